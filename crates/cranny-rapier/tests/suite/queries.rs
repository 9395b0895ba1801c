//! Single questions to the dispatcher, and sensors.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_rapier::{MeshShape, dispatcher, narrow, pose_from_rapier, pose_to_rapier};
use cranny_shapes::{Cup, LPrism, Torus};
use rapier3d::math::{Pose as RapierPose, Real, Vector};
use rapier3d::parry::query::{ClosestPoints, DefaultQueryDispatcher, QueryDispatcher};
use rapier3d::parry::shape::{Cuboid, Shape, SharedShape, TypedShape};
use rapier3d::prelude::{ColliderBuilder, RigidBodyBuilder};

use crate::manifolds::Random;
use crate::world::{World, built, cuboid, model, ours, up};

fn shape(model: &cranny_geometry::Model) -> MeshShape {
    MeshShape::new(model, 0).expect("parry takes it")
}

#[test]
fn they_agree_with_the_exact_query() {
    let bodies = [
        model(Torus { major_segments: 32, minor_segments: 8, ..Torus::default() }),
        model(Cup { segments: 24, ..Cup::default() }),
        model(LPrism::default()),
    ];
    let shapes = bodies.each_ref().map(shape);
    let mut random = Random(3);
    let (mut meeting, mut apart) = (0, 0);
    for k in 0..90 {
        let (i, j) = (k % 3, (k / 3) % 3);
        let pose = pose_to_rapier(&random.pose(1.5));
        let demand = Query::of(Demand::Distance { below: None });
        let a = Placed { model: &bodies[i], pose: Pose::IDENTITY };
        let b = Placed { model: &bodies[j], pose: pose_from_rapier(&pose) };
        let answer = query(a, b, &demand, &mut PairMemory::default()).expect("valid poses");
        let meets = answer.solid || answer.surface.meets();
        let distance = answer.distance.expect("demanded");
        let (g1, g2) = (&shapes[i], &shapes[j]);
        let ours = dispatcher();

        let intersecting = ours.intersection_test(&pose, g1, g2).expect("ours").intersecting;
        assert_eq!(intersecting, meets);
        let reported = ours.distance(&pose, g1, g2).expect("ours").distance;
        assert_eq!(reported, if meets { 0.0 } else { distance as Real });
        let reach: Real = 0.3;
        match ours.closest_points(&pose, g1, g2, reach).expect("ours") {
            ClosestPoints::Intersecting => assert!(meets),
            ClosestPoints::Disjoint => assert!(!meets && distance > f64::from(reach)),
            ClosestPoints::WithinMargin(p, q) => {
                assert!(!meets && distance <= f64::from(reach));
                let way = (pose.transform_point(q) - p).length();
                assert!((way - distance as Real).abs() < 1e-5, "{way} is not {distance}");
            }
        }
        match ours.contact(&pose, g1, g2, reach).expect("ours") {
            None => assert!(!meets && distance > f64::from(reach), "no contact at {distance}"),
            Some(c) if meets => assert!(c.dist <= 1e-6, "{} though they meet", c.dist),
            Some(c) => {
                let way = pose.transform_point(c.point2) - c.point1;
                assert!((way.dot(c.normal1) - c.dist).abs() < 1e-5);
                assert!((c.normal1 + pose.rotation * c.normal2).length() < 1e-5);
                assert!((c.dist - distance as Real).abs() < 1e-5, "{} not {distance}", c.dist);
            }
        }
        if meets { meeting += 1 } else { apart += 1 }
    }
    assert!(meeting > 20 && apart > 20, "{meeting} {apart}");
}

/// Boxes against parry's own boxes, which it knows by formula.
#[test]
fn boxes_agree_with_parrys_boxes() {
    let (mesh, other) = (shape(&cuboid(1.0, 2.0, 0.5)), shape(&cuboid(0.6, 0.6, 0.6)));
    let parry = [Vector::new(0.5, 1.0, 0.25), Vector::splat(0.3)].map(Cuboid::new);
    let mut random = Random(4);
    for _ in 0..60 {
        let pose = pose_to_rapier(&random.pose(1.5));
        let partners: [(&dyn Shape, &dyn Shape); 3] =
            [(&mesh, &other), (&mesh, &parry[1]), (&parry[0], &other)];
        let truth = DefaultQueryDispatcher.distance(&pose, &parry[0], &parry[1]);
        let truth = truth.expect("boxes").distance;
        for (g1, g2) in partners {
            let reported = dispatcher().distance(&pose, g1, g2).expect("ours").distance;
            assert!((reported - truth).abs() < 1e-4, "{reported} is not {truth}");
            let meets = dispatcher().intersection_test(&pose, g1, g2).expect("ours").intersecting;
            assert_eq!(meets, truth == 0.0, "distance {truth}");
        }
    }
}

fn round_partners() -> Vec<(&'static str, SharedShape)> {
    let ends = [Vector::new(-0.3, 0.1, 0.0), Vector::new(0.5, 0.0, 0.2)];
    vec![
        ("ball", SharedShape::ball(0.4)),
        ("capsule", SharedShape::capsule_x(0.4, 0.1)),
        ("segment", SharedShape::segment(ends[0], ends[1])),
        ("cylinder", SharedShape::cylinder(0.4, 0.3)),
        ("flat cylinder", SharedShape::cylinder(0.05, 0.6)),
        ("cone", SharedShape::cone(0.5, 0.3)),
        ("round cylinder", SharedShape::round_cylinder(0.3, 0.3, 0.1)),
        ("round cone", SharedShape::round_cone(0.4, 0.3, 0.1)),
        ("round cuboid", SharedShape::round_cuboid(0.3, 0.2, 0.4, 0.1)),
    ]
}

/// How far a point is from a shape's surface. parry searches what has a border, and ends early.
fn off_surface(shape: &dyn Shape, p: Vector) -> Real {
    let (core, border): (&dyn Shape, Real) = match shape.as_typed_shape() {
        TypedShape::RoundCylinder(g) => (&g.inner_shape, g.border_radius),
        TypedShape::RoundCone(g) => (&g.inner_shape, g.border_radius),
        TypedShape::RoundCuboid(g) => (&g.inner_shape, g.border_radius),
        _ => (shape, 0.0),
    };
    (core.distance_to_local_point(p, false) - border).abs()
}

/// What is round against a box as mesh, held against parry's own box, in both orders.
#[test]
fn round_partners_agree_with_parrys_box() {
    let mesh = shape(&cuboid(1.0, 2.0, 0.5));
    let parry = Cuboid::new(Vector::new(0.5, 1.0, 0.25));
    let mut random = Random(14);
    let (mut apart, mut meeting) = (0, 0);
    for (name, partner) in &round_partners() {
        for _ in 0..60 {
            let pose = pose_to_rapier(&random.pose(1.3));
            let truth = DefaultQueryDispatcher.distance(&pose, &parry, &*partner.0);
            let truth = truth.expect("convex").distance;
            for swap in [false, true] {
                let (pose, g1, g2): (_, &dyn Shape, &dyn Shape) = match swap {
                    false => (pose, &mesh, &*partner.0),
                    true => (pose.inverse(), &*partner.0, &mesh),
                };
                let ours = dispatcher();
                let what = format!("{name}, swapped {swap}");
                let reported = ours.distance(&pose, g1, g2).expect("ours").distance;
                // parry's search ends early on what is flat; points on both surfaces prove that
                // ours are not too small.
                let near = truth - 5e-3..truth + 1e-4;
                assert!(near.contains(&reported), "{what}: {reported} is not {truth}");
                let meets = ours.intersection_test(&pose, g1, g2).expect("ours").intersecting;
                assert_eq!(meets, reported == 0.0, "{what}: distance {reported}");
                let reach = 0.3;
                match ours.closest_points(&pose, g1, g2, reach).expect("ours") {
                    ClosestPoints::Intersecting => assert_eq!(reported, 0.0, "{what}"),
                    ClosestPoints::Disjoint => assert!(reported > reach, "{what}: {reported}"),
                    ClosestPoints::WithinMargin(p, q) => {
                        assert!(reported > 0.0 && reported <= reach, "{what}: {reported}");
                        let way = (pose.transform_point(q) - p).length();
                        assert!((way - reported).abs() < 1e-5, "{what}: {way} is not {reported}");
                        for (g, p) in [(g1, p), (g2, q)] {
                            let off = off_surface(g, p);
                            assert!(off < 1e-4, "{what}: {p} is {off} off the surface");
                        }
                    }
                }
                if reported > 0.0 { apart += 1 } else { meeting += 1 }
            }
        }
    }
    assert!(apart > 200 && meeting > 100, "{apart} {meeting}");
}

#[test]
fn wholly_inside_a_solid_is_intersecting() {
    let block = shape(&cuboid(4.0, 4.0, 4.0));
    let partners = [
        ("ours", ours(&cuboid(0.5, 0.5, 0.5))),
        ("cuboid", SharedShape::cuboid(0.2, 0.2, 0.2)),
        ("ball", SharedShape::ball(0.2)),
        ("capsule", SharedShape::capsule_x(0.2, 0.1)),
        ("cylinder", SharedShape::cylinder(0.2, 0.1)),
        ("cone", SharedShape::cone(0.2, 0.1)),
        ("segment", SharedShape::segment(Vector::new(-0.2, 0.0, 0.0), Vector::new(0.1, 0.1, 0.0))),
        ("round cylinder", SharedShape::round_cylinder(0.2, 0.1, 0.05)),
        ("round cone", SharedShape::round_cone(0.2, 0.1, 0.05)),
        ("round cuboid", SharedShape::round_cuboid(0.2, 0.1, 0.1, 0.05)),
    ];
    let pose = RapierPose::translation(0.3, -0.2, 0.5);
    for (name, partner) in &partners {
        for swap in [false, true] {
            let (g1, g2): (&dyn Shape, &dyn Shape) =
                if swap { (&*partner.0, &block) } else { (&block, &*partner.0) };
            let pose = if swap { pose.inverse() } else { pose };
            let ours = dispatcher();
            let meets = ours.intersection_test(&pose, g1, g2).expect("known").intersecting;
            assert!(meets, "{name}, swapped {swap}");
            let distance = ours.distance(&pose, g1, g2).expect("known").distance;
            assert_eq!(distance, 0.0, "{name}, swapped {swap}");
            let closest = ours.closest_points(&pose, g1, g2, 1.0).expect("known");
            assert_eq!(closest, ClosestPoints::Intersecting, "{name}, swapped {swap}");
        }
    }
}

/// In a void and in a well there is nothing to intersect with.
#[test]
fn in_a_hollow_is_apart() {
    let hollow = cuboid(4.0, 4.0, 4.0).mesh().clone();
    let void = cuboid(2.0, 2.0, 2.0).mesh().clone();
    let flipped = void.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    let void = Mesh::new(void.vertices().to_vec(), flipped).expect("in range");
    let hollow = shape(&built(hollow.joined(&void)));
    let cup = shape(&model(Cup { radius: 1.0, height: 2.0, ..Cup::default() }));
    for (name, partner, half) in [
        ("ours", ours(&cuboid(0.5, 0.5, 0.5)), 0.25),
        ("cuboid", SharedShape::cuboid(0.25, 0.25, 0.25), 0.25),
        ("ball", SharedShape::ball(0.25), 0.25),
        ("capsule", SharedShape::capsule_z(0.05, 0.2), 0.25),
        ("cylinder", SharedShape::cylinder(0.2, 0.25), 0.25),
        ("cone", SharedShape::cone(0.1, 0.25), 0.25),
        ("round cylinder", SharedShape::round_cylinder(0.15, 0.2, 0.05), 0.25),
        ("round cuboid", SharedShape::round_cuboid(0.2, 0.2, 0.2, 0.05), 0.25),
    ] {
        for (body, place, distance) in [(&hollow, up(0.0), 1.0 - half), (&cup, up(0.5), 0.4 - half)]
        {
            let ours = dispatcher();
            let meets = ours.intersection_test(&place, body, &*partner.0).expect("known");
            assert!(!meets.intersecting, "{name}");
            let reported = ours.distance(&place, body, &*partner.0).expect("known").distance;
            assert!((reported - distance).abs() < 1e-5, "{name}: {reported} is not {distance}");
        }
    }
}

/// A ball's single contact is the one that a solver would get, also where its centre is inside.
#[test]
fn a_ball_has_a_single_contact() {
    let block = shape(&cuboid(2.0, 2.0, 2.0));
    let ball = SharedShape::ball(0.5);
    for (z, distance) in [(1.6, 0.1), (1.4, -0.1), (0.9, -0.6)] {
        let contact = dispatcher().contact(&up(z), &block, &*ball.0, 0.2).expect("known");
        let contact = contact.unwrap_or_else(|| panic!("none at z = {z}"));
        assert!((contact.dist - distance).abs() < 1e-6, "{} at z = {z}", contact.dist);
        assert!((contact.normal1 - Vector::Z).length() < 1e-6, "{} at z = {z}", contact.normal1);
        let back = dispatcher().contact(&up(-z), &*ball.0, &block, 0.2).expect("known");
        assert!((back.expect("the same").normal1 + Vector::Z).length() < 1e-6);
    }
    assert!(dispatcher().contact(&up(1.8), &block, &*ball.0, 0.2).expect("known").is_none());
}

#[test]
fn sensors_feel_solids_not_shells() {
    let block = ours(&cuboid(4.0, 4.0, 4.0));
    for (name, probe) in [
        ("ours", ours(&cuboid(0.5, 0.5, 0.5))),
        ("ball", SharedShape::ball(0.2)),
        ("cuboid", SharedShape::cuboid(0.2, 0.2, 0.2)),
    ] {
        let mut world = World::new();
        let sensor = ColliderBuilder::new(block.clone()).sensor(true);
        let (_, sensor) = world.0.insert(RigidBodyBuilder::fixed(), sensor);
        let body = world.dynamic(&probe, up(2.8));
        let collider = world.0.bodies[body].colliders()[0];
        let mut felt = Vec::new();
        for _ in 0..90 {
            world.run(1);
            let inside = world.0.narrow_phase.intersection_pair(sensor, collider) == Some(true);
            felt.push((world.at(body).z, inside));
        }
        // The answer is of the step's beginning; in a step the probe falls 0.2 at most.
        let wrong = felt
            .iter()
            .find(|(z, inside)| (z.abs() < 1.5 && !inside) || (z.abs() > 2.6 && *inside));
        assert_eq!(wrong, None, "{name}");
        assert!(felt.iter().any(|f| f.1) && felt.iter().any(|f| !f.1), "{name}");
    }
}

#[test]
fn poses_that_are_none_are_refused_without_a_panic() {
    let (mesh, ball) = (shape(&cuboid(1.0, 1.0, 1.0)), SharedShape::ball(0.5));
    let broken = RapierPose::translation(Real::NAN, 0.0, 0.0);
    assert!(dispatcher().distance(&broken, &mesh, &mesh).is_err());
    for (name, partner) in &round_partners() {
        assert!(dispatcher().distance(&broken, &mesh, &*partner.0).is_err(), "{name}");
        assert!(dispatcher().distance(&broken, &*partner.0, &mesh).is_err(), "{name}");
    }
    let mut found = Vec::new();
    for partner in [&mesh as &dyn Shape, &*ball.0] {
        use rapier3d::parry::query::PersistentQueryDispatcher;
        let answered =
            dispatcher().contact_manifolds(&broken, &mesh, partner, 0.1, &mut found, &mut None);
        assert!(answered.is_ok());
        assert!(found.is_empty(), "contacts at no pose");
    }
}

#[test]
fn conversions_keep_what_rapier_can_hold() {
    let rotation = DQuat::from_xyzw(0.1, -0.7, 0.3, 0.64).normalize();
    let pose = Pose { rotation, translation: DVec3::new(1.5, -2.25, 1e3) };
    let there = pose_to_rapier(&pose);
    let back = pose_from_rapier(&there);
    assert_eq!(back.translation, pose.translation);
    assert!(back.rotation.dot(rotation).abs() > 1.0 - 1e-12);
    assert!((back.rotation.length() - 1.0).abs() < 1e-15, "normalised in f64");
    assert_eq!(narrow(DVec3::X), Vector::X);
}

/// Unit cubes side by side, overlapping by more and more: a question is answered with the depth
/// that there is, also where the solver gets less so as to be led out slowly.
#[test]
fn a_deep_contact_is_told_as_deep_as_it_is() {
    let cube = shape(&cuboid(1.0, 1.0, 1.0));
    for [z, depth] in
        [[0.95, 0.05], [0.9, 0.1], [0.8, 0.2], [0.7, 0.3], [0.6, 0.4]] as [[Real; 2]; 5]
    {
        let pose = RapierPose::translation(0.1, 0.0, z);
        let reported = dispatcher().contact(&pose, &cube, &cube, 0.1).expect("ours").expect("deep");
        // Along the direction of the area that the curves enclose, which leans a little.
        assert!(
            (-reported.dist / depth - 1.0).abs() < 0.1,
            "{} where it is {depth}",
            reported.dist
        );
        for (point, name) in [(reported.point1, "first"), (reported.point2, "second")] {
            let out = point.abs().max_element();
            assert!((out - 0.5).abs() < 1e-5, "{point} is not on the {name} cube");
        }
    }
}
