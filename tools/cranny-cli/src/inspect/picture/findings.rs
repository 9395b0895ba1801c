//! Where findings are: the faces concerned in colours, a dot at each.

use cranny_geometry::{Element, FaceId, Finding, FindingKind};
use cranny_render::{Point, palette};

use super::canvas::Canvas;
use super::coloring;

/// Pixels.
const DOT: f32 = 4.0;

/// Kinds in colours. A face of several findings has the colour of the last.
pub(super) fn draw_findings(canvas: &mut Canvas<'_>, findings: &[Finding]) {
    let mut kinds: Vec<FindingKind> = Vec::new();
    for finding in findings {
        let color = kinds.iter().position(|&kind| kind == finding.kind).unwrap_or_else(|| {
            kinds.push(finding.kind);
            kinds.len() - 1
        });
        paint_faces(canvas, finding, color);
        let (position, color) = (finding.at, palette(color));
        canvas.list.points.push(Point { position, color, radius: DOT, on_top: true });
    }
    let words = kinds.iter().enumerate().map(|(color, kind)| {
        format!("{}: {}", coloring::name(color), kind.name().replace('_', " "))
    });
    canvas.legend.extend(words);
    if !kinds.is_empty() {
        canvas.legend.push("dots: where; grey: faces of no finding".to_owned());
    }
    if kinds.is_empty() {
        canvas.legend.push("nothing was found".to_owned());
    }
}

fn paint_faces(canvas: &mut Canvas<'_>, finding: &Finding, color: usize) {
    let topology = canvas.model.topology();
    match finding.kind.element() {
        Element::Vertex => {}
        Element::Face => {
            for &face in &finding.ids {
                canvas.faces[face as usize] = palette(color);
            }
        }
        Element::Component => {
            for (face, painted) in (0..).map(FaceId).zip(&mut canvas.faces) {
                if finding.ids.contains(&topology.component_of(face).0) {
                    *painted = palette(color);
                }
            }
        }
    }
}
