//! Trees over all faces, some faces, and groups of faces.

use std::collections::BTreeSet;

use crate::meshes::{scaled, soup, turned};
use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{FaceForest, FaceId, FaceTree, Mesh, Topology};
use cranny_shapes::{NestedShells, Shape};
use cranny_testkit::Rng;

fn all(mesh: &Mesh) -> Vec<FaceId> {
    (0..mesh.faces().len() as u32).map(FaceId).collect()
}

fn face_box(mesh: &Mesh, face: FaceId) -> Aabb {
    Aabb::of_points(mesh.triangle(face))
}

/// A box about as large as a tenth of the mesh, somewhere in its box.
fn window(rng: &mut Rng, mesh: &Mesh) -> Aabb {
    let b = mesh.bounds();
    let mut at = || b.min + (b.max - b.min) * fractions(rng);
    let middle = at();
    let half = 0.1 * (at() - b.min);
    Aabb { min: middle - half, max: middle + half }
}

fn fractions(rng: &mut Rng) -> DVec3 {
    let mut part = || 0.5 + 0.5 * rng.unit();
    DVec3::new(part(), part(), part())
}

#[test]
fn every_generator_has_a_tree_over_all_and_some_faces() {
    for shape in Shape::defaults() {
        let mesh = turned(&shape.build().unwrap());
        let faces = all(&mesh);
        let some: Vec<FaceId> = faces.iter().copied().filter(|f| f.0 % 3 == 1).collect();
        for leaf_size in [1, 4, 1000] {
            FaceTree::of(&mesh, leaf_size).validate(&mesh, &faces).unwrap();
            FaceTree::over(&mesh, &some, leaf_size).validate(&mesh, &some).unwrap();
        }
    }
}

#[test]
fn a_visit_finds_what_looking_at_every_face_finds() {
    let mut rng = Rng::new(3);
    for round in 0..200 {
        let mesh = soup(&mut rng, 2 + 2 * round);
        let some: Vec<FaceId> = all(&mesh).into_iter().filter(|_| rng.below(3) > 0).collect();
        let tree = FaceTree::over(&mesh, &some, 1 + round % 5);
        tree.validate(&mesh, &some).unwrap();
        let window = window(&mut rng, &mesh);
        let mut found = BTreeSet::new();
        tree.visit(
            |b| b.overlaps(&window),
            |f| assert!(found.insert(f), "face {} is visited twice", f.0),
        );
        found.retain(|&f| face_box(&mesh, f).overlaps(&window));
        let wanted: BTreeSet<FaceId> =
            some.into_iter().filter(|&f| face_box(&mesh, f).overlaps(&window)).collect();
        assert_eq!(found, wanted);
    }
}

#[test]
fn a_forest_over_components() {
    let mesh = NestedShells::default().build().unwrap();
    let topology = Topology::of(&mesh);
    let mut groups = vec![Vec::new(); topology.components().len()];
    for face in all(&mesh) {
        groups[topology.component_of(face).0 as usize].push(face);
    }
    let slices = || groups.iter().map(Vec::as_slice);
    FaceForest::over(&mesh, slices(), 2).validate(&mesh, slices()).unwrap();
}

#[test]
fn powers_of_two_change_no_tree() {
    let mesh = turned(&NestedShells::default().build().unwrap());
    let tree = FaceTree::of(&mesh, 2);
    for exponent in [-150, -1, 100] {
        let other = FaceTree::of(&scaled(&mesh, 2f64.powi(exponent)), 2);
        assert_eq!(tree.faces(), other.faces());
    }
}

#[test]
fn a_tree_over_the_wrong_faces_is_refused() {
    let mesh = NestedShells::default().build().unwrap();
    let tree = FaceTree::of(&mesh, 2);
    let faces = all(&mesh);
    assert!(tree.validate(&mesh, &faces[1..]).is_err());
    assert!(tree.validate(&scaled(&mesh, 1.5), &faces).is_err());
}
