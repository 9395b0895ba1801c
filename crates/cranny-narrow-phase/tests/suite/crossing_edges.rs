//! Edges that cross under each other: a contact of their own, however obliquely they cross.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Contact, Demand, Feature, PairMemory, Placed, Query, query};
use cranny_shapes::Cuboid;

use crate::solids::shape;

/// How far the edges dip under each other.
const DEPTH: f64 = 0.01;

fn contacts(a: Placed, b: Placed) -> Vec<Contact> {
    let ask = Query::of(Demand::contacts(0.0));
    query(a, b, &ask, &mut PairMemory::default()).unwrap().contacts
}

/// A cube whose edge along y at (0.5, ., 0.5) is crossed by another cube's edge, along the normal
/// that leans from z by an angle; the other cube's faces lean alike from that normal, and its edge
/// by `askew` from straight across.
fn crossed(cube: &Model, angle: f64, askew: f64) -> (Placed<'_>, Placed<'_>, DVec3) {
    let normal = DVec3::new(angle.sin(), 0.0, angle.cos());
    let across = DQuat::from_axis_angle(normal, askew) * normal.cross(DVec3::Y);
    // Of the other cube, the edge along its x at (., -0.5, -0.5), turned until its two faces lean
    // alike.
    let aside = normal.cross(across);
    let corner_on = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_4);
    let frame = cranny_exact::DMat3::from_cols(across, aside, normal);
    let rotation = (DQuat::from_mat3(&frame) * corner_on).normalize();
    let on_edge = DVec3::new(0.5, 0.0, 0.5) - DEPTH * normal;
    let translation = on_edge - rotation * DVec3::new(0.0, -0.5, -0.5);
    let a = Placed { model: cube, pose: Pose::IDENTITY };
    (a, Placed { model: cube, pose: Pose { rotation, translation } }, normal)
}

/// The nearer the normal is to one of the edge's two faces, the nearer a point below the edge is to
/// the other one; out past that one leads no way, since the other edge reaches on.
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

/// A mesh and a copy of it elsewhere, as one body.
fn with_copy(mesh: &Mesh, place: impl Fn(DVec3) -> DVec3) -> Model {
    let count = mesh.vertices().len() as u32;
    let copies = mesh.vertices().iter().map(|&p| place(p));
    let vertices = mesh.vertices().iter().copied().chain(copies).collect();
    let moved = mesh.faces().iter().map(|f| f.map(|v| v + count));
    let faces = mesh.faces().iter().copied().chain(moved).collect();
    Model::build(Mesh::new(vertices, faces).unwrap(), &BuildOptions::default()).unwrap().0
}

/// Where nothing else overlaps, the crossing is reported for want of a contact; here a corner dips
/// in elsewhere.
#[test]
fn oblique_edges_have_their_contact_beside_others() {
    let cube = shape(Cuboid::default());
    for degrees in [30.0f64, 15.0, 8.0] {
        let (a, b, normal) = crossed(&cube, degrees.to_radians(), 0.3);
        let below = DVec3::new(0.0, 0.0, -5.0);
        let first = with_copy(cube.mesh(), |p| p + below);
        let (turn, at) = (b.pose.rotation, b.pose.translation);
        // In the world as the first's copy is, a little aside: corners dip by a tenth.
        let aside = below + DVec3::new(0.3, 0.2, -0.9);
        let second = with_copy(cube.mesh(), |p| turn.inverse() * (p + aside - at));
        let found = contacts(
            Placed { model: &first, pose: a.pose },
            Placed { model: &second, pose: b.pose },
        );
        assert!(found.iter().any(|c| c.separation < -0.05), "{degrees}: {found:?}");
        let is_crossing =
            |c: &&Contact| c.normal.dot(normal) > 1.0 - 1e-9 && (c.separation + DEPTH).abs() < 1e-9;
        assert!(found.iter().any(|c| is_crossing(&c)), "{degrees} degrees: {found:?}");
    }
}
