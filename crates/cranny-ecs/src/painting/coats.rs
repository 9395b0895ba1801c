//! The mesh and colour of each body: moving ones in colours, stationary ones grey.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use cranny_exact::{Aabb, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_primitives::{BodyShape, Primitive};
use cranny_render::{Color, DrawMesh, Instance, palette};
use cranny_world::BodyId;
use cranny_world::description::{BodyColor, BodyDescription, BodyKind, SceneDescription};

use crate::body::BodyRecord;
use crate::error::SceneAppError;

/// How bodies are drawn, by id.
#[derive(Default)]
pub(crate) struct Coats {
    coats: BTreeMap<BodyId, Coat>,
}

/// How a body is drawn.
pub(crate) struct Coat {
    pub(crate) name: String,
    pub(crate) mesh: Arc<DrawMesh>,
    pub(crate) color: Color,
    pub(crate) kind: BodyKind,
    /// What collides, where it is prepared.
    pub(crate) shape: Option<BodyShape>,
    /// For others of the same geometry.
    pub(crate) of: Geometry,
    /// Of what is drawn, where nobody has prepared what collides; made when first needed.
    drawn: OnceLock<Option<Model>>,
}

/// What a mesh is drawn of.
#[derive(Clone)]
pub(crate) enum Geometry {
    Described(Arc<Mesh>),
    Prepared(Model),
    /// A primitive, and the mesh that stands for it.
    Primitive(Primitive, Arc<Mesh>),
}

impl Geometry {
    pub(crate) fn mesh(&self) -> &Mesh {
        match self {
            Self::Described(mesh) | Self::Primitive(_, mesh) => mesh,
            Self::Prepared(model) => model.mesh(),
        }
    }

    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Described(a), Self::Described(b)) => Arc::ptr_eq(a, b),
            (Self::Prepared(a), Self::Prepared(b)) => a.is_same(b),
            (Self::Primitive(a, _), Self::Primitive(b, _)) => a == b,
            _ => false,
        }
    }
}

impl Coat {
    pub(crate) fn moves(&self) -> bool {
        self.kind != BodyKind::Fixed
    }

    /// What lines of sight meet: what collides, or what is drawn where that is not prepared; `None`
    /// where no model can be made of it.
    pub(crate) fn seen(&self) -> Option<&Model> {
        self.shape.as_ref().and_then(BodyShape::model).or_else(|| {
            let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
            let prepared = || Some(Model::build(self.of.mesh().clone(), &options).ok()?.0);
            self.drawn.get_or_init(prepared).as_ref()
        })
    }

    /// Where the body is at a pose; larger than needed where it is turned.
    pub(crate) fn bounds(&self, pose: &Pose) -> Aabb {
        let bounds = self.mesh.bounds();
        if bounds.is_empty() { Aabb::EMPTY } else { pose.world_from_body().bounds(&bounds) }
    }
}

impl Coats {
    /// Of a scene, with its bodies where they start.
    pub(crate) fn of_scene(
        scene: &SceneDescription,
    ) -> Result<(Self, Vec<Instance>), SceneAppError> {
        let mut coats = Self::default();
        let mut instances = Vec::new();
        for (id, body) in (0u32..).map(BodyId).zip(&scene.bodies) {
            let coat = coats.put_described(id, body)?;
            instances.push(Instance::solid(coat.mesh.clone(), body.pose, coat.color));
        }
        Ok((coats, instances))
    }

    pub(crate) fn get(&self, id: BodyId) -> Option<&Coat> {
        self.coats.get(&id)
    }

    pub(crate) fn name(&self, id: BodyId) -> &str {
        self.get(id).map_or("a body that left", |coat| &coat.name)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (BodyId, &Coat)> {
        self.coats.iter().map(|(&id, coat)| (id, coat))
    }

    /// Of a body as a scene describes it.
    pub(crate) fn put_described(
        &mut self,
        id: BodyId,
        body: &BodyDescription,
    ) -> Result<&Coat, SceneAppError> {
        let of = Geometry::Described(body.visual.as_ref().unwrap_or(&body.collision).clone());
        let mut coat = self.coat(id, &body.name, of, body.kind, body.color)?;
        coat.shape = body.shape.clone();
        Ok(self.coats.entry(id).insert_entry(coat).into_mut())
    }

    pub(crate) fn put(&mut self, id: BodyId, record: &BodyRecord) -> Result<(), SceneAppError> {
        let of = match (&record.visual, &record.shape) {
            (Some(visual), _) => Geometry::Described(visual.clone()),
            (None, BodyShape::Model(model)) => Geometry::Prepared(model.clone()),
            (None, BodyShape::Primitive(primitive)) => {
                Geometry::Primitive(*primitive, Arc::new(record.drawn_mesh()?.into_owned()))
            }
        };
        let mut coat = self.coat(id, &record.name, of, record.kind, record.color)?;
        coat.shape = Some(record.shape.clone());
        self.coats.insert(id, coat);
        Ok(())
    }

    pub(crate) fn remove(&mut self, id: BodyId) {
        self.coats.remove(&id);
    }

    fn coat(
        &self,
        id: BodyId,
        name: &str,
        of: Geometry,
        kind: BodyKind,
        stated: Option<BodyColor>,
    ) -> Result<Coat, SceneAppError> {
        let mesh = self.drawn(&of, name)?;
        let color =
            stated.map_or_else(|| color(id, kind), |BodyColor([r, g, b])| Color::rgb(r, g, b));
        Ok(Coat {
            name: name.to_owned(),
            mesh,
            color,
            kind,
            shape: None,
            of,
            drawn: OnceLock::new(),
        })
    }

    /// The mesh to draw of a geometry, shared with a body that has the same.
    fn drawn(&self, of: &Geometry, name: &str) -> Result<Arc<DrawMesh>, SceneAppError> {
        if let Some(coat) = self.coats.values().find(|coat| coat.of.is_same(of)) {
            return Ok(coat.mesh.clone());
        }
        let mesh = of.mesh();
        let drawn = DrawMesh::new(mesh.vertices(), mesh.faces()).map_err(|error| {
            SceneAppError::Undrawable { body: name.to_owned(), why: error.to_string() }
        })?;
        Ok(Arc::new(drawn))
    }
}

fn color(id: BodyId, kind: BodyKind) -> Color {
    match kind {
        BodyKind::Fixed => palette::STATIONARY,
        BodyKind::Kinematic | BodyKind::Dynamic => palette(id.0 as usize),
    }
}
