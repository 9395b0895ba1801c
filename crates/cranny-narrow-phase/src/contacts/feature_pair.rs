//! The contact of one feature of each body: a pure function of the two features and the pose.
//!
//! Every contact has the normal of its own point: a vertex before a face that of the face, two
//! edges their cross product, what is beside a face the line between the two points. Whether the
//! features face each other is judged in the full mesh (`facing`), so no border of a patch makes a
//! contact.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, FaceId, Model, VertexId};

use super::facing::{PARALLEL, edges_face, faces_towards, in_cone, in_wedge, over};
use crate::answer::{Contact, Feature};
use crate::pair::{Pair, Side};
use cranny_geometry::triangle_distance::{Part, closest_on_segments, closest_on_triangle};

/// The patch that a feature counts to.
pub(crate) fn patch_index(model: &Model, feature: Feature) -> u32 {
    let (patches, topology) = (model.patches(), model.topology());
    match feature {
        // A vertex of a contact is a corner of a face, and has a patch.
        Feature::Vertex(v) => patches.patch_of_vertex(topology, v).map_or(u32::MAX, |p| p.0),
        Feature::Edge(e) => patches.patch_of_edge(topology, e).0,
        Feature::Face(f) => patches.patch_of_face(f).0,
    }
}

/// Where a vertex stands with respect to a face.
pub(crate) enum Stand {
    /// Before its inside (or straight before its rim); `None` where they do not face each other.
    Over(Option<Contact>),
    /// Nearest to a corner or side of it.
    Beside(Part),
}

/// A vertex of `side`, at `p`, before a face of the other body, of these corners; not behind its
/// plane (but for rounding), no farther than `below`.
pub(crate) fn vertex_face(
    pair: &Pair,
    side: Side,
    (vertex, p): (VertexId, DVec3),
    (face, triangle): (FaceId, &[DVec3; 3]),
    below: f64,
) -> Stand {
    let raw = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    let (foot, part) = closest_on_triangle(p, triangle);
    let (height, apart) = (raw.dot(p - triangle[0]), (p - foot).length());
    if apart > below + pair.length_error() {
        return Stand::Over(None);
    }
    // A face without area has no inside to stand over.
    if part != Part::Inside && (raw == DVec3::ZERO || !over(height, apart, raw)) {
        return Stand::Beside(part);
    }
    let Some(outward) = raw.try_normalize() else { return Stand::Over(None) };
    let separation = if height < 0.0 { -apart } else { apart };
    // Lengths first: which way features face costs more to decide.
    let real = separation <= below
        && separation >= -pair.length_error()
        && faces_towards(pair, side, vertex, -outward);
    let features = [Feature::Vertex(vertex), Feature::Face(face)];
    Stand::Over(real.then(|| side.contact(features, [p, foot], -outward, separation)))
}

/// A vertex before an edge or a vertex of the other body, no farther than `below`, where both are
/// the nearest of their bodies.
pub(crate) fn vertex_rim(
    pair: &Pair,
    side: Side,
    vertex: VertexId,
    rim: Feature,
    below: f64,
) -> Option<Contact> {
    let other = side.other();
    let p = pair.position(side, vertex);
    let foot = match rim {
        Feature::Vertex(w) => pair.position(other, w),
        Feature::Edge(e) => {
            let [start, end] = pair.segment(other, e);
            let t = closest_on_segments(&[p, p], &[start, end]).1;
            if t <= 0.0 || t >= 1.0 {
                return None;
            }
            start + (end - start) * t
        }
        Feature::Face(_) => return None,
    };
    let separation = (foot - p).length();
    if separation <= pair.length_error() || separation > below {
        return None;
    }
    let towards = (foot - p) / separation;
    let faced = in_cone(pair, side, vertex, towards)
        && match rim {
            Feature::Vertex(w) => in_cone(pair, other, w, -towards),
            Feature::Edge(e) => in_wedge(pair, other, e, -towards),
            Feature::Face(_) => false,
        };
    faced.then(|| side.contact([Feature::Vertex(vertex), rim], [p, foot], towards, separation))
}

/// Two edges that cross when seen along their common normal, no farther than `below` (or rounding)
/// apart; the separation is negative where the solids beneath them overlap.
pub(crate) fn edge_edge(pair: &Pair, e: EdgeId, g: EdgeId, below: f64) -> Option<Contact> {
    let (p, q) = (pair.segment(Side::First, e), pair.segment(Side::Second, g));
    let (d1, d2) = (p[1] - p[0], q[1] - q[0]);
    let cross = d1.cross(d2);
    let squared = cross.length_squared();
    if squared <= PARALLEL * d1.length_squared() * d2.length_squared() {
        return None;
    }
    let lift = cross.dot(q[0] - p[0]);
    let reach = below + pair.length_error();
    if lift * lift > reach * reach * squared {
        return None;
    }
    let (s, t) = closest_on_segments(&p, &q);
    let open = |x: f64| x > 0.0 && x < 1.0;
    // A flat edge touches nothing before its ends do, or the edges around it.
    if !open(s) || !open(t) {
        return None;
    }
    let (point_a, point_b) = (p[0] + d1 * s, q[0] + d2 * t);
    let unit = cross / squared.sqrt();
    // Lengths first: which way features face costs more to decide.
    if unit.dot(point_b - point_a).abs() > below.max(pair.length_error()) {
        return None;
    }
    let normal = edges_face(pair, [e, g], unit)?;
    let separation = normal.dot(point_b - point_a);
    Some(Contact { id: (Feature::Edge(e), Feature::Edge(g)), point_a, point_b, normal, separation })
}
