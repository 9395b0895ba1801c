//! Bodies and joints that follow keyframed paths.
//!
//! A kinematic body gets in each step the velocities that lead to where the path is at the step's
//! end, so that it pushes as fast as it goes. A joint's motor gets position and velocity of then.

use std::sync::Arc;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_exact::{DVec3, Pose};
use cranny_world::BodyId;
#[cfg(feature = "rapier")]
use cranny_world::description::Motor;
use cranny_world::description::{KeyframedPath, MotorPath};

use crate::body::{Bodies, Body, narrowed, pose_of, transform_of};
use crate::clock::{CoreSystems, CrannyStep, SimulatedTime, StepSystems};
#[cfg(feature = "rapier")]
use crate::joints::Joint;
use crate::kinematics::Kinematic;
use crate::properties::{AngularVelocity, LinearVelocity, RigidBody};

/// The systems of paths.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PathSystems {
    /// Paths to velocities and to targets of motors, at the beginning of the step.
    Lead,
}

/// A path that a kinematic body follows: it writes the body's [`LinearVelocity`] and
/// [`AngularVelocity`] in each step. On bodies of another kind it does nothing.
///
/// At the end of each step the body is where the path is, to the rounding of `Transform`s, wherever
/// it was before. Where a looping path jumps, the body does: its `Transform` is set, and for that
/// step it has no velocity.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct FollowsPath {
    /// In world coordinates.
    pub path: Arc<KeyframedPath>,
    /// When the path begins, seconds of [`SimulatedTime`].
    pub since: f64,
}

/// A path along which the motor of a [`Joint`] leads: it writes the motor's position and velocity
/// in each step. All else of the motor, as gains and limits, stays as it is.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct FollowsMotorPath {
    /// Of the joint's positions.
    pub path: Arc<MotorPath>,
    /// When the path begins, seconds of [`SimulatedTime`].
    pub since: f64,
}

/// Leads kinematic bodies along their paths.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathPlugin;

impl Plugin for PathPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            CrannyStep,
            lead.run_if(any_with_component::<FollowsPath>)
                .in_set(PathSystems::Lead)
                .in_set(StepSystems::Admit)
                .after(CoreSystems::Admit),
        );
    }
}

/// A kinematic body that is led, if it is one.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Led {
    body: &'static Body,
    kind: &'static RigidBody,
    transform: &'static mut Transform,
    linear: &'static mut LinearVelocity,
    angular: &'static mut AngularVelocity,
    unsolved: Option<&'static Kinematic>,
}

impl LedItem<'_, '_> {
    pub(crate) fn id(&self) -> BodyId {
        self.body.id
    }
}

/// What leads kinematic bodies.
#[derive(SystemParam)]
pub(crate) struct Steering<'w> {
    bodies: Res<'w, Bodies>,
    time: Res<'w, SimulatedTime>,
    #[cfg(feature = "rapier")]
    solver: Option<Res<'w, crate::solved::RigidBodies>>,
}

impl Steering<'_> {
    /// Gives a body the velocities that lead to a pose by the end of the step; where it jumps, its
    /// `Transform` is set in their place. Bodies of other kinds are left alone.
    pub(crate) fn lead(&self, mut led: LedItem<'_, '_>, target: &Pose, jumps: bool) {
        if *led.kind != RigidBody::Kinematic {
            return;
        }
        let center = led.unsolved.map(|kinematic| kinematic.center);
        #[cfg(feature = "rapier")]
        let center = center.or_else(|| self.solver.as_ref()?.center_of_mass(led.body.id));
        let Some(center) = center else { return };
        if jumps {
            let scale = led.transform.scale;
            led.transform.set_if_neq(Transform { scale, ..transform_of(target) });
        }
        let reach = self.bodies.get(led.body.id).map_or(0.0, |record| record.extent());
        let from = pose_of(&led.transform);
        let [v, w] = if has_arrived(&from, target, reach) {
            [DVec3::ZERO; 2]
        } else {
            velocities(&from, target, center, self.time.step())
        };
        led.linear.set_if_neq(LinearVelocity(narrowed(v)));
        led.angular.set_if_neq(AngularVelocity(narrowed(w)));
    }
}

fn lead(mut led: Query<(Led, &FollowsPath)>, time: Res<SimulatedTime>, steering: Steering) {
    for (led, follows) in &mut led {
        let (now, dt) = (time.seconds() - follows.since, time.step());
        let target = follows.path.pose_at(now + dt);
        steering.lead(led, &target, !follows.path.is_continuous(now, now + dt));
    }
}

/// Leads motors along their paths; the solver's, which alone has joints.
#[cfg(feature = "rapier")]
pub(crate) fn lead_motors(
    joints: Query<(Entity, &Joint, &FollowsMotorPath)>,
    time: Res<SimulatedTime>,
    mut commands: Commands,
) {
    for (entity, &joint, FollowsMotorPath { path, since }) in &joints {
        let at = time.seconds() + time.step() - since;
        let (position, velocity) = (Some(path.position_at(at)), path.velocity_at(at));
        let led = Motor { position, velocity, ..joint.motor.unwrap_or_default() };
        if joint.motor != Some(led) {
            commands.entity(entity).insert(Joint { motor: Some(led), ..joint });
        }
    }
}

/// A body this near its path (in rounding errors of its coordinates) is where it should be.
/// Smaller: a body that waits is moved to and fro by a rounding error, and wakes what it
/// touches; larger: it lags behind a slow path.
const ROUNDINGS: f64 = 4.0;

fn has_arrived(from: &Pose, to: &Pose, reach: f64) -> bool {
    let bound = ROUNDINGS * f64::from(f32::EPSILON);
    let size = to.translation.abs().max_element() + reach;
    // Half the sine of half the angle, nearly.
    let turn = (from.rotation.conjugate() * to.rotation).xyz().length();
    from.translation.distance(to.translation) <= bound * size && turn <= bound
}

/// The velocities that lead from one pose to another in `dt` seconds; the linear one is that of the
/// centre of mass, given in the body's frame.
pub(crate) fn velocities(from: &Pose, to: &Pose, center: DVec3, dt: f64) -> [DVec3; 2] {
    let at = |pose: &Pose| pose.world_from_body().apply(center);
    let turn = to.rotation * from.rotation.conjugate();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    [(at(to) - at(from)) / dt, turn.to_scaled_axis() / dt]
}
