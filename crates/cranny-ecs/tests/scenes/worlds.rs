//! The scenes of `assets/`: all of them run, and those with somebody on a path end as they say.

use std::path::PathBuf;

use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_scene::load_scene;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes")
}

fn app(name: &str, seconds: Option<f64>) -> SceneApp {
    let loaded = load_scene(&folder().join(name)).unwrap_or_else(|error| panic!("{error}"));
    let options = RunOptions { duration: seconds, ..RunOptions::default() };
    SceneApp::new(&loaded.description, &options).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn pose(app: &SceneApp, name: &str) -> Pose {
    let world = app.app().world();
    let bodies = world.resource::<Bodies>();
    let entity = bodies.get(bodies.find(name).unwrap()).unwrap().entity;
    pose_of(world.get::<Transform>(entity).unwrap())
}

/// The stylus hovers over rim, wall and floor, and truly touches three times.
#[test]
fn a_stylus_that_shakes_makes_its_three_contacts_and_no_other() {
    let mut app = app("imprecise_tracking.ron", None);
    while app.step().unwrap() {}
    let tracking = app.finish().unwrap().tracking.remove(0);
    let TrackedContacts { latency_steps, end_latency_steps, .. } = tracking.filtered;
    assert_eq!(tracking.truth, 3);
    // Each of the three, and nothing wrong.
    let right =
        TrackedContacts { contacts: 3, latency_steps, end_latency_steps, ..Default::default() };
    assert_eq!(tracking.filtered, right);
    assert!(latency_steps < 60 && end_latency_steps < 60, "{tracking:?}");
    assert!(tracking.raw.spurious > 20 && tracking.raw.repeated > 0, "{tracking:?}");
    assert!(tracking.late > 0 && tracking.missing > 50 && tracking.lost > 0, "{tracking:?}");
}

/// By how many degrees bodies have turned, from before a run to after it.
fn turned(name: &str, seconds: f64, bodies: &[&str]) -> Vec<f64> {
    let mut app = app(name, Some(seconds));
    let poses = |app: &SceneApp| bodies.iter().map(|body| pose(app, body)).collect::<Vec<_>>();
    let before = poses(&app);
    while app.step().unwrap() {}
    let after = poses(&app);
    let angle = |(a, b): (&Pose, &Pose)| {
        let q = a.rotation.conjugate() * b.rotation;
        2.0 * q.xyz().length().atan2(q.w.abs()).to_degrees()
    };
    before.iter().zip(&after).map(angle).collect()
}

#[test]
fn every_scene_starts_and_steps() {
    const STEPS: usize = 3;
    let mut scenes = 0;
    for entry in std::fs::read_dir(folder()).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let mut app = app(&name, None);
        for _ in 0..STEPS {
            assert!(app.step().unwrap_or_else(|error| panic!("{name}: {error}")), "{name}");
        }
        scenes += 1;
    }
    assert!(scenes >= 32, "{scenes}");
}

#[test]
fn the_visitor_of_the_house_pushes_the_front_door_open() {
    let turns = turned("house.ron", 3.6, &["front_door", "bathroom_door"]);
    assert!(turns[0] > 50.0 && turns[0] < 115.0, "{turns:?}");
    assert!(turns[1] < 1.0, "nobody is at the other door: {turns:?}");
}

#[test]
fn the_hand_in_the_automobile_turns_the_steering_wheel() {
    let turns = turned("automobile.ron", 3.4, &["steering_wheel", "wheel_front_left"]);
    assert!(turns[0] > 15.0, "{turns:?}");
    assert!(turns[1] > 1.0, "a wheel that was spun turns on its axle: {turns:?}");
}

#[test]
fn the_drone_in_the_submarine_pushes_the_chair_towards_the_bow() {
    let mut app = app("submarine.ron", None);
    let start = pose(&app, "chair").translation;
    while app.step().unwrap() {}
    let moved = pose(&app, "chair").translation - start;
    assert!(moved.x > 0.3, "{moved}");
    // Beside the deck it falls into the bilge, and lies within the hull: no part of it is as far
    // from the axis as the hull is wide.
    let world = app.app().world();
    let bodies = world.resource::<Bodies>();
    let mesh = |name| bodies.get(bodies.find(name).unwrap()).unwrap().model().unwrap().mesh();
    let radius = |p: DVec3| DVec3::new(0.0, p.y, p.z).length();
    let below = mesh("hull").vertices().iter().filter(|p| p.z < 0.0).map(|&p| radius(p));
    let hull = below.fold(0.0, f64::max);
    let placed = pose(&app, "chair").world_from_body();
    for &p in mesh("chair").vertices() {
        assert!(radius(placed.apply(p)) < hull, "{p} of the chair, in a hull of radius {hull}");
    }
    let drone = pose(&app, "drone").translation;
    assert!(drone.distance(DVec3::new(4.9, 0.0, 0.0)) < 1e-4, "{drone}");
}
