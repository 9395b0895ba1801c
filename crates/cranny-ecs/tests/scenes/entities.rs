//! Bodies as entities: spawned, changed and despawned while the app runs.

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_ecs::system::RunSystemOnce;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_world::description::{BodyKind, Effect, Motor, StatedMass};

use crate::build::{
    cube, cuboid, drop, empty, gate, height, messages, scene, steps, unit, up, world,
};

const CONTACTS: Effect = Effect::Contacts { margin: 0.005 };

/// A fixed unit cube, and another that rests on it.
#[cfg(feature = "rapier")]
fn stack(app: &mut SceneApp) -> [Entity; 2] {
    let world = world(app);
    let unit = unit();
    let floor = world.spawn((RigidBody::Fixed, unit.clone(), up(0.0))).id();
    let upper = world.spawn((RigidBody::Dynamic, unit, up(1.01))).id();
    steps(app, 64);
    assert!((height(app, upper) - 1.0).abs() < 0.01, "{}", height(app, upper));
    [floor, upper]
}

#[cfg(feature = "rapier")]
#[test]
fn a_body_that_is_spawned_while_the_app_runs_falls_and_rests_and_is_reported_as_all_are() {
    let mut app = empty(&[Effect::Response, Effect::TRIGGER, CONTACTS]);
    steps(&mut app, 3);
    let [floor, upper] = stack(&mut app);
    let third =
        world(&mut app).spawn((Name::new("third"), RigidBody::Dynamic, unit(), up(2.2))).id();
    let mut touched = Vec::new();
    for _ in 0..64 {
        steps(&mut app, 1);
        touched.extend(messages::<CollisionStart>(&app).iter().map(|m| [m.body, m.other]));
    }
    touched.dedup(); // it bounces a little
    assert_eq!(touched, [[upper, third]]);
    assert!((height(&app, third) - 2.0).abs() < 0.01);
    let world = world(&mut app);
    assert_eq!(world.get::<TouchingBodies>(upper).unwrap().len(), 2);
    assert_eq!(world.get::<BodyContacts>(third).unwrap().partners, 1);
    let bodies = world.resource::<Bodies>();
    let names: Vec<&str> = bodies.iter().map(|(_, record)| &*record.name).collect();
    assert_eq!(names, ["body#0", "body#1", "third"]);
    // The solver's answers serve all: nothing is detected a second time.
    let stats = world.resource::<Detected>().report.as_ref().unwrap().stats;
    assert_eq!((stats.supplied_pairs, stats.queried_pairs), (2, 0));

    assert!(world.despawn(floor));
    steps(&mut app, 1);
    assert_eq!(messages::<CollisionEnd>(&app)[0].body, floor);
    steps(&mut app, 63);
    assert!(height(&app, upper) < -1.0);
    let summary = app.finish().unwrap();
    assert!(summary.energy_drift.unwrap() < 0.05, "{:?}", summary.energy);
}

#[cfg(feature = "rapier")]
#[test]
fn a_scene_and_the_same_bodies_spawned_by_hand_end_in_the_same_state() {
    let effects = [Effect::Response, Effect::TRIGGER];
    let mut described = drop(&effects);
    described.bodies[1].linear_velocity = DVec3::new(0.5, 0.0, 0.0);
    described.bodies[1].material.friction = 0.25;
    let plugins = PluginOptions { length_unit: Some(1.0 / 3.0), ..PluginOptions::default() };
    let options = RunOptions { plugins, ..RunOptions::default() };
    let mut by_file = SceneApp::new(&described, &options).unwrap();
    steps(&mut by_file, 60);

    let mut by_hand = empty(&effects);
    let unit = unit();
    world(&mut by_hand).spawn((RigidBody::Fixed, unit.clone(), up(0.0)));
    world(&mut by_hand).spawn((
        RigidBody::Dynamic,
        unit,
        Transform::from_xyz(0.125, 0.0, 1.25),
        LinearVelocity(Vec3::new(0.5, 0.0, 0.0)),
        Friction::new(0.25),
    ));
    steps(&mut by_hand, 60);

    let mut by_command = empty(&effects);
    let spawn = SpawnScene::new(&described).unwrap();
    world(&mut by_command).commands().queue(spawn);
    steps(&mut by_command, 60);

    let [a, b, c] = [by_file, by_hand, by_command].map(|app| app.finish().unwrap().state_hash);
    assert_eq!((&a, &a), (&b, &c));
}

#[cfg(feature = "rapier")]
#[test]
fn a_scene_may_be_spawned_again_elsewhere() {
    let mut app = SceneApp::new(&drop(&[Effect::Response]), &RunOptions::default()).unwrap();
    let mut described = drop(&[Effect::Response]);
    for body in &mut described.bodies {
        body.pose.translation.x += 5.0;
    }
    let more = SpawnScene::new(&described).unwrap().spawn(world(&mut app));
    steps(&mut app, 60);
    assert!((height(&app, more[1]) - 1.0).abs() < 0.01);
    let names = app.app().world().resource::<Bodies>();
    assert_eq!(names.name(BodyId(3)), "box#3", "names stay unique");
}

#[cfg(feature = "rapier")]
#[test]
fn what_is_written_counts_in_the_next_step() {
    let mut app = empty(&[Effect::Response]);
    let [floor, upper] = stack(&mut app);
    // Another geometry.
    world(&mut app).entity_mut(upper).insert(cuboid([1.0, 1.0, 2.0]));
    steps(&mut app, 64);
    assert!((height(&app, upper) - 1.5).abs() < 0.02, "{}", height(&app, upper));
    let mass = |app: &SceneApp| {
        let solved = app.app().world().get::<SolverBody>(upper).unwrap().index;
        app.app().world().resource::<RigidBodies>().simulation().mass(solved)
    };
    assert!((mass(&app) - 2.0).abs() < 1e-5);
    world(&mut app).entity_mut(upper).insert(Density(3.0));
    steps(&mut app, 1);
    assert!((mass(&app) - 6.0).abs() < 1e-5);
    world(&mut app).entity_mut(upper).remove::<Density>();
    steps(&mut app, 1);
    assert!((mass(&app) - 2.0).abs() < 1e-5, "a component that goes means its default");
    // An impulse acts once.
    let impulse = Vec3::new(0.0, 0.0, 8.0);
    world(&mut app).entity_mut(upper).insert(ExternalImpulse { impulse, ..Default::default() });
    steps(&mut app, 2);
    let speed = app.app().world().get::<LinearVelocity>(upper).unwrap().0.z;
    assert!((3.0..4.0).contains(&speed), "{speed}");
    assert_eq!(*app.app().world().get::<ExternalImpulse>(upper).unwrap(), Default::default());
    // A velocity, written in place; no gravity; locked axes.
    world(&mut app).get_mut::<LinearVelocity>(upper).unwrap().0 = Vec3::new(1.0, 0.0, 1.0);
    let held =
        LockedAxes { translation: bevy_math::BVec3::new(true, false, false), ..Default::default() };
    world(&mut app).entity_mut(upper).insert((GravityScale(0.0), held));
    steps(&mut app, 1);
    let at = app.app().world().get::<Transform>(upper).unwrap().translation;
    steps(&mut app, 16);
    let moved = app.app().world().get::<Transform>(upper).unwrap().translation - at;
    assert!((moved - Vec3::new(0.0, 0.0, 0.25)).length() < 1e-3, "{moved}");
    // A force against gravity.
    world(&mut app).entity_mut(upper).insert((
        GravityScale(1.0),
        LinearVelocity::default(),
        ExternalForce { force: Vec3::new(0.0, 0.0, 20.0), ..Default::default() },
    ));
    let before = height(&app, upper);
    steps(&mut app, 16);
    assert!((height(&app, upper) - before).abs() < 1e-3);
    // Kinematic; and a floor that begins to fall.
    let start = app.app().world().get::<Transform>(upper).unwrap().translation;
    world(&mut app).entity_mut(upper).insert((RigidBody::Kinematic, LinearVelocity(Vec3::Y)));
    steps(&mut app, 64);
    let at = app.app().world().get::<Transform>(upper).unwrap().translation;
    assert!((at - start - Vec3::Y).length() < 1e-2, "{start} to {at}");
    world(&mut app).entity_mut(floor).insert(RigidBody::Dynamic);
    steps(&mut app, 64);
    assert!(height(&app, floor) < -3.0);
    world(&mut app).resource_mut::<Gravity>().0 = DVec3::ZERO;
    let speed = app.app().world().get::<LinearVelocity>(floor).unwrap().0;
    steps(&mut app, 16);
    assert_eq!(app.app().world().get::<LinearVelocity>(floor).unwrap().0, speed);
}

#[cfg(feature = "rapier")]
#[test]
fn friction_and_restitution_are_components() {
    let slide = |friction: f32, restitution: f32| {
        let mut app = empty(&[Effect::Response]);
        let material = (Friction::new(friction), Restitution::new(restitution));
        let plate = cuboid([40.0, 40.0, 1.0]);
        world(&mut app).spawn((RigidBody::Fixed, plate, up(-0.5), material));
        let start = Transform::from_xyz(0.0, 0.0, 1.5);
        let velocity = LinearVelocity(Vec3::new(2.0, 0.0, 0.0));
        let body =
            world(&mut app).spawn((RigidBody::Dynamic, unit(), start, velocity, material)).id();
        let mut lowest = f32::INFINITY;
        let mut rebound = 0.0f32;
        for _ in 0..80 {
            steps(&mut app, 1);
            lowest = lowest.min(height(&app, body));
            if lowest < 0.55 {
                rebound = rebound.max(height(&app, body));
            }
        }
        (app.app().world().get::<Transform>(body).unwrap().translation.x, rebound)
    };
    let (smooth, rough) = (slide(0.0, 0.0), slide(0.8, 0.0));
    assert!(smooth.0 > 2.0 && rough.0 < 1.7, "{smooth:?} {rough:?}");
    assert!(slide(0.0, 0.9).1 > 0.9 && smooth.1 < 0.6);
}

#[cfg(feature = "rapier")]
#[test]
fn a_sensor_is_noticed_and_pushes_nothing() {
    let mut app = empty(&[Effect::Response, Effect::TRIGGER]);
    let gate = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0), Sensor)).id();
    let ball = world(&mut app).spawn((RigidBody::Dynamic, unit(), up(2.0))).id();
    let (mut starts, mut ends) = (Vec::new(), Vec::new());
    for _ in 0..64 {
        steps(&mut app, 1);
        starts.extend(messages::<CollisionStart>(&app));
        ends.extend(messages::<CollisionEnd>(&app));
    }
    assert_eq!((starts.len(), ends.len()), (1, 1));
    assert_eq!([starts[0].body, starts[0].other], [gate, ball]);
    assert!(height(&app, ball) < -2.0);
    // A body that is a sensor no more holds what comes next.
    world(&mut app).entity_mut(gate).remove::<Sensor>();
    world(&mut app).get_mut::<Transform>(ball).unwrap().translation.z = 1.1;
    world(&mut app).get_mut::<LinearVelocity>(ball).unwrap().0 = Vec3::ZERO;
    steps(&mut app, 64);
    assert!((height(&app, ball) - 1.0).abs() < 0.01, "{}", height(&app, ball));
}

/// A sensor brings `Trigger` along where nothing else would notice it, and only there.
#[test]
fn a_sensor_alone_is_noticed() {
    let app = |available: &[EffectKind]| {
        let mut app = bevy_app::App::new();
        let early = app.world_mut().spawn((unit(), up(0.0), Sensor)).id();
        let plugins = CrannyPlugins::new(0.25).unwrap().available(available).unwrap();
        app.add_plugins(plugins.keep_failures());
        (app, early)
    };
    let (mut app_, early) = app(&[EffectKind::Trigger, EffectKind::Proximity]);
    let world = app_.world_mut();
    let late = world.spawn((unit(), up(5.0), Sensor)).id();
    let near = world.spawn((unit(), up(9.0), Sensor, Proximity { within: 1.0 })).id();
    let guests = [0.5, 5.5, 9.5].map(|z| world.spawn((RigidBody::Kinematic, unit(), up(z))).id());
    world.run_schedule(CrannyStep);
    let touched = |world: &World, body: Entity| -> Vec<Entity> {
        world.get::<TouchingBodies>(body).unwrap().entities().collect()
    };
    assert_eq!([touched(world, early), touched(world, late)], [[guests[0]], [guests[1]]]);
    assert!(touched(world, near).is_empty(), "it says itself what notices it");
    // Whoever wants to hear nothing of it removes the trigger.
    world.entity_mut(late).remove::<Trigger>();
    world.run_schedule(CrannyStep);
    assert!(touched(world, late).is_empty() && !world.resource::<Failure>().is_set());
    // Pairs may name what notices it; where nothing can, the step fails.
    let (mut app_, _) = app(&[EffectKind::Proximity]);
    app_.world_mut().run_schedule(CrannyStep);
    assert!(!app_.world().resource::<Failure>().is_set());
    let (mut app_, _) = app(&[]);
    app_.world_mut().run_schedule(CrannyStep);
    let said = app_.world_mut().resource_mut::<Failure>().take().unwrap().to_string();
    assert!(said.contains("is a sensor, but no effect of the app notices"), "{said}");
}

#[test]
fn messages_say_who_is_who() {
    #[derive(Component)]
    struct Gate;
    let mut app = empty(&[Effect::TRIGGER]);
    let guest = (RigidBody::Kinematic, unit(), up(0.5));
    let guest = world(&mut app).spawn(guest).id();
    let gate = world(&mut app).spawn((unit(), up(0.0), Gate)).id();
    let aside = world(&mut app).spawn((unit(), up(9.0), Gate)).id();
    steps(&mut app, 1);
    let start = messages::<CollisionStart>(&app)[0];
    assert_eq!((start.body, start.other), (guest, gate));
    assert_eq!([guest, gate, aside].map(|body| start.involves(body)), [true, true, false]);
    let others = [guest, gate, aside].map(|body| start.other_than(body));
    assert_eq!(others, [Some(gate), Some(guest), None]);
    let touched = world(&mut app).get::<TouchingBodies>(gate).unwrap().clone();
    assert!(touched.contains(guest) && !touched.contains(aside) && touched.len() == 1);
    assert!(touched.entities().eq([guest]) && touched.ids().eq([BodyId(0)]));
    let found = world(&mut app).run_system_once(move |gates: Query<(), With<Gate>>| {
        (start.one_of(&gates), start.flipped().one_of(&gates))
    });
    assert_eq!(found.unwrap(), (Some((gate, guest)), Some((gate, guest))));
}

/// A body that turns and flies in a void: damping takes of both as it says, a spring of its own.
#[cfg(feature = "rapier")]
#[test]
fn damping_slows_down_what_moves() {
    let mut app = empty(&[Effect::Response]);
    world(&mut app).resource_mut::<Gravity>().0 = DVec3::ZERO;
    let flies = (LinearVelocity(Vec3::X), AngularVelocity(Vec3::Z));
    let damped = (LinearDamping(2.0), AngularDamping(1.0));
    let thrown = (RigidBody::Dynamic, unit(), up(0.0), flies, damped);
    let thrown = world(&mut app).spawn(thrown).id();
    let speeds = |app: &SceneApp| {
        let world = app.app().world();
        let linear = world.get::<LinearVelocity>(thrown).unwrap().0.x;
        [linear, world.get::<AngularVelocity>(thrown).unwrap().0.z]
    };
    steps(&mut app, 64); // a second
    let [linear, angular] = speeds(&app);
    assert!((linear - (-2.0_f32).exp()).abs() < 0.01, "{linear}");
    assert!((angular - (-1.0_f32).exp()).abs() < 0.01, "{angular}");
    // What is removed ends in the same step.
    world(&mut app).entity_mut(thrown).remove::<(LinearDamping, AngularDamping)>();
    steps(&mut app, 8);
    let [of_linear, of_angular] = speeds(&app);
    assert!((of_linear - linear).abs() < 1e-4 && (of_angular - angular).abs() < 1e-4);
    // A kinematic body keeps its velocity, and is damped once it is dynamic.
    let moves = (RigidBody::Kinematic, LinearVelocity(Vec3::X), LinearDamping(2.0));
    world(&mut app).entity_mut(thrown).insert(moves);
    steps(&mut app, 8);
    assert_eq!(speeds(&app)[0], 1.0);
    world(&mut app).entity_mut(thrown).insert(RigidBody::Dynamic);
    steps(&mut app, 1);
    assert!((speeds(&app)[0] - 1.0 / (1.0 + 2.0 / 64.0)).abs() < 1e-6);
}

#[cfg(feature = "rapier")]
#[test]
fn damping_that_is_no_share_is_refused_with_its_value() {
    let refused = |damping: f64| {
        let mut app = empty(&[Effect::Response]);
        let [_, upper] = stack(&mut app);
        world(&mut app).entity_mut(upper).insert(AngularDamping(damping));
        app.step().unwrap_err().to_string()
    };
    let said = refused(-0.5);
    assert!(said.contains("'body#1': angular damping is -0.5"), "{said}");
    assert!(refused(f64::NAN).contains("NaN") && refused(1e300).contains("angular damping"));
}

#[cfg(feature = "rapier")]
#[test]
fn a_body_that_sleeps_says_so_until_it_wakes() {
    let mut app = empty(&[Effect::Response]);
    let [floor, upper] = stack(&mut app);
    let sleeps = |app: &SceneApp, body| app.app().world().get::<Sleeping>(body).is_some();
    steps(&mut app, 192);
    assert!(sleeps(&app, upper) && !sleeps(&app, floor));
    world(&mut app).get_mut::<LinearVelocity>(upper).unwrap().0 = Vec3::Z;
    steps(&mut app, 1);
    assert!(!sleeps(&app, upper));
    steps(&mut app, 400);
    assert!(sleeps(&app, upper));
    world(&mut app).entity_mut(upper).remove::<Collider>();
    assert!(!sleeps(&app, upper), "what is no body does not sleep");
}

#[cfg(feature = "rapier")]
#[test]
fn layers_and_pairs_keep_bodies_apart_until_they_do_not() {
    let mut app = empty(&[Effect::Response]);
    let [floor, upper] = stack(&mut app);
    let pair = world(&mut app).spawn((BodyPair { a: floor, b: upper }, NeverMeet)).id();
    steps(&mut app, 32);
    assert!(height(&app, upper) < 0.5, "{}", height(&app, upper));
    world(&mut app).despawn(pair);
    let rest = |app: &mut SceneApp| {
        world(app).entity_mut(upper).insert((up(1.01), LinearVelocity::default()));
        steps(app, 48);
        height(app, upper)
    };
    assert!((rest(&mut app) - 1.0).abs() < 0.01);
    world(&mut app).entity_mut(upper).insert(CollisionLayers::shared(2));
    world(&mut app).entity_mut(floor).insert(CollisionLayers::shared(1));
    assert!(rest(&mut app) < 0.0);
    world(&mut app).entity_mut(floor).insert(CollisionLayers::new(1, 2));
    assert!(rest(&mut app) < 0.0, "layers are mutual");
    world(&mut app).entity_mut(upper).insert(CollisionLayers::new(2, 1));
    assert!((rest(&mut app) - 1.0).abs() < 0.01);
}

#[cfg(feature = "rapier")]
#[test]
fn a_reduced_joint_is_driven_and_driven_otherwise() {
    let mut app = empty(&[Effect::Response]);
    let post = world(&mut app).spawn((RigidBody::Fixed, unit(), up(5.0))).id();
    let arm = Transform::from_xyz(2.0, 0.0, 5.0);
    let hung = world(&mut app).spawn((RigidBody::Dynamic, unit(), arm)).id();
    let anchors = [Pose::IDENTITY, Pose::at(DVec3::new(-2.0, 0.0, 0.0))];
    let joint = Joint::revolute(post, hung, DVec3::Y).with_anchors(anchors[0], anchors[1]);
    let held = joint.reduced().with_motor(Motor::at(0.0));
    let joint = world(&mut app).spawn(held).id();
    steps(&mut app, 64);
    assert!((height(&app, hung) - 5.0).abs() < 2e-3, "{}", height(&app, hung));
    // Another motor does not join anew: the arm goes on from where it is.
    world(&mut app).entity_mut(joint).insert(held.with_motor(Motor::at(-0.5)));
    steps(&mut app, 64);
    let raised = 5.0 + 2.0 * 0.5f32.sin();
    assert!((height(&app, hung) - raised).abs() < 5e-3, "{}", height(&app, hung));
    // Its mass is stated; one that goes is that of its solid again.
    let mass = |app: &SceneApp| {
        let solved = app.app().world().get::<SolverBody>(hung).unwrap().index;
        app.app().world().resource::<RigidBodies>().simulation().mass(solved)
    };
    let (center, inertia) = (DVec3::ZERO, cranny_exact::DMat3::IDENTITY);
    let stated = Mass(StatedMass { mass: 7.0, center, inertia });
    world(&mut app).entity_mut(hung).insert(stated);
    steps(&mut app, 1);
    assert!((mass(&app) - 7.0).abs() < 1e-5);
    world(&mut app).entity_mut(hung).remove::<Mass>();
    steps(&mut app, 1);
    assert!((mass(&app) - 1.0).abs() < 1e-5);
    world(&mut app).despawn(joint);
    steps(&mut app, 64);
    assert!(height(&app, hung) < 4.0, "{}", height(&app, hung));
}

#[cfg(feature = "rapier")]
#[test]
fn joints_are_entities() {
    let mut app = empty(&[Effect::Response]);
    let post = world(&mut app).spawn((RigidBody::Fixed, unit(), up(5.0))).id();
    let hung = world(&mut app).spawn((RigidBody::Dynamic, unit(), up(3.0))).id();
    let anchors = [Pose::at(DVec3::new(0.0, 0.0, -2.0)), Pose::IDENTITY];
    let joint = Joint::fixed(post, hung).with_anchors(anchors[0], anchors[1]);
    let joint = world(&mut app).spawn(joint).id();
    steps(&mut app, 32);
    assert!((height(&app, hung) - 3.0).abs() < 1e-3);
    world(&mut app).despawn(joint);
    steps(&mut app, 32);
    assert!(height(&app, hung) < 2.5);
    // A joint waits for its bodies, and ends with one of them.
    let late = world(&mut app).spawn_empty().id();
    world(&mut app).spawn(Joint::fixed(post, late).with_anchors(anchors[0], anchors[1]));
    steps(&mut app, 2);
    world(&mut app).entity_mut(late).insert((RigidBody::Dynamic, unit(), up(3.0)));
    steps(&mut app, 32);
    assert!((height(&app, late) - 3.0).abs() < 1e-3);
    world(&mut app).despawn(post);
    steps(&mut app, 32);
    assert!(height(&app, late) < 2.5);
}

#[test]
fn bodies_and_pairs_ask_for_effects_that_the_app_has() {
    let plugins = CrannyPlugins::new(0.25).unwrap();
    let plugins = plugins.available(&[EffectKind::Trigger, EffectKind::Contacts]).unwrap();
    let mut app = bevy_app::App::empty();
    app.add_plugins(plugins.keep_failures());
    let world = app.world_mut();
    let unit = unit();
    let at = |x: f32| Transform::from_xyz(x, 0.0, 0.0);
    let a = world.spawn((RigidBody::Fixed, unit.clone(), at(0.0))).id();
    let b = world.spawn((RigidBody::Kinematic, unit.clone(), at(0.5), Trigger)).id();
    let c = world.spawn((RigidBody::Kinematic, unit.clone(), at(1.25))).id();
    world.spawn((BodyPair { a, b: c }, Contacts { margin: 0.5 }));
    world.run_schedule(CrannyStep);
    let touching = |world: &World, body| {
        let touched = world.get::<TouchingBodies>(body).unwrap();
        touched.ids().map(|id| id.0).collect::<Vec<u32>>()
    };
    assert_eq!(touching(world, b), [0, 2]);
    assert_eq!(touching(world, a), [1]);
    let pairs: Vec<_> =
        world.resource::<ContactReport>().pairs.iter().map(|p| (p.a.0, p.b.0)).collect();
    assert_eq!(pairs, [(0, 2)], "only that pair asks for contacts");
    world.entity_mut(b).remove::<Trigger>();
    world.run_schedule(CrannyStep);
    assert!(touching(world, a).is_empty() && touching(world, b).is_empty());
    assert!(!world.resource::<Failure>().is_set());
    // What the app has no plugin of is said, not passed over.
    world.spawn((Name::new("pusher"), unit, at(9.0), Response));
    world.run_schedule(CrannyStep);
    let said = world.resource_mut::<Failure>().take().unwrap().to_string();
    assert!(said.contains("'pusher'") && said.contains("Response"), "{said}");
}

#[test]
fn what_cannot_be_a_body_is_said() {
    let said = |spawn: &dyn Fn(&mut World)| {
        let mut app = empty(&[Effect::TRIGGER]);
        spawn(world(&mut app));
        app.step().unwrap_err().to_string()
    };
    let stretched = up(0.0).with_scale(Vec3::new(2.0, 1.0, 1.0));
    let scaled =
        said(&|world| drop_entity(world.spawn((Name::new("wide"), unit(), stretched)).id()));
    assert!(scaled.contains("'wide'") && scaled.contains("scale"), "{scaled}");
    let child = said(&|world| {
        let parent = world.spawn(up(1.0)).id();
        world.spawn((Name::new("child"), unit(), up(0.0), ChildOf(parent)));
    });
    assert!(child.contains("'child'") && child.contains("root"), "{child}");
    let lost = said(&|world| {
        let nowhere = Transform::from_xyz(f32::NAN, 0.0, 0.0);
        world.spawn((Name::new("lost"), unit(), nowhere));
    });
    assert!(lost.contains("'lost'"), "{lost}");
    #[cfg(feature = "rapier")]
    {
        let mut app = empty(&[Effect::Response]);
        world(&mut app).spawn((Name::new("void"), RigidBody::Dynamic, unit(), Density(0.0)));
        let weightless = app.step().unwrap_err().to_string();
        assert!(weightless.contains("'void'") && weightless.contains("mass"), "{weightless}");
    }
}

fn drop_entity(_: Entity) {}

#[test]
fn a_collider_that_is_removed_takes_the_body_out_and_another_brings_a_new_one() {
    let mut app = SceneApp::new(&gate(&[Effect::TRIGGER]), &RunOptions::default()).unwrap();
    steps(&mut app, 15);
    let guest = app.app().world().resource::<Bodies>().get(BodyId(1)).unwrap().entity;
    world(&mut app).entity_mut(guest).remove::<Collider>();
    assert!(app.app().world().get::<Body>(guest).is_none(), "at once");
    assert_eq!(app.app().world().resource::<Bodies>().iter().len(), 1);
    steps(&mut app, 1);
    assert_eq!(messages::<CollisionEnd>(&app).len(), 1);
    world(&mut app).entity_mut(guest).insert(unit());
    steps(&mut app, 1);
    assert_eq!(
        app.app().world().get::<Body>(guest).unwrap().id,
        BodyId(2),
        "ids are not given again"
    );
    assert_eq!(messages::<CollisionStart>(&app).len(), 1);
}

#[cfg(feature = "record")]
#[test]
fn a_recording_shows_who_comes_and_goes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut description = scene(Vec::new(), &[Effect::TRIGGER]);
    description.bodies.push(cube("post", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO));
    let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
    let mut app = SceneApp::new(&description, &options).unwrap();
    steps(&mut app, 2);
    let guest =
        world(&mut app).spawn((Name::new("guest"), RigidBody::Kinematic, unit(), up(0.5))).id();
    steps(&mut app, 2);
    world(&mut app).despawn(guest);
    steps(&mut app, 2);
    world(&mut app).spawn((Name::new("guest"), RigidBody::Kinematic, unit(), up(0.25)));
    steps(&mut app, 2);
    app.finish().unwrap();
    let recording = cranny_record::Recording::open(&path).unwrap();
    let placed: Vec<usize> = recording.transforms().unwrap().iter().map(|(_, p)| p.len()).collect();
    assert_eq!(placed, [1, 1, 2, 2, 1, 1, 2, 2, 2]);
    let events: Vec<usize> =
        recording.events().unwrap().iter().map(|(_, e)| e.events.len()).collect();
    assert_eq!(events.iter().sum::<usize>(), 3, "began, ended, began: {events:?}");
}

/// The pattern of bullets: whoever is hit takes the other out, in the step in which it is reported.
#[test]
fn a_body_that_is_despawned_as_its_collision_is_reported_ends_in_the_next_step() {
    let mut app = SceneApp::new(&gate(&[Effect::TRIGGER]), &RunOptions::default()).unwrap();
    let guest = app.app().world().resource::<Bodies>().get(BodyId(1)).unwrap().entity;
    let post = app.app().world().resource::<Bodies>().get(BodyId(0)).unwrap().entity;
    app.app_mut().add_observer(move |hit: On<CollisionStart>, mut commands: Commands| {
        if hit.body == guest {
            commands.entity(guest).despawn();
        }
    });
    let (mut starts, mut ends) = (Vec::new(), Vec::new());
    for _ in 0..20 {
        steps(&mut app, 1);
        starts.extend(messages::<CollisionStart>(&app));
        ends.extend(messages::<CollisionEnd>(&app).iter().map(|end| [end.body, end.other]));
    }
    assert_eq!((starts.len(), &ends[..]), (1, &[[post, guest]][..]));
    assert!(app.app().world().get::<TouchingBodies>(post).unwrap().is_empty());
}

#[test]
fn a_trigger_that_comes_or_goes_on_what_touches_begins_and_ends_it() {
    let mut app = bevy_app::App::empty();
    let plugins = CrannyPlugins::new(0.25).unwrap().effects(&[CONTACTS]).unwrap();
    app.add_plugins(plugins.available(&[EffectKind::Trigger]).unwrap());
    let world = app.world_mut();
    let a = world.spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    let b = world.spawn((RigidBody::Kinematic, unit(), up(0.5))).id();
    let touching = |world: &mut World| {
        world.run_schedule(CrannyStep);
        [a, b].map(|body| world.get::<TouchingBodies>(body).unwrap().len())
    };
    assert_eq!(touching(world), [0, 0]);
    world.entity_mut(b).insert(Trigger);
    assert_eq!(touching(world), [1, 1]);
    world.entity_mut(b).remove::<Trigger>();
    assert_eq!(touching(world), [0, 0]);
    assert!(!world.resource::<Failure>().is_set());
}

#[cfg(feature = "rapier")]
#[test]
fn a_body_that_asks_for_no_response_any_more_stands_still() {
    let mut app = bevy_app::App::empty();
    let plugins = CrannyPlugins::new(1.0 / 64.0).unwrap();
    app.add_plugins(plugins.available(&[EffectKind::Response]).unwrap());
    let world = app.world_mut();
    let body = world.spawn((RigidBody::Dynamic, unit(), up(9.0), Response)).id();
    let aside = world.spawn((RigidBody::Dynamic, unit(), Transform::from_xyz(5.0, 0.0, 9.0))).id();
    let hung = Transform::from_xyz(0.0, 0.0, 7.0);
    let hung = world.spawn((RigidBody::Dynamic, unit(), hung)).id();
    let layers = CollisionLayers::shared(2);
    world.entity_mut(hung).insert(layers);
    world.entity_mut(aside).insert(layers);
    let anchors = [Pose::at(DVec3::new(0.0, 0.0, -2.0)), Pose::IDENTITY];
    world.spawn(Joint::fixed(body, hung).with_anchors(anchors[0], anchors[1]));
    let fallen = |world: &mut World, entity: Entity| {
        let before = world.get::<Transform>(entity).unwrap().translation.z;
        (0..16).for_each(|_| world.run_schedule(CrannyStep));
        before - world.get::<Transform>(entity).unwrap().translation.z > 0.1
    };
    assert!(fallen(world, body) && fallen(world, hung) && !fallen(world, aside));
    world.entity_mut(body).remove::<Response>();
    assert!(!fallen(world, body) && !fallen(world, hung));
    assert!(world.get::<SolverBody>(body).is_none());
    world.entity_mut(body).insert(Response);
    assert!(fallen(world, body) && fallen(world, hung), "and the joint holds again");
    assert!(!world.resource::<Failure>().is_set());
}

#[test]
fn what_was_spawned_before_the_plugins_is_a_body_too_and_a_parent_is_refused() {
    let mut app = bevy_app::App::empty();
    let early = app.world_mut().spawn((Name::new("early"), unit(), up(0.0))).id();
    let plugins = CrannyPlugins::new(0.25).unwrap().effects(&[Effect::TRIGGER]).unwrap();
    app.add_plugins(plugins.keep_failures());
    let world = app.world_mut();
    world.run_schedule(CrannyStep);
    assert_eq!(world.get::<Body>(early).map(|body| body.id), Some(BodyId(0)));
    let parent = world.spawn(up(1.0)).id();
    world.entity_mut(early).insert(ChildOf(parent));
    let refused = world.resource_mut::<Failure>().take().unwrap().to_string();
    assert!(refused.contains("'early'") && refused.contains("root"), "{refused}");
}

#[cfg(feature = "rapier")]
#[test]
fn numbers_that_are_none_are_refused_with_the_body_and_the_component() {
    let mut app = empty(&[Effect::Response]);
    let [_, upper] = stack(&mut app);
    world(&mut app).get_mut::<LinearVelocity>(upper).unwrap().0.x = f32::NAN;
    let refused = app.step().unwrap_err().to_string();
    assert!(refused.contains("body#1") && refused.contains("linear velocity"), "{refused}");
    let mut app = empty(&[Effect::Response]);
    let [_, upper] = stack(&mut app);
    world(&mut app).entity_mut(upper).insert(Friction::new(-0.5));
    let refused = app.step().unwrap_err().to_string();
    assert!(refused.contains("friction") && refused.contains("-0.5"), "{refused}");
}

/// The solver gives the number of a body that left to the next one: its order is not that of ids.
#[cfg(feature = "rapier")]
#[test]
fn contacts_are_of_the_lower_id_first_whatever_number_the_solver_gave() {
    let mut app = empty(&[Effect::Response, CONTACTS]);
    let [floor, upper] = stack(&mut app);
    world(&mut app).despawn(floor);
    let floor = world(&mut app).spawn((RigidBody::Fixed, unit(), up(-0.02))).id();
    steps(&mut app, 32);
    let world = world(&mut app);
    let [index, other] = [floor, upper].map(|body| world.get::<SolverBody>(body).unwrap().index);
    assert!(index < other, "the new floor has the old one's number");
    let report = world.resource::<ContactReport>();
    let pair = &report.pairs[0];
    assert_eq!((pair.a, pair.b), (BodyId(1), BodyId(2)));
    assert!(pair.poses[0].translation.z > 0.9 && pair.poses[1].translation.z < 0.1);
    let contacts = &pair.answer.contacts;
    assert!(!contacts.is_empty() && contacts.iter().all(|contact| contact.normal.z < -0.9));
}

/// A bullet and a sheet that it would jump through: the bullet asks, the sheet, or nobody; and
/// asking counts from the next step on.
#[cfg(feature = "rapier")]
#[test]
fn a_body_that_asks_for_it_passes_through_nothing() {
    let shot = |bullet_asks: bool, sheet_asks: bool, later: bool| {
        let description = scene(Vec::new(), &[Effect::Response]);
        let plugins = CrannyPlugins::new(1.0 / 64.0).unwrap().gravity(DVec3::ZERO);
        let plugins = plugins.effects(&description.effects).unwrap();
        let mut app = bevy_app::App::new();
        app.add_plugins(plugins.available(&[EffectKind::Continuous]).unwrap());
        let world = app.world_mut();
        let sheet = world.spawn((RigidBody::Fixed, cuboid([4.0, 4.0, 0.02]))).id();
        let fast = LinearVelocity(Vec3::new(0.0, 0.0, -300.0));
        let bullet = (RigidBody::Dynamic, cuboid([0.1; 3]), up(21.0), fast);
        let bullet = world.spawn(bullet).id();
        if later {
            world.run_schedule(CrannyStep);
        }
        for (body, asks) in [(bullet, bullet_asks), (sheet, sheet_asks)] {
            if asks {
                world.entity_mut(body).insert(Continuous);
            }
        }
        (0..12).for_each(|_| world.run_schedule(CrannyStep));
        assert!(!world.resource::<Failure>().is_set());
        let passed = world.get::<Transform>(bullet).unwrap().translation.z < 0.0;
        assert_eq!(world.resource::<HeldBack>().total > 0, !passed);
        passed
    };
    assert!(shot(false, false, false));
    assert!(!shot(true, false, false) && !shot(true, false, true));
    assert!(!shot(false, true, false) && !shot(true, true, false));
}
