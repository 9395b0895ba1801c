//! A tree of boxes paired with itself: every two faces whose boxes overlap.
//!
//! Source: two trees are descended at once, as by Gottschalk, Lin and Manocha (1996, "OBBTree: a
//! hierarchical structure for rapid interference detection"); here both are one, and the larger box
//! is opened. Cost: the pairs of nodes whose boxes overlap, and those of their children:
//! near-linear where faces overlap few others, O(n²) at worst.

use std::ops::ControlFlow;

use crate::ids::FaceId;
use crate::tree::{Content, FaceTree};

/// Calls `visit` with every two faces of different leaves, or of one, whose leaves' boxes overlap:
/// each pair once. `opens` is called for a node before its faces are paired with each other (twice
/// the same node), and before those of two nodes are; what it refuses is passed over. `visit` may
/// end the search.
pub(super) fn overlapping_pairs(
    tree: &FaceTree,
    mut opens: impl FnMut(u32, u32) -> bool,
    mut visit: impl FnMut(FaceId, FaceId) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let leaf = |start: u32, end: u32| &tree.faces()[start as usize..end as usize];
    let mut stack = if tree.nodes().is_empty() { Vec::new() } else { vec![(0u32, 0u32)] };
    while let Some((i, j)) = stack.pop() {
        if !opens(i, j) {
            continue;
        }
        let mut push = |i: u32, j: u32| {
            let [a, b] = [i, j].map(|node| &tree.node(node).bounds);
            let along = |axis: usize| (a.min[axis] <= b.max[axis]) & (b.min[axis] <= a.max[axis]);
            // Taken back where they do not overlap: without a branch that nobody can predict.
            stack.push((i, j));
            stack.truncate(stack.len() - usize::from(!(along(0) & along(1) & along(2))));
        };
        match (tree.content(i), tree.content(j)) {
            (Content::Inner { left, right }, _) if i == j => {
                push(left, right);
                // One face alone is no pair.
                let has_pairs = |node: &u32| tree.node(*node).count() != 1;
                stack.extend([left, right].into_iter().filter(has_pairs).map(|node| (node, node)));
            }
            (Content::Leaf { start, end }, _) if i == j => {
                let all = leaf(start, end);
                for (n, &f) in all.iter().enumerate() {
                    all[n + 1..].iter().try_for_each(|&g| visit(f, g))?;
                }
            }
            // The larger box is opened; a leaf cannot be.
            (Content::Inner { left, right }, other)
                if matches!(other, Content::Leaf { .. }) || is_larger(tree, i, j) =>
            {
                push(left, j);
                push(right, j);
            }
            (_, Content::Inner { left, right }) => {
                push(i, left);
                push(i, right);
            }
            (Content::Leaf { start, end }, Content::Leaf { start: from, end: to }) => {
                for &f in leaf(start, end) {
                    leaf(from, to).iter().try_for_each(|&g| visit(f, g))?;
                }
            }
            (Content::Inner { .. }, Content::Leaf { .. }) => {} // opened above
        }
    }
    ControlFlow::Continue(())
}

fn is_larger(tree: &FaceTree, i: u32, j: u32) -> bool {
    let size = |n: u32| {
        let b = tree.node(n).bounds;
        (b.max - b.min).element_sum()
    };
    size(i) >= size(j)
}
