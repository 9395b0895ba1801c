//! Joints, energy, determinism, carrying; and the four detectors.

use std::f64::consts::FRAC_PI_4;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, Detector, JointSpec, MassSource, Motor, Simulation,
    SimulationError, SimulationOptions,
};
use cranny_shapes::{LPrism, Torus};

use crate::world::{cuboid, model, sheet, spec};

fn pinned(joint: &JointSpec, velocity: DVec3) -> (Simulation, BodyIndex, BodyIndex) {
    let bar = cuboid(1.0, 0.1, 0.1);
    let mut simulation = Simulation::new(SimulationOptions::default());
    let a = simulation.insert(&spec(&bar, BodyKind::Fixed, DVec3::ZERO)).expect("a body");
    let moving = BodySpec { angular_velocity: velocity, ..spec(&bar, BodyKind::Dynamic, DVec3::X) };
    let b = simulation.insert(&moving).expect("a body");
    let (end, start) = (Pose::at(DVec3::new(0.5, 0.0, 0.0)), Pose::at(DVec3::new(-0.5, 0.0, 0.0)));
    simulation.join(a, b, end, start, joint, false);
    (simulation, a, b)
}

/// Angle about y by which the bar hangs down.
fn droop(pose: &Pose) -> f64 {
    let along = pose.world_from_body().apply_vector(DVec3::X);
    (-along.z).atan2(along.x)
}

#[test]
fn a_hinge_stops_at_its_limit() {
    let limits = Some([-FRAC_PI_4, FRAC_PI_4]);
    let hinge = JointSpec::Revolute { axis: DVec3::Y, limits, motor: None };
    let (mut simulation, _, bar) = pinned(&hinge, DVec3::ZERO);
    let mut most = 0.0f64;
    for _ in 0..240 {
        simulation.step();
        most = most.max(droop(&simulation.pose(bar)));
    }
    let rest = droop(&simulation.pose(bar));
    assert!((rest - FRAC_PI_4).abs() < 0.02, "hangs at {rest}");
    assert!(most < FRAC_PI_4 + 0.1, "went to {most}");
    let pin = simulation.pose(bar).world_from_body().apply(DVec3::new(-0.5, 0.0, 0.0));
    assert!((pin - DVec3::new(0.5, 0.0, 0.0)).length() < 1e-2, "the pin is at {pin}");
}

#[test]
fn a_motor_holds_its_target_against_the_weight() {
    let hinge = JointSpec::Revolute { axis: DVec3::Y, limits: None, motor: Some(Motor::at(0.3)) };
    let (mut simulation, _, bar) = pinned(&hinge, DVec3::ZERO);
    for _ in 0..240 {
        simulation.step();
    }
    let at = droop(&simulation.pose(bar));
    // The spring of 5 Hz yields by the weight's torque over inertia and stiffness: 0.06.
    assert!((at - 0.3).abs() < 0.08, "held at {at}");
}

#[test]
fn a_fixed_joint_leaves_nothing_free() {
    let (mut simulation, a, b) = pinned(&JointSpec::Fixed, DVec3::new(0.3, -0.2, 0.5));
    for _ in 0..120 {
        simulation.step();
    }
    let (a, b) = (simulation.pose(a), simulation.pose(b));
    assert!((b.translation - a.translation - DVec3::X).length() < 1e-2, "{}", b.translation);
    assert!(b.rotation.dot(a.rotation).abs() > 1.0 - 1e-4, "{}", b.rotation);
}

#[test]
fn a_slider_slides_along_its_axis_to_its_limit() {
    let slider = JointSpec::Prismatic { axis: -DVec3::Z, limits: Some([0.0, 0.4]), motor: None };
    let (mut simulation, _, bar) = pinned(&slider, DVec3::ZERO);
    for _ in 0..180 {
        simulation.step();
    }
    let at = simulation.pose(bar).translation;
    assert!((at - DVec3::new(1.0, 0.0, -0.4)).length() < 1e-2, "slid to {at}");
}

#[test]
fn a_ball_joint_swings_about_every_axis_and_keeps_its_point() {
    let (mut simulation, _, bar) = pinned(&JointSpec::Ball, DVec3::new(0.0, 0.0, 2.0));
    let mut swung = [0.0f64; 2];
    for _ in 0..240 {
        simulation.step();
        let map = simulation.pose(bar).world_from_body();
        let along = map.apply_vector(DVec3::X);
        swung = [swung[0].max(along.y.abs()), swung[1].max(along.z.abs())];
        let pin = map.apply(DVec3::new(-0.5, 0.0, 0.0));
        assert!((pin - DVec3::new(0.5, 0.0, 0.0)).length() < 2e-2, "the pin is at {pin}");
    }
    assert!(swung.iter().all(|&most| most > 0.3), "swung by {swung:?}");
}

/// A cube of mass 1 below a fixed one, both held at their origins.
fn hung(joint: &JointSpec, height: f64, gravity: DVec3) -> (Simulation, BodyIndex) {
    let cube = cuboid(1.0, 1.0, 1.0);
    let options = SimulationOptions { step: 1.0 / 960.0, gravity, ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let above = simulation.insert(&spec(&cube, BodyKind::Fixed, DVec3::ZERO)).expect("a body");
    let at = DVec3::new(0.0, 0.0, height);
    let below = simulation.insert(&spec(&cube, BodyKind::Dynamic, at)).expect("a body");
    simulation.join(above, below, Pose::IDENTITY, Pose::IDENTITY, joint, false);
    (simulation, below)
}

#[test]
fn a_rope_is_slack_until_it_is_taut() {
    let gravity = DVec3::new(0.0, 0.0, -10.0);
    let (mut simulation, cube) = hung(&JointSpec::Rope { length: 3.0 }, -2.0, gravity);
    for _ in 0..192 {
        simulation.step();
    }
    // 0.2 s of free fall: ½ · 10 · 0.04.
    let slack = simulation.pose(cube).translation.z;
    assert!((slack + 2.2).abs() < 5e-3, "fell to {slack}");
    let mut lowest = 0.0f64;
    for _ in 0..1920 {
        simulation.step();
        lowest = lowest.min(simulation.pose(cube).translation.z);
    }
    let rest = simulation.pose(cube).translation.z;
    assert!((rest + 3.0).abs() < 1e-2 && lowest > -3.05, "hangs at {rest}, was at {lowest}");
}

#[test]
fn a_spring_yields_by_the_weight_over_its_stiffness() {
    let gravity = DVec3::new(0.0, 0.0, -10.0);
    let spring = JointSpec::Spring { length: 2.0, stiffness: 40.0, damping: 12.0 };
    let (mut simulation, cube) = hung(&spring, -2.0, gravity);
    for _ in 0..4800 {
        simulation.step();
    }
    let rest = simulation.pose(cube).translation.z;
    assert!((rest + 2.25).abs() < 1e-3, "hangs at {rest}");
}

#[test]
fn the_energy_of_a_spring_counts() {
    let spring = JointSpec::Spring { length: 2.0, stiffness: 40.0, damping: 0.0 };
    let (mut simulation, _) = hung(&spring, -2.5, DVec3::ZERO);
    let start = simulation.energy();
    assert!((start.potential - 0.5 * 40.0 * 0.25).abs() < 1e-5, "{start:?}");
    let mut fastest = 0.0f64;
    for _ in 0..480 {
        simulation.step();
        let energy = simulation.energy();
        fastest = fastest.max(energy.kinetic);
        let gained = energy.total() / start.total() - 1.0;
        assert!((-0.1..0.02).contains(&gained), "{energy:?}: {gained}");
    }
    assert!(fastest > 0.9 * start.total(), "{fastest} of {start:?}");
}

#[test]
fn a_body_in_free_fall_keeps_its_energy() {
    let l = model(LPrism::default());
    let options = SimulationOptions { step: 1.0 / 1000.0, ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let falling = BodySpec {
        linear_velocity: DVec3::new(1.0, 2.0, 3.0),
        angular_velocity: DVec3::new(0.0, 0.0, 4.0), // a principal axis
        mass: MassSource::Density(2.0),
        ..spec(&l, BodyKind::Dynamic, DVec3::new(0.0, 0.0, 20.0))
    };
    let body = simulation.insert(&falling).expect("a body");
    let mass = 2.0 * 0.51 * 0.5;
    assert!((simulation.mass(body) - mass).abs() < 1e-6);
    let start = simulation.energy();
    // ½mv² = 7m; rotation adds to it.
    assert!(start.kinetic > 7.0 * mass && (start.potential - 9.81 * mass * 20.0).abs() < 1e-3);
    for _ in 0..500 {
        simulation.step();
    }
    let end = simulation.energy();
    let drift = (end.total() - start.total()).abs() / start.total();
    assert!(drift < 1e-4, "{start:?} became {end:?}: {drift}");
    let z = 20.0 + 3.0 * 0.5 - 0.5 * 9.81 * 0.25;
    assert!((simulation.pose(body).translation.z - z).abs() < 1e-2, "the fall of Galilei");
}

#[test]
fn two_runs_are_the_same_to_the_bit() {
    let bodies = [model(Torus::default()), model(LPrism::default()), cuboid(0.7, 0.6, 0.5)];
    let floor = cuboid(10.0, 10.0, 1.0);
    let run = || {
        let mut simulation = Simulation::new(SimulationOptions::default());
        simulation
            .insert(&spec(&floor, BodyKind::Fixed, DVec3::new(0.0, 0.0, -0.5)))
            .expect("floor");
        for k in 0..6 {
            let rotation = DQuat::from_xyzw(0.3, 0.1 * f64::from(k), -0.4, 1.0).normalize();
            let translation = DVec3::new(0.1 * f64::from(k % 3), 0.0, 1.0 + 0.7 * f64::from(k));
            let body = spec(&bodies[k as usize % 3], BodyKind::Dynamic, translation);
            let pose = Pose { rotation, translation };
            simulation.insert(&BodySpec { pose, ..body }).expect("a body");
        }
        for _ in 0..90 {
            simulation.step();
        }
        (0..7).map(|k| simulation.pose(BodyIndex(k)).bits()).collect::<Vec<_>>()
    };
    assert_eq!(run(), run());
}

#[test]
fn a_kinematic_body_carries() {
    let (slab, cube) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0));
    let mut simulation = Simulation::new(SimulationOptions::default());
    let belt = BodySpec {
        linear_velocity: DVec3::X * 0.5,
        ..spec(&slab, BodyKind::Kinematic, DVec3::ZERO)
    };
    let belt = simulation.insert(&belt).expect("a body");
    let at = DVec3::new(0.0, 0.0, 1.001);
    let rider = simulation.insert(&spec(&cube, BodyKind::Dynamic, at)).expect("a body");
    for _ in 0..120 {
        simulation.step();
    }
    let (belt, rider) = (simulation.pose(belt).translation, simulation.pose(rider));
    assert!((belt - DVec3::X).length() < 1e-4, "the belt is at {belt}");
    // It slides for 0.1 s until friction has it: 0.025 behind.
    assert!((rider.translation - DVec3::new(0.975, 0.0, 1.0)).length() < 2e-2, "{rider:?}");
    assert_eq!(simulation.mass(BodyIndex(0)), 0.0);
}

#[test]
fn every_detector_holds_a_cube_on_a_slab() {
    let (slab, cube) = (cuboid(4.0, 4.0, 1.0), cuboid(1.0, 1.0, 1.0));
    for detector in Detector::ALL {
        let options = SimulationOptions { detector, ..SimulationOptions::default() };
        let mut simulation = Simulation::new(options);
        simulation.insert(&spec(&slab, BodyKind::Fixed, DVec3::ZERO)).expect("a body");
        let at = DVec3::new(0.0, 0.0, 1.05);
        let body = simulation.insert(&spec(&cube, BodyKind::Dynamic, at)).expect("a body");
        for _ in 0..120 {
            simulation.step();
        }
        let z = simulation.pose(body).translation.z;
        assert!((z - 1.0).abs() < 1e-2, "{detector}: at {z}");
        assert_eq!(simulation.mass(body), 1.0, "{detector}");
        assert!(simulation.solver_contacts() > 0, "{detector}");
        assert!(simulation.narrow_phase_seconds() > 0.0, "{detector}");
        assert_eq!(simulation.contact_pairs().is_empty(), detector != Detector::Cranny);
    }
}

/// An open, flat sheet bounds no volume: every detector takes it or says why not.
#[test]
fn an_open_sheet_makes_no_detector_panic() {
    let (open, cube) = (sheet(2.0), cuboid(1.0, 1.0, 1.0));
    for detector in Detector::ALL {
        let options = SimulationOptions { detector, ..SimulationOptions::default() };
        let mut simulation = Simulation::new(options);
        match simulation.insert(&spec(&open, BodyKind::Fixed, DVec3::ZERO)) {
            Ok(_) => {}
            Err(SimulationError::Shape(_)) if detector != Detector::Cranny => continue,
            Err(error) => panic!("{detector}: {error}"),
        }
        let at = DVec3::new(0.0, 0.0, 0.55);
        let body = simulation.insert(&spec(&cube, BodyKind::Dynamic, at)).expect("a body");
        for _ in 0..60 {
            simulation.step();
        }
        assert!(simulation.pose(body).translation.is_finite(), "{detector}");
    }
}

#[test]
fn numbers_that_are_none_are_refused() {
    let cube = cuboid(1.0, 1.0, 1.0);
    let good = || spec(&cube, BodyKind::Dynamic, DVec3::ZERO);
    let nan = DVec3::new(0.0, f64::NAN, 0.0);
    let mut simulation = Simulation::new(SimulationOptions::default());
    for bad in [
        BodySpec { pose: Pose::at(nan), ..good() },
        BodySpec {
            pose: Pose { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0), translation: DVec3::ZERO },
            ..good()
        },
        BodySpec { linear_velocity: nan, ..good() },
        BodySpec { angular_velocity: DVec3::splat(f64::INFINITY), ..good() },
        BodySpec { mass: MassSource::Density(f64::NAN), ..good() },
        BodySpec { friction: f64::NAN, ..good() },
        BodySpec { friction: -0.5, ..good() },
        BodySpec { restitution: f64::NEG_INFINITY, ..good() },
    ] {
        let refused = simulation.insert(&bad);
        let numbers = (bad.pose, bad.linear_velocity, bad.angular_velocity);
        assert!(refused.is_err(), "accepted {numbers:?} {:?}", bad.mass);
    }
    assert!(simulation.is_empty());
    assert_eq!(simulation.insert(&good()).expect("a body"), BodyIndex(0));
}

#[test]
fn a_body_may_be_moved_and_pushed() {
    let cube = cuboid(1.0, 1.0, 1.0);
    let options = SimulationOptions { gravity: DVec3::ZERO, ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let body = simulation.insert(&spec(&cube, BodyKind::Dynamic, DVec3::ZERO)).expect("a body");
    simulation.set_pose(body, Pose::at(DVec3::new(1.0, 2.0, 3.0)));
    simulation.set_velocity(body, DVec3::X, DVec3::Z);
    for _ in 0..60 {
        simulation.step();
    }
    let (linear, angular) = simulation.velocity(body);
    assert!((linear - DVec3::X).length() < 1e-5, "{linear}");
    assert!((angular - DVec3::Z).length() < 1e-3, "{angular}");
    let at = simulation.pose(body).translation;
    assert!((at - DVec3::new(2.0, 2.0, 3.0)).length() < 1e-4, "{at}");
}

/// A cube's weight presses it as deep into a block that moves as into one that is fixed, but for
/// how much of the block's mass moves with it.
#[test]
fn what_rests_sinks_into_a_moving_body_as_into_a_fixed_one() {
    let models = [cuboid(4.0, 4.0, 1.0), cuboid(2.0, 2.0, 1.0), cuboid(1.0, 1.0, 1.0)];
    let sunk = |block: BodyKind| {
        let mut simulation = Simulation::new(SimulationOptions::default());
        for (k, kind) in [BodyKind::Fixed, block, BodyKind::Dynamic].into_iter().enumerate() {
            simulation.insert(&spec(&models[k], kind, DVec3::Z * k as f64)).expect("a body");
        }
        (0..120).for_each(|_| simulation.step());
        let [block, cube] = [1, 2].map(|k| simulation.pose(BodyIndex(k)).translation.z);
        1.0 - (cube - block)
    };
    let [fixed, moving] = [BodyKind::Fixed, BodyKind::Dynamic].map(sunk);
    assert!(fixed > 1e-5, "{fixed}");
    assert!(moving > 0.5 * fixed && moving < 2.0 * fixed, "{moving}, {fixed}");
}
