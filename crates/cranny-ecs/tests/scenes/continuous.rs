//! Fast bodies of a scene and a thin wall: with `Continuous` none passes, without it many do.

use std::sync::Arc;

use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_primitives::{Ball, Primitive};
use cranny_shapes::{Boxes, Cuboid, Hook, Torus};
use cranny_world::description::{
    BodyDescription, BodyKind, Effect, Interpolation, Keyframe, KeyframedPath, PathEnd,
    SceneDescription,
};
use cranny_world::{BodyId, Random};

use crate::build::{cube, scene};

/// How many bodies are thrown.
const THROWN: u32 = 24;

/// A plate across x, 0.02 thick, with a rib on each side, and hooks and rings that fly at it from 3
/// before it, tumbling, at 100 to 400 a second: they are side by side and meet nothing else.
fn throws(wall: &[Effect], thrown: &[Effect]) -> SceneDescription {
    let kind = BodyKind::Dynamic;
    let bodies = at_a_wall(7, kind, wall, thrown);
    let duration = 12.0 / 64.0;
    SceneDescription { gravity: DVec3::ZERO, duration, ..scene(bodies, &[Effect::Response]) }
}

fn at_a_wall(
    seed: u64,
    kind: BodyKind,
    wall: &[Effect],
    thrown: &[Effect],
) -> Vec<BodyDescription> {
    let mut random = Random::new(seed);
    let plate = [[-0.01, -40.0, -9.0], [0.01, 40.0, 9.0]];
    let ribs = [[[-0.2, -40.0, 0.0], [0.0, 40.0, 0.02]], [[0.0, -40.0, 0.5], [0.2, 40.0, 0.52]]];
    let plate = Boxes { add: [&[plate], &ribs[..]].concat(), cut: Vec::new() };
    let plate = Arc::new(plate.build().unwrap());
    let hook = Hook { length: 0.12, opening: 0.07, tip: 0.05, thickness: 0.03, depth: 0.03 };
    let ring =
        Torus { major_radius: 0.06, minor_radius: 0.01, major_segments: 16, minor_segments: 6 };
    let shapes = [hook.build(), ring.build()].map(|mesh| Arc::new(mesh.unwrap()));
    let body = |i: u32| {
        let place = DVec3::new(-4.0, 3.0 * f64::from(i) - 35.0, 0.0) + 0.5 * random.in_ball();
        let speed = 250.0 + 150.0 * random.signed();
        BodyDescription {
            collision: Arc::clone(&shapes[i as usize % shapes.len()]),
            pose: Pose { rotation: random.rotation(), translation: place },
            angular_velocity: 30.0 * random.in_ball(),
            effects: thrown.to_vec(),
            ..cube(&format!("thrown_{i}"), kind, place, DVec3::X * speed)
        }
    };
    let mut bodies: Vec<_> = (0..THROWN).map(body).collect();
    let still = cube("wall", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
    bodies.push(BodyDescription { collision: plate, effects: wall.to_vec(), ..still });
    bodies
}

/// How many are behind the wall at the end, and how often one was held back.
fn passed(scene: &SceneDescription) -> (usize, u64) {
    let mut app = SceneApp::new(scene, &RunOptions::default()).unwrap();
    while app.step().unwrap() {}
    let world = app.app_mut().world_mut();
    let mut places = world.query::<(&Body, &Transform)>();
    let behind = places.iter(world).filter(|(_, place)| place.translation.x > 0.0).count();
    (behind, world.get_resource::<HeldBack>().map_or(0, |held| held.total))
}

#[test]
fn of_a_scene_s_fast_bodies_none_passes_a_thin_wall_with_continuous_and_many_do_without() {
    let (without, held) = passed(&throws(&[], &[]));
    assert!(without > THROWN as usize / 2 && held == 0, "{without} passed, {held} held back");
    for (wall, thrown) in [(&[Effect::Continuous][..], &[][..]), (&[], &[Effect::Continuous])] {
        let (with, held) = passed(&throws(wall, thrown));
        assert_eq!(with, 0);
        assert!(held >= THROWN.into(), "{held}");
    }
}

/// Without a solver: kinematic hooks, rings and balls that follow their velocities.
fn led(seed: u64, effects: &[Effect]) -> SceneDescription {
    let mut bodies = at_a_wall(seed, BodyKind::Kinematic, &[], effects);
    for ball in bodies.iter_mut().take(THROWN as usize).skip(2).step_by(3) {
        ball.shape = Some(Primitive::from(Ball { center: DVec3::ZERO, radius: 0.05 }).into());
    }
    SceneDescription { duration: 12.0 / 64.0, ..scene(bodies, &[]) }
}

#[test]
fn of_a_thousand_that_are_led_at_a_wall_none_passes_it_with_continuous_and_many_do_without() {
    let [mut with, mut without, mut back] = [0; 3];
    for seed in 0..42 {
        let (passed_it, held) = passed(&led(seed, &[Effect::Continuous]));
        with += passed_it;
        back += usize::from(held >= THROWN.into());
        let (passed_it, held) = passed(&led(seed, &[]));
        without += passed_it;
        assert_eq!(held, 0);
    }
    assert_eq!((with, back), (0, 42));
    assert_eq!(without, 42 * THROWN as usize, "nothing else stops them");
}

/// A body is led through a wall along a path, slowly: it stands before the wall as long as the path
/// is beyond, and goes on when the path comes back.
#[test]
fn what_is_led_through_a_wall_waits_before_it() {
    let keyframe = |time: f64, x: f64| Keyframe { time, pose: Pose::at(DVec3::X * x) };
    let path = KeyframedPath::new(
        vec![keyframe(0.0, -2.0), keyframe(1.0, 2.0), keyframe(2.0, -2.0)],
        Interpolation::Linear,
        PathEnd::Hold,
    );
    let wall = cube("wall", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
    let guest = BodyDescription {
        path: Some(Arc::new(path.unwrap())),
        ..cube("guest", BodyKind::Kinematic, DVec3::X * -2.0, DVec3::ZERO)
    };
    for (sensor, stops) in [(false, true), (true, false)] {
        let wall = BodyDescription { sensor, ..wall.clone() };
        let effects = [Effect::Continuous, Effect::TRIGGER];
        let bodies = vec![wall, guest.clone()];
        let scene = SceneDescription { duration: 2.0, ..scene(bodies, &effects) };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        let (mut farthest, mut waiting) = (f32::MIN, 0);
        while app.step().unwrap() {
            let world = app.app_mut().world_mut();
            let held = world.resource::<HeldBack>().bodies;
            let mut places = world.query::<(&Body, &Transform)>();
            let at = places.iter(world).find(|(body, _)| body.id.0 == 1).unwrap().1.translation.x;
            farthest = farthest.max(at);
            waiting += usize::from(held == 1);
        }
        assert_eq!((farthest < -1.0, waiting > 60), (stops, stops), "{farthest}, {waiting}");
        assert!(!stops || farthest > -1.001, "{farthest}: it stops where it meets the wall");
    }
}

/// A rod that only turns, about its middle, stops before a post that stands in its circle; what
/// touches at the beginning is not held, and neither is what an app puts elsewhere.
#[test]
fn what_turns_is_held_and_what_is_put_elsewhere_is_not() {
    let post = |x: f64| cube("post", BodyKind::Fixed, DVec3::new(x, 1.5, 0.0), DVec3::ZERO);
    let rod = BodyDescription {
        collision: Arc::new(Cuboid { size: [6.0, 0.1, 0.1] }.build().unwrap()),
        angular_velocity: DVec3::Z * 30.0,
        ..cube("rod", BodyKind::Kinematic, DVec3::ZERO, DVec3::ZERO)
    };
    let turned = |post: BodyDescription, put: Option<f32>| {
        let duration = 8.0 / 64.0;
        let scene = scene(vec![post, rod.clone()], &[Effect::Continuous]);
        let scene = SceneDescription { duration, ..scene };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        if let Some(x) = put {
            app.step().unwrap();
            let world = app.app_mut().world_mut();
            let rod = world.resource::<Bodies>().get(BodyId(1)).unwrap().entity;
            world.get_mut::<Transform>(rod).unwrap().translation.x = x;
        }
        while app.step().unwrap() {}
        let world = app.app_mut().world_mut();
        let rod = world.resource::<Bodies>().get(BodyId(1)).unwrap().entity;
        let (axis, angle) = world.get::<Transform>(rod).unwrap().rotation.to_axis_angle();
        (axis.z * angle, world.resource::<HeldBack>().total)
    };
    // Its upper side, 0.05 beside its middle line, meets the corner (2, 1) of the post.
    let meets = 1.0_f64.atan2(2.0) - (0.05 / 5.0_f64.sqrt()).asin();
    let (angle, held) = turned(post(1.5), None);
    assert!((f64::from(angle) - meets).abs() < 1e-3 && held > 0, "{angle}, not {meets}");
    let (angle, held) = turned(post(40.0), None);
    assert!(
        (angle - 8.0 * 30.0 / 64.0).rem_euclid(std::f32::consts::TAU).min(1.0) < 1e-3 && held == 0
    );
    assert_eq!(turned(post(1.5), Some(40.0)).1, 1, "held in its first step, then put beyond");
}

/// Far from the origin, where single precision is coarser than the gap that is kept.
#[test]
fn who_is_held_far_away_does_not_touch() {
    for i in 0..40 {
        let far = DVec3::new(20_000.3 + 0.37 * f64::from(i), 3e4, 0.0);
        let wall = cube("wall", BodyKind::Fixed, far, DVec3::ZERO);
        let from = far - DVec3::X * 8.0;
        let speed = DVec3::X * (400.0 + f64::from(i));
        let guest = cube("guest", BodyKind::Kinematic, from, speed);
        let scene = scene(vec![wall, guest], &[Effect::Continuous, Effect::TRIGGER]);
        let scene = SceneDescription { duration: 6.0 / 64.0, ..scene };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        while app.step().unwrap() {}
        let world = app.app_mut().world_mut();
        assert!(world.resource::<HeldBack>().total > 0);
        let mut places = world.query::<(&Body, &Transform)>();
        let x = |id: u32| places.iter(world).find(|(b, _)| b.id.0 == id).unwrap().1.translation.x;
        let [wall, guest] = [0, 1].map(x);
        assert!(wall - guest > 1.0 && wall - guest < 1.1, "{i}: {wall} {guest}");
    }
}

/// Two that are led at each other stop between; one that is not named runs into nobody either.
#[test]
fn who_meets_who_is_named_stops() {
    for named in [0, 1] {
        let mut bodies: Vec<_> = [-1.0, 1.0]
            .map(|side| {
                let at = DVec3::X * (5.0 * side);
                cube(&format!("at_{side}"), BodyKind::Kinematic, at, DVec3::X * (-320.0 * side))
            })
            .into();
        bodies[named].effects = vec![Effect::Continuous];
        let scene = SceneDescription { duration: 3.0 / 64.0, ..scene(bodies, &[]) };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        while app.step().unwrap() {}
        let world = app.app_mut().world_mut();
        let mut places = world.query::<(&Body, &Transform)>();
        let mut x: Vec<_> =
            places.iter(world).map(|(body, place)| (body.id.0, place.translation.x)).collect();
        x.sort_by_key(|(id, _)| *id);
        let gap = x[1].1 - x[0].1;
        assert!(gap > 1.0 && gap < 1.001, "{x:?}");
    }
}

/// rapier's limit of speed is 400 thicknesses a second.
#[test]
fn what_is_thin_is_not_slowed() {
    let mut scene = throws(&[], &[]);
    scene.bodies.pop();
    let starts: Vec<_> = scene.bodies.iter().map(|body| body.pose.translation.x).collect();
    let speeds: Vec<_> = scene.bodies.iter().map(|body| body.linear_velocity.x).collect();
    let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
    while app.step().unwrap() {}
    let world = app.app_mut().world_mut();
    let mut places = world.query::<(&Body, &Transform)>();
    for (body, place) in places.iter(world) {
        let index = body.id.0 as usize;
        let expected = starts[index] + speeds[index] * scene.duration;
        let center = place.translation.x;
        assert!((f64::from(center) - expected).abs() < 1.0, "{center}, {expected}");
    }
}
