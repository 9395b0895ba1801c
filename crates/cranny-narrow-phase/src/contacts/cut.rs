//! Where the last search of two patches ended: a cut through the pairs of their nodes, with how far each pair is apart.
//!
//! Nothing above the cut is looked at again. A pair on it is left alone until the patches may have come nearer by what it is apart beyond the
//! limit; then that axis is tried first which told it, since what parts two boxes mostly is what parted them before. Only if that
//! fails are they compared whole, and opened where they are not apart.
//!
//! The cut grows where bodies move on: what was opened stays open. When it has grown much, it is made anew from the
//! roots. It tells what to look at, and the search tells what is there, so a cut of any age answers as none does.

use super::oriented::{Axis, Bound};

/// A cut that has grown by this factor and [`SPARE`] is made anew. Smaller: it is made anew where it would still do; larger: what
/// was opened on the way is compared for long after.
const GROWN: usize = 2;
const SPARE: usize = 8;

/// Two nodes that were not opened.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    /// Counted from their patches' roots.
    pub(super) nodes: [u32; 2],
    /// What told how far they are apart.
    pub(super) axis: Axis,
    /// How far the patches may have come nearer, all in all, when these may touch.
    spent: f64,
}

/// All pairs of nodes of two patches at which a search ended.
#[derive(Clone, Debug, Default)]
pub(super) struct Cut {
    ends: Vec<End>,
    /// How many there were when it was made.
    made: usize,
    /// By how much the patches may have come nearer since.
    way: f64,
}

impl Cut {
    /// The patches may have come nearer by `step`, which is no less than what rounding adds to it, since the last search. Beyond `most`
    /// all is made anew: what is added up would be rounded by more than steps allow for.
    pub(super) fn moved(&mut self, step: f64, most: f64) {
        self.way += step;
        if self.way > most {
            self.ends.clear();
        }
    }

    /// Begins a search; tells of how many ends.
    pub(super) fn begin(&mut self) -> usize {
        if self.ends.is_empty() || self.ends.len() > GROWN * self.made + SPARE {
            let roots = End { nodes: [0; 2], axis: Axis::BALLS, spent: f64::NEG_INFINITY };
            *self = Self { ends: std::mem::take(&mut self.ends), ..Self::default() };
            self.ends.clear();
            self.ends.push(roots);
        }
        self.ends.len()
    }

    #[inline]
    pub(super) fn ends(&self) -> &[End] {
        &self.ends
    }

    /// Whether two nodes are still more than `limit` apart, for all that patches may have moved.
    #[inline]
    pub(super) fn is_apart(&self, at: usize, limit: f64) -> bool {
        self.ends[at].spent - self.way > limit
    }

    /// An end stays, as far apart as that.
    #[inline]
    pub(super) fn stays(&mut self, at: usize, bound: Bound) {
        let end = &mut self.ends[at];
        (end.axis, end.spent) = (bound.axis, bound.lower + self.way);
    }

    #[inline]
    pub(super) fn add(&mut self, nodes: [u32; 2], bound: Bound) {
        self.ends.push(End { nodes, axis: bound.axis, spent: bound.lower + self.way });
    }

    /// Drops an end, whose place the last one takes.
    pub(super) fn drop(&mut self, at: usize) {
        self.ends.swap_remove(at);
    }

    /// Ends a search; the next one begins with the end at `first`.
    pub(super) fn end(&mut self, first: usize) {
        if first < self.ends.len() {
            self.ends.swap(0, first);
        }
        if self.made == 0 {
            self.made = self.ends.len();
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.ends.capacity() * size_of::<End>()
    }
}
