//! Dividing the crumbs beneath a facet into those of the next layer.
//!
//! Greedy: the costliest part is divided in two until the layer is full. A part costs its number of
//! faces times its *thickness*, the depth of its faces beneath their plane: that is how many
//! faces a thing within a random distance of the plane has to look at. Two ways to divide are tried, each at
//! the middle of the widest range: by position in a frame along and around the opening direction, or
//! by normal. The lesser sum of costs wins: on a thread, azimuths first and flanks later; in a box, its
//! sides at once.
//!
//! Costs follow from sums over crumbs (`moments`): both ways together divide a part into quarters, so one
//! pass over its crumbs judges both.

use super::EnvelopeOptions;
use super::crumbs::Item;
use super::moments::{Moments, Opening};
use crate::tree::partition;

/// Where the place begins among the keys of an item, and where the normal.
const PLACE: usize = 0;
const FACING: usize = 3;

/// A range of the order of items, and the sums over them.
#[derive(Clone, Copy)]
pub(super) struct Cluster {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) moments: Moments,
    cost: f64,
}

/// Ranges of normals narrower than this are not worth dividing by.
const FLAT: f64 = 1.0 / 1024.0;

/// No part may be smaller than this part of both; else they are halved by number. Larger: cuts
/// miss the gaps between groups of faces; smaller: layers get deep and lopsided.
const LEAST_SHARE: f64 = 0.125;

/// Memory that is used again from part to part.
#[derive(Default)]
pub(super) struct Scratch {
    ordered: Vec<(f64, u32)>,
    aside: Vec<u32>,
}

/// Divides at least one item, named by `order`, into at most `options.width` parts and orders them by parts.
pub(super) fn clusters(
    items: &[Item],
    order: &mut [u32],
    opening: &Opening,
    options: &EnvelopeOptions,
    scratch: &mut Scratch,
) -> Vec<Cluster> {
    let moments = Moments::of(order.iter().map(|&item| &items[item as usize]));
    let whole = Cluster { start: 0, end: order.len(), moments, cost: 0.0 };
    let mut parts = Vec::with_capacity(options.width.min(order.len()));
    parts.push(whole);
    while parts.len() < options.width {
        let divisible = |c: &&mut Cluster| c.moments.count() > options.leaf_faces;
        let costliest = parts
            .iter_mut()
            .filter(divisible)
            .max_by(|a, b| a.cost.total_cmp(&b.cost).then(b.start.cmp(&a.start)));
        let Some(part) = costliest else { break };
        let (start, end) = (part.start, part.end);
        let (left_items, Halves { moments: [left, right], costs }) =
            halves(items, &mut order[start..end], opening, scratch);
        let middle = start + left_items;
        *part = Cluster { start, end: middle, moments: left, cost: costs[0] };
        parts.push(Cluster { start: middle, end, moments: right, cost: costs[1] });
    }
    parts
}

/// Least and greatest keys of some items.
struct Ranges {
    low: [f64; 6],
    high: [f64; 6],
}

impl Ranges {
    fn of<'a>(items: impl Iterator<Item = &'a Item>) -> Self {
        let mut ranges = Self { low: [f64::INFINITY; 6], high: [f64::NEG_INFINITY; 6] };
        for item in items {
            for (low, key) in ranges.low.iter_mut().zip(item.keys) {
                *low = if key < *low { key } else { *low };
            }
            for (high, key) in ranges.high.iter_mut().zip(item.keys) {
                *high = if key > *high { key } else { *high };
            }
        }
        ranges
    }

    fn width(&self, key: usize) -> f64 {
        self.high[key] - self.low[key]
    }

    /// The key with the widest range of three.
    fn widest(&self, first: usize) -> usize {
        let wider = |best, key| if self.width(key) > self.width(best) { key } else { best };
        (first + 1..first + 3).fold(first, wider)
    }

    /// At the middle of the range of a key.
    fn cut(&self, key: usize) -> Cut {
        Cut { key, at: (0.5 * (self.low[key] + self.high[key]), 0) }
    }
}

/// A way to divide items in two.
#[derive(Clone, Copy)]
struct Cut {
    key: usize,
    /// Where the right side begins; of equal keys, with this item.
    at: (f64, u32),
}

impl Cut {
    fn is_right(&self, items: &[Item], item: u32) -> bool {
        let key = items[item as usize].keys[self.key];
        // Without a branch, which nobody could predict.
        (key > self.at.0) | ((key == self.at.0) & (item >= self.at.1))
    }

    /// Two halves by number along the same key, and the sums over them.
    fn halving(
        key: usize,
        items: &[Item],
        order: &[u32],
        scratch: &mut Scratch,
    ) -> (Self, [Moments; 2]) {
        let ordered = &mut scratch.ordered;
        ordered.clear();
        ordered.extend(order.iter().map(|&item| (items[item as usize].keys[key], item)));
        let by_key = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        let (_, &mut at, _) = ordered.select_nth_unstable_by(order.len() / 2, by_key);
        let cut = Self { key, at };
        let mut sides = [Moments::NONE; 2];
        for &item in order {
            sides[usize::from(cut.is_right(items, item))].add(&items[item as usize]);
        }
        (cut, sides)
    }
}

/// Two parts of some items: the sums over them, and what they cost.
struct Halves {
    moments: [Moments; 2],
    costs: [f64; 2],
}

/// Divides at least two items in the better of two ways; the number of those on the left, and both parts.
fn halves(
    items: &[Item],
    order: &mut [u32],
    opening: &Opening,
    scratch: &mut Scratch,
) -> (usize, Halves) {
    let ranges = Ranges::of(order.iter().map(|&item| &items[item as usize]));
    let cuts = [PLACE, FACING].map(|first| ranges.cut(ranges.widest(first)));
    let mut quarters = [Moments::NONE; 4];
    for &item in &*order {
        let [by_place, by_facing] = cuts.map(|cut| usize::from(cut.is_right(items, item)));
        quarters[2 * by_place + by_facing].add(&items[item as usize]);
    }
    let [a, b, c, d] = quarters;
    let faces: usize = quarters.iter().map(Moments::count).sum();
    let least = (LEAST_SHARE * faces as f64).max(1.0) as usize;
    let mut judged = |cut: Cut, sides: [Moments; 2]| {
        let is_lopsided = sides.iter().any(|side| side.count() < least);
        let (cut, sides) =
            if is_lopsided { Cut::halving(cut.key, items, order, scratch) } else { (cut, sides) };
        (cut, Halves { moments: sides, costs: [sides[0].cost(opening), sides[1].cost(opening)] })
    };
    let mut best = judged(cuts[0], [a.plus(&b), c.plus(&d)]);
    if ranges.width(cuts[1].key) > FLAT {
        let by_facing = judged(cuts[1], [a.plus(&c), b.plus(&d)]);
        let sum = |(_, halves): &(Cut, Halves)| halves.costs[0] + halves.costs[1];
        if sum(&by_facing) < sum(&best) {
            best = by_facing;
        }
    }
    let (cut, sides) = best;
    let left = partition(order, &mut scratch.aside, |&item| !cut.is_right(items, item));
    (left, sides)
}
