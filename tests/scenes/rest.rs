//! At rest nothing creeps and nothing gains energy; and a simulation that is written then goes on
//! the same.
//!
//! `tools/soak` has ten minutes of it: `CRANNY_REST_SECONDS=600`.

use cranny_ecs::{RigidBodies, RunOptions, SceneApp};
use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_rapier::{BodyIndex, Simulation};

use crate::run::asset;

/// Seconds of rest, unless said otherwise.
const REST: f64 = 0.5;

/// How far anything may creep, in the scenes' units: bodies are about one across.
const CREEP: f64 = 1e-3;

/// Share of the energy of the fall that led to rest.
const GAIN: f64 = 0.01;

/// All poses and velocities, to the bit.
fn state(simulation: &Simulation) -> Vec<u64> {
    let numbers = simulation.indices().flat_map(|body| {
        let (pose, (linear, angular)) = (simulation.pose(body), simulation.velocity(body));
        let vectors = [pose.translation, linear, angular].map(|v| v.to_array());
        pose.rotation.to_array().into_iter().chain(vectors.into_iter().flatten())
    });
    numbers.map(f64::to_bits).collect()
}

/// What became of a scene at rest.
struct Rested {
    crept: f64,
    gained: f64,
    app: SceneApp,
    models: Vec<Model>,
}

/// Lets some bodies of a scene come to rest for some seconds, and looks at their rest.
fn rested(name: &str, settle: f64, among: impl Fn(&str) -> bool) -> Rested {
    let rest = match std::env::var("CRANNY_REST_SECONDS") {
        Ok(seconds) => seconds.parse().expect("CRANNY_REST_SECONDS is a number of seconds"),
        Err(_) => REST,
    };
    let mut scene = asset(name).description;
    scene.effects.truncate(1);
    scene.bodies.retain(|body| among(&body.name));
    let steps = |seconds: f64| (seconds / scene.step).round() as usize;
    let options = RunOptions { duration: Some(settle + rest + 1.0), ..RunOptions::default() };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    let start = simulation(&mut app).energy().total();
    (0..steps(settle)).for_each(|_| assert!(app.step().unwrap()));

    let settled = simulation(&mut app);
    let energy = settled.energy().total();
    let scale = start - energy;
    assert!(scale > 0.0, "they fell");
    let indices = 0..settled.len() as u32;
    let places: Vec<DVec3> =
        indices.clone().map(|k| settled.pose(BodyIndex(k)).translation).collect();
    let (mut crept, mut gained) = (0.0f64, 0.0f64);
    for _ in 0..steps(rest) {
        assert!(app.step().unwrap());
        let now = simulation(&mut app);
        gained = gained.max((now.energy().total() - energy) / scale);
        for (k, place) in indices.clone().zip(&places) {
            crept = crept.max(now.pose(BodyIndex(k)).translation.distance(*place));
        }
    }
    eprintln!("{name}: {rest} s of rest, crept by {crept:.2e}, gained {gained:.2e} of {scale:.3}");
    let built = |mesh: &Mesh| Model::build(mesh.clone(), &BuildOptions::default()).unwrap().0;
    let models = scene.bodies.iter().map(|body| built(&body.collision)).collect();
    Rested { crept, gained, app, models }
}

impl Rested {
    /// Writes the simulation, reads it, and pushes a body of both, lest they go on doing nothing.
    fn goes_on_the_same(mut self, pushed: BodyIndex) {
        let ours = simulation(&mut self.app);
        let bytes = ours.snapshot().unwrap();
        let mut restored = Simulation::restore(&bytes, &self.models).unwrap();
        assert_eq!(state(&restored), state(ours));
        for step in 0..60 {
            if step == 20 {
                for one in [&mut *ours, &mut restored] {
                    one.set_velocity(pushed, DVec3::new(0.3, 0.1, 0.5), DVec3::X);
                }
            }
            ours.step();
            restored.step();
            assert_eq!(state(&restored), state(ours), "step {step}");
        }
        let (linear, _) = restored.velocity(pushed);
        assert!(linear.length() > 0.01, "the push was felt: {linear}");
    }
}

#[test]
fn a_hook_on_its_ring() {
    let hook = rested("hook_on_ring.ron", 4.0, |_| true);
    assert!(hook.crept < CREEP, "{}", hook.crept);
    assert!(hook.gained < GAIN, "{}", hook.gained);
    hook.goes_on_the_same(BodyIndex(1));
}

#[test]
fn an_l_on_a_slab() {
    let l = rested("l_on_slab.ron", 2.0, |name| name == "slab" || name == "above");
    assert!(l.crept < CREEP, "{}", l.crept);
    assert!(l.gained < GAIN, "{}", l.gained);
    l.goes_on_the_same(BodyIndex(1));
}

#[test]
fn a_stack_of_cups() {
    let cups = rested("stack_of_cups.ron", 3.0, |_| true);
    assert!(cups.crept < CREEP, "{}", cups.crept);
    assert!(cups.gained < GAIN, "{}", cups.gained);
    cups.goes_on_the_same(BodyIndex(10));
}

fn simulation(app: &mut SceneApp) -> &mut Simulation {
    app.app_mut().world_mut().resource_mut::<RigidBodies>().into_inner().simulation_mut()
}
