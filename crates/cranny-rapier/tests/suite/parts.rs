//! Steps that are made in parts.

use cranny_exact::{DVec3, Pose};
use cranny_rapier::{BodyIndex, BodyKind, BodySpec, Detector, Simulation, SimulationOptions};

use crate::world::{cuboid, model, sheet, spec};
use cranny_shapes::Torus;

/// A plate of 0.1 flies at a wall, from 3 away, by 0.15 a step.
fn flight(options: SimulationOptions) -> (Simulation, BodyIndex) {
    let (plate, wall) = (cuboid(0.1, 1.0, 1.0), cuboid(1.0, 4.0, 4.0));
    let mut simulation = Simulation::new(SimulationOptions { gravity: DVec3::ZERO, ..options });
    simulation.insert(&spec(&wall, BodyKind::Fixed, DVec3::X * 3.5)).expect("a wall");
    let plate = BodySpec {
        linear_velocity: DVec3::X * 9.0,
        ..spec(&plate, BodyKind::Dynamic, DVec3::ZERO)
    };
    let index = simulation.insert(&plate).expect("a plate");
    (simulation, index)
}

/// In how many parts each step was made.
fn parts(simulation: &mut Simulation, steps: usize) -> Vec<usize> {
    let step = |_| {
        simulation.step();
        simulation.parts()
    };
    (0..steps).map(step).collect()
}

#[test]
fn only_steps_in_which_something_fast_is_near_something_are_divided() {
    let (mut simulation, plate) =
        flight(SimulationOptions { most_parts: 2, ..SimulationOptions::default() });
    let parts = parts(&mut simulation, 40);
    // It arrives in the 20th step, by 0.15 beside a thickness of 0.083.
    assert!(parts[..17].iter().all(|&parts| parts == 1), "{parts:?}");
    assert!(parts[17..20].contains(&2), "{parts:?}");
    assert!(parts[22..].iter().all(|&parts| parts == 1), "{parts:?}");
    let x = simulation.pose(plate).translation.x;
    assert!(x < 2.96, "in the wall, at {x}");
}

#[test]
fn no_more_parts_are_made_than_are_allowed() {
    let most = |most_parts: usize| {
        let (mut simulation, _) = flight(SimulationOptions {
            step: 1.0 / 8.0,
            most_parts,
            ..SimulationOptions::default()
        });
        parts(&mut simulation, 5).into_iter().max()
    };
    assert_eq!([0, 1, 2, 3, 4].map(most), [1, 1, 2, 3, 4].map(Some));
    assert_eq!(most(1000), Some(9), "no farther than its radius of 0.709 is counted");
    let (mut simulation, _) = flight(SimulationOptions {
        step: 1.0 / 8.0,
        detector: Detector::RapierTrimesh,
        ..SimulationOptions::default()
    });
    assert_eq!(parts(&mut simulation, 5), [1; 5], "a peer steps as rapier has it");
}

/// What turns moves by its rim.
#[test]
fn a_body_that_spins_beside_another_makes_parts() {
    let (blade, post) = (cuboid(2.0, 0.2, 0.1), cuboid(0.2, 0.2, 1.0));
    let spinning = |angular: f64, x: f64| {
        let gravity = DVec3::ZERO;
        let options = SimulationOptions { gravity, most_parts: 4, ..SimulationOptions::default() };
        let mut simulation = Simulation::new(options);
        let blade = BodySpec {
            angular_velocity: DVec3::Z * angular,
            ..spec(&blade, BodyKind::Dynamic, DVec3::ZERO)
        };
        simulation.insert(&blade).expect("a blade");
        simulation.insert(&spec(&post, BodyKind::Fixed, DVec3::X * x)).expect("a post");
        parts(&mut simulation, 3)
    };
    assert_eq!(
        spinning(12.0, 1.2),
        [1, 4, 4],
        "its tip by 0.2 a step, beside a thickness of 0.061"
    );
    assert_eq!(spinning(1.0, 1.2), [1; 3], "too slow");
    assert_eq!(spinning(12.0, 20.0), [1; 3], "nothing is near");
}

/// The time that a step takes is the same, and so is what joints, forces and kinematic bodies do in
/// it.
#[test]
fn a_step_in_parts_lasts_as_long() {
    let (belt, rider) = (cuboid(400.0, 4.0, 1.0), cuboid(0.1, 0.1, 0.1));
    let mut simulation =
        Simulation::new(SimulationOptions { most_parts: 2, ..SimulationOptions::default() });
    let belt = BodySpec {
        linear_velocity: DVec3::X * 30.0,
        ..spec(&belt, BodyKind::Kinematic, DVec3::ZERO)
    };
    let belt = simulation.insert(&belt).expect("a belt");
    simulation.insert(&spec(&rider, BodyKind::Dynamic, DVec3::Z * 0.551)).expect("a rider");
    let divided = parts(&mut simulation, 60).into_iter().filter(|&parts| parts > 1).count();
    assert!(divided > 10, "{divided} steps in parts");
    let at = simulation.pose(belt).translation;
    assert!((at - DVec3::X * 30.0).length() < 1e-3, "after a second: {at}");
}

/// What has no volume has no thickness to go by.
#[test]
fn an_open_sheet_alone_divides_nothing() {
    let (open, ball) = (sheet(2.0), model(Torus::default()));
    let mut simulation =
        Simulation::new(SimulationOptions { most_parts: 2, ..SimulationOptions::default() });
    simulation.insert(&spec(&open, BodyKind::Fixed, DVec3::ZERO)).expect("a sheet");
    let kinematic = BodySpec {
        linear_velocity: DVec3::X * 30.0,
        pose: Pose::at(DVec3::Z),
        ..spec(&open, BodyKind::Kinematic, DVec3::Z)
    };
    simulation.insert(&kinematic).expect("another");
    assert_eq!(parts(&mut simulation, 5), [1; 5]);
    simulation.insert(&spec(&ball, BodyKind::Dynamic, DVec3::Z * 3.0)).expect("a ring");
    assert_eq!(parts(&mut simulation, 1), [1], "before the broad phase knows it");
}
