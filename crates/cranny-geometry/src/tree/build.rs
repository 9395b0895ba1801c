//! Growing one tree: top-down, by the surface-area heuristic on binned centroids (Wald 2007).
//!
//! Items are moved, not indexed, so that every pass reads memory in order; the bins know the boxes
//! of what falls into them, so that no pass is spent on the boxes of the children.

use cranny_exact::{Aabb, DVec3};

use super::Node;

/// Bins per split at most. Fewer: worse trees; more: slower building for less than 1 % fewer tests.
const BINS: usize = 16;

/// A box as six numbers of which the least counts: the least corner, and the greatest one negated. So two
/// boxes are joined by one kind of operation on whole vectors.
#[derive(Clone, Copy)]
struct Lows([f64; 6]);

impl Lows {
    const NONE: Self = Self([f64::INFINITY; 6]);

    fn of(bounds: &Aabb) -> Self {
        let (low, high) = (bounds.min, -bounds.max);
        Self([low.x, low.y, low.z, high.x, high.y, high.z])
    }

    fn of_point(p: [f64; 3]) -> Self {
        Self([p[0], p[1], p[2], -p[0], -p[1], -p[2]])
    }

    fn join(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(other.0) {
            *own = if *own < other { *own } else { other };
        }
    }

    fn low(&self, axis: usize) -> f64 {
        self.0[axis]
    }

    fn size(&self) -> DVec3 {
        let [a, b, c, x, y, z] = self.0;
        DVec3::new(-x - a, -y - b, -z - c)
    }

    fn aabb(&self) -> Aabb {
        let [a, b, c, x, y, z] = self.0;
        Aabb { min: DVec3::new(a, b, c), max: DVec3::new(-x, -y, -z) }
    }
}

/// Something on its way into a leaf.
#[derive(Clone, Copy)]
struct Item<I> {
    bounds: Lows,
    id: I,
    /// Into which bin it fell last.
    bin: u32,
}

impl<I> Item<I> {
    /// Twice the middle of its box.
    fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.center_along(axis))
    }

    fn center_along(&self, axis: usize) -> f64 {
        self.bounds.0[axis] - self.bounds.0[axis + 3]
    }
}

/// Some items: their boxes, and the box of their middles.
#[derive(Clone, Copy)]
struct Extent {
    bounds: Lows,
    centers: Lows,
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
    bins: [Extent; BINS],
}

impl<I: Copy + Ord> Grower<I> {
    pub(crate) fn new(leaf_size: usize) -> Self {
        let (items, tasks) = (Vec::new(), Vec::new());
        Self { leaf_size: leaf_size.max(1), items, tasks, bins: [Extent::NONE; BINS] }
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
        self.items.extend(boxes.map(|(id, b)| Item { bounds: Lows::of(&b), id, bin: 0 }));
        if self.items.is_empty() {
            return;
        }
        self.tasks.push(Task { start: 0, extent: Extent::of(&self.items), parent: None });
        while let Some(Task { start, mut extent, parent }) = self.tasks.pop() {
            if let Some(parent) = parent {
                nodes[parent].content = nodes.len() as u32;
            }
            // Down the left children.
            while extent.count > self.leaf_size {
                let id = nodes.len();
                nodes.push(Node { bounds: extent.bounds.aabb(), content: 0, count: 0 });
                let items = &mut self.items[start..start + extent.count];
                let [left, right] = split(items, &extent, &mut self.bins);
                let start = start + left.count;
                self.tasks.push(Task { start, extent: right, parent: Some(id) });
                extent = left;
            }
            let (first, count) = ((offset + start) as u32, extent.count as u32);
            nodes.push(Node { bounds: extent.bounds.aabb(), content: first, count });
        }
        leaves.extend(self.items.iter().map(|item| item.id));
    }
}

impl Extent {
    const NONE: Self = Self { bounds: Lows::NONE, centers: Lows::NONE, count: 0 };

    fn of<I>(items: &[Item<I>]) -> Self {
        let mut extent = Self::NONE;
        items.iter().for_each(|item| extent.add(item));
        extent
    }

    fn add<I>(&mut self, item: &Item<I>) {
        self.bounds.join(&item.bounds);
        self.centers.join(&Lows::of_point(item.center()));
        self.count += 1;
    }

    fn join(&mut self, other: &Self) {
        self.bounds.join(&other.bounds);
        self.centers.join(&other.centers);
        self.count += other.count;
    }

    fn of_all(parts: &[Self]) -> Self {
        let mut all = Self::NONE;
        parts.iter().for_each(|part| all.join(part));
        all
    }
}

/// What it costs to look at so many items in a box, up to a factor.
fn cost(bounds: &Lows, count: usize) -> f64 {
    let e = bounds.size();
    (e.x * e.y + e.y * e.z + e.z * e.x) * count as f64
}

/// Orders at least two items so that the two parts are cheap to keep apart.
fn split<I: Copy + Ord>(
    items: &mut [Item<I>],
    extent: &Extent,
    bins: &mut [Extent; BINS],
) -> [Extent; 2] {
    let size = extent.centers.size();
    let axis = size.max_position();
    let count = (items.len() / 2).clamp(4, BINS);
    let scale = count as f64 / size[axis];
    if items.len() > 2 && scale.is_finite() {
        let bins = &mut bins[..count];
        bins.fill(Extent::NONE);
        let low = extent.centers.low(axis);
        for item in items.iter_mut() {
            let bin = (((item.center_along(axis) - low) * scale) as usize).min(count - 1);
            item.bin = bin as u32;
            bins[bin].add(item);
        }
        if let Some(cut) = cheapest_cut(bins) {
            partition(items, |item| (item.bin as usize) < cut);
            return [Extent::of_all(&bins[..cut]), Extent::of_all(&bins[cut..])];
        }
    }
    halve(items, axis)
}

/// The bin before which to cut so that the sum of area times count is least.
fn cheapest_cut(bins: &[Extent]) -> Option<usize> {
    let mut right_costs = [0.0; BINS];
    let (mut right, mut count) = (Lows::NONE, 0);
    for (cut, bin) in bins.iter().enumerate().skip(1).rev() {
        right.join(&bin.bounds);
        count += bin.count;
        right_costs[cut] = cost(&right, count);
    }
    let all = count + bins[0].count;
    let (mut left, mut count) = (Lows::NONE, 0);
    let (mut least, mut best) = (f64::INFINITY, None);
    for cut in 1..bins.len() {
        let bin = &bins[cut - 1];
        left.join(&bin.bounds);
        count += bin.count;
        if count == 0 || count == all {
            continue;
        }
        let both = cost(&left, count) + right_costs[cut];
        if best.is_none() || both < least {
            (least, best) = (both, Some(cut));
        }
    }
    best
}

/// Two halves along an axis; by number where middles coincide.
fn halve<I: Copy + Ord>(items: &mut [Item<I>], axis: usize) -> [Extent; 2] {
    let middle = items.len() / 2;
    let order = |a: &Item<I>, b: &Item<I>| {
        a.center_along(axis).total_cmp(&b.center_along(axis)).then(a.id.cmp(&b.id))
    };
    if let [a, b] = items {
        if order(a, b).is_gt() {
            items.swap(0, 1);
        }
    } else {
        items.select_nth_unstable_by(middle, order);
    }
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
