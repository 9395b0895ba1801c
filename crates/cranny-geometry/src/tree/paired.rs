//! Which node a paired descent of two trees opens.

use cranny_exact::Aabb;

use super::{Content, FaceTree, Node};

/// The node of a pair that a paired descent opens, with its children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairedStep {
    /// The first tree's node: its left and its right child.
    First(u32, u32),
    /// The second tree's node: its left and its right child.
    Second(u32, u32),
    /// Neither: both are leaves.
    Leaves,
}

impl PairedStep {
    /// Opens the node with the longer diagonal, the first of two equal ones, or the only one that
    /// has children. `nodes` are indices of the two trees.
    #[inline]
    #[must_use]
    pub fn of_larger(trees: [&FaceTree; 2], nodes: [u32; 2]) -> Self {
        let size = |b: &Aabb| (b.max - b.min).length_squared();
        let [a, b]: [&Node; 2] = [trees[0].node(nodes[0]), trees[1].node(nodes[1])];
        match (a.content_at(nodes[0]), b.content_at(nodes[1])) {
            (Content::Leaf { .. }, Content::Leaf { .. }) => Self::Leaves,
            (Content::Inner { left, right }, Content::Leaf { .. }) => Self::First(left, right),
            (Content::Leaf { .. }, Content::Inner { left, right }) => Self::Second(left, right),
            (Content::Inner { left, right }, Content::Inner { left: left_b, right: right_b }) => {
                if size(&a.bounds) >= size(&b.bounds) {
                    Self::First(left, right)
                } else {
                    Self::Second(left_b, right_b)
                }
            }
        }
    }
}
