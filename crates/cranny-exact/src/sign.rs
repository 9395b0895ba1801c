//! Determinants that answer only questions of sign.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

/// The sign of a determinant: the only thing that topology may read of it.
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

/// What it took to decide a sign, or all the signs of a question.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Arithmetic {
    /// Floating point, the result being larger than its error can be.
    #[default]
    Filter,
    /// Some sign was too near zero for that.
    Adaptive,
}

/// Relative error of a determinant of four points as [`orient3d`] computes it (Shewchuk 1997,
/// "Adaptive precision floating-point arithmetic and fast robust geometric predicates",
/// `o3derrboundA`; his ε is half of ours). Smaller, and signs may be wrong; larger, and more points
/// take the long way.
const FILTER: f64 = (7.0 + 28.0 * f64::EPSILON) * (0.5 * f64::EPSILON);

/// On which side of the plane through `a`, `b`, `c` the point `d` lies.
///
/// `Positive`: `d` sees the triangle counter-clockwise, that is, lies on the side of the normal
/// `(b − a) × (c − a)`. `Zero`: the four points are co-planar. Exact inside the domain.
#[must_use]
#[inline]
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Sign {
    orient3d_by(a, b, c, d, &mut Arithmetic::Filter)
}

/// [`orient3d`]; raises `by` where the filter does not do.
pub(crate) fn orient3d_by(a: DVec3, b: DVec3, c: DVec3, d: DVec3, by: &mut Arithmetic) -> Sign {
    let [p, q, r] = [a - d, b - d, c - d];
    let (qr, rp, pq) = ([q.x * r.y, r.x * q.y], [r.x * p.y, p.x * r.y], [p.x * q.y, q.x * p.y]);
    // It is negative where `d` is above.
    let det = p.z * (qr[0] - qr[1]) + q.z * (rp[0] - rp[1]) + r.z * (pq[0] - pq[1]);
    let magnitude = |[s, t]: [f64; 2]| s.abs() + t.abs();
    let permanent =
        magnitude(qr) * p.z.abs() + magnitude(rp) * q.z.abs() + magnitude(pq) * r.z.abs();
    if det.abs() > FILTER * permanent {
        return if det > 0.0 { Sign::Negative } else { Sign::Positive };
    }
    *by = Arithmetic::Adaptive;
    orient3d_near([a, b, c, d])
}

/// The same for points that are nearly co-planar.
#[cold]
fn orient3d_near(points: [DVec3; 4]) -> Sign {
    if (0..3).any(|axis| is_level(&points, axis) || stands_in_two_places(&points, axis)) {
        return Sign::Zero;
    }
    let [a, b, c, d] = points.map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    // It has the opposite sign.
    Sign::of(robust::orient3d(a, b, c, d)).flipped()
}

/// Whether four points lie in a plane square to an axis. The predicate takes longest for zeros, and
/// many sides of bodies are square to one, or stand along one.
fn is_level(points: &[DVec3; 4], axis: usize) -> bool {
    points.iter().all(|p| p[axis] == points[0][axis])
}

/// Whether four points are seen in one or two places along an axis: then a plane that stands along
/// it holds them all.
fn stands_in_two_places(points: &[DVec3; 4], axis: usize) -> bool {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let together = |p: &DVec3, q: &DVec3| p[u] == q[u] && p[v] == q[v];
    let [first, others @ ..] = points;
    let mut apart = others.iter().filter(|p| !together(p, first));
    apart.next().is_none_or(|second| apart.all(|p| together(p, second)))
}

/// Whether `a`, `b`, `c` turn left (`Positive`), right (`Negative`) or lie on a line (`Zero`).
/// Exact inside the domain.
#[must_use]
#[inline]
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
        // 0.1 + 0.2 is one ulp above 0.3: the plain f64 determinant does not resolve it.
        let [a, b, c] =
            [DVec3::new(0.1, 0.1, 0.1), DVec3::new(0.7, 0.2, 0.2), DVec3::new(0.3, 0.9, 0.9)];
        let d = DVec3::new(0.4, 0.4, 0.4);
        assert_eq!(orient3d(a, b, c, d), Sign::Zero); // y = z for all four
        let lifted = DVec3::new(0.4, 0.4, 0.4f64.next_up());
        assert_eq!(orient3d(a, b, c, lifted), orient3d(a, b, c, d + DVec3::Z));
        assert_ne!(orient3d(a, b, c, lifted), Sign::Zero);
    }

    #[test]
    fn points_that_stand_along_an_axis_are_coplanar_and_their_neighbours_are_not() {
        // Two uprights of a wall that is square to no axis, whose determinant rounds to something
        // else than 0.
        let (here, there) = ([0.1, 0.7], [0.3, 0.2]);
        let wall = [(here, 0.3), (here, 1.1), (there, 0.9), (there, 0.25)];
        for axis in 0..3 {
            let point = |([u, v], w): ([f64; 2], f64)| {
                let mut p = DVec3::ZERO;
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (w, u, v);
                p
            };
            let [a, b, c, d] = wall.map(point);
            for [p, q, r, s] in [[a, b, c, d], [a, c, b, d], [c, a, d, b], [b, b, a, c]] {
                assert_eq!(orient3d(p, q, r, s), Sign::Zero);
            }
            assert!(stands_in_two_places(&[a, c, d, b], axis));
            for lifted in [[0.3f64.next_up(), 0.2], [0.3, 0.2f64.next_down()]] {
                let off = point((lifted, 0.25));
                assert!(!stands_in_two_places(&[a, b, c, off], axis));
                let far = orient3d(a, b, c, c + (1u64 << 60) as f64 * (off - d));
                assert_eq!(orient3d(a, b, c, off), far);
                assert_ne!(far, Sign::Zero);
            }
        }
    }

    #[test]
    fn left_turns_are_positive() {
        assert_eq!(orient2d(DVec2::ZERO, DVec2::X, DVec2::Y), Sign::Positive);
        assert_eq!(orient2d(DVec2::ZERO, DVec2::X, 2.0 * DVec2::X), Sign::Zero);
    }
}
