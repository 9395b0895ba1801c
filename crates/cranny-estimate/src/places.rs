//! Boxes in which two surfaces may be within a margin of each other.

use cranny_exact::{Aabb, Interval};
use cranny_narrow_phase::operations::Pair;

use crate::estimate::Place;
use crate::refinement::Refinement;
use crate::trees::{NodePair, PairTrees};

/// Lists every entry of the cut that may hold faces within `margin`, nearest first. `least` is a
/// lower bound of the distance of the bodies.
///
/// Cost: linear in the cut.
pub(crate) fn places(
    pair: &Pair,
    trees: &PairTrees,
    cut: &Refinement,
    margin: f64,
    least: f64,
) -> Vec<Place> {
    let mut near: Vec<(f64, NodePair)> = cut
        .entries()
        .map(|entry| (cut.lower(entry, trees).max(least), entry.nodes))
        .filter(|&(lower, _)| lower <= margin)
        .collect();
    near.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    near.into_iter().filter_map(|(lower, nodes)| place(pair, trees, nodes, margin, lower)).collect()
}

/// `None` if the boxes, grown by the margin, are disjoint.
fn place(
    pair: &Pair,
    trees: &PairTrees,
    [a, b]: NodePair,
    margin: f64,
    lower: f64,
) -> Option<Place> {
    let first = trees.sides[0].node(a).bounds;
    let second = pair.first_from_second().bounds(&trees.sides[1].node(b).bounds);
    let reach = margin + trees.error;
    let (x, y) = (first.grown(reach), second.grown(reach));
    let common = Aabb { min: x.min.max(y.min), max: x.max.min(y.max) };
    // The two points farthest apart of two boxes are corners.
    let far = (second.max - first.min).max(first.max - second.min).length() + trees.error;
    (!common.is_empty()).then(|| Place {
        bounds: pair.world_bounds(&common),
        separation: Interval { lo: lower.max(0.0), hi: far.max(lower) },
    })
}
