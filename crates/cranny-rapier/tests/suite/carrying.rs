//! Contacts that are carried on: what rests keeps them, what leaves loses them.

use cranny_exact::{DQuat, DVec3, Pose};
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

/// A plate is led out of a block, askew and straight. It takes the same way with a search in each
/// step and with one in a few, comes out on the side where it came in, and is carried on there as
/// what rests.
#[test]
fn a_way_out_is_carried_on() {
    let models = [cuboid(4.0, 4.0, 1.0), cuboid(1.0, 0.7, 0.3)];
    // The middle of the plate, below the top at 0.5; wholly inside at the second.
    for (height, tilt) in [(0.45, 0.0), (0.3, 0.0), (0.45, 0.1)] {
        let led = |recycling: bool| {
            let options =
                SimulationOptions { recycling: Some(recycling), ..SimulationOptions::default() };
            let mut simulation = Simulation::new(options);
            simulation.insert(&spec(&models[0], BodyKind::Fixed, DVec3::ZERO)).unwrap();
            let plate = spec(&models[1], BodyKind::Dynamic, DVec3::Z * height);
            let rotation = DQuat::from_rotation_x(tilt) * DQuat::from_rotation_z(0.2);
            let pose = Pose { rotation, ..plate.pose };
            simulation.insert(&BodySpec { pose, ..plate }).unwrap();
            let (mut way, mut counts) = (Vec::new(), PairCounts::default());
            // Twelve steps: half of the time that the shortest way takes.
            for _ in 0..12 {
                simulation.step();
                let PairCounts { carried, searched } = simulation.pair_counts();
                counts.carried += carried;
                counts.searched += searched;
                way.push(simulation.pose(CUBE).translation.z);
            }
            (0..180).for_each(|_| simulation.step());
            let Pose { rotation, translation } = simulation.pose(CUBE);
            let up = (rotation * DVec3::Z).z;
            assert!(up > 0.999 && (translation.z - 0.65).abs() < 2e-3, "{up} at {translation}");
            (way, counts)
        };
        let ((anew, all), (lasting, some)) = (led(false), led(true));
        assert_eq!(all.carried, 0);
        assert!(some.carried >= some.searched, "{some:?} from {height} at {tilt}");
        for (x, y) in anew.iter().zip(&lasting) {
            assert!((x - y).abs() < 5e-3, "from {height} at {tilt}: {lasting:?}, not {anew:?}");
        }
    }
}
