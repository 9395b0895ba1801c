//! Contacts of an open surface with a closed solid that it pierces: each of its vertices inside has
//! its way out.
//!
//! An open surface cuts nothing out of a solid, so there are no regions to be measured. Vertices
//! inside are reached from the faces that cross, along edges. The nearest point of the solid's
//! surface is the shortest local way out; at a face its direction is the face's normal.
//!
//! What this does not see is left to the caller: a surface none of whose vertices lies inside has
//! no contact here.

use std::collections::BTreeMap;

use cranny_exact::DVec3;
use cranny_geometry::{FaceId, PatchId, VertexId};

use super::coarse::Coarse;
use super::facing::faces_towards;
use super::within::vertices_within;
use super::{nearer, patches_of};
use crate::answer::{Contact, Counters, Feature};
use crate::pair::{Pair, Side};
use crate::search::Vicinity;
use crate::surface::FacePair;
use cranny_geometry::triangle_distance::{Part, closest_on_triangle};

/// Contacts of negative separation by pairs of patches: all where they are to span the pair, else
/// the deepest.
pub(super) struct PiercedSolid<'p, 'm> {
    pair: &'p Pair<'m>,
    coarse: Coarse,
    groups: BTreeMap<[PatchId; 2], Vec<Contact>>,
}

impl<'p, 'm> PiercedSolid<'p, 'm> {
    /// Those of the open surface of two that cross; none where both are closed, or neither is.
    pub(super) fn of(
        pair: &'p Pair<'m>,
        coarse: Coarse,
        meeting: &[FacePair],
        counters: &mut Counters,
    ) -> Self {
        let mut found = Self { pair, coarse, groups: BTreeMap::new() };
        let is_closed = Side::BOTH.map(|side| pair.model(side).is_closed());
        if is_closed[0] != is_closed[1] {
            let open = if is_closed[0] { Side::Second } else { Side::First };
            vertices_inside(&mut found, open, meeting, counters);
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

    /// Whether no contact of two features that is at most so deep counts.
    fn is_outdone(&self, id: (Feature, Feature), depth: f64) -> bool {
        let patches = patches_of(self.pair, id);
        let is_deeper = |group: &Vec<Contact>| group.iter().any(|c| c.separation < -depth);
        self.groups.get(&patches).is_some_and(is_deeper) && !self.coarse.holds(self.pair, patches)
    }
}

fn vertices_inside(
    found: &mut PiercedSolid,
    side: Side,
    meeting: &[FacePair],
    counters: &mut Counters,
) {
    let pair = found.pair;
    let mut solid = NearestOn::of(pair, side.other());
    for vertex in vertices_within(pair, side, meeting, counters) {
        let p = pair.position(side, vertex);
        let nearest = solid.to(p, counters);
        let foot = Feature::of_part(nearest.part, pair.model(side.other()), nearest.face);
        let own = Feature::Vertex(vertex);
        let id = if side == Side::First { (own, foot) } else { (foot, own) };
        if !found.is_outdone(id, nearest.distance)
            && let Some(contact) = way_out(pair, side, (vertex, p), (foot, &nearest))
        {
            found.add(contact);
        }
    }
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
    Some(if side == Side::First { contact } else { contact.swapped() })
}

/// Finds the points of a body's surface that are nearest to points of the pair's frame: faster to
/// points that lie beside the last one.
struct NearestOn<'p, 'm> {
    pair: &'p Pair<'m>,
    side: Side,
    vicinity: Vicinity,
    /// The point that was found last.
    last: Option<DVec3>,
}

impl<'p, 'm> NearestOn<'p, 'm> {
    fn of(pair: &'p Pair<'m>, side: Side) -> Self {
        Self { pair, side, vicinity: Vicinity::default(), last: None }
    }

    /// Ties go to the lowest face.
    fn to(&mut self, p: DVec3, counters: &mut Counters) -> NearestFace {
        let Self { pair, side, .. } = *self;
        let local = match side {
            Side::First => p,
            Side::Second => pair.first_from_second.inverse().apply(p),
        };
        let tree = pair.model(side).clusters();
        // The face that was found last is no farther than the point of it.
        let known = self.last.map(|last| (last - p).length() + pair.length_error());
        let (reach, allowance) = (known.unwrap_or(f64::INFINITY), pair.culling_error());
        let mut best: Option<NearestFace> = None;
        self.vicinity.for_faces_near(tree, local, (reach, allowance), counters, |face| {
            let found = NearestFace::on(pair, side, p, face);
            if best.as_ref().is_none_or(|b| (found.distance, face) < (b.distance, b.face)) {
                best = Some(found);
            }
            best.as_ref().map_or(reach, |best| best.distance.min(reach))
        });
        // A mesh has faces, so there is a nearest one.
        let best = best.unwrap_or_else(|| NearestFace::on(pair, side, p, FaceId(0)));
        self.last = Some(best.foot);
        best
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::Placed;
    use crate::search::meeting_pairs;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};
    use cranny_shapes::{Comb, Cup, Shape, Torus};
    use cranny_testkit::Rng;

    /// Without its first face.
    fn opened(mesh: Mesh) -> Mesh {
        Mesh::new(mesh.vertices().to_vec(), mesh.faces()[1..].to_vec()).unwrap()
    }

    /// What is left out is less deep than what is reported of the same patches.
    #[test]
    fn the_deepest_contact_of_two_patches_is_found() {
        let shapes: [Shape; 3] = [
            Cup { segments: 12, ..Cup::default() }.into(),
            Comb { teeth: 4, ..Comb::default() }.into(),
            Torus { major_segments: 48, minor_segments: 24, ..Torus::default() }.into(),
        ];
        let build = |mesh| Model::build(mesh, &BuildOptions::default()).unwrap().0;
        let solids = shapes.clone().map(|s| build(s.build().unwrap()));
        let open = shapes.map(|s| build(opened(s.build().unwrap())));
        let mut rng = Rng::new(5);
        let (mut groups, mut left_out) = (0, 0);
        for round in 0..600 {
            let [a, b] = [&solids[rng.below(3)], &open[rng.below(3)]];
            let [a, b] = if rng.below(2) == 0 { [a, b] } else { [b, a] };
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
            let mut found = PiercedSolid::of(&pair, coarse, &meeting, counters);
            for (patches, all) in PiercedSolid::of(&pair, Coarse::all(), &meeting, counters).rest()
            {
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
