//! The sorted set of overlapping pairs, and its change from one update to the next.
//!
//! A pair is dropped when its boxes part, in three steps, each with its own owner:
//!
//! 1. An index notices it: `SweepAndPrune` at a crossing of end points (`Crossing::Parted`, in
//!    `sweep_and_prune`), or where it is sorted anew since much has jumped (`SortedAxes::admit`),
//!    `BoxTree` where a candidate no longer overlaps (`judge`, in `box_tree`).
//!    `PairKeeper` ends the pairs of what was removed or has become stationary.
//! 2. [`PairSet::apply`] takes it out of the set and makes [`OverlapEvent::Ended`] of it.
//! 3. Whoever keeps something about pairs forgets it: `World::update_pairs` of `cranny-world` the
//!    memory of its queries. rapier has a broad phase of its own, so `Simulation::forget_parted` of
//!    `cranny-rapier` (`simulation/stepping.rs`) drops answers and searches of the pairs that
//!    rapier has dropped, once these are the greater part of what is kept.

use crate::{OverlapEvent, OverlapPair, ProxyId};

/// A pair as one number whose order is the order of the pairs: lower id above, higher id below.
pub(crate) fn pack(a: ProxyId, b: ProxyId) -> u64 {
    let (low, high) = if a < b { (a.0, b.0) } else { (b.0, a.0) };
    u64::from(low) << 32 | u64::from(high)
}

fn packed(pair: OverlapPair) -> u64 {
    u64::from(pair.0.0) << 32 | u64::from(pair.1.0)
}

fn unpack(pair: u64) -> OverlapPair {
    #[expect(clippy::cast_possible_truncation, reason = "the two halves are 32 bits each")]
    (ProxyId((pair >> 32) as u32), ProxyId(pair as u32))
}

/// Pairs in a sorted array: iteration is in order by nature, and an update costs one merge, which
/// copies whole runs between the few places that change.
#[derive(Clone, Debug, Default)]
pub struct PairSet {
    pairs: Vec<OverlapPair>,
    spare: Vec<OverlapPair>,
}

impl PairSet {
    /// The pairs, sorted.
    pub(crate) fn as_slice(&self) -> &[OverlapPair] {
        &self.pairs
    }

    /// Takes out what is in `ended`, then puts in what is in `began`, and writes the *difference*
    /// of the set after and before to `events`, sorted.
    ///
    /// Both lists may be unsorted, hold a pair many times, and hold pairs that are absent or
    /// present already; a pair in both is present afterwards. So a caller need only see to it that
    /// `began` holds nothing but true pairs and all new ones, and `ended` all that are gone.
    pub(crate) fn apply(
        &mut self,
        began: &mut Vec<u64>,
        ended: &mut Vec<u64>,
        events: &mut Vec<OverlapEvent>,
    ) {
        events.clear();
        if began.is_empty() && ended.is_empty() {
            return;
        }
        for list in [&mut *began, &mut *ended] {
            list.sort_unstable();
            list.dedup();
        }
        self.spare.clear();
        let (mut old, mut b, mut e) = (0, 0, 0);
        while b < began.len() || e < ended.len() {
            let next_began = began.get(b).copied();
            let next_ended = ended.get(e).copied();
            let (is, key) = match (next_began, next_ended) {
                (Some(x), Some(y)) => (x <= y, x.min(y)),
                (Some(x), None) => (true, x),
                (None, y) => (false, y.unwrap_or(u64::MAX)),
            };
            b += usize::from(next_began == Some(key));
            e += usize::from(next_ended == Some(key));
            let run = old + self.pairs[old..].partition_point(|&p| packed(p) < key);
            self.spare.extend_from_slice(&self.pairs[old..run]);
            old = run;
            let was = self.pairs.get(old).is_some_and(|&p| packed(p) == key);
            old += usize::from(was);
            let pair = unpack(key);
            if is {
                self.spare.push(pair);
            }
            match (was, is) {
                (false, true) => events.push(OverlapEvent::Began(pair.0, pair.1)),
                (true, false) => events.push(OverlapEvent::Ended(pair.0, pair.1)),
                _ => {}
            }
        }
        self.spare.extend_from_slice(&self.pairs[old..]);
        std::mem::swap(&mut self.pairs, &mut self.spare);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use OverlapEvent::{Began, Ended};

    fn key(a: u32, b: u32) -> u64 {
        pack(ProxyId(a), ProxyId(b))
    }

    fn apply(set: &mut PairSet, began: &[u64], ended: &[u64]) -> Vec<OverlapEvent> {
        let mut events = vec![Began(ProxyId(9), ProxyId(9))]; // stale
        set.apply(&mut began.to_vec(), &mut ended.to_vec(), &mut events);
        events
    }

    #[test]
    fn packing_orders_as_pairs_do() {
        assert_eq!(key(7, 3), key(3, 7));
        assert!(key(3, u32::MAX) < key(4, 5));
        assert_eq!(unpack(key(u32::MAX, 3)), (ProxyId(3), ProxyId(u32::MAX)));
    }

    #[test]
    fn events_are_the_difference_and_nothing_else() {
        let mut set = PairSet::default();
        let id = ProxyId;
        let events = apply(&mut set, &[key(5, 1), key(0, 9), key(1, 5)], &[key(2, 3)]);
        assert_eq!(events, [Began(id(0), id(9)), Began(id(1), id(5))]);
        // (1, 5) is in both lists: it stays, and that is no event.
        let events = apply(&mut set, &[key(1, 5), key(1, 2)], &[key(0, 9), key(1, 5)]);
        assert_eq!(events, [Ended(id(0), id(9)), Began(id(1), id(2))]);
        assert_eq!(set.as_slice(), [(id(1), id(2)), (id(1), id(5))]);
        assert_eq!(apply(&mut set, &[], &[]), []);
    }
}
