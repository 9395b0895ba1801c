//! Time of impact where it is known in closed form.

use std::f64::consts::PI;

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::Model;
use cranny_impact::{Hit, Impact, ImpactError, ImpactOptions, Motion, Moving, time_of_impact};
use cranny_narrow_phase::{Containment, Feature};
use cranny_shapes::{CPrism, Cuboid, Floor, GolfBall, NestedShells, Torus};
use cranny_testkit::bodies::{cuboid, inverted, octahedron, prism};
use cranny_testkit::{model, shape};

const TOLERANCE: f64 = 1e-4;

fn moving(model: &Model, motion: Motion) -> Moving<'_> {
    Moving { model, motion }
}

fn still(model: &Model) -> Moving<'_> {
    moving(model, Motion::at_rest(Pose::IDENTITY))
}

/// Asks, both ways round.
fn impact(a: Moving, b: Moving) -> Impact {
    let options = ImpactOptions::within(TOLERANCE);
    let (impact, counters) = time_of_impact(a, b, &options).unwrap();
    let (swapped, counters_swapped) = time_of_impact(b, a, &options).unwrap();
    assert_eq!(counters, counters_swapped);
    match (impact, swapped) {
        (Impact::Hit(hit), Impact::Hit(other)) => {
            let [a, b] = other.witnesses;
            assert_eq!(hit, Hit { witnesses: [b, a], normal: -other.normal, ..other });
        }
        (Impact::Initially { contained, .. }, Impact::Initially { contained: other, .. }) => {
            assert_eq!(contained, other.map(Containment::swapped));
        }
        _ => assert_eq!(impact, swapped),
    }
    impact
}

fn hit(a: Moving, b: Moving) -> Hit {
    match impact(a, b) {
        Impact::Hit(hit) => {
            assert!(hit.distance <= TOLERANCE && hit.time.lo <= hit.time.hi, "{hit:?}");
            assert!((hit.normal.length() - 1.0).abs() < 1e-12);
            hit
        }
        other => panic!("{other:?}"),
    }
}

/// Hits at a known time, early or late at most by what the tolerance is in time at the speed of
/// approach.
fn hits_at(a: Moving, b: Moving, time: f64, speed: f64) -> Hit {
    let hit = hit(a, b);
    assert!(hit.time.lo <= time && time - hit.time.hi <= TOLERANCE / speed, "{time}: {hit:?}");
    hit
}

#[test]
fn a_bullet_does_not_tunnel_through_a_thin_plate() {
    let plate = model(cuboid([-2.0, -2.0, -0.005], [2.0, 2.0, 0.005]));
    let bullet = model(octahedron());
    let start = Pose::at(DVec3::new(0.3, 0.2, 100.0));
    let motion = Motion::straight(start, DVec3::new(0.0, 0.0, -1000.0));
    // The lower apex is one below the middle: 98.995 above the plate.
    let hit = hits_at(still(&plate), moving(&bullet, motion), 0.098995, 1000.0);
    assert!((hit.normal - DVec3::Z).length() < 1e-9, "{hit:?}");
    assert!(matches!(hit.witnesses[1].feature, Feature::Vertex(_)));
    // Spinning about its axis of flight changes nothing.
    let spinning = Motion { turn: 50.0 * DVec3::Z, ..motion };
    hits_at(still(&plate), moving(&bullet, spinning), 0.098995, 1000.0);
}

/// A bar of half-length 2, 0.2 wide and high, about the origin.
fn bar() -> Model {
    model(cuboid([-2.0, -0.1, -0.1], [2.0, 0.1, 0.1]))
}

/// An upright post with four edges, 0.2 around its middle.
fn post(x: f64, y: f64, height: f64) -> Model {
    let outline = [[x + 0.2, y], [x, y + 0.2], [x - 0.2, y], [x, y - 0.2]];
    let mesh = prism(&outline, &[[0, 1, 2], [0, 2, 3]], 2.0 * height);
    let down = mesh.vertices().iter().map(|p| *p - height * DVec3::Z).collect();
    model(cranny_geometry::Mesh::new(down, mesh.faces().to_vec()).unwrap())
}

#[test]
fn a_turning_bar_meets_a_post_when_its_side_reaches_the_edge() {
    // Edge at (0.2, 1.5); the side runs 0.1 ahead of the bar's middle.
    let post = post(0.0, 1.5, 1.0);
    let radius = 0.2f64.hypot(1.5);
    let angle = 1.5f64.atan2(0.2) - (0.1 / radius).asin();
    for turn in [1.5, 2.0, PI, 20.0, 100.0] {
        let motion = Motion { turn: turn * DVec3::Z, ..Motion::at_rest(Pose::IDENTITY) };
        let bar = bar();
        let hit = hits_at(still(&post), moving(&bar, motion), angle / turn, turn * radius);
        let expected = DVec3::new((angle + PI / 2.0).cos(), (angle + PI / 2.0).sin(), 0.0);
        // From the post to the bar: against the bar's motion.
        assert!((hit.normal + expected).length() < 1e-3, "{hit:?}");
    }
    // Turned the other way it comes round with its other arm: half a turn less the same angle.
    let mirrored = Motion { turn: -3.0 * DVec3::Z, ..Motion::at_rest(Pose::IDENTITY) };
    hits_at(still(&post), moving(&bar(), mirrored), angle / 3.0, 3.0 * radius);
    // Not far enough.
    let short = Motion { turn: (angle - 0.001) * DVec3::Z, ..mirrored };
    assert_eq!(impact(still(&post), moving(&bar(), short)), Impact::None);
}

#[test]
fn a_bar_that_turns_about_its_end_reaches_twice_as_far() {
    let post = post(0.0, 3.0, 1.0);
    let radius = 0.2f64.hypot(3.0);
    let angle = 3.0f64.atan2(0.2) - (0.1 / radius).asin();
    // The left end in the origin.
    let start = Pose::at(2.0 * DVec3::X);
    let swing = Motion { start, pivot: -2.0 * DVec3::X, turn: 3.0 * DVec3::Z, travel: DVec3::ZERO };
    hits_at(still(&post), moving(&bar(), swing), angle / 3.0, 3.0 * radius);
    assert_eq!(
        swing,
        Motion { travel: DVec3::ZERO, ..Motion::screw(start, DVec3::ZERO, 3.0 * DVec3::Z, 0.0) }
    );
    // About its middle the same bar does not.
    let middle = Motion { pivot: DVec3::ZERO, ..swing };
    assert_eq!(impact(still(&post), moving(&bar(), middle)), Impact::None);
}

#[test]
fn the_tip_of_a_bar_grazes_a_wall_or_clears_it() {
    let reach = 2.0f64.hypot(0.1);
    for (gap, meets) in [(1e-3, false), (2e-4, false), (-1e-3, true), (-1e-7, true)] {
        let wall = model(cuboid([-5.0, reach + gap, -1.0], [5.0, reach + gap + 1.0, 1.0]));
        for turn in [PI, -PI, 7.0] {
            let motion = Motion { turn: turn * DVec3::Z, ..Motion::at_rest(Pose::IDENTITY) };
            let impact = impact(still(&wall), moving(&bar(), motion));
            assert_eq!(matches!(impact, Impact::Hit(_)), meets, "{gap} {turn}: {impact:?}");
        }
    }
}

#[test]
fn a_tip_that_bulges_into_a_wall_is_seen_at_any_tolerance() {
    // Some chords of the tip's path stay clear of the wall; the path does not.
    let bar = bar();
    for depth in [1e-3, 1e-5, 1e-7] {
        let wall = model(cuboid([-5.0, 2.0f64.hypot(0.1) - depth, -1.0], [5.0, 3.0, 1.0]));
        for tolerance in [1e-3, 0.03, 0.3] {
            for step in 0..60 {
                let rotation = DQuat::from_rotation_z(0.0211 * f64::from(step));
                let start = Pose { rotation, translation: DVec3::ZERO };
                let motion = Motion { turn: 2.0 * DVec3::Z, ..Motion::at_rest(start) };
                let options = ImpactOptions::within(tolerance);
                let (impact, _) =
                    time_of_impact(still(&wall), moving(&bar, motion), &options).unwrap();
                assert!(matches!(impact, Impact::Hit(_)), "{depth} {tolerance} {step}: {impact:?}");
            }
        }
    }
}

#[test]
fn the_last_moment_counts() {
    let unit = shape(Cuboid::default());
    let to = |travel: f64| Motion::straight(Pose::at(3.0 * DVec3::X), -travel * DVec3::X);
    hits_at(still(&unit), moving(&unit, to(2.0)), 1.0, 2.0);
    assert_eq!(impact(still(&unit), moving(&unit, to(1.9999))), Impact::None);
}

#[test]
fn long_turns_are_searched_in_parts() {
    let post = post(0.0, 3.0, 1.0);
    let bar = bar();
    let motion = Motion { turn: 40.0 * DVec3::Z, ..Motion::at_rest(Pose::IDENTITY) };
    let options = ImpactOptions::within(TOLERANCE);
    let (impact, counters) = time_of_impact(still(&post), moving(&bar, motion), &options).unwrap();
    assert_eq!(impact, Impact::None);
    assert!(counters.descents >= 10 && counters.total() < 50_000, "{counters:?}");
}

#[test]
fn sliding_over_a_floor_is_no_meeting() {
    let (slab, unit) = (shape(Cuboid { size: [8.0, 4.0, 1.0] }), shape(Cuboid::default()));
    for gap in [1e-2, 1e-3, 1e-5, 1e-9] {
        let start = Pose::at(DVec3::new(-2.0, 0.1, 1.0 + gap));
        let slide = Motion::straight(start, DVec3::new(4.0, 0.3, 0.0));
        assert_eq!(impact(still(&slab), moving(&unit, slide)), Impact::None, "{gap}");
        let lifted = Motion { travel: DVec3::new(4.0, 0.3, 0.1), ..slide };
        assert_eq!(impact(still(&slab), moving(&unit, lifted)), Impact::None, "{gap}");
        let pressed = Motion { travel: DVec3::new(4.0, 0.3, -2.0 * gap), ..slide };
        hits_at(still(&slab), moving(&unit, pressed), 0.5, 2.0 * gap);
    }
    // Turning on the spot, as a curling stone.
    let spin = Motion { turn: 9.0 * DVec3::Z, ..Motion::at_rest(Pose::at(1.001 * DVec3::Z)) };
    assert_eq!(impact(still(&slab), moving(&unit, spin)), Impact::None);
}

/// A C, 0.25 around its middle, and a ring with a hole of 0.8: fits through whichever way it turns.
#[test]
fn a_spinning_hook_passes_a_ring_where_it_fits() {
    let ring = shape(Torus { major_segments: 48, minor_segments: 12, ..Torus::default() });
    let hook = shape(CPrism::default());
    let mesh = hook.mesh().scaled(DVec3::splat(0.5 / hook.radius())).unwrap();
    let hook = model(mesh);
    for turn in [DVec3::new(0.0, 9.0, 3.0), 40.0 * DVec3::X, DVec3::ZERO] {
        let through = |x: f64| Motion {
            turn,
            ..Motion::straight(Pose::at(DVec3::new(x, 0.05, 2.0)), -4.0 * DVec3::Z)
        };
        assert_eq!(impact(still(&ring), moving(&hook, through(0.1))), Impact::None);
        assert_eq!(impact(still(&ring), moving(&hook, through(2.0))), Impact::None);
        let met = hit(still(&ring), moving(&hook, through(1.0)));
        assert!(met.time.hi > 0.3 && met.time.hi < 0.5, "{met:?}");
    }
}

#[test]
fn who_does_not_move_does_not_meet() {
    let unit = shape(Cuboid::default());
    let apart = moving(&unit, Motion::at_rest(Pose::at(1.5 * DVec3::X)));
    assert_eq!(impact(still(&unit), apart), Impact::None);
    // Nor who moves alike, far away, or turns alike.
    let far = 1e3 * DVec3::new(1.0, -2.0, 0.5);
    let alike = |x: f64| Motion::straight(Pose::at(x * DVec3::X), far);
    assert_eq!(impact(moving(&unit, alike(0.0)), moving(&unit, alike(1.01))), Impact::None);
    let about = |x: f64| Motion::screw(Pose::at(x * DVec3::X), DVec3::Y, 7.0 * DVec3::Z, 2.0);
    assert_eq!(impact(moving(&unit, about(0.0)), moving(&unit, about(1.01))), Impact::None);
    let touching = moving(&unit, Motion::straight(Pose::at(DVec3::X), DVec3::X));
    let met = Impact::Initially { surface: Meeting::Touch, contained: None };
    assert_eq!(impact(still(&unit), touching), met);
}

#[test]
fn two_that_both_move_meet_in_the_middle() {
    let unit = shape(Cuboid::default());
    let from = |x: f64, travel: f64| Motion::straight(Pose::at(x * DVec3::X), travel * DVec3::X);
    let met = hits_at(moving(&unit, from(-3.0, 2.0)), moving(&unit, from(3.0, -8.0)), 0.5, 10.0);
    assert!((met.normal - DVec3::X).length() < 1e-9);
    assert!((met.witnesses[0].point.x + 1.5).abs() < 2.0 * TOLERANCE, "{met:?}");
}

#[test]
fn inside_a_solid_is_met_already_inside_a_void_is_free() {
    let ball = shape(GolfBall { radius: 0.05, dimples: 0, triangles: 80, ..GolfBall::default() });
    let block = shape(Cuboid::default());
    let out = Motion::straight(Pose::IDENTITY, 2.0 * DVec3::X);
    let inside = Impact::Initially { surface: Meeting::None, contained: Some(Containment::BInA) };
    assert_eq!(impact(still(&block), moving(&ball, out)), inside);
    // A hollow box: outer wall 1, inner wall 0.9.
    let inner = inverted(&cuboid([-0.9; 3], [0.9; 3]));
    let hollow = model(cuboid([-1.0; 3], [1.0; 3]).joined(&inner));
    let spin = Motion { turn: DVec3::new(3.0, 8.0, 5.0), ..Motion::at_rest(Pose::IDENTITY) };
    assert_eq!(impact(still(&hollow), moving(&ball, spin)), Impact::None);
    let reach = ball.mesh().vertices().iter().map(|p| p.x).fold(0.0, f64::max);
    hits_at(still(&hollow), moving(&ball, out), (0.9 - reach) / 2.0, 2.0);
    let shells = shape(NestedShells::default());
    assert!(matches!(impact(still(&shells), moving(&shells, out)), Impact::Initially { .. }));
}

/// Fine floors face to face, a hair apart: thousands of pairs of faces are settled at one moment.
/// A budget ends within it, but for what one pair of faces takes.
#[test]
fn a_budget_ends_within_a_moment() {
    let floor = shape(Floor { size: [4.0, 4.0, 0.2], squares: [30, 30] });
    let height = floor.bounds().max.z - floor.bounds().min.z;
    let start = Pose::at(DVec3::new(0.013, 0.007, height + 1e-3));
    let upper = moving(&floor, Motion::straight(start, DVec3::new(1.0, 0.3, -2e-3)));
    let (_, all) = time_of_impact(still(&floor), upper, &ImpactOptions::within(TOLERANCE)).unwrap();
    let budget = 2_000;
    assert!(all.total() > 10 * budget, "{all:?}");
    let options = ImpactOptions { budget, ..ImpactOptions::within(TOLERANCE) };
    let (_, spent) = time_of_impact(still(&floor), upper, &options).unwrap();
    assert!(spent.total() < 2 * budget, "{spent:?}");
}

#[test]
fn a_spent_budget_leaves_what_is_certain() {
    let plate = model(cuboid([-2.0, -2.0, -0.005], [2.0, 2.0, 0.005]));
    let ball = shape(GolfBall { dimples: 0, triangles: 320, ..GolfBall::default() });
    let (mut opened, mut uncertain) = (0, 0);
    for turn in [DVec3::ZERO, DVec3::new(5.0, 3.0, 1.0)] {
        let fall = Motion { turn, ..Motion::straight(Pose::at(3.0 * DVec3::Z), -3.0 * DVec3::Z) };
        let (a, b) = (still(&plate), moving(&ball, fall));
        let truth = hit(a, b).time.lo;
        assert!(truth < (3.0 - 0.95 * ball.radius()) / 3.0);
        // As far as the whole search goes.
        let (_, spent) = time_of_impact(a, b, &ImpactOptions::within(TOLERANCE)).unwrap();
        for budget in 0..spent.total() {
            let options = ImpactOptions { budget, ..ImpactOptions::within(TOLERANCE) };
            match time_of_impact(a, b, &options).unwrap().0 {
                Impact::Open { free_before } => {
                    assert!(free_before <= truth, "{free_before}");
                    opened += 1;
                }
                Impact::Hit(Hit { time, .. }) => {
                    assert!(time.lo <= truth && truth <= time.hi, "{time:?}");
                    uncertain += u32::from(time.width() > 0.0);
                }
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(opened >= 2 && uncertain >= 1, "{opened} open, {uncertain} uncertain");
}

#[test]
fn what_is_no_question_is_refused() {
    let unit = shape(Cuboid::default());
    let options = ImpactOptions::within(TOLERANCE);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = ImpactOptions { tolerance: value, ..options };
        let refused = time_of_impact(still(&unit), still(&unit), &options);
        assert!(matches!(refused, Err(ImpactError::Tolerance { .. })));
    }
    let mut bad = still(&unit);
    bad.motion.start.rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0);
    assert!(matches!(
        time_of_impact(still(&unit), bad, &options),
        Err(ImpactError::Rotation { body: 'B', .. })
    ));
}
