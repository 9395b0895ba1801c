//! Sorted axes while little is out of order, a tree of fat boxes while much is.
//!
//! What an update costs the axes is the number of swaps, and they count them. While the tree is in
//! use nobody swaps; then their number is estimated from how far the boxes moved, at as many swaps
//! for a way as were counted last. Some updates in a row must agree before the index is changed,
//! and the way back begins at half the load: a scene between the two keeps what it has.

use crate::InvariantError;
use crate::box_tree::FatTree;
use crate::index::{Found, Index};
use crate::pairs::PairSet;
use crate::slots::Slots;
use crate::sweep_and_prune::SortedAxes;

/// The back end of [`BroadPhase`](crate::BroadPhase) for scenes of which nothing is known: a
/// [`SweepAndPrune`](crate::SweepAndPrune) that turns into a [`BoxTree`](crate::BoxTree) where many
/// boxes move past many others, and back.
///
/// Which of the two is in use depends on the calls alone, never on a clock, and pairs and events do
/// not depend on it. A change costs about what inserting all boxes does.
pub type AdaptiveBroadPhase = crate::PairKeeper<Adaptive>;

/// Swaps a box and update from which the tree is the better index. Smaller: trees in calm scenes,
/// where a pass over the candidates costs more than the swaps; larger: axes that are mostly
/// sorting. Measured by `cargo run --release -p cranny-bench -- broad`.
const TREE_FROM: f64 = 0.4;

/// Swaps a box and update up to which the axes are, once the tree is in use.
const AXES_UP_TO: f64 = 0.5 * TREE_FROM;

/// How many times the load from which the tree is better a sorting anew is taken to stand for, in
/// case swaps were never counted. Smaller: back to the axes while things still fly about; larger:
/// never back.
const UNCOUNTED: f64 = 8.0;

/// Updates in a row that must agree. Smaller: one jolt changes the index; larger: it follows late.
const AGREEING: u32 = 8;

/// Sorted axes or a tree, by what the updates so far have shown.
#[derive(Clone, Debug, Default)]
pub struct Adaptive {
    index: Either,
    /// Swaps for each unit of way, over all boxes and axes, as last counted.
    swaps_a_way: f64,
    /// Updates in a row that spoke for the other index.
    agreeing: u32,
}

#[derive(Clone, Debug)]
enum Either {
    Axes(Box<SortedAxes>),
    Tree(Box<FatTree>),
}

impl Default for Either {
    fn default() -> Self {
        Self::Axes(Box::default())
    }
}

impl Adaptive {
    /// Takes note of an update, and whether it speaks for the other index.
    fn speaks_against(&mut self, slots: &Slots, found: &Found) -> bool {
        let (boxes, way) = (slots.len() as f64, way(slots));
        match self.index {
            Either::Axes(_) if found.counters.rebuilds > 0 => {
                // Sorted anew: more swaps than were worth counting.
                if way > 0.0 {
                    let at_least = UNCOUNTED * TREE_FROM * boxes / way;
                    self.swaps_a_way = self.swaps_a_way.max(at_least);
                }
                true
            }
            Either::Axes(_) => {
                let swaps = found.counters.swaps as f64;
                if way > 0.0 {
                    self.swaps_a_way = swaps / way;
                }
                swaps > TREE_FROM * boxes
            }
            Either::Tree(_) => self.swaps_a_way * way < AXES_UP_TO * boxes,
        }
    }
}

/// How far the boxes moved in this update, summed over boxes, axes and faces. A box that went from
/// or to infinity counts for nothing.
fn way(slots: &Slots) -> f64 {
    let mut way = 0.0;
    for slot in slots.moved() {
        let (was, is) = (&slots.boxes_before[slot.index()], &slots.boxes[slot.index()]);
        let moved = (is.min - was.min).abs() + (is.max - was.max).abs();
        let moved = moved.element_sum();
        way += if moved.is_finite() { moved } else { 0.0 };
    }
    way
}

impl Index for Adaptive {
    fn follow(&mut self, slots: &Slots, pairs: &PairSet, found: &mut Found) {
        match &mut self.index {
            Either::Axes(axes) => axes.follow(slots, pairs, found),
            Either::Tree(tree) => tree.follow(slots, pairs, found),
        }
        self.agreeing = if self.speaks_against(slots, found) { self.agreeing + 1 } else { 0 };
        if self.agreeing == AGREEING {
            self.agreeing = 0;
            self.index = match self.index {
                Either::Axes(_) => Either::Tree(Box::new(FatTree::of(slots))),
                Either::Tree(_) => Either::Axes(Box::new(SortedAxes::of(slots))),
            };
        }
        found.counters.tree = u64::from(matches!(self.index, Either::Tree(_)));
    }

    fn validate(&self, slots: &Slots) -> Result<(), InvariantError> {
        match &self.index {
            Either::Axes(axes) => axes.validate(slots),
            Either::Tree(tree) => tree.validate(slots),
        }
    }
}
