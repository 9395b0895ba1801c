//! Trees as the shape of their nodes and the order of their faces; boxes are made again.
//!
//! Nodes stand in depth-first order, so the number of faces at each node, 0 for an inner one, says
//! all about their shape. They are read from the last to the first: whatever is beneath a node is whole
//! when the node's turn comes.

use std::ops::Range;

use cranny_exact::Aabb;

use super::{FaceForest, FaceTree, Node};
use crate::codec::{Flaw, Reader, Writer, check, check_below};
use crate::ids::FaceId;
use crate::mesh::Mesh;

impl FaceTree {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { nodes, faces } = self;
        out.list(faces);
        out.items(nodes.len(), nodes.iter().map(|&Node { bounds: _, content: _, count }| count));
    }

    /// Reads a tree over all faces of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let (faces, counts): (Vec<FaceId>, Vec<u32>) = (input.list()?, input.list()?);
        check(faces.len() == mesh.faces().len(), "it is not over all faces")?;
        check_each_once(&faces, mesh.faces().len())?;
        let mut shape = Shape::new(&counts);
        shape.tree(0..counts.len(), 0..faces.len(), |leaf| box_of(mesh, &faces[leaf]))?;
        Ok(Self { nodes: shape.into_nodes(), faces })
    }
}

impl FaceForest {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { arena, starts } = self;
        arena.encode(out);
        out.list(starts);
    }

    /// Reads trees over faces of a mesh, each face at most once.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let (faces, counts): (Vec<FaceId>, Vec<u32>) = (input.list()?, input.list()?);
        let starts: Vec<[u32; 2]> = input.list()?;
        check_each_once(&faces, mesh.faces().len())?;
        let ends = (starts.first(), starts.last());
        let covers_all = ends == (Some(&[0, 0]), Some(&[counts.len() as u32, faces.len() as u32]));
        let is_behind = |a: &[u32; 2], b: &[u32; 2]| a[0] <= b[0] && a[1] <= b[1];
        check(covers_all && starts.is_sorted_by(is_behind), "trees are not in order")?;
        let mut shape = Shape::new(&counts);
        for pair in starts.windows(2) {
            let [nodes, held] = [0, 1].map(|kind| pair[0][kind] as usize..pair[1][kind] as usize);
            shape.tree(nodes, held, |leaf| box_of(mesh, &faces[leaf]))?;
        }
        Ok(Self { arena: FaceTree { nodes: shape.into_nodes(), faces }, starts })
    }
}

/// That faces are among so many, and none is named twice.
pub(crate) fn check_each_once(faces: &[FaceId], count: usize) -> Result<(), Flaw> {
    check_below(faces.iter().map(|f| f.0), count, "it names a face that is not there")?;
    let mut is_named = vec![false; count];
    let mut is_twice = false;
    for face in faces {
        let is_named = &mut is_named[face.index()];
        is_twice |= *is_named;
        *is_named = true;
    }
    check(!is_twice, "it names a face twice")
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
        for index in (0..nodes.len()).rev() {
            let count = counts[index];
            nodes[index] = if count > 0 {
                let start = first_held.checked_sub(count as usize).filter(|&f| f >= held.start);
                let start = start.ok_or("a tree has more in its leaves than it holds")?;
                let bounds = box_of(start..first_held);
                first_held = start;
                behind = index + 1;
                Node { bounds, content: start as u32, count }
            } else {
                let right = behind;
                let ([left, ..], Some(brother)) = (&nodes[index + 1..], nodes.get(right)) else {
                    return Err("a tree lacks nodes".into());
                };
                let bounds = left.bounds.union(&brother.bounds);
                behind = ends[right] as usize;
                Node { bounds, content: (range.start + right) as u32, count }
            };
            ends[index] = behind as u32;
        }
        check(first_held == held.start, "a tree has less in its leaves than it holds")?;
        check(behind == nodes.len(), "nodes belong to no tree")
    }
}

/// The box around some faces, at least one.
pub(crate) fn box_of(mesh: &Mesh, faces: &[FaceId]) -> Aabb {
    let of_face = |face: FaceId| {
        let [a, b, c] = mesh.triangle(face);
        Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
    };
    let mut boxes = faces.iter().map(|&face| of_face(face));
    let first = boxes.next().unwrap_or(Aabb::EMPTY);
    boxes.fold(first, |all, own| all.union(&own))
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
        let mut shape = Shape::new(counts);
        let whole = shape.tree(0..counts.len(), 0..size, |leaf| box_of(&mesh, &faces[leaf]));
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

    #[test]
    fn each_face_is_named_once() {
        let named = |faces: &[u32]| {
            let faces: Vec<FaceId> = faces.iter().map(|&f| FaceId(f)).collect();
            check_each_once(&faces, 65).is_ok()
        };
        assert!(named(&[]) && named(&[64, 0, 63]));
        assert!(!named(&[64, 0, 64]) && !named(&[65]) && !named(&[0, u32::MAX]));
    }
}
