//! Bodies that fall together: who lands under another stops it too, in the same step.

use cranny_exact::DVec3;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_rapier::{BodyIndex, BodyKind, BodySpec, Simulation, SimulationOptions};

use crate::world::{cuboid, spec};

/// Metres a second: 0.1 a step.
const FALL: f64 = 6.0;

/// Between the two, which approach each other by nothing before the lower one lands.
const GAP: f64 = 0.01;

/// Of the exact overlap: a tenth of what the upper one falls by in a step.
const OVERLAP: f64 = 0.01;

#[test]
fn what_falls_along_is_stopped_in_the_step_in_which_the_other_lands() {
    let (ground, plate) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 0.1));
    // A plate's 2·V/A is 0.083: a prediction distance of 0.0017, less than the gap.
    let options = SimulationOptions { length_unit: 0.083, ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let at = |z: f64| DVec3::new(0.0, 0.0, z);
    let fixed = spec(&ground, BodyKind::Fixed, at(-0.5));
    let falling =
        |z: f64| BodySpec { linear_velocity: at(-FALL), ..spec(&plate, BodyKind::Dynamic, at(z)) };
    // The lower one lands in the middle of its first step.
    let (lower, upper) = (falling(0.05 + 0.05), falling(0.05 + 0.05 + 0.1 + GAP));
    let bodies = [fixed, lower, upper].map(|spec| simulation.insert(&spec).expect("a body"));
    let models = [&ground, &plate, &plate];
    let overlap = |simulation: &Simulation, i: usize, j: usize| -> f64 {
        let placed = |k: usize| Placed { model: models[k], pose: simulation.pose(bodies[k]) };
        let ask = Query::of(Demand::Regions { margin: 0.0 });
        let answer = query(placed(i), placed(j), &ask, &mut PairMemory::default()).expect("poses");
        assert!(answer.contained.is_none(), "one inside the other");
        answer.regions.iter().map(|r| r.depth.expect("closed bodies")).fold(0.0, f64::max)
    };
    for step in 0..60 {
        simulation.step();
        for (i, j) in [(0, 1), (1, 2)] {
            let depth = overlap(&simulation, i, j);
            assert!(depth < OVERLAP, "step {step}: {i} and {j} are {depth} deep");
        }
    }
    let height = |body: BodyIndex| simulation.pose(body).translation.z;
    assert!((height(bodies[1]) - 0.05).abs() < 2e-3, "{}", height(bodies[1]));
    assert!((height(bodies[2]) - 0.15).abs() < 4e-3, "{}", height(bodies[2]));
}
