//! `Response`: rigid bodies through rapier.
//!
//! The solver keeps poses of its own, in f32 as `Transform`s are, so nothing is lost between the two:
//! before a step whatever moved a `Transform` is told to the solver, at the end of the step the
//! solver's poses become the `Transform`s.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::Remove;
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_narrow_phase::{Answer, Fields};
use cranny_rapier::{BodyIndex, Detector as Detection, PairContacts, Simulation};
use cranny_world::{BodyId, ContactFields};

use crate::body::{Bodies, Body, Velocity, narrowed, pose_of, transform_of};
use crate::clock::{CrannyStep, PhaseTimes, SimulatedTime, StepSystems};
use crate::detection::{DetectionSystems, Detector};
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};
use crate::readers::ContactReaders;
use crate::simulation::RigidScene;
use crate::tally::Tally;

/// The systems of `Response`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ResponseSystems {
    /// Transforms that somebody moved, to the solver.
    Sync,
    /// The solver's step.
    Solve,
    /// Its contacts, to detection.
    Supply,
    /// Sums, energies.
    Tally,
    /// The solver's poses, to the Transforms.
    Advance,
}

/// A body that the solver moves, or that others bounce off.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    /// The solver's number.
    pub index: BodyIndex,
}

/// rapier's world.
#[derive(Resource)]
pub struct RigidBodies {
    simulation: Simulation,
    ids: Vec<BodyId>,
    index_of: BTreeMap<BodyId, BodyIndex>,
    /// The `Transform`s that the solver knows of, by its numbers.
    known: Vec<Transform>,
    /// What the solver's detector found, at the poses of the beginning of this step, or of its last part.
    answers: Vec<PairContacts>,
    /// The `Transform`s from which a pair's latest answer was computed.
    answered_at: BTreeMap<(BodyIndex, BodyIndex), [Transform; 2]>,
    /// What of contacts is read in this step.
    read: Arc<Mutex<ContactFields>>,
    detection: Detection,
    energy: EnergyRange,
}

/// Total mechanical energy over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyRange {
    /// Before the first step.
    pub start: f64,
    /// Now.
    pub now: f64,
    /// The highest so far.
    pub max: f64,
    /// The lowest so far.
    pub min: f64,
    /// The highest kinetic energy so far.
    pub kinetic_max: f64,
    /// The greatest change of potential energy since the start.
    pub potential_change_max: f64,
    potential_start: f64,
}

impl EnergyRange {
    fn starting(kinetic: f64, potential: f64) -> Self {
        let total = kinetic + potential;
        Self {
            start: total,
            now: total,
            max: total,
            min: total,
            kinetic_max: kinetic,
            potential_change_max: 0.0,
            potential_start: potential,
        }
    }

    fn note(&mut self, kinetic: f64, potential: f64) {
        self.now = kinetic + potential;
        self.max = self.max.max(self.now);
        self.min = self.min.min(self.now);
        self.kinetic_max = self.kinetic_max.max(kinetic);
        let change = (potential - self.potential_start).abs();
        self.potential_change_max = self.potential_change_max.max(change);
    }

    /// What gains and losses are measured against: the larger of the highest kinetic energy and the
    /// greatest change of potential energy. It does not depend on where heights are counted from.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.kinetic_max.max(self.potential_change_max)
    }

    /// The greatest gain over the start, relative to [`scale`](Self::scale); 0 where nothing moved.
    #[must_use]
    pub fn drift(&self) -> f64 {
        relative(self.max - self.start, self.scale())
    }

    /// What was lost by now (negative: gained), relative to [`scale`](Self::scale).
    #[must_use]
    pub fn loss(&self) -> f64 {
        relative(self.start - self.now, self.scale())
    }
}

fn relative(value: f64, scale: f64) -> f64 {
    if scale > 0.0 { value / scale } else { 0.0 }
}

impl RigidBodies {
    /// The solver's world.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The solver's world, to change its settings. Poses are changed by `Transform`s.
    pub fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// The solver's number of a body, if it takes part.
    #[must_use]
    pub fn index(&self, body: BodyId) -> Option<BodyIndex> {
        self.index_of.get(&body).copied()
    }

    /// The body of a solver's number.
    #[must_use]
    pub fn id(&self, index: BodyIndex) -> Option<BodyId> {
        self.ids.get(index.0 as usize).copied()
    }

    /// Exact answers for the poses at the beginning of the step, or of its last part, by ascending bodies. Where rapier
    /// kept contacts from an older step, they are here only if neither body has moved since (it
    /// lets resting pairs sleep). Empty with rapier's own detectors. Ids ascend with the solver's
    /// numbers, so `a` < `b` in both.
    pub fn answers(&self) -> impl Iterator<Item = (BodyId, BodyId, &PairContacts)> {
        self.answers.iter().filter_map(|p| Some((self.id(p.a)?, self.id(p.b)?, p)))
    }

    fn collect_answers(&mut self) {
        let mut answers = self.simulation.contact_pairs();
        let mut answered_at = BTreeMap::new();
        answers.retain(|pair| {
            let key = (pair.a, pair.b);
            // Bodies that were put into the solver's world by hand have no `Transform` here.
            let [Some(&a), Some(&b)] =
                [pair.a, pair.b].map(|index| self.known.get(index.0 as usize))
            else {
                return false;
            };
            let now = [a, b];
            let current = pair.fresh || self.answered_at.get(&key) == Some(&now);
            if current {
                answered_at.insert(key, now);
            }
            current
        });
        (self.answers, self.answered_at) = (answers, answered_at);
    }

    /// Whether the solver's own detector gives exact answers.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.detection == Detection::Cranny
    }

    /// Energies.
    #[must_use]
    pub fn energy(&self) -> &EnergyRange {
        &self.energy
    }
}

/// Puts [`RigidBodies`] in.
pub(crate) struct ResponsePlugin {
    scene: Mutex<Option<RigidScene>>,
    /// Whether somebody wants exact answers of the world.
    detection_present: bool,
}

impl ResponsePlugin {
    pub(crate) fn new(scene: RigidScene, detection_present: bool) -> Self {
        Self { scene: Mutex::new(Some(scene)), detection_present }
    }
}

impl Plugin for ResponsePlugin {
    fn build(&self, app: &mut App) {
        let Some(scene) = self.scene.lock().ok().and_then(|mut scene| scene.take()) else {
            return; // built twice: the first build took it
        };
        let RigidScene { simulation, ids, detection } = scene;
        let effects = app.world().resource::<EffectTable>().clone();
        let (body_of, read) = (ids.clone(), Arc::new(Mutex::new(ContactFields::NONE)));
        let read_now = read.clone();
        simulation.read_by(move |a, b| {
            // Bodies that were put into the solver's world by hand are nobody's of the scene.
            let of = |index: BodyIndex| body_of.get(index.0 as usize).copied();
            let margin = of(a).zip(of(b)).and_then(|(a, b)| effects.contact_margin(a, b));
            let read = *read_now.lock().unwrap_or_else(PoisonError::into_inner);
            margin.map_or(Fields::NONE, |margin| read.within(margin))
        });
        let mut known = vec![Transform::IDENTITY; ids.len()];
        for (i, &id) in ids.iter().enumerate() {
            let index = BodyIndex(i as u32);
            let Some(entity) = app.world().resource::<Bodies>().get(id).map(|r| r.entity) else {
                continue;
            };
            let (linear, angular) = simulation.velocity(index);
            let mut entity = app.world_mut().entity_mut(entity);
            known[i] = entity.get::<Transform>().copied().unwrap_or_default();
            let velocity = Velocity { linear: narrowed(linear), angular: narrowed(angular) };
            entity.insert((RigidBody { index }, velocity));
        }
        let energy = simulation.energy();
        app.insert_resource(RigidBodies {
            index_of: ids.iter().enumerate().map(|(i, &id)| (id, BodyIndex(i as u32))).collect(),
            simulation,
            ids,
            known,
            answers: Vec::new(),
            answered_at: BTreeMap::new(),
            read,
            detection,
            energy: EnergyRange::starting(energy.kinetic, energy.potential),
        });
        app.add_observer(leave_removed_alone);
        app.configure_sets(
            CrannyStep,
            (
                ResponseSystems::Sync.in_set(StepSystems::Sync),
                ResponseSystems::Solve.in_set(StepSystems::Solve),
                ResponseSystems::Tally.in_set(StepSystems::Report),
                ResponseSystems::Advance.in_set(StepSystems::Advance),
            ),
        );
        app.add_systems(
            CrannyStep,
            (
                push_transforms.in_set(ResponseSystems::Sync),
                step_solver.in_set(ResponseSystems::Solve),
                tally_solver.in_set(ResponseSystems::Tally),
                pull_transforms.in_set(ResponseSystems::Advance),
            ),
        );
        if detection == Detection::Cranny {
            app.world_mut().resource_mut::<Tally>().depths_known = true;
            if self.detection_present {
                app.configure_sets(
                    CrannyStep,
                    ResponseSystems::Supply.in_set(DetectionSystems::Supply),
                );
                app.add_systems(CrannyStep, supply_answers.in_set(ResponseSystems::Supply));
            }
        }
    }
}

fn push_transforms(
    moved: Query<(&Transform, &RigidBody), Changed<Transform>>,
    mut bodies: ResMut<RigidBodies>,
) {
    for (transform, body) in &moved {
        if *transform != bodies.known[body.index.0 as usize] {
            bodies.known[body.index.0 as usize] = *transform;
            bodies.simulation.set_pose(body.index, pose_of(transform));
        }
    }
}

fn step_solver(
    mut bodies: ResMut<RigidBodies>,
    readers: Option<Res<ContactReaders>>,
    time: Res<SimulatedTime>,
    mut times: ResMut<PhaseTimes>,
    mut failure: ResMut<Failure>,
) {
    let bodies = &mut *bodies;
    if let Some(readers) = readers.filter(|readers| readers.is_changed()) {
        *bodies.read.lock().unwrap_or_else(PoisonError::into_inner) = readers.fields();
    }
    let start = Instant::now();
    if let Err(why) = stepped(bodies) {
        failure.set(SceneAppError::SolverPanicked { step: time.steps(), why });
        return;
    }
    let spent = 1e3 * start.elapsed().as_secs_f64();
    let timings = bodies.simulation.timings_ms();
    times.broad += timings.broad;
    times.narrow += timings.narrow;
    times.report += timings.reading;
    times.solver += (spent - timings.broad - timings.narrow - timings.reading).max(0.0);
    if bodies.detection == Detection::Cranny {
        let start = Instant::now();
        bodies.collect_answers();
        times.report += 1e3 * start.elapsed().as_secs_f64();
    }
}

/// Makes a step. What rapier's own detectors cannot take may make them panic, which ends the run in order;
/// a panic under our detector is ours, and is let through.
fn stepped(bodies: &mut RigidBodies) -> Result<(), String> {
    if bodies.is_exact() {
        bodies.simulation.step();
        return Ok(());
    }
    // The simulation is not used again after a failure.
    unless_it_panics(|| bodies.simulation.step())
}

/// Does something; what it says should it panic.
fn unless_it_panics(work: impl FnOnce()) -> Result<(), String> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        text.or_else(|| panic.downcast_ref::<&str>().copied())
            .unwrap_or("without a word")
            .to_owned()
    })
}

/// Hands the solver's answers to the world, which then does not detect those pairs again.
fn supply_answers(
    bodies: Res<RigidBodies>,
    effects: Res<EffectTable>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    detector.supplied_poses.clear();
    for (a, b, pair) in bodies.answers() {
        let asked =
            effects.asks(EffectKind::Trigger, a, b) || effects.contact_margin(a, b).is_some();
        if asked {
            failure.note(detector.world().supply(a, b, Answer::clone(&pair.answer)));
            detector.supplied_poses.insert((a, b), pair.poses);
        }
    }
}

fn tally_solver(
    mut bodies: ResMut<RigidBodies>,
    time: Res<SimulatedTime>,
    mut tally: ResMut<Tally>,
) {
    tally.pairs.push(bodies.simulation.pair_count());
    let counts = bodies.simulation.pair_counts();
    tally.carried.push(counts.carried);
    tally.searched.push(counts.searched);
    tally.contacts.push(bodies.simulation.solver_contacts());
    for (a, b, pair) in bodies.answers() {
        tally.note_depth(a, b, &pair.answer, time.steps());
    }
    let energy = bodies.simulation.energy();
    bodies.energy.note(energy.kinetic, energy.potential);
}

fn pull_transforms(
    mut moved: Query<(&Body, &mut Transform, &mut Velocity, &RigidBody)>,
    mut bodies: ResMut<RigidBodies>,
    records: Res<Bodies>,
    time: Res<SimulatedTime>,
    mut failure: ResMut<Failure>,
) {
    for (body, mut transform, mut velocity, rigid) in &mut moved {
        let next = transform_of(&bodies.simulation.pose(rigid.index));
        if !next.is_finite() {
            let name = records.name(body.id).to_owned();
            failure.set(SceneAppError::NotFinite { body: name, step: time.steps() + 1 });
            return;
        }
        let (linear, angular) = bodies.simulation.velocity(rigid.index);
        *velocity = Velocity { linear: narrowed(linear), angular: narrowed(angular) };
        bodies.known[rigid.index.0 as usize] = next;
        transform.set_if_neq(next);
    }
}

/// rapier's world does not let go of a body; one that was removed meets nothing any more.
fn leave_removed_alone(
    removed: On<Remove<Body>>,
    rigid: Query<&RigidBody>,
    mut bodies: ResMut<RigidBodies>,
) {
    if let Ok(body) = rigid.get(removed.entity) {
        for other in (0..bodies.ids.len() as u32).map(BodyIndex).filter(|&i| i != body.index) {
            bodies.simulation.exclude(body.index, other);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::panic::panic_any;

    use super::*;

    #[test]
    fn what_a_solver_says_as_it_panics_is_told() {
        assert_eq!(unless_it_panics(|| {}), Ok(()));
        assert_eq!(unless_it_panics(|| panic!("no pieces")), Err("no pieces".to_owned()));
        let counted = unless_it_panics(|| panic!("{} pieces", 7));
        assert_eq!(counted, Err("7 pieces".to_owned()));
        assert_eq!(unless_it_panics(|| panic_any(3)), Err("without a word".to_owned()));
    }

    #[test]
    fn drift_and_loss_do_not_depend_on_the_zero_of_height() {
        for zero in [0.0, -1e3] {
            let mut energy = EnergyRange::starting(1.0, 4.0 + zero);
            energy.note(3.0, 3.0 + zero);
            energy.note(2.0, 2.0 + zero);
            assert_eq!(energy.scale(), 3.0);
            assert!((energy.drift() - 1.0 / 3.0).abs() < 1e-12);
            assert!((energy.loss() - 1.0 / 3.0).abs() < 1e-12);
        }
        assert_eq!(EnergyRange::starting(0.0, 7.0).drift(), 0.0);
    }
}
