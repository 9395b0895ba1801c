//! Contacts that are carried on: what rests keeps them, what leaves loses them.

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, CARRIED_WITHIN, PairCounts, Simulation, SimulationOptions,
};

use crate::world::{cuboid, spec};

const CUBE: BodyIndex = BodyIndex(1);

/// A cube at rest in the middle of a slab, whose top is at 0.5.
fn at_rest(models: &[Model; 2], recycling: bool, friction: f64) -> Simulation {
    let options = SimulationOptions { recycling: Some(recycling), ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let slab = BodySpec { friction, ..spec(&models[0], BodyKind::Fixed, DVec3::ZERO) };
    let at = DVec3::new(0.0, 0.0, 1.0005);
    let cube = BodySpec { friction, ..spec(&models[1], BodyKind::Dynamic, at) };
    simulation.insert(&slab).unwrap();
    simulation.insert(&cube).unwrap();
    (0..10).for_each(|_| simulation.step());
    simulation
}

fn models() -> [Model; 2] {
    [cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0)]
}

#[test]
fn what_rests_is_carried_on_unless_that_is_turned_off() {
    for recycling in [true, false] {
        let mut simulation = at_rest(&models(), recycling, 0.5);
        // Lest it falls asleep.
        let stirred = DVec3::X * 1e-4;
        for step in 0..5 {
            simulation.set_velocity(CUBE, stirred, DVec3::ZERO);
            simulation.step();
            let expected = PairCounts { carried: recycling.into(), searched: (!recycling).into() };
            // What wakes is searched.
            if step > 0 {
                assert_eq!(simulation.pair_counts(), expected, "step {step}");
            }
            assert!(simulation.solver_contacts() >= 3);
        }
    }
}

/// At once, or by less in each step than may be carried on over.
#[test]
fn a_body_pulled_away_loses_its_contacts() {
    let models = models();
    let mut simulation = at_rest(&models, true, 0.5);
    let mut pose = simulation.pose(CUBE);
    pose.translation.z += 0.3;
    simulation.set_pose(CUBE, pose);
    simulation.set_velocity(CUBE, DVec3::ZERO, DVec3::ZERO);
    simulation.step();
    assert_eq!(simulation.solver_contacts(), 0);

    let mut simulation = at_rest(&models, true, 0.5);
    let (start, mut carried) = (simulation.pose(CUBE).translation.z, 0);
    for _ in 0..60 {
        simulation.set_velocity(CUBE, DVec3::Z * 0.2, DVec3::ZERO);
        simulation.step();
        carried += simulation.pair_counts().carried;
        // Of the step's beginning, which the next one's contacts are not of.
        let gap = simulation.pose(CUBE).translation.z - start - 0.2 / 60.0;
        if gap > 0.021 {
            assert_eq!(simulation.solver_contacts(), 0, "a gap of {gap}");
        }
    }
    assert!(simulation.pose(CUBE).translation.z > start + 0.05);
    assert!(carried > 0, "it left slowly");
}

/// It slides by less in a step than may be carried on over, and is gone over the edge when its
/// middle is.
#[test]
fn a_body_slid_to_an_edge_falls() {
    let fallen = |recycling: bool| {
        let mut simulation = at_rest(&models(), recycling, 0.0);
        let mut pose = simulation.pose(CUBE);
        pose.translation.x = 1.97;
        simulation.set_pose(CUBE, pose);
        let (slow, mut carried) = (0.3 * CARRIED_WITHIN * 0.02 * 60.0, 0);
        for step in 0..600 {
            simulation.set_velocity(CUBE, DVec3::X * slow, simulation.velocity(CUBE).1);
            if simulation.pose(CUBE).translation.x < 1.999 {
                simulation.step();
                carried += simulation.pair_counts().carried;
                let z = simulation.pose(CUBE).translation.z;
                assert!((z - 1.0).abs() < 0.01, "step {step}: {z} above the slab");
            } else {
                break;
            }
        }
        assert_eq!(carried > 10, recycling, "{carried} steps were carried on");
        let on_edge = simulation.pose(CUBE).translation.x;
        simulation.set_velocity(CUBE, DVec3::X * 0.2, DVec3::ZERO);
        (0..120).for_each(|_| simulation.step());
        (on_edge, simulation.pose(CUBE).translation.z)
    };
    for recycling in [true, false] {
        let (x, z) = fallen(recycling);
        assert!(x >= 1.999 && z < 0.0, "from {x} it came to {z}");
    }
}
