//! An app that already runs on bevy, with a world of its own: a lift with a cup on it. Two plugins
//! are added, and systems of the app's own do the rest: one drives the lift, one drops a crate into
//! the cup while the app runs, one hears what begins to touch, one says how things are. z is up.
//!
//! `cargo run --example bevy_app --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;
use std::f32::consts::TAU;
use std::time::Duration;

use bevy_app::{App, FixedUpdate, Startup, Update};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::shapes::{Cuboid, Cup};
use cranny::world::description::Effect;

const STEP: f64 = 1.0 / 60.0;
/// Of the cup's floor, and half of the crate's edge: where the crate comes to rest above the cup's
/// foot.
const FLOOR: f32 = 0.05;
const HALF: f32 = 0.1;

#[derive(Component)]
struct Lift;

/// What things are made of, prepared before it is needed.
#[derive(Resource)]
struct Shapes {
    lift: Collider,
    cup: Collider,
    crate_: Collider,
}

fn main() -> Result<(), Box<dyn Error>> {
    let cup = Cup { radius: 0.4, height: 0.6, wall: 0.05, floor: FLOOR.into(), segments: 48 };
    let cuboid = |size| Cuboid { size }.build();
    let shapes = Shapes {
        lift: Collider::from_mesh(cuboid([1.5, 1.5, 0.1])?)?,
        cup: Collider::from_mesh(cup.build()?)?,
        crate_: Collider::from_mesh(cuboid([2.0 * f64::from(HALF); 3])?)?,
    };
    // The thinnest thing that moves is a tenth of a metre thick or so.
    let options = PluginOptions { length_unit: Some(0.05), ..PluginOptions::default() };
    let cranny = CrannyPlugins::new(STEP)?.options(&options);

    let mut app = App::new();
    app.add_plugins(TimePlugin);
    app.add_plugins(cranny.effects(&[Effect::Response, Effect::Trigger])?);
    app.add_plugins(FixedUpdatePlugin); // its steps are bevy's fixed steps
    app.insert_resource(shapes);
    app.add_systems(Startup, set_up);
    app.add_systems(FixedUpdate, (drive_lift, drop_crate)); // before the step of this tick
    app.add_systems(Update, (hear, tell).chain());

    // An app with a window lets the wall clock run; here each update is a step, the first one none.
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(STEP)));
    for _ in 0..=240 {
        app.update();
        if let Some(failure) = app.world_mut().resource_mut::<Failure>().take() {
            return Err(failure.into());
        }
    }
    Ok(())
}

fn set_up(shapes: Res<Shapes>, mut commands: Commands) {
    let (lift, cup) = (shapes.lift.clone(), shapes.cup.clone());
    let at = |z| Transform::from_xyz(0.0, 0.0, z);
    commands.spawn((Name::new("lift"), Lift, RigidBody::Kinematic, lift, at(-0.05)));
    commands.spawn((Name::new("cup"), RigidBody::Dynamic, cup, at(0.01)));
}

/// Up and down once in two seconds. A velocity carries what stands on the lift; a `Transform` that
/// the app sets would teleport it.
fn drive_lift(time: Res<SimulatedTime>, mut lift: Single<&mut LinearVelocity, With<Lift>>) {
    lift.0.z = 0.3 * (TAU * time.seconds() as f32 / 2.0).sin();
}

/// After a second, a crate half a metre above the cup.
fn drop_crate(time: Res<SimulatedTime>, shapes: Res<Shapes>, mut commands: Commands) {
    if time.steps() == 60 {
        let place = Transform::from_xyz(0.1, 0.05, 1.1);
        let crate_ = shapes.crate_.clone();
        commands.spawn((Name::new("crate"), RigidBody::Dynamic, crate_, place));
        println!("{:4.2} s: a crate is dropped", time.seconds());
    }
}

fn hear(time: Res<SimulatedTime>, mut starts: MessageReader<CollisionStart>, names: Query<&Name>) {
    for start in starts.read() {
        if let Ok([a, b]) = names.get_many([start.body, start.other]) {
            println!("{:4.2} s: {a} and {b} begin to touch", time.seconds());
        }
    }
}

fn tell(time: Res<SimulatedTime>, places: Query<(&Name, &Transform)>) {
    if time.steps() == 0 || !time.steps().is_multiple_of(30) {
        return;
    }
    let height = |name: &str| {
        let place = places.iter().find(|(of, _)| of.as_str() == name);
        place.map(|(_, place)| place.translation.z)
    };
    let (Some(lift), Some(cup)) = (height("lift"), height("cup")) else { return };
    let lift = lift + 0.05;
    print!("{:4.2} s: lift at {lift:6.3}, cup {:6.3} above it", time.seconds(), cup - lift);
    match height("crate") {
        Some(fallen) => {
            let above = fallen - cup;
            println!(", crate {above:.3} above the cup's foot ({:.3} at rest)", FLOOR + HALF);
        }
        None => println!(),
    }
}
