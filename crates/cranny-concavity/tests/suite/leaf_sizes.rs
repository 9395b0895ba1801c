//! How many faces leaves hold is a matter of speed: answers are the same, and models keep it.

use std::num::NonZeroUsize;

use crate::body::Body;
use cranny_concavity::envelope::{Pocket, Probe};
use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{
    BuildError, BuildOptions, Content, FaceForest, FaceId, FaceTree, Mesh, Model, VertexId,
};
use cranny_shapes::{Cup, Gear, GolfBall, Shape, Torus};
use cranny_testkit::Rng;

fn built(mesh: &Mesh, leaf_size: usize) -> Body {
    let (model, _) = Model::build(mesh.clone(), &BuildOptions::default()).unwrap();
    Body::with_leaf_size(model, NonZeroUsize::new(leaf_size).unwrap())
}

/// The most faces that a leaf of the trees over concavities holds.
fn largest_leaf(trees: &FaceForest) -> usize {
    let arena = trees.arena();
    let leaf = |n| match arena.content(n) {
        Content::Leaf { start, end } => (end - start) as usize,
        Content::Inner { .. } => 0,
    };
    (0..arena.nodes().len() as u32).map(leaf).max().unwrap_or(0)
}

fn validate(model: &Body) {
    let (mesh, all) = (model.mesh(), model.concavities());
    model.concavity_trees().validate(mesh, all.iter().map(|c| c.faces)).unwrap();
    let openings: Vec<Vec<DVec3>> =
        all.iter().map(|c| c.lids().map(|lid| lid.opening).collect()).collect();
    let pockets = all.iter().zip(&openings);
    let pockets = pockets.map(|(c, openings)| Pocket { faces: c.faces, openings });
    model.envelopes().validate(mesh, pockets).unwrap();
}

/// Faces of a concavity whose boxes a window meets: by its tree, and by its envelope.
fn met(model: &Body, concavity: usize, window: &Aabb) -> [Vec<FaceId>; 2] {
    let mesh = model.mesh();
    let is_met = |f: &FaceId| Aabb::of_points(mesh.triangle(*f)).overlaps(window);
    let (mut by_tree, mut by_envelope) = (Vec::new(), Vec::new());
    let trees = model.concavity_trees();
    if let Some(root) = trees.root(concavity) {
        trees.arena().visit_from(root, |b| b.overlaps(window), |f| by_tree.push(f));
    }
    let corners = [window.min, window.max];
    let corners: Vec<DVec3> = (0..8)
        .map(|i| DVec3::new(corners[i & 1].x, corners[i >> 1 & 1].y, corners[i >> 2].z))
        .collect();
    let thing = Probe::of_points(&corners, 0.0);
    model.envelopes().envelope(concavity).for_each_face(&thing, |f| by_envelope.push(f));
    [by_tree, by_envelope].map(|mut found| {
        found.retain(is_met);
        found.sort_unstable();
        found
    })
}

#[test]
fn what_is_found_does_not_depend_on_leaves() {
    let mut rng = Rng::new(91);
    let ball = GolfBall { dimples: 12, triangles: 1_000, ..GolfBall::default() };
    for mesh in [
        Torus::default().build().unwrap(),
        Cup::default().build().unwrap(),
        Gear::default().build().unwrap(),
        ball.build().unwrap(),
    ] {
        let models = [FaceForest::DEFAULT_LEAF_SIZE, 1, 3, 8, 1000].map(|leaf_size| {
            let model = built(&mesh, leaf_size);
            validate(&model);
            assert!(largest_leaf(model.concavity_trees()) <= leaf_size);
            model
        });
        assert!(largest_leaf(models[4].concavity_trees()) > 8);
        let [usual, others @ ..] = &models;
        let bounds = usual.bounds();
        for other in others {
            assert_eq!(other.concavities().set(), usual.concavities().set());
            assert_eq!(other.digest(), usual.digest());
            for _ in 0..20 {
                let mut part = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
                let middle = bounds.min + (bounds.max - bounds.min) * part();
                let half = 0.2 * (bounds.max - bounds.min) * part();
                let window = Aabb { min: middle - half, max: middle + half };
                for concavity in usual.concavities().iter() {
                    let i = concavity.id().index();
                    let is_met = |f: &FaceId| Aabb::of_points(mesh_of(usual, *f)).overlaps(&window);
                    let all: Vec<FaceId> = concavity.faces.iter().copied().filter(is_met).collect();
                    let [by_tree, by_envelope] = met(other, i, &window);
                    assert_eq!(by_tree, all);
                    // Its planes leave out more than boxes do.
                    assert!(by_envelope.iter().all(|f| all.binary_search(f).is_ok()));
                    let touched = all
                        .iter()
                        .filter(|&&f| mesh_of(usual, f).iter().any(|&p| window.contains_point(p)));
                    assert!(touched.into_iter().all(|f| by_envelope.binary_search(f).is_ok()));
                }
            }
        }
    }
}

fn mesh_of(model: &Body, face: FaceId) -> [DVec3; 3] {
    model.mesh().triangle(face)
}

/// The most faces that a leaf of a tree holds.
fn largest_of_tree(tree: &FaceTree) -> usize {
    (0..tree.nodes().len() as u32).map(|n| tree.leaf_faces(n).len()).max().unwrap_or(0)
}

#[test]
fn a_saved_model_keeps_its_leaves() {
    let mesh = Torus::default().build().unwrap();
    for leaf_size in [1, 2, 7, usize::MAX] {
        let options = BuildOptions { leaf_size, ..BuildOptions::default() };
        let (model, _) = Model::build(mesh.clone(), &options).unwrap();
        let bytes = model.encode();
        let mut back = Model::decode(&bytes).unwrap();
        assert!(back.encode() == bytes);
        assert!(format!("{:?}", back.tree()) == format!("{:?}", model.tree()));
        let v = VertexId(3);
        back.deform(&[(v, 1.01 * back.mesh().position(v))]).unwrap();
        assert!(largest_of_tree(back.tree()) <= leaf_size);
        assert_eq!(largest_of_tree(back.tree()), largest_of_tree(model.tree()));
    }
}

#[test]
fn a_deformation_keeps_the_size_of_leaves() {
    for shape in Shape::defaults() {
        let mesh = shape.build().unwrap();
        if mesh.faces().len() > 3000 {
            continue;
        }
        for leaf_size in [1, 8] {
            let built = built(&mesh, leaf_size);
            let leaves = NonZeroUsize::new(leaf_size).unwrap();
            let read = Body::with_leaf_size(Model::decode(&built.encode()).unwrap(), leaves);
            for mut model in [built, read] {
                for v in [0, 1, 3].map(VertexId) {
                    let inward = 0.3 * (model.bounds().center() - model.mesh().position(v));
                    model.deform(&[(v, model.mesh().position(v) + inward)]).unwrap();
                    validate(&model);
                    assert!(largest_leaf(model.concavity_trees()) <= leaf_size);
                }
            }
        }
    }
}

#[test]
fn leaves_without_faces_are_refused() {
    let mesh = Cup::default().build().unwrap();
    let options = BuildOptions { leaf_size: 0, ..BuildOptions::default() };
    let refused = Model::build(mesh, &options).err();
    assert_eq!(refused, Some(BuildError::LeafSize));
}
