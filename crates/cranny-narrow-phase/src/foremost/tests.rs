use super::layer::MOST_VERTICES;
use super::*;
use crate::answer::Counters;
use crate::brute_force::brute_force;
use crate::closest::Closest;
use crate::memory::PairMemory;
use crate::query::{Demand, Placed, Query};
use crate::search::meeting_pairs;
use cranny_exact::{DQuat, Pose};
use cranny_geometry::hull::ConvexHull;
use cranny_geometry::{BuildOptions, Mesh, Model, Repair};
use cranny_shapes::{Comb, Cuboid, Cup, GolfBall, Shape, Torus};
use cranny_testkit::Rng;
use std::f64::consts::TAU;

fn bodies() -> Vec<Model> {
    let shapes: [Shape; 6] = [
        Cuboid { size: [1.0; 3] }.into(),
        Cup { segments: 10, ..Cup::default() }.into(),
        Comb { teeth: 4, ..Comb::default() }.into(),
        Torus { major_segments: 14, minor_segments: 6, ..Torus::default() }.into(),
        GolfBall { triangles: 320, dimples: 12, ..GolfBall::default() }.into(),
        GolfBall { triangles: 180, dimples: 0, ..GolfBall::default() }.into(),
    ];
    let mut meshes: Vec<Mesh> = shapes.map(|s| s.build().unwrap()).into();
    meshes.push(Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap());
    let options = BuildOptions::default();
    meshes.into_iter().map(|mesh| Model::build(mesh, &options).unwrap().0).collect()
}

/// The whole result: faces, features, and bits of lengths.
fn described(found: Option<Closest>) -> String {
    format!("{found:?}")
}

/// Along random directions, at all gaps; every other pose along the axes, where faces lie flush and
/// ties abound. One memory for all: what it says stems from other bodies, at other poses.
#[test]
fn finds_what_a_search_of_all_faces_finds() {
    let bodies = bodies();
    let mut rng = Rng::new(5);
    let mut foremost = Foremost::default();
    let (mut settled, mut left) = (0, 0);
    let mut last = None;
    for round in 0..1500 {
        let [a, b] = [&bodies[rng.below(7)], &bodies[rng.below(7)]];
        let aligned = round % 2 == 0;
        let mut vector = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let (turn, way) = match aligned {
            true => (DQuat::IDENTITY, DVec3::AXES[round / 2 % 3]),
            false => (DQuat::from_scaled_axis(3.0 * vector()), vector().normalize_or(DVec3::X)),
        };
        let far = [0.7, 0.9, 1.02, 1.1, 3.0][round % 5] * (a.radius() + b.radius());
        let pose = Pose { rotation: turn.normalize(), translation: far * way };
        let placed = [Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose }];
        let (settled_here, faces) = agrees(&mut foremost, placed, last);
        settled += settled_here;
        left += 2 - settled_here;
        last = faces.or(last);
    }
    assert!(settled > 1000 && left > 20, "{settled} {left}");
}

/// Measures every face against every face.
fn offer_all(pair: &Pair, nearest: &mut NearestFaces, counters: &mut Counters) {
    let faces = |side: Side| (0..pair.mesh(side).faces().len() as u32).map(FaceId);
    for f in faces(Side::First) {
        for g in faces(Side::Second) {
            nearest.offer(f, g, counters);
        }
    }
}

/// Searches for the nearest faces, without and with a way to begin with, knowing what was nearest
/// elsewhere. Returns how often they were found, as a search of all finds them; and which they are,
/// if surfaces do not meet.
fn agrees(
    foremost: &mut Foremost,
    [a, b]: [Placed; 2],
    last: Option<[FaceId; 2]>,
) -> (u32, Option<[FaceId; 2]>) {
    let pair = Pair::of_accepted(a, b);
    let mut counters = Counters::default();
    if !meeting_pairs(&pair, &mut counters).is_empty() {
        return (0, None);
    }
    let mut all = NearestFaces::less_than(&pair, f64::INFINITY);
    offer_all(&pair, &mut all, &mut counters);
    let mut settled = 0;
    for has_way in [false, true] {
        let mut nearest = NearestFaces::less_than(&pair, f64::INFINITY);
        let has = |side: Side, face: FaceId| face.index() < pair.mesh(side).faces().len();
        if let Some([f, g]) = last.filter(|l| has(Side::First, l[0]) && has(Side::Second, l[1])) {
            nearest.offer(f, g, &mut counters);
        }
        let way = if has_way { pair.first_from_second.translation } else { DVec3::ZERO };
        // What is tested is not how long it waits.
        foremost.backoff = Backoff::default();
        if foremost.offer(&pair, way.normalize_or_zero(), &mut nearest, &mut counters) {
            assert_eq!(described(nearest.found()), described(all.found()), "{:?}", b.pose);
            settled += 1;
        }
    }
    (settled, all.faces())
}

fn unmended(vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Option<Model> {
    let options = BuildOptions { repair: Repair::None, ..BuildOptions::default() };
    Some(Model::build(Mesh::new(vertices, faces).ok()?, &options).ok()?.0)
}

/// Some triangles over points of a lattice, each in a plane of it or slanted: needles and triangles
/// without area among them.
fn soup(rng: &mut Rng) -> Option<Model> {
    let count = 1 + rng.below(4) as u32;
    let mut vertices = Vec::new();
    for _ in 0..count {
        let (flat, level) = (rng.below(4), rng.below(7));
        for _ in 0..3 {
            let mut at = |axis| if axis == flat { level } else { rng.below(7) };
            let p = [at(0), at(1), at(2)].map(|k| 0.25 * k as f64);
            vertices.push(DVec3::from_array(p));
        }
    }
    unmended(vertices, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Ties of all kinds; whatever was measured before the trees are searched, the answer is theirs.
#[test]
fn ties_are_told_as_a_search_tells_them() {
    let mut rng = Rng::new(11);
    let (mut same, mut none) = (0, 0);
    for round in 0..6_000 {
        let (Some(a), Some(b)) = (soup(&mut rng), soup(&mut rng)) else { continue };
        let mut step = || 0.5 * rng.below(9) as f64 - 2.0;
        let pose = Pose::at(DVec3::new(step(), step(), step()));
        let [a, b] = [(&a, Pose::IDENTITY), (&b, pose)].map(|(model, pose)| Placed { model, pose });
        let pair = Pair::of_accepted(a, b);
        let mut counters = Counters::default();
        if !meeting_pairs(&pair, &mut counters).is_empty() {
            continue;
        }
        let below = [f64::INFINITY, 0.75, 2.0][round % 3];
        let mut all = NearestFaces::less_than(&pair, below);
        offer_all(&pair, &mut all, &mut counters);
        let mut nearest = NearestFaces::less_than(&pair, below);
        if round % 2 == 0 {
            nearest.offer(FaceId(0), FaceId(0), &mut counters);
        }
        let way = pair.first_from_second.translation.normalize_or_zero();
        if !Foremost::default().offer(&pair, way, &mut nearest, &mut counters) {
            offer_all(&pair, &mut nearest, &mut counters);
        }
        assert_eq!(described(nearest.found()), described(all.found()), "round {round}");
        same += u32::from(all.found().is_some());
        none += u32::from(all.found().is_none());
    }
    assert!(same > 2_000 && none > 300, "{same} {none}");
}

/// The normal of a face without area is noise, and may lie along the face.
#[test]
fn faces_that_are_lines_are_near() {
    let mut rng = Rng::new(13);
    let mut described = 0;
    for _ in 0..3_000 {
        let mut vector = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let (start, along) = (vector(), vector());
        let share = 0.3 + 0.6 * vector().x.abs();
        let line = unmended(vec![start, start + along, start + share * along], vec![[0, 1, 2]]);
        let corners = vec![vector(), vector(), vector(), vector()];
        let solid = unmended(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        let (Some(line), Some(solid)) = (line, solid) else { continue };
        let pose = Pose {
            rotation: DQuat::from_scaled_axis(3.0 * vector()).normalize(),
            translation: 3.0 * vector().normalize_or(DVec3::X),
        };
        let a = Placed { model: &line, pose: Pose::IDENTITY };
        let b = Placed { model: &solid, pose };
        let query = Query::of(Demand::Distance { below: None });
        let found = crate::query(a, b, &query, &mut PairMemory::default()).unwrap();
        assert_eq!(found.distance, Some(brute_force(a, b).unwrap().distance), "{pose:?}");
        described += 1;
    }
    assert!(described > 2_000, "{described}");
}

/// Here the first pass, which leaves corners out, finds the nearest faces and not the point on them
/// that is reported.
#[test]
fn what_a_thin_layer_leaves_out_does_not_show() {
    let torus = Torus { major_segments: 14, minor_segments: 6, ..Torus::default() };
    let shapes: [Shape; 2] = [torus.into(), Comb { teeth: 4, ..Comb::default() }.into()];
    let [torus, comb] =
        shapes.map(|s| Model::build(s.build().unwrap(), &BuildOptions::default()).unwrap().0);
    let turn = [-0.6734244524593356, 0.2163181212198827, 0.20337920902652656, 0.6770102470402414];
    let pose = Pose {
        rotation: DQuat::from_array(turn),
        translation: DVec3::new(0.5769018192288595, 0.7543956214707733, -2.6564991223455245),
    };
    let a = Placed { model: &torus, pose: Pose::IDENTITY };
    let b = Placed { model: &comb, pose };
    let query = Query::of(Demand::Distance { below: None });
    let mut memory = PairMemory::default();
    let [cold, warm] = [0, 1].map(|_| crate::query(a, b, &query, &mut memory).unwrap());
    assert_eq!(cold.witnesses, warm.witnesses);
}

/// A vertex with many neighbours is not looked at for long.
#[test]
fn layers_of_many_vertices_are_left_at_once() {
    let rim = |k: u32| {
        let (sin, cos) = (f64::from(k) * TAU / 2_000.0).sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    let mut points: Vec<DVec3> = (0..2_000).map(rim).collect();
    points.extend([0.01 * DVec3::Z, -DVec3::Z]);
    let hull = ConvexHull::of_points(&points);
    let top = hull.support(DVec3::Z, None).unwrap();
    let mut layer = Layer::default();
    assert!(!layer.fill(&hull, DVec3::Z, top, -0.5, 0.0));
    assert!(layer.vertices.len() <= MOST_VERTICES && layer.points.len() <= MOST_VERTICES);
    assert!(layer.fill(&hull, DVec3::Z, top, 0.005, 0.0));
    assert_eq!([layer.vertices.len(), layer.points.len()], [1, 2_001]);
}

/// Over a dish, whose lid is nearer than its floor: nothing of the floor is in a layer that is too
/// thin.
#[test]
fn looks_beneath_lids() {
    let dish = Cup { radius: 1.0, wall: 0.02, height: 0.3, floor: 0.1, segments: 8 };
    let [dish, cube] = [Shape::from(dish), Cuboid { size: [0.2; 3] }.into()]
        .map(|s: Shape| Model::build(s.build().unwrap(), &BuildOptions::default()).unwrap().0);
    let mut settled = 0;
    for round in 0..60 {
        let at = |k: i32| f64::from(k) * 0.137;
        let pose = Pose::at(DVec3::new(
            at(round % 7 - 3),
            at(round % 5 - 2),
            0.42 + 0.01 * f64::from(round),
        ));
        let placed = [Placed { model: &dish, pose: Pose::IDENTITY }, Placed { model: &cube, pose }];
        settled += u32::from(agrees(&mut Foremost::default(), placed, None).0 > 0);
    }
    assert!(settled > 40, "{settled}");
}

/// Between convex parts layers are thin: whatever the number of faces, few are looked at.
#[test]
fn work_does_not_grow_with_the_faces() {
    for triangles in [500, 2_000, 8_000] {
        let ball = GolfBall { triangles, dimples: 0, ..GolfBall::default() };
        let (model, _) = Model::build(ball.build().unwrap(), &BuildOptions::default()).unwrap();
        let mut foremost = Foremost::default();
        let mut last: Option<[FaceId; 2]> = None;
        for frame in 0..50 {
            let angle = 0.001 * f64::from(frame);
            let pose = Pose {
                rotation: DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle).normalize(),
                translation: 1.02 * DVec3::new(1.2, 1.28, 0.96),
            };
            let [a, b] = [Pose::IDENTITY, pose].map(|pose| Placed { model: &model, pose });
            let pair = Pair::of_accepted(a, b);
            let mut nearest = NearestFaces::less_than(&pair, f64::INFINITY);
            let mut counters = Counters::default();
            if let Some([f, g]) = last {
                nearest.offer(f, g, &mut counters);
            }
            let way = pose.translation.normalize();
            assert!(foremost.offer(&pair, way, &mut nearest, &mut counters));
            last = nearest.faces();
            if frame > 0 {
                let Counters { node_tests, triangle_tests, .. } = counters;
                assert!(node_tests < 400 && triangle_tests < 50, "{triangles} {counters:?}");
            }
        }
    }
}
