//! Is a point inside a solid? Exact: signed crossings of a segment that leads out.
//!
//! The winding number of the closed components around a point is the sum of +1 for every face that
//! the segment leaves through and −1 for every face that it enters by. Whether it does is decided
//! by sign predicates; a segment that meets an edge or a vertex is given up for another direction.
//! A point is inside where the winding number is not zero, so solids that overlap themselves count.
//!
//! The point need not be representable: a point of a face's inside, rounded, would leave the face
//! and could be on the wrong side of what the face touches. So it is a mean of exact points, and
//! all predicates read the mean. Only culling reads it rounded.

use cranny_exact::{Aabb, DVec3, Sign, WeightedPoint, generic_direction, orient3d};
use cranny_geometry::FaceId;

use crate::pair::{Pair, Side};
use crate::projection::Projection;
use crate::tally::Tally;

/// Where a point is with respect to the closed components of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Location {
    Inside,
    On,
    Outside,
}

/// By how much of its length a segment that leads out the shortest way is turned aside. Zero: it
/// runs along the edges of what is made of boxes, and there is no other segment to decide; larger:
/// it passes more faces. Below three quarters it surely ends outside the box.
const SWAY: f64 = 0.25;
const _: () = assert!(0.0 < SWAY && SWAY < 0.75);

/// Classifies a point of the pair's frame against the solid on a side.
pub(crate) fn locate(
    pair: &Pair,
    side: Side,
    p: &WeightedPoint,
    counters: &mut impl Tally,
) -> Location {
    counters.counters().inside_tests += 1;
    if is_beside_solids(pair, side, p) {
        return Location::Outside;
    }
    let (bounds, near) = (pair.bounds(side), p.rounded());
    // A generic direction is right at once; the loop ends because finitely many edges block only a
    // null set of directions and the sequence is equidistributed over an open set of them.
    let out = shortest_way_out(&bounds, near);
    let mut attempt = 0;
    loop {
        // Surely out of the bounds, also where these are no larger than the rounding of `p`.
        let reach = 4.0 * bounds.diagonal() + 64.0 * p.rounding();
        let end = near + (out + SWAY * generic_direction(attempt)) * reach;
        if let Some(location) = along(pair, side, p, end) {
            return location;
        }
        attempt += 1;
    }
}

pub(crate) fn is_inside(pair: &Pair, side: Side, p: DVec3, counters: &mut impl Tally) -> bool {
    locate(pair, side, &WeightedPoint::at(p), counters) == Location::Inside
}

/// The unit vector towards the nearest side of a box: what goes out there meets few faces.
fn shortest_way_out(bounds: &Aabb, p: DVec3) -> DVec3 {
    let ways = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|axis| [((bounds.max - p).dot(axis), axis), ((p - bounds.min).dot(axis), -axis)]);
    ways.min_by(|x, y| x.0.total_cmp(&y.0)).map_or(DVec3::X, |(_, way)| way)
}

/// Whether a point lies outside the boxes of all closed components.
fn is_beside_solids(pair: &Pair, side: Side, p: &WeightedPoint) -> bool {
    let (near, slack) = local(pair, side, p.rounded());
    let slack = DVec3::splat(slack + p.rounding());
    let around = Aabb { min: near - slack, max: near + slack };
    let model = pair.model(side);
    // Of all, first: there may be many.
    !model.bounds().overlaps(&around)
        || !model.clusters().solids().iter().any(|solid| solid.overlaps(&around))
}

/// A point of the pair's frame in that of a body, and by how much that may be off.
pub(crate) fn local(pair: &Pair, side: Side, p: DVec3) -> (DVec3, f64) {
    match side {
        Side::First => (p, 0.0),
        Side::Second => (pair.first_from_second.inverse().apply(p), 8.0 * pair.culling_error()),
    }
}

/// The verdict along the segment to `end`, which is outside; `None` where it meets an edge or a
/// vertex or lies in a face.
fn along(pair: &Pair, side: Side, p: &WeightedPoint, end: DVec3) -> Option<Location> {
    let mut winding = 0i64;
    let mut verdict = Some(Location::Outside);
    for_each_face_along(pair, side, p, end, |face| {
        if !pair.topology(side).in_closed_component(face) || verdict == Some(Location::On) {
            return;
        }
        match passage(p, end, &pair.triangle(side, face)) {
            Passage::Beside => {}
            Passage::Starts => verdict = Some(Location::On),
            Passage::Leaves => winding += 1,
            Passage::Enters => winding -= 1,
            Passage::Unclear => verdict = None,
        }
    });
    match verdict {
        Some(Location::Outside) if winding != 0 => Some(Location::Inside),
        other => other,
    }
}

/// How a segment passes a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Passage {
    /// They share no point.
    Beside,
    /// The segment begins on the face.
    Starts,
    /// Through its inside, from the back to the front.
    Leaves,
    /// Through its inside, from the front.
    Enters,
    /// In its plane, or through its rim.
    Unclear,
}

/// A face without area is passed by: it bounds nothing, and what goes through it goes through the
/// rim of a neighbour that does.
fn passage(p: &WeightedPoint, end: DVec3, triangle: &[DVec3; 3]) -> Passage {
    let [a, b, c] = *triangle;
    let (from, to) = (p.side_of(a, b, c), orient3d(a, b, c, end));
    if from.is_zero() && to.is_zero() {
        // In the plane: another direction decides.
        let has_area = Projection::of(triangle).is_some();
        return if has_area { Passage::Unclear } else { Passage::Beside };
    }
    if from == to || to.is_zero() {
        return Passage::Beside;
    }
    // On which side of each edge the line passes. (The turn about the edge; `p` comes last.)
    let sides = [(a, b), (b, c), (c, a)].map(|(u, v)| p.side_of(end, u, v));
    if sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative) {
        Passage::Beside
    } else if from.is_zero() {
        Passage::Starts
    } else if sides.contains(&Sign::Zero) {
        Passage::Unclear
    } else if from == Sign::Negative {
        Passage::Leaves
    } else {
        Passage::Enters
    }
}

/// Calls `visit` for every face whose box the segment from `p` to `end` may meet.
fn for_each_face_along(
    pair: &Pair,
    side: Side,
    p: &WeightedPoint,
    end: DVec3,
    visit: impl FnMut(FaceId),
) {
    let [(start, slack), (end, _)] = [p.rounded(), end].map(|p| local(pair, side, p));
    let local = [start, end];
    let reach = (local[1] - local[0]).length();
    let slack = slack + p.rounding() + 8.0 * f64::EPSILON * (reach + local[0].length());
    let ray = Ray::new(local);
    pair.model(side).tree().visit(|b| ray.may_meet(b, slack), visit);
}

/// A segment for box culling.
struct Ray {
    start: DVec3,
    inverse: DVec3,
}

impl Ray {
    fn new([start, end]: [DVec3; 2]) -> Self {
        Self { start, inverse: (end - start).recip() }
    }

    /// The slab test; a zero component yields infinities or NaN, and the comparisons are written so
    /// that NaN keeps the box.
    fn may_meet(&self, b: &Aabb, slack: f64) -> bool {
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        for axis in 0..3 {
            let t0 = (b.min[axis] - slack - self.start[axis]) * self.inverse[axis];
            let t1 = (b.max[axis] + slack - self.start[axis]) * self.inverse[axis];
            enter = enter.max(t0.min(t1));
            leave = leave.min(t0.max(t1));
        }
        // Three roundings of parameters in [0, 1].
        enter <= leave + 8.0 * f64::EPSILON
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn passed(from: [f64; 3], end: [f64; 3], triangle: &[DVec3; 3]) -> Passage {
        let p = WeightedPoint::at(DVec3::from_array(from));
        passage(&p, DVec3::from_array(end), triangle)
    }

    #[test]
    fn a_segment_passes_a_face_in_five_ways() {
        assert_eq!(passed([0.25, 0.25, -1.0], [0.25, 0.25, 1.0], &FLOOR), Passage::Leaves);
        assert_eq!(passed([0.25, 0.25, 1.0], [0.25, 0.25, -1.0], &FLOOR), Passage::Enters);
        assert_eq!(passed([2.0, 0.25, -1.0], [2.0, 0.25, 1.0], &FLOOR), Passage::Beside);
        assert_eq!(passed([0.25, 0.25, 1.0], [0.25, 0.25, 2.0], &FLOOR), Passage::Beside);
        assert_eq!(passed([0.25, 0.0, -1.0], [0.25, 0.0, 1.0], &FLOOR), Passage::Unclear);
        assert_eq!(passed([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], &FLOOR), Passage::Unclear);
        assert_eq!(passed([0.25, 0.25, 0.0], [9.0, 0.25, 0.0], &FLOOR), Passage::Unclear);
    }

    #[test]
    fn a_segment_that_begins_on_a_face_or_its_rim_begins_there() {
        for from in [[0.25, 0.25, 0.0], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.5, 0.0]] {
            for end in [[0.3, 9.0, 4.0], [-3.0, 1.0, -5.0]] {
                assert_eq!(passed(from, end, &FLOOR), Passage::Starts);
            }
        }
        assert_eq!(passed([1.0, 0.5, 0.0], [0.0, 0.0, 9.0], &FLOOR), Passage::Beside);
    }

    #[test]
    fn a_face_without_area_is_passed_by() {
        let needle = [DVec3::ZERO, DVec3::X, DVec3::X * 0.5];
        assert_eq!(passed([0.25, 0.0, -1.0], [0.25, 0.0, 1.0], &needle), Passage::Beside);
        assert_eq!(passed([0.25, 0.0, 0.0], [0.25, 0.0, 1.0], &needle), Passage::Beside);
    }
}
