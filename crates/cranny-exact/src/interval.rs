//! Closed intervals of real numbers.

/// A closed interval that is known to hold a value. `lo <= hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Interval {
    /// Nothing is known: the whole line.
    pub const WHOLE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// The interval that holds one number.
    #[must_use]
    pub fn point(value: f64) -> Self {
        Self { lo: value, hi: value }
    }

    /// All numbers within `error >= 0` of `value`, rounded outward.
    #[must_use]
    pub fn around(value: f64, error: f64) -> Self {
        Self { lo: (value - error).next_down(), hi: (value + error).next_up() }
    }

    /// Whether `value` lies in the interval, ends included.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// `hi - lo`.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.hi - self.lo
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn around_is_rounded_outward() {
        let third = Interval::around(1.0 / 3.0, 0.0);
        assert!(third.lo < 1.0 / 3.0 && 1.0 / 3.0 < third.hi);
        assert!(third.contains(1.0 / 3.0));
        assert!(third.width() < 1e-15);
    }
}
