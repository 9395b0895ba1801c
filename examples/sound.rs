//! What is to be heard of a ball that is thrown along a floor: it lands, slides, rolls. An app
//! would play a sample an event, and loop what goes on in `OngoingSounds`. z is up.
//!
//! `cargo run --example sound --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Sphere};

fn main() -> Result<(), Box<dyn Error>> {
    let floor = Collider::from_mesh(Cuboid { size: [60.0, 8.0, 1.0] }.build()?)?;
    let ball =
        Collider::from_mesh(Sphere { segments: 96, rings: 48, ..Sphere::default() }.build()?)?;

    let mut app = App::new();
    let cranny = CrannyPlugins::new(1.0 / 120.0)?.effects(&[Effect::Response])?;
    app.add_plugins(cranny.available(&[EffectKind::Sound])?);
    let world = app.world_mut();
    world.spawn((floor, Transform::from_xyz(0.0, 0.0, -0.5)));
    let thrown = (Transform::from_xyz(-20.0, 0.0, 0.8), LinearVelocity(Vec3::new(5.0, 0.0, 0.0)));
    let smooth = SmoothNormals { crease_angle: 1.0 }; // the facets stand for a round ball
    world.spawn((RigidBody::Dynamic, ball, thrown, smooth, Sound { above: 0.3 }));

    let mut heard = Vec::new();
    for step in 0..360 {
        world.run_schedule(CrannyStep);
        for sound in world.resource_mut::<Messages<SoundEvent>>().drain() {
            let SoundEvent { kind, speed, impulse, area, .. } = sound;
            let seconds = f64::from(step) / 120.0;
            println!(
                "{seconds:.2} s: {kind:?} at {speed:.2}, impulse {impulse:.3}, area {area:.4}"
            );
            heard.push(kind);
        }
    }
    assert_eq!(heard, [SoundKind::Impact, SoundKind::Slide, SoundKind::Roll]);
    let ongoing = &world.resource::<OngoingSounds>().sounds;
    println!("at the end {} sound goes on: {:?}", ongoing.len(), ongoing[0].kind);
    Ok(())
}
