//! A ball or a capsule against a mesh: where the distance to the mesh is locally least.
//!
//! Of all features within reach only those count whose nearest point is nearest among its neighbours:
//! a point inside a face, a point of an edge from which both faces fall away, a vertex from which all
//! edges do. So a ball on a tessellated floor feels the facet beneath it and no inner edge. A centre
//! behind the surface is pushed out through the nearest point, along the outward normal there.

use std::collections::HashSet;

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{EdgeId, FaceId, HalfEdgeId, Model, VertexId};
use cranny_narrow_phase::{
    Contact, Feature, closest_on_segments, closest_on_triangle, reduce_contacts,
};

/// Slack, as a sine, of 'falls away from': without it rounding would drop contacts at flat edges.
const FALLS_AWAY: f64 = 1e-9;

/// The partner's only feature at an end: capsules have two, balls one.
fn end(index: u32) -> Feature {
    Feature::Vertex(VertexId(index))
}

/// Contacts of a ball (centre in the model's frame).
pub(crate) fn ball_contacts(model: &Model, center: DVec3, radius: f64, reach: f64) -> Vec<Contact> {
    reduce_contacts(swept_end(model, center, radius, reach, end(0)))
}

/// Contacts of a capsule: of the balls at its ends, and of its axis with edges between them.
pub(crate) fn capsule_contacts(
    model: &Model,
    axis: [DVec3; 2],
    radius: f64,
    reach: f64,
) -> Vec<Contact> {
    let mut contacts = swept_end(model, axis[0], radius, reach, end(0));
    contacts.extend(swept_end(model, axis[1], radius, reach, end(1)));
    let window = Aabb::of_points(axis).grown(radius + reach);
    let mut edges: HashSet<EdgeId> = HashSet::new();
    model.tree().visit(
        |b| b.overlaps(&window),
        |face| edges.extend((0..3).map(|i| model.topology().edge_of(HalfEdgeId::of(face, i)))),
    );
    let mut edges: Vec<EdgeId> = edges.into_iter().collect();
    edges.sort_unstable();
    for edge in edges {
        let e = model.topology().edges()[edge.index()];
        let ends = [model.mesh().position(e.from), model.mesh().position(e.to)];
        let (s, t) = closest_on_segments(&ends, &axis);
        let open = |x: f64| x > 0.0 && x < 1.0;
        if !open(s) || !open(t) {
            continue; // the ends' balls and the vertices stand for it
        }
        let (q, p) = (ends[0] + (ends[1] - ends[0]) * s, axis[0] + (axis[1] - axis[0]) * t);
        if let Some(normal) = (p - q).try_normalize()
            && falls_away(model, edge, normal)
        {
            let id = (Feature::Edge(edge), Feature::Edge(EdgeId(0)));
            contacts.extend(contact(id, q, p, normal, radius, reach));
        }
    }
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

/// A feature of the mesh and its point nearest to a centre.
struct Foot {
    feature: Feature,
    point: DVec3,
    squared: f64,
}

fn swept_end(model: &Model, center: DVec3, radius: f64, reach: f64, own: Feature) -> Vec<Contact> {
    let window = Aabb::of_points([center]).grown(radius + reach);
    let mut seen: HashSet<Feature> = HashSet::new();
    let mut feet: Vec<Foot> = Vec::new();
    model.tree().visit(
        |b| b.overlaps(&window),
        |face| {
            let (point, part) = closest_on_triangle(center, &model.mesh().triangle(face));
            let feature = part.feature(model, face);
            let squared = (point - center).length_squared();
            if squared <= (radius + reach) * (radius + reach) && seen.insert(feature) {
                feet.push(Foot { feature, point, squared });
            }
        },
    );
    feet.sort_by(|x, y| x.squared.total_cmp(&y.squared).then(x.feature.cmp(&y.feature)));
    let Some(nearest) = feet.first() else { return Vec::new() };
    let outward = outward_normal(model, nearest.feature);
    if model.is_closed() && outward.dot(center - nearest.point) <= 0.0 {
        // Inside, or exactly on the surface: out through the nearest point.
        let normal = (nearest.point - center).try_normalize().unwrap_or(outward);
        return contact((nearest.feature, own), nearest.point, center, normal, radius, reach)
            .into_iter()
            .collect();
    }
    feet.iter()
        .filter_map(|foot| {
            let normal = (center - foot.point).try_normalize()?;
            let least = match foot.feature {
                Feature::Face(_) => true,
                Feature::Edge(e) => falls_away(model, e, normal),
                Feature::Vertex(v) => edges_fall_away(model, v, normal),
            };
            least
                .then(|| contact((foot.feature, own), foot.point, center, normal, radius, reach))?
        })
        .collect()
}

/// Sum of the unit normals around a feature, weighted by the angle at a vertex: the sign of its
/// product with the way to a point tells inside from outside (Bærentzen and Aanæs 2005).
fn outward_normal(model: &Model, feature: Feature) -> DVec3 {
    let mesh = model.mesh();
    let unit = |f: FaceId| mesh.area_vector(f).normalize_or_zero();
    match feature {
        Feature::Face(f) => unit(f),
        Feature::Edge(e) => model
            .topology()
            .half_edges(e)
            .iter()
            .map(|h| unit(h.face()))
            .sum::<DVec3>()
            .normalize_or_zero(),
        Feature::Vertex(v) => {
            let weighted = model.topology().faces_at(v).iter().map(|&f| {
                let corners = mesh.corners(f);
                let k = corners.iter().position(|&c| c == v).unwrap_or(0);
                let at = |i: usize| mesh.position(corners[(k + i) % 3]);
                let (a, b) = (at(1) - at(0), at(2) - at(0));
                unit(f) * a.angle_between(b)
            });
            weighted.sum::<DVec3>().normalize_or_zero()
        }
    }
}

/// Whether both faces at an edge fall away from a direction.
fn falls_away(model: &Model, edge: EdgeId, direction: DVec3) -> bool {
    let mesh = model.mesh();
    model.topology().half_edges(edge).iter().all(|h| {
        let corners = mesh.triangle(h.face());
        let start = corners[h.corner()];
        let along = (corners[(h.corner() + 1) % 3] - start).normalize_or_zero();
        let to_apex = corners[(h.corner() + 2) % 3] - start;
        let into = to_apex - along * along.dot(to_apex);
        direction.dot(into) <= FALLS_AWAY * into.length()
    })
}

/// Whether all edges at a vertex fall away from a direction.
fn edges_fall_away(model: &Model, vertex: VertexId, direction: DVec3) -> bool {
    let mesh = model.mesh();
    let p = mesh.position(vertex);
    model.topology().faces_at(vertex).iter().flat_map(|&f| mesh.corners(f)).all(|w| {
        let along = mesh.position(w) - p;
        direction.dot(along) <= FALLS_AWAY * along.length()
    })
}
