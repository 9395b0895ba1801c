//! Joints between bodies, as entities.

use bevy_ecs::prelude::*;
use cranny_exact::{DVec3, Pose};
use cranny_world::description::JointKind;

/// A joint between two bodies. The solver has it while both ends are bodies that it moves;
/// despawning the entity, or removing the component, takes it out. Inserting another one replaces
/// it.
///
/// Bodies that a joint holds collide as others do: a [`BodyPair`](crate::BodyPair) with
/// [`NeverMeet`](crate::NeverMeet) keeps links apart that overlap by design.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable)]
pub struct Joint {
    /// One end.
    pub parent: Entity,
    /// The other.
    pub child: Entity,
    /// The joint's frame in the parent's: `parent_from_joint`.
    pub parent_anchor: Pose,
    /// The joint's frame in the child's: `child_from_joint`.
    pub child_anchor: Pose,
    /// Which motions are free.
    pub kind: JointKind,
    /// Position (radians or units) at which a motor holds it, if one does.
    pub target: Option<f64>,
}

impl Joint {
    /// No motion is free. The frames of both bodies are the joint's.
    #[must_use]
    pub const fn fixed(parent: Entity, child: Entity) -> Self {
        Self::new(parent, child, JointKind::Fixed)
    }

    /// Rotation about a unit axis is free.
    #[must_use]
    pub const fn revolute(parent: Entity, child: Entity, axis: DVec3) -> Self {
        Self::new(parent, child, JointKind::Revolute { axis, limits: None })
    }

    /// Translation along a unit axis is free.
    #[must_use]
    pub const fn prismatic(parent: Entity, child: Entity, axis: DVec3) -> Self {
        Self::new(parent, child, JointKind::Prismatic { axis, limits: None })
    }

    const fn new(parent: Entity, child: Entity, kind: JointKind) -> Self {
        let frame = Pose::IDENTITY;
        Self { parent, child, parent_anchor: frame, child_anchor: frame, kind, target: None }
    }

    /// The joint's place in the parent's frame and in the child's.
    #[must_use]
    pub const fn with_anchors(self, parent_from_joint: Pose, child_from_joint: Pose) -> Self {
        Self { parent_anchor: parent_from_joint, child_anchor: child_from_joint, ..self }
    }
}
