//! What a descent of two patches' trees is for: the nearest contact, or all, or only which faces meet.

use cranny_exact::DVec3;
use cranny_geometry::{EdgeId, FaceId, VertexId};

use super::facet::may_cross;
use super::feature_pair::{Stand, edge_edge_at, vertex_face, vertex_rim};
use super::gauss_map::Touch;
use super::ownership::Ownership;
use crate::answer::{Contact, Counters, Feature};
use crate::pair::{Pair, Side};
use crate::surface::FacePair;
use crate::triangle_distance::Part;

/// Order of contacts: the nearest first, ties by lowest features.
pub(super) fn nearer(x: &Contact, y: &Contact) -> std::cmp::Ordering {
    x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id))
}

/// Which contacts of two patches are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Nearest,
    All,
}

/// Two bodies, and what makes contacts from which of their faces.
#[derive(Clone, Copy)]
pub(super) struct Ground<'a, 'b> {
    pub(super) pair: &'a Pair<'b>,
    pub(super) owned: &'a [Ownership; 2],
}

/// A corner of a body that is looked at, and where it is.
#[derive(Clone, Copy)]
pub(super) struct Tip {
    pub(super) side: Side,
    pub(super) vertex: VertexId,
    pub(super) at: DVec3,
}

/// What is told by a descent, and what it may leave out.
pub(super) trait Quest {
    /// Features and faces farther apart than this are left out.
    fn limit(&self) -> f64;

    /// Faces farther apart than this are not told of, but for rounding; `None`: no faces are.
    fn closeness(&self) -> Option<f64>;

    /// Whether features are to be told of as they are turned now; if not, also as they may be turned soon.
    fn is_for_now(&self) -> bool;

    /// Whether corners and edges are to be told of.
    fn wants_features(&self) -> bool;

    /// Two faces that may be close, of these corners.
    fn faces(&mut self, faces: [FaceId; 2], triangles: [&[DVec3; 3]; 2], counters: &mut Counters);

    /// A corner that is looked at, and a face of the other body, of these corners.
    fn corner(
        &mut self,
        ground: Ground,
        tip: Tip,
        its: (FaceId, &[DVec3; 3]),
        counters: &mut Counters,
    );

    /// Two edges that are looked at, of the first body and of the second, each from its lesser vertex, and whether they touch.
    fn edges(
        &mut self,
        ground: Ground,
        edges: [EdgeId; 2],
        segments: [[DVec3; 2]; 2],
        touch: Touch,
        counters: &mut Counters,
    );
}

/// Contacts across a gap that were found.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// No contact farther than this is wanted; shrinks as nearer ones are found, where the nearest is wanted.
    pub(super) limit: f64,
    pub(super) wanted: Wanted,
    pub(super) contacts: Vec<Contact>,
}

impl Found {
    pub(super) fn new(limit: f64, wanted: Wanted) -> Self {
        Self { limit, wanted, contacts: Vec::new() }
    }

    fn offer(&mut self, contact: Contact) {
        if contact.separation > self.limit {
            return;
        }
        if self.wanted == Wanted::All {
            self.contacts.push(contact);
        } else if self.contacts.first().is_none_or(|best| nearer(&contact, best).is_lt()) {
            self.limit = contact.separation.max(0.0);
            self.contacts = vec![contact];
        }
    }

    /// Offers the contact of a corner before a triangle.
    pub(super) fn corner(
        &mut self,
        ground: Ground,
        tip: Tip,
        (face, corners): (FaceId, &[DVec3; 3]),
    ) {
        let Tip { side, vertex, at } = tip;
        let pair = ground.pair;
        let found = match vertex_face(pair, side, (vertex, at), (face, corners), self.limit) {
            Stand::Over(found) => found,
            Stand::Beside(part) => {
                let other = side.other();
                let rim = part.feature(pair.model(other), face);
                let owned = ground.owned[other.index()].of(pair, other, face);
                let is_owned = match part {
                    Part::Corner(i) => owned.corners >> i & 1 != 0,
                    Part::Edge(i) => owned.sides >> i & 1 != 0,
                    Part::Inside => false,
                };
                // Two vertices are one pair, told from the first.
                let twice = side == Side::Second && matches!(rim, Feature::Vertex(_));
                if !is_owned || twice {
                    return;
                }
                vertex_rim(pair, side, vertex, rim, self.limit)
            }
        };
        if let Some(contact) = found {
            self.offer(contact);
        }
    }

    /// Offers the contact of two edges; whether they were looked at closely.
    pub(super) fn edges(
        &mut self,
        pair: &Pair,
        edges: [EdgeId; 2],
        segments: [[DVec3; 2]; 2],
        touch: Touch,
    ) -> bool {
        let [p, q] = segments;
        if !may_cross(p, q, self.limit + pair.length_error()) {
            return false;
        }
        if let Some(contact) = edge_edge_at(pair, edges, segments, touch, self.limit)
            && contact.separation >= -pair.length_error()
        {
            self.offer(contact);
        }
        true
    }
}

/// Which faces of two patches meet, and their contacts: both if asked for.
pub(super) struct Looking {
    /// `None`: only which faces meet.
    pub(super) found: Option<Found>,
    /// Whether faces that meet are asked for.
    pub(super) meets: bool,
    /// In the order of their discovery.
    pub(super) meeting: Vec<FacePair>,
}

impl Quest for Looking {
    #[inline]
    fn limit(&self) -> f64 {
        self.found.as_ref().map_or(0.0, |found| found.limit)
    }

    #[inline]
    fn closeness(&self) -> Option<f64> {
        self.meets.then_some(0.0)
    }

    #[inline]
    fn is_for_now(&self) -> bool {
        true
    }

    #[inline]
    fn wants_features(&self) -> bool {
        self.found.is_some()
    }

    fn faces(&mut self, faces: [FaceId; 2], triangles: [&[DVec3; 3]; 2], counters: &mut Counters) {
        counters.triangle_tests += 1;
        self.meeting.extend(FacePair::of(faces, triangles, counters));
    }

    fn corner(
        &mut self,
        ground: Ground,
        tip: Tip,
        its: (FaceId, &[DVec3; 3]),
        counters: &mut Counters,
    ) {
        if let Some(found) = &mut self.found {
            counters.triangle_tests += 1;
            found.corner(ground, tip, its);
        }
    }

    fn edges(
        &mut self,
        ground: Ground,
        edges: [EdgeId; 2],
        segments: [[DVec3; 2]; 2],
        touch: Touch,
        counters: &mut Counters,
    ) {
        let Some(found) = &mut self.found else { return };
        let is_looked_at = found.edges(ground.pair, edges, segments, touch);
        counters.triangle_tests += u64::from(is_looked_at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_is_kept_or_all_are() {
        let contact = |v: u32, separation: f64| Contact {
            id: (Feature::Vertex(VertexId(v)), Feature::Face(FaceId(0))),
            point_a: DVec3::ZERO,
            point_b: DVec3::ZERO,
            normal: DVec3::Z,
            separation,
        };
        let offered = [contact(1, 0.5), contact(3, 0.25), contact(2, 0.25), contact(0, 2.0)];
        for (wanted, expected) in [(Wanted::Nearest, vec![2]), (Wanted::All, vec![1, 3, 2])] {
            let mut found = Found::new(1.0, wanted);
            offered.into_iter().for_each(|c| found.offer(c));
            let vertices: Vec<u32> = found
                .contacts
                .iter()
                .map(|c| if let Feature::Vertex(v) = c.id.0 { v.0 } else { u32::MAX })
                .collect();
            assert_eq!(vertices, expected);
        }
    }
}
