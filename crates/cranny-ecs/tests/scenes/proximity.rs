//! How near bodies are.

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_world::description::Effect;

use crate::build::{empty, gate, steps, unit, up, world};

const NEAR: Effect = Effect::proximity(0.6);

fn report(app: &SceneApp) -> &ProximityReport {
    app.app().world().resource::<ProximityReport>()
}

/// The guest is a quarter of its side farther on in each step, at speed 1.
#[test]
fn what_is_nearer_is_reported_with_points_and_speed_and_what_is_not_costs_no_query() {
    let mut app = SceneApp::new(&gate(&[NEAR]), &RunOptions::default()).unwrap();
    let mut seen = Vec::new();
    while app.step().unwrap() {
        let step = report(&app).step;
        let x = -4.0 + 0.25 * step as f64; // the guest's, a side to either side
        let gap = (x.abs() - 1.0).max(0.0);
        let near = report(&app).pairs.first().copied();
        assert_eq!(near.is_some(), gap < 0.6, "step {step}");
        let stats = app.app().world().resource::<Detected>().report.as_ref().unwrap().stats;
        assert!(gap <= 1.2 || stats.queried_pairs == 0, "step {step}: {stats:?}");
        let Some(near) = near else { continue };
        assert!((near.distance - gap).abs() < 1e-12, "step {step}: {near:?}");
        seen.push(near);
        if gap > 0.0 {
            let speed = if x < 0.0 { 1.0 } else { -1.0 };
            assert!((near.speed.unwrap() - speed).abs() < 1e-6, "step {step}: {near:?}");
            let [p, q] = near.points.unwrap();
            let way = q - p; // from the gate to the guest
            assert!((way - gap * x.signum() * DVec3::X).length() < 1e-12, "{near:?}");
        } else {
            assert_eq!((near.distance, near.speed), (0.0, Some(0.0)));
        }
    }
    assert_eq!(seen.len(), 13);
}

#[test]
fn the_nearest_is_seen_from_the_body_that_asks() {
    let options = RunOptions::default();
    let mut app = SceneApp::new(&crate::build::scene(Vec::new(), &[NEAR]), &options).unwrap();
    let mut spawn = |x: f32| {
        let body = (RigidBody::Kinematic, unit(), Transform::from_xyz(x, 0.0, 0.0));
        world(&mut app).spawn(body).id()
    };
    let [left, right, me, far] = [-1.5, 1.25, 0.0, 9.0].map(&mut spawn);
    world(&mut app).entity_mut(me).insert(LinearVelocity(Vec3::new(2.0, 0.0, 0.0)));
    steps(&mut app, 1);
    let nearest = report(&app).nearest(me).unwrap();
    assert_eq!((nearest.body, nearest.other), (me, right));
    assert!((nearest.distance - 0.25).abs() < 1e-7 && (nearest.speed.unwrap() - 2.0).abs() < 1e-6);
    let all: Vec<(Entity, Option<f64>)> = report(&app).of(me).map(|p| (p.other, p.speed)).collect();
    assert_eq!(all, [(left, Some(-2.0)), (right, Some(2.0))]);
    assert_eq!(report(&app).nearest(far), None);
}

/// With a solver, whose answers need hold no distance, and with triggers and contacts beside it:
/// all the way of a body that falls, lands and rests.
#[cfg(feature = "rapier")]
#[test]
fn other_effects_of_a_pair_change_no_distance() {
    let others = [Effect::TRIGGER, Effect::Contacts { margin: 0.1 }, Effect::Response];
    let run = |effects: &[Effect]| {
        let mut app = empty(&[&[NEAR], effects].concat());
        world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0)));
        let falls = LinearVelocity(Vec3::new(0.5, 0.0, -1.0));
        let tilted = Transform { rotation: Quat::from_rotation_x(0.3), ..up(1.7) };
        world(&mut app).spawn((RigidBody::Dynamic, unit(), tilted, falls));
        let mut found = Vec::new();
        for _ in 0..60 {
            steps(&mut app, 1);
            let near = report(&app).pairs.first().copied();
            if let Some(near) = near.filter(|near| near.points.is_none()) {
                assert_eq!((near.distance, near.speed), (0.0, Some(0.0)));
            }
            found.push(near.map(|near| (near.distance, near.points)));
        }
        found
    };
    let alone = run(&others[2..]);
    let lengths: Vec<f64> = alone.iter().flatten().map(|(distance, _)| *distance).collect();
    assert!(lengths.len() > 50 && lengths.contains(&0.0) && lengths[0] > 0.3, "{lengths:?}");
    // It digs in a little.
    assert!(alone.iter().flatten().any(|(_, points)| points.is_none()), "{alone:?}");
    let answered = [Effect::TRIGGER, Effect::Response];
    for effects in [&others[..], &others[1..], &answered] {
        assert_eq!(run(effects), alone, "{effects:?}");
    }
    // Without a solver it stands still.
    let still = run(&[]);
    assert!(still[0].is_some_and(|(distance, _)| distance > 0.0));
    for effects in [&others[..1], &others[..2], &others[1..2]] {
        assert_eq!(run(effects), still, "{effects:?}");
    }
}

/// Nothing is known of the wall that it may be nearing.
#[test]
fn a_primitive_inside_a_body_meets_nothing_and_has_no_speed() {
    let mut app = empty(&[NEAR]);
    world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0)));
    let moves = LinearVelocity(Vec3::new(0.1, 0.0, 0.0));
    world(&mut app).spawn((RigidBody::Kinematic, Collider::ball(0.1), up(0.0), moves));
    steps(&mut app, 1);
    let near = report(&app).pairs[0];
    assert_eq!((near.distance, near.points, near.speed), (0.0, None, None));
}

#[test]
fn a_distance_that_is_none_is_refused() {
    for within in [0.0, -1.0, f64::NAN] {
        let refused = SceneApp::new(&gate(&[Effect::proximity(within)]), &RunOptions::default());
        let refused = refused.err().expect("it is no distance").to_string();
        assert!(refused.contains("`within` of Proximity of the scene"), "{refused}");
    }
}
