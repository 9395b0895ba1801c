//! Joints in reduced coordinates and their motors: an arm of six links, two fingers that follow.

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, JointIndex, JointSpec, MassSource, Motor, Resistance,
    Simulation, SimulationOptions, StatedMass,
};

use crate::world::{cuboid, sheet, spec};

/// Lengths of the links and their masses: those of a UR5, nearly.
const LINKS: [(f64, f64); 6] =
    [(0.09, 3.7), (0.43, 8.4), (0.39, 2.3), (0.09, 1.2), (0.09, 1.2), (0.08, 0.2)];

const AXES: [DVec3; 6] = [DVec3::Z, DVec3::Y, DVec3::Y, DVec3::Y, DVec3::Z, DVec3::Y];

fn at(x: f64) -> Pose {
    Pose::at(DVec3::new(x, 0.0, 0.0))
}

fn hinge(axis: DVec3, motor: Option<Motor>) -> JointSpec {
    JointSpec::Revolute { axis, limits: None, motor }
}

/// An arm that is stretched out level: its weight pulls at every hinge about y.
fn arm(
    reduced: bool,
    motor: impl Fn(usize) -> Option<Motor>,
) -> (Simulation, Vec<JointIndex>, Vec<BodyIndex>) {
    let mut simulation =
        Simulation::new(SimulationOptions { step: 1.0 / 240.0, ..Default::default() });
    let base = cuboid(0.1, 0.1, 0.1);
    let mut parent = simulation.insert(&spec(&base, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let (mut joints, mut bodies) = (Vec::new(), vec![parent]);
    let (mut x, mut length) = (0.0, 0.0);
    for (i, (next, mass)) in LINKS.into_iter().enumerate() {
        let link = cuboid(0.9 * next, 0.04, 0.04);
        let density = mass / (0.9 * next * 0.04 * 0.04);
        let place = DVec3::new(x + 0.5 * length + 0.5 * next, 0.0, 0.0);
        let body = BodySpec {
            mass: MassSource::Density(density),
            groups: 2 << i,
            ..spec(&link, BodyKind::Dynamic, place)
        };
        let child = simulation.insert(&body).unwrap();
        let anchors = [at(0.5 * length), at(-0.5 * next)];
        let joint = hinge(AXES[i], motor(i));
        joints.push(if reduced {
            simulation.join_reduced([parent, child], anchors, &joint, Resistance::default(), 0.0)
        } else {
            simulation.join(parent, child, anchors[0], anchors[1], &joint, false)
        });
        (x, length, parent) = (place.x, next, child);
        bodies.push(child);
    }
    (simulation, joints, bodies)
}

fn steps(simulation: &mut Simulation, count: usize) {
    (0..count).for_each(|_| simulation.step());
}

fn position(simulation: &Simulation, joint: JointIndex) -> f64 {
    simulation.joint_position(joint).expect("a joint in reduced coordinates")
}

#[test]
fn an_arm_keeps_its_pose_for_ten_seconds() {
    let (mut simulation, joints, bodies) = arm(true, |_| Some(Motor::at(0.0)));
    let end = simulation.pose(bodies[6]).translation;
    let mut worst = 0.0f64;
    for _ in 0..2400 {
        simulation.step();
        let off = joints.iter().map(|&joint| position(&simulation, joint).abs());
        worst = off.fold(worst, f64::max);
    }
    assert!(worst < 1e-3, "a joint gave way by {worst}");
    let sunk = simulation.pose(bodies[6]).translation.distance(end);
    assert!(sunk < 1e-3, "the end sank by {sunk}");
}

/// Why a robot's joints are coordinates: motors as constraints of two bodies ignore what hangs on
/// them.
#[test]
fn the_same_arm_of_impulses_sinks() {
    let (mut simulation, _, bodies) = arm(false, |_| Some(Motor::at(0.0)));
    let end = simulation.pose(bodies[6]).translation;
    steps(&mut simulation, 480);
    let sunk = simulation.pose(bodies[6]).translation.distance(end);
    assert!(sunk > 0.1, "the end sank by {sunk}");
}

#[test]
fn an_effort_that_is_too_small_lets_the_arm_down() {
    // The second hinge carries about 43 newton metres.
    for (most, holds) in [(80.0, true), (20.0, false)] {
        let motor = Motor { max_effort: Some(most), ..Motor::at(0.0) };
        let (mut simulation, joints, _) = arm(true, |_| Some(motor));
        steps(&mut simulation, 120);
        let at = position(&simulation, joints[1]);
        assert_eq!(at.abs() < 1e-3, holds, "{most} N m: {at}");
    }
}

#[test]
fn motors_reach_their_targets_no_faster_than_they_may() {
    let motor = Motor { max_velocity: Some(0.5), ..Motor::at(0.4) };
    let (mut simulation, joints, _) =
        arm(true, |i| Some(if i == 2 { motor } else { Motor::at(0.0) }));
    let mut fastest = 0.0f64;
    let mut before = 0.0;
    for _ in 0..480 {
        simulation.step();
        let now = position(&simulation, joints[2]);
        fastest = fastest.max((now - before) * 240.0);
        before = now;
    }
    assert!((before - 0.4).abs() < 1e-3, "came to {before}");
    assert!(fastest < 0.52 && fastest > 0.4, "{fastest} radians a second");
    // Sent elsewhere without being joined anew.
    assert!(simulation.set_motor(joints[2], Some(Motor::at(-0.2)), Resistance::default()));
    steps(&mut simulation, 240);
    let at = position(&simulation, joints[2]);
    assert!((at + 0.2).abs() < 1e-3, "came to {at}");
}

/// A hinge about z: no weight acts about it.
fn spindle(motor: Option<Motor>, resistance: Resistance, spin: f64) -> (Simulation, JointIndex) {
    let mut simulation =
        Simulation::new(SimulationOptions { step: 1.0 / 240.0, ..Default::default() });
    let (post, bar) = (cuboid(0.1, 0.1, 0.1), cuboid(1.0, 0.1, 0.1));
    let post = simulation.insert(&spec(&post, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    let up = DVec3::new(0.0, 0.0, 0.3);
    let inertia = DMat3::from_diagonal(DVec3::new(0.1, 2.0, 2.0));
    let mass = MassSource::Stated(StatedMass { mass: 3.0, center: DVec3::ZERO, inertia });
    let bar = BodySpec { mass, ..spec(&bar, BodyKind::Dynamic, up) };
    let bar = simulation.insert(&bar).unwrap();
    let anchors = [Pose::at(up), Pose::IDENTITY];
    let joint = hinge(DVec3::Z, motor);
    let joint = simulation.join_reduced([post, bar], anchors, &joint, resistance, 0.0);
    simulation.apply_impulse(bar, DVec3::ZERO, DVec3::new(0.0, 0.0, 2.0 * spin));
    (simulation, joint)
}

#[test]
fn an_effort_turns_the_inertia_that_is_stated() {
    let motor = Motor { effort: 4.0, ..Motor::default() };
    let (mut simulation, joint) = spindle(Some(motor), Resistance::default(), 0.0);
    steps(&mut simulation, 240);
    // ½ · 4/2 · 1².
    let at = position(&simulation, joint);
    assert!((at - 1.0).abs() < 0.01, "turned by {at}");
}

#[test]
fn a_velocity_is_kept() {
    let motor = Motor { velocity: 2.0, ..Motor::default() };
    let (mut simulation, joint) = spindle(Some(motor), Resistance::default(), 0.0);
    steps(&mut simulation, 720);
    let at = position(&simulation, joint);
    assert!((at - 6.0).abs() < 0.02, "turned by {at}");
}

#[test]
fn damping_and_friction_stop_what_turns() {
    // q = v₀ I/d for damping, v₀² I/(2 f) for friction, v₀ t without either.
    let rests = [
        (Resistance { damping: 4.0, friction: 0.0 }, 2.0),
        (Resistance { damping: 0.0, friction: 4.0 }, 4.0),
        (Resistance::default(), 16.0),
    ];
    for (resistance, expected) in rests {
        let (mut simulation, joint) = spindle(None, resistance, 4.0);
        steps(&mut simulation, 960);
        let at = position(&simulation, joint);
        assert!((at - expected).abs() < 0.02 * expected, "{resistance:?}: turned by {at}");
    }
}

#[test]
fn a_follower_keeps_its_ratio() {
    let (mut simulation, joints, _) = arm(true, |i| (i != 3).then(|| Motor::at(0.0)));
    assert!(simulation.couple(joints[3], joints[2], -2.0, 0.1));
    assert!(!simulation.couple(joints[3], joints[3], 1.0, 0.0));
    simulation.set_motor(joints[2], Some(Motor::at(0.3)), Resistance::default());
    steps(&mut simulation, 480);
    let (leader, follower) = (position(&simulation, joints[2]), position(&simulation, joints[3]));
    assert!((leader - 0.3).abs() < 2e-3, "the leader is at {leader}");
    assert!((follower - (0.1 - 2.0 * leader)).abs() < 2e-3, "the follower is at {follower}");
}

#[test]
fn what_follows_a_follower_is_driven_too() {
    let (mut simulation, joints, _) = arm(true, |i| (i != 3 && i != 4).then(|| Motor::at(0.0)));
    assert!(simulation.couple(joints[3], joints[2], 1.0, 0.0));
    assert!(simulation.couple(joints[4], joints[3], -1.0, 0.0));
    simulation.set_motor(joints[2], Some(Motor::at(0.2)), Resistance::default());
    steps(&mut simulation, 480);
    for (joint, expected) in [(2, 0.2), (3, 0.2), (4, -0.2)] {
        let at = position(&simulation, joints[joint]);
        assert!((at - expected).abs() < 1e-4, "joint {joint} is at {at}");
    }
}

#[test]
fn an_arm_comes_apart_where_a_joint_or_a_body_is_taken_out() {
    let (mut simulation, joints, bodies) = arm(true, |_| Some(Motor::at(0.0)));
    steps(&mut simulation, 10);
    simulation.part(joints[3]);
    simulation.part(joints[3]);
    assert_eq!(simulation.joint_position(joints[3]), None);
    steps(&mut simulation, 120);
    let height = |simulation: &Simulation, body: usize| simulation.pose(bodies[body]).translation.z;
    assert!(height(&simulation, 4) < -0.5 && height(&simulation, 3).abs() < 1e-3);
    simulation.remove(bodies[2]);
    assert_eq!(simulation.joint_position(joints[1]), None);
    assert_eq!(simulation.joint_position(joints[2]), None);
    steps(&mut simulation, 120);
    assert!(height(&simulation, 3) < -0.5 && height(&simulation, 1).abs() < 1e-3);
}

#[test]
fn a_link_that_stops_moving_holds_what_hangs_on_it() {
    let (mut simulation, _, bodies) = arm(true, |_| Some(Motor::at(0.0)));
    steps(&mut simulation, 10);
    let link = cuboid(0.9 * 0.39, 0.04, 0.04);
    simulation.set_kind(bodies[3], BodyKind::Fixed, &link, 1.0).unwrap();
    steps(&mut simulation, 240);
    let at = simulation.pose(bodies[6]).translation;
    assert!(at.z.abs() < 1e-2, "the end is at {at}");
}

#[test]
fn a_stated_mass_needs_no_solid() {
    let mut simulation =
        Simulation::new(SimulationOptions { step: 1.0 / 240.0, ..Default::default() });
    let open = sheet(1.0);
    let mass = |mass: f64, moment: f64| {
        let (center, inertia) =
            (DVec3::new(0.0, 0.0, 0.2), DMat3::from_diagonal(DVec3::splat(moment)));
        MassSource::Stated(StatedMass { mass, center, inertia })
    };
    let body = |mass| BodySpec { mass, ..spec(&open, BodyKind::Dynamic, DVec3::ZERO) };
    assert!(simulation.insert(&body(MassSource::Density(1.0))).is_err());
    for (m, moment) in [(0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, -1.0), (1.0, f64::NAN)] {
        assert!(simulation.insert(&body(mass(m, moment))).is_err(), "{m} {moment}");
    }
    let index = simulation.insert(&body(mass(3.0, 0.5))).unwrap();
    assert!((simulation.mass(index) - 3.0).abs() < 1e-6);
    steps(&mut simulation, 240);
    assert!((simulation.pose(index).translation.z + 0.5 * 9.81).abs() < 0.05);
}

#[test]
fn a_slow_motor_does_not_fall_asleep() {
    let motor = Motor { velocity: 0.1, ..Motor::default() };
    let (mut simulation, joint) = spindle(Some(motor), Resistance::default(), 0.0);
    steps(&mut simulation, 2400);
    let at = position(&simulation, joint);
    assert!((at - 1.0).abs() < 0.01, "turned by {at}");
}

#[test]
fn what_followed_a_joint_that_is_gone_has_its_own_motor_again() {
    let (mut simulation, joints, _) =
        arm(true, |i| Some(Motor::at(if i == 2 { 0.4 } else { 0.0 })));
    assert!(simulation.couple(joints[2], joints[5], 1.0, 0.1));
    steps(&mut simulation, 480);
    let following = position(&simulation, joints[2]);
    assert!((following - 0.1).abs() < 2e-3, "it follows, at {following}");
    simulation.part(joints[5]);
    steps(&mut simulation, 480);
    let own = position(&simulation, joints[2]);
    assert!((own - 0.4).abs() < 2e-3, "its own motor holds it, at {own}");
}
