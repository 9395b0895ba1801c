//! An app that already runs on bevy, with a world of its own: a lift with a cup on it. Three plugins are added, and systems
//! of the app's own do the rest: one drives the lift, one drops a crate into the cup while the app runs, one hears
//! what begins to touch, one tells how things are.
//!
//! `cargo run --example bevy_app --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;
use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

use bevy_app::{App, FixedLast, FixedUpdate, Update};
use bevy_ecs::prelude::*;
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::ecs::{Failure, RigidBodies, RigidBody, transform_of};
use cranny::prelude::{BuildOptions, DVec3, Mesh, Model, Pose};
use cranny::rapier::{self, BodyIndex, BodySpec};
use cranny::shapes::{Cuboid, Cup};
use cranny::world::description::{
    BodyDescription, BodyKind, Effect, Material, Normals, RecordDescription, SceneDescription,
};

const STEP: f64 = 1.0 / 60.0;
/// Of the cup's floor, and half of the crate's edge: where the crate comes to rest above the cup's foot.
const FLOOR: f64 = 0.05;
const HALF: f64 = 0.1;

/// The crate: no body of the scene, so the app keeps its number in the solver.
#[derive(Component)]
struct Crate(BodyIndex);

/// What the crate is made of, prepared before it is needed.
#[derive(Resource)]
struct CrateModel(Model);

fn main() -> Result<(), Box<dyn Error>> {
    let crate_mesh = Cuboid { size: [2.0 * HALF; 3] }.build()?;
    let (crate_model, _) = Model::build(crate_mesh, &BuildOptions::default())?;

    let mut app = App::new();
    app.add_plugins(TimePlugin);
    app.add_plugins(CrannyPlugins::from_scene(&scene()?, &PluginOptions::default())?);
    app.add_plugins(FixedUpdatePlugin); // its steps are bevy's fixed steps
    app.insert_resource(CrateModel(crate_model));
    app.add_systems(FixedUpdate, (drive_lift, drop_crate)); // before the step of this tick
    app.add_systems(FixedLast, follow_crate); // after it
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

/// A lift that nothing moves but the app, and a cup on it. z is up.
fn scene() -> Result<SceneDescription, Box<dyn Error>> {
    let cup = Cup { radius: 0.4, height: 0.6, wall: 0.05, floor: FLOOR, segments: 48 }.build()?;
    let lift = Cuboid { size: [1.5, 1.5, 0.1] }.build()?;
    let body = |name: &str, mesh: Mesh, kind, z| BodyDescription {
        name: name.into(),
        collision: Arc::new(mesh),
        visual: None,
        kind,
        pose: Pose::at(DVec3::new(0.0, 0.0, z)),
        linear_velocity: DVec3::ZERO,
        angular_velocity: DVec3::ZERO,
        material: Material::default(),
        normals: Normals::Flat,
        layers: vec!["all".into()],
        effects: Vec::new(),
    };
    Ok(SceneDescription {
        name: "lift".into(),
        gravity: DVec3::new(0.0, 0.0, -9.81),
        step: STEP,
        duration: 4.0,
        seed: 0,
        bodies: vec![
            body("lift", lift, BodyKind::Kinematic, -0.05),
            body("cup", cup, BodyKind::Dynamic, 0.01),
        ],
        joints: Vec::new(),
        excluded_pairs: Vec::new(),
        effects: vec![Effect::Response, Effect::Trigger],
        pairs: Vec::new(),
        cameras: Vec::new(),
        record: RecordDescription::default(),
    })
}

fn named(bodies: &Bodies, name: &str) -> Option<Entity> {
    Some(bodies.get(bodies.find(name)?)?.entity)
}

/// Up and down once in two seconds. A velocity carries what stands on the lift; a `Transform` that the app sets
/// would teleport it.
fn drive_lift(
    time: Res<SimulatedTime>,
    bodies: Res<Bodies>,
    mut solver: ResMut<RigidBodies>,
    rigid: Query<&RigidBody>,
) {
    let lift = named(&bodies, "lift").and_then(|entity| rigid.get(entity).ok());
    if let Some(lift) = lift {
        let speed = 0.3 * (TAU * time.seconds() / 2.0).sin();
        let velocity = DVec3::new(0.0, 0.0, speed);
        solver.simulation_mut().set_velocity(lift.index, velocity, DVec3::ZERO);
    }
}

/// After a second, a crate half a metre above the cup.
fn drop_crate(
    time: Res<SimulatedTime>,
    model: Res<CrateModel>,
    mut solver: ResMut<RigidBodies>,
    mut commands: Commands,
) -> Result<(), BevyError> {
    if time.steps() != 60 {
        return Ok(());
    }
    let pose = Pose::at(DVec3::new(0.1, 0.05, 1.1));
    let index = solver.simulation_mut().insert(&BodySpec {
        model: &model.0,
        kind: rapier::BodyKind::Dynamic,
        pose,
        linear_velocity: DVec3::ZERO,
        angular_velocity: DVec3::ZERO,
        density: 1.0,
        friction: 0.5,
        restitution: 0.0,
        normals: Normals::Flat,
        groups: 1, // the scene's only layer
    })?;
    commands.spawn((Crate(index), transform_of(&pose)));
    println!("{:4.2} s: a crate is dropped", time.seconds());
    Ok(())
}

fn follow_crate(solver: Res<RigidBodies>, mut crates: Query<(&Crate, &mut Transform)>) {
    for (fallen, mut transform) in &mut crates {
        *transform = transform_of(&solver.simulation().pose(fallen.0));
    }
}

/// Messages tell of bodies of the scene; of the crate the solver's pairs do.
fn hear(
    time: Res<SimulatedTime>,
    bodies: Res<Bodies>,
    mut starts: MessageReader<CollisionStart>,
    solver: Res<RigidBodies>,
    crates: Query<&Crate>,
    mut landed: Local<bool>,
) {
    for start in starts.read() {
        let [a, b] = start.ids.map(|id| bodies.name(id));
        println!("{:4.2} s: {a} and {b} begin to touch", time.seconds());
    }
    let Ok(fallen) = crates.single() else { return };
    let pairs = solver.simulation().contact_pairs();
    let touches = |depth: f64| depth >= 0.0;
    let contacts = pairs
        .iter()
        .filter(|pair| pair.b == fallen.0)
        .flat_map(|pair| &pair.answer.contacts)
        .filter(|contact| touches(-contact.separation));
    let points = contacts.count();
    if points > 0 && !*landed {
        println!("{:4.2} s: the crate lands in the cup, at {points} points", time.seconds());
        *landed = true;
    }
}

fn tell(
    time: Res<SimulatedTime>,
    bodies: Res<Bodies>,
    places: Query<&Transform>,
    crates: Query<&Transform, With<Crate>>,
) {
    if time.steps() == 0 || time.steps() % 30 != 0 {
        return;
    }
    let height = |name| {
        let place = named(&bodies, name).and_then(|entity| places.get(entity).ok());
        place.map_or(f64::NAN, |place| place.translation.z.into())
    };
    let (lift, cup) = (height("lift") + 0.05, height("cup"));
    print!("{:4.2} s: lift at {lift:6.3}, cup {:6.3} above it", time.seconds(), cup - lift);
    match crates.single() {
        Ok(fallen) => {
            let above = f64::from(fallen.translation.z) - cup;
            println!(", crate {above:.3} above the cup's foot ({:.3} at rest)", FLOOR + HALF);
        }
        Err(_) => println!(),
    }
}
