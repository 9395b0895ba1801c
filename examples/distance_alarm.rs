//! An arm that slows down before it hits: `Proximity` says how near the nearest body is and how
//! fast it comes nearer; nothing pushes, and no solver is there. z is up.
//!
//! `cargo run --example distance_alarm --features ecs`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Cup};

const STEP: f64 = 1.0 / 60.0;
/// It looks this far ahead, and keeps this far away.
const SEEN: f64 = 1.0;
const KEPT: f64 = 0.1;

#[derive(Component)]
struct Arm;

fn main() -> Result<(), Box<dyn Error>> {
    let cup = Collider::from_mesh(Cup::default().build()?)?;
    let finger = Collider::from_mesh(Cuboid { size: [0.1, 0.1, 1.0] }.build()?)?;

    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(STEP)?.available(&[EffectKind::Proximity])?);
    app.add_systems(
        CrannyStep,
        slow_down.in_set(StepSystems::Report).after(ProximitySystems::Report),
    );
    let world = app.world_mut();
    world.spawn(cup);
    // It comes down into the cup, where its hull would have stopped it at the rim.
    let moving = (RigidBody::Kinematic, LinearVelocity(Vec3::new(0.0, 0.0, -0.8)));
    let start = Transform::from_xyz(0.0, 0.0, 3.0);
    let arm = world.spawn((Arm, Proximity { within: SEEN }, moving, finger, start)).id();

    for step in 0..=480 {
        world.run_schedule(CrannyStep);
        if step % 60 == 0 {
            let at = world.get::<Transform>(arm).ok_or("the arm is there")?.translation.z;
            let nearest = world.resource::<ProximityReport>().nearest(arm);
            let said = nearest.map_or("nothing near".to_owned(), |n| {
                format!("{:.3} away, {:.3} a second nearer", n.distance, n.speed.unwrap_or(0.0))
            });
            println!("{:.0} s: z = {at:.2}, {said}", f64::from(step) * STEP);
        }
    }
    let nearest = world.resource::<ProximityReport>().nearest(arm).ok_or("the cup is near")?;
    assert!((KEPT * 0.9..KEPT * 1.5).contains(&nearest.distance), "{nearest:?}");
    Ok(())
}

/// No faster than it can stop within what is left.
fn slow_down(
    report: Res<ProximityReport>,
    mut arms: Query<(Entity, &mut LinearVelocity), With<Arm>>,
) {
    for (arm, mut velocity) in &mut arms {
        if let Some(nearest) = report.nearest(arm) {
            let allowed = (2.0 * (nearest.distance - KEPT).max(0.0)) as f32;
            velocity.0 = velocity.0.clamp_length_max(allowed);
        }
    }
}
