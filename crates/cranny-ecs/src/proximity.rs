//! `Proximity`: how near bodies are that are near each other, and how fast they come nearer.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use cranny_exact::DVec3;
use cranny_world::BodyId;

use crate::body::Bodies;
use crate::clock::{CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::collision::Velocities;
use crate::detection::{Detected, DetectionSystems};
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable};

/// The systems of `Proximity`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProximitySystems {
    /// Detection, shared with other effects that need it.
    Detect,
    /// [`ProximityReport`].
    Report,
}

/// Pairs that are nearer than they are asked about, at the poses that the `Transform`s hold during
/// a step. What is farther apart cost the broad phase only.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct ProximityReport {
    /// Steps completed when the report was made.
    pub step: u64,
    /// One a pair, sorted by body ids.
    pub pairs: Vec<ProximityPair>,
}

/// How near two bodies are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProximityPair {
    /// The body from which it is seen: in the report the one with the lower id.
    pub body: Entity,
    /// The other.
    pub other: Entity,
    /// Their stable ids, in the same order.
    pub ids: [BodyId; 2],
    /// Between the surfaces, units of length, >= 0: 0 where they meet.
    pub distance: f64,
    /// A point of each that realises it, world coordinates.
    pub points: [DVec3; 2],
    /// How fast the points approach each other, units of length / second: < 0 where they part, 0
    /// where the surfaces meet.
    pub speed: f64,
}

impl ProximityPair {
    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        let ([a, b], [p, q]) = (self.ids, self.points);
        Self { body: self.other, other: self.body, ids: [b, a], points: [q, p], ..self }
    }
}

impl ProximityReport {
    /// The pairs of a body, seen from it.
    pub fn of(&self, body: Entity) -> impl Iterator<Item = ProximityPair> {
        let own = self.pairs.iter().filter(move |pair| pair.body == body || pair.other == body);
        own.map(move |pair| if pair.body == body { *pair } else { pair.flipped() })
    }

    /// The nearest of a body's pairs, seen from it; of equals that with the lowest id.
    #[must_use]
    pub fn nearest(&self, body: Entity) -> Option<ProximityPair> {
        self.of(body).min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

/// Keeps [`ProximityReport`].
#[derive(Clone, Copy, Debug, Default)]
pub struct ProximityPlugin;

impl Plugin for ProximityPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<ProximityReport>();
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                report_distances
                    .in_set(StepSystems::Report)
                    .in_set(ProximitySystems::Report)
                    .after(DetectionSystems::Tally),
            );
        }
    }
}

fn report_distances(
    detected: Res<Detected>,
    effects: Res<EffectTable>,
    bodies: Res<Bodies>,
    velocities: Velocities,
    time: Res<SimulatedTime>,
    mut report: ResMut<ProximityReport>,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Proximity);
    report.step = time.steps();
    report.pairs.clear();
    for pair in detected.report.iter().flat_map(|report| &report.answers) {
        let ids = [pair.a, pair.b];
        let Some(within) = effects.proximity(pair.a, pair.b) else { continue };
        let near = pair.answer.distance.filter(|distance| *distance < within);
        let (Some(distance), Some(witnesses)) = (near, pair.answer.witnesses) else { continue };
        let points = witnesses.map(|witness| witness.point);
        let way = (points[1] - points[0]).normalize_or_zero();
        let [of_a, of_b] = [0, 1].map(|k| velocities.at(&bodies, ids[k], points[k]));
        let entities = ids.map(|id| bodies.entity(id));
        let [Some(body), Some(other)] = entities else { continue };
        let speed = (of_a - of_b).dot(way);
        report.pairs.push(ProximityPair { body, other, ids, distance, points, speed });
    }
}
