//! What is known of a part from sums over its faces: which way its plane faces, and how thick it
//! is.
//!
//! The plane of a part faces as its faces do on average. A hole right through has no floor, though,
//! and what is in it goes on in both directions: there the planes stand along the axis, where they
//! can.
//!
//! The thickness of a part along a normal is read off the second moments of its faces' corners:
//! their variance along it is that of an even layer so thick. Sums can be added, so a part costs
//! one pass over its groups however many ways to divide it are judged, and no sorting. Only costs
//! follow from it; the planes themselves hold every corner.
//!
//! Source: second moments of faces say how boxes lie in Gottschalk, Lin and Manocha (1996,
//! "OBBTree: a hierarchical structure for rapid interference detection"); here a thickness alone is
//! read off them. Cost: O(1) to add a group or two sums, and to compute a normal or a cost.

use cranny_exact::{Aabb, DVec3};

use super::face_groups::Item;

/// How a pocket opens.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    pub(super) axis: DVec3,
    /// Right angles: the axis, and two directions around it.
    frame: [DVec3; 3],
    /// Openings cancel: it goes right through along the axis.
    is_through: bool,
    /// A corner of the pocket's box, and one over its longest side.
    origin: DVec3,
    scale: f64,
}

/// A sum of unit vectors, weighted by areas, that is shorter than this part of the summed areas
/// says nothing about a direction. Smaller, and rounding picks the axis of a hole right through;
/// larger, and a nearly symmetrical one takes the axis of its largest lid though it has one of its
/// own.
const MEANINGLESS: f64 = 1.0 / 1024.0;

/// A plane is made to stand along the axis of a hole right through if its normal is within 60
/// degrees of one that does. Larger: more planes that every long peg offends; smaller: planes far
/// from their faces.
const LEAST_UPRIGHT: f64 = 0.5;

pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    // Scaled first, so that squares neither overflow nor vanish.
    (largest > 0.0 && largest.is_finite()).then(|| (v / largest).normalize())
}

impl Opening {
    /// Of a pocket with some openings in a box.
    pub(super) fn of(openings: &[DVec3], bounds: &Aabb) -> Self {
        let sum: DVec3 = openings.iter().sum();
        let total: f64 = openings.iter().map(|o| o.length()).sum();
        let largest = openings
            .iter()
            .copied()
            .reduce(|a, b| if b.length_squared() > a.length_squared() { b } else { a });
        let is_through = openings.len() > 1 && sum.length() <= MEANINGLESS * total;
        let direction = if is_through { largest.and_then(unit) } else { unit(sum) };
        let size = bounds.max - bounds.min;
        let axis = direction.unwrap_or_else(|| DVec3::AXES[size.min_position()]);
        let (across, around) = axis.any_orthonormal_pair();
        let longest = size.max_element();
        let scale = if longest > 0.0 { 1.0 / longest } else { 0.0 };
        Self { axis, frame: [axis, across, around], is_through, origin: bounds.min, scale }
    }

    /// A vector in the frame.
    pub(super) fn turned(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.frame.map(|direction| direction.dot(v)))
    }

    /// From the frame's origin to a point, not turned yet; the longest side of the pocket is the
    /// unit.
    pub(super) fn beside_origin(&self, p: DVec3) -> DVec3 {
        self.scale * (p - self.origin)
    }

    /// Sums of products of coordinates in the frame (xx, yy, zz, xy, yz, zx), from those that were
    /// not turned: xx, yy, zz and xy, yz, zx.
    pub(super) fn turned_products(&self, squares: DVec3, mixed: DVec3) -> [f64; 6] {
        let [u, v, w] = self.frame;
        // The sums are a symmetric matrix.
        let times = |d: DVec3| {
            squares * d
                + DVec3::new(mixed.x, mixed.y, mixed.z) * DVec3::new(d.y, d.z, d.x)
                + DVec3::new(mixed.z, mixed.x, mixed.y) * DVec3::new(d.z, d.x, d.y)
        };
        let [of_u, of_v, of_w] = [u, v, w].map(times);
        [u.dot(of_u), v.dot(of_v), w.dot(of_w), u.dot(of_v), v.dot(of_w), w.dot(of_u)]
    }

    /// What the plane of some faces faces, in the frame: by the sum of their area vectors and that
    /// of their areas.
    fn normal_of(&self, sum: DVec3, total: f64) -> DVec3 {
        // Where normals cancel (around a whole hole) no plane is good; the part is divided anyway.
        let mean = if sum.length() > MEANINGLESS * total { sum.normalize() } else { DVec3::X };
        let upright = DVec3 { x: 0.0, ..mean };
        let stands = self.is_through && upright.length() > LEAST_UPRIGHT;
        if stands { upright.normalize() } else { mean }
    }
}

/// What part of its size adds to a part's thickness: a flat wall is divided too, once thicker parts
/// are thin. Smaller: walls stay whole and one offence opens them all; larger: sides are cut before
/// they are distinguished.
const SPREAD: f64 = 0.125;

/// The thickness of an even layer over its standard deviation: the root of 12.
const EVEN: f64 = 3.464_101_615_137_754_4;

/// Sums over faces: their number, area, area vector, middle, and the products of their corners'
/// coordinates (xx, yy, zz, xy, yz, zx).
#[derive(Clone, Copy)]
pub(super) struct Moments([f64; 14]);

impl Moments {
    pub(super) const NONE: Self = Self([0.0; 14]);

    pub(super) fn of<'a>(items: impl IntoIterator<Item = &'a Item>) -> Self {
        let mut all = Self::NONE;
        items.into_iter().for_each(|item| all.add(item));
        all
    }

    /// Of so many faces, nothing else being known of them.
    pub(super) fn of_count(faces: usize) -> Self {
        let mut sums = Self::NONE;
        sums.0[0] = faces as f64;
        sums
    }

    #[inline]
    pub(super) fn add(&mut self, item: &Item) {
        let ([x, y, z, a, b, c], w, n) = (item.keys, item.area, f64::from(item.count));
        let [xx, yy, zz, xy, yz, zx] = item.products;
        self.sum(&[n, w, w * a, w * b, w * c, n * x, n * y, n * z, xx, yy, zz, xy, yz, zx]);
    }

    fn sum(&mut self, terms: &[f64; 14]) {
        for (sum, term) in self.0.iter_mut().zip(terms) {
            *sum += term;
        }
    }

    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.sum(&other.0);
        self
    }

    /// The number of faces. As a float, which it is summed as: no conversion is as cheap as none.
    pub(super) fn count(&self) -> f64 {
        self.0[0]
    }

    /// The normal of the part's plane: a unit vector, to rounding, in the body's frame.
    pub(super) fn normal(&self, opening: &Opening) -> DVec3 {
        let n = self.turned_normal(opening);
        let [u, v, w] = opening.frame;
        (n.x * u + n.y * v + n.z * w).normalize()
    }

    fn turned_normal(&self, opening: &Opening) -> DVec3 {
        let [_, total, a, b, c, ..] = self.0;
        opening.normal_of(DVec3::new(a, b, c), total)
    }

    /// Number of faces times thickness.
    pub(super) fn cost(&self, opening: &Opening) -> f64 {
        let [count, _, _, _, _, x, y, z, xx, yy, zz, xy, yz, zx] = self.0;
        let n = self.turned_normal(opening);
        let mean = DVec3::new(x, y, z) / count;
        let squares = DVec3::new(xx, yy, zz).dot(n * n)
            + 2.0 * DVec3::new(xy, yz, zx).dot(n * DVec3::new(n.y, n.z, n.x));
        let deep = squares / count - mean.dot(n) * mean.dot(n);
        let wide = (xx + yy + zz) / count - mean.length_squared();
        // Rounding may leave less than nothing of either.
        let thickness = deep.max(0.0).sqrt() + SPREAD * wide.max(0.0).sqrt();
        count * EVEN * thickness
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envelope::face_groups::FaceGroups;
    use cranny_geometry::FaceId;
    use cranny_geometry::FaceTree;
    use cranny_geometry::Mesh;

    #[test]
    fn two_floors_one_above_the_other_by_hand() {
        let floor = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]].map(DVec3::from_array);
        let vertices = [floor(0.0), floor(0.5)].concat();
        let mesh = Mesh::new(vertices, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let opening = Opening::of(&[DVec3::Z * 3.0], &mesh.bounds());
        let mut groups = FaceGroups::default();
        let tree = FaceTree::over(&mesh, &[FaceId(0), FaceId(1)], 1);
        groups.fill(&mesh, &tree, 0, &opening, 1);
        // Corners of a floor vary by 2/9 along x and y, those of both by 1/16 along z.
        for (items, variances) in [
            (&groups.items[..1], [0.0, 4.0 / 9.0]),
            (&groups.items[..], [0.0625, 4.0 / 9.0 + 0.0625]),
        ] {
            let moments = Moments::of(items);
            assert_eq!(moments.count(), items.len() as f64);
            assert!((moments.normal(&opening) - DVec3::Z).length() < 1e-15);
            let [deep, wide] = variances.map(f64::sqrt);
            let cost = items.len() as f64 * 12f64.sqrt() * (deep + 0.125 * wide);
            assert!((moments.cost(&opening) - cost).abs() < 1e-7, "{}", moments.cost(&opening));
        }
    }

    #[test]
    fn planes_stand_in_a_hole_right_through_where_they_can() {
        let bounds = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let through = Opening::of(&[DVec3::Z, -DVec3::Z], &bounds);
        let toward = |n: DVec3| through.normal_of(through.turned(n), n.length());
        let upright = toward(DVec3::new(0.6, 0.0, 0.8));
        assert!((upright - through.turned(DVec3::X)).length() < 1e-15, "{upright}");
        let floor = DVec3::new(0.28, 0.0, 0.96);
        assert!((toward(floor) - through.turned(floor)).length() < 1e-15);
        let well = Opening::of(&[DVec3::Z], &bounds);
        let slanted = DVec3::new(0.6, 0.0, 0.8);
        assert!(
            (well.normal_of(well.turned(slanted), 1.0) - well.turned(slanted)).length() < 1e-15
        );
        // Areas that cancel: the axis.
        assert_eq!(well.normal_of(DVec3::splat(1e-9), 1.0), DVec3::X);
    }
}
