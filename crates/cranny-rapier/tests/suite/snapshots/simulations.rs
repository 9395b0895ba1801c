//! [`Simulation`]s, with what they keep beside rapier's world.

use std::f64::consts::TAU;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Fields, Region, RegionId};
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, Detector, JointSpec, Motor, Resistance, Simulation,
    SimulationOptions, SnapshotError,
};
use cranny_shapes::{IsoBolt, IsoNut};

use crate::world::{cuboid, model, spec};

fn bits(v: DVec3) -> [u64; 3] {
    v.to_array().map(f64::to_bits)
}

/// All poses and velocities, to the bit.
fn state(simulation: &Simulation) -> Vec<([u64; 4], [[u64; 3]; 3])> {
    let of = |body| {
        let pose = simulation.pose(body);
        let (linear, angular) = simulation.velocity(body);
        let rotation = pose.rotation.to_array().map(f64::to_bits);
        (rotation, [pose.translation, linear, angular].map(bits))
    };
    simulation.indices().map(of).collect()
}

/// What is reported of all pairs, written out; but for the names of regions, which are history and
/// begin anew.
fn found(simulation: &Simulation) -> String {
    let pairs = simulation.contact_pairs();
    let found = pairs.iter().map(|pair| {
        let nameless =
            |r: &Region| Region { id: RegionId::default(), from: Vec::new(), ..r.clone() };
        let regions: Vec<Region> = pair.answer.regions.iter().map(nameless).collect();
        let answer = (&pair.answer.contacts, regions, pair.answer.distance);
        format!("{:?} {:?} {answer:?} {:?} {}", pair.a, pair.b, pair.poses, pair.fresh)
    });
    found.collect::<Vec<_>>().join("\n")
}

#[track_caller]
fn goes_on(
    make: impl Fn() -> Simulation,
    models: &[Model],
    [before, after]: [usize; 2],
    also: impl Fn(&mut Simulation),
) -> [Simulation; 2] {
    let (mut unwritten, mut written) = (make(), make());
    for simulation in [&mut unwritten, &mut written] {
        (0..before).for_each(|_| simulation.step());
    }
    let bytes = written.snapshot().expect("between two steps");
    let mut restored = Simulation::restore(&bytes, models).expect("just written");
    assert_eq!(state(&restored), state(&unwritten));
    assert_eq!(found(&restored), found(&unwritten), "what the last step said");
    also(&mut unwritten);
    also(&mut restored);
    for step in 0..after {
        unwritten.step();
        restored.step();
        assert_eq!(state(&restored), state(&unwritten), "step {step} after it was read");
        assert_eq!(found(&restored), found(&unwritten), "step {step} after it was read");
        assert_eq!(restored.prediction_distance(), unwritten.prediction_distance());
    }
    [unwritten, restored]
}

fn nut_on_bolt() -> (Simulation, Vec<Model>) {
    let models = vec![
        model(IsoBolt { segments: 48, ..IsoBolt::default() }),
        model(IsoNut { segments: 48, ..IsoNut::default() }),
    ];
    let mut simulation = Simulation::new(SimulationOptions {
        step: 1.0 / 240.0,
        length_unit: 3.0,
        ..SimulationOptions::default()
    });
    simulation.insert(&spec(&models[0], BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let mut nut = spec(&models[1], BodyKind::Dynamic, DVec3::new(0.0, 0.0, 20.0));
    (nut.friction, nut.angular_velocity) = (0.1, DVec3::new(0.0, 0.0, TAU));
    simulation.insert(&nut).unwrap();
    (simulation, models)
}

#[test]
fn a_nut_on_its_bolt() {
    let (_, models) = nut_on_bolt();
    let nuts = goes_on(|| nut_on_bolt().0, &models, [30, 40], |_| ());
    let [one, other] = nuts.each_ref().map(|nut| nut.snapshot().expect("between two steps"));
    assert!(one == other, "written the same again");
    assert!(nuts[1].contact_pairs().iter().any(|pair| !pair.answer.contacts.is_empty()));
}

fn pile(detector: Detector) -> (Simulation, Vec<Model>) {
    let models = vec![cuboid(8.0, 8.0, 1.0), cuboid(0.6, 0.8, 0.5), cuboid(0.3, 0.3, 2.0)];
    let mut simulation =
        Simulation::new(SimulationOptions { detector, ..SimulationOptions::default() });
    let mut add = |k: usize, kind, x: f64, z: f64| {
        simulation.insert(&spec(&models[k], kind, DVec3::new(x, 0.0, z))).unwrap()
    };
    add(0, BodyKind::Fixed, 0.0, 0.0);
    for k in 0..3 {
        add(1, BodyKind::Dynamic, 0.03 * f64::from(k), 0.8 + 0.56 * f64::from(k));
    }
    let (post, arm) = (add(2, BodyKind::Fixed, 2.0, 1.5), add(1, BodyKind::Dynamic, 2.6, 2.0));
    let passer = add(2, BodyKind::Dynamic, 0.0, 9.0);
    let at = |x: f64, z: f64| Pose::at(DVec3::new(x, 0.0, z));
    let hinge = JointSpec::Revolute { axis: DVec3::Y, limits: None, motor: None };
    simulation.join(post, arm, at(0.2, 0.5), at(-0.4, 0.0), &hinge, false);
    let all: Vec<BodyIndex> = simulation.indices().collect();
    for body in all {
        let group = if body == BodyIndex(1) { 0b10 } else { 0b01 };
        simulation.set_groups(body, group, if body == passer { !0b10 } else { u32::MAX });
    }
    (simulation, models)
}

#[test]
fn a_pile_a_hinge_and_a_pair_that_is_left_out() {
    for detector in Detector::ALL {
        let (_, models) = pile(detector);
        goes_on(|| pile(detector).0, &models, [50, 70], |_| ());
    }
}

/// Motors, couplings and positions of joints that are coordinates go on.
#[test]
fn an_arm_that_is_driven() {
    let models = vec![cuboid(0.4, 0.1, 0.1)];
    let arm = || {
        let step = 1.0 / 240.0;
        let mut simulation = Simulation::new(SimulationOptions { step, ..Default::default() });
        let mut bodies = Vec::new();
        for i in 0..4 {
            let kind = if i == 0 { BodyKind::Fixed } else { BodyKind::Dynamic };
            let place = DVec3::new(0.5 * f64::from(i), 0.0, 0.0);
            bodies.push(simulation.insert(&spec(&models[0], kind, place)).unwrap());
        }
        let end = |side: f64| Pose::at(DVec3::new(0.25 * side, 0.0, 0.0));
        let mut joints = Vec::new();
        for (i, ends) in bodies.windows(2).enumerate() {
            let motor = (i < 2).then(|| Motor::at(0.5 * i as f64));
            let hinge = JointSpec::Revolute { axis: DVec3::Y, limits: None, motor };
            let resistance = Resistance { damping: 0.1, friction: 0.01 };
            let ends = [ends[0], ends[1]];
            joints.push(simulation.join_reduced(
                ends,
                [end(1.0), end(-1.0)],
                &hinge,
                resistance,
                0.0,
            ));
        }
        assert!(simulation.couple(joints[2], joints[1], -1.0, 0.0));
        simulation
    };
    goes_on(arm, &models, [20, 60], |_| ());
}

/// Numbers of bodies that left stay free, and are given again in the same order.
#[test]
fn a_pile_that_bodies_have_left() {
    let (_, models) = pile(Detector::Cranny);
    let thinned = || {
        let mut simulation = pile(Detector::Cranny).0;
        (0..20).for_each(|_| simulation.step());
        [4, 2].into_iter().for_each(|index| simulation.remove(BodyIndex(index)));
        simulation
    };
    let also = |simulation: &mut Simulation| {
        let falling = spec(&models[1], BodyKind::Dynamic, DVec3::new(0.0, 0.0, 3.0));
        let numbers = [0, 1].map(|_| simulation.insert(&falling).unwrap());
        assert_eq!(numbers, [BodyIndex(2), BodyIndex(4)]);
        simulation.step();
    };
    goes_on(thinned, &models, [30, 40], also);
}

/// Written while contacts are carried on: they go on being carried on, from the same search.
#[test]
fn what_is_carried_on_goes_on_being_so() {
    let (_, models) = pile(Detector::Cranny);
    for before in 20..24 {
        let counts = std::cell::Cell::new(0);
        let count = |simulation: &mut Simulation| {
            counts.set(counts.get() + simulation.pair_counts().carried);
        };
        let mut unread = pile(Detector::Cranny).0;
        (0..before).for_each(|_| unread.step());
        count(&mut unread);
        assert!(counts.get() > 0, "nothing was carried on in step {before}");
        goes_on(|| pile(Detector::Cranny).0, &models, [before, 30], |_| ());
    }
}

/// Written while a body is led out of another along a way that was found steps before.
#[test]
fn who_is_led_out_goes_on_along_the_same_way() {
    let models = [cuboid(4.0, 4.0, 1.0), cuboid(1.0, 0.7, 0.3)];
    let make = || {
        let mut simulation = Simulation::new(SimulationOptions::default());
        simulation.insert(&spec(&models[0], BodyKind::Fixed, DVec3::ZERO)).unwrap();
        let plate = spec(&models[1], BodyKind::Dynamic, DVec3::Z * 0.45);
        let rotation = DQuat::from_rotation_x(0.1) * DQuat::from_rotation_z(0.2);
        simulation.insert(&BodySpec { pose: Pose { rotation, ..plate.pose }, ..plate }).unwrap();
        simulation
    };
    let mut carried = 0;
    for before in 1..8 {
        let mut unread = make();
        (0..before).for_each(|_| unread.step());
        carried += unread.pair_counts().carried;
        goes_on(make, &models, [before, 60], |_| ());
    }
    assert!(carried > 0, "each step was searched for");
}

/// In as many parts as before: the setting and the thicknesses are written.
#[test]
fn steps_in_parts() {
    let models = [cuboid(4.0, 4.0, 1.0), cuboid(0.5, 0.5, 0.05)];
    let make = || {
        let options = SimulationOptions { most_parts: 3, ..SimulationOptions::default() };
        let mut simulation = Simulation::new(options);
        simulation.insert(&spec(&models[0], BodyKind::Fixed, DVec3::ZERO)).unwrap();
        for k in 0..3 {
            let at = DVec3::new(0.2 * f64::from(k), 0.0, 1.0 + 0.4 * f64::from(k));
            let plate = spec(&models[1], BodyKind::Dynamic, at);
            let plate = BodySpec { angular_velocity: DVec3::new(0.0, 9.0, 1.0), ..plate };
            simulation.insert(&plate).unwrap();
        }
        simulation
    };
    let [mut one, mut other] = goes_on(make, &models, [5, 30], |_| ());
    let push = |simulation: &mut Simulation| {
        simulation.set_velocity(BodyIndex(3), DVec3::Z * -20.0, DVec3::X * 20.0);
        simulation.step();
        simulation.parts()
    };
    assert_eq!([push(&mut one), push(&mut other)], [3, 3]);
}

/// What a reader reads is computed again for the reader that is given anew.
#[test]
fn readers_read_on() {
    let (_, models) = pile(Detector::Cranny);
    let reader = |_, _| Fields::regions(0.5);
    let make = || {
        let (simulation, _) = pile(Detector::Cranny);
        simulation.read_by(reader);
        simulation
    };
    goes_on(make, &models, [50, 20], |simulation| simulation.read_by(reader));
}

#[test]
fn who_sleeps_is_told_of_as_before() {
    let (_, models) = pile(Detector::Cranny);
    let make = || {
        let (mut simulation, _) = pile(Detector::Cranny);
        (0..400).for_each(|_| simulation.step());
        simulation
    };
    let [_, rested] = goes_on(make, &models, [0, 30], |_| ());
    let pairs = rested.contact_pairs();
    assert!(pairs.iter().any(|pair| !pair.fresh && !pair.answer.contacts.is_empty()));
}

#[test]
fn bodies_that_were_pushed_and_put_elsewhere_before_the_next_step() {
    let (_, models) = pile(Detector::Cranny);
    let make = || {
        let (mut simulation, _) = pile(Detector::Cranny);
        (0..40).for_each(|_| simulation.step());
        simulation.set_pose(BodyIndex(3), Pose::at(DVec3::new(1.0, 1.0, 2.0)));
        simulation.set_velocity(BodyIndex(2), DVec3::new(0.5, 0.0, 1.0), DVec3::Z);
        simulation
    };
    goes_on(make, &models, [0, 60], |_| ());
}

#[test]
fn between_steps_only() {
    let (mut simulation, models) = pile(Detector::Cranny);
    let written = |simulation: &Simulation| simulation.snapshot();
    assert!(matches!(written(&simulation), Err(SnapshotError::UnsettledJoint)));
    simulation.step();
    assert!(written(&simulation).is_ok());
    simulation.insert(&spec(&models[1], BodyKind::Dynamic, DVec3::new(0.0, 3.0, 5.0))).unwrap();
    let refused = written(&simulation);
    assert!(matches!(refused, Err(SnapshotError::Unsettled { changed: 1 })), "{refused:?}");
}
