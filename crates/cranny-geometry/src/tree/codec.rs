//! Trees as the shape of their nodes and the order of their faces; boxes are made again.
//!
//! Nodes stand in depth-first order, so the number of faces at each node, 0 for an inner one, says
//! all about their shape.

use std::ops::Range;

use cranny_exact::Aabb;

use super::{FaceForest, FaceTree, Node};
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
        shape.tree(0..all, |leaf| box_of(mesh, &faces[leaf]))?;
        Ok(Self { nodes: shape.finish()?, faces })
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
                let end = first + size as usize;
                check(end <= faces.len(), "trees have more faces than there are")?;
                shape.tree(first..end, |leaf| box_of(mesh, &faces[leaf]))?;
                first = end;
            }
            starts.push([shape.nodes.len() as u32, first as u32]);
        }
        check(first == faces.len(), "trees leave faces out")?;
        let nodes = shape.finish()?;
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

fn box_of(mesh: &Mesh, faces: &[FaceId]) -> Aabb {
    Aabb::of_points(faces.iter().flat_map(|&f| mesh.triangle(f)))
}

/// Nodes in the making.
struct Shape<'a> {
    counts: &'a [u32],
    nodes: Vec<Node>,
    /// Inner nodes above the one that comes next.
    open: Vec<u32>,
}

impl<'a> Shape<'a> {
    fn new(counts: &'a [u32]) -> Self {
        Self { counts, nodes: Vec::with_capacity(counts.len()), open: Vec::new() }
    }

    /// Appends one tree over some faces, at least one; `box_of` is asked for those of each leaf.
    fn tree(
        &mut self,
        faces: Range<usize>,
        box_of: impl Fn(Range<usize>) -> Aabb,
    ) -> Result<(), Flaw> {
        let mut at = faces.start;
        loop {
            let index = self.nodes.len();
            let count = *self.counts.get(index).ok_or("a tree lacks nodes")?;
            if count == 0 {
                self.open.push(index as u32);
                self.nodes.push(Node { bounds: Aabb::EMPTY, content: 0, count });
                continue;
            }
            check(
                count as usize <= faces.end - at,
                "a tree has more faces in its leaves than it holds",
            )?;
            let leaf = at..at + count as usize;
            at = leaf.end;
            self.nodes.push(Node { bounds: box_of(leaf), content: at as u32 - count, count });
            if !self.close() {
                break;
            }
        }
        check(at == faces.end, "a tree has fewer faces in its leaves than it holds")
    }

    /// After a leaf: puts boxes around both children of inner nodes that are whole. Whether a right child
    /// comes next.
    fn close(&mut self) -> bool {
        while let Some(parent) = self.open.pop() {
            let (left, right) = (parent as usize + 1, self.nodes[parent as usize].content as usize);
            if right == 0 {
                self.nodes[parent as usize].content = self.nodes.len() as u32;
                self.open.push(parent);
                return true;
            }
            let bounds = self.nodes[left].bounds.union(&self.nodes[right].bounds);
            self.nodes[parent as usize].bounds = bounds;
        }
        false
    }

    fn finish(self) -> Result<Vec<Node>, Flaw> {
        check(self.nodes.len() == self.counts.len(), "nodes belong to no tree")?;
        Ok(self.nodes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right children of inner nodes, and how the shape of a tree over `size` faces ends.
    fn shape(counts: &[u32], size: usize) -> Result<Vec<u32>, String> {
        let mut shape = Shape::new(counts);
        shape.tree(0..size, |_| Aabb::EMPTY).map_err(|Flaw(what)| what)?;
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
