//! Dividing the groups beneath a facet into those of the next layer.
//!
//! Greedy: the costliest part is divided in two until the layer is full. A part costs its number of
//! faces times its *thickness*, the depth of its faces beneath their plane: that is how many faces
//! a probe within a random distance of the plane has to look at. Two ways to divide are tried, each
//! at the middle of the widest range: by position in a frame along and around the opening
//! direction, or by normal. The lesser sum of costs wins: on a thread, azimuths first and flanks
//! later; in a box, its sides at once.
//!
//! Costs follow from sums over groups (`moments`): both ways together divide a part into quarters,
//! so one pass over its groups judges both.
//!
//! Source: to divide the worst part in two until there are enough is Heckbert's way with colours
//! (1982, "Color image quantization for frame buffer display"); what a part costs and the two ways
//! are this crate's own. Any division is right. Cost: for each division a pass or two over the
//! groups of the part that is divided, and a glance at each part.

use super::EnvelopeOptions;
use super::face_groups::Item;
use super::moments::{Moments, Opening};
use cranny_geometry::partition;

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

/// Divides at least one item, named by `order`, into at most `options.width` parts and orders them
/// by parts.
pub(super) fn clusters(
    items: &[Item],
    order: &mut [u32],
    opening: &Opening,
    options: &EnvelopeOptions,
    scratch: &mut Scratch,
) -> Vec<Cluster> {
    if order.len() <= options.width && no_two_stay_together(items, order, options.leaf_faces) {
        let alone = |(start, &item): (usize, &u32)| Cluster {
            start,
            end: start + 1,
            moments: Moments::of([&items[item as usize]]),
            cost: 0.0,
        };
        return order.iter().enumerate().map(alone).collect();
    }
    let most = options.leaf_faces as f64;
    let all = order.iter().map(|&item| &items[item as usize]);
    let count: usize = all.clone().map(|item| item.count as usize).sum();
    if count <= options.leaf_faces {
        return vec![Cluster { start: 0, end: order.len(), moments: Moments::of(all), cost: 0.0 }];
    }
    // It is divided first, so its sums are not needed.
    let moments = Moments::of_count(count);
    let whole = Cluster { start: 0, end: order.len(), moments, cost: 0.0 };
    let mut parts = Vec::with_capacity(options.width.min(order.len()));
    parts.push(whole);
    while parts.len() < options.width {
        let divisible = |c: &&mut Cluster| c.moments.count() > most;
        let costliest = parts
            .iter_mut()
            .filter(divisible)
            .max_by(|a, b| a.cost.total_cmp(&b.cost).then(b.start.cmp(&a.start)));
        let Some(part) = costliest else { break };
        let (start, end) = (part.start, part.end);
        let order = &mut order[start..end];
        let (left_items, Halves { moments: [left, right], costs }) = match *order {
            [a, b] => halves_of_two(items, [a, b], order),
            _ => halves(items, order, opening, scratch),
        };
        let middle = start + left_items;
        // The cost of a part that is not divided is not needed.
        let cost = |side: usize, moments: &Moments| {
            let is_divided = moments.count() > most;
            let known = || costs.map(|costs| costs[side]);
            if is_divided { known().unwrap_or_else(|| moments.cost(opening)) } else { 0.0 }
        };
        *part = Cluster { start, end: middle, moments: left, cost: cost(0, &left) };
        parts.push(Cluster { start: middle, end, moments: right, cost: cost(1, &right) });
    }
    parts
}

/// Whether any two of some items have too many faces for a part that is not divided: then each
/// becomes a part, in whichever way they are divided.
fn no_two_stay_together(items: &[Item], order: &[u32], leaf_faces: usize) -> bool {
    let [mut least, mut next] = [usize::MAX; 2];
    for &item in order {
        let count = items[item as usize].count as usize;
        next = next.min(least.max(count));
        least = least.min(count);
    }
    least.saturating_add(next) > leaf_faces
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

/// Two parts of some items: the sums over them, and what they cost, where that is wanted.
struct Halves {
    moments: [Moments; 2],
    costs: Option<[f64; 2]>,
}

/// [`halves`] of two items: by place, for both ways leave the same two parts.
fn halves_of_two(items: &[Item], [a, b]: [u32; 2], order: &mut [u32]) -> (usize, Halves) {
    let [p, q] = [a, b].map(|item| &items[item as usize].keys);
    let width = |key: usize| (p[key] - q[key]).abs();
    let wider = |best, key| if width(key) > width(best) { key } else { best };
    let key = (PLACE + 1..PLACE + 3).fold(PLACE, wider);
    let is_turned = p[key] > q[key] || (p[key] == q[key] && a > b);
    let ordered = if is_turned { [b, a] } else { [a, b] };
    order.copy_from_slice(&ordered);
    (1, Halves { moments: ordered.map(|item| Moments::of([&items[item as usize]])), costs: None })
}

/// Divides more than two items in the better of two ways; the number of those on the left, and both
/// parts.
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
    let faces: f64 = quarters.iter().map(Moments::count).sum();
    let least = f64::from((LEAST_SHARE * faces) as u32).max(1.0);
    let mut judged = |cut: Cut, sides: [Moments; 2]| {
        let is_lopsided = sides.iter().any(|side| side.count() < least);
        if is_lopsided { Cut::halving(cut.key, items, order, scratch) } else { (cut, sides) }
    };
    let mut best = judged(cuts[0], [a.plus(&b), c.plus(&d)]);
    let mut costs = None;
    if ranges.width(cuts[1].key) > FLAT {
        let by_facing = judged(cuts[1], [a.plus(&c), b.plus(&d)]);
        let costs_of =
            |(_, sides): &(Cut, [Moments; 2])| [0, 1].map(|k: usize| sides[k].cost(opening));
        let [of_best, of_other] = [costs_of(&best), costs_of(&by_facing)];
        costs = Some(of_best);
        if of_other[0] + of_other[1] < of_best[0] + of_best[1] {
            (best, costs) = (by_facing, Some(of_other));
        }
    }
    let (cut, moments) = best;
    let sides = Halves { moments, costs };
    let left = partition(order, &mut scratch.aside, |&item| !cut.is_right(items, item));
    (left, sides)
}
