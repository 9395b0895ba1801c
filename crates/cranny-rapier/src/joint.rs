//! Joints, described neutrally and built as rapier's generic ones.

use cranny_exact::{DQuat, DVec3, Pose};
use rapier3d::math::Real;
use rapier3d::prelude::{
    GenericJoint, GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis, MotorModel,
};

use crate::convert::pose_to_rapier;

/// Stiffness of a joint's motor, per second squared: a spring of 5 Hz whatever the mass. Softer: an
/// arm sags under its tool; stiffer: steps of 1/60 s overshoot.
const MOTOR_STIFFNESS: Real = 1000.0;

/// Damping of a joint's motor, per second: critical for the stiffness.
const MOTOR_DAMPING: Real = 63.0;

/// A joint of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointIndex(pub(crate) ImpulseJointHandle);

/// Which motions a joint leaves free. Axes are unit vectors in the joint's frame; angles in
/// radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointSpec {
    /// None.
    Fixed,
    /// Rotation about an axis.
    Revolute {
        /// Unit axis.
        axis: DVec3,
        /// Least and greatest angle; `None`: unbounded.
        limits: Option<[f64; 2]>,
        /// Angle at which a motor holds it, if one does.
        target: Option<f64>,
    },
    /// Translation along an axis.
    Prismatic {
        /// Unit axis.
        axis: DVec3,
        /// Least and greatest position; `None`: unbounded.
        limits: Option<[f64; 2]>,
        /// Position at which a motor holds it, if one does.
        target: Option<f64>,
    },
}

/// rapier's joint, whose free axis is x: the joint's frame is turned so that its axis is that.
pub(crate) fn generic_joint(
    parent_from_joint: &Pose,
    child_from_joint: &Pose,
    spec: &JointSpec,
    contacts_enabled: bool,
) -> GenericJoint {
    let (locked, free, axis, limits, target) = match *spec {
        JointSpec::Fixed => (JointAxesMask::LOCKED_FIXED_AXES, None, DVec3::X, None, None),
        JointSpec::Revolute { axis, limits, target } => {
            (JointAxesMask::LOCKED_REVOLUTE_AXES, Some(JointAxis::AngX), axis, limits, target)
        }
        JointSpec::Prismatic { axis, limits, target } => {
            (JointAxesMask::LOCKED_PRISMATIC_AXES, Some(JointAxis::LinX), axis, limits, target)
        }
    };
    let turn =
        Pose { rotation: DQuat::from_rotation_arc(DVec3::X, axis), translation: DVec3::ZERO };
    let mut builder = GenericJointBuilder::new(locked)
        .local_frame1(pose_to_rapier(&parent_from_joint.compose(&turn)))
        .local_frame2(pose_to_rapier(&child_from_joint.compose(&turn)))
        .contacts_enabled(contacts_enabled);
    if let Some(free) = free {
        if let Some([low, high]) = limits {
            builder = builder.limits(free, [low as Real, high as Real]);
        }
        if let Some(target) = target {
            builder = builder.motor_model(free, MotorModel::AccelerationBased).motor_position(
                free,
                target as Real,
                MOTOR_STIFFNESS,
                MOTOR_DAMPING,
            );
        }
    }
    builder.build()
}
