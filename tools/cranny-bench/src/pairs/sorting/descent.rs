//! A paired descent from the top, which keeps nothing.

use cranny_exact::RigidMap;
use cranny_geometry::{Content, FaceTree};

use super::level::NodePair;
use super::levels::{pairs_beneath, posed};

/// Pairs of leaves whose boxes overlap where the second tree is posed by `map` in the first's
/// frame, and how many pairs of boxes were compared. Both nodes of a pair are opened at once, as
/// sorting does.
pub(super) fn pairs_of_leaves(trees: [&FaceTree; 2], map: &RigidMap) -> (Vec<NodePair>, u64) {
    let (mut found, mut tests) = (Vec::new(), 0);
    let some = trees.iter().all(|tree| !tree.nodes().is_empty());
    let mut stack: Vec<NodePair> = if some { vec![[0, 0]] } else { Vec::new() };
    while let Some(pair) = stack.pop() {
        let [a, b] = [0, 1].map(|i| trees[i].node(pair[i]).bounds);
        tests += 1;
        if !a.overlaps(&posed(&b, map, 0.0)) {
            continue;
        }
        let is_leaf = |i: usize| matches!(trees[i].content(pair[i]), Content::Leaf { .. });
        if is_leaf(0) && is_leaf(1) {
            found.push(pair);
        } else {
            stack.extend(pairs_beneath(trees, pair));
        }
    }
    (found, tests)
}
