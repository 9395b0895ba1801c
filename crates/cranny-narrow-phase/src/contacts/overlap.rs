//! Contacts where solids overlap: each vertex inside has its way out, each crossing of edges its
//! depth.
//!
//! Vertices inside are reached from the faces that cross, along edges, and decided exactly. The
//! nearest point of the other surface is the shortest local way out; at a face its direction is the
//! face's normal. Edges that cross, each dipping under the other, are parted along their common
//! normal.
//!
//! What this does not see is left to the caller: a tip that has passed the middle of a thin part,
//! whose far side is nearer than the one it came in by, has no contact here.

use std::collections::BTreeMap;

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{EdgeId, PatchId, VertexId};

use super::coarse::Coarse;
use super::facing::faces_towards;
use super::feature_pair::edge_edge;
use super::within::vertices_within;
use super::{nearer, patches_of};
use crate::answer::{Contact, Feature};
use crate::inside::is_inside;
use crate::nearest_on::{NearestFace, NearestOn};
use crate::pair::{Pair, Side};
use crate::pieces::Inside;
use crate::surface::FacePair;
use crate::tally::Tally;

/// How much farther than the nearest way out the faces at the other edge may be from a point of an
/// edge that crosses it: 1 where edges cross locally, however sharp they are, and a little more
/// where these faces are smaller than the overlap is deep. Smaller: finely cut edges get no
/// contact; larger: edges on opposite sides of a thin bar are pressed through it.
const DETOUR: f64 = 2.0;

/// How much deeper than the nearest way out a crossing of edges may be, in multiples of what it is
/// where the edge is crossed midway between its two faces. Smaller: an edge that is crossed nearly
/// along one of its faces makes no contact; larger: a body pushed sideways by a sliver is lifted by
/// the height of the side that it touches.
const ASLANT: f64 = 8.0;

/// What is near so many vertices inside, or more, is listed for all of them at once. Fewer: the
/// list costs more than it spares, as in piles; more: lists are made for some vertices each.
const MANY: usize = 4;

/// Contacts of negative separation by pairs of patches: all where they are to span the pair, else
/// the deepest.
pub(super) struct Overlaps<'p, 'm> {
    pair: &'p Pair<'m>,
    coarse: Coarse,
    groups: BTreeMap<[PatchId; 2], Vec<Contact>>,
    /// The vertices of each body that lie inside the other.
    pub(super) inside: [Inside; 2],
}

impl<'p, 'm> Overlaps<'p, 'm> {
    /// No contacts.
    pub(super) fn none(pair: &'p Pair<'m>, coarse: Coarse) -> Self {
        Self { pair, coarse, groups: BTreeMap::new(), inside: Default::default() }
    }

    /// That vertices and edges about the crossing faces make.
    pub(super) fn of(
        pair: &'p Pair<'m>,
        coarse: Coarse,
        meeting: &[FacePair],
        counters: &mut impl Tally,
    ) -> Self {
        let mut found = Self::none(pair, coarse);
        let mut surfaces = Side::BOTH.map(|side| NearestOn::of(pair, side));
        for side in Side::BOTH {
            if pair.model(side.other()).is_closed() {
                vertices_inside(&mut found, side, meeting, &mut surfaces, counters);
            }
        }
        if pair.is_closed() {
            edges_crossing(&mut found, meeting, &mut surfaces, counters);
        }
        found
    }

    /// Takes the contacts of two patches out.
    pub(super) fn take(&mut self, patches: [PatchId; 2]) -> Vec<Contact> {
        self.groups.remove(&patches).unwrap_or_default()
    }

    /// What is left, by ascending patches.
    pub(super) fn rest(self) -> impl Iterator<Item = ([PatchId; 2], Vec<Contact>)> {
        self.groups.into_iter()
    }

    fn add(&mut self, contact: Contact) {
        let patches = patches_of(self.pair, contact.id);
        let group = self.groups.entry(patches).or_default();
        if group.is_empty() || self.coarse.holds(self.pair, patches) {
            group.push(contact);
        } else if nearer(&contact, &group[0]).is_lt() {
            group[0] = contact;
        }
    }

    /// How deep a contact of two features is at least that counts.
    fn counting(&self, patches: [PatchId; 2]) -> f64 {
        match self.groups.get(&patches) {
            Some(group) if !self.coarse.holds(self.pair, patches) => {
                group.iter().map(|contact| -contact.separation).fold(0.0, f64::max)
            }
            _ => 0.0,
        }
    }
}

fn vertices_inside(
    found: &mut Overlaps,
    side: Side,
    meeting: &[FacePair],
    surfaces: &mut [NearestOn; 2],
    counters: &mut impl Tally,
) {
    let pair = found.pair;
    let vertices = vertices_within(pair, side, meeting, counters);
    if vertices.len() >= MANY {
        let all = || vertices.iter().map(|&(vertex, _)| pair.position(side, vertex));
        let center = Aabb::of_points(all()).center();
        let radius = all().map(|p| (p - center).length()).fold(0.0, f64::max);
        surfaces[side.other().index()].gather((center, radius), counters);
    }
    for &(vertex, _) in &vertices {
        let p = pair.position(side, vertex);
        let nearest = surfaces[side.other().index()].to(p, counters);
        let foot = Feature::of_part(nearest.part, pair.model(side.other()), nearest.face);
        let own = Feature::Vertex(vertex);
        let id = if side == Side::First { (own, foot) } else { (foot, own) };
        if nearest.distance < found.counting(patches_of(pair, id)) {
            continue;
        }
        if let Some(contact) = way_out(pair, side, (vertex, p), (foot, &nearest)) {
            found.add(contact);
        }
    }
    found.inside[side.index()] = vertices;
}

/// The contact of a vertex inside the other solid with the nearest point of its surface.
fn way_out(
    pair: &Pair,
    side: Side,
    (vertex, p): (VertexId, DVec3),
    (feature, nearest): (Feature, &NearestFace),
) -> Option<Contact> {
    let outward = match feature {
        Feature::Face(face) => pair.normal(side.other(), face),
        _ if nearest.distance > pair.length_error() => (nearest.foot - p) / nearest.distance,
        // On a rim to rounding: the face that was found there is as good as its neighbours.
        _ => pair.normal(side.other(), nearest.face),
    };
    if outward == DVec3::ZERO || !faces_towards(pair, side, vertex, -outward) {
        return None;
    }
    let contact = Contact {
        id: (Feature::Vertex(vertex), feature),
        point_a: p,
        point_b: nearest.foot,
        normal: -outward,
        separation: -nearest.distance,
    };
    Some(side.in_order(contact))
}

fn edges_crossing<T: Tally>(
    found: &mut Overlaps,
    meeting: &[FacePair],
    surfaces: &mut [NearestOn; 2],
    counters: &mut T,
) {
    let pair = found.pair;
    let mut crossing: Vec<(EdgeId, EdgeId)> = Vec::new();
    // Of the patches of the last two edges.
    let (mut last, mut counting) = ([PatchId(u32::MAX); 2], 0.0);
    for p in meeting {
        let (f, g) = (p.first, p.second);
        let bent = |side: Side, face| pair.model(side).clusters().owned(face).bent;
        let (own, its) = (bent(Side::First, f), bent(Side::Second, g));
        if own == 0 || its == 0 {
            continue;
        }
        let (a, b) = (pair.triangle(Side::First, f), pair.triangle(Side::Second, g));
        let sides = |bits: u8| (0..3).filter(move |i| bits >> i & 1 != 0);
        for i in sides(own) {
            for k in sides(its) {
                let segments = [[a[i], a[(i + 1) % 3]], [b[k], b[(k + 1) % 3]]];
                let Some(depth) = may_cross(segments, pair.length_error()) else { continue };
                let (e, h) = (pair.edge(Side::First, f, i), pair.edge(Side::Second, g, k));
                let patches = patches_of(pair, (Feature::Edge(e), Feature::Edge(h)));
                if patches != last {
                    (last, counting) = (patches, found.counting(patches));
                }
                if depth < counting {
                    continue;
                }
                crossing.push((e, h));
            }
        }
    }
    crossing.sort_unstable();
    crossing.dedup();
    for (e, g) in crossing {
        let Some(contact) = edge_edge(pair, e, g, f64::INFINITY) else { continue };
        let mut dips = |side: Side, edge: EdgeId, p: DVec3, counters: &mut T| {
            let nearest = surfaces[side.index()].to(p, counters).distance;
            let least = sine_of_half(pair, side, edge) * -contact.separation;
            let around = pair.topology(side).half_edges(edge);
            least <= ASLANT * nearest + pair.length_error()
                && around
                    .iter()
                    .any(|h| NearestFace::on(pair, side, p, h.face()).distance <= DETOUR * nearest)
                && is_inside(pair, side, p, counters)
        };
        if contact.separation < 0.0
            && dips(Side::Second, g, contact.point_a, counters)
            && dips(Side::First, e, contact.point_b, counters)
        {
            found.add(contact);
        }
    }
}

/// Sine of half the angle within the solid between the two faces at an edge: the distance to both,
/// in parts of that to the edge, of what lies midway between them.
fn sine_of_half(pair: &Pair, side: Side, edge: EdgeId) -> f64 {
    let mut faces = pair.topology(side).half_edges(edge).iter().map(|h| h.face());
    let (Some(f), Some(g)) = (faces.next(), faces.next()) else { return 0.0 };
    (0.5 * (1.0 + pair.normal(side, f).dot(pair.normal(side, g)))).max(0.0).sqrt()
}

/// By how much of its length two edges may miss each other, seen along their common normal, and
/// still be looked at closely. Smaller: rounding of edges at small angles loses crossings at ends.
const NEAR_MISS: f64 = 1e-3;

/// How deep the contact of two segments is at most; `None` where they do not cross, seen along
/// their common normal. Cheap: rather too deep, and of too many. `error` is that of a length.
#[inline]
fn may_cross([[p0, p1], [q0, q1]]: [[DVec3; 2]; 2], error: f64) -> Option<f64> {
    let (d1, d2, apart) = (p1 - p0, q1 - q0, q0 - p0);
    let cross = d1.cross(d2);
    let squared = cross.length_squared();
    let within = |t: f64| t >= -NEAR_MISS * squared && t <= (1.0 + NEAR_MISS) * squared;
    let crosses = within(apart.cross(d2).dot(cross)) && within(apart.cross(d1).dot(cross));
    // The normal is off by rounding over the sine of the angle between the segments.
    let over_sine = || (d1.length_squared() * d2.length_squared() / squared).sqrt();
    crosses.then(|| apart.dot(cross).abs() / squared.sqrt() + error * over_sine())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Counters;
    use crate::query::Placed;
    use crate::search::meeting_pairs;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Comb, Cup, Shape, Torus};
    use cranny_testkit::Rng;

    /// What is left out is less deep than what is found of the same patches.
    #[test]
    fn the_deepest_contact_of_two_patches_is_found() {
        let shapes: [Shape; 3] = [
            Cup { segments: 12, ..Cup::default() }.into(),
            Comb { teeth: 4, ..Comb::default() }.into(),
            Torus { major_segments: 48, minor_segments: 24, ..Torus::default() }.into(),
        ];
        let build = |s: Shape| Model::build(s.build().unwrap(), &BuildOptions::default()).unwrap();
        let bodies = shapes.map(|s| build(s).0);
        let mut rng = Rng::new(5);
        let (mut groups, mut left_out) = (0, 0);
        for round in 0..300 {
            let [a, b] = [&bodies[rng.below(3)], &bodies[rng.below(3)]];
            let turn = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
            let rotation = if round % 3 > 0 { turn } else { DQuat::IDENTITY };
            let translation = DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let pair = Pair::of_accepted(
                Placed { model: a, pose: Pose::IDENTITY },
                Placed { model: b, pose: Pose { rotation, translation } },
            );
            let coarse = Coarse::of(&pair);
            let counters = &mut Counters::default();
            let meeting = meeting_pairs(&pair, counters);
            let mut found = Overlaps::of(&pair, coarse, &meeting, counters);
            for (patches, all) in Overlaps::of(&pair, Coarse::all(), &meeting, counters).rest() {
                let some = found.take(patches);
                if coarse.holds(&pair, patches) {
                    assert_eq!(some, all, "round {round}");
                } else {
                    assert_eq!(some.first(), all.iter().min_by(|x, y| nearer(x, y)));
                    left_out += all.len() - some.len();
                }
                groups += 1;
            }
            assert_eq!(found.rest().count(), 0, "round {round}");
        }
        assert!(groups > 200 && left_out > 50, "{groups} {left_out}");
    }
}
