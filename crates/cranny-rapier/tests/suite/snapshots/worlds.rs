//! Worlds of rapier with our dispatcher.

use cranny_shapes::{Cup, Torus};
use rapier3d::math::{Pose, Real, Rotation, Vector};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::{ColliderBuilder, RevoluteJointBuilder, RigidBodyBuilder};

use super::{goes_on_as_if_nothing_had_happened as goes_on, state};
use crate::world::{World, cuboid, model, ours, up};

#[test]
fn what_rests_and_what_lands_beside_it() {
    let models = [
        cuboid(6.0, 6.0, 1.0),
        cuboid(0.6, 0.8, 0.5),
        model(Cup { segments: 24, ..Cup::default() }),
        model(Torus { major_segments: 24, minor_segments: 8, ..Torus::default() }),
    ];
    let [slab, brick, cup, torus] = models.each_ref().map(ours);
    goes_on(
        || {
            let mut world = World::new();
            world.fixed(&slab, Pose::IDENTITY);
            for k in 0..3 {
                world.dynamic(
                    &brick,
                    Pose::translation(0.05 * k as Real, 0.0, 0.8 + 0.55 * k as Real),
                );
            }
            world.dynamic(&cup, Pose::translation(1.8, 0.0, 1.0));
            world.dynamic(&SharedShape::ball(0.15), Pose::translation(1.85, 0.05, 3.0));
            world.dynamic(&torus, Pose::translation(-1.6, 0.0, 1.5));
            // parry answers for these, and keeps something of its own.
            world.dynamic(&SharedShape::cylinder(0.2, 0.3), Pose::translation(0.0, 2.0, 1.0));
            world.dynamic(&SharedShape::capsule_x(0.3, 0.2), Pose::translation(0.0, -2.0, 1.0));
            (world, models.to_vec())
        },
        [40, 80],
        |_| (),
    );
}

#[test]
fn what_slides() {
    let models = [cuboid(20.0, 4.0, 1.0), cuboid(0.6, 0.8, 0.5)];
    let [slope, brick] = models.each_ref().map(ours);
    let [written, _] = goes_on(
        || {
            let mut world = World::new();
            let tilted = Rotation::from_rotation_y(0.35);
            world.fixed(&slope, Pose::from_parts(Vector::ZERO, tilted));
            let start = Pose::from_parts(tilted * Vector::new(-8.0, 0.0, 0.76), tilted);
            let body = RigidBodyBuilder::dynamic().pose(start);
            let collider = ColliderBuilder::new(brick.clone()).friction(0.1);
            world.0.insert(body, collider);
            (world, models.to_vec())
        },
        [30, 60],
        |_| (),
    );
    let (_, brick) = written.bodies.iter().nth(1).expect("two bodies");
    // Friction is the mean of 0.1 and 0.5, the slope 0.35: 9.81 · (sin − 0.3 cos) = 0.6 faster a
    // second, for 1.5 s.
    assert!(brick.linvel().length() > 0.5, "it slides: {}", brick.linvel());
}

#[test]
fn who_sleeps_goes_on_sleeping_until_something_falls_on_it() {
    let models = [cuboid(6.0, 6.0, 1.0), cuboid(0.6, 0.8, 0.5)];
    let [slab, brick] = models.each_ref().map(ours);
    let asleep = |world: &rapier3d::prelude::PhysicsWorld| {
        world.bodies.iter().filter(|(_, body)| body.is_sleeping()).count()
    };
    let [written, restored] = goes_on(
        || {
            let mut world = World::new();
            world.fixed(&slab, Pose::IDENTITY);
            world.dynamic(&brick, up(0.76));
            world.dynamic(&brick, Pose::translation(2.0, 0.0, 0.76));
            world.run(400);
            assert_eq!(asleep(&world.0), 2, "for the sake of the test");
            (world, models.to_vec())
        },
        [1, 80],
        |world| {
            assert_eq!(asleep(world), 2, "nothing woke them");
            world.insert(
                RigidBodyBuilder::dynamic().pose(up(1.6)),
                ColliderBuilder::new(ours(&models[1])),
            );
        },
    );
    assert_eq!((asleep(&written), asleep(&restored)), (1, 1), "the one beside goes on sleeping");
}

#[test]
fn compounds_that_hold_ours() {
    let models = [cuboid(6.0, 6.0, 1.0), cuboid(0.4, 0.4, 0.4)];
    let [slab, cube] = models.each_ref().map(ours);
    let at = |x: Real| Pose::translation(x, 0.0, 0.0);
    let bar = SharedShape::cuboid(0.5, 0.1, 0.1);
    let dumbbell = SharedShape::compound(vec![
        (at(-0.6), cube.clone()),
        (Pose::IDENTITY, bar),
        (at(0.6), cube.clone()),
    ]);
    goes_on(
        || {
            let mut world = World::new();
            world.fixed(&SharedShape::compound(vec![(Pose::IDENTITY, slab.clone())]), up(0.0));
            world.dynamic(&dumbbell, up(0.9));
            let across = Rotation::from_rotation_z(1.2);
            world.dynamic(&dumbbell, Pose::from_parts(Vector::new(0.1, 0.0, 1.5), across));
            world.dynamic(&cube, Pose::translation(0.7, 0.1, 1.4));
            (world, models.to_vec())
        },
        [30, 90],
        |_| (),
    );
}

#[test]
fn joints_and_what_was_said_to_bodies_before_the_next_step() {
    let models = [cuboid(6.0, 6.0, 1.0), cuboid(0.6, 0.2, 0.2)];
    let [slab, link] = models.each_ref().map(ours);
    let scene = || {
        let mut world = World::new();
        world.fixed(&slab, Pose::IDENTITY);
        let mut last = world.0.bodies.insert(RigidBodyBuilder::fixed().pose(up(2.2)));
        for k in 0..3 {
            let next = world.dynamic(&link, Pose::translation(0.35 + 0.7 * k as Real, 0.0, 2.2));
            let joint = RevoluteJointBuilder::new(Vector::Y)
                .local_anchor1(Vector::new(if k == 0 { 0.0 } else { 0.35 }, 0.0, 0.0))
                .local_anchor2(Vector::new(-0.35, 0.0, 0.0));
            world.0.impulse_joints.insert(last, next, joint, true);
            last = next;
        }
        world.run(20);
        // Not seen by any step when the world is written.
        world.0.bodies[last].set_linvel(Vector::new(0.0, 1.0, 0.0), true);
        world.0.bodies[last].add_force(Vector::new(0.0, 0.5, 0.0), true);
        (world, models.to_vec())
    };
    goes_on(scene, [0, 90], |_| ());
}

/// A body that is put elsewhere between the last step and the snapshot.
#[test]
fn what_was_moved_by_hand() {
    let models = [cuboid(6.0, 6.0, 1.0), cuboid(0.6, 0.8, 0.5)];
    let [slab, brick] = models.each_ref().map(ours);
    let scene = || {
        let mut world = World::new();
        world.fixed(&slab, Pose::IDENTITY);
        let body = world.dynamic(&brick, up(0.8));
        world.run(30);
        world.0.bodies[body].set_position(Pose::translation(1.0, 0.5, 1.2), true);
        (world, models.to_vec())
    };
    let [written, _] = goes_on(scene, [0, 60], |_| ());
    assert_ne!(state(&written), state(&scene().0.0));
}
