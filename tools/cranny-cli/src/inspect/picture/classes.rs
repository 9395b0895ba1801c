//! What lies on the hull and what does not: classes, patches, boxes.

use cranny_concavity::Concavities;
use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{Content, EdgeId};
use cranny_render::{Color, Mark, Point, palette};

use super::canvas::{Canvas, GREY, INK, LINE_WIDTH, lightened};
use super::enclosed::lay_bare_what_is_enclosed;

const HULL: Color = Color { r: 40, g: 90, b: 170, a: 120 };

/// Of caps: no concavity is drawn so strong.
const CAP: Color = Color::rgb(235, 145, 0);

/// With more facets than this, their outlines would cover the picture.
const OUTLINED_FACETS: usize = 2_000;

/// Pixels.
const THIN: f32 = 1.0;
const BOX_WIDTH: f32 = 1.8;

/// Concavities in colours, each beneath its translucent cap, and their boundary loops.
pub(super) fn draw_classes(canvas: &mut Canvas<'_>) {
    let model = canvas.model;
    let mesh = model.mesh();
    let colors = draw_concavities(canvas);
    for cap in canvas.concavities.caps() {
        if cap.concavity.is_some() {
            canvas.add_glass(&cap.corners.map(|v| mesh.position(v)), CAP);
        }
    }
    if !colors.is_empty() {
        canvas.explain("amber", Mark::Body(CAP), "caps, translucent");
    }
    draw_facets(canvas);
    let isolated = canvas.concavities.features().isolated_vertices();
    if !isolated.is_empty() {
        canvas.remark("dark dots: vertices on the hull without a face on it");
    }
    for &vertex in isolated {
        let position = mesh.position(vertex);
        canvas.list.points.push(Point { position, color: INK, radius: 4.0, on_top: false });
    }
}

/// Patches in colours, and their borders.
pub(super) fn draw_patches(canvas: &mut Canvas<'_>) {
    let model = canvas.model;
    let patches = model.patches();
    canvas.paint(|face| Some(patches.patch_of_face(face).0), patches.len());
    lay_bare_what_is_enclosed(canvas);
    for (id, edge) in (0..).map(EdgeId).zip(model.topology().edges()) {
        let mut around = model.topology().half_edges(id).iter();
        let first = around.next().map(|h| patches.patch_of_face(h.face()));
        if around.any(|h| Some(patches.patch_of_face(h.face())) != first) {
            let [from, to] = [edge.from, edge.to].map(|vertex| model.mesh().position(vertex));
            canvas.list.push_line(from, to, INK, THIN);
        }
    }
    let count = patches.len();
    canvas.remark(format!("{count} patches in colours; neighbours differ; dark lines: borders"));
}

/// The boxes of one level of the concavities' trees; of branches that end before, the leaves.
pub(super) fn draw_boxes(canvas: &mut Canvas<'_>, level: usize) {
    let colors = draw_concavities(canvas);
    // Pale, or the boxes would not show before faces of their own colour.
    for face in &mut canvas.faces {
        *face = lightened(*face);
    }
    let first = canvas.list.lines.len();
    let mut count = 0;
    for (tree, &color) in colors.iter().enumerate() {
        for bounds in boxes(canvas.concavities, tree, level) {
            canvas.list.push_box(&bounds, palette(color), BOX_WIDTH);
            count += 1;
        }
    }
    canvas.let_lines_shine_through(first);
    canvas.remark(format!(
        "boxes of level {level} of the concavities' trees: {count}, in the colour of theirs"
    ));
}

/// The last level of the concavities' trees.
pub(super) fn last_level(concavities: &Concavities) -> usize {
    let trees = concavities.trees();
    let mut open: Vec<_> = (0..trees.len()).filter_map(|t| trees.root(t)).map(|n| (n, 0)).collect();
    let mut last = 0;
    while let Some((node, level)) = open.pop() {
        last = last.max(level);
        if let Content::Inner { left, right } = trees.arena().content(node) {
            open.extend([(left, level + 1), (right, level + 1)]);
        }
    }
    last
}

fn boxes(concavities: &Concavities, tree: usize, level: usize) -> Vec<Aabb> {
    let trees = concavities.trees();
    let mut open: Vec<_> = trees.root(tree).map(|root| (root, 0)).into_iter().collect();
    let mut found = Vec::new();
    while let Some((node, depth)) = open.pop() {
        match trees.arena().content(node) {
            Content::Inner { left, right } if depth < level => {
                open.extend([(right, depth + 1), (left, depth + 1)]);
            }
            _ => found.push(trees.arena().node(node).bounds),
        }
    }
    found
}

/// The faces of concavities in colours, and their loops. Returns the colours.
fn draw_concavities(canvas: &mut Canvas<'_>) -> Vec<usize> {
    let (mesh, concavities) = (canvas.model.mesh(), canvas.concavities);
    let colors = canvas.paint(|face| concavities.of_face(face).map(|id| id.0), concavities.len());
    canvas.explain("grey", Mark::Body(GREY), "faces on the hull");
    canvas.explain_colors(["concavity", "concavities"], &colors);
    lay_bare_what_is_enclosed(canvas);
    for rim in concavities.iter().flat_map(|concavity| concavity.loops()) {
        let corners: Vec<DVec3> = rim.vertices.iter().map(|&v| mesh.position(v)).collect();
        canvas.add_loop(&corners, INK, LINE_WIDTH);
    }
    if !colors.is_empty() {
        canvas.explain("dark lines", Mark::Line(INK), "boundary loops");
    }
    colors
}

/// The outlines of the hull's facets, each edge once.
fn draw_facets(canvas: &mut Canvas<'_>) {
    let hull = canvas.model.hull();
    if hull.facet_count() > OUTLINED_FACETS {
        return;
    }
    for (id, facet) in (0..).zip(hull.facets()) {
        let next = facet.corners.iter().cycle().skip(1);
        for ((&from, &to), neighbour) in facet.corners.iter().zip(next).zip(facet.neighbours) {
            if neighbour.0 > id {
                canvas.list.push_line(hull.position(from), hull.position(to), HULL, THIN);
            }
        }
    }
    canvas.explain("thin blue lines", Mark::Line(HULL.with_alpha(u8::MAX)), "edges of the hull");
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::Cup;

    #[test]
    fn boxes_divide_level_by_level_until_the_leaves() {
        let mesh = Cup::default().build().unwrap();
        let model = Model::build(mesh, &BuildOptions::default()).unwrap().0;
        let concavities = Concavities::of(&model);
        for level in 0..4 {
            assert_eq!(boxes(&concavities, 0, level).len(), 1 << level);
        }
        let leaves = concavities.trees().nodes(0).len().div_ceil(2);
        assert_eq!(boxes(&concavities, 0, 1_000).len(), leaves);
    }
}
