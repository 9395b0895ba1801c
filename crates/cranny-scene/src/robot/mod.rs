//! Robots from URDF files: links with their meshes, joints, and where the links are for given
//! joint positions.
//!
//! Lengths are metres and angles radians, as URDF says. Collision geometry must be there and
//! readable; drawing geometry that is missing is noted and left out.

mod cylinder;
mod group;
mod kinematics;
mod models;
mod package;
mod problem;
mod sift;
mod srdf;
mod urdf;

use std::path::PathBuf;
use std::sync::Arc;

use cranny_exact::Pose;
use cranny_geometry::Mesh;
use cranny_primitives::Primitive;
use cranny_world::description::{BodyColor, JointKind, Mimic, Resistance, StatedMass};

pub(crate) use group::these;
pub use group::{Member, MemberKind, RobotGroup, SemanticGroup};
pub use kinematics::PositionError;
pub(crate) use kinematics::about;
pub use models::LinkModelError;
pub(crate) use models::LinkModels;
pub use problem::RobotError;
pub use srdf::{Semantics, read_semantics};
pub use urdf::read_robot;

/// A tree of links joined by joints.
#[derive(Clone, Debug)]
pub struct Robot {
    /// Its name in the URDF file.
    pub name: String,
    /// In file order.
    pub links: Vec<RobotLink>,
    /// In file order.
    pub joints: Vec<RobotJoint>,
    /// The one link without parent: index into [`links`](Self::links).
    pub root: usize,
    /// One sentence each: drawing meshes that were left out, elements that say nothing here.
    pub notes: Vec<String>,
    /// The URDF file and every mesh file read, in order.
    pub files: Vec<PathBuf>,
    /// Joints such that parents come before children: indices into [`joints`](Self::joints).
    order: Vec<usize>,
}

/// A rigid part of a robot.
#[derive(Clone, Debug)]
pub struct RobotLink {
    /// Unique in the robot.
    pub name: String,
    /// All its collision elements joined, in the link's frame; `None` where it has none.
    pub collision: Option<Arc<Mesh>>,
    /// What collides in place of that mesh, in the link's frame: where the one collision element of
    /// the link is a sphere, a cylinder or a capsule. The mesh then stands for it in pictures.
    pub primitive: Option<Primitive>,
    /// All its visual elements joined, in the link's frame; `None` where none could be read.
    pub visual: Option<Arc<Mesh>>,
    /// Colour of the material of its visual element with the greatest surface, of those that have
    /// one.
    pub color: Option<BodyColor>,
    /// Mass, where the file states one above 0.
    pub mass: Option<f64>,
    /// Mass, centre and inertia in the link's frame, where the file states a mass above 0 and an
    /// inertia that a body can have.
    pub inertial: Option<StatedMass>,
}

/// A joint between two links of a robot.
#[derive(Clone, Debug)]
pub struct RobotJoint {
    /// Unique in the robot.
    pub name: String,
    /// Index into [`Robot::links`].
    pub parent: usize,
    /// Index into [`Robot::links`]. At position 0 the child's frame is the joint's.
    pub child: usize,
    /// Where the joint is in the parent's frame.
    pub parent_from_joint: Pose,
    /// What it leaves free, with axes in the joint's frame.
    pub kind: JointKind,
    /// The joint that it follows, if it does.
    pub mimic: Option<Mimic>,
    /// Damping and dry friction.
    pub resistance: Resistance,
    /// Greatest force or torque of its motor, where the file states one above 0.
    pub max_effort: Option<f64>,
    /// Greatest velocity, where the file states one above 0.
    pub max_velocity: Option<f64>,
}

impl Robot {
    /// The link of a name.
    #[must_use]
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// The joint of a name.
    #[must_use]
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The joint whose child a link is; the root has none.
    #[must_use]
    pub fn joint_above(&self, link: usize) -> Option<usize> {
        self.joints.iter().position(|joint| joint.child == link)
    }

    /// Pairs of links that a joint joins, the smaller index first, sorted. They overlap by design
    /// and are not checked against each other.
    #[must_use]
    pub fn adjacent_links(&self) -> Vec<(usize, usize)> {
        let ordered = |j: &RobotJoint| (j.parent.min(j.child), j.parent.max(j.child));
        let mut pairs: Vec<_> = self.joints.iter().map(ordered).collect();
        pairs.sort_unstable();
        pairs
    }

    /// Has the visual meshes stand for collision geometry where no link has any; returns whether
    /// they do.
    pub fn collide_as_drawn(&mut self) -> bool {
        if self.links.iter().any(|link| link.collision.is_some()) {
            return false;
        }
        for link in &mut self.links {
            link.collision.clone_from(&link.visual);
        }
        self.links.iter().any(|link| link.collision.is_some())
    }

    /// Indices of [`joints`](Self::joints) such that every link is reached as a child before it is
    /// a parent.
    #[must_use]
    pub fn joints_from_root(&self) -> &[usize] {
        &self.order
    }
}
