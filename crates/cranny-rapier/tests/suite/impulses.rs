//! What contacts gave bodies in a step of one part or several.

use cranny_exact::DVec3;
use cranny_rapier::{BodyIndex, BodyKind, BodySpec, Simulation, SimulationOptions};

use crate::world::{cuboid, spec};

const G: f64 = 9.81;
const STEP: f64 = 1.0 / 60.0;

fn up(z: f64) -> DVec3 {
    DVec3::new(0.0, 0.0, z)
}

/// A unit cube of mass 1 that has come to rest on a fixed one.
fn stack() -> (Simulation, [BodyIndex; 2]) {
    let cube = cuboid(1.0, 1.0, 1.0);
    let mut simulation = Simulation::new(SimulationOptions { step: STEP, ..Default::default() });
    let lower = simulation.insert(&spec(&cube, BodyKind::Fixed, up(0.0))).unwrap();
    let upper = simulation.insert(&spec(&cube, BodyKind::Dynamic, up(1.001))).unwrap();
    (0..45).for_each(|_| simulation.step());
    (simulation, [lower, upper])
}

/// Far away a plate flies at a wall. As it arrives, steps are made in two parts, each of which
/// solves the contacts anew.
#[test]
fn what_rests_gets_its_weight_in_a_step_of_two_parts_too() {
    let (mut simulation, [lower, upper]) = stack();
    let (plate, wall) = (cuboid(0.1, 1.0, 1.0), cuboid(1.0, 4.0, 4.0));
    let far = DVec3::new(0.0, 50.0, 10.0);
    simulation.insert(&spec(&wall, BodyKind::Fixed, far + 3.5 * DVec3::X)).unwrap();
    let plate =
        BodySpec { linear_velocity: 9.0 * DVec3::X, ..spec(&plate, BodyKind::Dynamic, far) };
    simulation.insert(&plate).unwrap();
    let mut in_parts = 0;
    for step in 0..25 {
        simulation.set_material(upper, 0.5, 0.0); // wakes it: what sleeps keeps its impulse
        simulation.step();
        in_parts += usize::from(simulation.parts() == 2);
        let impulse = simulation.contact_impulse(upper, lower);
        let listed = simulation.contact_impulses().find(|(pair, _)| *pair == (lower, upper));
        assert_eq!(listed, Some(((lower, upper), impulse)));
        let parts = simulation.parts();
        assert!((impulse / (G * STEP) - 1.0).abs() < 0.05, "step {step}, {parts}: {impulse}");
        let points = simulation.solved_points(upper, lower);
        let of_points: f64 = points.iter().map(|point| point.impulse).sum();
        assert!((of_points / impulse - 1.0).abs() < 1e-6, "step {step}, {parts}: {of_points}");
    }
    assert!(in_parts > 0);
}

/// Contacts are new in the step in which a body arrives.
#[test]
fn the_first_step_of_a_bounce_has_its_impulse() {
    let cube = cuboid(1.0, 1.0, 1.0);
    let mut simulation = Simulation::new(SimulationOptions { step: STEP, ..Default::default() });
    let bouncy = |spec| BodySpec { restitution: 1.0, ..spec };
    let floor = simulation.insert(&bouncy(spec(&cube, BodyKind::Fixed, up(0.0)))).unwrap();
    let ball = simulation.insert(&bouncy(spec(&cube, BodyKind::Dynamic, up(2.5)))).unwrap();
    let speed = |simulation: &Simulation| simulation.velocity(ball).0.z;
    let (mut before, mut steps) = (0.0, 0);
    while speed(&simulation) <= 0.0 {
        before = speed(&simulation);
        assert_eq!(simulation.contact_impulse(ball, floor), 0.0, "nothing met yet");
        simulation.step();
        steps += 1;
        assert!(steps < 100, "it never bounced");
    }
    // Its mass is 1; gravity took its share within the step.
    let given = speed(&simulation) - before + G * STEP;
    let impulse = simulation.contact_impulse(ball, floor);
    assert!((impulse / given - 1.0).abs() < 0.02, "{impulse} for {given}");
}

#[test]
fn the_points_that_press_give_the_impulse_together() {
    let (mut simulation, [lower, upper]) = stack();
    simulation.set_material(upper, 0.5, 0.0);
    simulation.step();
    let points = simulation.solved_points(upper, lower);
    assert_eq!(points, simulation.solved_points(lower, upper));
    assert_eq!(points.len(), 4);
    let sum: f64 = points.iter().map(|point| point.impulse).sum();
    assert!((sum / simulation.contact_impulse(lower, upper) - 1.0).abs() < 1e-6, "{points:?}");
    for solved in points {
        assert!((solved.normal - DVec3::Z).length() < 1e-3, "{solved:?}"); // from lower to higher
        let at = solved.point;
        assert!(at.x.abs() > 0.49 && at.y.abs() > 0.49 && (at.z - 0.5).abs() < 0.01, "{at}");
        assert!(solved.separation.abs() < 0.01, "{solved:?}");
    }
    simulation.remove(upper);
    let far = simulation.insert(&spec(&cuboid(1.0, 1.0, 1.0), BodyKind::Dynamic, up(9.0))).unwrap();
    assert!(simulation.solved_points(lower, far).is_empty());
}
