//! The last resort: every exact triangle that can matter against every other.
//!
//! It decides what rounding leaves open (touching, overlaps and gaps of a few units in the last
//! place, hulls without an interior) by exact predicates on the posed, rounded vertices, and finds
//! the nearest pair where the walk lost its way. A direction culls: with `h` an upper bound of the
//! distance, nearest and common points of the first hull lie no lower than the second's lowest
//! point less `h`, and those of the second no higher than the first's highest plus `h`. O(n) where
//! the direction is good, O(n m) at worst. Counted, so that whoever relies on the walk sees it.

use cranny_exact::{DVec3, Meeting, Sign, classify_triangles, orient3d};
use cranny_geometry::hull::{FacetId, HullKind, HullVertexId, Location};

use super::graph::{FeatureGraph, HullFeature};
use super::sides::Sides;
use cranny_geometry::triangle_distance::{Part, triangle_distance};

/// An exact triangle in the first's frame.
struct Piece {
    corners: [DVec3; 3],
    vertices: [HullVertexId; 3],
    facet: Option<FacetId>,
}

/// What looking at everything found.
pub(super) struct Exhausted {
    /// How the closed hulls meet: exact for the posed, rounded vertices. A hull inside the other
    /// crosses.
    pub(super) meeting: Meeting,
    /// The nearest points (where they meet, points of a triangle pair that does) and their
    /// features.
    pub(super) points: [DVec3; 2],
    pub(super) pair: [HullFeature; 2],
}

pub(super) fn exhaust(sides: &Sides, direction: DVec3) -> Exhausted {
    let unit = direction.normalize_or(DVec3::X);
    let pieces = [0, 1].map(|side| pieces(sides, side));
    let heights = |side: usize| pieces[side].iter().flat_map(|p| p.corners).map(|p| unit.dot(p));
    let top = heights(0).fold(f64::NEG_INFINITY, f64::max);
    let bottom = heights(1).fold(f64::INFINITY, f64::min);
    let near = [pieces[0][0].corners[0], pieces[1][0].corners[0]];
    let mut found = Exhausted {
        meeting: Meeting::None,
        points: near,
        pair: [
            HullFeature::Vertex(pieces[0][0].vertices[0]),
            HullFeature::Vertex(pieces[1][0].vertices[0]),
        ],
    };
    let within = least_span(&pieces, unit, top, bottom) + 4.0 * sides.rounding;
    let of_first = candidates(&pieces[0], |p| unit.dot(p) >= bottom - within);
    let of_second = candidates(&pieces[1], |p| unit.dot(p) <= top + within);
    let mut nearest = f64::INFINITY;
    for a in &of_first {
        for b in &of_second {
            let meeting = classify_triangles(&a.corners, &b.corners);
            let distance = triangle_distance(&a.corners, &b.corners);
            let squared = if meeting.meets() { 0.0 } else { distance.squared };
            if meeting > found.meeting || (meeting == found.meeting && squared < nearest) {
                nearest = squared;
                let [of_a, of_b] = distance.parts;
                let pair = [feature(sides.graph(0), a, of_a), feature(sides.graph(1), b, of_b)];
                found = Exhausted { meeting, points: distance.points, pair };
            }
            if meeting == Meeting::Cross {
                return found;
            }
        }
    }
    if !found.meeting.meets() && one_holds_the_other(sides, &pieces) {
        found.meeting = Meeting::Cross;
    }
    found
}

/// An upper bound of the distance: that between the highest corner of the first and the lowest of
/// the second.
fn least_span(pieces: &[Vec<Piece>; 2], unit: DVec3, top: f64, bottom: f64) -> f64 {
    let find = |side: usize, height: f64| {
        pieces[side].iter().flat_map(|p| p.corners).find(|p| unit.dot(*p) == height)
    };
    match (find(0, top), find(1, bottom)) {
        (Some(p), Some(q)) => p.distance(q),
        _ => f64::INFINITY,
    }
}

fn pieces(sides: &Sides, side: usize) -> Vec<Piece> {
    let piece = |(vertices, facet): ([HullVertexId; 3], Option<FacetId>)| Piece {
        corners: vertices.map(|v| sides.vertex_in(0, side, v)),
        vertices,
        facet,
    };
    FeatureGraph::triangles(sides.hulls[side].hull).map(piece).collect()
}

/// Pieces one of whose corners will do.
fn candidates(pieces: &[Piece], corner: impl Fn(DVec3) -> bool) -> Vec<&Piece> {
    pieces.iter().filter(|piece| piece.corners.iter().any(|p| corner(*p))).collect()
}

/// Whether a hull lies in the interior of the other. Their surfaces share no point, so any vertex
/// decides.
fn one_holds_the_other(sides: &Sides, pieces: &[Vec<Piece>; 2]) -> bool {
    let in_first = sides.hulls[0].hull.locate(pieces[1][0].corners[0]) == Location::Inside;
    let p = pieces[0][0].corners[0];
    let below = |piece: &Piece| {
        let [a, b, c] = piece.corners;
        orient3d(a, b, c, p) == Sign::Negative
    };
    let is_volume = sides.hulls[1].hull.kind() == HullKind::Volume;
    in_first || (is_volume && pieces[1].iter().all(below))
}

/// The feature of the merged layer that holds a part of an exact triangle.
fn feature(graph: &FeatureGraph, piece: &Piece, part: Part) -> HullFeature {
    let corner = |i: u8| piece.vertices[usize::from(i) % 3];
    let edge_between = |v, w| {
        graph
            .fan(v)
            .find(|(_, h)| h.ends[1] == w)
            .map(|(id, _)| HullFeature::Edge(graph.edge_of(id)))
    };
    let inside = |v| piece.facet.map_or(HullFeature::Vertex(v), HullFeature::Facet);
    match part {
        Part::Corner(i) => HullFeature::Vertex(corner(i)),
        Part::Edge(i) => {
            edge_between(corner(i), corner(i + 1)).unwrap_or_else(|| inside(corner(i)))
        }
        Part::Inside => inside(corner(0)),
    }
}
