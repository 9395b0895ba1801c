//! Kinematic bodies on keyframed paths.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_world::description::{
    BodyDescription, BodyKind, Effect, Interpolation, Keyframe, KeyframedPath, PathEnd,
};

use crate::build::{cube, scene};

/// Of coordinates of a few units, in single precision.
const ROUNDED: f64 = 5e-6;

fn key(time: f64, at: DVec3, turn: f64) -> Keyframe {
    Keyframe { time, pose: Pose { rotation: DQuat::from_rotation_z(turn), translation: at } }
}

fn led(keys: &[Keyframe], end: PathEnd) -> BodyDescription {
    let path = KeyframedPath::new(keys.to_vec(), Interpolation::Linear, end).unwrap();
    let body = cube("led", BodyKind::Kinematic, DVec3::splat(77.0), DVec3::ZERO);
    BodyDescription { path: Some(Arc::new(path)), ..body }
}

/// A cube whose centre is not its origin.
fn off_centre() -> Arc<Mesh> {
    let cube = cube("", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO).collision;
    let moved = cube.vertices().iter().map(|&p| p + DVec3::new(2.0, 0.0, 0.0)).collect();
    Arc::new(Mesh::new(moved, cube.faces().to_vec()).unwrap())
}

fn entity(app: &SceneApp, name: &str) -> Entity {
    let bodies = app.app().world().resource::<Bodies>();
    bodies.get(bodies.find(name).unwrap()).unwrap().entity
}

fn pose(app: &SceneApp, name: &str) -> Pose {
    pose_of(app.app().world().get::<Transform>(entity(app, name)).unwrap())
}

fn distance(a: &Pose, b: &Pose) -> f64 {
    let turn = (a.rotation.conjugate() * b.rotation).xyz().length();
    a.translation.distance(b.translation) + turn
}

fn effects() -> Vec<Vec<Effect>> {
    let with_solver = cfg!(feature = "rapier").then(|| vec![Effect::Response]);
    with_solver.into_iter().chain([vec![Effect::TRIGGER]]).collect()
}

#[test]
fn a_body_is_on_its_path_at_the_end_of_each_step_also_where_it_turns_off_centre() {
    let keys = [
        key(0.1, DVec3::ZERO, 0.0),
        key(0.5, DVec3::new(1.0, 2.0, 3.0), FRAC_PI_2),
        key(0.9, DVec3::X, -FRAC_PI_2),
    ];
    for effects in effects() {
        let body = BodyDescription { collision: off_centre(), ..led(&keys, PathEnd::Hold) };
        let path = body.path.clone().unwrap();
        let mut app = SceneApp::new(&scene(vec![body], &effects), &RunOptions::default()).unwrap();
        assert!(distance(&pose(&app, "led"), &keys[0].pose) < 1e-9, "it starts on its path");
        let mut steps = 0;
        while app.step().unwrap() {
            let seconds = app.app().world().resource::<SimulatedTime>().seconds();
            let off = distance(&pose(&app, "led"), &path.pose_at(seconds));
            assert!(off < ROUNDED, "{effects:?}: {off} at {seconds}");
            steps += 1;
        }
        assert!(steps > 60);
        let velocity = app.app().world().get::<LinearVelocity>(entity(&app, "led")).unwrap();
        assert_eq!(velocity.0.length(), 0.0, "it waits at its end without a trace of motion");
    }
}

#[test]
fn a_loop_begins_again_with_a_jump_that_throws_nobody() {
    let keys = [key(0.0, DVec3::ZERO, 0.0), key(0.25, DVec3::new(0.5, 0.0, 0.0), 0.0)];
    let body = led(&keys, PathEnd::Loop);
    let path = body.path.clone().unwrap();
    for effects in effects() {
        let scene = scene(vec![body.clone()], &effects);
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        while app.step().unwrap() {
            let world = app.app().world();
            let at = world.resource::<SimulatedTime>().seconds();
            assert!(
                distance(&pose(&app, "led"), &path.pose_at(at)) < ROUNDED,
                "{effects:?} at {at}"
            );
            let velocity = world.get::<LinearVelocity>(entity(&app, "led")).unwrap();
            assert!(velocity.0.length() < 2.1, "{velocity:?} at {at}");
        }
    }
}

#[cfg(feature = "rapier")]
#[test]
fn a_body_on_a_path_pushes_what_is_in_its_way_and_is_not_held_back() {
    let floor = cube("floor", BodyKind::Fixed, DVec3::new(0.0, 0.0, -1.01), DVec3::ZERO);
    let crate_ = cube("crate", BodyKind::Dynamic, DVec3::new(1.2, 0.0, 0.0), DVec3::ZERO);
    let floor = BodyDescription {
        collision: Arc::new(cranny_shapes::Cuboid { size: [20.0, 20.0, 1.0] }.build().unwrap()),
        ..floor
    };
    let keys = [key(0.0, DVec3::ZERO, 0.0), key(1.0, DVec3::new(2.0, 0.0, 0.0), 0.0)];
    let bodies = vec![floor, crate_, led(&keys, PathEnd::Hold)];
    let scene = scene(bodies, &[Effect::Response]);
    let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
    while app.step().unwrap() {}
    assert!(distance(&pose(&app, "led"), &keys[1].pose) < 1e-5);
    let at = pose(&app, "crate").translation;
    assert!(at.x > 2.98 && at.x < 3.3 && at.z.abs() < 0.05, "{at}");
}

#[test]
fn a_path_on_a_body_that_is_not_kinematic_is_refused() {
    let body = BodyDescription {
        kind: BodyKind::Dynamic,
        ..led(&[key(0.0, DVec3::ZERO, PI)], PathEnd::Hold)
    };
    let scene = scene(vec![body], &[Effect::TRIGGER]);
    let error = SceneApp::new(&scene, &RunOptions::default()).err().unwrap().to_string();
    assert!(error.contains("'led'") && error.contains("kinematic"), "{error}");
}
