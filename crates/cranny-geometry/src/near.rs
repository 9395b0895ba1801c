//! Near a vertex, near an edge: what lies within the weld distance, found over the face tree.
//!
//! Distances that a repair relies on are rounded upward, so that 'within' is certain. At distance 0
//! 'on the edge' is decided by signs.
//!
//! Source: none. Cost: the nodes of the tree that lie near, O(log n) as a rule where few faces do.

use cranny_exact::{Aabb, DVec3};

use crate::each_once::each_once;
use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::projection::collinear;
use crate::tree::FaceTree;

/// Relative to the coordinates that enter, what the roundings of a distance add up to: a handful of
/// operations of 2^-53 each; 16 epsilons leave room.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// An upper bound of the distance of two points, exactly 0 for equal ones.
pub(crate) fn distance(p: DVec3, q: DVec3) -> f64 {
    // Differences are rounded relative to themselves: no other term is needed.
    (q - p).length() * (1.0 + ROUNDINGS)
}

/// Where a point is with respect to a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Foot {
    /// An upper bound of the distance, exactly 0 where the point lies on the segment.
    pub(crate) distance: f64,
    /// The nearest point is `start + parameter * (end - start)`; from 0 to 1.
    pub(crate) parameter: f64,
}

/// The nearest point of the segment `[a, b]`. Ends that coincide are a point. A vertex that was
/// rounded once off its edge is reported as near as that: what would be lost in differences is kept
/// beside them (`two_sum` of Knuth 1969, The Art of Computer Programming 2, 4.2.2), and of
/// `to − parameter * along`, which all but cancels, only the result is rounded.
pub(crate) fn foot(p: DVec3, [a, b]: [DVec3; 2]) -> Foot {
    let ([to, to_rest], [along, along_rest]) = (difference(p, a), difference(b, a));
    let length_squared = along.length_squared();
    let on_segment = |t: f64| if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
    let left = |t: f64| DVec3::splat(-t).mul_add(along, to);
    let first = on_segment(to.dot(along) / length_squared);
    // As exact as a parameter can be: the quotient's own roundings would show.
    let parameter = on_segment(first + left(first).dot(along) / length_squared);
    if collinear(a, b, p) && Aabb::of_points([a, b]).contains_point(p) {
        return Foot { distance: 0.0, parameter };
    }
    // Any point of the segment gives an upper bound, whatever the parameter's rounding.
    let left = left(parameter);
    let distance = (left + (to_rest - parameter * along_rest)).length() * (1.0 + ROUNDINGS);
    let entered = left.abs() + to_rest.abs() + along_rest.abs();
    Foot { distance: distance + ROUNDINGS * entered.length(), parameter }
}

/// `p − q`, rounded, and what rounding took away, exactly.
fn difference(p: DVec3, q: DVec3) -> [DVec3; 2] {
    let rounded = p - q;
    let taken = p - rounded;
    [rounded, (p - (rounded + taken)) + (taken - q)]
}

/// The corners of faces near the box, each once, ascending.
pub(crate) fn corners_near(mesh: &Mesh, tree: &FaceTree, near: &Aabb) -> Vec<VertexId> {
    each_once(tree.vertices_within(mesh, near).0)
}

/// The vertices that `wanted` names, of faces whose boxes come within `margin` of the segment; each
/// once, ascending.
pub(crate) fn corners_along(
    mesh: &Mesh,
    tree: &FaceTree,
    [a, b]: [DVec3; 2],
    margin: f64,
    wanted: impl Fn(VertexId) -> bool,
) -> Vec<VertexId> {
    let around = Aabb::of_points([a, b]).grown(margin);
    let mut found = Vec::new();
    tree.visit(
        |bounds| bounds.overlaps(&around) && bounds.grown(margin).entered_at(a, b).is_some(),
        |face| {
            let near = |v: &VertexId| wanted(*v) && around.contains_point(mesh.position(*v));
            found.extend(mesh.corners(face).into_iter().filter(near));
        },
    );
    each_once(found)
}

#[cfg(test)]
mod tests {
    use cranny_testkit::Rng;

    use super::*;

    #[test]
    fn a_point_on_the_segment_is_at_no_distance() {
        let third = DVec3::new(1.0, 2.0, 4.0);
        assert_eq!(foot(third, [DVec3::ZERO, 3.0 * third]).distance, 0.0);
        let above = foot(DVec3::new(1.0, 0.5, 0.0), [DVec3::ZERO, 4.0 * DVec3::X]);
        assert_eq!(above.parameter, 0.25);
        assert!(above.distance >= 0.5 && above.distance < 0.5 + 1e-13);
    }

    #[test]
    fn what_was_rounded_once_is_as_near_as_that() {
        let mut rng = Rng::new(5);
        for _ in 0..2000 {
            let [a, b] = [rng.rotation() * DVec3::X, rng.rotation() * DVec3::X];
            let p = a + 0.5 * (1.0 + rng.unit()) * (b - a);
            assert!(foot(p, [a, b]).distance < 2.0 * f64::EPSILON, "{p}, {a}, {b}");
        }
    }

    #[test]
    fn what_lies_off_by_the_last_digits_is_told_to_be() {
        let (middle, beside) = (DVec3::new(1.5, 2.0, 0.0), DVec3::new(-4.0, 3.0, 0.0));
        for digits in [40, 45, 50] {
            let off = 2f64.powi(-digits);
            let found = foot(middle + off * beside, [DVec3::ZERO, 2.0 * middle]).distance;
            assert!(found >= 5.0 * off && found < 5.05 * off, "{found:e} for {:e}", 5.0 * off);
        }
        // An end beside the line by less than differences keep: half as far in the middle.
        let off = 2f64.powi(-60);
        for (p, ends) in [
            (middle, [off * beside, 2.0 * middle]),
            (-middle, [2.0 * -middle, off * beside]),
            (off * beside, [-middle, middle]),
        ] {
            let least = if p.length() < 1.0 { 5.0 * off } else { 2.5 * off };
            let found = foot(p, ends).distance;
            assert!(found >= 0.999 * least && found < 1e-15, "{found:e} for {least:e}");
        }
        // Rounded products would cancel to nothing. The distance is of exact rationals.
        let p =
            DVec3::new(0.431_275_538_485_871_13, -0.563_940_512_014_218_9, 0.507_171_580_162_077_1);
        let ends =
            [DVec3::new(0.921875, 0.921875, -0.65625), DVec3::new(0.375, -0.734375, 0.640625)];
        assert!(foot(p, ends).distance >= 2.443_416_316_622_518e-17);
    }

    #[test]
    fn beyond_the_ends_the_end_is_nearest() {
        let before = foot(-DVec3::X, [DVec3::ZERO, DVec3::X]);
        assert!(before.parameter == 0.0 && before.distance >= 1.0);
        let point = foot(DVec3::Y, [DVec3::ZERO; 2]);
        assert!(point.parameter == 0.0 && point.distance >= 1.0 && point.distance < 1.1);
    }

    #[test]
    fn slabs_keep_what_touches() {
        let bounds = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let segment_may_meet =
            |[a, b]: [DVec3; 2], bounds: &Aabb| bounds.entered_at(a, b).is_some();
        assert!(segment_may_meet([-DVec3::X, 2.0 * DVec3::X], &bounds)); // along an edge
        assert!(segment_may_meet([-DVec3::ONE, DVec3::ZERO], &bounds)); // ends at a corner
        assert!(!segment_may_meet([-DVec3::X, DVec3::new(-0.5, 1.0, 1.0)], &bounds));
        assert!(!segment_may_meet([DVec3::new(2.5, 0.0, 0.5), DVec3::new(0.0, 2.5, 0.5)], &bounds));
        assert!(segment_may_meet([DVec3::splat(0.5); 2], &bounds)); // a point
    }
}
