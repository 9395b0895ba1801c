//! Fast bodies are stopped before they overlap, in the same step, whoever it is that stops them;
//! and what is near none of them is not looked at farther than usual.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_rapier::{BodyIndex, BodyKind, BodySpec, Simulation, SimulationOptions};

use crate::world::{cuboid, spec};

/// A plate's 2·V/A is 0.083: a prediction distance of 0.0017, less than the gaps.
const UNIT: f64 = 0.083;

/// Metres a second: 0.1 a step.
const FALL: f64 = 6.0;

/// Between the two, which approach each other by nothing before the lower one lands.
const GAP: f64 = 0.01;

/// Of the exact overlap: a tenth of what the upper one falls by in a step.
const OVERLAP: f64 = 0.01;

fn simulation(gravity: f64) -> Simulation {
    let gravity = DVec3::new(0.0, 0.0, gravity);
    Simulation::new(SimulationOptions {
        length_unit: UNIT,
        gravity,
        ..SimulationOptions::default()
    })
}

fn at(z: f64) -> DVec3 {
    DVec3::new(0.0, 0.0, z)
}

fn moving(spec: BodySpec, velocity: DVec3) -> BodySpec {
    BodySpec { linear_velocity: velocity, ..spec }
}

/// How deep two bodies overlap, by the exact query.
fn overlap(simulation: &Simulation, bodies: [(&Model, BodyIndex); 2]) -> f64 {
    let [a, b] = bodies.map(|(model, body)| Placed { model, pose: simulation.pose(body) });
    let ask = Query::of(Demand::Regions { margin: 0.0 });
    let answer = query(a, b, &ask, &mut PairMemory::default()).expect("poses");
    assert!(answer.contained.is_none(), "one inside the other");
    answer.regions.iter().map(|r| r.depth.expect("closed bodies")).fold(0.0, f64::max)
}

#[test]
fn what_falls_along_is_stopped_in_the_step_in_which_the_other_lands() {
    let (ground, plate) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 0.1));
    let mut simulation = simulation(-9.81);
    let fixed = spec(&ground, BodyKind::Fixed, at(-0.5));
    let falling = |z: f64| moving(spec(&plate, BodyKind::Dynamic, at(z)), at(-FALL));
    // The lower one lands in the middle of its first step.
    let (lower, upper) = (falling(0.05 + 0.05), falling(0.05 + 0.05 + 0.1 + GAP));
    let bodies = [fixed, lower, upper].map(|spec| simulation.insert(&spec).expect("a body"));
    let bodies = [(&ground, bodies[0]), (&plate, bodies[1]), (&plate, bodies[2])];
    for step in 0..60 {
        simulation.step();
        for (i, j) in [(0, 1), (1, 2)] {
            let depth = overlap(&simulation, [bodies[i], bodies[j]]);
            assert!(depth < OVERLAP, "step {step}: {i} and {j} are {depth} deep");
        }
    }
    let height = |k: usize| simulation.pose(bodies[k].1).translation.z;
    assert!((height(1) - 0.05).abs() < 2e-3, "{}", height(1));
    assert!((height(2) - 0.15).abs() < 4e-3, "{}", height(2));
}

#[test]
fn what_has_long_been_falling_lands_wherever_a_step_ends() {
    let (ground, plate) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 0.1));
    // It takes 37 steps to fall by 1.9; in the last it falls by 0.1.
    for start in 0..10 {
        let mut simulation = simulation(-9.81);
        let bodies = [
            spec(&ground, BodyKind::Fixed, at(-0.5)),
            spec(&plate, BodyKind::Dynamic, at(1.95 + 0.01 * f64::from(start))),
        ]
        .map(|spec| simulation.insert(&spec).expect("a body"));
        for step in 0..50 {
            simulation.step();
            let depth = overlap(&simulation, [(&ground, bodies[0]), (&plate, bodies[1])]);
            assert!(depth < OVERLAP, "from {start}, step {step}: {depth} deep");
        }
        let height = simulation.pose(bodies[1]).translation.z;
        assert!((height - 0.05).abs() < 2e-3, "from {start}: {height}");
    }
}

#[test]
fn what_is_hit_is_stopped_by_what_stands_behind_it() {
    let plate = cuboid(1.0, 1.0, 0.1);
    let mut simulation = simulation(0.0);
    // The first one hits the second after a tenth of some step, which then has a gap of 0.02 before
    // it.
    let bodies = [
        moving(spec(&plate, BodyKind::Dynamic, at(0.4 + 0.1 + GAP)), at(-FALL)),
        spec(&plate, BodyKind::Dynamic, at(0.1 + 2.0 * GAP)),
        spec(&plate, BodyKind::Fixed, at(0.0)),
    ]
    .map(|spec| simulation.insert(&spec).expect("a body"));
    for step in 0..60 {
        simulation.step();
        for pair in bodies.windows(2) {
            let depth = overlap(&simulation, [(&plate, pair[0]), (&plate, pair[1])]);
            assert!(depth < OVERLAP, "step {step}: {pair:?} are {depth} deep");
        }
    }
    let height = simulation.pose(bodies[0]).translation.z;
    assert!(height > 0.2 - OVERLAP, "{height}");
}

#[test]
fn a_lost_body_makes_nothing_else_dearer() {
    let (ground, plate) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 0.1));
    let mut simulation = simulation(-9.81);
    let bodies = [
        spec(&ground, BodyKind::Fixed, at(-0.5)),
        spec(&plate, BodyKind::Dynamic, at(0.05)),
        moving(spec(&plate, BodyKind::Dynamic, at(-50.0)), at(-10.0 * FALL)),
    ];
    for spec in &bodies {
        simulation.insert(spec).expect("a body");
    }
    for _ in 0..3 {
        simulation.step();
    }
    let usual = 0.02 * UNIT;
    assert!((simulation.prediction_distance() - usual).abs() < 0.01 * usual);
    // It came back, and is seen.
    simulation.set_pose(BodyIndex(2), Pose::at(at(0.2)));
    simulation.set_velocity(BodyIndex(2), at(-FALL), DVec3::ZERO);
    simulation.step();
    assert!(simulation.prediction_distance() >= FALL / 60.0);
    let depth = overlap(&simulation, [(&plate, BodyIndex(1)), (&plate, BodyIndex(2))]);
    assert!(depth < OVERLAP, "{depth} deep");
}

#[test]
fn what_falls_side_by_side_is_not_looked_at() {
    let plate = cuboid(1.0, 1.0, 0.1);
    let mut simulation = simulation(-9.81);
    for x in [0.0, 1.0 + GAP] {
        let falling = spec(&plate, BodyKind::Dynamic, DVec3::new(x, 0.0, 50.0));
        simulation.insert(&moving(falling, at(-FALL))).expect("a body");
    }
    for _ in 0..3 {
        simulation.step();
    }
    let pairs = simulation.contact_pairs();
    assert!(pairs.iter().all(|pair| !pair.fresh), "{} pairs", pairs.len());
}

/// Nothing moves but that it turns: what comes down is the end of a bar, by more than its gap,
/// which is within the prediction distance of 0.02.
#[test]
fn what_comes_down_by_turning_is_stopped_in_the_same_step() {
    let (ground, bar) = (cuboid(4.0, 4.0, 1.0), cuboid(2.0, 0.2, 0.2));
    for gap in [0.002, 0.008, 0.012, 0.018] {
        let options = SimulationOptions { gravity: DVec3::ZERO, ..SimulationOptions::default() };
        let mut simulation = Simulation::new(options);
        let ground_body = simulation.insert(&spec(&ground, BodyKind::Fixed, at(-0.5))).unwrap();
        let turning = BodySpec {
            angular_velocity: DVec3::Y * 0.03 * 60.0,
            ..spec(&bar, BodyKind::Dynamic, at(0.1 + gap))
        };
        let bar_body = simulation.insert(&turning).unwrap();
        // rapier has seen both, and the bar is put back to where it was.
        let (pose, velocity) = (simulation.pose(bar_body), simulation.velocity(bar_body));
        simulation.step();
        simulation.set_pose(bar_body, pose);
        simulation.set_velocity(bar_body, velocity.0, velocity.1);
        simulation.step();
        assert!(simulation.solver_contacts() > 0, "a gap of {gap}");
        let depth = overlap(&simulation, [(&ground, ground_body), (&bar, bar_body)]);
        assert!(depth < 1e-3, "a gap of {gap}: {depth} deep");
    }
}

/// What stands still within the prediction distance is no business of the solver's, unless gravity
/// or a push may bring it there in the step.
#[test]
fn a_solver_gets_what_may_come_together_in_the_step() {
    let (ground, cube) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0));
    let contacts = |gravity: f64, gap: f64| {
        let gravity = DVec3::Z * gravity;
        let mut simulation =
            Simulation::new(SimulationOptions { gravity, ..SimulationOptions::default() });
        simulation.insert(&spec(&ground, BodyKind::Fixed, at(-0.5))).unwrap();
        let cube = simulation.insert(&spec(&cube, BodyKind::Dynamic, at(0.5 + gap))).unwrap();
        let pose = simulation.pose(cube);
        simulation.step();
        simulation.set_pose(cube, pose);
        simulation.set_velocity(cube, DVec3::ZERO, DVec3::ZERO);
        simulation.step();
        simulation.solver_contacts()
    };
    assert!(contacts(0.0, 0.004) >= 4, "within a quarter of 0.02");
    assert_eq!(contacts(0.0, 0.007), 0, "beyond it");
    // 0.0069 in a step of 1/60 s.
    assert!(contacts(-25.0, 0.007) >= 4, "it falls there");
    assert_eq!(contacts(-25.0, 0.015), 0, "and no farther");
}

/// A cube comes down so slowly that searches which found nothing are carried on: it has its
/// contacts as soon as it is within a quarter of the prediction distance.
#[test]
fn what_comes_near_while_it_is_carried_on_has_its_contacts() {
    let (ground, cube) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0));
    for start in [0.0055, 0.0062, 0.0067] {
        let options = SimulationOptions { gravity: DVec3::ZERO, ..SimulationOptions::default() };
        let mut simulation = Simulation::new(options);
        simulation.insert(&spec(&ground, BodyKind::Fixed, at(-0.5))).unwrap();
        let cube = simulation.insert(&spec(&cube, BodyKind::Dynamic, at(0.5 + start))).unwrap();
        let (mut near, mut carried) = (0, 0);
        for step in 0..16 {
            simulation.set_velocity(cube, at(-0.0002 * 60.0), DVec3::ZERO);
            let gap = simulation.pose(cube).translation.z - 0.5;
            simulation.step();
            carried += simulation.pair_counts().carried;
            if gap < 0.0049 {
                near += 1;
                assert!(simulation.solver_contacts() >= 4, "from {start}, step {step}: {gap}");
            }
        }
        assert!(near > 5 && carried > 5, "{near} steps within reach, {carried} carried on");
    }
}
