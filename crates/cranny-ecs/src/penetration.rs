//! `Penetration`: how deep bodies overlap, and a way out, for whoever has no solver.

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use cranny_exact::DVec3;
use cranny_narrow_phase::Answer;
use cranny_primitives::{PlacedShape, way_apart_of_shapes};
use cranny_world::{BodyId, WorldError};

use crate::body::Bodies;
use crate::clock::{CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::collision::deepest;
use crate::detection::{Detected, DetectionSystems, Detector};
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable};
use crate::error::Failure;

/// The systems of `Penetration`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PenetrationSystems {
    /// Detection, shared with other effects that need it.
    Detect,
    /// [`PenetrationReport`].
    Report,
}

/// Pairs that overlap, at the poses that the `Transform`s hold during a step. What does not overlap
/// costs a verdict, and beyond its boxes nothing.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct PenetrationReport {
    /// Steps completed when the report was made.
    pub step: u64,
    /// One a pair whose interiors meet, sorted by body ids.
    pub pairs: Vec<PenetrationPair>,
}

/// How two bodies overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenetrationPair {
    /// The body from which it is seen: in the report the one with the lower id.
    pub body: Entity,
    /// The other.
    pub other: Entity,
    /// Their stable ids, in the same order.
    pub ids: [BodyId; 2],
    /// Where they overlap deepest, halfway between both surfaces, world coordinates; `None` where
    /// one lies wholly inside the other.
    pub point: Option<DVec3>,
    /// The depth of their deepest region of contact, along its normal, > 0; beside a primitive that
    /// of the deepest contact. `None` where one lies wholly inside the other, or a surface is open.
    pub depth: Option<f64>,
    /// By which translation `other` gets out, in the world: confirmed by a query there, or by a
    /// plane that parts the hulls. Not always the shortest.
    pub way: DVec3,
}

impl PenetrationPair {
    /// Seen from the other body.
    #[must_use]
    pub fn flipped(self) -> Self {
        let [a, b] = self.ids;
        Self { body: self.other, other: self.body, ids: [b, a], way: -self.way, ..self }
    }
}

impl PenetrationReport {
    /// The pairs of a body, seen from it.
    pub fn of(&self, body: Entity) -> impl Iterator<Item = PenetrationPair> {
        let own = self.pairs.iter().filter(move |pair| pair.body == body || pair.other == body);
        own.map(move |pair| if pair.body == body { *pair } else { pair.flipped() })
    }
}

/// Keeps [`PenetrationReport`].
#[derive(Clone, Copy, Debug, Default)]
pub struct PenetrationPlugin;

impl Plugin for PenetrationPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PenetrationReport>();
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                report_overlaps
                    .in_set(StepSystems::Report)
                    .in_set(PenetrationSystems::Report)
                    .after(DetectionSystems::Tally),
            );
        }
    }
}

fn report_overlaps(
    detected: Res<Detected>,
    mut detector: ResMut<Detector>,
    effects: Res<EffectTable>,
    bodies: Res<Bodies>,
    time: Res<SimulatedTime>,
    mut report: ResMut<PenetrationReport>,
    mut failure: ResMut<Failure>,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Penetration);
    report.step = time.steps();
    report.pairs.clear();
    for pair in detected.report.iter().flat_map(|report| &report.answers) {
        let ids = [pair.a, pair.b];
        let asked = effects.asks(EffectKind::Penetration, pair.a, pair.b);
        if !asked || !pair.answer.solid {
            continue;
        }
        let [Some(a), Some(b)] = ids.map(|id| bodies.get(id)) else { continue };
        let (poses, _) = detector.poses(pair.a, pair.b);
        let placed = |k: usize| PlacedShape { shape: &[a, b][k].shape, pose: poses[k] };
        let way = way_apart_of_shapes(placed(0), placed(1), &pair.answer)
            .map_err(|source| WorldError::Query { a: a.name.clone(), b: b.name.clone(), source });
        let Some(way) = failure.note(way).flatten() else { continue };
        let (body, other) = (a.entity, b.entity);
        let is_primitive = a.model().and(b.model()).is_none();
        let depth =
            if is_primitive { depth_of_contacts(&pair.answer) } else { depth_of(&pair.answer) };
        let point = deepest(&pair.answer).map(|at| at.point);
        report.pairs.push(PenetrationPair { body, other, ids, point, depth, way });
    }
}

/// Of the deepest contact: answers about primitives have no regions.
fn depth_of_contacts(answer: &Answer) -> Option<f64> {
    Some(answer.depth()).filter(|depth| *depth > 0.0 && answer.contained.is_none())
}

/// Of the deepest region.
fn depth_of(answer: &Answer) -> Option<f64> {
    let depths = answer.regions.iter().filter_map(|region| region.depth);
    depths.filter(|depth| *depth > 0.0 && answer.contained.is_none()).reduce(f64::max)
}
