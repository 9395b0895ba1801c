//! A triangle in the pair's frame, with what tells at once that another is out of its reach.
//!
//! Each triangle has a ball around it and five planes: on top and at the bottom of it, and upright on its
//! sides. The corners of another triangle have *outcodes* against them (after Cohen and Sutherland, in
//! Newman and Sproull 1973): a bit for each plane beyond which a corner lies by more than the reach. What
//! shares a bit (all corners of a triangle, both ends of an edge) lies beyond that plane as a whole.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

use crate::pair::{Pair, Side};

/// A triangle, its ball and its planes. Those of a triangle without area hold everything.
pub(super) struct Facet {
    pub(super) face: FaceId,
    pub(super) corners: [DVec3; 3],
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// Unit, or zero without area.
    normal: DVec3,
    /// How far the corners reach along the normal, and against it. All three, so that bounds hold also
    /// where rounding tilts a needle's normal.
    top: f64,
    bottom: f64,
    /// For each side: its outward direction in the plane, unit, and how far along it the corners reach.
    outward: [(DVec3, f64); 3],
}

/// Where the corners of one triangle are with respect to another.
pub(super) struct Outcodes {
    codes: [u8; 3],
    /// The least height of a corner over the other's top.
    pub(super) least_height: f64,
}

impl Outcodes {
    /// A corner is not within reach.
    pub(super) fn corner_out(&self, corner: usize) -> bool {
        self.codes[corner] != 0
    }

    /// No point of the side from this corner to the next is within reach.
    pub(super) fn side_out(&self, corner: usize) -> bool {
        self.codes[corner] & self.codes[(corner + 1) % 3] != 0
    }
}

impl Facet {
    /// Of a face and its corners in the pair's frame.
    pub(super) fn of(face: FaceId, corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let [least, most] = extent(&corners, normal);
        let mut outward = [(DVec3::ZERO, 0.0); 3];
        for (i, slot) in outward.iter_mut().enumerate() {
            let direction = (corners[(i + 1) % 3] - corners[i]).cross(normal).normalize_or_zero();
            *slot = (direction, extent(&corners, direction)[1]);
        }
        let center = (a + b + c) / 3.0;
        let squared = |p: DVec3| (p - center).length_squared();
        let radius = squared(a).max(squared(b)).max(squared(c)).sqrt();
        Self { face, corners, center, radius, normal, top: most, bottom: least, outward }
    }

    /// Whether another triangle's ball is more than `reach` away from this one's.
    #[inline]
    pub(super) fn is_far_from(&self, other: &Self, reach: f64) -> bool {
        let touching = self.radius + other.radius + reach;
        (self.center - other.center).length_squared() > touching * touching
    }

    /// Where another triangle's corners are; out is what is beyond a plane by more than `reach`. `None` if all
    /// three are beyond one plane.
    #[inline]
    pub(super) fn outcodes(&self, other: &Self, reach: f64) -> Option<Outcodes> {
        let mut codes = [0u8; 3];
        let mut least = f64::INFINITY;
        for (code, p) in codes.iter_mut().zip(&other.corners) {
            let height = self.normal.dot(*p);
            if height < least {
                least = height;
            }
            *code =
                u8::from(height > self.top + reach) | u8::from(height < self.bottom - reach) << 1;
        }
        if codes[0] & codes[1] & codes[2] != 0 {
            return None;
        }
        for (i, (direction, far)) in self.outward.iter().enumerate() {
            let [a, b, c] = &other.corners;
            let beyond = far + reach;
            let [a, b, c] = [a, b, c].map(|p| u8::from(direction.dot(*p) > beyond));
            if a & b & c != 0 {
                return None;
            }
            codes[0] |= a << (i + 2);
            codes[1] |= b << (i + 2);
            codes[2] |= c << (i + 2);
        }
        Some(Outcodes { codes, least_height: least - self.top })
    }

    pub(super) fn side(&self, i: usize) -> [DVec3; 2] {
        [self.corners[i], self.corners[(i + 1) % 3]]
    }

    /// Whether a corner is looked at from this face: the first of the corner's patch there, so that each vertex
    /// is looked at once for each face of the other patch.
    pub(super) fn owns_corner(&self, pair: &Pair, side: Side, i: usize) -> bool {
        let vertex = pair.corner(side, self.face, i);
        self.is_first(pair, side, pair.topology(side).faces_at(vertex).iter().copied())
    }

    /// As [`owns_corner`](Self::owns_corner), of the edge from a corner to the next.
    pub(super) fn owns_side(&self, pair: &Pair, side: Side, i: usize) -> bool {
        let edge = pair.edge(side, self.face, i);
        self.is_first(pair, side, pair.topology(side).half_edges(edge).iter().map(|h| h.face()))
    }

    /// Whether this is the first face of the lowest patch among some faces: that to which belongs what lies
    /// between them.
    fn is_first(&self, pair: &Pair, side: Side, faces: impl Iterator<Item = FaceId>) -> bool {
        let patches = pair.model(side).patches();
        faces.min_by_key(|&f| patches.patch_of_face(f)) == Some(self.face)
    }
}

/// How far points reach along a direction: least and most.
fn extent(points: &[DVec3; 3], direction: DVec3) -> [f64; 2] {
    let [a, b, c] = points.map(|p| direction.dot(p));
    [a.min(b).min(c), a.max(b).max(c)]
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
    fn outcodes_tell_beyond_which_planes_corners_are() {
        let floor = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        // Over the floor, rising by 1; then beneath it, then beside its first side.
        let roof = facet([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 3.0]]);
        assert!(floor.outcodes(&roof, 1.0).is_none());
        let out = floor.outcodes(&roof, 2.5).unwrap();
        assert_eq!([0, 1, 2].map(|i| out.corner_out(i)), [false, false, true]);
        assert!(out.least_height == 2.0 && [0, 1, 2].iter().all(|&i| !out.side_out(i)));
        let cellar = facet(roof.corners.map(|p| (-p).to_array()));
        assert!(floor.outcodes(&cellar, 1.5).is_none() && floor.outcodes(&cellar, 2.5).is_some());
        let beside = facet([[0.0, -2.0, -1.0], [1.0, -2.0, 1.0], [0.0, 0.5, 0.0]]);
        let out = floor.outcodes(&beside, 1.5).unwrap();
        assert!(out.side_out(0) && !out.side_out(1));
        assert!(
            floor
                .outcodes(&facet([[0.0, -2.0, 0.0], [1.0, -2.0, 0.0], [0.0, -3.0, 0.0]]), 1.5)
                .is_none()
        );
        // A needle has no planes of its own.
        let needle = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        let out = needle.outcodes(&roof, 0.5).unwrap();
        assert!([0, 1, 2].iter().all(|&i| !out.corner_out(i)));
    }
}
