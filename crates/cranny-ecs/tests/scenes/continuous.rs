//! Fast bodies of a scene and a thin wall: with `Continuous` none passes, without it many do.

use std::sync::Arc;

use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_shapes::{Boxes, Hook, Torus};
use cranny_world::Random;
use cranny_world::description::{BodyDescription, BodyKind, Effect, SceneDescription};

use crate::build::{cube, scene};

/// How many bodies are thrown.
pub(crate) const THROWN: u32 = 24;

/// A plate across x, 0.02 thick, with a rib on each side, and hooks and rings that fly at it from 3
/// before it, tumbling, at 100 to 400 a second: they are side by side and meet nothing else.
fn throws(wall: &[Effect], thrown: &[Effect]) -> SceneDescription {
    let kind = BodyKind::Dynamic;
    let bodies = at_a_wall(7, kind, wall, thrown);
    let duration = 12.0 / 64.0;
    SceneDescription { gravity: DVec3::ZERO, duration, ..scene(bodies, &[Effect::Response]) }
}

pub(crate) fn at_a_wall(
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
pub(crate) fn passed(scene: &SceneDescription) -> (usize, u64) {
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
