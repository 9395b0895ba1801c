//! From contacts to rapier's manifolds: [`rebuild`], which the dispatcher calls for each pair.
//!
//! A manifold has one normal, and rapier solves at most four of its points. So contacts whose
//! normals agree share a manifold, and every other contact gets one of its own: no normal is ever
//! averaged. Impulses of the last step are carried over by ids (for two meshes those of their
//! patches, which stay while the nearest features change) and place, or else by place alone.

use cranny_exact::{DVec3, Pose, RigidMap};
use cranny_geometry::PatchId;
use cranny_narrow_phase::{Contact, Feature, SAME_NORMAL};
use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::math::Real;
use rapier3d::parry::query::{ContactManifold, TrackedContact};
use rapier3d::parry::shape::PackedFeatureId;

use crate::convert::{narrow, wide};

/// rapier's manifold with rapier's data.
pub(crate) type Manifold = ContactManifold<ContactManifoldData, ContactData>;

/// Cosine of the angle (8 degrees) within which a contact takes over the impulse of an earlier one
/// without its ids. Larger: impulses turn round corners; smaller: they are lost where a body rolls.
const SAME_WAY: f64 = 0.99;

/// Points of a manifold at most: rapier solves no more.
const MAX_POINTS: usize = 4;

/// A contact as the solver gets it, in the first shape's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolverContact {
    /// By what it is known from step to step, on the first shape and on the second.
    pub(crate) ids: (PackedFeatureId, PackedFeatureId),
    pub(crate) on_first: DVec3,
    pub(crate) on_second: DVec3,
    /// Unit, from first to second.
    pub(crate) normal: DVec3,
    /// Along the normal: > 0 apart, < 0 overlapping.
    pub(crate) separation: f64,
}

impl SolverContact {
    pub(crate) fn of(contact: &Contact, ids: (PackedFeatureId, PackedFeatureId)) -> Self {
        let Contact { point_a, point_b, normal, separation, .. } = *contact;
        Self { ids, on_first: point_a, on_second: point_b, normal, separation }
    }

    /// The same contact in another frame.
    pub(crate) fn moved(self, map: &RigidMap) -> Self {
        Self {
            on_first: map.apply(self.on_first),
            on_second: map.apply(self.on_second),
            normal: map.apply_vector(self.normal),
            ..self
        }
    }
}

/// Replaces the manifolds by those of the given contacts, keeping impulses.
pub(crate) fn rebuild(
    contacts: &[SolverContact],
    first_from_second: &Pose,
    reach: f64,
    manifolds: &mut Vec<Manifold>,
) {
    let (count, members) = by_manifolds(contacts);
    let groups = || members.chunk_by(|(one, _), (other, _)| one == other);
    let inverse = first_from_second.world_from_body().inverse();
    // What rests has the same contacts as in the step before: they keep their impulses where they
    // stand.
    if count == manifolds.len()
        && groups().zip(&*manifolds).all(|(group, manifold)| is_of(manifold, group))
    {
        for (group, manifold) in groups().zip(manifolds) {
            turn(manifold, group[0].1.normal, &inverse);
            for ((_, contact), point) in group.iter().zip(&mut manifold.points) {
                *point = TrackedContact { data: point.data, ..tracked(contact, &inverse) };
            }
        }
        return;
    }
    let mut memory = Impulses::of(manifolds);
    manifolds.clear();
    for (index, group) in groups().enumerate() {
        let mut manifold =
            Manifold::with_data(index as u32, index as u32, ContactManifoldData::default());
        turn(&mut manifold, group[0].1.normal, &inverse);
        manifold.points.extend(group.iter().map(|(_, contact)| tracked(contact, &inverse)));
        manifolds.push(manifold);
    }
    // Ids first, for all: what stands at a place may belong to a contact that comes later.
    let mut strangers = Vec::new();
    for manifold in manifolds {
        let normal = wide(manifold.local_n1);
        for point in &mut manifold.points {
            match memory.by_ids(point) {
                Some(data) => point.data = data,
                None => strangers.push((point, normal)),
            }
        }
    }
    for (point, normal) in strangers {
        point.data = memory.by_place(point, normal, reach);
    }
}

/// The number of a manifold, and a contact of it.
type Member<'c> = (usize, &'c SolverContact);

/// The number of manifolds, and contacts by them: of one normal each, and no more than rapier
/// solves.
fn by_manifolds<'c>(contacts: &'c [SolverContact]) -> (usize, Vec<Member<'c>>) {
    // Of each manifold the normal, and how many points it has.
    let mut manifolds: Vec<(DVec3, usize)> = Vec::with_capacity(contacts.len());
    let member = |contact: &'c SolverContact| {
        let has_room = |(normal, points): &(DVec3, usize)| {
            *points < MAX_POINTS && normal.dot(contact.normal) >= SAME_NORMAL
        };
        let home = manifolds.iter().position(has_room).unwrap_or_else(|| {
            manifolds.push((contact.normal, 0));
            manifolds.len() - 1
        });
        manifolds[home].1 += 1;
        (home, contact)
    };
    let mut members: Vec<Member> = contacts.iter().map(member).collect();
    members.sort_by_key(|(home, _)| *home);
    (manifolds.len(), members)
}

/// Whether these contacts are a manifold's, in its order.
fn is_of(manifold: &Manifold, group: &[Member]) -> bool {
    let same = |(point, (_, contact)): (&TrackedContact<ContactData>, &Member)| {
        (point.fid1, point.fid2) == contact.ids
    };
    manifold.points.len() == group.len() && manifold.points.iter().zip(group).all(same)
}

/// Gives a manifold its normal.
fn turn(manifold: &mut Manifold, normal: DVec3, second_from_first: &RigidMap) {
    manifold.local_n1 = narrow(normal);
    manifold.local_n2 = narrow(second_from_first.apply_vector(-normal));
}

/// A contact as rapier has it, without an impulse.
fn tracked(contact: &SolverContact, second_from_first: &RigidMap) -> TrackedContact<ContactData> {
    let (first, second) = contact.ids;
    TrackedContact::new(
        narrow(contact.on_first),
        narrow(second_from_first.apply(contact.on_second)),
        first,
        second,
        contact.separation as Real,
    )
}

/// Two bits of rapier's ids say what kind a feature is; meshes of more than 2^30 features do not
/// exist.
pub(crate) fn packed(feature: Feature) -> PackedFeatureId {
    match feature {
        Feature::Vertex(v) => PackedFeatureId::vertex(v.0),
        Feature::Edge(e) => PackedFeatureId::edge(e.0),
        Feature::Face(f) => PackedFeatureId::face(f.0),
    }
}

/// A patch, for contacts between patches. Encoded as a face, of which there are at least as many.
pub(crate) fn packed_patch(patch: PatchId) -> PackedFeatureId {
    PackedFeatureId::face(patch.0)
}

/// What the solver learned in the last step. Each impulse is handed on once at most.
struct Impulses {
    known: Vec<KnownContact>,
    /// Places among these, by ascending ids.
    by_ids: Vec<([u32; 2], usize)>,
}

struct KnownContact {
    place: DVec3,
    normal: DVec3,
    data: ContactData,
    taken: bool,
}

fn ids_of(point: &TrackedContact<ContactData>) -> [u32; 2] {
    [point.fid1.0, point.fid2.0]
}

impl Impulses {
    fn of(manifolds: &[Manifold]) -> Self {
        let mut out = Self { known: Vec::new(), by_ids: Vec::new() };
        for manifold in manifolds {
            for point in &manifold.points {
                out.by_ids.push((ids_of(point), out.known.len()));
                out.known.push(KnownContact {
                    place: wide(point.local_p1),
                    normal: wide(manifold.local_n1),
                    data: point.data,
                    taken: false,
                });
            }
        }
        out.by_ids.sort_unstable();
        out
    }

    /// Of a point with the same ids, the nearest of them; `None` if there was none with these ids.
    fn by_ids(&mut self, point: &TrackedContact<ContactData>) -> Option<ContactData> {
        let (ids, Self { known, by_ids }) = (ids_of(point), self);
        let start = by_ids.partition_point(|(other, _)| *other < ids);
        let same = by_ids[start..].iter().take_while(|(other, _)| *other == ids);
        same.clone().next()?;
        Some(take_nearest(known, same.map(|(_, at)| *at), wide(point.local_p1)))
    }

    /// Of a point at nearly the same place, and of nearly the same normal.
    fn by_place(
        &mut self,
        point: &TrackedContact<ContactData>,
        normal: DVec3,
        reach: f64,
    ) -> ContactData {
        let place = wide(point.local_p1);
        let near: Vec<usize> = (0..self.known.len())
            .filter(|&i| {
                let KnownContact { place: p, normal: n, .. } = &self.known[i];
                n.dot(normal) >= SAME_WAY && (*p - place).length_squared() <= reach * reach
            })
            .collect();
        take_nearest(&mut self.known, near.into_iter(), place)
    }
}

/// Takes what is nearest and not yet taken; nothing was learned where all is.
fn take_nearest(
    known: &mut [KnownContact],
    among: impl Iterator<Item = usize>,
    place: DVec3,
) -> ContactData {
    let away = |i: &usize| (known[*i].place - place).length_squared();
    let nearest = among.filter(|&i| !known[i].taken).min_by(|i, j| away(i).total_cmp(&away(j)));
    nearest.map_or_else(ContactData::default, |i| {
        known[i].taken = true;
        known[i].data
    })
}
