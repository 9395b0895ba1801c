//! Contacts where solids overlap: each vertex inside has its way out, each crossing of edges its depth.
//!
//! Vertices inside are reached from the faces that cross, along edges, and told exactly. The nearest
//! point of the other surface is the shortest local way out; at a face its direction is the face's
//! normal. Edges that cross, each dipping under the other, are parted along their common normal.
//!
//! What this does not see is left to the caller: a tip that has passed the middle of a thin part, whose
//! far side is nearer than the one it came in by, has no contact here.

use cranny_exact::{DVec3, WeightedPoint};
use cranny_geometry::{EdgeId, FaceId, VertexId};

use super::facing::faces_towards;
use super::feature_pair::edge_edge;
use super::within::vertices_within;
use crate::answer::{Contact, Counters, Feature};
use crate::inside::{Location, locate};
use crate::pair::{Pair, Side};
use crate::search::for_faces_near;
use crate::surface::FacePair;
use cranny_geometry::triangle_distance::{Part, closest_on_triangle};

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
    let (mut last, mut stack) = (None, Vec::new());
    for vertex in vertices_within(pair, side, meeting, counters) {
        let p = pair.position(side, vertex);
        contacts.extend(way_out(pair, side, vertex, p, (&mut last, &mut stack), counters));
    }
}

/// The contact of a vertex inside the other solid with the nearest point of its surface.
fn way_out(
    pair: &Pair,
    side: Side,
    vertex: VertexId,
    p: DVec3,
    last: (&mut Option<FaceId>, &mut Vec<(f64, u32)>),
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
    let mut crossing: Vec<(EdgeId, EdgeId)> = Vec::new();
    for p in meeting {
        let faces = [p.first, p.second];
        let bent =
            Side::BOTH.map(|side| pair.model(side).clusters().owned(faces[side.index()]).bent);
        if bent.contains(&0) {
            continue;
        }
        let [a, b] = Side::BOTH.map(|side| pair.triangle(side, faces[side.index()]));
        let sides = |bits: u8| (0..3).filter(move |i| bits >> i & 1 != 0);
        for i in sides(bent[0]) {
            for k in sides(bent[1]) {
                if may_cross([a[i], a[(i + 1) % 3]], [b[k], b[(k + 1) % 3]]) {
                    let edge = |side: Side, i| pair.edge(side, faces[side.index()], i);
                    crossing.push((edge(Side::First, i), edge(Side::Second, k)));
                }
            }
        }
    }
    crossing.sort_unstable();
    crossing.dedup();
    let (mut last, mut stack) = ([None; 2], Vec::new());
    for (e, g) in crossing {
        let Some(contact) = edge_edge(pair, e, g, f64::INFINITY) else { continue };
        let mut dips = |side: Side, edge: EdgeId, p: DVec3, counters: &mut Counters| {
            let last = (&mut last[side.index()], &mut stack);
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

/// By how much of its length two edges may miss each other, seen along their common normal, and still
/// be looked at closely. Smaller: rounding of edges at small angles loses crossings at ends.
const NEAR_MISS: f64 = 1e-3;

/// Whether two segments may cross when seen along their common normal: cheap, and true too often rather than too seldom.
#[inline]
fn may_cross([p0, p1]: [DVec3; 2], [q0, q1]: [DVec3; 2]) -> bool {
    let (d1, d2, apart) = (p1 - p0, q1 - q0, q0 - p0);
    let cross = d1.cross(d2);
    let squared = cross.length_squared();
    let within = |t: f64| t >= -NEAR_MISS * squared && t <= (1.0 + NEAR_MISS) * squared;
    within(apart.cross(d2).dot(cross)) && within(apart.cross(d1).dot(cross))
}

/// The point of a body's surface nearest to a point of the pair's frame; ties go to the lowest face. Begins
/// at the face that was `last` found for a point nearby.
fn nearest_on(
    pair: &Pair,
    side: Side,
    p: DVec3,
    (last, stack): (&mut Option<FaceId>, &mut Vec<(f64, u32)>),
    counters: &mut Counters,
) -> Nearest {
    // A mesh has faces, so there is a nearest one.
    let begin = last.unwrap_or(FaceId(0));
    let mut best = NearestFace::on(pair, side, p, begin);
    let local = match side {
        Side::First => p,
        Side::Second => pair.first_from_second.inverse().apply(p),
    };
    let tree = pair.model(side).clusters();
    let allowance = pair.culling_error();
    for_faces_near(tree, local, (best.distance, allowance), stack, counters, |face| {
        let found = NearestFace::on(pair, side, p, face);
        if (found.distance, face) < (best.distance, best.face) {
            best = found;
        }
        best.distance
    });
    *last = Some(best.face);
    let feature = Feature::of_part(best.part, pair.model(side), best.face);
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
