//! Joints in reduced coordinates: a tree of bodies moves by the positions of its joints alone, so
//! that no joint yields, and its motors are solved together.
//!
//! rapier's multibodies do this (Featherstone 2008; the motors are their joint springs, which are
//! solved with the mass matrix by backward Euler). Before each step [`Simulation::drive_joints`]
//! says anew what spring, damping and friction each joint has: the default spring has one natural
//! frequency for what the joint carries with all others held, and a motor at its greatest effort
//! is a softer spring, so that damping stays implicit.
//!
//! rapier's motors as rows of constraints (`set_motor`) hold as well where their gains are these,
//! and throw the arm about where they are softer; springs do neither, and need no sweeps.

use std::collections::BTreeMap;

use cranny_exact::{DVec3, Pose};
use rapier3d::math::{Pose as RapierPose, Real, Vector};
use rapier3d::prelude::{
    ImpulseJointHandle, JointAxesMask, JointAxis, Multibody, MultibodyDofCoupling, MultibodyIndex,
    MultibodyJointHandle, MultibodyJointSet, RigidBodyHandle, RigidBodySet,
};

use super::{BodyIndex, Simulation};
use crate::convert::pose_from_rapier;
use crate::joint::{
    APPROACH, JointIndex, JointPlace, JointSpec, Motor, generic_joint, set_impulse_motor,
};

/// Natural frequency of a motor's default spring, radians a second. Slower: the end of a finger of
/// 2 cm sags by more than a thousandth of a radian; faster: the spring outweighs the mass matrix
/// in single precision at steps of 1/60 s.
const NATURAL_FREQUENCY: f64 = 800.0;

/// Stiffness of a spring that stands for a constant effort, per unit of it: the spring's rest is so
/// far away that no motion of a step changes what it pulls. Stiffer: the effort fades as the joint
/// gives way; softer: its rest has no digits left in single precision.
const SOFTNESS: f64 = 1e-3;

/// A motor that is farther from its position keeps its tree awake, radians or units of length.
/// Smaller: an arm that sags by its weight never sleeps; larger: one that creeps falls asleep on
/// its way.
const NEAR: f64 = 2e-3;

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
    /// impulses.
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
        let dynamic = self.bodies[second].is_dynamic();
        let taken =
            dynamic.then(|| self.multibody_joints.insert(first, second, data, true)).flatten();
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
    /// The position of a joint of one coordinate: radians or units of length.
    #[must_use]
    pub fn joint_position(&self, joint: JointIndex) -> Option<f64> {
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
            ReducedPlace::Impulses(handle) => self.between(handle)?,
        };
        Some(start + coordinate)
    }

    /// Whether the motor of a joint in reduced coordinates was at its greatest effort at the
    /// beginning of the last step, so that it could not do what it was asked.
    #[must_use]
    pub fn is_strained(&self, joint: JointIndex) -> bool {
        let JointPlace::Reduced(number) = joint.0 else { return false };
        self.reduced.joints.get(&number).is_some_and(|joint| joint.strained)
    }

    /// The position of a joint of impulses, from its bodies: a hinge's within half a turn.
    fn between(&self, handle: ImpulseJointHandle) -> Option<f64> {
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
        Some(position(&spec, &[first, second], 0.0))
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

/// Motors.
impl Simulation {
    /// Says what drives and what resists each joint in the coming step.
    pub(super) fn drive_joints(&mut self) {
        if self.reduced.joints.is_empty() {
            return;
        }
        if self.joined {
            self.see_masses();
        }
        let mut busy = Vec::new();
        for (index, joints) in self.reduced.by_tree(&self.multibody_joints) {
            let Some(tree) = self.multibody_joints.get_multibody_mut(index) else { continue };
            if self.joined || tree.body_jacobian(0).ncols() != tree.ndofs() {
                tree.forward_kinematics(&self.bodies, true);
            }
            let length = self.options.length_unit;
            let step = f64::from(self.parameters.dt);
            let (carried, firsts) = (carried(tree, &self.bodies), first_coordinates(tree));
            for DrivenLink { link, number, joint } in joints {
                let first = firsts[link];
                resist(tree, link, first, joint.resistance);
                let Some(axis) = joint.axis.map(usize::from) else { continue };
                let velocity = f64::from(tree.generalized_velocity()[first]);
                let Some(known) = tree.link_mut(link) else { continue };
                let now = Now {
                    position: f64::from(known.joint.coords()[axis]) + joint.start,
                    velocity,
                    carried: carried[first],
                    approach: if axis < 3 { APPROACH * length } else { APPROACH },
                    step,
                };
                let spring = joint.motor.map_or(Spring::default(), |motor| motor.spring(&now));
                let rest = spring.rest - joint.start;
                known.joint.set_spring(axis, spring.stiffness as Real, rest as Real);
                if joint.motor.is_some_and(|motor| motor.is_busy(&now)) {
                    busy.push(known.rigid_body_handle());
                }
                tree.damping_mut()[first] += spring.damping as Real;
                if let Some(known) = self.reduced.joints.get_mut(&number) {
                    known.strained = spring.strained;
                }
            }
        }
        for link in busy {
            if let Some(body) = self.bodies.get_mut(link) {
                body.wake_up(true);
            }
        }
    }

    /// rapier sees the masses of bodies that were inserted within its step only.
    fn see_masses(&mut self) {
        let links = self.multibody_joints.multibodies().flat_map(Multibody::links);
        for handle in links.map(|link| link.rigid_body_handle()) {
            if let Some(body) = self.bodies.get_mut(handle) {
                body.recompute_mass_properties_from_colliders(&self.colliders);
            }
        }
    }
}

/// A joint of a tree, with what drives it.
struct DrivenLink {
    /// The child's number in the tree.
    link: usize,
    /// The joint's.
    number: u32,
    joint: ReducedJoint,
}

/// Damping and friction of all coordinates of a link's joint.
fn resist(tree: &mut Multibody, link: usize, first: usize, resistance: Resistance) {
    let count = tree.link(link).map_or(0, |link| link.joint.ndofs());
    for coordinate in first..first + count {
        tree.frictions_mut()[coordinate] = resistance.friction as Real;
        tree.damping_mut()[coordinate] = resistance.damping as Real;
    }
}

impl ReducedJoints {
    /// Joints that are coordinates, tree by tree.
    fn by_tree(&self, trees: &MultibodyJointSet) -> Vec<(MultibodyIndex, Vec<DrivenLink>)> {
        let mut found: Vec<(MultibodyIndex, Vec<DrivenLink>)> = Vec::new();
        for (&number, joint) in &self.joints {
            let ReducedPlace::Above(body) = joint.place else { continue };
            let Some(link) = trees.rigid_body_link(body) else { continue };
            let joint = ReducedJoint { motor: self.motor_of(joint, self.joints.len()), ..*joint };
            let driven = DrivenLink { link: link.id, number, joint };
            match found.iter_mut().find(|(tree, _)| *tree == link.multibody) {
                Some((_, joints)) => joints.push(driven),
                None => found.push((link.multibody, vec![driven])),
            }
        }
        found
    }

    /// What drives a joint: its motor, or one that keeps up with what it follows, through so many
    /// joints at most. A joint whose leader is gone has its own motor again.
    fn motor_of(&self, joint: &ReducedJoint, through: usize) -> Option<Motor> {
        let Some(Coupling { leader, multiplier, offset }) = joint.follows else {
            return joint.motor;
        };
        let Some(leader) = self.joints.get(&leader) else { return joint.motor };
        let leader = self.motor_of(leader, through.checked_sub(1)?)?;
        let position = leader.position.filter(|_| leader.stiffness.is_none())?;
        Some(Motor {
            position: Some(multiplier * position + offset),
            velocity: multiplier * leader.velocity,
            max_effort: joint.motor.and_then(|motor| motor.max_effort),
            max_velocity: Some(leader.max_velocity.unwrap_or(APPROACH) * multiplier.abs())
                .filter(|most| *most > 0.0),
            ..Motor::default()
        })
    }
}

/// A joint before a step.
struct Now {
    position: f64,
    velocity: f64,
    /// Mass, or inertia about the axis, of all that it carries.
    carried: f64,
    /// Velocity with which a motor approaches its position where none is stated.
    approach: f64,
    /// Seconds.
    step: f64,
}

/// Pulls by `stiffness * (rest - q) - damping * q'`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Spring {
    stiffness: f64,
    rest: f64,
    damping: f64,
    /// Whether it is softer than the motor asks.
    strained: bool,
}

impl Motor {
    /// Whether it has yet to move its joint.
    fn is_busy(&self, now: &Now) -> bool {
        let away = self.position.map_or(0.0, |position| position - now.position);
        self.velocity != 0.0 || self.effort != 0.0 || away.abs() > NEAR
    }

    /// The spring that is this motor in the coming step.
    fn spring(&self, now: &Now) -> Spring {
        let position = self.position.unwrap_or(now.position);
        let stiffness = match self.position {
            Some(_) => self.stiffness.unwrap_or(now.carried * NATURAL_FREQUENCY.powi(2)),
            None => 0.0,
        };
        let critical = match self.position {
            Some(_) => 2.0 * (stiffness * now.carried).sqrt(),
            None => now.carried * NATURAL_FREQUENCY,
        };
        // A motor that only pushes does not brake.
        let pushes = self.position.is_none() && self.velocity == 0.0 && self.effort != 0.0;
        let damping = self.damping.unwrap_or(if pushes { 0.0 } else { critical });
        let mut away = position - now.position;
        let mut velocity = self.velocity;
        let mut stiffness = stiffness;
        let limited = self.stiffness.is_none() || self.max_velocity.is_some();
        if limited && stiffness > 0.0 && damping > 0.0 {
            let fastest = self.max_velocity.unwrap_or(now.approach);
            let lag = damping / stiffness;
            if away.abs() > fastest * (lag + now.step) {
                (velocity, stiffness) = (fastest.copysign(away), 0.0);
            } else {
                let most = fastest * lag.max(now.step);
                away = away.clamp(-most, most);
            }
        }
        let pull = stiffness * away + damping * velocity + self.effort;
        let demanded = pull - damping * now.velocity;
        // At its greatest effort a motor is a softer one.
        let share = match self.max_effort {
            Some(most) if demanded.abs() > most => most / demanded.abs(),
            _ => 1.0,
        };
        let stiff = if stiffness > 0.0 { stiffness } else { SOFTNESS * pull.abs() };
        let rest = if stiff > 0.0 { now.position + pull / stiff } else { now.position };
        Spring { stiffness: share * stiff, rest, damping: share * damping, strained: share < 1.0 }
    }
}

/// For each coordinate of a tree what it carries, all others held.
fn carried(tree: &Multibody, bodies: &RigidBodySet) -> Vec<f64> {
    let mut carried = vec![0.0; tree.ndofs()];
    for (id, link) in tree.links().enumerate() {
        let Some(body) = bodies.get(link.rigid_body_handle()) else { continue };
        let mass = f64::from(body.mass());
        let inertia = body.mass_properties().effective_angular_inertia();
        let jacobian = tree.body_jacobian(id);
        for (coordinate, sum) in carried.iter_mut().enumerate() {
            let column = |row: usize| jacobian[(row, coordinate)];
            let linear = Vector::new(column(0), column(1), column(2));
            let angular = Vector::new(column(3), column(4), column(5));
            *sum += mass * f64::from(linear.length_squared());
            *sum += f64::from(angular.dot(inertia * angular));
        }
    }
    carried
}

/// The first coordinate of each link of a tree.
fn first_coordinates(tree: &Multibody) -> Vec<usize> {
    let counts = tree.links().map(|link| link.joint.ndofs());
    counts.scan(0, |next, count| Some(std::mem::replace(next, *next + count))).collect()
}

/// The position of a joint whose frames are given in the world, nearest to a value.
fn position(spec: &JointSpec, [first, second]: &[Pose; 2], near: f64) -> f64 {
    let back = first.rotation.conjugate();
    let relative = Pose {
        rotation: back * second.rotation,
        translation: back * (second.translation - first.translation),
    };
    match *spec {
        JointSpec::Fixed | JointSpec::Planar { .. } => 0.0,
        JointSpec::Prismatic { axis, .. } => relative.translation.dot(axis),
        JointSpec::Revolute { axis, .. } => {
            let turn = relative.rotation;
            let along = DVec3::new(turn.x, turn.y, turn.z).dot(axis);
            let angle = 2.0 * along.atan2(turn.w);
            let turns = ((near - angle) / std::f64::consts::TAU).round();
            angle + std::f64::consts::TAU * turns
        }
    }
}

fn axis_of(number: u8) -> Option<JointAxis> {
    [JointAxis::LinX, JointAxis::AngX].into_iter().find(|&axis| axis as u8 == number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn now() -> Now {
        Now { position: 0.25, velocity: 0.5, carried: 2.0, approach: 3.0, step: 1.0 / 240.0 }
    }

    fn pull(spring: Spring, now: &Now) -> f64 {
        spring.stiffness * (spring.rest - now.position) - spring.damping * now.velocity
    }

    #[test]
    fn a_motor_of_given_gains_pulls_by_its_formula() {
        let motor = Motor {
            position: Some(1.0),
            velocity: 2.0,
            effort: 3.0,
            stiffness: Some(100.0),
            damping: Some(10.0),
            ..Motor::default()
        };
        let by_hand = 100.0 * 0.75 + 10.0 * (2.0 - 0.5) + 3.0;
        assert!((pull(motor.spring(&now()), &now()) - by_hand).abs() < 1e-9);
    }

    #[test]
    fn a_motor_pulls_no_harder_than_it_can() {
        let motor = Motor { max_effort: Some(7.0), ..Motor::at(1.0) };
        assert!((pull(motor.spring(&now()), &now()) - 7.0).abs() < 1e-9);
        let motor = Motor { max_effort: Some(7.0), ..Motor::at(-1.0) };
        assert!((pull(motor.spring(&now()), &now()) + 7.0).abs() < 1e-9);
    }

    #[test]
    fn a_constant_effort_does_not_depend_on_the_motion() {
        let motor = Motor { effort: -4.0, ..Motor::default() };
        let spring = motor.spring(&now());
        assert_eq!(spring.damping, 0.0);
        let later = Now { position: 0.35, velocity: -9.0, ..now() };
        assert!((pull(spring, &now()) + 4.0).abs() < 1e-9);
        assert!((pull(spring, &later) + 4.0).abs() < 1e-3);
    }

    #[test]
    fn a_far_position_is_approached_at_the_greatest_velocity() {
        let motor = Motor { max_velocity: Some(0.5), ..Motor::at(50.0) };
        // At that velocity nothing pulls any more.
        assert!(pull(motor.spring(&now()), &now()).abs() < 1e-6);
        let slow = Now { velocity: 0.25, ..now() };
        let critical = 2.0 * slow.carried * NATURAL_FREQUENCY;
        assert!((pull(motor.spring(&slow), &slow) - 0.25 * critical).abs() < 1e-6);
    }
}
