//! What a model consists of.

use crate::clusters::ClusterTree;
use crate::deform::Workshop;
use crate::hull::ConvexHull;
use crate::ids::FaceId;
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::on_demand::{FromStored, OnDemand};
use crate::patches::Patches;
use crate::topology::Topology;
use crate::tree::{FaceTree, StoredTree};

/// What a model consists of.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology,
    pub(crate) hull: ConvexHull,
    pub(crate) tree: FromStored<StoredTree, FaceTree>,
    pub(crate) patches: Patches,
    /// Follows from mesh, topology and patches.
    pub(crate) clusters: OnDemand<ClusterTree>,
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

    pub(crate) fn clusters(&self) -> &ClusterTree {
        self.clusters.get(|| ClusterTree::of(&self.mesh, &self.topology, &self.patches))
    }

    /// Takes the tree out; to be [put back](Self::put_tree).
    pub(crate) fn take_tree(&mut self) -> FaceTree {
        let Self { mesh, tree, .. } = self;
        std::mem::take(tree).into_made(|stored| stored.rebuild(mesh))
    }

    /// Puts a tree in. What follows from the surface is made anew when it is next needed.
    pub(crate) fn put_tree(&mut self, tree: FaceTree) {
        self.tree = FromStored::made(tree);
        self.clusters = OnDemand::default();
    }
}
