//! The exact triangle tests against brute force and exact rationals, on generated hard cases.

use cranny_exact::{
    Crossing, CrossingEnd, DVec3, Meeting, Piercing, SegmentFeature, TriangleFeature, check_point,
    classify_segment_triangle, classify_triangles, cross_triangles, locate_piercing, orient3d,
};
use cranny_testkit::{Family, Rng, brute_force_meeting, rational_meeting, rational_piercing};

type Triangle = [DVec3; 3];

const PAIRS: usize = 100_000;

const CORNER_ORDERS: [[usize; 3]; 6] =
    [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

fn in_order(t: &Triangle, order: [usize; 3]) -> Triangle {
    order.map(|i| t[i])
}

fn edges(t: &Triangle) -> [[DVec3; 2]; 3] {
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]
}

/// The families in turn.
fn pairs(seed: u64, count: usize) -> impl Iterator<Item = (Family, Triangle, Triangle)> {
    let mut rng = Rng::new(seed);
    (0..count).map(move |i| {
        let family = Family::ALL[i % Family::ALL.len()];
        let (a, b) = family.pair(&mut rng);
        (family, a, b)
    })
}

/// Whether a corner of one lies in the plane of the other, or one has no area.
fn is_degenerate(a: &Triangle, b: &Triangle) -> bool {
    let flat = |t: &Triangle, p: &DVec3| orient3d(t[0], t[1], t[2], *p).is_zero();
    a.iter().any(|p| flat(b, p)) || b.iter().any(|p| flat(a, p))
}

#[test]
fn fast_brute_force_and_rationals_agree_in_every_order() {
    let mut degenerate = 0;
    let mut meetings = [0; 3];
    for (i, (family, a, b)) in pairs(20, PAIRS).enumerate() {
        let expected = rational_meeting(&a, &b);
        let place = || format!("pair {i} ({family:?}): {a:?} and {b:?}");
        assert!(a.iter().chain(&b).all(|&p| check_point(p).is_ok()), "{}", place());
        assert_eq!(brute_force_meeting(&a, &b), expected, "brute force, {}", place());
        for first in CORNER_ORDERS.map(|order| in_order(&a, order)) {
            for second in CORNER_ORDERS.map(|order| in_order(&b, order)) {
                assert_eq!(classify_triangles(&first, &second), expected, "{}", place());
                assert_eq!(classify_triangles(&second, &first), expected, "swapped, {}", place());
            }
        }
        degenerate += usize::from(is_degenerate(&a, &b));
        meetings[expected as usize] += 1;
    }
    assert!(2 * degenerate >= PAIRS, "only {degenerate} of {PAIRS} pairs are degenerate");
    // The generators must not lose any kind of answer.
    assert!(meetings.iter().all(|&count| count >= PAIRS / 10), "{meetings:?}");
}

#[test]
fn crossings_are_made_by_the_edges_that_rationals_find() {
    let insides = Piercing::Point {
        on_segment: SegmentFeature::Interior,
        on_triangle: TriangleFeature::Interior,
    };
    let mut seen = [0; 2];
    for (i, (family, a, b)) in pairs(22, 20_000).enumerate() {
        let (meeting, crossing, _) = cross_triangles(&a, &b);
        let place = || format!("pair {i} ({family:?}): {a:?} and {b:?}");
        assert_eq!(meeting, classify_triangles(&a, &b), "{}", place());
        let piercing = |(owner, other): (&Triangle, &Triangle), name: u8| {
            let sides = edges(owner).map(|side| rational_piercing(&side, other) == insides);
            (0..3u8)
                .filter(move |&edge| sides[usize::from(edge)])
                .map(move |edge| CrossingEnd { owner: name, edge })
        };
        let mut expected: Vec<_> = piercing((&a, &b), 0).chain(piercing((&b, &a), 1)).collect();
        expected.sort_unstable();
        if let Some(Crossing { ends }) = crossing {
            let mut found = ends.to_vec();
            found.sort_unstable();
            assert_eq!(found, expected, "{}", place());
            // The other way round the normals' product is turned over, and so it is where one
            // triangle is.
            let renamed = |end: CrossingEnd| CrossingEnd { owner: 1 - end.owner, ..end };
            let backward = [renamed(ends[1]), renamed(ends[0])];
            assert_eq!(cross_triangles(&b, &a).1, Some(Crossing { ends: backward }), "{}", place());
            let turned = |end: CrossingEnd| match end.owner {
                0 => CrossingEnd { edge: 2 - end.edge, ..end },
                _ => end,
            };
            let over = cross_triangles(&[a[0], a[2], a[1]], &b).1;
            let backward = Crossing { ends: [turned(ends[1]), turned(ends[0])] };
            assert_eq!(over, Some(backward), "{}", place());
            seen[0] += 1;
        } else if meeting == Meeting::Cross {
            let in_general_position = expected.len() == 2 && !is_degenerate(&a, &b);
            assert!(!in_general_position, "{}", place());
            seen[1] += 1;
        }
    }
    assert!(seen[0] >= 1_000 && seen[1] >= 100, "{seen:?}");
}

#[test]
fn segments_meet_the_features_that_rationals_construct() {
    let mut found = std::collections::BTreeMap::new();
    for (i, (family, a, b)) in pairs(21, 20_000).enumerate() {
        for segment in edges(&a) {
            let expected = rational_piercing(&segment, &b);
            let place = || format!("pair {i} ({family:?}): {segment:?} and {b:?}");
            assert_eq!(locate_piercing(&segment, &b), expected, "{}", place());
            let [p, q] = segment;
            let shared = rational_meeting(&[p, q, q], &b); // Touch at most: it has no area
            let meeting = classify_segment_triangle(&segment, &b);
            assert_eq!(meeting.meets(), shared.meets(), "{}", place());
            let insides = Piercing::Point {
                on_segment: SegmentFeature::Interior,
                on_triangle: TriangleFeature::Interior,
            };
            assert_eq!(meeting == Meeting::Cross, expected == insides, "{}", place());
            *found.entry(format!("{expected:?}")).or_insert(0) += 1;
        }
    }
    // 3 parts of a segment on 7 parts of a triangle, a miss, and the co-planar case.
    assert_eq!(found.len(), 23, "{found:#?}");
    assert!(found.values().all(|&count| count >= 20), "{found:#?}");
}

#[test]
fn piercings_follow_their_renumbered_corners() {
    use TriangleFeature::{Edge, Interior, Vertex};
    for (_, a, b) in pairs(22, 5_000) {
        for segment in edges(&a) {
            let given = locate_piercing(&segment, &b);
            let backward = locate_piercing(&[segment[1], segment[0]], &b);
            let turned = locate_piercing(&segment, &in_order(&b, [1, 2, 0]));
            let mirrored = locate_piercing(&segment, &in_order(&b, [2, 1, 0]));
            let Piercing::Point { on_segment, on_triangle } = given else {
                assert_eq!([backward, turned, mirrored], [given; 3]);
                continue;
            };
            let other_end = match on_segment {
                SegmentFeature::Start => SegmentFeature::End,
                SegmentFeature::Interior => SegmentFeature::Interior,
                SegmentFeature::End => SegmentFeature::Start,
            };
            assert_eq!(backward, Piercing::Point { on_segment: other_end, on_triangle });
            let on_turned = match on_triangle {
                Vertex(i) => Vertex((i + 2) % 3),
                Edge(i) => Edge((i + 2) % 3),
                Interior => Interior,
            };
            assert_eq!(turned, Piercing::Point { on_segment, on_triangle: on_turned });
            let on_mirrored = match on_triangle {
                Vertex(i) => Vertex(2 - i),
                Edge(i) => Edge((4 - i) % 3),
                Interior => Interior,
            };
            assert_eq!(mirrored, Piercing::Point { on_segment, on_triangle: on_mirrored });
        }
    }
}

#[test]
fn powers_of_two_and_lattice_moves_change_nothing() {
    for (family, a, b) in pairs(23, 20_000) {
        let expected = classify_triangles(&a, &b);
        for exponent in [-90, -1, 1, 100] {
            let scale = 2f64.powi(exponent);
            let (a, b) = (a.map(|p| scale * p), b.map(|p| scale * p));
            assert_eq!(classify_triangles(&a, &b), expected, "{family:?} times 2^{exponent}");
        }
        if family == Family::Lattice {
            let offset = DVec3::new(1048576.0, -3.0, 77.0);
            let (a, b) = (a.map(|p| p + offset), b.map(|p| p + offset));
            assert_eq!(classify_triangles(&a, &b), expected);
        }
    }
}

#[test]
fn turning_the_axes_changes_nothing() {
    for (family, a, b) in pairs(24, 20_000) {
        let expected = classify_triangles(&a, &b);
        for turn in [
            |p: DVec3| DVec3::new(p.y, p.z, p.x),
            |p: DVec3| DVec3::new(p.z, p.x, p.y),
            |p: DVec3| DVec3::new(p.y, p.x, p.z),
            |p: DVec3| -p,
        ] {
            assert_eq!(classify_triangles(&a.map(turn), &b.map(turn)), expected, "{family:?}");
        }
    }
}

#[test]
fn one_ulp_decides() {
    // A needle's tip on a slanted face whose plane passes through multiples of 2^-53.
    let face = [DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.0)];
    let tip = DVec3::new(0.25, 0.25, 0.5);
    let blade = |tip: DVec3| [tip, DVec3::new(0.25, 0.0, 3.0), DVec3::new(0.0, 0.25, 3.0)];
    assert_eq!(classify_triangles(&face, &blade(tip)), Meeting::Touch);
    let raised = DVec3 { z: tip.z.next_up(), ..tip };
    assert_eq!(classify_triangles(&face, &blade(raised)), Meeting::None);
    let lowered = DVec3 { z: tip.z.next_down(), ..tip };
    assert_eq!(classify_triangles(&face, &blade(lowered)), Meeting::Cross);
}
