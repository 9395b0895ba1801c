//! `Trigger`: touching began, touching ended.

use std::collections::BTreeSet;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::{Add, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use cranny_world::BodyId;
#[cfg(feature = "record")]
use cranny_world::{PairEvent, PairEventKind};

use crate::body::{Bodies, Body};
use crate::clock::{CrannyEnd, CrannyStep, StepSystems};
use crate::detection::{Detected, DetectionSystems};
use crate::effects::{EffectKind, EffectTable, Pair};

/// The systems of `Trigger`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TriggerSystems {
    /// Detection, shared with other effects that need it.
    Detect,
    /// Messages, events and [`TouchingBodies`].
    Report,
}

/// Two bodies began to touch or overlap.
///
/// As a message it is written once a pair, `body` having the lower id. As an event it is triggered
/// for each of the two entities, as `body`; for one that does not exist any more it is not.
#[derive(Message, EntityEvent, Clone, Copy, Debug, PartialEq, Eq)]
pub struct CollisionStart {
    /// The entity that the event is about.
    #[event_target]
    pub body: Entity,
    /// What it touches.
    pub other: Entity,
    /// Their stable ids, in the same order.
    pub ids: [BodyId; 2],
}

/// Two bodies touch no more, or one of them was removed. Reported as [`CollisionStart`] is.
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

/// What a body touches now, by id, among the pairs that are asked for `Trigger`.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq)]
pub struct TouchingBodies(pub BTreeSet<BodyId>);

/// Pairs that touch and ask for `Trigger`, and what this step has changed about them.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct TriggeredPairs {
    touching: BTreeSet<Pair>,
    /// Ascending.
    changed: Vec<Pair>,
}

impl TriggeredPairs {
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

fn report_collisions(
    detected: Res<Detected>,
    effects: Res<EffectTable>,
    bodies: Res<Bodies>,
    mut touching: Query<&mut TouchingBodies, With<Body>>,
    mut starts: MessageWriter<CollisionStart>,
    mut ends: MessageWriter<CollisionEnd>,
    mut triggered: ResMut<TriggeredPairs>,
    mut commands: Commands,
) {
    let Some(report) = &detected.report else { return };
    // By what is asked now: an effect that comes or goes begins and ends what touches.
    let touches = report.touching.iter().copied();
    let now: BTreeSet<Pair> =
        touches.filter(|&(a, b)| effects.asks(EffectKind::Trigger, a, b)).collect();
    let before = std::mem::replace(&mut triggered.touching, now);
    triggered.changed = before.symmetric_difference(&triggered.touching).copied().collect();
    for &(id_a, id_b) in &triggered.changed {
        let began = triggered.touching.contains(&(id_a, id_b));
        let (Some(a), Some(b)) = (bodies.entity(id_a), bodies.entity(id_b)) else { continue };
        for (turn, (body, other, ids)) in
            [(a, b, [id_a, id_b]), (b, a, [id_b, id_a])].into_iter().enumerate()
        {
            let (start, end) =
                (CollisionStart { body, other, ids }, CollisionEnd { body, other, ids });
            match (turn, began) {
                (0, true) => drop(starts.write(start)),
                (0, false) => drop(ends.write(end)),
                _ => {}
            }
            // A body that was removed hears nothing; its partner does.
            let Ok(mut set) = touching.get_mut(body) else { continue };
            if began {
                set.0.insert(ids[1]);
                commands.trigger(start);
            } else {
                set.0.remove(&ids[1]);
                commands.trigger(end);
            }
        }
    }
}
