//! A named body that gets nowhere twice in a row is braked; that is remembered of this body alone.

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_rapier::{
    BodyIndex, BodyKind, BodySpec, Simulation, SimulationOptions, SolvedContacts, StepHooks,
};

use crate::world::{cuboid, spec};

/// The solver sees no contact, so that nothing but being held back stops a body.
struct NoContacts;

impl StepHooks for NoContacts {
    fn modify(&self, contacts: &mut SolvedContacts<'_>) {
        contacts.clear();
    }
}

const SPEED: f64 = 300.0;

fn models() -> [Model; 2] {
    [cuboid(0.02, 4.0, 4.0), cuboid(0.1, 0.1, 0.1)]
}

/// A ball that presses on a wall, at full speed.
fn press(simulation: &mut Simulation, ball: &Model) -> BodyIndex {
    let at = BodySpec {
        linear_velocity: SPEED * DVec3::X,
        ..spec(ball, BodyKind::Dynamic, -(0.06 + 1e-3) * DVec3::X)
    };
    let ball = simulation.insert(&at).unwrap();
    simulation.set_continuous(ball, true);
    ball
}

fn speed(simulation: &Simulation, ball: BodyIndex) -> f64 {
    simulation.velocity(ball).0.x
}

/// A ball that has got nowhere for the first time.
fn stuck([wall, ball]: &[Model; 2]) -> (Simulation, BodyIndex) {
    let options = SimulationOptions { gravity: DVec3::ZERO, ..SimulationOptions::default() };
    let mut simulation = Simulation::new(options);
    let wall = simulation.insert(&spec(wall, BodyKind::Fixed, DVec3::ZERO)).unwrap();
    simulation.set_hooked(wall, false, true);
    let ball = press(&mut simulation, ball);
    simulation.step_with(&NoContacts);
    assert_eq!((simulation.held_back() > 0, speed(&simulation, ball)), (true, SPEED));
    (simulation, ball)
}

#[test]
fn what_gets_nowhere_twice_is_braked() {
    let (mut simulation, ball) = stuck(&models());
    simulation.step_with(&NoContacts);
    assert!(speed(&simulation, ball) <= 0.5 * SPEED, "{}", speed(&simulation, ball));
}

#[test]
fn a_new_body_of_an_old_number_is_not_braked_for_it() {
    let models = models();
    let (mut simulation, gone) = stuck(&models);
    simulation.remove(gone);
    let ball = press(&mut simulation, &models[1]);
    assert_eq!(ball, gone);
    simulation.step_with(&NoContacts);
    assert_eq!((simulation.held_back() > 0, speed(&simulation, ball)), (true, SPEED));
}

#[cfg(feature = "snapshot")]
#[test]
fn what_was_written_as_it_got_nowhere_is_braked_as_it_goes_on() {
    let models = models();
    let (mut simulation, ball) = stuck(&models);
    let bytes = simulation.snapshot().unwrap();
    let mut restored = Simulation::restore(&bytes, &models).unwrap();
    simulation.step_with(&NoContacts);
    restored.step_with(&NoContacts);
    assert_eq!(speed(&restored, ball), speed(&simulation, ball));
    assert!(speed(&restored, ball) <= 0.5 * SPEED);
}
