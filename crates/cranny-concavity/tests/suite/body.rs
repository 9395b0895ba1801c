//! A model with its concavities, which follow it: what tests of both look at.
#![allow(dead_code, reason = "each test binary uses its part")]

use std::num::NonZeroUsize;
use std::ops::Deref;

use cranny_concavity::{Concavities, ConcavityChange, Envelopes, Features, FollowedConcavities};
use cranny_exact::DVec3;
use cranny_geometry::{
    BuildError, BuildOptions, ChangeSet, DecodeError, DeformError, FaceForest, Mesh, Model, Report,
    VertexId,
};

/// A model and its concavities.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    model: Model,
    followed: FollowedConcavities,
    concavities: Concavities,
    /// How often it was deformed.
    steps: usize,
}

impl Deref for Body {
    type Target = Model;

    fn deref(&self) -> &Model {
        &self.model
    }
}

/// What a deformation has changed.
#[derive(Debug)]
pub(crate) struct Change {
    model: ChangeSet,
    pub(crate) beneath: ConcavityChange,
}

impl Deref for Change {
    type Target = ChangeSet;

    fn deref(&self) -> &ChangeSet {
        &self.model
    }
}

impl Body {
    pub(crate) fn of(model: Model) -> Self {
        Self::with_leaf_size(model, Concavities::DEFAULT_LEAF_SIZE)
    }

    /// Leaves of the trees of concavities hold at most so many faces.
    pub(crate) fn with_leaf_size(model: Model, leaf_size: NonZeroUsize) -> Self {
        let mut followed = FollowedConcavities::with_leaf_size(&model, leaf_size);
        let concavities = followed.concavities(&model).clone();
        Self { model, followed, concavities, steps: 0 }
    }

    /// The report holds the findings about concavities as well.
    pub(crate) fn build(mesh: Mesh, options: &BuildOptions) -> Result<(Self, Report), BuildError> {
        let (model, mut report) = Model::build(mesh, options)?;
        let body = Self::of(model);
        report.add(body.concavities.findings(&body));
        Ok((body, report))
    }

    pub(crate) fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        Model::decode(bytes).map(Self::of)
    }

    pub(crate) fn deform(&mut self, moves: &[(VertexId, DVec3)]) -> Result<Change, DeformError> {
        let model = self.model.deform(moves)?;
        let beneath = self.followed.follow(&self.model, &model);
        // Envelopes wait to be built for one deformation or for several.
        self.steps += 1;
        self.concavities = match self.steps % 2 {
            0 => self.followed.concavities(&self.model).clone(),
            _ => self.followed.clone().concavities(&self.model).clone(),
        };
        Ok(Change { model, beneath })
    }

    pub(crate) fn concavities(&self) -> &Concavities {
        &self.concavities
    }

    pub(crate) fn features(&self) -> &Features {
        self.concavities.features()
    }

    pub(crate) fn concavity_trees(&self) -> &FaceForest {
        self.concavities.trees()
    }

    pub(crate) fn envelopes(&self) -> &Envelopes {
        self.concavities.envelopes()
    }
}
