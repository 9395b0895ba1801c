//! A half-space against a mesh: the lowest vertices of the mesh.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{FaceId, Model, VertexId};
use cranny_narrow_phase::{Contact, Feature, reduce_contacts};

use crate::primitive::Plane;

/// Every vertex lower than `reach` above a half-space's plane, reduced to those that span.
pub(super) fn half_space_contacts(
    model: &Model,
    &Plane { normal, offset }: &Plane,
    reach: f64,
) -> Vec<Contact> {
    let mut low: Vec<VertexId> = Vec::new();
    model.tree().visit(
        |b| lowest(b, normal) - offset <= reach,
        |face| low.extend(model.mesh().corners(face)),
    );
    low.sort_unstable();
    low.dedup();
    let contacts = low.into_iter().filter_map(|v| {
        let p = model.mesh().position(v);
        let separation = normal.dot(p) - offset;
        (separation <= reach).then(|| Contact {
            id: (Feature::Vertex(v), Feature::Face(FaceId(0))),
            point_a: p,
            point_b: p - normal * separation,
            normal: -normal,
            separation,
        })
    });
    reduce_contacts(contacts.collect())
}

/// The least product of a point of a box with a direction.
pub(crate) fn lowest(b: &Aabb, normal: DVec3) -> f64 {
    normal.min(DVec3::ZERO).dot(b.max) + normal.max(DVec3::ZERO).dot(b.min)
}
