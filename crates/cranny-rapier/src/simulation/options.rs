//! How a simulation runs.

use cranny_exact::DVec3;
use rapier3d::prelude::IntegrationParameters;

use crate::detector::Detector;

/// The longest solver substep with our detector, seconds. rapier's default of four substeps has it at
/// 240 Hz. Longer: a chain of twelve links tears at 60 Hz; shorter: solving takes longer for nothing.
pub const SOLVER_SUBSTEP: f64 = 1.0 / 960.0;

/// How a simulation runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationOptions {
    /// Who detects contacts.
    pub detector: Detector,
    /// Acceleration of dynamic bodies.
    pub gravity: DVec3,
    /// Seconds a step, > 0.
    pub step: f64,
    /// How many units of length make what rapier takes for a metre; scales its prediction distance
    /// (0.02 of it) and tolerances.
    pub length_unit: f64,
    /// Whether contacts of a pair that drifts by little are carried on instead of searched in each step: with our detector
    /// told anew at each pose, within [`CARRIED_WITHIN`](crate::CARRIED_WITHIN), with rapier's own by its
    /// `contact_recycling`. `None`: they are.
    pub recycling: Option<bool>,
    /// Solver substeps a step, at least 1. `None`: rapier's default for its own detectors, enough for
    /// [`SOLVER_SUBSTEP`] for ours.
    pub solver_iterations: Option<usize>,
    /// Into how many parts a step is divided at most in which two bodies near each other move
    /// farther than the thinner one is thick; contacts are found at the beginning of each. 1:
    /// never, as rapier's own pipeline. More than 2: fast chains overlap less, and large piles take
    /// longer to fall (`docs/notebook`). Our detector only.
    pub most_parts: usize,
}

impl SimulationOptions {
    /// Solver substeps a step.
    #[must_use]
    pub fn substeps(&self) -> usize {
        let usual = IntegrationParameters::default().num_solver_iterations;
        match self.solver_iterations {
            Some(iterations) => iterations.max(1),
            None if self.detector == Detector::Cranny => Self::substeps_for(self.step),
            None => usual,
        }
    }

    /// Solver substeps that our detector's contacts need in a step of so many seconds: of
    /// [`SOLVER_SUBSTEP`] at most, and not fewer than rapier's default.
    #[must_use]
    pub fn substeps_for(step: f64) -> usize {
        let enough = (step / SOLVER_SUBSTEP).round() as usize;
        enough.max(IntegrationParameters::default().num_solver_iterations)
    }

    /// Whether our detector carries contacts on.
    pub(super) fn carries(&self) -> bool {
        self.detector == Detector::Cranny && self.recycling.unwrap_or(true)
    }

    /// Whether rapier reuses contacts as they were.
    pub(super) fn rapier_recycles(&self) -> bool {
        self.detector != Detector::Cranny && self.recycling.unwrap_or(true)
    }
}

impl Default for SimulationOptions {
    fn default() -> Self {
        Self {
            detector: Detector::default(),
            gravity: DVec3::new(0.0, 0.0, -9.81),
            step: 1.0 / 60.0,
            length_unit: 1.0,
            recycling: None,
            solver_iterations: None,
            most_parts: 2,
        }
    }
}
