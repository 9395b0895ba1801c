//! Bodies as entities, and the one place where a body is: its `Transform`.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_world::BodyId;
use cranny_world::description::{BodyKind, Normals, SceneDescription};
use glam::DQuat;

use crate::error::SceneAppError;

/// An entity that is a body of the scene.
///
/// Its `Transform` is the single truth about where it is: every query, recording and picture reads
/// it through [`pose_of`], and whoever moves it, moves the body. A `Transform` must not scale.
/// Despawning the entity, or removing this component, takes the body out of everything.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[require(Transform)]
pub struct Body {
    /// Stable: the position in the scene. Orders everything that is reported.
    pub id: BodyId,
}

/// Velocities as the solver (or, of a kinematic body, the scene) has them; to be read, not written.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Of the centre of mass, units a second.
    pub linear: Vec3,
    /// Radians a second, world axes.
    pub angular: Vec3,
}

/// What does not change about a body.
#[derive(Clone, Debug)]
pub struct BodyRecord {
    /// Its entity (whether or not it still exists).
    pub entity: Entity,
    /// Unique.
    pub name: String,
    /// Collision geometry.
    pub model: Model,
    /// Geometry to draw, where it differs from the model's mesh.
    pub visual: Option<Arc<Mesh>>,
    /// How it moves.
    pub kind: BodyKind,
    /// Mass per volume.
    pub density: f64,
    /// Whose normals its contacts have for the solver.
    pub normals: Normals,
}

/// All bodies by id, those that were removed included.
#[derive(Resource, Clone, Debug, Default)]
pub struct Bodies {
    records: Vec<BodyRecord>,
    by_name: BTreeMap<String, BodyId>,
}

impl Bodies {
    pub(crate) fn push(&mut self, record: BodyRecord) {
        self.by_name.insert(record.name.clone(), BodyId(self.records.len() as u32));
        self.records.push(record);
    }

    /// A body's record.
    #[must_use]
    pub fn get(&self, body: BodyId) -> Option<&BodyRecord> {
        self.records.get(body.0 as usize)
    }

    /// Whose name it is.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<BodyId> {
        self.by_name.get(name).copied()
    }

    /// By id.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (BodyId, &BodyRecord)> {
        self.records.iter().enumerate().map(|(i, record)| (BodyId(i as u32), record))
    }

    /// The name of a body; empty for an id that no body has.
    #[must_use]
    pub fn name(&self, body: BodyId) -> &str {
        self.get(body).map_or("", |record| &record.name)
    }
}

/// The exact pose that a `Transform` means: its numbers widened, its quaternion normalised in f64.
///
/// A pure function, so two parts of the program cannot disagree about where a body is.
#[must_use]
pub fn pose_of(transform: &Transform) -> Pose {
    let q = transform.rotation;
    let q = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
    let t = transform.translation;
    Pose {
        rotation: q * (1.0 / q.length()),
        translation: DVec3::new(t.x.into(), t.y.into(), t.z.into()),
    }
}

/// The nearest `Transform` to a pose.
#[must_use]
pub fn transform_of(pose: &Pose) -> Transform {
    let q = pose.rotation;
    Transform {
        translation: narrowed(pose.translation),
        rotation: Quat::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32),
        scale: Vec3::ONE,
    }
}

/// The nearest f32 vector.
pub(crate) fn narrowed(v: DVec3) -> Vec3 {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// The same vector in f64.
pub(crate) fn widened(v: Vec3) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}

/// A model for each body of a scene; bodies that share a mesh share the model.
pub(crate) fn build_models(scene: &SceneDescription) -> Result<Vec<Model>, SceneAppError> {
    let mut built: BTreeMap<*const Mesh, Model> = BTreeMap::new();
    let mut models = Vec::with_capacity(scene.bodies.len());
    for body in &scene.bodies {
        let key = Arc::as_ptr(&body.collision);
        let model = match built.get(&key) {
            Some(model) => model.clone(),
            None => {
                let mesh = Mesh::clone(&body.collision);
                let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
                let (model, _) = Model::build(mesh, &options)
                    .map_err(|source| SceneAppError::Model { body: body.name.clone(), source })?;
                built.insert(key, model.clone());
                model
            }
        };
        models.push(model);
    }
    Ok(models)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn translations_survive_to_the_bit_and_rotations_to_rounding() {
        for (x, w) in [(0.6f32, 0.8f32), (0.0, 1.0), (0.1, 0.994_987_4), (-0.3, 0.953_939_2)] {
            let transform = Transform {
                translation: Vec3::new(0.1, -7.25e3, 1e-20),
                rotation: Quat::from_xyzw(x, 0.0, 0.0, w),
                scale: Vec3::ONE,
            };
            let pose = pose_of(&transform);
            assert!((pose.rotation.length_squared() - 1.0).abs() < 4.0 * f64::EPSILON);
            let back = transform_of(&pose);
            assert_eq!(back.translation, transform.translation);
            assert!((back.rotation.x - x).abs() <= 1.2e-7 && (back.rotation.w - w).abs() <= 1.2e-7);
        }
    }
}
