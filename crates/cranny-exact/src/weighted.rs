//! A point that need not be representable: the weighted mean of three others.

use glam::DVec3;

use crate::expansion::Expansion;
use crate::sign::{Sign, orient3d};

/// A weighted mean of three points. It is never rounded: predicates read the mean itself, so a
/// point inside a triangle lies exactly in the triangle's plane, whatever its coordinates.
///
/// ```
/// use cranny_exact::{DVec3, Sign, WeightedPoint};
/// let t = [DVec3::new(0.1, 0.7, 0.3), DVec3::new(0.9, 0.2, 0.6), DVec3::new(0.3, 0.4, 0.8)];
/// let third = WeightedPoint::new(t, [1, 1, 1]);
/// assert_eq!(third.side_of(t[0], t[1], t[2]), Sign::Zero);
/// assert_eq!(third.side_of(t[0], t[1], t[2] - DVec3::Z), WeightedPoint::at(t[2]).side_of(t[0], t[1], t[2] - DVec3::Z));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedPoint {
    points: [DVec3; 3],
    weights: [u32; 3],
}

impl WeightedPoint {
    /// The mean of points inside the [`domain`](crate::domain).
    ///
    /// # Panics
    ///
    /// Where all weights are zero.
    #[must_use]
    pub fn new(points: [DVec3; 3], weights: [u32; 3]) -> Self {
        assert!(weights != [0; 3], "the mean of nothing");
        Self { points, weights }
    }

    /// A point as it is.
    #[must_use]
    pub fn at(p: DVec3) -> Self {
        Self { points: [p; 3], weights: [1, 0, 0] }
    }

    /// The nearest `f64` coordinates, to within [`rounding`](Self::rounding).
    #[must_use]
    pub fn rounded(&self) -> DVec3 {
        if self.weights == [1, 0, 0] {
            return self.points[0];
        }
        let weights = self.weights.map(f64::from);
        let total: f64 = weights.iter().sum();
        self.points.iter().zip(weights).map(|(&p, w)| p * (w / total)).sum()
    }

    /// An upper bound of the distance between [`rounded`](Self::rounded) and the mean itself.
    ///
    /// A coordinate takes three quotients, three products and two sums of numbers no larger than
    /// the largest coordinate, half an ulp each; three coordinates.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        let largest = self.points.iter().fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        8.0 * f64::EPSILON * largest
    }

    /// [`orient3d`]`(a, b, c, self)`: on which side of a plane the mean lies. Exact.
    ///
    /// The volume that `orient3d` is the sign of is affine in its last point, so that of the mean
    /// is the mean of the volumes of the points. Where these do not all have one sign (rare), they
    /// are summed without rounding, which takes some ten microseconds.
    #[must_use]
    pub fn side_of(&self, a: DVec3, b: DVec3, c: DVec3) -> Sign {
        let of = |i: usize| match self.weights[i] {
            0 => Sign::Zero,
            _ => orient3d(a, b, c, self.points[i]),
        };
        let sides = [of(0), of(1), of(2)];
        match (sides.contains(&Sign::Positive), sides.contains(&Sign::Negative)) {
            (true, true) => self.weighted_volume(a, b, c),
            (true, false) => Sign::Positive,
            (false, true) => Sign::Negative,
            (false, false) => Sign::Zero,
        }
    }

    /// The sign of the sum of weights times volumes.
    fn weighted_volume(&self, a: DVec3, b: DVec3, c: DVec3) -> Sign {
        let mut sum = Expansion::default();
        for (d, w) in self.points.into_iter().zip(self.weights.map(f64::from)) {
            // (b − a) × (c − a) · (d − a), multiplied out: differences round, products do not.
            add_determinant(&mut sum, w, [b, c, d]);
            add_determinant(&mut sum, -w, [a, c, d]);
            add_determinant(&mut sum, w, [a, b, d]);
            add_determinant(&mut sum, -w, [a, b, c]);
        }
        sum.sign()
    }
}

/// Adds `weight · x · (y × z)`.
fn add_determinant(sum: &mut Expansion, weight: f64, [x, y, z]: [DVec3; 3]) {
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        sum.add_product(&[x[i], y[j], z[k], weight]);
        sum.add_product(&[x[i], y[k], z[j], -weight]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn side(points: [DVec3; 3], weights: [u32; 3]) -> Sign {
        WeightedPoint::new(points, weights).side_of(FLOOR[0], FLOOR[1], FLOOR[2])
    }

    #[test]
    fn weights_decide_between_points_on_both_sides() {
        let points = [DVec3::Z, DVec3::new(5.0, 1.0, -1.0), DVec3::new(0.0, 9.0, -2.0)];
        assert_eq!(side(points, [1, 0, 0]), Sign::Positive);
        assert_eq!(side(points, [0, 1, 0]), Sign::Negative);
        assert_eq!(side(points, [1, 1, 0]), Sign::Zero);
        assert_eq!(side(points, [4, 1, 1]), Sign::Positive);
        assert_eq!(side(points, [3, 1, 1]), Sign::Zero);
        assert_eq!(side(points, [2, 1, 1]), Sign::Negative);
    }

    #[test]
    fn a_mean_that_no_f64_holds_is_told_from_its_neighbours() {
        // The mean of z = 1/10 twice and −(1/5 ± an ulp) is ± a third of an ulp.
        let at = |z: f64| DVec3::new(0.3, 0.7, z);
        let fifth = 2.0 * 0.1;
        assert_eq!(side([at(0.1), at(0.1), at(-fifth)], [1, 1, 1]), Sign::Zero);
        assert_eq!(side([at(0.1), at(0.1), at(-fifth.next_up())], [1, 1, 1]), Sign::Negative);
        assert_eq!(side([at(0.1), at(0.1), at(-fifth.next_down())], [1, 1, 1]), Sign::Positive);
    }

    #[test]
    fn the_sum_of_volumes_is_the_volume() {
        // Corner volumes by the expansion agree with the predicate, also far from the origin.
        let far = DVec3::new(1e6, -3e5, 0.1);
        let [a, b, c] = FLOOR.map(|p| p + far);
        for d in
            [DVec3::new(0.3, 0.4, 1e-9), DVec3::new(7.0, -0.2, -1e-9), DVec3::new(0.1, 0.2, 0.0)]
        {
            let d = d + far;
            let single = WeightedPoint::new([d, d, d], [1, 5, 2]);
            assert_eq!(single.weighted_volume(a, b, c), orient3d(a, b, c, d));
            assert_eq!(single.weighted_volume(a, c, b), orient3d(a, c, b, d));
        }
    }

    #[test]
    fn rounding_is_bounded() {
        let points = [DVec3::splat(0.1), DVec3::splat(0.7), DVec3::splat(-0.3)];
        let mean = WeightedPoint::new(points, [1, 1, 1]);
        assert!((mean.rounded() - DVec3::splat(0.5 / 3.0)).length() <= mean.rounding());
        assert_eq!(WeightedPoint::at(points[1]).rounded(), points[1]);
    }
}
