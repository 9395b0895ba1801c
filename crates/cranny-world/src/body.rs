//! Bodies: a model at a pose, under a stable id.

use std::collections::BTreeSet;
use std::fmt;

use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_narrow_phase::Placed;

use crate::demand::Wish;
use crate::description::{BodyKind, Effect};

/// A body of one [`World`](crate::World). Ids count up from 0 in the order of insertion and are
/// never used again, so they order everything that a world reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(pub u32);

impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// A body to insert.
#[derive(Clone, Debug)]
pub struct BodySpec {
    /// Unique among the bodies present.
    pub name: String,
    /// Its geometry, shared with others of the same shape.
    pub model: Model,
    /// Where it is: `world_from_body`.
    pub pose: Pose,
    /// How it moves. Two fixed bodies never meet.
    pub kind: BodyKind,
    /// Bodies meet only where they share a layer; a body without any meets nothing.
    pub layers: Vec<String>,
    /// What is asked about it beyond the scene's effects.
    pub effects: Vec<Effect>,
}

impl BodySpec {
    /// The layer of a body that names none.
    pub const DEFAULT_LAYER: &'static str = "all";

    /// A dynamic body at the origin, in the [default layer](Self::DEFAULT_LAYER), without effects.
    #[must_use]
    pub fn new(name: impl Into<String>, model: Model) -> Self {
        // Before the first step, which would make it otherwise.
        model.clusters();
        Self {
            name: name.into(),
            model,
            pose: Pose::IDENTITY,
            kind: BodyKind::Dynamic,
            layers: vec![Self::DEFAULT_LAYER.to_owned()],
            effects: Vec::new(),
        }
    }
}

/// A body as it is in the world.
#[derive(Clone, Debug)]
pub struct Body {
    pub(crate) name: String,
    pub(crate) model: Model,
    pub(crate) pose: Pose,
    pub(crate) kind: BodyKind,
    pub(crate) layers: BTreeSet<String>,
    pub(crate) effects: Vec<Effect>,
    /// What `effects` ask.
    pub(crate) wish: Wish,
}

impl Body {
    /// Unique among the bodies present.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its geometry.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Where it is: the very bits that queries read.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// How it moves.
    #[must_use]
    pub fn kind(&self) -> BodyKind {
        self.kind
    }

    /// Its layers, sorted.
    pub fn layers(&self) -> impl Iterator<Item = &str> {
        self.layers.iter().map(String::as_str)
    }

    /// What is asked about it beyond the scene's effects.
    #[must_use]
    pub fn effects(&self) -> &[Effect] {
        &self.effects
    }

    /// As the narrow phase wants it.
    pub(crate) fn placed(&self) -> Placed<'_> {
        Placed { model: &self.model, pose: self.pose }
    }

    /// Whether layers and kinds let the two meet at all.
    pub(crate) fn may_meet(&self, other: &Self) -> bool {
        let both_fixed = self.kind == BodyKind::Fixed && other.kind == BodyKind::Fixed;
        !both_fixed && !self.layers.is_disjoint(&other.layers)
    }
}
