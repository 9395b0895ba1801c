//! Faces of one mesh that meet where they should not: self-intersection, overlap in a plane, touch.
//!
//! The face tree is paired with itself; what the boxes leave is judged by signs. Faces that share a
//! vertex or an edge meet there by right, and are asked whether they meet *elsewhere*: two triangles
//! with a common corner do so exactly if the side opposite to it, of one or the other, meets the other
//! triangle (what they share is convex, so it reaches an opposite side if it is more than the corner);
//! two with a common side do so exactly if they lie in one plane, on the same side of it.

use cranny_exact::{
    Aabb, DVec2, DVec3, Meeting, Sign, classify_segment_triangle, classify_triangles, orient2d,
    orient3d,
};

use super::stars::Star;
use crate::ids::FaceId;
use crate::mesh::Mesh;
use crate::report::{Finding, FindingKind, MeetingScan};
use crate::tree::{Content, FaceTree};

/// Pairs judged for each face before the search gives up, and for the mesh at large. Sound meshes need
/// about ten a face, but k faces around one vertex need k²/2. Smaller, and the search ends at a fan of a
/// few thousand; larger, and a mesh whose faces all meet each other takes more than seconds.
const TESTS_A_FACE: usize = 64;
const TESTS_AT_LEAST: usize = 1 << 23;

/// Judges all pairs of faces but those that `left_out` names (faces without area, all but one of
/// those in one place). A mere touch that `explained` knows the reason of is not reported. Faces around a
/// vertex whose star is spread out need no judgement: most pairs whose boxes overlap.
pub(super) fn meetings(
    mesh: &Mesh,
    tree: &FaceTree,
    stars: &[Star],
    left_out: &[bool],
    explained: impl Fn(FaceId, FaceId) -> bool,
) -> (Vec<Finding>, MeetingScan) {
    let limit = TESTS_AT_LEAST + TESTS_A_FACE * mesh.faces().len();
    let (mut found, mut tests) = (Vec::new(), 0);
    let mut stack = vec![(0u32, 0u32)];
    while let Some((i, j)) = stack.pop() {
        if tests > limit {
            return (findings(mesh, found), MeetingScan::Stopped { tests });
        }
        let mut push = |i: u32, j: u32| {
            if tree.node(i).bounds.overlaps(&tree.node(j).bounds) {
                stack.push((i, j));
            }
        };
        match (tree.content(i), tree.content(j)) {
            (Content::Inner { left, right }, _) if i == j => {
                push(left, left);
                push(right, right);
                push(left, right);
            }
            // The larger box is opened; a leaf cannot be.
            (Content::Inner { left, right }, other)
                if matches!(other, Content::Leaf { .. }) || is_larger(tree, i, j) =>
            {
                push(left, j);
                push(right, j);
            }
            (_, Content::Inner { left, right }) => {
                push(i, left);
                push(i, right);
            }
            _ => {
                for (n, &f) in tree.leaf_faces(i).iter().enumerate() {
                    let rest = if i == j { n + 1 } else { 0 };
                    for &g in &tree.leaf_faces(j)[rest..] {
                        tests += 1;
                        if left_out[f.index()] || left_out[g.index()] {
                            continue;
                        }
                        let pair = [f.min(g), f.max(g)];
                        if let Some(kind) = judge(mesh, stars, pair)
                            && !(kind == FindingKind::SelfTouch && explained(f, g))
                        {
                            found.push((kind, pair));
                        }
                    }
                }
            }
        }
    }
    (findings(mesh, found), MeetingScan::Complete)
}

fn is_larger(tree: &FaceTree, i: u32, j: u32) -> bool {
    let size = |n: u32| {
        let b = tree.node(n).bounds;
        (b.max - b.min).element_sum()
    };
    size(i) >= size(j)
}

fn findings(mesh: &Mesh, mut found: Vec<(FindingKind, [FaceId; 2])>) -> Vec<Finding> {
    found.sort_unstable();
    let finding = |(kind, pair): (FindingKind, [FaceId; 2])| {
        let [a, b] = pair.map(|f| Aabb::of_points(mesh.triangle(f)));
        let common = Aabb { min: a.min.max(b.min), max: a.max.min(b.max) };
        let ids = pair.map(|f| f.0).to_vec();
        Finding { kind, ids, at: common.center(), measure: common.diagonal(), count: 1 }
    };
    found.into_iter().map(finding).collect()
}

/// How two faces with area meet, apart from what they share by right.
fn judge(mesh: &Mesh, stars: &[Star], [f, g]: [FaceId; 2]) -> Option<FindingKind> {
    let corners = mesh.corners(f);
    let shared = shared_corners(corners, mesh.corners(g));
    if let SharedCorners::One(i, _) | SharedCorners::More { shared: i, .. } = shared
        && stars[corners[i].index()] == Star::Spread
    {
        return None;
    }
    let (a, b) = (mesh.triangle(f), mesh.triangle(g));
    match shared {
        SharedCorners::None => {
            let meeting = classify_triangles(&a, &b);
            meeting.meets().then(|| kind_of(meeting, &a, &b))
        }
        SharedCorners::One(i, j) => {
            let (a, b) = (rotated(&a, i), rotated(&b, j));
            if seen_apart(&a, &b) || apart_but_for_corner(&a, &b) {
                return None;
            }
            let (a_side, b_side) = ([a[1], a[2]], [b[1], b[2]]);
            let meet = classify_segment_triangle(&a_side, &b).meets()
                || classify_segment_triangle(&b_side, &a).meets();
            meet.then(|| kind_of(classify_triangles(&a, &b), &a, &b))
        }
        SharedCorners::More { apex, .. } => {
            if seen_beside(&a, &b, apex) {
                return None;
            }
            let folded = orient3d(a[0], a[1], a[2], b[apex]).is_zero() && overlap_in_plane(&a, &b);
            folded.then_some(FindingKind::CoplanarOverlap)
        }
    }
}

/// The corners that two faces share: none, one (its place in each), or two and more (the place of one of
/// them in the first, and of a corner of the second that is not shared, if any).
enum SharedCorners {
    None,
    One(usize, usize),
    More { shared: usize, apex: usize },
}

fn shared_corners(
    corners: [crate::ids::VertexId; 3],
    others: [crate::ids::VertexId; 3],
) -> SharedCorners {
    let mut place = None;
    let mut apex = 0;
    let mut count = 0;
    for (j, other) in others.iter().enumerate() {
        match corners.iter().position(|corner| corner == other) {
            Some(i) => {
                place = Some((i, j));
                count += 1;
            }
            None => apex = j,
        }
    }
    match (count, place) {
        (_, None) => SharedCorners::None,
        (1, Some((i, j))) => SharedCorners::One(i, j),
        (_, Some((shared, _))) => SharedCorners::More { shared, apex },
    }
}

fn rotated<T: Copy>(t: &[T; 3], first: usize) -> [T; 3] {
    [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
}

/// Whether two triangles that share their first corner are plainly apart elsewhere: one lies strictly
/// on one side of the other's plane or, in one plane, strictly on the outer side of a line through the
/// corner and a side of the other. Decides nearly all pairs around a vertex, at a few signs each.
fn apart_but_for_corner(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let about = |[p, q, r]: [DVec3; 3], t: &[DVec3; 3]| [t[1], t[2]].map(|v| orient3d(p, q, r, v));
    let one_side = |[s, t]: [Sign; 2]| s == t && !s.is_zero();
    let both = [a, b];
    // Faces along a coordinate plane are frequent, and the predicate takes longest for zeros.
    let axis = (0..3).find(|&axis| both.iter().all(|t| t.iter().all(|p| p[axis] == a[0][axis])));
    if axis.is_none() {
        let sides = about(*a, b);
        if one_side(sides) {
            return true;
        }
        if sides != [Sign::Zero; 2] {
            return one_side(about(*b, a));
        }
    }
    let mut axes = axis.map_or(0..3, |axis| axis..axis + 1);
    axes.any(|axis| {
        let [a, b] = both.map(|t| t.map(|p| without(p, axis)));
        wedge_parted(&a, &b) || wedge_parted(&b, &a)
    })
}

/// Whether two triangles that share their first corner are plainly apart elsewhere, seen along the axis
/// nearest the normal of one: what appears apart is apart. Decides most pairs on a smooth surface, and
/// signs in a plane are quicker than those in space, by far where faces are coplanar.
fn seen_apart(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let axis = dominant_axis(a);
    let [a, b] = [a, b].map(|t| t.map(|p| without(p, axis)));
    wedge_parted(&a, &b) || wedge_parted(&b, &a)
}

/// Whether two triangles that share a side lie on either side of it, seen along the axis nearest the
/// normal of the first: then they share nothing else. `apex` is the corner of the second across from it.
fn seen_beside(a: &[DVec3; 3], b: &[DVec3; 3], apex: usize) -> bool {
    let Some(own) = a.iter().position(|p| !b.contains(p)) else { return false };
    let axis = dominant_axis(a);
    let [p, q, own, other] =
        [a[(own + 1) % 3], a[(own + 2) % 3], a[own], b[apex]].map(|p| without(p, axis));
    let side = orient2d(p, q, own);
    !side.is_zero() && orient2d(p, q, other) == side.flipped()
}

/// The axis nearest a triangle's normal.
fn dominant_axis([a, b, c]: &[DVec3; 3]) -> usize {
    (*b - *a).cross(*c - *a).abs().max_position()
}

/// Whether the second triangle lies strictly beyond a side of the first that ends at its first corner.
fn wedge_parted(a: &[DVec2; 3], b: &[DVec2; 3]) -> bool {
    let turn = orient2d(a[0], a[1], a[2]);
    let beyond = |p, q| (1..3).all(|i| orient2d(p, q, b[i]) == turn.flipped());
    !turn.is_zero() && (beyond(a[0], a[1]) || beyond(a[2], a[0]))
}

pub(super) fn without(p: DVec3, axis: usize) -> DVec2 {
    DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3])
}

/// What to call it when two faces meet elsewhere than they may.
fn kind_of(meeting: Meeting, a: &[DVec3; 3], b: &[DVec3; 3]) -> FindingKind {
    let [p, q, r] = *a;
    match meeting {
        Meeting::Cross => FindingKind::SelfIntersection,
        _ if b.iter().all(|&v| orient3d(p, q, r, v).is_zero()) && overlap_in_plane(a, b) => {
            FindingKind::CoplanarOverlap
        }
        _ => FindingKind::SelfTouch,
    }
}

/// Whether two triangles with area in one plane share area: no line through a side of either has the
/// other on its outer side (rims included). Exact.
pub(super) fn overlap_in_plane(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    for axis in 0..3 {
        let [a, b] = [a, b].map(|t| t.map(|p| without(p, axis)));
        let turn = orient2d(a[0], a[1], a[2]);
        if !turn.is_zero() {
            return !parted(&a, &b, turn) && !parted(&b, &a, orient2d(b[0], b[1], b[2]));
        }
    }
    false
}

fn parted(a: &[DVec2; 3], b: &[DVec2; 3], turn: Sign) -> bool {
    (0..3).any(|i| b.iter().all(|&p| orient2d(a[i], a[(i + 1) % 3], p) != turn))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(vertices: &[[f64; 3]], faces: [[u32; 3]; 2]) -> Option<FindingKind> {
        let vertices: Vec<DVec3> = vertices.iter().map(|&p| DVec3::from_array(p)).collect();
        let judged = |faces: [[u32; 3]; 2]| {
            let mesh = Mesh::new(vertices.clone(), faces.to_vec()).unwrap();
            judge(&mesh, &[Star::Torn; 9], [FaceId(0), FaceId(1)])
        };
        let [[a, b, c], [p, q, r]] = faces;
        let kind = judged(faces);
        assert_eq!(kind, judged([faces[1], faces[0]]));
        assert_eq!(kind, judged([[b, c, a], [r, q, p]]));
        kind
    }

    const FLOOR: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    fn with_floor(more: &[[f64; 3]], face: [u32; 3]) -> Option<FindingKind> {
        judged(&[&FLOOR, more].concat(), [[0, 1, 2], face])
    }

    #[test]
    fn neighbours_over_a_corner_meet_there_by_right() {
        let rising = [[-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]];
        assert_eq!(with_floor(&rising, [0, 3, 4]), None);
        // In the floor's plane, beside it.
        assert_eq!(with_floor(&[[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]], [0, 3, 4]), None);
        // One side goes down, one up, the floor lies between them.
        let through = [[2.0, 2.0, 1.0], [2.0, 2.0, -1.0]];
        assert_eq!(with_floor(&through, [0, 3, 4]), Some(FindingKind::SelfIntersection));
        // The far side only rests on the floor.
        let resting = [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        assert_eq!(with_floor(&resting, [0, 3, 4]), Some(FindingKind::SelfTouch));
        let flat = [[1.0, 1.0, 0.0], [1.0, 2.0, 0.0]];
        assert_eq!(with_floor(&flat, [0, 3, 4]), Some(FindingKind::CoplanarOverlap));
        // Along the floor's side, outside: a line in common, no area.
        let along = [[2.0, 0.0, 0.0], [2.0, -1.0, 0.0]];
        assert_eq!(with_floor(&along, [0, 3, 4]), Some(FindingKind::SelfTouch));
    }

    #[test]
    fn neighbours_over_a_side_overlap_only_when_folded() {
        assert_eq!(with_floor(&[[1.0, 1.0, 3.0]], [1, 0, 3]), None);
        assert_eq!(with_floor(&[[1.0, -1.0, 0.0]], [1, 0, 3]), None);
        assert_eq!(with_floor(&[[1.0, 9.0, 0.0]], [1, 0, 3]), Some(FindingKind::CoplanarOverlap));
        assert_eq!(with_floor(&[[1.0, 9.0, 1.0]], [1, 0, 3]), None);
    }

    #[test]
    fn strangers_cross_touch_or_overlap() {
        let blade = [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]];
        assert_eq!(with_floor(&blade, [3, 4, 5]), Some(FindingKind::SelfIntersection));
        let tip = [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]];
        assert_eq!(with_floor(&tip, [3, 4, 5]), Some(FindingKind::SelfTouch));
        let inlay = [[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]];
        assert_eq!(with_floor(&inlay, [3, 4, 5]), Some(FindingKind::CoplanarOverlap));
        let side_by_side = [[2.0, 2.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0]];
        assert_eq!(with_floor(&side_by_side, [3, 4, 5]), Some(FindingKind::SelfTouch));
        let far = [[9.0, 1.0, -1.0], [9.0, 1.0, 1.0], [9.0, 2.0, 1.0]];
        assert_eq!(with_floor(&far, [3, 4, 5]), None);
    }

    #[test]
    fn every_pair_is_judged_once_at_any_leaf_size() {
        // A stack of parallel blades through one floor.
        let mut vertices: Vec<DVec3> = FLOOR.iter().map(|&p| DVec3::from_array(p)).collect();
        let mut faces = vec![[0, 1, 2]];
        for i in 0..20 {
            let x = 0.1 + 0.1 * f64::from(i);
            let n = vertices.len() as u32;
            vertices.extend([
                DVec3::new(x, 0.5, -1.0),
                DVec3::new(x, 1.5, -1.0),
                DVec3::new(x, 1.0, 1.0),
            ]);
            faces.push([n, n + 1, n + 2]);
        }
        let mesh = Mesh::new(vertices, faces).unwrap();
        let stars = [Star::Torn; 63];
        for leaf_size in [1, 3, 100] {
            let tree = FaceTree::of(&mesh, leaf_size);
            let (found, scan) = meetings(&mesh, &tree, &stars, &[false; 21], |_, _| false);
            let pairs: Vec<_> = found.iter().map(|f| f.ids.clone()).collect();
            assert_eq!(pairs, (1..21).map(|i| vec![0, i]).collect::<Vec<_>>());
            assert_eq!(scan, MeetingScan::Complete);
        }
    }
}
