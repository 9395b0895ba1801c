//! Observers and systems that keep the solver's bodies in step with the app's entities.

use std::collections::BTreeSet;

use bevy_app::App;
use bevy_ecs::lifecycle::{Insert, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_rapier::{BodyIndex, JointIndex, JointSpec, Motor, Resistance, Simulation};
use cranny_world::BodyId;
use cranny_world::description::{BodyKind, JointKind, Spring};

use super::given::Given;
use super::{RigidBodies, SolverBody};
use crate::body::{Bodies, Body, widened};
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};
use crate::joints::Joint;
use crate::kinematics::Kinematic;
use crate::properties::{
    AngularDamping, AngularVelocity, Density, ExternalForce, ExternalImpulse, Friction,
    GravityScale, LinearDamping, LinearVelocity, LockedAxes, Mass, Restitution, Sleeping,
};
use crate::response::Gravity;

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
                self.bodies.hooks_are_current = false;
                true
            }
            Err(source) => {
                let body = record.name.clone();
                self.failure.set(SceneAppError::Solver { body, source });
                false
            }
        }
    }

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
                entity.try_remove::<(SolverBody, Sleeping)>();
                if record.kind == BodyKind::Kinematic {
                    entity.insert(Kinematic::of(&record.shape));
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
        let mass = given.values().mass_source();
        if let Err(source) = insertion.bodies.change(index, record, effects, mass) {
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
        commands.entity(removed.entity).try_remove::<(SolverBody, Sleeping)>();
    }
}

type Defaulted = (
    Friction,
    Restitution,
    Density,
    Mass,
    GravityScale,
    LinearDamping,
    AngularDamping,
    LockedAxes,
    ExternalForce,
);

fn note_lost(lost: On<Remove<Defaulted>>, mut bodies: ResMut<RigidBodies>) {
    bodies.bereft.push(lost.entity);
}

fn note_joint(inserted: On<Insert<Joint>>, joints: Query<&Joint>, mut bodies: ResMut<RigidBodies>) {
    let entity = inserted.entity;
    if let (Some(&(before, index)), Ok(&now)) = (bodies.joints.get(&entity), joints.get(entity)) {
        let as_before = Joint { motor: before.motor, resistance: before.resistance, ..now };
        let (motor, resistance) = driven(&now);
        if as_before == before && bodies.simulation.set_motor(index, motor, resistance) {
            bodies.joints.insert(entity, (now, index));
            return;
        }
    }
    if let Some((_, index)) = bodies.joints.remove(&entity) {
        bodies.simulation.part(index);
        bodies.uncouple(entity);
    }
    bodies.loosen(entity);
}

fn part(removed: On<Remove<Joint>>, mut bodies: ResMut<RigidBodies>) {
    bodies.loose.retain(|_, waiting| *waiting != removed.entity);
    if let Some((_, index)) = bodies.joints.remove(&removed.entity) {
        bodies.simulation.part(index);
        bodies.uncouple(removed.entity);
        // What it held may have no part in any response now.
        bodies.members_are_current = false;
    }
}

/// Looks again who takes part, where effects have changed.
pub(crate) fn relate(mut insertion: Insertion) {
    let bodies = &mut insertion.bodies;
    let asked = bodies.asked.as_ref().map(EffectTable::revision);
    if !bodies.members_are_current || asked != Some(insertion.effects.revision()) {
        bodies.members_are_current = true;
        let outside: Vec<Entity> = insertion
            .effects
            .bodies()
            .filter(|&id| insertion.bodies.index(id).is_none() && insertion.effects.responds(id))
            .filter_map(|id| insertion.records.entity(id))
            .collect();
        for entity in outside {
            insertion.insert(entity);
        }
        insertion.take_out_idle();
    }
}

/// Sets for which bodies a step decides whether they respond, once it is known who takes part.
pub(crate) fn set_hooks(effects: Res<EffectTable>, mut bodies: ResMut<RigidBodies>) {
    let same = bodies.asked.as_ref().is_some_and(|asked| asked.revision() == effects.revision());
    if same && bodies.hooks_are_current {
        return;
    }
    bodies.set_hooked(&effects);
    bodies.hooks_are_current = true;
    if !same {
        if let Some(before) = bodies.asked.replace(effects.clone()) {
            bodies.reconsider(&before, &effects);
        }
        bodies.reading_is_current = false;
    }
}

/// Says whose contacts are read, in the solver's step.
pub(crate) fn refresh_reading(effects: Res<EffectTable>, mut bodies: ResMut<RigidBodies>) {
    let bodies = &mut *bodies;
    if !bodies.reading_is_current && effects.has_plugin(EffectKind::Contacts) {
        let count = bodies.known.last_key_value().map_or(0, |(index, _)| index.0 + 1);
        let ids = (0..count).map(|index| bodies.id(BodyIndex(index))).collect();
        let mut reading = bodies.reading();
        (reading.ids, reading.effects) = (ids, effects.clone());
    }
    bodies.reading_is_current = true;
}

/// Makes joints of which both ends are bodies, one of them in the solver's world.
pub(crate) fn join(joints: Query<&Joint>, mut insertion: Insertion) {
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
            let of = ends.map(|end| insertion.given.get(end).ok().map(|(body, _)| body.id));
            let [Some(a), Some(b)] = of else { continue };
            let is_in = |id: BodyId| insertion.bodies.index(id).is_some();
            let joins = a != b && joint.kind != JointKind::Floating;
            let held = joins && (is_in(a) || is_in(b));
            if !held || !ends.iter().all(|&end| insertion.insert(end)) {
                continue;
            }
            let [Some(parent), Some(child)] = [a, b].map(|id| insertion.bodies.index(id)) else {
                continue;
            };
            let made_now = solver_joint(&mut insertion.bodies.simulation, [parent, child], &joint);
            insertion.bodies.joints.insert(entity, (joint, made_now));
            if joint.follows.is_some() {
                insertion.bodies.uncoupled.insert(entity);
            }
            insertion.bodies.loose.remove(&number);
            made += 1;
        }
        if made == 0 {
            break;
        }
    }
    insertion.bodies.couple();
}

/// Whether joined bodies meet is for pairs to say.
fn solver_joint(simulation: &mut Simulation, ends: [BodyIndex; 2], joint: &Joint) -> JointIndex {
    let (spec, anchors) = (joint_spec(joint), [joint.parent_anchor, joint.child_anchor]);
    if joint.reduced {
        let (_, resistance) = driven(joint);
        return simulation.join_reduced(ends, anchors, &spec, resistance, joint.start);
    }
    simulation.join(ends[0], ends[1], anchors[0], anchors[1], &spec, true)
}

/// What drives and what resists a joint, as the solver says it.
fn driven(joint: &Joint) -> (Option<Motor>, Resistance) {
    let motor = joint.motor.map(|motor| Motor {
        position: motor.position,
        velocity: motor.velocity,
        effort: motor.effort,
        stiffness: motor.stiffness,
        damping: motor.damping,
        max_effort: motor.max_effort,
        max_velocity: motor.max_velocity,
    });
    let (damping, friction) = (joint.resistance.damping, joint.resistance.friction);
    (motor, Resistance { damping, friction })
}

fn joint_spec(joint: &Joint) -> JointSpec {
    let (motor, _) = driven(joint);
    match joint.kind {
        // The last is never joined.
        JointKind::Fixed | JointKind::Floating => JointSpec::Fixed,
        JointKind::Revolute { axis, limits } => JointSpec::Revolute { axis, limits, motor },
        JointKind::Prismatic { axis, limits } => JointSpec::Prismatic { axis, limits, motor },
        JointKind::Planar { normal } => JointSpec::Planar { normal },
        JointKind::Ball => JointSpec::Ball,
        JointKind::Rope { length } => JointSpec::Rope { length },
        JointKind::Spring(Spring { length, stiffness, damping }) => {
            JointSpec::Spring { length, stiffness, damping }
        }
    }
}

type AnyChanged = Or<(
    Changed<Transform>,
    Changed<LinearVelocity>,
    Changed<AngularVelocity>,
    Changed<Friction>,
    Changed<Restitution>,
    Changed<Density>,
    Changed<Mass>,
    Changed<GravityScale>,
    Changed<LinearDamping>,
    Changed<AngularDamping>,
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
