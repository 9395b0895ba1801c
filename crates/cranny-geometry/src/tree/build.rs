//! Growing one tree: top-down, by the surface-area heuristic on binned centroids (Wald 2007).
//!
//! Items are moved, not indexed, so that every pass reads memory in order; the bins know the boxes
//! of what falls into them, so that no pass is spent on the boxes of the children. All this happens
//! on a `lattice`, which is laid anew where a part has become small for it. The exact boxes are
//! fitted from the leaves up: those of twigs while they grow, those above in the end.
//!
//! Source: the heuristic is that of MacDonald and Booth (1990, "Heuristics for ray tracing using
//! space subdivision"), bins are Wald's (2007, "On fast construction of SAH-based bounding volume
//! hierarchies"); the lattice is this crate's own. Cost: O(n) for each level of the tree, so O(n
//! log n) as a rule; nothing but the way in which boxes are spread bounds the number of levels.

use std::ops::Range;

use cranny_exact::Aabb;

use super::lattice::{Extent, LatticeBox, LatticeFrame, LatticeItem};
use super::{Content, FaceTree, Node};
use crate::ids::FaceId;

/// Bins per split at most. Fewer: worse trees; more: slower building for less than 1 % fewer tests.
const BINS: usize = 16;

/// Up to this many items are parted between any two neighbours, not only between bins. Larger, and
/// sorting them takes longer than binning.
const FEW: usize = 8;

/// A part whose middles spread over fewer half steps of the lattice is laid on one of its own.
/// Smaller, and rounding decides how it is divided; larger, and time is spent on ever new lattices.
const LEAST_SPREAD: i32 = 32;

/// How much finer a new lattice must be. Smaller, and parts of long boxes about one middle are laid
/// anew at every level.
const FINER: f64 = 4.0;

/// An inner node, before what it holds is known.
pub(super) const INNER: Node = Node { bounds: Aabb::EMPTY, content: 0, count: 0 };

/// What remains to be built: a range of items.
struct Task {
    start: usize,
    extent: Extent,
    /// That of the lattice.
    scale: f64,
    /// The node whose right child this is; a left child stands right behind its parent.
    parent: Option<usize>,
}

/// In the name of an item: it is a pair of things, the second one numbered next to the first.
const PAIR: u32 = 1 << 31;

/// Appends trees to an arena, and keeps its scratch memory between them.
#[derive(Default)]
pub(crate) struct Grower {
    leaf_size: usize,
    /// By number.
    faces: Vec<FaceId>,
    boxes: Vec<Aabb>,
    /// Numbers of things alone and of the first of each pair.
    names: Vec<u32>,
    items: Vec<LatticeItem>,
    aside: Vec<LatticeItem>,
    tasks: Vec<Task>,
    /// Inner nodes above twigs, whose boxes are not fitted yet.
    stem: Vec<usize>,
}

impl Grower {
    pub(crate) fn new(leaf_size: usize) -> Self {
        Self { leaf_size: leaf_size.max(1), ..Self::default() }
    }

    /// Appends the tree over some boxes to an arena.
    pub(crate) fn grow(
        &mut self,
        boxes: impl Iterator<Item = (FaceId, Aabb)>,
        arena: &mut FaceTree,
    ) {
        self.grow_pairs(boxes.map(|own| (own, None)), arena);
    }

    /// The same over things alone and in pairs, which are parted last, where leaves are smaller
    /// than pairs.
    pub(super) fn grow_pairs(
        &mut self,
        things: impl Iterator<Item = ((FaceId, Aabb), Option<(FaceId, Aabb)>)>,
        arena: &mut FaceTree,
    ) {
        let frame = LatticeFrame::of(&self.list(things));
        if self.names.is_empty() {
            return;
        }
        self.stem.clear();
        self.items.clear();
        let boxes = &self.boxes;
        self.items.extend(self.names.iter().map(|&name| frame.item(&exact_box(boxes, name), name)));
        let (scale, extent) = (frame.scale, Extent::of(&self.items));
        self.tasks.push(Task { start: 0, extent, scale, parent: None });
        while let Some(Task { start, mut extent, mut scale, parent }) = self.tasks.pop() {
            if let Some(parent) = parent {
                arena.nodes[parent].content = arena.nodes.len() as u32;
            }
            // Down the left children.
            while extent.count as usize > FEW && extent.things as usize > self.leaf_size {
                let id = arena.nodes.len();
                arena.nodes.push(INNER);
                self.stem.push(id);
                let items = &mut self.items[start..start + extent.count as usize];
                if lay_anew(items, &self.boxes, &extent.centers, &mut scale) {
                    extent = Extent::of(items);
                }
                let [left, right] = split(items, &extent, &mut self.aside);
                let middle = start + left.count as usize;
                self.tasks.push(Task { start: middle, extent: right, scale, parent: Some(id) });
                extent = left;
            }
            let items = &mut self.items[start..start + extent.count as usize];
            let (faces, boxes) = (&self.faces, &self.boxes);
            let mut twigs = Twigs { leaf_size: self.leaf_size, faces, boxes, arena };
            twigs.grow(items, extent.things as usize, scale);
        }
        for &index in self.stem.iter().rev() {
            if let Content::Inner { left, right } = arena.content(index as u32) {
                let both = arena.node(left).bounds.union(&arena.node(right).bounds);
                arena.nodes[index].bounds = both;
            }
        }
    }

    /// Takes down things and pairs; the box of all.
    fn list(
        &mut self,
        things: impl Iterator<Item = ((FaceId, Aabb), Option<(FaceId, Aabb)>)>,
    ) -> Aabb {
        self.faces.clear();
        self.boxes.clear();
        self.names.clear();
        let most = things.size_hint().1.unwrap_or(0);
        self.faces.reserve(most);
        self.boxes.reserve(most);
        self.names.reserve(most);
        let mut whole = Aabb::EMPTY;
        let mut add = |(face, bounds): (FaceId, Aabb)| {
            whole = whole.union(&bounds);
            self.faces.push(face);
            self.boxes.push(bounds);
        };
        let mut count = 0;
        for (first, second) in things {
            add(first);
            let is_pair = second.is_some();
            second.into_iter().for_each(&mut add);
            self.names.push(if is_pair { count | PAIR } else { count });
            count += 1 + u32::from(is_pair);
        }
        whole
    }
}

/// The number of the first of what a name stands for, and of that behind the last.
fn numbers(name: u32) -> Range<usize> {
    let first = (name & !PAIR) as usize;
    first..first + 1 + (name >> 31) as usize
}

/// The box of what a name stands for.
fn exact_box(boxes: &[Aabb], name: u32) -> Aabb {
    let Range { start, end } = numbers(name);
    boxes[start].union(&boxes[end - 1])
}

/// The lowest parts of a tree in the making.
struct Twigs<'a> {
    leaf_size: usize,
    faces: &'a [FaceId],
    boxes: &'a [Aabb],
    arena: &'a mut FaceTree,
}

impl Twigs<'_> {
    /// Appends the tree over at most [`FEW`] items, or a leaf; the box of all.
    fn grow(&mut self, items: &mut [LatticeItem], things: usize, mut scale: f64) -> Aabb {
        if things <= self.leaf_size {
            return self.leaf(items);
        }
        let id = self.arena.nodes.len();
        self.arena.nodes.push(INNER);
        if let [pair] = items {
            let Range { start, end } = numbers(pair.name() as u32);
            let left = self.single(start);
            self.arena.nodes[id].content = self.arena.nodes.len() as u32;
            let right = self.single(end - 1);
            return self.fit(id, &left, &right);
        }
        let mut cut = 1;
        if items.len() > 2 {
            let mut centers = LatticeBox::of_centers(items);
            if lay_anew(items, self.boxes, &centers, &mut scale) {
                centers = LatticeBox::of_centers(items);
            }
            let axis = centers.longest();
            items.sort_by_key(|item| item.center(axis));
            cut = cheapest_cut(items.len(), |k| (items[k].bounds(), items[k].things()));
        }
        let (left, right) = items.split_at_mut(cut);
        let on_left = left.iter().map(|item| item.things() as usize).sum();
        let left_box = self.grow(left, on_left, scale);
        self.arena.nodes[id].content = self.arena.nodes.len() as u32;
        let right_box = self.grow(right, things - on_left, scale);
        self.fit(id, &left_box, &right_box)
    }

    fn fit(&mut self, node: usize, left: &Aabb, right: &Aabb) -> Aabb {
        let both = left.union(right);
        self.arena.nodes[node].bounds = both;
        both
    }

    fn leaf(&mut self, items: &[LatticeItem]) -> Aabb {
        if let [item] = items
            && item.things() == 1
        {
            return self.single(item.name());
        }
        let first = self.arena.faces.len();
        let mut bounds = Aabb::EMPTY;
        for number in items.iter().flat_map(|item| numbers(item.name() as u32)) {
            bounds = bounds.union(&self.boxes[number]);
            self.arena.faces.push(self.faces[number]);
        }
        let count = (self.arena.faces.len() - first) as u32;
        self.arena.nodes.push(Node { bounds, content: first as u32, count });
        bounds
    }

    /// A leaf of one thing.
    fn single(&mut self, number: usize) -> Aabb {
        let (bounds, content) = (self.boxes[number], self.arena.faces.len() as u32);
        self.arena.faces.push(self.faces[number]);
        self.arena.nodes.push(Node { bounds, content, count: 1 });
        bounds
    }
}

/// Lays a finer lattice over items that hardly differ on theirs, given the box of their middles;
/// whether it did.
#[inline]
fn lay_anew(
    items: &mut [LatticeItem],
    boxes: &[Aabb],
    centers: &LatticeBox,
    scale: &mut f64,
) -> bool {
    centers.size(centers.longest()) < LEAST_SPREAD && lay_finer(items, boxes, scale)
}

/// The same, if the lattice would be much finer.
fn lay_finer(items: &mut [LatticeItem], boxes: &[Aabb], scale: &mut f64) -> bool {
    let exact = |item: &LatticeItem| exact_box(boxes, item.name() as u32);
    let whole = items.iter().fold(Aabb::EMPTY, |all, item| all.union(&exact(item)));
    let frame = LatticeFrame::of(&whole);
    let is_finer = frame.scale >= FINER * *scale;
    if is_finer {
        for item in items.iter_mut() {
            *item = frame.item(&exact(item), item.name() as u32);
        }
        *scale = frame.scale;
    }
    is_finer
}

/// Orders more than [`FEW`] items so that the two parts are cheap to keep apart.
fn split(items: &mut [LatticeItem], extent: &Extent, aside: &mut Vec<LatticeItem>) -> [Extent; 2] {
    let axis = extent.centers.longest();
    let (low, spread) = (extent.centers.low(axis), extent.centers.size(axis));
    if spread == 0 {
        // All in one place: by number.
        let halves = items.split_at(items.len() / 2);
        return [Extent::of(halves.0), Extent::of(halves.1)];
    }
    // With no more bins than steps, the least middle falls into the first and the greatest into the
    // last.
    let count = (items.len() / 2).min(BINS).min(spread as usize + 1);
    let scale = ((count as u64) << 32) / (spread as u64 + 1);
    let mut bins = [Extent::NONE; BINS];
    for item in &*items {
        let bin = (((item.center(axis) - low) as u64 * scale) >> 32) as usize;
        bins[bin % BINS].add(item);
    }
    let bins = &bins[..count];
    let cut = cheapest_cut(count, |k| (&bins[k].bounds, bins[k].things));
    // The least middle of the bins from the cut on.
    let first = low + ((cut as u64) << 32).div_ceil(scale) as i32;
    partition(items, aside, |item| item.center(axis) < first);
    [Extent::of_all(&bins[..cut]), Extent::of_all(&bins[cut..])]
}

/// The part before which to cut so that the sum of area times count is least, of at most [`BINS`]
/// parts with their boxes and counts; the first and the last hold something.
fn cheapest_cut<'a>(parts: usize, part: impl Fn(usize) -> (&'a LatticeBox, u32)) -> usize {
    let join = |(bounds, count): &mut (LatticeBox, u32), cut: usize| {
        let (of_part, number) = part(cut);
        bounds.join(of_part);
        *count += number;
        bounds.half_area() * u64::from(*count)
    };
    let mut right_costs = [0; BINS];
    let mut right = (LatticeBox::NONE, 0);
    for cut in (1..parts).rev() {
        right_costs[cut % BINS] = join(&mut right, cut);
    }
    let mut left = (LatticeBox::NONE, 0);
    let (mut least, mut best) = (u64::MAX, 1);
    for cut in 1..parts {
        let both = join(&mut left, cut - 1) + right_costs[cut % BINS];
        if both < least {
            (least, best) = (both, cut);
        }
    }
    best
}

/// Moves what satisfies `first` to the front and keeps the order otherwise, without a branch an
/// item. Their number. `aside` is memory to be used again.
pub fn partition<T: Copy>(
    items: &mut [T],
    aside: &mut Vec<T>,
    first: impl Fn(&T) -> bool,
) -> usize {
    let Some(&any) = items.first() else { return 0 };
    if aside.len() < items.len() {
        aside.resize(items.len(), any);
    }
    let aside = &mut aside[..items.len()];
    let (mut low, mut high) = (0, 0);
    for at in 0..items.len() {
        let is_first = first(&items[at]);
        let item = items[at];
        items[low] = item;
        aside[high] = item;
        low += usize::from(is_first);
        high += usize::from(!is_first);
    }
    items[low..].copy_from_slice(&aside[..high]);
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    fn numbered(bounds: impl Iterator<Item = Aabb>) -> impl Iterator<Item = (FaceId, Aabb)> {
        (0..).map(FaceId).zip(bounds)
    }

    fn leaves(places: impl Iterator<Item = f64>) -> Vec<u32> {
        let cube = |x: f64| Aabb { min: DVec3::X * x, max: DVec3::X * x + 1e-4 };
        let mut tree = FaceTree::default();
        Grower::new(1).grow(numbered(places.map(cube)), &mut tree);
        let FaceTree { nodes, faces: leaves } = tree;
        assert_eq!(nodes.len() + 1, 2 * leaves.len());
        leaves.into_iter().map(|face: FaceId| face.0).collect()
    }

    #[test]
    fn what_is_small_beside_the_whole_is_divided_by_place_all_the_same() {
        // From right to left, all of it within one step of the first lattice but for the last.
        let row = (0..40).map(|i| f64::from(40 - i) / 1024.0);
        let order = leaves(row.chain([1e4]));
        assert!(order.is_sorted_by(|a, b| a > b || *b == 40), "{order:?}");
    }

    #[test]
    fn what_is_in_one_place_is_halved_by_number() {
        assert_eq!(leaves(std::iter::repeat_n(0.5, 100)), (0..100).collect::<Vec<u32>>());
    }

    #[test]
    fn long_boxes_about_nearly_one_middle_are_divided() {
        // Middles on three neighbouring steps, which no finer lattice parts.
        let long = |i: u32| {
            let (reach, off) = (f64::from(1 + i % 7), f64::from(i % 3) / 2048.0);
            Aabb { min: DVec3::X * -reach, max: DVec3::X * (reach + off) }
        };
        let mut tree = FaceTree::default();
        Grower::new(1).grow(numbered((0..40).map(long)), &mut tree);
        let FaceTree { nodes, faces: mut leaves } = tree;
        leaves.sort_unstable();
        assert_eq!((leaves, nodes.len()), ((0..40).map(FaceId).collect(), 79));
    }

    #[test]
    fn the_cheapest_cut_goes_through_the_gap() {
        // 30 boxes at the left, 10 at the right: the root divides them there.
        let at = |i: u32| f64::from(i) + if i < 30 { 0.0 } else { 100.0 };
        let cube = |i: u32| Aabb { min: DVec3::X * at(i), max: DVec3::X * at(i) + 1.0 };
        let mut tree = FaceTree::default();
        Grower::new(4).grow(numbered((0..40).map(cube)), &mut tree);
        let Content::Inner { left, right } = tree.content(0) else { panic!("one leaf") };
        let ends = [left, right].map(|n| tree.node(n).bounds);
        assert_eq!(ends.map(|b| (b.min.x, b.max.x)), [(0.0, 30.0), (130.0, 140.0)]);
    }

    #[test]
    fn a_partition_keeps_the_order_of_both_sides() {
        let mut numbers = [5, 2, 8, 1, 9, 4, 4];
        let mut aside = vec![0];
        assert_eq!(partition(&mut numbers, &mut aside, |n| n % 2 == 0), 4);
        assert_eq!(numbers, [2, 8, 4, 4, 5, 1, 9]);
        assert_eq!(partition(&mut [3, 1], &mut aside, |_| false), 0);
        assert_eq!(partition::<u8>(&mut [], &mut Vec::new(), |_| true), 0);
    }
}
