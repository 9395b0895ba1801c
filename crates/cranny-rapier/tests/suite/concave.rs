//! What convex parts, hollow meshes and internal edges get wrong.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_rapier::{MeshShape, dispatcher, pose_to_rapier, wide};
use cranny_shapes::{Cup, LPrism, Pyramid};
use rapier3d::geometry::ContactManifold;
use rapier3d::math::{Pose as RapierPose, Vector};
use rapier3d::parry::query::PersistentQueryDispatcher;
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::RigidBodyBuilder;

use crate::world::{World, cuboid, model, ours, tessellated_slab, up};

#[test]
fn a_ball_dropped_into_a_cup_stays_at_its_bottom() {
    let cup = Cup { radius: 1.0, height: 1.5, wall: 0.1, floor: 0.2, segments: 48 };
    let mut world = World::new();
    world.fixed(&ours(&model(cup)), RapierPose::IDENTITY);
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(0.2, 0.1, 2.5))
        .linvel(Vector::new(1.5, -0.7, 0.0));
    let ball = world.insert(body, &SharedShape::ball(0.3));
    for _ in 0..300 {
        world.run(1);
        let at = world.at(ball);
        if at.z < 1.5 {
            assert!(at.truncate().length() < 0.9 - 0.3 + 0.02, "in the wall: {at}");
        }
    }
    let at = world.at(ball);
    assert!((at.z - (0.2 + 0.3)).abs() < 1e-2, "{at}");
}

/// What rolls or slides over a plane of 3,200 triangles feels the plane and none of its edges.
#[test]
fn a_tessellated_plane_has_vertical_normals_only() {
    let slab = ours(&tessellated_slab(40, 3.0));
    for (name, shape, height) in [
        ("ball", SharedShape::ball(0.3), 0.3),
        ("capsule", SharedShape::capsule_x(0.3, 0.2), 0.2),
        ("cuboid", SharedShape::cuboid(0.3, 0.2, 0.1), 0.1),
        ("ours", ours(&cuboid(0.6, 0.4, 0.2)), 0.1),
    ] {
        let mut world = World::new();
        world.fixed(&slab, RapierPose::IDENTITY);
        let moving = RigidBodyBuilder::dynamic()
            .translation(Vector::new(-2.0, 0.13, height + 0.001))
            .linvel(Vector::new(3.0, 0.4, 0.0));
        let body = world.insert(moving, &shape);
        let mut contacts = 0;
        for step in 0..60 {
            world.run(1);
            let at = world.at(body);
            assert!((at.z - height).abs() < 5e-3, "{name} in step {step}: {at}");
            for manifold in world.manifolds() {
                let normal = manifold.local_n1; // the slab came first and is not turned
                contacts += manifold.points.len();
                assert!(normal.z > 1.0 - 1e-6, "{name} in step {step}: {normal}");
            }
        }
        assert!(contacts >= 60, "{name}: {contacts} contacts in all");
        // What slides is stopped by friction after v²/2µg = 0.92.
        assert!(world.at(body).x > -1.15, "{name} got stuck at {}", world.at(body));
    }
}

#[test]
fn a_ball_that_starts_inside_is_pushed_out() {
    for (name, shape, height) in
        [("ball", SharedShape::ball(0.3), 0.3), ("capsule", SharedShape::capsule_x(0.2, 0.3), 0.3)]
    {
        let mut world = World::new();
        world.fixed(&ours(&cuboid(4.0, 4.0, 1.0)), RapierPose::IDENTITY);
        let body = world.dynamic(&shape, up(0.5 - 0.02));
        world.run(240);
        assert!((world.at(body).z - (0.5 + height)).abs() < 1e-2, "{name}: {}", world.at(body));
    }
}

/// An L hooked over the edge of a slab: its upper arm carries it, its lower arm keeps it there.
#[test]
fn a_hook_holds_at_an_edge() {
    let slab = ours(&cuboid(4.0, 4.0, 1.0)); // its edge is at x = −2, its top at z = 0.5
    let hook = LPrism { width: 1.4, height: 1.0, thickness: 0.3, depth: 0.6 };
    let quarter = DQuat::from_xyzw(-0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt()); // y becomes −z
    // Areas of the arms are 0.42 and 0.21: the centroid is at (0.5166…, 0.3166…) from the corner.
    let centroid = (0.42 * 0.7 + 0.21 * 0.15) / 0.63;
    let drop = (0.42 * 0.15 + 0.21 * 0.65) / 0.63;
    let (gap, fall) = (0.02, 0.02);
    let rest = DVec3::new(-2.0 - gap - 0.3 + centroid, 0.0, 0.5 + 0.3 - drop);
    let pose = Pose { rotation: quarter, translation: rest + DVec3::Z * fall };
    for push in [0.0, 1.5] {
        let mut world = World::new();
        world.fixed(&slab, RapierPose::IDENTITY);
        let moving = RigidBodyBuilder::dynamic()
            .pose(pose_to_rapier(&pose))
            .linvel(Vector::new(push, 0.0, 0.0));
        let body = world.insert(moving, &ours(&model(hook)));
        world.run(180);
        let at = wide(world.at(body));
        assert!((at.z - rest.z).abs() < 1e-2, "pushed by {push}: {at}, expected {rest}");
        // Friction alone would let it slide by v²/2µg = 0.23.
        let moved = at.x - rest.x;
        assert!((-1e-2..gap + 1e-2).contains(&moved), "pushed by {push}: moved by {moved}");
        let turn = world.0.bodies[body].rotation().angle_between(pose_to_rapier(&pose).rotation);
        assert!(turn < 1e-2, "pushed by {push}: turned by {turn}");
    }
}

/// Contacts of a partner before a thin blade, whose far side is within reach too: no normal may
/// lead into the blade.
#[test]
fn the_far_side_of_a_blade_pushes_nothing() {
    let blade = Pyramid { base: 1.0, height: 4.0 };
    let blade = MeshShape::new(&model(blade), 0).expect("parry takes it");
    let thin = MeshShape::new(&cuboid(4.0, 4.0, 0.02), 0).expect("parry takes it");
    for (name, shape, size) in
        [("ball", SharedShape::ball(0.5), 0.5), ("capsule", SharedShape::capsule_x(0.4, 0.5), 0.5)]
    {
        // Before the blade's flank x > 0, near its tip; the flank's outward normal is (8, 0, 1).
        let flank = DVec3::new(8.0, 0.0, 1.0).normalize();
        let side = Pose::at(DVec3::new(0.06, 0.0, 2.6) + flank * (size - 0.05));
        let turned = Pose {
            rotation: DQuat::from_rotation_arc(DVec3::X, DVec3::Y),
            translation: side.translation,
        };
        let manifolds = contacts(&blade, &shape, &turned);
        assert!(!manifolds.is_empty(), "{name} misses the blade");
        for manifold in &manifolds {
            let along = wide(manifold.local_n1).dot(flank);
            assert!(along > 0.9, "{name} is pushed to {}", manifold.local_n1);
        }
        let above = Pose::at(DVec3::new(0.1, 0.0, 0.01 + size - 0.002));
        let manifolds = contacts(&thin, &shape, &above);
        assert!(!manifolds.is_empty(), "{name} misses the plate");
        for manifold in &manifolds {
            assert!(manifold.local_n1.z > 1.0 - 1e-6, "{name} is pushed to {}", manifold.local_n1);
            for point in &manifold.points {
                let on_top = (point.local_p1.z - 0.01).abs() < 1e-6;
                assert!(on_top, "{name} touches the back at {}", point.local_p1);
            }
        }
    }
}

/// A capsule whose axis runs inside an L, near its inner corner, is not pulled further in.
#[test]
fn the_inner_corner_of_an_l_pulls_nothing_in() {
    let l = MeshShape::new(&model(LPrism::default()), 0).expect("parry takes it");
    // The inner corner is the edge along z at (0.3, 0.3) less the centroid.
    let centroid = (0.3 * 0.5 + 0.21 * 0.15) / 0.51;
    let inner = DVec3::new(0.3 - centroid, 0.3 - centroid, 0.0);
    let diagonal = DVec3::new(1.0, 1.0, 0.0).normalize();
    // Crosses the edge's direction at a slant, 0.05 inside.
    let tilt = DQuat::from_rotation_arc(DVec3::X, DVec3::new(1.0, -1.0, 1.0).normalize());
    let pose = Pose { rotation: tilt, translation: inner - diagonal * 0.05 };
    for manifold in contacts(&l, &SharedShape::capsule_x(0.05, 0.1), &pose) {
        let along = wide(manifold.local_n1).dot(diagonal);
        assert!(along >= 0.0, "pulled to {}", manifold.local_n1);
    }
}

/// Between its ends, where neither of their balls reaches: on a spike and across a ridge.
#[test]
fn a_capsule_lies_on_a_spike_and_across_a_ridge() {
    let capsule = SharedShape::capsule_x(1.0, 0.1);
    let spike = MeshShape::new(&model(Pyramid::default()), 0).expect("parry takes it");
    let ridge = MeshShape::new(&cuboid(0.2, 2.0, 1.0), 0).expect("parry takes it");
    for (name, mesh, top, expected) in
        [("spike", &spike, 0.75, 1..=1), ("ridge", &ridge, 0.5, 2..=3)]
    {
        let found = contacts(mesh, &capsule, &Pose::at(DVec3::new(0.3, 0.0, top + 0.1 - 0.01)));
        let points: Vec<_> = found.iter().flat_map(|m| &m.points).collect();
        assert!(expected.contains(&points.len()), "{name}: {} contacts", points.len());
        for point in points {
            assert!((point.dist + 0.01).abs() < 1e-6, "{name}: {}", point.dist);
        }
        let upward = found.iter().all(|m| (m.local_n1 - Vector::Z).length() < 1e-6);
        assert!(upward, "{name} pushes sideways");
    }
}

fn contacts(mesh: &MeshShape, partner: &SharedShape, pose: &Pose) -> Vec<ContactManifold> {
    let mut manifolds = Vec::new();
    dispatcher()
        .contact_manifolds(&pose_to_rapier(pose), mesh, &*partner.0, 0.1, &mut manifolds, &mut None)
        .expect("a partner that is known");
    manifolds
}
