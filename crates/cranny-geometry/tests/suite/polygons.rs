//! Polygons in triangles: areas add up, whatever the first corner, the direction and the plane.

use std::collections::BTreeMap;

use cranny_exact::{DVec2, DVec3, Sign, orient2d};
use cranny_geometry::{SplitPolygon, split_polygon};

fn flat(corners: &[[f64; 2]]) -> Vec<DVec3> {
    corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
}

/// Twice the area by the shoelace formula; exact on small lattices.
fn doubled_area(corners: &[DVec3]) -> f64 {
    let n = corners.len();
    (0..n).map(|k| corners[k].truncate().perp_dot(corners[(k + 1) % n].truncate())).sum()
}

fn seen(corners: &[DVec3], triangle: [u32; 3]) -> [DVec2; 3] {
    triangle.map(|k| corners[k as usize].truncate())
}

/// Sides by position, from the lesser end, counted by direction; opposite ones cancel.
fn boundary(corners: &[DVec3], loops: impl Iterator<Item = Vec<u32>>) -> BTreeMap<String, i64> {
    let mut net = BTreeMap::new();
    for around in loops {
        for k in 0..around.len() {
            let [a, b] = [around[k], around[(k + 1) % around.len()]]
                .map(|v| format!("{:?}", corners[v as usize]));
            if a != b {
                let (key, way) = if a < b { (a + &b, 1) } else { (b + &a, -1) };
                *net.entry(key).or_insert(0) += way;
            }
        }
    }
    net.retain(|_, count| *count != 0);
    net
}

/// Triangles as positions, in an order that does not depend on numbers.
fn places(corners: &[DVec3], split: &SplitPolygon, turn_over: bool) -> Vec<String> {
    let mut all: Vec<String> = split
        .triangles
        .iter()
        .map(|&[a, b, c]| {
            let t = if turn_over { [a, c, b] } else { [a, b, c] };
            let t = t.map(|k| format!("{:?}", corners[k as usize]));
            let least = (0..3).min_by_key(|&k| &t[k]).unwrap();
            (0..3).map(|k| t[(least + k) % 3].clone()).collect()
        })
        .collect();
    all.sort();
    all
}

/// Checks a simple polygon in the plane z = 0, from every `step`th first corner and in both
/// directions; those that are not convex give the same triangles each time.
fn check(corners: &[DVec3], step: usize) -> SplitPolygon {
    let first = split_polygon(corners);
    let turns = (0..corners.len() as u32).map(|k| {
        let n = corners.len() as u32;
        let [a, b, c] = seen(corners, [k, (k + 1) % n, (k + 2) % n]);
        orient2d(a, b, c)
    });
    let convex = turns.clone().all(|turn| turn != Sign::Negative)
        || turns.clone().all(|turn| turn != Sign::Positive);
    let wanted = places(corners, &first, false);
    for turn_over in [false, true] {
        let mut turned = corners.to_vec();
        if turn_over {
            turned.reverse();
        }
        for _ in (0..corners.len()).step_by(step) {
            turned.rotate_left(step);
            let split = split_polygon(&turned);
            assert!(split.simple && split.thickness == 0.0);
            let way = if doubled_area(&turned) > 0.0 { Sign::Positive } else { Sign::Negative };
            let mut area = 0.0;
            for &t in &split.triangles {
                let [a, b, c] = seen(&turned, t);
                assert_eq!(orient2d(a, b, c), way, "{t:?}");
                area += (b - a).perp_dot(c - a);
            }
            let wanted_area = doubled_area(&turned);
            assert!(
                (area - wanted_area).abs() <= 1e-12 * wanted_area.abs(),
                "{area} {wanted_area}"
            );
            assert_eq!(
                boundary(&turned, split.triangles.iter().map(|t| t.to_vec())),
                boundary(&turned, std::iter::once((0..turned.len() as u32).collect()))
            );
            if !convex {
                assert_eq!(places(&turned, &split, turn_over), wanted);
            }
        }
    }
    first
}

const L: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

#[test]
fn an_l_has_its_own_area_from_every_corner() {
    assert_eq!(check(&flat(&L), 1).triangles.len(), 4);
}

#[test]
fn a_convex_polygon_is_a_fan_from_its_first_corner() {
    let hexagon = [[2.0, 0.0], [1.0, 2.0], [-1.0, 2.0], [-2.0, 0.0], [-1.0, -2.0], [1.0, -2.0]];
    let split = check(&flat(&hexagon), 1);
    assert_eq!(split.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
}

#[test]
fn corners_on_straight_sides_stay_corners() {
    let square = [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [2.0, 2.0],
        [1.0, 2.0],
        [0.0, 2.0],
        [0.0, 1.0],
    ];
    assert_eq!(check(&flat(&square), 1).triangles.len(), 6);
}

#[test]
fn stars_and_a_comb_with_forty_prongs() {
    for points in 3..12 {
        let star: Vec<[f64; 2]> = (0..2 * points)
            .map(|k| {
                let angle = std::f64::consts::PI * f64::from(k) / f64::from(points);
                let r = if k % 2 == 0 { 8.0 } else { 1.0 };
                [r * angle.cos(), r * angle.sin()]
            })
            .collect();
        assert_eq!(check(&flat(&star), 1).triangles.len(), 2 * points as usize - 2);
    }
    let mut comb = vec![[80.0, -1.0], [80.0, 0.0]];
    for prong in (0..40).rev() {
        let x = 2.0 * f64::from(prong);
        comb.extend([[x + 1.0, 0.0], [x + 1.0, 30.0], [x, 30.0], [x, 0.0]]);
    }
    comb.push([0.0, -1.0]);
    assert_eq!(check(&flat(&comb), 7).triangles.len(), comb.len() - 2);
}

/// Numbers that are the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

/// A simple polygon of `n` corners on a lattice: heights over a row of columns, there above and
/// back below.
fn ragged(random: &mut Random, columns: u64, high: u64) -> Vec<DVec3> {
    let mut height = |sign: f64| sign * (1 + random.below(high)) as f64;
    let above: Vec<[f64; 2]> = (0..columns).map(|x| [x as f64, height(1.0)]).collect();
    let below: Vec<[f64; 2]> = (0..columns).map(|x| [x as f64, height(-1.0)]).collect();
    flat(&below.into_iter().chain(above.into_iter().rev()).collect::<Vec<_>>())
}

#[test]
fn ragged_polygons_on_a_lattice() {
    let mut random = Random(1);
    for _ in 0..200 {
        let columns = 2 + random.below(12);
        let polygon = ragged(&mut random, columns, 6);
        let split = check(&polygon, 1);
        assert_eq!(split.triangles.len(), polygon.len() - 2);
    }
}

#[test]
fn ten_thousand_corners() {
    let polygon = ragged(&mut Random(2), 5_000, 1000);
    assert_eq!(check(&polygon, 5_000).triangles.len(), 9_998);
    // A spiral of many windings, there and back: its corners see each other around none.
    let arm = |k: usize, r: f64| {
        let angle = 0.02 * k as f64;
        [(r + angle) * angle.cos(), (r + angle) * angle.sin()]
    };
    let out = (0..5_000).map(|k| arm(k, 1.0));
    let back = (0..5_000).rev().map(|k| arm(k, 2.0));
    assert_eq!(check(&flat(&out.chain(back).collect::<Vec<_>>()), 5_000).triangles.len(), 9_998);
}

#[test]
fn ten_thousand_corners_that_cross_in_disorder_are_split_and_told() {
    let mut random = Random(3);
    let mut at = || random.below(1 << 20) as f64;
    let polygon = flat(&(0..10_000).map(|_| [at(), at()]).collect::<Vec<_>>());
    let split = split_polygon(&polygon);
    assert!(!split.simple && !split.triangles.is_empty());
}

#[test]
fn every_plane_gives_the_area_of_its_own() {
    // The L in planes whose normals favour each axis in either direction, and none.
    let frames = [
        [DVec3::X, DVec3::Y],
        [DVec3::Y, DVec3::X],
        [DVec3::Y, DVec3::Z],
        [DVec3::Z, DVec3::X],
        [DVec3::X, DVec3::Z],
        [DVec3::new(1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, -2.0)],
    ];
    for [u, v] in frames {
        let tilted: Vec<DVec3> = L.iter().map(|&[x, y]| x * u + y * v).collect();
        let split = split_polygon(&tilted);
        assert!(split.simple && split.thickness < 1e-15);
        let area: DVec3 = split
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| tilted[k as usize]);
                (b - a).cross(c - a)
            })
            .sum();
        assert!((area - 6.0 * u.cross(v)).length() < 1e-12, "{area}");
        for first in 1..6 {
            let mut turned = tilted.clone();
            turned.rotate_left(first);
            assert_eq!(
                places(&turned, &split_polygon(&turned), false),
                places(&tilted, &split, false)
            );
        }
    }
}

#[test]
fn a_way_to_a_hole_and_back_leaves_the_hole_open() {
    let keyhole = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ];
    let split = check(&flat(&keyhole), 1);
    assert_eq!(split.triangles.len(), 8);
}

#[test]
fn parts_that_hang_together_at_a_corner_do_not_cross() {
    let bow = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [2.0, 2.0], [1.0, 1.0], [0.0, 2.0]];
    assert_eq!(check(&flat(&bow), 1).triangles.len(), 2);
}

#[test]
fn corners_twice_in_a_row_count_once() {
    let doubled: Vec<[f64; 2]> = L.iter().flat_map(|&p| [p, p]).collect();
    assert_eq!(check(&flat(&doubled), 1).triangles.len(), 4);
}

#[test]
fn what_is_no_simple_polygon_is_told() {
    let bow_tie = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
    let pentagram = [[0.0, 10.0], [6.0, -8.0], [-10.0, 3.0], [10.0, 3.0], [-6.0, -8.0]];
    let twice_around: Vec<[f64; 2]> = [&L[..], &L[..]].concat();
    let eight = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [2.0, 0.0], [1.0, 1.0], [0.0, 2.0]];
    let antenna = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let line = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [2.0, 0.0]];
    let there_and_back = [[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [1.0, 0.0]];
    let touching = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
    for corners in [
        &bow_tie[..],
        &pentagram,
        &twice_around,
        &eight,
        &antenna,
        &line,
        &there_and_back,
        &touching,
    ] {
        let polygon = flat(corners);
        for first in 0..corners.len() {
            let mut turned = polygon.clone();
            turned.rotate_left(first);
            let split = split_polygon(&turned);
            assert!(!split.simple, "{corners:?}");
            assert!(!split.triangles.is_empty(), "{corners:?}");
            let doubled: f64 = split
                .triangles
                .iter()
                .map(|&t| {
                    let [a, b, c] = seen(&turned, t);
                    (b - a).perp_dot(c - a)
                })
                .sum();
            assert_eq!(doubled, doubled_area(&turned), "{corners:?}");
        }
    }
}

#[test]
fn a_bent_polygon_says_how_far_it_leaves_its_plane() {
    let mut saddle = flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    saddle[0].z = 0.5;
    saddle[2].z = 0.5;
    assert_eq!(split_polygon(&saddle).thickness, 0.25);
    assert_eq!(split_polygon(&saddle[..2]), SplitPolygon::default());
}
