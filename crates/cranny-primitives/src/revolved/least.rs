//! Where the signed distance from a core is least on a segment and on a triangle.
//!
//! The signed distance from a convex set is convex. On a segment its slope is that of the gradient,
//! so the least is bracketed by slopes of opposite signs. On a plane it is symmetric about the
//! plane's line of steepest descent to the axis, so the least lies on that line; where this place
//! is not inside the triangle, the least of the triangle lies on its sides.

use cranny_exact::DVec3;

use super::{CoreFoot, ROUNDING, Revolved};
use cranny_geometry::triangle_distance::{Part, closest_on_triangle};

/// Steps after which a bracket has shrunk to rounding: every third one halves it.
const STEPS: usize = 180;

/// Where the signed distance from a core is least on a segment.
#[derive(Clone, Copy, Debug)]
pub struct LeastOnSegment {
    /// From 0 at the first end to 1 at the second.
    pub at: f64,
    /// There.
    pub foot: CoreFoot,
    /// Unit, outward: the normal of the core that is square to the segment, amid those at its edge;
    /// at an end of the segment that of its foot.
    /// `None` where the segment pierces opposite sides.
    pub outward: Option<DVec3>,
}

/// Where the signed distance from a core is least on a triangle.
#[derive(Clone, Copy, Debug)]
pub struct LeastOnTriangle {
    /// The signed distance there.
    pub signed: f64,
    /// Where on the triangle.
    pub point: DVec3,
    /// What of the triangle holds it.
    pub part: Part,
    /// The nearest point of the core.
    pub on_core: DVec3,
    /// As [`LeastOnSegment::outward`].
    pub outward: Option<DVec3>,
}

/// A place on a segment with its slope.
#[derive(Clone, Copy)]
struct Probe {
    at: f64,
    foot: CoreFoot,
    slope: f64,
}

impl Revolved {
    /// Where the signed distance from the core is least on a segment.
    ///
    /// Cost: some ten feet of points.
    #[must_use]
    pub fn least_on_segment(&self, ends: [DVec3; 2]) -> LeastOnSegment {
        let along = ends[1] - ends[0];
        let probe = |at: f64| {
            let foot = self.core_foot(if at < 1.0 { ends[0] + along * at } else { ends[1] });
            Probe { at, foot, slope: foot.outward.dot(along) }
        };
        let at_end =
            |p: Probe| LeastOnSegment { at: p.at, foot: p.foot, outward: Some(p.foot.outward) };
        let (mut low, mut high) = (probe(0.0), probe(1.0));
        if low.slope >= 0.0 {
            return at_end(low);
        }
        if high.slope <= 0.0 {
            return at_end(high);
        }
        let size = ends[0].distance(self.middle()).max(ends[1].distance(self.middle()));
        let resolution = ROUNDING * (size + self.extent());
        for step in 0..STEPS {
            // The tangents at both ends of the bracket meet below the least.
            let width = high.at - low.at;
            let fall = high.slope * width - (high.foot.signed - low.foot.signed);
            let place = (fall / (high.slope - low.slope)).clamp(0.0, width);
            let bound = low.foot.signed + low.slope * place;
            if low.foot.signed.min(high.foot.signed) - bound <= resolution {
                break;
            }
            // Where a slope that changes evenly is 0, where two even slopes meet, and half-way, in
            // turn.
            let share = match step % 3 {
                0 => -low.slope * width / (high.slope - low.slope),
                1 => place,
                _ => 0.5 * width,
            };
            let within = share > 0.0 && share < width;
            let next = low.at + if within { share } else { 0.5 * width };
            if next <= low.at || next >= high.at {
                break;
            }
            let found = probe(next);
            if found.slope < 0.0 { low = found } else { high = found }
        }
        let best = if low.foot.signed <= high.foot.signed { low } else { high };
        let mixed = low.foot.outward * high.slope - high.foot.outward * low.slope;
        let outward = (mixed.length() > OPPOSITE * (high.slope - low.slope))
            .then(|| mixed.try_normalize())
            .flatten();
        LeastOnSegment { at: best.at, foot: best.foot, outward }
    }

    /// From the solid to a triangle, where the signed distance is least on that: unit.
    pub(crate) fn outward_at(&self, least: &LeastOnTriangle) -> DVec3 {
        least.outward.unwrap_or_else(|| self.core_foot(least.point).outward)
    }

    /// Where the signed distance from the core is least on a triangle, which may be without area.
    #[must_use]
    pub fn least_on_triangle(&self, triangle: &[DVec3; 3]) -> LeastOnTriangle {
        if let Some(inside) = self.least_inside(triangle) {
            return inside;
        }
        let sides = [0, 1, 2].map(|i| {
            let ends = [triangle[i], triangle[(i + 1) % 3]];
            (i as u8, ends, self.least_on_segment(ends))
        });
        let mut best = &sides[0];
        for side in &sides[1..] {
            if side.2.foot.signed < best.2.foot.signed {
                best = side;
            }
        }
        let (i, ends, least) = best;
        let (point, part) = match least.at {
            at if at <= 0.0 => (ends[0], Part::Corner(*i)),
            at if at >= 1.0 => (ends[1], Part::Corner((*i + 1) % 3)),
            at => (ends[0] + (ends[1] - ends[0]) * at, Part::Edge(*i)),
        };
        LeastOnTriangle {
            signed: least.foot.signed,
            point,
            part,
            on_core: least.foot.point,
            outward: least.outward,
        }
    }

    /// Where the least of the triangle's plane lies inside the triangle.
    fn least_inside(&self, triangle: &[DVec3; 3]) -> Option<LeastOnTriangle> {
        let [a, b, c] = *triangle;
        let normal = (b - a).cross(c - a).try_normalize()?;
        let on_plane = self.least_on_plane(a, normal);
        let (point, part) = closest_on_triangle(on_plane.point, triangle);
        (part == Part::Inside).then_some(LeastOnTriangle { point, ..on_plane })
    }

    /// Where the signed distance from the core is least on a plane through a point, with a unit
    /// normal. Its part is the inside of a triangle.
    #[must_use]
    pub fn least_on_plane(&self, point: DVec3, normal: DVec3) -> LeastOnTriangle {
        for outward in [normal, -normal] {
            let signed = outward.dot(point) - self.core_reach(outward);
            if signed >= 0.0 {
                let on_core = self.core_support(outward);
                return LeastOnTriangle {
                    signed,
                    point: on_core + outward * signed,
                    part: Part::Inside,
                    on_core,
                    outward: Some(outward),
                };
            }
        }
        // The plane cuts the core: along its line in the half-planes that hold its normal and the
        // axis.
        let middle = self.middle();
        let foot = middle + normal * normal.dot(point - middle);
        let (_, across) = self.parted(normal);
        let square = across.cross(self.axis);
        let along = normal.cross(square).normalize_or_zero() * (2.0 * self.extent());
        let ends = [foot - along, foot + along];
        let least = self.least_on_segment(ends);
        // Square to the line and in its half-planes, so along the plane's normal.
        let outward = least.outward.map(|o| if o.dot(normal) < 0.0 { -normal } else { normal });
        LeastOnTriangle {
            signed: least.foot.signed,
            point: ends[0] + (ends[1] - ends[0]) * least.at,
            part: Part::Inside,
            on_core: least.foot.point,
            outward,
        }
    }
}

/// Sine of the least angle between opposite sides and what is square to a segment that pierces
/// both. Smaller: normals are rounding; larger: sharp edges
/// have none.
const OPPOSITE: f64 = 1e-9;
