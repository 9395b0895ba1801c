//! Where the links are.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_world::description::{JointKind, JointPositions};
use thiserror::Error;

use super::{Robot, RobotJoint};

/// A joint position that cannot be taken.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PositionError {
    /// No joint of that name.
    #[error("the robot has no joint {joint:?}; {}", movable_joints(movable))]
    UnknownJoint {
        /// The name.
        joint: String,
        /// Names that would do, separated by commas; empty where no joint moves.
        movable: String,
    },
    /// The joint has no position of its own.
    #[error("joint {joint:?} {reason}: it takes no position")]
    NotFree {
        /// The name.
        joint: String,
        /// "is fixed", "is planar", "is floating" or "follows joint …".
        reason: String,
    },
    /// Not a number.
    #[error("joint {joint:?}: the position {value} is not a finite number")]
    NotFinite {
        /// The name.
        joint: String,
        /// Value found.
        value: f64,
    },
}

fn movable_joints(names: &str) -> String {
    match names {
        "" => "none of its joints moves".to_owned(),
        names => format!("its movable joints are {names}"),
    }
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for PositionError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl Robot {
    /// World pose of every link, in the order of [`links`](Self::links), with the root's frame as
    /// the world. Positions are radians, or metres for prismatic joints; joints not named are at 0;
    /// mimic joints follow. Limits are not enforced: recorded robots exceed them.
    ///
    /// # Errors
    ///
    /// [`PositionError`]: an unknown, fixed or following joint is given a position, or the position
    /// is not finite.
    pub fn forward_kinematics(
        &self,
        positions: &JointPositions,
    ) -> Result<Vec<Pose>, PositionError> {
        let values = self.all_positions(positions)?;
        let mut poses = vec![Pose::IDENTITY; self.links.len()];
        for &index in self.joints_from_root() {
            let joint = &self.joints[index];
            let world_from_joint = poses[joint.parent].compose(&joint.parent_from_joint);
            poses[joint.child] = world_from_joint.compose(&joint.joint_from_child(values[index]));
        }
        Ok(poses)
    }

    /// The position of every joint, in the order of [`joints`](Self::joints); 0 for fixed ones.
    ///
    /// # Errors
    ///
    /// As [`forward_kinematics`](Self::forward_kinematics).
    pub fn all_positions(&self, positions: &JointPositions) -> Result<Vec<f64>, PositionError> {
        let mut values = vec![0.0; self.joints.len()];
        for (name, &value) in positions {
            let index = self.joint(name).ok_or_else(|| PositionError::UnknownJoint {
                joint: name.clone(),
                movable: self.movable_joints(),
            })?;
            let refuse = |reason| PositionError::NotFree { joint: name.clone(), reason };
            let joint = &self.joints[index];
            if !joint.has_position() {
                return Err(refuse(format!("is {}", joint.kind.name().to_lowercase())));
            }
            if let Some(mimic) = &joint.mimic {
                return Err(refuse(format!("follows joint {:?}", mimic.joint)));
            }
            if !value.is_finite() {
                return Err(PositionError::NotFinite { joint: name.clone(), value });
            }
            values[index] = value;
        }
        // The reader has checked that a mimic joint's leader exists and follows nobody.
        for (index, joint) in self.joints.iter().enumerate() {
            if let Some(mimic) = &joint.mimic {
                let leader = self.joint(&mimic.joint).map_or(0.0, |leader| values[leader]);
                values[index] = mimic.multiplier * leader + mimic.offset;
            }
        }
        Ok(values)
    }

    /// Gives joints that have no position the one within their limits that is nearest to 0, where
    /// that is not 0; returns the names of those.
    pub fn clamp_to_limits(&self, positions: &mut JointPositions) -> Vec<String> {
        let mut clamped = Vec::new();
        for joint in self.joints.iter().filter(|joint| joint.mimic.is_none()) {
            let Some([low, high]) = joint.limits() else { continue };
            let start = 0f64.clamp(low, high);
            if start != 0.0 && !positions.contains_key(&joint.name) {
                positions.insert(joint.name.clone(), start);
                clamped.push(joint.name.clone());
            }
        }
        clamped
    }

    fn movable_joints(&self) -> String {
        let free = |joint: &&RobotJoint| joint.has_position() && joint.mimic.is_none();
        let names: Vec<_> = self.joints.iter().filter(free).map(|j| j.name.as_str()).collect();
        names.join(", ")
    }
}

impl RobotJoint {
    /// Whether one number says where it is.
    #[must_use]
    pub fn has_position(&self) -> bool {
        self.kind.has_position()
    }

    /// Whether it moves nothing.
    #[must_use]
    pub fn is_fixed(&self) -> bool {
        self.kind == JointKind::Fixed
    }

    /// The child's pose in the joint's frame at a position.
    #[must_use]
    pub fn joint_from_child(&self, position: f64) -> Pose {
        match self.kind {
            JointKind::Revolute { axis, .. } => {
                Pose { rotation: about(axis, position), translation: DVec3::ZERO }
            }
            JointKind::Prismatic { axis, .. } => Pose::at(axis * position),
            _ => Pose::IDENTITY,
        }
    }

    /// Least and greatest position, where it has limits.
    #[must_use]
    pub fn limits(&self) -> Option<[f64; 2]> {
        self.kind.limits()
    }
}

/// A rotation about a unit axis by an angle in radians.
pub(crate) fn about(axis: DVec3, angle: f64) -> DQuat {
    let (sin, cos) = (0.5 * angle).sin_cos();
    let v = axis * sin;
    let rotation = DQuat::from_xyzw(v.x, v.y, v.z, cos);
    rotation * (1.0 / rotation.length())
}

/// URDF's roll, pitch, yaw: about the fixed axes x, then y, then z.
pub(super) fn roll_pitch_yaw([roll, pitch, yaw]: [f64; 3]) -> DQuat {
    about(DVec3::Z, yaw) * about(DVec3::Y, pitch) * about(DVec3::X, roll)
}
