//! Edges that cross under each other: a contact of their own, however obliquely they cross.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Contact, Demand, Feature, PairMemory, Placed, Query, query};
use cranny_shapes::Cuboid;

use crate::solids::shape;

/// How far the edges dip under each other.
const DEPTH: f64 = 0.01;

fn contacts(a: Placed, b: Placed) -> Vec<Contact> {
    let ask = Query::of(Demand::Contacts { margin: 0.0 });
    query(a, b, &ask, &mut PairMemory::default()).unwrap().contacts
}

/// A cube whose edge along y at (0.5, ., 0.5) is crossed by another cube's edge, along the normal that leans from z
/// by an angle; the other cube's faces lean alike from that normal, and its edge by `askew` from straight across.
fn crossed(cube: &Model, angle: f64, askew: f64) -> (Placed<'_>, Placed<'_>, DVec3) {
    let normal = DVec3::new(angle.sin(), 0.0, angle.cos());
    let across = DQuat::from_axis_angle(normal, askew) * normal.cross(DVec3::Y);
    // Of the other cube, the edge along its x at (., -0.5, -0.5), turned until its two faces lean alike.
    let aside = normal.cross(across);
    let corner_on = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_4);
    let frame = cranny_exact::DMat3::from_cols(across, aside, normal);
    let rotation = (DQuat::from_mat3(&frame) * corner_on).normalize();
    let on_edge = DVec3::new(0.5, 0.0, 0.5) - DEPTH * normal;
    let translation = on_edge - rotation * DVec3::new(0.0, -0.5, -0.5);
    let a = Placed { model: cube, pose: Pose::IDENTITY };
    (a, Placed { model: cube, pose: Pose { rotation, translation } }, normal)
}

/// The nearer the normal is to one of the edge's two faces, the nearer a point below the edge is to the other
/// one; out past that one leads no way, since the other edge reaches on.
#[test]
fn oblique_edges_have_their_contact() {
    let cube = shape(Cuboid::default());
    for degrees in [45.0f64, 30.0, 15.0, 8.0] {
        for askew in [0.0, 0.3] {
            let (a, b, normal) = crossed(&cube, degrees.to_radians(), askew);
            let found = contacts(a, b);
            let edges = found
                .iter()
                .find(|c| matches!(c.id, (Feature::Edge(_), Feature::Edge(_))))
                .unwrap_or_else(|| panic!("{degrees} degrees, {askew} askew: {found:?}"));
            assert!(edges.normal.dot(normal) > 1.0 - 1e-9, "{degrees}, {askew}: {edges:?}");
            assert!((edges.separation + DEPTH).abs() < 1e-9, "{degrees}, {askew}: {edges:?}");
        }
    }
}
