//! Bodies whose rims touch, nest and branch, counted by hand: as they are, turned, scaled, moved
//! and renumbered.

use std::collections::{BTreeMap, BTreeSet};

use crate::body::Body;
use cranny_concavity::ConcavityKind::{self, Island, Passage, Pocket, Void};
use cranny_concavity::features::Feature;
use cranny_exact::{DMat3, DVec3};
use cranny_geometry::{BuildOptions, FaceId, Mesh, Repair, VertexId};
use cranny_shapes::Cuboid;
use cranny_testkit::Rng;

use super::bodies;
use super::check::{check_sums, checked_with, closed_checked};
use super::rounding::classification;
use super::ways::{census, moved, rounded_to_single, turned};

/// Kinds and lids, sorted: what no way of writing a body may change.
fn kinds(model: &Body) -> Vec<(ConcavityKind, usize)> {
    census(model).into_iter().map(|(kind, lids, _)| (kind, lids)).collect()
}

/// Each concavity's faces and caps have the same boundary, and its loops are that boundary, each of
/// them simple.
fn assert_closes(model: &Body, what: &str) {
    for concavity in model.concavities().iter() {
        let mut chain: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        let mut add = |corners: [u32; 3], sign: i32| {
            for i in 0..3 {
                let (from, to) = (corners[i], corners[(i + 1) % 3]);
                let forward = if from < to { sign } else { -sign };
                *chain.entry([from.min(to), from.max(to)]).or_default() += forward;
            }
        };
        let faces = concavity.faces.iter().map(|&f| model.mesh().corners(f).map(|v| v.0));
        let caps = concavity.caps.iter();
        let caps = caps.map(|&c| model.concavities().cap(c).corners.map(|v| v.0));
        faces.for_each(|f| add(f, 1));
        caps.for_each(|c| add(c, -1));
        let left = chain.iter().filter(|e| *e.1 != 0).count();
        assert_eq!(left, 0, "{what}: {:?} {:?}", concavity.id(), concavity.kind);
        for rim in concavity.loops() {
            let seen: BTreeSet<_> = rim.vertices.iter().collect();
            assert_eq!(seen.len(), rim.vertices.len(), "{what}: a loop passes a vertex twice");
        }
    }
}

fn sheared(mesh: &Mesh) -> Mesh {
    let shear = DMat3::from_cols(
        DVec3::new(1.0, 0.25, 0.0),
        DVec3::new(0.125, 1.0, -0.25),
        DVec3::new(0.375, 0.0, 1.0),
    );
    moved(mesh, |p| shear * p)
}

/// Holds a body against what was counted, in every way.
fn assert_counts(mesh: &Mesh, mut expected: Vec<(ConcavityKind, usize)>, what: &str) {
    expected.sort_unstable();
    let model = closed_checked(mesh);
    assert_eq!(kinds(&model), expected, "{what}");
    assert_closes(&model, what);
    let class = classification(&model, FaceId::index);
    for scale in [2f64.powi(-60), 2f64.powi(30)] {
        let scaled = closed_checked(&moved(mesh, |p| scale * p));
        assert_eq!(classification(&scaled, FaceId::index), class, "{what}, scaled by {scale:e}");
    }
    let (other, names) = bodies::renumbered(mesh, &mut Rng::new(3));
    let other = closed_checked(&other);
    assert_closes(&other, what);
    assert_eq!(classification(&other, |f| names[f.index()]), class, "{what}, renumbered");
    let turn = turned(mesh);
    let ways = [
        ("sheared", sheared(mesh)),
        ("turned", turn.clone()),
        ("single", rounded_to_single(&turn)),
        ("1e-20", moved(&turn, |p| 1e-20 * p)),
        ("1e6", moved(&turn, |p| 1e6 * p)),
        ("far", moved(&turn, |p| p + DVec3::new(1e6, -1e6, 1e6))),
        ("far, as drawn", moved(mesh, |p| p + DVec3::new(1e6, -1e6, 1e6))),
        ("not so far", moved(mesh, |p| p + DVec3::new(4999.0, 0.0, 0.0))),
    ];
    for (way, mesh) in ways {
        let model = closed_checked(&mesh);
        assert_eq!(kinds(&model), expected, "{what}, {way}");
    }
}

type Region = BTreeSet<[i32; 2]>;

/// A block of `n` by `n` cells, of which those of a region are pits that run together where they
/// share a side: corners and sides that lie in pits all around, and the middles of pits, are
/// lowered.
fn tray(n: i32, pits: &Region) -> Mesh {
    let depth = |i: i32, j: i32| {
        let (x, y) = (i.div_euclid(2), j.div_euclid(2));
        let beside = |of: i32, odd: bool| if odd { vec![of] } else { vec![of - 1, of] };
        let mut around = beside(x, i % 2 == 1)
            .into_iter()
            .flat_map(|a| beside(y, j % 2 == 1).into_iter().map(move |b| [a, b]));
        if around.all(|cell| pits.contains(&cell)) { 1 + i % 2 + j % 2 } else { 0 }
    };
    let side = 2 * n + 1;
    let mut vertices: Vec<DVec3> = (0..side * side)
        .map(|k| {
            DVec3::new(
                f64::from(k % side),
                f64::from(k / side),
                -f64::from(depth(k % side, k / side)),
            )
        })
        .collect();
    let at = |i: i32, j: i32| (j * side + i) as u32;
    let mut faces = Vec::new();
    for x in 0..n {
        for y in 0..n {
            let ring = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]]
                .map(|[i, j]| at(2 * x + i, 2 * y + j));
            let middle = at(2 * x + 1, 2 * y + 1);
            faces.extend((0..8).map(|k| [middle, ring[k], ring[(k + 1) % 8]]));
        }
    }
    let last = 2 * n;
    let mut rim: Vec<u32> = (0..last).map(|i| at(i, 0)).collect();
    rim.extend((0..last).map(|j| at(last, j)));
    rim.extend((0..last).map(|i| at(last - i, last)));
    rim.extend((0..last).map(|j| at(0, last - j)));
    let low = vertices.len() as u32;
    for &v in &rim {
        let p = vertices[v as usize];
        vertices.push(p - 8.0 * DVec3::Z);
    }
    let bottom = vertices.len() as u32;
    vertices.push(DVec3::new(f64::from(n), f64::from(n), -8.0));
    let count = rim.len() as u32;
    for k in 0..count {
        let next = (k + 1) % count;
        let (a, b) = (rim[k as usize], rim[next as usize]);
        faces.extend([[low + k, low + next, b], [low + k, b, a], [bottom, low + next, low + k]]);
    }
    Mesh::new(vertices, faces).unwrap()
}

/// How many parts there are that hang together over sides.
fn parts(region: &Region) -> usize {
    let mut left = region.clone();
    let mut count = 0;
    while let Some(first) = left.pop_first() {
        count += 1;
        let mut open = vec![first];
        while let Some([x, y]) = open.pop() {
            for beside in [[x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]] {
                if left.remove(&beside) {
                    open.push(beside);
                }
            }
        }
    }
    count
}

fn region(n: i32, is_pit: impl Fn(i32, i32) -> bool) -> Region {
    (0..n * n).map(|k| [k % n, k / n]).filter(|&[x, y]| is_pit(x, y)).collect()
}

#[test]
fn pits_corner_to_corner_share_vertices_of_rims_and_nothing_else() {
    let pits = region(5, |x, y| (x + y) % 2 == 0);
    assert_counts(&tray(5, &pits), vec![(Pocket, 1); 13], "chequered");
}

#[test]
fn a_rim_may_touch_itself_at_several_vertices() {
    // Islands corner to corner in one pit: three of them in a row, then a ring of four.
    let row = region(5, |x, y| x != y || x == 0 || x == 4);
    let ring = region(5, |x, y| ![[2, 1], [1, 2], [3, 2], [2, 3]].contains(&[x, y]));
    // The ring parts its middle from what is around it.
    assert_counts(&tray(5, &row), vec![(Pocket, 1)], "row");
    assert_counts(&tray(5, &ring), vec![(Pocket, 1); 2], "ring");
    // A pit whose ends meet at corners, about an island.
    let hook = region(7, |x, y| {
        [[1, 1], [2, 1], [3, 1], [3, 2], [3, 3], [2, 3], [1, 2]].contains(&[x, y])
    });
    assert_counts(&tray(7, &hook), vec![(Pocket, 1)], "hook");
}

#[test]
fn grooves_nest_five_deep() {
    let rings = region(11, |x, y| {
        (x - 5).abs().max((y - 5).abs()) % 2 == 0 && (x - 5).abs().max((y - 5).abs()) < 5
    });
    let all = parts(&rings);
    assert_eq!(all, 3);
    assert_counts(&tray(11, &rings), vec![(Pocket, 1); 3], "rings of 11");
    let rings = region(19, |x, y| (x - 9).abs().max((y - 9).abs()) % 2 == 0);
    assert_counts(&tray(19, &rings), vec![(Pocket, 1); 5], "rings of 19");
}

#[test]
fn any_pits_are_as_many_as_hang_together_over_sides() {
    let mut rng = Rng::new(17);
    for round in 0..12 {
        let n = 3 + rng.below(4) as i32;
        let of_ten = 2 + rng.below(7);
        let pits: Region =
            region(n, |_, _| true).into_iter().filter(|_| rng.below(10) < of_ten).collect();
        let count = parts(&pits);
        assert_counts(
            &tray(n, &pits),
            vec![(Pocket, 1); count],
            &format!("round {round}: {pits:?}"),
        );
    }
}

#[test]
fn tunnels_branch() {
    let middle = |a: i32, b: i32| a == 2 && b == 2;
    let six =
        bodies::of_cells([5, 5, 5], |[x, y, z]| !(middle(x, y) || middle(y, z) || middle(z, x)));
    assert_counts(&six, vec![(Passage, 6)], "three tunnels");
    let five = bodies::of_cells([5, 5, 5], |[x, y, z]| {
        !(middle(x, y) && z > 0 || middle(y, z) || middle(z, x))
    });
    assert_counts(&five, vec![(Passage, 5)], "a tunnel ends");
    // A tunnel around a pillar: a ring within, two mouths.
    let ring = bodies::of_cells([5, 5, 3], |[x, y, z]| {
        let in_ring = z == 1 && (x - 2).abs().max((y - 2).abs()) == 1;
        let mouths = z == 1 && y == 2 && (x == 0 || x == 4);
        !(in_ring || mouths)
    });
    assert_counts(&ring, vec![(Passage, 2)], "ring");
    // Seven holes side by side, of which three meet within.
    let comb = bodies::of_cells([9, 3, 5], |[x, y, z]| {
        !(y == 1 && (x % 2 == 1 || z == 2 && (3..=7).contains(&x)))
    });
    assert_counts(&comb, vec![(Passage, 2), (Passage, 6)], "holes that meet");
}

#[test]
fn a_hollow_box_with_windows_is_one_passage() {
    let house = bodies::of_cells([5, 5, 5], |[x, y, z]| {
        let is_room = (1..4).contains(&x) && (1..4).contains(&y) && z > 0;
        let is_window = z == 2 && (y == 2 && (x == 0 || x == 4) || x == 2 && y == 0);
        !(is_room || is_window)
    });
    assert_counts(&house, vec![(Passage, 4)], "house");
}

#[test]
fn voids_nest_and_lie_side_by_side() {
    let shell = |size: f64, at: DVec3, inward: bool| {
        let mesh = moved(&Cuboid { size: [size; 3] }.build().unwrap(), |p| p + at);
        if inward { bodies::inside_out(&mesh) } else { mesh }
    };
    let mut mesh = shell(64.0, DVec3::ZERO, false);
    for (i, size) in [32.0, 16.0, 8.0, 4.0, 2.0].into_iter().enumerate() {
        mesh = mesh.joined(&shell(size, DVec3::splat(1.0), i % 2 == 0));
    }
    mesh = mesh.joined(&shell(8.0, DVec3::splat(-24.0), true));
    let expected = vec![(Void, 0), (Void, 0), (Void, 0), (Void, 0), (Island, 0), (Island, 0)];
    assert_counts(&mesh, expected, "voids");
    // Pieces in pits: an island in each.
    let pits = region(3, |x, y| x == 1 && y == 1);
    let piece = shell(0.25, DVec3::new(3.0, 3.0, -1.0), false);
    assert_counts(&tray(3, &pits).joined(&piece), vec![(Pocket, 1), (Island, 0)], "pebble");
}

/// A prism over a star, the upper star moved aside and another size: slanted notches, all corners
/// on the hull.
fn slanted_star(points: u32, scale: f64, shift: f64) -> Mesh {
    moved(&bodies::star_prism(points), |p| {
        let s = if p.z > 0.5 { scale } else { 1.0 };
        DVec3::new(s * p.x + shift * p.z, s * p.y - 0.5 * shift * p.z, p.z)
    })
}

#[test]
fn slanted_notches_whose_corners_are_all_on_the_hull_are_pockets() {
    for (points, scale, shift) in [(3, 1.0, 0.3), (5, 0.5, 0.1), (8, 0.75, -0.7), (7, 0.3, 0.0)] {
        let mesh = slanted_star(points, scale, shift);
        let model = closed_checked(&mesh);
        let mut all = (0..mesh.vertices().len() as u32).map(VertexId);
        assert!(all.all(|v| model.features().vertex(v) != Feature::Concavity));
        assert_counts(&mesh, vec![(Pocket, 1); points as usize], &format!("{points} points"));
    }
}

/// A body of which the first edge of every n-th face is halved on that side only.
fn with_t_vertices(mesh: &Mesh, every: usize) -> Mesh {
    let mut vertices = mesh.vertices().to_vec();
    let mut faces = Vec::new();
    for (i, &[a, b, c]) in mesh.faces().iter().enumerate() {
        if i % every == 0 {
            let middle = vertices.len() as u32;
            vertices.push(0.5 * (vertices[a as usize] + vertices[b as usize]));
            faces.extend([[a, middle, c], [middle, b, c]]);
        } else {
            faces.push([a, b, c]);
        }
    }
    Mesh::new(vertices, faces).unwrap()
}

#[test]
fn t_vertices_on_edges_of_the_hull_are_stitched_and_change_no_count() {
    let pits = region(3, |x, y| (x + y) % 2 == 0);
    let cup = bodies::of_cells([3, 3, 2], |[x, y, z]| !(x == 1 && y == 1 && z == 1));
    let bodies = [
        ("cube", Cuboid::default().build().unwrap(), vec![]),
        ("cup", cup, vec![(Pocket, 1)]),
        ("pits", tray(3, &pits), vec![(Pocket, 1); 5]),
        // Numbers of double precision, which no grid holds.
        ("notches", bodies::star_prism(5), vec![(Pocket, 1); 5]),
    ];
    for (what, mesh, expected) in bodies {
        for every in [1, 2, 3, 7] {
            let cut = with_t_vertices(&mesh, every);
            for cut in [cut.clone(), moved(&cut, |p| 2f64.powi(-40) * p), turned(&cut)] {
                // As filed: open along the cuts, which is reported, but as sound as it can be.
                checked_with(&cut, &BuildOptions::default());
                let options = BuildOptions { repair: Repair::Safe, ..BuildOptions::default() };
                let model = checked_with(&cut, &options);
                check_sums(&model);
                assert_closes(&model, what);
                assert_eq!(kinds(&model), expected, "{what}, every {every}");
            }
        }
    }
}

#[test]
fn cells_that_each_have_a_surface_of_their_own_keep_the_invariants() {
    let mut rng = Rng::new(23);
    for round in 0..40 {
        let mut mesh: Option<Mesh> = None;
        let cells: Vec<[i32; 3]> =
            (0..1 + rng.below(7)).map(|_| [0; 3].map(|_: i32| rng.between(0, 2))).collect();
        let cells: BTreeSet<[i32; 3]> = cells.into_iter().collect();
        for &cell in &cells {
            let at = DVec3::from_array(cell.map(f64::from));
            let cube = moved(&Cuboid::default().build().unwrap(), |p| p + at);
            mesh = Some(mesh.map_or(cube.clone(), |m| m.joined(&cube)));
        }
        let mesh = mesh.unwrap();
        for mesh in [mesh.clone(), turned(&mesh), rounded_to_single(&turned(&mesh))] {
            for repair in [Repair::None, Repair::Safe, Repair::Full] {
                let options = BuildOptions { repair, ..BuildOptions::default() };
                let model = checked_with(&mesh, &options);
                if model.is_closed() {
                    check_sums(&model);
                }
                let volume = model.mass_properties().map(|m| m.volume);
                assert!(
                    volume.is_none_or(|v| (v - cells.len() as f64).abs() < 1e-5),
                    "round {round} {repair:?}: {volume:?} of {cells:?}"
                );
            }
        }
    }
}
