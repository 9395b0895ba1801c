//! The closest-feature walk: hand-computed pairs, every start, every relation, frames in a row.

use cranny_concavity::walk::{
    HullFeature, Relation, WalkCounters, WalkError, WalkState, walk_hulls,
};
use cranny_exact::{DQuat, DVec3, Pose, RigidMap};
use cranny_geometry::Mesh;
use cranny_geometry::hull::HullVertexId;
use cranny_shapes::Shape;
use cranny_testkit::Rng;

use super::judge::{
    Body, ask, ask_cold, at, brute_force_depth, cuboid, disk, judge, platonic_solids, random_map,
    rounding, sphere,
};

fn kinds(found: [HullFeature; 2]) -> [char; 2] {
    found.map(|feature| match feature {
        HullFeature::Vertex(_) => 'v',
        HullFeature::Edge(_) => 'e',
        HullFeature::Facet(_) => 'f',
    })
}

fn separated_by(a: &Body, b: &Body, map: &RigidMap, distance: f64, features: [char; 2]) {
    let found = ask_cold(a, b, map);
    judge(a, b, map, &found);
    assert_eq!(found.relation, Relation::Separated);
    assert!(found.separation.contains(distance), "{distance} {found:?}");
    assert_eq!(kinds(found.features), features);
}

#[test]
fn each_kind_of_pair_is_found_between_boxes() {
    let (large, small) = (cuboid(DVec3::ONE), cuboid(DVec3::splat(0.25)));
    let corner = 0.75 * 3f64.sqrt();
    separated_by(&large, &small, &at(2.0, 2.0, 2.0), corner, ['v', 'v']);
    let eighth =
        DQuat::from_xyzw(0.0, 0.0, (0.5 - 0.125f64.sqrt()).sqrt(), (0.5 + 0.125f64.sqrt()).sqrt());
    let turned = |rotation: DQuat, p: DVec3| Pose { rotation, translation: p }.world_from_body();
    // A corner of the small box, turned by 45 degrees about two axes, below it; over facet, edge.
    let tipped = eighth * DQuat::from_xyzw(eighth.z, 0.0, 0.0, eighth.w);
    let lowest =
        (0..8).map(|i| small.hull.positions()[i]).map(|p| (tipped * p).z).fold(0.0, f64::min);
    separated_by(
        &large,
        &small,
        &turned(tipped, DVec3::new(0.1, 0.2, 3.0)),
        2.0 + lowest,
        ['f', 'v'],
    );
    // Crossed edges: one box turned about x, the other about y, above each other.
    let about_y = DQuat::from_xyzw(0.0, eighth.z, 0.0, eighth.w);
    let roof = DQuat::from_xyzw(eighth.z, 0.0, 0.0, eighth.w);
    let map = RigidMap::between(
        &Pose { rotation: about_y, translation: DVec3::ZERO },
        &Pose { rotation: roof, translation: DVec3::new(0.1, 0.1, 3.0) },
    );
    separated_by(&large, &small, &map, 3.0 - 1.25 * 2f64.sqrt(), ['e', 'e']);
    separated_by(&small, &large, &map.inverse(), 3.0 - 1.25 * 2f64.sqrt(), ['e', 'e']);
    // A corner beside an edge: the corner of the tipped box out along the diagonal of x and y.
    let spike = Body::of(&[
        DVec3::ZERO,
        DVec3::new(1.0, 1.0, 0.5),
        DVec3::new(1.0, 1.0, -0.5),
        DVec3::new(1.0, 2.0, 0.0),
    ]);
    separated_by(&large, &spike, &at(2.0, 2.0, 0.25), 2f64.sqrt(), ['e', 'v']);
}

#[test]
fn thin_hulls_are_walked_like_others() {
    let point = Body::of(&[DVec3::ZERO]);
    let segment = Body::of(&[DVec3::new(-1.0, 0.0, 0.0), DVec3::X]);
    let across = Body::of(&[DVec3::new(0.0, -1.0, 0.0), DVec3::Y]);
    let plate = disk(5, 0.0);
    let cube = cuboid(DVec3::ONE);
    let below = ask_cold(&point, &point, &at(3.0, 4.0, 0.0));
    assert!(below.separation.contains(5.0) && below.relation == Relation::Separated);
    assert_eq!(ask_cold(&point, &point, &RigidMap::IDENTITY).relation, Relation::Touching);
    assert_eq!(ask_cold(&segment, &across, &RigidMap::IDENTITY).relation, Relation::Touching);
    separated_by(&segment, &across, &at(0.25, 0.25, 2.0), 2.0, ['e', 'e']);
    separated_by(&segment, &point, &at(0.25, 0.0, 2.0), 2.0, ['e', 'v']);
    separated_by(&plate, &point, &at(0.1, 0.0, -2.0), 2.0, ['f', 'v']);
    assert_eq!(ask_cold(&cube, &point, &at(0.5, 0.0, 0.0)).relation, Relation::Penetrating);
    assert_eq!(ask_cold(&cube, &point, &at(1.0, 0.5, 0.0)).relation, Relation::Touching);
    let bodies = [point, segment, plate, cube];
    let mut rng = Rng::new(5);
    for a in &bodies {
        for b in &bodies {
            for round in 0..40 {
                let map = random_map(&mut rng, 0.1 * f64::from(round));
                judge(a, b, &map, &ask_cold(a, b, &map));
            }
        }
    }
}

#[test]
fn the_start_does_not_matter() {
    let solids = platonic_solids();
    let mut rng = Rng::new(1);
    for (i, a) in solids.iter().enumerate() {
        for b in &solids[i..] {
            for distance in [4.5, 2.6, 1.5] {
                let map = random_map(&mut rng, distance);
                let cold = ask_cold(a, b, &map);
                judge(a, b, &map, &cold);
                for f in a.graph.features() {
                    for g in b.graph.features().step_by(3) {
                        let found = ask(a, b, &map, &mut WalkState::starting_at([f, g]));
                        assert_eq!(found.relation, cold.relation, "from {f:?}, {g:?}");
                        if found.relation == Relation::Separated {
                            let apart = found.separation.lo - cold.separation.lo;
                            assert!(apart.abs() <= rounding(a, b, &map), "from {f:?}, {g:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn random_poses_agree_with_brute_force() {
    let mut bodies = platonic_solids();
    bodies.extend([
        disk(40, 0.1),
        disk(64, 0.0),
        sphere(30, 7),
        cuboid(DVec3::new(2.0, 0.01, 0.5)),
    ]);
    let mut rng = Rng::new(2);
    let mut counts = [0; 3];
    let mut counters = WalkCounters::default();
    for a in &bodies {
        for b in &bodies {
            for _ in 0..6 {
                let map = {
                    let distance = 1.7 * (rng.unit() + 1.0);
                    random_map(&mut rng, distance)
                };
                let state = &mut WalkState::default();
                let found =
                    walk_hulls(a.walkable(), b.walkable(), &map, state, &mut counters).unwrap();
                judge(a, b, &map, &found);
                counts[found.relation as usize] += 1;
            }
        }
    }
    assert!(counts[0] > 100 && counts[2] > 100, "{counts:?}");
    assert!(counters.exhausted <= 12, "flat on flat alone has no inner ball: {counters:?}");
}

#[test]
fn hulls_of_generators_agree_with_brute_force() {
    let mesh = |shape: &Shape| -> Mesh { shape.build().unwrap() };
    let mut rng = Rng::new(3);
    let probe = platonic_solids().remove(3);
    for shape in Shape::defaults() {
        let mesh = mesh(&shape);
        let size = mesh.vertices().iter().fold(0.0f64, |most, p| most.max(p.length()));
        let scaled: Vec<DVec3> = mesh.vertices().iter().map(|&p| p / size).collect();
        let body = Body::of(&scaled);
        for distance in [3.2, 2.0, 1.0] {
            let map = random_map(&mut rng, distance);
            judge(&body, &probe, &map, &ask_cold(&body, &probe, &map));
            judge(&probe, &body, &map, &ask_cold(&probe, &body, &map));
        }
    }
}

#[test]
fn frames_in_a_row_are_answered_by_proofs_and_as_if_cold() {
    let (a, b) = (sphere(300, 11), sphere(200, 12));
    let turn = Pose {
        rotation: DQuat::from_xyzw(0.0006, -0.0004, 0.0005, 1.0).normalize(),
        translation: DVec3::ZERO,
    };
    for center in [2.05, 1.93, 1.2] {
        let mut pose = Pose::at(DVec3::new(center, 0.2, 0.1));
        let (mut state, mut counters) = (WalkState::default(), WalkCounters::default());
        for frame in 0..600 {
            pose = turn.compose(&pose);
            // A rest, a jump, a reversal: history may not show.
            if frame == 300 {
                pose = Pose { rotation: pose.rotation.inverse(), ..pose };
            }
            let map = pose.world_from_body();
            let warm =
                walk_hulls(a.walkable(), b.walkable(), &map, &mut state, &mut counters).unwrap();
            let cold = ask_cold(&a, &b, &map);
            assert_eq!(warm.relation, cold.relation);
            if warm.relation == Relation::Separated {
                let apart = warm.separation.lo - cold.separation.lo;
                assert!(apart.abs() <= rounding(&a, &b, &map));
            }
            if frame % 100 == 0 {
                judge(&a, &b, &map, &warm);
            }
        }
        assert_eq!(counters.exhausted, 0);
        assert!(10 * counters.proved_at_once > 8 * counters.queries, "{counters:?}");
        assert!(counters.steps < 2500, "{counters:?}");
    }
}

#[test]
fn a_state_of_other_hulls_does_no_harm() {
    let bodies = [sphere(100, 21), cuboid(DVec3::ONE), disk(3, 0.0), Body::of(&[DVec3::ZERO])];
    let mut rng = Rng::new(4);
    let mut state = WalkState::default();
    for _ in 0..400 {
        let (a, b) = (&bodies[rng.below(4)], &bodies[rng.below(4)]);
        let map = {
            let distance = 1.5 * (rng.unit() + 1.0);
            random_map(&mut rng, distance)
        };
        let warm = ask(a, b, &map, &mut state);
        let cold = ask_cold(a, b, &map);
        assert_eq!(warm.relation, cold.relation);
        judge(a, b, &map, &warm);
    }
}

#[test]
fn exchanging_the_hulls_exchanges_the_answer() {
    let bodies = platonic_solids();
    let mut rng = Rng::new(6);
    for _ in 0..300 {
        let (a, b) = (&bodies[rng.below(5)], &bodies[rng.below(5)]);
        let map = {
            let distance = 1.8 * (rng.unit() + 1.0);
            random_map(&mut rng, distance)
        };
        let there = ask_cold(a, b, &map);
        let back = ask_cold(b, a, &map.inverse());
        assert_eq!(there.relation, back.relation);
        if there.relation == Relation::Separated {
            let slack = rounding(a, b, &map);
            assert!((there.separation.lo - back.separation.lo).abs() <= slack);
            assert!((there.normal + map.apply_vector(back.normal)).length() < 1e-6);
        }
    }
}

#[test]
fn depths_are_held_by_their_bounds() {
    let bodies = platonic_solids();
    let mut rng = Rng::new(8);
    let (mut overlaps, mut global, mut shallow) = (0, 0, 0);
    for round in 0..400 {
        let (a, b) = (&bodies[rng.below(3)], &bodies[rng.below(3)]);
        let map = random_map(&mut rng, 0.005 * f64::from(round));
        let found = ask_cold(a, b, &map);
        if found.relation != Relation::Penetrating {
            continue;
        }
        judge(a, b, &map, &found);
        let depth = brute_force_depth(a, b, &map);
        let slack = rounding(a, b, &map);
        let (least, most) = (-found.separation.hi, -found.separation.lo);
        assert!(least <= depth + slack && depth <= most + slack, "{depth} {found:?}");
        overlaps += 1;
        global += usize::from(most <= depth + slack);
        shallow += usize::from(most <= 1.5 * depth);
    }
    // Local minima, and honest about it: most are global all the same.
    assert!(
        overlaps > 200 && 2 * global > overlaps && 10 * shallow > 9 * overlaps,
        "{global} {shallow} of {overlaps}"
    );
}

#[test]
fn a_body_that_sinks_into_another_keeps_its_features() {
    let (floor, cube) = (cuboid(DVec3::new(4.0, 4.0, 1.0)), cuboid(DVec3::ONE));
    let tilted = DQuat::from_xyzw(0.3, 0.2, 0.1, 0.9).normalize();
    let lowest = cube.hull.positions().iter().map(|&p| (tilted * p).z).fold(0.0, f64::min);
    let mut state = WalkState::default();
    for step in 0..200 {
        let gap = 0.5 - 0.01 * f64::from(step) + 0.005;
        let map = Pose { rotation: tilted, translation: DVec3::new(0.3, 0.2, 1.0 - lowest + gap) };
        let found = ask(&floor, &cube, &map.world_from_body(), &mut state);
        let expected = if gap > 0.0 { Relation::Separated } else { Relation::Penetrating };
        assert_eq!(found.relation, expected, "gap {gap}");
        assert!((found.separation.lo - gap).abs() < 1e-13, "gap {gap}: {found:?}");
        assert_eq!(kinds(found.features), ['f', 'v']);
        assert!(found.normal.distance(DVec3::Z) < 1e-14);
    }
}

#[test]
fn a_walk_that_starts_on_the_far_side_goes_on_inside() {
    // Below the top facet's plane, over it, and yet below the box: the pseudo-internal regions lead
    // from the top facet to the bottom one, and nothing has to be searched.
    let (cube, point) = (cuboid(DVec3::ONE), Body::of(&[DVec3::ZERO]));
    let vertex = HullFeature::Vertex(HullVertexId(0));
    let facets = cube.graph.features().filter(|f| matches!(f, HullFeature::Facet(_)));
    for facet in facets {
        let (mut state, mut counters) =
            (WalkState::starting_at([facet, vertex]), WalkCounters::default());
        let map = at(0.2, 0.1, -3.0);
        let (a, b) = (cube.walkable(), point.walkable());
        let found = walk_hulls(a, b, &map, &mut state, &mut counters).unwrap();
        assert!(found.separation.contains(2.0), "{found:?}");
        assert_eq!(kinds(found.features), ['f', 'v']);
        assert_eq!((counters.searches, counters.cycles), (0, 0), "from {facet:?}");
    }
}

#[test]
fn motions_that_are_not_finite_are_refused() {
    let cube = cuboid(DVec3::ONE);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut state = WalkState::default();
        let map = at(bad, 0.0, 0.0);
        let (a, b) = (cube.walkable(), cube.walkable());
        let refused = walk_hulls(a, b, &map, &mut state, &mut WalkCounters::default());
        assert_eq!(refused, Err(WalkError::NotFinite));
    }
}
