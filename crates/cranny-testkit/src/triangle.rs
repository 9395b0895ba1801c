//! Triangle against triangle and against segment, by constructing what they share.

use std::cmp::Ordering;

use cranny_exact::{DVec3, Meeting, Piercing, SegmentFeature, TriangleFeature};

use crate::convex::{Polygon, Region};
use crate::rational::{Q, Q3};

/// How two closed triangles meet, in exact rationals.
#[must_use]
pub fn rational_meeting(a: &[DVec3; 3], b: &[DVec3; 3]) -> Meeting {
    rational_contact(a, b).0
}

/// How two closed triangles meet, and the points that they share: the corners in order of a convex
/// polygon (co-planar triangles), the ends of a segment, one point, or nothing.
///
/// # Panics
///
/// Where a coordinate is not finite.
#[must_use]
pub fn rational_contact(a: &[DVec3; 3], b: &[DVec3; 3]) -> (Meeting, Vec<Q3>) {
    contact(&Region::of(&a.map(Q3::exactly)), &Region::of(&b.map(Q3::exactly)))
}

/// Clips A by the half-spaces whose intersection is B. What is left is convex. Where some point
/// lies inside both triangles, the inside of what is left lies inside both, so its centroid
/// decides.
pub(crate) fn contact(a: &Region, b: &Region) -> (Meeting, Polygon) {
    let shared = b.clip(&a.corners);
    if shared.is_empty() {
        return (Meeting::None, shared);
    }
    let centroid = Q3::mean(&shared.iter().map(|p| (Q::ONE, p)).collect::<Vec<_>>());
    let planes_cross = !a.normal.cross(&b.normal).is_zero();
    if planes_cross && a.contains_inside(&centroid) && b.contains_inside(&centroid) {
        (Meeting::Cross, shared)
    } else {
        (Meeting::Touch, shared)
    }
}

/// What [`locate_piercing`](cranny_exact::locate_piercing) must answer, from the constructed point.
///
/// # Panics
///
/// Where a coordinate is not finite.
#[must_use]
pub fn rational_piercing(segment: &[DVec3; 2], triangle: &[DVec3; 3]) -> Piercing {
    piercing(&segment.map(Q3::exactly), &triangle.map(Q3::exactly)).0
}

/// The features that meet, and on which side of the triangle the segment ends relative to where it
/// starts: `Greater` where it runs along the normal.
pub(crate) fn piercing([p, q]: &[Q3; 2], corners: &[Q3; 3]) -> (Piercing, Ordering) {
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a));
    let (start, end) = (normal.dot(&(p - a)), normal.dot(&(q - a)));
    let direction = end.cmp(&start);
    if start.is_zero() && end.is_zero() {
        return (Piercing::Coplanar, direction);
    }
    if direction == Ordering::Equal {
        return (Piercing::Miss, direction);
    }
    let t = &start / &(&start - &end);
    if t < Q::ZERO || t > Q::ONE {
        return (Piercing::Miss, direction);
    }
    let on_segment = if t.is_zero() {
        SegmentFeature::Start
    } else if t.is_one() {
        SegmentFeature::End
    } else {
        SegmentFeature::Interior
    };
    let point = p.towards(q, &t);
    // Barycentric coordinates times a positive factor: entry i belongs to corner i.
    let opposite = |u: &Q3, v: &Q3| normal.dot(&(u - &point).cross(&(v - &point)));
    let coordinates = [opposite(b, c), opposite(c, a), opposite(a, b)];
    if coordinates.iter().any(|x| x < &Q::ZERO) {
        return (Piercing::Miss, direction);
    }
    let on_triangle = match coordinates.map(|x| x.is_zero()) {
        [false, false, false] => TriangleFeature::Interior,
        [false, true, true] => TriangleFeature::Vertex(0),
        [true, false, true] => TriangleFeature::Vertex(1),
        [true, true, _] => TriangleFeature::Vertex(2),
        [_, _, true] => TriangleFeature::Edge(0),
        [true, _, _] => TriangleFeature::Edge(1),
        [_, true, _] => TriangleFeature::Edge(2),
    };
    (Piercing::Point { on_segment, on_triangle }, direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shared_polygon_of_two_coplanar_triangles_is_constructed() {
        let a = [DVec3::ZERO, 4.0 * DVec3::X, 4.0 * DVec3::Y];
        let b = a.map(|p| DVec3::new(3.0, 3.0, 0.0) - p);
        let (meeting, shared) = rational_contact(&a, &b);
        assert_eq!(meeting, Meeting::Touch);
        assert_eq!(shared.len(), 6);
    }

    #[test]
    fn the_shared_segment_of_two_crossing_triangles_is_constructed() {
        let a = [DVec3::ZERO, 4.0 * DVec3::X, 4.0 * DVec3::Y];
        let b = [DVec3::new(1.0, 1.0, -1.0), DVec3::new(1.0, 1.0, 3.0), DVec3::new(9.0, 1.0, 1.0)];
        let (meeting, shared) = rational_contact(&a, &b);
        assert_eq!(meeting, Meeting::Cross);
        let ends = [DVec3::new(1.0, 1.0, 0.0), DVec3::new(3.0, 1.0, 0.0)].map(Q3::exactly);
        assert!(shared.len() == 2 && ends.iter().all(|p| shared.contains(p)));
    }

    #[test]
    fn needles_and_points_are_regions_too() {
        let floor = [DVec3::ZERO, 4.0 * DVec3::X, 4.0 * DVec3::Y];
        let needle = [-DVec3::Z, DVec3::Z, DVec3::ZERO].map(|p| p + DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(rational_meeting(&floor, &needle), Meeting::Touch);
        assert_eq!(rational_meeting(&needle, &floor), Meeting::Touch);
        assert_eq!(rational_meeting(&needle, &floor.map(|p| p + DVec3::X)), Meeting::Touch);
        assert_eq!(rational_meeting(&needle, &floor.map(|p| p + 2.0 * DVec3::X)), Meeting::None);
        assert_eq!(rational_meeting(&[DVec3::ONE; 3], &[DVec3::ONE; 3]), Meeting::Touch);
        assert_eq!(rational_meeting(&[DVec3::ONE; 3], &needle), Meeting::Touch);
        assert_eq!(rational_meeting(&[DVec3::X; 3], &needle), Meeting::None);
    }
}
