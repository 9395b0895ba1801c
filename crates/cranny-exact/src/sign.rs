//! Determinants that answer only questions of sign.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// The sign of a determinant: the only thing that topology may ask of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(i8)]
pub enum Sign {
    /// Below zero.
    Negative = -1,
    /// Exactly zero.
    Zero = 0,
    /// Above zero.
    Positive = 1,
}

impl Sign {
    /// The sign of a finite number; `NaN` counts as zero and cannot arise inside the domain.
    #[must_use]
    pub fn of(value: f64) -> Self {
        if value > 0.0 {
            Self::Positive
        } else if value < 0.0 {
            Self::Negative
        } else {
            Self::Zero
        }
    }

    /// The opposite sign.
    #[must_use]
    pub fn flipped(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }

    /// −1, 0 or 1.
    #[must_use]
    pub fn as_i8(self) -> i8 {
        self as i8
    }

    /// Whether the determinant vanishes.
    #[must_use]
    pub fn is_zero(self) -> bool {
        self == Self::Zero
    }
}

/// On which side of the plane through `a`, `b`, `c` the point `d` lies.
///
/// `Positive`: `d` sees the triangle counter-clockwise, that is, lies on the side of the normal
/// `(b − a) × (c − a)`. `Zero`: the four points are co-planar. Exact inside the domain.
///
/// (`robust::orient3d` has the opposite sign; this function hides that.)
#[must_use]
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Sign {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    Sign::of(robust::orient3d(coord(a), coord(b), coord(c), coord(d))).flipped()
}

/// Whether `a`, `b`, `c` turn left (`Positive`), right (`Negative`) or lie on a line (`Zero`).
/// Exact inside the domain.
#[must_use]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Sign {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    Sign::of(robust::orient2d(coord(a), coord(b), coord(c)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn above_a_counter_clockwise_triangle_is_positive() {
        let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(orient3d(a, b, c, DVec3::Z), Sign::Positive);
        assert_eq!(orient3d(a, b, c, -DVec3::Z), Sign::Negative);
        assert_eq!(orient3d(a, c, b, DVec3::Z), Sign::Negative);
    }

    #[test]
    fn a_rounded_coplanar_point_is_told_from_a_coplanar_one() {
        // 0.1 + 0.2 is one ulp above 0.3: the plain f64 determinant cannot tell.
        let [a, b, c] =
            [DVec3::new(0.1, 0.1, 0.1), DVec3::new(0.7, 0.2, 0.2), DVec3::new(0.3, 0.9, 0.9)];
        let d = DVec3::new(0.4, 0.4, 0.4);
        assert_eq!(orient3d(a, b, c, d), Sign::Zero); // y = z for all four
        let lifted = DVec3::new(0.4, 0.4, 0.4f64.next_up());
        assert_eq!(orient3d(a, b, c, lifted), orient3d(a, b, c, d + DVec3::Z));
        assert_ne!(orient3d(a, b, c, lifted), Sign::Zero);
    }

    #[test]
    fn left_turns_are_positive() {
        assert_eq!(orient2d(DVec2::ZERO, DVec2::X, DVec2::Y), Sign::Positive);
        assert_eq!(orient2d(DVec2::ZERO, DVec2::X, 2.0 * DVec2::X), Sign::Zero);
    }
}
