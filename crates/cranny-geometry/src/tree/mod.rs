//! Binary trees of axis-aligned boxes over faces, in the body's frame.
//!
//! Boxes hold their faces exactly: the ends are vertex coordinates, no arithmetic is done on them,
//! and no face is ever cut. Nodes lie in depth-first order, the left child right behind its parent.
//! [`FaceTree`] is one tree, [`FaceForest`] many in one array (one a concavity).
//!
//! Source: trees of axis-aligned boxes over faces are van den Bergen's (1997, "Efficient collision
//! detection of complex deformable models using AABB trees"); how they are grown stands in `build`.
//! Cost: O(n log n) to grow, as a rule; a question costs the nodes whose boxes it opens and their
//! children.

mod build;
mod codec;
mod forest;
mod lattice;
mod mates;
mod paired;
mod prune;
mod refit;

use cranny_exact::Aabb;

pub(crate) use self::build::Grower;
pub use self::build::partition;
pub(crate) use self::codec::StoredTree;
pub use self::forest::FaceForest;
pub(crate) use self::mates::Mates;
pub use self::paired::PairedStep;
pub use self::refit::{GrownAreas, MovedFace, NodeChanges};

use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;

/// A node: a box, and what it holds.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Holds every face beneath.
    pub bounds: Aabb,
    content: u32,
    count: u32,
}

impl Node {
    /// How many things it holds; 0 for an inner node.
    pub(crate) fn count(&self) -> u32 {
        self.count
    }
}

/// What a node holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Two children, as node indices.
    Inner {
        /// First child.
        left: u32,
        /// Second child.
        right: u32,
    },
    /// Faces: a range of [`FaceTree::faces`].
    Leaf {
        /// First.
        start: u32,
        /// One past the last.
        end: u32,
    },
}

/// A tree over faces of a mesh: all of them, or some.
#[derive(Clone, Debug, Default)]
pub struct FaceTree {
    nodes: Vec<Node>,
    faces: Vec<FaceId>,
}

impl FaceTree {
    /// Builds a tree over all faces whose leaves hold at most `leaf_size >= 1` of them.
    ///
    /// Cost: O(n log n).
    #[must_use]
    pub fn of(mesh: &Mesh, leaf_size: usize) -> Self {
        let all: Vec<FaceId> = mesh.face_ids().collect();
        Self::over(mesh, &all, leaf_size)
    }

    /// Builds a tree over some faces, each named once; the cost follows their number, not the
    /// mesh's. No faces: no nodes.
    #[must_use]
    pub fn over(mesh: &Mesh, faces: &[FaceId], leaf_size: usize) -> Self {
        let mut tree = Self::with_capacity(faces.len(), leaf_size);
        let boxes = face_boxes(mesh, faces);
        Grower::new(leaf_size).grow(boxes, &mut tree);
        tree
    }

    /// [`of`](Self::of), pairs of faces being parted last.
    ///
    /// Cost: half as much.
    pub(crate) fn of_pairs(mesh: &Mesh, mates: &Mates, leaf_size: usize) -> Self {
        let count = mesh.faces().len();
        let mut tree = Self::with_capacity(count, leaf_size);
        let boxed = |face: FaceId| (face, *mates.bounds(face));
        let pairs = (0..count as u32).map(FaceId).filter_map(|face| {
            let mate = mates.of_face(face);
            // The lesser of two speaks for both.
            mate.is_none_or(|mate| face < mate).then(|| (boxed(face), mate.map(boxed)))
        });
        Grower::new(leaf_size).grow_pairs(pairs, &mut tree);
        tree
    }

    fn with_capacity(faces: usize, leaf_size: usize) -> Self {
        let nodes = 2 * faces.div_ceil(leaf_size.max(1));
        Self { nodes: Vec::with_capacity(nodes), faces: Vec::with_capacity(faces) }
    }

    /// All nodes; the root is node 0.
    #[must_use]
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Faces in leaf order.
    #[must_use]
    pub fn faces(&self) -> &[FaceId] {
        &self.faces
    }

    /// A node by index.
    #[must_use]
    #[inline]
    pub fn node(&self, index: u32) -> &Node {
        &self.nodes[index as usize]
    }

    /// What a node holds.
    #[must_use]
    #[inline]
    pub fn content(&self, index: u32) -> Content {
        let &Node { content, count, .. } = self.node(index);
        match count {
            0 => Content::Inner { left: index + 1, right: content },
            _ => Content::Leaf { start: content, end: content + count },
        }
    }

    /// The faces of a leaf; none for an inner node.
    #[must_use]
    #[inline]
    pub fn leaf_faces(&self, index: u32) -> &[FaceId] {
        match self.content(index) {
            Content::Inner { .. } => &[],
            Content::Leaf { start, end } => &self.faces[start as usize..end as usize],
        }
    }

    /// Calls `visit` with every face whose leaf passes `keep`; a box that fails is not opened.
    pub fn visit(&self, keep: impl FnMut(&Aabb) -> bool, visit: impl FnMut(FaceId)) {
        if !self.nodes.is_empty() {
            self.visit_from(0, keep, visit);
        }
    }

    /// The vertices in a box, in no order and some more than once, and the faces whose boxes
    /// overlap it.
    #[must_use]
    pub fn vertices_within(&self, mesh: &Mesh, bounds: &Aabb) -> (Vec<VertexId>, Vec<FaceId>) {
        let mut faces = Vec::new();
        self.visit(|b| b.overlaps(bounds), |f| faces.push(f));
        let corners = faces.iter().flat_map(|&f| mesh.corners(f));
        let inside = corners.filter(|&v| bounds.contains_point(mesh.position(v)));
        (inside.collect(), faces)
    }

    /// [`visit`](Self::visit), beginning at a node.
    pub fn visit_from(
        &self,
        node: u32,
        mut keep: impl FnMut(&Aabb) -> bool,
        mut visit: impl FnMut(FaceId),
    ) {
        let mut stack = vec![node];
        while let Some(index) = stack.pop() {
            if !keep(&self.node(index).bounds) {
                continue;
            }
            match self.content(index) {
                Content::Inner { left, right } => stack.extend([right, left]),
                Content::Leaf { start, end } => {
                    self.faces[start as usize..end as usize].iter().copied().for_each(&mut visit);
                }
            }
        }
    }

    /// Checks the invariants of a tree over `faces`; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate(&self, mesh: &Mesh, faces: &[FaceId]) -> Result<(), String> {
        let visited = if faces.is_empty() { 0 } else { self.validate_from(0, mesh, faces)? };
        if visited != self.nodes.len() {
            return Err(format!("{visited} of {} nodes can be reached", self.nodes.len()));
        }
        Ok(())
    }

    /// Checks what hangs at a node, which holds `faces`; returns the number of its nodes.
    fn validate_from(&self, root: u32, mesh: &Mesh, faces: &[FaceId]) -> Result<usize, String> {
        let mut held: Vec<FaceId> = Vec::with_capacity(faces.len());
        let mut stack = vec![root];
        let mut visited = 0;
        while let Some(index) = stack.pop() {
            visited += 1;
            let bounds = self.nodes.get(index as usize).ok_or("a child that is not there")?.bounds;
            let mut tight = Aabb::EMPTY;
            match self.content(index) {
                Content::Inner { left, right } => {
                    for child in [left, right] {
                        let child = self.nodes.get(child as usize);
                        tight = tight.union(&child.ok_or("a child that is not there")?.bounds);
                    }
                    stack.extend([right, left]);
                }
                Content::Leaf { .. } => {
                    for &face in self.leaf_faces(index) {
                        held.push(face);
                        tight = tight.union(&Aabb::of_points(mesh.triangle(face)));
                    }
                }
            }
            if tight != bounds {
                return Err(format!("the box of node {index} is not that of what it holds"));
            }
            if visited > self.nodes.len() {
                return Err(format!("the nodes beneath node {root} run in circles"));
            }
        }
        held.sort_unstable();
        let mut wanted = faces.to_vec();
        wanted.sort_unstable();
        if held != wanted {
            return Err(format!("node {root} holds other faces than it should"));
        }
        Ok(visited)
    }
}

fn face_boxes<'a>(
    mesh: &'a Mesh,
    faces: &'a [FaceId],
) -> impl Iterator<Item = (FaceId, Aabb)> + 'a {
    faces.iter().map(|&face| (face, Aabb::of_points(mesh.triangle(face))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    fn all(mesh: &Mesh) -> Vec<FaceId> {
        mesh.face_ids().collect()
    }

    fn strip(count: u32) -> Mesh {
        let vertices =
            (0..count + 2).map(|i| DVec3::new(f64::from(i), f64::from(i % 2), 0.0)).collect();
        Mesh::new(vertices, (0..count).map(|i| [i, i + 1, i + 2]).collect()).unwrap()
    }

    #[test]
    fn every_face_stands_in_one_leaf() {
        for (count, leaf) in [(1, 1), (2, 1), (7, 2), (1000, 1), (1000, 4)] {
            let mesh = strip(count);
            let tree = FaceTree::of(&mesh, leaf);
            tree.validate(&mesh, &all(&mesh)).unwrap();
            assert!((0..tree.nodes().len() as u32).all(|n| tree.leaf_faces(n).len() <= leaf));
        }
    }

    #[test]
    fn coincident_faces_are_split_by_number() {
        let mesh = Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]; 9]).unwrap();
        let tree = FaceTree::of(&mesh, 2);
        tree.validate(&mesh, &all(&mesh)).unwrap();
        assert!(tree.nodes().len() > 1);
    }

    #[test]
    fn a_tree_over_some_faces_holds_just_these() {
        let mesh = strip(100);
        let some: Vec<FaceId> = (0..100).filter(|i| i % 7 == 3).map(FaceId).collect();
        let tree = FaceTree::over(&mesh, &some, 2);
        tree.validate(&mesh, &some).unwrap();
        assert!(tree.validate(&mesh, &some[1..]).is_err());
        assert_eq!(tree.node(0).bounds.min.x, 3.0);
        let none = FaceTree::over(&mesh, &[], 2);
        none.validate(&mesh, &[]).unwrap();
        none.visit(|_| true, |f| panic!("face {} of none", f.0));
    }

    #[test]
    fn a_visit_opens_only_what_is_kept() {
        let tree = FaceTree::of(&strip(1000), 1);
        let mut found = Vec::new();
        let window = Aabb { min: DVec3::new(10.5, -1.0, -1.0), max: DVec3::new(10.6, 2.0, 1.0) };
        tree.visit(|b| b.overlaps(&window), |f| found.push(f.0));
        found.sort_unstable();
        assert_eq!(found, [9, 10]);
    }
}
