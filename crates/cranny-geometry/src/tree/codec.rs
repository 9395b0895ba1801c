//! Trees as the shape of their nodes and the order of their faces; boxes are made again.
//!
//! Nodes stand in depth-first order, so the number of faces at each node, 0 for an inner one, says
//! all about their shape.

use cranny_exact::Aabb;

use super::{Content, FaceForest, FaceTree, Node};
use crate::codec::{Flaw, Reader, Writer, check};
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
        let all = mesh.faces().len();
        check(faces.len() == all, "it is not over all faces")?;
        let mut once = Once::new(all);
        faces.iter().try_for_each(|&f| once.see(f))?;
        let mut shape = Shape::new(&counts);
        shape.tree(0, all)?;
        Ok(Self { nodes: shape.finish(mesh, &faces)?, faces })
    }
}

impl FaceForest {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { arena, starts } = self;
        arena.encode(out);
        out.items(self.len(), starts.windows(2).map(|pair| pair[1][1] - pair[0][1]));
    }

    /// Reads trees over faces of a mesh, each face at most once.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let (faces, counts): (Vec<FaceId>, Vec<u32>) = (input.list()?, input.list()?);
        let sizes: Vec<u32> = input.list()?;
        let mut once = Once::new(mesh.faces().len());
        faces.iter().try_for_each(|&f| once.see(f))?;
        let mut shape = Shape::new(&counts);
        let mut starts = Vec::with_capacity(sizes.len() + 1);
        starts.push([0, 0]);
        let mut first = 0;
        for size in sizes {
            if size > 0 {
                shape.tree(first, size as usize)?;
                first += size as usize;
            }
            starts.push([shape.nodes.len() as u32, first as u32]);
        }
        check(first == faces.len(), "trees leave faces out")?;
        let nodes = shape.finish(mesh, &faces)?;
        Ok(Self { arena: FaceTree { nodes, faces }, starts })
    }
}

/// That no face is named twice.
pub(crate) struct Once(Vec<u64>, usize);

impl Once {
    pub(crate) fn new(faces: usize) -> Self {
        Self(vec![0; faces.div_ceil(64)], faces)
    }

    pub(crate) fn see(&mut self, face: FaceId) -> Result<(), Flaw> {
        check(face.index() < self.1, "it names a face that is not there")?;
        let (word, bit) = (&mut self.0[face.index() / 64], 1 << (face.0 % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        check(is_new, "it names a face twice")
    }
}

/// Nodes without boxes, in the making.
struct Shape<'a> {
    counts: &'a [u32],
    nodes: Vec<Node>,
    /// Inner nodes that wait for their right child.
    waiting: Vec<u32>,
}

impl<'a> Shape<'a> {
    fn new(counts: &'a [u32]) -> Self {
        Self { counts, nodes: Vec::with_capacity(counts.len()), waiting: Vec::new() }
    }

    /// Appends one tree, over `size >= 1` faces beginning at `first`.
    fn tree(&mut self, first: usize, size: usize) -> Result<(), Flaw> {
        let (mut at, end) = (first, first + size);
        loop {
            let index = self.nodes.len();
            let count = *self.counts.get(index).ok_or("a tree lacks nodes")?;
            if count == 0 {
                self.waiting.push(index as u32);
                self.nodes.push(Node { bounds: Aabb::EMPTY, content: 0, count });
                continue;
            }
            check(count as usize <= end - at, "a tree has more faces in its leaves than it holds")?;
            self.nodes.push(Node { bounds: Aabb::EMPTY, content: at as u32, count });
            at += count as usize;
            let Some(parent) = self.waiting.pop() else { break };
            self.nodes[parent as usize].content = self.nodes.len() as u32;
        }
        check(at == end, "a tree has fewer faces in its leaves than it holds")
    }

    /// Puts boxes around what the nodes hold.
    fn finish(self, mesh: &Mesh, faces: &[FaceId]) -> Result<Vec<Node>, Flaw> {
        let Self { counts, mut nodes, .. } = self;
        check(nodes.len() == counts.len(), "nodes belong to no tree")?;
        // Children stand behind their parents.
        for index in (0..nodes.len()).rev() {
            nodes[index].bounds = match nodes[index].content_at(index as u32) {
                Content::Inner { left, right } => {
                    nodes[left as usize].bounds.union(&nodes[right as usize].bounds)
                }
                Content::Leaf { start, end } => {
                    let faces = &faces[start as usize..end as usize];
                    Aabb::of_points(faces.iter().flat_map(|&f| mesh.triangle(f)))
                }
            };
        }
        Ok(nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right children of inner nodes, and how the shape of a tree over `size` faces ends.
    fn shape(counts: &[u32], size: usize) -> Result<Vec<u32>, String> {
        let mut shape = Shape::new(counts);
        shape.tree(0, size).map_err(|Flaw(what)| what)?;
        let inner = shape.nodes.iter().filter(|n| n.count == 0);
        Ok(inner.map(|n| n.content).collect())
    }

    #[test]
    fn counts_in_depth_first_order_are_a_tree_or_none() {
        assert_eq!(shape(&[5], 5), Ok(vec![]));
        // Root, left inner with two leaves, right leaf.
        assert_eq!(shape(&[0, 0, 1, 2, 3], 6), Ok(vec![4, 3]));
        for (counts, size, flaw) in [
            (vec![0, 0, 0, 0], 4, "lacks nodes"),
            (vec![0, 1], 1, "lacks nodes"),
            (vec![], 1, "lacks nodes"),
            (vec![1, 1], 2, "fewer faces"),
            (vec![0, 1, 1], 3, "fewer faces"),
            (vec![0, 1, u32::MAX], 3, "more faces"),
        ] {
            let error = shape(&counts, size).unwrap_err();
            assert!(error.contains(flaw), "{counts:?}: {error}");
        }
    }

    #[test]
    fn a_face_is_seen_once() {
        let mut once = Once::new(65);
        assert!(once.see(FaceId(64)).is_ok() && once.see(FaceId(0)).is_ok());
        assert!(once.see(FaceId(64)).is_err() && once.see(FaceId(65)).is_err());
    }
}
