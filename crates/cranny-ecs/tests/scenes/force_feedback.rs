//! What a hand feels: no kicks, no tunnels, the spring's force on a face.

use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_shapes::{Cuboid, Cup, LPrism, Torus};
use cranny_world::description::Effect;
use proptest::prelude::*;

use crate::build::{empty, steps, unit, up, world};

const STIFFNESS: f64 = 1000.0;

fn built(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).unwrap().0
}

fn cube(size: f64) -> Model {
    built(Cuboid { size: [size; 3] }.build().unwrap())
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::at(DVec3::new(x, y, z))
}

/// Drags a body along poses among obstacles; asserts that force and torque jump no farther than
/// they may, and that the proxy is never in an obstacle.
fn drag(body: &Model, obstacles: &[(&Model, Pose)], poses: &[Pose]) -> Vec<(Wrench, Pose)> {
    let mut proxy = Proxy::at(poses[0]);
    let ids = (0..).map(BodyId);
    let obstacles: Vec<Obstacle<'_>> = obstacles
        .iter()
        .zip(ids)
        .map(|(&(model, pose), id)| Obstacle { id, placed: Placed { model, pose } })
        .collect();
    let mut felt: Vec<(Wrench, Pose)> = Vec::new();
    for (tick, &pose) in poses.iter().enumerate() {
        let wrench = proxy.follow(Placed { model: body, pose }, &obstacles, STIFFNESS).unwrap();
        let placed = Placed { model: body, pose: proxy.pose() };
        for obstacle in &obstacles {
            let ask = Query::of(Demand::Intersects);
            let answer = query(obstacle.placed, placed, &ask, &mut PairMemory::default()).unwrap();
            assert!(!answer.touches(), "tick {tick}: the proxy is in an obstacle");
        }
        if let Some((before, last)) = felt.last() {
            let arm = 0.5 * body.radius();
            let (from, to) = (poses[tick - 1], pose);
            let center = body.mass_properties().unwrap().center;
            let place = |pose: Pose| pose.world_from_body().apply(center);
            let moved = place(to).distance(place(from));
            let turned = (to.rotation * from.rotation.conjugate()).to_scaled_axis().length();
            let most = 1.5 * STIFFNESS * moved.hypot(arm * turned);
            let force = wrench.force - before.force;
            let torque = (wrench.torque - before.torque) / arm;
            let jump = force.length().hypot(torque.length());
            // Beyond 2 radians between proxy and body nothing is promised.
            let against = |proxy: Pose, body: Pose| {
                let turn = proxy.rotation * body.rotation.conjugate();
                2.0 * turn.w.abs().min(1.0).acos()
            };
            let turned = against(*last, from).max(against(proxy.pose(), to));
            let kicks = jump > most * (1.0 + 1e-6) + 1e-9;
            assert!(!kicks || turned > 2.0, "tick {tick}: {jump} of {most}, {turned}");
        }
        felt.push((wrench, proxy.pose()));
    }
    felt
}

/// From one pose to the next in so many ticks.
fn way(poses: &[Pose], ticks: u32) -> Vec<Pose> {
    let mut all = vec![poses[0]];
    for pair in poses.windows(2) {
        all.extend((1..=ticks).map(|tick| {
            let t = f64::from(tick) / f64::from(ticks);
            let translation = pair[0].translation.lerp(pair[1].translation, t);
            Pose { rotation: pair[0].rotation.slerp(pair[1].rotation, t), translation }
        }));
    }
    all
}

#[test]
fn a_face_pushes_back_by_stiffness_times_depth_and_lets_slide() {
    let (body, floor) = (cube(0.2), built(Cuboid { size: [4.0, 4.0, 1.0] }.build().unwrap()));
    let poses =
        way(&[at(0.0, 0.0, 0.7), at(0.0, 0.0, 0.5), at(1.0, 0.3, 0.5), at(1.0, 0.3, 0.7)], 200);
    let felt = drag(&body, &[(&floor, at(0.0, 0.0, 0.0))], &poses);
    assert_eq!(felt[40].0, Wrench::default(), "it is not there yet");
    let deepest = felt[200].0;
    assert!((deepest.force - 100.0 * DVec3::Z).length() < 1.0, "{deepest:?}");
    assert!(deepest.torque.length() < 1.0, "{deepest:?}");
    // Along the face nothing holds it.
    for (wrench, proxy) in &felt[210..400] {
        assert!((wrench.force - 100.0 * DVec3::Z).length() < 1.0, "{wrench:?}");
        assert!((proxy.translation.z - 0.6).abs() < 0.001, "{proxy:?}");
    }
    assert_eq!(felt.last().unwrap().0, Wrench::default(), "it has left");
}

/// A bar whose one end is pressed into an edge is turned.
#[test]
fn what_is_held_at_one_end_is_turned() {
    let bar = built(Cuboid { size: [2.0, 0.1, 0.1] }.build().unwrap());
    let post = built(Cuboid { size: [0.1, 0.5, 1.0] }.build().unwrap());
    let poses = way(&[at(0.0, 0.0, 0.7), at(0.0, 0.0, 0.45)], 300);
    let felt = drag(&bar, &[(&post, at(0.8, 0.0, 0.0))], &poses);
    let last = felt.last().unwrap().0;
    // The force acts at x = 0.75 or more, up: it turns about -y.
    assert!(last.force.z > 10.0 && last.torque.y < -5.0, "{last:?}");
    assert!(last.torque.x.abs() < 0.5 && last.torque.z.abs() < 0.5, "{last:?}");
}

/// Over the edge of a block while it is pressed into it: the way on which a spring to the nearest
/// surface jumps from top to side.
#[test]
fn an_edge_is_no_kick() {
    let (body, block) = (cube(0.2), cube(1.0));
    for depth in [0.02, 0.1, 0.3] {
        let low = 0.6 - depth;
        let poses = way(
            &[at(0.0, 0.0, 0.7), at(0.0, 0.0, low), at(0.9, 0.0, low), at(0.9, 0.0, -0.5)],
            300,
        );
        let felt = drag(&body, &[(&block, Pose::IDENTITY)], &poses);
        assert_eq!(felt.last().unwrap().0, Wrench::default(), "depth {depth}: it is free");
    }
}

fn concave() -> Vec<Model> {
    vec![
        built(Cup::default().build().unwrap()),
        built(Torus::default().build().unwrap()),
        built(LPrism::default().build().unwrap()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Through and along concave bodies, by random ways with turns.
    #[test]
    fn no_way_along_concave_bodies_kicks(
        obstacle in 0usize..3,
        body in 0usize..2,
        corners in prop::collection::vec(
            (prop::array::uniform3(-1.0f64..1.0), prop::array::uniform3(-1.0f64..1.0)), 4),
    ) {
        let obstacle = &concave()[obstacle];
        let bounds = obstacle.bounds();
        let size = bounds.max - bounds.min;
        let ring = Torus::default().build().unwrap().scaled(DVec3::splat(0.2)).unwrap();
        let body = &[cube(0.2 * size.min_element()), built(ring)][body];
        let place = |[x, y, z]: [f64; 3], turn: [f64; 3]| Pose {
            rotation: DQuat::from_scaled_axis(0.5 * DVec3::from_array(turn)),
            translation: bounds.center() + 0.6 * size * DVec3::new(x, y, z),
        };
        let start = Pose::at(bounds.max + size);
        let mut poses = vec![start];
        poses.extend(corners.into_iter().map(|(x, turn)| place(x, turn)));
        drag(body, &[(obstacle, Pose::IDENTITY)], &way(&poses, 60));
    }
}

/// The effect: a kinematic cube is moved into a fixed one, at 64 steps a second.
#[test]
fn a_scene_of_few_steps_is_felt_at_a_kilohertz() {
    let mut app = empty(&[]);
    let stiff = ForceFeedback { stiffness: 1.0 };
    world(&mut app).spawn((RigidBody::Kinematic, unit(), up(9.0), stiff));
    let failed = app.step().unwrap_err().to_string();
    assert!(failed.contains("asks for ForceFeedback"), "{failed}");

    let mut app = empty(&[Effect::ForceFeedback { stiffness: STIFFNESS }]);
    let floor = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
    let down = LinearVelocity(Vec3::new(0.0, 0.0, -0.64));
    let hand = world(&mut app).spawn((RigidBody::Kinematic, unit(), up(1.1), down)).id();
    let mut all: Vec<Wrench> = Vec::new();
    for _ in 0..20 {
        steps(&mut app, 1);
        let report = app.app().world().resource::<ForceFeedbackReport>();
        assert!(report.of(floor).is_none(), "nobody moves it");
        let felt = report.of(hand).unwrap();
        assert_eq!(felt.wrenches.len(), 16);
        all.extend(&felt.wrenches);
    }
    // After 19 moves of a hundredth it is in by 0.09.
    let last = all.last().unwrap().force;
    assert!((last - 90.0 * DVec3::Z).length() < 2.0, "{last}");
    let jumps = all.windows(2).map(|pair| (pair[1].force - pair[0].force).length());
    let most = 1.5 * STIFFNESS * 0.64 / 64.0 / 16.0;
    assert!(jumps.fold(0.0, f64::max) <= most * (1.0 + 1e-3));
    world(&mut app).despawn(hand);
    steps(&mut app, 1);
    assert!(app.app().world().resource::<ForceFeedbackReport>().bodies.is_empty());
}

/// A sensor pushes nobody, and so no hand.
#[test]
fn a_hand_feels_no_sensor() {
    let felt = |sensor: bool| {
        let mut app = empty(&[Effect::ForceFeedback { stiffness: STIFFNESS }]);
        let floor = world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0))).id();
        if sensor {
            world(&mut app).entity_mut(floor).insert(Sensor).remove::<Trigger>();
        }
        let down = LinearVelocity(Vec3::new(0.0, 0.0, -0.64));
        let hand = world(&mut app).spawn((RigidBody::Kinematic, unit(), up(1.1), down)).id();
        steps(&mut app, 20);
        let report = app.app().world().resource::<ForceFeedbackReport>();
        report.of(hand).and_then(|felt| felt.wrenches.last().copied()).unwrap_or_default().force.z
    };
    assert!(felt(false) > 50.0);
    assert_eq!(felt(true), 0.0);
}

/// What comes to the hand pushes it, although the hand keeps still.
#[test]
fn an_obstacle_that_moves_is_felt() {
    let mut app = empty(&[Effect::ForceFeedback { stiffness: STIFFNESS }]);
    let hand = (RigidBody::Kinematic, unit(), up(1.1), LinearVelocity(Vec3::ZERO));
    let hand = world(&mut app).spawn(hand).id();
    let lift = (RigidBody::Kinematic, unit(), up(0.0), LinearVelocity(Vec3::new(0.0, 0.0, 0.64)));
    let lift = world(&mut app).spawn(lift).id();
    steps(&mut app, 21);
    let report = app.app().world().resource::<ForceFeedbackReport>();
    let force = |body| report.of(body).unwrap().wrenches.last().unwrap().force;
    assert!((force(hand) - 100.0 * DVec3::Z).length() < 2.0, "{}", force(hand));
    assert!((force(lift) + 100.0 * DVec3::Z).length() < 2.0, "both are kinematic");
    let at: &Transform = app.app().world().get(hand).unwrap();
    assert_eq!(at.translation.z, 1.1, "a proxy moves nobody");
}
