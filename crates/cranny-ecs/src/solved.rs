//! Bodies in the solver: who is in it, what it knows of them, and how it learns what changed.
//!
//! A body is in the solver's world where something names `Response` for it, or a joint holds it to
//! one of which that is so. [`upkeep`] holds the observers and systems that see to this: a body is
//! inserted as it is admitted, memberships are found again where effects have changed, and what
//! components say ([`given`]) is compared with what the solver knows, so that a component which was
//! written without a change costs a comparison and wakes nobody.

mod given;
mod upkeep;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_exact::DVec3;
use cranny_primitives::BodyShape;
use cranny_rapier::{
    BodyIndex, Detector as Detection, Energy, JointIndex, MassSource, PairContacts, Simulation,
    SimulationError,
};
use cranny_world::description::{BodyKind, Effect, Normals};
use cranny_world::{BodyId, Layers};

use self::given::GivenValues;
pub(crate) use self::upkeep::{
    join, observe, push_changes, push_gravity, push_impulses, refresh_reading, relate, set_hooks,
};
use crate::body::{BodyRecord, pose_of, widened};
use crate::collision::CollisionPoint;
use crate::effects::{BodyEffects, EffectKind, EffectTable, Pair, ordered};
use crate::energy::EnergyRange;
use crate::hooks::{CollisionHooks, Deciding};
use crate::joints::{Follows, Joint};
use crate::properties::{AngularDamping, ExternalForce, GravityScale, LinearDamping, LockedAxes};
use crate::response::Reading;

/// A body that is in the solver's world.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable)]
pub struct SolverBody {
    /// The solver's number.
    pub index: BodyIndex,
}

/// rapier's world, and which bodies are in it.
#[derive(Resource)]
pub struct RigidBodies {
    simulation: Simulation,
    index_of: BTreeMap<BodyId, BodyIndex>,
    known: BTreeMap<BodyIndex, Known>,
    /// What the solver's detector found, at the poses of the beginning of this step, or of its last
    /// part.
    answers: Vec<SolverAnswer>,
    /// The `Transform`s from which a pair's latest answer was computed.
    answered_at: BTreeMap<Pair, [Transform; 2]>,
    /// Shared with the solver's step.
    reading: Arc<Mutex<Reading>>,
    /// Whether `reading` knows all bodies and effects.
    reading_is_current: bool,
    detection: Detection,
    /// Whether what the detector found is handed to whoever reads.
    hands_over: bool,
    /// `None` before the first step.
    energy: Option<EnergyRange>,
    /// At the end of the last step.
    energy_left: Energy,
    /// The effects when it was last looked who takes part; `None` before the first step.
    asked: Option<EffectTable>,
    /// Whether it need not be looked again.
    members_are_current: bool,
    /// Whether all bodies have the hooks that they need.
    hooks_are_current: bool,
    /// Whether an app's hooks decide too.
    hooked: bool,
    joints: BTreeMap<Entity, (Joint, JointIndex)>,
    /// Of joints that motors hold.
    held: BTreeMap<Entity, HeldJoint>,
    /// Joints that are to follow another and do not yet.
    uncoupled: BTreeSet<Entity>,
    /// Joints whose ends are not both in the solver's world, in the order in which they came.
    loose: BTreeMap<u64, Entity>,
    /// How many joints came to wait so far.
    joints_noted: u64,
    /// Entities that lost a component, which now means its default.
    bereft: Vec<Entity>,
}

/// What the solver's detector found of a pair; A is the body with the lower id.
#[derive(Clone, Debug)]
struct SolverAnswer {
    pair: Pair,
    contacts: PairContacts,
    /// Whether it was computed for the very poses at which the solver used it.
    exact: bool,
}

/// How well a motor holds a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HeldJoint {
    /// Where it holds it, radians or units.
    pub position: f64,
    /// How far off the joint is.
    pub off: f64,
    /// How far off it was at most after a step.
    pub off_max: f64,
    /// In how many steps the motor was at its greatest effort.
    pub strained: u64,
}

/// What the solver knows of a body.
#[derive(Clone, Debug)]
pub(crate) struct Known {
    pub(crate) id: BodyId,
    pub(crate) entity: Entity,
    shape: BodyShape,
    kind: BodyKind,
    normals: Normals,
    layers: Layers,
    given: GivenValues,
}

/// The layers that a body has in the solver's world, where a sensor meets nothing.
fn layers_of(effects: &BodyEffects) -> Layers {
    if effects.sensor { Layers { memberships: 0, filters: 0 } } else { effects.layers }
}

fn rapier_kind(kind: BodyKind) -> cranny_rapier::BodyKind {
    match kind {
        BodyKind::Fixed => cranny_rapier::BodyKind::Fixed,
        BodyKind::Kinematic => cranny_rapier::BodyKind::Kinematic,
        BodyKind::Dynamic => cranny_rapier::BodyKind::Dynamic,
    }
}

/// Access for callers.
impl RigidBodies {
    /// The solver's world.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The solver's world, to change its settings. Bodies are changed by their components.
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
        self.known.get(&index).map(|known| known.id)
    }

    /// Exact answers for the poses at the beginning of the step, or of its last part, by ascending
    /// ids; A is the body of the lower one. Where rapier kept contacts from an older step, they are
    /// here only if neither body has moved since (it lets resting pairs sleep). Empty with rapier's
    /// own detectors.
    pub fn answers(&self) -> impl Iterator<Item = (BodyId, BodyId, &PairContacts)> {
        let exact = self.answers.iter().filter(|answer| answer.exact);
        exact.map(|answer| (answer.pair.0, answer.pair.1, &answer.contacts))
    }

    /// The contacts that the solver used in this step, by ascending ids, as
    /// [`answers`](Self::answers) has them; beside those the ones that it carried on from an older
    /// step, with the points and normals that they had in the frame of the body which rapier has
    /// first.
    pub fn contacts(&self) -> impl Iterator<Item = (BodyId, BodyId, &PairContacts)> {
        self.answers.iter().map(|answer| (answer.pair.0, answer.pair.1, &answer.contacts))
    }

    /// The same of one pair, the lower id first.
    pub(crate) fn contacts_of(&self, pair: Pair) -> Option<&PairContacts> {
        let at = self.answers.binary_search_by_key(&pair, |answer| answer.pair).ok()?;
        Some(&self.answers[at].contacts)
    }

    /// The point of a body, in its frame, that its linear velocity is of; `None` for bodies that
    /// the solver does not have.
    #[must_use]
    pub fn center_of_mass(&self, body: BodyId) -> Option<DVec3> {
        self.index(body).map(|index| self.simulation.center_of_mass(index))
    }

    /// Whether the solver's own detector gives exact answers.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.detection == Detection::Cranny
    }

    /// Whether they are handed to whoever reads them.
    pub(crate) fn hands_over(&self) -> bool {
        self.hands_over
    }

    /// Energies since the first step of a [`SceneApp`](crate::SceneApp). Other apps do not sum them
    /// up: it returns the present energy there.
    #[must_use]
    pub fn energy(&self) -> EnergyRange {
        self.energy.unwrap_or_else(|| EnergyRange::starting(self.simulation.energy()))
    }
}

/// The solver's step.
impl RigidBodies {
    pub(crate) fn new(
        simulation: Simulation,
        reading: Arc<Mutex<Reading>>,
        detection: Detection,
        hands_over: bool,
    ) -> Self {
        Self {
            simulation,
            index_of: BTreeMap::new(),
            known: BTreeMap::new(),
            answers: Vec::new(),
            answered_at: BTreeMap::new(),
            reading,
            reading_is_current: false,
            detection,
            hands_over,
            energy: None,
            energy_left: Energy::default(),
            asked: None,
            members_are_current: false,
            hooks_are_current: false,
            hooked: false,
            joints: BTreeMap::new(),
            held: BTreeMap::new(),
            uncoupled: BTreeSet::new(),
            loose: BTreeMap::new(),
            joints_noted: 0,
            bereft: Vec::new(),
        }
    }

    /// Makes a step.
    pub(crate) fn step(&mut self, effects: &EffectTable, hooks: &impl CollisionHooks) {
        let Self { simulation, known: members, .. } = self;
        simulation.step_with(&Deciding { hooks, effects, members });
    }

    /// Has an app's hooks decide too.
    pub(crate) fn hook(&mut self) {
        self.hooked = true;
    }

    /// How deep pairs can overlap at the poses at the beginning of the step.
    pub(crate) fn depth_bounds(&self) -> impl Iterator<Item = (Pair, f64)> {
        self.simulation.depth_bounds().filter_map(|((a, b), at_most)| {
            let [a, b] = [self.id(a)?, self.id(b)?];
            Some((ordered(a, b), at_most))
        })
    }

    /// The impulses along the normals that pairs of bodies gave each other in the last step, where
    /// they did.
    pub(crate) fn impulses(&self) -> impl Iterator<Item = (Pair, f64)> {
        self.simulation.contact_impulses().filter_map(|((a, b), impulse)| {
            let [a, b] = [self.id(a)?, self.id(b)?];
            Some((ordered(a, b), impulse))
        })
    }

    /// The same by ascending ids: the solver lists pairs in no order.
    pub(crate) fn impulses_in_order(&self) -> Vec<(Pair, f64)> {
        let mut impulses: Vec<(Pair, f64)> = self.impulses().collect();
        impulses.sort_by_key(|(pair, _)| *pair);
        impulses
    }

    /// The same of one pair; 0 for bodies that the solver does not have.
    pub(crate) fn impulse(&self, a: BodyId, b: BodyId) -> f64 {
        let pair = self.index(a).zip(self.index(b));
        pair.map_or(0.0, |(a, b)| self.simulation.contact_impulse(a, b))
    }

    /// The points at which the solver had two bodies press on each other in the last step, seen
    /// from the one with the lower id, each with its impulse. Readers make no difference.
    pub(crate) fn presses(&self, (a, b): Pair) -> Vec<(CollisionPoint, f64)> {
        let Some((i, j)) = self.index(a).zip(self.index(b)) else { return Vec::new() };
        let points = self.simulation.solved_points(i, j).into_iter();
        let points = points.filter(|solved| solved.impulse > 0.0).map(|solved| {
            let (normal, depth) = (solved.normal, -solved.separation);
            let seen = CollisionPoint { point: solved.point, normal, depth };
            // Numbers are given again, ids are not: either may be the lower one.
            (if i < j { seen } else { seen.flipped() }, solved.impulse)
        });
        points.collect()
    }

    pub(crate) fn reading(&self) -> MutexGuard<'_, Reading> {
        self.reading.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Energies count from the first step on. What an app has changed since the step before, as by
    /// a body that came, is no gain and no loss.
    pub(crate) fn begin_energy(&mut self) {
        let now = self.simulation.energy();
        match &mut self.energy {
            Some(energy) if self.energy_left != now => energy.shift(self.energy_left, now),
            Some(_) => {}
            None => self.energy = Some(EnergyRange::starting(now)),
        }
    }

    pub(crate) fn note_energy(&mut self) {
        let now = self.simulation.energy();
        self.energy_left = now;
        if let Some(energy) = &mut self.energy {
            energy.note(now);
        }
    }

    pub(crate) fn note_joints(&mut self) {
        for (&entity, (joint, index)) in &self.joints {
            let held = joint.motor.and_then(|motor| motor.position);
            // A motor between two bodies counts no turns, so none are held against it.
            let found = held
                .and_then(|held| Some((held, self.simulation.joint_position_near(*index, held)?)));
            let Some((held, at)) = found else { continue };
            let known = self.held.entry(entity).or_default();
            known.position = held;
            known.off = (at - held).abs();
            known.off_max = known.off_max.max(known.off);
            known.strained += u64::from(self.simulation.is_strained(*index));
        }
    }

    /// Joints that motors hold, or held, since the first step of a [`SceneApp`](crate::SceneApp);
    /// empty in other apps.
    pub fn held_joints(&self) -> impl Iterator<Item = (Entity, HeldJoint)> {
        self.held.iter().map(|(&entity, &held)| (entity, held))
    }

    /// The solver has written these.
    pub(crate) fn knows(&mut self, index: BodyIndex, transform: Transform, velocities: [Vec3; 2]) {
        if let Some(known) = self.known.get_mut(&index) {
            known.given.transform = transform;
            known.given.velocities = velocities;
        }
    }

    pub(crate) fn collect_answers(&mut self) {
        let (mut answers, mut answered_at) = (Vec::new(), BTreeMap::new());
        for pair in self.simulation.contact_pairs() {
            // Bodies that were put into the solver's world by hand have no `Transform` here.
            let [Some(a), Some(b)] = [pair.a, pair.b].map(|index| self.known.get(&index)) else {
                continue;
            };
            // Numbers are given again, ids are not: either may be the lower one.
            let turned = a.id > b.id;
            let [a, b] = if turned { [b, a] } else { [a, b] };
            let (key, now) = ((a.id, b.id), [a, b].map(|known| known.given.transform));
            let exact = pair.fresh || self.answered_at.get(&key) == Some(&now);
            if exact {
                answered_at.insert(key, now);
            }
            let contacts = if turned { pair.swapped() } else { pair };
            answers.push(SolverAnswer { pair: key, contacts, exact });
        }
        answers.sort_unstable_by_key(|answer| answer.pair);
        (self.answers, self.answered_at) = (answers, answered_at);
    }
}

/// Bodies that come, change and leave.
impl RigidBodies {
    fn insert(
        &mut self,
        id: BodyId,
        record: &BodyRecord,
        effects: &BodyEffects,
        given: GivenValues,
    ) -> Result<BodyIndex, SimulationError> {
        let known = Known {
            id,
            entity: record.entity,
            shape: record.shape.clone(),
            kind: record.kind,
            normals: record.normals,
            layers: layers_of(effects),
            // What an insertion does not say.
            given: GivenValues {
                gravity: GravityScale::default(),
                linear_damping: LinearDamping::default(),
                angular_damping: AngularDamping::default(),
                locked: LockedAxes::default(),
                force: ExternalForce::default(),
                ..given
            },
        };
        given.check(&known)?;
        let index = self.simulation.insert(&given.spec(&known))?;
        let Layers { memberships, filters } = known.layers;
        if filters != memberships {
            self.simulation.set_groups(index, memberships, filters);
        }
        self.index_of.insert(id, index);
        self.known.insert(index, known);
        self.push(index, given)?;
        self.reading_is_current = false;
        Ok(index)
    }

    /// Passes on what has become of a body's record and of whom it meets.
    fn change(
        &mut self,
        index: BodyIndex,
        record: &BodyRecord,
        effects: &BodyEffects,
        mass: MassSource,
    ) -> Result<(), SimulationError> {
        let Some(known) = self.known.get_mut(&index) else { return Ok(()) };
        let layers = layers_of(effects);
        let reshaped = !known.shape.is_same(&record.shape) || known.normals != record.normals;
        if known.kind != record.kind {
            let kind = rapier_kind(record.kind);
            self.simulation.set_kind(index, kind, &record.shape, mass)?;
            known.kind = record.kind;
            let [linear, angular] = known.given.damping(known.kind);
            self.simulation.set_damping(index, linear, angular);
        }
        if reshaped {
            self.simulation.set_shape(index, &record.shape, record.normals, mass)?;
            (known.shape, known.normals) = (record.shape.clone(), record.normals);
        }
        if known.layers != layers {
            self.simulation.set_groups(index, layers.memberships, layers.filters);
            known.layers = layers;
        }
        self.reading_is_current = false;
        Ok(())
    }

    /// Passes on values that are other ones than the solver knows.
    fn push(&mut self, index: BodyIndex, given: GivenValues) -> Result<(), SimulationError> {
        let Some(known) = self.known.get_mut(&index) else { return Ok(()) };
        let before = known.given;
        if before == given {
            return Ok(());
        }
        given.check(known)?;
        let simulation = &mut self.simulation;
        let reweighed = (before.density, before.mass) != (given.density, given.mass);
        if reweighed && known.kind == BodyKind::Dynamic {
            simulation.set_mass(index, &known.shape, given.mass_source())?;
        }
        known.given = given;
        if before.transform != given.transform {
            simulation.set_pose(index, pose_of(&given.transform));
        }
        if before.velocities != given.velocities {
            let [linear, angular] = given.velocities.map(widened);
            simulation.set_velocity(index, linear, angular);
        }
        if (before.friction, before.restitution) != (given.friction, given.restitution) {
            let [friction, restitution] =
                [given.friction.coefficient, given.restitution.coefficient].map(f64::from);
            simulation.set_material(index, friction, restitution);
        }
        if before.gravity != given.gravity {
            simulation.set_gravity_scale(index, given.gravity.0.into());
        }
        if before.damping(known.kind) != given.damping(known.kind) {
            let [linear, angular] = given.damping(known.kind);
            simulation.set_damping(index, linear, angular);
        }
        if before.locked != given.locked {
            let [along, about] = [given.locked.translation, given.locked.rotation];
            simulation.set_locked_axes(index, along.into(), about.into());
        }
        if before.force != given.force {
            let [force, torque] = [given.force.force, given.force.torque].map(widened);
            simulation.set_force(index, force, torque);
        }
        Ok(())
    }

    fn leave(&mut self, id: BodyId, entity: Entity) {
        let ends = |joint: &Joint| joint.parent == entity || joint.child == entity;
        let freed: Vec<Entity> =
            self.joints.iter().filter(|(_, (j, _))| ends(j)).map(|(&e, _)| e).collect();
        for joint in freed {
            self.joints.remove(&joint);
            self.uncouple(joint);
            self.loosen(joint);
        }
        self.take_out(id);
    }

    /// A joint waits for its ends, after those that wait already.
    fn loosen(&mut self, joint: Entity) {
        self.loose.retain(|_, waiting| *waiting != joint);
        self.loose.insert(self.joints_noted, joint);
        self.joints_noted += 1;
    }

    /// A joint left the solver's world: what follows it has to be coupled again.
    fn uncouple(&mut self, joint: Entity) {
        self.uncoupled.remove(&joint);
        let followers = self
            .joints
            .iter()
            .filter(|(_, (known, _))| known.follows.is_some_and(|follows| follows.joint == joint));
        self.uncoupled.extend(followers.map(|(&entity, _)| entity).collect::<Vec<_>>());
    }

    /// Makes joints follow those that they name, where both are there.
    fn couple(&mut self) {
        let waiting: Vec<Entity> = self.uncoupled.iter().copied().collect();
        for entity in waiting {
            let Some(&(joint, follower)) = self.joints.get(&entity) else { continue };
            let Some(follows) = joint.follows else { continue };
            let Some(&(_, leader)) = self.joints.get(&follows.joint) else { continue };
            let Follows { multiplier, offset, .. } = follows;
            if self.simulation.couple(follower, leader, multiplier, offset) {
                self.uncoupled.remove(&entity);
            }
        }
    }

    /// Takes a body out of the solver's world.
    fn take_out(&mut self, id: BodyId) {
        let Some(index) = self.index_of.remove(&id) else { return };
        self.simulation.remove(index);
        self.known.remove(&index);
        let others = |pair: &Pair| pair.0 != id && pair.1 != id;
        self.answers.retain(|answer| others(&answer.pair));
        self.answered_at.retain(|pair, _| others(pair));
        self.reading_is_current = false;
    }

    /// Has a step decide, for bodies that may be near others without a response, who responds.
    fn set_hooked(&mut self, effects: &EffectTable) {
        let of_scene = effects.of_scene().contains(&Effect::Response);
        let apart: BTreeSet<BodyId> = effects.excluded().flat_map(|(a, b)| [a, b]).collect();
        for (&index, known) in &self.known {
            let filters = self.hooked || !of_scene || apart.contains(&known.id);
            self.simulation.set_hooked(index, filters, self.hooked);
        }
    }

    /// Wakes pairs whose response has come or gone.
    fn reconsider(&mut self, before: &EffectTable, now: &EffectTable) {
        let responds = |effects: &EffectTable, a: &Known, b: &Known| {
            effects.asks(EffectKind::Response, a.id, b.id)
        };
        let changed: Vec<_> = self
            .simulation
            .candidate_pairs()
            .filter(|(a, b)| {
                let pair = self.known.get(a).zip(self.known.get(b));
                pair.is_some_and(|(a, b)| responds(before, a, b) != responds(now, a, b))
            })
            .collect();
        for (a, b) in changed {
            self.simulation.reconsider(a, b);
        }
    }
}
