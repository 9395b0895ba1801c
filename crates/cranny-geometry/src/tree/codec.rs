//! Trees as the shape of their nodes and the order of their faces; boxes are made again.
//!
//! Nodes stand in depth-first order, so the number of faces at each node, 0 for an inner one, says
//! all about their shape. They are read from the last to the first: whatever is beneath a node is whole
//! when the node's turn comes.

use std::ops::Range;

use cranny_exact::Aabb;

use super::{FaceForest, FaceTree, Node};
use crate::codec::{Flaw, Reader, Writer, check, owners};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// The box of each face of a mesh: all trees and envelopes are made of these.
pub(crate) struct FaceBoxes(Vec<Aabb>);

impl FaceBoxes {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        let vertices = mesh.vertices();
        let of_face = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| vertices[v as usize]);
            Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
        };
        Self(mesh.faces().iter().map(of_face).collect())
    }

    /// Number of faces.
    fn len(&self) -> usize {
        self.0.len()
    }

    /// The box around some faces; the empty one around none.
    #[inline]
    pub(crate) fn around(&self, faces: &[FaceId]) -> Aabb {
        let [first, others @ ..] = faces else { return Aabb::EMPTY };
        let own = |face: &FaceId| &self.0[face.index()];
        others.iter().map(own).fold(*own(first), |all, own| all.union(own))
    }
}

impl FaceTree {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { nodes, faces } = self;
        out.list(faces);
        out.items(nodes.len(), nodes.iter().map(|&Node { bounds: _, content: _, count }| count));
    }

    /// Reads a tree over all faces of a mesh.
    pub(crate) fn decode(input: &mut Reader, boxes: &FaceBoxes) -> Result<Self, Flaw> {
        let (faces, counts): (Vec<u32>, Vec<u32>) = (input.list()?, input.list()?);
        check(faces.len() == boxes.len(), "it is not over all faces")?;
        owners(boxes.len(), [faces.as_slice()])?;
        let faces: Vec<FaceId> = faces.into_iter().map(FaceId).collect();
        let mut shape = Shape::new(&counts);
        shape.tree(0..counts.len(), 0..faces.len(), |leaf| boxes.around(&faces[leaf]))?;
        Ok(Self { nodes: shape.into_nodes(), faces })
    }
}

impl FaceForest {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { arena, starts } = self;
        arena.encode(out);
        out.list(starts);
    }

    /// Reads trees over faces of a mesh, each face at most once; and of each face the tree that holds it, or
    /// [`NOBODY`](crate::rows::NOBODY).
    pub(crate) fn decode(input: &mut Reader, boxes: &FaceBoxes) -> Result<(Self, Vec<u32>), Flaw> {
        let (faces, counts): (Vec<u32>, Vec<u32>) = (input.list()?, input.list()?);
        let starts: Vec<[u32; 2]> = input.list()?;
        let ends = (starts.first(), starts.last());
        let covers_all = ends == (Some(&[0, 0]), Some(&[counts.len() as u32, faces.len() as u32]));
        let is_behind = |a: &[u32; 2], b: &[u32; 2]| a[0] <= b[0] && a[1] <= b[1];
        check(covers_all && starts.is_sorted_by(is_behind), "trees are not in order")?;
        let trees = starts
            .windows(2)
            .map(|pair| [0, 1].map(|kind: usize| pair[0][kind] as usize..pair[1][kind] as usize));
        let owners = owners(boxes.len(), trees.clone().map(|[_, held]| &faces[held]))?;
        let faces: Vec<FaceId> = faces.into_iter().map(FaceId).collect();
        let mut shape = Shape::new(&counts);
        for [nodes, held] in trees {
            shape.tree(nodes, held, |leaf| boxes.around(&faces[leaf]))?;
        }
        Ok((Self { arena: FaceTree { nodes: shape.into_nodes(), faces }, starts }, owners))
    }
}

/// Nodes in the making, by how many things each leaf holds; 0 for an inner node.
pub(crate) struct Shape<'a> {
    counts: &'a [u32],
    nodes: Vec<Node>,
    /// Of each node, the one that comes behind all that is beneath it.
    ends: Vec<u32>,
}

impl<'a> Shape<'a> {
    pub(crate) fn new(counts: &'a [u32]) -> Self {
        let blank = Node { bounds: Aabb::EMPTY, content: 0, count: 0 };
        Self { counts, nodes: vec![blank; counts.len()], ends: vec![0; counts.len()] }
    }

    pub(crate) fn into_nodes(self) -> Vec<Node> {
        self.nodes
    }

    /// Fills a range of nodes with a tree over a range of things: no nodes where there are none. `box_of` is
    /// asked for those of each leaf.
    pub(crate) fn tree(
        &mut self,
        range: Range<usize>,
        held: Range<usize>,
        box_of: impl Fn(Range<usize>) -> Aabb,
    ) -> Result<(), Flaw> {
        let nodes = &mut self.nodes[range.clone()];
        let ends = &mut self.ends[range.clone()];
        let counts = &self.counts[range.clone()];
        let mut first_held = held.end;
        // Within the range, the node behind all that is beneath the one that was made last: right of it,
        // there a brother stands, if it has one.
        let mut behind = nodes.len();
        for (index, &count) in counts.iter().enumerate().rev() {
            if count > 0 {
                let start = first_held.checked_sub(count as usize).filter(|&f| f >= held.start);
                let start = start.ok_or("a tree has more in its leaves than it holds")?;
                let bounds = box_of(start..first_held);
                nodes[index] = Node { bounds, content: start as u32, count };
                first_held = start;
                behind = index + 1;
            } else {
                let right = behind;
                let ([left, ..], Some(brother)) = (&nodes[index + 1..], nodes.get(right)) else {
                    return Err("a tree lacks nodes".into());
                };
                let bounds = left.bounds.union(&brother.bounds);
                nodes[index] = Node { bounds, content: (range.start + right) as u32, count };
                behind = ends[right] as usize;
            }
            ends[index] = behind as u32;
        }
        check(first_held == held.start, "a tree has less in its leaves than it holds")?;
        check(behind == nodes.len(), "nodes belong to no tree")
    }
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::*;

    /// The right children of inner nodes, and how the shape of a tree over `size` faces ends.
    fn shape(counts: &[u32], size: usize) -> Result<Vec<u32>, String> {
        let vertices = (0..8).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        let mesh = Mesh::new(vertices, (0..6).map(|i| [i, i + 1, i + 2]).collect()).unwrap();
        let faces: Vec<FaceId> = (0..6).map(FaceId).collect();
        let boxes = FaceBoxes::of(&mesh);
        let mut shape = Shape::new(counts);
        let whole = shape.tree(0..counts.len(), 0..size, |leaf| boxes.around(&faces[leaf]));
        whole.map_err(|Flaw(what)| what)?;
        let tree = FaceTree { nodes: shape.into_nodes(), faces: faces[..size].to_vec() };
        tree.validate(&mesh, &faces[..size])?;
        Ok(tree.nodes.iter().filter(|n| n.count == 0).map(|n| n.content).collect())
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
            (vec![], 1, "less in"),
            (vec![1, 1], 2, "no tree"),
            (vec![0, 1, 1, 1], 3, "no tree"),
            (vec![0, 1, 1], 3, "less in"),
            (vec![1], 0, "more in"),
            (vec![0, 1, u32::MAX], 3, "more in"),
        ] {
            let error = shape(&counts, size).unwrap_err();
            assert!(error.contains(flaw), "{counts:?}: {error}");
        }
    }
}
