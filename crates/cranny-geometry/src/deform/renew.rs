//! The first deformation of a model that was read from bytes: all but its mesh is made again.
//!
//! Reading checks what queries need. A deformation needs more: that stages of preparation agree
//! with each other, down to which facet each face lies on. Whoever forges a file can break that in
//! ways that are as costly to find as to make good, so everything is made from the mesh. What
//! [`Model::encode`](crate::Model::encode) wrote of a model as it was built comes out the same; a
//! model that was deformed before it was saved may have other numbers afterwards, and the change
//! set says so.
//!
//! No source: it is preparation, once more. Cost: that of preparing a model, but for the scan.

use super::ChangeSet;
use crate::codec::Writer;
use crate::hull::ConvexHull;
use crate::ids::PatchId;
use crate::model::Parts;
use crate::patches::Patches;
use crate::topology::Topology;
use crate::tree::{FaceTree, Mates, NodeChanges};

/// What was read, and whether something else was made in its place.
pub(super) struct Renewal {
    patches: Patches,
    hull_differs: bool,
    /// Which faces hang together.
    topology_differs: bool,
    tree_differs: bool,
}

impl Renewal {
    /// Makes everything again of a model that was only read.
    pub(super) fn of(parts: &mut Parts) -> Option<Self> {
        if !std::mem::take(&mut parts.only_read) {
            return None;
        }
        // Which faces hang together was believed; edges are the same.
        let topology = Topology::of(&parts.mesh);
        let topology_differs = differ([&parts.topology, &topology], Topology::encode);
        parts.topology = topology;
        let Former { hull, tree, patches } = replace(parts);
        Some(Self {
            hull_differs: differ([&hull, &parts.hull], ConvexHull::encode),
            topology_differs,
            tree_differs: differ([&tree, parts.tree()], FaceTree::encode),
            patches,
        })
    }

    /// Makes everything but the adjacency again of a mesh of which a large part has moved, where
    /// that is cheaper than to follow it; so nothing is compared either.
    pub(super) fn of_moved(parts: &mut Parts) -> Self {
        let Former { patches, .. } = replace(parts);
        Self { patches, hull_differs: true, topology_differs: false, tree_differs: true }
    }

    /// Reports in a change set what has become of what was read.
    pub(super) fn report(&self, change: &mut ChangeSet, parts: &Parts) {
        change.hull |= self.hull_differs;
        if self.tree_differs {
            change.tree = NodeChanges::anew();
        }
        if self.hull_differs || self.topology_differs {
            change.trail = None;
        }
        let Self { patches, .. } = self;
        let same = |id: PatchId| parts.patches.with_faces(patches.faces(id));
        change.patches = (0..patches.len() as u32).map(PatchId).map(same).collect();
    }
}

/// What was there.
struct Former {
    hull: ConvexHull,
    tree: FaceTree,
    patches: Patches,
}

/// Makes everything but the adjacency of faces from the mesh.
fn replace(parts: &mut Parts) -> Former {
    let Parts { mesh, topology, flatness, leaf_size, .. } = &*parts;
    let mates = Mates::of(mesh, topology);
    let tree = FaceTree::of_pairs(mesh, &mates, *leaf_size);
    let patches = Patches::with_mates(mesh, topology, &mates);
    let hull = ConvexHull::with_flatness(mesh.vertices(), *flatness);
    let former_tree = parts.take_tree();
    parts.put_tree(tree);
    Former {
        hull: std::mem::replace(&mut parts.hull, hull),
        tree: former_tree,
        patches: std::mem::replace(&mut parts.patches, patches),
    }
}

/// Whether two things are not the same to the last bit.
fn differ<T>(both: [&T; 2], encode: impl Fn(&T, &mut Writer)) -> bool {
    let [a, b] = both.map(|thing| {
        let mut out = Writer::default();
        encode(thing, &mut out);
        out.into_bytes()
    });
    a != b
}
