//! A solid of revolution against a mesh: where the signed distance from it is locally least on the
//! mesh.
//!
//! On each face, edge and vertex within reach the place is sought where the solid is nearest, or,
//! where they overlap, where the mesh lies deepest in it. It counts if nothing around it on the
//! mesh is nearer, as for a ball: so a cylinder that rolls over a tessellated floor feels the facet
//! beneath it and no inner edge. The normal there is that of the face, or the solid's own; the
//! separation is how far the solid reaches along it.
//!
//! What lies flat touches everywhere alike. So each direction found is followed by more contacts
//! along it (`spread`): what the rims lie over, and what of the mesh lies under a flat end.

use std::collections::BTreeSet;

use cranny_exact::DVec3;
use cranny_geometry::triangle_distance::{Part, closest_on_triangle};
use cranny_geometry::{EdgeId, FaceId, HalfEdgeId, Model, VertexId};
use cranny_narrow_phase::{Contact, Feature, reduce_contacts};

use super::spread::spread;
use crate::inside::{enclosing, outward_normal};
use crate::normal_cone::is_least;
use crate::revolved::Revolved;

/// Cosine of the angle (0.08 degrees) within which a foot's normal is that of a plane. Larger: what
/// lies on its side has contacts at its ends only; smaller: feet off the plane's normal are taken
/// for those on it.
const ALONG: f64 = 1.0 - 1e-6;

/// Of what a body without thickness is stuck in, the ways out that are so many times as long as the
/// shortest still count. Larger: it is pulled to several sides; smaller: one end of two alone.
const NEARLY_SHORTEST: f64 = 2.0;

/// Cosine of the angle (45 degrees) between such ways, and the shortest one, at most.
const SAME_SIDE: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// A share of the solid's extent. What overlaps by less touches, and needs no way out. Smaller:
/// what rounding makes of touching is led; larger: what overlaps so much has no contact where none
/// is nearest.
const TOUCH: f64 = 1e-6;

/// A share of the greatest depth in a core. What lies as deep as that goes through its midst, and
/// rounding chooses its side. Larger: ways out lead to either side, as long as the solid; smaller:
/// normals that are still clear are left out.
const THROUGH: f64 = 0.99;

/// A share of the solid's extent, squared: area vectors that add up to less have no direction.
/// Larger: a clear way is not taken; smaller: rounding chooses one.
const BALANCED: f64 = 1e-3;

/// The greatest depth of the contact that leads out of a deep overlap, as a share of the solid's
/// extent. Larger: a solver shoots it out; smaller: it takes longer.
const LED_DEPTH: f64 = 0.15;

/// Faces, edges and vertices of a model near a solid.
pub(super) struct Near {
    pub(super) faces: Vec<FaceId>,
    pub(super) edges: BTreeSet<EdgeId>,
    pub(super) vertices: BTreeSet<VertexId>,
}

impl Near {
    fn to(model: &Model, solid: &Revolved, reach: f64) -> Self {
        let own = solid.bounds();
        let mut faces = Vec::new();
        model.tree().visit(|b| solid.may_reach(&own, b, reach), |face| faces.push(face));
        faces.sort_unstable();
        let sides = faces.iter().flat_map(|&f| (0..3).map(move |i| HalfEdgeId::of(f, i)));
        Self {
            edges: sides.map(|side| model.topology().edge_of(side)).collect(),
            vertices: faces.iter().flat_map(|&f| model.mesh().corners(f)).collect(),
            faces,
        }
    }
}

/// Contacts of a solid of revolution in the model's frame.
pub(super) fn revolved_contacts(model: &Model, solid: &Revolved, reach: f64) -> Vec<Contact> {
    let near = Near::to(model, solid, reach);
    let bare = solid.is_thin() && solid.radius() == 0.0;
    if !bare && let Some(out) = out_of_a_solid(model, solid) {
        return vec![out];
    }
    let mut contacts = least(model, solid, &near, reach);
    if bare {
        // Nothing is deeper in it than its surface: where it passes through, there is no nearest
        // place.
        contacts.retain(|c| c.separation >= -TOUCH * solid.extent());
        contacts.extend(stuck(model, solid, &near, reach));
        if let Some(out) = contacts.is_empty().then(|| out_of_a_solid(model, solid)).flatten() {
            return vec![out];
        }
    }
    let more = spread(model, solid, &near, reach, &contacts);
    contacts.extend(more);
    contacts.extend(out_of_the_midst(model, solid, &near, &contacts));
    reduce_contacts(contacts)
}

/// The contact that leads a capsule out whose axis is inside, where no other contact does.
pub(super) fn deep_contact(
    model: &Model,
    solid: &Revolved,
    contacts: &[Contact],
) -> Option<Contact> {
    out_of_the_midst(model, solid, &Near::to(model, solid, 0.0), contacts)
}

/// The contact of a feature through its point, with the solid's outward normal towards it.
fn contact(solid: &Revolved, feature: Feature, on_mesh: DVec3, outward: DVec3) -> Contact {
    let separation = outward.dot(on_mesh) - solid.core_reach(outward) - solid.radius();
    Contact {
        id: (feature, Feature::Face(FaceId(0))),
        point_a: on_mesh,
        point_b: on_mesh - outward * separation,
        normal: -outward,
        separation,
    }
}

/// Contacts where the signed distance is locally least.
fn least(model: &Model, solid: &Revolved, near: &Near, reach: f64) -> Vec<Contact> {
    let (mesh, edges) = (model.mesh(), model.topology().edges());
    let through = THROUGH * solid.core_foot(solid.middle()).signed.min(-TOUCH * solid.extent());
    let at_vertices = near.vertices.iter().map(|&v| {
        let p = mesh.position(v);
        contact(solid, Feature::Vertex(v), p, solid.core_foot(p).outward)
    });
    let on_edges = near.edges.iter().filter_map(|&e| {
        let ends = [edges[e.index()].from, edges[e.index()].to].map(|v| mesh.position(v));
        let least = solid.least_on_segment(ends);
        let inner = least.at > 0.0 && least.at < 1.0;
        let p = ends[0] + (ends[1] - ends[0]) * least.at;
        let counts = inner && least.foot.signed >= through;
        counts.then(|| Some(contact(solid, Feature::Edge(e), p, least.outward?))).flatten()
    });
    let on_faces = near.faces.iter().filter_map(|&f| {
        let corners = mesh.triangle(f);
        let normal = mesh.area_vector(f).try_normalize()?;
        let least = solid.least_on_plane(corners[0], normal);
        let outward = least.outward?;
        if closest_on_triangle(least.point, &corners).1 != Part::Inside {
            return None;
        }
        // Of what lies flat or on its side the point beneath, not an end.
        let foot = solid.core_foot(least.point);
        if foot.signed < through {
            return None;
        }
        let on_core = match foot.outward.dot(outward) > ALONG {
            true => foot.point,
            false => solid.core_support(outward),
        };
        let on_mesh = on_core + outward * outward.dot(corners[0] - on_core);
        Some(contact(solid, Feature::Face(f), on_mesh, outward))
    });
    at_vertices
        .chain(on_edges)
        .chain(on_faces)
        .filter(|c| c.separation <= reach && is_least(model, c.id.0, c.normal))
        .collect()
}

/// The contact that leads a solid out whose middle is inside the model, through the nearest point
/// of its surface.
fn out_of_a_solid(model: &Model, solid: &Revolved) -> Option<Contact> {
    let middle = solid.middle();
    let foot = enclosing(model, middle)?;
    let out = (foot.point - middle)
        .try_normalize()
        .unwrap_or_else(|| outward_normal(model, foot.feature));
    Some(contact(solid, foot.feature, foot.point, -out))
}

/// The contact that leads out a solid that overlaps so deeply that nothing on the mesh is nearest:
/// along the sum of the area vectors of the faces in it.
fn out_of_the_midst(
    model: &Model,
    solid: &Revolved,
    near: &Near,
    contacts: &[Contact],
) -> Option<Contact> {
    if contacts.iter().any(|c| c.separation < 0.0) {
        return None;
    }
    let (mesh, extent) = (model.mesh(), solid.extent() + solid.radius());
    let touch = TOUCH * extent;
    let pierced = if solid.is_thin() { touch } else { f64::NEG_INFINITY };
    let deep = (solid.radius() - touch).max(pierced);
    let (mut outward, mut beside) = (DVec3::ZERO, DVec3::ZERO);
    let mut places: Vec<(FaceId, DVec3)> = Vec::new();
    for &face in &near.faces {
        let least = solid.least_on_triangle(&mesh.triangle(face));
        if least.signed > deep {
            continue;
        }
        let out = mesh.area_vector(face);
        let to_middle = solid.middle() - least.point;
        let away = !model.topology().in_closed_component(face) && out.dot(to_middle) < 0.0;
        let share = (extent * extent / out.length()).min(1.0);
        outward += if away { -out * share } else { out * share };
        beside += to_middle;
        places.push((face, least.point));
    }
    let balanced = outward.length() < BALANCED * extent * extent;
    let way = if balanced { beside } else { outward }.try_normalize()?;
    let all = places.iter().map(|&(face, p)| contact(solid, Feature::Face(face), p, -way));
    let whole = all.min_by(|x, y| x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id)))?;
    let (point, separation) = (whole.point_a, whole.separation.max(-LED_DEPTH * extent).min(0.0));
    Some(Contact { point_b: point + way * separation, separation, ..whole })
}

/// Contacts of a segment or a disc, which has no inside to be met in: where it is in the mesh's
/// material, near the surface, it goes back the shortest way.
fn stuck(model: &Model, solid: &Revolved, near: &Near, reach: f64) -> Vec<Contact> {
    let (mesh, edges) = (model.mesh(), model.topology().edges());
    // From the mesh's point to the solid's, against the mesh's outward normal.
    let back = |feature: Feature, on_mesh: DVec3, on_solid: DVec3| {
        let normal = (on_mesh - on_solid).try_normalize()?;
        let closed = match feature {
            Feature::Face(f) => model.topology().in_closed_component(f),
            Feature::Edge(e) => {
                let sides = model.topology().half_edges(e);
                sides.iter().all(|h| model.topology().in_closed_component(h.face()))
            }
            Feature::Vertex(_) => return None,
        };
        let separation = -on_mesh.distance(on_solid);
        let id = (feature, Feature::Face(FaceId(0)));
        let found = Contact { id, point_a: on_mesh, point_b: on_solid, normal, separation };
        (closed && -separation <= reach && is_least(model, feature, normal)).then_some(found)
    };
    let on_edges = near.edges.iter().filter_map(|&e| {
        let ends = [edges[e.index()].from, edges[e.index()].to].map(|v| mesh.position(v));
        let least = solid.least_on_segment(ends);
        let p = ends[0] + (ends[1] - ends[0]) * least.at;
        if least.at > 0.0 && least.at < 1.0 {
            back(Feature::Edge(e), p, least.foot.point)
        } else {
            None
        }
    });
    let on_faces = near.faces.iter().flat_map(|&f| {
        let corners = mesh.triangle(f);
        let normal = mesh.area_vector(f).normalize_or_zero();
        let ends: Vec<DVec3> = solid.rims(-normal).collect();
        ends.into_iter().filter_map(move |p| {
            let height = normal.dot(p - corners[0]);
            let on_mesh = p - normal * height;
            let over = closest_on_triangle(on_mesh, &corners).1 == Part::Inside;
            if height < 0.0 && over { back(Feature::Face(f), on_mesh, p) } else { None }
        })
    });
    let mut all: Vec<Contact> = on_edges.chain(on_faces).collect();
    let shortest = all.iter().max_by(|x, y| x.separation.total_cmp(&y.separation)).copied();
    if let Some(shortest) = shortest {
        all.retain(|c| {
            c.separation >= NEARLY_SHORTEST * shortest.separation
                && c.normal.dot(shortest.normal) > SAME_SIDE
        });
    }
    all
}
