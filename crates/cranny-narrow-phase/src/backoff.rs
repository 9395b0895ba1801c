//! Exponential backoff: how many queries skip an attempt that has failed.

/// Doubles the wait after each failure, and halves it after as many successes as it is long.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Backoff {
    /// Queries that still skip the attempt.
    wait: u32,
    /// The wait after the next failure.
    next: u32,
    /// Successes since `next` last changed.
    calm: u32,
}

impl Backoff {
    /// The longest wait. Shorter: attempts that always fail cost more than one query in this many;
    /// longer: an attempt that would succeed again is found out late.
    const LONGEST: u32 = 63;

    /// Returns whether this query makes the attempt; if not, one query of the wait has passed.
    pub(crate) fn is_due(&mut self) -> bool {
        let due = self.wait == 0;
        self.wait = self.wait.saturating_sub(1);
        due
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

    /// How many queries skip the attempt.
    fn wait(backoff: &mut Backoff) -> u32 {
        (0..).find(|_| backoff.is_due()).unwrap()
    }

    #[test]
    fn waits_double_up_to_a_bound_and_success_halves_them() {
        let mut backoff = Backoff::default();
        for expected in [0, 1, 3, 7, 15, 31, 63, 63] {
            backoff.failed();
            assert_eq!(wait(&mut backoff), expected);
        }
        for _ in 0..64 {
            backoff.succeeded();
        }
        backoff.failed();
        assert_eq!(wait(&mut backoff), 31);
    }
}
