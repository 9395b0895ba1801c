//! What a model consists of.

use crate::clusters::ClusterTree;
use crate::deform::Workshop;
use crate::hull::ConvexHull;
use crate::ids::FaceId;
use crate::late::{FromStored, Late};
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::patches::{Patches, StoredPatches};
use crate::topology::Topology;
use crate::tree::{FaceTree, StoredTree};

/// What a model consists of.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology,
    pub(crate) hull: ConvexHull,
    pub(crate) tree: FromStored<StoredTree, FaceTree>,
    pub(crate) patches: FromStored<StoredPatches, Patches>,
    /// Follows from mesh, topology and patches.
    pub(crate) clusters: Late<ClusterTree>,
    pub(crate) mass: Option<MassProperties>,
    pub(crate) radius: f64,
    pub(crate) digest: [u8; 32],
    /// The filed face of each face; `None` where all are as filed.
    pub(crate) filed_faces: Option<Vec<FaceId>>,
    /// How flat is flat, relative to the largest coordinate magnitude.
    pub(crate) flatness: f64,
    /// Faces per leaf of the tree.
    pub(crate) leaf_size: usize,
    /// Whether it was read from bytes and never deformed, so that of what was prepared only the
    /// mesh is sure.
    pub(crate) only_read: bool,
    /// What deformations need beside; none before the first.
    pub(crate) workshop: Option<Box<Workshop>>,
}

impl Parts {
    #[inline]
    pub(crate) fn tree(&self) -> &FaceTree {
        self.tree.get(|stored| stored.rebuild(&self.mesh))
    }

    #[inline]
    pub(crate) fn patches(&self) -> &Patches {
        self.patches.get(|stored| stored.rebuild(&self.mesh))
    }

    pub(crate) fn clusters(&self) -> &ClusterTree {
        self.clusters.get(|| ClusterTree::of(&self.mesh, &self.topology, self.patches()))
    }

    /// Takes out what is over the whole surface; to be [put back](Self::put_surface).
    pub(crate) fn take_surface(&mut self) -> (FaceTree, Patches) {
        let Self { mesh, tree, patches, .. } = self;
        (
            std::mem::take(tree).into_made(|stored| stored.rebuild(mesh)),
            std::mem::take(patches).into_made(|stored| stored.rebuild(mesh)),
        )
    }

    pub(crate) fn put_surface(&mut self, tree: FaceTree, patches: Patches) {
        self.tree = FromStored::made(tree);
        self.patches = FromStored::made(patches);
        self.clusters = Late::default();
    }
}
