//! The front: where the last descent of two trees ended, kept from frame to frame.
//!
//! A descent ends at pairs of nodes whose boxes are apart, and at pairs of leaves. Each of them has a
//! separation of which motion takes only so much in a frame, so most need not be looked at again: what
//! has slack rests. Slack is counted in [`block`]s of neighbouring entries by [`motion`] bounds; only
//! blocks in which some slack may be spent are opened, spent entries are tested again, and those
//! that have come too near are opened in their turn. What has grown too fine is found anew from the
//! roots of its block. (Li and Chen, 'Incremental 3D collision detection with hierarchical data
//! structures', 1998, keep such a front of a traversal; Mirtich's and Hubbard's time-critical queues
//! rest what has slack.)
//!
//! A front holds no answers: whatever meets is looked at in every frame. So it saves time only, and what
//! is found is what a descent from the top finds.
//!
//! Cost of a frame: one odometer a block, and what is spent. Where that is half of what a descent costs,
//! the front tells so ([`Front::is_exhausted`]) and the descent is made instead ([`Pace`]).

mod block;
pub(crate) mod coherent;
pub(crate) mod motion;
#[cfg(test)]
mod promises;
mod quests;

use cranny_exact::RigidMap;
use cranny_geometry::FaceId;

use self::block::{Block, Entry, build};
pub(crate) use self::block::{Ground, Nodes};
use self::motion::Motion;
pub(crate) use self::quests::gap_along_normals;
use crate::answer::Counters;
use crate::descent::BoxTest;
use crate::pair::{Pair, Side};

/// What is asked of pairs of leaves, and which gaps matter.
pub(crate) trait Quest {
    /// What is farther apart than this does not matter.
    fn limit(&self) -> f64;

    /// Looks at the faces of two leaves; returns a lower bound of their separation, 0 where they meet.
    fn leaves(&mut self, first: &[FaceId], second: &[FaceId], counters: &mut Counters) -> f64;

    /// Whether enough is known.
    fn is_done(&self) -> bool;
}

/// A front of more entries is not kept: 24 bytes each.
const MOST_ENTRIES: usize = 4 << 20;

/// A descent tests two pairs of nodes for each entry that it leaves. A spent entry costs itself and, as it
/// opens, about four more: one in so many spent is half of a descent. Fewer: what could have rested is
/// looked for from the top; more: fast motion pays for memory that it cannot use.
const SPENT_SHARE: usize = 5;

/// Blocks are merged, by a descent from the top, when they hold fewer entries than this on average, a
/// quarter of what fits. (After a descent, any two neighbours together hold more than a block does.)
const SPARSE: usize = block::CAPACITY / 4;

/// Where a descent ended.
#[derive(Clone, Debug)]
pub(crate) struct Front {
    /// The relative pose up to which odometers have counted.
    map: RigidMap,
    blocks: Vec<Block>,
    entries: usize,
}

pub(crate) fn ground<'a>(pair: &Pair<'a>) -> Ground<'a> {
    Ground {
        trees: Side::BOTH.map(|side| pair.model(side).tree()),
        boxes: BoxTest::of(pair),
        error: pair.culling_error(),
    }
}

impl Front {
    /// Descends from the top and keeps where that ends; `None` if the quest ended it.
    pub(crate) fn of(pair: &Pair, quest: &mut impl Quest, counters: &mut Counters) -> Option<Self> {
        let blocks = build(&ground(pair), std::iter::once([0, 0]), quest, counters);
        let entries = blocks.iter().map(|b| b.entries.len()).sum();
        let kept = !quest.is_done() && entries <= MOST_ENTRIES;
        kept.then_some(Self { map: pair.first_from_second, blocks, entries })
    }

    /// Counts the motion to the pair's pose; once a query.
    pub(crate) fn advance(&mut self, pair: &Pair) {
        let motion = Motion::since(&self.map, pair);
        for block in &mut self.blocks {
            block.advance(motion.as_ref());
        }
        self.map = pair.first_from_second;
    }

    /// Whether what is spent costs more than half of what a descent does.
    pub(crate) fn is_exhausted(&self, pair: &Pair, limit: f64) -> bool {
        let error = pair.culling_error();
        let bearable = self.entries / SPENT_SHARE;
        let mut spent = 0;
        for block in &self.blocks {
            spent += block.spent_entries(limit, error);
            if spent > bearable {
                return true;
            }
        }
        self.entries > MOST_ENTRIES
    }

    /// Whether blocks have become so many for what they hold that a descent from the top pays.
    pub(crate) fn is_sparse(&self) -> bool {
        self.blocks.len() > 8 && self.entries < SPARSE * self.blocks.len()
    }

    /// Looks at all that may have come within the quest's limit. Returns whether the bodies can be moved
    /// here from the last pose without faces that meet.
    pub(crate) fn refresh(
        &mut self,
        pair: &Pair,
        quest: &mut impl Quest,
        counters: &mut Counters,
    ) -> bool {
        let ground = ground(pair);
        let mut kept: Vec<Entry> = Vec::new();
        let mut unbroken = true;
        // Blocks that come of others stand behind; they are fresh.
        for i in 0..self.blocks.len() {
            if quest.is_done() {
                return false;
            }
            let block = &mut self.blocks[i];
            if !block.is_spent(quest.limit(), ground.error) {
                continue;
            }
            let before = block.entries.len();
            if block.is_worn() {
                let mut fresh = build(&ground, block.roots(), quest, counters);
                unbroken = false;
                counters.front_rebuilt += 1;
                if quest.is_done() {
                    return false;
                }
                let now = fresh.iter().map(|b| b.entries.len()).sum::<usize>();
                self.entries += now;
                counters.front_merged += before.saturating_sub(now) as u64;
                let first = fresh.swap_remove(0);
                self.blocks[i] = first;
                self.blocks.append(&mut fresh);
            } else {
                let opening = block.refresh(&ground, quest, &mut kept, counters);
                counters.front_tested += opening.tested as u64;
                counters.front_split += opening.split as u64;
                unbroken &= opening.unbroken;
                self.entries += block.entries.len();
            }
            self.entries -= before;
        }
        unbroken && !quest.is_done()
    }

    /// How many pairs of nodes it has.
    pub(crate) fn held(&self) -> u64 {
        self.entries as u64
    }

    /// Whether odometers have counted up to this pose.
    pub(crate) fn is_at(&self, pair: &Pair) -> bool {
        self.map == pair.first_from_second
    }

    /// Its pairs of nodes, and how far apart they are at least, but for what posing may have eaten.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (Nodes, f64)> + '_ {
        self.blocks.iter().flat_map(|block| {
            let rest = |entry: &Entry| (entry.nodes, (entry.key - block.odometer).next_down());
            block.entries.iter().map(rest)
        })
    }

    pub(crate) fn bytes(&self) -> usize {
        self.blocks.iter().map(Block::bytes).sum()
    }
}
