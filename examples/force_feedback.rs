//! A stylus that a hand moves into a cup and along its inside: what the hand feels, at a thousand
//! ticks a second from sixty steps. z is up.
//!
//! `cargo run --example force_feedback --features ecs`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cup, Sphere};

const STEP: f64 = 1.0 / 60.0;
/// Newton a metre, say.
const STIFFNESS: f64 = 500.0;

/// Where the hand is after so many seconds: down into the cup, then against its wall and around.
fn hand(seconds: f32) -> Vec3 {
    let (down, around) = (seconds.min(1.0), (seconds - 1.5).max(0.0));
    let out = 0.5 * (seconds - 1.0).clamp(0.0, 1.0); // 0.1 beyond where the wall lets it
    Vec3::new(out * around.cos(), out * around.sin(), 2.0 - 1.5 * down)
}

fn main() -> Result<(), Box<dyn Error>> {
    let cup = Cup { radius: 0.55, height: 1.0, wall: 0.05, ..Cup::default() };
    let stylus = Sphere { radius: 0.1, ..Sphere::default() };

    let mut app = App::new();
    app.add_plugins(CrannyPlugins::new(STEP)?.available(&[EffectKind::ForceFeedback])?);
    let world = app.world_mut();
    world.spawn(Collider::from_mesh(cup.build()?)?);
    let felt = ForceFeedback { stiffness: STIFFNESS };
    let stylus = (RigidBody::Kinematic, Collider::from_mesh(stylus.build()?)?, felt);
    let stylus = world.spawn((stylus, Transform::from_translation(hand(0.0)))).id();

    let (mut before, mut greatest_jump) = (None, 0.0_f64);
    for step in 0..=240 {
        let seconds = step as f32 * STEP as f32;
        world.get_mut::<Transform>(stylus).ok_or("it is there")?.translation = hand(seconds);
        world.run_schedule(CrannyStep);
        let report = world.resource::<ForceFeedbackReport>();
        let ticks = &report.of(stylus).ok_or("it is felt")?.wrenches;
        for wrench in ticks {
            let jump = before.map_or(0.0, |before| wrench.force.distance(before));
            (before, greatest_jump) = (Some(wrench.force), greatest_jump.max(jump));
        }
        if step % 30 == 0 {
            let force = ticks.last().ok_or("there are ticks")?.force;
            println!("{seconds:.1} s, {} ticks: the force is {force:.1}", ticks.len());
        }
    }
    println!("from tick to tick it changes by {greatest_jump:.2} at most");
    // The hand moves by 0.0015 a tick at most, as it goes down.
    assert!(greatest_jump <= 1.5 * STIFFNESS * 1.5 * STEP / 17.0 * 1.01, "{greatest_jump}");
    let last = before.ok_or("there were ticks")?;
    assert!((40.0..60.0).contains(&last.length()), "{last}");
    Ok(())
}
