//! How long to leave off what has failed of late.

/// Waits twice as long after each failure, and half as long after as many successes as it would wait.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Patience {
    /// Queries to answer without it.
    wait: u32,
    /// How many will be, after the next failure.
    next: u32,
    /// Successes since that last changed.
    calm: u32,
}

impl Patience {
    /// The longest wait: one trial in so many queries is in vain.
    const LONGEST: u32 = 63;

    /// Whether it is time for a trial; if not, a query of the wait has passed.
    pub(crate) fn is_over(&mut self) -> bool {
        let over = self.wait == 0;
        self.wait = self.wait.saturating_sub(1);
        over
    }

    pub(crate) fn failed(&mut self) {
        self.wait = self.next;
        self.next = (2 * self.next + 1).min(Self::LONGEST);
        self.calm = 0;
    }

    pub(crate) fn succeeded(&mut self) {
        self.calm += 1;
        if self.calm > self.next {
            (self.calm, self.next) = (0, self.next / 2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many queries pass before the next trial.
    fn wait(patience: &mut Patience) -> u32 {
        (0..).find(|_| patience.is_over()).unwrap()
    }

    #[test]
    fn waits_double_up_to_a_bound_and_success_halves_them() {
        let mut patience = Patience::default();
        for expected in [0, 1, 3, 7, 15, 31, 63, 63] {
            patience.failed();
            assert_eq!(wait(&mut patience), expected);
        }
        for _ in 0..64 {
            patience.succeeded();
        }
        patience.failed();
        assert_eq!(wait(&mut patience), 31);
    }
}
