//! Bodies that come, change and leave between steps.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_rapier::{BodyIndex, BodyKind, JointSpec, Simulation, SimulationOptions};

use crate::world::{Apart, cuboid, spec};

fn cube(size: f64) -> Model {
    cuboid(size, size, size)
}

fn up(z: f64) -> DVec3 {
    DVec3::new(0.0, 0.0, z)
}

/// A fixed unit cube with another that rests on it.
fn stack(cube: &Model) -> (Simulation, [BodyIndex; 2]) {
    let mut simulation = Simulation::new(SimulationOptions::default());
    let lower = simulation.insert(&spec(cube, BodyKind::Fixed, up(0.0))).unwrap();
    let upper = simulation.insert(&spec(cube, BodyKind::Dynamic, up(1.01))).unwrap();
    steps(&mut simulation, 60);
    (simulation, [lower, upper])
}

fn steps(simulation: &mut Simulation, count: usize) {
    (0..count).for_each(|_| simulation.step());
}

fn height(simulation: &Simulation, body: BodyIndex) -> f64 {
    simulation.pose(body).translation.z
}

#[test]
fn what_stood_on_a_removed_body_falls() {
    let cube = cube(1.0);
    let (mut simulation, [lower, upper]) = stack(&cube);
    assert!((height(&simulation, upper) - 1.0).abs() < 0.01);
    simulation.remove(lower);
    simulation.remove(lower); // nothing happens
    assert!(!simulation.contains(lower) && simulation.contains(upper));
    steps(&mut simulation, 30);
    assert!(height(&simulation, upper) < 0.0, "{}", height(&simulation, upper));
    assert_eq!((simulation.len(), simulation.pair_count()), (1, 0));
    assert!(simulation.contact_pairs().is_empty());
}

#[test]
fn numbers_of_removed_bodies_are_given_again_and_tell_nothing_of_the_past() {
    let cube = cube(1.0);
    let (mut simulation, [lower, upper]) = stack(&cube);
    simulation.set_hooked(upper, true, false);
    simulation.remove(upper);
    let again = simulation.insert(&spec(&cube, BodyKind::Dynamic, up(1.01))).unwrap();
    assert_eq!(again, upper);
    (0..60).for_each(|_| simulation.step_with(&Apart(lower, upper)));
    assert!((height(&simulation, upper) - 1.0).abs() < 0.01, "nobody asks about the new body");
    // Far away, on a number that was near.
    simulation.remove(upper);
    let far = spec(&cube, BodyKind::Dynamic, DVec3::new(50.0, 0.0, 1.0));
    assert_eq!(simulation.insert(&far).unwrap(), upper);
    assert!(simulation.contact_pairs().is_empty());
    steps(&mut simulation, 60);
    assert!(height(&simulation, upper) < 0.0);
}

#[test]
fn a_run_with_removals_repeats_to_the_bit() {
    let (small, large) = (cube(0.5), cube(1.0));
    let run = || {
        let (mut simulation, [lower, _]) = stack(&large);
        let mut live = Vec::new();
        for i in 0..60 {
            let model = if i % 2 == 0 { &small } else { &large };
            let at = DVec3::new(0.1 * f64::from(i % 5), 0.0, 3.0);
            live.push(simulation.insert(&spec(model, BodyKind::Dynamic, at)).unwrap());
            if live.len() > 3 {
                simulation.remove(live.remove(i as usize % 3));
            }
            steps(&mut simulation, 3);
        }
        assert_eq!(simulation.len(), 5);
        simulation.remove(lower);
        let poses = live.iter().flat_map(|&body| simulation.pose(body).bits());
        poses.collect::<Vec<_>>()
    };
    assert_eq!(run(), run());
}

#[test]
fn bodies_that_rest_fall_once_they_do_not_respond_and_hold_once_they_do() {
    let cube = cube(1.0);
    let (mut simulation, [lower, upper]) = stack(&cube);
    steps(&mut simulation, 240); // asleep
    simulation.set_hooked(lower, true, false);
    simulation.reconsider(lower, upper);
    (0..20).for_each(|_| simulation.step_with(&Apart(lower, upper)));
    assert!(height(&simulation, upper) < 0.6, "{}", height(&simulation, upper));
    simulation.reconsider(upper, lower);
    simulation.set_pose(upper, Pose::at(up(1.01)));
    simulation.set_velocity(upper, DVec3::ZERO, DVec3::ZERO);
    steps(&mut simulation, 60);
    assert!((height(&simulation, upper) - 1.0).abs() < 0.01, "{}", height(&simulation, upper));
}

#[test]
fn joints_end_with_their_bodies() {
    let cube = cube(1.0);
    let mut simulation = Simulation::new(SimulationOptions::default());
    let post = simulation.insert(&spec(&cube, BodyKind::Fixed, up(5.0))).unwrap();
    let hung = simulation.insert(&spec(&cube, BodyKind::Dynamic, up(3.0))).unwrap();
    let fixed = JointSpec::Fixed;
    simulation.join(post, hung, Pose::at(up(-2.0)), Pose::IDENTITY, &fixed, false);
    steps(&mut simulation, 60);
    assert!((height(&simulation, hung) - 3.0).abs() < 1e-3);
    simulation.remove(post);
    steps(&mut simulation, 60);
    assert!(height(&simulation, hung) < 0.0);
    // And by themselves.
    let post = simulation.insert(&spec(&cube, BodyKind::Fixed, up(5.0))).unwrap();
    let other = simulation.insert(&spec(&cube, BodyKind::Dynamic, up(3.0))).unwrap();
    let joint = simulation.join(post, other, Pose::at(up(-2.0)), Pose::IDENTITY, &fixed, false);
    steps(&mut simulation, 60);
    assert!((height(&simulation, other) - 3.0).abs() < 1e-3);
    simulation.part(joint);
    simulation.part(joint);
    steps(&mut simulation, 60);
    assert!(height(&simulation, other) < 0.0);
}

#[test]
fn a_larger_shape_lifts_and_a_smaller_one_lets_down() {
    let (small, large) = (cube(0.5), cube(1.0));
    let (mut simulation, [lower, upper]) = stack(&large);
    let mass = simulation.mass(upper);
    simulation.set_shape(upper, &small, cranny_rapier::Normals::Flat, 2.0).unwrap();
    assert!((simulation.mass(upper) - 0.25).abs() < 1e-6 && (mass - 1.0).abs() < 1e-6);
    steps(&mut simulation, 60);
    assert!((height(&simulation, upper) - 0.75).abs() < 0.01);
    simulation.set_shape(lower, &small, cranny_rapier::Normals::Flat, 1.0).unwrap();
    steps(&mut simulation, 60);
    assert!((height(&simulation, upper) - 0.5).abs() < 0.01, "{}", height(&simulation, upper));
}

#[test]
fn settings_of_a_body_count_from_the_next_step() {
    let cube = cube(1.0);
    let (mut simulation, [lower, upper]) = stack(&cube);
    // Held in the air, without gravity, by a force, by its axes, by being kinematic.
    simulation.set_gravity_scale(upper, 0.0);
    simulation.set_groups(lower, 2, 2);
    steps(&mut simulation, 30);
    assert!((height(&simulation, upper) - 1.0).abs() < 0.01, "nothing pulls it down");
    simulation.set_gravity_scale(upper, 1.0);
    simulation.set_force(upper, up(9.81), DVec3::ZERO);
    steps(&mut simulation, 30);
    assert!((height(&simulation, upper) - 1.0).abs() < 0.01, "the force bears it");
    simulation.set_force(upper, DVec3::ZERO, DVec3::ZERO);
    simulation.set_locked_axes(upper, [false, false, true], [false; 3]);
    simulation.set_velocity(upper, up(1.0), DVec3::ZERO);
    steps(&mut simulation, 30);
    assert!((height(&simulation, upper) - 1.0).abs() < 0.01, "it cannot move along z");
    simulation.set_locked_axes(upper, [false; 3], [false; 3]);
    simulation.set_kind(upper, BodyKind::Kinematic, &cube, 1.0).unwrap();
    simulation.set_velocity(upper, DVec3::ZERO, DVec3::ZERO);
    steps(&mut simulation, 30);
    let held = height(&simulation, upper);
    simulation.set_kind(upper, BodyKind::Dynamic, &cube, 3.0).unwrap();
    assert!((held - 1.0).abs() < 0.01);
    simulation.apply_impulse(upper, up(30.0), DVec3::ZERO);
    simulation.step();
    assert!((simulation.mass(upper) - 3.0).abs() < 1e-6);
    assert!((simulation.velocity(upper).0.z - 10.0).abs() < 0.5);
    // Groups are mutual.
    simulation.set_groups(lower, 1, 1);
    simulation.set_groups(upper, 1, 2);
    steps(&mut simulation, 240);
    assert!(height(&simulation, upper) < 0.0, "it does not meet the first group");
}

/// A kinematic body turns about the middle of its solid, however it came to be one and to its
/// shape; an open mesh turns about its origin.
#[test]
fn a_kinematic_body_turns_about_its_centre_of_mass_however_it_came_to_be_one() {
    let off = |size: f64| {
        let cube = cube(size);
        let vertices = cube.mesh().vertices().iter().map(|&p| p + 2.0 * DVec3::X).collect();
        let mesh = Mesh::new(vertices, cube.mesh().faces().to_vec()).unwrap();
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    };
    let (small, large) = (off(0.5), off(1.0));
    let open = {
        let mesh = large.mesh();
        let mesh = Mesh::new(mesh.vertices().to_vec(), mesh.faces()[1..].to_vec()).unwrap();
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    };
    let center = |change: &dyn Fn(&mut Simulation, BodyIndex)| {
        let mut simulation = Simulation::new(SimulationOptions::default());
        let body = simulation.insert(&spec(&large, BodyKind::Fixed, DVec3::ZERO)).unwrap();
        change(&mut simulation, body);
        simulation.set_velocity(body, DVec3::ZERO, DVec3::Z);
        steps(&mut simulation, 60);
        let pose = simulation.pose(body).world_from_body();
        let middle = simulation.center_of_mass(body);
        assert!(pose.apply(middle).distance(middle) < 1e-3, "it moved about {middle}");
        assert!(pose.apply(middle + DVec3::X).distance(middle + DVec3::X) > 0.1, "it turned");
        assert_eq!(simulation.mass(body), 0.0);
        middle
    };
    let kinematic = |simulation: &mut Simulation, body| {
        simulation.set_kind(body, BodyKind::Kinematic, &large, 1.0).unwrap();
    };
    let reshaped = |model: &Model| {
        center(&|simulation: &mut Simulation, body| {
            kinematic(simulation, body);
            simulation.set_shape(body, model, cranny_rapier::Normals::Flat, 1.0).unwrap();
        })
    };
    assert!(center(&kinematic).distance(2.0 * DVec3::X) < 1e-6);
    assert!(reshaped(&small).distance(2.0 * DVec3::X) < 1e-6);
    assert!(reshaped(&open).length() < 1e-6);
}
