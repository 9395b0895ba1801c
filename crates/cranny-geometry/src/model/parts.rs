//! What a model consists of, and how the parts that lie beneath the hull are made.

use cranny_exact::DVec3;

use super::options::Stage;
use crate::caps::CapSurface;
use crate::clusters::ClusterTree;
use crate::concavity::{Concavities, HullCovers};
use crate::deform::Workshop;
use crate::envelope::{EnvelopeOptions, Envelopes, Pocket};
use crate::features::{Assignment, Features};
use crate::hull::ConvexHull;
use crate::ids::FaceId;
use crate::late::{Late, Unfolding};
use crate::mass::MassProperties;
use crate::mesh::Mesh;
use crate::patches::{FoldedPatches, Patches};
use crate::topology::Topology;
use crate::tree::{FaceForest, FaceTree, FoldedTree};

/// Envelopes of before one or several deformations.
#[derive(Clone, Debug)]
pub(crate) struct FormerEnvelopes {
    pub(crate) envelopes: Envelopes,
    /// For each concavity now the one before that has the same envelope, if any.
    pub(crate) kept: Vec<Option<usize>>,
}

/// What a model consists of.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    pub(crate) mesh: Mesh,
    pub(crate) topology: Topology,
    pub(crate) hull: ConvexHull,
    pub(crate) features: Features,
    pub(crate) concavities: Concavities,
    /// Follows from hull, features and concavities.
    pub(crate) hull_covers: Late<HullCovers>,
    pub(crate) tree: Unfolding<FoldedTree, FaceTree>,
    pub(crate) concavity_trees: Late<FaceForest>,
    pub(crate) envelopes: Late<Envelopes>,
    /// Where a deformation has left some of them to be built: what the others are taken from.
    pub(crate) former_envelopes: Option<FormerEnvelopes>,
    /// Whether trees and envelopes of concavities are those that would be made now from the other parts; not
    /// so after a deformation.
    pub(crate) is_as_made: bool,
    pub(crate) patches: Unfolding<FoldedPatches, Patches>,
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
    /// Faces per leaf of the trees over concavities.
    pub(crate) concavity_leaf_size: usize,
    /// Whether it was read from bytes and never deformed, so that of what was prepared only the mesh is
    /// sure.
    pub(crate) only_read: bool,
    /// What deformations need beside; none before the first.
    pub(crate) workshop: Option<Box<Workshop>>,
}

impl Parts {
    #[inline]
    pub(crate) fn tree(&self) -> &FaceTree {
        self.tree.get(|folded| folded.unfold(&self.mesh))
    }

    #[inline]
    pub(crate) fn patches(&self) -> &Patches {
        self.patches.get(|folded| folded.unfold(&self.mesh))
    }

    pub(crate) fn clusters(&self) -> &ClusterTree {
        self.clusters.get(|| ClusterTree::of(&self.mesh, &self.topology, self.patches()))
    }

    /// Takes out what is over the whole surface; to be [put back](Self::put_surface).
    pub(crate) fn take_surface(&mut self) -> (FaceTree, Patches) {
        let Self { mesh, tree, patches, .. } = self;
        (
            std::mem::take(tree).into_made(|folded| folded.unfold(mesh)),
            std::mem::take(patches).into_made(|folded| folded.unfold(mesh)),
        )
    }

    pub(crate) fn put_surface(&mut self, tree: FaceTree, patches: Patches) {
        self.tree = Unfolding::made(tree);
        self.patches = Unfolding::made(patches);
        self.clusters = Late::default();
    }

    pub(crate) fn concavity_trees(&self) -> &FaceForest {
        let Self { mesh, concavities, concavity_leaf_size, .. } = self;
        self.concavity_trees
            .get(|| concavity_trees(mesh, self.tree(), concavities, *concavity_leaf_size))
    }

    pub(crate) fn envelopes(&self) -> &Envelopes {
        let Self { mesh, concavities, former_envelopes, .. } = self;
        self.envelopes.get(|| match former_envelopes {
            None => envelopes(mesh, concavities, self.concavity_trees()),
            Some(FormerEnvelopes { envelopes, kept }) => {
                let openings = openings(concavities);
                let (pockets, trees) = (pockets(concavities, &openings), self.concavity_trees());
                envelopes.updated(mesh, pockets, trees, |i| kept[i])
            }
        })
    }

    /// Takes the trees of concavities out, for whoever puts others in their places, and what there is of
    /// envelopes.
    pub(crate) fn take_late(&mut self) -> (FaceForest, Option<FormerEnvelopes>) {
        let trees = std::mem::take(&mut self.concavity_trees);
        let Self { mesh, concavities, concavity_leaf_size, .. } = &*self;
        let trees = trees
            .into_made(|| concavity_trees(mesh, self.tree(), concavities, *concavity_leaf_size));
        let former = self.former_envelopes.take();
        let all = std::mem::take(&mut self.envelopes).if_taken();
        let made = all.map(|envelopes| FormerEnvelopes {
            kept: (0..self.concavities.len()).map(Some).collect(),
            envelopes,
        });
        (trees, made.or(former))
    }
}

/// Stages 4 to 7: what the hull covers, and whether the body fills it.
pub(crate) struct Covered {
    pub(crate) features: Features,
    pub(crate) concavities: Concavities,
    pub(crate) concavity_trees: FaceForest,
    pub(crate) envelopes: Envelopes,
}

impl Covered {
    pub(crate) fn of(
        mesh: &Mesh,
        topology: &Topology,
        hull: &ConvexHull,
        tree: &FaceTree,
        leaf_size: usize,
        observe: &mut dyn FnMut(Stage),
    ) -> Self {
        observe(Stage::Classify);
        let assignment = Assignment::of(mesh, topology, hull, tree);
        let (features, ridges) = Features::of(mesh, topology, &assignment);
        observe(Stage::Caps);
        let caps = CapSurface::build(mesh, topology, hull, &assignment, &ridges);
        let concavities = Concavities::of(mesh, topology, hull, &features, caps);
        observe(Stage::ConcavityTrees);
        let concavity_trees = concavity_trees(mesh, tree, &concavities, leaf_size);
        observe(Stage::Envelopes);
        let envelopes = envelopes(mesh, &concavities, &concavity_trees);
        Self { features, concavities, concavity_trees, envelopes }
    }
}

/// For each concavity how its lids open.
pub(crate) fn openings(concavities: &Concavities) -> Vec<Vec<DVec3>> {
    concavities.iter().map(|c| c.lids().map(|lid| lid.opening).collect()).collect()
}

/// A tree for each concavity, given the one over all faces.
fn concavity_trees(
    mesh: &Mesh,
    tree: &FaceTree,
    concavities: &Concavities,
    leaf_size: usize,
) -> FaceForest {
    let groups = concavities.iter().map(|concavity| concavity.faces);
    FaceForest::within(tree, mesh, groups, leaf_size)
}

/// An envelope for each concavity, which opens through its lids.
fn envelopes(mesh: &Mesh, concavities: &Concavities, trees: &FaceForest) -> Envelopes {
    let openings = openings(concavities);
    Envelopes::within(mesh, pockets(concavities, &openings), trees, &EnvelopeOptions::default())
}

fn pockets<'a>(
    concavities: &'a Concavities,
    openings: &'a [Vec<DVec3>],
) -> impl Iterator<Item = Pocket<'a>> {
    let pockets = concavities.iter().zip(openings);
    pockets.map(|(concavity, openings)| Pocket { faces: concavity.faces, openings })
}
