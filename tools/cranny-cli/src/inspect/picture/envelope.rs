//! Layers of envelopes: the convex cores that they enclose, and what lies beneath each facet.

use cranny_concavity::envelope::{EnvelopeFacet, HalfSpace};
use cranny_concavity::{Concavities, EnvelopeFacetId, Envelopes, LayerId};
use cranny_exact::{Aabb, DVec3};
use cranny_geometry::FaceId;
use cranny_render::{Mark, palette};

use super::canvas::{Canvas, GREY};
use super::enclosed::lay_bare_what_is_enclosed;

/// Pixels.
const OUTLINE: f32 = 1.5;

/// A facet to be drawn.
struct Shown {
    facet: EnvelopeFacetId,
    /// Counter-clockwise seen from the pocket; empty where other facets cut all of it away.
    polygon: Vec<DVec3>,
}

/// The facets of the layers at a depth, and the faces in the colours of the facets that they lie
/// beneath; where an envelope ends before, its last layer.
pub(super) fn draw_layer(canvas: &mut Canvas<'_>, depth: usize) {
    let envelopes = canvas.concavities.envelopes();
    let mut shown = Vec::new();
    for index in 0..envelopes.len() {
        let envelope = envelopes.envelope(index);
        if let Some(first) = envelope.first_layer() {
            collect(envelopes, first, depth, envelope.bounds(), envelope.lids(), &mut shown);
        }
    }
    let mut facet_of = vec![None; canvas.faces.len()];
    for (number, Shown { facet, .. }) in (0..).zip(&shown) {
        for face in envelopes.faces_beneath(*facet) {
            facet_of[face.index()] = Some(number);
        }
    }
    let colors = canvas.paint(|face: FaceId| facet_of[face.index()], shown.len());
    for (Shown { polygon, .. }, color) in shown.iter().zip(colors) {
        canvas.add_glass(polygon, palette(color));
        canvas.add_loop(polygon, palette(color), OUTLINE);
    }
    lay_bare_what_is_enclosed(canvas);
    canvas.remark(found(depth, &shown));
    canvas.remark(
        "beyond all facets of a layer lies a convex core, which touches no face beneath them",
    );
    canvas.remark("faces have the colour of the facet that they lie beneath");
    let mark = Mark::Body(GREY);
    canvas.explain("grey", mark, "faces on the hull, or beneath no facet of this layer");
}

/// How many facets there are, and why some, or all, are not seen.
fn found(depth: usize, shown: &[Shown]) -> String {
    let drawn = shown.iter().filter(|facet| !facet.polygon.is_empty()).count();
    let why = match (drawn, shown.len() - drawn) {
        (_, 0) => String::new(),
        (0, _) => ", none of which is drawn: the layer leaves no room beneath it".to_owned(),
        (_, hidden) => {
            format!(", {hidden} of which are not drawn: what is beyond them is beneath others")
        }
    };
    let (count, facets) = (shown.len(), if shown.len() == 1 { "facet" } else { "facets" });
    format!("layers of the envelopes at depth {depth}, translucent: {count} {facets}{why}")
}

/// How deep the envelopes' layers nest, 0 where there is one beneath each cap.
pub(super) fn last_depth(concavities: &Concavities) -> usize {
    let all = concavities.envelopes();
    let first = (0..all.len()).filter_map(|index| all.envelope(index).first_layer());
    let mut open: Vec<(LayerId, usize)> = first.map(|layer| (layer, 0)).collect();
    let mut last = 0;
    while let Some((layer, depth)) = open.pop() {
        last = last.max(depth);
        let beneath = all.layer(layer).filter_map(|facet| all.layer_beneath(facet));
        open.extend(beneath.map(|layer| (layer, depth + 1)));
    }
    last
}

fn collect(
    all: &Envelopes,
    layer: LayerId,
    depth: usize,
    within: &Aabb,
    limits: &[HalfSpace],
    shown: &mut Vec<Shown>,
) {
    for facet in all.layer(layer) {
        let EnvelopeFacet { beneath, bounds, .. } = all.facet(facet);
        match all.layer_beneath(facet).filter(|_| depth > 0) {
            Some(next) => collect(all, next, depth - 1, bounds, &[*beneath], shown),
            None => {
                let mut polygon = square(beneath, within);
                clip_to_box(&mut polygon, within);
                for limit in limits {
                    clip(&mut polygon, limit.normal, limit.offset);
                }
                for other in all.layer(layer).filter(|&other| other != facet) {
                    let HalfSpace { normal, offset } = all.facet(other).beneath;
                    clip(&mut polygon, -normal, -offset);
                }
                shown.push(Shown { facet, polygon });
            }
        }
    }
}

/// A square of the half-space's boundary that covers all of it within the box.
fn square(plane: &HalfSpace, bounds: &Aabb) -> Vec<DVec3> {
    let HalfSpace { normal, offset } = *plane;
    let center = bounds.center();
    let middle = center + (offset - normal.dot(center)) * normal;
    let (u, v) = normal.any_orthonormal_pair();
    let reach = bounds.diagonal();
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, y)| middle + reach * (x * u + y * v))
        .to_vec()
}

fn clip_to_box(polygon: &mut Vec<DVec3>, bounds: &Aabb) {
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        clip(polygon, axis, bounds.max.dot(axis));
        clip(polygon, -axis, -bounds.min.dot(axis));
    }
}

/// Keeps what has `normal · x <= offset` of a convex polygon (Sutherland and Hodgman 1974).
pub(super) fn clip(polygon: &mut Vec<DVec3>, normal: DVec3, offset: f64) {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &to) in polygon.iter().enumerate() {
        let from = polygon[(i + polygon.len() - 1) % polygon.len()];
        let [before, after] = [from, to].map(|p| normal.dot(p) - offset);
        if (before > 0.0) != (after > 0.0) {
            kept.push(from + before / (before - after) * (to - from));
        }
        if after <= 0.0 {
            kept.push(to);
        }
    }
    *polygon = kept;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(polygon: &[DVec3]) -> f64 {
        let fan = (2..polygon.len())
            .map(|i| (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]));
        0.5 * fan.sum::<DVec3>().length()
    }

    #[test]
    fn a_plane_is_cut_to_its_part_of_a_box() {
        let bounds = Aabb { min: DVec3::ZERO, max: DVec3::new(2.0, 3.0, 4.0) };
        let level = HalfSpace { normal: DVec3::Z, offset: 1.0 };
        let mut polygon = square(&level, &bounds);
        clip_to_box(&mut polygon, &bounds);
        assert!((area(&polygon) - 6.0).abs() < 1e-12, "{polygon:?}");
        let counter_clockwise = (polygon[1] - polygon[0]).cross(polygon[2] - polygon[1]);
        assert!(counter_clockwise.z > 0.0);
        clip(&mut polygon, DVec3::X, 0.5);
        assert!((area(&polygon) - 1.5).abs() < 1e-12, "{polygon:?}");
        clip(&mut polygon, DVec3::X, -1.0);
        assert!(polygon.is_empty());
        clip(&mut polygon, DVec3::X, 9.0);
        assert!(polygon.is_empty());
    }

    #[test]
    fn why_facets_are_not_drawn_is_said() {
        let shown = |corners: &[usize]| -> Vec<Shown> {
            let of =
                |&n: &usize| Shown { facet: EnvelopeFacetId(0), polygon: vec![DVec3::ZERO; n] };
            corners.iter().map(of).collect()
        };
        assert!(found(0, &shown(&[3, 4])).ends_with("at depth 0, translucent: 2 facets"));
        assert!(found(0, &shown(&[3, 0])).contains("2 facets, 1 of which are not drawn"));
        assert!(found(2, &shown(&[0, 0])).contains("2 facets, none of which is drawn: the layer"));
    }
}
