//! Lines along edges: wireframes, creases, silhouettes, the rims of cut faces.

use cranny_exact::DVec3;

use crate::color::Color;
use crate::draw_list::Instance;
use crate::section::Section;
use crate::style::{Shading, Style};

/// A line along an edge, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeLine {
    pub(crate) ends: [DVec3; 2],
    pub(crate) color: Color,
    /// Pixels.
    pub(crate) width: f32,
    /// Whether the section takes away what is before its plane.
    pub(crate) cut: bool,
}

/// Pixels. Thinner: outlines break up in small pictures; thicker: threads turn black.
const OUTLINE: f32 = 1.25;
const WIRE: f32 = 1.0;
const RIM: f32 = 1.75;

/// Outlines are this much darker than what they outline.
const DARKER: f32 = 0.12;

/// Of one instance, seen from `eye`.
pub(crate) fn edge_lines(instance: &Instance, shading: Shading, eye: DVec3) -> Vec<EdgeLine> {
    let wires = instance.style == Style::Wireframe;
    if !wires && !shading.outlines {
        return Vec::new();
    }
    let mesh = &instance.mesh;
    let world_from_body = instance.pose.world_from_body();
    let faces_eye: Vec<bool> = if wires { Vec::new() } else { facing(instance, eye) };
    let is_drawn = |edge: &crate::edges::Edge| {
        wires
            || edge.crease
            || edge.faces.is_some_and(|[a, b]| faces_eye[a as usize] != faces_eye[b as usize])
    };
    let width = if wires { WIRE } else { OUTLINE };
    let color = if wires { instance.color } else { outline_color(instance.color) };
    let cut = instance.cut;
    let edges = mesh.edges().all.iter().filter(|edge| is_drawn(edge));
    edges
        .map(|edge| {
            let ends = edge.ends.map(|v| world_from_body.apply(mesh.position(v)));
            EdgeLine { ends, color, width, cut }
        })
        .collect()
}

/// Of each face of an instance: whether its outside is seen.
fn facing(instance: &Instance, eye: DVec3) -> Vec<bool> {
    let mesh = &instance.mesh;
    let eye = instance.pose.world_from_body().inverse().apply(eye);
    let corners = mesh.indices().chunks_exact(3).map(|face| mesh.position(face[0]));
    mesh.normals().zip(corners).map(|(normal, corner)| normal.dot(eye - corner) > 0.0).collect()
}

fn outline_color(of: Color) -> Color {
    let [r, g, b, a] = of.to_linear();
    Color::from_linear([r * DARKER, g * DARKER, b * DARKER, a.max(0.35) * 0.85])
}

/// Where the section's plane cuts an instance.
pub(crate) fn section_lines(instance: &Instance, section: &Section) -> Vec<EdgeLine> {
    let color = outline_color(instance.color).with_alpha(255);
    let line = |ends| EdgeLine { ends, color, width: RIM, cut: false };
    section.segments(instance).map(line).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use cranny_exact::Pose;

    use super::*;
    use crate::mesh::DrawMesh;

    /// A roof of two slopes, `height` high, over two unit squares.
    fn roof(height: f64) -> Instance {
        let at = |x: f64, y: f64| DVec3::new(x, y, if x == 0.0 { height } else { 0.0 });
        let vertices =
            [at(-1.0, 0.0), at(-1.0, 1.0), at(0.0, 0.0), at(0.0, 1.0), at(1.0, 0.0), at(1.0, 1.0)];
        let faces = [[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]];
        let mesh = DrawMesh::new(&vertices, &faces).unwrap();
        Instance::solid(Arc::new(mesh), Pose::IDENTITY, Color::WHITE)
    }

    fn ridges(instance: &Instance, shading: Shading, eye: DVec3) -> usize {
        let lines = edge_lines(instance, shading, eye);
        lines.iter().filter(|line| line.ends.iter().all(|p| p.x.abs() < 1e-6)).count()
    }

    #[test]
    fn outlines_are_creases_and_silhouettes() {
        let above = DVec3::new(0.0, 0.5, 9.0);
        let aside = DVec3::new(9.0, 0.5, 0.1);
        // A ridge of 23 degrees is none, one of 90 is; from aside, only one slope of it is seen.
        assert_eq!(ridges(&roof(0.2), Shading::FULL, above), 0);
        assert_eq!(ridges(&roof(1.0), Shading::FULL, above), 1);
        assert_eq!(ridges(&roof(0.2), Shading::FULL, aside), 1);
        assert_eq!(ridges(&roof(1.0), Shading::PLAIN, aside), 0);
    }

    #[test]
    fn a_wireframe_has_every_edge_once_without_shading() {
        let wires = Instance { style: Style::Wireframe, ..roof(0.2) };
        assert_eq!(edge_lines(&wires, Shading::PLAIN, DVec3::Z).len(), 9);
    }
}
