//! Dividing the faces beneath a facet into those of the next layer.
//!
//! Greedy: the costliest part is divided in two until the layer is full. A part costs its number of
//! faces times its *thickness*, the depth of its faces beneath their plane: that is how many
//! faces a thing within a random distance of the plane has to look at. Two ways to divide are tried, each at
//! the middle of the widest range: by position in a frame along and around the opening direction, or
//! by normal. The lesser sum of costs wins: on a thread, azimuths first and flanks later; in a box, its
//! sides at once.
//!
//! The plane of a part faces as its faces do on average. A hole right through has no floor, though, and what
//! is in it goes on in both directions: there the planes stand along the axis, where they can.

use cranny_exact::{Aabb, DVec3};

use super::EnvelopeOptions;
use crate::ids::FaceId;

/// A face on its way.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub(super) corners: [DVec3; 3],
    /// Unit normal; zero for a face without area.
    pub(super) normal: DVec3,
    pub(super) area: f64,
    pub(super) face: FaceId,
}

/// How a pocket opens.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    pub(super) axis: DVec3,
    /// Right angles: the axis, and two directions around it.
    pub(super) frame: [DVec3; 3],
    /// Openings cancel: it goes right through along the axis.
    pub(super) is_through: bool,
}

/// A part of the items, and the normal of its plane.
#[derive(Clone, Copy)]
pub(super) struct Cluster {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) normal: DVec3,
    cost: f64,
}

/// What part of its size adds to a part's thickness: a flat wall is divided too, once thicker parts are
/// thin. Smaller: walls stay whole and one offence opens them all; larger: sides are cut before
/// they are told apart.
const SPREAD: f64 = 0.125;

/// Ranges of normals narrower than this are not worth dividing by.
const FLAT: f64 = 1.0 / 1024.0;

/// No part may be smaller than this part of both; else they are halved by number. Larger: cuts
/// miss the gaps between groups of faces; smaller: layers get deep and lopsided.
const LEAST_SHARE: f64 = 0.125;

/// Large parts are judged by about this many of their items, which costs divide them and what their
/// planes face; the planes themselves hold all. Smaller, and parts divide worse; larger, and most of the
/// time of building goes into judging.
const SAMPLE: usize = 512;

/// The distance between items that are judged.
fn stride(items: &[Item]) -> usize {
    items.len().div_ceil(SAMPLE).max(1)
}

fn sample(items: &[Item]) -> impl Iterator<Item = &Item> {
    items.iter().step_by(stride(items))
}

/// Memory that is used again from part to part.
#[derive(Default)]
pub(super) struct Scratch {
    /// By item.
    keys: Vec<f64>,
    ordered: Vec<(f64, FaceId)>,
    /// The judged items left and right of a cut.
    sides: [Vec<u32>; 2],
}

/// Divides at least one item into at most `options.width` parts and orders the items by parts.
pub(super) fn clusters(
    items: &mut [Item],
    opening: &Opening,
    options: &EnvelopeOptions,
    scratch: &mut Scratch,
) -> Vec<Cluster> {
    let judged: Vec<u32> = (0..items.len() as u32).step_by(stride(items)).collect();
    let mut parts = vec![Cluster::of(items, &judged, [0, items.len()], opening)];
    while parts.len() < options.width {
        let divisible = |c: &&mut Cluster| c.end - c.start > options.leaf_faces;
        let costliest = parts
            .iter_mut()
            .filter(divisible)
            .max_by(|a, b| a.cost.total_cmp(&b.cost).then(b.start.cmp(&a.start)));
        let Some(part) = costliest else { break };
        let (start, end) = (part.start, part.end);
        let [left, right] = halves(items, start, end, opening, scratch);
        *part = left;
        parts.push(right);
    }
    parts
}

impl Cluster {
    /// Of the items that are to stand in a range, by some of them.
    fn of(items: &[Item], judged: &[u32], [start, end]: [usize; 2], opening: &Opening) -> Self {
        let judged = || judged.iter().map(|&i| &items[i as usize]);
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for item in judged() {
            sum += item.area * item.normal;
            total += item.area;
        }
        let normal = opening.normal_of(sum, total);
        let (mut low, mut high, mut bounds) = (f64::INFINITY, f64::NEG_INFINITY, Aabb::EMPTY);
        for corner in judged().flat_map(|item| item.corners) {
            let height = normal.dot(corner);
            (low, high) = (low.min(height), high.max(height));
            bounds = Aabb { min: bounds.min.min(corner), max: bounds.max.max(corner) };
        }
        // Where none was judged nothing is known of a thickness.
        let thickness = (high - low).max(0.0) + SPREAD * bounds.diagonal();
        Self { start, end, normal, cost: (end - start) as f64 * thickness }
    }
}

impl Opening {
    /// What the plane of some faces faces, by the sum of their area vectors and that of their areas.
    fn normal_of(&self, sum: DVec3, total: f64) -> DVec3 {
        // Where normals cancel (around a whole hole) no plane is good; the part is divided anyway.
        let axis = self.axis;
        let mean = if sum.length() > FLAT * total { sum.normalize() } else { axis };
        let upright = mean - mean.dot(axis) * axis;
        let stands = self.is_through && upright.length() > LEAST_UPRIGHT;
        if stands { upright.normalize() } else { mean }
    }
}

/// A plane is made to stand along the axis of a hole right through if its normal is within 60 degrees of
/// one that does. Larger: more planes that every long peg offends; smaller: planes far from their
/// faces.
const LEAST_UPRIGHT: f64 = 0.5;

/// What items are divided by: where they lie along a direction, or how far they face it.
#[derive(Clone, Copy)]
enum Key {
    Place(DVec3),
    Facing(DVec3),
}

impl Key {
    fn of(self, item: &Item) -> f64 {
        let key = match self {
            Self::Place(axis) => axis.dot(item.corners[0] + item.corners[1] + item.corners[2]),
            Self::Facing(axis) => axis.dot(item.normal),
        };
        // No zero has a sign, so that all orders agree.
        key + 0.0
    }

    /// The one with the widest range of three, and that range.
    fn widest(keys: [Self; 3], items: &[Item]) -> (Self, [f64; 2]) {
        let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for item in sample(items) {
            for (range, key) in ranges.iter_mut().zip(keys) {
                let k = key.of(item);
                *range = [range[0].min(k), range[1].max(k)];
            }
        }
        let width = |k: usize| ranges[k][1] - ranges[k][0];
        let best = (1..3).fold(0, |best, k| if width(k) > width(best) { k } else { best });
        (keys[best], ranges[best])
    }
}

/// A way to divide items in two.
#[derive(Clone, Copy)]
struct Cut {
    key: Key,
    /// Where the right side begins; of equal keys, with this face.
    at: (f64, FaceId),
    /// How many items are on the left side.
    left: usize,
}

impl Cut {
    /// At the middle of the range of a key, for at least two items. Two halves by number where that would
    /// be lopsided.
    fn new(key: Key, range: [f64; 2], items: &[Item], scratch: &mut Scratch) -> Self {
        let middle = 0.5 * (range[0] + range[1]);
        let Scratch { keys, ordered, .. } = scratch;
        let left = keys.iter().filter(|&&k| k < middle).count();
        let least = (LEAST_SHARE * items.len() as f64).max(1.0) as usize;
        if left >= least && items.len() - left >= least {
            return Self { key, at: (middle, FaceId(0)), left };
        }
        let left = items.len() / 2;
        ordered.clear();
        ordered.extend(keys.iter().zip(items).map(|(&k, item)| (k, item.face)));
        let (_, &mut at, _) =
            ordered.select_nth_unstable_by(left, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        Self { key, at, left }
    }

    fn is_right(&self, key: f64, item: &Item) -> bool {
        key > self.at.0 || (key == self.at.0 && item.face >= self.at.1)
    }
}

/// One way to divide a part that begins at `start`: where, and what comes of it.
fn judged(
    part: &[Item],
    start: usize,
    (key, range): (Key, [f64; 2]),
    opening: &Opening,
    scratch: &mut Scratch,
) -> (Cut, [Cluster; 2]) {
    scratch.keys.clear();
    scratch.keys.extend(part.iter().map(|item| key.of(item)));
    let cut = Cut::new(key, range, part, scratch);
    let Scratch { keys, sides, .. } = scratch;
    sides.iter_mut().for_each(Vec::clear);
    for i in (0..part.len()).step_by(stride(part)) {
        sides[usize::from(cut.is_right(keys[i], &part[i]))].push(i as u32);
    }
    let (middle, end) = (start + cut.left, start + part.len());
    let left = Cluster::of(part, &sides[0], [start, middle], opening);
    (cut, [left, Cluster::of(part, &sides[1], [middle, end], opening)])
}

/// Divides a part of at least two items in the better of two ways.
fn halves(
    items: &mut [Item],
    start: usize,
    end: usize,
    opening: &Opening,
    scratch: &mut Scratch,
) -> [Cluster; 2] {
    let part = &mut items[start..end];
    let cost = |parts: &[Cluster; 2]| parts[0].cost + parts[1].cost;
    let place = Key::widest(opening.frame.map(Key::Place), part);
    let (mut cut, mut parts) = judged(part, start, place, opening, scratch);
    let facing = Key::widest(opening.frame.map(Key::Facing), part);
    if facing.1[1] - facing.1[0] > FLAT {
        let by_facing = judged(part, start, facing, opening, scratch);
        if cost(&by_facing.1) < cost(&parts) {
            (cut, parts) = by_facing;
        }
    }
    divide(part, &cut);
    parts
}

/// Orders items so that those left of a cut stand first.
fn divide(items: &mut [Item], cut: &Cut) {
    let is_right = |item: &Item| cut.is_right(cut.key.of(item), item);
    let (mut low, mut high) = (0, items.len());
    loop {
        while low < high && !is_right(&items[low]) {
            low += 1;
        }
        while low < high && is_right(&items[high - 1]) {
            high -= 1;
        }
        if low >= high {
            debug_assert_eq!(low, cut.left);
            return;
        }
        items.swap(low, high - 1);
    }
}
