//! A lift that a program drives carries what stands on it: a kinematic body moves by its velocity,
//! and nothing pushes it. z is up.
//!
//! `cargo run --example kinematic_lift --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;
use std::f32::consts::TAU;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Cup};

#[derive(Component)]
struct Lift;

/// Up and down once in two seconds. A `Transform` that is set would teleport it from its load.
fn drive(time: Res<SimulatedTime>, mut lift: Single<&mut LinearVelocity, With<Lift>>) {
    lift.0.z = 0.6 * (TAU * time.seconds() as f32 / 2.0).sin();
}

fn main() -> Result<(), Box<dyn Error>> {
    let platform = Collider::from_mesh(Cuboid { size: [2.0, 2.0, 0.2] }.build()?)?;
    let cup = Collider::from_mesh(Cup::default().build()?)?;

    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(1.0 / 120.0)?.effects(&[Effect::Response])?);
    app.add_systems(CrannyStep, drive.before(StepSystems::Admit));
    let world = app.world_mut();
    let place = Transform::from_xyz(0.0, 0.0, -0.1);
    let lift = world.spawn((Lift, RigidBody::Kinematic, platform, place)).id();
    let load = world.spawn((RigidBody::Dynamic, cup, Transform::default())).id();

    let height = |world: &World, body: Entity| {
        world.get::<Transform>(body).map_or(f32::NAN, |place| place.translation.z)
    };
    let (mut highest, mut worst) = (0.0_f32, 0.0_f32);
    for step in 0..480 {
        world.run_schedule(CrannyStep);
        let top = height(world, lift) + 0.1;
        let above = height(world, load) - top;
        (highest, worst) = (highest.max(top), worst.max(above.abs()));
        if step % 60 == 0 {
            println!("the lift is at {top:.3}, the cup {above:.4} above it");
        }
    }
    // It goes up by twice 0.6 over the circular frequency.
    assert!((highest - 2.0 * 0.6 / std::f32::consts::PI).abs() < 0.01, "{highest}");
    assert!(worst < 0.01, "the cup left the lift by {worst}");
    Ok(())
}
