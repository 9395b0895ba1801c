//! Bodies as entities, and the one place where a body is: its `Transform`.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_math::{Quat, Vec3};
use bevy_transform::components::Transform;
use cranny_exact::{DVec3, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_primitives::BodyShape;
use cranny_world::BodyId;
use cranny_world::description::{BodyColor, BodyKind, Normals};
use glam::DQuat;

#[cfg(any(feature = "record", feature = "render"))]
use crate::error::SceneAppError;
use crate::properties::{AngularVelocity, LinearVelocity};

/// A body: an entity with a [`Collider`](crate::Collider) that a step has taken in. The step
/// inserts this component; an app spawns the collider and what else the body has.
///
/// The entity's `Transform` is the single truth about where it is: every query, recording and
/// picture reads it through [`pose_of`], and whoever moves it, moves the body. A `Transform` must
/// not scale. Despawning the entity, or removing its collider, takes the body out of everything, at
/// once.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable)]
#[require(Transform, LinearVelocity, AngularVelocity)]
pub struct Body {
    /// Stable, and never given again: counts up in the order in which bodies came. Orders
    /// everything that is reported.
    pub id: BodyId,
}

/// What a body is, as the latest step took it in.
#[derive(Clone, Debug)]
pub struct BodyRecord {
    /// Its entity.
    pub entity: Entity,
    /// Unique among the bodies present: its `Name` or "body", with the id behind it where another
    /// body has that name already.
    pub name: String,
    /// Collision geometry.
    pub shape: BodyShape,
    /// Geometry to draw, where it differs from the shape.
    pub visual: Option<Arc<Mesh>>,
    /// Colour to draw it in, where one is stated.
    pub color: Option<BodyColor>,
    /// How it moves.
    pub kind: BodyKind,
    /// Which normals its contacts have for the solver.
    pub normals: Normals,
}

impl BodyRecord {
    /// The prepared mesh, where the body is one.
    #[must_use]
    pub fn model(&self) -> Option<&Model> {
        self.shape.model()
    }

    /// What is drawn and recorded of it; of a primitive that says nothing else a mesh that stands
    /// for it.
    ///
    /// # Errors
    ///
    /// [`SceneAppError::Undrawable`] for a primitive without a size.
    #[cfg(any(feature = "record", feature = "render"))]
    pub(crate) fn drawn_mesh(&self) -> Result<std::borrow::Cow<'_, Mesh>, SceneAppError> {
        use std::borrow::Cow::{Borrowed, Owned};
        match (&self.visual, &self.shape) {
            (Some(visual), _) => Ok(Borrowed(visual)),
            (None, BodyShape::Model(model)) => Ok(Borrowed(model.mesh())),
            (None, BodyShape::Primitive(primitive)) => {
                cranny_shapes::primitive_mesh(primitive).map(Owned).map_err(|error| {
                    SceneAppError::Undrawable { body: self.name.clone(), why: error.to_string() }
                })
            }
        }
    }

    /// How far a point of its surface is from its origin at most; of a half-space 0, whose plane
    /// goes where its origin does.
    pub(crate) fn extent(&self) -> f64 {
        let radius = self.shape.radius();
        if radius.is_finite() { radius } else { 0.0 }
    }
}

/// All bodies that are present, by id.
#[derive(Resource, Clone, Debug, Default)]
pub struct Bodies {
    records: BTreeMap<BodyId, BodyRecord>,
    by_name: BTreeMap<String, BodyId>,
    /// The id of the next body.
    next: u32,
    /// Entity and name of bodies that left since this step began, and before it did: the events of
    /// a step are about bodies that left before it.
    departing: BTreeMap<BodyId, (Entity, String)>,
    departed: BTreeMap<BodyId, (Entity, String)>,
    /// Names of bodies that left and that a run's summary will mention.
    remembered: BTreeMap<BodyId, String>,
}

impl Bodies {
    /// Takes a body in, or what has become of one that is known. `None` where no id is left.
    pub(crate) fn admit(
        &mut self,
        known: Option<BodyId>,
        mut record: BodyRecord,
    ) -> Option<BodyId> {
        let id = match known {
            Some(id) => id,
            None => {
                let id = BodyId(self.next);
                self.next = self.next.checked_add(1)?;
                id
            }
        };
        if let Some(before) = self.records.remove(&id) {
            // A body keeps the name under which it was reported.
            record.name = before.name;
        } else if record.name.is_empty() || self.by_name.contains_key(&record.name) {
            let stem = if record.name.is_empty() { "body" } else { &record.name };
            let mut name = format!("{stem}#{}", id.0);
            while self.by_name.contains_key(&name) {
                name.push('#');
            }
            record.name = name;
        }
        self.by_name.insert(record.name.clone(), id);
        self.records.insert(id, record);
        Some(id)
    }

    /// Lets a body go; `remember` its name beyond the next step.
    pub(crate) fn take_leave(&mut self, body: BodyId, remember: bool) {
        if let Some(record) = self.records.remove(&body) {
            self.by_name.remove(&record.name);
            if remember {
                self.remembered.insert(body, record.name.clone());
            }
            self.departing.insert(body, (record.entity, record.name));
        }
    }

    /// A step begins, which reports the end of what has left by now. Returns whether anything has,
    /// or had before.
    pub(crate) fn begin_step(&mut self) -> bool {
        let before = std::mem::replace(&mut self.departed, std::mem::take(&mut self.departing));
        !before.is_empty() || !self.departed.is_empty()
    }

    fn departed(&self, body: BodyId) -> Option<&(Entity, String)> {
        self.departing.get(&body).or_else(|| self.departed.get(&body))
    }

    /// A body's record.
    #[must_use]
    pub fn get(&self, body: BodyId) -> Option<&BodyRecord> {
        self.records.get(&body)
    }

    /// The entity of a body; of one that left, until a step has reported its departure.
    pub(crate) fn entity(&self, body: BodyId) -> Option<Entity> {
        let present = self.get(body).map(|record| record.entity);
        present.or_else(|| self.departed(body).map(|(entity, _)| *entity))
    }

    /// The body of a name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<BodyId> {
        self.by_name.get(name).copied()
    }

    /// By id.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (BodyId, &BodyRecord)> {
        self.records.iter().map(|(&id, record)| (id, record))
    }

    /// The name of a body; of one that left, until a step has reported its departure. Empty for an
    /// id that no body has.
    #[must_use]
    pub fn name(&self, body: BodyId) -> &str {
        let departed = || self.departed(body).map(|(_, name)| name);
        let present = self.get(body).map(|record| &record.name);
        present.or_else(departed).or_else(|| self.remembered.get(&body)).map_or("", |name| name)
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
