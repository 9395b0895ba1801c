//! Kinematic bodies that no solver moves: they follow the velocity that the scene gives them.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_exact::{DVec3, Pose};
use cranny_geometry::Model;
use cranny_world::BodyId;
use glam::DQuat;

use crate::body::{Bodies, Body, Velocity, narrowed, pose_of, transform_of, widened};
use crate::clock::{CrannyStep, SimulatedTime, StepSystems};

/// The systems of kinematic motion without a solver.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KinematicsSystems {
    /// Velocity to `Transform`, at the end of the step.
    Move,
}

/// A body that moves by its velocity alone, about its centre of mass.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Kinematic {
    /// In the body's frame.
    pub center: DVec3,
}

/// Moves some bodies by their velocities.
#[derive(Clone, Debug)]
pub struct KinematicsPlugin {
    /// Which, with linear and angular velocity in world coordinates.
    pub bodies: Vec<(BodyId, DVec3, DVec3)>,
}

impl Plugin for KinematicsPlugin {
    fn build(&self, app: &mut App) {
        for &(id, linear, angular) in &self.bodies {
            let Some(record) = app.world().resource::<Bodies>().get(id) else { continue };
            let (entity, center) = (record.entity, center_of_mass(&record.model));
            app.world_mut().entity_mut(entity).insert((
                Kinematic { center },
                Velocity { linear: narrowed(linear), angular: narrowed(angular) },
            ));
        }
        app.add_systems(
            CrannyStep,
            follow_velocities.in_set(StepSystems::Advance).in_set(KinematicsSystems::Move),
        );
    }
}

/// The centre of the solid; of the bounds where the mesh is open.
fn center_of_mass(model: &Model) -> DVec3 {
    model.mass_properties().map_or_else(|| model.bounds().center(), |mass| mass.center)
}

fn follow_velocities(
    mut bodies: Query<(&Kinematic, &Velocity, &mut Transform), With<Body>>,
    time: Res<SimulatedTime>,
) {
    for (kinematic, velocity, mut transform) in &mut bodies {
        let pose = pose_of(&transform);
        let moved = moved(&pose, kinematic.center, velocity, time.step());
        let scale = transform.scale;
        *transform = Transform { scale, ..transform_of(&moved) };
    }
}

/// The pose after `dt` seconds at constant velocity of the centre and constant spin.
fn moved(pose: &Pose, center: DVec3, velocity: &Velocity, dt: f64) -> Pose {
    let (linear, angular) = (widened(velocity.linear), widened(velocity.angular));
    let turned = DQuat::from_scaled_axis(dt * angular) * pose.rotation;
    let rotation = turned * (1.0 / turned.length());
    let center_in_world = pose.world_from_body().apply(center) + dt * linear;
    let arm = Pose { rotation, translation: DVec3::ZERO }.world_from_body().apply(center);
    Pose { rotation, translation: center_in_world - arm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_math::Vec3;

    #[test]
    fn the_centre_moves_straight_and_the_body_turns_about_it() {
        let velocity = Velocity { linear: Vec3::X, angular: Vec3::Z };
        let center = DVec3::new(0.0, 2.0, 0.0);
        let mut pose = Pose::IDENTITY;
        for _ in 0..100 {
            pose = moved(&pose, center, &velocity, 0.01);
        }
        let at = pose.world_from_body().apply(center);
        assert!((at - DVec3::new(1.0, 2.0, 0.0)).length() < 1e-12);
        let expected = DQuat::from_scaled_axis(DVec3::Z);
        assert!(pose.rotation.dot(expected).abs() > 1.0 - 1e-12);
    }
}
