//! Shape casts of polyhedra, against times that anybody can compute.

use cranny_rapier::dispatcher;
use cranny_shapes::{Cup, Torus};
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::query::details::{NonlinearRigidMotion, ShapeCastOptions};
use rapier3d::parry::query::{QueryDispatcher, ShapeCastHit, ShapeCastStatus};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::{ColliderBuilder, RigidBodyBuilder};

use crate::world::{World, cuboid, model, ours, up};

/// Steps of f32 at times about 1, and the tolerance.
const EXACT: Real = 1e-5;

fn straight(
    g1: &SharedShape,
    g2: &SharedShape,
    from: Pose,
    velocity: Vector,
) -> Option<ShapeCastHit> {
    let options = ShapeCastOptions::with_max_time_of_impact(100.0);
    dispatcher().cast_shapes(&from, velocity, &**g1, &**g2, options).expect("known")
}

fn partners() -> [(&'static str, SharedShape); 4] {
    let corners: Vec<Vector> = (0..8)
        .map(|i| Vector::new((i & 1) as Real, (i >> 1 & 1) as Real, (i >> 2) as Real) - 0.5)
        .collect();
    [
        ("ours", ours(&cuboid(1.0, 1.0, 1.0))),
        ("cuboid", SharedShape::cuboid(0.5, 0.5, 0.5)),
        ("convex polyhedron", SharedShape::convex_hull(&corners).expect("a cube")),
        ("triangle mesh", {
            let mesh = cranny_rapier::Detector::RapierTrimesh.shape(&cuboid(1.0, 1.0, 1.0), 0);
            mesh.expect("parry takes a cube")
        }),
    ]
}

#[test]
fn cubes_that_fly_at_a_cube_meet_it_in_time() {
    let cube = ours(&cuboid(1.0, 1.0, 1.0));
    for (name, partner) in partners() {
        // 2 − 1 = 1 apart, by 4 a second.
        let hit = straight(&cube, &partner, up(2.0), Vector::new(0.0, 0.0, -4.0)).expect(name);
        assert!((hit.time_of_impact - 0.25).abs() < EXACT, "{name}: {}", hit.time_of_impact);
        assert!(hit.time_of_impact <= 0.25, "{name}: conservative");
        assert_eq!(hit.status, ShapeCastStatus::Converged, "{name}");
        assert!((hit.normal1 - Vector::Z).length() < EXACT, "{name}: {}", hit.normal1);
        assert!((hit.normal2 + Vector::Z).length() < EXACT, "{name}: {}", hit.normal2);
        assert!((hit.witness1.z - 0.5).abs() < EXACT, "{name}: {}", hit.witness1);
        assert!((hit.witness2.z + 0.5).abs() < EXACT, "{name}: {}", hit.witness2);
        // The other order, in the other's frame.
        let hit = straight(&partner, &cube, up(-2.0), Vector::new(0.0, 0.0, 4.0)).expect(name);
        assert!((hit.time_of_impact - 0.25).abs() < EXACT, "{name}: {}", hit.time_of_impact);
        // Past it, away from it, and not at all.
        let beside = Pose::translation(1.01, 0.0, 2.0);
        assert!(straight(&cube, &partner, beside, Vector::new(0.0, 0.0, -4.0)).is_none(), "{name}");
        assert!(straight(&cube, &partner, up(2.0), Vector::Z).is_none(), "{name}");
        assert!(straight(&cube, &partner, up(2.0), Vector::ZERO).is_none(), "{name}");
    }
}

/// A turned cube meets with an edge: half a diagonal lower.
#[test]
fn an_edge_comes_first() {
    let cube = ours(&cuboid(1.0, 1.0, 1.0));
    let turned = Rotation::from_rotation_x(std::f64::consts::FRAC_PI_4 as Real);
    let from = Pose::from_parts(Vector::new(0.0, 0.0, 3.0), turned);
    let hit = straight(&cube, &cube, from, Vector::new(0.0, 0.0, -1.0)).expect("it meets");
    let expected = 2.5 - Real::sqrt(0.5);
    assert!((hit.time_of_impact - expected).abs() < EXACT, "{} not {expected}", hit.time_of_impact);
}

/// Thin, fast, and from so far away that no step would see it.
#[test]
fn a_bullet_meets_a_sheet() {
    let (sheet, bullet) = (ours(&cuboid(4.0, 4.0, 0.001)), SharedShape::cuboid(0.01, 0.01, 0.01));
    let hit = straight(&sheet, &bullet, up(100.0), Vector::new(0.0, 0.0, -10_000.0));
    let time = hit.expect("it does not tunnel").time_of_impact;
    assert!((time - (100.0 - 0.0105) / 10_000.0).abs() < 1e-8, "{time}");
}

/// Into the well of a cup, which no hull would let in: down to its floor at 0.1.
#[test]
fn a_cube_falls_into_a_cup() {
    let cup = ours(&model(Cup { radius: 0.5, height: 0.6, wall: 0.1, floor: 0.1, segments: 32 }));
    let cube = SharedShape::cuboid(0.1, 0.1, 0.1);
    let hit = straight(&cup, &cube, up(2.0), Vector::new(0.0, 0.0, -1.0)).expect("the floor");
    assert!((hit.time_of_impact - 1.8).abs() < EXACT, "{}", hit.time_of_impact);
}

/// Round shapes whose lowest point is 0.5 below their origin.
fn round_partners() -> [(&'static str, SharedShape); 5] {
    [
        ("ball", SharedShape::ball(0.5)),
        ("capsule", SharedShape::capsule_z(0.3, 0.2)),
        ("cylinder", SharedShape::cylinder(0.4, 0.5)),
        ("cone on its side", SharedShape::cone(0.4, 0.5)),
        ("round cylinder", SharedShape::round_cylinder(0.3, 0.4, 0.1)),
    ]
}

fn cast(
    [g1, g2]: [&SharedShape; 2],
    from: Pose,
    velocity: Vector,
    (target_distance, stop_at_penetration): (Real, bool),
) -> Option<ShapeCastHit> {
    let options = ShapeCastOptions {
        target_distance,
        stop_at_penetration,
        ..ShapeCastOptions::with_max_time_of_impact(100.0)
    };
    dispatcher().cast_shapes(&from, velocity, &**g1, &**g2, options).expect("known")
}

#[test]
fn round_shapes_meet_a_cube_in_time_or_stop_at_a_distance() {
    let cube = ours(&cuboid(4.0, 4.0, 1.0));
    for (name, partner) in round_partners() {
        for target in [0.0, 0.1] {
            let slow = Vector::new(0.0, 0.0, -4.0);
            // 3 − 1 = 2 apart.
            let expected = (2.0 - target) / 4.0;
            let hit = cast([&cube, &partner], up(3.0), slow, (target, true)).expect(name);
            assert!((hit.time_of_impact - expected).abs() < EXACT, "{name}: {hit:?}");
            assert_eq!(hit.status, ShapeCastStatus::Converged, "{name}");
            assert!((hit.normal1 - Vector::Z).length() < 1e-3, "{name}: {hit:?}");
            assert!((hit.normal2 + Vector::Z).length() < 1e-3, "{name}: {hit:?}");
            assert!((hit.witness1.z - 0.5).abs() < EXACT, "{name}: {hit:?}");
            assert!((hit.witness2.z + 0.5).abs() < 1e-3, "{name}: {hit:?}");
            // The other order, in the other's frame.
            let hit = cast([&partner, &cube], up(-3.0), -slow, (target, true)).expect(name);
            assert!((hit.time_of_impact - expected).abs() < EXACT, "{name}: {hit:?}");
            assert!((hit.normal1 + Vector::Z).length() < 1e-3, "{name}: {hit:?}");
            assert!((hit.witness1.z + 0.5).abs() < 1e-3, "{name}: {hit:?}");
            assert!((hit.witness2.z - 0.5).abs() < EXACT, "{name}: {hit:?}");
            assert!(cast([&cube, &partner], up(3.0), Vector::Z, (target, true)).is_none());
        }
    }
}

/// Inside a block, where a hollow mesh sees nothing: all shapes, also those with a border, straight
/// and turning.
#[test]
fn round_shapes_that_begin_inside_a_solid_are_not_free() {
    let block = ours(&cuboid(9.0, 9.0, 9.0));
    let others = [
        ("round cuboid", SharedShape::round_cuboid(0.3, 0.3, 0.3, 0.1)),
        ("round triangle", {
            let [a, b, c] = [Vector::X, Vector::Y, Vector::Z];
            SharedShape::round_triangle(a, b, c, 0.1)
        }),
    ];
    for (name, partner) in round_partners().into_iter().chain(others) {
        for pair in [[&block, &partner], [&partner, &block]] {
            for options in [(0.0, true), (0.0, false), (0.1, true), (0.1, false)] {
                let hit = cast(pair, Pose::IDENTITY, Vector::Z, options).expect(name);
                assert_eq!(hit.time_of_impact, 0.0, "{name}");
                assert_eq!(hit.status, ShapeCastStatus::PenetratingOrWithinTargetDist, "{name}");
            }
            let still = NonlinearRigidMotion::constant_position(Pose::IDENTITY);
            let moving =
                NonlinearRigidMotion::new(Pose::IDENTITY, Vector::ZERO, Vector::Z, Vector::X);
            let hit = dispatcher()
                .cast_shapes_nonlinear(&still, &**pair[0], &moving, &**pair[1], 0.0, 1.0, true)
                .expect("known")
                .expect(name);
            assert_eq!(hit.time_of_impact, 0.0, "{name}");
        }
    }
}

/// What touches at the beginning and parts is free where the caller says so; what comes nearer, or
/// is within the distance at which it is to stop, is not.
#[test]
fn who_parts_is_free_if_the_caller_wants_it() {
    let (cube, ball) = (ours(&cuboid(4.0, 4.0, 1.0)), SharedShape::ball(0.5));
    for (pair, side) in [([&cube, &ball], 1.0), ([&ball, &cube], -1.0)] {
        for (height, target) in [(0.98, 0.0), (1.05, 0.1)] {
            let from = up(side * height);
            let away = Vector::new(0.0, 0.0, side);
            assert!(cast(pair, from, away, (target, false)).is_none());
            assert!(cast(pair, from, away, (target, true)).is_some());
            let hit = cast(pair, from, -away, (target, false)).expect("it comes nearer");
            assert_eq!(hit.time_of_impact, 0.0);
        }
    }
}

/// A ball falls through a ring that is as wide as its hole, and a capsule into a cup.
#[test]
fn round_shapes_pass_holes() {
    let ring = ours(&model(Torus { major_radius: 1.0, minor_radius: 0.25, ..Torus::default() }));
    let fall = |shape: &SharedShape| {
        cast([&ring, shape], up(10.0), Vector::new(0.0, 0.0, -50.0), (0.0, true))
    };
    assert!(fall(&SharedShape::ball(0.7)).is_none());
    assert!(fall(&SharedShape::ball(0.8)).is_some());
    assert!(fall(&SharedShape::ball(0.001)).is_none());
}

/// What begins within a solid, where a hollow mesh sees nothing, or overlaps.
#[test]
fn who_begins_inside_is_told_so() {
    let (block, crumb) = (ours(&cuboid(2.0, 2.0, 2.0)), ours(&cuboid(0.2, 0.2, 0.2)));
    for from in [Pose::IDENTITY, up(1.05)] {
        let hit = straight(&block, &crumb, from, Vector::Z).expect("it is inside");
        assert_eq!(hit.time_of_impact, 0.0);
        assert_eq!(hit.status, ShapeCastStatus::PenetratingOrWithinTargetDist);
    }
    let options = ShapeCastOptions {
        stop_at_penetration: false,
        ..ShapeCastOptions::with_max_time_of_impact(10.0)
    };
    let cast = |velocity| {
        let cast = dispatcher().cast_shapes(&up(1.05), velocity, &*block.0, &*crumb.0, options);
        cast.expect("known")
    };
    assert!(cast(Vector::Z).is_none(), "it comes out");
    assert!(cast(-Vector::Z).is_some(), "it goes in");
}

/// A bar that turns about its end by a quarter in a second meets a block on its way at an angle
/// that is known.
#[test]
fn a_bar_that_turns_meets_a_block() {
    let (bar, block) = (ours(&cuboid(4.0, 0.2, 0.2)), SharedShape::cuboid(0.1, 0.1, 0.5));
    let pivot = Vector::new(-2.0, 0.0, 0.0);
    let turning = NonlinearRigidMotion::new(
        Pose::translation(2.0, 0.0, 0.0),
        pivot,
        Vector::ZERO,
        Vector::new(0.0, 0.0, std::f64::consts::FRAC_PI_2 as Real),
    );
    // Its side is 0.1 beside a line through the origin. The block's near corner, (1.6, 1.9), is 0.1
    // beside that line when the line's angle is that of the corner less asin(0.1 / |corner|).
    let at = Pose::translation(1.5, 2.0, 0.0);
    let corner = Vector::new(1.6, 1.9, 0.0);
    let angle = corner.y.atan2(corner.x) - (0.1 / corner.length()).asin();
    let expected = angle / std::f64::consts::FRAC_PI_2 as Real;
    let still = NonlinearRigidMotion::constant_position(at);
    let cast = |begin: Real, end: Real| {
        dispatcher()
            .cast_shapes_nonlinear(&turning, &*bar.0, &still, &*block.0, begin, end, true)
            .expect("known")
    };
    let hit = cast(0.0, 1.0).expect("it meets the block");
    assert!((hit.time_of_impact - expected).abs() < EXACT, "{} not {expected}", hit.time_of_impact);
    let later = cast(0.25, 1.0).expect("it meets the block");
    assert!((later.time_of_impact - expected).abs() < EXACT, "{}", later.time_of_impact);
    assert!(cast(0.0, 0.9 * expected).is_none());
    let swapped = dispatcher()
        .cast_shapes_nonlinear(&still, &*block.0, &turning, &*bar.0, 0.0, 1.0, true)
        .expect("known")
        .expect("it meets the block");
    assert!((swapped.time_of_impact - expected).abs() < EXACT, "{}", swapped.time_of_impact);
}

/// rapier's own continuous detection of a fast cuboid, against a sheet of ours: 2.5 a step through
/// 0.02.
#[test]
fn rapier_stops_a_fast_cuboid_at_a_sheet_of_ours() {
    let mut world = World::new();
    world.fixed(&ours(&cuboid(4.0, 4.0, 0.02)), Pose::IDENTITY);
    let bullet = RigidBodyBuilder::dynamic()
        .pose(up(1.0))
        .linvel(Vector::new(0.0, 0.0, -150.0))
        .ccd_enabled(true);
    let (body, _) = world.0.insert(bullet, ColliderBuilder::cuboid(0.1, 0.1, 0.1));
    world.run(60);
    assert!(world.at(body).z > 0.0, "{}", world.at(body));
}
