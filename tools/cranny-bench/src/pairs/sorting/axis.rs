//! End points along one axis, kept in order.

use std::ops::ControlFlow;

use super::level::Member;

/// Where a box begins or ends along an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) at: f64,
    pub(super) of: Member,
    pub(super) is_max: bool,
}

impl End {
    /// Closed boxes that only touch overlap: where two ends coincide, what begins stands before
    /// what ends.
    fn is_after(&self, other: &Self) -> bool {
        self.at > other.at || (self.at == other.at && self.is_max && !other.is_max)
    }
}

/// The ends of all boxes of a level along one axis.
#[derive(Clone, Debug, Default)]
pub(super) struct Axis {
    pub(super) ends: Vec<End>,
}

impl Axis {
    /// Sorts by insertion; reports every begin and end of opposite trees' boxes that passed each
    /// other, which are so found to overlap along the axis (`true`) or not. Breaks off after `most`
    /// swaps, in no order: how many were made.
    pub(super) fn sort(
        &mut self,
        most: u64,
        mut passed: impl FnMut(Member, Member, bool),
    ) -> ControlFlow<u64, u64> {
        let mut swaps = 0;
        for i in 1..self.ends.len() {
            let end = self.ends[i];
            let mut place = i;
            while place > 0 && self.ends[place - 1].is_after(&end) {
                let before = self.ends[place - 1];
                if before.is_max != end.is_max && before.of.tree != end.of.tree {
                    passed(before.of, end.of, before.is_max);
                }
                self.ends[place] = before;
                place -= 1;
                swaps += 1;
            }
            self.ends[place] = end;
            if swaps > most {
                return ControlFlow::Break(swaps);
            }
        }
        ControlFlow::Continue(swaps)
    }

    /// Sorts without regard to what was, and reports nothing.
    pub(super) fn sort_anew(&mut self) {
        self.ends.sort_unstable_by(|x, y| x.at.total_cmp(&y.at).then(x.is_max.cmp(&y.is_max)));
    }

    /// Takes in more ends, in one pass.
    pub(super) fn merge(&mut self, mut more: Vec<End>) {
        more.sort_unstable_by(|x, y| x.at.total_cmp(&y.at).then(x.is_max.cmp(&y.is_max)));
        let old = std::mem::take(&mut self.ends);
        self.ends.reserve(old.len() + more.len());
        let mut more = more.into_iter().peekable();
        for end in old {
            while let Some(new) = more.next_if(|new| end.is_after(new)) {
                self.ends.push(new);
            }
            self.ends.push(end);
        }
        self.ends.extend(more);
    }
}
