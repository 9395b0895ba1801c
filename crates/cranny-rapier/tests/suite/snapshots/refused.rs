//! Snapshots that were damaged, and models that are not those saved.

use cranny_geometry::{BuildOptions, Model};
use cranny_rapier::{RestoreError, Simulation, SnapshotError, restore, snapshot};
use rapier3d::math::Pose;
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::PhysicsWorld;

use crate::world::{World, cuboid, ours, up};

fn scene() -> (World, Vec<Model>) {
    let models = vec![cuboid(4.0, 4.0, 1.0), cuboid(0.6, 0.8, 0.5)];
    let mut world = World::new();
    world.fixed(&ours(&models[0]), Pose::IDENTITY);
    let parts = vec![(up(0.5), SharedShape::ball(0.1)), (Pose::IDENTITY, ours(&models[1]))];
    world.dynamic(&SharedShape::compound(parts), up(0.8));
    (world, models)
}

fn refusal(restored: Result<PhysicsWorld, RestoreError>) -> String {
    match restored {
        Ok(_) => panic!("it was restored"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn no_byte_may_be_missing_or_another() {
    let (mut world, models) = scene();
    world.run(5);
    let bytes = snapshot(&world.0).unwrap();
    assert!(restore(&bytes, &models).is_ok());
    for length in (0..bytes.len()).step_by(7).chain(0..80) {
        let found = refusal(restore(&bytes[..length], &models));
        assert!(found.contains("no snapshot") || found.contains("were written"), "{found}");
    }
    for at in (0..bytes.len()).step_by(5).chain(0..80) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        refusal(restore(&damaged, &models));
    }
    let longer = [bytes.as_slice(), &[0]].concat();
    assert!(refusal(restore(&longer, &models)).contains("were written"));
    let found = refusal(restore(b"solid cube", &models));
    assert!(found.contains("no snapshot"), "{found}");
}

#[test]
fn a_model_that_is_missing_or_another_is_named_with_its_collider() {
    let (mut world, models) = scene();
    world.run(5);
    let bytes = snapshot(&world.0).unwrap();
    let found = refusal(restore(&bytes, &[]));
    assert!(found.contains("collider 0") && found.contains("8 vertices and 12 faces"), "{found}");
    assert!(found.contains("no model was given"), "{found}");

    let found = refusal(restore(&bytes, &models[..1]));
    assert!(
        found.contains("part 1 of collider 1") && found.contains("none is that one"),
        "{found}"
    );

    // One vertex moved by a hair.
    let mut vertices = models[1].mesh().vertices().to_vec();
    vertices[0].x += 1e-9;
    let faces = models[1].mesh().faces().to_vec();
    let moved = cranny_geometry::Mesh::new(vertices, faces).unwrap();
    let other = crate::world::built(moved);
    let found = refusal(restore(&bytes, &[models[0].clone(), other]));
    assert!(found.contains("part 1 of collider 1"), "{found}");

    // The same mesh prepared otherwise.
    let options = BuildOptions { leaf_size: 3, ..BuildOptions::default() };
    let (otherwise, _) = Model::build(models[1].mesh().clone(), &options).unwrap();
    assert_eq!(otherwise.digest(), models[1].digest());
    let found = refusal(restore(&bytes, &[models[0].clone(), otherwise]));
    assert!(found.contains("part 1 of collider 1"), "{found}");

    // A model that was saved and loaded is the same; so is one that is built again, and the order
    // does not matter.
    let loaded = Model::decode(&models[1].encode()).unwrap();
    assert!(restore(&bytes, &[loaded, cuboid(4.0, 4.0, 1.0)]).is_ok());
}

#[test]
fn a_world_is_no_simulation() {
    let (mut world, models) = scene();
    world.run(1);
    let bytes = snapshot(&world.0).unwrap();
    let refused = Simulation::restore(&bytes, &models).err().expect("of a world");
    assert!(refused.to_string().contains("not of a simulation"), "{refused}");
}

#[test]
fn between_steps_only() {
    let (mut world, _) = scene();
    assert!(matches!(snapshot(&world.0), Err(SnapshotError::Unsettled { changed: 2 })));
    world.run(1);
    assert!(snapshot(&world.0).is_ok());
    let (collider, _) = world.0.colliders.iter().next().unwrap();
    world.0.colliders[collider].set_friction(0.3);
    assert!(matches!(snapshot(&world.0), Err(SnapshotError::Unsettled { changed: 1 })));
}
