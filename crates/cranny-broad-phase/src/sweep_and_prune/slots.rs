//! Where the boxes are kept: a dense array of slots, and the way from a caller's id to its slot.

use crate::{BroadPhaseError, Motion, ProxyId};
use cranny_exact::Aabb;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::{BuildHasherDefault, Hasher};

/// Index of a box in the arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Slot(pub(super) u32);

impl Slot {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// The most boxes that fit: end points are counted in 32 bits, two a box.
pub(super) const MAX_SLOTS: u32 = 1 << 31;

/// What becomes of a slot at the next update.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// Nothing: free for another box.
    Vacant,
    /// Its end points enter the axes.
    Pending,
    /// It stays on the axes.
    Listed,
    /// It was removed before it was ever listed.
    Withdrawn,
    /// Its end points leave the axes.
    Doomed,
}

/// The boxes, by slot.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots {
    slot_of: HashMap<ProxyId, Slot, BuildHasherDefault<IdHasher>>,
    pub(super) ids: Vec<ProxyId>,
    pub(super) states: Vec<State>,
    pub(super) motions: Vec<Motion>,
    /// As last set by the caller.
    pub(super) boxes: Vec<Aabb>,
    /// As of the last update; equal to `boxes` unless the slot awaits the next one.
    pub(super) boxes_before: Vec<Aabb>,
    vacant: Vec<Slot>,
}

impl Slots {
    pub(super) fn len(&self) -> usize {
        self.slot_of.len()
    }

    pub(super) fn find(&self, id: ProxyId) -> Option<Slot> {
        self.slot_of.get(&id).copied()
    }

    pub(super) fn get(&self, id: ProxyId) -> Result<Slot, BroadPhaseError> {
        self.find(id).ok_or(BroadPhaseError::UnknownProxy { id })
    }

    /// All slots in the given state, in order.
    pub(super) fn in_state(&self, state: State) -> impl Iterator<Item = Slot> + '_ {
        (0..).map(Slot).zip(&self.states).filter(move |(_, s)| **s == state).map(|(slot, _)| slot)
    }

    /// Puts a box into a vacant slot, pending.
    pub(super) fn add(
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
            slot
        };
        entry.insert(slot);
        let i = slot.index();
        (self.ids[i], self.states[i], self.motions[i]) = (id, State::Pending, motion);
        (self.boxes[i], self.boxes_before[i]) = (aabb, aabb);
        Ok(slot)
    }

    /// Forgets the id, so that it can be used again, and marks the slot to be vacated.
    pub(super) fn discard(&mut self, id: ProxyId) -> Result<Slot, BroadPhaseError> {
        let slot = self.slot_of.remove(&id).ok_or(BroadPhaseError::UnknownProxy { id })?;
        let state = &mut self.states[slot.index()];
        *state = if *state == State::Listed { State::Doomed } else { State::Withdrawn };
        Ok(slot)
    }

    /// Frees a discarded slot.
    pub(super) fn vacate(&mut self, slot: Slot) {
        self.states[slot.index()] = State::Vacant;
        self.vacant.push(slot);
    }

    /// Whether two boxes of these slots, if they overlap, are a pair.
    pub(super) fn can_pair(&self, a: Slot, b: Slot) -> bool {
        self.motions[a.index()].pairs_with(self.motions[b.index()])
    }
}

/// Spreads ids by one multiplication (Knuth 1973, section 6.4): lookups are frequent, ids are the
/// program's own, and the result decides no order.
#[derive(Clone, Debug, Default)]
pub(super) struct IdHasher(u64);

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
        slots.vacate(first);
        assert_eq!(add(&mut slots, 6), Ok(first));
        assert_eq!(slots.len(), 2);
    }
}
