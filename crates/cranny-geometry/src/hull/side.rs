//! On which side of a triangle's plane a point lies: a static filter before the exact predicate.
//!
//! # The filter and its proof
//!
//! With `d = b − a`, `e = c − a`, `f = p − a` the determinant is `Σ ± dᵢ eⱼ fₖ`, six monomials.
//! `(d × e) · f` is computed in the obvious way. Let `u = 2^-53`. Every monomial collects at most
//! eight factors `1 + δ`, `|δ| ≤ u`: three from the differences, one from the product `dᵢ eⱼ`, one
//! from the subtraction in the cross product, one from the product with `fₖ`, two from the sums.
//! Hence (Higham 2002, lemma 3.1) the computed value is off by at most `γ₈ M`,
//! `γ₈ = 8u / (1 − 8u)`, `M` being the sum of the monomials' magnitudes. Now `|fₖ| ≤ wₖ`, the
//! extent of the box that holds all points tested, so with `mₖ = |dᵢ eⱼ| + |dⱼ eᵢ|` the number
//! `M ≤ m · w`, which depends on the triangle alone. Computing `m · w` loses at most nine further
//! factors; [`FILTER`]` = 16 u` covers both with room.
//!
//! Underflow does not enter: inside the [`domain`](cranny_exact::domain) a difference is zero or at
//! least 2^-355 (2^-252 for stored vertices), a component of the cross product zero or at least
//! 2^-557, so no product drops below 2^-912; and none exceeds 2^366.
//!
//! # Source and cost
//!
//! Filters in front of exact predicates are those of Fortune and Van Wyk (1993, "Efficient exact
//! arithmetic for computational geometry") and Shewchuk (1997, "Adaptive precision floating-point
//! arithmetic and fast robust geometric predicates"); the bound above is derived for this use.
//! Cost: O(1), a dot product and a comparison, but near the plane, where the exact predicate is
//! tested.

use cranny_exact::{DVec3, Sign, orient3d};

/// Relative error of the filtered determinant. Smaller, and the proof above fails; larger, and more
/// points go to the exact predicate
/// (`coplanar_and_nearly_coplanar_points_pass_to_the_exact_predicate`).
const FILTER: f64 = 8.0 * f64::EPSILON;

/// The oriented plane of a triangle, prepared for many points of one box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// `(b − a) × (c − a)`, rounded.
    pub(super) normal: DVec3,
    pub(super) anchor: DVec3,
    bound: f64,
}

impl Side {
    /// Prepares the triangle; `extent` is the size of a box that holds it and all points to come.
    pub(super) fn new([a, b, c]: [DVec3; 3], extent: DVec3) -> Self {
        let (d, e) = (b - a, c - a);
        let (da, ea) = (d.abs(), e.abs());
        let magnitudes = DVec3::new(
            da.y * ea.z + da.z * ea.y,
            da.z * ea.x + da.x * ea.z,
            da.x * ea.y + da.y * ea.x,
        );
        Self { normal: d.cross(e), anchor: a, bound: FILTER * magnitudes.dot(extent) }
    }

    /// The [`margin`](Self::margin) of any triangle of a box of size `extent`, at least: the sums
    /// over its monomials are at most the sums over a triangle as large as the box.
    pub(super) fn greatest_margin(extent: DVec3) -> f64 {
        6.0 * FILTER * (extent.x * extent.y * extent.z)
    }

    /// How far above zero `normal · (p − anchor)` can be, in real arithmetic too, for a point `p`
    /// of the box that is not above the exact plane.
    pub(super) fn margin(&self) -> f64 {
        self.bound
    }

    /// The rounded determinant: proportional to the height of `p` above the plane. A heuristic.
    pub(super) fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p - self.anchor)
    }

    /// The exact side of `p`, given its [`height`](Self::height) and the triangle that the plane
    /// was prepared from.
    #[inline]
    pub(super) fn sign(&self, height: f64, p: DVec3, triangle: impl Fn() -> [DVec3; 3]) -> Sign {
        if height < -self.bound {
            Sign::Negative
        } else if height > self.bound {
            Sign::Positive
        } else {
            let [a, b, c] = triangle();
            // The predicate takes longest for zeros, and many facets stand square to an axis.
            let level =
                |axis: usize| a[axis] == p[axis] && b[axis] == p[axis] && c[axis] == p[axis];
            if (0..3).any(level) { Sign::Zero } else { orient3d(a, b, c, p) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coplanar_and_nearly_coplanar_points_pass_to_the_exact_predicate() {
        let triangle =
            [DVec3::new(0.1, 0.1, 0.1), DVec3::new(0.7, 0.2, 0.2), DVec3::new(0.3, 0.9, 0.9)];
        let side = Side::new(triangle, DVec3::ONE);
        let sign = |p: DVec3| side.sign(side.height(p), p, || triangle);
        // All four points have y = z: the determinant vanishes though its f64 value need not.
        assert_eq!(sign(DVec3::new(0.4, 0.4, 0.4)), Sign::Zero);
        let above = sign(DVec3::new(0.4, 0.4, 0.4f64.next_up()));
        assert_eq!(above, sign(DVec3::new(0.4, 0.4, 0.9)));
        assert_eq!(above.flipped(), sign(DVec3::new(0.4, 0.4, 0.4f64.next_down())));
    }

    #[test]
    fn no_triangle_of_a_box_has_more_than_the_greatest_margin() {
        let extent = DVec3::new(3.0, 0.7, 1e-3);
        let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let greatest = Side::greatest_margin(extent);
        for i in 0..512 {
            let triangle = [i & 7, i >> 3 & 7, i >> 6].map(|i| corner(i) * extent);
            assert!(Side::new(triangle, extent).margin() <= greatest * (1.0 + 8.0 * f64::EPSILON));
        }
    }

    #[test]
    fn the_filter_decides_what_is_far_from_the_plane() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let side = Side::new(triangle, DVec3::ONE);
        let undecided = || -> [DVec3; 3] { unreachable!("the filter must decide") };
        assert_eq!(side.sign(side.height(1e-12 * DVec3::Z), DVec3::Z, undecided), Sign::Positive);
        assert_eq!(side.sign(side.height(-1e-12 * DVec3::Z), DVec3::Z, undecided), Sign::Negative);
    }
}
