//! Rays: nothing slips through, the first is the first, what is inside sees backs.

use cranny_exact::DVec3;
use cranny_geometry::{FaceId, Model};
use cranny_primitives::{PrimitiveError, cast_ray, contains_point};
use cranny_shapes::{Cup, Torus};
use cranny_testkit::Rng;

use crate::{built, cuboid};

const FAR: f64 = f64::INFINITY;

fn torus() -> Model {
    built(Torus { major_radius: 1.0, minor_radius: 0.3, ..Torus::default() }.build().unwrap())
}

fn cup() -> Model {
    built(Cup::default().build().unwrap())
}

fn somewhere(random: &mut Rng, size: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| size * random.unit()))
}

/// Plain interval arithmetic of Möller and Trumbore: the least distance over all faces, away from
/// edges.
fn every_face(model: &Model, from: DVec3, along: DVec3) -> Option<f64> {
    let faces = (0..model.mesh().faces().len() as u32).map(FaceId);
    let distances = faces.filter_map(|face| {
        let [a, b, c] = model.mesh().triangle(face);
        let (ab, ac) = (b - a, c - a);
        let cross = along.cross(ac);
        let determinant = ab.dot(cross);
        let u = (from - a).dot(cross) / determinant;
        let second = (from - a).cross(ab);
        let v = along.dot(second) / determinant;
        let distance = ac.dot(second) / determinant;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0).then_some(distance)
    });
    distances.reduce(f64::min)
}

#[test]
fn the_first_face_is_that_of_all() {
    let mut random = Rng::new(11);
    for model in [torus(), cup()] {
        let mut hits = 0;
        for _ in 0..2_000 {
            let from = somewhere(&mut random, 2.0);
            let along = (somewhere(&mut random, 0.8) - from).normalize();
            let found = cast_ray(&model, from, along, FAR).unwrap().map(|hit| hit.distance);
            let expected = every_face(&model, from, along);
            hits += usize::from(expected.is_some());
            match (found, expected) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 1e-12, "{from} {along}: {a} {b}"),
                (a, b) => assert_eq!(a, b, "{from} {along}"),
            }
        }
        assert!(hits > 500, "{hits}");
    }
}

#[test]
fn no_ray_slips_between_faces() {
    // From a point in the material to every vertex, to the middle of every edge, and beyond.
    let mut random = Rng::new(12);
    for (model, convex) in [(torus(), false), (cuboid([1.0, 2.0, 3.0]), true)] {
        let inside: Vec<DVec3> = std::iter::repeat_with(|| somewhere(&mut random, 1.3))
            .filter(|&p| contains_point(&model, p))
            .take(5)
            .collect();
        for &from in &inside {
            for face in (0..model.mesh().faces().len() as u32).map(FaceId) {
                let [a, b, c] = model.mesh().triangle(face);
                for target in [a, 0.5 * (a + b), 0.5 * (b + c)] {
                    let hit = cast_ray(&model, from, target - from, FAR).unwrap();
                    let hit = hit.unwrap_or_else(|| panic!("{from} to {target} slips through"));
                    // What is not convex may be grazed.
                    let reach = (target - from).length() * (1.0 + 1e-12);
                    assert!(!convex || hit.distance <= reach, "{from} to {target}: {hit:?}");
                    let grazes = !convex && (hit.point - target).length() < 1e-12;
                    assert!(hit.from_behind || grazes, "{from} to {target}: {hit:?}");
                }
            }
        }
    }
}

#[test]
fn from_inside_one_sees_backs_and_from_outside_fronts() {
    let mut random = Rng::new(13);
    let model = torus();
    let mut seen = [0; 2];
    for _ in 0..2_000 {
        let from = somewhere(&mut random, 1.4);
        let along = somewhere(&mut random, 1.0);
        let Some(hit) = cast_ray(&model, from, along, FAR).unwrap() else {
            assert!(!contains_point(&model, from));
            continue;
        };
        assert_eq!(hit.from_behind, contains_point(&model, from), "{from} {along}");
        assert_eq!(hit.from_behind, hit.normal.dot(along) > 0.0, "{from} {along}");
        seen[usize::from(hit.from_behind)] += 1;
    }
    assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
}

#[test]
fn a_ray_ends_where_it_is_said_to() {
    let cube = cuboid([2.0; 3]);
    let from = DVec3::new(0.25, 0.5, 5.0);
    assert_eq!(cast_ray(&cube, from, DVec3::NEG_Z, 4.0).unwrap().unwrap().distance, 4.0);
    assert_eq!(cast_ray(&cube, from, DVec3::NEG_Z, 3.999).unwrap(), None);
    assert_eq!(cast_ray(&cube, from, DVec3::Z, FAR).unwrap(), None);
    // From the surface itself, out and in.
    let on_top = DVec3::new(0.25, 0.5, 1.0);
    for (along, from_behind) in [(DVec3::Z, true), (DVec3::NEG_Z, false)] {
        let hit = cast_ray(&cube, on_top, along, FAR).unwrap().unwrap();
        assert_eq!((hit.distance, hit.normal, hit.from_behind), (0.0, DVec3::Z, from_behind));
    }
    // Along the top it meets nothing but the sides.
    let beside = DVec3::new(-3.0, 0.1, 1.0);
    let hit = cast_ray(&cube, beside, DVec3::X, FAR).unwrap().unwrap();
    assert_eq!((hit.distance, hit.normal), (2.0, DVec3::NEG_X));
}

#[test]
fn numbers_that_are_none_are_refused() {
    let cube = cuboid([2.0; 3]);
    let nan = DVec3::new(0.0, f64::NAN, 0.0);
    let refused = |result| matches!(result, Err(PrimitiveError::Place { what: "origin", .. }));
    assert!(refused(cast_ray(&cube, nan, DVec3::X, 1.0)));
    for zero in [DVec3::ZERO, nan] {
        let refused = cast_ray(&cube, DVec3::ZERO, zero, 1.0).unwrap_err();
        assert!(refused.to_string().starts_with("direction is"), "{refused}");
    }
    for length in [-1.0, f64::NAN] {
        let refused = cast_ray(&cube, DVec3::ZERO, DVec3::X, length).unwrap_err();
        assert!(refused.to_string().starts_with("distance is"), "{refused}");
    }
}
