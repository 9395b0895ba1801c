//! Two faces of one mesh: do they meet where they should not?
//!
//! Faces that share a vertex or an edge meet there by right, and are tested for whether they meet
//! *elsewhere*: two triangles with a common corner do so exactly if the side opposite to it, of one
//! or the other, meets the other triangle (what they share is convex, so it reaches an opposite
//! side if it is more than the corner); two with a common side do so exactly if they lie in one
//! plane, on the same side of it. Decided by signs.
//!
//! Sources: triangles against triangles and segments are judged in `cranny-exact`, which cites its
//! own; which tests faces with a common corner or side get is argued above, and is this crate's
//! own. Cost: O(1) a pair; a few comparisons where a coordinate or a view along an axis parts the
//! two, else some signs, which are filtered.

use cranny_exact::{
    DVec2, DVec3, Meeting, Sign, classify_segment_triangle, classify_triangles, orient2d, orient3d,
};

use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::projection::seen_along;
use crate::report::FindingKind;

/// How two faces with area meet, apart from what they share by right. Not called for faces that
/// share a vertex at which `settled` knows that all faces were judged.
pub(super) fn judge(
    mesh: &Mesh,
    [f, g]: [FaceId; 2],
    settled: impl FnOnce(VertexId) -> bool,
) -> Option<FindingKind> {
    let corners = mesh.corners(f);
    let shared = shared_corners(corners, mesh.corners(g));
    if let SharedCorners::One(i, _) | SharedCorners::More { shared: i, .. } = shared
        && settled(corners[i])
    {
        return None;
    }
    let (a, b) = (mesh.triangle(f), mesh.triangle(g));
    match shared {
        SharedCorners::None => {
            if parted_across(&a, &b) || seen_parted(&a, &b) {
                return None;
            }
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

/// The corners that two faces share: none, one (its place in each), or two and more (the place of
/// one of them in the first, and of a corner of the second that is not shared, if any).
enum SharedCorners {
    None,
    One(usize, usize),
    More { shared: usize, apex: usize },
}

fn shared_corners(corners: [VertexId; 3], others: [VertexId; 3]) -> SharedCorners {
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

/// Whether two triangles that share their first corner are plainly apart elsewhere: one lies
/// strictly on one side of the other's plane or, in one plane, strictly on the outer side of a line
/// through the corner and a side of the other. Decides nearly all pairs around a vertex, at a few
/// signs each.
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
        let [a, b] = both.map(|t| t.map(|p| seen_along(axis, p)));
        wedge_parted(&a, &b) || wedge_parted(&b, &a)
    })
}

/// Whether two triangles that share their first corner are plainly apart elsewhere, seen along the
/// axis nearest the normal of one: what appears apart is apart. Decides most pairs on a smooth
/// surface, and signs in a plane are quicker than those in space, by far where faces are coplanar.
fn seen_apart(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let axis = dominant_axis(a);
    let [a, b] = [a, b].map(|t| t.map(|p| seen_along(axis, p)));
    wedge_parted(&a, &b) || wedge_parted(&b, &a)
}

/// Whether a line through a side of one of two triangles certainly parts them, seen along the axis
/// nearest the normal of the first.
fn seen_parted(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let axis = dominant_axis(a);
    let [a, b] = [a, b].map(|t| t.map(|p| seen_along(axis, p)));
    let beyond = |a: &[DVec2; 3], b: &[DVec2; 3]| {
        let turn = orient2d(a[0], a[1], a[2]);
        let outside =
            |i: usize| b.iter().all(|&p| orient2d(a[i], a[(i + 1) % 3], p) == turn.flipped());
        !turn.is_zero() && (0..3).any(outside)
    };
    beyond(&a, &b) || beyond(&b, &a)
}

/// Whether two triangles lie plainly apart along the direction across the longest sides of both,
/// with more room than projecting can round: as needles that pass each other do, whose boxes all
/// overlap and whose planes part nothing.
fn parted_across(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let across = longest_side(a).cross(longest_side(b));
    let span = |t: &[DVec3; 3]| {
        let [x, y, z] = t.map(|p| across.dot(p));
        [x.min(y).min(z), x.max(y).max(z)]
    };
    let ([low, high], [from, to]) = (span(a), span(b));
    let reach = a.iter().chain(b).fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
    // Three products and two sums on either side.
    let rounding = 8.0 * f64::EPSILON * across.abs().element_sum() * reach + f64::MIN_POSITIVE;
    from - high > rounding || low - to > rounding
}

fn longest_side(&[a, b, c]: &[DVec3; 3]) -> DVec3 {
    let sides = [b - a, c - b, a - c];
    sides[DVec3::from_array(sides.map(DVec3::length_squared)).max_position()]
}

/// Whether two triangles that share a side lie on either side of it, seen along the axis nearest
/// the normal of the first: then they share nothing else. `apex` is the corner of the second across
/// from it.
fn seen_beside(a: &[DVec3; 3], b: &[DVec3; 3], apex: usize) -> bool {
    let Some(own) = a.iter().position(|p| !b.contains(p)) else { return false };
    let axis = dominant_axis(a);
    let [p, q, own, other] =
        [a[(own + 1) % 3], a[(own + 2) % 3], a[own], b[apex]].map(|p| seen_along(axis, p));
    let side = orient2d(p, q, own);
    !side.is_zero() && orient2d(p, q, other) == side.flipped()
}

/// The axis nearest a triangle's normal.
fn dominant_axis([a, b, c]: &[DVec3; 3]) -> usize {
    (*b - *a).cross(*c - *a).abs().max_position()
}

/// Whether the second triangle lies strictly beyond a side of the first that ends at its first
/// corner.
fn wedge_parted(a: &[DVec2; 3], b: &[DVec2; 3]) -> bool {
    let turn = orient2d(a[0], a[1], a[2]);
    let beyond = |p, q| (1..3).all(|i| orient2d(p, q, b[i]) == turn.flipped());
    !turn.is_zero() && (beyond(a[0], a[1]) || beyond(a[2], a[0]))
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

/// Whether two triangles with area in one plane share area: no line through a side of either has
/// the other on its outer side (rims included). Exact.
pub(super) fn overlap_in_plane(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    for axis in 0..3 {
        let [a, b] = [a, b].map(|t| t.map(|p| seen_along(axis, p)));
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
            judge(&mesh, [FaceId(0), FaceId(1)], |_| false)
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
    fn what_is_parted_across_meets_nowhere() {
        // Needles of a lattice, in all directions: many touch, and many miss each other by little.
        let mut state = 1u64;
        let mut whole = |reach: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((state >> 33) % (2 * reach + 1)) as f64 - reach as f64
        };
        let (mut parted, mut met) = (0, 0);
        for _ in 0..20_000 {
            let mut needle = || {
                let mut point = |reach| DVec3::new(whole(reach), whole(reach), whole(reach));
                let (foot, along, aside) = (point(2), point(4), 0.125 * point(1));
                [foot - along, foot + along, foot + along + aside]
            };
            let (a, b) = (needle(), needle());
            let meets = classify_triangles(&a, &b).meets();
            assert!(!(meets && parted_across(&a, &b)), "{a:?} {b:?}");
            parted += usize::from(parted_across(&a, &b));
            met += usize::from(meets);
        }
        assert!(parted > 10_000 && met > 100, "{parted} {met}");
    }
}
