//! Where a segment meets a triangle, named by features instead of by coordinates.

use glam::DVec3;

use super::Meeting;
use super::planar::{collinear, coplanar_triangles_meet, segments_meet, span};
use crate::sign::{Sign, orient3d};

/// A part of a closed segment `[start, end]`. The three parts are disjoint and cover it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SegmentFeature {
    /// The first end, `segment[0]`.
    Start,
    /// Any point strictly between the ends.
    Interior,
    /// The second end, `segment[1]`.
    End,
}

/// A part of a closed triangle. The seven parts are disjoint and cover it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TriangleFeature {
    /// Corner `i`, 0 to 2.
    Vertex(u8),
    /// The open edge from corner `i` to corner `(i + 1) % 3`, 0 to 2.
    Edge(u8),
    /// Any point inside, off the edges.
    Interior,
}

/// What [`locate_piercing`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Piercing {
    /// The segment does not lie in the triangle's plane and shares no point with the triangle.
    Miss,
    /// The segment does not lie in the triangle's plane and shares exactly one point with the
    /// triangle, which lies on these two features.
    Point {
        /// The part of the segment that holds the point.
        on_segment: SegmentFeature,
        /// The part of the triangle that holds the point.
        on_triangle: TriangleFeature,
    },
    /// Both ends lie in the triangle's plane, or the triangle has no plane because its corners lie
    /// on one line. They may share nothing, a point, or a whole segment:
    /// [`classify_segment_triangle`] answers for this case too.
    Coplanar,
}

/// Which features of a closed segment and a closed triangle meet, where the segment crosses or
/// touches the triangle's plane in one point.
///
/// The point itself is not constructed; two calls with the same corners in any order name the same
/// features. Turning the segment around swaps `Start` and `End`; renumbering or turning the
/// triangle renumbers its features.
///
/// Degenerate input: a segment of no length off the plane is a [`Piercing::Miss`], in the plane it
/// is [`Piercing::Coplanar`]; a triangle of no area always is `Coplanar`.
///
/// ```
/// use cranny_exact::{DVec3, Piercing, SegmentFeature, TriangleFeature, locate_piercing};
/// let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// let downward = [DVec3::new(0.5, 0.0, 1.0), DVec3::new(0.5, 0.0, -1.0)];
/// assert_eq!(
///     locate_piercing(&downward, &triangle),
///     Piercing::Point {
///         on_segment: SegmentFeature::Interior,
///         on_triangle: TriangleFeature::Edge(0), // from corner 0 to corner 1
///     }
/// );
/// ```
#[must_use]
pub fn locate_piercing(segment: &[DVec3; 2], triangle: &[DVec3; 3]) -> Piercing {
    let [p, q] = *segment;
    let [a, b, c] = *triangle;
    let on_segment = match (orient3d(a, b, c, p), orient3d(a, b, c, q)) {
        (Sign::Zero, Sign::Zero) => return Piercing::Coplanar,
        (Sign::Zero, _) => SegmentFeature::Start,
        (_, Sign::Zero) => SegmentFeature::End,
        (s, t) if s == t => return Piercing::Miss,
        _ => SegmentFeature::Interior,
    };
    match line_through(p, q, triangle) {
        Some(on_triangle) => Piercing::Point { on_segment, on_triangle },
        None => Piercing::Miss,
    }
}

/// The feature of the triangle that the line `p q`, which crosses its plane in one point, hits.
///
/// Seen along the line, the sign of the volume `(p, q, corner i, corner i+1)` says on which side of
/// edge i the line passes. A zero says that it meets the line through that edge.
fn line_through(p: DVec3, q: DVec3, triangle: &[DVec3; 3]) -> Option<TriangleFeature> {
    let [a, b, c] = *triangle;
    let sides = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    let passes_left = sides.contains(&Sign::Positive);
    let passes_right = sides.contains(&Sign::Negative);
    if passes_left && passes_right {
        return None;
    }
    Some(match sides.map(Sign::is_zero) {
        [false, false, false] => TriangleFeature::Interior,
        [true, false, false] => TriangleFeature::Edge(0),
        [false, true, false] => TriangleFeature::Edge(1),
        [false, false, true] => TriangleFeature::Edge(2),
        [true, _, true] => TriangleFeature::Vertex(0),
        [true, true, _] => TriangleFeature::Vertex(1),
        [_, true, true] => TriangleFeature::Vertex(2),
    })
}

/// How a closed segment meets a closed triangle.
///
/// [`Meeting::Cross`]: the segment's inside pierces the triangle's inside. Any other shared point
/// is [`Meeting::Touch`], a segment in the triangle's plane included. A segment without length or a
/// triangle without area has no inside, so it can only touch.
#[must_use]
pub fn classify_segment_triangle(segment: &[DVec3; 2], triangle: &[DVec3; 3]) -> Meeting {
    match locate_piercing(segment, triangle) {
        Piercing::Miss => Meeting::None,
        Piercing::Point {
            on_segment: SegmentFeature::Interior,
            on_triangle: TriangleFeature::Interior,
        } => Meeting::Cross,
        Piercing::Point { .. } => Meeting::Touch,
        Piercing::Coplanar if meet_in_plane(segment, triangle) => Meeting::Touch,
        Piercing::Coplanar => Meeting::None,
    }
}

/// Whether they share a point, where the segment lies in the triangle's plane or the triangle has
/// none.
fn meet_in_plane(segment: &[DVec3; 2], triangle: &[DVec3; 3]) -> bool {
    if collinear(triangle) {
        segments_meet(segment, &span(triangle))
    } else {
        let [p, q] = *segment;
        coplanar_triangles_meet(&[p, q, q], triangle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] =
        [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

    /// What a vertical segment hits that goes down through `(x, y)`.
    fn below(x: f64, y: f64) -> Option<TriangleFeature> {
        let segment = [DVec3::new(x, y, 1.0), DVec3::new(x, y, -1.0)];
        match locate_piercing(&segment, &FLOOR) {
            Piercing::Point { on_segment, on_triangle } => {
                assert_eq!(on_segment, SegmentFeature::Interior);
                Some(on_triangle)
            }
            Piercing::Miss => None,
            Piercing::Coplanar => panic!("a vertical segment does not lie in the floor"),
        }
    }

    #[test]
    fn features_of_the_triangle_are_numbered_by_corner() {
        use TriangleFeature::{Edge, Interior, Vertex};
        assert_eq!(below(1.0, 1.0), Some(Interior));
        assert_eq!(
            [below(0.0, 0.0), below(4.0, 0.0), below(0.0, 4.0)].map(Option::unwrap),
            [Vertex(0), Vertex(1), Vertex(2)]
        );
        assert_eq!(
            [below(1.0, 0.0), below(2.0, 2.0), below(0.0, 1.0)].map(Option::unwrap),
            [Edge(0), Edge(1), Edge(2)]
        );
        assert_eq!(below(5.0, 0.0), None); // on the line through edge 0
        assert_eq!(below(2.0, 2.0f64.next_up()), None);
    }

    #[test]
    fn features_of_the_segment_follow_its_direction() {
        let at = |z0: f64, z1: f64| {
            let segment = [DVec3::new(1.0, 1.0, z0), DVec3::new(1.0, 1.0, z1)];
            match locate_piercing(&segment, &FLOOR) {
                Piercing::Point { on_segment, .. } => Some(on_segment),
                _ => None,
            }
        };
        assert_eq!(at(0.0, 1.0), Some(SegmentFeature::Start));
        assert_eq!(at(1.0, 0.0), Some(SegmentFeature::End));
        assert_eq!(at(-1.0, 1.0), Some(SegmentFeature::Interior));
        assert_eq!(at(1.0, 2.0), None);
        assert_eq!(at(1.0, 1.0), None); // a point off the plane
    }

    #[test]
    fn coplanar_and_degenerate_segments_can_only_touch() {
        let flat = |x: f64| [DVec3::new(x, -1.0, 0.0), DVec3::new(x, 9.0, 0.0)];
        assert_eq!(locate_piercing(&flat(1.0), &FLOOR), Piercing::Coplanar);
        assert_eq!(classify_segment_triangle(&flat(1.0), &FLOOR), Meeting::Touch);
        assert_eq!(classify_segment_triangle(&flat(4.0), &FLOOR), Meeting::Touch);
        assert_eq!(classify_segment_triangle(&flat(4.5), &FLOOR), Meeting::None);
        let point = [DVec3::new(1.0, 1.0, 0.0); 2];
        assert_eq!(classify_segment_triangle(&point, &FLOOR), Meeting::Touch);
        let needle = [DVec3::ZERO, DVec3::X, 3.0 * DVec3::X];
        let upright = [DVec3::new(2.0, 0.0, -1.0), DVec3::new(2.0, 0.0, 1.0)];
        assert_eq!(locate_piercing(&upright, &needle), Piercing::Coplanar);
        assert_eq!(classify_segment_triangle(&upright, &needle), Meeting::Touch);
    }

    #[test]
    fn only_insides_cross() {
        let upright = |x: f64, z: f64| [DVec3::new(x, 1.0, -1.0), DVec3::new(x, 1.0, z)];
        assert_eq!(classify_segment_triangle(&upright(1.0, 1.0), &FLOOR), Meeting::Cross);
        assert_eq!(classify_segment_triangle(&upright(1.0, 0.0), &FLOOR), Meeting::Touch);
        assert_eq!(classify_segment_triangle(&upright(3.0, 1.0), &FLOOR), Meeting::Touch);
        assert_eq!(classify_segment_triangle(&upright(3.5, 1.0), &FLOOR), Meeting::None);
    }
}
