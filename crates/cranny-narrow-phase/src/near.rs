//! Regions across a gap: contacts within a margin, gathered by what they lie on.
//!
//! A vertex over a face, and two convex edges whose nearest points lie between their ends, are what
//! two polyhedra touch with next; a vertex before an edge or another vertex is where sharp parts
//! are nearest (`contacts`). Contacts of which a face of each body has both features belong to one
//! region.

#[cfg(test)]
mod oracle;

use cranny_geometry::{DisjointSets, FaceId};

use crate::answer::{Contact, Feature};
use crate::coherent::Coherent;
use crate::contacts::{ContactMemory, across_gaps};
use crate::pair::{Pair, Side};
use crate::tally::Tally;
use cranny_geometry::triangle_distance::closest_on_triangle;

/// Contacts across a gap that hang together, and the pairs of faces that hold their features.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearRegion {
    pub(crate) contacts: Vec<Contact>,
    pub(crate) faces: Vec<[FaceId; 2]>,
}

/// All contacts between surfaces that are apart by more than 0 and at most `margin`, grouped into
/// regions, in the pair's frame.
pub(crate) fn near_regions(
    pair: &Pair,
    margin: f64,
    memory: (&mut Coherent, &mut ContactMemory),
    counters: &mut impl Tally,
) -> Vec<NearRegion> {
    let mut contacts = across_gaps(pair, margin, memory, counters);
    // Edges that touch have no direction but noise.
    contacts.retain(|contact| match contact.id {
        (Feature::Edge(_), Feature::Edge(_)) => contact.separation > pair.length_error(),
        _ => contact.separation > 0.0,
    });
    for contact in &mut contacts {
        contact.id = by_foot(pair, contact);
    }
    // What stands before the rim between two faces was offered before each of them.
    contacts.sort_unstable_by(|x, y| x.id.cmp(&y.id).then(x.separation.total_cmp(&y.separation)));
    contacts.dedup_by_key(|contact| contact.id);
    regions(pair, contacts)
}

/// A contact's features, that of the face's rim in place of the face where a vertex stands before
/// the rim.
fn by_foot(pair: &Pair, contact: &Contact) -> (Feature, Feature) {
    let before = |side: Side, p, face| {
        let part = closest_on_triangle(p, &pair.triangle(side, face)).1;
        Feature::of_part(part, pair.model(side), face)
    };
    match contact.id {
        (vertex, Feature::Face(face)) => (vertex, before(Side::Second, contact.point_a, face)),
        (Feature::Face(face), vertex) => (before(Side::First, contact.point_b, face), vertex),
        id => id,
    }
}

fn regions(pair: &Pair, contacts: Vec<Contact>) -> Vec<NearRegion> {
    let mut places: Vec<([FaceId; 2], usize)> = Vec::new();
    for (index, contact) in contacts.iter().enumerate() {
        let of_second = contact.id.1.faces(pair.topology(Side::Second));
        for f in contact.id.0.faces(pair.topology(Side::First)) {
            places.extend(of_second.iter().map(|&g| ([f, g], index)));
        }
    }
    places.sort_unstable();
    let mut sets = DisjointSets::new(contacts.len());
    for ends in places.windows(2).filter(|ends| ends[0].0 == ends[1].0) {
        sets.union(ends[0].1, ends[1].1);
    }
    let (region_of, count) = sets.numbered();
    let mut regions = vec![NearRegion::default(); count];
    for (contact, &region) in contacts.into_iter().zip(&region_of) {
        regions[region as usize].contacts.push(contact);
    }
    for (faces, index) in places {
        regions[region_of[index] as usize].faces.push(faces);
    }
    regions
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Counters;
    use crate::{Demand, PairMemory, Placed, Query, query};
    use cranny_exact::{DQuat, DVec3, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Comb, Cuboid, Cup, GolfBall, LPrism, Shape, Torus};
    use cranny_testkit::Rng;

    fn shape(shape: impl Into<Shape>) -> Model {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    /// Regions by the features of their contacts, each with its separation.
    fn by_features(regions: &[Vec<Contact>]) -> Vec<Vec<((Feature, Feature), f64)>> {
        let mut all: Vec<Vec<_>> = regions
            .iter()
            .map(|region| {
                let mut ids: Vec<_> = region.iter().map(|c| (c.id, c.separation)).collect();
                ids.sort_by_key(|x| x.0);
                ids
            })
            .collect();
        all.sort_by(|x, y| x[0].0.cmp(&y[0].0));
        all
    }

    /// A body wanders over another: what is kept finds what a search of all pairs of faces finds.
    #[test]
    fn regions_across_gaps_are_those_of_all_pairs_of_faces() {
        let bodies = [
            shape(Cuboid::default()),
            shape(LPrism::default()),
            shape(Cup { segments: 9, ..Cup::default() }),
            shape(Comb { teeth: 3, ..Comb::default() }),
            shape(Torus { major_segments: 12, minor_segments: 7, ..Torus::default() }),
            shape(GolfBall { triangles: 200, dimples: 6, ..GolfBall::default() }),
        ];
        let mut rng = Rng::new(77);
        let (mut contacts, mut several) = (0, 0);
        for _ in 0..24 {
            let (a, b) = (&bodies[rng.below(6)], &bodies[rng.below(6)]);
            let (mut coherent, mut memory) = (Coherent::default(), ContactMemory::default());
            let turn = |rng: &mut Rng, size: f64| {
                let axis = size * DVec3::new(rng.unit(), rng.unit(), rng.unit());
                DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0).normalize()
            };
            let mut pose = Pose { rotation: turn(&mut rng, 9.0), translation: DVec3::ZERO };
            let direction = turn(&mut rng, 9.0) * DVec3::X;
            pose.translation = (a.radius() + b.radius()) * direction;
            // Nearer by no more than they are apart.
            for _ in 0..8 {
                let at = |model, pose| Placed { model, pose };
                let query_of_distance = Query::of(Demand::Distance { below: None });
                let memory = &mut PairMemory::default();
                let answer =
                    query(at(a, Pose::IDENTITY), at(b, pose), &query_of_distance, memory).unwrap();
                pose.translation -= (answer.distance.unwrap() - 0.03) * direction;
            }
            let pace = [0.0, 0.002, 0.01, 0.05][rng.below(4)];
            for step in 0..30 {
                let placed = |model, pose| Placed { model, pose };
                let pair = Pair::of_accepted(placed(a, Pose::IDENTITY), placed(b, pose));
                // Often by less than patches may come nearer.
                let margin = 0.05 + 0.02 * (step % 8) as f64;
                let mut counters = Counters::default();
                coherent.begin(&pair);
                let kept = (&mut coherent, &mut memory);
                let found = near_regions(&pair, margin, kept, &mut counters);
                coherent.end(&pair);
                let truth = oracle::near_regions(&pair, margin);
                let flat = |regions: &[Vec<((Feature, Feature), f64)>]| {
                    let mut all = regions.concat();
                    all.sort_by_key(|x| x.0);
                    all
                };
                let found: Vec<Vec<Contact>> =
                    found.into_iter().map(|found| found.contacts).collect();
                let (found, truth) = (by_features(&found), by_features(&truth));
                let (ours, theirs) = (flat(&found), flat(&truth));
                let ids = |all: &[((Feature, Feature), f64)]| -> Vec<_> {
                    all.iter().map(|c| c.0).collect()
                };
                assert_eq!(ids(&ours), ids(&theirs), "step {step} at {pose:?}");
                let differ = |(x, y): (&(_, f64), &(_, f64))| (x.1 - y.1).abs() > 1e-12;
                assert!(!ours.iter().zip(&theirs).any(differ), "step {step} at {pose:?}");
                let parts = |regions: &[Vec<((Feature, Feature), f64)>]| -> Vec<_> {
                    regions.iter().map(|region| ids(region)).collect()
                };
                assert_eq!(parts(&found), parts(&truth), "step {step} at {pose:?}");
                (contacts, several) = (contacts + ours.len(), several + u32::from(found.len() > 1));
                pose.translation += pace * DVec3::new(rng.unit(), rng.unit(), rng.unit());
                pose.rotation = (turn(&mut rng, pace) * pose.rotation).normalize();
            }
        }
        assert!(
            contacts > 1000 && several > 50,
            "{contacts} contacts, several regions {several} times"
        );
    }
}
