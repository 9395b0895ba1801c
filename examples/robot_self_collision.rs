//! A robot that folds up and might hit itself: of each configuration on the way, the links that
//! meet, on their meshes and primitives. Links that a joint joins overlap by design, and others
//! that meet at rest.
//!
//! `cargo run --example robot_self_collision --features scene`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;

use cranny::prelude::{BuildOptions, Model, World};
use cranny::scene::{Robot, read_robot};
use cranny::world::description::{Effect, JointPositions};
use cranny::world::{BodyId, BodySpec};

/// The links that have a mesh, as bodies of a world.
fn bodies(robot: &Robot, world: &mut World) -> Result<Vec<Option<BodyId>>, Box<dyn Error>> {
    let mut ids = Vec::new();
    for link in &robot.links {
        let spec = match (link.primitive, &link.collision) {
            (Some(primitive), _) => BodySpec::new(&link.name, primitive),
            (None, Some(mesh)) => {
                let (model, _) = Model::build(mesh.as_ref().clone(), &BuildOptions::default())?;
                BodySpec::new(&link.name, model)
            }
            (None, None) => {
                ids.push(None);
                continue;
            }
        };
        ids.push(Some(world.insert(spec)?));
    }
    Ok(ids)
}

fn main() -> Result<(), Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/robots/arm/arm.urdf");
    let robot = read_robot(file.as_ref())?;
    let mut world = World::new();
    world.set_scene_effects(&[Effect::TRIGGER])?;
    let ids = bodies(&robot, &mut world)?;
    for (a, b) in robot.adjacent_links() {
        if let (Some(a), Some(b)) = (ids[a], ids[b]) {
            world.exclude_pair(a, b)?;
        }
    }
    // Where the links are, and which pairs meet there.
    let meeting = |world: &mut World, positions: &JointPositions| {
        for (pose, id) in robot.forward_kinematics(positions)?.into_iter().zip(&ids) {
            if let Some(id) = *id {
                world.set_pose(id, pose)?;
            }
        }
        Ok::<_, Box<dyn Error>>(world.step()?.touching)
    };
    for (a, b) in meeting(&mut world, &JointPositions::new())? {
        world.exclude_pair(a, b)?;
    }
    let mut first = None;
    for step in 0..=24 {
        let share = f64::from(step) / 24.0;
        let folded = [("axis_2", -1.2), ("axis_3", 2.4), ("axis_5", 2.0)];
        let positions: JointPositions =
            folded.into_iter().map(|(joint, most)| (joint.to_owned(), share * most)).collect();
        let pairs = meeting(&mut world, &positions)?;
        if let (Some(&(a, b)), None) = (pairs.first(), first) {
            let names = [a, b].map(|id| world.name(id).unwrap_or_default().to_owned());
            println!("folded by {:.0} %: {} meets {}", 100.0 * share, names[0], names[1]);
            first = Some(share);
        }
    }
    println!(
        "{}",
        if first.is_some() { "it must not fold up wholly" } else { "it folds up freely" }
    );
    assert!(first.is_some_and(|share| share > 0.25));
    Ok(())
}
