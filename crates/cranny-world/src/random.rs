//! Reproducible random numbers.

use cranny_exact::{DQuat, DVec3};

/// SplitMix64 (Steele, Lea and Flood 2014, 'Fast splittable pseudorandom number generators'): the
/// same numbers from the same seed on every machine.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The sequence of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 to below `count`, which is at least 1.
    pub fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.bits()) * count as u128) >> 64) as usize
    }

    /// From −1 to below 1.
    pub fn signed(&mut self) -> f64 {
        // 53 random bits are every multiple of 2^-52 in the interval.
        (self.bits() >> 11) as f64 * f64::EPSILON - 1.0
    }

    /// Uniform over the unit ball.
    pub fn in_ball(&mut self) -> DVec3 {
        loop {
            let p = DVec3::new(self.signed(), self.signed(), self.signed());
            if p.length_squared() <= 1.0 {
                return p;
            }
        }
    }

    /// Uniform over all rotations: a point of the unit ball in four dimensions, away from its
    /// centre, projected onto the sphere. Needs no trigonometry, so it is the same everywhere.
    pub fn rotation(&mut self) -> DQuat {
        loop {
            let q = DQuat::from_xyzw(self.signed(), self.signed(), self.signed(), self.signed());
            let squared = q.length_squared();
            if (0.01..=1.0).contains(&squared) {
                return q * (1.0 / squared.sqrt());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_sequence() {
        let mut random = Random::new(1_234_567);
        let first: Vec<u64> = (0..3).map(|_| random.bits()).collect();
        assert_eq!(
            first,
            [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]
        );
    }

    #[test]
    fn ranges_hold_and_rotations_are_unit_and_spread() {
        let mut random = Random::new(7);
        let mut mean = [0.0; 4];
        for _ in 0..4000 {
            assert!(random.below(6) < 6);
            assert!((-1.0..1.0).contains(&random.signed()));
            let q = random.rotation();
            assert!((q.length() - 1.0).abs() < 1e-12);
            mean.iter_mut().zip(q.to_array()).for_each(|(sum, x)| *sum += x / 4000.0);
        }
        assert!(mean.iter().all(|x| x.abs() < 0.04), "{mean:?}");
    }
}
