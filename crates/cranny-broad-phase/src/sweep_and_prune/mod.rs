//! Incremental sweep and prune on three axes.
//!
//! The end points of all boxes are kept sorted along x, y and z. When boxes move a little, few end
//! points pass each other, and the old order is repaired by insertion sort; a pair can begin or end
//! only where a lower and an upper end pass each other on some axis (Baraff 1992, section 2.3;
//! Cohen, Lin, Manocha and Ponamgi 1995). Departures from these:
//!
//! - All new boxes are known before any axis is sorted, so each crossing is judged once, against
//!   the boxes before and the boxes now on all three axes. No count per axis is kept.
//! - Only ends that were given new values are visited: a frame costs what moves, not what is there.
//! - Ends that come are sorted among each other and merged; the pairs of boxes that come (or wake
//!   up) are found by one walk along the best axis. Ends that go are squeezed out in one pass.
//! - When more ends pass each other than [`swap_budget`] allows, everything is sorted anew, so
//!   that a world which teleports costs what a new one does.

mod axis;
mod sweep;

use crate::index::{Found, Index};
use crate::pairs::{PairSet, pack};
use crate::slots::{Slot, Slots, State};
use crate::{InvariantError, Motion};
use axis::{Axis, Crossing, End};

/// The sweep-and-prune back end of [`BroadPhase`](crate::BroadPhase).
///
/// Costs of an update, with n boxes, k of them changed and p pairs: motion about k plus swaps;
/// insertion, and switching to moving, n + k log k + the intervals that meet along the best axis;
/// removal, and switching to stationary, n + p, however many there are; any event, a copy of p.
/// Where all boxes move at scale, swaps grow faster than n.
pub type SweepAndPrune = crate::PairKeeper<SortedAxes>;

/// The end points of all boxes, sorted along each axis.
#[derive(Clone, Debug, Default)]
pub struct SortedAxes {
    axes: [Axis; 3],
}

/// How many swaps an axis of `ends` end points may take before sorting anew is the better bargain.
///
/// Measured at 1,000, 10,000 and 100,000 boxes with 2.8 partners each (those of
/// `cranny-bench broad`), the break-even lies at 4, 10 and 39 swaps an end on each axis: a tenth of
/// the root of `ends`. Smaller: ordinary motion pays for sorting anew (all boxes moving by 1 % of
/// their size take 2, 2 and 10 swaps an end). Larger: a teleport of the whole world wastes more
/// time before it is noticed. `a_world_that_teleports_is_sorted_anew` shows both sides.
fn swap_budget(ends: usize) -> u64 {
    let ends = ends as u64;
    ends * ends.isqrt() / 10
}

impl SortedAxes {
    /// An index over all boxes that are present.
    pub(crate) fn of(slots: &Slots) -> Self {
        let mut index = Self::default();
        index.list(&slots.present().collect::<Vec<_>>(), slots);
        index
    }

    /// Takes the end points of removed proxies off the axes.
    fn expel(&mut self, slots: &Slots) {
        if !slots.doomed().is_empty() {
            for axis in &mut self.axes {
                axis.retain(|slot| slots.states[slot.index()] != State::Doomed);
            }
        }
    }

    /// Gives moved boxes their new places on the axes and judges every crossing.
    fn shift(&mut self, slots: &Slots, found: &mut Found) {
        let moved = slots.moved();
        let Found { began, ended, counters } = found;
        let mut visit = |a: Slot, b: Slot, crossing: Crossing| {
            if !slots.can_pair(a, b) {
                return;
            }
            counters.box_tests += 1;
            let (i, j) = (a.index(), b.index());
            match crossing {
                Crossing::Met if slots.boxes[i].overlaps(&slots.boxes[j]) => {
                    began.push(slots.key(a, b));
                }
                Crossing::Parted if slots.boxes_before[i].overlaps(&slots.boxes_before[j]) => {
                    ended.push(slots.key(a, b));
                }
                _ => {}
            }
        };
        let mut swaps = Some(0);
        for (k, axis) in self.axes.iter_mut().enumerate() {
            for &slot in &moved {
                let aabb = &slots.boxes[slot.index()];
                axis.set(slot, aabb.min[k], aabb.max[k]);
            }
            let budget = swap_budget(axis.ends().len());
            swaps = swaps.and_then(|sum| Some(sum + axis.sort(budget, &mut visit)?));
        }
        if let Some(swaps) = swaps {
            counters.swaps = swaps;
        } else {
            counters.rebuilds = 1;
            for axis in &mut self.axes {
                axis.sort_anew();
            }
        }
    }

    /// Lists the boxes that came, and finds the pairs of all that came or woke up; after a rebuild
    /// the pairs of all.
    fn admit(&mut self, slots: &Slots, pairs: &PairSet, found: &mut Found) {
        let pending = slots.pending();
        self.list(&pending, slots);
        let rebuilt = found.counters.rebuilds > 0;
        let woken = slots.switched_to(Motion::Moving);
        if rebuilt {
            found.began.clear();
            found.ended.clear();
            found.ended.extend(pairs.as_slice().iter().map(|pair| pack(pair.0, pair.1)));
        } else if pending.is_empty() && woken.is_empty() {
            return;
        }
        let mut is_fresh = vec![rebuilt; slots.ids.len()];
        for slot in pending.iter().chain(&woken) {
            is_fresh[slot.index()] = true;
        }
        let Found { began, counters, .. } = found;
        counters.box_tests += sweep::sweep(&self.axes, slots, &is_fresh, |a, b| {
            began.push(slots.key(a, b));
        });
    }

    fn list(&mut self, added: &[Slot], slots: &Slots) {
        if added.is_empty() {
            return;
        }
        for (k, axis) in self.axes.iter_mut().enumerate() {
            let faces = |&slot: &Slot| {
                let aabb = &slots.boxes[slot.index()];
                [(aabb.min[k], End::lower(slot)), (aabb.max[k], End::upper(slot))]
            };
            axis.merge(added.iter().flat_map(faces).collect());
        }
    }
}

impl Index for SortedAxes {
    fn follow(&mut self, slots: &Slots, pairs: &PairSet, found: &mut Found) {
        self.expel(slots);
        self.shift(slots, found);
        self.admit(slots, pairs, found);
    }

    fn validate(&self, slots: &Slots) -> Result<(), InvariantError> {
        let is_on_axes = |state| matches!(state, State::Listed | State::Doomed);
        let on_axes = slots.states.iter().filter(|&&state| is_on_axes(state)).count();
        for (k, name) in ['x', 'y', 'z'].into_iter().enumerate() {
            self.axes[k].validate(name, on_axes, |slot| {
                let aabb = slots.boxes_before[slot.index()];
                is_on_axes(slots.states[slot.index()]).then(|| (aabb.min[k], aabb.max[k]))
            })?;
        }
        Ok(())
    }
}
