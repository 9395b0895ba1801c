//! An app that already runs on rapier, with plain sets of its own: two lines change, the dispatcher
//! of the narrow phase and the shape of the colliders. A ball falls into a cup, past its rim, and
//! stays there: to the solver the cup is as hollow as its mesh.

use cranny_geometry::{BuildOptions, Model};
use cranny_rapier::{MeshShape, dispatcher};
use cranny_shapes::Cup;
use rapier3d::prelude::*;

#[allow(clippy::print_stdout, reason = "an example")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cup = Cup { radius: 1.0, height: 1.5, wall: 0.1, floor: 0.2, segments: 64 };
    let (cup, _) = Model::build(cup.build()?, &BuildOptions::default())?;

    let mut bodies = RigidBodySet::new();
    let mut colliders = ColliderSet::new();
    let stand = bodies.insert(RigidBodyBuilder::fixed());
    let shape = MeshShape::shared(&cup, 0)?; // was: SharedShape::convex_decomposition(…)
    colliders.insert_with_parent(ColliderBuilder::new(shape), stand, &mut bodies);
    let start = Vector::new(0.3, 0.2, 3.0);
    let ball = bodies.insert(RigidBodyBuilder::dynamic().translation(start));
    colliders.insert_with_parent(ColliderBuilder::ball(0.3), ball, &mut bodies);

    let mut narrow_phase = NarrowPhase::with_query_dispatcher(dispatcher()); // was: NarrowPhase::new()
    let mut broad_phase = DefaultBroadPhase::new();
    let mut pipeline = PhysicsPipeline::new();
    let mut islands = IslandManager::new();
    let (mut joints, mut multibody_joints) = (ImpulseJointSet::new(), MultibodyJointSet::new());
    let (mut soft_bodies, mut ccd) = (SoftBodySet::new(), CCDSolver::new());
    let parameters = IntegrationParameters::default();

    for step in 0..=240 {
        pipeline.step(
            Vector::new(0.0, 0.0, -9.81),
            &parameters,
            &mut islands,
            &mut broad_phase,
            &mut narrow_phase,
            &mut bodies,
            &mut colliders,
            &mut joints,
            &mut multibody_joints,
            &mut soft_bodies,
            &mut ccd,
            &(),
            &(),
        );
        if step % 40 == 0 {
            let manifolds = narrow_phase.contact_pairs().flat_map(|pair| pair.manifolds());
            let points: usize = manifolds.map(|manifold| manifold.points.len()).sum();
            let at = bodies[ball].translation();
            println!("{:4.2} s: ball at z = {:.3}, {points} contacts", step as f32 / 60.0, at.z);
        }
    }
    let rest = bodies[ball].translation();
    println!("at rest {:.3} above the cup's floor: its radius is 0.3", rest.z - 0.2);
    Ok(())
}
