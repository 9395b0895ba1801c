//! Runs a scene file to its end.

use std::path::PathBuf;

use cranny_ecs::{Bodies, Body, RunOptions, RunSummary, SceneApp, pose_of};
use cranny_exact::Pose;
use cranny_scene::{LoadedScene, load_scene};

/// A scene of `assets/scenes`.
pub(crate) fn asset(name: &str) -> LoadedScene {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/scenes").join(name);
    load_scene(&path).unwrap_or_else(|error| panic!("{error:?}"))
}

/// How a run ended.
pub(crate) struct Ended {
    pub(crate) summary: RunSummary,
    /// In the scene's order.
    pub(crate) poses: Vec<Pose>,
}

/// Simulates a scene to its end.
pub(crate) fn run(scene: &LoadedScene, options: &RunOptions) -> Ended {
    let mut app = SceneApp::new(&scene.description, options).unwrap();
    while app.step().unwrap() {}
    let poses = poses(&mut app);
    Ended { summary: app.finish().unwrap(), poses }
}

fn poses(app: &mut SceneApp) -> Vec<Pose> {
    let world = app.app_mut().world_mut();
    let mut found: Vec<_> = world
        .query::<(&Body, &bevy_transform::components::Transform)>()
        .iter(world)
        .map(|(body, transform)| (body.id, pose_of(transform)))
        .collect();
    found.sort_by_key(|(id, _)| *id);
    assert_eq!(found.len(), world.resource::<Bodies>().iter().len());
    found.into_iter().map(|(_, pose)| pose).collect()
}
