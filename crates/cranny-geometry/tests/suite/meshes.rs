//! Meshes that several tests of this crate share.

#![allow(dead_code, reason = "each test uses some of them")]

use cranny_exact::{DMat3, DQuat, DVec3};
use cranny_geometry::Mesh;
use cranny_testkit::Rng;

/// Turned so that nothing stands along an axis; turning rounds.
pub(crate) fn turned(mesh: &Mesh) -> Mesh {
    let turn = DMat3::from_quat(DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize());
    let vertices = mesh.vertices().iter().map(|&p| turn * p).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
}

/// Scaled about the origin.
pub(crate) fn scaled(mesh: &Mesh, factor: f64) -> Mesh {
    let vertices = mesh.vertices().iter().map(|&p| factor * p).collect();
    Mesh::new(vertices, mesh.faces().to_vec()).unwrap()
}

/// Random faces on few vertices of a small lattice, some of them a hair off: degenerate,
/// coincident, turned around, many at an edge.
pub(crate) fn soup(rng: &mut Rng, faces: usize) -> Mesh {
    let count = 3 + faces / 2;
    let vertices = (0..count).map(|_| {
        let mut whole = || f64::from(rng.between(-2, 2));
        let p = DVec3::new(whole(), whole(), whole());
        let hair = if rng.below(4) == 0 { f64::from(rng.between(-3, 3)) * 1e-12 } else { 0.0 };
        p + DVec3::new(0.0, hair, 0.5 * hair)
    });
    let vertices = vertices.collect();
    let faces = (0..faces).map(|_| [0; 3].map(|_: u32| rng.below(count) as u32)).collect();
    Mesh::new(vertices, faces).unwrap()
}
