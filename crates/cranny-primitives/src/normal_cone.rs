//! Whether a feature is the nearest one around itself for what lies in a direction: whether the
//! direction is in the feature's normal cone.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, Model, VertexId};
use cranny_narrow_phase::Feature;

use crate::inside::leaves;

/// Slack, as a sine, of 'falls away from': without it rounding would drop contacts at flat edges.
const FALLS_AWAY: f64 = 1e-9;

/// Whether a feature's point is the nearest around it of what a unit way leads to from it, outside.
pub(crate) fn is_least(model: &Model, feature: Feature, way: DVec3) -> bool {
    is_least_within(model, feature, way, FALLS_AWAY)
}

/// [`is_least`], where a way may lean by a slack, as a sine.
pub(crate) fn is_least_within(model: &Model, feature: Feature, way: DVec3, slack: f64) -> bool {
    let least = match feature {
        Feature::Face(_) => true,
        Feature::Edge(e) => falls_away(model, e, way, slack),
        Feature::Vertex(v) => edges_fall_away(model, v, way, slack),
    };
    least && leaves(model, feature, way)
}

/// Whether both faces at an edge fall away from a direction, but for a slack.
fn falls_away(model: &Model, edge: EdgeId, direction: DVec3, slack: f64) -> bool {
    let mesh = model.mesh();
    model.topology().half_edges(edge).iter().all(|h| {
        let corners = mesh.triangle(h.face());
        let start = corners[h.corner()];
        let along = (corners[(h.corner() + 1) % 3] - start).normalize_or_zero();
        let to_apex = corners[(h.corner() + 2) % 3] - start;
        let into = to_apex - along * along.dot(to_apex);
        direction.dot(into) <= slack * into.length()
    })
}

/// Whether all edges at a vertex fall away from a direction, but for a slack.
fn edges_fall_away(model: &Model, vertex: VertexId, direction: DVec3, slack: f64) -> bool {
    let mesh = model.mesh();
    let p = mesh.position(vertex);
    model.topology().faces_at(vertex).iter().flat_map(|&f| mesh.corners(f)).all(|w| {
        let along = mesh.position(w) - p;
        direction.dot(along) <= slack * along.length()
    })
}
