//! A ball or a capsule against a mesh: where the distance to the mesh is locally least.
//!
//! Of all features within reach only those count whose nearest point is nearest among its
//! neighbours: a point inside a face, a point of an edge from which both faces fall away, a vertex
//! from which all edges do. So a ball on a tessellated floor feels the facet beneath it and no
//! inner edge. Features whose way to the centre leads through their own solid, as the far side of a
//! plate, do not count either. A centre inside is pushed out through the nearest point.

use std::collections::HashSet;

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::triangle_distance::{closest_on_segments, closest_on_triangle};
use cranny_geometry::{EdgeId, HalfEdgeId, Model, VertexId};
use cranny_narrow_phase::{Contact, Feature, reduce_contacts};

use crate::inside::{NearestPoint, enclosing, leaves, outward_normal};
use crate::normal_cone::is_least;

/// Sine of the tilt up to which a capsule's end touches an edge although the axis comes nearer to
/// it. Larger: ends press sideways against what the middle lies across; smaller: a capsule that
/// lies along an edge stands on one end at a time.
const END_SLACK: f64 = 0.1;

/// The shape's only feature at an end: capsules have two, balls one.
fn end(index: u32) -> Feature {
    Feature::Vertex(VertexId(index))
}

/// Contacts of a ball (centre in the model's frame).
pub(super) fn ball_contacts(model: &Model, center: DVec3, radius: f64, reach: f64) -> Vec<Contact> {
    reduce_contacts(swept_end(model, center, radius, reach, end(0)))
}

/// Contacts of a capsule: of the balls at its ends, and of its axis between them with edges and
/// vertices.
pub(super) fn capsule_contacts(
    model: &Model,
    axis: [DVec3; 2],
    radius: f64,
    reach: f64,
) -> Vec<Contact> {
    let along = (axis[1] - axis[0]).normalize_or_zero();
    let mut contacts = Vec::new();
    for (index, inward) in [(0, along), (1, -along)] {
        let found = swept_end(model, axis[index], radius, reach, end(index as u32));
        // Where the axis comes nearer to an edge or a vertex than its end does, the axis stands for
        // it.
        contacts.extend(
            found.into_iter().filter(|c| {
                matches!(c.id.0, Feature::Face(_)) || c.normal.dot(inward) >= -END_SLACK
            }),
        );
    }
    let window = Aabb::of_points(axis).grown(radius + reach);
    let mut edges: Vec<EdgeId> = Vec::new();
    let mut vertices: Vec<VertexId> = Vec::new();
    model.tree().visit(
        |b| b.overlaps(&window),
        |face| {
            edges.extend((0..3).map(|i| model.topology().edge_of(HalfEdgeId::of(face, i))));
            vertices.extend(model.mesh().corners(face));
        },
    );
    edges.sort_unstable();
    edges.dedup();
    vertices.sort_unstable();
    vertices.dedup();
    let between = |feature: Feature, q: DVec3, p: DVec3| {
        let normal = (p - q).try_normalize()?;
        let id = (feature, Feature::Edge(EdgeId(0)));
        is_least(model, feature, normal).then(|| contact(id, q, p, normal, radius, reach)).flatten()
    };
    let open = |x: f64| x > 0.0 && x < 1.0;
    contacts.extend(edges.into_iter().filter_map(|edge| {
        let e = model.topology().edges()[edge.index()];
        let ends = [model.mesh().position(e.from), model.mesh().position(e.to)];
        let (s, t) = closest_on_segments(&ends, &axis);
        let (q, p) = (ends[0] + (ends[1] - ends[0]) * s, axis[0] + (axis[1] - axis[0]) * t);
        // The ends' balls and the vertices stand for the rest.
        if open(s) && open(t) { between(Feature::Edge(edge), q, p) } else { None }
    }));
    contacts.extend(vertices.into_iter().filter_map(|vertex| {
        let q = model.mesh().position(vertex);
        let t = (q - axis[0]).dot(axis[1] - axis[0]) / (axis[1] - axis[0]).length_squared();
        let p = axis[0] + (axis[1] - axis[0]) * t;
        if open(t) { between(Feature::Vertex(vertex), q, p) } else { None }
    }));
    reduce_contacts(contacts)
}

fn contact(
    id: (Feature, Feature),
    on_mesh: DVec3,
    center: DVec3,
    normal: DVec3,
    radius: f64,
    reach: f64,
) -> Option<Contact> {
    let separation = normal.dot(center - on_mesh) - radius;
    (separation <= reach).then(|| Contact {
        id,
        point_a: on_mesh,
        point_b: center - normal * radius,
        normal,
        separation,
    })
}

fn swept_end(model: &Model, center: DVec3, radius: f64, reach: f64, own: Feature) -> Vec<Contact> {
    let window = Aabb::of_points([center]).grown(radius + reach);
    let mut seen: HashSet<Feature> = HashSet::new();
    let mut feet: Vec<NearestPoint> = Vec::new();
    model.tree().visit(
        |b| b.overlaps(&window),
        |face| {
            let (point, part) = closest_on_triangle(center, &model.mesh().triangle(face));
            let feature = Feature::of_part(part, model, face);
            let squared = (point - center).length_squared();
            if squared <= (radius + reach) * (radius + reach) && seen.insert(feature) {
                feet.push(NearestPoint { feature, point, squared });
            }
        },
    );
    feet.sort_by(|x, y| x.squared.total_cmp(&y.squared).then(x.feature.cmp(&y.feature)));
    let inside = match feet.first() {
        Some(nearest) => {
            (!leaves(model, nearest.feature, center - nearest.point)).then_some(*nearest)
        }
        // Nothing within reach: in the open, or deep inside.
        None => enclosing(model, center),
    };
    if let Some(nearest) = inside {
        let way = (nearest.point - center).try_normalize();
        let normal = way.unwrap_or_else(|| outward_normal(model, nearest.feature));
        return contact((nearest.feature, own), nearest.point, center, normal, radius, reach)
            .into_iter()
            .collect();
    }
    feet.iter()
        .filter_map(|foot| {
            let normal = (center - foot.point).try_normalize()?;
            is_least(model, foot.feature, normal)
                .then(|| contact((foot.feature, own), foot.point, center, normal, radius, reach))?
        })
        .collect()
}
