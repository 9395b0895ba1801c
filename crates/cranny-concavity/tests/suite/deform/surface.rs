//! Moves that change the hull, one after the other: what follows equals a rebuild, and what there
//! is to do does not depend on how large the mesh is.

use crate::body::{Body, Change};
use cranny_exact::DVec3;
use cranny_geometry::{DeformError, Mesh, VertexId};
use cranny_shapes::{Cup, Gear, GolfBall, NestedShells, Sphere, Torus};
use cranny_testkit::Rng;

use super::equal::{assert_equals_rebuild, assert_tells_changes};
use super::{deformed, model, split_edges};
use crate::meshes::turned;

/// A vertex of the hull away from the sides of its box, which decide how flat is flat.
fn corner(model: &Body, rng: &mut Rng) -> Option<VertexId> {
    let bounds = model.bounds();
    let all = model.hull().sources();
    let first = rng.below(all.len());
    let is_within = |v: &VertexId| {
        let p = model.mesh().position(*v);
        (p - bounds.min).min(bounds.max - p).min_element() > 0.02 * bounds.diagonal()
    };
    (0..all.len()).map(|i| all[(first + i) % all.len()]).find(is_within)
}

fn neighbours(model: &Body, v: VertexId) -> Vec<VertexId> {
    let faces = model.topology().faces_at(v);
    let mut all: Vec<_> = faces.iter().flat_map(|&f| model.mesh().corners(f)).collect();
    all.sort_unstable();
    all.dedup();
    all.retain(|&w| w != v);
    all
}

/// Where a vertex of the hull may go: in, out, into the plane of a face beside it, onto another
/// vertex, through the body, or a hair.
fn place(model: &Body, v: VertexId, kind: usize, rng: &mut Rng) -> DVec3 {
    let mesh = model.mesh();
    let (p, middle) = (mesh.position(v), model.bounds().center());
    let others = neighbours(model, v);
    let any = mesh.position(others[rng.below(others.len())]);
    match kind {
        0 => p + 0.03 * (middle - p),
        1 => p - 0.01 * (middle - p),
        // Faces across the ring's edges have planes; a combination of a face's corners lies in one.
        2 => {
            let face = others.iter().flat_map(|&w| model.topology().faces_at(w));
            let beyond = face.copied().find(|&f| !mesh.corners(f).contains(&v));
            beyond.map_or(p, |f| {
                let [a, b, c] = mesh.triangle(f);
                2.0 * a + 0.5 * b - 1.5 * c
            })
        }
        3 => any,
        4 => p + 1.3 * (middle - p),
        _ => p + 1e-9 * (any - p),
    }
}

const KINDS: usize = 6;

fn solids() -> Vec<(&'static str, Mesh)> {
    let ball = |triangles, dimples| {
        GolfBall { triangles, dimples, dimple_depth: 0.05, ..GolfBall::default() }.build().unwrap()
    };
    let cube = cranny_shapes::Cuboid::default().build().unwrap();
    vec![
        ("golf ball", ball(1_500, 12)),
        ("smooth ball", Sphere { radius: 1.0, segments: 20, rings: 10 }.build().unwrap()),
        ("cup", Cup::default().build().unwrap()),
        ("shells", NestedShells::default().build().unwrap()),
        (
            "torus",
            Torus { major_segments: 24, minor_segments: 12, ..Torus::default() }.build().unwrap(),
        ),
        ("gear", Gear::default().build().unwrap()),
        ("divided cube", split_edges(&split_edges(&cube))),
    ]
}

/// Deforms; a body turned inside out is refused.
fn tried(model: &mut Body, moves: &[(VertexId, DVec3)], what: &str) -> Option<Change> {
    let before = model.clone();
    match model.deform(moves) {
        Ok(change) => {
            assert_equals_rebuild(model, what);
            assert_tells_changes(&before, model, &change, what);
            Some(change)
        }
        Err(DeformError::InsideOut { .. }) => None,
        Err(error) => panic!("{what}: {error}"),
    }
}

#[test]
fn every_kind_of_move_on_the_hull_and_back_equals_a_rebuild() {
    let mut rng = Rng::new(41);
    for (name, mesh) in solids() {
        if mesh.faces().len() > 6_000 {
            continue;
        }
        for mesh in [turned(&mesh), mesh] {
            let mut model = model(mesh);
            for kind in 0..KINDS {
                let Some(v) = corner(&model, &mut rng) else { continue };
                let home = model.mesh().position(v);
                let there = place(&model, v, kind, &mut rng);
                let what = format!("{name}, kind {kind} of vertex {}", v.0);
                if tried(&mut model, &[(v, there)], &what).is_some() {
                    tried(&mut model, &[(v, home)], &format!("{what}, back"));
                }
            }
        }
    }
}

#[test]
fn moves_here_and_there_at_once_and_one_upon_the_other_equal_a_rebuild() {
    let mut rng = Rng::new(43);
    for (name, mesh) in solids() {
        if mesh.faces().len() > 3_000 {
            continue;
        }
        let mut model = model(turned(&mesh));
        let (mut anew, mut followed) = (0, 0);
        for step in 0..8 {
            let mut moves: Vec<(VertexId, DVec3)> = Vec::new();
            for _ in 0..1 + step % 5 {
                let Some(v) = corner(&model, &mut rng) else { continue };
                let kind = rng.below(KINDS);
                if moves.iter().all(|m| m.0 != v) {
                    moves.push((v, place(&model, v, kind, &mut rng)));
                }
            }
            match tried(&mut model, &moves, &format!("{name}, step {step}")) {
                Some(change) if change.work.is_anew => anew += 1,
                Some(_) => followed += 1,
                None => {}
            }
        }
        assert!(followed > anew, "{name}: {followed}, {anew}");
    }
}

/// One vertex of the hull, out and in again as far as the surface bends over an edge, on balls of
/// very different sizes.
#[test]
fn work_on_the_hull_does_not_grow_with_the_mesh() {
    let moved = |triangles: u32| -> [Change; 3] {
        // As many faces a dimple on each.
        let dimples = triangles / 50;
        let ball = GolfBall { triangles, dimples, ..GolfBall::default() }.build().unwrap();
        let mut model = model(turned(&ball));
        let bounds = model.bounds();
        let inner = |v: &VertexId| {
            let p = model.mesh().position(*v);
            (p - bounds.min).min(bounds.max - p).min_element() > 0.1 * bounds.diagonal()
        };
        let v = model.hull().sources().iter().copied().find(inner).unwrap();
        let home = model.mesh().position(v);
        let near = model.mesh().position(neighbours(&model, v)[0]);
        // As far as the ball bends over an edge: what such a vertex sees is as many edges on each.
        let share = |share: f64| home + share * (home - near).length_squared() * home.normalize();
        // The first one makes what the others keep.
        model.deform(&[(v, share(0.05))]).unwrap();
        [home, share(-0.5), share(0.5)].map(|to| {
            let change = model.deform(&[(v, to)]).unwrap();
            assert!(change.hull && !change.work.is_anew);
            change
        })
    };
    // Vertices lie nearer to a dimple or farther from it; the largest ball has hundreds of times as
    // many of each.
    for change in [1_000, 10_000, 100_000].into_iter().flat_map(moved) {
        let (work, beneath) = (change.work, change.beneath.work);
        assert!(beneath.faces > 0 && work.hull_triangles > 0, "{work:?}, {beneath:?}");
        assert!(beneath.faces <= 400 && beneath.facets <= 500, "{beneath:?}");
        assert!(work.hull_triangles <= 120 && beneath.grouped <= 1_000, "{work:?}, {beneath:?}");
    }
}

#[test]
fn facets_away_from_a_move_keep_their_numbers() {
    let mut model =
        model(turned(&Sphere { radius: 1.0, segments: 32, rings: 16 }.build().unwrap()));
    let mut rng = Rng::new(47);
    for share in [-0.05, 0.05, 0.6, -0.01] {
        let v = corner(&model, &mut rng).unwrap();
        let before = model.hull().clone();
        let to = (1.0 - share) * model.mesh().position(v);
        let change = deformed(&mut model, &[(v, to)], "sphere");
        let after = model.hull();
        let is_same = |f: &u32| {
            let [a, b] = [&before, after].map(|hull| {
                let facet = hull.facet(cranny_geometry::hull::FacetId(*f));
                let triangle = |t: &u32| hull.triangle(*t as usize).map(|v| hull.source(v));
                let triangles: Vec<_> = facet.triangles.iter().map(triangle).collect();
                (facet.normal, facet.offset, triangles)
            });
            a == b
        };
        let count = before.facet_count().min(after.facet_count()) as u32;
        let others = (0..count).filter(|f| !is_same(f)).count();
        assert!(
            others > 0 && others <= 2 * change.work.hull_triangles,
            "{others}, {:?}",
            change.work
        );
    }
}

#[test]
fn what_moves_as_a_whole_is_built_anew_and_followed_again_after() {
    let mut model = model(turned(&Torus::default().build().unwrap()));
    let stretched: Vec<(VertexId, DVec3)> = (0..)
        .map(VertexId)
        .zip(model.mesh().vertices())
        .map(|(v, p)| (v, *p * DVec3::new(1.0, 1.25, 0.875)))
        .collect();
    let change = deformed(&mut model, &stretched, "stretched");
    assert!(change.work.is_anew && change.hull);
    assert!(change.beneath.work.is_anew);
    assert_eq!(change.beneath.work.faces, model.mesh().faces().len());
    let v = corner(&model, &mut Rng::new(53)).unwrap();
    let to = 1.01 * model.mesh().position(v);
    let change = deformed(&mut model, &[(v, to)], "one of it");
    assert!(change.hull && !change.work.is_anew);
}
