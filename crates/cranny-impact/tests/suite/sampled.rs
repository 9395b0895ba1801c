//! Time of impact judged by exact queries at sampled times: free before it, within the tolerance at
//! it, whatever the bodies and however they tumble.

use cranny_exact::{DQuat, DVec3, Meeting, Pose};
use cranny_geometry::Model;
use cranny_impact::{Hit, Impact, ImpactOptions, Motion, Moving, time_of_impact};
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query, query};
use cranny_shapes::{CPrism, Comb, Cuboid, Cup, GolfBall, LPrism, NestedShells, Torus, UPrism};
use cranny_testkit::bodies::octahedron;
use cranny_testkit::{Rng, from_surface, model, shape, world_triangles};

/// The answer without memory.
fn ask(a: Placed, b: Placed, demand: Demand) -> Answer {
    query(a, b, &Query::of(demand), &mut PairMemory::default()).unwrap()
}

fn bodies() -> Vec<Model> {
    vec![
        shape(Cuboid { size: [2.0, 0.3, 0.2] }),
        shape(Torus { major_segments: 16, minor_segments: 8, ..Torus::default() }),
        shape(Cup { segments: 12, ..Cup::default() }),
        shape(NestedShells { segments: 7, ..NestedShells::default() }),
        shape(Comb::default()),
        shape(LPrism::default()),
        shape(UPrism::default()),
        shape(CPrism { segments: 9, ..CPrism::default() }),
        shape(GolfBall { dimples: 0, triangles: 80, ..GolfBall::default() }),
        model(octahedron()),
    ]
}

fn vector(rng: &mut Rng) -> DVec3 {
    DVec3::new(rng.unit(), rng.unit(), rng.unit())
}

fn rotation(rng: &mut Rng) -> DQuat {
    DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), rng.unit() + 1.1).normalize()
}

fn at<'a>(moving: &Moving<'a>, time: f64) -> Placed<'a> {
    Placed { model: moving.model, pose: moving.motion.pose_at(time) }
}

/// Surfaces share no point at any of some times up to `end`, denser towards it.
fn free_up_to(a: &Moving, b: &Moving, end: f64, samples: u32) {
    let free_at = |time: f64| {
        let answer = ask(at(a, time), at(b, time), Demand::Intersects);
        assert_eq!(answer.surface, Meeting::None, "meets at {time}, before {end}");
    };
    for i in 0..samples {
        free_at(end * f64::from(i) / f64::from(samples));
    }
    let mut before = 0.5;
    for _ in 0..40 {
        free_at(end * (1.0 - before));
        before *= 0.5;
    }
}

/// Within the tolerance at the hit, with true witnesses.
fn real(a: &Moving, b: &Moving, hit: &Hit, tolerance: f64) {
    let rounding = 1e-11 * (a.model.radius() + b.model.radius());
    let (placed_a, placed_b) = (at(a, hit.time.hi), at(b, hit.time.hi));
    let answer = ask(placed_a, placed_b, Demand::Distance { below: None });
    assert!(answer.distance.unwrap() <= tolerance + rounding, "{hit:?}");
    assert!(hit.distance <= tolerance && hit.distance + rounding >= answer.distance.unwrap());
    let [p, q] = hit.witnesses.map(|w| w.point);
    assert!(((q - p).length() - hit.distance).abs() <= rounding, "{hit:?}");
    assert!(
        from_surface(p, &world_triangles(placed_a.model, &placed_a.pose)) <= rounding,
        "{hit:?}"
    );
    assert!(
        from_surface(q, &world_triangles(placed_b.model, &placed_b.pose)) <= rounding,
        "{hit:?}"
    );
    assert!((hit.normal.length() - 1.0).abs() < 1e-9);
}

fn judged(a: Moving, b: Moving, tolerance: f64, samples: u32) -> Impact {
    let (impact, counters) = time_of_impact(a, b, &ImpactOptions::within(tolerance)).unwrap();
    let (other, _) = time_of_impact(b, a, &ImpactOptions::within(tolerance)).unwrap();
    assert_eq!(std::mem::discriminant(&impact), std::mem::discriminant(&other));
    match (impact, other) {
        (Impact::None, _) => free_up_to(&a, &b, 1.0, samples),
        (Impact::Hit(hit), Impact::Hit(other)) => {
            assert_eq!(hit.time, other.time);
            assert!(hit.time.width() <= 1e-12, "{hit:?}");
            free_up_to(&a, &b, hit.time.lo, samples);
            real(&a, &b, &hit, tolerance);
        }
        (Impact::Initially { surface, .. }, _) => {
            let answer = ask(at(&a, 0.0), at(&b, 0.0), Demand::Intersects);
            assert!(answer.surface == surface && (answer.surface != Meeting::None || answer.solid));
        }
        (impact, _) => panic!("{impact:?} after {counters:?}"),
    }
    impact
}

#[test]
fn tumbling_bodies_are_free_until_they_meet() {
    let bodies = bodies();
    let mut rng = Rng::new(77);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..120 {
        let (a, b) = (&bodies[rng.below(bodies.len())], &bodies[rng.below(bodies.len())]);
        let reach = a.radius() + b.radius();
        let fast = [0.0, 0.5, 3.0, 12.0][rng.below(4)];
        let motion = |rng: &mut Rng, start: DVec3, travel: DVec3| Motion {
            start: Pose { rotation: rotation(rng), translation: start },
            pivot: 0.5 * vector(rng),
            turn: fast * vector(rng),
            travel,
        };
        let home = 10.0 * vector(&mut rng);
        let away = 1.1 * reach * vector(&mut rng).normalize();
        let aim = -2.0 * away + 1.5 * reach * vector(&mut rng);
        let shared = vector(&mut rng);
        let first = motion(&mut rng, home, shared);
        let second = motion(&mut rng, home + away, shared + aim);
        let tolerance = [1e-2, 1e-4, 1e-6][round % 3];
        let (a, b) = (Moving { model: a, motion: first }, Moving { model: b, motion: second });
        match judged(a, b, tolerance, 60) {
            Impact::Hit(_) => hits += 1,
            Impact::None => misses += 1,
            _ => {}
        }
    }
    assert!(hits >= 40 && misses >= 20, "{hits} hits, {misses} misses");
}

#[test]
fn linked_tori_swing_until_they_meet() {
    let torus = shape(Torus { major_segments: 24, minor_segments: 10, ..Torus::default() });
    let quarter = DQuat::from_xyzw(0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt());
    let mut rng = Rng::new(5);
    for _ in 0..8 {
        let start = Pose { rotation: quarter, translation: DVec3::X + 0.05 * vector(&mut rng) };
        let motion = Motion { turn: 6.0 * vector(&mut rng), ..Motion::at_rest(start) };
        let a = Moving { model: &torus, motion: Motion::at_rest(Pose::IDENTITY) };
        let b = Moving { model: &torus, motion };
        judged(a, b, 1e-4, 100);
    }
}

#[test]
fn tiny_and_huge_and_far_away_bodies_are_judged_alike() {
    for (size, far) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e6), (1e-3, 1e3)] {
        let mesh = shape(LPrism::default()).mesh().scaled(DVec3::splat(size)).unwrap();
        let body = model(mesh);
        let mut rng = Rng::new(11);
        for _ in 0..6 {
            let home = far * DVec3::new(1.0, -0.7, 0.3);
            let pose = |rng: &mut Rng, p: DVec3| Pose { rotation: rotation(rng), translation: p };
            let away = 2.2 * body.radius() * vector(&mut rng).normalize();
            let first =
                Motion { turn: 3.0 * vector(&mut rng), ..Motion::at_rest(pose(&mut rng, home)) };
            let second = Motion {
                turn: 3.0 * vector(&mut rng),
                ..Motion::straight(pose(&mut rng, home + away), -2.0 * away)
            };
            let (a, b) =
                (Moving { model: &body, motion: first }, Moving { model: &body, motion: second });
            let (impact, _) = time_of_impact(a, b, &ImpactOptions::within(1e-4 * size)).unwrap();
            match impact {
                Impact::Hit(hit) => free_up_to(&a, &b, hit.time.lo, 50),
                Impact::None => free_up_to(&a, &b, 1.0, 50),
                other => panic!("{other:?}"),
            }
        }
    }
}

#[test]
fn a_nut_follows_its_helix_and_not_a_straight_line() {
    use cranny_shapes::{IsoBolt, IsoNut};
    // Coarse: chords are 0.07 inside the thread, so that the clearance is 0.3.
    let bolt = shape(IsoBolt { segments: 24, length: Some(8.0), ..IsoBolt::default() });
    let nut = shape(IsoNut {
        segments: 24,
        flank_segments: 1,
        clearance: 0.3,
        height: Some(4.0),
        ..IsoNut::default()
    });
    let still = Moving { model: &bolt, motion: Motion::at_rest(Pose::IDENTITY) };
    let start = Pose::at(4.0 * DVec3::Z);
    let turned = |turn: f64, climb: f64| {
        let motion = Motion::screw(start, DVec3::ZERO, turn * DVec3::Z, climb);
        judged(still, Moving { model: &nut, motion }, 1e-2, 20)
    };
    let pitch = 2.0;
    let turn = 0.6;
    assert_eq!(turned(turn, turn / std::f64::consts::TAU * pitch), Impact::None);
    assert!(matches!(turned(turn, 0.5 * pitch), Impact::Hit(_)));
}
