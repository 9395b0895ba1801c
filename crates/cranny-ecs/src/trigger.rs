//! `Trigger`: touching began, touching ended.

use std::collections::BTreeSet;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::Add;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use cranny_world::{BodyId, PairEventKind};

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

/// Two bodies touch no more, or one of them was removed. Told as [`CollisionStart`] is.
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

/// Tells [`CollisionStart`] and [`CollisionEnd`], and keeps [`TouchingBodies`].
#[derive(Clone, Copy, Debug, Default)]
pub struct TriggerPlugin;

impl Plugin for TriggerPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<CollisionStart>().add_message::<CollisionEnd>();
        app.add_observer(|added: On<Add<Body>>, mut commands: Commands| {
            commands.entity(added.entity).insert(TouchingBodies::default());
        });
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                tell_collisions
                    .in_set(StepSystems::Report)
                    .in_set(TriggerSystems::Report)
                    .after(DetectionSystems::Tally),
            );
        }
    }
}

fn tell_collisions(
    detected: Res<Detected>,
    effects: Res<EffectTable>,
    bodies: Res<Bodies>,
    mut touching: Query<&mut TouchingBodies, With<Body>>,
    mut starts: MessageWriter<CollisionStart>,
    mut ends: MessageWriter<CollisionEnd>,
    mut begun: Local<BTreeSet<Pair>>,
    mut commands: Commands,
) {
    for event in detected.report.iter().flat_map(|report| &report.events) {
        let began = match event.kind {
            PairEventKind::Began => true,
            PairEventKind::Ended => false,
            _ => continue,
        };
        // What began ends, whether or not it is still asked for.
        let pair = (event.a, event.b);
        let known = if began {
            effects.asks(EffectKind::Trigger, event.a, event.b) && begun.insert(pair)
        } else {
            begun.remove(&pair)
        };
        if !known {
            continue;
        }
        let (Some(a), Some(b)) = (bodies.entity(event.a), bodies.entity(event.b)) else { continue };
        let sides = [(a, b, [event.a, event.b]), (b, a, [event.b, event.a])];
        for (turn, (body, other, ids)) in sides.into_iter().enumerate() {
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
