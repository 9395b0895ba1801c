//! Many trees in one array: one a concavity.
//!
//! Source and cost of growing a tree stand in `build`, of pruning one in `prune`; a forest costs
//! what its trees cost.

use super::build::Grower;
use super::{Content, FaceTree, GrownAreas, MovedFace, Node, NodeChanges, face_boxes};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// Trees over groups of faces, one behind the other in one array of nodes and one of faces.
///
/// Node and face indices count through all trees, so whoever descends reads [`arena`](Self::arena)
/// as one would a [`FaceTree`], beginning at a [`root`](Self::root).
#[derive(Clone, Debug)]
pub struct FaceForest {
    arena: FaceTree,
    /// First node and first face of each tree, and the ends.
    starts: Vec<[u32; 2]>,
}

impl FaceForest {
    /// Faces a leaf for trees over concavities. One: 1.8 times the bytes and box tests, and queries
    /// up to a third slower; four: twice the triangle tests (`cranny-bench trees`,
    /// `docs/notebook`).
    pub const DEFAULT_LEAF_SIZE: usize = 2;

    /// Builds a tree over each group, with at most `leaf_size >= 1` faces a leaf.
    ///
    /// Cost: O(n log m) for n faces in groups of at most m.
    #[must_use]
    pub fn over<'g>(
        mesh: &Mesh,
        groups: impl IntoIterator<Item = &'g [FaceId]>,
        leaf_size: usize,
    ) -> Self {
        let mut grower = Grower::new(leaf_size);
        Self::made(groups, |_, group, arena| {
            grower.grow(face_boxes(mesh, group), arena);
        })
    }

    /// The same, given the tree over all faces: where a group has most of them, that tree is
    /// pruned.
    pub fn within<'g>(
        tree: &FaceTree,
        mesh: &Mesh,
        groups: impl IntoIterator<Item = &'g [FaceId]>,
        leaf_size: usize,
    ) -> Self {
        let mut grower = Grower::new(leaf_size);
        Self::made(groups, |_, group, arena| {
            if !group.is_empty() && tree.is_worth_pruning(group.len()) {
                tree.prune(mesh, group, leaf_size, arena);
            } else {
                grower.grow(face_boxes(mesh, group), arena);
            }
        })
    }

    /// Trees that are appended to the arena by `make`, one behind the other; it is given the number
    /// of each group, too.
    fn made<'g>(
        groups: impl IntoIterator<Item = &'g [FaceId]>,
        mut make: impl FnMut(usize, &[FaceId], &mut FaceTree),
    ) -> Self {
        let mut arena = FaceTree::default();
        let mut starts = vec![[0, 0]];
        for (number, group) in groups.into_iter().enumerate() {
            make(number, group, &mut arena);
            starts.push([arena.nodes.len() as u32, arena.faces.len() as u32]);
        }
        Self { arena, starts }
    }

    /// The same trees but for those of some groups: the tree over group `i` is tree `kept(i)` of
    /// this forest, where there is one, moved; the others are built.
    ///
    /// Cost: copying, and O(n log m) for the faces of the groups that are built.
    pub fn updated<'g>(
        &self,
        mesh: &Mesh,
        groups: impl IntoIterator<Item = &'g [FaceId]>,
        leaf_size: usize,
        kept: impl Fn(usize) -> Option<usize>,
    ) -> Self {
        let mut grower = Grower::new(leaf_size);
        Self::made(groups, |group, faces, arena| {
            let Some(tree) = kept(group) else {
                grower.grow(face_boxes(mesh, faces), arena);
                return;
            };
            let [from_node, from_face] = self.starts[tree];
            let (nodes, held) = (arena.nodes.len() as u32, arena.faces.len() as u32);
            arena.nodes.extend(self.nodes(tree).iter().map(|&node| {
                let inner = node.count == 0;
                let (from, to) = if inner { (from_node, nodes) } else { (from_face, held) };
                Node { content: node.content - from + to, ..node }
            }));
            arena.faces.extend_from_slice(self.faces(tree));
        })
    }

    /// Fits the boxes of one tree after some of its faces have moved, and grows parts of it again;
    /// the changes are added to `changes`. Returns whether the tree is well again: a part that
    /// takes more or fewer nodes when grown again stays as it is.
    ///
    /// Cost: follows the number of moved faces and the depth of the tree.
    pub fn refit(
        &mut self,
        tree: usize,
        mesh: &Mesh,
        moved: &[MovedFace],
        leaf_size: usize,
        grown: &mut GrownAreas,
        changes: &mut NodeChanges,
    ) -> bool {
        self.root(tree)
            .is_none_or(|root| self.arena.refit(root, mesh, moved, leaf_size, grown, changes))
    }

    /// The range of nodes of tree `tree < len()`.
    pub fn node_range(&self, tree: usize) -> std::ops::Range<usize> {
        self.starts[tree][0] as usize..self.starts[tree + 1][0] as usize
    }

    /// Number of trees.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no tree.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The nodes and faces of all trees. Its node 0 is the root of the first tree only.
    #[must_use]
    pub fn arena(&self) -> &FaceTree {
        &self.arena
    }

    /// The root of tree `tree < len()`, as a node of the [`arena`](Self::arena); `None` where it
    /// holds no faces.
    #[must_use]
    pub fn root(&self, tree: usize) -> Option<u32> {
        let [first, last] = [self.starts[tree][0], self.starts[tree + 1][0]];
        (first < last).then_some(first)
    }

    /// The faces of tree `tree < len()`, in leaf order.
    #[must_use]
    pub fn faces(&self, tree: usize) -> &[FaceId] {
        &self.arena.faces[self.starts[tree][1] as usize..self.starts[tree + 1][1] as usize]
    }

    /// The nodes of tree `tree < len()`, root first.
    #[must_use]
    pub fn nodes(&self, tree: usize) -> &[Node] {
        &self.arena.nodes[self.starts[tree][0] as usize..self.starts[tree + 1][0] as usize]
    }

    /// Checks the invariants of trees over `groups`; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate<'g>(
        &self,
        mesh: &Mesh,
        groups: impl IntoIterator<Item = &'g [FaceId]>,
    ) -> Result<(), String> {
        let mut trees = 0;
        for group in groups {
            if trees >= self.len() {
                return Err(format!("more groups than the {trees} trees"));
            }
            let visited = match self.root(trees) {
                Some(root) => self.arena.validate_from(root, mesh, group)?,
                None if group.is_empty() => 0,
                None => return Err(format!("tree {trees} is empty, its group is not")),
            };
            if visited != self.nodes(trees).len() {
                return Err(format!("tree {trees} has nodes that cannot be reached"));
            }
            trees += 1;
        }
        if trees != self.len() {
            return Err(format!("{} trees for {trees} groups", self.len()));
        }
        let leaves = (0..self.arena.nodes.len() as u32).map(|n| match self.arena.content(n) {
            Content::Leaf { start, end } => (end - start) as usize,
            Content::Inner { .. } => 0,
        });
        if leaves.sum::<usize>() != self.arena.faces.len() {
            return Err("leaves overlap, or leave faces out".into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    #[test]
    fn groups_keep_to_themselves_and_an_empty_one_has_no_root() {
        let vertices = (0..42).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        let mesh = Mesh::new(vertices, (0..40).map(|i| [i, i + 1, i + 2]).collect()).unwrap();
        let group = |from: u32, to: u32| (from..to).map(FaceId).collect::<Vec<_>>();
        let groups = [group(5, 9), group(0, 0), group(9, 40), group(0, 1)];
        let slices = || groups.iter().map(Vec::as_slice);
        let forest = FaceForest::over(&mesh, slices(), 2);
        forest.validate(&mesh, slices()).unwrap();
        assert_eq!((forest.len(), forest.root(0), forest.root(1)), (4, Some(0), None));
        assert_eq!(forest.faces(3), [FaceId(0)]);
        assert!(forest.validate(&mesh, slices().rev()).is_err());
        assert!(forest.validate(&mesh, slices().take(3)).is_err());
        // A tree of a forest is the tree over its group, moved.
        let alone = FaceTree::over(&mesh, &groups[2], 2);
        assert_eq!(alone.faces(), forest.faces(2));
        let boxes = |nodes: &[Node]| nodes.iter().map(|n| n.bounds).collect::<Vec<_>>();
        assert_eq!(boxes(alone.nodes()), boxes(forest.nodes(2)));
        let mut seen = Vec::new();
        forest.arena().visit_from(forest.root(2).unwrap(), |_| true, |f| seen.push(f));
        assert_eq!(seen, forest.faces(2));
    }
}
