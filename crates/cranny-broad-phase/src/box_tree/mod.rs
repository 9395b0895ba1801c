//! A tree of fat boxes, and the pairs of them that overlap: parry's `Bvh`, made exact.
//!
//! Every proxy has a *fat box*: its own, in single precision rounded outward, with room to move in. As
//! long as a box stays within its fat box neither the tree nor the list of *candidates* (pairs of
//! proxies whose fat boxes overlap) is touched; an update then is one pass over the candidates that
//! compares the boxes themselves, in double precision. A box that leaves gets a new fat box, with
//! room for several updates like the last one, and its candidates are searched for anew: one by one
//! where few have left, by one walk of the tree against itself where many have.
//!
//! The idea of room is the usual one (Catto 2019, 'Dynamic Bounding Volume Hierarchies'); that it
//! follows each body's own speed makes leaving rare for slow things and candidates few.

mod fat;

use crate::index::{Found, Index};
use crate::pairs::PairSet;
use crate::slots::{Slot, Slots, State};
use crate::{InvariantError, Motion};
use fat::{fattened, holds, rounded};
use parry3d::bounding_volume::{Aabb as FatBox, BoundingVolume};
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use std::fmt;

/// The box-tree back end of [`BroadPhase`](crate::BroadPhase).
///
/// Costs of an update, with n boxes, c candidates and p pairs: c, if anything changed; for each box
/// that comes or leaves its fat box, about log n; if many do, n; if very many do, n log n; any event, a
/// copy of p. Memory: about 150 bytes a box and 8 a candidate.
pub type BoxTree = crate::PairKeeper<FatTree>;

/// New fat boxes are put into the tree and searched for one by one, unless more than one in so many
/// is new: then the tree is walked against itself once. Smaller: single searches for many; larger: whole
/// walks for few.
const WALK_SHARE: usize = 12;

/// If more than one in so many fat boxes is new, the tree is built anew. Smaller: a poor tree after a
/// teleport; larger: building where a walk would do.
const BUILD_SHARE: usize = 3;

/// What the tree grows a fat box by where it is to note the change; far below the room.
const NOTED: f32 = f32::MIN_POSITIVE;

/// Two proxies whose fat boxes overlap and whose kinds can be a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate(Slot, Slot);

/// Fat boxes in a tree, and which of them overlap.
#[derive(Clone, Default)]
pub struct FatTree {
    /// Leaves are numbered by slot.
    tree: Bvh,
    workspace: BvhWorkspace,
    /// By slot; meaningless for slots that are not in the tree.
    fat: Vec<FatBox>,
    candidates: Vec<Candidate>,
    /// By slot; between updates all are [`Fate::Kept`].
    fates: Vec<Fate>,
    /// Fat boxes in the tree.
    leaves: usize,
    /// Fat boxes that were put elsewhere since the tree was last built.
    renewed: usize,
}

/// What becomes of a slot's candidates in this update.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Fate {
    /// Nothing: its box is where it was.
    #[default]
    Kept,
    /// Its box moved within its fat box: they are looked at.
    Moved,
    /// It has a new fat box: they are searched for anew.
    Renewed,
    /// It may have more partners than before: they are searched for anew.
    Woken,
    /// It leaves, and they with it.
    Gone,
}

impl FatTree {
    /// An index over all boxes that are present.
    pub(crate) fn of(slots: &Slots) -> Self {
        let mut index = Self::default();
        index.make_room(slots);
        let present: Vec<Slot> = slots.present().collect();
        for slot in &present {
            let i = slot.index();
            index.fat[i] = fattened(&slots.boxes_before[i], &slots.boxes[i]);
        }
        index.leaves = present.len();
        index.build(slots, &mut Found::default());
        index
    }

    fn make_room(&mut self, slots: &Slots) {
        let nowhere = FatBox { mins: Vector::ZERO, maxs: Vector::ZERO };
        self.fat.resize(slots.ids.len(), nowhere);
        self.fates.resize(slots.ids.len(), Fate::Kept);
    }

    fn fate(&self, slot: Slot) -> Fate {
        self.fates[slot.index()]
    }

    /// Decides what becomes of every changed slot.
    fn decide(&mut self, slots: &Slots) -> Changes {
        self.make_room(slots);
        let (mut renewed, mut woken) = (slots.pending(), slots.switched_to(Motion::Moving));
        for slot in slots.moved() {
            let i = slot.index();
            if holds(&self.fat[i], &rounded(&slots.boxes[i])) {
                self.fates[i] = Fate::Moved;
            } else {
                renewed.push(slot);
            }
        }
        for slot in &renewed {
            let i = slot.index();
            self.fates[i] = Fate::Renewed;
            self.fat[i] = fattened(&slots.boxes_before[i], &slots.boxes[i]);
        }
        woken.retain(|&slot| self.fate(slot) != Fate::Renewed);
        woken.iter().for_each(|slot| self.fates[slot.index()] = Fate::Woken);
        let gone = slots.doomed();
        for slot in &gone {
            self.fates[slot.index()] = Fate::Gone;
            self.tree.remove(slot.0);
        }
        self.leaves = self.leaves + slots.pending().len() - gone.len();
        Changes { renewed, woken }
    }

    /// Compares the boxes of all candidates of which one has moved, and drops those that are searched
    /// for anew or can be no pair by now.
    fn judge(&mut self, slots: &Slots, found: &mut Found) {
        let Self { candidates, fates, .. } = self;
        candidates.retain(|&Candidate(a, b)| {
            let (i, j) = (a.index(), b.index());
            let is = |fate| fates[i] == fate || fates[j] == fate;
            if fates[i] == Fate::Kept && fates[j] == Fate::Kept {
                return slots.can_pair(a, b);
            }
            if is(Fate::Gone) {
                return false;
            }
            found.counters.box_tests += 1;
            let did = slots.boxes_before[i].overlaps(&slots.boxes_before[j]);
            if is(Fate::Renewed) || is(Fate::Woken) {
                if did {
                    found.ended.push(slots.key(a, b));
                }
                return false;
            }
            if !slots.can_pair(a, b) {
                return false;
            }
            let does = slots.boxes[i].overlaps(&slots.boxes[j]);
            if did != does {
                let list = if does { &mut found.began } else { &mut found.ended };
                list.push(slots.key(a, b));
            }
            true
        });
    }

    /// Brings new fat boxes into the tree and finds the candidates of what is to be searched for anew.
    fn renew(&mut self, changes: &Changes, slots: &Slots, found: &mut Found) {
        let Changes { renewed, woken } = changes;
        self.renewed += renewed.len();
        let share = |of: usize| renewed.len() * of > self.leaves;
        if share(BUILD_SHARE) || self.renewed > self.leaves {
            self.build(slots, found);
            return;
        }
        if share(WALK_SHARE) {
            for slot in renewed {
                self.tree.insert_or_update_partially(self.fat[slot.index()], slot.0, NOTED);
            }
            self.tree.refit(&mut self.workspace);
            self.walk::<true>(slots, found);
        } else {
            for slot in renewed {
                self.tree.insert(self.fat[slot.index()], slot.0);
            }
            renewed.iter().for_each(|&slot| self.search(slot, slots, found));
        }
        woken.iter().for_each(|&slot| self.search(slot, slots, found));
    }

    /// Finds all candidates by a new tree.
    fn build(&mut self, slots: &Slots, found: &mut Found) {
        let leaves = slots.present().map(|slot| (slot.index(), self.fat[slot.index()]));
        if self.leaves > 2 {
            self.tree = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        } else {
            // Of one or two leaves, parry 0.31's builder takes the numbers to be 0 and 1.
            self.tree = Bvh::new();
            leaves.for_each(|(leaf, fat)| self.tree.insert(fat, leaf as u32));
        }
        self.renewed = 0;
        found.counters.rebuilds = 1;
        self.candidates.clear();
        self.walk::<false>(slots, found);
    }

    /// Finds candidates by walking the tree against itself: all, or those of slots with new fat boxes.
    fn walk<const NEW_ONLY: bool>(&mut self, slots: &Slots, found: &mut Found) {
        let Self { tree, workspace, candidates, fates, .. } = self;
        tree.traverse_bvtt_single_tree::<NEW_ONLY>(workspace, &mut |a, b| {
            let (a, b) = (Slot(a), Slot(b));
            let is = |fate| fates[a.index()] == fate || fates[b.index()] == fate;
            // The tree may also have noted what is new since an earlier walk.
            if slots.can_pair(a, b) && (!NEW_ONLY || is(Fate::Renewed)) {
                candidates.push(Candidate(a.min(b), a.max(b)));
                if is(Fate::Renewed) || is(Fate::Woken) {
                    found.judge_new(a, b, slots);
                }
            }
        });
    }

    /// Finds the candidates of one slot that is searched for anew. Two such find each other once.
    fn search(&mut self, slot: Slot, slots: &Slots, found: &mut Found) {
        let Self { tree, candidates, fates, fat, .. } = self;
        for other in tree.intersect_aabb(&fat[slot.index()]).map(Slot) {
            let is_mine = match (fates[slot.index()], fates[other.index()]) {
                (Fate::Woken, Fate::Renewed) => false,
                (own, others) => own != others || slot < other,
            };
            if is_mine && slots.can_pair(slot, other) {
                candidates.push(Candidate(slot.min(other), slot.max(other)));
                found.judge_new(slot, other, slots);
            }
        }
    }
}

/// Slots whose candidates are searched for anew.
struct Changes {
    renewed: Vec<Slot>,
    woken: Vec<Slot>,
}

impl Found {
    fn judge_new(&mut self, a: Slot, b: Slot, slots: &Slots) {
        self.counters.box_tests += 1;
        if slots.boxes[a.index()].overlaps(&slots.boxes[b.index()]) {
            self.began.push(slots.key(a, b));
        }
    }
}

impl Index for FatTree {
    fn follow(&mut self, slots: &Slots, _: &PairSet, found: &mut Found) {
        found.counters.tree = 1;
        if slots.changed().is_empty() {
            return;
        }
        let changes = self.decide(slots);
        self.judge(slots, found);
        self.renew(&changes, slots, found);
        for slot in slots.changed() {
            self.fates[slot.index()] = Fate::Kept;
        }
    }

    fn validate(&self, slots: &Slots) -> Result<(), InvariantError> {
        let is_in_tree =
            |slot: Slot| matches!(slots.states[slot.index()], State::Listed | State::Doomed);
        let listed: Vec<Slot> =
            (0..slots.ids.len() as u32).map(Slot).filter(|&slot| is_in_tree(slot)).collect();
        InvariantError::unless(
            listed.len() == self.leaves && self.tree.leaf_count() as usize == self.leaves,
            || format!("{} boxes are in a tree of {} leaves", listed.len(), self.tree.leaf_count()),
        )?;
        for &slot in &listed {
            let fat = &self.fat[slot.index()];
            let now = rounded(&slots.boxes_before[slot.index()]);
            InvariantError::unless(holds(fat, &now), || format!("{slot:?} is not in its fat box"))?;
            let node = self.tree.leaf_node(slot.0).map(|node| node.aabb());
            InvariantError::unless(node.is_some_and(|node| holds(&node, fat)), || {
                format!("the leaf of {slot:?} does not hold its fat box")
            })?;
            InvariantError::unless(self.fate(slot) == Fate::Kept, || {
                format!("{slot:?} has a fate left over from the last update")
            })?;
        }
        let mut candidates = self.candidates.clone();
        candidates.sort_unstable();
        let once = candidates.windows(2).all(|two| two[0] < two[1]);
        InvariantError::unless(once, || "a candidate is held twice".into())?;
        if !slots.changed().is_empty() {
            return Ok(());
        }
        for (n, &a) in listed.iter().enumerate() {
            for &b in &listed[n + 1..] {
                let needed =
                    slots.can_pair(a, b) && self.fat[a.index()].intersects(&self.fat[b.index()]);
                let held = candidates.binary_search(&Candidate(a, b)).is_ok();
                InvariantError::unless(held || !needed, || {
                    format!("{a:?} and {b:?} have fat boxes that overlap, and are no candidate")
                })?;
            }
        }
        Ok(())
    }
}

impl fmt::Debug for FatTree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FatTree")
            .field("leaves", &self.leaves)
            .field("candidates", &self.candidates.len())
            .finish_non_exhaustive()
    }
}
