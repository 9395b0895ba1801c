//! What is said of a joint: which motions it leaves, what drives it and what resists.

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_exact::{DVec3, Pose};

use super::motor_path::MotorPath;

/// A joint between two bodies.
#[derive(Clone, Debug)]
pub struct JointDescription {
    /// Unique.
    pub name: String,
    /// Index into [`SceneDescription::bodies`](crate::description::SceneDescription::bodies).
    pub parent: usize,
    /// Index into [`SceneDescription::bodies`](crate::description::SceneDescription::bodies).
    pub child: usize,
    /// `parent_from_joint`.
    pub parent_anchor: Pose,
    /// `child_from_joint`.
    pub child_anchor: Pose,
    /// Which motions are free.
    pub kind: JointKind,
    /// Motion of the joint in step with another: position = multiplier * other + offset.
    pub mimic: Option<Mimic>,
    /// What drives it, if anything does.
    pub motor: Option<Motor>,
    /// Where the motor leads it over time, in place of the motor's position and velocity.
    pub path: Option<Arc<MotorPath>>,
    /// What resists its motion.
    pub resistance: Resistance,
    /// Whether its position is a coordinate of a tree of bodies, so that it does not yield, rather
    /// than a constraint between two bodies. A robot's joints are.
    pub reduced: bool,
    /// Position of the joint at the poses of its bodies.
    pub start: f64,
}

/// What drives a joint: `stiffness * (position - q) + damping * (velocity - q') + effort`, at most
/// `max_effort` in either direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motor {
    /// Position (radians or units) that is held, if one is.
    pub position: Option<f64>,
    /// Velocity that is aimed at.
    pub velocity: f64,
    /// Force or torque that is there whatever the joint does.
    pub effort: f64,
    /// Per radian or unit of distance; `None`: as stiff as the solver resolves.
    pub stiffness: Option<f64>,
    /// Per unit of velocity; `None`: critical for the stiffness.
    pub damping: Option<f64>,
    /// Greatest force or torque; `None`: unbounded.
    pub max_effort: Option<f64>,
    /// Greatest velocity with which the position is approached; `None`: the solver's default.
    pub max_velocity: Option<f64>,
}

impl Motor {
    /// Holds a position.
    #[must_use]
    pub fn at(position: f64) -> Self {
        Self { position: Some(position), ..Self::default() }
    }
}

/// What resists the motion of a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resistance {
    /// Force or torque per velocity, against it, >= 0.
    pub damping: f64,
    /// Greatest force or torque of dry friction, >= 0.
    pub friction: f64,
}

/// Which motions a joint leaves free; axes are unit vectors in the joint's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// None.
    Fixed,
    /// Rotation about an axis, within limits (radians).
    Revolute {
        /// Unit axis.
        axis: DVec3,
        /// Least and greatest angle; `None`: unbounded.
        limits: Option<[f64; 2]>,
    },
    /// Translation along an axis, within limits.
    Prismatic {
        /// Unit axis.
        axis: DVec3,
        /// Least and greatest position; `None`: unbounded.
        limits: Option<[f64; 2]>,
    },
    /// Translation in a plane, and rotation about its normal.
    Planar {
        /// Unit normal.
        normal: DVec3,
    },
    /// Rotation about a point.
    Ball,
    /// All, as long as the anchors are no farther apart than this.
    Rope {
        /// Greatest distance of the anchors, > 0.
        length: f64,
    },
    /// All; a force along the line between the anchors.
    Spring(Spring),
    /// All: its bodies are not joined.
    Floating,
}

impl JointKind {
    /// Its name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Fixed => "Fixed",
            Self::Revolute { .. } => "Revolute",
            Self::Prismatic { .. } => "Prismatic",
            Self::Planar { .. } => "Planar",
            Self::Ball => "Ball",
            Self::Rope { .. } => "Rope",
            Self::Spring(_) => "Spring",
            Self::Floating => "Floating",
        }
    }

    /// Least and greatest position, if it has one and is bounded.
    #[must_use]
    pub fn limits(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Revolute { limits, .. } | Self::Prismatic { limits, .. } => limits,
            _ => None,
        }
    }

    /// Whether one number says where it is: an angle or a distance along an axis.
    #[must_use]
    pub fn has_position(&self) -> bool {
        matches!(self, Self::Revolute { .. } | Self::Prismatic { .. })
    }
}

/// What pulls two anchors together that are farther apart than `length`, and pushes them apart
/// where they are nearer: `stiffness * (distance - length) + damping * (change of distance)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Distance at rest, >= 0.
    pub length: f64,
    /// Force a unit of distance, > 0.
    pub stiffness: f64,
    /// Force a unit of velocity, >= 0.
    pub damping: f64,
}

/// One joint follows another.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// Name of the joint that leads.
    pub joint: String,
    /// Factor.
    pub multiplier: f64,
    /// Offset.
    pub offset: f64,
}

/// Joint positions by name.
pub type JointPositions = BTreeMap<String, f64>;
