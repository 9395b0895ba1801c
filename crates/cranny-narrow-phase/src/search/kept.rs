//! When a cut is worth keeping, and how far it reaches.

use cranny_exact::RigidMap;

use super::cut::Cut;
use super::ground::Ground;
use crate::backoff::Backoff;
use crate::pair::Pair;
use crate::tally::Tally;

/// A cut that is built anew sooner than after so many queries has not paid for itself. Larger: it
/// is given up where it still saves time; smaller: motion that outruns it is followed in vain.
const LEAST_AGE: u32 = 2;

/// How far a cut is to reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// At least so far now.
    pub(crate) least: f64,
    /// So far where it is built.
    pub(crate) build: f64,
    /// So far where it was built to reach less than is wanted.
    pub(crate) outgrown: f64,
    /// And so much farther where it is tested.
    pub(crate) spare: f64,
    /// No farther than this, or it is built anew or given up.
    pub(crate) most: f64,
}

/// A cut, where motion lets it last.
#[derive(Clone, Debug, Default)]
pub(crate) struct KeptCut {
    cut: Option<Cut>,
    age: u32,
    backoff: Backoff,
    /// The pose of the last query.
    last: Option<RigidMap>,
    /// Whether the cut is at the pair's pose.
    is_here: bool,
    /// Whether it was at the last query's.
    was_here: bool,
}

impl KeptCut {
    /// Begins a query.
    pub(crate) fn begin(&mut self) {
        self.was_here = std::mem::take(&mut self.is_here);
    }

    /// Ends a query.
    pub(crate) fn end(&mut self, pair: &Pair) {
        self.last = Some(pair.first_from_second);
    }

    /// The pose of the last query.
    pub(crate) fn last(&self) -> Option<&RigidMap> {
        self.last.as_ref()
    }

    /// Whether the cut was at the pose of the last query.
    pub(crate) fn was_here(&self) -> bool {
        self.was_here
    }

    /// The cut at the pair's pose; `None` where none is worth its while. `builds`: one may be
    /// built.
    pub(crate) fn at(
        &mut self,
        pair: &Pair,
        ground: &Ground,
        (reach, builds): (Reach, bool),
        counters: &mut impl Tally,
    ) -> Option<&mut Cut> {
        let (mut build, mut held) = (reach.build, 0);
        if let Some(cut) = &mut self.cut {
            let followed = if self.is_here { true } else { cut.follow(pair, ground, counters) };
            let serves = cut.reach() >= reach.least;
            if followed && serves && cut.reach() <= reach.most {
                if !self.is_here {
                    self.age += 1;
                    self.backoff.succeeded();
                }
                self.is_here = true;
                return self.cut.as_mut();
            }
            let is_outgrown = followed && !serves;
            held = cut.held();
            self.cut = None;
            counters.counters().front_rebuilt += 1;
            if is_outgrown {
                // What is wanted varies, and may go on to.
                build = reach.outgrown;
            } else if !followed && self.age < LEAST_AGE {
                counters.counters().bypassed += 1;
                self.backoff.failed();
            }
        }
        // Not for a single query, and not while motion outruns it.
        if !builds || self.last.is_none() || !self.backoff.is_due() {
            return None;
        }
        self.age = 0;
        self.is_here = true;
        let cut = self.cut.insert(Cut::build(pair, ground, (build, reach.spare), counters));
        counters.counters().front_merged += held.saturating_sub(cut.held());
        Some(cut)
    }

    /// How many blocks are kept.
    pub(crate) fn held(&self) -> u64 {
        self.cut.as_ref().map_or(0, Cut::held)
    }

    pub(crate) fn bytes(&self) -> usize {
        self.cut.as_ref().map_or(0, Cut::bytes)
    }
}
