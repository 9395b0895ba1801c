//! Cases by hand, and random chains on integer lattices, where areas and sides are exact integers.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::DVec2;
use proptest::prelude::*;

use super::{Triangulation, outlines, triangulate};

type Lattice = [i64; 2];

fn points(lattice: &[Lattice]) -> Vec<DVec2> {
    lattice.iter().map(|p| DVec2::new(p[0] as f64, p[1] as f64)).collect()
}

fn cycle(vertices: &[u32]) -> Vec<[u32; 2]> {
    (0..vertices.len()).map(|i| [vertices[i], vertices[(i + 1) % vertices.len()]]).collect()
}

fn cycles(loops: &[&[u32]]) -> Vec<[u32; 2]> {
    loops.iter().flat_map(|l| cycle(l)).collect()
}

fn orient([a, b, c]: [Lattice; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The chain's net edges: from the lower to the higher index, how often.
fn netted(edges: impl IntoIterator<Item = [u32; 2]>) -> BTreeMap<[u32; 2], i64> {
    let mut net = BTreeMap::new();
    for [a, b] in edges {
        if a != b {
            *net.entry([a.min(b), a.max(b)]).or_insert(0) += if a < b { 1 } else { -1 };
        }
    }
    net.retain(|_, count| *count != 0);
    net
}

fn sides(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    triangles.iter().flat_map(|t| cycle(t)).collect()
}

/// The winding number of the chain about a point on none of its edges, by a ray to the right.
/// The point's coordinates are in `1 / SCALE` of the lattice.
fn winding_number(lattice: &[Lattice], chain: &[[u32; 2]], p: Lattice) -> i64 {
    let fine = |v: u32| lattice[v as usize].map(|c| SCALE * c);
    let mut winding = 0;
    for &[a, b] in chain {
        let [a, b] = [fine(a), fine(b)];
        if (a[1] <= p[1]) != (b[1] <= p[1]) {
            let left = orient([a, b, p]);
            winding += i64::from(b[1] > a[1] && left > 0) - i64::from(b[1] < a[1] && left < 0);
        }
    }
    winding
}

const SCALE: i64 = 3;

/// Whether the interiors of two triangles of positive area (of either orientation) are disjoint: a
/// side of one has the other beyond it.
fn disjoint(s: [Lattice; 3], t: [Lattice; 3]) -> bool {
    let beyond = |s: [Lattice; 3], t: [Lattice; 3]| {
        let turn = orient(s).signum();
        (0..3).any(|i| t.iter().all(|&p| turn * orient([s[i], s[(i + 1) % 3], p]) <= 0))
    };
    beyond(s, t) || beyond(t, s)
}

/// Whether a segment passes through the interior of a triangle.
fn passes_through([p, q]: [Lattice; 2], t: [Lattice; 3]) -> bool {
    let signs = t.map(|c| orient([p, q, c]).signum());
    let turn = orient(t).signum();
    let one_side_of_a_side =
        (0..3).any(|i| [p, q].iter().all(|&e| turn * orient([t[i], t[(i + 1) % 3], e]) <= 0));
    signs.contains(&1) && signs.contains(&-1) && !one_side_of_a_side
}

/// Whether two edges meet in the inside of both, at a point that is none of the vertices.
fn any_cross(lattice: &[Lattice], edges: &[[u32; 2]], vertices: &BTreeSet<u32>) -> bool {
    let at = |v: u32| lattice[v as usize];
    let inside = |v: &u32, [a, b]: [Lattice; 2]| {
        let (p, low, high) = (at(*v), a.min(b), a.max(b));
        orient([a, b, p]) == 0 && low < p && p < high
    };
    edges.iter().enumerate().any(|(i, e)| {
        edges[i + 1..].iter().any(|f| {
            let ([a, b], [c, d]) = (e.map(at), f.map(at));
            let apart = |p: [Lattice; 2], q: [Lattice; 2]| {
                orient([p[0], p[1], q[0]]).signum() * orient([p[0], p[1], q[1]]).signum() == -1
            };
            apart([a, b], [c, d])
                && apart([c, d], [a, b])
                && !vertices.iter().any(|v| inside(v, [a, b]) && inside(v, [c, d]))
        })
    })
}

/// Everything that is promised of a triangulation.
fn check(lattice: &[Lattice], chain: &[[u32; 2]], forced: &[[u32; 2]]) -> Triangulation {
    let made = triangulate(&points(lattice), chain, forced);
    assert_eq!(netted(sides(&made.triangles)), netted(chain.iter().copied()), "the boundary");

    let named: BTreeSet<u32> = chain.iter().chain(forced).flatten().copied().collect();
    assert!(made.triangles.iter().flatten().all(|v| named.contains(v)), "a vertex of its own");

    let net = netted(chain.iter().copied());
    let used: BTreeSet<u32> = net.keys().chain(forced).flatten().copied().collect();
    let mut edges: Vec<[u32; 2]> = net.keys().copied().collect();
    assert!(made.exact || any_cross(lattice, &edges, &used), "inexact without a crossing");
    edges.extend(forced);
    assert!(!made.missed || any_cross(lattice, &edges, &used), "missed without a crossing");

    let corners = |t: &[u32; 3]| t.map(|v| lattice[v as usize]);
    let solid: Vec<[Lattice; 3]> =
        made.triangles.iter().map(corners).filter(|&t| orient(t) != 0).collect();
    for t in &solid {
        // The sum of coordinates of three corners is thrice the centroid.
        let centroid = [t[0][0] + t[1][0] + t[2][0], t[0][1] + t[1][1] + t[2][1]];
        let winding = winding_number(lattice, chain, centroid);
        if made.exact {
            let copies = made.triangles.iter().filter(|s| {
                let mut here = corners(s);
                let mut there = *t;
                here.sort_unstable();
                there.sort_unstable();
                here == there
            });
            let turns: Vec<i64> = copies.map(|s| orient(corners(s)).signum()).collect();
            assert_eq!(turns.len() as i64, winding.abs(), "layers of {t:?}");
            assert!(turns.iter().all(|&turn| turn == winding.signum()), "orientation of {t:?}");
        }
    }
    if made.exact {
        let distinct: BTreeSet<[Lattice; 3]> = solid
            .iter()
            .map(|t| {
                let mut t = *t;
                t.sort_unstable();
                t
            })
            .collect();
        let distinct: Vec<[Lattice; 3]> = distinct.into_iter().collect();
        for (i, &s) in distinct.iter().enumerate() {
            for &t in &distinct[i + 1..] {
                assert!(disjoint(s, t), "{s:?} and {t:?} overlap");
            }
            for edge in forced.iter().filter(|_| !made.missed) {
                let edge = edge.map(|v| lattice[v as usize]);
                assert!(!passes_through(edge, s), "forced {edge:?} through {s:?}");
            }
        }
    }

    let mut turned: Vec<[u32; 2]> = chain.to_vec();
    turned.reverse();
    turned.rotate_left(chain.len() / 3);
    assert_eq!(triangulate(&points(lattice), &turned, forced), made, "the order of edges matters");

    let loops = outlines(&made.triangles);
    assert_eq!(netted(loops.iter().flat_map(|l| cycle(l))), netted(chain.iter().copied()));
    for outline in &loops {
        assert_eq!(outline.iter().collect::<BTreeSet<_>>().len(), outline.len());
    }
    made
}

fn solid_count(lattice: &[Lattice], made: &Triangulation) -> usize {
    made.triangles.iter().filter(|t| orient(t.map(|v| lattice[v as usize])) != 0).count()
}

/// The corners of `[x0, x1] × [y0, y1]`, counter-clockwise.
fn square(low: i64, high: i64) -> [Lattice; 4] {
    [[low, low], [high, low], [high, high], [low, high]]
}

#[test]
fn a_square_has_two_triangles() {
    let made = check(&square(0, 1), &cycle(&[0, 1, 2, 3]), &[]);
    assert!(made.exact);
    assert_eq!(made.triangles.len(), 2);
}

#[test]
fn an_empty_chain_has_none() {
    let made = check(&square(0, 1), &[], &[]);
    assert_eq!(made, Triangulation { triangles: vec![], exact: true, missed: false });
    // Edges there and back cancel, loops of one vertex are nothing.
    let made = check(&square(0, 1), &[[0, 1], [1, 0], [2, 2]], &[]);
    assert_eq!(made, Triangulation { triangles: vec![], exact: true, missed: false });
}

#[test]
fn a_square_with_a_square_hole_has_eight() {
    let lattice = [square(0, 9), square(3, 6)].concat();
    let made = check(&lattice, &cycles(&[&[0, 1, 2, 3], &[7, 6, 5, 4]]), &[]);
    assert!(made.exact);
    assert_eq!(made.triangles.len(), 8);
    assert_eq!(outlines(&made.triangles), [vec![0, 1, 2, 3], vec![4, 7, 6, 5]]);
}

#[test]
fn holes_that_touch_at_a_vertex_stay_open() {
    let lattice = [square(0, 9).as_slice(), &square(2, 4), &square(4, 6)[1..]].concat();
    // 6 is the upper corner of the first hole and the lower one of the second: 6 8 9 10.
    let made = check(&lattice, &cycles(&[&[0, 1, 2, 3], &[7, 6, 5, 4], &[6, 10, 9, 8]]), &[]);
    assert!(made.exact);
    assert_eq!(solid_count(&lattice, &made), made.triangles.len());
    assert_eq!(outlines(&made.triangles).len(), 3);
}

#[test]
fn islands_in_holes_are_filled() {
    let lattice = [square(0, 19), square(3, 16), square(6, 13), square(8, 10)].concat();
    let rings: [&[u32]; 4] = [&[0, 1, 2, 3], &[7, 6, 5, 4], &[8, 9, 10, 11], &[15, 14, 13, 12]];
    let made = check(&lattice, &cycles(&rings), &[]);
    assert!(made.exact);
    assert_eq!(made.triangles.len(), 16);
}

#[test]
fn a_vertex_on_an_edge_gives_a_triangle_without_area() {
    // Two triangles above the long edge 0 1 share the vertex 2 in its middle: 0 2 3 and 2 1 4;
    // below it one whole triangle 0 5 1.
    let lattice = [[0, 0], [4, 0], [2, 0], [0, 2], [4, 2], [2, -2]];
    let made = check(&lattice, &cycles(&[&[0, 2, 3], &[2, 1, 4], &[0, 5, 1]]), &[]);
    assert!(made.exact);
    assert_eq!(made.triangles.len() - solid_count(&lattice, &made), 1);
    assert!(made.triangles.iter().any(|t| *t == [0, 2, 1] || *t == [2, 1, 0] || *t == [1, 0, 2]));
}

#[test]
fn vertices_at_one_place_are_bridged_without_area() {
    // Two triangles that touch in the origin, each with an index of its own there.
    let lattice = [[0, 0], [1, -1], [1, 1], [0, 0], [-1, 1], [-1, -1]];
    let made = check(&lattice, &cycles(&[&[0, 1, 2], &[3, 4, 5]]), &[]);
    assert!(made.exact);
    assert_eq!(solid_count(&lattice, &made), 2);
    // A square whose corners all occur twice, and a loop between two indices of one place.
    let lattice = [square(0, 2), square(0, 2)].concat();
    let made = check(&lattice, &cycles(&[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4]]), &[]);
    assert!(made.exact);
    assert_eq!(solid_count(&lattice, &made), 0);
    let made = check(&lattice, &cycle(&[0, 4, 1, 5, 6, 2, 3, 7]), &[]);
    assert_eq!((made.exact, solid_count(&lattice, &made)), (true, 2));
}

#[test]
fn a_bow_tie_has_a_side_of_each_sign() {
    let lattice = [[0, 0], [2, 2], [2, 0], [0, 2]];
    let made = check(&lattice, &cycle(&[0, 1, 2, 3]), &[]);
    assert!(!made.exact);
    let areas: i64 = made.triangles.iter().map(|t| orient(t.map(|v| lattice[v as usize]))).sum();
    assert_eq!(areas, 0);
    // With its crossing as a vertex the same curve is two triangles.
    let lattice = [[0, 0], [2, 2], [2, 0], [0, 2], [1, 1]];
    let made = check(&lattice, &cycle(&[0, 4, 1, 2, 4, 3]), &[]);
    assert_eq!((made.exact, made.triangles.len()), (true, 2));
    // A vertex of something else at the crossing is enough.
    let lattice = [[0, 0], [2, 2], [2, 0], [0, 2], [1, 1], [2, 1]];
    let made = check(&lattice, &cycles(&[&[0, 1, 2, 3], &[4, 5, 1]]), &[]);
    assert!(made.exact);
}

#[test]
fn a_crossing_disturbs_only_its_neighbourhood() {
    // A hole whose corner sticks out through the right side of a square, and another hole far away.
    let lattice =
        [square(0, 90).as_slice(), &square(10, 20), &[[80, 40], [91, 45], [80, 50]]].concat();
    let made = check(&lattice, &cycles(&[&[0, 1, 2, 3], &[7, 6, 5, 4], &[10, 9, 8]]), &[]);
    assert!(!made.exact);
    let magnitudes: i64 =
        made.triangles.iter().map(|t| orient(t.map(|v| lattice[v as usize])).abs()).sum();
    let area = 2 * (90 * 90 - 10 * 10 - 55);
    // The right side takes the way over the corner outside; the strip between counts twice.
    assert_eq!(magnitudes, area + 2 * 90);
}

#[test]
fn a_detour_goes_forward_and_on_the_closer_side() {
    // 0 1 crosses 2 3 and is the longer; 3 lies closer to it than 2. Behind its start, on its line,
    // ends the side 0 4 of another triangle.
    let lattice = [[0, 0], [4, 0], [2, 2], [2, -1], [-2, 0], [-2, -3]];
    let made = check(&lattice, &cycles(&[&[0, 1, 2, 3], &[4, 5, 0]]), &[]);
    assert!(!made.exact);
    let mut areas: Vec<i64> =
        made.triangles.iter().map(|t| orient(t.map(|v| lattice[v as usize]))).collect();
    areas.sort_unstable();
    assert_eq!(areas, [-4, 6, 6]); // 0 1 3, which fills the strip; 3 1 2; 4 5 0
}

#[test]
fn a_forced_edge_that_crosses_the_boundary_is_missed_and_disturbs_nothing() {
    let lattice = [square(0, 4).as_slice(), &[[1, 2], [6, 3]]].concat();
    let made = check(&lattice, &cycle(&[0, 1, 2, 3]), &[[4, 5]]);
    assert!(made.exact && made.missed);
    assert_eq!(made.triangles.len(), 4);
    assert!(made.triangles.iter().all(|t| orient(t.map(|v| lattice[v as usize])) > 0));
}

#[test]
fn twice_around_is_two_layers_and_clockwise_is_negative() {
    let lattice = [square(0, 9), square(3, 6)].concat();
    let made = check(&lattice, &cycles(&[&[0, 1, 2, 3], &[4, 5, 6, 7]]), &[]);
    assert_eq!((made.exact, made.triangles.len()), (true, 8 + 2 * 2));
    let made = check(&lattice, &cycle(&[3, 2, 1, 0]), &[]);
    assert_eq!((made.exact, made.triangles.len()), (true, 2));
    let made = check(&lattice, &cycles(&[&[3, 2, 1, 0], &[7, 6, 5, 4], &[7, 6, 5, 4]]), &[]);
    assert_eq!((made.exact, made.triangles.len()), (true, 8 + 3 * 2));
}

#[test]
fn a_line_there_and_back_has_no_area() {
    let lattice = [[0, 0], [3, 3], [1, 1], [2, 2], [5, 5]];
    let made = check(&lattice, &cycle(&[0, 1, 3, 2]), &[]);
    assert_eq!((made.exact, solid_count(&lattice, &made)), (true, 0));
    let made = check(&lattice, &cycle(&[4, 2, 1, 0, 3]), &[[0, 4]]);
    assert_eq!((made.exact, solid_count(&lattice, &made)), (true, 0));
}

#[test]
fn a_star_has_two_triangles_less_than_corners() {
    let outer = [[0, 30], [28, 9], [18, -24], [-18, -24], [-28, 9]];
    let inner = [[6, 9], [10, -3], [0, -11], [-10, -3], [-6, 9]];
    let lattice: Vec<Lattice> = outer.iter().zip(&inner).flat_map(|(o, i)| [*o, *i]).collect();
    let clockwise: Vec<u32> = (0..10).collect();
    let made = check(&lattice, &cycle(&clockwise), &[]);
    assert_eq!((made.exact, made.triangles.len()), (true, 8));
}

#[test]
fn forced_edges_are_edges() {
    let lattice = square(0, 4);
    for diagonal in [[0, 2], [1, 3]] {
        let made = check(&lattice, &cycle(&[0, 1, 2, 3]), &[diagonal]);
        assert!(made.exact && !made.missed);
        let all = sides(&made.triangles);
        assert!(all.contains(&diagonal) && all.contains(&[diagonal[1], diagonal[0]]));
    }
    // Both diagonals cannot be: one is missed, and the boundary is right nevertheless.
    let made = check(&lattice, &cycle(&[0, 1, 2, 3]), &[[0, 2], [1, 3]]);
    assert!(made.exact && made.missed);
    // A forced edge that ends inside, and one through a vertex that another edge brings along.
    let lattice = [square(0, 4).as_slice(), &[[1, 1], [3, 1], [2, 2]]].concat();
    let made = check(&lattice, &cycle(&[0, 1, 2, 3]), &[[4, 5], [0, 2], [6, 3]]);
    assert!(made.exact && !made.missed);
    assert_eq!(made.triangles.len(), 2 + 2 * 3);
}

#[test]
fn bad_input_is_answered_with_a_fan() {
    let chain = cycle(&[0, 1, 2, 3]);
    for bad in [f64::NAN, f64::INFINITY, 1e200, 1e-200] {
        let mut points = points(&square(0, 1));
        points[2].y = bad;
        let made = triangulate(&points, &chain, &[]);
        assert_eq!(
            (made.triangles.as_slice(), made.exact),
            ([[0, 1, 2], [0, 2, 3]].as_slice(), false)
        );
    }
    let missing = triangulate(&points(&square(0, 1)), &cycles(&[&[0, 1, 9], &[3, 4, 5]]), &[]);
    assert_eq!((missing.triangles, missing.exact), (vec![[0, 1, 9], [3, 4, 5]], false));
    let open = triangulate(&points(&square(0, 1)), &[[0, 1], [1, 2]], &[]);
    assert_eq!((open.triangles, open.exact), (vec![[0, 1, 2]], false));
}

#[test]
fn signed_zeros_are_one_place() {
    let points =
        [DVec2::new(0.0, 0.0), DVec2::new(1.0, 0.0), DVec2::new(-0.0, 1.0), DVec2::new(-0.0, -0.0)];
    let made = triangulate(&points, &cycle(&[0, 1, 2, 3]), &[]);
    assert_eq!(netted(sides(&made.triangles)), netted(cycle(&[0, 1, 2, 3])));
    assert!(made.exact);
    assert_eq!(made.triangles.len(), 2);
}

#[test]
fn one_ulp_decides_between_a_split_and_none() {
    let tenth = 0.1;
    let on_line = DVec2::new(tenth, tenth);
    for (middle, exact_triangles) in [(on_line, 1), (DVec2::new(tenth, tenth.next_up()), 2)] {
        // The lower triangle 0 1 2 of a square and a vertex on its diagonal, or just above it.
        let points = [DVec2::ZERO, DVec2::X, DVec2::ONE, middle];
        let made = triangulate(&points, &cycle(&[0, 1, 2, 3]), &[]);
        assert!(made.exact);
        assert_eq!(made.triangles.len(), 2, "{middle}");
        let turns = made.triangles.iter().filter(|t| {
            let [a, b, c] = t.map(|v| points[v as usize]);
            !cranny_exact::orient2d(a, b, c).is_zero()
        });
        assert!(turns.count() >= exact_triangles);
    }
}

#[test]
fn a_tangle_of_many_crossings_ends_as_a_fan() {
    let n = 3000u32;
    let mut state = 7u64;
    let lattice: Vec<Lattice> = (0..n)
        .map(|_| {
            [0; 2].map(|_: i64| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 40) as i64
            })
        })
        .collect();
    let chain = cycle(&(0..n).collect::<Vec<_>>());
    let made = triangulate(&points(&lattice), &chain, &[]);
    assert_eq!(netted(sides(&made.triangles)), netted(chain));
    assert!(!made.exact);
    assert_eq!(made.triangles.len(), n as usize - 2);
}

#[test]
fn combs_of_many_teeth_leave_no_gap() {
    // Teeth that lean so far that each crosses the places of many others.
    let teeth = 500;
    let mut lattice = vec![[-10, -10]];
    for i in 0..teeth {
        lattice.extend([[10 * i, 0], [10 * i + 4000, 1000 + i % 7], [10 * i + 5, 0]]);
    }
    lattice.push([10 * teeth, -10]);
    let made = triangulate(
        &points(&lattice),
        &cycle(&(0..lattice.len() as u32).rev().collect::<Vec<_>>()),
        &[],
    );
    assert!(made.exact);
    assert_eq!(made.triangles.len(), lattice.len() - 2);
    assert!(made.triangles.iter().all(|t| orient(t.map(|v| lattice[v as usize])) > 0));
}

/// Unit cells of a small grid, merged: regions with holes and islands that touch at vertices.
fn cells(filled: &[bool], size: i64) -> (Vec<Lattice>, Vec<[u32; 2]>) {
    let row = size + 1;
    let lattice = (0..row * row).map(|i| [i % row, i / row]).collect();
    let mut chain = Vec::new();
    for (i, _) in filled.iter().enumerate().filter(|f| *f.1) {
        let corner = (i as i64 % size + row * (i as i64 / size)) as u32;
        let row = row as u32;
        chain.extend(cycle(&[corner, corner + 1, corner + 1 + row, corner + row]));
    }
    let chain = netted(chain).into_iter().flat_map(|([a, b], count)| {
        let edge = if count > 0 { [a, b] } else { [b, a] };
        std::iter::repeat_n(edge, count.unsigned_abs() as usize)
    });
    (lattice, chain.collect())
}

/// Joins pairs of edges `u v`, `v w` of a chain into `u w` where a straight line allows it.
fn joined(lattice: &[Lattice], chain: &[[u32; 2]], choices: u64) -> Vec<[u32; 2]> {
    let mut chain = chain.to_vec();
    for round in 0..64 {
        let straight = (0..chain.len()).find_map(|i| {
            let [u, v] = chain[i];
            let j = chain.iter().position(|&[a, w]| {
                let [p, q, r] = [u, v, w].map(|x| lattice[x as usize]);
                let forward = (q[0] - p[0]) * (r[0] - q[0]) + (q[1] - p[1]) * (r[1] - q[1]) > 0;
                a == v && forward && orient([p, q, r]) == 0
            })?;
            (choices >> ((u + v + round) % 64) & 1 == 1).then_some((i, j))
        });
        if let Some((i, j)) = straight {
            let edge = [chain[i][0], chain[j][1]];
            chain.swap_remove(i.max(j));
            chain.swap_remove(i.min(j));
            chain.push(edge);
        }
    }
    chain
}

/// The rotations by 0 and by the angle of (3, 4), and shears: lattice to lattice, orientation kept.
fn moved(lattice: &[Lattice], way: u8) -> Vec<Lattice> {
    let [a, b, c, d] = [[1, 0, 0, 1], [3, -4, 4, 3], [0, -1, 1, 0], [2, 1, 1, 1]][way as usize % 4];
    lattice.iter().map(|&[x, y]| [a * x + b * y, c * x + d * y]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn merged_cells_are_exact(
        filled in prop::collection::vec(any::<bool>(), 36),
        choices in any::<u64>(),
        way in 0u8..4,
        forced in prop::collection::vec([0u32..49, 0u32..49], 0..3),
    ) {
        let (lattice, chain) = cells(&filled, 6);
        let lattice = moved(&lattice, way);
        let chain = joined(&lattice, &chain, choices);
        prop_assert!(check(&lattice, &chain, &[]).exact);
        check(&lattice, &chain, &forced);
    }

    #[test]
    fn sums_of_triangles_keep_their_winding_numbers(
        lattice in prop::collection::vec([-9i64..10, -9i64..10], 4..14),
        triples in prop::collection::vec([0usize..14, 0usize..14, 0usize..14], 1..9),
        forced in prop::collection::vec([0usize..14, 0usize..14], 0..3),
    ) {
        let id = |i: usize| (i % lattice.len()) as u32;
        let chain: Vec<_> = triples.iter().flat_map(|t| cycle(&t.map(id))).collect();
        let forced: Vec<_> = forced.iter().map(|e| e.map(id)).collect();
        check(&lattice, &chain, &forced);
    }

    #[test]
    fn walks_on_a_tiny_lattice_keep_their_boundary(
        lattice in prop::collection::vec([0i64..4, 0i64..3], 3..16),
        walk in prop::collection::vec(0usize..16, 2..24),
    ) {
        let walk: Vec<u32> = walk.iter().map(|i| (i % lattice.len()) as u32).collect();
        check(&lattice, &cycle(&walk), &[]);
    }

    #[test]
    fn star_shaped_polygons_are_exact(
        radii in prop::collection::vec(1i64..40, 3..40),
        mirrored in any::<bool>(),
    ) {
        // Directions of a convex polygon's corners, (i, i²) about a point inside, each with its own
        // radius.
        let n = radii.len() as i64;
        let lattice: Vec<Lattice> = (0..n)
            .map(|i| {
                let r = radii[i as usize];
                [r * (2 * i - n + 1), r * (i * i - n * n / 3 - 1)]
            })
            .map(|[x, y]| if mirrored { [-x, y] } else { [x, y] })
            .collect();
        let made = check(&lattice, &cycle(&(0..n as u32).collect::<Vec<_>>()), &[]);
        let angles_wrap = (0..n as usize).all(|i| {
            orient([[0, 0], lattice[i], lattice[(i + 1) % n as usize]]) * if mirrored { -1 } else { 1 } > 0
        });
        if angles_wrap {
            prop_assert!(made.exact);
            prop_assert_eq!(made.triangles.len(), n as usize - 2);
        }
    }

    #[test]
    fn points_an_ulp_apart_are_told_apart(
        steps in prop::collection::vec([0u64..4, 0u64..4], 3..12),
        walk in prop::collection::vec(0usize..12, 3..14),
    ) {
        let near = |base: f64, n: u64| f64::from_bits(base.to_bits() + n);
        let points: Vec<DVec2> =
            steps.iter().map(|s| DVec2::new(near(0.1, s[0]), near(0.7, s[1]))).collect();
        let walk: Vec<u32> = walk.iter().map(|i| (i % points.len()) as u32).collect();
        let made = triangulate(&points, &cycle(&walk), &[]);
        prop_assert_eq!(netted(sides(&made.triangles)), netted(cycle(&walk)));
        // Steps of one size each way: the same walk on the lattice of steps has the same answer.
        let lattice: Vec<Lattice> = steps.iter().map(|s| s.map(|n| n as i64)).collect();
        prop_assert_eq!(made.exact, check(&lattice, &cycle(&walk), &[]).exact);
    }
}
