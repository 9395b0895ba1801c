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
        match (trees[0].content(nodes[0]), trees[1].content(nodes[1])) {
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

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::*;
    use crate::mesh::Mesh;

    /// A tree of two faces with a leaf each; its root is `size` long.
    fn two_faces(size: f64) -> FaceTree {
        let at = |x: f64, y: f64| size * DVec3::new(x, y, 0.0);
        let vertices = vec![at(0.0, 0.0), at(0.1, 0.0), at(0.0, 0.1), at(0.9, 0.0), at(1.0, 0.0)];
        FaceTree::of(&Mesh::new(vertices, vec![[0, 1, 2], [3, 4, 2]]).unwrap(), 1)
    }

    #[test]
    fn the_larger_node_is_opened_or_the_one_that_has_children() {
        let (small, large) = (two_faces(1.0), two_faces(2.0));
        let step = |trees: [&FaceTree; 2], nodes| PairedStep::of_larger(trees, nodes);
        assert_eq!(step([&large, &small], [0, 0]), PairedStep::First(1, 2));
        assert_eq!(step([&small, &large], [0, 0]), PairedStep::Second(1, 2));
        assert_eq!(step([&small, &small], [0, 0]), PairedStep::First(1, 2));
        assert_eq!(step([&large, &small], [1, 0]), PairedStep::Second(1, 2));
        assert_eq!(step([&small, &large], [0, 2]), PairedStep::First(1, 2));
        assert_eq!(step([&small, &large], [1, 2]), PairedStep::Leaves);
    }
}
