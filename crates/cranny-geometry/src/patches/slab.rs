//! How high the faces beneath a node reach along their mean normal.
//!
//! Where two surfaces lie along each other, boxes of slanted faces are thicker than the gap. A plane
//! above the faces is not: the heights of two such planes bound the gap between two nodes.

use std::ops::Range;

use cranny_exact::DVec3;

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
    /// Those of all nodes of an arena, in its order. Cost: O(n log n).
    pub(super) fn of_nodes(mesh: &Mesh, arena: &FaceTree) -> Vec<Self> {
        Self::of_trees(mesh, arena, 0..arena.nodes().len())
    }

    /// Those of the nodes of some whole trees, which stand together in the arena.
    pub(super) fn of_trees(mesh: &Mesh, arena: &FaceTree, nodes: Range<usize>) -> Vec<Self> {
        let (first, count) = (nodes.start, nodes.len());
        let (mut areas, mut ranges) = (vec![DVec3::ZERO; count], vec![[0, 0]; count]);
        let mut slabs = vec![Self { normal: DVec3::ZERO, height: 0.0 }; count];
        // Children stand behind their parents, and the faces beneath a node side by side.
        for node in (0..count).rev() {
            (areas[node], ranges[node]) = match arena.content((first + node) as u32) {
                Content::Leaf { start, end } => {
                    let range = [start as usize, end as usize];
                    let faces = &arena.faces()[range[0]..range[1]];
                    (faces.iter().map(|&f| mesh.area_vector(f)).sum(), range)
                }
                Content::Inner { left, right } => {
                    let (left, right) = (left as usize - first, right as usize - first);
                    let range = [
                        ranges[left][0].min(ranges[right][0]),
                        ranges[left][1].max(ranges[right][1]),
                    ];
                    (areas[left] + areas[right], range)
                }
            };
            let normal = areas[node].normalize_or_zero();
            let faces = &arena.faces()[ranges[node][0]..ranges[node][1]];
            let heights = faces.iter().flat_map(|&f| mesh.triangle(f)).map(|p| normal.dot(p));
            slabs[node] = Self { normal, height: heights.fold(f64::NEG_INFINITY, f64::max) };
        }
        slabs
    }
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
        let slabs = Slab::of_nodes(&mesh, &tree);
        assert_eq!(slabs.len(), 3);
        assert_eq!(slabs[0], Slab { normal: DVec3::Z, height: 2.0 });
        for (node, slab) in slabs.iter().enumerate().skip(1) {
            let [face] = tree.leaf_faces(node as u32) else { panic!("a leaf has one face") };
            let at = mesh.triangle(*face).map(|p| slab.normal.dot(p) - slab.height);
            assert!(at.iter().all(|h| h.abs() < 1e-15), "{at:?}");
        }
    }
}
