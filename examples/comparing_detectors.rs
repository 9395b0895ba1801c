//! One scene, all detectors: a ring is let go over a post that fits into its hole. Contacts of the
//! meshes let it down to the floor; convex pieces of them close the hole and hold it up. All are
//! judged alike, by exact answers beside the solver.
//!
//! `cargo run --example comparing_detectors --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::rapier::Detector;
use cranny::shapes::{Cylinder, Torus};

const STEPS: usize = 240;

/// What a detector made of the scene.
struct Outcome {
    height: f32,
    /// The deepest overlap of any step.
    deepest: f64,
}

fn run(detector: Detector) -> Result<Outcome, Box<dyn Error>> {
    let ring = Torus { major_radius: 0.5, minor_radius: 0.1, ..Torus::default() }.build()?;
    let post = Cylinder { radius: 0.38, height: 1.0, ..Cylinder::default() }.build()?;
    let options = PluginOptions {
        detector,
        detects_beside: true, // ours too: all are judged by the same answers
        length_unit: Some(0.1),
        ..PluginOptions::default()
    };
    let effects = [Effect::Response, Effect::Contacts { margin: 0.0 }];
    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(1.0 / 240.0)?.options(&options).effects(&effects)?);
    let world = app.world_mut();
    world.spawn((RigidBody::Fixed, Collider::cuboid(4.0, 4.0, 0.2)?, Transform::default()));
    let place = Transform::from_xyz(0.0, 0.0, 0.6);
    world.spawn((RigidBody::Fixed, Collider::from_mesh(post)?, place));
    let place = Transform::from_xyz(0.0, 0.0, 1.3);
    let ring = world.spawn((RigidBody::Dynamic, Collider::from_mesh(ring)?, place)).id();
    let mut deepest = 0.0f64;
    for _ in 0..STEPS {
        world.run_schedule(CrannyStep);
        if let Some(failure) = world.resource_mut::<Failure>().take() {
            return Err(failure.into());
        }
        let report = world.resource::<ContactReport>();
        deepest = report.pairs.iter().map(|pair| pair.answer.depth()).fold(deepest, f64::max);
    }
    let height = world.get::<Transform>(ring).map_or(f32::NAN, |place| place.translation.z);
    Ok(Outcome { height, deepest })
}

fn main() -> Result<(), Box<dyn Error>> {
    for detector in Detector::ALL {
        let Outcome { height, deepest } = run(detector)?;
        let name = detector.name();
        println!("{name:<22} the ring ends at {height:.3}; deepest overlap {deepest:.4}");
        if detector == Detector::Cranny {
            assert!((height - 0.2).abs() < 0.01, "on the floor, around the post: {height}");
            assert!(deepest < 0.01, "{deepest}");
        }
    }
    Ok(())
}
