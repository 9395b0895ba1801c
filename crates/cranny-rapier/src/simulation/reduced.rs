//! Joints in reduced coordinates: a tree of bodies moves by the positions of its joints alone, so
//! that no joint yields, and its motors are solved together.
//!
//! rapier's multibodies do this (Featherstone 2008; the motors are their joint springs, which are
//! solved with the mass matrix by backward Euler). Here joints come and go, and say where they are;
//! `motors` drives them.

mod motors;

use std::collections::BTreeMap;

use cranny_exact::{DVec3, Pose};
use rapier3d::math::{Pose as RapierPose, Real, Vector};
use rapier3d::prelude::{
    ImpulseJointHandle, JointAxesMask, JointAxis, MultibodyDofCoupling, MultibodyJointHandle,
    RigidBodyHandle,
};

use super::{BodyIndex, Simulation};
use crate::convert::pose_from_rapier;
use crate::joint::{JointIndex, JointPlace, JointSpec, Motor, generic_joint, set_impulse_motor};

/// What a joint has beside its motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "snapshot", derive(serde::Serialize, serde::Deserialize))]
pub struct Resistance {
    /// Force or torque per velocity, against it.
    pub damping: f64,
    /// Greatest force or torque of dry friction.
    pub friction: f64,
}

/// Joints whose positions are coordinates, by number.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "snapshot", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct ReducedJoints {
    joints: BTreeMap<u32, ReducedJoint>,
    /// The number of the next joint; none is given again.
    next: u32,
}

impl ReducedJoints {
    pub(super) fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }
}

#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "snapshot", derive(serde::Serialize, serde::Deserialize))]
struct ReducedJoint {
    place: ReducedPlace,
    /// As rapier counts them; `None`: it drives none.
    axis: Option<u8>,
    /// Position at which the coordinate is 0.
    start: f64,
    motor: Option<Motor>,
    resistance: Resistance,
    follows: Option<Coupling>,
    /// Whether its motor was at its greatest effort in the last step.
    strained: bool,
}

/// Position = multiplier * position of another joint + offset.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "snapshot", derive(serde::Serialize, serde::Deserialize))]
struct Coupling {
    leader: u32,
    multiplier: f64,
    offset: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "snapshot", derive(serde::Serialize, serde::Deserialize))]
enum ReducedPlace {
    /// The joint above this body.
    Above(RigidBodyHandle),
    /// The tree could not take it: its child has a parent already, or is not dynamic.
    Impulses(ImpulseJointHandle),
}

/// Joints come and go.
impl Simulation {
    /// Joins two bodies by a joint whose position is a coordinate. The child moves with its parent
    /// from now on: [`set_pose`](Self::set_pose) and [`set_velocity`](Self::set_velocity) move a
    /// tree by its root alone.
    ///
    /// `near` picks the turn of a hinge that the bodies' poses leave open: its position is the
    /// nearest to it. Where the child has a parent already, or is not dynamic, the joint is one of
    /// impulses, and so are ropes and springs.
    pub fn join_reduced(
        &mut self,
        [parent, child]: [BodyIndex; 2],
        [parent_from_joint, child_from_joint]: [Pose; 2],
        spec: &JointSpec,
        resistance: Resistance,
        near: f64,
    ) -> JointIndex {
        let frames = [
            self.pose(parent).compose(&parent_from_joint),
            self.pose(child).compose(&child_from_joint),
        ];
        let start = position(spec, &frames, near);
        let data = generic_joint(&parent_from_joint, &child_from_joint, spec, start, true);
        let [first, second] = [self.handle(parent), self.handle(child)];
        let fits = self.bodies[second].is_dynamic() && !spec.is_of_distance();
        let taken = fits.then(|| self.multibody_joints.insert(first, second, data, true)).flatten();
        let axis = spec.driven_axis().map(|axis| axis as u8);
        let motor = spec.motor();
        let place = match taken {
            Some(_) => ReducedPlace::Above(second),
            None => ReducedPlace::Impulses(self.joints.insert(first, second, data, true)),
        };
        let number = self.reduced.next;
        self.reduced.next += 1;
        let joint =
            ReducedJoint { place, axis, start, motor, resistance, follows: None, strained: false };
        self.reduced.joints.insert(number, joint);
        self.drive_impulses(number);
        self.joined = true;
        JointIndex(JointPlace::Reduced(number))
    }

    /// Gives a joint of [`join_reduced`](Self::join_reduced) another motor and resistance; returns
    /// whether it is one.
    pub fn set_motor(
        &mut self,
        joint: JointIndex,
        motor: Option<Motor>,
        resistance: Resistance,
    ) -> bool {
        let JointPlace::Reduced(number) = joint.0 else { return false };
        let Some(known) = self.reduced.joints.get_mut(&number) else { return false };
        (known.motor, known.resistance) = (motor, resistance);
        match known.place {
            ReducedPlace::Above(body) => {
                if let Some(body) = self.bodies.get_mut(body) {
                    body.wake_up(true);
                }
            }
            ReducedPlace::Impulses(_) => self.drive_impulses(number),
        }
        true
    }

    /// Makes a joint follow another of the same tree: position = `multiplier` * other + `offset`.
    /// Returns whether it does; both must have one coordinate.
    ///
    /// It is held to it by a constraint, and driven beside: where a motor of the default stiffness
    /// holds the other one, one like it, with the greatest effort of its own motor, holds this one
    /// where it should be then. (A constraint alone would have the leader carry it through rows
    /// that are swept four times a step.) Its own motor does nothing else.
    pub fn couple(
        &mut self,
        follower: JointIndex,
        leader: JointIndex,
        multiplier: f64,
        offset: f64,
    ) -> bool {
        let found = |joint: JointIndex| {
            let JointPlace::Reduced(number) = joint.0 else { return None };
            let joint = self.reduced.joints.get(&number)?;
            let ReducedPlace::Above(body) = joint.place else { return None };
            let link = self.multibody_joints.rigid_body_link(body)?;
            Some((*joint, link.multibody, link.id, usize::from(joint.axis?)))
        };
        let Some((follows, tree, link2, axis2)) = found(follower) else { return false };
        let Some((leads, tree_of_leader, link1, axis1)) = found(leader) else { return false };
        if tree != tree_of_leader || link1 == link2 {
            return false;
        }
        let Some(multibody) = self.multibody_joints.get_multibody_mut(tree) else { return false };
        if let (JointPlace::Reduced(number), JointPlace::Reduced(leader)) = (follower.0, leader.0)
            && let Some(joint) = self.reduced.joints.get_mut(&number)
        {
            joint.follows = Some(Coupling { leader, multiplier, offset });
        }
        multibody.retain_dof_couplings(|known| known.link2 != link2);
        multibody.add_dof_coupling(MultibodyDofCoupling {
            link1,
            dof1: 0,
            axis1,
            link2,
            dof2: 0,
            axis2,
            coeff: multiplier as Real,
            offset: (multiplier * leads.start + offset - follows.start) as Real,
        });
        true
    }

    pub(super) fn part_reduced(&mut self, number: u32) {
        match self.reduced.joints.remove(&number).map(|joint| joint.place) {
            Some(ReducedPlace::Above(body)) => {
                self.multibody_joints.remove(MultibodyJointHandle(body.0), true);
            }
            Some(ReducedPlace::Impulses(handle)) => {
                self.joints.remove(handle, true);
            }
            None => {}
        }
    }

    /// Forgets joints that ended with a body.
    pub(super) fn forget_parted_joints(&mut self) {
        let (trees, joints) = (&self.multibody_joints, &self.joints);
        self.reduced.joints.retain(|_, joint| match joint.place {
            ReducedPlace::Above(body) => {
                trees.rigid_body_link(body).is_some_and(|link| link.id > 0)
            }
            ReducedPlace::Impulses(handle) => joints.get(handle).is_some(),
        });
    }

    /// A body that ceases to be dynamic is no link of a tree any more: its joint becomes one of
    /// impulses.
    pub(super) fn leave_coordinates(&mut self, body: BodyIndex) {
        let child = self.handle(body);
        let above = self.reduced.joints.iter().find(|(_, j)| j.place == ReducedPlace::Above(child));
        let Some((&number, joint)) = above else { return };
        let Some((tree, id)) = self.multibody_joints.get(MultibodyJointHandle(child.0)) else {
            return;
        };
        let Some(link) = tree.link(id) else { return };
        let Some(parent) = link.parent_id().and_then(|parent| tree.link(parent)) else { return };
        let (parent, data) = (parent.rigid_body_handle(), link.joint.data);
        let joint = *joint;
        self.multibody_joints.remove(MultibodyJointHandle(child.0), true);
        let place = ReducedPlace::Impulses(self.joints.insert(parent, child, data, true));
        self.reduced.joints.insert(number, ReducedJoint { place, ..joint });
        self.drive_impulses(number);
    }

    fn drive_impulses(&mut self, number: u32) {
        let Some(joint) = self.reduced.joints.get(&number).copied() else { return };
        let ReducedPlace::Impulses(handle) = joint.place else { return };
        let Some(axis) = joint.axis.and_then(axis_of) else { return };
        if let Some(known) = self.joints.get_mut(handle, true) {
            match joint.motor {
                Some(motor) => set_impulse_motor(&mut known.data, axis, motor, joint.start),
                None => known.data.motor_axes.remove(axis.into()),
            }
        }
    }
}

/// Positions and velocities.
impl Simulation {
    /// The position of a joint of one coordinate: radians or units of length. That of a hinge which
    /// is a constraint between its bodies is known up to whole turns: it is within half a turn.
    #[must_use]
    pub fn joint_position(&self, joint: JointIndex) -> Option<f64> {
        self.joint_position_near(joint, 0.0)
    }

    /// The same; where whole turns are open, the position nearest to this one.
    #[must_use]
    pub fn joint_position_near(&self, joint: JointIndex, near: f64) -> Option<f64> {
        let (place, axis, start) = match joint.0 {
            JointPlace::Impulses(handle) => (ReducedPlace::Impulses(handle), None, 0.0),
            JointPlace::Reduced(number) => {
                let joint = self.reduced.joints.get(&number)?;
                (joint.place, joint.axis, joint.start)
            }
        };
        let coordinate = match place {
            ReducedPlace::Above(body) => {
                let link = self.multibody_joints.rigid_body_link(body)?;
                let link = self.multibody_joints.get_multibody(link.multibody)?.link(link.id)?;
                f64::from(link.joint.coords()[usize::from(axis?)])
            }
            ReducedPlace::Impulses(handle) => self.between(handle, near - start)?,
        };
        Some(start + coordinate)
    }

    /// Whether the motor of a joint in reduced coordinates was at its greatest effort at the
    /// beginning of the last step, so that it could not do what was required.
    #[must_use]
    pub fn is_strained(&self, joint: JointIndex) -> bool {
        let JointPlace::Reduced(number) = joint.0 else { return false };
        self.reduced.joints.get(&number).is_some_and(|joint| joint.strained)
    }

    /// The position of a joint of impulses, from its bodies: a hinge's is within half a turn of
    /// `near`.
    fn between(&self, handle: ImpulseJointHandle, near: f64) -> Option<f64> {
        let joint = self.joints.get(handle)?;
        let locked = joint.data.locked_axes;
        let spec = if locked == JointAxesMask::LOCKED_REVOLUTE_AXES {
            JointSpec::Revolute { axis: DVec3::X, limits: None, motor: None }
        } else if locked == JointAxesMask::LOCKED_PRISMATIC_AXES {
            JointSpec::Prismatic { axis: DVec3::X, limits: None, motor: None }
        } else {
            return None;
        };
        let frame = |body, local: &RapierPose| {
            let body = pose_from_rapier(self.bodies.get(body)?.position());
            Some(body.compose(&pose_from_rapier(local)))
        };
        let first = frame(joint.body1(), &joint.data.local_frame1)?;
        let second = frame(joint.body2(), &joint.data.local_frame2)?;
        Some(position(&spec, &[first, second], near))
    }

    /// The root of a tree has the velocity that its body was given.
    pub(super) fn take_velocity_of_root(&mut self, body: BodyIndex) {
        let handle = self.handle(body);
        let Some(link) = self.multibody_joints.rigid_body_link(handle).copied() else { return };
        let rigid = &self.bodies[handle];
        let velocity = [rigid.linvel(), rigid.angvel()];
        let Some(tree) = self.multibody_joints.get_multibody_mut(link.multibody) else { return };
        if link.id == 0 && tree.root().joint.ndofs() == 6 {
            let [linear, angular] = velocity.map(|v| v.to_array());
            let mut coordinates = tree.generalized_velocity_mut();
            for (i, value) in linear.into_iter().chain(angular).enumerate() {
                coordinates[i] = value;
            }
        }
    }

    /// An impulse on a link changes the velocities of all joints of its tree.
    pub(super) fn push_coordinates(&mut self, body: BodyIndex, linear: Vector, angular: Vector) {
        let handle = self.handle(body);
        let Some(link) = self.multibody_joints.rigid_body_link(handle).copied() else { return };
        self.see_masses();
        let Some(tree) = self.multibody_joints.get_multibody_mut(link.multibody) else { return };
        tree.forward_kinematics(&self.bodies, true);
        let inverse = tree.dof_inverse_inertia(&self.bodies); // fills the mass matrix as well
        let mut change = inverse * 0.0;
        let jacobian = tree.body_jacobian(link.id);
        let impulse: Vec<Real> = linear.to_array().into_iter().chain(angular.to_array()).collect();
        for (row, push) in impulse.into_iter().enumerate() {
            for column in 0..change.len() {
                change[column] += jacobian[(row, column)] * push;
            }
        }
        if tree.inv_augmented_mass().solve_mut(&mut change) {
            let mut velocity = tree.generalized_velocity_mut();
            velocity += &change;
        }
    }
}

/// The position of a joint whose frames are given in the world, nearest to a value.
fn position(spec: &JointSpec, [first, second]: &[Pose; 2], near: f64) -> f64 {
    let back = first.rotation.conjugate();
    let relative = Pose {
        rotation: back * second.rotation,
        translation: back * (second.translation - first.translation),
    };
    match *spec {
        JointSpec::Prismatic { axis, .. } => relative.translation.dot(axis),
        JointSpec::Revolute { axis, .. } => {
            let turn = relative.rotation;
            let along = DVec3::new(turn.x, turn.y, turn.z).dot(axis);
            let angle = 2.0 * along.atan2(turn.w);
            let turns = ((near - angle) / std::f64::consts::TAU).round();
            angle + std::f64::consts::TAU * turns
        }
        _ => 0.0,
    }
}

fn axis_of(number: u8) -> Option<JointAxis> {
    [JointAxis::LinX, JointAxis::AngX].into_iter().find(|&axis| axis as u8 == number)
}
