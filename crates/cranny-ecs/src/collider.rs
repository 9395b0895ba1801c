//! What a body is made of: a prepared mesh or a primitive, and what is drawn for it.

use std::sync::Arc;

use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_exact::DVec3;
use cranny_geometry::{BuildError, BuildOptions, Mesh, Model, Repair};
use cranny_primitives::{Ball, BodyShape, Capsule, Cone, Cylinder, HalfSpace, Primitive, Segment};
use cranny_shapes::{Cuboid, ShapeError};
use cranny_world::description::BodyColor;
use thiserror::Error;

use crate::admission::{note_change, note_removal};

/// The geometry of a body: an entity with a `Collider` is one.
///
/// A collider is a prepared [`Model`], which is made once and shared by all bodies of its shape, or
/// a [`Primitive`] in the body's frame: a ball, a capsule, a cylinder, a cone, a half-space.
/// Without a [`RigidBody`](crate::RigidBody) beside it the body is fixed. Inserting another one
/// replaces the geometry, from the next step on; removing it takes the body out at once.
///
/// What is answered about a primitive is right to rounding, at once, whatever level or budget holds
/// elsewhere, and has no regions and curves of contact. `Deformation`, `ForceFeedback` and
/// `SmoothNormals` need a mesh. A number that is invalid is an error of the step that takes the
/// body in.
///
/// ```
/// use cranny_ecs::Collider;
/// let hook = cranny_shapes::Cuboid { size: [1.0, 2.0, 3.0] }.build()?;
/// let collider = Collider::from_mesh(hook)?;
/// let another = collider.clone(); // shares the model
/// let marble = Collider::ball(0.5);
/// assert!(another.model().is_some() && marble.model().is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Component, Clone, Debug)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
#[require(Transform)]
pub struct Collider {
    shape: BodyShape,
}

/// A cuboid that cannot be made.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CuboidError {
    /// A side that is no length.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A mesh that cannot be prepared.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for CuboidError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl Collider {
    /// Prepares a mesh, which takes milliseconds and more: keep what it returns for other bodies of
    /// the same shape.
    ///
    /// The mesh is mended as meshes of scenes are ([`Repair::Safe`]): what is inside out, whole or
    /// in parts, is turned. An open mesh stays a surface without inside; a dynamic body of it is an
    /// error of the step that takes it in, unless it has a [`Mass`](crate::Mass). Where a mesh
    /// crosses itself, volume and mass count the overlap as often as it is enclosed.
    /// [`Model::build`] reports what it finds and mends, and `Collider::from` takes its model.
    ///
    /// # Errors
    ///
    /// [`BuildError`] where the mesh cannot be prepared.
    pub fn from_mesh(mesh: Mesh) -> Result<Self, BuildError> {
        let (repair, self_intersections) = (Repair::Safe, false);
        let options = BuildOptions { repair, self_intersections, ..BuildOptions::default() };
        Ok(Self::from(Model::build(mesh, &options)?.0))
    }

    /// All within a radius of the origin.
    #[must_use]
    pub fn ball(radius: f64) -> Self {
        Primitive::from(Ball { center: DVec3::ZERO, radius }).into()
    }

    /// A cuboid about the origin, by the lengths of its sides. It is a mesh, whose answers are
    /// exact.
    ///
    /// # Errors
    ///
    /// [`CuboidError`].
    pub fn cuboid(x: f64, y: f64, z: f64) -> Result<Self, CuboidError> {
        Ok(Self::from_mesh(Cuboid { size: [x, y, z] }.build()?)?)
    }

    /// All within a radius of a segment of a length along y, about the origin.
    #[must_use]
    pub fn capsule(radius: f64, length: f64) -> Self {
        let end = 0.5 * length * DVec3::Y;
        Primitive::from(Capsule { ends: [-end, end], radius }).into()
    }

    /// A cylinder along y, about the origin.
    #[must_use]
    pub fn cylinder(radius: f64, height: f64) -> Self {
        let (center, axis) = (DVec3::ZERO, DVec3::Y);
        Cylinder { center, axis, half_height: 0.5 * height, radius, border: 0.0 }.into()
    }

    /// A cone along y, with its apex up and its middle height at the origin.
    #[must_use]
    pub fn cone(radius: f64, height: f64) -> Self {
        let (center, axis) = (DVec3::ZERO, DVec3::Y);
        Cone { center, axis, half_height: 0.5 * height, radius, border: 0.0 }.into()
    }

    /// All on the side of the plane through the origin to which the normal does not point. A body
    /// of it is fixed or kinematic: it has no mass.
    #[must_use]
    pub fn half_space(outward_normal: DVec3) -> Self {
        HalfSpace { point: DVec3::ZERO, normal: outward_normal }.into()
    }

    /// What it is.
    #[must_use]
    pub fn shape(&self) -> &BodyShape {
        &self.shape
    }

    /// The prepared mesh, if it is one.
    #[must_use]
    pub fn model(&self) -> Option<&Model> {
        self.shape.model()
    }
}

impl From<BodyShape> for Collider {
    fn from(shape: BodyShape) -> Self {
        Self { shape }
    }
}

macro_rules! is_a_collider {
    ($($shape:ty)*) => {
        $(impl From<$shape> for Collider {
            fn from(shape: $shape) -> Self {
                Self { shape: shape.into() }
            }
        })*
    };
}

macro_rules! is_a_primitive {
    ($($shape:ty)*) => {
        $(impl From<$shape> for Collider {
            fn from(shape: $shape) -> Self {
                Primitive::from(shape).into()
            }
        })*
    };
}

is_a_collider!(Model &Model Primitive);
is_a_primitive!(Ball Capsule Segment Cylinder Cone HalfSpace);

/// What is drawn and recorded of a body, where it differs from its collider's mesh.
#[derive(Component, Clone, Debug)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct VisualMesh(pub Arc<Mesh>);

/// The colour in which a body is drawn and recorded, in place of one by its number.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Painted(pub BodyColor);
