//! Where findings are: the faces concerned in colours, a dot at each.

use cranny_geometry::{Element, FaceId, Finding, FindingKind};
use cranny_render::{Mark, Point, palette};

use super::canvas::{Canvas, GREY};
use super::coloring;
use super::enclosed::lay_bare_what_is_enclosed;

/// Pixels.
const DOT: f32 = 4.0;

/// Kinds in colours. A face of several findings has the colour of the last.
pub(super) fn draw_findings(canvas: &mut Canvas<'_>, findings: &[Finding]) {
    lay_bare_what_is_enclosed(canvas);
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
    for (color, kind) in kinds.iter().enumerate() {
        let meaning = kind.name().replace('_', " ");
        canvas.explain(&coloring::name(color), Mark::Body(palette(color)), meaning);
    }
    if kinds.is_empty() {
        canvas.remark("nothing was found");
    } else {
        canvas.explain("grey", Mark::Body(GREY), "faces of no finding");
        canvas.remark("dots: where");
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
            // The first is what was found; others are those that it lies in.
            for (face, painted) in (0..).map(FaceId).zip(&mut canvas.faces) {
                if finding.ids.first() == Some(&topology.component_of(face).0) {
                    *painted = palette(color);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_concavity::Concavities;
    use cranny_geometry::{BuildOptions, Mesh, Model};
    use cranny_shapes::Cuboid;

    #[test]
    fn a_cavity_is_painted_and_what_is_around_it_is_not() {
        let outer = Cuboid { size: [8.0; 3] }.build().unwrap();
        let inner = Cuboid { size: [6.0; 3] }.build().unwrap();
        let inward = inner.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let inward = Mesh::new(inner.vertices().to_vec(), inward).unwrap();
        let options = BuildOptions::default();
        let (model, report) = Model::build(outer.joined(&inward), &options).unwrap();
        let is_cavity = |f: &&Finding| f.kind == FindingKind::Cavity;
        let cavity: Vec<Finding> = report.findings.iter().filter(is_cavity).cloned().collect();
        assert_eq!(cavity[0].ids, [1, 0]);
        let concavities = Concavities::of(&model);
        let mut canvas = Canvas::new(&model, &concavities);
        draw_findings(&mut canvas, &cavity);
        let painted: Vec<bool> = canvas.faces.iter().map(|&c| c == palette(0)).collect();
        assert_eq!(painted, [[false; 12], [true; 12]].concat());
    }
}
