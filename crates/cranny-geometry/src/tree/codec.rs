//! Trees as the shape of their nodes and the order of their faces; boxes are made again.
//!
//! Nodes stand in depth-first order, so the number of faces at each node, 0 for an inner one, says
//! all about their shape. They are read from the last to the first: whatever is beneath a node is whole
//! when the node's turn comes.
//!
//! No source: this crate's own; a shape that does not add up is refused. Cost: O(n) for n nodes and faces.

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

    /// Reads a tree over all faces of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let faces: Vec<FaceId> = input.list()?;
        let counts = input.words()?;
        check(faces.len() == mesh.faces().len(), "it is not over all faces")?;
        check_each_once(faces.iter().map(|face| face.0), faces.len())?;
        // In the order of leaves, in a loop without branches: what it fetches from here and there overlaps.
        let boxes: Vec<Aabb> = faces.iter().map(|&face| box_of(mesh, face)).collect();
        let mut shape = Shape::new(counts, faces.len(), counts.len())?;
        shape.tree(0..counts.len(), 0..faces.len(), |leaf| around(&boxes[leaf]))?;
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
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<(Self, Vec<u32>), Flaw> {
        let faces: Vec<u32> = input.list()?;
        let counts = input.words()?;
        let starts: Vec<[u32; 2]> = input.list()?;
        let ends = (starts.first(), starts.last());
        let covers_all = ends == (Some(&[0, 0]), Some(&[counts.len() as u32, faces.len() as u32]));
        let is_behind = |a: &[u32; 2], b: &[u32; 2]| a[0] <= b[0] && a[1] <= b[1];
        check(covers_all && starts.is_sorted_by(is_behind), "trees are not in order")?;
        let trees = starts
            .windows(2)
            .map(|pair| [0, 1].map(|kind: usize| pair[0][kind] as usize..pair[1][kind] as usize));
        let owners = owners(mesh.faces().len(), trees.clone().map(|[_, held]| &faces[held]))?;
        let faces: Vec<FaceId> = faces.into_iter().map(FaceId).collect();
        let most = trees.clone().map(|[nodes, _]| nodes.len()).max().unwrap_or(0);
        let mut shape = Shape::new(counts, faces.len(), most)?;
        for [nodes, held] in trees {
            shape.tree(nodes, held, |leaf| box_around(mesh, &faces[leaf]))?;
        }
        Ok((Self { arena: FaceTree { nodes: shape.into_nodes(), faces }, starts }, owners))
    }
}

/// Nodes in the making, by how many things each leaf holds; 0 for an inner node. The counts are read where they are
/// written.
pub(crate) struct Shape<'a> {
    counts: &'a [[u8; 4]],
    nodes: Vec<Node>,
    /// The roots of finished trees that wait for a parent, but for the one that was finished last; the first
    /// stands for none. As long as the largest tree needs: it never grows, which keeps its loop short.
    waiting: Vec<u32>,
}

impl<'a> Shape<'a> {
    /// Of trees that hold `held` things in all, one of them at most `most` nodes.
    pub(crate) fn new(counts: &'a [[u8; 4]], held: usize, most: usize) -> Result<Self, Flaw> {
        // Leaves hold one or more, and there are fewer inner nodes. A node takes fourteen times the bytes of its
        // count: whoever counts more than there can be shall not have memory for them.
        check(counts.len() <= 2 * held, "trees have more nodes than they can")?;
        // All zero: memory is filled at once.
        let blank = Aabb { min: DVec3::ZERO, max: DVec3::ZERO };
        let blank = Node { bounds: blank, content: 0, count: 0 };
        // Of the nodes of a tree, one more than half are leaves.
        Ok(Self { counts, nodes: vec![blank; counts.len()], waiting: vec![0; most / 2 + 1] })
    }

    pub(crate) fn into_nodes(self) -> Vec<Node> {
        self.nodes
    }

    /// Fills a range of nodes with a tree over a range of things: no nodes where there are none. `box_of` is
    /// asked for those of each leaf.
    ///
    /// From the last node to the first: the tree finished last begins right behind an inner node, which makes it
    /// the left child, and the one that has waited least is the right one.
    #[inline]
    pub(crate) fn tree(
        &mut self,
        range: Range<usize>,
        held: Range<usize>,
        box_of: impl Fn(Range<usize>) -> Aabb,
    ) -> Result<(), Flaw> {
        /// In place of a node: there is none.
        const NONE: u32 = u32::MAX;
        let first = range.start as u32;
        let nodes = &mut self.nodes[range.clone()];
        let counts = &self.counts[range][..nodes.len()];
        let waiting = self.waiting.as_mut_slice();
        let (mut first_held, mut waits) = (held.end, 0);
        // The root of the tree finished last, within the range, and what is around it.
        let (mut finished, mut bounds) = (NONE, Aabb::EMPTY);
        for index in (0..nodes.len()).rev() {
            let count = u32::from_le_bytes(counts[index]);
            if count > 0 {
                if count as usize > first_held - held.start {
                    return Err("a tree has more in its leaves than it holds".into());
                }
                let place = waiting.get_mut(waits).ok_or("a tree has too many leaves")?;
                *place = finished;
                waits += 1;
                let end = first_held;
                first_held -= count as usize;
                bounds = box_of(first_held..end);
                nodes[index] = Node { bounds, content: first_held as u32, count };
            } else {
                waits = waits.wrapping_sub(1);
                let right = waiting.get(waits).copied().unwrap_or(NONE);
                // Where no tree is finished, none waits.
                let Some(brother) = nodes.get(right as usize) else {
                    return Err("a tree lacks nodes".into());
                };
                bounds = bounds.union(&brother.bounds);
                nodes[index] = Node { bounds, content: first + right, count };
            }
            finished = index as u32;
        }
        check(first_held == held.start, "a tree has less in its leaves than it holds")?;
        // What was finished last is the root; beneath it nothing waits but what stands for none.
        check(waits == usize::from(!nodes.is_empty()), "nodes belong to no tree")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right children of inner nodes, and how the shape of a tree over `size` faces ends.
    fn shape(counts: &[u32], size: usize) -> Result<Vec<u32>, String> {
        let vertices = (0..8).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        let mesh = Mesh::new(vertices, (0..6).map(|i| [i, i + 1, i + 2]).collect()).unwrap();
        let faces: Vec<FaceId> = (0..6).map(FaceId).collect();
        let whole = |shape: &mut Shape| {
            shape.tree(0..counts.len(), 0..size, |leaf| box_around(&mesh, &faces[leaf]))
        };
        let words: Vec<[u8; 4]> = counts.iter().map(|count| count.to_le_bytes()).collect();
        let mut shape = Shape::new(&words, size, counts.len()).map_err(|Flaw(what)| what)?;
        whole(&mut shape).map_err(|Flaw(what)| what)?;
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
            (vec![0], 0, "more nodes"),
            (vec![], 1, "less in"),
            (vec![1, 1], 2, "no tree"),
            (vec![1, 1, 1], 3, "too many leaves"),
            (vec![2], 1, "more in"),
            (vec![0, 1, 1, 1], 3, "no tree"),
            (vec![0, 1, 1], 3, "less in"),
            (vec![1], 0, "more nodes"),
            (vec![0, 1, u32::MAX], 3, "more in"),
        ] {
            let error = shape(&counts, size).unwrap_err();
            assert!(error.contains(flaw), "{counts:?}: {error}");
        }
    }
}
