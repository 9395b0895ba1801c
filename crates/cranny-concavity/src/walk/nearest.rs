//! The nearest points of two features, and the direction between them.
//!
//! Where the features nearly touch, the difference of the points is all rounding. So the direction
//! is built from what the features *are*: a facet's normal, the cross product of two edges, a
//! difference made square to an edge.

use cranny_exact::DVec3;
use cranny_geometry::hull::{FacetId, HullVertexId};

use super::graph::{HullEdgeId, HullFeature};
use super::sides::Sides;
use cranny_geometry::triangle_distance::closest_on_segments;

/// Squared sine of the angle between two edges below which their cross product does not give the
/// direction between them better than their points do. Smaller, and needle-thin angles give crooked
/// directions; larger, and edges that cross at real angles lose digits near touching. Either way
/// only the width of an interval suffers: both directions are tried where the first does not do.
const NEARLY_PARALLEL: f64 = 1.0 / (1u64 << 40) as f64;

/// A point on each hull.
pub(super) struct Witnesses {
    /// In the first's frame.
    pub(super) points: [DVec3; 2],
    /// From the first to the second, in the first's frame, of any length.
    pub(super) direction: DVec3,
    /// How far the points may be from the exact hulls, beyond rounding: a facet's thickness.
    pub(super) slack: f64,
}

/// The nearest points of a pair. `None` where a vertex does not lie over the facet or beside the
/// edge (the pair is not closest then), or for two facets.
#[inline]
pub(super) fn witnesses(sides: &Sides, pair: [HullFeature; 2]) -> Option<Witnesses> {
    use HullFeature::{Edge, Facet, Vertex};
    match pair {
        [Vertex(v), Vertex(w)] => {
            let points = [sides.vertex_in(0, 0, v), sides.vertex_in(0, 1, w)];
            Some(Witnesses { points, direction: points[1] - points[0], slack: 0.0 })
        }
        [Vertex(v), Edge(e)] => beside_edge(sides, 0, v, e),
        [Edge(e), Vertex(v)] => beside_edge(sides, 1, v, e),
        [Vertex(v), Facet(f)] => over_facet(sides, 0, v, f),
        [Facet(f), Vertex(v)] => over_facet(sides, 1, v, f),
        [Edge(e), Edge(f)] => between_edges(sides, e, f),
        _ => None,
    }
}

/// In order (first, second), and from first to second, in the first's frame: what was made in the
/// frame of the other side than `vertex_side`.
#[inline]
fn in_first_frame(
    sides: &Sides,
    vertex_side: usize,
    vertex: HullVertexId,
    foot: DVec3,
    foot_to_vertex: DVec3,
    slack: f64,
) -> Witnesses {
    let other = 1 - vertex_side;
    let at_vertex = sides.vertex_in(0, vertex_side, vertex);
    let foot = sides.point_in(0, other, foot);
    let rising = sides.vector_in(0, other, foot_to_vertex);
    let (points, direction) =
        if vertex_side == 0 { ([at_vertex, foot], -rising) } else { ([foot, at_vertex], rising) };
    Witnesses { points, direction, slack }
}

#[inline]
fn beside_edge(
    sides: &Sides,
    vertex_side: usize,
    vertex: HullVertexId,
    edge: HullEdgeId,
) -> Option<Witnesses> {
    let other = 1 - vertex_side;
    let h = &sides.graph(other).half_edges[edge.index()];
    let arm = sides.vertex_in(other, vertex_side, vertex) - h.from;
    let per_square = 1.0 / h.along.length_squared();
    let t = arm.dot(h.along) * per_square;
    if !(0.0..=1.0).contains(&t) {
        return None;
    }
    let foot = h.from + t * h.along;
    let rough = arm - t * h.along;
    let square = rough - (rough.dot(h.along) * per_square) * h.along;
    Some(in_first_frame(sides, vertex_side, vertex, foot, square, 0.0))
}

#[inline]
fn over_facet(
    sides: &Sides,
    vertex_side: usize,
    vertex: HullVertexId,
    facet: FacetId,
) -> Option<Witnesses> {
    let other = 1 - vertex_side;
    let graph = sides.graph(other);
    let plane = &graph.facets[facet.index()];
    let p = sides.vertex_in(other, vertex_side, vertex);
    let mut nearest = (f64::NEG_INFINITY, None);
    for (_, h) in graph.around(facet) {
        let beyond = h.outward.dot(p - h.from);
        if beyond > nearest.0 {
            nearest = (beyond, Some(h));
        }
    }
    let (beyond, edge) = nearest;
    if beyond > sides.rounding {
        return None;
    }
    // Beside the rim rounding may have put the foot outside of a sharp corner: a point of the rim
    // itself is on the hull for certain.
    let (foot, slack) = match edge {
        Some(h) if beyond > -sides.rounding => {
            let t = (p - h.from).dot(h.along) / h.along.length_squared();
            (h.from + t.clamp(0.0, 1.0) * h.along, 0.0)
        }
        _ => (p - (plane.normal.dot(p) - plane.offset) * plane.normal, plane.thickness),
    };
    Some(in_first_frame(sides, vertex_side, vertex, foot, plane.normal, slack))
}

#[inline]
fn between_edges(sides: &Sides, first: HullEdgeId, second: HullEdgeId) -> Option<Witnesses> {
    let [u, w] = [0, 1].map(|i| edge_vector(sides, i, [first, second][i]));
    let p = sides.graph(0).half_edges[first.index()].from;
    let q = sides.point_in(0, 1, sides.graph(1).half_edges[second.index()].from);
    let (s, t) = closest_on_segments(&[p, p + u], &[q, q + w]);
    let points = [p + s * u, q + t * w];
    let across = u.cross(w);
    let crooked =
        across.length_squared() <= NEARLY_PARALLEL * u.length_squared() * w.length_squared();
    let direction = if crooked {
        made_square(points, [u, w])
    } else {
        outward(sides, first, across, points[1] - points[0])
    };
    Some(Witnesses { points, direction, slack: 0.0 })
}

/// For two edges, whichever of the two directions between them was not the first choice.
pub(super) fn second_choice(
    sides: &Sides,
    pair: [HullFeature; 2],
    first_choice: &Witnesses,
) -> Option<DVec3> {
    let [HullFeature::Edge(first), HullFeature::Edge(second)] = pair else { return None };
    let [u, w] = [0, 1].map(|i| edge_vector(sides, i, [first, second][i]));
    let square = made_square(first_choice.points, [u, w]);
    if square == first_choice.direction {
        let difference = first_choice.points[1] - first_choice.points[0];
        return Some(outward(sides, first, u.cross(w), difference));
    }
    Some(square)
}

fn edge_vector(sides: &Sides, side: usize, edge: HullEdgeId) -> DVec3 {
    sides.vector_in(0, side, sides.graph(side).half_edges[edge.index()].along)
}

/// The difference of two points, made square to one vector and then to another.
fn made_square([p, q]: [DVec3; 2], edges: [DVec3; 2]) -> DVec3 {
    edges.iter().fold(q - p, |d, u| d - (d.dot(*u) / u.length_squared()) * u)
}

/// Turns a direction across an edge of the first hull so that it points out of that hull. What is
/// normal to an edge and points outward lies between the normals of its facets, hence on the
/// positive side of their sum and of that of the directions out of the facets; one of the sums
/// never vanishes. The difference of the points serves only where there are no facets: it may be
/// all rounding.
fn outward(sides: &Sides, edge: HullEdgeId, across: DVec3, difference: DVec3) -> DVec3 {
    let graph = sides.graph(0);
    let [left, right] = graph.both_halves(edge);
    let reference = match (left.facet(), right.facet()) {
        (Some(f), Some(g)) => {
            let normals = graph.facets[f.index()].normal + graph.facets[g.index()].normal;
            normals + left.outward + right.outward
        }
        _ => difference,
    };
    if across.dot(reference) < 0.0 { -across } else { across }
}
