//! What a closed, oriented, non-self-intersecting solid is, decided exactly.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{
    Aabb, DVec2, DVec3, Meeting, Sign, classify_segment_triangle, classify_triangles, orient2d,
    orient3d,
};
use cranny_geometry::Mesh;

type Triangle = [DVec3; 3];

/// Counts handles: V - E + F = 2 - 2 genus. Panics, naming the offender, where the mesh is not one
/// closed, oriented shell of faces with area on distinct, used vertices.
pub(crate) fn genus_of_closed_shell(mesh: &Mesh) -> i64 {
    let mut positions = BTreeSet::new();
    for p in mesh.vertices() {
        // Adding zero makes the negative zero positive.
        let bits = (*p + DVec3::ZERO).to_array().map(f64::to_bits);
        assert!(positions.insert(bits), "two vertices at {p}");
    }
    let mut half_edges = BTreeMap::new();
    for (face, &[a, b, c]) in mesh.faces().iter().enumerate() {
        for edge in [(a, b), (b, c), (c, a)] {
            let twice = half_edges.insert(edge, face);
            assert!(twice.is_none(), "edge {edge:?} in faces {face} and {twice:?}");
        }
        let [a, b, c] = triangle(mesh, face);
        let flat = |drop: fn(DVec3) -> DVec2| orient2d(drop(a), drop(b), drop(c)).is_zero();
        let no_area = flat(|p| DVec2::new(p.x, p.y))
            && flat(|p| DVec2::new(p.y, p.z))
            && flat(|p| DVec2::new(p.z, p.x));
        assert!(!no_area, "face {face} has no area: {a} {b} {c}");
    }
    for (a, b) in half_edges.keys() {
        assert!(half_edges.contains_key(&(*b, *a)), "edge {a} -> {b} has no twin");
    }
    assert_one_fan_around_each_vertex(mesh, &half_edges);
    assert_connected(mesh, &half_edges);
    let count = |n: usize| n as i64;
    let euler =
        count(mesh.vertices().len()) - count(half_edges.len() / 2) + count(mesh.faces().len());
    assert_eq!(euler % 2, 0);
    (2 - euler) / 2
}

/// Around each vertex the faces form one fan: as many as one walk meets.
fn assert_one_fan_around_each_vertex(mesh: &Mesh, half_edges: &BTreeMap<(u32, u32), usize>) {
    let mut valence = vec![0usize; mesh.vertices().len()];
    let mut start = vec![None; mesh.vertices().len()];
    for &(a, b) in half_edges.keys() {
        valence[a as usize] += 1;
        start[a as usize] = Some(b);
    }
    for (vertex, start) in start.iter().enumerate() {
        let start = start.unwrap_or_else(|| panic!("vertex {vertex} is unused"));
        let (mut spoke, mut met) = (start, 0);
        loop {
            // From the face left of (vertex, spoke), on to its third corner.
            let corners = mesh.faces()[half_edges[&(vertex as u32, spoke)]];
            let at =
                corners.iter().position(|&i| i as usize == vertex).expect("a corner of its face");
            spoke = corners[(at + 2) % 3];
            met += 1;
            if spoke == start {
                break;
            }
        }
        assert_eq!(met, valence[vertex], "faces around vertex {vertex} form several fans");
    }
}

fn assert_connected(mesh: &Mesh, half_edges: &BTreeMap<(u32, u32), usize>) {
    let mut seen = vec![false; mesh.faces().len()];
    let mut stack = vec![0];
    while let Some(face) = stack.pop() {
        if !std::mem::replace(&mut seen[face], true) {
            let [a, b, c] = mesh.faces()[face];
            stack.extend([(b, a), (c, b), (a, c)].map(|twin| half_edges[&twin]));
        }
    }
    assert!(!seen.contains(&false), "the mesh has several components");
}

/// Volume by the divergence theorem; positive if faces look outward.
pub(crate) fn volume(mesh: &Mesh) -> f64 {
    let origin = mesh.bounds().center();
    let six_times = |face| {
        let [a, b, c] = triangle(mesh, face).map(|p| p - origin);
        a.dot(b.cross(c))
    };
    (0..mesh.faces().len()).map(six_times).sum::<f64>() / 6.0
}

fn triangle(mesh: &Mesh, face: usize) -> Triangle {
    mesh.faces()[face].map(|i| mesh.vertices()[i as usize])
}

/// A pair of faces that meets elsewhere than in what it shares.
pub(crate) fn self_intersection(mesh: &Mesh) -> Option<(usize, usize)> {
    let triangles: Vec<_> = (0..mesh.faces().len()).map(|f| triangle(mesh, f)).collect();
    let faces = mesh.faces();
    first_overlapping_pair(&triangles, |i, j| improper(faces[i], faces[j], mesh.vertices()))
}

/// A pair of triangles, one of each mesh (the second one posed), that share a point.
pub(crate) fn meeting_pair(
    a: &Mesh,
    b: &Mesh,
    pose_b: impl Fn(DVec3) -> DVec3,
) -> Option<(usize, usize)> {
    let ours = a.faces().len();
    let mut triangles: Vec<_> = (0..ours).map(|f| triangle(a, f)).collect();
    triangles.extend((0..b.faces().len()).map(|f| triangle(b, f).map(&pose_b)));
    first_overlapping_pair(&triangles, |i, j| {
        (i < ours) != (j < ours)
            && !one_sided(&triangles[i], &triangles[j])
            && classify_triangles(&triangles[i], &triangles[j]) != Meeting::None
    })
}

/// Sweeps the boxes along the longest axis and asks about each pair that overlaps.
fn first_overlapping_pair(
    triangles: &[Triangle],
    meet: impl Fn(usize, usize) -> bool,
) -> Option<(usize, usize)> {
    let boxes: Vec<Aabb> = triangles.iter().map(|t| Aabb::of_points(*t)).collect();
    let all = boxes.iter().fold(Aabb::EMPTY, |union, b| union.union(b));
    let axis = (all.max - all.min).max_position();
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&i, &j| boxes[i].min[axis].total_cmp(&boxes[j].min[axis]));
    let mut active: Vec<usize> = Vec::new();
    for &i in &order {
        active.retain(|&j| boxes[j].max[axis] >= boxes[i].min[axis]);
        if let Some(&j) = active.iter().find(|&&j| boxes[i].overlaps(&boxes[j]) && meet(i, j)) {
            return Some((i.min(j), i.max(j)));
        }
        active.push(i);
    }
    None
}

/// Whether one triangle lies strictly on one side of the other's plane: then they do not meet. Said
/// first because it is true of nearly all neighbours and cheap.
fn one_sided(s: &Triangle, t: &Triangle) -> bool {
    let strictly = |[a, b, c]: &Triangle, t: &Triangle| {
        let signs = t.map(|p| orient3d(*a, *b, *c, p));
        signs[0] != Sign::Zero && signs[0] == signs[1] && signs[1] == signs[2]
    };
    strictly(s, t) || strictly(t, s)
}

/// Whether two faces of a mesh meet in more than their shared vertices and edges.
fn improper(f: [u32; 3], g: [u32; 3], vertices: &[DVec3]) -> bool {
    let at = |i: u32| vertices[i as usize];
    let (s, t) = (f.map(at), g.map(at));
    let (own_f, own_g): (Vec<_>, Vec<_>) = (
        f.iter().filter(|i| !g.contains(i)).map(|&i| at(i)).collect(),
        g.iter().filter(|i| !f.contains(i)).map(|&i| at(i)).collect(),
    );
    match own_f.len() {
        3 => !one_sided(&s, &t) && classify_triangles(&s, &t) != Meeting::None,
        // Both are convex and hold the shared corner; a ray from there through another shared point
        // leaves one of the two first, through the side opposite the corner.
        2 => {
            classify_segment_triangle(&[own_f[0], own_f[1]], &t) != Meeting::None
                || classify_segment_triangle(&[own_g[0], own_g[1]], &s) != Meeting::None
        }
        // Two triangles on one edge overlap only where one is folded onto the other.
        1 => {
            let shared: Vec<_> = f.iter().filter(|i| g.contains(i)).map(|&i| at(i)).collect();
            folded(shared[0], shared[1], own_f[0], own_g[0])
        }
        _ => true,
    }
}

/// Whether `p` and `q` lie in one plane with the edge, on the same side of it.
fn folded(a: DVec3, b: DVec3, p: DVec3, q: DVec3) -> bool {
    let drops: [fn(DVec3) -> DVec2; 3] =
        [|p| DVec2::new(p.x, p.y), |p| DVec2::new(p.y, p.z), |p| DVec2::new(p.z, p.x)];
    orient3d(a, b, p, q) == Sign::Zero
        && drops.iter().any(|drop| {
            let side = orient2d(drop(a), drop(b), drop(p));
            side != Sign::Zero && side == orient2d(drop(a), drop(b), drop(q))
        })
}
