//! A hoop that counts what goes through it: a thin sensor fills the hole, and the hoop itself is
//! solid. Of three balls one goes through, one falls on the rim, one beside. z is up.
//!
//! `cargo run --example triggers --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;
use std::time::Duration;

use bevy_app::{App, Update};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cylinder, Sphere, Torus};

const STEP: f64 = 1.0 / 120.0;

#[derive(Component)]
struct Gate;

#[derive(Resource, Default)]
struct Score(Vec<String>);

fn main() -> Result<(), Box<dyn Error>> {
    let hoop = Torus { major_radius: 0.6, minor_radius: 0.1, ..Torus::default() }.build()?;
    let hole = Cylinder { radius: 0.4, height: 0.02, ..Cylinder::default() }.build()?;
    let ball = Collider::from_mesh(Sphere { radius: 0.15, ..Sphere::default() }.build()?)?;

    let mut app = App::new();
    app.add_plugins(TimePlugin);
    let cranny = CrannyPlugins::new(STEP)?.effects(&[Effect::Response])?;
    app.add_plugins(cranny.available(&[EffectKind::Trigger])?); // only sensors have it
    app.add_plugins(FixedUpdatePlugin).init_resource::<Score>();
    let world = app.world_mut();
    world.spawn((RigidBody::Fixed, Collider::from_mesh(hoop)?));
    world.spawn((Gate, Sensor, RigidBody::Fixed, Collider::from_mesh(hole)?));
    for (name, x) in [("straight", 0.0), ("on the rim", 0.62), ("wide", 1.5)] {
        let place = Transform::from_xyz(x, 0.0, 2.0);
        world.spawn((Name::new(name), RigidBody::Dynamic, ball.clone(), place));
    }
    app.add_systems(Update, score);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(STEP)));

    for _ in 0..=180 {
        app.update();
    }
    let scored = &app.world().resource::<Score>().0;
    println!("went through the hoop: {}", scored.join(", "));
    assert_eq!(*scored, ["straight"]);
    Ok(())
}

/// Whatever has begun to touch the gate and touches it no more.
fn score(
    mut ends: MessageReader<CollisionEnd>,
    gates: Query<(), With<Gate>>,
    names: Query<&Name>,
    mut score: ResMut<Score>,
) {
    for (_, ball) in ends.read().filter_map(|end| end.one_of(&gates)) {
        score.0.extend(names.get(ball).map(|name| name.as_str().to_owned()));
    }
}
