//! How high the faces beneath a node reach along their mean normal.
//!
//! Where two surfaces lie along each other, boxes of slanted faces are thicker than the gap. A
//! plane above the faces is not: the heights of two such planes bound the gap between two nodes.
//!
//! Source: planes at a distance along given directions bound faces in Klosowski and others (1998,
//! "Efficient collision detection using bounding volume hierarchies of k-DOPs"); here it is one
//! plane, along each node's own normal. Cost: O(n) for each level of the trees.

use std::ops::Range;

use cranny_exact::DVec3;

use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::tree::{Content, FaceTree};

/// A plane that no face beneath a node rises above, but for rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Mean normal of the faces, unit to rounding; zero where their areas cancel (and the height is
    /// then 0: it says nothing, and nothing false).
    pub normal: DVec3,
    /// The largest inner product of a corner with the normal, to rounding.
    pub height: f64,
}

impl Slab {
    /// Those of the nodes of some whole trees of an arena, given by their ranges, one tree's behind
    /// the other's. Cost: O(n log n).
    pub(super) fn of_trees(
        mesh: &Mesh,
        arena: &FaceTree,
        trees: impl IntoIterator<Item = Range<usize>>,
    ) -> Vec<Self> {
        let mut seen = vec![u32::MAX; mesh.vertices().len()];
        let last = |vertex: VertexId, leaf| std::mem::replace(&mut seen[vertex.index()], leaf);
        Self::with(mesh, arena, trees, last)
    }

    /// Those of the nodes of one tree, without memory for all vertices.
    pub(super) fn of_tree(mesh: &Mesh, arena: &FaceTree, nodes: Range<usize>) -> Vec<Self> {
        let (mut at, mut seen) = (u32::MAX, Vec::new());
        let last = |vertex, leaf| {
            if at != leaf {
                at = leaf;
                seen.clear();
            }
            // Leaves have few faces.
            if seen.contains(&vertex) {
                return leaf;
            }
            seen.push(vertex);
            u32::MAX
        };
        Self::with(mesh, arena, [nodes], last)
    }

    /// `last` returns the leaf before in which a vertex was a corner, and takes the one in which it
    /// is.
    fn with(
        mesh: &Mesh,
        arena: &FaceTree,
        trees: impl IntoIterator<Item = Range<usize>>,
        mut last: impl FnMut(VertexId, u32) -> u32,
    ) -> Vec<Self> {
        let mut slabs = Vec::new();
        let mut beneath: Vec<Beneath> = Vec::new();
        let mut corners: Vec<DVec3> = Vec::new();
        for nodes in trees {
            let at = slabs.len();
            slabs.resize(at + nodes.len(), Self { normal: DVec3::ZERO, height: 0.0 });
            beneath.clear();
            beneath.resize(nodes.len(), Beneath { area: DVec3::ZERO, corners: [0, 0] });
            // In leaf order, each once in a leaf: looked up once, and read once a level.
            corners.clear();
            for node in nodes.clone() {
                let (first, mut area) = (corners.len(), DVec3::ZERO);
                let faces = arena.leaf_faces(node as u32);
                corners.resize(first + 3 * faces.len(), DVec3::ZERO);
                let mut end = first;
                for &face in faces {
                    let triangle = mesh.triangle(face);
                    let [a, b, c] = triangle;
                    area += 0.5 * (b - a).cross(c - a);
                    for (vertex, corner) in mesh.corners(face).into_iter().zip(triangle) {
                        // Written over where it stands there: without a branch that nobody can
                        // predict.
                        corners[end] = corner;
                        end += usize::from(last(vertex, node as u32) != node as u32);
                    }
                }
                corners.truncate(end);
                beneath[node - nodes.start] = Beneath { area, corners: [first, corners.len()] };
            }
            // Children stand behind their parents, and the corners beneath a node side by side.
            for node in (0..nodes.len()).rev() {
                let own = match arena.content((nodes.start + node) as u32) {
                    Content::Leaf { .. } => beneath[node],
                    Content::Inner { left, right } => {
                        let [left, right] =
                            [left, right].map(|n| beneath[n as usize - nodes.start]);
                        let corners = [left.corners[0], right.corners[1]];
                        Beneath { area: left.area + right.area, corners }
                    }
                };
                beneath[node] = own;
                let normal = own.area.normalize_or_zero();
                let held = corners[own.corners[0]..own.corners[1]].iter();
                // Not by `f64::max`, which would look for NaN among them.
                let higher =
                    |most, p: &DVec3| if normal.dot(*p) > most { normal.dot(*p) } else { most };
                let height = held.fold(f64::NEG_INFINITY, higher);
                slabs[at + node] = Self { normal, height };
            }
        }
        slabs
    }
}

/// What is beneath a node: the sum of area vectors, and which corners of the tree's faces.
#[derive(Clone, Copy)]
struct Beneath {
    area: DVec3,
    corners: [usize; 2],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::FaceId;

    #[test]
    fn planes_lie_on_top_of_their_faces() {
        // Two roofs, z = 2 − |x|; the mean normal is up, the ridge is the highest.
        let vertices = [[-1.0, 0.0, 1.0], [0.0, 0.0, 2.0], [0.0, 1.0, 2.0], [1.0, 0.0, 1.0]];
        let vertices = vertices.map(DVec3::from_array).to_vec();
        let mesh = Mesh::new(vertices, vec![[0, 1, 2], [1, 3, 2]]).unwrap();
        let tree = FaceTree::over(&mesh, &[FaceId(0), FaceId(1)], 1);
        let slabs = Slab::of_trees(&mesh, &tree, std::iter::once(0..tree.nodes().len()));
        assert_eq!(slabs.len(), 3);
        assert_eq!(slabs[0], Slab { normal: DVec3::Z, height: 2.0 });
        for (node, slab) in slabs.iter().enumerate().skip(1) {
            let [face] = tree.leaf_faces(node as u32) else { panic!("a leaf has one face") };
            let at = mesh.triangle(*face).map(|p| slab.normal.dot(p) - slab.height);
            assert!(at.iter().all(|h| h.abs() < 1e-15), "{at:?}");
        }
    }
}
