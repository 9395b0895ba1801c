//! Kinematic bodies that no solver moves: they follow their velocities.

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::Insert;
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_exact::{DVec3, Pose};
use cranny_primitives::BodyShape;
use cranny_world::description::BodyKind;
use glam::DQuat;

use crate::body::{Bodies, Body, pose_of, transform_of, widened};
use crate::clock::{CrannyStep, SimulatedTime, StepSystems};
use crate::effects::{EffectKind, EffectTable};
use crate::properties::{AngularVelocity, LinearVelocity};

/// The systems of kinematic motion without a solver.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KinematicsSystems {
    /// Velocity to `Transform`, at the end of the step.
    Move,
}

/// A body that moves by its velocities alone, about its centre of mass: present beside
/// [`Body`] where a body is kinematic and the solver does not have it.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Kinematic {
    /// In the body's frame.
    pub center: DVec3,
}

impl Kinematic {
    pub(crate) fn of(shape: &BodyShape) -> Self {
        Self { center: shape.center() }
    }
}

/// Moves kinematic bodies that the solver does not have.
#[derive(Clone, Copy, Debug, Default)]
pub struct KinematicsPlugin;

impl Plugin for KinematicsPlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(mark);
        app.add_systems(
            CrannyStep,
            follow_velocities.in_set(StepSystems::Advance).in_set(KinematicsSystems::Move),
        );
    }
}

fn mark(
    inserted: On<Insert<Body>>,
    query: Query<&Body>,
    bodies: Res<Bodies>,
    effects: Res<EffectTable>,
    #[cfg(feature = "rapier")] solver: Option<Res<crate::solved::RigidBodies>>,
    mut commands: Commands,
) {
    let Ok(&Body { id }) = query.get(inserted.entity) else { return };
    let Some(record) = bodies.get(id) else { return };
    let solved = effects.has_plugin(EffectKind::Response) && effects.responds(id);
    #[cfg(feature = "rapier")]
    let solved = solved || solver.is_some_and(|solver| solver.index(id).is_some());
    let mut entity = commands.entity(inserted.entity);
    if record.kind == BodyKind::Kinematic && !solved {
        entity.insert(Kinematic::of(&record.shape));
    } else {
        entity.try_remove::<Kinematic>();
    }
}

fn follow_velocities(
    mut bodies: Query<(&Kinematic, &LinearVelocity, &AngularVelocity, &mut Transform), With<Body>>,
    time: Res<SimulatedTime>,
) {
    for (kinematic, linear, angular, mut transform) in &mut bodies {
        let velocities = [linear.0, angular.0].map(widened);
        if velocities == [DVec3::ZERO; 2] {
            continue;
        }
        let moved = moved(&pose_of(&transform), kinematic.center, velocities, time.step());
        let scale = transform.scale;
        *transform = Transform { scale, ..transform_of(&moved) };
    }
}

/// The pose after `dt` seconds at constant velocity of the centre and constant spin.
pub(crate) fn moved(pose: &Pose, center: DVec3, [linear, angular]: [DVec3; 2], dt: f64) -> Pose {
    let turned = DQuat::from_scaled_axis(dt * angular) * pose.rotation;
    let rotation = turned * (1.0 / turned.length());
    let center_in_world = pose.world_from_body().apply(center) + dt * linear;
    let arm = Pose { rotation, translation: DVec3::ZERO }.world_from_body().apply(center);
    Pose { rotation, translation: center_in_world - arm }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centre_moves_straight_and_the_body_turns_about_it() {
        let velocities = [DVec3::X, DVec3::Z];
        let center = DVec3::new(0.0, 2.0, 0.0);
        let mut pose = Pose::IDENTITY;
        for _ in 0..100 {
            pose = moved(&pose, center, velocities, 0.01);
        }
        let at = pose.world_from_body().apply(center);
        assert!((at - DVec3::new(1.0, 2.0, 0.0)).length() < 1e-12);
        let expected = DQuat::from_scaled_axis(DVec3::Z);
        assert!(pose.rotation.dot(expected).abs() > 1.0 - 1e-12);
    }
}
