//! One level of two box trees: the boxes that are active on it, sorted along three axes, and which
//! of them overlap.

use std::collections::HashSet;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::{AddAssign, ControlFlow};

use cranny_exact::Aabb;

use super::axis::{Axis, End};

/// A node of one of the two trees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Member {
    pub(super) tree: usize,
    pub(super) node: u32,
}

/// Numbers of two nodes, the first tree's first.
pub(super) type NodePair = [u32; 2];

/// Pairs are looked up at every swap: one multiplication (Knuth's, of the golden ratio) is hash
/// enough.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PairHasher(u64);

impl Hasher for PairHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(4) {
            let word = chunk.iter().rev().fold(0, |word, &b| word << 8 | u64::from(b));
            self.0 = (self.0.rotate_left(32) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
    }
}

type PairSet = HashSet<NodePair, BuildHasherDefault<PairHasher>>;

/// What a level did and holds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LevelWork {
    pub(super) swaps: u64,
    /// Boxes of nodes that are active.
    pub(super) active: u64,
    /// Pairs of boxes compared.
    pub(super) tests: u64,
    pub(super) pairs: u64,
}

impl AddAssign for LevelWork {
    fn add_assign(&mut self, other: Self) {
        self.swaps += other.swaps;
        self.active += other.active;
        self.tests += other.tests;
        self.pairs += other.pairs;
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Level {
    axes: [Axis; 3],
    /// Nodes of each tree, ascending.
    active: [Vec<u32>; 2],
    pairs: PairSet,
}

impl Level {
    pub(super) fn pairs(&self) -> impl Iterator<Item = NodePair> + '_ {
        self.pairs.iter().copied()
    }

    pub(super) fn bytes(&self) -> usize {
        let ends: usize = self.axes.iter().map(|axis| axis.ends.capacity()).sum();
        let active: usize = self.active.iter().map(Vec::capacity).sum();
        ends * size_of::<End>()
            + active * size_of::<u32>()
            + self.pairs.capacity() * (size_of::<NodePair>() + 1)
    }

    /// Makes these nodes, ascending, the active ones, with boxes as they are now. `candidates` are
    /// pairs of active nodes among which all that overlap are; called where nodes are new.
    pub(super) fn update(
        &mut self,
        active: [Vec<u32>; 2],
        of: impl Fn(Member) -> Aabb,
        candidates: impl Fn() -> Vec<NodePair>,
    ) -> LevelWork {
        let mut work = LevelWork {
            active: (active[0].len() + active[1].len()) as u64,
            ..LevelWork::default()
        };
        let new = [0, 1].map(|i| difference(&active[i], &self.active[i]));
        let gone = [0, 1].map(|i| difference(&self.active[i], &active[i]));
        self.drop_nodes(&gone);
        self.active = active;
        let in_order = self.resort(&of, &mut work);
        if !in_order {
            self.pairs.clear();
        }
        if !in_order || new.iter().any(|nodes| !nodes.is_empty()) {
            self.take_in(&new, in_order, &of);
            let is_new = |tree: usize, node: u32| new[tree].binary_search(&node).is_ok();
            for [a, b] in candidates() {
                if in_order && !is_new(0, a) && !is_new(1, b) {
                    continue;
                }
                work.tests += 1;
                if of(Member { tree: 0, node: a }).overlaps(&of(Member { tree: 1, node: b })) {
                    self.pairs.insert([a, b]);
                }
            }
        }
        work.pairs = self.pairs.len() as u64;
        work
    }

    fn drop_nodes(&mut self, gone: &[Vec<u32>; 2]) {
        if gone.iter().all(Vec::is_empty) {
            return;
        }
        let is_gone = |tree: usize, node: u32| gone[tree].binary_search(&node).is_ok();
        self.pairs.retain(|&[a, b]| !is_gone(0, a) && !is_gone(1, b));
        for axis in &mut self.axes {
            axis.ends.retain(|end| !is_gone(end.of.tree, end.of.node));
        }
    }

    /// Sorts the ends of the boxes that were here before; `false` where that was given up.
    fn resort(&mut self, of: &impl Fn(Member) -> Aabb, work: &mut LevelWork) -> bool {
        let Self { axes, pairs, .. } = self;
        for (i, axis) in axes.iter_mut().enumerate() {
            for end in &mut axis.ends {
                let bounds = of(end.of);
                end.at = if end.is_max { bounds.max[i] } else { bounds.min[i] };
            }
        }
        for axis in axes {
            let n = axis.ends.len() as u64;
            let tests = &mut work.tests;
            let sorted = axis.sort(n * u64::from(n.max(2).ilog2()), |x, y, overlap| {
                let (a, b) = if x.tree == 0 { (x, y) } else { (y, x) };
                let pair = [a.node, b.node];
                if !overlap {
                    pairs.remove(&pair);
                    return;
                }
                *tests += 1;
                if of(a).overlaps(&of(b)) {
                    pairs.insert(pair);
                }
            });
            let (ControlFlow::Continue(swaps) | ControlFlow::Break(swaps)) = sorted;
            work.swaps += swaps;
            if sorted.is_break() {
                return false;
            }
        }
        true
    }

    fn take_in(&mut self, new: &[Vec<u32>; 2], in_order: bool, of: &impl Fn(Member) -> Aabb) {
        for (i, axis) in self.axes.iter_mut().enumerate() {
            let mut more = Vec::with_capacity(2 * (new[0].len() + new[1].len()));
            for (tree, nodes) in new.iter().enumerate() {
                for &node in nodes {
                    let of_it = Member { tree, node };
                    let bounds = of(of_it);
                    more.push(End { at: bounds.min[i], of: of_it, is_max: false });
                    more.push(End { at: bounds.max[i], of: of_it, is_max: true });
                }
            }
            if in_order {
                axis.merge(more);
            } else {
                axis.ends.extend(more);
                axis.sort_anew();
            }
        }
    }
}

/// What is in the first and not in the second of two ascending lists.
fn difference(first: &[u32], second: &[u32]) -> Vec<u32> {
    let mut left = second.iter().copied().peekable();
    let mut out = Vec::new();
    for &node in first {
        while left.next_if(|&other| other < node).is_some() {}
        if left.peek() != Some(&node) {
            out.push(node);
        }
    }
    out
}
