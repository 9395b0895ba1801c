//! Joints between bodies, as entities.

use bevy_ecs::prelude::*;
use cranny_exact::{DVec3, Pose};
use cranny_world::description::{JointKind, Motor, Resistance, Spring};

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
    /// What drives it, if anything does.
    pub motor: Option<Motor>,
    /// What resists its motion.
    pub resistance: Resistance,
    /// The joint that it follows, if it does; both must be reduced, and of one tree.
    pub follows: Option<Follows>,
    /// Whether its position is a coordinate of a tree of bodies: then it does not yield, its motor
    /// holds whatever the tree carries, and the child moves with its parent (a `Transform` or a
    /// velocity that an app writes moves a tree by its root alone). Otherwise it is a constraint
    /// between two bodies, which loops may hold.
    pub reduced: bool,
    /// About where the position of a hinge is at the bodies' poses, which leave whole turns open.
    pub start: f64,
}

/// Position = `multiplier` * position of another joint + `offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follows {
    /// The entity of the other joint.
    pub joint: Entity,
    /// Factor.
    pub multiplier: f64,
    /// Offset, radians or units.
    pub offset: f64,
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

    /// Rotation about the origin of the joint's frames is free.
    #[must_use]
    pub const fn ball(parent: Entity, child: Entity) -> Self {
        Self::new(parent, child, JointKind::Ball)
    }

    /// The origins of the joint's frames get no farther apart than this.
    #[must_use]
    pub const fn rope(parent: Entity, child: Entity, length: f64) -> Self {
        Self::new(parent, child, JointKind::Rope { length })
    }

    /// A spring between the origins of the joint's frames.
    #[must_use]
    pub const fn spring(parent: Entity, child: Entity, spring: Spring) -> Self {
        Self::new(parent, child, JointKind::Spring(spring))
    }

    const fn new(parent: Entity, child: Entity, kind: JointKind) -> Self {
        let frame = Pose::IDENTITY;
        Self {
            parent,
            child,
            parent_anchor: frame,
            child_anchor: frame,
            kind,
            motor: None,
            resistance: Resistance { damping: 0.0, friction: 0.0 },
            follows: None,
            reduced: false,
            start: 0.0,
        }
    }

    /// What drives it. Inserted in place of a joint that differs in nothing else, it changes the
    /// motor of a reduced joint without joining anew.
    #[must_use]
    pub const fn with_motor(self, motor: Motor) -> Self {
        Self { motor: Some(motor), ..self }
    }

    /// Its position is a coordinate of a tree of bodies.
    #[must_use]
    pub const fn reduced(self) -> Self {
        Self { reduced: true, ..self }
    }

    /// The joint's place in the parent's frame and in the child's.
    #[must_use]
    pub const fn with_anchors(self, parent_from_joint: Pose, child_from_joint: Pose) -> Self {
        Self { parent_anchor: parent_from_joint, child_anchor: child_from_joint, ..self }
    }
}
