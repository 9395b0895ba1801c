//! The picture of `cranny inspect --render`: the body, its hull, and the edges that are not sound.

use std::fmt::Display;
use std::path::Path;
use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::hull::HullKind;
use cranny_geometry::{EdgeKind, Model};
use cranny_render::{
    Camera, Color, DrawList, DrawMesh, DrawMeshError, Ground, ImageSize, Instance, Line, Preset,
    RenderError, Renderer, RendererOptions,
};

use crate::failure::Failure;
use crate::progress;

/// Width and height in pixels.
const SIZE: [u32; 2] = [1280, 960];

const BODY: Color = Color::rgb(176, 182, 190);
const HULL: Color = Color { r: 70, g: 130, b: 220, a: 48 };
const OPEN: Color = Color::rgb(220, 40, 40);
const CONTRADICTORY: Color = Color::rgb(240, 140, 0);
const NON_MANIFOLD: Color = Color::rgb(200, 0, 180);

/// Pixels.
const LINE_WIDTH: f32 = 2.5;

/// Opacity with which a marked edge shows through what hides it.
const HIDDEN: u8 = 70;

/// The hull is drawn larger by this factor, about its centroid. Smaller, and depth rounding mixes it
/// with the faces that lie on it; larger, and the gap shows.
const VEIL: f64 = 1.004;

/// Why there is no picture.
pub(super) enum Trouble {
    /// No graphics adapter that could draw: the work goes on without.
    NoGraphics(String),
    /// Everything else.
    Failed(Failure),
}

/// Draws a model and writes the picture as PNG: whole, or not at all.
pub(super) fn draw(model: &Model, path: &Path) -> Result<(), Trouble> {
    // Told before a graphics adapter is looked for, so that it is told where there is none, too.
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(Trouble::Failed(Failure::run(format!(
            "picture {}: there is no folder {}. Create it or choose another.",
            path.display(),
            folder.display()
        ))));
    }
    let waiting = progress::spinner(format!("drawing {}", path.display()));
    let mut renderer = match Renderer::new(&RendererOptions::default()) {
        Ok(renderer) => renderer,
        Err(error @ RenderError::UnknownBackend { .. }) => {
            return Err(Trouble::Failed(Failure::input(error)));
        }
        Err(error) => return Err(Trouble::NoGraphics(error.to_string())),
    };
    let failed = |error: &dyn Display| {
        Trouble::Failed(Failure::run(format!("picture {}: {error}", path.display())))
    };
    let size = ImageSize::new(SIZE[0], SIZE[1]).map_err(|error| failed(&error))?;
    let list = draw_list(model).map_err(|error| failed(&error))?;
    let camera =
        Camera::fitted_to(Preset::Isometric, &list, size).map_err(|error| failed(&error))?;
    let image = renderer.render(&list, &camera, size).map_err(|error| failed(&error))?;
    image.save_png(path).map_err(|error| Trouble::Failed(Failure::run(error)))?;
    waiting.finish_and_clear();
    Ok(())
}

fn draw_list(model: &Model) -> Result<DrawList, DrawMeshError> {
    let mut list = DrawList::new();
    let mut body = |mesh: DrawMesh, color: Color| {
        list.instances.push(Instance { mesh: Arc::new(mesh), pose: Pose::IDENTITY, color });
    };
    let mesh = model.mesh();
    body(DrawMesh::new(mesh.vertices(), mesh.faces())?, BODY);
    let hull = model.hull();
    if let (HullKind::Volume, Some(center)) = (hull.kind(), hull.centroid()) {
        let triangles: Vec<[u32; 3]> =
            (0..hull.triangle_count()).map(|i| hull.triangle(i).map(|v| v.0)).collect();
        let corners: Vec<DVec3> =
            hull.positions().iter().map(|&p| center + VEIL * (p - center)).collect();
        body(DrawMesh::new(&corners, &triangles)?, HULL);
    }
    list.ground = Some(Ground::under(&list.bounds()));
    for edge in model.topology().edges() {
        if let Some(color) = mark(edge.kind) {
            let ends = [edge.from, edge.to].map(|vertex| mesh.position(vertex));
            list.push_line(ends[0], ends[1], color, LINE_WIDTH);
            let shining_through = Line {
                from: ends[0],
                to: ends[1],
                color: color.with_alpha(HIDDEN),
                width: [LINE_WIDTH; 2],
                on_top: true,
            };
            list.lines.push(shining_through);
        }
    }
    Ok(list)
}

/// The colour of an edge that is not sound.
fn mark(kind: EdgeKind) -> Option<Color> {
    match kind {
        EdgeKind::Manifold => None,
        EdgeKind::Open => Some(OPEN),
        EdgeKind::Contradictory => Some(CONTRADICTORY),
        EdgeKind::Balanced | EdgeKind::Tangled => Some(NON_MANIFOLD),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_geometry::{BuildOptions, Mesh};

    #[test]
    fn body_hull_and_open_edges_are_drawn() {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]]; // one side missing
        let mesh = Mesh::new(vertices, faces).unwrap();
        let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let list = draw_list(&model).unwrap();
        assert_eq!(list.instances.len(), 2);
        assert_eq!(list.instances[1].mesh.triangle_count(), 4);
        assert_eq!(list.lines.iter().filter(|line| line.color == OPEN).count(), 3);
        assert_eq!(list.lines.iter().filter(|line| line.on_top).count(), 3);
    }
}
