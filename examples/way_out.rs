//! Bodies that overlap, and no solver: `Penetration` says how deep and by which way out, and the
//! app moves them itself, a share of the way in each step. z is up.
//!
//! `cargo run --example way_out --features ecs`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Hook, Torus};

/// Moves the later body of each pair half of its way, and a little on.
fn push_apart(report: Res<PenetrationReport>, mut places: Query<&mut Transform>) {
    for pair in &report.pairs {
        if let Ok(mut place) = places.get_mut(pair.other) {
            let way = 0.5 * pair.way + 1e-3 * pair.way.normalize_or_zero();
            place.translation += Vec3::new(way.x as f32, way.y as f32, way.z as f32);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let hook = Collider::from_mesh(Hook::default().build()?)?;
    let ring = Collider::from_mesh(Torus::default().build()?)?;

    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(1.0 / 60.0)?.available(&[EffectKind::Penetration])?);
    // After the step: within it every `Transform` stays what it was.
    app.add_systems(CrannyStep, push_apart.after(StepSystems::Advance));
    let world = app.world_mut();
    world.spawn((hook, Penetration));
    let place = Transform::from_xyz(0.5, 0.0, 0.05);
    world.spawn((RigidBody::Kinematic, ring, place));

    let mut overlapping = 0;
    for step in 0..30 {
        world.run_schedule(CrannyStep);
        let Some(pair) = world.resource::<PenetrationReport>().pairs.first() else { break };
        println!("step {step}: {:.4} deep, {:.3} is the way", pair.depth.unwrap_or(0.0), pair.way);
        overlapping += 1;
    }
    println!("after {overlapping} steps they are apart");
    assert!((1..30).contains(&overlapping));
    Ok(())
}
