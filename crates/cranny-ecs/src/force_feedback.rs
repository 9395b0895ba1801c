//! `ForceFeedback`: what somebody's hand feels who moves a kinematic body: force and torque, at
//! 1 kHz from a scene of fewer steps.
//!
//! Between the poses of two steps body and obstacles move on screws; along those each tick lets a
//! [`Proxy`] follow the body. A device's own thread, which needs its forces at once, keeps a
//! [`Proxy`] itself and lets it follow among the obstacles of the last step.

mod constraints;
mod proxy;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::Remove;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_exact::{Aabb, Pose};
use cranny_geometry::Model;
use cranny_impact::Motion;
use cranny_narrow_phase::Placed;
use cranny_world::description::BodyKind;
use cranny_world::{BodyId, WorldError};

pub use self::proxy::{Obstacle, Proxy, Wrench};
use crate::body::{Bodies, Body, BodyRecord, pose_of};
use crate::clock::{CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};

/// Ticks a second; of a step as many as come nearest to it, and one at least.
const RATE: f64 = 1000.0;

/// The systems of `ForceFeedback`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ForceFeedbackSystems {
    /// [`ForceFeedbackReport`].
    Feel,
}

/// What kinematic bodies feel, from the poses at the beginning of the last step to those at the
/// beginning of this one.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct ForceFeedbackReport {
    /// Steps completed when the report was made.
    pub step: u64,
    /// One a body that feels, by ids.
    pub bodies: Vec<FeltForces>,
}

/// What a body feels in a step.
#[derive(Clone, Debug, PartialEq)]
pub struct FeltForces {
    /// The body.
    pub body: Entity,
    /// Its stable id.
    pub id: BodyId,
    /// Where it would be if it could not enter others.
    pub proxy: Pose,
    /// One a tick.
    pub wrenches: Vec<Wrench>,
}

impl ForceFeedbackReport {
    /// What a body feels; `None` where it does not.
    #[must_use]
    pub fn of(&self, body: Entity) -> Option<&FeltForces> {
        self.bodies.iter().find(|felt| felt.body == body)
    }
}

/// What is kept from step to step; its pair memories may be used by one thread at a time only.
#[derive(Resource, Default)]
struct Followed(Mutex<Proxies>);

impl Followed {
    fn proxies(&mut self) -> &mut Proxies {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Proxies, and where all bodies were a step ago.
#[derive(Default)]
struct Proxies {
    proxies: BTreeMap<BodyId, Proxy>,
    before: BTreeMap<BodyId, Pose>,
}

/// Keeps [`ForceFeedbackReport`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ForceFeedbackPlugin;

impl Plugin for ForceFeedbackPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ForceFeedbackReport>().init_resource::<Followed>();
        app.add_observer(forget);
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                feel.in_set(StepSystems::Report).in_set(ForceFeedbackSystems::Feel),
            );
        }
    }
}

/// A body that left is felt no more.
fn forget(removed: On<Remove<Body>>, bodies: Query<&Body>, mut followed: ResMut<Followed>) {
    if let Ok(&Body { id }) = bodies.get(removed.entity) {
        let proxies = followed.proxies();
        proxies.proxies.remove(&id);
        proxies.before.remove(&id);
    }
}

/// Where bodies are and what they feel.
#[derive(SystemParam)]
struct Surroundings<'w, 's> {
    bodies: Res<'w, Bodies>,
    effects: Res<'w, EffectTable>,
    transforms: Query<'w, 's, (&'static Body, &'static Transform)>,
}

/// A body's way since the last step.
struct Moving<'a> {
    id: BodyId,
    record: &'a BodyRecord,
    model: &'a Model,
    motion: Motion,
}

impl Moving<'_> {
    fn at(&self, time: f64) -> Placed<'_> {
        Placed { model: self.model, pose: self.motion.pose_at(time) }
    }

    /// A box that holds it at both ends of its way, grown by its diagonal: its way bends by less.
    fn around(&self) -> Aabb {
        let [start, end] = [0.0, 1.0].map(|time| {
            let bounds = self.model.bounds();
            self.motion.pose_at(time).world_from_body().bounds(&bounds)
        });
        start.union(&end).grown(start.diagonal())
    }
}

fn feel(
    scene: Surroundings,
    time: Res<SimulatedTime>,
    mut followed: ResMut<Followed>,
    mut report: ResMut<ForceFeedbackReport>,
    mut failure: ResMut<Failure>,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::ForceFeedback);
    let now: BTreeMap<BodyId, Pose> =
        scene.transforms.iter().map(|(body, transform)| (body.id, pose_of(transform))).collect();
    let Proxies { proxies, before } = followed.proxies();
    let before = std::mem::replace(before, now.clone());
    let ways: Vec<Moving<'_>> = now
        .iter()
        .filter_map(|(&id, &end)| {
            let record = scene.bodies.get(id)?;
            let start = before.get(&id).copied().unwrap_or(end);
            let (model, pivot) = (record.model()?, record.shape.center());
            Some(Moving { id, record, model, motion: Motion::between(start, end, pivot) })
        })
        .collect();
    report.step = time.steps();
    report.bodies.clear();
    if let Some(error) = felt_primitive(&scene) {
        failure.set(error);
        return;
    }
    let ticks = (RATE * time.step()).round().max(1.0) as u32;
    for body in ways.iter().filter(|way| way.record.kind == BodyKind::Kinematic) {
        let others: Vec<(&Moving<'_>, f64)> = ways
            .iter()
            .filter_map(|other| Some((other, scene.effects.felt_stiffness(body.id, other.id)?)))
            .collect();
        let Some(stiffness) = others.iter().map(|(_, stiffness)| *stiffness).reduce(f64::max)
        else {
            proxies.remove(&body.id);
            continue;
        };
        let proxy = proxies.entry(body.id).or_insert_with(|| Proxy::at(body.motion.start));
        let reach = body.around().grown(proxy.lag(body.motion.start));
        let near: Vec<&Moving<'_>> = others
            .iter()
            .map(|(other, _)| *other)
            .filter(|o| o.around().overlaps(&reach))
            .collect();
        let felt = felt(body, &near, proxy, ticks, stiffness);
        if let Some(wrenches) = failure.note(felt) {
            let (body, id) = (body.record.entity, body.id);
            report.bodies.push(FeltForces { body, id, proxy: proxy.pose(), wrenches });
        }
    }
}

/// A primitive that a body is to feel, as an error: what is felt is the contact of meshes.
fn felt_primitive(scene: &Surroundings) -> Option<SceneAppError> {
    let mut primitives = scene.bodies.iter().filter(|(_, record)| record.model().is_none());
    let felt = primitives.find(|&(id, _)| {
        scene.bodies.iter().any(|(body, _)| scene.effects.felt_stiffness(body, id).is_some())
    });
    let (_, record) = felt?;
    let what = record.shape.primitive()?.name();
    let effect = EffectKind::ForceFeedback.name();
    Some(SceneAppError::NeedsMesh { body: record.name.clone(), what, effect })
}

/// What a body feels on its way, tick by tick.
fn felt(
    body: &Moving<'_>,
    near: &[&Moving<'_>],
    proxy: &mut Proxy,
    ticks: u32,
    stiffness: f64,
) -> Result<Vec<Wrench>, WorldError> {
    let mut wrenches = Vec::with_capacity(ticks as usize);
    for tick in 1..=ticks {
        let time = f64::from(tick) / f64::from(ticks);
        let obstacles: Vec<Obstacle<'_>> =
            near.iter().map(|other| Obstacle { id: other.id, placed: other.at(time) }).collect();
        let followed = proxy.follow(body.at(time), &obstacles, stiffness);
        wrenches.push(followed.map_err(|(other, source)| {
            let other = near.iter().find(|near| near.id == other);
            let b = other.map(|near| near.record.name.clone()).unwrap_or_default();
            WorldError::Query { a: body.record.name.clone(), b, source: source.into() }
        })?);
    }
    Ok(wrenches)
}
