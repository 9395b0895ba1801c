//! How deep bodies overlap, and ways out.

use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_ecs::*;
use cranny_exact::DVec3;
use cranny_shapes::{Cup, Torus};
use cranny_world::description::Effect;

use crate::build::{cuboid, empty, gate, steps, unit, up, world};

fn report(app: &SceneApp) -> &PenetrationReport {
    app.app().world().resource::<PenetrationReport>()
}

/// The guest passes through the gate, a quarter of its side a step.
#[test]
fn the_depth_follows_a_body_through_another() {
    let mut app = SceneApp::new(&gate(&[Effect::Penetration]), &RunOptions::default()).unwrap();
    let mut overlaps = 0;
    while app.step().unwrap() {
        let step = report(&app).step;
        let x = -4.0 + 0.25 * step as f64;
        let pair = report(&app).pairs.first().copied();
        let overlap = 1.0 - x.abs();
        assert_eq!(pair.is_some(), overlap > 0.0, "step {step}");
        let Some(pair) = pair else { continue };
        overlaps += 1;
        assert!(pair.way.length() >= overlap.min(1.0) - 1e-9, "step {step}: {pair:?}");
        // Along the shared sides it is as deep as it is wide: those coincide to the bit.
        if x != 0.0 {
            let depth = pair.depth.expect("they cross");
            assert!((depth - overlap).abs() < 1e-6, "step {step}: {pair:?}");
            assert!((pair.way - overlap * x.signum() * DVec3::X).length() < 1e-6, "{pair:?}");
        }
    }
    assert_eq!(overlaps, 7);
}

/// Whoever has no solver moves bodies out by their ways; where they rest then nothing overlaps.
#[test]
fn bodies_that_are_moved_by_their_ways_overlap_no_more() {
    let mut app = empty(&[Effect::Penetration]);
    let ring = Collider::from_mesh(Torus::default().build().unwrap()).unwrap();
    let cup = Collider::from_mesh(Cup::default().build().unwrap()).unwrap();
    let tilted = |x: f32, angle: f32| Transform {
        rotation: Quat::from_rotation_x(angle),
        ..Transform::from_xyz(x, 0.2, 0.1)
    };
    let fixed = world(&mut app).spawn((RigidBody::Fixed, ring, tilted(0.0, 0.4))).id();
    let moved = world(&mut app).spawn((RigidBody::Kinematic, cup, tilted(0.7, 1.1))).id();
    steps(&mut app, 1);
    let pair = report(&app).of(fixed).next().expect("they overlap");
    assert_eq!((pair.body, pair.other), (fixed, moved));
    let flipped = report(&app).of(moved).next().unwrap();
    assert_eq!((flipped.body, flipped.way), (moved, -pair.way));
    let way = pair.way * (1.0 + 1e-6); // a Transform is f32
    let way = Vec3::new(way.x as f32, way.y as f32, way.z as f32);
    world(&mut app).get_mut::<Transform>(moved).unwrap().translation += way;
    steps(&mut app, 1);
    assert_eq!(report(&app).pairs, []);
}

#[test]
fn what_lies_inside_has_a_way_and_no_depth() {
    let mut app = empty(&[]);
    let large = (RigidBody::Fixed, cuboid([8.0; 3]), up(0.0), Penetration);
    world(&mut app).spawn(large);
    let failed = app.step().unwrap_err().to_string();
    assert!(failed.contains("asks for Penetration"), "{failed}");
    let mut app = empty(&[Effect::Penetration]);
    world(&mut app).spawn((RigidBody::Fixed, cuboid([8.0; 3]), up(0.0)));
    world(&mut app).spawn((RigidBody::Kinematic, unit(), up(3.0)));
    steps(&mut app, 1);
    let pair = report(&app).pairs[0];
    assert_eq!(pair.depth, None);
    assert!((pair.way - 1.5 * DVec3::Z).length() < 1e-6, "{pair:?}");
}

/// With a solver, whose answers need hold no regions, and beside effects that take them.
#[cfg(feature = "rapier")]
#[test]
fn other_effects_of_a_pair_change_no_way() {
    let others = [Effect::TRIGGER, Effect::Contacts { margin: 0.1 }, Effect::Response];
    let run = |effects: &[Effect]| {
        let mut app = empty(&[&[Effect::Penetration], effects].concat());
        world(&mut app).spawn((RigidBody::Fixed, unit(), up(0.0)));
        let tilted = Transform { rotation: Quat::from_rotation_x(0.3), ..up(0.9) };
        world(&mut app).spawn((RigidBody::Dynamic, unit(), tilted));
        let ways = (0..10).map(|_| {
            steps(&mut app, 1);
            report(&app).pairs.first().map(|pair| (pair.depth, pair.way))
        });
        ways.collect::<Vec<_>>()
    };
    let alone = run(&others[2..]);
    assert!(alone[0].is_some());
    for effects in [&others[..], &others[1..], &[Effect::TRIGGER, Effect::Response]] {
        assert_eq!(run(effects), alone, "{effects:?}");
    }
    assert_eq!(run(&[]), vec![alone[0]; 10], "without a solver it stands still");
}
