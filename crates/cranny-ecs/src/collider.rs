//! What a body is made of: a prepared mesh, and what is drawn for it.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_geometry::{BuildError, BuildOptions, Mesh, Model};

use crate::admission::{note_change, note_removal};

/// The geometry of a body: an entity with a `Collider` is one.
///
/// A collider is made of a [`Model`], which is prepared once and shared by all bodies of its shape.
/// Without a [`RigidBody`](crate::RigidBody) beside it the body is fixed. Inserting another one
/// replaces the geometry, from the next step on; removing it takes the body out at once.
///
/// ```
/// use cranny_ecs::Collider;
/// let hook = cranny_shapes::Cuboid { size: [1.0, 2.0, 3.0] }.build()?;
/// let collider = Collider::from_mesh(hook)?;
/// let another = collider.clone(); // shares the model
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Component, Clone, Debug)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
#[require(Transform)]
pub struct Collider {
    model: Model,
}

impl Collider {
    /// Prepares a mesh, which takes milliseconds and more: keep what it returns for other bodies of
    /// the same shape.
    ///
    /// # Errors
    ///
    /// [`BuildError`] where the mesh cannot be prepared.
    pub fn from_mesh(mesh: Mesh) -> Result<Self, BuildError> {
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        Ok(Self::from(Model::build(mesh, &options)?.0))
    }

    /// The prepared geometry.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }
}

impl From<Model> for Collider {
    fn from(model: Model) -> Self {
        Self { model }
    }
}

impl From<&Model> for Collider {
    fn from(model: &Model) -> Self {
        Self { model: model.clone() }
    }
}

/// What is drawn and recorded of a body, where it differs from its collider's mesh.
#[derive(Component, Clone, Debug)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct VisualMesh(pub Arc<Mesh>);
