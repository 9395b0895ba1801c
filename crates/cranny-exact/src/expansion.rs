//! Sums of products, exact: floating-point expansions (Shewchuk 1997, sections 2.2 to 2.5).

use crate::sign::Sign;

/// 2^27 + 1 splits the 53 bits of an `f64` into two halves whose products are exact (Dekker 1971).
const SPLITTER: f64 = 134_217_729.0;

/// An exact real number: the sum of its terms, which do not overlap and grow in magnitude.
///
/// Exact as long as no product overflows or underflows, which the [`domain`](crate::domain)
/// guarantees for products of three coordinates and of factors up to 2^32.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    terms: Vec<f64>,
}

impl Expansion {
    /// Adds the product of some numbers. Cost: 2^(factors − 1) additions, each linear in the terms.
    pub(crate) fn add_product(&mut self, factors: &[f64]) {
        let mut products = vec![1.0];
        for &factor in factors {
            products = products
                .into_iter()
                .flat_map(|x| two_product(x, factor))
                .filter(|&x| x != 0.0)
                .collect();
        }
        for x in products {
            self.add(x);
        }
    }

    /// Adds a number: Shewchuk's GROW-EXPANSION, zeros left out.
    fn add(&mut self, x: f64) {
        let mut carry = x;
        let mut kept = 0;
        for i in 0..self.terms.len() {
            let [sum, rest] = two_sum(carry, self.terms[i]);
            carry = sum;
            if rest != 0.0 {
                self.terms[kept] = rest;
                kept += 1;
            }
        }
        self.terms.truncate(kept);
        if carry != 0.0 {
            self.terms.push(carry);
        }
    }

    /// The sign of the sum: that of its largest term, which outweighs all others.
    pub(crate) fn sign(&self) -> Sign {
        Sign::of(self.terms.last().copied().unwrap_or(0.0))
    }
}

/// The rounded sum and its rounding error (Knuth 1969).
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    let of_a = sum - of_b;
    [sum, (a - of_a) + (b - of_b)]
}

/// The rounded product and its rounding error (Dekker 1971).
fn two_product(a: f64, b: f64) -> [f64; 2] {
    let product = a * b;
    let ([a_high, a_low], [b_high, b_low]) = (split(a), split(b));
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    [product, error]
}

fn split(a: f64) -> [f64; 2] {
    let c = SPLITTER * a;
    let high = c - (c - a);
    [high, a - high]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(products: &[&[f64]]) -> Expansion {
        let mut sum = Expansion::default();
        products.iter().for_each(|factors| sum.add_product(factors));
        sum
    }

    #[test]
    fn what_plain_arithmetic_loses_is_kept() {
        assert_eq!(sum(&[&[1e30], &[1e-30], &[-1e30]]).sign(), Sign::Positive);
        assert_eq!(sum(&[&[1e30], &[-1e-30], &[-1e30], &[1e-30]]).sign(), Sign::Zero);
        assert_eq!(sum(&[]).sign(), Sign::Zero);
        // (1 + ulp)^3 = 1 + 3 ulp + 3 ulp² + ulp³.
        let (x, ulp) = (1.0 + f64::EPSILON, f64::EPSILON);
        let expanded: [&[f64]; 5] =
            [&[x, x, x], &[-1.0], &[-3.0, ulp], &[-3.0, ulp, ulp], &[-1.0, ulp, ulp, ulp]];
        assert_eq!(sum(&expanded).sign(), Sign::Zero);
        assert_eq!(sum(&expanded[..4]).sign(), Sign::Positive);
        assert_eq!(sum(&expanded[..3]).sign(), Sign::Positive);
    }

    #[test]
    fn terms_do_not_overlap_and_grow() {
        let mut terms = Expansion::default();
        let mut x = 0.1f64;
        for k in 0..200 {
            x = (x * 997.0 + 0.3).fract() - 0.5;
            terms.add_product(&[x, 1e3 * x + f64::from(k), x - 0.25]);
            for pair in terms.terms.windows(2) {
                assert!(pair[0] != 0.0 && pair[1] + pair[0] == pair[1], "{pair:?}");
            }
        }
        assert!(terms.terms.len() > 2, "{}", terms.terms.len());
    }
}
