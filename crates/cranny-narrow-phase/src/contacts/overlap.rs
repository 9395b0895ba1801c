//! Contacts where solids overlap: each vertex inside has its way out, each crossing of edges its depth.
//!
//! Vertices inside are reached from the faces that cross, along edges, and told exactly. The nearest
//! point of the other surface is the shortest local way out; at a face its direction is the face's
//! normal. Edges that cross, each dipping under the other, are parted along their common normal.
//!
//! What this does not see is left to the caller: a tip that has passed the middle of a thin part, whose
//! far side is nearer than the one it came in by, has no contact here.

use cranny_exact::{DVec3, WeightedPoint};
use cranny_geometry::clusters::may_be_ridge;
use cranny_geometry::{Content, EdgeId, FaceId, VertexId};

use super::facing::faces_towards;
use super::feature_pair::edge_edge;
use super::within::vertices_within;
use crate::answer::{Contact, Counters, Feature};
use crate::inside::{Location, locate};
use crate::numbering::Numbering;
use crate::pair::{Pair, Side};
use crate::surface::FacePair;
use crate::triangle_distance::{Part, closest_on_triangle};

/// How much farther than the nearest way out the faces at the other edge may be from a point of an edge that
/// crosses it: 1 where edges cross locally, however sharp they are, and a little more where these faces are
/// smaller than the overlap is deep. Smaller: finely cut edges get no contact; larger: edges on opposite sides of
/// a thin bar are pressed through it.
const DETOUR: f64 = 2.0;

/// The nearest point of a surface.
struct Nearest {
    distance: f64,
    foot: DVec3,
    feature: Feature,
    face: FaceId,
}

/// All contacts of negative separation that vertices and edges about the crossing faces make.
pub(super) fn overlaps(pair: &Pair, meeting: &[FacePair], counters: &mut Counters) -> Vec<Contact> {
    let mut contacts = Vec::new();
    for side in Side::BOTH {
        if pair.model(side.other()).is_closed() {
            vertices_inside(pair, side, meeting, counters, &mut contacts);
        }
    }
    if Side::BOTH.iter().all(|&side| pair.model(side).is_closed()) {
        edges_crossing(pair, meeting, counters, &mut contacts);
    }
    contacts
}

fn is_inside(pair: &Pair, side: Side, p: DVec3, counters: &mut Counters) -> bool {
    locate(pair, side, &WeightedPoint::at(p), counters) == Location::Inside
}

fn vertices_inside(
    pair: &Pair,
    side: Side,
    meeting: &[FacePair],
    counters: &mut Counters,
    contacts: &mut Vec<Contact>,
) {
    // Neighbours are nearest to neighbours.
    let mut last = None;
    for vertex in vertices_within(pair, side, meeting, counters) {
        let p = pair.position(side, vertex);
        contacts.extend(way_out(pair, side, vertex, p, &mut last, counters));
    }
}

/// The contact of a vertex inside the other solid with the nearest point of its surface.
fn way_out(
    pair: &Pair,
    side: Side,
    vertex: VertexId,
    p: DVec3,
    last: &mut Option<FaceId>,
    counters: &mut Counters,
) -> Option<Contact> {
    let nearest = nearest_on(pair, side.other(), p, last, counters);
    let outward = match nearest.feature {
        Feature::Face(face) => pair.normal(side.other(), face),
        _ if nearest.distance > pair.length_error() => (nearest.foot - p) / nearest.distance,
        // On a rim to rounding: the face that was found there is as good as its neighbours.
        _ => pair.normal(side.other(), nearest.face),
    };
    if outward == DVec3::ZERO || !faces_towards(pair, side, vertex, -outward) {
        return None;
    }
    let told = Contact {
        id: (Feature::Vertex(vertex), nearest.feature),
        point_a: p,
        point_b: nearest.foot,
        normal: -outward,
        separation: -nearest.distance,
    };
    Some(if side == Side::First { told } else { told.swapped() })
}

fn edges_crossing(
    pair: &Pair,
    meeting: &[FacePair],
    counters: &mut Counters,
    contacts: &mut Vec<Contact>,
) {
    let mut ridges = Side::BOTH.map(Ridges::of);
    let mut crossing: Vec<(EdgeId, EdgeId)> = Vec::new();
    for p in meeting {
        let others = ridges[1].of_face(pair, p.second);
        for e in ridges[0].of_face(pair, p.first).into_iter().flatten() {
            crossing.extend(others.into_iter().flatten().map(|g| (e, g)));
        }
    }
    crossing.sort_unstable();
    crossing.dedup();
    let mut last = [None; 2];
    for (e, g) in crossing {
        let Some(contact) = edge_edge(pair, e, g, f64::INFINITY) else { continue };
        let mut dips = |side: Side, edge: EdgeId, p: DVec3, counters: &mut Counters| {
            let last = &mut last[side.index()];
            let nearest = nearest_on(pair, side, p, last, counters).distance;
            let around = pair.topology(side).half_edges(edge);
            around
                .iter()
                .any(|h| NearestFace::on(pair, side, p, h.face()).distance <= DETOUR * nearest)
                && is_inside(pair, side, p, counters)
        };
        if contact.separation < 0.0
            && dips(Side::Second, g, contact.point_a, counters)
            && dips(Side::First, e, contact.point_b, counters)
        {
            contacts.push(contact);
        }
    }
}

/// The edges of a body that may make contacts with others, each looked at once.
struct Ridges {
    side: Side,
    edges: Numbering,
    are: Vec<bool>,
}

impl Ridges {
    fn of(side: Side) -> Self {
        Self { side, edges: Numbering::default(), are: Vec::new() }
    }

    /// Those of a face.
    fn of_face(&mut self, pair: &Pair, face: FaceId) -> [Option<EdgeId>; 3] {
        [self.of_side(pair, face, 0), self.of_side(pair, face, 1), self.of_side(pair, face, 2)]
    }

    fn of_side(&mut self, pair: &Pair, face: FaceId, i: usize) -> Option<EdgeId> {
        let edge = pair.edge(self.side, face, i);
        let (number, is_new) = self.edges.number(u64::from(edge.0));
        if is_new {
            let around = pair.topology(self.side).half_edges(edge);
            self.are.push(may_be_ridge(pair.mesh(self.side), around));
        }
        self.are[number as usize].then_some(edge)
    }
}

/// The point of a body's surface nearest to a point of the pair's frame; ties go to the lowest face. Begins
/// at the face that was `last` found for a point nearby.
fn nearest_on(
    pair: &Pair,
    side: Side,
    p: DVec3,
    last: &mut Option<FaceId>,
    counters: &mut Counters,
) -> Nearest {
    let tree = pair.model(side).tree();
    let local = match side {
        Side::First => p,
        Side::Second => pair.first_from_second.inverse().apply(p),
    };
    let bound = |node: u32| {
        let b = &tree.node(node).bounds;
        let beside = (b.min - local).max(local - b.max).max(DVec3::ZERO);
        (beside.length() - pair.culling_error()).max(0.0)
    };
    // A mesh has faces, so there is a nearest one.
    let begin = last.unwrap_or(FaceId(0));
    let mut best = NearestFace::on(pair, side, p, begin);
    let mut stack = vec![(0.0, 0u32)];
    while let Some((lower, node)) = stack.pop() {
        if lower > best.distance {
            continue;
        }
        counters.node_tests += 1;
        if let Content::Inner { left, right } = tree.content(node) {
            let (left, right) = ((bound(left), left), (bound(right), right));
            let (near, far) = if left.0 < right.0 { (left, right) } else { (right, left) };
            if far.0 <= best.distance {
                stack.push(far);
            }
            if near.0 <= best.distance {
                stack.push(near);
            }
            continue;
        }
        for &face in tree.leaf_faces(node) {
            let found = NearestFace::on(pair, side, p, face);
            if (found.distance, face) < (best.distance, best.face) {
                best = found;
            }
        }
    }
    *last = Some(best.face);
    let feature = best.part.feature(pair.model(side), best.face);
    Nearest { distance: best.distance, foot: best.foot, feature, face: best.face }
}

/// The point of a face nearest to a point.
struct NearestFace {
    distance: f64,
    foot: DVec3,
    part: Part,
    face: FaceId,
}

impl NearestFace {
    fn on(pair: &Pair, side: Side, p: DVec3, face: FaceId) -> Self {
        let (foot, part) = closest_on_triangle(p, &pair.triangle(side, face));
        Self { distance: (foot - p).length(), foot, part, face }
    }
}
