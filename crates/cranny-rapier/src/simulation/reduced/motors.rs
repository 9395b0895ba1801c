//! What drives and resists joints that are coordinates: springs of a tree's mass matrix.
//!
//! Before each step [`Simulation::drive_joints`] says anew what spring, damping and friction each
//! joint has: the default spring has one natural frequency for what the joint carries with all
//! others held, and a motor at its greatest effort is a softer spring, so that damping stays
//! implicit.
//!
//! rapier's motors as rows of constraints (`set_motor`) hold as well where their gains are these,
//! and throw the arm about where they are softer; springs do neither, and need no sweeps.

use rapier3d::math::{Real, Vector};
use rapier3d::prelude::{Multibody, MultibodyIndex, MultibodyJointSet, RigidBodySet};

use super::{Coupling, ReducedJoint, ReducedJoints, ReducedPlace, Resistance};
use crate::joint::{APPROACH, Motor};
use crate::simulation::Simulation;

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

/// Motors.
impl Simulation {
    /// Says what drives and what resists each joint in the coming step.
    pub(in crate::simulation) fn drive_joints(&mut self) {
        if self.reduced.is_empty() {
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
    pub(super) fn see_masses(&mut self) {
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
    /// Whether it is softer than the motor requires.
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
