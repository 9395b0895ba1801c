//! Deformation: what follows moved vertices equals what is built of the moved mesh.

mod any_solid;
pub(crate) mod equal;
mod folded;
mod moves;
mod surface;
mod without_area;

use crate::body::{Body, Change};
use crate::meshes::turned;
use cranny_concavity::ConcavityWork;
use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, DeformError, FaceId, Flatness, Mesh, VertexId};
use cranny_shapes::{Cuboid, Cup, GolfBall, NestedShells, Shape, Sphere, Torus, UPrism};
use cranny_testkit::Rng;
use equal::{assert_equals_rebuild, options};
use moves::{bell, random_moves};

fn model(mesh: Mesh) -> Body {
    Body::build(mesh, &options()).unwrap().0
}

/// Deforms, and checks the result and the change set.
fn deformed(model: &mut Body, moves: &[(VertexId, DVec3)], what: &str) -> Change {
    let before = model.clone();
    let change = model.deform(moves).unwrap_or_else(|e| panic!("{what}: {e}"));
    assert_equals_rebuild(model, what);
    equal::assert_tells_changes(&before, model, &change, what);
    change
}

#[test]
fn whatever_happens_to_a_generator_equals_a_rebuild() {
    let mut rng = Rng::new(7);
    let mut refused = 0;
    for shape in Shape::defaults() {
        let plain = shape.build().unwrap();
        if plain.faces().len() > 3000 {
            continue;
        }
        for mesh in [turned(&plain), plain] {
            let mut model = model(mesh);
            for step in 0..6 {
                let moves = random_moves(model.mesh(), &mut rng);
                let what = format!("{} step {step}", shape.name());
                let before = (model.digest(), model.mesh().clone());
                match model.deform(&moves) {
                    Ok(_) => assert_equals_rebuild(&model, &what),
                    Err(DeformError::InsideOut { .. }) => {
                        refused += 1;
                        assert_eq!((model.digest(), model.mesh()), (before.0, &before.1));
                    }
                    Err(e) => panic!("{what}: {e}"),
                }
            }
        }
    }
    assert!(refused < 20, "{refused}");
}

#[test]
fn a_cup_dented_from_within_keeps_its_hull() {
    let mesh = Cup::default().build().unwrap();
    let mut model = model(mesh);
    let hull = model.hull().clone();
    let inner = (0..model.mesh().vertices().len() as u32)
        .map(VertexId)
        .find(|&v| {
            model.hull().locate(model.mesh().position(v)) == cranny_geometry::hull::Location::Inside
        })
        .unwrap();
    for step in 0..4 {
        let to = model.mesh().position(inner) + DVec3::new(0.01, 0.02, 0.015);
        let change = deformed(&mut model, &[(inner, to)], &format!("cup {step}"));
        assert!(!change.hull && change.beneath.reclassified.is_empty());
        assert_eq!(change.beneath.reshaped.len(), 1);
        assert_eq!(*model.hull(), hull);
    }
}

#[test]
fn a_dent_in_a_flat_side_opens_a_concavity_and_closes_it_again() {
    let mut mesh = Cuboid::default().build().unwrap();
    for _ in 0..3 {
        mesh = split_edges(&mesh);
    }
    let mut model = model(mesh);
    assert_eq!(model.concavities().len(), 0);
    let hull = model.hull().clone();
    let middle = (0..model.mesh().vertices().len() as u32)
        .map(VertexId)
        .find(|&v| {
            let p = model.mesh().position(v);
            p.x == model.bounds().max.x && p.y.abs() < 0.1 && p.z.abs() < 0.1
        })
        .unwrap();
    let home = model.mesh().position(middle);
    let change = deformed(&mut model, &[(middle, home - 0.1 * DVec3::X)], "in");
    assert!(!change.hull && !change.beneath.reclassified.is_empty());
    assert_eq!(model.concavities().len(), 1);
    assert_eq!(*model.hull(), hull);
    let change = deformed(&mut model, &[(middle, home)], "out");
    assert_eq!((model.concavities().len(), change.beneath.concavities), (0, vec![None]));
    // Beyond the side: the hull grows by a vertex, and the block's side is under a tent.
    let change = deformed(&mut model, &[(middle, home + 0.1 * DVec3::X)], "beyond");
    assert!(change.hull);
    assert_eq!(model.hull().vertex_count(), 9);
}

/// Every triangle divided into four.
fn split_edges(mesh: &Mesh) -> Mesh {
    let mut vertices = mesh.vertices().to_vec();
    let mut middles = std::collections::BTreeMap::new();
    let mut faces = Vec::new();
    for &[a, b, c] in mesh.faces() {
        let mut middle = |i: u32, j: u32| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                vertices.push(0.5 * (vertices[i as usize] + vertices[j as usize]));
                vertices.len() as u32 - 1
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh::new(vertices, faces).unwrap()
}

#[test]
fn nested_shells_are_kneaded_for_long() {
    let mut rng = Rng::new(3);
    for mesh in [
        NestedShells::default().build().unwrap(),
        Torus { major_segments: 24, minor_segments: 8, ..Torus::default() }.build().unwrap(),
        UPrism::default().build().unwrap(),
    ] {
        let mut model = model(turned(&mesh));
        for step in 0..12 {
            let moves = random_moves(model.mesh(), &mut rng);
            if model.deform(&moves).is_ok() {
                assert_equals_rebuild(&model, &format!("step {step}"));
            }
        }
    }
}

#[test]
fn nothing_moved_is_nothing_changed() {
    let mut model = model(Torus::default().build().unwrap());
    let (same, digest) = (model.clone(), model.digest());
    let v = VertexId(7);
    let change = model.deform(&[(v, model.mesh().position(v))]).unwrap();
    assert!(
        change.is_empty() && change.beneath.concavities == [Some(cranny_concavity::ConcavityId(0))]
    );
    assert_eq!(change.work, cranny_geometry::Work::default());
    assert_eq!(change.beneath.work, ConcavityWork::default());
    assert!(model.is_same(&same) && model.digest() == digest);
    assert!(model.deform(&[]).unwrap().is_empty());
}

#[test]
fn a_shared_model_stays_as_it_was() {
    let mut model = model(Torus::default().build().unwrap());
    let (shared, before) = (model.clone(), model.mesh().clone());
    let v = VertexId(3);
    model.deform(&[(v, 1.01 * before.position(v))]).unwrap();
    assert!(!model.is_same(&shared));
    assert_eq!((shared.mesh(), model.mesh() == &before), (&before, false));
    assert_equals_rebuild(&shared, "the other");
}

#[test]
fn a_model_from_a_file_is_deformed_like_the_one_it_was_saved_from() {
    let mut model = model(turned(&Cup::default().build().unwrap()));
    let mut rng = Rng::new(5);
    for step in 0..4 {
        let mut loaded = Body::decode(&model.encode()).unwrap();
        let moves = random_moves(model.mesh(), &mut rng);
        let done = model.deform(&moves);
        let read = loaded.clone();
        let change = loaded.deform(&moves);
        assert_eq!(change.is_ok(), done.is_ok());
        // Trees may have been regrown for what happened before the file was written.
        if let Ok(change) = change {
            equal::assert_tells_changes(&read, &loaded, &change, "loaded");
        }
        assert_equals_rebuild(&loaded, &format!("step {step}"));
        equal::assert_equal(&loaded, &model, &format!("step {step}"));
    }
}

#[test]
fn bad_moves_are_refused_and_change_nothing() {
    let mut model = model(Cuboid::default().build().unwrap());
    let before = model.clone();
    let (v, p) = (VertexId(0), DVec3::ONE);
    let refused = |model: &mut Body, moves: &[(VertexId, DVec3)]| {
        let error = model.deform(moves).unwrap_err();
        assert!(model.is_same(&before));
        error
    };
    let nan = refused(&mut model, &[(VertexId(1), p), (v, DVec3::new(0.0, f64::NAN, 0.0))]);
    assert!(matches!(nan, DeformError::Coordinate { vertex: VertexId(0), .. }), "{nan}");
    let far = refused(&mut model, &[(v, DVec3::splat(1e300))]);
    assert!(matches!(far, DeformError::Coordinate { .. }), "{far}");
    let unknown = refused(&mut model, &[(v, p), (VertexId(8), p)]);
    assert_eq!(unknown, DeformError::UnknownVertex { at: 1, vertex: VertexId(8), vertices: 8 });
    let twice = refused(&mut model, &[(v, p), (VertexId(1), p), (v, p)]);
    assert_eq!(twice, DeformError::MovedTwice { vertex: v });
    let line: Vec<_> =
        (0..8).map(|i| (VertexId(i), f64::from(i) * DVec3::new(1.0, 0.5, 0.25))).collect();
    assert_eq!(refused(&mut model, &line), DeformError::OnlyDegenerateFaces { faces: 12 });
    let mirrored: Vec<_> = (0..8)
        .map(|i| (VertexId(i), before.mesh().position(VertexId(i)) * DVec3::new(-1.0, 1.0, 1.0)))
        .collect();
    assert!(matches!(refused(&mut model, &mirrored), DeformError::InsideOut { .. }));
}

#[test]
fn a_body_may_be_flattened_and_raised_again() {
    let mesh = Cuboid::default().build().unwrap();
    let mut model = model(mesh.clone());
    let all = (0..8).map(VertexId);
    let flat: Vec<_> = all
        .clone()
        .map(|v| {
            (v, mesh.position(v) * DVec3::new(1.0, 1.0, 0.0) + f64::from(v.0) * 0.01 * DVec3::X)
        })
        .collect();
    model.deform(&flat).unwrap();
    assert_eq!(model.hull().kind(), cranny_geometry::hull::HullKind::Polygon);
    assert_equals_rebuild(&model, "flat");
    let back: Vec<_> = all.map(|v| (v, mesh.position(v))).collect();
    model.deform(&back).unwrap();
    assert_equals_rebuild(&model, "raised");
    assert_eq!(model.hull().volume(), mesh.bounds().max.x * 2.0);
}

#[test]
fn an_open_surface_follows_too() {
    let closed = Sphere::default().build().unwrap();
    let faces = closed.faces()[..closed.faces().len() / 2].to_vec();
    let mut model = model(Mesh::new(closed.vertices().to_vec(), faces).unwrap());
    let mut rng = Rng::new(11);
    for step in 0..8 {
        let moves = random_moves(model.mesh(), &mut rng);
        deformed(&mut model, &moves, &format!("step {step}"));
        assert!(model.mass_properties().is_none());
    }
}

#[test]
fn openings_without_faces_keep_their_order_however_facets_are_numbered() {
    // A divided cube, of two opposite sides of which faces are missing: openings that no face lies
    // beneath.
    let whole = split_edges(&split_edges(&Cuboid::default().build().unwrap()));
    let mut rng = Rng::new(5);
    let (mut faceless, mut followed) = (0, 0);
    for _ in 0..12 {
        let faces = whole.faces().iter().copied().filter(|_| rng.below(8) != 0).collect();
        let mut model = model(Mesh::new(whole.vertices().to_vec(), faces).unwrap());
        for step in 0..6 {
            let corners = model.hull().sources();
            let v = corners[rng.below(corners.len())];
            let place = model.mesh().position(v) * [0.96875, 1.03125][rng.below(2)];
            let change = deformed(&mut model, &[(v, place)], &format!("step {step}"));
            let bare = model.concavities().iter().filter(|c| c.faces.is_empty()).count();
            faceless += usize::from(bare > 1);
            followed += usize::from(change.hull && !change.work.is_anew);
        }
    }
    assert!(faceless > 20 && followed > 20, "{faceless}, {followed}");
}

/// A dimple of a golf ball, pressed: how much is looked at does not depend on how large the ball
/// is.
#[test]
fn work_follows_the_dent_not_the_mesh() {
    let pressed = |triangles: u32, radius_in_edges: f64| {
        let ball = GolfBall { triangles, dimples: 12, dimple_depth: 0.1, ..GolfBall::default() };
        let ball = ball.build().unwrap();
        let mut model = model(ball);
        let mesh = model.mesh().clone();
        let deepest = (0..mesh.vertices().len() as u32)
            .map(VertexId)
            .min_by(|&a, &b| mesh.position(a).length().total_cmp(&mesh.position(b).length()))
            .unwrap();
        let edge = mesh.area_vector(FaceId(0)).length().sqrt();
        let shift = -0.1 * edge * mesh.position(deepest).normalize();
        let moves = bell(&mesh, deepest, radius_in_edges * edge, shift);
        assert!(moves.iter().all(|m| model.hull().vertex_of_source(m.0).is_none()));
        let change = deformed(&mut model, &moves, "dimple");
        assert!(!change.hull);
        (moves.len(), change.work, change.beneath.work)
    };
    let (few, small, few_beneath) = pressed(5_000, 2.5);
    let (same, large, beneath) = pressed(20_000, 2.5);
    assert!(few >= 3 && same <= 2 * few, "{few}, {same}");
    assert!(beneath.faces <= 2 * few_beneath.faces, "{few_beneath:?}, {beneath:?}");
    assert!(beneath.facets <= 2 * few_beneath.facets.max(8), "{few_beneath:?}, {beneath:?}");
    assert!(large.nodes <= 2 * small.nodes, "{small:?}, {large:?}");
    assert!(beneath.nodes <= 2 * few_beneath.nodes, "{few_beneath:?}, {beneath:?}");
    assert!(large.summed <= 2 * small.summed, "{small:?}, {large:?}");
    assert!(large.located <= 2 * small.located, "{small:?}, {large:?}");
    let (more, _, wide) = pressed(20_000, 5.0);
    assert!(more > 2 * same && wide.faces > 2 * beneath.faces, "{beneath:?}, {wide:?}");
}

/// Vertices of a smooth body pushed in and pulled out: what is measured follows these.
#[test]
fn a_hull_is_repaired_where_it_was_dented() {
    let work = |segments: u32| {
        let sphere = Sphere { radius: 1.0, segments, rings: segments / 2 };
        let mesh = turned(&sphere.build().unwrap());
        let mut model = model(mesh.clone());
        let bounds = mesh.bounds();
        // Away from the six sides of the box, which decides how flat is flat.
        let inner = |v: &VertexId| {
            let share = (mesh.position(*v) - bounds.center()).abs() / (bounds.max - bounds.min);
            share.max_element() < 0.32
        };
        let v = (0..mesh.vertices().len() as u32).map(VertexId).find(inner).unwrap();
        let mut most = 0;
        for factor in [0.99, 1.001, 0.9, 1.0] {
            let change = deformed(&mut model, &[(v, factor * mesh.position(v))], "sphere");
            assert!(change.hull && change.work.hull_triangles > 0);
            let beneath = change.beneath.work;
            most = most.max(change.work.hull_triangles + beneath.facets + beneath.faces);
        }
        (most, model.hull().triangle_count())
    };
    let ((small, few), (large, many)) = (work(24), work(96));
    assert!(many > 10 * few && large <= 2 * small, "{small} of {few}, {large} of {many}");
}

#[test]
fn a_model_of_single_precision_keeps_its_flatness() {
    let mesh = turned(&Torus::default().build().unwrap());
    let stored: Vec<DVec3> = mesh.vertices().iter().map(|p| p.as_vec3().as_dvec3()).collect();
    let mesh = Mesh::new(stored, mesh.faces().to_vec()).unwrap();
    let (mut model, report) = Body::build(mesh, &BuildOptions::default()).unwrap();
    assert_eq!(report.flatness, Flatness::SINGLE);
    let v = VertexId(5);
    // No number of single precision.
    let to = model.mesh().position(v) + DVec3::splat(1e-3 / 3.0);
    model.deform(&[(v, to)]).unwrap();
    let single = BuildOptions { flatness: Flatness::Single, ..options() };
    let (rebuilt, _) = Body::build(model.mesh().clone(), &single).unwrap();
    equal::assert_equal(&model, &rebuilt, "torus");
}
