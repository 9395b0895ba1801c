//! Bodies that are primitives: with a solver and without, spawned by code and by a scene.

use std::sync::Arc;

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemState;
use bevy_math::{Dir3, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_primitives::{Ball, HalfSpace, Primitive};
use cranny_shapes::{Cup, Torus, primitive_mesh};
use cranny_world::description::{BodyDescription, BodyKind, Effect};

use crate::build::{cube, empty, messages, scene, steps, unit, up, world};

fn ring() -> Collider {
    let torus = Torus { major_radius: 2.0, minor_radius: 0.5, ..Torus::default() };
    Collider::from_mesh(torus.build().unwrap()).unwrap()
}

fn ground() -> Collider {
    Collider::half_space(DVec3::Z)
}

/// A body of a scene that is a primitive.
fn described(name: &str, kind: BodyKind, at: DVec3, primitive: Primitive) -> BodyDescription {
    let collision = Arc::new(primitive_mesh(&primitive).unwrap());
    let shape = Some(primitive.into());
    BodyDescription { collision, shape, ..cube(name, kind, at, DVec3::ZERO) }
}

/// What an app says is wrong after a step.
fn failure(effects: &[Effect], spawn: impl FnOnce(&mut World)) -> String {
    let mut app = empty(effects);
    spawn(world(&mut app));
    app.step().unwrap_err().to_string()
}

#[test]
fn a_ball_that_goes_down_beside_the_hole_of_a_ring_is_met_from_step_to_step() {
    let mut app = empty(&[Effect::TRIGGER]);
    world(&mut app).spawn((RigidBody::Fixed, ring()));
    // Half a unit a second, 64 steps a second: 1/128 a step. It meets at a height of 0.75.
    let down = LinearVelocity(Vec3::new(0.0, 0.0, -0.5));
    let aside = Transform::from_xyz(2.0, 0.0, 1.0);
    let ball =
        world(&mut app).spawn((RigidBody::Kinematic, Collider::ball(0.25), aside, down)).id();
    let through = Transform::from_xyz(0.0, 0.0, 1.0);
    world(&mut app).spawn((RigidBody::Kinematic, Collider::ball(0.25), through, down));
    let mut events = Vec::new();
    for step in 0..320 {
        steps(&mut app, 1);
        let began = messages::<CollisionStart>(&app).into_iter().map(|m| (step, m.body, true));
        let ended = messages::<CollisionEnd>(&app).into_iter().map(|m| (step, m.body, false));
        let both = began.chain(ended).collect::<Vec<_>>();
        events.extend(both);
    }
    let [(first, _, true), (last, _, false)] = events[..] else { panic!("{events:?}") };
    // The ring's tube is inscribed, so that it is met a little later and left a little earlier.
    assert!((32..34).contains(&first), "{events:?}");
    assert!((223..226).contains(&last), "{events:?}");
    assert!(world(&mut app).get::<TouchingBodies>(ball).is_some());
}

#[test]
fn distances_depths_and_ways_of_primitives_without_a_solver() {
    let mut app = empty(&[Effect::proximity(10.0), Effect::Penetration]);
    world(&mut app).spawn((RigidBody::Fixed, ground()));
    let near = world(&mut app).spawn((RigidBody::Kinematic, Collider::ball(0.5), up(3.0))).id();
    let low = Transform::from_xyz(50.0, 0.0, 0.25);
    let sunk = world(&mut app).spawn((RigidBody::Kinematic, Collider::ball(0.5), low)).id();
    steps(&mut app, 1);
    let world = world(&mut app);
    let report = world.resource::<ProximityReport>();
    let [clear, meets] = &report.pairs[..] else { panic!("{report:?}") };
    assert_eq!((clear.distance, clear.other), (2.5, near));
    assert_eq!((meets.distance, meets.other), (0.0, sunk));
    let report = world.resource::<PenetrationReport>();
    let [pair] = &report.pairs[..] else { panic!("{report:?}") };
    assert_eq!((pair.other, pair.depth), (sunk, Some(0.25)));
    assert!((pair.way - 0.25 * DVec3::Z).length() < 1e-6, "{pair:?}");
}

#[cfg(feature = "rapier")]
#[test]
fn a_ball_rolls_into_a_cup_and_rests_and_says_what_it_touches() {
    let mut app = empty(&[Effect::Response, Effect::TRIGGER, Effect::Contacts { margin: 0.01 }]);
    let cup = Collider::from_mesh(Cup::default().build().unwrap()).unwrap();
    let bottom = cup.model().unwrap().bounds().min.z as f32;
    let cup = world(&mut app).spawn((RigidBody::Fixed, cup, up(-bottom))).id();
    let start = Transform::from_xyz(0.2, 0.0, 1.3);
    let ball = world(&mut app).spawn((RigidBody::Dynamic, Collider::ball(0.15), start)).id();
    let mut touched = Vec::new();
    for _ in 0..256 {
        steps(&mut app, 1);
        touched.extend(messages::<CollisionStart>(&app).iter().map(|m| [m.body, m.other]));
    }
    touched.dedup();
    assert_eq!(touched, [[cup, ball]]);
    let rest = world(&mut app).get::<Transform>(ball).unwrap().translation;
    assert!((rest.z - 0.25).abs() < 5e-3, "on the floor of 0.1: {rest}");
    assert!(world(&mut app).get::<BodyContacts>(ball).unwrap().partners == 1);
    let summary = app.finish().unwrap();
    assert!(summary.energy_drift.unwrap() < 0.05, "{:?}", summary.energy);
}

#[cfg(feature = "rapier")]
#[test]
fn a_scene_of_primitives_and_the_same_spawned_by_hand_end_in_the_same_state() {
    let effects = [Effect::Response, Effect::TRIGGER];
    let plane = HalfSpace { point: DVec3::ZERO, normal: DVec3::Z };
    let ball = Ball { center: DVec3::ZERO, radius: 0.5 };
    let mut bodies = vec![
        described("ground", BodyKind::Fixed, DVec3::ZERO, plane.into()),
        described("ball", BodyKind::Dynamic, DVec3::Z, ball.into()),
        cube("box", BodyKind::Dynamic, DVec3::new(0.25, 0.0, 2.25), DVec3::ZERO),
    ];
    bodies[1].linear_velocity = DVec3::new(0.5, 0.0, 0.0);
    let plugins = PluginOptions { length_unit: Some(1.0 / 3.0), ..PluginOptions::default() };
    let options = RunOptions { plugins, ..RunOptions::default() };
    let mut by_file = SceneApp::new(&scene(bodies, &effects), &options).unwrap();
    steps(&mut by_file, 60);

    let mut by_hand = empty(&effects);
    let world = world(&mut by_hand);
    world.spawn((RigidBody::Fixed, ground()));
    let velocity = LinearVelocity(Vec3::new(0.5, 0.0, 0.0));
    world.spawn((RigidBody::Dynamic, Collider::ball(0.5), up(1.0), velocity));
    world.spawn((RigidBody::Dynamic, unit(), Transform::from_xyz(0.25, 0.0, 2.25)));
    steps(&mut by_hand, 60);
    let [a, b] = [by_file, by_hand].map(|app| app.finish().unwrap().state_hash);
    assert_eq!(a, b);
}

#[cfg(feature = "rapier")]
#[test]
fn a_collider_changes_from_mesh_to_primitive_and_back_while_it_rests() {
    let mut app = empty(&[Effect::Response]);
    world(&mut app).spawn((RigidBody::Fixed, ground()));
    let body = world(&mut app).spawn((RigidBody::Dynamic, unit(), up(0.5))).id();
    let rests_at = |app: &mut SceneApp, height: f32| {
        steps(app, 64);
        let z = world(app).get::<Transform>(body).unwrap().translation.z;
        assert!((z - height).abs() < 5e-3, "{z}, not {height}");
    };
    rests_at(&mut app, 0.5);
    world(&mut app).entity_mut(body).insert(Collider::ball(0.25));
    rests_at(&mut app, 0.25);
    world(&mut app).entity_mut(body).insert(Collider::capsule(0.25, 0.5));
    steps(&mut app, 1);
    world(&mut app).entity_mut(body).insert(unit());
    steps(&mut app, 64);
}

#[test]
fn a_child_that_is_a_primitive_stands_where_the_child_does_and_none_is_one_of_several() {
    let mut app = empty(&[Effect::TRIGGER]);
    let body = world(&mut app).spawn((RigidBody::Kinematic, up(0.0))).id();
    let arm = Transform::from_xyz(3.0, 0.0, 0.0);
    world(&mut app).spawn((Collider::ball(0.5), arm, ChildOf(body)));
    let post = world(&mut app).spawn((unit(), Transform::from_xyz(3.9, 0.0, 0.0))).id();
    steps(&mut app, 1);
    let id = world(&mut app).get::<Body>(body).unwrap().id;
    let touching = world(&mut app).get::<TouchingBodies>(post).unwrap();
    assert_eq!(touching.ids().collect::<Vec<_>>(), [id]);
    world(&mut app).spawn((unit(), ChildOf(body)));
    let error = app.step().unwrap_err().to_string();
    assert!(error.contains("a ball is one of several"), "{error}");
}

#[test]
fn a_collider_of_a_body_that_has_rules_of_its_own_is_refused() {
    let mut app = empty(&[Effect::TRIGGER]);
    let crate_ = (Name::new("crate"), RigidBody::Fixed, unit(), up(0.0));
    let body = world(&mut app).spawn(crate_).id();
    world(&mut app).spawn((unit(), up(1.0), ChildOf(body), Sensor));
    let error = app.step().unwrap_err().to_string();
    assert!(error.contains("body 'crate'") && error.contains("a Sensor of its own"), "{error}");
}

#[test]
fn effects_of_meshes_and_invalid_numbers_are_refused_by_name() {
    let marble = |world: &mut World| world.spawn((Name::new("marble"), Collider::ball(0.5))).id();
    let smooth = failure(&[], |world| {
        let marble = marble(world);
        world.entity_mut(marble).insert(SmoothNormals { crease_angle: 0.3 });
    });
    assert!(
        smooth.starts_with("SmoothNormals works on a mesh, but body 'marble' is a ball"),
        "{smooth}"
    );
    let feedback = Effect::ForceFeedback { stiffness: 100.0 };
    let felt = failure(&[feedback], |world| {
        marble(world);
    });
    assert!(felt.starts_with("ForceFeedback works on a mesh, but body 'marble'"), "{felt}");
    let wrong = failure(&[], |world| {
        world.spawn((Name::new("marble"), Collider::ball(-0.5)));
    });
    assert_eq!(
        wrong,
        "body 'marble': its ball is refused: radius is -0.5: it must be a finite number, 0 or more"
    );
    let flat = Collider::cuboid(1.0, 0.0, 1.0).unwrap_err().to_string();
    assert!(flat.starts_with("Cuboid: size"), "{flat}");
}

#[cfg(feature = "rapier")]
#[test]
fn a_dynamic_half_space_and_a_pair_that_is_to_be_dented_are_refused() {
    let falling = failure(&[Effect::Response], |world| {
        world.spawn((Name::new("plane"), RigidBody::Dynamic, ground()));
    });
    assert_eq!(falling, "body 'plane': a half-space has no mass: make the body fixed or kinematic");
    let dent = Effect::Deformation { hardness: 1.0, radius: 0.1 };
    let mut described = scene(
        vec![
            cube("can", BodyKind::Dynamic, DVec3::ZERO, DVec3::ZERO),
            described(
                "ball",
                BodyKind::Dynamic,
                DVec3::X * 3.0,
                Ball { center: DVec3::ZERO, radius: 0.5 }.into(),
            ),
        ],
        &[Effect::Response],
    );
    described.pairs.push(cranny_world::description::PairDescription {
        a: "can".into(),
        b: "ball".into(),
        effects: vec![dent],
        accuracy: None,
    });
    let refused = SceneApp::new(&described, &RunOptions::default()).err();
    let error = refused.unwrap().to_string();
    assert!(error.starts_with("Deformation works on a mesh, but body 'ball' is a ball"), "{error}");
    // Of the can alone it is no matter what hits it.
    described.pairs.clear();
    described.bodies[0].effects.push(dent);
    let mut app = SceneApp::new(&described, &RunOptions::default()).unwrap();
    steps(&mut app, 3);
}

#[test]
fn questions_about_places_see_primitives_as_what_they_are() {
    let mut app = empty(&[]);
    let ground = world(&mut app).spawn(ground()).id();
    let ball = world(&mut app).spawn((RigidBody::Kinematic, Collider::ball(0.5), up(2.0))).id();
    let down = LinearVelocity(Vec3::new(0.0, 0.0, -1.0));
    world(&mut app).entity_mut(ball).insert(down);
    steps(&mut app, 1);
    *world(&mut app).get_mut::<Transform>(ball).unwrap() = up(2.0);
    let world = world(&mut app);
    let mut state = SystemState::<SpatialQuery>::new(world);
    let spatial = state.get(world).unwrap();
    let all = SpatialQueryFilter::default();
    let hit = spatial.cast_ray(Vec3::new(0.0, 0.0, 5.0), Dir3::NEG_Z, 10.0, &all).unwrap().unwrap();
    assert_eq!((hit.entity, hit.face, hit.from_inside), (ball, None, false));
    assert!((hit.distance - 2.5).abs() < 1e-9 && (hit.normal - DVec3::Z).length() < 1e-9);
    assert_eq!(spatial.point_intersections(Vec3::new(0.0, 0.0, -3.0), &all), [ground]);
    let nearest = spatial.project_point(Vec3::new(2.0, 0.0, 2.0), 9.0, &all).unwrap().unwrap();
    assert_eq!((nearest.entity, nearest.distance), (ball, 1.5));
    let points = spatial.closest_points(ball, ground).unwrap();
    assert_eq!((points.distance, points.overlap), (1.5, false));
    let TimeOfImpact::At(time) = spatial.time_of_impact(ball, ground, 10.0).unwrap() else {
        panic!("it falls on the ground")
    };
    assert!((time - 1.5).abs() < 1e-5, "{time}");
    assert_eq!(spatial.time_of_impact(ball, ground, 1.0).unwrap(), TimeOfImpact::None);
    let probe = Collider::capsule(0.25, 1.0);
    let start = Transform::from_xyz(-4.0, 0.0, 2.0);
    let cast = spatial.cast_shape(&probe, &start, Vec3::X * 8.0, &all).unwrap().unwrap();
    assert_eq!(cast.entity, ball);
    assert!((cast.distance - 3.25).abs() < 1e-5, "{cast:?}");
    assert!((cast.normal.unwrap() + DVec3::X).length() < 1e-5);
    let sunk = spatial.shape_intersections(&unit(), &up(0.25), &all).unwrap();
    assert_eq!(sunk, [ground]);
}

#[cfg(feature = "record")]
#[test]
fn a_recording_of_primitives_is_computed_anew_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let ball = Ball { center: DVec3::new(0.1, 0.0, 0.0), radius: 0.5 };
    let plane = HalfSpace { point: DVec3::ZERO, normal: DVec3::new(0.1, 0.0, 1.0) };
    let mut bodies = vec![
        described("ground", BodyKind::Fixed, DVec3::ZERO, plane.into()),
        described("ball", BodyKind::Kinematic, DVec3::new(-4.0, 0.0, 0.2), ball.into()),
        cube("box", BodyKind::Fixed, DVec3::new(0.0, 0.0, 0.4), DVec3::ZERO),
    ];
    bodies[1].linear_velocity = DVec3::X * 4.0;
    let scene = scene(bodies, &[Effect::TRIGGER, Effect::Contacts { margin: 0.01 }]);
    let options = RunOptions { record: Some(path.clone()), ..RunOptions::default() };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    while app.step().unwrap() {}
    app.finish().unwrap();
    let replay = Replay::open(&path).unwrap();
    let report = replay.compare(replay.frames().iter());
    assert!(report.same > 30, "{report:?}");
    assert_eq!((report.different.len(), report.unknown), (0, 0), "{report:?}");
}

/// What passes beside a plane without coming nearer to it does not hide what lies ahead.
#[test]
fn a_ball_that_grazes_the_ground_is_swept_past_it() {
    let mut app = empty(&[Effect::TRIGGER]);
    let wall = Transform::from_xyz(5.0, 0.0, 0.0);
    world(&mut app).spawn((RigidBody::Fixed, ground()));
    let wall = world(&mut app).spawn((RigidBody::Fixed, Collider::cylinder(0.5, 4.0), wall)).id();
    steps(&mut app, 1);
    let mut state = SystemState::<SpatialQuery>::new(world(&mut app));
    let spatial = state.get(world(&mut app)).unwrap();
    let (ball, all) = (Collider::ball(0.5), SpatialQueryFilter::default());
    let cast = |height, way| spatial.cast_shape(&ball, &up(height), way, &all).unwrap();
    let hit = cast(0.501, 10.0 * Vec3::X).expect("the wall is in the way");
    assert_eq!(hit.entity, wall);
    // The cylinder lies across the way, and the ball touches it a little above its middle.
    let expected = 5.0 - (1.0 - 0.501f64.powi(2)).sqrt();
    assert!((hit.distance - expected).abs() < 1e-3, "{hit:?}");
    assert!(cast(0.501, 10.0 * Vec3::Y).is_none());
    let hit = cast(1.5, Vec3::new(0.0, 2.0, -2.0)).expect("it falls to the ground");
    assert!((hit.distance - 2.0f64.sqrt()).abs() < 1e-3, "{hit:?}");
}
