//! Trees as they are stored: the shape of their nodes and the order of their faces. Boxes are made
//! again.
//!
//! Nodes stand in depth-first order, so the number of faces at each node, 0 for an inner one, says
//! all about their shape. They are gone through from the last to the first: whatever is beneath a
//! node is whole when the node's turn comes. To check a shape takes no nodes; so a tree is read as
//! checked counts, and rebuilt at its first use.
//!
//! No source: this crate's own; a shape that does not add up is refused. Cost: O(n) for n nodes and
//! faces.

use std::ops::Range;

use cranny_exact::{Aabb, DVec3};

use super::{FaceForest, FaceTree, Node};
use crate::codec::{Flaw, Reader, Writer, check, check_each_once, owners};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// The box of a face.
#[inline(always)]
fn box_of(mesh: &Mesh, face: FaceId) -> Aabb {
    let [a, b, c] = mesh.triangle(face);
    Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
}

/// The box around boxes; the empty one around none.
#[inline]
fn around(boxes: &[Aabb]) -> Aabb {
    match boxes {
        [] => Aabb::EMPTY,
        [own] => *own,
        [first, others @ ..] => others.iter().fold(*first, |all, own| all.union(own)),
    }
}

/// The box around some faces; the empty one around none.
#[inline]
pub(crate) fn box_around(mesh: &Mesh, faces: &[FaceId]) -> Aabb {
    match faces {
        [] => Aabb::EMPTY,
        [first, others @ ..] => {
            let others = others.iter().map(|&face| box_of(mesh, face));
            others.fold(box_of(mesh, *first), |all, own| all.union(&own))
        }
    }
}

impl FaceTree {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { nodes, faces } = self;
        out.list(faces);
        out.items(nodes.len(), nodes.iter().map(|&Node { bounds: _, content: _, count }| count));
    }
}

/// A tree over all faces of a mesh without its boxes, whose shape was checked.
#[derive(Clone, Debug, Default)]
pub(crate) struct StoredTree {
    faces: Vec<FaceId>,
    counts: Vec<u32>,
}

impl StoredTree {
    /// Reads a tree over all faces of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let stored = Self { faces: input.list()?, counts: input.list()? };
        let Self { faces, counts } = &stored;
        check(faces.len() == mesh.faces().len(), "it is not over all faces")?;
        check_each_once(faces.iter().map(|face| face.0), faces.len())?;
        check_shape(counts, faces.len())?;
        Ok(stored)
    }

    /// The tree. What it keeps is taken out.
    pub(crate) fn rebuild(&mut self, mesh: &Mesh) -> FaceTree {
        let Self { faces, counts } = self;
        // In the order of leaves, in a loop without branches: what it fetches from here and there
        // overlaps.
        let boxes: Vec<Aabb> = faces.iter().map(|&face| box_of(mesh, face)).collect();
        let mut nodes = NodesFromCounts::of(counts);
        nodes.tree(0..counts.len(), 0..faces.len(), |leaf| around(&boxes[leaf]));
        let nodes = nodes.into_nodes();
        counts.clear();
        FaceTree { nodes, faces: std::mem::take(faces) }
    }
}

impl FaceForest {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { arena, starts } = self;
        arena.encode(out);
        out.list(starts);
    }
}

/// Trees over faces of a mesh without their boxes, whose shape was checked.
#[derive(Clone, Debug, Default)]
pub(crate) struct StoredForest {
    faces: Vec<FaceId>,
    counts: Vec<u32>,
    /// As in [`FaceForest`].
    starts: Vec<[u32; 2]>,
}

impl StoredForest {
    /// Reads trees over faces of a mesh, each face at most once; and of each face the tree that
    /// holds it, or [`NOBODY`](crate::rows::NOBODY).
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<(Self, Vec<u32>), Flaw> {
        let faces: Vec<u32> = input.list()?;
        let counts: Vec<u32> = input.list()?;
        let starts: Vec<[u32; 2]> = input.list()?;
        let ends = (starts.first(), starts.last());
        let covers_all = ends == (Some(&[0, 0]), Some(&[counts.len() as u32, faces.len() as u32]));
        let is_behind = |a: &[u32; 2], b: &[u32; 2]| a[0] <= b[0] && a[1] <= b[1];
        check(covers_all && starts.is_sorted_by(is_behind), "trees are not in order")?;
        let held = starts.windows(2).map(|pair| &faces[pair[0][1] as usize..pair[1][1] as usize]);
        let owners = owners(mesh.faces().len(), held)?;
        let faces = faces.into_iter().map(FaceId).collect();
        let stored = Self { faces, counts, starts };
        stored
            .trees()
            .try_for_each(|[nodes, held]| check_shape(&stored.counts[nodes], held.len()))?;
        Ok((stored, owners))
    }

    /// The nodes and the faces of each tree.
    fn trees(&self) -> impl Iterator<Item = [Range<usize>; 2]> {
        let ends =
            |pair: &[[u32; 2]]| [0, 1].map(|i: usize| pair[0][i] as usize..pair[1][i] as usize);
        self.starts.windows(2).map(ends)
    }

    /// Number of trees.
    pub(crate) fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Number of nodes of all trees.
    pub(crate) fn node_count(&self) -> usize {
        self.counts.len()
    }

    /// Number of faces of a tree.
    pub(crate) fn face_count(&self, tree: usize) -> usize {
        (self.starts[tree + 1][1] - self.starts[tree][1]) as usize
    }

    /// The trees. What they keep is taken out.
    pub(crate) fn rebuild(&mut self, mesh: &Mesh) -> FaceForest {
        let mut nodes = NodesFromCounts::of(&self.counts);
        for [range, held] in self.trees() {
            nodes.tree(range, held, |leaf| box_around(mesh, &self.faces[leaf]));
        }
        let nodes = nodes.into_nodes();
        self.counts.clear();
        let (faces, starts) = (&mut self.faces, &mut self.starts);
        let arena = FaceTree { nodes, faces: std::mem::take(faces) };
        FaceForest { arena, starts: std::mem::take(starts) }
    }
}

/// Whether counts in depth-first order are those of a tree whose leaves hold so many things in all,
/// or of none where there is nothing to hold.
///
/// From the last to the first: a leaf is a finished tree, an inner node makes one of the two that
/// were finished last, and all are one in the end.
pub(crate) fn check_shape(counts: &[u32], held: usize) -> Result<(), Flaw> {
    let (mut finished, mut in_leaves, mut lacks) = (0_i64, 0_u64, false);
    // No way out of the loop, so that it stays short.
    for &count in counts.iter().rev() {
        let is_inner = count == 0;
        finished += 1 - 2 * i64::from(is_inner);
        lacks |= is_inner & (finished < 1);
        in_leaves += u64::from(count);
    }
    check(!lacks, "a tree lacks nodes")?;
    check(in_leaves == held as u64, "leaves of a tree hold more or less than it does")?;
    check(finished == i64::from(!counts.is_empty()), "nodes belong to no tree")
}

/// Nodes in the making, by how many things each leaf holds; 0 for an inner node. The shape was
/// [checked](check_shape).
pub(crate) struct NodesFromCounts<'a> {
    counts: &'a [u32],
    nodes: Vec<Node>,
    /// The roots of finished trees that wait for a parent, but for the one that was finished last.
    waiting: Vec<u32>,
}

impl<'a> NodesFromCounts<'a> {
    pub(crate) fn of(counts: &'a [u32]) -> Self {
        // All zero: memory is filled at once.
        let blank = Aabb { min: DVec3::ZERO, max: DVec3::ZERO };
        let blank = Node { bounds: blank, content: 0, count: 0 };
        Self { counts, nodes: vec![blank; counts.len()], waiting: Vec::new() }
    }

    pub(crate) fn into_nodes(self) -> Vec<Node> {
        self.nodes
    }

    /// Fills a range of nodes with a tree over a range of things: no nodes where there are none.
    /// `box_of` is called for those of each leaf.
    ///
    /// From the last node to the first: the tree finished last begins right behind an inner node,
    /// which makes it the left child, and the one that has waited least is the right one.
    #[inline]
    pub(crate) fn tree(
        &mut self,
        range: Range<usize>,
        held: Range<usize>,
        box_of: impl Fn(Range<usize>) -> Aabb,
    ) {
        let Some(first) = range.end.checked_sub(1).filter(|_| !range.is_empty()) else { return };
        let mut first_held = held.end;
        // The root of the tree finished last, and what is around it; none at first, which nobody
        // takes up again.
        let (mut finished, mut bounds) = (first as u32, Aabb::EMPTY);
        self.waiting.clear();
        for index in range.rev() {
            let count = self.counts[index];
            if count > 0 {
                self.waiting.push(finished);
                let end = first_held;
                first_held -= count as usize;
                bounds = box_of(first_held..end);
                self.nodes[index] = Node { bounds, content: first_held as u32, count };
            } else if let Some(right) = self.waiting.pop() {
                bounds = bounds.union(&self.nodes[right as usize].bounds);
                self.nodes[index] = Node { bounds, content: right, count };
            }
            finished = index as u32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right children of inner nodes, and how the shape of a tree over `size` faces ends.
    fn shape(counts: &[u32], size: usize) -> Result<Vec<u32>, String> {
        let vertices = (0..8).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        let mesh = Mesh::new(vertices, (0..6).map(|i| [i, i + 1, i + 2]).collect()).unwrap();
        let faces: Vec<FaceId> = (0..size as u32).map(FaceId).collect();
        check_shape(counts, size).map_err(|Flaw(what)| what)?;
        let tree = StoredTree { faces: faces.clone(), counts: counts.to_vec() }.rebuild(&mesh);
        tree.validate(&mesh, &faces)?;
        Ok(tree.nodes.iter().filter(|n| n.count == 0).map(|n| n.content).collect())
    }

    /// The rest of some counts behind those of one tree, and what its leaves hold; by what a tree
    /// is.
    fn tree_of(counts: &[u32]) -> Option<(&[u32], u32)> {
        let (&root, rest) = counts.split_first()?;
        if root > 0 {
            return Some((rest, root));
        }
        let (rest, left) = tree_of(rest)?;
        let (rest, right) = tree_of(rest)?;
        Some((rest, left + right))
    }

    #[test]
    fn a_shape_is_accepted_where_it_is_a_tree_of_that_size() {
        let mut accepted = 0;
        for length in 0..=7 {
            for code in 0..3_u32.pow(length) {
                let counts: Vec<u32> = (0..length).map(|i| code / 3_u32.pow(i) % 3).collect();
                for held in 0..=6 {
                    let is_tree = tree_of(&counts) == Some((&[], held));
                    let is_none = counts.is_empty() && held == 0;
                    let is_accepted = check_shape(&counts, held as usize).is_ok();
                    assert_eq!(is_accepted, is_tree || is_none, "{counts:?} of {held}");
                    accepted += usize::from(is_accepted);
                }
            }
        }
        // None, and the binary trees of one to four leaves of one or two things, six at most.
        assert_eq!(accepted, 1 + 2 + 4 + 2 * 8 + 5 * (1 + 4 + 6));
    }

    #[test]
    fn counts_in_depth_first_order_are_a_tree_or_none() {
        assert_eq!(shape(&[], 0), Ok(vec![]));
        assert_eq!(shape(&[5], 5), Ok(vec![]));
        // Root, left inner with two leaves, right leaf.
        assert_eq!(shape(&[0, 0, 1, 2, 3], 6), Ok(vec![4, 3]));
        // A left chain, and a right one.
        assert_eq!(shape(&[0, 0, 0, 1, 1, 1, 1], 4), Ok(vec![6, 5, 4]));
        assert_eq!(shape(&[0, 1, 0, 1, 0, 1, 1], 4), Ok(vec![2, 4, 6]));
        for (counts, size, flaw) in [
            (vec![0, 0, 0, 0], 4, "lacks nodes"),
            (vec![0, 1], 1, "lacks nodes"),
            (vec![0], 0, "lacks nodes"),
            (vec![0, 1, 0, 1], 2, "lacks nodes"),
            (vec![], 1, "more or less"),
            (vec![1, 1], 2, "no tree"),
            (vec![1, 1, 1], 3, "no tree"),
            (vec![2], 1, "more or less"),
            (vec![0, 1, 1, 1], 3, "no tree"),
            (vec![0, 1, 1], 3, "more or less"),
            (vec![1], 0, "more or less"),
            (vec![0, 1, u32::MAX], 3, "more or less"),
        ] {
            let error = shape(&counts, size).unwrap_err();
            assert!(error.contains(flaw), "{counts:?}: {error}");
        }
    }
}
