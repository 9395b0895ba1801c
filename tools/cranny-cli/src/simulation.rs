//! A scene simulated to its end, or to where Ctrl-C ends it in order.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use cranny_ecs::{
    ContactFields, PluginOptions, RunOptions, RunSummary, SceneApp, SceneAppError, helices, rings,
};
use cranny_rapier::Detector;
use cranny_scene::LoadedScene;
use cranny_world::description::SceneDescription;

use crate::failure::Failure;
use crate::progress::RunProgress;

/// The plugins of a scene whose contacts nobody reads.
pub(crate) fn plugins(scene: &LoadedScene, detector: Detector) -> PluginOptions {
    PluginOptions {
        detector,
        helices: helices(scene),
        rings: rings(scene),
        contact_fields: ContactFields::NONE,
        ..PluginOptions::default()
    }
}

/// Simulates a scene; the progress still shows. `refused` words what is wrong with the scene or the
/// options.
///
/// # Errors
///
/// A scene or options that cannot be simulated; a step, a recording or a picture that failed.
pub(crate) fn simulate(
    scene: &SceneDescription,
    options: &RunOptions,
    refused: impl FnOnce(SceneAppError) -> Failure,
) -> Result<(RunSummary, RunProgress), Failure> {
    // Before anything is written that a Ctrl-C would have to finish.
    let stop = stop_flag();
    let mut app = SceneApp::new(scene, options).map_err(refused)?;
    let progress = RunProgress::new(app.steps_total(), options.step.unwrap_or(scene.step));
    let mut steps_left = app.steps_total() > 0;
    while steps_left {
        if stop.load(Ordering::Relaxed) {
            app.interrupt();
        }
        steps_left = app.step().map_err(failure)?;
        progress.set(app.steps_done());
    }
    progress.finishing();
    Ok((app.finish().map_err(failure)?, progress))
}

/// Input that cannot be simulated is the caller's to mend; the rest is a failed run.
pub(crate) fn failure(error: SceneAppError) -> Failure {
    match error {
        SceneAppError::Output { .. }
        | SceneAppError::Record(_)
        | SceneAppError::Picture { .. }
        | SceneAppError::NotFinite { .. } => Failure::run(error),
        _ => Failure::input(error),
    }
}

/// Set by Ctrl-C, and by the signal that ends jobs: the step at hand is completed, then the run
/// ends in order.
pub(crate) fn stop_flag() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let set = stop.clone();
    if let Err(error) = ctrlc::set_handler(move || set.store(true, Ordering::Relaxed)) {
        tracing::warn!("Ctrl-C will end the run at once, without a summary ({error})");
    }
    stop
}
