//! Where the boxes are kept: a dense array of slots, the way from a caller's id to its slot, and
//! what happened to each since the last update.

use crate::pairs::pack;
use crate::{BroadPhaseError, Motion, ProxyId};
use cranny_exact::Aabb;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::{BuildHasherDefault, Hasher};

/// Index of a box in the arrays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Slot(pub(crate) u32);

impl Slot {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// The most boxes that fit: end points are counted in 32 bits, two a box.
pub(crate) const MAX_SLOTS: u32 = 1 << 31;

/// What becomes of a slot at the next update.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum State {
    /// Nothing: free for another box.
    Vacant,
    /// It enters the index.
    Pending,
    /// It stays in the index.
    Listed,
    /// It was removed before it was ever listed.
    Withdrawn,
    /// It leaves the index.
    Doomed,
}

/// What happened to a slot since the last update. All false: it is not in [`Slots::changed`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Change {
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

/// The boxes, by slot.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    slot_of: HashMap<ProxyId, Slot, BuildHasherDefault<IdHasher>>,
    pub(crate) ids: Vec<ProxyId>,
    pub(crate) states: Vec<State>,
    pub(crate) motions: Vec<Motion>,
    /// As last set by the caller.
    pub(crate) boxes: Vec<Aabb>,
    /// As of the last update; equal to `boxes` unless the slot awaits the next one.
    pub(crate) boxes_before: Vec<Aabb>,
    vacant: Vec<Slot>,
    /// The slot looked up last.
    last: Slot,
    /// Slots that were inserted, moved, removed or switched since the last update.
    changed: Vec<Slot>,
    /// What happened to them, by slot.
    changes: Vec<Change>,
}

impl Slots {
    pub(crate) fn len(&self) -> usize {
        self.slot_of.len()
    }

    pub(crate) fn find(&self, id: ProxyId) -> Option<Slot> {
        self.slot_of.get(&id).copied()
    }

    /// Tries the slot behind the last one first: callers go through their bodies in order, and
    /// mostly in the order in which they inserted them.
    pub(crate) fn get(&mut self, id: ProxyId) -> Result<Slot, BroadPhaseError> {
        let next = Slot(self.last.0 + 1);
        let is_next = self.ids.get(next.index()) == Some(&id)
            && matches!(self.states[next.index()], State::Pending | State::Listed);
        let slot = if is_next { Some(next) } else { self.find(id) };
        self.last = slot.unwrap_or_default();
        slot.ok_or(BroadPhaseError::UnknownProxy { id })
    }

    /// The slots that hold a box by now, in order.
    pub(crate) fn present(&self) -> impl Iterator<Item = Slot> + '_ {
        let is_present = |s: &State| matches!(s, State::Pending | State::Listed);
        (0..).map(Slot).zip(&self.states).filter(move |(_, s)| is_present(s)).map(|(slot, _)| slot)
    }

    /// Puts a box into a vacant slot, pending.
    pub(crate) fn add(
        &mut self,
        id: ProxyId,
        aabb: Aabb,
        motion: Motion,
    ) -> Result<Slot, BroadPhaseError> {
        let Entry::Vacant(entry) = self.slot_of.entry(id) else {
            return Err(BroadPhaseError::DuplicateProxy { id });
        };
        let slot = if let Some(slot) = self.vacant.pop() {
            slot
        } else {
            let next = u32::try_from(self.ids.len()).ok().filter(|&next| next < MAX_SLOTS);
            let slot = Slot(next.ok_or(BroadPhaseError::Full { id, max: MAX_SLOTS })?);
            self.ids.push(id);
            self.states.push(State::Vacant);
            self.motions.push(motion);
            self.boxes.push(aabb);
            self.boxes_before.push(aabb);
            self.changes.push(Change::default());
            slot
        };
        entry.insert(slot);
        let i = slot.index();
        (self.ids[i], self.states[i], self.motions[i]) = (id, State::Pending, motion);
        (self.boxes[i], self.boxes_before[i]) = (aabb, aabb);
        self.note(slot, Change::CAME_OR_WENT);
        Ok(slot)
    }

    /// Forgets the id, so that it can be used again, and marks the slot to be vacated.
    pub(crate) fn discard(&mut self, id: ProxyId) -> Result<Slot, BroadPhaseError> {
        let slot = self.slot_of.remove(&id).ok_or(BroadPhaseError::UnknownProxy { id })?;
        let state = &mut self.states[slot.index()];
        *state = if *state == State::Listed { State::Doomed } else { State::Withdrawn };
        self.note(slot, Change::CAME_OR_WENT);
        Ok(slot)
    }

    /// Gives a slot another box.
    pub(crate) fn set_box(&mut self, slot: Slot, aabb: Aabb) {
        if self.boxes[slot.index()] != aabb {
            self.boxes[slot.index()] = aabb;
            self.note(slot, Change::MOVED);
        }
    }

    /// Gives a slot another kind.
    pub(crate) fn set_motion(&mut self, slot: Slot, motion: Motion) {
        if self.motions[slot.index()] != motion {
            self.motions[slot.index()] = motion;
            self.note(slot, Change::SWITCHED);
        }
    }

    fn note(&mut self, slot: Slot, change: Change) {
        let so_far = &mut self.changes[slot.index()];
        if *so_far == Change::default() {
            self.changed.push(slot);
        }
        *so_far = so_far.and(change);
    }

    /// All that changed since the last update.
    pub(crate) fn changed(&self) -> &[Slot] {
        &self.changed
    }

    fn changed_with(&self, state: State, has: impl Fn(Change) -> bool) -> Vec<Slot> {
        let is =
            |slot: &Slot| self.states[slot.index()] == state && has(self.changes[slot.index()]);
        self.changed.iter().copied().filter(is).collect()
    }

    /// What enters the index at this update.
    pub(crate) fn pending(&self) -> Vec<Slot> {
        self.changed_with(State::Pending, |_| true)
    }

    /// What leaves the index at this update.
    pub(crate) fn doomed(&self) -> Vec<Slot> {
        self.changed_with(State::Doomed, |_| true)
    }

    /// What stays in the index and has another box.
    pub(crate) fn moved(&self) -> Vec<Slot> {
        self.changed_with(State::Listed, |change| change.moved)
    }

    /// What stays in the index and was switched to this kind (or forth and back).
    pub(crate) fn switched_to(&self, motion: Motion) -> Vec<Slot> {
        let mut switched = self.changed_with(State::Listed, |change| change.switched);
        switched.retain(|slot| self.motions[slot.index()] == motion);
        switched
    }

    /// Makes what is now what was before, and frees the slots of boxes that left.
    pub(crate) fn close(&mut self) {
        for slot in self.changed.drain(..) {
            let i = slot.index();
            self.changes[i] = Change::default();
            self.boxes_before[i] = self.boxes[i];
            match self.states[i] {
                State::Pending => self.states[i] = State::Listed,
                State::Withdrawn | State::Doomed => {
                    self.states[i] = State::Vacant;
                    self.vacant.push(slot);
                }
                State::Listed | State::Vacant => {}
            }
        }
    }

    /// The pairs as of now, packed and sorted, by looking at all.
    pub(crate) fn true_pairs(&self) -> Vec<u64> {
        let present: Vec<Slot> = self.present().collect();
        let mut pairs = Vec::new();
        for (i, &a) in present.iter().enumerate() {
            pairs.extend(
                present[i + 1..].iter().filter(|&&b| self.is_pair(a, b)).map(|&b| self.key(a, b)),
            );
        }
        pairs.sort_unstable();
        pairs
    }

    /// Whether two boxes overlap and are of kinds that can be a pair.
    pub(crate) fn is_pair(&self, a: Slot, b: Slot) -> bool {
        self.can_pair(a, b) && self.boxes[a.index()].overlaps(&self.boxes[b.index()])
    }

    /// Two slots' ids as one number.
    pub(crate) fn key(&self, a: Slot, b: Slot) -> u64 {
        pack(self.ids[a.index()], self.ids[b.index()])
    }

    /// Whether two boxes of these slots, if they overlap, are a pair.
    pub(crate) fn can_pair(&self, a: Slot, b: Slot) -> bool {
        self.motions[a.index()].pairs_with(self.motions[b.index()])
    }
}

/// Spreads ids by one multiplication (Knuth 1973, section 6.4): lookups are frequent, ids are the
/// program's own, and the result decides no order.
#[derive(Clone, Debug, Default)]
pub(crate) struct IdHasher(u64);

/// 2^64 divided by the golden ratio, odd.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

impl Hasher for IdHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u32(u32::from(byte));
        }
    }

    fn write_u32(&mut self, number: u32) {
        let product = (self.0 ^ u64::from(number)).wrapping_mul(GOLDEN);
        self.0 = product ^ (product >> 32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_can_be_used_again_before_its_slot_is() {
        let mut slots = Slots::default();
        let add = |slots: &mut Slots, id| slots.add(ProxyId(id), Aabb::EMPTY, Motion::Moving);
        let first = add(&mut slots, 5).expect("new");
        assert_eq!(add(&mut slots, 5), Err(BroadPhaseError::DuplicateProxy { id: ProxyId(5) }));
        slots.discard(ProxyId(5)).expect("known");
        assert_eq!(slots.states[first.index()], State::Withdrawn);
        let second = add(&mut slots, 5).expect("known no longer");
        assert_ne!(first, second);
        slots.close();
        assert_eq!(slots.states[second.index()], State::Listed);
        assert_eq!(add(&mut slots, 6), Ok(first));
        assert_eq!(slots.len(), 2);
    }
}
