//! Runs a scene file to its end, and watches it on the way.

use std::path::PathBuf;

use cranny_ecs::{Bodies, Body, RunOptions, RunSummary, SceneApp, pose_of};
use cranny_exact::{DVec3, Pose};
use cranny_scene::{LoadedScene, load_scene};
use cranny_world::description::SceneDescription;

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

/// The number of a body in the scene's order.
pub(crate) fn body(scene: &SceneDescription, name: &str) -> usize {
    let found = scene.bodies.iter().position(|body| body.name == name);
    found.unwrap_or_else(|| panic!("no body {name:?}"))
}

/// Degrees between where a body's axis points in two poses.
pub(crate) fn tilt(axis: DVec3, a: &Pose, b: &Pose) -> f64 {
    let [p, q] = [a, b].map(|pose| pose.rotation * axis);
    p.cross(q).length().atan2(p.dot(q)).to_degrees()
}

/// The body's lowest point, or that along another direction.
pub(crate) fn lowest(scene: &SceneDescription, body: usize, pose: &Pose, up: DVec3) -> f64 {
    let map = pose.world_from_body();
    let vertices = scene.bodies[body].collision.vertices();
    vertices.iter().map(|&p| up.dot(map.apply(p))).fold(f64::INFINITY, f64::min)
}

/// A moment of a run, in the scene's order.
pub(crate) struct Moment {
    /// Steps done.
    pub(crate) step: u64,
    pub(crate) poses: Vec<Pose>,
}

/// Simulates a scene to its end.
pub(crate) fn run(scene: &LoadedScene, options: &RunOptions) -> Ended {
    watch(&scene.description, options, |_| ())
}

/// Simulates a scene to its end, and shows every moment, the first one too.
pub(crate) fn watch(
    scene: &SceneDescription,
    options: &RunOptions,
    mut see: impl FnMut(&Moment),
) -> Ended {
    let mut app = SceneApp::new(scene, options).unwrap();
    loop {
        let now = moment(&mut app);
        see(&now);
        let before = app.steps_done();
        app.step().unwrap();
        if app.steps_done() == before {
            return Ended { poses: now.poses, summary: app.finish().unwrap() };
        }
    }
}

fn moment(app: &mut SceneApp) -> Moment {
    let step = app.steps_done();
    let world = app.app_mut().world_mut();
    let mut found: Vec<_> = world
        .query::<(&Body, &bevy_transform::components::Transform)>()
        .iter(world)
        .map(|(body, transform)| (body.id, pose_of(transform)))
        .collect();
    found.sort_by_key(|(id, _)| *id);
    assert_eq!(found.len(), world.resource::<Bodies>().iter().len());
    Moment { step, poses: found.into_iter().map(|(_, pose)| pose).collect() }
}
