//! What presses does so in front of its surfaces.

use std::sync::Mutex;

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_rapier::{
    BodyIndex, BodyKind, CONTACT_SKIN, Simulation, SimulationOptions, SolvedContacts, StepHooks,
};
use cranny_shapes::Cup;

use crate::world::{cuboid, model, spec};

/// With a length unit of 1.
const SKIN: f64 = CONTACT_SKIN * 0.02;

/// Three bodies on each other, `apart` from middle to middle, the lowest fixed.
fn stack(body: &Model, apart: f64, options: SimulationOptions) -> Simulation {
    let mut simulation = Simulation::new(options);
    for k in 0..3 {
        let kind = if k == 0 { BodyKind::Fixed } else { BodyKind::Dynamic };
        simulation.insert(&spec(body, kind, DVec3::Z * (apart * f64::from(k)))).expect("a body");
        simulation.set_hooked(BodyIndex(k as u32), false, true);
    }
    simulation
}

/// How far neighbours of a stack are apart; 0 where they meet.
fn gaps(simulation: &Simulation, body: &Model) -> [f64; 2] {
    let placed = |k| Placed { model: body, pose: simulation.pose(BodyIndex(k)) };
    let ask = Query::of(Demand::Distance { below: None });
    [0, 1].map(|k| {
        let answer = query(placed(k), placed(k + 1), &ask, &mut PairMemory::default());
        answer.expect("valid poses").distance.expect("demanded")
    })
}

/// The least separation that hooks saw.
#[derive(Default)]
struct Least(Mutex<Option<f64>>);

impl StepHooks for Least {
    fn modify(&self, contacts: &mut SolvedContacts<'_>) {
        let mut least = self.0.lock().expect("nobody panicked");
        let found = contacts.points().map(|(_, separation)| separation);
        *least = found.chain(*least).min_by(f64::total_cmp);
        let all = contacts.points().count();
        contacts.retain(|_, separation| separation >= least.expect("a point"));
        assert_eq!(contacts.points().count(), all, "points and separations are the same");
    }
}

#[test]
fn what_rests_does_not_overlap() {
    let cup = model(Cup { segments: 24, ..Cup::default() });
    let height = cup.bounds().max.z - cup.bounds().min.z;
    let mut simulation = stack(&cup, height + 1e-3, SimulationOptions::default());
    for _ in 0..120 {
        simulation.step();
    }
    for gap in gaps(&simulation, &cup) {
        assert!(gap > 0.0 && gap < SKIN, "{gap} apart, with a skin of {SKIN}");
    }
    for k in [1, 2] {
        assert!(simulation.contact_impulse(BodyIndex(k), BodyIndex(k - 1)) > 0.0);
        simulation.set_material(BodyIndex(k), 0.5, 0.0); // wakes it
    }
    // Hooks see the surfaces' separation.
    let nearest = gaps(&simulation, &cup).into_iter().fold(f64::INFINITY, f64::min);
    let least = Least::default();
    simulation.step_with(&least);
    let seen = least.0.into_inner().expect("nobody panicked").expect("contacts");
    assert!((seen - nearest).abs() < 1e-6, "{seen} seen, {nearest} apart");
}

/// Solids of few faces span their sides by regions, and these need an overlap.
#[test]
fn solids_of_few_faces_have_no_skin() {
    let cube = cuboid(1.0, 1.0, 1.0);
    let mut simulation = stack(&cube, 1.001, SimulationOptions::default());
    for _ in 0..120 {
        simulation.step();
    }
    assert_eq!(gaps(&simulation, &cube), [0.0; 2]);
}

/// A skin is a part of the length unit.
#[test]
fn a_skin_is_as_thin_as_the_bodies_are_small() {
    let small = Cup { radius: 0.01, height: 0.02, wall: 0.002, floor: 0.002, segments: 24 };
    let cup = model(small);
    let options = SimulationOptions { length_unit: 0.01, ..SimulationOptions::default() };
    let mut simulation = stack(&cup, 0.02 + 1e-5, options);
    for _ in 0..120 {
        simulation.step();
    }
    let gaps = gaps(&simulation, &cup);
    assert!(gaps.iter().all(|&gap| gap < 0.01 * SKIN), "{gaps:?}");
}
