//! An app that runs on bevy, with a world and a clock of its own: plugins are added, and systems do
//! the rest. One drops a crate into a cup while the app runs, one hears what begins to touch, one
//! says how things are. z is up.
//!
//! `cargo run --example bevy_app --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::{error::Error, time::Duration};

use bevy_app::{App, FixedUpdate, Startup, Update};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Cup};

const STEP: f64 = 1.0 / 60.0;

/// What things are made of, prepared before it is needed.
#[derive(Resource)]
struct Shapes {
    cup: Collider,
    crate_: Collider,
}

fn main() -> Result<(), Box<dyn Error>> {
    let cup = Cup { radius: 0.4, height: 0.6, wall: 0.05, floor: 0.05, segments: 48 };
    let cup = Collider::from_mesh(cup.build()?)?;
    let crate_ = Collider::from_mesh(Cuboid { size: [0.2; 3] }.build()?)?;
    let cranny = CrannyPlugins::new(STEP)?.effects(&[Effect::Response, Effect::TRIGGER])?;

    let mut app = App::new();
    // The steps of the last plugin are bevy's fixed steps.
    app.add_plugins(TimePlugin).add_plugins(cranny).add_plugins(FixedUpdatePlugin);
    app.insert_resource(Shapes { cup, crate_ });
    app.add_systems(Startup, set_up);
    app.add_systems(FixedUpdate, drop_crate); // before the step of this tick
    app.add_systems(Update, (hear, tell).chain());

    // An app with a window lets the wall clock run; here each update is a step, the first one none.
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(STEP)));
    for _ in 0..=180 {
        app.update();
    }
    Ok(())
}

fn set_up(shapes: Res<Shapes>, mut commands: Commands) {
    commands.spawn((Name::new("cup"), shapes.cup.clone())); // without a RigidBody it is fixed
}

/// After a second, a crate half a metre above the cup.
fn drop_crate(time: Res<SimulatedTime>, shapes: Res<Shapes>, mut commands: Commands) {
    if time.steps() == 60 {
        let place = Transform::from_xyz(0.1, 0.05, 1.1);
        commands.spawn((Name::new("crate"), RigidBody::Dynamic, shapes.crate_.clone(), place));
    }
}

fn hear(time: Res<SimulatedTime>, mut starts: MessageReader<CollisionStart>, names: Query<&Name>) {
    for [a, b] in starts.read().filter_map(|at| names.get_many([at.body, at.other]).ok()) {
        println!("{:4.2} s: {a} and {b} begin to touch", time.seconds());
    }
}

fn tell(time: Res<SimulatedTime>, dynamic: Query<(&Name, &Transform), With<RigidBody>>) {
    for (name, place) in dynamic.iter().filter(|_| time.steps().is_multiple_of(30)) {
        println!("{:4.2} s: {name} is at {:.3}", time.seconds(), place.translation);
    }
}
