//! Where two surfaces may be within a margin of each other, told as boxes.

use cranny_exact::{Aabb, Interval};

use super::estimate::Place;
use super::ground::{Ground, Nodes};
use super::refinement::Refinement;
use crate::pair::Pair;

/// Every entry of the cut that may hold faces within `margin`, nearest first. The bodies are known to be
/// no nearer than `least`.
///
/// Cost: linear in the cut, whatever it holds.
pub(super) fn places(
    pair: &Pair,
    ground: &Ground,
    cut: &Refinement,
    margin: f64,
    least: f64,
) -> Vec<Place> {
    let mut near: Vec<(f64, Nodes)> = cut
        .entries()
        .map(|entry| (cut.lower(entry, ground).max(least), entry.nodes))
        .filter(|&(lower, _)| lower <= margin)
        .collect();
    near.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    near.into_iter()
        .filter_map(|(lower, nodes)| place(pair, ground, nodes, margin, lower))
        .collect()
}

/// `None` where boxes grown by the margin share no point.
fn place(pair: &Pair, ground: &Ground, [a, b]: Nodes, margin: f64, lower: f64) -> Option<Place> {
    let first = ground.trees[0].node(a).bounds;
    let second = pair.first_from_second.bounds(&ground.trees[1].node(b).bounds);
    let reach = margin + ground.error;
    let (x, y) = (first.grown(reach), second.grown(reach));
    let common = Aabb { min: x.min.max(y.min), max: x.max.min(y.max) };
    // The two points farthest apart of two boxes are corners.
    let far = (second.max - first.min).max(first.max - second.min).length() + ground.error;
    (!common.is_empty()).then(|| Place {
        bounds: pair.world_bounds(&common),
        separation: Interval { lo: lower.max(0.0), hi: far.max(lower) },
    })
}
