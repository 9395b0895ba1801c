//! How a simulation runs: its options, and rapier's settings, each with its argument.

use cranny_exact::DVec3;
use rapier3d::prelude::IntegrationParameters;

use crate::detector::Detector;

/// How long solver substeps are with our detector, seconds; steps are divided into as many as come
/// nearest to it. rapier's default of four substeps has it
/// at 240 Hz. Longer: a chain of twelve links tears at 60 Hz; shorter: solving takes longer for
/// nothing.
pub const SOLVER_SUBSTEP: f64 = 1.0 / 960.0;

/// How a simulation runs.
///
/// # rapier's settings, and why
///
/// The values that a [`Simulation`](super::Simulation) gives rapier's `IntegrationParameters` and
/// bodies with our detector. An app that steps rapier itself sets the same, except where a row says
/// otherwise (*own app*).
///
/// | setting | value | why |
/// |---|---|---|
/// | `contact_clustering` | `false` | rapier merges normals within 5 degrees and keeps the first; ours are few, each exact at its own point |
/// | `contact_recycling` | `false` | rapier keeps contacts as they are while a pair drifts by several prediction distances: more than the play of a nut. A simulation carries contacts on instead, each computed anew ([`CARRIED_WITHIN`](crate::CARRIED_WITHIN)). Own app: `false` for tight fits |
/// | `friction_model` | `FrictionModel::Coulomb` | the simplified model rubs at a manifold's middle, and most of our manifolds have one point |
/// | `num_solver_iterations` | substeps of [`SOLVER_SUBSTEP`], 1/960 s: 4 at 240 Hz, 16 at 60 Hz; or [`solver_iterations`](Self::solver_iterations) | they are rapier's substeps: with its default of 4 at 60 Hz a falling chain sinks in by half a link before it is stopped |
/// | `contact_softness`, `static_contact_softness` | rapier's for what is fixed, 60 Hz, for both, times [`SOLVER_SUBSTEP`] over the substep where that is shorter | with rapier's own in shorter substeps, gravity presses a peg of millimetres into its floor by a quarter of its clearance; with its 30 Hz between moving bodies, a pile of 500 is half as deep again. Stiffer: a nut of coarse facets is braked by each of them (`docs/notebook`). Own app: the same |
/// | `length_unit` | [`length_unit`](Self::length_unit); for a scene, unless stated, twice the volume per area of the thinnest moving body (about its thickness) | the prediction distance is 0.02 of it, and tolerances scale with it. Larger: the far flank of a groove joins in; smaller: bodies meet before they are seen |
/// | `normalized_max_linear_velocity` | `Real::MAX`: no limit | rapier slows every body to 400 of `length_unit` a second: a ring of thin wire, which makes the unit small, would not fall faster than 4. What moves by more than its radius in a step gets no contacts farther than that: it needs `Continuous` |
/// | `normalized_prediction_distance` | in each step as far as any two bodies near each other can come nearer in it; each pair has a reach of its own, as far as *its* bodies can. Own app: before each step, at least twice what two bodies can come nearer in it, over `length_unit` (rapier loosens a box by half of it, and only when its body moves) | a fast body overlaps before it is stopped; one that falls along with another does not see that a third stops that one. rapier looks ahead by linear velocity alone: what spins or turns fast needs steps in which its rim moves by less than the prediction distance |
/// | `dt` | [`step`](Self::step), in [parts](Self::most_parts) where bodies near each other move farther than the thinner is thick. Own app: shorter steps | what slides past an edge or turns fast meets features that no search looked at: a chain of thin rings that snaps taut is twice as deep |
/// | `soft_ccd_prediction` of a dynamic body | 0. Own app that does not look ahead by the prediction distance: the body's radius | it leaves out pairs with boxes apart that approach each other only once one of them is stopped |
/// | the rest | rapier's defaults | |
///
/// With another detector rapier has its defaults, but for `dt` and `length_unit`, which the options
/// state, `contact_recycling` and `num_solver_iterations`, which they may,
/// `normalized_max_linear_velocity`, which would be of that unit, and `soft_ccd_prediction`, which
/// is a dynamic body's radius: rapier's own way to look ahead.
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
    /// Whether contacts of a pair that drifts by little are carried on instead of searched in each
    /// step: with our detector computed anew at each pose, within
    /// [`CARRIED_WITHIN`](crate::CARRIED_WITHIN), with rapier's own by its `contact_recycling`.
    /// `None`: they are.
    pub recycling: Option<bool>,
    /// Solver substeps a step, at least 1. `None`: rapier's default for its own detectors, enough
    /// for [`SOLVER_SUBSTEP`] for ours.
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

    /// Solver substeps that our detector's contacts need in a step of so many seconds: of about
    /// [`SOLVER_SUBSTEP`], and not fewer than rapier's default.
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
