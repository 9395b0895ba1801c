//! A cut: where the last descent ended, kept from query to query.
//!
//! A descent tests a place of one tree against the boxes of a node of the other, and ends at those
//! that are farther than its reach. How much farther the nearest of these is, is the *slack* of
//! that block of eight; motion spends it, and until it is spent the block need not be looked at.
//! What of a block comes within reach is descended into, and adds blocks of its own; where there
//! have come to be many more than a new descent would leave, one is made. Pairs of clusters within
//! reach are listed, with the gap of their boxes as their slack.
//!
//! Motion is counted once for all blocks: by how much the second body has turned, and one point of
//! it moved, the *pivot*, as seen from the first. No point at a distance r from the pivot has then
//! moved by more than `turn · r + shift`. The pivot lies where the bodies were near each other.
//! (Li and Chen, 'Incremental 3D collision detection with hierarchical
//! data structures', 1998, keep such a front of a traversal.)
//!
//! A cut holds no answers: it lists no less than all pairs of clusters within reach.

use cranny_exact::{DVec3, RigidMap};
use wide::f32x8;

use super::ground::{At, Ground};
use super::lanes::{Wide3, greatest, lanes_of, masked, single, wide, within};
use super::parted::Leaf;
use crate::motion::MATRIX_ERROR;
use crate::pair::{Pair, Side};
use crate::tally::Tally;

/// Rounded sums of motions are made larger by this part.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// Single-precision lengths are made larger by this part.
const SPARE: f64 = 1.0 + 1e-6;

/// A cut with more blocks, or pairs of clusters, than this times what it was built with, and a few
/// more, is built anew. Larger: more is looked at in each query; smaller: cuts are built more
/// often.
const WORN: f64 = 1.25;

/// A place of one tree, tested against a node of the other.
#[derive(Clone, Copy, Debug)]
struct Block {
    at: [At; 2],
    /// Whose node it is.
    side: Side,
    /// The lanes at which the descent ended.
    ended: u8,
}

/// A place of each tree, to be looked at together.
#[derive(Clone, Copy)]
struct Place {
    at: [At; 2],
    /// A lower bound of how far their boxes are apart, in lengths of a side, but for its error.
    gap: f32,
    side: Side,
}

/// When a block is due: once `turn · radius + shift` reaches the limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Due {
    pub(super) radius: f64,
    pub(super) limit: f64,
}

/// How much motion there has been: by how far the second body has turned, and the pivot moved.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Spent {
    turn: f64,
    shift: f64,
}

impl Spent {
    /// Of a slack, by what lies within a radius of the pivot.
    #[inline(always)]
    fn of(&self, radius: f64) -> f64 {
        self.turn * radius + self.shift
    }

    /// How far two clusters are apart at least, by what was known of them and the motion since.
    #[inline(always)]
    pub(crate) fn left(&self, leaf: &Leaf) -> f64 {
        (leaf.due.limit - self.of(leaf.due.radius) * ROUND_UP).next_down()
    }

    /// Notes how far two clusters are apart at least now, by their faces; `posing` is what posing
    /// rounds.
    #[inline(always)]
    pub(crate) fn note(&self, leaf: &mut Leaf, separation: f64, posing: f64) {
        let known = separation - 2.0 * posing + self.of(leaf.due.radius);
        leaf.due.limit = leaf.due.limit.max(known.next_down());
        leaf.is_parted = false;
    }

    /// The same as seen along the leaf's direction.
    #[inline(always)]
    pub(crate) fn note_along(&self, leaf: &mut Leaf, gap: f64, posing: f64) {
        let before = leaf.due.limit;
        self.note(leaf, gap, posing);
        leaf.is_parted = gap > 0.0 && leaf.due.limit > before;
    }
}

/// A point of the second body.
#[derive(Clone, Copy, Debug)]
struct Pivot {
    /// In the lengths of its tree.
    at: [f32; 3],
    /// In its frame.
    point: DVec3,
    /// No point of the second body is farther from it.
    farthest: f64,
}

impl Pivot {
    /// In the middle of where the boxes of two bodies overlap, or of what is between.
    fn of(pair: &Pair, ground: &Ground) -> Self {
        let own = pair.model(Side::Second).bounds();
        let its = pair.first_from_second.inverse().bounds(&pair.model(Side::First).bounds());
        let middle = 0.5 * (own.min.max(its.min) + own.max.min(its.max));
        let tree = ground.tree(Side::Second);
        // Beyond the body it would be no better.
        let at = single((middle.clamp(own.min, own.max) - tree.origin()) / tree.unit());
        let point = tree.origin() + tree.unit() * DVec3::from_array(at.map(f64::from));
        let root = tree.root();
        let farthest = f64::from(length(minus(root.center, at)) + root.radius);
        Self { at, point, farthest: farthest * tree.unit() * SPARE }
    }
}

/// Where a descent ended.
#[derive(Clone, Debug)]
pub(crate) struct Cut {
    pivot: Pivot,
    map: RigidMap,
    reach: f64,
    /// How much farther is looked where something is tested again: what is within the reach by a
    /// little, or beyond it, would be tested in every query.
    spare: f64,
    spent: Spent,
    blocks: Vec<Block>,
    due: Vec<Due>,
    leaves: Vec<Leaf>,
    /// How many leaves were listed at the last pose already, if nothing else can have met since.
    held_leaves: Option<usize>,
    built: [usize; 2],
}

impl Cut {
    /// Descends from the top, for what is within `reach`, and what comes near it in a motion of
    /// `spare`.
    pub(crate) fn build(
        pair: &Pair,
        ground: &Ground,
        (reach, spare): (f64, f64),
        counters: &mut impl Tally,
    ) -> Self {
        let mut cut = Self {
            pivot: Pivot::of(pair, ground),
            map: pair.first_from_second,
            reach,
            spare,
            spent: Spent::default(),
            blocks: Vec::new(),
            due: Vec::new(),
            leaves: Vec::new(),
            held_leaves: None,
            built: [0; 2],
        };
        let mut stack =
            vec![Place { at: [At::ROOT; 2], gap: f32::NEG_INFINITY, side: Side::First }];
        cut.descend(ground, &mut stack, counters);
        cut.built = [cut.blocks.len(), cut.leaves.len()];
        cut.spare_room();
        cut
    }

    /// Leaves room for a quarter more than is there: it is kept.
    fn spare_room(&mut self) {
        let with_room = |count: usize| count + count / 4 + 8;
        self.blocks.shrink_to(with_room(self.blocks.len()));
        self.due.shrink_to(with_room(self.due.len()));
        self.leaves.shrink_to(with_room(self.leaves.len()));
    }

    /// What it lists lies within this.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// All pairs of clusters within reach, and perhaps some others; and the motion that there has
    /// been.
    pub(crate) fn leaves(&mut self) -> (&mut [Leaf], Spent) {
        (&mut self.leaves, self.spent)
    }

    /// How many of the leaves, the first ones, were listed at the last pose already; `None` unless
    /// all other clusters are certain to have been apart all the way from there.
    pub(crate) fn held_leaves(&self) -> Option<usize> {
        self.held_leaves
    }

    /// Follows the bodies to the pair's pose; whether that costs less than a new descent.
    pub(crate) fn follow(
        &mut self,
        pair: &Pair,
        ground: &Ground,
        counters: &mut impl Tally,
    ) -> bool {
        let step = self.advance(pair);
        let is_short = step + 2.0 * ground.posing() < self.reach;
        let limits = self.built.map(|built| (WORN * built as f64) as usize + 64);
        if self.blocks.len() > limits[0] || self.leaves.len() > limits[1] {
            return false;
        }
        let spent = self.spent;
        let is_due = |due: &Due| spent.of(due.radius) >= due.limit;
        let mut count = self.due.iter().filter(|due| is_due(due)).count();
        // A block that is due costs about what a step of a descent does.
        if 2 * count > self.blocks.len() + 8 {
            return false;
        }
        // What has slack left has stayed apart, and what had come no nearer than the reach.
        self.held_leaves = (count == 0 || is_short).then_some(self.leaves.len());
        let mut stack = Vec::new();
        let mut index = 0;
        while count > 0 {
            if is_due(&self.due[index]) {
                count -= 1;
                self.renew(index, ground, &mut stack, counters);
            }
            index += 1;
        }
        self.descend(ground, &mut stack, counters);
        self.spare_room();
        true
    }

    /// Counts the motion since the last pose; returns a bound for all points of the second body.
    fn advance(&mut self, pair: &Pair) -> f64 {
        let (before, now) = (self.map, pair.first_from_second);
        if before == now {
            return 0.0;
        }
        let turn = now.linear - before.linear;
        let squares = [turn.x_axis, turn.y_axis, turn.z_axis].map(DVec3::length_squared);
        // Of a difference of rotations two singular values are equal and the third is nothing.
        let turned =
            (0.5 * (squares[0] + squares[1] + squares[2])).sqrt() * ROUND_UP + MATRIX_ERROR;
        let point = self.pivot.point;
        let shifted =
            (now.apply(point) - before.apply(point)).length() * ROUND_UP + pair.culling_error();
        self.spent.turn = (self.spent.turn + turned) * ROUND_UP;
        self.spent.shift = (self.spent.shift + shifted) * ROUND_UP;
        self.map = now;
        (turned * self.pivot.farthest + shifted) * ROUND_UP
    }

    /// Tests a block again; what has come within reach goes to the stack.
    fn renew(
        &mut self,
        index: usize,
        ground: &Ground,
        stack: &mut Vec<Place>,
        counters: &mut impl Tally,
    ) {
        let Block { at, side, ended } = self.blocks[index];
        counters.counters().front_tested += u64::from(ended.count_ones());
        let tested = self.test(ground, (at, side, u32::from(ended)), stack, counters);
        (self.blocks[index].ended, self.due[index]) = tested;
        counters.counters().front_split += u64::from((ended & !tested.0).count_ones());
    }

    /// Goes down from what is on the stack, and keeps where that ends.
    fn descend(&mut self, ground: &Ground, stack: &mut Vec<Place>, counters: &mut impl Tally) {
        while let Some(Place { at, gap, side: seen_from }) = stack.pop() {
            let Some(side) = ground.opened(at) else {
                let pair =
                    Side::BOTH.map(|side| ground.child(side, at[side.index()]).index() as u32);
                let radius = cluster_radius(ground, &self.pivot, pair[1]);
                // Less than nothing where boxes overlap, which is no more than is true.
                let gap = ground.certain(seen_from, gap) - 2.0 * ground.posing();
                let limit = (gap + self.spent.of(radius)).next_down();
                self.leaves.push(Leaf::new(pair, Due { radius, limit }));
                continue;
            };
            let node = ground.child(side, at[side.index()]).index();
            let node = &ground.tree(side).nodes()[node];
            counters.counters().node_tests += u64::from(node.count);
            let (ended, due) = self.test(ground, (at, side, node.mask()), stack, counters);
            if ended != 0 {
                self.due.push(due);
                self.blocks.push(Block { at, side, ended });
            }
        }
    }

    /// Tests the lanes of `mask` of the node at a place of `side` against the other place; what is
    /// within reach goes to the stack. Returns the other lanes, and when they are due.
    fn test(
        &self,
        ground: &Ground,
        (at, side, mask): ([At; 2], Side, u32),
        stack: &mut Vec<Place>,
        counters: &mut impl Tally,
    ) -> (u8, Due) {
        counters.boxes(|| ground.compared(at, side, mask));
        let (i, pivot) = (side.index(), self.pivot.at);
        let index = ground.child(side, at[i]).index();
        let node = &ground.tree(side).nodes()[index];
        let gaps = ground.gaps(side, node, at[1 - i]);
        let near = within(gaps, f32x8::splat(ground.reach(side, self.reach + self.spare))) & mask;
        let ended = mask & !near;
        let nearest = -greatest(masked(-gaps, ended, f32::NEG_INFINITY));
        let slack = (ground.certain(side, nearest) - self.reach - 2.0 * ground.posing()).max(0.0);
        let unit = ground.tree(Side::Second).unit();
        let distance = |center: [f32; 3]| length(minus(center, pivot));
        let radius = match side {
            // What of the second body is there.
            Side::First => {
                let b = ground.boxed(Side::Second, at[1]);
                f64::from(distance(b.center) + b.radius) * unit * SPARE
            }
            // That, or what of the first one is, as seen from the pivot: it may go as far as the
            // slack lets it.
            Side::Second => {
                let from = Wide3::of(&node.center).minus(&Wide3::all(pivot));
                let farthest = from.dot(&from).sqrt() + wide(&node.radius);
                let farthest = greatest(masked(farthest, ended, 0.0));
                let b = ground.placed(Side::Second, at[0]);
                // Where it is placed is off by as much as the bounds are.
                let off = f64::from(ground.reach(Side::Second, 0.0)) * unit;
                let its = f64::from(distance(b.center) + b.radius) * unit * SPARE + off;
                (f64::from(farthest) * unit * SPARE).min(its + ground.posing() + slack)
            }
        };
        let gaps = gaps.to_array();
        for lane in lanes_of(near) {
            let mut next = at;
            next[i] = At::lane(index, lane);
            stack.push(Place { at: next, gap: gaps[lane], side });
        }
        (ended as u8, Due { radius, limit: slack + self.spent.of(radius) })
    }

    /// How many blocks are kept.
    pub(crate) fn held(&self) -> u64 {
        self.blocks.len() as u64
    }

    pub(crate) fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<Block>()
            + self.due.capacity() * size_of::<Due>()
            + self.leaves.capacity() * size_of::<Leaf>()
    }
}

/// How far a cluster of the second body reaches from the pivot at most.
fn cluster_radius(ground: &Ground, pivot: &Pivot, cluster: u32) -> f64 {
    let tree = ground.tree(Side::Second);
    let cluster = &tree.clusters()[cluster as usize];
    (cluster.center - pivot.point).length() + f64::from(cluster.bounds.radius) * tree.unit() * SPARE
}

fn minus([x, y, z]: [f32; 3], [u, v, w]: [f32; 3]) -> [f32; 3] {
    [x - u, y - v, z - w]
}

fn length([x, y, z]: [f32; 3]) -> f32 {
    (x * x + y * y + z * z).sqrt()
}
