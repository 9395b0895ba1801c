//! A triangle with what tells at once that a point is out of its reach: its planes, in its body's frame, and so for
//! every pose.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

/// A triangle and the planes on top of it, at its bottom and along its sides. Those of a triangle without area hold everything.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) face: FaceId,
    /// Where its corners are among the points of its leaf.
    pub(super) places: [u16; 3],
    /// Unit, or zero without area.
    pub(super) normal: DVec3,
    /// How far the corners reach along the normal, and against it. All three, so that bounds hold also where
    /// rounding tilts it.
    pub(super) top: f64,
    bottom: f64,
    /// Directions across the sides, outward: unit, or zero; and how far the corners reach that way. Again all three.
    sides: [(DVec3, f64); 3],
}

/// The numbers of the bits that are set, of three.
pub(super) fn ones(bits: u8) -> impl Iterator<Item = usize> {
    (0..3).filter(move |i| bits >> i & 1 != 0)
}

impl Facet {
    /// Of a face and its corners in the body's frame.
    pub(super) fn of(face: FaceId, corners: &[DVec3; 3], places: [u16; 3]) -> Self {
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let [bottom, top] = extent(corners, normal);
        let sides = [b - a, c - b, a - c].map(|along| {
            let outward = along.cross(normal).normalize_or_zero();
            (outward, extent(corners, outward)[1])
        });
        Self { face, places, normal, top, bottom, sides }
    }

    /// Whether a point of the body's frame may be no farther than `reach` away: false for what is over the triangle,
    /// beneath it or beyond one of its sides by more.
    #[inline]
    pub(super) fn may_reach(&self, p: DVec3, reach: f64) -> bool {
        let height = self.normal.dot(p);
        height <= self.top + reach
            && height >= self.bottom - reach
            && self.sides.iter().all(|(outward, end)| outward.dot(p) <= end + reach)
    }

    /// Where its corners are, given the points of its leaf.
    #[inline]
    pub(super) fn corners(&self, points: &[DVec3]) -> [DVec3; 3] {
        self.places.map(|place| points[usize::from(place)])
    }
}

/// Whether all of some points lie higher over a plane than `reach`.
#[inline]
pub(super) fn is_beneath(normal: DVec3, height: f64, points: &[DVec3], reach: f64) -> bool {
    let over = height + reach;
    points.iter().all(|p| normal.dot(*p) > over)
}

/// How far points reach along a direction: least and most.
#[inline]
pub(super) fn extent(points: &[DVec3; 3], direction: DVec3) -> [f64; 2] {
    let [a, b, c] = points.map(|p| direction.dot(p));
    let [low, high] = if a < b { [a, b] } else { [b, a] };
    [if c < low { c } else { low }, if c > high { c } else { high }]
}

/// By how much of its length two edges may miss each other, seen along their common normal, and still
/// be looked at closely. Smaller: rounding of edges at small angles loses crossings at ends.
const NEAR_MISS: f64 = 1e-3;

/// Whether two segments may cross when seen along their common normal, their lines no farther than
/// `below` apart: cheap, and true too often rather than too seldom.
#[inline]
pub(super) fn may_cross([p0, p1]: [DVec3; 2], [q0, q1]: [DVec3; 2], below: f64) -> bool {
    let (d1, d2, apart) = (p1 - p0, q1 - q0, q0 - p0);
    let cross = d1.cross(d2);
    let squared = cross.length_squared();
    let lift = cross.dot(apart);
    if lift * lift > below * below * squared * (1.0 + NEAR_MISS) {
        return false;
    }
    let within = |t: f64| t >= -NEAR_MISS * squared && t <= (1.0 + NEAR_MISS) * squared;
    within(apart.cross(d2).dot(cross)) && within(apart.cross(d1).dot(cross))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facet(corners: [[f64; 3]; 3]) -> Facet {
        Facet::of(FaceId(0), &corners.map(DVec3::from_array), [0, 1, 2])
    }

    #[test]
    fn a_point_is_out_of_reach_over_beneath_and_beside_a_triangle() {
        let floor = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        for p in [at(0.2, 0.2, 1.0), at(0.2, 0.2, -1.0), at(0.2, -1.0, 0.0), at(-1.0, 0.2, 0.0)] {
            assert!(floor.may_reach(p, 1.01) && !floor.may_reach(p, 0.99), "{p}");
        }
        // Beyond the long side, by its own length's measure.
        assert!(
            floor.may_reach(at(1.0, 1.0, 0.0), 0.71) && !floor.may_reach(at(1.0, 1.0, 0.0), 0.7)
        );
        let beneath = |reach| {
            is_beneath(floor.normal, floor.top, &[at(5.0, 5.0, 0.3), at(0.0, 0.0, 0.4)], reach)
        };
        assert!(beneath(0.29) && !beneath(0.31));
        // A needle has no planes of its own.
        let needle = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        assert!(needle.may_reach(at(9.0, 9.0, 9.0), 0.5));
    }
}
