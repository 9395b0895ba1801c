//! Incremental sweep and prune on three axes.
//!
//! The end points of all boxes are kept sorted along x, y and z. When boxes move a little, few end
//! points pass each other, and the old order is repaired by insertion sort; a pair can begin or end
//! only where a lower and an upper end pass each other on some axis (Baraff 1992, section 2.3; Cohen,
//! Lin, Manocha and Ponamgi 1995). Departures from these:
//!
//! - All new boxes are known before any axis is sorted, so each crossing is judged once, against
//!   the boxes before and the boxes now on all three axes. No count per axis is kept.
//! - Only ends that were given new values are visited: a frame costs what moves, not what is there.
//! - Ends that come are sorted among each other and merged; the pairs of boxes that come (or wake
//!   up) are found by one walk along the best axis. Ends that go are squeezed out in one pass.
//! - When more ends pass each other than [`swap_budget`] allows, everything is sorted anew, so
//!   that a world which teleports costs what a new one does.

mod axis;
mod slots;
mod sweep;

use crate::error::checked_box;
use crate::pairs::{PairSet, pack};
use crate::{
    BroadPhase, BroadPhaseCounters, BroadPhaseError, InvariantError, Motion, OverlapEvent,
    OverlapPair, ProxyId,
};
use axis::{Axis, Crossing, End};
use cranny_exact::Aabb;
use slots::{Slot, Slots, State};

/// The sweep-and-prune back end of [`BroadPhase`].
///
/// Costs of an update, with n boxes, k of them changed and p pairs: motion about k plus swaps;
/// insertion, and switching to moving, n + k log k + the intervals that meet along the best axis;
/// removal, and switching to stationary, n + p, however many there are; any event, a copy of p.
/// Where all boxes move at scale, swaps grow faster than n.
#[derive(Clone, Debug, Default)]
pub struct SweepAndPrune {
    slots: Slots,
    axes: [Axis; 3],
    pairs: PairSet,
    events: Vec<OverlapEvent>,
    counters: BroadPhaseCounters,
    /// Slots that were inserted, moved, removed or switched since the last update.
    changed: Vec<Slot>,
    /// What happened to them, by slot.
    changes: Vec<Change>,
    began: Vec<u64>,
    ended: Vec<u64>,
}

/// What happened to a slot since the last update. All false: it is not in `changed`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Change {
    came_or_went: bool,
    moved: bool,
    switched: bool,
}

impl Change {
    const CAME_OR_WENT: Self = Self { came_or_went: true, moved: false, switched: false };
    const MOVED: Self = Self { came_or_went: false, moved: true, switched: false };
    const SWITCHED: Self = Self { came_or_went: false, moved: false, switched: true };

    fn and(self, other: Self) -> Self {
        Self {
            came_or_went: self.came_or_went | other.came_or_went,
            moved: self.moved | other.moved,
            switched: self.switched | other.switched,
        }
    }
}

/// How many swaps an axis of `ends` end points may take before sorting anew is the better bargain.
///
/// Measured at 1,000, 10,000 and 100,000 boxes with 2.8 partners each (`examples/frame_cost.rs`),
/// the break-even lies at 4, 10 and 39 swaps an end on each axis: a tenth of the root of `ends`.
/// Smaller: ordinary motion pays for sorting anew (all boxes moving by 1 % of their size take 2, 2
/// and 10 swaps an end). Larger: a teleport of the whole world wastes more time before it is
/// noticed. `a_world_that_teleports_is_sorted_anew` shows both sides.
fn swap_budget(ends: usize) -> u64 {
    let ends = ends as u64;
    ends * ends.isqrt() / 10
}

impl SweepAndPrune {
    fn note(&mut self, slot: Slot, change: Change) {
        if self.changes.len() <= slot.index() {
            self.changes.resize(slot.index() + 1, Change::default());
        }
        let so_far = &mut self.changes[slot.index()];
        if *so_far == Change::default() {
            self.changed.push(slot);
        }
        *so_far = so_far.and(change);
    }

    /// Slots in the given state for which `has` holds.
    fn changed(&self, state: State, has: impl Fn(Change) -> bool) -> Vec<Slot> {
        let is = |slot: Slot| {
            self.slots.states[slot.index()] == state && has(self.changes[slot.index()])
        };
        self.changed.iter().copied().filter(|&slot| is(slot)).collect()
    }

    /// Ends the pairs of removed proxies and takes their end points off the axes.
    fn expel(&mut self) {
        let doomed = self.changed(State::Doomed, |_| true);
        if doomed.is_empty() {
            return;
        }
        let mut gone: Vec<ProxyId> =
            doomed.iter().map(|slot| self.slots.ids[slot.index()]).collect();
        gone.sort_unstable();
        let is_gone = |id| gone.binary_search(&id).is_ok();
        let lost = self.pairs.as_slice().iter().filter(|pair| is_gone(pair.0) || is_gone(pair.1));
        self.ended.extend(lost.map(|pair| pack(pair.0, pair.1)));
        for axis in &mut self.axes {
            axis.retain(|slot| self.slots.states[slot.index()] != State::Doomed);
        }
    }

    /// Ends the pairs between proxies that are stationary by now.
    fn settle(&mut self) {
        let is_stationary = |slot: Slot| self.slots.motions[slot.index()] == Motion::Stationary;
        let mut settled: Vec<ProxyId> = self
            .changed(State::Listed, |change| change.switched)
            .into_iter()
            .filter(|&slot| is_stationary(slot))
            .map(|slot| self.slots.ids[slot.index()])
            .collect();
        if settled.is_empty() {
            return;
        }
        settled.sort_unstable();
        let has_settled = |id| settled.binary_search(&id).is_ok();
        let at_rest = |id| self.slots.find(id).is_none_or(is_stationary);
        for &(a, b) in self.pairs.as_slice() {
            if (has_settled(a) || has_settled(b)) && at_rest(a) && at_rest(b) {
                self.ended.push(pack(a, b));
            }
        }
    }

    /// Gives moved boxes their new places on the axes and judges every crossing.
    fn shift(&mut self) {
        let moved = self.changed(State::Listed, |change| change.moved);
        let Self { slots, axes, began, ended, counters, .. } = self;
        let mut visit = |a: Slot, b: Slot, crossing: Crossing| {
            if !slots.can_pair(a, b) {
                return;
            }
            counters.box_tests += 1;
            let (i, j) = (a.index(), b.index());
            match crossing {
                Crossing::Met if slots.boxes[i].overlaps(&slots.boxes[j]) => {
                    began.push(pack(slots.ids[i], slots.ids[j]));
                }
                Crossing::Parted if slots.boxes_before[i].overlaps(&slots.boxes_before[j]) => {
                    ended.push(pack(slots.ids[i], slots.ids[j]));
                }
                _ => {}
            }
        };
        let mut swaps = Some(0);
        for (k, axis) in axes.iter_mut().enumerate() {
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
            for axis in axes.iter_mut() {
                axis.sort_anew();
            }
        }
    }

    /// Lists the boxes that came, and finds the pairs of all that came or woke up; after a rebuild
    /// the pairs of all.
    fn admit(&mut self) {
        let pending = self.changed(State::Pending, |_| true);
        if !pending.is_empty() {
            for (k, axis) in self.axes.iter_mut().enumerate() {
                let faces = |&slot: &Slot| {
                    let aabb = &self.slots.boxes[slot.index()];
                    [(aabb.min[k], End::lower(slot)), (aabb.max[k], End::upper(slot))]
                };
                axis.merge(pending.iter().flat_map(faces).collect());
            }
        }
        let rebuilt = self.counters.rebuilds > 0;
        let mut woken = self.changed(State::Listed, |change| change.switched);
        woken.retain(|slot| self.slots.motions[slot.index()] == Motion::Moving);
        if rebuilt {
            self.began.clear();
            self.ended.clear();
            self.ended.extend(self.pairs.as_slice().iter().map(|pair| pack(pair.0, pair.1)));
        } else if pending.is_empty() && woken.is_empty() {
            return;
        }
        let mut is_fresh = vec![rebuilt; self.slots.ids.len()];
        for slot in pending.iter().chain(&woken) {
            is_fresh[slot.index()] = true;
        }
        let (ids, began) = (&self.slots.ids, &mut self.began);
        self.counters.box_tests += sweep::sweep(&self.axes, &self.slots, &is_fresh, |a, b| {
            began.push(pack(ids[a.index()], ids[b.index()]));
        });
    }

    /// Makes what is now what was before.
    fn close(&mut self) {
        for slot in self.changed.drain(..) {
            let i = slot.index();
            self.changes[i] = Change::default();
            self.slots.boxes_before[i] = self.slots.boxes[i];
            match self.slots.states[i] {
                State::Pending => self.slots.states[i] = State::Listed,
                State::Withdrawn | State::Doomed => self.slots.vacate(slot),
                State::Listed | State::Vacant => {}
            }
        }
        self.began.clear();
        self.ended.clear();
    }

    fn validate_pairs(&self) -> Result<(), InvariantError> {
        let listed: Vec<Slot> = self.slots.in_state(State::Listed).collect();
        let mut expected = Vec::new();
        for (i, &a) in listed.iter().enumerate() {
            for &b in &listed[i + 1..] {
                let overlap = self.slots.boxes[a.index()].overlaps(&self.slots.boxes[b.index()]);
                if overlap && self.slots.can_pair(a, b) {
                    expected.push(pack(self.slots.ids[a.index()], self.slots.ids[b.index()]));
                }
            }
        }
        expected.sort_unstable();
        let held = self.pairs.as_slice().iter().map(|pair| pack(pair.0, pair.1));
        InvariantError::unless(held.eq(expected.iter().copied()), || {
            let (held, true_pairs) = (self.pairs.as_slice().len(), expected.len());
            format!("{held} pairs are held; brute force finds {true_pairs}, or others")
        })
    }
}

impl BroadPhase for SweepAndPrune {
    fn insert(&mut self, id: ProxyId, aabb: Aabb, motion: Motion) -> Result<(), BroadPhaseError> {
        let slot = self.slots.add(id, checked_box(id, aabb)?, motion)?;
        self.note(slot, Change::CAME_OR_WENT);
        Ok(())
    }

    fn remove(&mut self, id: ProxyId) -> Result<(), BroadPhaseError> {
        let slot = self.slots.discard(id)?;
        self.note(slot, Change::CAME_OR_WENT);
        Ok(())
    }

    fn set_box(&mut self, id: ProxyId, aabb: Aabb) -> Result<(), BroadPhaseError> {
        let slot = self.slots.get(id)?;
        let aabb = checked_box(id, aabb)?;
        if self.slots.boxes[slot.index()] != aabb {
            self.slots.boxes[slot.index()] = aabb;
            self.note(slot, Change::MOVED);
        }
        Ok(())
    }

    fn set_moving(&mut self, id: ProxyId, motion: Motion) -> Result<(), BroadPhaseError> {
        let slot = self.slots.get(id)?;
        if self.slots.motions[slot.index()] != motion {
            self.slots.motions[slot.index()] = motion;
            self.note(slot, Change::SWITCHED);
        }
        Ok(())
    }

    /// The steps may name pairs too often, never wrongly: `began` receives only pairs that hold by
    /// now and all of them that are new; `ended` all that are gone, and nothing else but pairs
    /// that `began` has too, or that were never held. The pair set takes care of the rest.
    fn update(&mut self) -> &[OverlapEvent] {
        self.counters =
            BroadPhaseCounters { changed: self.changed.len() as u64, ..Default::default() };
        self.expel();
        self.settle();
        self.shift();
        self.admit();
        self.pairs.apply(&mut self.began, &mut self.ended, &mut self.events);
        self.close();
        &self.events
    }

    fn pairs(&self) -> &[OverlapPair] {
        self.pairs.as_slice()
    }

    fn aabb(&self, id: ProxyId) -> Option<Aabb> {
        self.slots.find(id).map(|slot| self.slots.boxes[slot.index()])
    }

    fn motion(&self, id: ProxyId) -> Option<Motion> {
        self.slots.find(id).map(|slot| self.slots.motions[slot.index()])
    }

    fn len(&self) -> usize {
        self.slots.len()
    }

    fn counters(&self) -> BroadPhaseCounters {
        self.counters
    }

    fn validate(&self) -> Result<(), InvariantError> {
        let is_on_axes = |state| matches!(state, State::Listed | State::Doomed);
        let on_axes = self.slots.states.iter().filter(|&&state| is_on_axes(state)).count();
        for (k, name) in ['x', 'y', 'z'].into_iter().enumerate() {
            self.axes[k].validate(name, on_axes, |slot| {
                let aabb = self.slots.boxes_before[slot.index()];
                is_on_axes(self.slots.states[slot.index()]).then(|| (aabb.min[k], aabb.max[k]))
            })?;
        }
        let sorted = self.pairs.as_slice().windows(2).all(|two| two[0] < two[1]);
        InvariantError::unless(sorted, || "the pairs are not sorted".into())?;
        if self.changed.is_empty() { self.validate_pairs() } else { Ok(()) }
    }
}
