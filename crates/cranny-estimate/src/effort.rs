//! How much may be spent on a pair.

use std::fmt;

/// What an estimate reads of the two bodies.
///
/// Every level is conservative: none excludes what `Exact` finds. Levels differ in how much is
/// certain at them. A level opens no node deeper than it says, but uses nodes that memory has
/// opened before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Accuracy {
    /// The boxes of the two bodies.
    Boxes,
    /// The [walk](cranny_concavity::walk) over the two hulls: the distance of the hulls bounds that
    /// of the bodies.
    Hulls,
    /// The hulls, and the faces that lie on them: where such faces meet, the bodies meet. Faces
    /// beneath caps are not read; their boxes bound the distance.
    Caps,
    /// The boxes of the bodies' trees down to this depth, the root being 0; the faces of leaves
    /// that are less deep.
    Tree(u8),
    /// All faces.
    #[default]
    Exact,
}

/// A clock that a caller lends: the computing crates read none of their own.
pub trait Clock {
    /// Nanoseconds since a moment that stays the same. Never decreases.
    fn now_ns(&self) -> u64;
}

/// When an estimate must come to its end.
#[derive(Clone, Copy, Default)]
pub enum Budget<'a> {
    /// When the level is exhausted.
    #[default]
    Unlimited,
    /// After this many elementary tests: pairs of boxes, pairs of triangles, points against a
    /// solid. The estimate is the same on every machine.
    Tests(u64),
    /// When a clock has reached a moment. How tight the estimate is then depends on the machine;
    /// that it is certain does not.
    Until {
        /// Read once for each 32 tests, and before the first.
        clock: &'a dyn Clock,
        /// The time of the clock at which the estimate ends.
        deadline_ns: u64,
    },
}

impl fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unlimited => f.write_str("Unlimited"),
            Self::Tests(tests) => f.debug_tuple("Tests").field(tests).finish(),
            Self::Until { deadline_ns, .. } => {
                f.debug_struct("Until").field("deadline_ns", deadline_ns).finish_non_exhaustive()
            }
        }
    }
}

impl Accuracy {
    /// The coarser of the levels at which everything is certain that is certain at either: the
    /// finer one, or `Exact` for `Tree` beside `Hulls` or `Caps`: neither knows all that the other
    /// one does.
    ///
    /// ```
    /// use cranny_estimate::Accuracy::{Boxes, Caps, Exact, Hulls, Tree};
    ///
    /// assert_eq!([Hulls.join(Caps), Tree(5).join(Tree(2))], [Caps, Tree(5)]);
    /// assert_eq!([Boxes.join(Hulls), Hulls.join(Tree(9))], [Hulls, Exact]);
    /// ```
    #[must_use]
    pub fn join(self, other: Self) -> Self {
        match (self, other) {
            (Self::Boxes | Self::Tree(0), finer) | (finer, Self::Boxes | Self::Tree(0)) => finer,
            (Self::Hulls, Self::Hulls) => Self::Hulls,
            (Self::Hulls | Self::Caps, Self::Hulls | Self::Caps) => Self::Caps,
            (Self::Tree(a), Self::Tree(b)) => Self::Tree(a.max(b)),
            _ => Self::Exact,
        }
    }
}

/// As the command names them: `boxes`, `hulls`, `caps`, `tree:3`, `exact`.
impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boxes => f.write_str("boxes"),
            Self::Hulls => f.write_str("hulls"),
            Self::Caps => f.write_str("caps"),
            Self::Tree(depth) => write!(f, "tree:{depth}"),
            Self::Exact => f.write_str("exact"),
        }
    }
}

/// How much may be spent on a pair. By default: all that it takes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort<'a> {
    /// What is read of the bodies.
    pub accuracy: Accuracy,
    /// When the work ends.
    pub budget: Budget<'a>,
}

impl Effort<'_> {
    /// A level without a budget.
    #[must_use]
    pub fn of(accuracy: Accuracy) -> Self {
        Self { accuracy, budget: Budget::Unlimited }
    }

    /// The level [`Exact`](Accuracy::Exact) within a number of tests.
    #[must_use]
    pub fn tests(tests: u64) -> Self {
        Self { accuracy: Accuracy::Exact, budget: Budget::Tests(tests) }
    }

    pub(crate) fn is_all(&self) -> bool {
        self.accuracy == Accuracy::Exact && matches!(self.budget, Budget::Unlimited)
    }
}

/// What is left of a budget.
pub(crate) struct Meter<'a> {
    budget: Budget<'a>,
    spent: u64,
    /// Tests since the clock was read; `None` before that.
    unread: Option<u64>,
    late: bool,
    /// Tests were wanted and refused.
    pub(crate) refused: bool,
    /// Tests that the next estimate makes again.
    repeated: u64,
    /// Tests that are kept back, or would be.
    held: u64,
    /// The least budget with which one of the refused steps is made.
    needed: Option<u64>,
}

/// Tests between two readings of the clock. Fewer: reading costs as much as the tests; more: the
/// tests overrun the deadline by some microseconds.
const TESTS_A_READING: u64 = 32;

impl<'a> Meter<'a> {
    pub(crate) fn of(budget: Budget<'a>) -> Self {
        Self {
            budget,
            spent: 0,
            unread: None,
            late: false,
            refused: false,
            repeated: 0,
            held: 0,
            needed: None,
        }
    }

    /// Takes tests from the budget, if as many are left; returns whether they were.
    pub(crate) fn take(&mut self, tests: u64) -> bool {
        let taken = self.try_take(tests);
        if !taken {
            self.refused = true;
            // Less than twice what is held, and nothing is: the verdict would come last.
            let needed = self.repeated + 2 * self.held + tests;
            self.needed = Some(self.needed.map_or(needed, |least| least.min(needed)));
        }
        taken
    }

    /// [Takes](Self::take) tests that every estimate makes: they bring nobody on.
    pub(crate) fn take_again(&mut self, tests: u64) -> bool {
        let taken = self.try_take(tests);
        self.refused |= !taken;
        self.repeats(tests);
        taken
    }

    /// Counts tests that the next estimate makes again.
    pub(crate) fn repeats(&mut self, tests: u64) {
        self.repeated += tests;
    }

    /// The budget with which the next estimate makes a step that was refused to this one; 0 where
    /// none was.
    pub(crate) fn needed(&self) -> u64 {
        if self.refused { self.needed.unwrap_or(self.repeated) } else { 0 }
    }

    fn try_take(&mut self, tests: u64) -> bool {
        match self.budget {
            Budget::Unlimited => true,
            Budget::Tests(_) => {
                let affords = self.affords(tests);
                if affords {
                    self.spent += tests;
                }
                affords
            }
            Budget::Until { clock, deadline_ns } => {
                let unread = self.unread.map(|unread| unread + tests);
                if !self.late && unread.is_none_or(|unread| unread >= TESTS_A_READING) {
                    self.late = clock.now_ns() >= deadline_ns;
                    self.unread = Some(0);
                } else {
                    self.unread = unread;
                }
                !self.late
            }
        }
    }

    /// Whether this many tests are left; of a clock, whether the deadline has not been read.
    pub(crate) fn affords(&self, tests: u64) -> bool {
        match self.budget {
            Budget::Unlimited => true,
            Budget::Tests(all) => all.saturating_sub(self.spent) >= tests,
            Budget::Until { .. } => !self.late,
        }
    }

    /// Keeps tests back until they are given back, if twice as many are left; returns how many.
    pub(crate) fn reserve(&mut self, tests: u64) -> u64 {
        self.held = tests;
        match self.budget {
            Budget::Tests(_) if self.affords(2 * tests) => {
                self.spent += tests;
                tests
            }
            _ => 0,
        }
    }

    /// Gives back what [`reserve`](Self::reserve) has kept back.
    pub(crate) fn release(&mut self, reserved: u64) {
        self.held = 0;
        self.give_back(reserved);
    }

    /// Returns tests that were taken and not made.
    pub(crate) fn give_back(&mut self, tests: u64) {
        self.spent = self.spent.saturating_sub(tests);
    }

    /// Takes tests that were made before their number was known; the budget may be overdrawn.
    pub(crate) fn charge(&mut self, tests: u64) {
        self.spent = self.spent.saturating_add(tests);
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn tests_are_taken_as_long_as_there_are_enough() {
        let mut meter = Meter::of(Budget::Tests(5));
        assert_eq!(
            [2, 4, 2, 2, 1, 1].map(|n| meter.take(n)),
            [true, false, true, false, true, false]
        );
        let mut meter = Meter::of(Budget::Tests(5));
        meter.charge(9);
        assert!(!meter.take(1) && meter.take(0));
        assert!(Meter::of(Budget::Unlimited).take(u64::MAX));
    }

    #[test]
    fn what_is_needed_holds_what_is_made_again_and_kept_back() {
        let mut meter = Meter::of(Budget::Tests(4));
        assert!(meter.take_again(2) && meter.needed() == 0);
        let reserved = meter.reserve(5);
        assert!(meter.take(2) && !meter.take(8) && !meter.take(6));
        assert_eq!((reserved, meter.needed()), (0, 2 + 2 * 5 + 6));
        meter.release(reserved);
        assert!(!meter.take(1));
        assert_eq!(meter.needed(), 2 + 1);
    }

    /// Moves on by one whenever it is read.
    struct Ticks(Cell<u64>);

    impl Clock for Ticks {
        fn now_ns(&self) -> u64 {
            self.0.replace(self.0.get() + 1)
        }
    }

    #[test]
    fn a_clock_is_read_at_first_and_now_and_then() {
        let clock = Ticks(Cell::new(0));
        let mut meter = Meter::of(Budget::Until { clock: &clock, deadline_ns: 2 });
        let taken = (0..1_000).take_while(|_| meter.take(1)).count();
        assert_eq!((taken, clock.0.get()), (64, 3));
        assert!(!meter.take(0));
        assert_eq!(clock.0.get(), 3, "once it is late, it stays so");
        assert!(!Meter::of(Budget::Until { clock: &clock, deadline_ns: 0 }).take(1));
    }
}
