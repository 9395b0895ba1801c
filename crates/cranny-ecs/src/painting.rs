//! What is drawn: bodies in colours of their own, ground, contact marks; cameras that stay put.

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_exact::{Aabb, DVec3, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_render::{
    Camera, Color, DrawList, DrawMesh, Ground, ImageSize, Instance, Preset, palette,
};
use cranny_world::BodyId;
use cranny_world::description::{BodyKind, CameraDescription, CameraView, SceneDescription};

use crate::body::BodyRecord;
use crate::contacts::ContactReport;
use crate::error::SceneAppError;

/// Contacts beyond these many are not marked: a picture of more shows nothing but marks.
pub const MARKS_MAX: usize = 2_000;

/// Length of a contact's arrow, in parts of the scene's diagonal.
const ARROW: f64 = 0.03;

/// Surfaces that meet.
const MEETING: Color = Color::rgb(214, 40, 40);
/// Surfaces that are near.
const NEAR: Color = Color::rgb(250, 170, 40);

/// Name of the camera of a scene that names none.
pub const DEFAULT_CAMERA: &str = "main";

/// All that pictures of a scene share.
pub(crate) struct Palette {
    bodies: BTreeMap<BodyId, Painted>,
    ground: Ground,
    arrow: f64,
}

/// How a body is drawn.
struct Painted {
    mesh: Arc<DrawMesh>,
    color: Color,
    /// For others of the same geometry.
    of: Geometry,
}

/// What a mesh is drawn of.
#[derive(Clone)]
enum Geometry {
    Described(Arc<Mesh>),
    Prepared(Model),
}

impl Geometry {
    fn mesh(&self) -> &Mesh {
        match self {
            Self::Described(mesh) => mesh,
            Self::Prepared(model) => model.mesh(),
        }
    }

    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Described(a), Self::Described(b)) => Arc::ptr_eq(a, b),
            (Self::Prepared(a), Self::Prepared(b)) => a.is_same(b),
            _ => false,
        }
    }
}

/// A camera by name.
pub(crate) type NamedCamera = (String, Camera);

/// Prepares meshes, and cameras for pictures of `size`.
pub(crate) fn prepare(
    scene: &SceneDescription,
    size: ImageSize,
) -> Result<(Palette, Vec<NamedCamera>), SceneAppError> {
    let mut bodies = BTreeMap::new();
    let mut list = DrawList::new();
    for (i, body) in scene.bodies.iter().enumerate() {
        let of = Geometry::Described(body.visual.as_ref().unwrap_or(&body.collision).clone());
        let (mesh, color) = (drawn(&bodies, &of, &body.name)?, palette(i));
        list.instances.push(Instance::solid(mesh.clone(), body.pose, color));
        bodies.insert(BodyId(i as u32), Painted { mesh, color, of });
    }
    let start = list.bounds();
    let room = room_to_fall(scene, &start);
    if room != start {
        // Two corners are enough to make the list's bounds those of the room.
        list.push_line(room.min, room.max, Color::BLACK, 1.0);
    }
    let cameras = match &scene.cameras[..] {
        [] => vec![camera(&CameraView::Isometric, DEFAULT_CAMERA, &list, size)?],
        all => all
            .iter()
            .map(|CameraDescription { name, view }| camera(view, name, &list, size))
            .collect::<Result<_, _>>()?,
    };
    let arrow = if start.is_empty() { ARROW } else { ARROW * start.diagonal() };
    Ok((Palette { bodies, ground: Ground::under(&room), arrow }, cameras))
}

/// The mesh to draw of a geometry, shared with a body that has the same.
fn drawn(
    bodies: &BTreeMap<BodyId, Painted>,
    of: &Geometry,
    name: &str,
) -> Result<Arc<DrawMesh>, SceneAppError> {
    if let Some(painted) = bodies.values().find(|painted| painted.of.is_same(of)) {
        return Ok(painted.mesh.clone());
    }
    let mesh = of.mesh();
    let drawn = DrawMesh::new(mesh.vertices(), mesh.faces()).map_err(|error| {
        SceneAppError::Undrawable { body: name.to_owned(), why: error.to_string() }
    })?;
    Ok(Arc::new(drawn))
}

fn camera(
    view: &CameraView,
    name: &str,
    list: &DrawList,
    size: ImageSize,
) -> Result<NamedCamera, SceneAppError> {
    let camera = match *view {
        CameraView::Isometric => Camera::fitted_to(Preset::Isometric, list, size),
        CameraView::Front => Camera::fitted_to(Preset::Front, list, size),
        CameraView::Side => Camera::fitted_to(Preset::Side, list, size),
        CameraView::Top => Camera::fitted_to(Preset::Top, list, size),
        CameraView::LookAt { eye, target, field_of_view } => Camera::look_at(eye, target)
            .and_then(|camera| camera.with_field_of_view(field_of_view.to_degrees())),
    };
    let camera = camera.map_err(|error| SceneAppError::Camera {
        camera: name.to_owned(),
        why: error.to_string(),
    })?;
    Ok((name.to_owned(), camera))
}

/// How far a scene that nothing carries may hang down, in parts of its greatest extent: half the
/// circumference of a ring is 1.57 of its diameter. Larger: everything is drawn small.
const HANGING: f64 = 1.6;

/// The bounds of the start, and below them, where nothing fixed carries the scene, room to fall: a
/// chain that is held at one end will hang.
fn room_to_fall(scene: &SceneDescription, start: &Aabb) -> Aabb {
    let falls = scene.gravity.z < 0.0
        && scene.bodies.iter().any(|b| b.kind == BodyKind::Dynamic)
        && scene.effects.iter().any(|e| matches!(e, cranny_world::description::Effect::Response));
    if start.is_empty() || !falls {
        return *start;
    }
    let bottom = |kind_fixed: bool| {
        let bodies = scene.bodies.iter().filter(|b| (b.kind == BodyKind::Fixed) == kind_fixed);
        bodies
            .flat_map(|b| {
                let map = b.pose.world_from_body();
                b.collision.vertices().iter().map(move |&p| map.apply(p).z)
            })
            .fold(f64::INFINITY, f64::min)
    };
    if bottom(true) <= bottom(false) {
        return *start;
    }
    let size = start.max - start.min;
    let depth = (HANGING * size.max_element() - size.z).max(0.0);
    Aabb { min: start.min - depth * DVec3::Z, max: start.max }
}

impl Palette {
    /// Takes in a body that the scene does not describe, or another geometry of one that it does.
    pub(crate) fn put(&mut self, id: BodyId, record: &BodyRecord) -> Result<(), SceneAppError> {
        let of = match &record.visual {
            Some(visual) => Geometry::Described(visual.clone()),
            None => Geometry::Prepared(record.model.clone()),
        };
        let mesh = drawn(&self.bodies, &of, &record.name)?;
        self.bodies.insert(id, Painted { mesh, color: palette(id.0 as usize), of });
        Ok(())
    }

    /// Draws a body no more.
    pub(crate) fn remove(&mut self, id: BodyId) {
        self.bodies.remove(&id);
    }

    /// The picture of bodies at poses, and of contacts.
    pub(crate) fn draw_list(
        &self,
        poses: impl Iterator<Item = (BodyId, Pose)>,
        contacts: Option<&ContactReport>,
    ) -> DrawList {
        let mut list = DrawList::new();
        list.ground = Some(self.ground);
        for (id, pose) in poses {
            if let Some(Painted { mesh, color, .. }) = self.bodies.get(&id) {
                list.instances.push(Instance::solid(mesh.clone(), pose, *color));
            }
        }
        let pairs = contacts.iter().flat_map(|c| &c.pairs);
        for point in pairs.flat_map(|pair| &pair.answer.contacts).take(MARKS_MAX) {
            let color = if point.separation > 0.0 { NEAR } else { MEETING };
            list.push_contact(
                0.5 * (point.point_a + point.point_b),
                point.normal,
                self.arrow,
                color,
            );
        }
        list
    }
}
