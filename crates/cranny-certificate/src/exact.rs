//! Exact points: every finite `f64` is a whole number of steps of some grid of powers of two.

use std::cmp::Ordering;

use dashu_int::IBig;
use dashu_ratio::RBig;

/// A vector with whole coordinates.
pub(crate) type Vector = [IBig; 3];

/// A power of two that divides all coordinates of a problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// The step is two to this power.
    exponent: i32,
}

/// `x = mantissa * 2^exponent`, the mantissa odd or zero.
fn split(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mantissa, exponent) = match (bits >> 52 & 0x7ff) as i32 {
        0 => (fraction, -1074),
        biased => (fraction | 1 << 52, biased - 1075),
    };
    let signed = if x.is_sign_negative() { -mantissa } else { mantissa };
    match mantissa.trailing_zeros() {
        64 => (0, 0),
        zeros => (signed >> zeros, exponent + zeros as i32),
    }
}

impl Grid {
    /// The coarsest grid that holds all of some finite numbers.
    pub(crate) fn of(numbers: impl Iterator<Item = f64>) -> Self {
        let exponents = numbers.filter(|&x| x != 0.0).map(|x| split(x).1);
        Self { exponent: exponents.min().unwrap_or(0) }
    }

    /// A number that the grid was made of, in steps.
    pub(crate) fn whole(self, x: f64) -> IBig {
        let (mantissa, exponent) = split(x);
        IBig::from(mantissa) << exponent.saturating_sub(self.exponent).max(0) as usize
    }

    pub(crate) fn vector(self, p: [f64; 3]) -> Vector {
        p.map(|x| self.whole(x))
    }
}

pub(crate) fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

pub(crate) fn dot(a: &Vector, b: &Vector) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    let [[ax, ay, az], [bx, by, bz]] = [a, b];
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

pub(crate) fn is_zero(a: &Vector) -> bool {
    a.iter().all(|x| sign(x).is_eq())
}

pub(crate) fn sign(x: &IBig) -> Ordering {
    x.cmp(&IBig::ZERO)
}

pub(crate) fn times(a: &Vector, factor: &IBig) -> Vector {
    std::array::from_fn(|i| &a[i] * factor)
}

/// Outer product of two sides: along the normal of a triangle, and as long as twice its area.
pub(crate) fn normal([a, b, c]: &[Vector; 3]) -> Vector {
    cross(&minus(b, a), &minus(c, a))
}

/// A point with rational coordinates: whole ones over a positive denominator.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) over: IBig,
    pub(crate) xyz: Vector,
}

impl Point {
    pub(crate) fn at(corner: &Vector) -> Self {
        Self { over: IBig::ONE, xyz: corner.clone() }
    }

    /// From exact coordinates in steps of the grid.
    pub(crate) fn rational(p: &[RBig; 3]) -> Self {
        let [x, y, z] = p.each_ref().map(|q| IBig::from(q.denominator().clone()));
        let over = &x * &y * &z;
        let xyz = p.each_ref().map(|q| q.numerator() * &over / IBig::from(q.denominator().clone()));
        Self { over, xyz }
    }

    /// The way from a corner to the point, times the denominator.
    pub(crate) fn from(&self, corner: &Vector) -> Vector {
        std::array::from_fn(|i| &self.xyz[i] - &corner[i] * &self.over)
    }

    /// How the point's coordinate compares with that of a corner.
    pub(crate) fn compare(&self, axis: usize, coordinate: &IBig) -> Ordering {
        self.xyz[axis].cmp(&(coordinate * &self.over))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_whole_on_their_grid() {
        let grid = Grid::of([0.75, -6.0, 0.0, 5e-324].into_iter());
        assert_eq!(grid.whole(5e-324), IBig::ONE);
        assert_eq!(grid.whole(-6.0), -(grid.whole(0.75) * IBig::from(8)));
        assert_eq!(grid.whole(-0.0), IBig::ZERO);
        let coarse = Grid::of([0.75, -6.0].into_iter());
        assert_eq!((coarse.whole(0.75), coarse.whole(-6.0)), (IBig::from(3), IBig::from(-24)));
    }

    #[test]
    fn rational_points_keep_their_place() {
        let third = RBig::from_parts(IBig::from(-1), 3u8.into());
        let half = RBig::from_parts(IBig::from(1), 2u8.into());
        let p = Point::rational(&[third, half, RBig::ZERO]);
        let scaled: Vec<IBig> = p.xyz.iter().map(|x| x * IBig::from(6)).collect();
        let expected = [-2, 3, 0].map(|k| IBig::from(k) * &p.over);
        assert_eq!(scaled, expected);
    }
}
