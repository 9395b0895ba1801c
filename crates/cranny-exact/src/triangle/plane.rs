//! The sides of one plane on which several points lie.

use glam::DVec3;

use crate::sign::{Arithmetic, Sign, orient3d_by};

/// Relative error of the filter: 8 units of rounding (2^-53 each).
///
/// The filter evaluates `(p − a) · ((b − a) × (c − a))` as three products of a difference and a
/// 2 × 2 minor of differences, the expression for which Shewchuk (1997, section 4.3) bounds the
/// error by (7 + 56 u) u times the sum of the absolute products, u = 2^-53. Smaller, and the bound
/// no longer holds; larger, and a few more points go to the adaptive predicate. Nothing underflows
/// inexactly inside the [`domain`](crate::domain).
const FILTER: f64 = 4.0 * f64::EPSILON;

/// The plane through three points, ready to say for many points on which side they lie: the
/// products that the points share are computed once.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    corners: [DVec3; 3],
    normal: DVec3,
    /// Sums of the absolute products that `normal` is the difference of, times [`FILTER`].
    slack: DVec3,
}

impl Plane {
    pub(super) fn through(corners: &[DVec3; 3]) -> Self {
        let [a, b, c] = *corners;
        let (u, v) = (b - a, c - a);
        let left = DVec3::new(u.y * v.z, u.z * v.x, u.x * v.y);
        let right = DVec3::new(u.z * v.y, u.x * v.z, u.y * v.x);
        Self { corners: *corners, normal: left - right, slack: FILTER * (left.abs() + right.abs()) }
    }

    /// The sign of [`orient3d`](crate::orient3d) for the plane's corners and `p`; exact.
    fn side(&self, p: DVec3, by: &mut Arithmetic) -> Sign {
        let d = p - self.corners[0];
        let height = d.dot(self.normal);
        if height.abs() > d.abs().dot(self.slack) {
            return Sign::of(height);
        }
        let [a, b, c] = self.corners;
        orient3d_by(a, b, c, p, by)
    }

    pub(super) fn sides(&self, points: &[DVec3; 3], by: &mut Arithmetic) -> [Sign; 3] {
        points.map(|p| self.side(p, by))
    }
}
