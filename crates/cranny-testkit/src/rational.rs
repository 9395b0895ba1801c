//! Points and vectors with exact rational coordinates.

use std::ops::{Add, Mul, Sub};

use dashu_ratio::RBig;
use glam::DVec3;

/// An exact rational number.
pub type Q = RBig;

/// A point or a vector in space with exact rational coordinates.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Q3 {
    /// Coordinates x, y, z.
    pub xyz: [Q; 3],
}

impl Q3 {
    /// The same point: every finite `f64` is a rational number.
    ///
    /// # Panics
    ///
    /// Where a coordinate is infinite or `NaN`: an oracle cannot judge it.
    #[must_use]
    pub fn exactly(p: DVec3) -> Self {
        let exact = |x: f64| Q::try_from(x).unwrap_or_else(|_| panic!("{x} is not a number"));
        Self { xyz: p.to_array().map(exact) }
    }

    /// Inner product.
    #[must_use]
    pub fn dot(&self, other: &Self) -> Q {
        let ([a, b, c], [d, e, f]) = (&self.xyz, &other.xyz);
        a * d + b * e + c * f
    }

    /// Outer product.
    #[must_use]
    pub fn cross(&self, other: &Self) -> Self {
        let ([a, b, c], [d, e, f]) = (&self.xyz, &other.xyz);
        Self { xyz: [b * f - c * e, c * d - a * f, a * e - b * d] }
    }

    /// Whether all coordinates are zero.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.xyz.iter().all(Q::is_zero)
    }

    /// The point `self + t · (other − self)`.
    #[must_use]
    pub fn towards(&self, other: &Self, t: &Q) -> Self {
        self + &(&(other - self) * t)
    }

    /// The weighted mean of some points; weights are positive.
    ///
    /// # Panics
    ///
    /// Where there is no point.
    #[must_use]
    pub fn mean(weighted: &[(Q, &Self)]) -> Self {
        let total = weighted.iter().fold(Q::ZERO, |sum, (w, _)| sum + w);
        let sum = weighted.iter().fold(Self::exactly(DVec3::ZERO), |sum, (w, p)| &sum + &(*p * w));
        &sum * &(Q::ONE / total)
    }
}

impl Add for &Q3 {
    type Output = Q3;

    fn add(self, other: Self) -> Q3 {
        let ([a, b, c], [d, e, f]) = (&self.xyz, &other.xyz);
        Q3 { xyz: [a + d, b + e, c + f] }
    }
}

impl Sub for &Q3 {
    type Output = Q3;

    fn sub(self, other: Self) -> Q3 {
        let ([a, b, c], [d, e, f]) = (&self.xyz, &other.xyz);
        Q3 { xyz: [a - d, b - e, c - f] }
    }
}

impl Mul<&Q> for &Q3 {
    type Output = Q3;

    fn mul(self, factor: &Q) -> Q3 {
        let [a, b, c] = &self.xyz;
        Q3 { xyz: [a * factor, b * factor, c * factor] }
    }
}
