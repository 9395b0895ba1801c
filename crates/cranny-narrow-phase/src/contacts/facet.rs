//! A triangle in the pair's frame, with what tells at once that a point is out of its reach.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

/// A triangle and the planes on top and at the bottom of it. Those of a triangle without area hold everything.
pub(super) struct Facet {
    pub(super) face: FaceId,
    pub(super) corners: [DVec3; 3],
    /// Unit, or zero without area.
    normal: DVec3,
    /// How far the corners reach along the normal, and against it. All three, so that bounds hold also where
    /// rounding tilts it.
    top: f64,
    bottom: f64,
}

/// The numbers of the bits that are set, of three.
pub(super) fn ones(bits: u8) -> impl Iterator<Item = usize> {
    (0..3).filter(move |i| bits >> i & 1 != 0)
}

impl Facet {
    /// Of a face and its corners in the pair's frame.
    pub(super) fn of(face: FaceId, corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let [bottom, top] = extent(&corners, normal);
        Self { face, corners, normal, top, bottom }
    }

    /// Whether a point may be no farther than `reach` away: false for what is over the triangle, beneath it or
    /// beyond one of its sides by more.
    #[inline]
    pub(super) fn may_reach(&self, p: DVec3, reach: f64) -> bool {
        let height = self.normal.dot(p);
        height <= self.top + reach && height >= self.bottom - reach && self.may_be_over(p, reach)
    }

    /// Whether a point is not beyond a side by more than `reach`, seen along the normal.
    fn may_be_over(&self, p: DVec3, reach: f64) -> bool {
        let [a, b, c] = self.corners;
        [(a, b), (b, c), (c, a)].iter().all(|&(start, end)| {
            let along = end - start;
            let beyond = along.cross(self.normal).dot(p - start);
            // The outward direction is as long as the side.
            beyond <= 0.0 || beyond * beyond <= reach * reach * along.length_squared()
        })
    }

    /// Whether all of some points lie higher over the triangle than `reach`.
    #[inline]
    pub(super) fn is_beneath(&self, points: &[DVec3], reach: f64) -> bool {
        let over = self.top + reach;
        points.iter().all(|p| self.normal.dot(*p) > over)
    }
}

/// How far points reach along a direction: least and most.
#[inline]
fn extent(points: &[DVec3; 3], direction: DVec3) -> [f64; 2] {
    let [a, b, c] = points.map(|p| direction.dot(p));
    let [low, high] = if a < b { [a, b] } else { [b, a] };
    [if c < low { c } else { low }, if c > high { c } else { high }]
}

/// By how much of its length two edges may miss each other, seen along their common normal, and still
/// be looked at closely. Smaller: rounding of edges at small angles loses crossings at ends.
const NEAR_MISS: f64 = 1e-3;

/// Whether two segments may cross when seen along their common normal, their lines no farther than
/// `below` apart: cheap, and true too often rather than too seldom.
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
        Facet::of(FaceId(0), corners.map(DVec3::from_array))
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
        assert!(floor.is_beneath(&[at(5.0, 5.0, 0.3), at(0.0, 0.0, 0.4)], 0.29));
        assert!(!floor.is_beneath(&[at(5.0, 5.0, 0.3), at(0.0, 0.0, 0.4)], 0.31));
        // A needle has no planes of its own.
        let needle = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        assert!(needle.may_reach(at(9.0, 9.0, 9.0), 0.5));
    }
}
