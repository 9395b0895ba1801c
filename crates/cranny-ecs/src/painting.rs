//! What is drawn: bodies in colours of their own, ground, contact marks; cameras that stay put.

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_exact::{Aabb, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_render::{
    Camera, Color, DrawList, DrawMesh, Ground, ImageSize, Instance, Preset, palette,
};
use cranny_world::BodyId;
use cranny_world::description::{BodyKind, CameraDescription, CameraView, SceneDescription};

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
    /// By body id.
    bodies: Vec<(Arc<DrawMesh>, Color)>,
    ground: Ground,
    arrow: f64,
}

/// A camera by name.
pub(crate) type NamedCamera = (String, Camera);

/// Prepares meshes, and cameras for pictures of `size`.
pub(crate) fn prepare(
    scene: &SceneDescription,
    size: ImageSize,
) -> Result<(Palette, Vec<NamedCamera>), SceneAppError> {
    let mut meshes: BTreeMap<*const Mesh, Arc<DrawMesh>> = BTreeMap::new();
    let mut bodies = Vec::with_capacity(scene.bodies.len());
    let mut list = DrawList::new();
    for (i, body) in scene.bodies.iter().enumerate() {
        let mesh = body.visual.as_ref().unwrap_or(&body.collision);
        let key = Arc::as_ptr(mesh);
        let drawn = match meshes.get(&key) {
            Some(drawn) => drawn.clone(),
            None => {
                let drawn = DrawMesh::new(mesh.vertices(), mesh.faces()).map_err(|error| {
                    SceneAppError::Undrawable { body: body.name.clone(), why: error.to_string() }
                })?;
                meshes.entry(key).or_insert(Arc::new(drawn)).clone()
            }
        };
        let color = palette(i);
        list.instances.push(Instance { mesh: drawn.clone(), pose: body.pose, color });
        bodies.push((drawn, color));
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
    /// The picture of bodies at poses, and of contacts.
    pub(crate) fn draw_list(
        &self,
        poses: impl Iterator<Item = (BodyId, Pose)>,
        contacts: Option<&ContactReport>,
    ) -> DrawList {
        let mut list = DrawList::new();
        list.ground = Some(self.ground);
        for (id, pose) in poses {
            if let Some((mesh, color)) = self.bodies.get(id.0 as usize) {
                list.instances.push(Instance { mesh: mesh.clone(), pose, color: *color });
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
