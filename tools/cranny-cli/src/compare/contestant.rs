//! One of those that are compared: the scene under one detector, stepped until it ends or fails.

use std::time::Instant;

use cranny_ecs::{
    PhaseTimes, PluginOptions, RigidBodies, RunOptions, RunSummary, SceneApp, SceneAppError,
};
use cranny_rapier::{Detector, ShapeError, SimulationError, SimulationOptions};
use cranny_world::description::SceneDescription;

use super::figures::{RunFigures, Setting, StepTimes};

/// The scene under one detector.
pub(super) struct DetectorRun {
    detector: Detector,
    recycling: bool,
    substeps: usize,
    prepared_s: f64,
    state: State,
    steps: Vec<StepTimes>,
}

enum State {
    /// Going on, or at the end of its steps.
    Running(Box<SceneApp>),
    /// A peer that could not go on: why.
    Failed(String),
}

impl DetectorRun {
    /// Prepares the scene. A peer may refuse a mesh; its row says so.
    ///
    /// # Errors
    ///
    /// What our detector cannot simulate; a scene in which nothing responds to anything.
    pub(super) fn new(
        scene: &SceneDescription,
        options: &RunOptions,
    ) -> Result<Self, SceneAppError> {
        let PluginOptions { detector, recycling, substeps, .. } = options.plugins;
        let solver = SimulationOptions {
            detector,
            step: options.step.unwrap_or(scene.step),
            solver_iterations: substeps,
            ..SimulationOptions::default()
        };
        let start = Instant::now();
        let state = excused(detector, SceneApp::new(scene, options))?.map_or_else(
            |why| State::Failed(format!("before its first step: {why}")),
            |app| State::Running(Box::new(app)),
        );
        Ok(Self {
            detector,
            recycling: recycling.unwrap_or(true),
            substeps: solver.substeps(),
            prepared_s: start.elapsed().as_secs_f64(),
            state,
            steps: Vec::new(),
        })
    }

    /// Whether a solver moves bodies in it, which alone makes detectors differ.
    pub(super) fn has_solver(&self) -> bool {
        match &self.state {
            State::Running(app) => app.app().world().get_resource::<RigidBodies>().is_some(),
            State::Failed(_) => true,
        }
    }

    /// Steps that the run has in all.
    pub(super) fn steps_total(&self) -> u64 {
        match &self.state {
            State::Running(app) => app.steps_total(),
            State::Failed(_) => 0,
        }
    }

    /// Makes a step, if it can.
    ///
    /// # Errors
    ///
    /// A step of our own that failed.
    pub(super) fn step(&mut self) -> Result<(), SceneAppError> {
        let State::Running(app) = &mut self.state else { return Ok(()) };
        let before = times(app);
        match excused(self.detector, app.step())? {
            Ok(_) => {
                let now = times(app);
                self.steps.push(StepTimes {
                    broad: now.broad - before.broad,
                    narrow: now.narrow - before.narrow,
                    solver: now.solver - before.solver,
                });
            }
            Err(why) => {
                self.state = State::Failed(format!("after {} steps: {why}", self.steps.len()));
            }
        }
        Ok(())
    }

    /// Makes no step any more; the summary will say so.
    pub(super) fn interrupt(&mut self) {
        if let State::Running(app) = &mut self.state {
            app.interrupt();
        }
    }

    /// Looks at the final poses and sums up.
    ///
    /// # Errors
    ///
    /// Where our own run cannot be ended.
    pub(super) fn finish(self) -> Result<RunFigures, SceneAppError> {
        let (summary, failure): (Option<RunSummary>, _) = match self.state {
            State::Failed(why) => (None, Some(why)),
            State::Running(app) => (Some(app.finish()?), None),
        };
        let setting = Setting {
            detector: self.detector.name(),
            recycling: self.recycling,
            substeps: self.substeps,
            prepared_s: self.prepared_s,
        };
        Ok(RunFigures::new(setting, self.steps, summary, failure))
    }
}

fn times(app: &SceneApp) -> PhaseTimes {
    app.app().world().get_resource::<PhaseTimes>().copied().unwrap_or_default()
}

/// What a peer may fail at: a mesh that rapier refuses, a step in which it panics or loses bodies.
/// Its row gives the reason, so that the others go on. Ours has no such grace, nor has whatever
/// else goes wrong.
fn excused<T>(
    detector: Detector,
    outcome: Result<T, SceneAppError>,
) -> Result<Result<T, String>, SceneAppError> {
    match outcome {
        Err(
            error @ (SceneAppError::Solver {
                source: SimulationError::Shape(ShapeError::TriMesh(_) | ShapeError::Decomposition),
                ..
            }
            | SceneAppError::SolverPanicked { .. }
            | SceneAppError::NotFinite { .. }),
        ) if detector != Detector::Cranny => Ok(Err(error.to_string())),
        outcome => outcome.map(Ok),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_is_excused_what_is_its_own_fault() {
        let lost = || Err::<(), _>(SceneAppError::NotFinite { body: "nut".into(), step: 7 });
        let shape = || SceneAppError::Solver {
            body: "nut".into(),
            source: SimulationError::Shape(ShapeError::Decomposition),
        };
        let peer = Detector::RapierDecomposition;
        assert!(matches!(excused(peer, Ok(3)), Ok(Ok(3))));
        assert!(excused(peer, lost()).unwrap().unwrap_err().contains("nut"));
        assert!(excused::<()>(peer, Err(shape())).unwrap().unwrap_err().contains("decompose"));
        let unknown = || Err::<(), _>(SceneAppError::UnknownBody { name: "nut".into() });
        assert!(excused(peer, unknown()).is_err());
        assert!(excused(Detector::Cranny, lost()).is_err());
        assert!(excused::<()>(Detector::Cranny, Err(shape())).is_err());
    }
}
