//! From contacts to rapier's manifolds.
//!
//! A manifold has one normal, and rapier solves at most four of its points. So contacts whose normals
//! agree share a manifold, and every other contact gets one of its own: no normal is ever averaged.
//! Impulses of the last step are carried over by feature ids, or else by place.

use std::collections::HashMap;

use cranny_exact::{DVec3, Pose};
use cranny_narrow_phase::{Contact, Feature};
use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::parry::query::{ContactManifold, TrackedContact};
use rapier3d::parry::shape::PackedFeatureId;

use crate::convert::{narrow, wide};

/// rapier's manifold with rapier's data.
pub(crate) type Manifold = ContactManifold<ContactManifoldData, ContactData>;

/// Cosine of the angle (0.8 degrees) within which normals share a manifold. Larger: a curved flank
/// gets normals that are not its own, and 0.3 degrees already cost a turning nut motion; smaller:
/// flat contacts fall apart into single points by rounding.
const SAME_NORMAL: f64 = 0.999_9;

/// Points of a manifold at most: rapier solves no more.
const MAX_POINTS: usize = 4;

/// Replaces the manifolds by those of the given contacts (coordinates of the first shape's frame,
/// normals from first to second), keeping impulses.
pub(crate) fn rebuild(
    contacts: &[Contact],
    first_from_second: &Pose,
    reach: f64,
    manifolds: &mut Vec<Manifold>,
) {
    let memory = Impulses::of(manifolds);
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
            let mut point = TrackedContact::new(
                narrow(contact.point_a),
                narrow(inverse.apply(contact.point_b)),
                packed(contact.id.0),
                packed(contact.id.1),
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

/// What the solver learned in the last step.
struct Impulses {
    by_id: HashMap<(PackedFeatureId, PackedFeatureId), ContactData>,
    by_place: Vec<(DVec3, DVec3, ContactData)>,
}

impl Impulses {
    fn of(manifolds: &[Manifold]) -> Self {
        let mut out = Self { by_id: HashMap::new(), by_place: Vec::new() };
        for manifold in manifolds {
            for point in &manifold.points {
                out.by_id.insert((point.fid1, point.fid2), point.data);
                out.by_place.push((wide(point.local_p1), wide(manifold.local_n1), point.data));
            }
        }
        out
    }

    fn recall(
        &self,
        point: &TrackedContact<ContactData>,
        normal: DVec3,
        reach: f64,
    ) -> ContactData {
        if let Some(data) = self.by_id.get(&(point.fid1, point.fid2)) {
            return *data;
        }
        let place = wide(point.local_p1);
        self.by_place
            .iter()
            .filter(|(p, n, _)| {
                n.dot(normal) >= SAME_NORMAL && (*p - place).length_squared() <= reach * reach
            })
            .min_by(|x, y| {
                (x.0 - place).length_squared().total_cmp(&(y.0 - place).length_squared())
            })
            .map_or_else(ContactData::default, |(_, _, data)| *data)
    }
}
