//! Bodies in the solver: who is in it, what it knows of them, and how it learns what changed.
//!
//! A body is in the solver's world where something asks for its response, or a joint holds it to
//! one of which that is so. [`take_in`] inserts it as it is admitted; [`relate`] looks again where
//! what is asked has changed; [`push_changes`] compares what components say with what the solver
//! knows, so that a component which was written without a change costs a comparison and wakes
//! nobody.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy_app::App;
use bevy_ecs::lifecycle::{Insert, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_geometry::Model;
use cranny_rapier::{
    BodyIndex, BodySpec, Detector as Detection, Energy, JointIndex, JointSpec, PairContacts,
    Simulation, SimulationError,
};
use cranny_world::description::{BodyKind, JointKind, Normals};
use cranny_world::{BodyId, Layers};

use crate::body::{Bodies, Body, BodyRecord, pose_of, widened};
use crate::effects::{BodyEffects, EffectKind, EffectTable, Pair};
use crate::energy::EnergyRange;
use crate::error::{Failure, SceneAppError};
use crate::joints::Joint;
use crate::kinematics::Kinematic;
use crate::properties::{
    AngularVelocity, Density, ExternalForce, ExternalImpulse, Friction, GravityScale,
    LinearVelocity, LockedAxes, Restitution,
};
use crate::response::{Gravity, Reading};

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
    slots: BTreeMap<BodyIndex, Slot>,
    /// What the solver's detector found, at the poses of the beginning of this step, or of its last
    /// part.
    answers: Vec<(Pair, PairContacts)>,
    /// The `Transform`s from which a pair's latest answer was computed.
    answered_at: BTreeMap<Pair, [Transform; 2]>,
    /// Shared with the solver's step.
    reading: Arc<Mutex<Reading>>,
    /// Whether `reading` knows all bodies and effects.
    reading_is_current: bool,
    detection: Detection,
    /// `None` before the first step.
    energy: Option<EnergyRange>,
    /// At the end of the last step.
    energy_left: Energy,
    stepped: bool,
    excluded: BTreeSet<Pair>,
    /// Of the effects that memberships and exclusions follow.
    revision: Option<u64>,
    joints: BTreeMap<Entity, (Joint, JointIndex)>,
    /// Joints whose ends are not both in the solver's world, in the order in which they came.
    loose: BTreeMap<u64, Entity>,
    /// How many joints came to wait so far.
    joints_noted: u64,
    /// Entities that lost a component, which now means its default.
    bereft: Vec<Entity>,
}

/// A body of the solver's.
#[derive(Clone, Debug)]
struct Slot {
    id: BodyId,
    known: Known,
}

/// What the solver knows of a body.
#[derive(Clone, Debug)]
struct Known {
    model: Model,
    kind: BodyKind,
    normals: Normals,
    layers: Layers,
    given: GivenValues,
}

/// The components that the solver reads of a body.
#[derive(QueryData)]
pub(crate) struct Given {
    transform: &'static Transform,
    linear: &'static LinearVelocity,
    angular: &'static AngularVelocity,
    friction: Option<&'static Friction>,
    restitution: Option<&'static Restitution>,
    density: Option<&'static Density>,
    gravity: Option<&'static GravityScale>,
    locked: Option<&'static LockedAxes>,
    force: Option<&'static ExternalForce>,
}

/// Their values.
#[derive(Clone, Copy, Debug, PartialEq)]
struct GivenValues {
    transform: Transform,
    velocities: [Vec3; 2],
    friction: Friction,
    restitution: Restitution,
    density: Density,
    gravity: GravityScale,
    locked: LockedAxes,
    force: ExternalForce,
}

impl GivenItem<'_, '_> {
    fn values(&self) -> GivenValues {
        GivenValues {
            transform: *self.transform,
            velocities: [self.linear.0, self.angular.0],
            friction: self.friction.copied().unwrap_or_default(),
            restitution: self.restitution.copied().unwrap_or_default(),
            density: self.density.copied().unwrap_or_default(),
            gravity: self.gravity.copied().unwrap_or_default(),
            locked: self.locked.copied().unwrap_or_default(),
            force: self.force.copied().unwrap_or_default(),
        }
    }
}

impl GivenValues {
    /// Fails if a number is none.
    fn check(&self) -> Result<(), SimulationError> {
        let [linear, angular] = self.velocities;
        let vectors = [
            ("Transform::translation", self.transform.translation),
            ("LinearVelocity", linear),
            ("AngularVelocity", angular),
            ("ExternalForce::force", self.force.force),
            ("ExternalForce::torque", self.force.torque),
        ];
        let numbers = [
            ("Friction::coefficient", self.friction.coefficient),
            ("Restitution::coefficient", self.restitution.coefficient),
            ("GravityScale", self.gravity.0),
        ];
        let components = vectors.into_iter().flat_map(|(what, v)| v.to_array().map(|x| (what, x)));
        for (what, value) in components.chain(numbers) {
            if !value.is_finite() {
                let value = value.into();
                return Err(SimulationError::Number { what, value, expected: "finite" });
            }
        }
        Ok(())
    }
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

/// Whoever asks.
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
        self.slots.get(&index).map(|slot| slot.id)
    }

    /// Exact answers for the poses at the beginning of the step, or of its last part, by ascending
    /// ids; A is the body of the lower one. Where rapier kept contacts from an older step, they are
    /// here only if neither body has moved since (it lets resting pairs sleep). Empty with rapier's
    /// own detectors.
    pub fn answers(&self) -> impl Iterator<Item = (BodyId, BodyId, &PairContacts)> {
        self.answers.iter().map(|((a, b), pair)| (*a, *b, pair))
    }

    /// Whether the solver's own detector gives exact answers.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.detection == Detection::Cranny
    }

    /// Energies since the first step.
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
    ) -> Self {
        Self {
            simulation,
            index_of: BTreeMap::new(),
            slots: BTreeMap::new(),
            answers: Vec::new(),
            answered_at: BTreeMap::new(),
            reading,
            reading_is_current: false,
            detection,
            energy: None,
            energy_left: Energy::default(),
            stepped: false,
            excluded: BTreeSet::new(),
            revision: None,
            joints: BTreeMap::new(),
            loose: BTreeMap::new(),
            joints_noted: 0,
            bereft: Vec::new(),
        }
    }

    pub(crate) fn reading(&self) -> MutexGuard<'_, Reading> {
        self.reading.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Energies count from the first step on. What an app has changed since the step before, as by
    /// a body that came, is no gain and no loss.
    pub(crate) fn begin(&mut self) {
        let now = self.simulation.energy();
        let energy = self.energy.get_or_insert_with(|| EnergyRange::starting(now));
        if self.energy_left != now && self.stepped {
            energy.shift(self.energy_left, now);
        }
        self.stepped = true;
    }

    pub(crate) fn note_energy(&mut self) {
        let now = self.simulation.energy();
        self.energy_left = now;
        if let Some(energy) = &mut self.energy {
            energy.note(now);
        }
    }

    /// The solver has written these.
    pub(crate) fn knows(&mut self, index: BodyIndex, transform: Transform, velocities: [Vec3; 2]) {
        if let Some(slot) = self.slots.get_mut(&index) {
            slot.known.given.transform = transform;
            slot.known.given.velocities = velocities;
        }
    }

    pub(crate) fn collect_answers(&mut self) {
        let (mut answers, mut answered_at) = (Vec::new(), BTreeMap::new());
        for pair in self.simulation.contact_pairs() {
            // Bodies that were put into the solver's world by hand have no `Transform` here.
            let [Some(a), Some(b)] = [pair.a, pair.b].map(|index| self.slots.get(&index)) else {
                continue;
            };
            // Numbers are given again, ids are not: either may be the lower one.
            let turned = a.id > b.id;
            let [a, b] = if turned { [b, a] } else { [a, b] };
            let (key, now) = ((a.id, b.id), [a, b].map(|slot| slot.known.given.transform));
            if pair.fresh || self.answered_at.get(&key) == Some(&now) {
                answered_at.insert(key, now);
                answers.push((key, if turned { exchanged(pair) } else { pair }));
            }
        }
        answers.sort_unstable_by_key(|(key, _)| *key);
        (self.answers, self.answered_at) = (answers, answered_at);
    }
}

fn exchanged(pair: PairContacts) -> PairContacts {
    let [a, b] = pair.poses;
    PairContacts {
        a: pair.b,
        b: pair.a,
        answer: Arc::new(pair.answer.as_ref().clone().swapped()),
        poses: [b, a],
        fresh: pair.fresh,
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
        let layers = layers_of(effects);
        let index = self.simulation.insert(&BodySpec {
            model: &record.model,
            kind: rapier_kind(record.kind),
            pose: pose_of(&given.transform),
            linear_velocity: widened(given.velocities[0]),
            angular_velocity: widened(given.velocities[1]),
            density: given.density.0,
            friction: given.friction.coefficient.into(),
            restitution: given.restitution.coefficient.into(),
            normals: record.normals,
            groups: layers.memberships,
        })?;
        if layers.filters != layers.memberships {
            self.simulation.set_groups(index, layers.memberships, layers.filters);
        }
        let plain = GivenValues {
            gravity: GravityScale::default(),
            locked: LockedAxes::default(),
            force: ExternalForce::default(),
            ..given
        };
        let known = Known {
            model: record.model.clone(),
            kind: record.kind,
            normals: record.normals,
            layers,
            given: plain,
        };
        self.index_of.insert(id, index);
        self.slots.insert(index, Slot { id, known });
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
        density: Density,
    ) -> Result<(), SimulationError> {
        let Some(Slot { known, .. }) = self.slots.get_mut(&index) else { return Ok(()) };
        let layers = layers_of(effects);
        let reshaped = !known.model.is_same(&record.model) || known.normals != record.normals;
        if known.kind != record.kind {
            let kind = rapier_kind(record.kind);
            self.simulation.set_kind(index, kind, &record.model, density.0)?;
            known.kind = record.kind;
        }
        if reshaped {
            self.simulation.set_shape(index, &record.model, record.normals, density.0)?;
            (known.model, known.normals) = (record.model.clone(), record.normals);
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
        let Some(Slot { known, .. }) = self.slots.get_mut(&index) else { return Ok(()) };
        let before = known.given;
        if before == given {
            return Ok(());
        }
        given.check()?;
        let simulation = &mut self.simulation;
        if before.density != given.density && known.kind == BodyKind::Dynamic {
            simulation.set_density(index, &known.model, given.density.0)?;
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

    /// Takes a body out of the solver's world.
    fn take_out(&mut self, id: BodyId) {
        let Some(index) = self.index_of.remove(&id) else { return };
        self.simulation.remove(index);
        self.slots.remove(&index);
        let others = |pair: &Pair| pair.0 != id && pair.1 != id;
        self.answers.retain(|(pair, _)| others(pair));
        self.answered_at.retain(|pair, _| others(pair));
        self.excluded.retain(others);
        self.reading_is_current = false;
    }

    /// Excludes and includes pairs of bodies that are in the solver's world.
    fn set_excluded(&mut self, excluded: BTreeSet<Pair>) {
        let before = std::mem::replace(&mut self.excluded, excluded);
        let indices = |(a, b): Pair, bodies: &Self| bodies.index(a).zip(bodies.index(b));
        for &pair in before.difference(&self.excluded) {
            if let Some((a, b)) = indices(pair, self) {
                self.simulation.include(a, b);
            }
        }
        let more: Vec<Pair> = self.excluded.difference(&before).copied().collect();
        for pair in more {
            if let Some((a, b)) = indices(pair, self) {
                self.simulation.exclude(a, b);
            }
        }
    }

    /// Pairs of bodies in the solver's world that do not respond to each other, of layers that
    /// meet.
    fn apart(&self, effects: &EffectTable) -> BTreeSet<Pair> {
        if effects.of_scene().iter().any(|e| EffectKind::of(e) == Some(EffectKind::Response)) {
            let present = |pair: &Pair| {
                self.index_of.contains_key(&pair.0) && self.index_of.contains_key(&pair.1)
            };
            return effects.excluded().filter(present).collect();
        }
        let members: Vec<BodyId> = self.index_of.keys().copied().collect();
        let pairs = members
            .iter()
            .enumerate()
            .flat_map(|(i, &a)| members[i + 1..].iter().map(move |&b| (a, b)));
        // Those whose layers or kinds keep them apart need no exclusion.
        let meet = |&(a, b): &Pair| effects.may_meet(a, b) || effects.excludes(a, b);
        pairs.filter(meet).filter(|&(a, b)| !effects.asks(EffectKind::Response, a, b)).collect()
    }
}

/// Registers what looks after bodies between steps.
pub(crate) fn observe(app: &mut App) {
    app.add_observer(take_in)
        .add_observer(let_go)
        .add_observer(note_lost)
        .add_observer(note_joint)
        .add_observer(part);
}

/// What is needed to insert a body.
#[derive(SystemParam)]
pub(crate) struct Insertion<'w, 's> {
    given: Query<'w, 's, (&'static Body, Given)>,
    records: Res<'w, Bodies>,
    effects: Res<'w, EffectTable>,
    bodies: ResMut<'w, RigidBodies>,
    failure: ResMut<'w, Failure>,
    commands: Commands<'w, 's>,
}

impl Insertion<'_, '_> {
    /// Inserts a body that is not there; returns whether it is.
    fn insert(&mut self, entity: Entity) -> bool {
        let Ok((&Body { id }, given)) = self.given.get(entity) else { return false };
        if self.bodies.index(id).is_some() {
            return true;
        }
        let (Some(record), Some(effects)) = (self.records.get(id), self.effects.body(id)) else {
            return false;
        };
        match self.bodies.insert(id, record, effects, given.values()) {
            Ok(index) => {
                self.commands.entity(entity).insert(SolverBody { index });
                self.commands.entity(entity).try_remove::<Kinematic>();
                // Exclusions are found again.
                self.bodies.revision = None;
                true
            }
            Err(source) => {
                let body = record.name.clone();
                self.failure.set(SceneAppError::Solver { body, source });
                false
            }
        }
    }
}

impl Insertion<'_, '_> {
    /// Takes out bodies that have a part in no response any more, by themselves or by joints.
    fn take_out_idle(&mut self) {
        let id = |end: Entity| self.given.get(end).ok().map(|(body, _)| body.id);
        let present = self.bodies.index_of.keys().copied();
        let mut kept: BTreeSet<BodyId> =
            present.filter(|&body| self.effects.responds(body)).collect();
        let joints = self.bodies.joints.values();
        let ends: Vec<[BodyId; 2]> =
            joints.filter_map(|(j, _)| Some([id(j.parent)?, id(j.child)?])).collect();
        loop {
            let before = kept.len();
            for ends in &ends {
                if ends.iter().any(|end| kept.contains(end)) {
                    kept.extend(ends);
                }
            }
            if kept.len() == before {
                break;
            }
        }
        let idle: Vec<BodyId> =
            self.bodies.index_of.keys().copied().filter(|body| !kept.contains(body)).collect();
        for body in idle {
            if let Some(record) = self.records.get(body) {
                self.bodies.leave(body, record.entity);
                let mut entity = self.commands.entity(record.entity);
                entity.try_remove::<SolverBody>();
                if record.kind == BodyKind::Kinematic {
                    entity.insert(Kinematic::of(&record.model));
                }
            }
        }
    }
}

/// Takes in a body that was admitted, or what has become of it.
fn take_in(inserted: On<Insert<Body>>, mut insertion: Insertion) {
    let entity = inserted.entity;
    let Ok((&Body { id }, given)) = insertion.given.get(entity) else { return };
    if let Some(index) = insertion.bodies.index(id) {
        let (Some(record), Some(effects)) = (insertion.records.get(id), insertion.effects.body(id))
        else {
            return;
        };
        let density = given.density.copied().unwrap_or_default();
        if let Err(source) = insertion.bodies.change(index, record, effects, density) {
            let body = record.name.clone();
            insertion.failure.set(SceneAppError::Solver { body, source });
        }
    } else if insertion.effects.responds(id) {
        insertion.insert(entity);
    }
}

fn let_go(
    removed: On<Remove<Body>>,
    query: Query<&Body>,
    mut bodies: ResMut<RigidBodies>,
    mut commands: Commands,
) {
    if let Ok(&Body { id }) = query.get(removed.entity) {
        bodies.leave(id, removed.entity);
        commands.entity(removed.entity).try_remove::<SolverBody>();
    }
}

type Defaulted = (Friction, Restitution, Density, GravityScale, LockedAxes, ExternalForce);

fn note_lost(lost: On<Remove<Defaulted>>, mut bodies: ResMut<RigidBodies>) {
    bodies.bereft.push(lost.entity);
}

fn note_joint(inserted: On<Insert<Joint>>, mut bodies: ResMut<RigidBodies>) {
    let joint = inserted.entity;
    if let Some((_, index)) = bodies.joints.remove(&joint) {
        bodies.simulation.part(index);
    }
    bodies.loosen(joint);
}

fn part(removed: On<Remove<Joint>>, mut bodies: ResMut<RigidBodies>) {
    bodies.loose.retain(|_, waiting| *waiting != removed.entity);
    if let Some((_, index)) = bodies.joints.remove(&removed.entity) {
        bodies.simulation.part(index);
        // What it held may have no part in any response now.
        bodies.revision = None;
    }
}

/// Looks again who takes part, and who responds to whom, where what is asked has changed.
pub(crate) fn relate(mut insertion: Insertion) {
    if insertion.bodies.revision != Some(insertion.effects.revision()) {
        let outside: Vec<(BodyId, Entity)> = insertion
            .effects
            .bodies()
            .filter(|&id| insertion.bodies.index(id).is_none() && insertion.effects.responds(id))
            .filter_map(|id| Some((id, insertion.records.entity(id)?)))
            .collect();
        for (_, entity) in outside {
            insertion.insert(entity);
        }
        insertion.take_out_idle();
        let apart = insertion.bodies.apart(&insertion.effects);
        insertion.bodies.set_excluded(apart);
        insertion.bodies.revision = Some(insertion.effects.revision());
        insertion.bodies.reading_is_current = false;
    }
}

/// Says whose contacts are read, in the solver's step.
pub(crate) fn refresh_reading(effects: Res<EffectTable>, mut bodies: ResMut<RigidBodies>) {
    let bodies = &mut *bodies;
    if !bodies.reading_is_current && effects.names(EffectKind::Contacts) {
        let count = bodies.slots.last_key_value().map_or(0, |(index, _)| index.0 + 1);
        let ids = (0..count).map(|index| bodies.id(BodyIndex(index))).collect();
        let mut reading = bodies.reading();
        (reading.ids, reading.effects) = (ids, effects.clone());
    }
    bodies.reading_is_current = true;
}

/// Makes joints of which both ends are bodies, one of them in the solver's world.
pub(crate) fn join(joints: Query<&Joint>, solved: Query<(), With<Body>>, mut insertion: Insertion) {
    // A joint carries the response on; chains of joints need several passes.
    loop {
        let loose: Vec<(u64, Entity)> =
            insertion.bodies.loose.iter().map(|(&number, &joint)| (number, joint)).collect();
        let mut made = 0;
        for (number, entity) in loose {
            let Ok(&joint) = joints.get(entity) else {
                insertion.bodies.loose.remove(&number);
                continue;
            };
            let ends = [joint.parent, joint.child];
            if joint.parent == joint.child || !ends.iter().all(|&end| solved.contains(end)) {
                continue;
            }
            let id = |end: Entity| insertion.given.get(end).ok().map(|(body, _)| body.id);
            let is_in = |end: Entity| id(end).and_then(|id| insertion.bodies.index(id)).is_some();
            if !ends.iter().any(|&end| is_in(end))
                || !ends.map(|end| insertion.insert(end)).iter().all(|&is| is)
            {
                continue;
            }
            let index = |end: Entity| {
                let (body, _) = insertion.given.get(end).ok()?;
                insertion.bodies.index(body.id)
            };
            let (Some(parent), Some(child)) = (index(joint.parent), index(joint.child)) else {
                continue;
            };
            // Whether joined bodies meet is for pairs to say.
            let made_now = insertion.bodies.simulation.join(
                parent,
                child,
                joint.parent_anchor,
                joint.child_anchor,
                &joint_spec(&joint),
                true,
            );
            insertion.bodies.joints.insert(entity, (joint, made_now));
            insertion.bodies.loose.remove(&number);
            made += 1;
        }
        if made == 0 {
            break;
        }
    }
    if insertion.bodies.revision.is_none() {
        let apart = insertion.bodies.apart(&insertion.effects);
        insertion.bodies.set_excluded(apart);
        insertion.bodies.revision = Some(insertion.effects.revision());
    }
}

fn joint_spec(joint: &Joint) -> JointSpec {
    let target = joint.target;
    match joint.kind {
        JointKind::Fixed => JointSpec::Fixed,
        JointKind::Revolute { axis, limits } => JointSpec::Revolute { axis, limits, target },
        JointKind::Prismatic { axis, limits } => JointSpec::Prismatic { axis, limits, target },
    }
}

type AnyChanged = Or<(
    Changed<Transform>,
    Changed<LinearVelocity>,
    Changed<AngularVelocity>,
    Changed<Friction>,
    Changed<Restitution>,
    Changed<Density>,
    Changed<GravityScale>,
    Changed<LockedAxes>,
    Changed<ExternalForce>,
)>;

/// Passes on what components say otherwise than the solver knows.
pub(crate) fn push_changes(
    changed: Query<(Given, &SolverBody), AnyChanged>,
    all: Query<(Given, &SolverBody)>,
    records: Res<Bodies>,
    mut bodies: ResMut<RigidBodies>,
    mut failure: ResMut<Failure>,
) {
    let bereft = std::mem::take(&mut bodies.bereft);
    let bereft = bereft.into_iter().filter_map(|entity| all.get(entity).ok());
    for (given, solved) in changed.iter().chain(bereft) {
        if let Err(source) = bodies.push(solved.index, given.values()) {
            let id = bodies.id(solved.index);
            let body = id.map_or("", |id| records.name(id)).to_owned();
            failure.set(SceneAppError::Solver { body, source });
        }
    }
}

/// Impulses act once.
pub(crate) fn push_impulses(
    mut given: Query<(&mut ExternalImpulse, &SolverBody), Changed<ExternalImpulse>>,
    mut bodies: ResMut<RigidBodies>,
) {
    for (mut impulse, solved) in &mut given {
        if *impulse != ExternalImpulse::default() {
            let [linear, angular] = [impulse.impulse, impulse.torque_impulse].map(widened);
            bodies.simulation.apply_impulse(solved.index, linear, angular);
            *impulse = ExternalImpulse::default();
        }
    }
}

pub(crate) fn push_gravity(gravity: Res<Gravity>, mut bodies: ResMut<RigidBodies>) {
    if gravity.is_changed() {
        bodies.simulation.set_gravity(gravity.0);
    }
}
