//! What is left of a tree when some of its faces are taken out.
//!
//! A concavity may have nearly all faces of a body (the thread of a bolt). A tree of its own would
//! be grown by nearly the same cuts as the tree over all faces, so that one is pruned instead: nodes without
//! a face are left out, those with few become leaves, and boxes are fitted anew.

use cranny_exact::Aabb;

use super::build::INNER;
use super::{Content, FaceTree, Node};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// At least so many of four faces must be kept, or cuts between the others spoil the tree.
const LEAST_KEPT: usize = 3;

impl FaceTree {
    /// Whether the tree over some of its faces may as well be pruned as grown.
    pub(super) fn is_worth_pruning(&self, kept: usize, leaf_size: usize) -> bool {
        4 * kept >= LEAST_KEPT * self.faces.len()
            && self.nodes.iter().all(|node| node.count as usize <= leaf_size)
    }

    /// Appends what is left of this tree, whose leaves hold at most `leaf_size` faces, to `arena` when only
    /// `kept` remain, each named once; at least one.
    ///
    /// Cost: O(n) for n faces of this tree.
    pub(super) fn prune(&self, mesh: &Mesh, kept: &[FaceId], leaf_size: usize, arena: &mut Self) {
        let mut is_kept = vec![false; mesh.faces().len()];
        kept.iter().for_each(|face| is_kept[face.index()] = true);
        let counts = self.counts(&is_kept);
        let root = arena.nodes.len();
        arena.faces.reserve(kept.len());
        // Leaves are a little more than half full, and there are nearly as many inner nodes.
        arena.nodes.reserve(5 * kept.len() / (2 * leaf_size));
        // Nodes to come, and whose right children they are; a left child stands right behind its parent.
        let mut stack: Vec<(u32, Option<usize>)> = vec![(0, None)];
        while let Some((node, parent)) = stack.pop() {
            let node = self.thinned(node, &counts);
            if let Some(parent) = parent {
                arena.nodes[parent].content = arena.nodes.len() as u32;
            }
            match self.content(node) {
                Content::Inner { left, right } if counts[node as usize] as usize > leaf_size => {
                    stack.extend([(right, Some(arena.nodes.len())), (left, None)]);
                    arena.nodes.push(INNER);
                }
                _ => {
                    let first = arena.faces.len();
                    let (_, held) = self.beneath(node);
                    let held = &self.faces[held.start as usize..held.end as usize];
                    let count = counts[node as usize];
                    let bounds = if held.len() == count as usize {
                        arena.faces.extend_from_slice(held);
                        self.node(node).bounds
                    } else {
                        arena.faces.extend(held.iter().filter(|face| is_kept[face.index()]));
                        let kept = &arena.faces[first..];
                        Aabb::of_points(kept.iter().flat_map(|&f| mesh.triangle(f)))
                    };
                    arena.nodes.push(Node { bounds, content: first as u32, count });
                }
            }
        }
        for index in (root..arena.nodes.len()).rev() {
            if let Content::Inner { left, right } = arena.content(index as u32) {
                let both = arena.node(left).bounds.union(&arena.node(right).bounds);
                arena.nodes[index].bounds = both;
            }
        }
    }

    /// How many kept faces each node holds.
    fn counts(&self, is_kept: &[bool]) -> Vec<u32> {
        let mut counts = vec![0; self.nodes.len()];
        // Children stand behind their parents.
        for index in (0..self.nodes.len()).rev() {
            counts[index] = match self.content(index as u32) {
                Content::Inner { left, right } => counts[left as usize] + counts[right as usize],
                Content::Leaf { .. } => {
                    let held = self.leaf_faces(index as u32).iter();
                    held.filter(|face| is_kept[face.index()]).count() as u32
                }
            };
        }
        counts
    }

    /// The highest node beneath this one that holds the same kept faces and no child without one.
    fn thinned(&self, mut node: u32, counts: &[u32]) -> u32 {
        while let Content::Inner { left, right } = self.content(node) {
            match [left, right].map(|child| counts[child as usize]) {
                [0, _] => node = right,
                [_, 0] => node = left,
                _ => break,
            }
        }
        node
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    #[test]
    fn what_is_left_of_a_row_by_hand() {
        // Four squares in a row, tree ((0 1) (2 3)); without 1 the left half is the leaf 0.
        let corner = |i: u32| DVec3::new(f64::from(4 * (i / 3) + i % 3), f64::from(i % 2), 0.0);
        let faces = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mesh = Mesh::new((0..12).map(corner).collect(), faces).unwrap();
        let tree = FaceTree::of(&mesh, 1);
        assert_eq!(tree.faces(), [0, 1, 2, 3].map(FaceId));
        let kept = [FaceId(3), FaceId(0), FaceId(2)];
        let pruned = |leaf_size| {
            let mut arena = FaceTree { nodes: Vec::new(), faces: Vec::new() };
            tree.prune(&mesh, &kept, leaf_size, &mut arena);
            arena.validate(&mesh, &kept).unwrap();
            arena
        };
        let left = pruned(1);
        assert_eq!((left.faces(), left.nodes().len()), (&[0, 2, 3].map(FaceId)[..], 5));
        assert_eq!(left.leaf_faces(1), [FaceId(0)]);
        assert_eq!(left.content(2), Content::Inner { left: 3, right: 4 });
        assert_eq!(left.node(2).bounds.min.x, 8.0);
        let left = pruned(2);
        assert_eq!(left.content(0), Content::Inner { left: 1, right: 2 });
        assert_eq!((left.leaf_faces(1).len(), left.leaf_faces(2).len()), (1, 2));
        assert_eq!(pruned(3).nodes().len(), 1);
        assert!(tree.is_worth_pruning(3, 1) && !tree.is_worth_pruning(2, 1));
        assert!(!FaceTree::of(&mesh, 2).is_worth_pruning(3, 1));
    }
}
