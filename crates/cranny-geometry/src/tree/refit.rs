//! Trees after some of their faces have moved: boxes fitted again, subtrees grown again where they
//! have become bad.
//!
//! A moved face is found by its old box, which lies in the box of every node above it; so the cost
//! follows the number of moved faces and the depth of the tree. Then boxes are fitted from the
//! leaves up, as van den Bergen (1997) does for whole trees. A node whose box has spread to
//! [`SPREAD`] times the area that it had when it was grown no longer divides well: the tree beneath
//! its parent is grown again, in place.

use std::ops::Range;

use cranny_exact::Aabb;

use super::{Content, FaceForest, FaceTree, Node};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// How much larger than when it was grown a box may become before the tree around it is grown
/// again. Smaller, and every dent regrows trees; larger, and a body that is kneaded for long is
/// searched slowly.
const SPREAD: f64 = 3.0;

/// A face that has moved, and the box that it had before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedFace {
    /// Which.
    pub face: FaceId,
    /// Its box before.
    pub old: Aabb,
}

/// Half the area of each node's box when it was grown, by node: what later boxes are compared with.
#[derive(Clone, Debug, Default)]
pub struct GrownAreas(Vec<f64>);

impl GrownAreas {
    /// Of nodes as they are now.
    pub fn of(nodes: &[Node]) -> Self {
        Self(nodes.iter().map(|n| n.bounds.half_area()).collect())
    }

    /// Whether a node divides no longer well, given its box now.
    pub(crate) fn has_spread(&self, node: u32, bounds: &Aabb) -> bool {
        bounds.half_area() > SPREAD * self.0[node as usize]
    }

    /// Of the trees of `new`, of which tree `i` is tree `kept(i)` of `old`, or was just grown.
    pub fn carried(
        &self,
        old: &FaceForest,
        new: &FaceForest,
        kept: impl Fn(usize) -> Option<usize>,
    ) -> Self {
        let mut areas = Vec::with_capacity(new.arena().nodes.len());
        for tree in 0..new.len() {
            match kept(tree) {
                Some(tree) => areas.extend_from_slice(&self.0[old.node_range(tree)]),
                None => areas.extend(new.nodes(tree).iter().map(|n| n.bounds.half_area())),
            }
        }
        Self(areas)
    }
}

/// Which nodes of an arena have changed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NodeChanges {
    /// Nodes that hold the same faces as before in another box; ascending.
    pub refitted: Vec<u32>,
    /// Ranges of nodes that were grown again: they may hold other faces than before. Ascending,
    /// apart.
    pub regrown: Vec<Range<u32>>,
    /// Whether nodes were numbered anew, so that no index means what it did. Then the others say
    /// nothing.
    pub renumbered: bool,
}

impl NodeChanges {
    /// Nodes are numbered anew.
    #[must_use]
    pub fn anew() -> Self {
        Self { renumbered: true, ..Self::default() }
    }

    /// Whether a node holds just what it did, in the same box.
    #[must_use]
    pub fn is_unchanged(&self, node: u32) -> bool {
        !self.renumbered
            && self.refitted.binary_search(&node).is_err()
            && !self.regrown.iter().any(|range| range.contains(&node))
    }

    /// Whether nothing has changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.renumbered && self.refitted.is_empty() && self.regrown.is_empty()
    }

    /// Number of nodes whose boxes were computed, as far as they have kept their numbers.
    #[must_use]
    pub fn count(&self) -> usize {
        self.refitted.len() + self.regrown.iter().map(|r| r.len()).sum::<usize>()
    }

    /// In ascending order, nodes that were grown again not counted twice.
    pub fn settle(&mut self) {
        self.regrown.sort_unstable_by_key(|r| (r.start, std::cmp::Reverse(r.end)));
        let mut end = 0;
        self.regrown.retain(|r| {
            let is_new = r.start >= end;
            end = end.max(r.end);
            is_new
        });
        self.refitted.sort_unstable();
        self.refitted.dedup();
        self.refitted.retain(|n| !self.regrown.iter().any(|r| r.contains(n)));
    }
}

impl FaceTree {
    /// Fits the boxes of the tree at `root` after some of its faces have moved, and grows parts of
    /// it again; the changes are added to `changes`. Whether the tree is well again: a part that
    /// takes more or fewer nodes when grown again stays as it is.
    pub(crate) fn refit(
        &mut self,
        root: u32,
        mesh: &Mesh,
        moved: &[MovedFace],
        leaf_size: usize,
        grown: &mut GrownAreas,
        changes: &mut NodeChanges,
    ) -> bool {
        let first = changes.refitted.len();
        self.refit_beneath(root, mesh, moved, &mut changes.refitted);
        // Parents are listed after their children.
        let fitted = &changes.refitted[first..];
        let spread = |n: u32| grown.has_spread(n, &self.node(n).bounds);
        let is_bad = |&&n: &&u32| match self.content(n) {
            Content::Inner { left, right } => spread(left) || spread(right),
            Content::Leaf { .. } => false,
        };
        let mut bad: Vec<u32> = fitted.iter().filter(is_bad).copied().collect();
        bad.sort_unstable();
        let (mut end, mut is_well) = (0, true);
        for node in bad {
            if node < end {
                continue;
            }
            if let Some(range) = self.regrow(node, mesh, leaf_size) {
                end = range.end;
                for n in range.clone() {
                    grown.0[n as usize] = self.node(n).bounds.half_area();
                }
                changes.regrown.push(range);
            } else {
                is_well = false;
            }
        }
        is_well
    }

    /// Fits what hangs at a node; whether any of the faces was there.
    fn refit_beneath(
        &mut self,
        node: u32,
        mesh: &Mesh,
        moved: &[MovedFace],
        fitted: &mut Vec<u32>,
    ) -> bool {
        match self.content(node) {
            Content::Leaf { start, end } => {
                let faces = &self.faces[start as usize..end as usize];
                if !faces.iter().any(|f| moved.iter().any(|m| m.face == *f)) {
                    return false;
                }
                let corners = faces.iter().flat_map(|&f| mesh.triangle(f));
                self.nodes[node as usize].bounds = Aabb::of_points(corners);
            }
            Content::Inner { left, right } => {
                let mut any = false;
                for child in [left, right] {
                    let bounds = self.node(child).bounds;
                    let may_hold = |m: &&MovedFace| {
                        bounds.contains_point(m.old.min) && bounds.contains_point(m.old.max)
                    };
                    let within: Vec<MovedFace> = moved.iter().filter(may_hold).copied().collect();
                    any |= !within.is_empty() && self.refit_beneath(child, mesh, &within, fitted);
                }
                if !any {
                    return false;
                }
                let both = self.node(left).bounds.union(&self.node(right).bounds);
                self.nodes[node as usize].bounds = both;
            }
        }
        fitted.push(node);
        true
    }

    /// Grows what hangs at a node again, if that takes just as many nodes; their range.
    fn regrow(&mut self, node: u32, mesh: &Mesh, leaf_size: usize) -> Option<Range<u32>> {
        let (nodes, faces) = self.beneath(node);
        let new = Self::over(mesh, &self.faces[faces.clone()], leaf_size);
        if new.nodes.len() != nodes.len() {
            return None;
        }
        for (to, mut from) in nodes.clone().zip(new.nodes) {
            from.content += if from.count == 0 { nodes.start } else { faces.start as u32 };
            self.nodes[to as usize] = from;
        }
        self.faces[faces].copy_from_slice(&new.faces);
        Some(nodes)
    }

    /// Whether a node is an inner one with more than `few` faces beneath. True is certain, and
    /// quicker than to count them; false may only mean that most of them are on one side.
    pub fn surely_has_more(&self, node: u32, few: usize) -> bool {
        match self.content(node) {
            // Of the left child and the nodes beneath it more than half are leaves; no leaf is
            // empty.
            Content::Inner { left, right } => (right - left).div_ceil(2) as usize >= few,
            Content::Leaf { .. } => false,
        }
    }

    /// The nodes that hang at a node, itself included, and the faces that they hold: both stand
    /// together.
    pub fn beneath(&self, node: u32) -> (Range<u32>, Range<usize>) {
        let (mut first, mut last) = (node, node);
        let start = loop {
            match self.content(first) {
                Content::Inner { left, .. } => first = left,
                Content::Leaf { start, .. } => break start,
            }
        };
        let end = loop {
            match self.content(last) {
                Content::Inner { right, .. } => last = right,
                Content::Leaf { end, .. } => break end,
            }
        };
        (node..last + 1, start as usize..end as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    /// A row of `count` triangles along x.
    fn row(count: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let corner =
            |i: u32| DVec3::new(f64::from(i / 3) * 2.0, f64::from(i % 3), f64::from(i % 2));
        (
            (0..3 * count).map(corner).collect(),
            (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        )
    }

    fn refit(move_face: usize, by: DVec3, leaf_size: usize) -> (Mesh, FaceTree, NodeChanges) {
        let (mut vertices, faces) = row(64);
        let mesh = Mesh::new(vertices.clone(), faces.clone()).unwrap();
        let mut tree = FaceTree::of(&mesh, leaf_size);
        let mut grown = GrownAreas::of(tree.nodes());
        let face = FaceId(move_face as u32);
        let moved = [MovedFace { face, old: Aabb::of_points(mesh.triangle(face)) }];
        for v in &mut vertices[3 * move_face..3 * move_face + 3] {
            *v += by;
        }
        let mesh = Mesh::new(vertices, faces).unwrap();
        let mut changes = NodeChanges::default();
        tree.refit(0, &mesh, &moved, leaf_size, &mut grown, &mut changes);
        changes.settle();
        (mesh, tree, changes)
    }

    #[test]
    fn a_small_move_fits_the_path_to_the_root_only() {
        let (mesh, tree, changes) = refit(20, 0.125 * DVec3::X, 1);
        let all: Vec<FaceId> = (0..64).map(FaceId).collect();
        tree.validate(&mesh, &all).unwrap();
        assert!(changes.regrown.is_empty() && !changes.renumbered);
        assert!(changes.refitted.contains(&0) && changes.count() <= 12, "{changes:?}");
        assert!(!changes.is_unchanged(0) && changes.is_unchanged(tree.nodes().len() as u32 - 1));
    }

    #[test]
    fn a_face_that_goes_to_the_other_end_is_divided_off_again() {
        let (mesh, tree, changes) = refit(2, 100.0 * DVec3::X, 1);
        let all: Vec<FaceId> = (0..64).map(FaceId).collect();
        tree.validate(&mesh, &all).unwrap();
        assert!(!changes.regrown.is_empty());
        // Its new neighbours' boxes and its own lie together: no leaf's parent spans the row.
        let widest = (0..tree.nodes().len() as u32)
            .filter(|&n| {
                matches!(tree.content(n), Content::Inner { left, right }
                if !tree.leaf_faces(left).is_empty() && !tree.leaf_faces(right).is_empty())
            })
            .map(|n| tree.node(n).bounds.max.x - tree.node(n).bounds.min.x)
            .fold(0.0, f64::max);
        assert!(widest < 10.0, "{widest}");
    }

    #[test]
    fn larger_leaves_keep_a_valid_tree() {
        let (mesh, tree, _) = refit(2, 100.0 * DVec3::X, 4);
        let all: Vec<FaceId> = (0..64).map(FaceId).collect();
        tree.validate(&mesh, &all).unwrap();
    }
}
