//! `Proximity`: how near bodies are that are near each other, and how fast they come nearer.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use cranny_exact::DVec3;
use cranny_world::{BodyId, StepReport};

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

/// Pairs that are nearer than `Proximity` reaches for them, at the poses that the `Transform`s hold
/// during a step. What is farther apart cost the broad phase only.
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
    /// Between the surfaces, units of length, >= 0: 0 where they meet, and where a primitive meets
    /// the other or lies in it. At a level or within a budget, the least that it can be.
    pub distance: f64,
    /// The most that the distance can be: `distance`, but at a level or within a budget.
    pub at_most: f64,
    /// A point of each that realises `distance`, world coordinates; `None` where surfaces cross,
    /// and where a primitive meets the other or lies in it. At a level or within a budget, the
    /// nearest points that were tested in this step, a common one where surfaces are known to meet;
    /// `None` where the budget left no test for the pair.
    pub points: Option<[DVec3; 2]>,
    /// How fast the points approach each other, units of length / second: < 0 where they part, 0
    /// where the surfaces meet. `None` where `points` is, unless they are known to meet.
    pub speed: Option<f64>,
}

impl ProximityPair {
    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        let ([a, b], points) = (self.ids, self.points.map(|[p, q]| [q, p]));
        Self { body: self.other, other: self.body, ids: [b, a], points, ..self }
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
    for found in detected.report.iter().flat_map(distances) {
        let Found { ids, distance, at_most, points, meets } = found;
        let within = effects.proximity(ids[0], ids[1]);
        let [Some(body), Some(other)] = ids.map(|id| bodies.entity(id)) else { continue };
        if within.is_none_or(|within| distance >= within) {
            continue;
        }
        let along = points.map(|points| {
            let way = (points[1] - points[0]).normalize_or_zero();
            let [of_a, of_b] = [0, 1].map(|k| velocities.at(&bodies, ids[k], points[k]));
            (of_a - of_b).dot(way)
        });
        let speed = if meets { Some(0.0) } else { along };
        report.pairs.push(ProximityPair { body, other, ids, distance, at_most, points, speed });
    }
    report.pairs.sort_by_key(|pair| pair.ids);
}

/// What is known of a distance.
struct Found {
    ids: [BodyId; 2],
    distance: f64,
    at_most: f64,
    points: Option<[DVec3; 2]>,
    /// The surfaces share a point.
    meets: bool,
}

/// The distances that a step found, exact ones first.
fn distances(report: &StepReport) -> impl Iterator<Item = Found> {
    let exact = report.answers.iter().filter_map(|pair| {
        let distance = pair.answer.distance?;
        let points = pair.answer.witnesses.map(|both| both.map(|witness| witness.point));
        let meets = pair.answer.surface.meets();
        Some(Found { ids: [pair.a, pair.b], distance, at_most: distance, points, meets })
    });
    let estimated = report.estimates.iter().map(|pair| Found {
        ids: [pair.a, pair.b],
        distance: pair.separation.lo,
        at_most: pair.separation.hi,
        points: pair.points,
        meets: pair.separation.hi <= 0.0,
    });
    exact.chain(estimated)
}
