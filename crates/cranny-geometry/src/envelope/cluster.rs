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
const SAMPLE: usize = 256;

fn sample(items: &[Item]) -> impl Iterator<Item = &Item> {
    items.iter().step_by(items.len().div_ceil(SAMPLE).max(1))
}

/// Divides at least one item into at most `options.width` parts and orders the items by parts.
pub(super) fn clusters(
    items: &mut [Item],
    opening: &Opening,
    options: &EnvelopeOptions,
) -> Vec<Cluster> {
    let mut parts = vec![Cluster::of(items, 0, items.len(), opening)];
    while parts.len() < options.width {
        let divisible = |c: &&mut Cluster| c.end - c.start > options.leaf_faces;
        let costliest = parts
            .iter_mut()
            .filter(divisible)
            .max_by(|a, b| a.cost.total_cmp(&b.cost).then(b.start.cmp(&a.start)));
        let Some(part) = costliest else { break };
        let (start, end) = (part.start, part.end);
        let [left, right] = halves(items, start, end, opening);
        *part = left;
        parts.push(right);
    }
    parts
}

impl Cluster {
    fn of(items: &[Item], start: usize, end: usize, opening: &Opening) -> Self {
        let part = &items[start..end];
        let sum: DVec3 = sample(part).map(|item| item.area * item.normal).sum();
        let total: f64 = sample(part).map(|item| item.area).sum();
        // Where normals cancel (around a whole hole) no plane is good; the part is divided anyway.
        let axis = opening.axis;
        let mean = if sum.length() > FLAT * total { sum.normalize() } else { axis };
        let upright = mean - mean.dot(axis) * axis;
        let stands = opening.is_through && upright.length() > LEAST_UPRIGHT;
        let normal = if stands { upright.normalize() } else { mean };
        let (mut low, mut high, mut bounds) = (f64::INFINITY, f64::NEG_INFINITY, Aabb::EMPTY);
        for corner in sample(part).flat_map(|item| item.corners) {
            let along = normal.dot(corner);
            (low, high) = (low.min(along), high.max(along));
            bounds = Aabb { min: bounds.min.min(corner), max: bounds.max.max(corner) };
        }
        let cost = (end - start) as f64 * ((high - low) + SPREAD * bounds.diagonal());
        Self { start, end, normal, cost }
    }
}

/// A plane is made to stand along the axis of a hole right through if its normal is within 60 degrees of
/// one that does. Larger: more planes that every long peg offends; smaller: planes far from their
/// faces.
const LEAST_UPRIGHT: f64 = 0.5;

/// Divides a part of at least two items in the better of two ways.
fn halves(items: &mut [Item], start: usize, end: usize, opening: &Opening) -> [Cluster; 2] {
    let (across, around) = opening.axis.any_orthonormal_pair();
    let frame = &[opening.axis, across, around];
    let place =
        |item: &Item, axis: DVec3| axis.dot(item.corners[0] + item.corners[1] + item.corners[2]);
    let facing = |item: &Item, axis: DVec3| axis.dot(item.normal);
    let (place_axis, place_range) = widest(&items[start..end], frame, place);
    let (facing_axis, facing_range) = widest(&items[start..end], frame, facing);
    let measured = |items: &[Item], middle: usize| {
        [Cluster::of(items, start, middle, opening), Cluster::of(items, middle, end, opening)]
    };
    let cost = |parts: &[Cluster; 2]| parts[0].cost + parts[1].cost;

    let mut by_facing = None;
    if facing_range[1] - facing_range[0] > FLAT {
        let middle = divide(&mut items[start..end], facing_range, |i| facing(i, facing_axis));
        by_facing = Some(measured(items, start + middle));
    }
    let middle = divide(&mut items[start..end], place_range, |i| place(i, place_axis));
    let by_place = measured(items, start + middle);
    match by_facing {
        Some(parts) if cost(&parts) < cost(&by_place) => {
            let middle = divide(&mut items[start..end], facing_range, |i| facing(i, facing_axis));
            measured(items, start + middle)
        }
        _ => by_place,
    }
}

/// The axis of the frame along which a key has the widest range, and that range.
fn widest(
    items: &[Item],
    frame: &[DVec3; 3],
    key: impl Fn(&Item, DVec3) -> f64,
) -> (DVec3, [f64; 2]) {
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for item in sample(items) {
        for (range, &axis) in ranges.iter_mut().zip(frame) {
            let k = key(item, axis);
            *range = [range[0].min(k), range[1].max(k)];
        }
    }
    let width = |k: usize| ranges[k][1] - ranges[k][0];
    let mut best = 0;
    for k in 1..3 {
        if width(k) > width(best) {
            best = k;
        }
    }
    (frame[best], ranges[best])
}

/// Orders at least two items so that keys below the middle of the range stand first; returns where the
/// others begin. Two halves by number where that would be lopsided.
fn divide(items: &mut [Item], range: [f64; 2], key: impl Fn(&Item) -> f64) -> usize {
    let cut = 0.5 * (range[0] + range[1]);
    let (mut low, mut high) = (0, items.len());
    while low < high {
        if key(&items[low]) < cut {
            low += 1;
        } else {
            high -= 1;
            items.swap(low, high);
        }
    }
    let least = (LEAST_SHARE * items.len() as f64).max(1.0) as usize;
    if low >= least && items.len() - low >= least {
        return low;
    }
    let middle = items.len() / 2;
    items
        .select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.face.cmp(&b.face)));
    middle
}
