//! A triangle in the pair's frame, with what tells at once that another is out of its reach.
//!
//! Each triangle has five planes: on top and at the bottom of it, and upright on its
//! sides. The corners of another triangle have *outcodes* against them (after Cohen and Sutherland, in
//! Newman and Sproull 1973): a bit for each plane beyond which a corner lies by more than the reach. What
//! shares a bit (all corners of a triangle, both ends of an edge) lies beyond that plane as a whole.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

/// A plane upright on a side of a triangle.
#[derive(Clone, Copy)]
struct Upright {
    /// Outward, in the triangle's plane, as long as the side.
    direction: DVec3,
    length: f64,
    /// How far the corners reach along it. All three, so that bounds hold also where rounding tilts it.
    far: f64,
}

/// A triangle and its planes. Those of a triangle without area hold everything.
pub(super) struct Facet {
    pub(super) face: FaceId,
    pub(super) corners: [DVec3; 3],
    /// Unit, or zero without area.
    normal: DVec3,
    /// How far the corners reach along the normal, and against it. All three, as above.
    top: f64,
    bottom: f64,
    sides: [Upright; 3],
}

/// Where the corners of one triangle are with respect to another.
pub(super) struct Outcodes {
    codes: [u8; 3],
    /// The least height of a corner over the other's top.
    pub(super) least_height: f64,
}

impl Outcodes {
    /// Which corners are within reach: a bit each.
    pub(super) fn corners(&self) -> u8 {
        let within = |i: usize| u8::from(self.codes[i] == 0) << i;
        within(0) | within(1) | within(2)
    }

    /// Which sides, from a corner to the next, may have a point within reach: a bit each.
    pub(super) fn sides(&self) -> u8 {
        let [a, b, c] = self.codes;
        u8::from(a & b == 0) | u8::from(b & c == 0) << 1 | u8::from(c & a == 0) << 2
    }
}

/// The numbers of the bits that are set, of three.
pub(super) fn ones(bits: u8) -> impl Iterator<Item = usize> {
    (0..3).filter(move |i| bits >> i & 1 != 0)
}

impl Facet {
    /// Of a face and its corners in the pair's frame.
    pub(super) fn of(face: FaceId, corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let normal = edges[0].cross(-edges[2]).normalize_or_zero();
        let [bottom, top] = extent(&corners, normal);
        let sides = edges.map(|edge| {
            let direction = edge.cross(normal);
            Upright { direction, length: edge.length(), far: extent(&corners, direction)[1] }
        });
        Self { face, corners, normal, top, bottom, sides }
    }

    /// Where the corners of two triangles are, those of the second with respect to the first and the other way
    /// round; out is what is beyond a plane by more than `reach`, rounding not included. `None` if all three
    /// corners are beyond one plane.
    #[inline]
    pub(super) fn outcodes(pair: [&Self; 2], reach: f64, rounding: f64) -> Option<[Outcodes; 2]> {
        let [f, g] = pair;
        let mut of_g = f.heights(g, reach + rounding)?;
        let mut of_f = g.heights(f, reach + rounding)?;
        f.add_sides(g, reach, rounding, &mut of_g)?;
        g.add_sides(f, reach, rounding, &mut of_f)?;
        Some([of_f, of_g])
    }

    /// Outcodes of another triangle's corners against the planes on top and at the bottom of this one.
    #[inline]
    fn heights(&self, other: &Self, reach: f64) -> Option<Outcodes> {
        let heights = other.corners.map(|p| self.normal.dot(p));
        let (over, beneath) = (self.top + reach, self.bottom - reach);
        let codes = heights.map(|h| u8::from(h > over) | u8::from(h < beneath) << 1);
        let [a, b, c] = codes;
        let [x, y, z] = heights;
        let least = if x < y { x } else { y };
        let least = if z < least { z } else { least };
        (a & b & c == 0).then_some(Outcodes { codes, least_height: least - self.top })
    }

    /// Adds those against the planes on the sides.
    ///
    /// What lies over this triangle by h and beyond a side by l is √(h² + l²) away: so near to the reach in
    /// height, little is left of it sideways.
    #[inline]
    fn add_sides(&self, other: &Self, reach: f64, rounding: f64, out: &mut Outcodes) -> Option<()> {
        let (most, height) = (reach + rounding, out.least_height - rounding);
        let sideways =
            if height > 0.0 { (most * most - height * height).max(0.0).sqrt() } else { most };
        let sideways = sideways + rounding;
        let codes = &mut out.codes;
        for (i, side) in self.sides.iter().enumerate() {
            let beyond = side.far + sideways * side.length;
            let [a, b, c] = other.corners.map(|p| u8::from(side.direction.dot(p) > beyond));
            if a & b & c != 0 {
                return None;
            }
            codes[0] |= a << (i + 2);
            codes[1] |= b << (i + 2);
            codes[2] |= c << (i + 2);
        }
        Some(())
    }

    pub(super) fn side(&self, i: usize) -> [DVec3; 2] {
        [self.corners[i], self.corners[(i + 1) % 3]]
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

    /// Those of the second with respect to the first.
    fn outcodes(of: &Facet, other: &Facet, reach: f64) -> Option<Outcodes> {
        let mut out = of.heights(other, reach)?;
        of.add_sides(other, reach, 0.0, &mut out)?;
        Some(out)
    }

    #[test]
    fn outcodes_tell_beyond_which_planes_corners_are() {
        let floor = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        // Over the floor, rising by 1; then beneath it, then beside its first side.
        let roof = facet([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 3.0]]);
        assert!(outcodes(&floor, &roof, 1.0).is_none());
        let out = outcodes(&floor, &roof, 2.5).unwrap();
        assert_eq!((out.corners(), out.sides(), out.least_height), (0b011, 0b111, 2.0));
        assert!(Facet::outcodes([&floor, &roof], 2.5, 0.0).is_some());
        assert!(Facet::outcodes([&floor, &roof], 1.5, 0.0).is_none());
        let cellar = facet(roof.corners.map(|p| (-p).to_array()));
        assert!(
            outcodes(&floor, &cellar, 1.5).is_none() && outcodes(&floor, &cellar, 2.5).is_some()
        );
        let beside = facet([[0.0, -2.0, -1.0], [1.0, -2.0, 1.0], [0.0, 0.5, 0.0]]);
        let out = outcodes(&floor, &beside, 1.5).unwrap();
        assert_eq!(ones(out.sides()).collect::<Vec<_>>(), [1, 2]);
        let away = facet([[0.0, -2.0, 0.0], [1.0, -2.0, 0.0], [0.0, -3.0, 0.0]]);
        assert!(outcodes(&floor, &away, 1.5).is_none());
        // A needle has no planes of its own.
        let needle = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        let out = outcodes(&needle, &roof, 0.5).unwrap();
        assert_eq!(out.corners(), 0b111);
    }

    #[test]
    fn what_is_high_over_a_triangle_may_be_little_beside_it() {
        let floor = facet([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        // 3 over it and 4 or more beyond its first side: 5 away.
        let shelf = facet([[0.0, -4.0, 3.0], [1.0, -4.0, 3.0], [0.0, -5.0, 3.0]]);
        assert!(outcodes(&floor, &shelf, 4.99).is_none());
        assert!(outcodes(&floor, &shelf, 5.01).is_some());
    }
}
