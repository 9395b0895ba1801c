//! Bodies of several colliders.

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_world::description::{BodyColor, Effect};

use crate::build::{cuboid, empty, height, steps, unit, up, world};

fn record(app: &SceneApp, entity: Entity) -> BodyRecord {
    let world = app.app().world();
    let id = world.get::<Body>(entity).expect("a body").id;
    world.resource::<Bodies>().get(id).expect("a record").clone()
}

fn bodies(app: &SceneApp) -> usize {
    app.app().world().resource::<Bodies>().iter().count()
}

fn at(x: f32, y: f32, z: f32) -> Transform {
    Transform::from_xyz(x, y, z)
}

/// A table: a top, and four legs that abut on it, one of them below an entity between.
fn table(app: &mut SceneApp, place: Transform) -> (Entity, [Entity; 4]) {
    let (top, leg) = (cuboid([2.0, 2.0, 0.25]), cuboid([0.25, 0.25, 1.0]));
    let world = world(app);
    let table = world.spawn((RigidBody::Dynamic, top, place)).id();
    let between = world.spawn((at(0.75, 0.75, -0.625), ChildOf(table))).id();
    let mut legs = [(-0.75, -0.75), (0.75, -0.75), (-0.75, 0.75)]
        .map(|(x, y)| world.spawn((leg.clone(), at(x, y, -0.625), ChildOf(table))).id());
    let last = world.spawn((leg, Transform::IDENTITY, ChildOf(between))).id();
    legs.sort_unstable();
    (table, [legs[0], legs[1], legs[2], last])
}

#[cfg(feature = "rapier")]
#[test]
fn a_table_stands_on_its_legs_and_a_ball_rolls_below() {
    let mut app = empty(&[Effect::Response, Effect::TRIGGER]);
    world(&mut app).spawn((cuboid([9.0, 9.0, 1.0]), up(-0.5)));
    let (table, legs) = table(&mut app, up(1.2));
    let below = world(&mut app).spawn((RigidBody::Dynamic, cuboid([0.5; 3]), up(0.3))).id();
    steps(&mut app, 90);
    assert_eq!(bodies(&app), 3);
    assert!((height(&app, table) - 1.125).abs() < 0.01, "{}", height(&app, table));
    assert!((height(&app, below) - 0.25).abs() < 0.01, "its hull is full, the table is not");
    let world = app.app().world();
    assert!(legs.iter().all(|&leg| world.get::<ColliderOf>(leg).unwrap().body == table));
    assert!(legs.iter().all(|&leg| world.get::<Body>(leg).is_none()));
    let mass = record(&app, table).model().unwrap().mass_properties().unwrap().volume;
    assert!((mass - 1.25).abs() < 1e-9, "{mass}");
}

#[test]
fn parts_come_move_and_go() {
    let mut app = empty(&[]);
    let body = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    let part = world(&mut app).spawn((unit(), at(3.0, 0.0, 0.0), ChildOf(body))).id();
    steps(&mut app, 1);
    let reach = |app: &SceneApp| record(app, body).model().unwrap().bounds().max.x;
    assert_eq!((reach(&app), bodies(&app)), (3.5, 1));
    let first = record(&app, body).shape;

    world(&mut app).get_mut::<Transform>(part).unwrap().translation.x = 5.0;
    steps(&mut app, 1);
    assert_eq!(reach(&app), 5.5);
    world(&mut app).get_mut::<Transform>(part).unwrap().translation.x = 3.0;
    steps(&mut app, 1);
    assert_eq!(record(&app, body).model().unwrap().digest(), first.model().unwrap().digest());

    // Its own collider may go, as long as a part is left.
    world(&mut app).entity_mut(body).remove::<Collider>();
    steps(&mut app, 1);
    assert_eq!((record(&app, body).model().unwrap().bounds().min.x, bodies(&app)), (2.5, 1));
    world(&mut app).entity_mut(body).insert(unit());
    steps(&mut app, 1);

    // A part that is let go is a body of its own, and comes back as a part.
    world(&mut app).entity_mut(part).remove::<ChildOf>();
    steps(&mut app, 1);
    assert_eq!((reach(&app), bodies(&app)), (0.5, 2));
    assert!(app.app().world().get::<ColliderOf>(part).is_none());
    world(&mut app).entity_mut(part).insert(ChildOf(body));
    steps(&mut app, 1);
    assert_eq!((reach(&app), bodies(&app)), (3.5, 1));

    assert!(world(&mut app).despawn(part));
    steps(&mut app, 1);
    assert_eq!((reach(&app), bodies(&app)), (0.5, 1));
    let part = (unit(), at(0.0, 3.0, 0.0), ChildOf(body));
    let part = world(&mut app).spawn(part).id();
    steps(&mut app, 1);
    assert!(world(&mut app).despawn(body), "with its parts");
    assert!(world(&mut app).get_entity(part).is_err());
    steps(&mut app, 1);
    assert_eq!(bodies(&app), 0);
}

#[test]
fn a_part_goes_from_one_body_to_another_and_a_group_with_its_parts() {
    let mut app = empty(&[]);
    let [one, two] = [0.0, 20.0]
        .map(|y| world(&mut app).spawn((RigidBody::Fixed, unit(), at(0.0, y, 0.0))).id());
    let group = world(&mut app).spawn((at(3.0, 0.0, 0.0), ChildOf(one))).id();
    let part = world(&mut app).spawn((unit(), Transform::IDENTITY, ChildOf(group))).id();
    steps(&mut app, 1);
    let reach = |app: &SceneApp, body| record(app, body).model().unwrap().bounds().max.x;
    assert_eq!([one, two].map(|body| reach(&app, body)), [3.5, 0.5]);
    world(&mut app).entity_mut(group).insert(ChildOf(two));
    steps(&mut app, 1);
    assert_eq!([one, two].map(|body| reach(&app, body)), [0.5, 3.5]);
    assert_eq!(app.app().world().get::<ColliderOf>(part).unwrap().body, two);
    world(&mut app).entity_mut(part).insert(ChildOf(one));
    steps(&mut app, 1);
    assert_eq!([one, two].map(|body| reach(&app, body)), [0.5, 0.5]); // at its centre
    assert_eq!(app.app().world().get::<ColliderOf>(part).unwrap().body, one);
}

#[test]
fn a_body_of_parts_alone_may_be_spawned_before_the_plugins() {
    let mut app = bevy_app::App::new();
    let body = app.world_mut().spawn((RigidBody::Fixed, up(0.0))).id();
    let part = (unit(), at(2.0, 0.0, 0.0), ChildOf(body));
    app.world_mut().spawn(part);
    app.add_plugins(CrannyPlugins::new(0.25).unwrap());
    app.world_mut().run_schedule(CrannyStep);
    assert!(!app.world().resource::<Failure>().is_set());
    assert!(app.world().get::<Body>(body).is_some());
}

#[test]
fn bodies_of_the_same_parts_share_a_model_and_do_not_move_it() {
    let mut app = empty(&[]);
    let spawn = |app: &mut SceneApp, place: Transform| {
        let (body, _) = table(app, place);
        let moves = (RigidBody::Kinematic, LinearVelocity(Vec3::X));
        world(app).entity_mut(body).insert(moves);
        body
    };
    let turned = at(9.0, 0.0, 0.0).with_rotation(Quat::from_rotation_z(1.0));
    let [one, two] = [up(0.0), turned].map(|place| spawn(&mut app, place));
    steps(&mut app, 1);
    let model = record(&app, one).shape;
    assert!(model.is_same(&record(&app, two).shape));
    let before = app.app().world().get::<Transform>(one).unwrap().translation.x;
    steps(&mut app, 3);
    assert!(app.app().world().get::<Transform>(one).unwrap().translation.x > before);
    assert!(model.is_same(&record(&app, one).shape));
}

const ORANGE: BodyColor = BodyColor([208, 128, 48]);

/// Puts a rule beside a part.
type InsertRule = fn(&mut EntityWorldMut<'_>);

/// What is said beside a part is said of nobody: it is refused, there from the start or later.
#[test]
fn rules_of_a_part_are_refused_by_name() {
    let refused = |rule: InsertRule, late: bool| {
        let mut app = empty(&[Effect::TRIGGER]);
        let body = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
        let handle = (Name::new("handle"), unit(), up(3.0), ChildOf(body));
        let handle = world(&mut app).spawn(handle).id();
        if late {
            steps(&mut app, 1);
        }
        rule(&mut world(&mut app).entity_mut(handle));
        app.step().unwrap_err().to_string()
    };
    let rules: [(&str, InsertRule); 13] = [
        ("Painted", |part| _ = part.insert(Painted(ORANGE))),
        ("Sensor", |part| _ = part.insert(Sensor)),
        ("Trigger", |part| _ = part.insert(Trigger)),
        ("Proximity", |part| _ = part.insert(Proximity { within: 1.0 })),
        ("Contacts", |part| _ = part.insert(Contacts { margin: 0.0 })),
        ("Friction", |part| _ = part.insert(Friction::new(0.1))),
        ("Restitution", |part| _ = part.insert(Restitution::new(0.1))),
        ("Density", |part| _ = part.insert(Density(7.8))),
        ("LinearDamping", |part| _ = part.insert(LinearDamping(0.1))),
        ("ExternalForce", |part| _ = part.insert(ExternalForce::default())),
        ("LinearVelocity", |part| _ = part.insert(LinearVelocity(Vec3::X))),
        ("CollisionLayers", |part| _ = part.insert(CollisionLayers::shared(2))),
        ("SmoothNormals", |part| _ = part.insert(SmoothNormals { crease_angle: 0.4 })),
    ];
    for (name, rule) in rules {
        for late in [false, true] {
            let said = refused(rule, late);
            let wrong = format!("'handle' has a {name} of its own");
            assert!(said.contains(&wrong) && said.contains("beside the RigidBody"), "{said}");
        }
    }
}

#[test]
fn what_no_body_can_be_made_of_is_said() {
    // A body of its own below another body.
    let mut app = empty(&[]);
    let outer = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    world(&mut app).spawn((RigidBody::Dynamic, unit(), up(3.0), ChildOf(outer)));
    let refused = app.step().unwrap_err().to_string();
    assert!(refused.contains("is a child of another entity"), "{refused}");

    let mut app = empty(&[]);
    let outer = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    let large = up(3.0).with_scale(Vec3::splat(2.0));
    world(&mut app).spawn((Name::new("knob"), unit(), large, ChildOf(outer)));
    let refused = app.step().unwrap_err().to_string();
    assert!(refused.contains("'knob': its Transform has the scale [2, 2, 2]"), "{refused}");

    let mut app = empty(&[]);
    let outer = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    let far = at(f32::MAX, 0.0, 0.0);
    world(&mut app).spawn((unit(), far, ChildOf(outer)));
    let refused = app.step().unwrap_err().to_string();
    assert!(refused.contains("cannot be put together"), "{refused}");
}
