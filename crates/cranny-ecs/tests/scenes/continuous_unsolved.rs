//! `Continuous` without a solver: kinematic bodies that are led by velocities and paths.

use std::f64::consts::TAU;
use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_narrow_phase::{Demand, PairMemory, Query as PairQuery};
use cranny_primitives::{
    Ball, BodyShape, Capsule, HalfSpace, PlacedShape, Primitive, query_shapes,
};
use cranny_shapes::Cuboid;
use cranny_testkit::Rng;
use cranny_world::BodyId;
use cranny_world::description::{
    BodyDescription, BodyKind, Effect, Interpolation, Keyframe, KeyframedPath, PairDescription,
    PathEnd, SceneDescription,
};

use crate::build::{cube, empty, scene, steps, unit, world};
use crate::continuous::{THROWN, at_a_wall, passed};

/// Without a solver: kinematic hooks, rings and balls that follow their velocities.
fn led(seed: u64, effects: &[Effect]) -> SceneDescription {
    let mut bodies = at_a_wall(seed, BodyKind::Kinematic, &[], effects);
    for ball in bodies.iter_mut().take(THROWN as usize).skip(2).step_by(3) {
        ball.shape = Some(Primitive::from(Ball { center: DVec3::ZERO, radius: 0.05 }).into());
    }
    SceneDescription { duration: 12.0 / 64.0, ..scene(bodies, &[]) }
}

#[test]
fn of_a_thousand_that_are_led_at_a_wall_none_passes_it_with_continuous_and_many_do_without() {
    let [mut with, mut without, mut back] = [0; 3];
    for seed in 0..42 {
        let (passed_it, held) = passed(&led(seed, &[Effect::Continuous]));
        with += passed_it;
        back += usize::from(held >= THROWN.into());
        let (passed_it, held) = passed(&led(seed, &[]));
        without += passed_it;
        assert_eq!(held, 0);
    }
    assert_eq!((with, back), (0, 42));
    assert_eq!(without, 42 * THROWN as usize, "nothing else stops them");
}

/// A body is led through a wall along a path, slowly: it stands before the wall as long as the path
/// is beyond, and goes on when the path comes back.
#[test]
fn what_is_led_through_a_wall_waits_before_it() {
    let keyframe = |time: f64, x: f64| Keyframe { time, pose: Pose::at(DVec3::X * x) };
    let path = KeyframedPath::new(
        vec![keyframe(0.0, -2.0), keyframe(1.0, 2.0), keyframe(2.0, -2.0)],
        Interpolation::Linear,
        PathEnd::Hold,
    );
    let wall = cube("wall", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
    let guest = BodyDescription {
        path: Some(Arc::new(path.unwrap())),
        ..cube("guest", BodyKind::Kinematic, DVec3::X * -2.0, DVec3::ZERO)
    };
    for (sensor, stops) in [(false, true), (true, false)] {
        let wall = BodyDescription { sensor, ..wall.clone() };
        let effects = [Effect::Continuous, Effect::TRIGGER];
        let bodies = vec![wall, guest.clone()];
        let scene = SceneDescription { duration: 2.0, ..scene(bodies, &effects) };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        let (mut farthest, mut waiting) = (f32::MIN, 0);
        while app.step().unwrap() {
            let world = app.app_mut().world_mut();
            let held = world.resource::<HeldBack>().bodies;
            let mut places = world.query::<(&Body, &Transform)>();
            let at = places.iter(world).find(|(body, _)| body.id.0 == 1).unwrap().1.translation.x;
            farthest = farthest.max(at);
            waiting += usize::from(held == 1);
        }
        assert_eq!((farthest < -1.0, waiting > 60), (stops, stops), "{farthest}, {waiting}");
        assert!(!stops || farthest > -1.001, "{farthest}: it stops where it meets the wall");
    }
}

/// A rod that only turns, about its middle, stops before a post that stands in its circle; what
/// touches at the beginning is not held, and neither is what an app puts elsewhere.
#[test]
fn what_turns_is_held_and_what_is_put_elsewhere_is_not() {
    let post = |x: f64| cube("post", BodyKind::Fixed, DVec3::new(x, 1.5, 0.0), DVec3::ZERO);
    let rod = BodyDescription {
        collision: Arc::new(Cuboid { size: [6.0, 0.1, 0.1] }.build().unwrap()),
        angular_velocity: DVec3::Z * 30.0,
        ..cube("rod", BodyKind::Kinematic, DVec3::ZERO, DVec3::ZERO)
    };
    let turned = |post: BodyDescription, put: Option<f32>| {
        let duration = 8.0 / 64.0;
        let scene = scene(vec![post, rod.clone()], &[Effect::Continuous]);
        let scene = SceneDescription { duration, ..scene };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        if let Some(x) = put {
            app.step().unwrap();
            let world = app.app_mut().world_mut();
            let rod = world.resource::<Bodies>().get(BodyId(1)).unwrap().entity;
            world.get_mut::<Transform>(rod).unwrap().translation.x = x;
        }
        while app.step().unwrap() {}
        let world = app.app_mut().world_mut();
        let rod = world.resource::<Bodies>().get(BodyId(1)).unwrap().entity;
        let (axis, angle) = world.get::<Transform>(rod).unwrap().rotation.to_axis_angle();
        (axis.z * angle, world.resource::<HeldBack>().total)
    };
    // Its upper side, 0.05 beside its middle line, meets the corner (2, 1) of the post.
    let meets = 1.0_f64.atan2(2.0) - (0.05 / 5.0_f64.sqrt()).asin();
    let (angle, held) = turned(post(1.5), None);
    assert!((f64::from(angle) - meets).abs() < 1e-3 && held > 0, "{angle}, not {meets}");
    let (angle, held) = turned(post(40.0), None);
    assert!(
        (angle - 8.0 * 30.0 / 64.0).rem_euclid(std::f32::consts::TAU).min(1.0) < 1e-3 && held == 0
    );
    assert_eq!(turned(post(1.5), Some(40.0)).1, 1, "held in its first step, then put beyond");
}

/// Far from the origin, where single precision is coarser than the gap that is kept.
#[test]
fn who_is_held_far_away_does_not_touch() {
    for i in 0..40 {
        let far = DVec3::new(20_000.3 + 0.37 * f64::from(i), 3e4, 0.0);
        let wall = cube("wall", BodyKind::Fixed, far, DVec3::ZERO);
        let from = far - DVec3::X * 8.0;
        let speed = DVec3::X * (400.0 + f64::from(i));
        let guest = cube("guest", BodyKind::Kinematic, from, speed);
        let scene = scene(vec![wall, guest], &[Effect::Continuous, Effect::TRIGGER]);
        let scene = SceneDescription { duration: 6.0 / 64.0, ..scene };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        while app.step().unwrap() {}
        let world = app.app_mut().world_mut();
        assert!(world.resource::<HeldBack>().total > 0);
        let mut places = world.query::<(&Body, &Transform)>();
        let x = |id: u32| places.iter(world).find(|(b, _)| b.id.0 == id).unwrap().1.translation.x;
        let [wall, guest] = [0, 1].map(x);
        assert!(wall - guest > 1.0 && wall - guest < 1.1, "{i}: {wall} {guest}");
    }
}

/// Two that are led at each other stop between; one that is not named runs into nobody either.
#[test]
fn who_meets_who_is_named_stops() {
    for named in [0, 1] {
        let mut bodies: Vec<_> = [-1.0, 1.0]
            .map(|side| {
                let at = DVec3::X * (5.0 * side);
                cube(&format!("at_{side}"), BodyKind::Kinematic, at, DVec3::X * (-320.0 * side))
            })
            .into();
        bodies[named].effects = vec![Effect::Continuous];
        let scene = SceneDescription { duration: 3.0 / 64.0, ..scene(bodies, &[]) };
        let mut app = SceneApp::new(&scene, &RunOptions::default()).unwrap();
        while app.step().unwrap() {}
        let world = app.app_mut().world_mut();
        let mut places = world.query::<(&Body, &Transform)>();
        let mut x: Vec<_> =
            places.iter(world).map(|(body, place)| (body.id.0, place.translation.x)).collect();
        x.sort_by_key(|(id, _)| *id);
        let gap = x[1].1 - x[0].1;
        assert!(gap > 1.0 && gap < 1.001, "{x:?}");
    }
}

/// Of bodies that nothing pulls.
fn app_of(bodies: Vec<BodyDescription>) -> SceneApp {
    app_with(SceneDescription { duration: 1_000.0, ..scene(bodies, &[Effect::Continuous]) })
}

fn app_with(scene: SceneDescription) -> SceneApp {
    let scene = SceneDescription { gravity: DVec3::ZERO, ..scene };
    SceneApp::new(&scene, &RunOptions::default()).unwrap()
}

fn place(app: &mut SceneApp, id: u32) -> Transform {
    let world = world(app);
    let entity = world.resource::<Bodies>().get(BodyId(id)).unwrap().entity;
    *world.get::<Transform>(entity).unwrap()
}

fn lead(app: &mut SceneApp, id: u32, velocity: DVec3) {
    let world = world(app);
    let entity = world.resource::<Bodies>().get(BodyId(id)).unwrap().entity;
    world.get_mut::<LinearVelocity>(entity).unwrap().0 =
        Vec3::from_array(velocity.to_array().map(|x| x as f32));
}

fn of_shape(name: &str, shape: impl Into<BodyShape>, kind: BodyKind, at: DVec3) -> BodyDescription {
    BodyDescription { shape: Some(shape.into()), ..cube(name, kind, at, DVec3::ZERO) }
}

fn block(name: &str, size: [f64; 3], kind: BodyKind, at: DVec3) -> BodyDescription {
    let collision = Arc::new(Cuboid { size }.build().unwrap());
    BodyDescription { collision, ..cube(name, kind, at, DVec3::ZERO) }
}

fn ball() -> Primitive {
    Ball { center: DVec3::ZERO, radius: 0.5 }.into()
}

/// Led straight and at angles in turn, it is ever nearer to the wall, and never in it.
#[test]
fn what_stands_at_a_wall_is_held_again_from_wherever_it_comes() {
    let rod = Capsule { ends: [DVec3::NEG_Y * 0.3, DVec3::Y * 0.3], radius: 0.5 };
    let half_space = HalfSpace { point: DVec3::ZERO, normal: DVec3::NEG_X };
    let mut rng = Rng::new(10);
    for round in 0..60 {
        let still = BodyKind::Fixed;
        let wall = match round % 2 {
            0 => block("wall", [0.2, 4e3, 4e3], still, DVec3::X * 0.1),
            _ => of_shape("wall", Primitive::HalfSpace(half_space), still, DVec3::ZERO),
        };
        let (kind, at) = (BodyKind::Kinematic, DVec3::X * -0.9);
        let guest = match round / 2 % 3 {
            0 => of_shape("guest", ball(), kind, at),
            1 => of_shape("guest", Primitive::Capsule(rod), kind, at),
            _ => cube("guest", kind, at, DVec3::ZERO),
        };
        let mut app = app_of(vec![wall, guest]);
        for _ in 0..120 {
            let angle = 1.5 * 10_f64.powf(-4.0 * rng.unit().abs());
            let way = DVec3::new(angle.sin(), rng.unit().signum() * angle.cos(), 0.0);
            lead(&mut app, 1, 100.0 * rng.unit().abs() * way);
            steps(&mut app, 1);
            let x = place(&mut app, 1).translation.x;
            assert!(x <= -0.5, "{round}: {x}");
        }
    }
}

/// A ball and a cube that fall on a half-space stop where they meet it.
#[test]
fn what_meets_a_half_space_stops_at_it() {
    for (speed, is_ball) in [(3.0, true), (64.0, true), (3.0, false), (64.0, false)] {
        let floor = HalfSpace { point: DVec3::ZERO, normal: DVec3::Z };
        let floor = of_shape("floor", Primitive::from(floor), BodyKind::Fixed, DVec3::ZERO);
        let falling = cube("falling", BodyKind::Kinematic, DVec3::Z * 3.9, DVec3::Z * -speed);
        let shape = is_ball.then(|| ball().into());
        let mut app = app_of(vec![floor, BodyDescription { shape, ..falling }]);
        steps(&mut app, 200);
        let z = place(&mut app, 1).translation.z;
        assert!((0.5..0.5001).contains(&z), "{speed} {is_ball}: {z}");
    }
}

/// Two poses do not say by how much more than half a turn a body turned.
#[test]
fn what_turns_by_more_than_half_a_turn_a_step_is_held() {
    for turn in [1.0, 3.3, 5.0, TAU, 7.0, 20.0] {
        let post = cube("post", BodyKind::Fixed, DVec3::new(1.5, 1.5, 0.0), DVec3::ZERO);
        let rod = BodyDescription {
            angular_velocity: DVec3::Z * turn * 64.0,
            ..block("rod", [6.0, 0.1, 0.1], BodyKind::Kinematic, DVec3::ZERO)
        };
        let mut app = app_of(vec![post, rod]);
        steps(&mut app, 3);
        let (axis, angle) = place(&mut app, 1).rotation.to_axis_angle();
        let angle = f64::from(axis.z * angle);
        assert!((0.43..0.45).contains(&angle), "{turn}: {angle}");
    }
}

fn touch(bodies: [&BodyDescription; 2]) -> bool {
    let build = |body: &BodyDescription| {
        BodyShape::from(Collider::from_mesh((*body.collision).clone()).unwrap().shape())
    };
    let shapes = bodies.map(build);
    let [a, b] = [0, 1]
        .map(|k| PlacedShape { shape: &shapes[k], pose: pose_of(&transform_of(&bodies[k].pose)) });
    let verdict = PairQuery::of(Demand::Intersects);
    query_shapes(a, b, &verdict, &mut PairMemory::default()).unwrap().touches()
}

/// A wall that slants, far from the origin: a cube that flies along it is held by a block, where
/// its pose is rounded, and is not rounded into the wall.
#[test]
fn who_is_held_by_one_is_not_rounded_into_another() {
    let mut rng = Rng::new(77);
    let rounded = |v: DVec3| DVec3::from_array(v.to_array().map(|x| f64::from(x as f32)));
    let mut held = 0;
    for round in 0..150 {
        let far = rounded(2e4 + 100.0 * DVec3::new(rng.unit(), rng.unit(), 0.0));
        let rotation = DQuat::from_rotation_z(0.3 + 0.5 * rng.unit().abs());
        let [along, up] = [DVec3::X, DVec3::Y].map(|axis| rotation * axis);
        let turned = |body: BodyDescription, at: DVec3| {
            let pose = Pose { rotation, translation: rounded(far + at) };
            BodyDescription { pose, ..body }
        };
        let (still, led) = (BodyKind::Fixed, BodyKind::Kinematic);
        let gap = 5e-4 + 2e-3 * rng.unit().abs(); // poses are rounded by a thousandth
        let guest = turned(cube("guest", led, far, DVec3::ZERO), (0.6 + gap) * up - 3.0 * along);
        let bodies = vec![
            turned(block("wall", [100.0, 0.2, 4.0], still, far), DVec3::ZERO),
            BodyDescription { linear_velocity: 320.0 * along, ..guest },
            turned(block("stop", [1.0, 3.6, 1.0], still, far), 2.0 * up + along),
        ];
        if touch([&bodies[0], &bodies[1]]) {
            continue; // rounded into it at the beginning
        }
        let mut app = app_of(bodies);
        steps(&mut app, 1);
        held += world(&mut app).resource::<HeldBack>().total;
        lead(&mut app, 1, -320.0 * up);
        steps(&mut app, 1);
        let at = place(&mut app, 1).translation.to_array().map(f64::from);
        let height = (DVec3::from_array(at) - far).dot(up);
        assert!(height > 0.59, "{round}: {height}");
    }
    assert!(held > 100, "{held}");
}

/// The path's end is beyond the wall, from where it goes back to its beginning by a jump.
#[test]
fn a_path_that_jumps_puts_a_body_elsewhere() {
    let place_at = |x: f64, y: f64| Pose::at(DVec3::new(x, y, 0.0));
    let corners = [(0.0, 0.0), (0.0, 4.0), (6.0, 4.0), (6.0, 0.0)];
    let keyframes = (0..)
        .zip(corners)
        .map(|(i, (x, y))| Keyframe { time: 0.5 * f64::from(i), pose: place_at(x, y) });
    let path = KeyframedPath::new(keyframes.collect(), Interpolation::Linear, PathEnd::Loop);
    let wall = cube("wall", BodyKind::Fixed, DVec3::X * 3.0, DVec3::ZERO);
    let guest = BodyDescription {
        path: Some(Arc::new(path.unwrap())),
        ..cube("guest", BodyKind::Kinematic, DVec3::ZERO, DVec3::ZERO)
    };
    let mut app = app_of(vec![wall, guest]);
    steps(&mut app, 110); // the path takes 96 steps
    assert_eq!(world(&mut app).resource::<HeldBack>().total, 0);
    assert!(place(&mut app, 1).translation.x.abs() < 1e-3);
}

/// A body, and a wall, that come while the app runs are held, and hold, in their first step.
#[test]
fn newcomers_are_held_in_their_first_step() {
    for wall_is_last in [false, true] {
        let mut app = empty(&[Effect::Continuous]);
        let speed = LinearVelocity(Vec3::X * 320.0); // 5 a step
        let spawn_wall = |app: &mut SceneApp| {
            world(app).spawn((unit(), Transform::default(), RigidBody::Fixed));
        };
        if !wall_is_last {
            spawn_wall(&mut app);
        }
        let from = if wall_is_last { -7.0 } else { -2.0 };
        steps(&mut app, 1);
        let guest = (unit(), Transform::from_xyz(from, 0.0, 0.0), RigidBody::Kinematic, speed);
        let guest = world(&mut app).spawn(guest).id();
        if wall_is_last {
            steps(&mut app, 1);
            spawn_wall(&mut app);
        }
        steps(&mut app, 1);
        let x = world(&mut app).get::<Transform>(guest).unwrap().translation.x;
        assert!((-1.001..-1.0).contains(&x), "{wall_is_last}: {x}");
    }
}

/// Where an app sets `Transform` in a step before bodies move, no way leads there.
#[test]
fn what_an_app_puts_elsewhere_within_a_step_is_there() {
    for set in StepSystems::ALL.into_iter().filter(|set| *set != StepSystems::Advance) {
        let wall = cube("wall", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
        let guest = cube("guest", BodyKind::Kinematic, DVec3::X * -3.0, DVec3::ZERO);
        let mut app = app_of(vec![wall, guest]);
        let put = |mut places: Query<(&Body, &mut Transform)>, time: Res<SimulatedTime>| {
            for (body, mut place) in &mut places {
                if body.id.0 == 1 && time.steps() == 3 {
                    place.translation.x = 3.0;
                }
            }
        };
        app.app_mut().add_systems(CrannyStep, put.in_set(set));
        steps(&mut app, 6);
        assert_eq!(place(&mut app, 1).translation.x, 3.0, "{set:?}");
    }
}

/// Bodies in other layers, pairs that do not collide and bodies that nobody named pass.
#[test]
fn who_does_not_collide_or_is_not_named_passes() {
    let passes = |change: &dyn Fn(&mut SceneDescription)| {
        let wall = cube("wall", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
        let guest = cube("guest", BodyKind::Kinematic, DVec3::X * -3.0, DVec3::X * 320.0);
        // Another one is named, so that ways are looked at.
        let other = cube("other", BodyKind::Kinematic, DVec3::Y * 9.0, DVec3::X);
        let bodies = vec![wall, guest, other];
        let mut scene = SceneDescription { duration: 1.0, ..scene(bodies, &[]) };
        scene.bodies[2].effects = vec![Effect::Continuous];
        change(&mut scene);
        let mut app = app_with(scene);
        steps(&mut app, 4);
        place(&mut app, 1).translation.x > 0.0
    };
    let name = |scene: &mut SceneDescription| scene.bodies[1].effects = vec![Effect::Continuous];
    assert!(passes(&|_| ()), "it is not named");
    assert!(!passes(&name));
    assert!(passes(&|scene| {
        name(scene);
        scene.bodies[0].layers = vec!["other".into()];
    }));
    let pair = |effects: Vec<Effect>| PairDescription {
        a: "wall".into(),
        b: "guest".into(),
        effects,
        accuracy: None,
    };
    assert!(!passes(&|scene| scene.pairs = vec![pair(vec![Effect::Continuous])]));
    assert!(passes(&|scene| {
        name(scene);
        scene.excluded_pairs = vec![(0, 1)];
    }));
}

/// On the floor of a room that is one mesh, in touch or nearly: a cube does not pass the wall, and
/// comes into it by no more than a millionth.
#[test]
fn what_touches_a_floor_is_held_by_the_wall_of_the_same_body() {
    for (speed, gap) in [(2.0, 0.0), (100.0, 0.0), (1_000.0, 0.0), (100.0, 1e-5)] {
        let room = cranny_shapes::Boxes {
            add: vec![[[-4.0; 3], [4.0; 3]]],
            cut: vec![[[-3.5; 3], [3.5; 3]]],
        };
        let room = BodyDescription {
            collision: Arc::new(room.build().unwrap()),
            ..cube("room", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO)
        };
        let at = DVec3::Z * (-3.0 + gap);
        let guest = cube("guest", BodyKind::Kinematic, at, DVec3::X * speed);
        let mut app = app_of(vec![room, guest]);
        steps(&mut app, 192);
        let x = place(&mut app, 1).translation.x;
        assert!((2.99..=3.0 + 1e-6).contains(&x), "{speed}, {gap}: {x}");
        lead(&mut app, 1, DVec3::NEG_X);
        steps(&mut app, 64);
        let back = place(&mut app, 1).translation.x;
        assert!((x - 1.0 - back).abs() < 0.02, "it leaves the wall: {x}, {back}");
    }
}

/// What touches a wall is led no deeper into it.
#[test]
fn what_touches_a_wall_comes_no_nearer() {
    for is_ball in [false, true] {
        let wall = cube("wall", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO);
        let guest = cube("guest", BodyKind::Kinematic, DVec3::X * -1.0, DVec3::X * 128.0);
        let shape = is_ball.then(|| ball().into());
        let mut app = app_of(vec![wall, BodyDescription { shape, ..guest }]);
        steps(&mut app, 4);
        let x = place(&mut app, 1).translation.x;
        assert!((-1.001..-0.999).contains(&x), "{is_ball}: {x}");
    }
}

/// A half-space at any attitude holds what comes, and nobody else.
#[test]
fn a_slanting_half_space_holds_nobody_who_leaves() {
    let mut rng = Rng::new(5);
    for round in 0..40 {
        let rotation = rng.rotation();
        let up = rotation * DVec3::Z;
        let plane = HalfSpace { point: DVec3::ZERO, normal: DVec3::Z };
        let ground = of_shape("ground", Primitive::from(plane), BodyKind::Fixed, DVec3::ZERO);
        let pose = Pose { rotation, translation: DVec3::ZERO };
        let guest = cube("guest", BodyKind::Kinematic, 10.0 * up, 6.4 * up);
        let shape = (round % 2 == 0).then(|| ball().into());
        let bodies = vec![BodyDescription { pose, ..ground }, BodyDescription { shape, ..guest }];
        let mut app = app_of(bodies);
        let height = |app: &mut SceneApp| {
            DVec3::from_array(place(app, 1).translation.to_array().map(f64::from)).dot(up)
        };
        steps(&mut app, 10);
        let above = height(&mut app);
        assert!((above - 11.0).abs() < 1e-3, "{round}: {above}");
        lead(&mut app, 1, -320.0 * up);
        steps(&mut app, 10);
        let above = height(&mut app);
        assert!((0.49..0.9).contains(&above), "{round}: {above}");
    }
}

/// One that runs after another does not stop it, and a wall without velocities is a wall.
#[test]
fn who_is_pursued_goes_on_and_what_has_no_velocity_holds() {
    let front = cube("front", BodyKind::Kinematic, DVec3::ZERO, DVec3::X);
    let behind = cube("behind", BodyKind::Kinematic, DVec3::X * -1.5, DVec3::X * 2.0);
    let mut app = app_of(vec![front, behind]);
    steps(&mut app, 320);
    let [front, behind] = [0, 1].map(|id| place(&mut app, id).translation.x);
    assert!((front - 5.0).abs() < 1e-3 && front - behind > 1.0 && front - behind < 1.1, "{behind}");
    let mut app = empty(&[Effect::Continuous]);
    let wall = world(&mut app).spawn((unit(), Transform::default(), RigidBody::Fixed)).id();
    let speed = LinearVelocity(Vec3::X * 320.0);
    let guest = (unit(), Transform::from_xyz(-6.0, 0.0, 0.0), RigidBody::Kinematic, speed);
    let guest = world(&mut app).spawn(guest).id();
    steps(&mut app, 1);
    world(&mut app).entity_mut(wall).remove::<(LinearVelocity, AngularVelocity)>();
    steps(&mut app, 4);
    assert!(world(&mut app).get::<Transform>(guest).unwrap().translation.x < -1.0);
}

/// What touches a thin floor is led no deeper into it, wherever it stands.
#[test]
fn what_touches_a_thin_floor_is_not_led_through() {
    let mut rng = Rng::new(3);
    for i in 0..30 {
        let (size, sunk) = ([0.2, 1.0][i % 2], [0.0, 1e-7, 1e-5, 1e-4][i / 2 % 4]);
        let floor = BodyDescription {
            collision: Arc::new(Cuboid { size: [80.0, 80.0, 0.02] }.build().unwrap()),
            ..cube("floor", BodyKind::Fixed, DVec3::Z * -0.01, DVec3::ZERO)
        };
        let at = DVec3::new(3.0 * rng.unit(), 3.0 * rng.unit(), 0.5 * size - sunk);
        let guest = BodyDescription {
            collision: Arc::new(Cuboid { size: [size; 3] }.build().unwrap()),
            ..cube("guest", BodyKind::Kinematic, at, DVec3::Z * -25.6)
        };
        let mut app = app_of(vec![floor, guest]);
        steps(&mut app, 31);
        let came = at.z - f64::from(place(&mut app, 1).translation.z);
        assert!(came < 1e-6 + 2.0 * sunk, "{size}, {sunk} deep: by {came}");
        lead(&mut app, 1, DVec3::X);
        steps(&mut app, 64);
        let slid = f64::from(place(&mut app, 1).translation.x) - at.x;
        assert!((slid - 1.0).abs() < 0.02, "{size}, {sunk} deep: it slid by {slid}");
    }
}
