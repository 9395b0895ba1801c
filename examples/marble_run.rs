//! A marble run without a window. Marbles, of which one is a primitive, roll down a gutter, ride a
//! belt uphill, go round a bend and drop into a cup. Gates on the way give points. When all marbles
//! sleep in the cup, the app prints the score and exits. z is up.
//!
//! `cargo run --example marble_run --features ecs,rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::{collections::BTreeSet, error::Error, f64::consts::PI, time::Duration};

use bevy_app::{App, AppExit, FixedUpdate};
use bevy_ecs::{name::Name, prelude::*, system::SystemParam};
use bevy_math::{Quat, Vec3};
use bevy_time::{TimePlugin, TimeUpdateStrategy};
use bevy_transform::components::Transform;
use cranny::ecs::prelude::*;
use cranny::exact::DVec3;
use cranny::geometry::{BuildOptions, Mesh, Model};
use cranny::shapes::{Boxes, Cuboid, Cup, Cylinder, GolfBall};

const STEP: f64 = 1.0 / 240.0;
const RADIUS: f64 = 0.1;
const CUP: Cup = Cup { radius: 0.7, height: 1.0, wall: 0.06, floor: 0.06, segments: 64 };
const CUP_AT: Vec3 = Vec3::new(1.75, 2.4, 0.28);

#[derive(Component)]
struct Marble;

/// A gate, and what it is worth.
#[derive(Component)]
struct Points(u32);

/// How the surface of a body moves, world axes.
#[derive(Component)]
struct Belt(Vec3);
#[derive(Resource, Default)]
struct Score {
    points: u32,
    passed: BTreeSet<(Entity, Entity)>,
}

#[derive(SystemParam)]
struct Belts<'w, 's> {
    belts: Query<'w, 's, &'static Belt>,
}

impl CollisionHooks for Belts<'_, '_> {
    fn modify_contacts(&self, contacts: &mut SolverContacts<'_, '_>) -> bool {
        if let Some((belt, _)) = contacts.one_of(&self.belts) {
            contacts.drive(belt, self.belts.get(belt).map_or(Vec3::ZERO, |belt| belt.0));
        }
        true
    }
}

/// A gutter with a square section along +x. Origin: the middle of its floor's beginning.
fn gutter(length: f64, width: f64) -> Result<Collider, Box<dyn Error>> {
    let (inner, outer) = (width / 2.0, width / 2.0 + 0.08);
    let add = vec![[[0.0, -outer, -0.1], [length, outer, 0.25]]];
    let cut = vec![[[0.0, -inner, 0.0], [length, inner, 0.25]]];
    Ok(Collider::from_mesh(Boxes { add, cut }.build()?)?)
}

/// A half turn to the left of a round channel that begins along +x and sinks by `drop`. Its outer
/// side leans over. Origin: the middle of its floor's beginning.
fn bend(radius: f64, drop: f64, inner: f64, wall: f64) -> Result<Collider, Box<dyn Error>> {
    const ALONG: u32 = 64;
    const AROUND: u32 = 20;
    const RING: u32 = 2 * (AROUND + 1); // the section: its outside there, its inside back
    let mut vertices = Vec::new();
    for station in 0..=ALONG {
        let t = f64::from(station) / f64::from(ALONG);
        let out = DVec3::new((PI * t).sin(), -(PI * t).cos(), 0.0); // from the axis of the turn
        let middle = DVec3::new(0.0, radius, inner - drop * t) + out * radius;
        vertices.extend((0..RING).map(|j| {
            let (i, r) = if j <= AROUND { (j, inner + wall) } else { (RING - 1 - j, inner) };
            let angle = 1.25 * PI * f64::from(i) / f64::from(AROUND); // 0: towards the axis
            middle - (out * angle.cos() + DVec3::Z * angle.sin()) * r
        }));
    }
    let at = |station: u32, j: u32| station * RING + j % RING;
    let mut faces = Vec::new();
    let mut quad = |[a, b, c, d]: [u32; 4]| faces.extend([[a, b, c], [a, c, d]]);
    for (s, j) in (0..ALONG).flat_map(|s| (0..RING).map(move |j| (s, j))) {
        quad([at(s, j), at(s + 1, j), at(s + 1, j + 1), at(s, j + 1)]);
    }
    for (i, j) in (0..AROUND).map(|i| (i, RING - 1 - i)) {
        quad([at(0, i), at(0, i + 1), at(0, j - 1), at(0, j)]);
        quad([at(ALONG, j), at(ALONG, j - 1), at(ALONG, i + 1), at(ALONG, i)]);
    }
    let (model, report) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
    assert!(report.closed && model.mass_properties().is_some_and(|mass| mass.volume > 0.0));
    Ok(Collider::from(model))
}

fn main() -> Result<(), Box<dyn Error>> {
    let cranny = CrannyPlugins::new(STEP)?.effects(&[Effect::Response])?;
    let cranny = cranny.available(&[EffectKind::Trigger])?.hooks::<Belts>();
    let options = PluginOptions { length_unit: Some(RADIUS), ..PluginOptions::default() };
    let mut app = App::new();
    app.add_plugins(TimePlugin).add_plugins(cranny.options(&options));
    app.add_plugins(FixedUpdatePlugin).init_resource::<Score>();
    lay_tracks(app.world_mut())?;
    app.add_systems(FixedUpdate, come_to_rest).add_observer(score);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(STEP)));
    while app.should_exit().is_none() {
        app.update();
    }
    let mut marbles = app.world_mut().query_filtered::<&Transform, With<Marble>>();
    assert_eq!(marbles.iter(app.world()).filter(|place| is_in_cup(place)).count(), 3);
    let score = app.world().resource::<Score>();
    println!("score: {}", score.points);
    assert_eq!(score.points, 3 * (10 + 20 + 50));
    Ok(())
}

fn lay_tracks(world: &mut World) -> Result<(), Box<dyn Error>> {
    let tilt = Quat::from_rotation_y;
    let start = Transform::from_xyz(0.0, 0.0, 2.0).with_rotation(tilt(0.15));
    world.spawn((Name::new("start"), gutter(2.0, 0.3)?, start));
    let ramp = Transform::from_xyz(2.0, 0.0, 1.67).with_rotation(tilt(-0.06));
    let belt = Belt(ramp.rotation * Vec3::X * 2.5);
    world.spawn((Name::new("belt"), gutter(1.5, 0.3)?, ramp, belt));
    let bend = (bend(1.2, 0.35, 0.25, 0.07)?, SmoothNormals { crease_angle: 0.4 });
    world.spawn((Name::new("bend"), bend, Transform::from_xyz(3.52, 0.0, 1.73)));
    let back = Transform::from_xyz(3.5, 2.4, 1.36).with_rotation(Quat::from_rotation_z(PI as f32));
    world.spawn((Name::new("back"), gutter(1.0, 0.56)?, back));
    let cup = (Collider::from_mesh(CUP.build()?)?, Transform::from_translation(CUP_AT));
    world.spawn((Name::new("cup"), cup));

    let ball = GolfBall { radius: RADIUS, dimples: 0, triangles: 1280, ..GolfBall::default() };
    let ball = Collider::from_mesh(ball.build()?)?;
    let marbles = [(1.2, ball.clone()), (0.7, Collider::ball(RADIUS)), (0.2, ball)];
    for ((x, ball), name) in marbles.into_iter().zip(["Ann", "Bob", "Cid"]) {
        let place = start * Transform::from_xyz(x, 0.02, RADIUS as f32);
        world.spawn((Name::new(name), Marble, RigidBody::Dynamic, ball, place));
    }

    let mut gate = |name, points, mesh, place| {
        let body = (Sensor, Collider::from_mesh(mesh)?, place); // a sensor brings a trigger along
        world.spawn((Name::new(name), Points(points), body));
        Ok::<_, Box<dyn Error>>(())
    };
    let across = Cuboid { size: [0.02, 0.28, 0.24] }.build()?;
    gate("gate", 10, across, start * Transform::from_xyz(1.5, 0.0, 0.125))?;
    let around = Cuboid { size: [0.5, 0.02, 0.5] }.build()?;
    gate("halfway", 20, around, Transform::from_xyz(4.72, 1.2, 1.805))?;
    let mouth = Cylinder { radius: 0.6, height: 0.02, ..Cylinder::default() }.build()?;
    gate("mouth", 50, mouth, Transform::from_translation(CUP_AT + Vec3::Z * 0.9))
}

/// Each of two bodies hears of a collision as `body`; here only gates are watched.
fn score(
    hit: On<CollisionStart>,
    time: Res<SimulatedTime>,
    gates: Query<(&Points, &Name)>,
    marbles: Query<&Name, With<Marble>>,
    mut score: ResMut<Score>,
) {
    if let (Ok((points, gate)), Ok(name)) = (gates.get(hit.body), marbles.get(hit.other))
        && score.passed.insert((hit.body, hit.other))
    {
        score.points += points.0;
        println!("{:5.2} s: {name} passes the {gate}: {}", time.seconds(), score.points);
    }
}

fn is_in_cup(marble: &Transform) -> bool {
    let (at, inside) = (marble.translation - CUP_AT, (CUP.radius - CUP.wall) as f32);
    at.truncate().length() < inside && (0.0..CUP.height as f32).contains(&at.z)
}

/// Felt lines the cup. The run is over when all marbles sleep in it, or after a minute.
fn come_to_rest(
    time: Res<SimulatedTime>,
    marbles: Query<(Entity, &Transform, Has<Sleeping>), With<Marble>>,
    mut commands: Commands,
    mut exit: MessageWriter<AppExit>,
) {
    for (marble, place, _) in &marbles {
        if is_in_cup(place) {
            commands.entity(marble).insert((LinearDamping(2.4), AngularDamping(2.4)));
        }
    }
    if marbles.iter().all(|(_, place, sleeps)| is_in_cup(place) && sleeps) {
        println!("{:5.2} s: all marbles sleep in the cup", time.seconds());
        exit.write(AppExit::Success);
    } else if time.seconds() > 60.0 {
        exit.write(AppExit::error()); // the assertion below the loop fails
    }
}
