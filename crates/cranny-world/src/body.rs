//! Bodies: a shape at a pose, under a stable id.

use std::fmt;

use cranny_exact::Pose;
use cranny_primitives::{BodyShape, PlacedShape};

use crate::demand::Wish;
use crate::description::{BodyKind, Effect};
use crate::layers::Layers;

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
    /// Its geometry: a model, shared with others of the same shape, or a primitive.
    pub shape: BodyShape,
    /// Where it is: `world_from_body`.
    pub pose: Pose,
    /// How it moves. Two fixed bodies never meet.
    pub kind: BodyKind,
    /// Which other bodies it may meet at all.
    pub layers: Layers,
    /// Whether it is noticed and never pushes: a solver then has no part in its pairs.
    pub sensor: bool,
    /// What is wanted of it beyond the scene's effects.
    pub effects: Vec<Effect>,
}

impl BodySpec {
    /// A dynamic body at the origin, in the default layers, without effects.
    #[must_use]
    pub fn new(name: impl Into<String>, shape: impl Into<BodyShape>) -> Self {
        let shape = shape.into();
        // Before the first step, which would make it otherwise.
        if let BodyShape::Model(model) = &shape {
            model.clusters();
        }
        Self {
            name: name.into(),
            shape,
            pose: Pose::IDENTITY,
            kind: BodyKind::Dynamic,
            layers: Layers::default(),
            sensor: false,
            effects: Vec::new(),
        }
    }
}

/// A body as it is in the world.
#[derive(Clone, Debug)]
pub struct Body {
    pub(crate) name: String,
    pub(crate) shape: BodyShape,
    pub(crate) pose: Pose,
    pub(crate) kind: BodyKind,
    pub(crate) layers: Layers,
    pub(crate) sensor: bool,
    pub(crate) effects: Vec<Effect>,
    /// What `effects` need.
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
    pub fn shape(&self) -> &BodyShape {
        &self.shape
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

    /// Which other bodies it may meet at all.
    #[must_use]
    pub fn layers(&self) -> Layers {
        self.layers
    }

    /// Whether it never pushes.
    #[must_use]
    pub fn is_sensor(&self) -> bool {
        self.sensor
    }

    /// What is wanted of it beyond the scene's effects.
    #[must_use]
    pub fn effects(&self) -> &[Effect] {
        &self.effects
    }

    /// As queries take it.
    pub(crate) fn placed(&self) -> PlacedShape<'_> {
        PlacedShape { shape: &self.shape, pose: self.pose }
    }

    /// Whether layers and kinds let the two meet at all.
    pub(crate) fn may_meet(&self, other: &Self) -> bool {
        let both_fixed = self.kind == BodyKind::Fixed && other.kind == BodyKind::Fixed;
        !both_fixed && self.layers.meets(other.layers)
    }
}
