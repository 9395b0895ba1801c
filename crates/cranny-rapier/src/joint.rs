//! Joints, described neutrally and built as rapier's generic ones.

use cranny_exact::{DQuat, DVec3, Pose};
use rapier3d::math::Real;
use rapier3d::prelude::{
    GenericJoint, GenericJointBuilder, ImpulseJointHandle, JointAxesMask, JointAxis, MotorModel,
};

use crate::convert::pose_to_rapier;

/// Stiffness of the motor of a joint of impulses, per second squared: a spring of 5 Hz whatever the
/// mass. Softer: an arm sags under its tool; stiffer: steps of 1/60 s overshoot.
const MOTOR_STIFFNESS: Real = 1000.0;

/// Damping of the motor of a joint of impulses, per second: critical for the stiffness.
const MOTOR_DAMPING: Real = 63.0;

/// Velocity with which a motor of the default stiffness approaches its position where none is
/// stated: radians, or units of length, a second. Slower: an arm takes seconds to come where it is
/// sent; faster: it throws what it carries.
pub const APPROACH: f64 = 3.0;

/// A joint of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointIndex(pub(crate) JointPlace);

/// Who solves a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JointPlace {
    /// Its bodies keep all their coordinates, impulses hold them together.
    Impulses(ImpulseJointHandle),
    /// The joint's position is a coordinate: its number among those.
    Reduced(u32),
}

/// What drives a joint: `stiffness * (position - q) + damping * (velocity - q') + effort`, at most
/// `max_effort` in either direction. Angles and torques for a hinge, lengths and forces for a
/// slider.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "snapshot", derive(serde::Serialize, serde::Deserialize))]
pub struct Motor {
    /// Position that is held; `None`: none is.
    pub position: Option<f64>,
    /// Velocity that is aimed at.
    pub velocity: f64,
    /// Force or torque that is there whatever the joint does.
    pub effort: f64,
    /// Per unit of distance from `position`; `None`: as stiff as a solver's substep resolves, for
    /// what the joint carries.
    pub stiffness: Option<f64>,
    /// Per unit of velocity; `None`: critical for the stiffness.
    pub damping: Option<f64>,
    /// Greatest force or torque; `None`: unbounded.
    pub max_effort: Option<f64>,
    /// Greatest velocity with which a motor of the default stiffness approaches its position;
    /// `None`: [`APPROACH`].
    pub max_velocity: Option<f64>,
}

impl Motor {
    /// Holds a position.
    #[must_use]
    pub fn at(position: f64) -> Self {
        Self { position: Some(position), ..Self::default() }
    }
}

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
        /// What drives it.
        motor: Option<Motor>,
    },
    /// Translation along an axis.
    Prismatic {
        /// Unit axis.
        axis: DVec3,
        /// Least and greatest position; `None`: unbounded.
        limits: Option<[f64; 2]>,
        /// What drives it.
        motor: Option<Motor>,
    },
    /// Translation in a plane, and rotation about its normal.
    Planar {
        /// Unit normal.
        normal: DVec3,
    },
    /// Rotation about a point.
    Ball,
    /// All, as long as the two frames' origins are no farther apart than this.
    Rope {
        /// Greatest distance, > 0.
        length: f64,
    },
    /// All. `stiffness * (distance - length) + damping * (change of distance)` pulls the origins of
    /// the two frames together.
    Spring {
        /// Distance at rest, >= 0.
        length: f64,
        /// Force a unit of distance, > 0.
        stiffness: f64,
        /// Force a unit of velocity, >= 0.
        damping: f64,
    },
}

impl JointSpec {
    /// The axis that a motor drives, as rapier counts them.
    pub(crate) fn driven_axis(&self) -> Option<JointAxis> {
        match self {
            Self::Revolute { .. } => Some(JointAxis::AngX),
            Self::Prismatic { .. } => Some(JointAxis::LinX),
            _ => None,
        }
    }

    /// Whether it holds a distance between points, not one frame in another.
    pub(crate) fn is_of_distance(&self) -> bool {
        matches!(self, Self::Rope { .. } | Self::Spring { .. })
    }

    /// What drives it, if anything does.
    pub(crate) fn motor(&self) -> Option<Motor> {
        match *self {
            Self::Revolute { motor, .. } | Self::Prismatic { motor, .. } => motor,
            _ => None,
        }
    }

    /// How far the joint displaces its child at a position.
    pub(crate) fn displacement(&self, position: f64) -> Pose {
        match *self {
            Self::Revolute { axis, .. } => {
                Pose { rotation: DQuat::from_axis_angle(axis, position), translation: DVec3::ZERO }
            }
            Self::Prismatic { axis, .. } => Pose::at(axis * position),
            _ => Pose::IDENTITY,
        }
    }
}

/// rapier's joint without its motor. Its free axis is x: the joint's frame is turned so that its
/// axis is that. Its coordinate is 0 at the position `start`.
pub(crate) fn generic_joint(
    parent_from_joint: &Pose,
    child_from_joint: &Pose,
    spec: &JointSpec,
    start: f64,
    contacts_enabled: bool,
) -> GenericJoint {
    let (locked, axis, limits) = match *spec {
        JointSpec::Fixed => (JointAxesMask::LOCKED_FIXED_AXES, DVec3::X, None),
        JointSpec::Revolute { axis, limits, .. } => {
            (JointAxesMask::LOCKED_REVOLUTE_AXES, axis, limits)
        }
        JointSpec::Prismatic { axis, limits, .. } => {
            (JointAxesMask::LOCKED_PRISMATIC_AXES, axis, limits)
        }
        JointSpec::Planar { normal } => {
            let locked = JointAxesMask::LIN_X | JointAxesMask::ANG_Y | JointAxesMask::ANG_Z;
            (locked, normal, None)
        }
        JointSpec::Ball => (JointAxesMask::LOCKED_SPHERICAL_AXES, DVec3::X, None),
        JointSpec::Rope { .. } | JointSpec::Spring { .. } => {
            (JointAxesMask::empty(), DVec3::X, None)
        }
    };
    let turn =
        Pose { rotation: DQuat::from_rotation_arc(DVec3::X, axis), translation: DVec3::ZERO };
    let first = parent_from_joint.compose(&spec.displacement(start)).compose(&turn);
    let mut builder = GenericJointBuilder::new(locked)
        .local_frame1(pose_to_rapier(&first))
        .local_frame2(pose_to_rapier(&child_from_joint.compose(&turn)))
        .contacts_enabled(contacts_enabled);
    if let Some((free, limits)) = spec.driven_axis().zip(limits) {
        builder = builder.limits(free, limits.map(|limit| (limit - start) as Real));
    }
    with_distance(builder, spec).build()
}

/// A rope or a spring acts along the line between the origins: rapier couples the axes for it.
fn with_distance(builder: GenericJointBuilder, spec: &JointSpec) -> GenericJointBuilder {
    let coupled = JointAxesMask::LIN_AXES;
    match *spec {
        JointSpec::Rope { length } => {
            builder.coupled_axes(coupled).limits(JointAxis::LinX, [0.0, length as Real])
        }
        JointSpec::Spring { length, stiffness, damping } => {
            let [length, stiffness, damping] = [length, stiffness, damping].map(|n| n as Real);
            builder
                .coupled_axes(coupled)
                .motor_model(JointAxis::LinX, MotorModel::ForceBased)
                .motor_position(JointAxis::LinX, length, stiffness, damping)
        }
        _ => builder,
    }
}

/// Energy in a joint that is a spring, at a distance of its origins; 0 of all others.
pub(crate) fn elastic_energy(joint: &GenericJoint, distance: f64) -> f64 {
    let is_spring = joint.coupled_axes == JointAxesMask::LIN_AXES
        && joint.motor_axes.contains(JointAxesMask::LIN_X);
    let motor = &joint.motors[JointAxis::LinX as usize];
    let stretch = distance - f64::from(motor.target_pos);
    if is_spring { 0.5 * f64::from(motor.stiffness) * stretch * stretch } else { 0.0 }
}

/// Gives a joint of impulses its motor. rapier's spring for it acts on the two bodies alone, as if
/// nothing hung on them: gains are for both, or by their inertia.
pub(crate) fn set_impulse_motor(
    joint: &mut GenericJoint,
    axis: JointAxis,
    motor: Motor,
    start: f64,
) {
    let target = motor.position.unwrap_or(start) - start;
    let given = motor.stiffness.is_some() || motor.damping.is_some();
    let velocity = motor.velocity as Real;
    let held = if motor.position.is_some() { 1.0 } else { 0.0 };
    if given {
        let stiffness = motor.stiffness.unwrap_or(0.0);
        let damping = motor.damping.unwrap_or(0.0);
        // The spring's rest says what the constant effort adds.
        let rest = if stiffness > 0.0 { target + motor.effort / stiffness } else { target };
        joint.set_motor_model(axis, MotorModel::ForceBased);
        joint.set_motor(axis, rest as Real, velocity, held * stiffness as Real, damping as Real);
    } else {
        joint.set_motor_model(axis, MotorModel::AccelerationBased);
        joint.set_motor(axis, target as Real, velocity, held * MOTOR_STIFFNESS, MOTOR_DAMPING);
    }
    joint.set_motor_max_force(axis, motor.max_effort.map_or(Real::MAX, |most| most as Real));
}
