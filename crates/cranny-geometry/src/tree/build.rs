//! Growing one tree: top-down, by the surface-area heuristic on binned centroids (Wald 2007).
//!
//! Items are moved, not indexed, so that every pass reads memory in order; the bins know the boxes
//! of what falls into them, so that no pass is spent on the boxes of the children.

use cranny_exact::{Aabb, DVec3};

use super::Node;

/// Bins per split at most. Fewer: worse trees; more: slower building for less than 1 % fewer tests.
const BINS: usize = 16;

/// Something on its way into a leaf.
#[derive(Clone, Copy)]
struct Item<I> {
    bounds: Aabb,
    id: I,
}

impl<I> Item<I> {
    /// Twice the middle of its box.
    fn center(&self) -> DVec3 {
        self.bounds.min + self.bounds.max
    }
}

/// Some items: their boxes, and the box of their middles.
#[derive(Clone, Copy)]
struct Extent {
    bounds: Aabb,
    centers: Aabb,
    count: usize,
}

/// What remains to be built: a range of items.
struct Task {
    start: usize,
    extent: Extent,
    /// The node whose right child this is; a left child stands right behind its parent.
    parent: Option<usize>,
}

/// Appends trees to an arena, and keeps its scratch memory between them.
pub(crate) struct Grower<I> {
    leaf_size: usize,
    items: Vec<Item<I>>,
    tasks: Vec<Task>,
}

impl<I: Copy + Ord> Grower<I> {
    pub(crate) fn new(leaf_size: usize) -> Self {
        Self { leaf_size: leaf_size.max(1), items: Vec::new(), tasks: Vec::new() }
    }

    /// Appends the tree over some boxes to `nodes`, and their names in leaf order to `leaves`.
    pub(crate) fn grow(
        &mut self,
        boxes: impl Iterator<Item = (I, Aabb)>,
        nodes: &mut Vec<Node>,
        leaves: &mut Vec<I>,
    ) {
        let offset = leaves.len();
        self.items.clear();
        self.items.extend(boxes.map(|(id, bounds)| Item { bounds, id }));
        if self.items.is_empty() {
            return;
        }
        self.tasks.push(Task { start: 0, extent: Extent::of(&self.items), parent: None });
        while let Some(Task { start, extent, parent }) = self.tasks.pop() {
            let id = nodes.len();
            if let Some(parent) = parent {
                nodes[parent].content = id as u32;
            }
            let count = extent.count;
            if count <= self.leaf_size {
                let first = (offset + start) as u32;
                nodes.push(Node { bounds: extent.bounds, content: first, count: count as u32 });
                continue;
            }
            nodes.push(Node { bounds: extent.bounds, content: 0, count: 0 });
            let [left, right] = split(&mut self.items[start..start + count], &extent);
            self.tasks.push(Task { start: start + left.count, extent: right, parent: Some(id) });
            self.tasks.push(Task { start, extent: left, parent: None });
        }
        leaves.extend(self.items.iter().map(|item| item.id));
    }
}

impl Extent {
    const NONE: Self = Self { bounds: Aabb::EMPTY, centers: Aabb::EMPTY, count: 0 };

    fn of<I>(items: &[Item<I>]) -> Self {
        items.iter().fold(Self::NONE, |extent, item| extent.with(item))
    }

    fn with<I>(self, item: &Item<I>) -> Self {
        let center = item.center();
        let centers = Aabb { min: self.centers.min.min(center), max: self.centers.max.max(center) };
        Self { bounds: self.bounds.union(&item.bounds), centers, count: self.count + 1 }
    }

    fn union(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(&other.bounds),
            centers: self.centers.union(&other.centers),
            count: self.count + other.count,
        }
    }

    /// What it costs to look at all of them, up to a factor.
    fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let e = self.bounds.max - self.bounds.min;
        (e.x * e.y + e.y * e.z + e.z * e.x) * self.count as f64
    }
}

/// Orders at least two items so that the two parts are cheap to keep apart.
fn split<I: Copy + Ord>(items: &mut [Item<I>], extent: &Extent) -> [Extent; 2] {
    let size = extent.centers.max - extent.centers.min;
    let axis = size.max_position();
    let bins = (items.len() / 2).clamp(4, BINS);
    let scale = bins as f64 / size[axis];
    if items.len() > 2 && scale.is_finite() {
        let low = extent.centers.min[axis];
        let bin = |item: &Item<I>| (((item.center()[axis] - low) * scale) as usize).min(bins - 1);
        if let Some((cut, parts)) = cheapest_cut(items, bins, bin) {
            partition(items, |item| bin(item) < cut);
            return parts;
        }
    }
    halve(items, axis)
}

/// The bin before which to cut so that the sum of area times count is least, and both parts.
fn cheapest_cut<I>(
    items: &[Item<I>],
    bins: usize,
    bin: impl Fn(&Item<I>) -> usize,
) -> Option<(usize, [Extent; 2])> {
    let mut filled = [Extent::NONE; BINS];
    for item in items {
        let b = bin(item);
        filled[b] = filled[b].with(item);
    }
    let mut right = [Extent::NONE; BINS];
    right[bins - 1] = filled[bins - 1];
    for i in (1..bins - 1).rev() {
        right[i] = right[i + 1].union(&filled[i]);
    }
    let mut left = Extent::NONE;
    let mut best: Option<(f64, usize, [Extent; 2])> = None;
    for cut in 1..bins {
        left = left.union(&filled[cut - 1]);
        if left.count == 0 || right[cut].count == 0 {
            continue;
        }
        let cost = left.cost() + right[cut].cost();
        if best.is_none_or(|(least, ..)| cost < least) {
            best = Some((cost, cut, [left, right[cut]]));
        }
    }
    best.map(|(_, cut, parts)| (cut, parts))
}

/// Two halves along an axis; by number where middles coincide.
fn halve<I: Ord>(items: &mut [Item<I>], axis: usize) -> [Extent; 2] {
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        a.center()[axis].total_cmp(&b.center()[axis]).then(a.id.cmp(&b.id))
    });
    [Extent::of(&items[..middle]), Extent::of(&items[middle..])]
}

/// Moves what satisfies `first` to the front, by exchanging what stands on the wrong side.
fn partition<I>(items: &mut [Item<I>], first: impl Fn(&Item<I>) -> bool) {
    let (mut low, mut high) = (0, items.len());
    loop {
        while low < high && first(&items[low]) {
            low += 1;
        }
        while low < high && !first(&items[high - 1]) {
            high -= 1;
        }
        if low >= high {
            return;
        }
        items.swap(low, high - 1);
    }
}
