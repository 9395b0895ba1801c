//! From contacts to rapier's manifolds.
//!
//! A manifold has one normal, and rapier solves at most four of its points. So contacts whose normals
//! agree share a manifold, and every other contact gets one of its own: no normal is ever averaged.
//! Impulses of the last step are carried over by ids (for two meshes those of their patches, which
//! stay while the nearest features change) and place, or else by place alone.

use std::collections::HashMap;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::PatchId;
use cranny_narrow_phase::{Contact, Feature};
use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::parry::query::{ContactManifold, TrackedContact};
use rapier3d::parry::shape::PackedFeatureId;

use crate::convert::{narrow, wide};

/// rapier's manifold with rapier's data.
pub(crate) type Manifold = ContactManifold<ContactManifoldData, ContactData>;

/// Cosine of the angle (0.03 degrees) within which normals share a manifold. Larger: a curved flank
/// gets normals that are not its own, and 0.3 degrees already cost a turning nut motion; smaller:
/// flat contacts fall apart into single points by rounding.
const SAME_NORMAL: f64 = 0.999_999_9;

/// Cosine of the angle (8 degrees) within which a contact takes over the impulse of an earlier one
/// without its ids. Larger: impulses turn round corners; smaller: they are lost where a body rolls.
const SAME_WAY: f64 = 0.99;

/// Points of a manifold at most: rapier solves no more.
const MAX_POINTS: usize = 4;

/// Replaces the manifolds by those of the given contacts (coordinates of the first shape's frame,
/// normals from first to second), keeping impulses. `ids` names each contact from step to step.
pub(crate) fn rebuild(
    contacts: &[Contact],
    ids: impl Fn(&Contact) -> (PackedFeatureId, PackedFeatureId),
    first_from_second: &Pose,
    reach: f64,
    manifolds: &mut Vec<Manifold>,
) {
    let mut memory = Impulses::of(manifolds);
    let map = first_from_second.world_from_body();
    let inverse = map.inverse();
    let mut groups: Vec<(DVec3, Vec<&Contact>)> = Vec::new();
    for contact in contacts {
        let home = groups.iter_mut().find(|(normal, members)| {
            members.len() < MAX_POINTS && normal.dot(contact.normal) >= SAME_NORMAL
        });
        match home {
            Some((_, members)) => members.push(contact),
            None => groups.push((contact.normal, vec![contact])),
        }
    }
    manifolds.clear();
    for (index, (normal, members)) in groups.into_iter().enumerate() {
        let mut manifold =
            Manifold::with_data(index as u32, index as u32, ContactManifoldData::default());
        manifold.local_n1 = narrow(normal);
        manifold.local_n2 = narrow(inverse.apply_vector(-normal));
        for contact in members {
            let (first, second) = ids(contact);
            let mut point = TrackedContact::new(
                narrow(contact.point_a),
                narrow(inverse.apply(contact.point_b)),
                first,
                second,
                contact.separation as f32,
            );
            point.data = memory.recall(&point, normal, reach);
            manifold.points.push(point);
        }
        manifolds.push(manifold);
    }
}

/// Two bits of rapier's ids say what kind a feature is; meshes of more than 2^30 features do not exist.
pub(crate) fn packed(feature: Feature) -> PackedFeatureId {
    match feature {
        Feature::Vertex(v) => PackedFeatureId::vertex(v.0),
        Feature::Edge(e) => PackedFeatureId::edge(e.0),
        Feature::Face(f) => PackedFeatureId::face(f.0),
    }
}

/// A patch, for contacts between patches. Told as a face, of which there are at least as many.
pub(crate) fn packed_patch(patch: PatchId) -> PackedFeatureId {
    PackedFeatureId::face(patch.0)
}

/// What the solver learned in the last step.
struct Impulses {
    by_id: HashMap<(PackedFeatureId, PackedFeatureId), Vec<(DVec3, ContactData)>>,
    by_place: Vec<(DVec3, DVec3, ContactData)>,
}

impl Impulses {
    fn of(manifolds: &[Manifold]) -> Self {
        let mut out = Self { by_id: HashMap::new(), by_place: Vec::new() };
        for manifold in manifolds {
            for point in &manifold.points {
                let place = wide(point.local_p1);
                out.by_id.entry((point.fid1, point.fid2)).or_default().push((place, point.data));
                out.by_place.push((place, wide(manifold.local_n1), point.data));
            }
        }
        out
    }

    /// Each impulse is handed on by ids once at most.
    fn recall(
        &mut self,
        point: &TrackedContact<ContactData>,
        normal: DVec3,
        reach: f64,
    ) -> ContactData {
        let place = wide(point.local_p1);
        let away = |p: &DVec3| (*p - place).length_squared();
        if let Some(same) = self.by_id.get_mut(&(point.fid1, point.fid2)) {
            let nearest =
                (0..same.len()).min_by(|&i, &j| away(&same[i].0).total_cmp(&away(&same[j].0)));
            return nearest.map_or_else(ContactData::default, |i| same.swap_remove(i).1);
        }
        self.by_place
            .iter()
            .filter(|(p, n, _)| n.dot(normal) >= SAME_WAY && away(p) <= reach * reach)
            .min_by(|x, y| away(&x.0).total_cmp(&away(&y.0)))
            .map_or_else(ContactData::default, |(_, _, data)| *data)
    }
}
