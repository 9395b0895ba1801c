//! `Trigger`: touching began, touching ended.

use std::collections::{BTreeMap, BTreeSet};

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::{Add, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::query::{QueryData, QueryFilter};
use bevy_ecs::schedule::ScheduleLabel;
use bevy_ecs::system::SystemParam;
use cranny_world::{BodyId, PairAnswer};
#[cfg(feature = "record")]
use cranny_world::{PairEvent, PairEventKind};

use crate::body::{Bodies, Body};
use crate::clock::{CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
#[cfg(feature = "rapier")]
use crate::collision::hardest;
use crate::collision::{CollisionContact, Velocities, deepest, two_bodies};
use crate::detection::{Detected, DetectionSystems};
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable, Pair};
use crate::tracking::CertainPairs;

/// The systems of `Trigger`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TriggerSystems {
    /// Detection, shared with other effects that need it.
    Detect,
    /// Messages, events and [`TouchingBodies`].
    Report,
}

/// Two bodies began to touch or overlap: at the poses at the beginning of the step, or within it,
/// where the solver kept them apart. At the end of a run what the last step kept apart touches too.
///
/// Of pairs with [`Tracking`](crate::Tracking) it says that they overlap for certain, though poses
/// are known to a tolerance only.
///
/// As a message it is written once a pair, `body` having the lower id. As an event it is triggered
/// for each of the two entities, as `body`; for one that does not exist any more it is not.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct CollisionStart {
    /// The entity that the event is about.
    #[event_target]
    pub body: Entity,
    /// What it touches.
    pub other: Entity,
    /// Their stable ids, in the same order.
    pub ids: [BodyId; 2],
    /// Where and how hard, of pairs whose contacts somebody finds anyway: those with
    /// [`Response`](crate::Response) or [`Contacts`](crate::Contacts). `None` for pairs with
    /// [`Trigger`](crate::Trigger) alone, of which nothing but the verdict is computed.
    pub contact: Option<CollisionContact>,
    /// Whether they certainly touch. At a level or within a budget it may be open whether they do;
    /// then it counts as touching, so that no level misses a collision.
    pub is_certain: bool,
}

impl CollisionStart {
    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        let ([a, b], contact) = (self.ids, self.contact.map(CollisionContact::flipped));
        Self { body: self.other, other: self.body, ids: [b, a], contact, ..self }
    }
}

/// Two bodies touch no more (of pairs with [`Tracking`](crate::Tracking): for certain), or one of
/// them was removed. Reported as [`CollisionStart`] is.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionEnd {
    /// The entity that the event is about.
    #[event_target]
    pub body: Entity,
    /// What it touched.
    pub other: Entity,
    /// Their stable ids, in the same order.
    pub ids: [BodyId; 2],
}

impl CollisionEnd {
    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        let [a, b] = self.ids;
        Self { body: self.other, other: self.body, ids: [b, a] }
    }
}

/// What a body touches now among the pairs with `Trigger`, or may touch as far as is
/// known: [`StepReport::estimates`](cranny_world::StepReport::estimates) of [`Detected`]
/// say which verdicts are open.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq)]
pub struct TouchingBodies(BTreeMap<BodyId, Entity>);

impl TouchingBodies {
    /// Their entities, by ascending ids.
    pub fn entities(&self) -> impl ExactSizeIterator<Item = Entity> {
        self.0.values().copied()
    }

    /// Their stable ids, ascending.
    pub fn ids(&self) -> impl ExactSizeIterator<Item = BodyId> {
        self.0.keys().copied()
    }

    /// Whether an entity's body is among them.
    #[must_use]
    pub fn contains(&self, body: Entity) -> bool {
        self.entities().any(|touched| touched == body)
    }

    /// How many they are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether the body touches nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

two_bodies!(CollisionStart, CollisionEnd);

/// Pairs that touch and have `Trigger`, and what this step has changed about them.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct TriggeredPairs {
    touching: BTreeSet<Pair>,
    /// Ascending.
    changed: Vec<Pair>,
}

impl TriggeredPairs {
    pub(crate) fn touches(&self, pair: Pair) -> bool {
        self.touching.contains(&pair)
    }

    /// What began and what ended in this step, ascending.
    #[cfg(feature = "record")]
    pub(crate) fn events(&self) -> impl Iterator<Item = PairEvent> {
        self.changed.iter().map(|&pair| {
            let began = self.touching.contains(&pair);
            let kind = if began { PairEventKind::Began } else { PairEventKind::Ended };
            PairEvent { a: pair.0, b: pair.1, kind }
        })
    }
}

/// How often pairs with `Trigger` began to touch, for a run's summary. An app that puts none in has
/// none kept.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct TriggerLog(BTreeMap<Pair, Fired>);

/// How often, and when first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fired {
    /// Beginnings, >= 1.
    pub times: u64,
    /// Of these, those with an open verdict.
    pub open: u64,
    /// Steps completed at the first.
    pub step: u64,
}

impl TriggerLog {
    /// Pairs that touched, ascending, the lower id first.
    pub fn pairs(&self) -> impl ExactSizeIterator<Item = ((BodyId, BodyId), Fired)> {
        self.0.iter().map(|(&pair, &fired)| (pair, fired))
    }

    /// Whether a summary will name a body.
    pub(crate) fn mentions(&self, body: BodyId) -> bool {
        self.0.keys().any(|&(a, b)| a == body || b == body)
    }

    fn note(&mut self, pair: Pair, step: u64, is_certain: bool) {
        let fired = self.0.entry(pair).or_insert(Fired { times: 0, open: 0, step });
        fired.times += 1;
        fired.open += u64::from(!is_certain);
    }
}

/// Reports [`CollisionStart`] and [`CollisionEnd`], and keeps [`TouchingBodies`].
#[derive(Clone, Copy, Debug, Default)]
pub struct TriggerPlugin;

impl Plugin for TriggerPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<CollisionStart>().add_message::<CollisionEnd>();
        app.init_resource::<TriggeredPairs>();
        app.add_observer(|added: On<Add<Body>>, mut commands: Commands| {
            commands.entity(added.entity).insert(TouchingBodies::default());
        });
        app.add_observer(|removed: On<Remove<Body>>, mut commands: Commands| {
            commands.entity(removed.entity).try_remove::<TouchingBodies>();
        });
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                report_collisions
                    .in_set(StepSystems::Report)
                    .in_set(TriggerSystems::Report)
                    .after(DetectionSystems::Tally),
            );
        }
    }
}

/// What is known of the contact of a pair that began to touch.
#[derive(SystemParam)]
struct Beginnings<'w, 's> {
    velocities: Velocities<'w, 's>,
    #[cfg(feature = "rapier")]
    solver: Option<Res<'w, crate::solved::RigidBodies>>,
}

impl Beginnings<'_, '_> {
    /// Seen from the body with the lower id.
    fn contact(
        &self,
        bodies: &Bodies,
        answers: &[PairAnswer],
        (a, b): Pair,
    ) -> Option<CollisionContact> {
        let at = answers.binary_search_by_key(&(a, b), |pair| (pair.a, pair.b)).ok();
        let point = at.and_then(|at| deepest(&answers[at].answer));
        // What the solver carries on from an older step was not detected in this one.
        #[cfg(feature = "rapier")]
        let point = point.or_else(|| {
            let carried = self.solver.as_ref()?.contacts_of((a, b))?;
            deepest(&carried.answer)
        });
        // What others read may hold fewer contacts than the solver had.
        #[cfg(feature = "rapier")]
        let point = point.or_else(|| hardest(&self.solver.as_ref()?.presses((a, b))));
        let deepest = point?;
        let speed = self.velocities.closing(bodies, [a, b], &deepest);
        #[cfg(feature = "rapier")]
        let impulse = self.solver.as_ref().map_or(0.0, |solver| solver.impulse(a, b));
        #[cfg(not(feature = "rapier"))]
        let impulse = 0.0;
        Some(CollisionContact { deepest, impulse, speed })
    }
}

fn report_collisions(
    detected: Res<Detected>,
    effects: Res<EffectTable>,
    bodies: Res<Bodies>,
    beginnings: Beginnings,
    mut touching: Query<&mut TouchingBodies, With<Body>>,
    mut starts: MessageWriter<CollisionStart>,
    mut ends: MessageWriter<CollisionEnd>,
    mut triggered: ResMut<TriggeredPairs>,
    mut commands: Commands,
    certain: Option<Res<CertainPairs>>,
    (time, mut log): (Res<SimulatedTime>, Option<ResMut<TriggerLog>>),
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Trigger);
    let Some(report) = &detected.report else { return };
    // By the current effects: one that comes or goes begins and ends what touches.
    let touches = report.touching.iter().copied();
    let touches = touches.filter(|&(a, b)| effects.asks(EffectKind::Trigger, a, b));
    // Of poses that are imprecise the verdict is no evidence.
    let precise = touches.filter(|&(a, b)| effects.tracked(a, b).is_none());
    let now: BTreeSet<Pair> = precise.chain(certain.iter().flat_map(|c| c.iter())).collect();
    let before = std::mem::replace(&mut triggered.touching, now);
    triggered.changed = before.symmetric_difference(&triggered.touching).copied().collect();
    for &pair @ (id_a, id_b) in &triggered.changed {
        let (Some(a), Some(b)) = (bodies.entity(id_a), bodies.entity(id_b)) else { continue };
        if triggered.touching.contains(&pair) {
            let is_certain = !report.is_open(pair.0, pair.1);
            if let Some(log) = &mut log {
                log.note(pair, time.steps(), is_certain);
            }
            let contact = beginnings.contact(&bodies, &report.answers, pair);
            let start =
                CollisionStart { body: a, other: b, ids: [id_a, id_b], contact, is_certain };
            starts.write(start);
            for start in [start, start.flipped()] {
                if let Ok(mut set) = touching.get_mut(start.body) {
                    set.0.insert(start.ids[1], start.other);
                    commands.trigger(start);
                }
            }
        } else {
            let end = CollisionEnd { body: a, other: b, ids: [id_a, id_b] };
            ends.write(end);
            for end in [end, end.flipped()] {
                // A body that was removed hears nothing; its partner does.
                if let Ok(mut set) = touching.get_mut(end.body) {
                    set.0.remove(&end.ids[1]);
                    commands.trigger(end);
                }
            }
        }
    }
}
