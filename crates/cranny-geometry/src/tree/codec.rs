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

use cranny_exact::{Aabb, DVec3};

use super::{FaceTree, Node};
use crate::codec::{Flaw, Reader, Writer, check, check_each_once};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// The box of a face, in straight code.
#[inline(always)]
fn box_of(mesh: &Mesh, face: FaceId) -> Aabb {
    let [a, b, c] = mesh.triangle(face);
    Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
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
    ///
    /// From the last node to the first: the tree finished last begins right behind an inner node,
    /// which makes it the left child, and the one that has waited least is the right one.
    pub(crate) fn rebuild(&mut self, mesh: &Mesh) -> FaceTree {
        let Self { faces, counts } = std::mem::take(self);
        // In the order of leaves, in a loop without branches: what it fetches from here and there
        // overlaps.
        let boxes: Vec<Aabb> = faces.iter().map(|&face| box_of(mesh, face)).collect();
        // All zero: memory is filled at once.
        let blank = Aabb { min: DVec3::ZERO, max: DVec3::ZERO };
        let mut nodes = vec![Node { bounds: blank, content: 0, count: 0 }; counts.len()];
        let (mut waiting, mut first): (Vec<u32>, usize) = (Vec::new(), faces.len());
        for (index, &count) in counts.iter().enumerate().rev() {
            if count > 0 {
                let held = first - count as usize..first;
                first = held.start;
                let bounds = boxes[held].iter().fold(Aabb::EMPTY, |all, own| all.union(own));
                nodes[index] = Node { bounds, content: first as u32, count };
            } else if let (Some(left), Some(right)) = (waiting.pop(), waiting.pop()) {
                let [left, beside] = [left, right].map(|node| nodes[node as usize].bounds);
                nodes[index] = Node { bounds: left.union(&beside), content: right, count };
            }
            waiting.push(index as u32);
        }
        FaceTree { nodes, faces }
    }
}

/// Whether counts in depth-first order are those of a tree whose leaves hold so many things in all,
/// or of none where there is nothing to hold.
///
/// From the last to the first: a leaf is a finished tree, an inner node makes one of the two that
/// were finished last, and all are one in the end.
fn check_shape(counts: &[u32], held: usize) -> Result<(), Flaw> {
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
