//! The grid that all coordinates of a mesh lie on, whatever its unit.
//!
//! A mesh written with few decimals, or quantised to integers, shows it by its digits. Once it is
//! scaled (from millimetres to metres, from inches, by a power of two) the digits are gone, but
//! coordinates are still whole multiples of one step. Euclid's algorithm finds it: the quotients of
//! two coordinates, as a continued fraction, end where the step divides both. In floating point the
//! fraction is known to end when a remainder is far below any step that is looked for; as the
//! numerator and denominator of the fraction are whole numbers, the step is then known to a
//! rounding, however many quotients it took. One division a coordinate; a mesh without a grid is
//! known by its first few.
//!
//! Source: Knuth (1969, section 4.5.3) for Euclid's algorithm and continued fractions. Cost: O(n),
//! a division a number, and for one that refines the step as many more as Euclid's algorithm takes.

/// Steps looked for are no smaller than this share of the largest coordinate. Smaller, and errors
/// of rounding, which grow with the square of the count of steps, come near the step; larger, and
/// grids that are coarser than single precision stay unseen.
const LEAST_SHARE: f64 = 1e-7;

/// What is left of a division that comes out even is at most this share of the least step: numbers
/// of `n` steps leave up to `n` roundings of the largest, a hundredth of the step for the finest
/// grid. Larger, and numbers without a grid seem to have one by chance.
const EVEN: f64 = 0.02;

/// The largest step of which all numbers, none of which is 0, are multiples up to rounding;
/// `largest` is the greatest magnitude among them.
pub(crate) fn common_step(numbers: impl Iterator<Item = f64>, largest: f64) -> Option<f64> {
    let least = LEAST_SHARE * largest;
    let mut step = None;
    for x in numbers.map(f64::abs) {
        let known = step.unwrap_or(x);
        let refined = known / denominator(x, known, least)?;
        if refined < least {
            return None;
        }
        step = Some(refined);
    }
    step
}

/// The denominator of `x / step` as a fraction of whole numbers: how many parts `step` has to be
/// divided into to measure `x` as well. Nothing where such a part would be smaller than `least`.
fn denominator(x: f64, step: f64, least: f64) -> Option<f64> {
    let (mut dividend, mut divisor) = (x, step);
    let (mut before, mut now) = (1.0, 0.0);
    loop {
        let quotient = (dividend / divisor).round();
        (before, now) = (now, quotient * now + before);
        let rest = dividend - quotient * divisor;
        if rest.abs() < EVEN * least {
            return Some(f64::abs(now));
        }
        if rest.abs() < least {
            return None;
        }
        // At most half as large each time: it ends.
        (dividend, divisor) = (divisor, rest);
    }
}

#[cfg(test)]
mod tests {
    use cranny_testkit::Rng;

    use super::*;

    fn step(numbers: &[f64]) -> Option<f64> {
        let largest = numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        common_step(numbers.iter().copied(), largest)
    }

    #[test]
    fn a_grid_is_found_in_any_unit() {
        let mut rng = Rng::new(3);
        for round in 0..400 {
            let reach = [3, 200, 50_000, 4_000_000][round % 4];
            let mut counts: Vec<i32> = (0..40).map(|_| rng.between(1, reach)).collect();
            // Without a common divisor; the most that is looked for.
            counts.extend([reach, reach - 1]);
            for unit in [1.0, 1e-3, 0.0254, 1.0 / 3.0, 2f64.powi(-40), 1e9, 7.3e-200] {
                let numbers: Vec<f64> = counts.iter().map(|&k| f64::from(k) * unit).collect();
                let found = step(&numbers).unwrap();
                assert!((found / unit - 1.0).abs() < 1e-12, "{found:e} of {unit:e}");
            }
        }
    }

    #[test]
    fn numbers_without_a_grid_have_none() {
        let mut rng = Rng::new(4);
        for _ in 0..1_000 {
            let numbers: Vec<f64> = (0..8).map(|_| 1.0 + rng.unit()).collect();
            assert_eq!(step(&numbers), None, "{numbers:?}");
        }
        assert_eq!(step(&[]), None);
    }

    #[test]
    fn one_number_is_its_own_step() {
        assert_eq!(step(&[0.3]), Some(0.3));
        assert_eq!(step(&[0.5, -0.5, 0.125]), Some(0.125));
    }
}
