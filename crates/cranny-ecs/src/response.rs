//! `Response`: rigid bodies through rapier.
//!
//! The solver keeps poses of its own, in f32 as `Transform`s are, so nothing is lost between the
//! two: before a step whatever moved a `Transform` is passed to the solver, at the end of the step
//! the solver's poses become the `Transform`s. [`solved`](crate::solved) says how bodies get into
//! it.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_ecs::system::{StaticSystemParam, SystemParam, SystemParamItem};
use bevy_transform::components::Transform;
use cranny_exact::DVec3;
use cranny_narrow_phase::{Answer, Fields};
use cranny_rapier::{BodyIndex, Detector as Detection, Simulation, SimulationOptions};
use cranny_world::{BodyId, ContactFields};

use crate::body::{Bodies, Body, narrowed, transform_of};
use crate::clock::{CrannyEnd, CrannyStep, PhaseTimes, SimulatedTime, StepSystems};
use crate::contacts::QueryFrame;
use crate::detection::{DetectionSystems, Detector};
use crate::effects::{EffectKind, EffectTable, ordered};
use crate::error::{Failure, SceneAppError};
use crate::hooks::CollisionHooks;
use crate::paths::{FollowsMotorPath, lead_motors};
use crate::plugins::PluginOptions;
use crate::properties::{AngularVelocity, LinearVelocity, Sleeping};
use crate::readers::ContactReaders;
use crate::solved::{self, RigidBodies, SolverBody};
use crate::tally::Tally;

/// The systems of `Response`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ResponseSystems {
    /// What changed about bodies, and Transforms that somebody moved, to the solver.
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

/// Acceleration of dynamic bodies, units of length / second². Whoever changes it changes it from
/// the next step on.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Gravity(pub DVec3);

/// What is read of the contacts of which pairs, for the solver's step.
#[derive(Debug, Default)]
pub(crate) struct Reading {
    fields: ContactFields,
    /// Of single pairs, besides.
    of_pairs: BTreeMap<(BodyId, BodyId), ContactFields>,
    /// By the solver's numbers.
    pub(crate) ids: Vec<Option<BodyId>>,
    pub(crate) effects: EffectTable,
}

impl Reading {
    fn of(&self, a: BodyIndex, b: BodyIndex) -> Fields {
        // Bodies that were put into the solver's world by hand are nobody's.
        let id = |index: BodyIndex| self.ids.get(index.0 as usize).copied().flatten();
        let Some((a, b)) = id(a).zip(id(b)) else { return Fields::NONE };
        let of_pair = self.of_pairs.get(&ordered(a, b)).copied();
        let fields = of_pair.map_or(self.fields, |fields| fields.join(self.fields));
        let margin = self.effects.contact_margin(a, b);
        margin.map_or(Fields::NONE, |margin| fields.within(margin))
    }
}

/// Puts [`RigidBodies`] in.
pub(crate) struct ResponsePlugin {
    pub(crate) gravity: DVec3,
    pub(crate) step: f64,
    pub(crate) length_unit: f64,
    pub(crate) options: PluginOptions,
    /// Whether somebody wants exact answers of the world.
    pub(crate) detection_present: bool,
    /// Adds the system that makes the solver's step.
    pub(crate) add_step: fn(&mut App),
}

/// Adds the system that makes the solver's step, with hooks.
pub(crate) fn add_step<H>(app: &mut App)
where
    H: SystemParam + 'static,
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    app.add_systems(CrannyStep, step_solver::<H>.in_set(ResponseSystems::Solve));
}

/// The same with hooks that are an app's.
pub(crate) fn add_hooked_step<H>(app: &mut App)
where
    H: SystemParam + 'static,
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    app.world_mut().resource_mut::<RigidBodies>().hook();
    add_step::<H>(app);
}

impl ResponsePlugin {
    fn simulation(&self) -> Simulation {
        let defaults = SimulationOptions::default();
        Simulation::new(SimulationOptions {
            detector: self.options.detector,
            gravity: self.gravity,
            step: self.step,
            length_unit: self.length_unit,
            recycling: self.options.recycling,
            solver_iterations: self.options.substeps,
            most_parts: self.options.most_parts.unwrap_or(defaults.most_parts),
        })
    }
}

impl Plugin for ResponsePlugin {
    fn build(&self, app: &mut App) {
        let simulation = self.simulation();
        let reading =
            Arc::new(Mutex::new(Reading { fields: ContactFields::NONE, ..Reading::default() }));
        let read_now = reading.clone();
        simulation
            .read_by(move |a, b| read_now.lock().unwrap_or_else(PoisonError::into_inner).of(a, b));
        let detection = self.options.detector;
        let hands_over = detection == Detection::Cranny && !self.options.detects_beside;
        app.insert_resource(Gravity(self.gravity));
        app.insert_resource(RigidBodies::new(simulation, reading, detection, hands_over));
        solved::observe(app);
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
                (
                    solved::relate,
                    solved::join,
                    solved::set_hooks,
                    solved::refresh_reading,
                    solved::push_changes,
                    solved::push_impulses,
                    solved::push_gravity,
                )
                    .chain()
                    .in_set(ResponseSystems::Sync),
                tally_solver.in_set(ResponseSystems::Tally),
                (pull_transforms, tell_sleepers).in_set(ResponseSystems::Advance),
            ),
        );
        let led = lead_motors.run_if(any_with_component::<FollowsMotorPath>);
        let led = led.in_set(ResponseSystems::Sync).before(solved::relate);
        app.add_systems(CrannyStep, led);
        (self.add_step)(app);
        app.world_mut().resource_mut::<Tally>().depths_known |= hands_over;
        let presses = app.world().resource::<EffectTable>().has_plugin(EffectKind::Trigger);
        let supplies = hands_over && self.detection_present;
        if presses || supplies {
            let supply = ResponseSystems::Supply.in_set(DetectionSystems::Supply);
            app.configure_sets(CrannyStep, supply);
        }
        if supplies {
            app.add_systems(CrannyStep, supply_answers.in_set(ResponseSystems::Supply));
        }
        if presses {
            app.configure_sets(CrannyEnd, ResponseSystems::Supply.in_set(DetectionSystems::Supply));
            for label in [CrannyStep.intern(), CrannyEnd.intern()] {
                app.add_systems(label, press.in_set(ResponseSystems::Supply));
            }
        }
    }
}

/// Makes the solver's step.
fn step_solver<H>(hooks: StaticSystemParam<'_, '_, H>, mut stepping: Stepping<'_>)
where
    H: SystemParam + 'static,
    for<'w, 's> SystemParamItem<'w, 's, H>: CollisionHooks,
{
    stepping.step(&*hooks);
}

/// What a step of the solver's needs.
#[derive(SystemParam)]
struct Stepping<'w> {
    bodies: ResMut<'w, RigidBodies>,
    effects: Res<'w, EffectTable>,
    readers: Option<Res<'w, ContactReaders>>,
    time: Res<'w, SimulatedTime>,
    times: ResMut<'w, PhaseTimes>,
    failure: ResMut<'w, Failure>,
}

impl Stepping<'_> {
    /// Makes a step.
    fn step(&mut self, hooks: &impl CollisionHooks) {
        if self.failure.is_set() {
            return; // what failed may have left numbers that are none
        }
        let (bodies, times) = (&mut *self.bodies, &mut *self.times);
        let changed = self.readers.as_ref().filter(|readers| readers.is_changed());
        if let Some(readers) = changed.filter(|_| bodies.hands_over()) {
            let mut reading = bodies.reading();
            (reading.fields, reading.of_pairs) = (readers.fields(), readers.fields_of_pairs());
        }
        let start = Instant::now();
        if let Err(why) = stepped(bodies, &self.effects, hooks) {
            self.failure.set(SceneAppError::SolverPanicked { step: self.time.steps(), why });
            return;
        }
        let spent = 1e3 * start.elapsed().as_secs_f64();
        let timings = bodies.simulation().timings_ms();
        times.broad += timings.broad;
        times.narrow += timings.narrow;
        times.report += timings.reading;
        times.solver += (spent - timings.broad - timings.narrow - timings.reading).max(0.0);
        if bodies.hands_over() {
            let start = Instant::now();
            bodies.collect_answers();
            times.report += 1e3 * start.elapsed().as_secs_f64();
        }
    }
}

/// Makes a step. What rapier's own detectors cannot take may make them panic, which ends the run in
/// order; a panic under our detector is ours, and is let through.
fn stepped(
    bodies: &mut RigidBodies,
    effects: &EffectTable,
    hooks: &impl CollisionHooks,
) -> Result<(), String> {
    if bodies.is_exact() {
        bodies.step(effects, hooks);
        return Ok(());
    }
    // The simulation is not used again after a failure.
    unless_it_panics(|| bodies.step(effects, hooks))
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

/// Hands the solver's answers to the world, which then does not detect those pairs again, and how
/// deep the others can overlap.
fn supply_answers(
    bodies: Res<RigidBodies>,
    effects: Res<EffectTable>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    detector.supplied_poses.clear();
    for (a, b, pair) in bodies.answers() {
        let read =
            effects.asks(EffectKind::Trigger, a, b) || effects.contact_margin(a, b).is_some();
        // A solver's answer need hold no distance and no regions, nor reach as far as a tolerance.
        let more = effects.proximity(a, b).is_some()
            || effects.asks(EffectKind::Penetration, a, b)
            || effects.tracked(a, b).is_some();
        if read && !more {
            failure.note(detector.world().supply(a, b, Answer::clone(&pair.answer)));
            let cranny_rapier::PairContacts { poses, first_is_a, first_from_second, .. } = *pair;
            let frame = QueryFrame { first_is_a, first_from_second };
            detector.supplied_poses.insert((a, b), (poses, frame));
        }
    }
    for ((a, b), at_most) in bodies.depth_bounds() {
        failure.note(detector.world().bound_depth(a, b, at_most));
    }
}

/// Pairs that the solver kept apart by an impulse in its last step touch: what bounces off may do
/// so between two poses.
fn press(
    bodies: Res<RigidBodies>,
    effects: Res<EffectTable>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    for ((a, b), _) in bodies.impulses() {
        if effects.asks(EffectKind::Trigger, a, b) {
            failure.note(detector.world().press(a, b));
        }
    }
}

fn tally_solver(bodies: Res<RigidBodies>, time: Res<SimulatedTime>, mut tally: ResMut<Tally>) {
    tally.pairs.push(bodies.simulation().pair_count());
    let counts = bodies.simulation().pair_counts();
    tally.carried.push(counts.carried);
    tally.searched.push(counts.searched);
    let parts = bodies.simulation().parts();
    tally.parts.push(parts);
    tally.divided += u64::from(parts > 1);
    tally.contacts.push(bodies.simulation().solver_contacts());
    for (a, b, pair) in bodies.answers() {
        tally.note_depth(a, b, &pair.answer, time.steps());
    }
}

fn pull_transforms(
    mut moved: Query<(
        &Body,
        &mut Transform,
        &mut LinearVelocity,
        &mut AngularVelocity,
        &SolverBody,
    )>,
    mut bodies: ResMut<RigidBodies>,
    records: Res<Bodies>,
    time: Res<SimulatedTime>,
    mut failure: ResMut<Failure>,
) {
    for (body, mut transform, mut linear, mut angular, solved) in &mut moved {
        let next = transform_of(&bodies.simulation().pose(solved.index));
        if !next.is_finite() {
            let name = records.name(body.id).to_owned();
            failure.set(SceneAppError::NotFinite { body: name, step: time.steps() + 1 });
            return;
        }
        let (v, w) = bodies.simulation().velocity(solved.index);
        let velocities = [narrowed(v), narrowed(w)];
        bodies.knows(solved.index, next, velocities);
        transform.set_if_neq(next);
        linear.set_if_neq(LinearVelocity(velocities[0]));
        angular.set_if_neq(AngularVelocity(velocities[1]));
    }
}

/// Says who fell asleep in the step, and who woke.
fn tell_sleepers(
    members: Query<(Entity, &SolverBody, Has<Sleeping>)>,
    bodies: Res<RigidBodies>,
    mut commands: Commands,
) {
    for (entity, solved, slept) in &members {
        match (slept, bodies.simulation().is_asleep(solved.index)) {
            (false, true) => drop(commands.entity(entity).try_insert(Sleeping)),
            (true, false) => drop(commands.entity(entity).try_remove::<Sleeping>()),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use std::panic::panic_any;

    use super::*;

    #[test]
    fn what_a_solver_says_as_it_panics_is_reported() {
        assert_eq!(unless_it_panics(|| {}), Ok(()));
        assert_eq!(unless_it_panics(|| panic!("no pieces")), Err("no pieces".to_owned()));
        let counted = unless_it_panics(|| panic!("{} pieces", 7));
        assert_eq!(counted, Err("7 pieces".to_owned()));
        assert_eq!(unless_it_panics(|| panic_any(3)), Err("without a word".to_owned()));
    }
}
