//! All that lies between a body and its hull, made on demand.
//!
//! No source: it puts together what the other files make. Cost: with the functions.

use std::num::NonZeroUsize;
use std::ops::Deref;

use cranny_exact::DVec3;

use super::{ConcavitySet, Stage};
use crate::caps::CapSurface;
use crate::envelope::{EnvelopeOptions, Envelopes, Pocket};
use crate::features::{Assignment, Features, RidgeOnFacet};
use cranny_geometry::{FaceForest, Finding, Model};

/// The concavities of a model with what they are made from, their box trees and their envelopes.
///
/// A value of its own: a model neither holds it nor makes it. It is that of one model, and means
/// nothing to another. After deformations of the model it is kept up to date by
/// [`FollowedConcavities`](super::FollowedConcavities). It dereferences to the [set](ConcavitySet)
/// of concavities and caps.
///
/// ```
/// use cranny_concavity::Concavities;
/// use cranny_geometry::{BuildOptions, Model};
/// use cranny_shapes::Cup;
///
/// let (cup, _) = Model::build(Cup::default().build()?, &BuildOptions::default())?;
/// let concavities = Concavities::of(&cup);
/// assert_eq!((concavities.len(), concavities.envelopes().len()), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Concavities {
    pub(super) features: Features,
    pub(super) set: ConcavitySet,
    pub(super) trees: FaceForest,
    pub(super) envelopes: Envelopes,
    pub(super) leaf_size: NonZeroUsize,
}

impl Deref for Concavities {
    type Target = ConcavitySet;

    fn deref(&self) -> &ConcavitySet {
        &self.set
    }
}

impl Concavities {
    /// Faces a leaf of the trees, unless [stated](Self::observed):
    /// [`FaceForest::DEFAULT_LEAF_SIZE`], as measured there.
    pub const DEFAULT_LEAF_SIZE: NonZeroUsize =
        NonZeroUsize::new(FaceForest::DEFAULT_LEAF_SIZE).expect("it is not 0");

    /// Makes them for a model.
    ///
    /// Cost: O(n log n), a quarter to a half of what [`Model::build`] costs.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        Self::observed(model, Self::DEFAULT_LEAF_SIZE, &mut |_| {})
    }

    /// [`of`](Self::of) with leaves of at most so many faces, observed at the beginning of each
    /// [`Stage`].
    ///
    /// Envelopes are made of parts of the trees: leaves of more faces than
    /// [`leaf_faces`](EnvelopeOptions::leaf_faces) give envelopes of single faces, which take
    /// longer to build.
    #[must_use]
    pub fn observed(
        model: &Model,
        leaf_size: NonZeroUsize,
        observe: &mut dyn FnMut(Stage),
    ) -> Self {
        Self::with_assignment(model, leaf_size, observe).0
    }

    /// Beside them, which facet each face and each ridge lies on.
    pub(super) fn with_assignment(
        model: &Model,
        leaf_size: NonZeroUsize,
        observe: &mut dyn FnMut(Stage),
    ) -> (Self, Assignment, Vec<RidgeOnFacet>) {
        let mesh = model.mesh();
        observe(Stage::Classify);
        let assignment = Assignment::of(model);
        let (features, ridges) = Features::classified(model, &assignment);
        observe(Stage::Caps);
        let caps = CapSurface::build(model, &assignment, &ridges);
        let set = ConcavitySet::of(model, &features, caps);
        observe(Stage::Trees);
        let groups = set.iter().map(|concavity| concavity.faces);
        let trees = FaceForest::within(model.tree(), mesh, groups, leaf_size.get());
        observe(Stage::Envelopes);
        let openings = set.openings();
        let pockets = set.pockets(&openings);
        let envelopes = Envelopes::within(mesh, pockets, &trees, &EnvelopeOptions::default());
        observe(Stage::Done);
        (Self { features, set, trees, envelopes, leaf_size }, assignment, ridges)
    }

    /// Which features of the model lie on its hull.
    #[must_use]
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// The concavities, their caps and boundary loops.
    #[must_use]
    pub fn set(&self) -> &ConcavitySet {
        &self.set
    }

    /// A box tree for each concavity, by their ids.
    #[must_use]
    pub fn trees(&self) -> &FaceForest {
        &self.trees
    }

    /// An envelope for each concavity, by their ids.
    #[must_use]
    pub fn envelopes(&self) -> &Envelopes {
        &self.envelopes
    }

    /// What limits the meaning of concavities, of caps above all: findings that the model's own
    /// [report](cranny_geometry::Report) does not hold. O(n), and the square of the facets found.
    #[must_use]
    pub fn findings(&self, model: &Model) -> Vec<Finding> {
        self.set.caps.findings(model, self.features.slab_depth())
    }
}

impl ConcavitySet {
    /// For each concavity how its lids open.
    pub(super) fn openings(&self) -> Vec<Vec<DVec3>> {
        self.iter().map(|c| c.lids().map(|lid| lid.opening).collect()).collect()
    }

    /// Each concavity as an envelope sees it.
    pub(super) fn pockets<'a>(
        &'a self,
        openings: &'a [Vec<DVec3>],
    ) -> impl Iterator<Item = Pocket<'a>> {
        let pockets = self.iter().zip(openings);
        pockets.map(|(concavity, openings)| Pocket { faces: concavity.faces, openings })
    }
}
