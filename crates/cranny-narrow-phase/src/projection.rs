//! Seeing a plane along a coordinate axis: turns in the plane by exact signs.

use cranny_exact::{DVec2, DVec3, Sign, orient2d};

/// Drops one coordinate such that a triangle keeps an area: of points in its plane, turns seen so
/// are turns in the plane, up to one common sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Projection {
    axis: usize,
}

impl Projection {
    /// For the plane of a triangle; `None` where its corners lie on one line. Exact: a needle's
    /// computed normal may name an axis along which the needle is seen edge on.
    pub(crate) fn of(triangle: &[DVec3; 3]) -> Option<Self> {
        let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
        let best = normal.abs().max_position();
        (0..3).map(|k| Self { axis: (best + k) % 3 }).find(|seen| !seen.turn(triangle).is_zero())
    }

    pub(crate) fn apply(self, p: DVec3) -> DVec2 {
        match self.axis {
            0 => DVec2::new(p.y, p.z),
            1 => DVec2::new(p.z, p.x),
            _ => DVec2::new(p.x, p.y),
        }
    }

    /// Whether three points are seen to turn left, right or not at all.
    pub(crate) fn turn(self, points: &[DVec3; 3]) -> Sign {
        let [a, b, c] = points.map(|p| self.apply(p));
        orient2d(a, b, c)
    }

    /// The triangle as seen, its corners in the order that turns left.
    pub(crate) fn counter_clockwise(self, triangle: &[DVec3; 3]) -> [DVec2; 3] {
        let [a, b, c] = triangle.map(|p| self.apply(p));
        if orient2d(a, b, c) == Sign::Negative { [a, c, b] } else { [a, b, c] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_along_which_the_triangle_has_an_area_is_found() {
        let wall = [DVec3::ZERO, DVec3::Y, DVec3::Z];
        let seen = Projection::of(&wall).unwrap();
        assert_eq!((seen.axis, seen.turn(&wall)), (0, Sign::Positive));
        assert_eq!(seen.turn(&[wall[0], wall[2], wall[1]]), Sign::Negative);
        assert_eq!(
            seen.counter_clockwise(&wall),
            seen.counter_clockwise(&[wall[0], wall[2], wall[1]])
        );
        assert_eq!(Projection::of(&[DVec3::ONE, DVec3::ONE, DVec3::X]), None);
        assert_eq!(Projection::of(&[DVec3::ZERO, DVec3::ONE, 2.0 * DVec3::ONE]), None);
    }

    #[test]
    fn a_needle_whose_computed_normal_is_noise_keeps_its_area() {
        // In the plane y = x, so seen along z it has none; the computed normal is all but zero.
        let far = |t: f64, z: f64| DVec3::new(t, t, z);
        let needle = [far(0.1, 0.3), far(0.7, 0.9), far(0.4, 0.6f64.next_up())];
        let seen = Projection::of(&needle).unwrap();
        assert!(!seen.turn(&needle).is_zero());
        assert_ne!(seen.axis, 2);
    }
}
