//! Rings that rain onto a peg: bodies come while the app runs, and go when they have fallen past
//! it. Those that the peg threads stay: a ring's hole is a hole. z is up.
//!
//! `cargo run --example spawn_despawn --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::{error::Error, time::Duration};

use bevy_app::{App, FixedUpdate};
use bevy_ecs::prelude::*;
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Torus};

const STEP: f64 = 1.0 / 60.0;

#[derive(Component)]
struct Ring;

#[derive(Resource)]
struct RingShape(Collider);

#[derive(Resource, Default)]
struct Fallen(u32);

fn main() -> Result<(), Box<dyn Error>> {
    let torus = Torus { major_radius: 0.4, minor_radius: 0.08, ..Torus::default() };
    let cuboid = |size| Ok::<_, Box<dyn Error>>(Collider::from_mesh(Cuboid { size }.build()?)?);
    let options = PluginOptions { length_unit: Some(0.08), ..PluginOptions::default() };

    let mut app = App::new();
    app.add_plugins(TimePlugin);
    app.add_plugins(CrannyPlugins::new(STEP)?.options(&options).effects(&[Effect::Response])?);
    app.add_plugins(FixedUpdatePlugin);
    app.insert_resource(RingShape(Collider::from_mesh(torus.build()?)?)).init_resource::<Fallen>();
    let world = app.world_mut();
    world.spawn((RigidBody::Fixed, cuboid([3.0, 3.0, 0.2])?, Transform::from_xyz(0.0, 0.0, -0.1)));
    world.spawn((RigidBody::Fixed, cuboid([0.3, 0.3, 2.0])?, Transform::from_xyz(0.0, 0.0, 1.0)));
    app.add_systems(FixedUpdate, (rain, clear));
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(STEP)));

    for _ in 0..=360 {
        app.update();
    }
    let fallen = app.world().resource::<Fallen>().0;
    let mut rings = app.world_mut().query_filtered::<&Transform, With<Ring>>();
    let away = |ring: &Transform| ring.translation.truncate().length();
    let threaded = rings.iter(app.world()).filter(|ring| away(ring) < 0.3).count();
    println!("{threaded} rings are on the peg, {fallen} fell past the plate and are gone");
    assert!(threaded >= 2 && fallen >= 1);
    Ok(())
}

/// Every half second a ring, every other one beside the peg.
fn rain(time: Res<SimulatedTime>, shape: Res<RingShape>, mut commands: Commands) {
    let (number, rest) = (time.steps() / 30, time.steps() % 30);
    if rest == 0 && number < 6 {
        let x = if number % 2 == 0 { 0.05 } else { 2.5 };
        let place = Transform::from_xyz(x, 0.02, 2.4);
        commands.spawn((Ring, RigidBody::Dynamic, shape.0.clone(), place));
    }
}

fn clear(
    rings: Query<(Entity, &Transform), With<Ring>>,
    mut fallen: ResMut<Fallen>,
    mut commands: Commands,
) {
    for (ring, _) in rings.iter().filter(|(_, place)| place.translation.z < -2.0) {
        commands.entity(ring).despawn();
        fallen.0 += 1;
    }
}
