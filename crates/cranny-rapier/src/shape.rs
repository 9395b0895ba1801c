//! A Cranny model as a rapier shape.

use std::sync::Arc;

use cranny_geometry::{CreaseAngleError, Model, SmoothNormals};
use cranny_narrow_phase::Normals;
use cranny_primitives::PrimitiveError;
use cranny_primitives::deep::thickness;
use rapier3d::math::{Pose, Real, Vector};
use rapier3d::parry::bounding_volume::{Aabb, BoundingSphere};
use rapier3d::parry::mass_properties::MassProperties;
use rapier3d::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use rapier3d::parry::shape::{
    CompositeShape, FeatureId, Shape, ShapeType, SharedShape, SubShapeId, TriMesh,
    TriMeshBuilderError, TypedShape,
};
use thiserror::Error;

use crate::convert::narrow;
use crate::mass::{MassError, mass_properties};
#[cfg(feature = "snapshot")]
use crate::snapshot::StandIn;

/// A model that rapier cannot take.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// parry refused the same triangles as a mesh for ray casts and point queries.
    #[error("parry does not accept the mesh for ray casts and point queries: {0}")]
    TriMesh(#[from] TriMeshBuilderError),
    /// parry's convex decomposition gave up, with a panic.
    #[error("parry cannot decompose the mesh into convex pieces: it panics on it")]
    Decomposition,
    /// parry finds no convex hull.
    #[error("parry finds no convex hull of the mesh: it is flat, or a line")]
    Hull,
    /// A crease angle that is none.
    #[error(transparent)]
    Crease(#[from] CreaseAngleError),
    /// No mass can be computed.
    #[error(transparent)]
    Mass(#[from] MassError),
    /// A number of a primitive.
    #[error(transparent)]
    Primitive(#[from] PrimitiveError),
    /// Smooth normals of a primitive, whose surface is its own.
    #[error("a {what} has no facets to smooth: leave smooth normals to meshes")]
    SmoothPrimitive {
        /// The kind of primitive: "ball".
        what: &'static str,
    },
}

/// A model, prepared for [`Dispatcher`](crate::Dispatcher). Contacts, intersections and distances
/// between two of them are Cranny's, and so are shape casts; ray casts and point queries go to a
/// parry mesh of the same triangles.
#[derive(Clone)]
pub struct MeshShape {
    model: Model,
    tag: u32,
    /// The model's, which takes a pass over all its faces to compute.
    thickness: f64,
    mesh: TriMesh,
    smooth: Option<Arc<SmoothNormals>>,
    walkable: bool,
    #[cfg(feature = "snapshot")]
    stand_in: StandIn,
}

impl MeshShape {
    /// A shape; `tag` is what [`AnswerLog`](crate::AnswerLog) will know it by.
    ///
    /// # Errors
    ///
    /// [`ShapeError::TriMesh`].
    pub fn new(model: &Model, tag: u32) -> Result<Self, ShapeError> {
        let (vertices, faces) = buffers(model);
        // Before the first step, which would make it otherwise.
        model.clusters();
        Ok(Self {
            model: model.clone(),
            tag,
            thickness: thickness(model),
            mesh: TriMesh::new(vertices, faces)?,
            smooth: None,
            walkable: false,
            #[cfg(feature = "snapshot")]
            stand_in: StandIn::default(),
        })
    }

    /// The same with normals as they are wanted, see
    /// [`with_smooth_normals`](Self::with_smooth_normals).
    ///
    /// # Errors
    ///
    /// [`ShapeError::Crease`].
    pub fn with_normals(self, normals: Normals) -> Result<Self, ShapeError> {
        match normals {
            Normals::Flat => Ok(Self { smooth: None, ..self }),
            Normals::Smooth { crease_angle } => self.with_smooth_normals(crease_angle),
        }
    }

    /// The same with smooth normals: a solver gets its contacts with the normals of the curved
    /// surface that the mesh stands for, smooth over edges between normals that differ by less than
    /// `crease_angle` (radians, 0 to π). Points and separations of contacts stay exact, as do all
    /// other answers. See [`smooth_normal`](cranny_narrow_phase::smooth_normal).
    ///
    /// # Errors
    ///
    /// [`ShapeError::Crease`].
    pub fn with_smooth_normals(self, crease_angle: f64) -> Result<Self, ShapeError> {
        let smooth = Some(Arc::new(SmoothNormals::of(&self.model, crease_angle)?));
        Ok(Self { smooth, ..self })
    }

    /// The same as ground that rapier's `KinematicCharacterController` feels. The controller makes
    /// its casts through the query pipeline's dispatcher, and finds through parry's own whether it
    /// stands on something; that one then gets the parry mesh of the same triangles. Without this
    /// nothing but a ball is ever reported to be grounded on the shape, snaps to it, is carried by
    /// it or pushes it. Nothing else changes, but that parry panics where such a shape is put into
    /// a compound.
    #[must_use]
    pub fn walkable(self) -> Self {
        Self { walkable: true, ..self }
    }

    /// Whether rapier's character controller feels it, see [`walkable`](Self::walkable).
    #[must_use]
    pub fn is_walkable(&self) -> bool {
        self.walkable
    }

    /// The same as a shared shape, ready for a `ColliderBuilder`.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn shared(model: &Model, tag: u32) -> Result<SharedShape, ShapeError> {
        Ok(SharedShape::new(Self::new(model, tag)?))
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The model's [thickness](thickness()).
    pub(crate) fn thickness(&self) -> f64 {
        self.thickness
    }

    /// The normals that its contacts get, if not those of its facets.
    #[must_use]
    pub fn smooth_normals(&self) -> Option<&Arc<SmoothNormals>> {
        self.smooth.as_ref()
    }

    /// What the answer log knows it by.
    #[must_use]
    pub fn tag(&self) -> u32 {
        self.tag
    }

    /// The parry mesh of the same triangles.
    #[must_use]
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// What it wears while it is written.
    #[cfg(feature = "snapshot")]
    pub(crate) fn stand_in(&self) -> &StandIn {
        &self.stand_in
    }
}

/// Vertices and faces for parry.
pub(crate) fn buffers(model: &Model) -> (Vec<Vector>, Vec<[u32; 3]>) {
    let mesh = model.mesh();
    (mesh.vertices().iter().map(|&p| narrow(p)).collect(), mesh.faces().to_vec())
}

impl RayCast for MeshShape {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Option<RayIntersection> {
        self.mesh.cast_local_ray_and_get_normal(ray, max_time_of_impact, solid)
    }
}

impl PointQuery for MeshShape {
    fn project_local_point(&self, pt: Vector, solid: bool) -> PointProjection {
        self.mesh.project_local_point(pt, solid)
    }

    fn project_local_point_and_get_feature(&self, pt: Vector) -> (PointProjection, FeatureId) {
        self.mesh.project_local_point_and_get_feature(pt)
    }
}

impl Shape for MeshShape {
    fn compute_local_aabb(&self) -> Aabb {
        // rapier's numbers round the vertices; the box must hold them as they are in f64.
        let b = self.model.bounds();
        let (min, max) = (narrow(b.min), narrow(b.max));
        let down = |x: Real| x.next_down();
        let up = |x: Real| x.next_up();
        Aabb::new(
            Vector::new(down(min.x), down(min.y), down(min.z)),
            Vector::new(up(max.x), up(max.y), up(max.z)),
        )
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.compute_local_aabb().bounding_sphere()
    }

    fn compute_aabb(&self, position: &Pose) -> Aabb {
        self.compute_local_aabb().transform_by(position)
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// A scaled model is another model, to be prepared as such: `None`.
    fn scale_dyn(&self, _scale: Vector, _num_subdivisions: u32) -> Option<Box<dyn Shape>> {
        None
    }

    /// Of the solid. Of a mesh that is not closed: zero, so that nothing is invented.
    fn mass_properties(&self, density: Real) -> MassProperties {
        mass_properties(&self.model, f64::from(density)).unwrap_or_default()
    }

    /// For callers of parry's own dispatcher, such as rapier's character controller; not always,
    /// since parry makes no compounds of what has parts.
    fn as_composite_shape(&self) -> Option<&(dyn CompositeShape + Sync)> {
        self.walkable.then_some(&self.mesh as &(dyn CompositeShape + Sync))
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    /// Its own, so that rapier's serde refuses to write it: what it could read back would be
    /// another shape. Only a `snapshot` is shown one that it can.
    fn as_typed_shape(&self) -> TypedShape<'_> {
        #[cfg(feature = "snapshot")]
        if let Some(ball) = self.stand_in.shown() {
            return ball;
        }
        TypedShape::Custom(self)
    }

    /// Infinite: rapier's own continuous detection never starts, as it never does for parry's
    /// meshes and height fields. It would cast the hollow mesh, find contact at once, and hold a
    /// body that slides along another where it is. A prediction distance as long as bodies move
    /// sees fast ones ahead instead; [`Simulation`](crate::Simulation) sets it.
    fn ccd_thickness(&self) -> Real {
        Real::MAX
    }

    fn ccd_angular_thickness(&self) -> Real {
        self.mesh.ccd_angular_thickness()
    }

    fn feature_normal_at_point(
        &self,
        subshape: SubShapeId,
        feature: FeatureId,
        point: Vector,
    ) -> Option<Vector> {
        self.mesh.feature_normal_at_point(subshape, feature, point)
    }
}
