//! A tree of fat boxes, and the pairs of them that overlap: parry's `Bvh`, made exact.
//!
//! Every proxy has a *fat box*: its own, in single precision rounded outward, with room to move in.
//! As long as a box stays within its fat box neither the tree nor the list of *candidates* (pairs
//! of proxies whose fat boxes overlap) is touched. A box that leaves gets a new fat box, with room
//! for several updates like the last one, and its candidates are searched for anew: one by one
//! where few have left, by one walk of the tree against itself where many have. The room is the
//! usual idea (Catto 2019, 'Dynamic Bounding Volume Hierarchies'); that it follows each body's own
//! speed makes leaving rare for slow things and candidates few for quick ones.
//!
//! Candidates are judged by the boxes themselves, in double precision, and only when they may have
//! changed: by how much two boxes overlap, or are apart, says how far they can move before they
//! do. Bodies that move about as far as most need no word of their own: a common *travel* is summed
//! up, and a candidate is due when the travel has reached its mark. Quicker ones are judged in
//! every update.

mod candidate;
mod fat;

use crate::index::{Found, Index};
use crate::pairs::PairSet;
use crate::slots::{Slot, Slots, State};
use crate::{InvariantError, Motion};
use candidate::Candidate;
use fat::{fattened, holds, step, wear};
pub(crate) use fat::{rounded, unrounded};
use parry3d::bounding_volume::{Aabb as FatBox, BoundingVolume};
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhLeafUpdateStatus, BvhWorkspace};
use std::fmt;

/// The box-tree back end of [`BroadPhase`](crate::BroadPhase).
///
/// Costs of an update, with n boxes, c candidates and p pairs: c, if anything changed; for each box
/// that comes or leaves its fat box, about log n; if many do, n; if very many do, n log n; any
/// event, a copy of p. Memory follows n and c.
pub type BoxTree = crate::PairKeeper<FatTree>;

/// New fat boxes are put into the tree and searched for one by one, unless more than one in so many
/// is new: then the tree is walked against itself once. Smaller: single searches for many; larger:
/// whole walks for few.
const WALK_SHARE: usize = 12;

/// The tree is built anew when the fat boxes that were put elsewhere have gone so many times their
/// own size since, over all; a box that comes counts for one. Smaller: building where a refit would
/// do; larger: walks through a tree whose boxes overlap.
const LARGEST_WEAR: f64 = 0.5;

/// A body is quick if it moved more than so many times as far as bodies did on average. Smaller:
/// many are judged in every update; larger: the common travel grows beyond what most move.
const QUICK: f64 = 1.5;

/// The common travel is worth summing up if at least one in so many bodies moves; else those few
/// are all called quick.
const FEW_SHARE: usize = 8;

/// What the tree grows a fat box by where it is to note the change; far below the room.
const NOTED: f32 = f32::MIN_POSITIVE;

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
    /// How far fat boxes were put elsewhere since the tree was last built, in their sizes.
    wear: f64,
    /// How far any body but the quick ones may have moved since the tree was built: faces, along an
    /// axis.
    travel: f64,
    /// By moved slot, in this update.
    steps: Vec<f64>,
}

/// What becomes of a slot's candidates in this update. Of two slots the later counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    /// They are judged when they are due: its box moved no farther than the common travel.
    #[default]
    Kept,
    /// They are judged: its box moved farther, within its fat box.
    Quick,
    /// It may have more partners than before: they are searched for anew.
    Woken,
    /// It has a new fat box: they are searched for anew.
    Renewed,
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
        let moved = slots.moved();
        let stride = self.stride(&moved, slots);
        for (&slot, &step) in moved.iter().zip(&self.steps) {
            let i = slot.index();
            if !holds(&self.fat[i], &slots.boxes[i]) {
                renewed.push(slot);
            } else if step > stride || step.is_nan() {
                self.fates[i] = Fate::Quick;
            }
        }
        self.wear += slots.pending().len() as f64;
        for slot in &renewed {
            let i = slot.index();
            let (was, is) = (&slots.boxes_before[i], &slots.boxes[i]);
            self.fates[i] = Fate::Renewed;
            self.fat[i] = fattened(was, is);
            self.wear += wear(was, is);
        }
        woken.retain(|&slot| self.fate(slot) != Fate::Renewed);
        woken.iter().for_each(|slot| self.fates[slot.index()] = Fate::Woken);
        for slot in slots.doomed() {
            self.fates[slot.index()] = Fate::Gone;
            self.tree.remove(slot.0);
        }
        Changes { renewed, woken }
    }

    /// How far bodies may have moved in this update without being called quick; the common travel
    /// grows by it. Leaves in `steps` how far each has.
    fn stride(&mut self, moved: &[Slot], slots: &Slots) -> f64 {
        self.steps.clear();
        let step =
            |slot: &Slot| step(&slots.boxes_before[slot.index()], &slots.boxes[slot.index()]);
        self.steps.extend(moved.iter().map(step));
        if moved.is_empty() || moved.len() * FEW_SHARE < slots.len() {
            return 0.0;
        }
        let finite = self.steps.iter().filter(|step| step.is_finite());
        let stride = QUICK * finite.sum::<f64>() / moved.len() as f64;
        self.travel += stride;
        stride
    }

    /// Judges all candidates that are due or have a quick member, and drops those that are searched
    /// for anew or can be no pair by now. A pair whose boxes have parted ends here; the header of
    /// `pairs` says what becomes of it.
    fn judge_due(&mut self, slots: &Slots, found: &mut Found) {
        let Self { candidates, fates, travel, .. } = self;
        let has_settled = !slots.switched_to(Motion::Stationary).is_empty();
        candidates.retain_mut(|candidate| {
            let Candidate { slots: [a, b], .. } = *candidate;
            let fate = fates[a.index()].max(fates[b.index()]);
            if fate == Fate::Kept && !candidate.is_due(*travel) && !has_settled {
                return true;
            }
            if fate >= Fate::Woken {
                if candidate.held && fate != Fate::Gone {
                    found.ended.push(slots.key(a, b));
                }
                return false;
            }
            if !slots.can_pair(a, b) {
                return false;
            }
            let held = candidate.held;
            candidate.judge(*travel, slots);
            found.counters.box_tests += 1;
            if candidate.held != held {
                let list = if held { &mut found.ended } else { &mut found.began };
                list.push(slots.key(a, b));
            }
            true
        });
    }

    /// Brings new fat boxes into the tree and finds the candidates of what is to be searched for
    /// anew.
    fn renew(&mut self, changes: &Changes, slots: &Slots, found: &mut Found) {
        let Changes { renewed, woken } = changes;
        if self.wear > LARGEST_WEAR * slots.len() as f64 {
            self.build(slots, found);
            return;
        }
        if renewed.len() * WALK_SHARE > slots.len() {
            renewed.iter().for_each(|&slot| self.put_and_note(slot));
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

    /// Puts a new fat box into the tree, which notes the change; its ancestors await a refit.
    fn put_and_note(&mut self, slot: Slot) {
        let fat = self.fat[slot.index()];
        let status = self.tree.insert_or_update_partially(fat, slot.0, NOTED);
        if status == BvhLeafUpdateStatus::Unchanged {
            // A box may leave its fat box by less than the tree had grown that. In none it is a
            // change again.
            self.tree.insert_or_update_partially(FatBox::new_invalid(), slot.0, 0.0);
            self.tree.insert_or_update_partially(fat, slot.0, NOTED);
        }
    }

    /// Finds all candidates by a new tree.
    fn build(&mut self, slots: &Slots, found: &mut Found) {
        let leaves = slots.present().map(|slot| (slot.index(), self.fat[slot.index()]));
        if slots.len() > 2 {
            self.tree = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        } else {
            // Of one or two leaves, parry 0.31's builder takes the numbers to be 0 and 1.
            self.tree = Bvh::new();
            leaves.for_each(|(leaf, fat)| self.tree.insert(fat, leaf as u32));
        }
        (self.wear, self.travel) = (0.0, 0.0);
        found.counters.rebuilds = 1;
        self.candidates.clear();
        self.walk::<false>(slots, found);
    }

    /// Finds candidates by walking the tree against itself: all, or those of slots with new fat
    /// boxes.
    fn walk<const NEW_ONLY: bool>(&mut self, slots: &Slots, found: &mut Found) {
        let Self { tree, workspace, candidates, fates, travel, .. } = self;
        tree.traverse_bvtt_single_tree::<NEW_ONLY>(workspace, &mut |a, b| {
            let (a, b) = (Slot(a), Slot(b));
            let fate = fates[a.index()].max(fates[b.index()]);
            // The tree may also have noted what is new since an earlier walk.
            if slots.can_pair(a, b) && (!NEW_ONLY || fate == Fate::Renewed) {
                candidates.push(Candidate::found(a, b, *travel, slots, found));
            }
        });
    }

    /// Finds the candidates of one slot that is searched for anew. Two such find each other once.
    fn search(&mut self, slot: Slot, slots: &Slots, found: &mut Found) {
        let Self { tree, candidates, fates, fat, travel, .. } = self;
        for other in tree.intersect_aabb(&fat[slot.index()]).map(Slot) {
            let is_mine = match (fates[slot.index()], fates[other.index()]) {
                (Fate::Woken, Fate::Renewed) => false,
                (own, others) => own != others || slot < other,
            };
            if is_mine && slots.can_pair(slot, other) {
                candidates.push(Candidate::found(slot, other, *travel, slots, found));
            }
        }
    }
}

/// Slots whose candidates are searched for anew.
struct Changes {
    renewed: Vec<Slot>,
    woken: Vec<Slot>,
}

impl Index for FatTree {
    fn follow(&mut self, slots: &Slots, _: &PairSet, found: &mut Found) {
        found.counters.tree = 1;
        if slots.changed().is_empty() {
            return;
        }
        let changes = self.decide(slots);
        self.judge_due(slots, found);
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
        InvariantError::unless(self.tree.leaf_count() as usize == listed.len(), || {
            format!("{} boxes are in a tree of {} leaves", listed.len(), self.tree.leaf_count())
        })?;
        for &slot in &listed {
            let fat = &self.fat[slot.index()];
            let is_in = holds(fat, &slots.boxes_before[slot.index()]);
            InvariantError::unless(is_in, || format!("{slot:?} is not in its fat box"))?;
            let node = self.tree.leaf_node(slot.0).map(|node| node.aabb());
            InvariantError::unless(node.is_some_and(|node| node.contains(fat)), || {
                format!("the leaf of {slot:?} does not hold its fat box")
            })?;
            InvariantError::unless(self.fate(slot) == Fate::Kept, || {
                format!("{slot:?} has a fate left over from the last update")
            })?;
        }
        let mut candidates: Vec<[Slot; 2]> = self.candidates.iter().map(|c| c.slots).collect();
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
                let held = candidates.binary_search(&[a, b]).is_ok();
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
            .field("leaves", &self.tree.leaf_count())
            .field("candidates", &self.candidates.len())
            .finish_non_exhaustive()
    }
}
