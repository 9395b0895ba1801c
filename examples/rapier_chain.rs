//! Three links of a chain in rapier, with exact contacts: the upper one is fixed, the others fall
//! into it and stay linked.
//!
//! `cargo run --example rapier_chain --features rapier`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use cranny::prelude::*;
use cranny::rapier::{
    BodyIndex, BodyKind, BodySpec, MassSource, Normals, Simulation, SimulationOptions,
};
use cranny::shapes::ChainLink;
use std::error::Error;
use std::f64::consts::FRAC_PI_2;

/// Between the centres of neighbours, in units: 0.1 less than what a taut chain has.
const SPACING: f64 = 1.6;
const STEP: f64 = 1.0 / 240.0;

fn main() -> Result<(), Box<dyn Error>> {
    let (link, _) = Model::build(ChainLink::default().build()?, &BuildOptions::default())?;
    let mut simulation =
        Simulation::new(SimulationOptions { step: STEP, ..SimulationOptions::default() });

    // A link's long axis, x, is turned to z; every other link by a quarter about it as well.
    let upright = DQuat::from_rotation_y(FRAC_PI_2);
    let mut hang = |k: u32| {
        simulation.insert(&BodySpec {
            shape: (&link).into(),
            kind: if k == 0 { BodyKind::Fixed } else { BodyKind::Dynamic },
            pose: Pose {
                rotation: upright * DQuat::from_rotation_x(f64::from(k % 2) * FRAC_PI_2),
                translation: DVec3::new(0.0, 0.0, -SPACING * f64::from(k)),
            },
            linear_velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            mass: MassSource::Density(1.0),
            friction: 0.5,
            restitution: 0.0,
            normals: Normals::Flat,
            groups: 1,
        })
    };
    let links: [BodyIndex; 3] = [hang(0)?, hang(1)?, hang(2)?];

    let start = simulation.energy().total();
    let mut deepest = 0.0f64;
    for step in 0..=480 {
        if step % 60 == 0 {
            let [_, middle, last] = links.map(|link| simulation.pose(link).translation.z);
            println!(
                "{:.2} s: middle link at {middle:.4}, last at {last:.4}, {} points in the solver",
                f64::from(step) * STEP,
                simulation.solver_contacts(),
            );
        }
        simulation.step();
        // The very answers that the solver's contacts came from.
        for pair in simulation.contact_pairs() {
            let depths = pair.answer.contacts.iter().map(|contact| -contact.separation);
            deepest = depths.fold(deepest, f64::max);
        }
    }
    println!("deepest overlap on the way: {deepest:.5} units, wire radius 0.15");
    println!("energy: {:.4} lost", start - simulation.energy().total());
    Ok(())
}
