//! Smooth normals: near those of the surface that a mesh stands for, and the faces' own where it is
//! flat.

use std::f64::consts::PI;

use crate::meshes::{scaled, turned};
use cranny_exact::{DQuat, DVec3};
use cranny_geometry::{
    BuildOptions, Crease, EdgeId, FaceId, HalfEdgeId, Mesh, Model, Repair, SmoothNormals, VertexId,
    radians_between,
};
use cranny_shapes::{Cup, Cylinder, GolfBall, Shape, Sphere, Torus};
use cranny_testkit::{Rng, bodies::cuboid};

/// 30 degrees.
const CREASE: f64 = PI / 6.0;

fn model(mesh: Mesh) -> Model {
    let options = BuildOptions { repair: Repair::None, ..BuildOptions::default() };
    Model::build(mesh, &options).unwrap().0
}

fn shape(shape: impl Into<Shape>) -> Model {
    model(shape.into().build().unwrap())
}

fn smooth(model: &Model, crease_angle: f64) -> SmoothNormals {
    SmoothNormals::of(model, crease_angle).unwrap()
}

fn faces(model: &Model) -> impl Iterator<Item = FaceId> {
    (0..model.mesh().faces().len() as u32).map(FaceId)
}

fn edges(model: &Model) -> impl Iterator<Item = EdgeId> {
    (0..model.topology().edges().len() as u32).map(EdgeId)
}

fn vertices(model: &Model) -> impl Iterator<Item = VertexId> {
    (0..model.mesh().vertices().len() as u32).map(VertexId)
}

fn flat_normal(model: &Model, face: FaceId) -> DVec3 {
    model.mesh().area_vector(face).normalize()
}

/// A point of a triangle.
fn inside(triangle: [DVec3; 3], rng: &mut Rng) -> DVec3 {
    let [a, b, c] = [(); 3].map(|()| rng.unit().abs() + 1e-3);
    (a * triangle[0] + b * triangle[1] + c * triangle[2]) / (a + b + c)
}

/// The largest angles to the true normals, of smooth normals and of the faces', at points of all
/// faces.
fn worst(model: &Model, truth: impl Fn(DVec3) -> DVec3) -> [f64; 2] {
    let (normals, mut rng) = (smooth(model, CREASE), Rng::new(5));
    let mut worst = [0.0f64; 2];
    for face in faces(model) {
        for _ in 0..4 {
            let p = inside(model.mesh().triangle(face), &mut rng);
            let reported = normals.on_face(model, face, p).expect("faces have an area");
            assert!((reported.normal.length() - 1.0).abs() < 1e-15);
            let both = [reported.normal, flat_normal(model, face)];
            worst = std::array::from_fn(|i| worst[i].max(radians_between(both[i], truth(p))));
        }
    }
    worst
}

/// Facets of a ball are off by as much as they span: an edge of the 320 is about 0.3 of the radius
/// long, its triangle's corners lie 0.17 from its middle.
#[test]
fn normals_of_a_ball_are_radial() {
    let ball = shape(GolfBall { dimples: 0, triangles: 320, ..GolfBall::default() });
    let [reported, flat] = worst(&ball, DVec3::normalize);
    assert!(flat > 0.12 && reported < 0.1 * flat, "{reported} {flat}");
    let normals = smooth(&ball, CREASE);
    for vertex in vertices(&ball) {
        let reported = normals.at_vertex(&ball, vertex).expect("a ball is nowhere sharp");
        let radial = ball.mesh().position(vertex).normalize();
        assert!(radians_between(reported.normal, radial) < 0.1 * flat);
        // A sphere's normal turns by the inverse of its radius along a unit of length.
        let bend = reported.bend * ball.radius();
        assert!(bend > 0.5 && bend < 2.0, "{bend}");
    }
    // Of meridians and parallels: triangles of very different shapes, more of them about the poles.
    let [reported, flat] =
        worst(&shape(Sphere { radius: 2.0, segments: 48, rings: 24 }), DVec3::normalize);
    assert!(flat > 0.06 && reported < 0.1 * flat, "{reported} {flat}");
}

#[test]
fn normals_of_a_torus_are_those_of_its_tube() {
    let torus = shape(Torus { major_segments: 96, minor_segments: 32, ..Torus::default() });
    let [reported, flat] = worst(&torus, |p| {
        let ring = DVec3::new(p.x, p.y, 0.0).normalize();
        (p - ring).normalize()
    });
    assert!(flat > 0.09 && reported < 0.1 * flat, "{reported} {flat}");
}

/// The faces of a cube meet at 90 degrees, its halves of sides at 0.
#[test]
fn a_cube_stays_flat_to_the_bit() {
    let cube = model(cuboid([0.0; 3], [1.0; 3]));
    let mut rng = Rng::new(1);
    for crease in [0.0, 0.01, CREASE, 1.5] {
        let normals = smooth(&cube, crease);
        assert_eq!(normals.crease_angle(), crease);
        for face in faces(&cube) {
            let p = inside(cube.mesh().triangle(face), &mut rng);
            let reported = normals.on_face(&cube, face, p).unwrap();
            assert_eq!((reported.normal, reported.bend), (flat_normal(&cube, face), 0.0));
        }
        assert!(vertices(&cube).all(|v| normals.at_vertex(&cube, v).is_none()));
        let reported = edges(&cube).filter(|&e| normals.on_edge(&cube, e, 0.3).is_some()).count();
        assert_eq!(reported, if crease == 0.0 { 0 } else { 6 });
    }
}

/// The mean at a cube's corner is along its diagonal, however its sides are cut: three right
/// angles, not three to six faces.
#[test]
fn a_mean_does_not_depend_on_how_faces_are_cut() {
    let cube = model(cuboid([0.0; 3], [1.0; 3]));
    let normals = smooth(&cube, 1.6);
    for vertex in vertices(&cube) {
        let reported = normals.at_vertex(&cube, vertex).unwrap();
        let diagonal = (cube.mesh().position(vertex) - 0.5).normalize();
        assert!((reported.normal - diagonal).length() < 1e-15);
    }
}

/// The sides of a prism of six meet at 60 degrees; with its ends at 90.
#[test]
fn an_edge_is_smooth_below_the_crease_and_sharp_from_there_on() {
    let prism = shape(Cylinder { segments: 6, chamfer: 0.0, ..Cylinder::default() });
    let is_side = |f: FaceId| flat_normal(&prism, f).z.abs() < 0.5;
    let sides: Vec<FaceId> = faces(&prism).filter(|&f| is_side(f)).collect();
    assert_eq!(sides.len(), 12);
    let between_sides: Vec<EdgeId> = edges(&prism)
        .filter(|&e| {
            let [f, g] = prism.topology().half_edges(e) else { panic!("closed") };
            let [f, g] = [f, g].map(|h| h.face());
            let apart = radians_between(flat_normal(&prism, f), flat_normal(&prism, g));
            is_side(f) && is_side(g) && apart > 0.1
        })
        .collect();
    assert_eq!(between_sides.len(), 6);
    for crease in [1.04, 1.05] {
        let normals = smooth(&prism, crease);
        for &edge in &between_sides {
            let reported = normals.on_edge(&prism, edge, 0.5);
            assert_eq!(reported.is_some(), crease > PI / 3.0);
            if let Some(reported) = reported {
                let ends = prism.topology().edges()[edge.index()];
                let at = prism.mesh().position(ends.from);
                let radial = DVec3::new(at.x, at.y, 0.0).normalize();
                assert!((reported.normal - radial).length() < 1e-14, "{reported:?}");
            }
        }
        // Past the ends' rims nothing is smooth but their middles.
        for vertex in vertices(&prism) {
            let is_middle = prism.mesh().position(vertex).truncate().length() == 0.0;
            assert_eq!(normals.at_vertex(&prism, vertex).is_some(), is_middle);
        }
    }
    // Strictly: an edge at the crease is not flatter than it.
    let edge = between_sides[0];
    let [f, g] = prism.topology().half_edges(edge) else { panic!("closed") };
    let [f, g] = [f, g].map(|h| flat_normal(&prism, h.face()));
    let angle = radians_between(f, g);
    assert!(smooth(&prism, angle).on_edge(&prism, edge, 0.5).is_none());
    assert!(smooth(&prism, angle + 1e-12).on_edge(&prism, edge, 0.5).is_some());
    // In the middle of a side the normal is the side's, at its edges it leans by half the angle.
    let normals = smooth(&prism, 1.05);
    for &face in &sides {
        let corners = prism.mesh().triangle(face);
        let flat = flat_normal(&prism, face);
        for (c, corner) in corners.into_iter().enumerate() {
            let reported = normals.at_corner(face, c).unwrap();
            let there = normals.on_face(&prism, face, corner).unwrap();
            assert!((reported.normal - there.normal).length() < 1e-14);
            assert!((radians_between(reported.normal, flat) - PI / 6.0).abs() < 1e-14);
        }
        let upright = |i: usize| (corners[i] - corners[(i + 1) % 3]).truncate().length() < 1e-9;
        let i = (0..3).find(|&i| upright(i)).unwrap();
        let middle = 0.25 * (corners[i] + corners[(i + 1) % 3]) + 0.5 * corners[(i + 2) % 3];
        let reported = normals.on_face(&prism, face, middle).unwrap();
        assert!((reported.normal - flat).length() < 1e-14);
    }
}

/// A ball one of whose edges is a needle: two faces on one side of it, and a face without area
/// between.
#[test]
fn a_face_without_area_parts_nothing() {
    let ball = GolfBall { dimples: 0, triangles: 80, ..GolfBall::default() }.build().unwrap();
    // On a lattice, so that the middle of an edge lies on it.
    let lattice = ball.vertices().iter().map(|&p| (p * 1e9).round() / f64::from(1 << 30));
    let ball = Mesh::new(lattice.collect(), ball.faces().to_vec()).unwrap();
    let whole = model(ball.clone());
    let ([u, v, w], middle) = (ball.faces()[0], ball.vertices().len() as u32);
    let mut points = ball.vertices().to_vec();
    let [p, q] = [u, v].map(|i| points[i as usize]);
    points.push(0.5 * (p + q));
    let mut cut = ball.faces().to_vec();
    cut[0] = [u, middle, w];
    cut.extend([[middle, v, w], [u, v, middle]]);
    let needle = FaceId(cut.len() as u32 - 1);
    let split = model(Mesh::new(points, cut).unwrap());
    assert!(split.is_closed());
    assert_eq!(split.mesh().faces().len(), whole.mesh().faces().len() + 2);
    let crease = 0.8; // faces of this ball meet at up to 0.6
    let (before, after) = (smooth(&whole, crease), smooth(&split, crease));
    let at = |model: &Model, p: DVec3| {
        let found = model.mesh().vertices().iter().position(|&q| q == p).unwrap();
        VertexId(found as u32)
    };
    for &p in whole.mesh().vertices() {
        let [reported, truth] = [(&after, &split), (&before, &whole)]
            .map(|(normals, model)| normals.at_vertex(model, at(model, p)).unwrap().normal);
        assert!((reported - truth).length() < 1e-14, "{p}: {reported} {truth}");
    }
    let reported = after.at_vertex(&split, at(&split, 0.5 * (p + q))).unwrap().normal;
    // The middle belongs to that one face alone, and the needle says nothing.
    assert!((reported - flat_normal(&whole, FaceId(0))).length() < 1e-14);
    assert!(after.on_face(&split, needle, 0.5 * (p + q)).is_none());
    // Where it would be sharp without the needle, it is sharp with it.
    let sharp = smooth(&split, 0.01);
    assert!(
        split.topology().half_edges(split.topology().edge_of(HalfEdgeId::of(needle, 0))).len() == 2
    );
    for corner in 0..3 {
        let edge = split.topology().edge_of(HalfEdgeId::of(needle, corner));
        assert!(sharp.on_edge(&split, edge, 0.5).is_none());
        assert!(after.on_edge(&split, edge, 0.5).is_some());
    }
}

/// A sheet ends at its rim: there it has no normal but on its faces.
#[test]
fn a_rim_is_sharp() {
    let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]];
    let points = points.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
    let sheet = model(Mesh::new(points, vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]).unwrap());
    let normals = smooth(&sheet, CREASE);
    assert!(vertices(&sheet).all(|v| normals.at_vertex(&sheet, v).is_none()));
    let inner = edges(&sheet).filter(|&e| normals.on_edge(&sheet, e, 0.5).is_some()).count();
    assert_eq!(inner, 3);
    assert_eq!(normals.on_face(&sheet, FaceId(1), DVec3::ZERO).unwrap().normal, DVec3::Z);
}

#[test]
fn normals_turn_with_the_body_and_know_no_size() {
    let turn = |p: DVec3| DQuat::from_xyzw(0.3, -0.5, 0.2, 0.79).normalize() * p;
    let mut rng = Rng::new(3);
    let (mut counted, mut bent) = ([0; 2], 0);
    for mesh in [
        GolfBall { dimples: 12, triangles: 1280, ..GolfBall::default() }.build().unwrap(),
        Cup { segments: 24, ..Cup::default() }.build().unwrap(),
    ] {
        let plain = model(mesh.clone());
        let (large, leaning) = (model(scaled(&mesh, 64.0)), model(turned(&mesh)));
        let normals = [&plain, &large, &leaning].map(|model| smooth(model, CREASE));
        for face in faces(&plain) {
            let p = inside(plain.mesh().triangle(face), &mut rng);
            let [own, its, third] = [
                normals[0].on_face(&plain, face, p),
                normals[1].on_face(&large, face, 64.0 * p),
                normals[2].on_face(&leaning, face, turn(p)),
            ]
            .map(Option::unwrap);
            assert_eq!((own.normal, own.bend), (its.normal, 64.0 * its.bend));
            assert!((turn(own.normal) - third.normal).length() < 1e-12);
            assert!((own.bend - third.bend).abs() < 1e-9 * (1.0 + own.bend));
            bent += u32::from(own.bend > 0.0);
        }
        for vertex in vertices(&plain) {
            let reported = [(0, &plain), (1, &large), (2, &leaning)]
                .map(|(i, model)| normals[i].at_vertex(model, vertex).is_some());
            assert!(reported[0] == reported[1] && reported[0] == reported[2], "{vertex:?}");
            counted[usize::from(reported[0])] += 1;
        }
    }
    assert!(bent > 1000 && counted.iter().all(|&n| n > 50), "{bent} {counted:?}");
}

/// The rims of a cup are circles, at every vertex and between; a cube's edges end at its corners.
#[test]
fn a_sharp_curve_that_runs_on_has_a_tangent() {
    let cup = shape(Cup { segments: 24, ..Cup::default() });
    let normals = smooth(&cup, CREASE);
    let mut count = 0;
    for vertex in vertices(&cup) {
        let p = cup.mesh().position(vertex);
        let radius = p.truncate().length();
        if radius == 0.0 {
            continue; // the middles of its floor
        }
        let Crease { tangent, bend } = normals.crease_at_vertex(vertex).expect("on a rim");
        let around = DVec3::new(-p.y, p.x, 0.0) / radius;
        assert!((tangent.dot(around).abs() - 1.0).abs() < 1e-14);
        assert!((bend * radius - 1.0).abs() < 0.01, "{bend}");
        count += 1;
    }
    assert_eq!(count, 4 * 24);
    let rims = edges(&cup).filter(|&e| normals.crease_on_edge(&cup, e, 0.5).is_some()).count();
    assert_eq!(rims, 4 * 24);
    for edge in edges(&cup) {
        if let Some(reported) = normals.crease_on_edge(&cup, edge, 0.25) {
            let ends = cup.topology().edges()[edge.index()];
            let [p, q] = [ends.from, ends.to].map(|v| cup.mesh().position(v));
            let middle = 0.75 * p + 0.25 * q;
            let around = DVec3::new(-middle.y, middle.x, 0.0).normalize();
            assert!(reported.tangent.cross(around).length() < 1e-3);
        }
    }
    let cube = model(cuboid([0.0; 3], [1.0; 3]));
    let normals = smooth(&cube, CREASE);
    assert!(vertices(&cube).all(|v| normals.crease_at_vertex(v).is_none()));
    assert!(edges(&cube).all(|e| normals.crease_on_edge(&cube, e, 0.5).is_none()));
}

#[test]
fn an_angle_that_is_none_is_refused() {
    let cube = model(cuboid([0.0; 3], [1.0; 3]));
    for crease in [-1e-9, 3.15, f64::NAN, f64::INFINITY] {
        let refused = SmoothNormals::of(&cube, crease).unwrap_err();
        assert!(refused.to_string().contains(&crease.to_string()));
    }
    assert!(SmoothNormals::of(&cube, PI).is_ok());
}
