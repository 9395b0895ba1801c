//! A ball that rolls over a floor of many triangles feels a plane.

use cranny_shapes::Floor;
use rapier3d::math::{Pose as RapierPose, Real, Vector};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::{RigidBodyBuilder, RigidBodyHandle};

use crate::world::{World, model, ours};

const RADIUS: Real = 0.5;

/// A ball that rolls from rest height without slipping, askew to all edges: 2 m/s along x, 0.3
/// along y.
fn rolling(world: &mut World) -> RigidBodyHandle {
    let body = RigidBodyBuilder::dynamic()
        .translation(Vector::new(-6.0, -0.4, RADIUS))
        .linvel(Vector::new(2.0, 0.3, 0.0))
        .angvel(Vector::new(-0.3 / RADIUS, 2.0 / RADIUS, 0.0));
    world.insert(body, &SharedShape::ball(RADIUS))
}

/// 20,000 triangles on top, whose edges the ball crosses every 0.1 s in both directions and askew:
/// its vertical velocity is that of a ball on a plane within 1e-3, at every step, and so is where
/// it comes to.
#[test]
fn a_ball_feels_no_bump_on_20_000_triangles() {
    let floor = Floor { size: [20.0, 10.0, 0.5], squares: [100, 100] };
    let (mut tiled, mut plane) = (World::new(), World::new());
    tiled.fixed(&ours(&model(floor)), RapierPose::IDENTITY);
    plane.fixed(&SharedShape::halfspace(Vector::Z), RapierPose::IDENTITY);
    let (over_tiles, over_plane) = (rolling(&mut tiled), rolling(&mut plane));
    let mut touched = 0;
    for step in 0..240 {
        tiled.run(1);
        plane.run(1);
        touched += tiled.manifolds().count();
        let [here, there] = [(&tiled, over_tiles), (&plane, over_plane)]
            .map(|(world, ball)| (world.at(ball), world.0.bodies[ball].linvel()));
        let bump = (here.1.z - there.1.z).abs();
        assert!(bump < 1e-3, "step {step}: {} and {} upwards", here.1, there.1);
        assert!((here.0 - there.0).length() < 1e-3, "step {step}: {} and {}", here.0, there.0);
    }
    assert!(touched >= 240, "in contact at every step, but {touched}");
    // 4 s at 2 m/s: it has crossed 40 rows of squares.
    assert!(tiled.at(over_tiles).x > 1.9, "{}", tiled.at(over_tiles));
}
