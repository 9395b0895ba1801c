//! Is a point inside a solid? Exact: signed crossings of a segment that leads out.
//!
//! The winding number of the closed components around a point is the sum of +1 for every face that
//! the segment leaves through and −1 for every face that it enters by. Whether it does is decided by
//! sign predicates; a segment that meets an edge or a vertex is given up for another direction.
//! A point is inside where the winding number is not zero, so solids that overlap themselves count.

use cranny_exact::{
    Aabb, DVec3, Piercing, SegmentFeature, Sign, TriangleFeature, classify_segment_triangle,
    locate_piercing, orient3d,
};
use cranny_geometry::FaceId;

use crate::answer::Counters;
use crate::pair::{Pair, Side};

/// Where a point is with respect to the closed components of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Location {
    Inside,
    On,
    Outside,
}

/// Classifies a point of the pair's frame against the solid on a side.
pub(crate) fn locate(pair: &Pair, side: Side, p: DVec3, counters: &mut Counters) -> Location {
    counters.inside_tests += 1;
    let bounds = pair.bounds(side);
    if !bounds.contains_point(p) {
        return Location::Outside;
    }
    // A generic direction is right at once; the loop ends because finitely many edges block only a
    // null set of directions and the sequence is equidistributed.
    let mut attempt = 0;
    loop {
        let end = p + direction(attempt) * (4.0 * bounds.diagonal());
        if let Some(location) = along(pair, side, [p, end]) {
            return location;
        }
        attempt += 1;
    }
}

/// The verdict along one segment; `None` where it meets an edge or a vertex or lies in a face.
fn along(pair: &Pair, side: Side, segment: [DVec3; 2]) -> Option<Location> {
    let mut winding = 0i64;
    let mut verdict = Some(Location::Outside);
    for_each_face_along(pair, side, segment, |face| {
        if !pair.topology(side).in_closed_component(face) || verdict == Some(Location::On) {
            return;
        }
        let triangle = pair.triangle(side, face);
        match locate_piercing(&segment, &triangle) {
            Piercing::Miss => {}
            Piercing::Point { on_segment: SegmentFeature::Start, .. } => {
                verdict = Some(Location::On);
            }
            Piercing::Point { on_triangle: TriangleFeature::Interior, .. } => {
                match orient3d(triangle[0], triangle[1], triangle[2], segment[0]) {
                    Sign::Negative => winding += 1, // from behind: leaving
                    _ => winding -= 1,
                }
            }
            Piercing::Point { .. } => verdict = None,
            Piercing::Coplanar => {
                if classify_segment_triangle(&[segment[0]; 2], &triangle).meets() {
                    verdict = Some(Location::On);
                } else if classify_segment_triangle(&segment, &triangle).meets() {
                    verdict = None;
                }
            }
        }
    });
    match verdict {
        Some(Location::Outside) if winding != 0 => Some(Location::Inside),
        other => other,
    }
}

/// Calls `visit` for every face whose box the segment may meet.
fn for_each_face_along(pair: &Pair, side: Side, segment: [DVec3; 2], visit: impl FnMut(FaceId)) {
    let (local, slack) = match side {
        Side::First => (segment, 0.0),
        Side::Second => {
            let inverse = pair.first_from_second.inverse();
            (segment.map(|p| inverse.apply(p)), 8.0 * pair.culling_error())
        }
    };
    let reach = (local[1] - local[0]).length();
    let slack = slack + 8.0 * f64::EPSILON * (reach + local[0].length());
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

/// An equidistributed sequence of directions, none of them near an axis or a diagonal at first.
fn direction(attempt: u32) -> DVec3 {
    // Fractional parts of multiples of the plastic number's powers (Roberts 2018) in two dimensions.
    let n = f64::from(attempt) + 1.0;
    let (u, v) = ((n * 0.754_877_666_246_692_7).fract(), (n * 0.569_840_290_998_053_2).fract());
    // On the cube's surface rather than the sphere's: no transcendental function is needed.
    let p = DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.618_033_988_749_894_9);
    match attempt % 3 {
        0 => p,
        1 => DVec3::new(p.z, p.x, p.y),
        _ => DVec3::new(p.y, -p.z, p.x),
    }
}
