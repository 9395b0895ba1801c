//! Which nodes of a body's tree hold faces of some kind: those on the hull, say.
//!
//! No source. Cost: O(n) for n faces, a bit a node.

use cranny_geometry::{Content, FaceId, FaceTree};

/// A bit for each node of a tree.
#[derive(Clone, Debug)]
pub struct NodeSet(Vec<u64>);

impl NodeSet {
    /// The nodes that hold a face of the kind.
    #[must_use]
    pub fn of(tree: &FaceTree, is_one: impl Fn(FaceId) -> bool) -> Self {
        let mut nodes = Self(vec![0; tree.nodes().len().div_ceil(64)]);
        // Children stand behind their parents.
        for node in (0..tree.nodes().len() as u32).rev() {
            let holds = match tree.content(node) {
                Content::Inner { left, right } => nodes.has(left) || nodes.has(right),
                Content::Leaf { .. } => tree.leaf_faces(node).iter().any(|&f| is_one(f)),
            };
            nodes.0[node as usize / 64] |= u64::from(holds) << (node % 64);
        }
        nodes
    }

    /// Whether a node of the tree is one.
    #[must_use]
    #[inline]
    pub fn has(&self, node: u32) -> bool {
        self.0[node as usize / 64] >> (node % 64) & 1 != 0
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;
    use cranny_geometry::{BuildOptions, Mesh, Model};

    use super::*;
    use crate::Features;

    #[test]
    fn a_node_holds_a_face_on_the_hull_if_one_beneath_it_does() {
        // A tetrahedron, and a small one in its middle.
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let small = corners.map(|p| 0.1 * p + DVec3::splat(0.2));
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let inner = faces.map(|face| face.map(|v| v + 4));
        let mesh = Mesh::new([corners, small].concat(), [faces, inner].concat()).unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let (tree, features) = (model.tree(), Features::of(&model));
        let nodes = NodeSet::of(tree, |face| features.is_convex(face));
        for node in 0..tree.nodes().len() as u32 {
            let mut holds = false;
            tree.visit_from(node, |_| true, |f| holds |= f.0 < 4);
            assert_eq!(nodes.has(node), holds, "{node}");
        }
        assert!(nodes.has(0) && (0..tree.nodes().len() as u32).any(|node| !nodes.has(node)));
    }
}
