//! What is left of a tree when some of its faces are taken out.
//!
//! A concavity may have nearly all faces of a body (the thread of a bolt). A tree of its own would
//! be grown by nearly the same cuts as the tree over all faces, so that one is pruned instead:
//! nodes without a face are left out, those with few become leaves, and boxes are fitted anew.
//!
//! No source: this crate's own. The order of faces stays, and boxes are those of what is left, so
//! what comes out is a tree over it. Cost: O(n) for n faces before pruning.

use cranny_exact::Aabb;

use super::build::INNER;
use super::{Content, FaceTree, Node};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// At least so many of four faces must be kept, or cuts between the others spoil the tree.
const LEAST_KEPT: usize = 3;

/// A part of the tree to come: what is left of it beneath a node, and how many faces that node
/// holds.
struct PruneTask {
    place: NodePlace,
    held: usize,
    /// The node whose right child this is; a left child stands right behind its parent.
    parent: Option<usize>,
}

/// A node of a tree whose leaves hold one face each, and the place of the first face beneath.
#[derive(Clone, Copy)]
struct NodePlace {
    node: u32,
    first: u32,
}

impl FaceTree {
    /// Whether every leaf holds one face.
    fn has_single_faces(&self) -> bool {
        self.nodes.len() + 1 == 2 * self.faces.len()
    }

    /// The children of an inner node, where every leaf holds one face. Nodes beneath the left one,
    /// of which one more than half are leaves, stand between them.
    fn children(&self, NodePlace { node, first }: NodePlace) -> Option<[NodePlace; 2]> {
        match self.content(node) {
            Content::Inner { left, right } => {
                let beneath = (right - left).div_ceil(2);
                Some([
                    NodePlace { node: left, first },
                    NodePlace { node: right, first: first + beneath },
                ])
            }
            Content::Leaf { .. } => None,
        }
    }

    /// Whether the tree over some of its faces may as well be pruned as grown.
    pub(super) fn is_worth_pruning(&self, kept: usize) -> bool {
        4 * kept >= LEAST_KEPT * self.faces.len() && self.has_single_faces()
    }

    /// Appends what is left of this tree, whose leaves hold one face each, to `arena` when only
    /// `kept` remain, each named once; at least one. Leaves hold at most `leaf_size >= 1`.
    ///
    /// Cost: O(n) for n faces of this tree.
    pub(super) fn prune(&self, mesh: &Mesh, kept: &[FaceId], leaf_size: usize, arena: &mut Self) {
        let mut is_kept = vec![false; mesh.faces().len()];
        kept.iter().for_each(|face| is_kept[face.index()] = true);
        // How many stand before each place.
        let mut before = Vec::with_capacity(self.faces.len() + 1);
        before.push(0u32);
        let mut count = 0;
        before.extend(self.faces.iter().map(|face| {
            count += u32::from(is_kept[face.index()]);
            count
        }));
        let kept_of = |first: u32, held: usize| {
            (before[first as usize + held] - before[first as usize]) as usize
        };
        // Inner nodes that lose some of their faces, whose boxes are not fitted yet.
        let mut parted = Vec::new();
        arena.faces.reserve(kept.len());
        // Leaves are a little more than half full, and there are nearly as many inner nodes.
        arena.nodes.reserve(5 * kept.len().div_ceil(leaf_size.max(1)) / 2);
        let place = NodePlace { node: 0, first: 0 };
        let mut stack = vec![PruneTask { place, held: self.faces.len(), parent: None }];
        while let Some(PruneTask { mut place, mut held, parent }) = stack.pop() {
            if let Some(parent) = parent {
                arena.nodes[parent].content = arena.nodes.len() as u32;
            }
            let count = kept_of(place.first, held);
            // Down to the highest node that keeps faces on both sides.
            let children = loop {
                let Some([left, right]) = self.children(place).filter(|_| count > leaf_size) else {
                    break None;
                };
                let on_left = (right.first - left.first) as usize;
                let kept_on_left = kept_of(left.first, on_left);
                if kept_on_left == 0 {
                    (place, held) = (right, held - on_left);
                } else if kept_on_left == count {
                    (place, held) = (left, on_left);
                } else {
                    break Some([(left, on_left), (right, held - on_left)]);
                }
            };
            if let Some([left, right]) = children {
                let id = arena.nodes.len();
                stack.push(PruneTask { place: right.0, held: right.1, parent: Some(id) });
                stack.push(PruneTask { place: left.0, held: left.1, parent: None });
                if count == held {
                    arena.nodes.push(Node { bounds: self.node(place.node).bounds, ..INNER });
                } else {
                    arena.nodes.push(INNER);
                    parted.push(id);
                }
                continue;
            }
            let first = arena.faces.len();
            let beneath = &self.faces[place.first as usize..place.first as usize + held];
            let bounds = if count == held {
                arena.faces.extend_from_slice(beneath);
                self.node(place.node).bounds
            } else {
                arena.faces.extend(beneath.iter().filter(|face| is_kept[face.index()]));
                let kept = &arena.faces[first..];
                Aabb::of_points(kept.iter().flat_map(|&f| mesh.triangle(f)))
            };
            arena.nodes.push(Node { bounds, content: first as u32, count: count as u32 });
        }
        for index in parted.into_iter().rev() {
            if let Content::Inner { left, right } = arena.content(index as u32) {
                let both = arena.node(left).bounds.union(&arena.node(right).bounds);
                arena.nodes[index].bounds = both;
            }
        }
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
        assert_eq!(pruned(usize::MAX).nodes().len(), 1);
        assert!(tree.is_worth_pruning(3) && !tree.is_worth_pruning(2));
        assert!(!FaceTree::of(&mesh, 2).is_worth_pruning(3));
    }
}
