//! One of those that are compared: the scene under one detector, stepped until it ends or fails.

use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use cranny_ecs::{PhaseTimes, RigidBodies, RunOptions, RunSummary, SceneApp, SceneAppError};
use cranny_rapier::Detector;
use cranny_world::description::SceneDescription;

use super::figures::{Figures, StepTimes};

/// The scene under one detector.
pub(super) struct Contestant {
    detector: Detector,
    recycling: bool,
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

impl Contestant {
    /// Prepares the scene. A peer may refuse a mesh; that is told in its row.
    ///
    /// # Errors
    ///
    /// What our detector cannot simulate; a scene in which nothing responds to anything.
    pub(super) fn new(
        scene: &SceneDescription,
        options: &RunOptions,
    ) -> Result<Self, SceneAppError> {
        let (detector, recycling) = (options.plugins.detector, options.plugins.recycling);
        let start = Instant::now();
        let state = guarded(detector, || SceneApp::new(scene, options))?
            .map_or_else(State::Failed, |app| State::Running(Box::new(app)));
        let prepared_s = start.elapsed().as_secs_f64();
        let recycling = recycling.unwrap_or(false);
        Ok(Self { detector, recycling, prepared_s, state, steps: Vec::new() })
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
        match guarded(self.detector, || app.step())? {
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
    pub(super) fn finish(self) -> Result<Figures, SceneAppError> {
        let (summary, failure): (Option<RunSummary>, _) = match self.state {
            State::Failed(why) => (None, Some(why)),
            State::Running(app) => match guarded(self.detector, || app.finish())? {
                Ok(summary) => (Some(summary), None),
                Err(why) => (None, Some(format!("after its last step: {why}"))),
            },
        };
        Ok(Figures::new(
            self.detector,
            self.recycling,
            self.prepared_s,
            self.steps,
            summary,
            failure,
        ))
    }
}

fn times(app: &SceneApp) -> PhaseTimes {
    app.app().world().get_resource::<PhaseTimes>().copied().unwrap_or_default()
}

/// Does something for a detector. What fails for a peer (some panic on meshes that they cannot take) is told
/// as a reason, so that the others go on; ours has no such grace.
fn guarded<T>(
    detector: Detector,
    work: impl FnOnce() -> Result<T, SceneAppError>,
) -> Result<Result<T, String>, SceneAppError> {
    if detector == Detector::Cranny {
        return work().map(Ok);
    }
    // What a panic would print is told in the row.
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let outcome = catch_unwind(AssertUnwindSafe(work));
    panic::set_hook(hook);
    Ok(match outcome {
        Ok(done) => done.map_err(|error| error.to_string()),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Err(format!("it panicked: {}", text.unwrap_or("without a word")))
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_that_fails_is_told_and_ours_is_not_spared() {
        let lost = || SceneAppError::NotFinite { body: "nut".into(), step: 7 };
        let peer = Detector::RapierDecomposition;
        assert!(matches!(guarded(peer, || Ok(3)), Ok(Ok(3))));
        let why = guarded::<()>(peer, || Err(lost())).unwrap().unwrap_err();
        assert!(why.contains("nut"), "{why}");
        let why = guarded::<()>(peer, || panic!("no hull of {} points", 2)).unwrap().unwrap_err();
        assert_eq!(why, "it panicked: no hull of 2 points");
        assert!(guarded::<()>(Detector::Cranny, || Err(lost())).is_err());
    }
}
