//! Which directions a feature of a body can be touched along, judged in the full mesh.
//!
//! A contact is real only where its direction lies in the cones of outward normals of both
//! features: what a vertex in the middle of a floor, or the diagonal of a square, would stop is
//! stopped by what stands around it, and sideways by nothing.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, HalfEdgeId, VertexId};

use crate::pair::{Pair, Side};

/// By how much, as a sine (30 degrees), a vertex's neighbours may be nearer to a face that the
/// vertex stands before. Smaller: a tilted box loses the corners that will touch next; larger: flat
/// vertices of a floor stop what slides along it.
const NEIGHBOUR_LEAD: f64 = 0.5;

/// How far outside the wedge of an edge's two faces a direction may lie and still count as within,
/// as a sine. Zero would drop contacts of smooth meshes by rounding.
pub(crate) const WEDGE_SLACK: f64 = 1e-9;

/// Squared sine of the angle below which two edges count as parallel: their nearest points are not
/// unique, and vertices stand for them. Larger: crossed edges at small angles are missed; smaller:
/// the contact's normal is lost in rounding.
pub(crate) const PARALLEL: f64 = 1e-6;

/// Whether a point that is as far from a face's plane as `height` (times the length of `raw`, the
/// plane's normal) stands over its rim rather than beside it.
pub(crate) fn over(height: f64, separation: f64, raw: DVec3) -> bool {
    height >= (1.0 - WEDGE_SLACK) * separation * raw.length()
}

/// A direction of the pair's frame in that of one of the bodies, where nothing needs to be posed.
fn local(pair: &Pair, side: Side, direction: DVec3) -> DVec3 {
    match side {
        Side::First => direction,
        Side::Second => pair.first_from_second.linear.transpose() * direction,
    }
}

/// Whether a direction rises along an edge by more than a sine.
fn rises(direction: DVec3, edge: DVec3, sine: f64) -> bool {
    let along = direction.dot(edge);
    along > 0.0 && along * along > sine * sine * edge.length_squared()
}

/// Whether a vertex can be what touches along `direction`: some face at it looks that way (the
/// back of a thin part does not touch), and no neighbour is much farther that way (a vertex in
/// the middle of a floor is not what stops a box that slides along it).
pub(crate) fn faces_towards(pair: &Pair, side: Side, vertex: VertexId, direction: DVec3) -> bool {
    looks_towards(pair, side, vertex, local(pair, side, direction), NEIGHBOUR_LEAD)
}

/// Whether all edges at a vertex fall away from a direction that does not lead into the body.
pub(crate) fn in_cone(pair: &Pair, side: Side, vertex: VertexId, direction: DVec3) -> bool {
    looks_towards(pair, side, vertex, local(pair, side, direction), WEDGE_SLACK)
}

/// Whether some face at a vertex looks along a direction of its body's frame, and no neighbour
/// leads by more than a sine.
fn looks_towards(pair: &Pair, side: Side, vertex: VertexId, direction: DVec3, lead: f64) -> bool {
    let mesh = pair.mesh(side);
    let faces = pair.topology(side).faces_at(vertex);
    let p = mesh.position(vertex);
    let (mut looks, mut leads) = (false, false);
    for &face in faces {
        let edges = mesh.triangle(face).map(|q| q - p);
        leads |= edges.iter().any(|&edge| rises(direction, edge, lead));
        if leads {
            return false;
        }
        // Of the three edges from the vertex one is nothing; the outer product of the others is the
        // face's.
        let [a, b, c] = edges;
        looks |= ((b - a).cross(c - a)).dot(direction) > 0.0;
    }
    looks
}

/// The outward normals of the faces at an edge, in the body's frame: what contacts of the edge are
/// judged by.
pub(crate) struct Ridge {
    /// Their sum.
    mean: DVec3,
    /// The edge is more than a line drawn on a plane.
    pub(crate) is_sharp: bool,
}

impl Ridge {
    pub(crate) fn of(pair: &Pair, side: Side, edge: EdgeId) -> Self {
        let mesh = pair.mesh(side);
        let normal = |h: &HalfEdgeId| mesh.area_vector(h.face()).normalize_or_zero();
        let around = pair.topology(side).half_edges(edge);
        let [h, g] = around else {
            return Self { mean: around.iter().map(normal).sum(), is_sharp: true };
        };
        let (n, m) = (normal(h), normal(g));
        let is_sharp = n.dot(m) <= 0.0 || n.cross(m).length() > WEDGE_SLACK;
        Self { mean: n + m, is_sharp }
    }

    /// Whether a direction of the body's frame does not lead into the body. At a reflex edge both
    /// faces fall away from what leads inside. The sum of the normals decides; each of them by
    /// itself would refuse half of what a sharp edge can touch.
    pub(crate) fn leads_out(&self, direction: DVec3) -> bool {
        self.mean.dot(direction) >= 0.0
    }
}

/// Whether a direction lies between the outward normals of an edge's faces: both faces fall away
/// from it, and it does not lead into the body.
pub(crate) fn in_wedge(pair: &Pair, side: Side, edge: EdgeId, direction: DVec3) -> bool {
    let direction = local(pair, side, direction);
    Ridge::of(pair, side, edge).leads_out(direction) && faces_fall_away(pair, side, edge, direction)
}

/// Whether all faces at an edge fall away from a direction of the body's frame.
fn faces_fall_away(pair: &Pair, side: Side, edge: EdgeId, direction: DVec3) -> bool {
    let (mesh, around) = (pair.mesh(side), pair.topology(side).half_edges(edge));
    around.iter().all(|&h| {
        let corners = mesh.triangle(h.face());
        let start = corners[h.corner()];
        let along = (corners[(h.corner() + 1) % 3] - start).normalize_or_zero();
        let apex = corners[(h.corner() + 2) % 3] - start;
        !rises(direction, apex - along * along.dot(apex), WEDGE_SLACK)
    })
}

/// The direction, of a unit vector of the pair's frame and its opposite, along which two edges face
/// each other.
pub(crate) fn edges_face(pair: &Pair, [e, g]: [EdgeId; 2], unit: DVec3) -> Option<DVec3> {
    let (ridge_e, ridge_g) = (Ridge::of(pair, Side::First, e), Ridge::of(pair, Side::Second, g));
    if !ridge_e.is_sharp || !ridge_g.is_sharp {
        return None;
    }
    let back = local(pair, Side::Second, unit);
    [(unit, back), (-unit, -back)].into_iter().find_map(|(n, m)| {
        let faces = ridge_e.leads_out(n)
            && ridge_g.leads_out(-m)
            && faces_fall_away(pair, Side::First, e, n)
            && faces_fall_away(pair, Side::Second, g, -m);
        faces.then_some(n)
    })
}
