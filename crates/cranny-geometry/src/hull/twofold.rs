//! The side of a plane on which a point lies, in twice the digits: a second filter before the exact
//! predicate, for what is flat but for rounding. Sides of subdivided bodies are, all along their
//! diagonals.
//!
//! # The filter and its proof
//!
//! A number is a pair of `f64`, the second of which is what the first one lacks. Let `u = 2^-53`.
//!
//! - Differences of coordinates are exact ([`Pair::difference`]; Knuth's two-sum).
//! - A product loses the product of the second parts, at most `u² |x y|`, and what rounding takes
//!   from three terms of at most `2 u |x y|` in all and from their sums: together less than
//!   `8 u² |x y|`.
//! - A sum loses what rounding takes from the second parts, of at most `u (|x| + |y|)` each, and
//!   from their sums: less than `4 u² (|x| + |y|)`.
//!
//! The determinant is a sum of three products `fₖ (dᵢ eⱼ − dⱼ eᵢ)`. A monomial goes through two
//! products and three sums, so less than `(2 · 8 + 3 · 4 + 1) u² M` is lost, `M` being the sum of
//! the monomials' magnitudes and the last `u²` all that is of higher order. `M` is at most
//! [`Side::margin`] by `16 u` ([`super::side`]), so [`SHARE`]` = 4 u` times the margin is
//! `64 u² M`, which leaves room for the rounding of the bound.
//!
//! Products are taken apart after Dekker (1971, "A floating-point technique for extending the
//! available precision"). Inside the [`domain`](cranny_exact::domain) none overflows; and none
//! underflows, for coordinates are multiples of 2^-252 and products of three of 2^-756.
//!
//! Cost: O(1), nine differences, nine products and five sums of pairs.

use cranny_exact::{DVec3, Sign};

use super::side::Side;

/// Of the first filter's margin. Smaller, and the proof above fails; larger, and more goes to the
/// exact predicate.
const SHARE: f64 = 2.0 * f64::EPSILON;

/// The unevaluated sum of two numbers.
#[derive(Clone, Copy, Debug)]
struct Pair {
    high: f64,
    low: f64,
}

impl Pair {
    /// `x + y`, exactly (Knuth).
    fn sum(x: f64, y: f64) -> Self {
        let high = x + y;
        let of_y = high - x;
        let of_x = high - of_y;
        Self { high, low: (x - of_x) + (y - of_y) }
    }

    /// The same where `x` is no smaller than `y` (Dekker).
    fn quick_sum(x: f64, y: f64) -> Self {
        let high = x + y;
        Self { high, low: y - (high - x) }
    }

    /// `x − y`, exactly.
    fn difference(x: f64, y: f64) -> Self {
        Self::sum(x, -y)
    }

    fn plus(self, other: Self) -> Self {
        let Self { high, low } = Self::sum(self.high, other.high);
        // Not the quick one: where the sum cancels, what is added may be more than is left.
        Self::sum(high, low + (self.low + other.low))
    }

    fn minus(self, other: Self) -> Self {
        self.plus(Self { high: -other.high, low: -other.low })
    }

    fn times(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (halves(self.high), halves(other.high));
        let high = self.high * other.high;
        // Exact (Dekker).
        let low = b * d - (((high - a * c) - b * c) - a * d);
        Self::quick_sum(high, low + (self.high * other.low + self.low * other.high))
    }
}

/// A number as two of at most 26 digits (Veltkamp).
fn halves(x: f64) -> [f64; 2] {
    const FACTOR: f64 = ((1u64 << 27) + 1) as f64;
    let far = FACTOR * x;
    let high = far - (far - x);
    [high, x - high]
}

/// The side of the plane of a triangle on which a point lies, if twice the digits decide it; `side`
/// is prepared from the triangle, for a box that holds the point.
pub(super) fn sign(side: &Side, [a, b, c]: [DVec3; 3], p: DVec3) -> Option<Sign> {
    let from_a = |q: DVec3| [0, 1, 2].map(|i| Pair::difference(q[i], a[i]));
    let [d, e, f] = [b, c, p].map(from_a);
    let term = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        f[i].times(d[j].times(e[k]).minus(d[k].times(e[j])))
    };
    let height = term(0).plus(term(1)).plus(term(2)).high;
    let bound = SHARE * side.margin();
    if height < -bound {
        Some(Sign::Negative)
    } else if height > bound {
        Some(Sign::Positive)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use cranny_exact::orient3d;
    use cranny_testkit::Rng;

    use super::*;

    fn filtered_sign(triangle: [DVec3; 3], p: DVec3) -> Option<Sign> {
        let bounds = cranny_exact::Aabb::of_points(triangle.into_iter().chain([p]));
        sign(&Side::new(triangle, bounds.max - bounds.min), triangle, p)
    }

    #[test]
    fn what_is_decided_is_exact() {
        let mut rng = Rng::new(17);
        let (mut decided, mut left) = (0, 0);
        for _ in 0..20_000 {
            let mut point = || 0.5 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let triangle @ [a, b, c] = [point(), point(), point()];
            let [s, t] = [rng.unit(), rng.unit()];
            // Within a few digits of the plane, and of late ones of the coordinates.
            let step = 2.0 * rng.unit() * f64::EPSILON;
            let p = a + s * (b - a) + t * (c - a) + step * DVec3::Z;
            let exact = orient3d(a, b, c, p);
            match filtered_sign(triangle, p) {
                Some(sign) => {
                    assert_eq!(sign, exact, "{triangle:?}, {p}");
                    decided += 1;
                }
                None => left += 1,
            }
        }
        // What rounding puts beside a plane is seen there; half as many digits see next to none of
        // it.
        assert!(decided > 100 * left, "{decided} of {left}");
    }

    #[test]
    fn flat_is_left_to_the_exact_predicate() {
        let triangle =
            [DVec3::new(0.1, 0.1, 0.1), DVec3::new(0.7, 0.2, 0.2), DVec3::new(0.3, 0.9, 0.9)];
        // All have y = z.
        assert_eq!(filtered_sign(triangle, DVec3::splat(0.4)), None);
        let above = filtered_sign(triangle, DVec3::new(0.4, 0.4, 0.4f64.next_up()));
        assert_eq!(above, Some(orient3d(triangle[0], triangle[1], triangle[2], DVec3::Z)));
        let below = filtered_sign(triangle, DVec3::new(0.4, 0.4, 0.4f64.next_down()));
        assert_eq!(below.map(Sign::flipped), above);
    }

    #[test]
    fn products_and_sums_of_pairs_keep_twice_the_digits() {
        let third = Pair::sum(1.0 / 3.0, 1.0 / 3.0f64.powi(36));
        let square = third.times(third);
        // (x + y)² = x² + 2xy + y², the first of which is exact in two parts.
        let [x, y] = [third.high, third.low];
        let [h, l] = halves(x);
        assert_eq!(h + l, x);
        let exact = Pair { high: x * x, low: ((h * h - x * x) + 2.0 * h * l) + l * l };
        let whole = exact.plus(Pair::sum(2.0 * x * y, 0.0)).plus(Pair::sum(y * y, 0.0));
        let lost = square.minus(whole);
        assert!((lost.high / square.high).abs() < f64::EPSILON * f64::EPSILON, "{lost:?}");
        let none = third.minus(third);
        assert_eq!((none.high, none.low), (0.0, 0.0));
    }
}
