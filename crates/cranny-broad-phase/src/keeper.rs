//! What all back ends share: boxes in, pairs and events out, with an index between.

use crate::error::checked_box;
use crate::index::{Found, Index};
use crate::pairs::{PairSet, pack};
use crate::slots::{Slot, Slots};
use crate::{
    BroadPhase, BroadPhaseCounters, BroadPhaseError, InvariantError, Motion, OverlapEvent,
    OverlapPair, ProxyId,
};
use cranny_exact::Aabb;

/// A [`BroadPhase`] over an index: [`SweepAndPrune`](crate::SweepAndPrune),
/// [`BoxTree`](crate::BoxTree) or [`AdaptiveBroadPhase`](crate::AdaptiveBroadPhase).
#[derive(Clone, Debug, Default)]
pub struct PairKeeper<I> {
    slots: Slots,
    index: I,
    pairs: PairSet,
    events: Vec<OverlapEvent>,
    found: Found,
}

impl<I: Index> PairKeeper<I> {
    /// Ends the pairs of removed proxies.
    fn expel(&mut self) {
        let mut gone = self.ids(&self.slots.doomed());
        if gone.is_empty() {
            return;
        }
        gone.sort_unstable();
        let is_gone = |id| gone.binary_search(&id).is_ok();
        let lost = self.pairs.as_slice().iter().filter(|pair| is_gone(pair.0) || is_gone(pair.1));
        self.found.ended.extend(lost.map(|pair| pack(pair.0, pair.1)));
    }

    /// Ends the pairs between proxies that are stationary by now.
    fn settle(&mut self) {
        let mut settled = self.ids(&self.slots.switched_to(Motion::Stationary));
        if settled.is_empty() {
            return;
        }
        settled.sort_unstable();
        let has_settled = |id| settled.binary_search(&id).is_ok();
        let Self { slots, pairs, found, .. } = self;
        let is_still = |slot: Slot| slots.motions[slot.index()] == Motion::Stationary;
        let at_rest = |id| slots.find(id).is_none_or(is_still);
        let lost = pairs.as_slice().iter().filter(|pair| {
            (has_settled(pair.0) || has_settled(pair.1)) && at_rest(pair.0) && at_rest(pair.1)
        });
        found.ended.extend(lost.map(|pair| pack(pair.0, pair.1)));
    }

    fn ids(&self, slots: &[Slot]) -> Vec<ProxyId> {
        slots.iter().map(|slot| self.slots.ids[slot.index()]).collect()
    }
}

impl<I: Index> BroadPhase for PairKeeper<I> {
    fn insert(&mut self, id: ProxyId, aabb: Aabb, motion: Motion) -> Result<(), BroadPhaseError> {
        self.slots.add(id, checked_box(id, aabb)?, motion).map(drop)
    }

    fn remove(&mut self, id: ProxyId) -> Result<(), BroadPhaseError> {
        self.slots.discard(id).map(drop)
    }

    fn set_box(&mut self, id: ProxyId, aabb: Aabb) -> Result<(), BroadPhaseError> {
        let slot = self.slots.get(id)?;
        self.slots.set_box(slot, checked_box(id, aabb)?);
        Ok(())
    }

    fn set_moving(&mut self, id: ProxyId, motion: Motion) -> Result<(), BroadPhaseError> {
        let slot = self.slots.get(id)?;
        self.slots.set_motion(slot, motion);
        Ok(())
    }

    fn update(&mut self) -> &[OverlapEvent] {
        self.found.counters =
            BroadPhaseCounters { changed: self.slots.changed().len() as u64, ..Default::default() };
        self.expel();
        self.settle();
        self.index.follow(&self.slots, &self.pairs, &mut self.found);
        let Found { began, ended, .. } = &mut self.found;
        self.pairs.apply(began, ended, &mut self.events);
        self.slots.close();
        began.clear();
        ended.clear();
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
        self.found.counters
    }

    fn validate(&self) -> Result<(), InvariantError> {
        self.index.validate(&self.slots)?;
        let sorted = self.pairs.as_slice().windows(2).all(|two| two[0] < two[1]);
        InvariantError::unless(sorted, || "the pairs are not sorted".into())?;
        if !self.slots.changed().is_empty() {
            return Ok(());
        }
        let expected = self.slots.true_pairs();
        let held = self.pairs.as_slice().iter().map(|pair| pack(pair.0, pair.1));
        InvariantError::unless(held.eq(expected.iter().copied()), || {
            let (held, true_pairs) = (self.pairs.as_slice().len(), expected.len());
            format!("{held} pairs are held; brute force finds {true_pairs}, or others")
        })
    }
}
