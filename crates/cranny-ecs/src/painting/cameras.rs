//! Cameras that stay put, fitted to what moves and what it moves about.

use cranny_exact::{Aabb, DVec3};
use cranny_render::{Camera, Color, DrawList, Ground, ImageSize, Instance, Preset};
use cranny_world::description::{
    BodyKind, CameraDescription, CameraView, Effect, SceneDescription,
};

use crate::error::SceneAppError;

/// Name of the camera of a scene that names none.
pub const DEFAULT_CAMERA: &str = "main";

/// Names of directions, each of which is a camera of every scene.
pub const CAMERA_PRESETS: [&str; 4] = ["isometric", "front", "side", "top"];

/// A camera by name.
pub type NamedCamera = (String, Camera);

/// A stationary body is part of the picture where it is no larger than this many times what moves.
/// Smaller: the bolt is cut off beside its nut; larger: floors make everything small.
const SURROUNDINGS: f64 = 3.0;

/// How far a scene that nothing carries may hang down, in parts of its greatest extent: half the
/// circumference of a ring is 1.57 of its diameter. Larger: everything is drawn small.
const HANGING: f64 = 1.6;

/// What cameras are fitted to: what moves, what stands still near it, and room to fall.
pub(super) fn room(scene: &SceneDescription, instances: &[Instance]) -> DrawList {
    let bounds = |instance: &Instance| one(instance).bounds();
    let movers = |kind: BodyKind| kind != BodyKind::Fixed;
    let pairs = || scene.bodies.iter().zip(instances);
    let moving = Aabb::of_points(
        pairs()
            .filter(|(body, _)| movers(body.kind))
            .map(|(_, instance)| bounds(instance))
            .filter(|b| !b.is_empty())
            .flat_map(|b| [b.min, b.max]),
    );
    let near = |instance: &Instance| {
        moving.is_empty() || bounds(instance).diagonal() <= SURROUNDINGS * moving.diagonal()
    };
    let shown = pairs().filter(|(body, instance)| movers(body.kind) || near(instance));
    let mut list = DrawList::new();
    list.instances = shown.map(|(_, instance)| instance.clone()).collect();
    let start = list.bounds();
    let room = room_to_fall(scene, &start);
    if room != start {
        // Two corners are enough to make the list's bounds those of the room.
        list.push_line(room.min, room.max, Color::BLACK, 1.0);
    }
    list
}

/// Below everything, and where nothing carries the scene, below where it falls to.
pub(super) fn ground(scene: &SceneDescription, instances: &[Instance]) -> Ground {
    let list = DrawList { instances: instances.to_vec(), ..DrawList::new() };
    Ground::under(&room_to_fall(scene, &list.bounds()))
}

fn one(instance: &Instance) -> DrawList {
    DrawList { instances: vec![instance.clone()], ..DrawList::new() }
}

/// The scene's own, or one from aslant.
pub(super) fn of_scene(
    scene: &SceneDescription,
    room: &DrawList,
    size: ImageSize,
) -> Result<Vec<NamedCamera>, SceneAppError> {
    match &scene.cameras[..] {
        [] => Ok(vec![camera(&CameraView::Isometric, DEFAULT_CAMERA, room, size)?]),
        all => all
            .iter()
            .map(|CameraDescription { name, view }| camera(view, name, room, size))
            .collect(),
    }
}

/// One of the fitted ones by the name of its direction.
pub(super) fn preset(
    name: &str,
    known: &[NamedCamera],
    room: &DrawList,
    size: ImageSize,
) -> Result<NamedCamera, SceneAppError> {
    let view = match name {
        "isometric" => CameraView::Isometric,
        "front" => CameraView::Front,
        "side" => CameraView::Side,
        "top" => CameraView::Top,
        _ => {
            let own = || known.iter().map(|(name, _)| name.as_str());
            let presets = CAMERA_PRESETS.into_iter().filter(|name| !own().any(|own| own == *name));
            let names: Vec<_> = own().chain(presets).collect();
            let why = format!("there is none of that name. Choose one of {}", names.join(", "));
            return Err(SceneAppError::Camera { camera: name.to_owned(), why });
        }
    };
    camera(&view, name, room, size)
}

fn camera(
    view: &CameraView,
    name: &str,
    room: &DrawList,
    size: ImageSize,
) -> Result<NamedCamera, SceneAppError> {
    let camera = match *view {
        CameraView::Isometric => Camera::fitted_to(Preset::Isometric, room, size),
        CameraView::Front => Camera::fitted_to(Preset::Front, room, size),
        CameraView::Side => Camera::fitted_to(Preset::Side, room, size),
        CameraView::Top => Camera::fitted_to(Preset::Top, room, size),
        CameraView::LookAt { eye, target, field_of_view } => Camera::look_at(eye, target)
            .and_then(|camera| camera.with_field_of_view(field_of_view.to_degrees())),
    };
    let camera = camera.map_err(|error| SceneAppError::Camera {
        camera: name.to_owned(),
        why: error.to_string(),
    })?;
    Ok((name.to_owned(), camera))
}

/// The bounds of the start, and below them, where nothing fixed carries the scene, room to fall: a
/// chain that is held at one end will hang.
fn room_to_fall(scene: &SceneDescription, start: &Aabb) -> Aabb {
    let falls = scene.gravity.z < 0.0
        && scene.bodies.iter().any(|b| b.kind == BodyKind::Dynamic)
        && scene.effects.iter().any(|e| matches!(e, Effect::Response));
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
