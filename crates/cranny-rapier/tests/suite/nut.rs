//! A nut spun on its bolt without friction and weight climbs its helix, and nothing stops it.

#![allow(clippy::print_stderr)] // figures are worth saying

use std::f64::consts::TAU;
use std::time::Instant;

use cranny_exact::{DVec3, Pose};
use cranny_rapier::{
    BodyKind, BodySpec, Detector, MassSource, Normals, Simulation, SimulationOptions,
};
use cranny_shapes::{IsoBolt, IsoNut};

use crate::world::model;

const PITCH: f64 = 2.0;
const STEP: f64 = 1.0 / 240.0;

#[test]
fn a_spun_nut_keeps_turning_along_its_helix() {
    // Frictionless, a turn a second for 2 s: of 2 turns at least 1.98 are left; the play is 0.058,
    // and it lets the nut tilt by 0.4 degrees.
    let (bolt, nut) = (
        model(IsoBolt { segments: 144, ..IsoBolt::default() }),
        model(IsoNut { segments: 144, ..IsoNut::default() }),
    );
    let mut simulation = Simulation::new(SimulationOptions {
        detector: Detector::Cranny,
        gravity: DVec3::ZERO,
        step: STEP,
        length_unit: 3.0, // about twice the nut's volume by its area, as scenes have it
        ..SimulationOptions::default()
    });
    let spec = |model: &cranny_geometry::Model, kind, z: f64, spin: f64| BodySpec {
        shape: model.into(),
        kind,
        pose: Pose::at(DVec3::new(0.0, 0.0, z)),
        linear_velocity: DVec3::ZERO,
        angular_velocity: DVec3::new(0.0, 0.0, spin),
        mass: MassSource::Density(1.0),
        friction: 0.0,
        restitution: 0.0,
        normals: Normals::Flat,
        groups: 1,
    };
    simulation.insert(&spec(&bolt, BodyKind::Fixed, 0.0, 0.0)).unwrap();
    let nut = simulation.insert(&spec(&nut, BodyKind::Dynamic, 20.0, TAU)).unwrap();
    let (mut turned, mut before) = (0.0, 0.0);
    let (mut deviation, mut tilt, mut deepest, mut points) = (0.0f64, 0.0f64, 0.0f64, 0);
    let start = Instant::now();
    for _ in 0..480 {
        simulation.step();
        let pose = simulation.pose(nut);
        let x = pose.rotation * DVec3::X;
        let angle = x.y.atan2(x.x);
        turned += (angle - before + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        before = angle;
        let height = 20.0 + turned / TAU * PITCH;
        deviation = deviation.max((pose.translation.z - height).abs());
        let axis = pose.rotation * DVec3::Z;
        tilt = tilt.max(axis.x.hypot(axis.y).asin().to_degrees());
        for pair in simulation.contact_pairs() {
            let gaps = pair.answer.contacts.iter().map(|c| -c.separation);
            deepest = gaps.fold(deepest, f64::max);
        }
        points = points.max(simulation.solver_contacts());
    }
    let step = start.elapsed().as_secs_f64() / 480.0;
    let turns = turned / TAU;
    eprintln!(
        "nut: {turns:.4} turns, off the helix by {deviation:.4}, tilt {tilt:.3} degrees, \
         depth {deepest:.4}, {points} points, {:.2} ms a step, of it {:.2} ms detection",
        1e3 * step,
        1e3 * simulation.narrow_phase_seconds() / 480.0,
    );
    assert!(turns >= 1.98, "{turns}");
    assert!(deviation <= 0.07, "{deviation}");
    assert!(tilt <= 0.4, "{tilt}");
    assert!(deepest <= 0.06, "{deepest}");
}
