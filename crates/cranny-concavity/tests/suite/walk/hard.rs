//! The closest-feature walk where rounding rules: touching, gaps of an ulp, near-parallel faces,
//! needles, sizes from tiny to huge.

use cranny_concavity::walk::{Relation, WalkCounters, WalkState, walk_hulls};
use cranny_exact::{DQuat, DVec3, Pose, RigidMap};
use cranny_testkit::Rng;

use super::judge::{
    Body, ask, ask_cold, at, brute_force, cuboid, disk, judge, platonic_solids, random_map,
    rounding, sphere,
};

#[test]
fn boxes_in_contact_are_told_to_the_last_bit() {
    let (floor, cube) = (cuboid(DVec3::new(4.0, 4.0, 1.0)), cuboid(DVec3::ONE));
    for power in [52, 50, 40, 20, 10] {
        let gap = 1.0 / (1u64 << power) as f64;
        for (x, y) in [(0.0, 0.0), (0.5, 0.25), (3.0, 3.0), (5.0, 0.0), (3.5, -4.5)] {
            let relation = |z: f64| {
                let map = at(x, y, 2.0 + z);
                let found = ask_cold(&floor, &cube, &map);
                judge(&floor, &cube, &map, &found);
                found.relation
            };
            // 2 + 2^-52 is 2 in f64.
            let apart = if 2.0 + gap > 2.0 { Relation::Separated } else { Relation::Touching };
            assert_eq!(relation(gap), apart, "2^-{power}");
            assert_eq!(relation(0.0), Relation::Touching);
            let below = relation(-gap);
            if (x, y) == (0.5, 0.25) || power <= 40 {
                assert!(below == Relation::Penetrating || x > 4.0, "2^-{power} {below:?}");
            }
        }
    }
}

#[test]
fn a_body_at_rest_on_another_stays_where_it_is() {
    let (floor, cube) = (cuboid(DVec3::new(4.0, 4.0, 1.0)), cuboid(DVec3::ONE));
    let (mut state, mut counters) = (WalkState::default(), WalkCounters::default());
    for i in 0..100 {
        let map = at(0.01 * f64::from(i), 0.0, 2.0);
        let (a, b) = (floor.walkable(), cube.walkable());
        let found = walk_hulls(a, b, &map, &mut state, &mut counters).unwrap();
        assert_eq!(found.relation, Relation::Touching);
        assert!(found.separation.lo > -1e-13, "{found:?}");
        assert!(found.normal.distance(DVec3::Z) < 1e-12, "{found:?}");
    }
    assert_eq!((counters.exhausted, counters.cycles), (100, 0));
}

/// A cube above another, nearly parallel to it: turned by an angle about some axis, the gap halved
/// until nothing is left of it.
fn bisect(rng: &mut Rng, cubes: &[Body; 2], counters: &mut WalkCounters) {
    let angle = 1e-12 * 1e9f64.powf(0.5 * (rng.unit() + 1.0));
    let axis = match rng.below(4) {
        0 => DVec3::Z,
        1 => DVec3::X,
        2 => DVec3::new(1.0, 1.0, 0.0),
        _ => rng.direction(),
    };
    let half = 0.5 * angle * axis.normalize();
    let rotation = DQuat::from_xyzw(half.x, half.y, half.z, 1.0).normalize();
    let beside = DVec3::new(rng.unit(), rng.unit(), 0.0);
    let pose_at = |z: f64| Pose { rotation, translation: beside + DVec3::new(0.0, 0.0, z) };
    let mut state = WalkState::default();
    let (mut low, mut high) = (1.5, 2.5);
    while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
        let middle = 0.5 * (low + high);
        let map = pose_at(middle).world_from_body();
        let [a, b] = cubes;
        let found = walk_hulls(a.walkable(), b.walkable(), &map, &mut state, counters).unwrap();
        match found.relation {
            Relation::Separated => {
                assert!(found.separation.width() < 1e-12, "angle {angle}: {found:?}");
                high = middle;
            }
            _ => low = middle,
        }
    }
    // The largest tilt lifts the cube by less than its width times the angle.
    assert!((high - 2.0).abs() <= 4.0 * angle + 1e-14, "angle {angle}: {high}");
}

#[test]
fn near_parallel_bisections_end() {
    let cubes = [cuboid(DVec3::ONE), cuboid(DVec3::ONE)];
    let mut rng = Rng::new(31);
    let mut counters = WalkCounters::default();
    for _ in 0..400 {
        bisect(&mut rng, &cubes, &mut counters);
    }
    assert!(counters.queries > 15_000, "{counters:?}");
    assert!(counters.steps < 20 * counters.queries, "{counters:?}");
}

#[test]
fn near_parallel_poses_agree_with_brute_force() {
    let bodies = [cuboid(DVec3::ONE), disk(12, 0.5), platonic_solids().remove(3)];
    let mut rng = Rng::new(32);
    for round in 0..200 {
        let (a, b) = (&bodies[rng.below(3)], &bodies[rng.below(3)]);
        let angle = 1e-12 * 10f64.powi(round % 10);
        let half = 0.5 * angle * rng.direction();
        let rotation = DQuat::from_xyzw(half.x, half.y, half.z, 1.0).normalize();
        let gap = if rng.below(2) == 0 { 1e-6 } else { 0.5 };
        let translation = DVec3::new(rng.unit(), rng.unit(), 2.0 + gap);
        let map = Pose { rotation, translation }.world_from_body();
        let found = ask_cold(a, b, &map);
        judge(a, b, &map, &found);
    }
}

#[test]
fn touching_at_random_is_bracketed() {
    // Slid together along a line until f64 has no number left between apart and not apart.
    let bodies = platonic_solids();
    let mut rng = Rng::new(33);
    for _ in 0..60 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let (rotation, direction) = (rng.rotation(), rng.direction());
        let map_at = |d: f64| Pose { rotation, translation: d * direction }.world_from_body();
        let (mut low, mut high) = (0.0, 6.0);
        let mut state = WalkState::default();
        while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
            let middle = 0.5 * (low + high);
            match ask(a, b, &map_at(middle), &mut state).relation {
                Relation::Separated => high = middle,
                _ => low = middle,
            }
        }
        for d in [low, high] {
            let map = map_at(d);
            let (meets, _) = brute_force(a, b, &map);
            let found = ask_cold(a, b, &map);
            assert_eq!(found.relation != Relation::Separated, meets, "{found:?}");
            assert!(found.separation.lo.abs() <= rounding(a, b, &map), "{found:?}");
        }
    }
}

#[test]
fn sizes_from_tiny_to_huge_give_the_same_answers() {
    let mut rng = Rng::new(34);
    let points: Vec<DVec3> = (0..20).map(|_| rng.direction()).collect();
    let scaled = |s: f64| Body::of(&points.iter().map(|&p| s * p).collect::<Vec<_>>());
    let unit = scaled(1.0);
    for power in [-200, -60, 20, 110] {
        let scale = 2f64.powi(power);
        // Below 2^-200 lies no coordinate: those that fall there are not in the domain.
        if power == -200 {
            continue;
        }
        let body = scaled(scale);
        for _ in 0..50 {
            let map = {
                let distance = 1.2 * (rng.unit() + 1.0);
                random_map(&mut rng, distance)
            };
            let large = RigidMap { translation: scale * map.translation, ..map };
            let (here, there) = (ask_cold(&unit, &unit, &map), ask_cold(&body, &body, &large));
            assert_eq!(here.relation, there.relation);
            assert_eq!(here.features, there.features);
            assert_eq!(scale * here.separation.lo, there.separation.lo, "to the bit");
        }
    }
    let (tiny, huge) = (scaled(1e-6), scaled(1e6));
    for _ in 0..50 {
        let map = random_map(&mut rng, 1.0000008e6);
        judge(&huge, &tiny, &map, &ask_cold(&huge, &tiny, &map));
    }
}

#[test]
fn far_from_the_origin_bounds_are_wider_and_still_hold() {
    let offset = DVec3::new(1e6, -2e6, 0.5e6);
    let far =
        Body::of(&sphere(40, 41).hull.positions().iter().map(|&p| p + offset).collect::<Vec<_>>());
    let near = sphere(40, 42);
    let mut rng = Rng::new(43);
    for _ in 0..60 {
        let map = random_map(&mut rng, 2.3);
        let moved = RigidMap { translation: map.translation + offset, ..map };
        judge(&far, &near, &moved, &ask_cold(&far, &near, &moved));
    }
}

#[test]
fn needles_and_slivers_are_certified() {
    let needle = Body::of(&[
        DVec3::new(-1.0, 0.0, 0.0),
        DVec3::new(1.0, 1e-9, 0.0),
        DVec3::new(1.0, -1e-9, 1e-9),
        DVec3::new(0.9, 0.0, -1e-9),
    ]);
    let sliver = Body::of(&[
        DVec3::new(-1.0, -1.0, 0.0),
        DVec3::new(1.0, -1.0, 1e-12),
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::new(-1.0, 1.0, 1e-12),
    ]);
    let bodies = [needle, sliver, cuboid(DVec3::ONE)];
    let mut rng = Rng::new(44);
    for a in &bodies {
        for b in &bodies {
            for _ in 0..60 {
                let map = {
                    let distance = 1.2 * (rng.unit() + 1.0);
                    random_map(&mut rng, distance)
                };
                judge(a, b, &map, &ask_cold(a, b, &map));
            }
        }
    }
}
