//! What tracking made of contacts: those of the true motion, of the poses as they came, and of the
//! body as it was shown.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::sync::{Mutex, PoisonError};

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_exact::Pose;
use cranny_narrow_phase::{Answer, Demand, PairMemory, Query as PairQuery};
use cranny_primitives::{PlacedShape, query_shapes};
use cranny_world::description::TrackerDescription;
use cranny_world::{BodyId, WorldError};

use super::judged::{Stretches, TrueContacts, Window, judged};
use super::{SimulatedTracker, Tracker, TrackerCounts, is_beyond};
use crate::body::{Bodies, Body, BodyRecord, pose_of};
use crate::clock::SimulatedTime;
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable, ordered};
use crate::error::Failure;
use crate::properties::RigidBody;
use crate::summary::TrackingSummary;
use crate::trigger::TriggeredPairs;

/// A tracked body beside another one.
#[derive(Debug)]
struct Compared {
    /// As poses arrive, and as they are shown.
    windows: [Window; 2],
    truth: TrueContacts,
    raw: Stretches,
    reported: Stretches,
    memories: [PairMemory; 2],
}

impl Compared {
    fn new(timings: &Timings) -> Self {
        Self {
            windows: timings.windows,
            truth: TrueContacts::new(timings.long),
            raw: Stretches::default(),
            reported: Stretches::default(),
            memories: Default::default(),
        }
    }
}

/// Of one tracked body.
#[derive(Debug, Default)]
struct ComparedBody {
    name: String,
    others: BTreeMap<BodyId, Compared>,
    uncompared: BTreeSet<BodyId>,
    poses: TrackerCounts,
    missing: u64,
}

/// What simulated devices made of contacts, for a run's summary.
#[derive(Resource, Debug, Default)]
pub struct TrackingLog(Mutex<BTreeMap<BodyId, ComparedBody>>);

impl TrackingLog {
    /// One a tracked body, by ids, over all others together.
    #[must_use]
    pub fn bodies(&self) -> Vec<TrackingSummary> {
        let bodies = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        bodies.values().map(ComparedBody::summary).collect()
    }
}

impl ComparedBody {
    fn summary(&self) -> TrackingSummary {
        let TrackerCounts { reported, late, refused, lost } = self.poses;
        let mut sum = TrackingSummary {
            body: self.name.clone(),
            poses: reported,
            late,
            refused,
            missing: self.missing,
            lost,
            uncompared: self.uncompared.len(),
            ..TrackingSummary::default()
        };
        for Compared { windows, truth, raw, reported, .. } in self.others.values() {
            sum.truth += truth.stretches.all.len();
            sum.raw = sum.raw.join(judged(truth, raw, windows[0]));
            sum.filtered = sum.filtered.join(judged(truth, reported, windows[1]));
        }
        sum
    }
}

/// A body whose device is simulated.
type Tracked<'a> = (&'a Body, &'a SimulatedTracker, &'a Tracker, &'a Transform);

/// Where bodies are.
#[derive(SystemParam)]
pub(super) struct Present<'w, 's> {
    bodies: Res<'w, Bodies>,
    effects: Res<'w, EffectTable>,
    triggered: Res<'w, TriggeredPairs>,
    time: Res<'w, SimulatedTime>,
    devices: Query<'w, 's, Tracked<'static>>,
    transforms: Query<'w, 's, (Entity, &'static Body, &'static Transform, &'static RigidBody)>,
}

pub(super) fn compare(
    present: Present,
    mut log: ResMut<TrackingLog>,
    mut failure: ResMut<Failure>,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Tracking);
    let log = log.0.get_mut().unwrap_or_else(PoisonError::into_inner);
    for tracked in &present.devices {
        let (body, device, tracker, _) = tracked;
        let Some(record) = present.bodies.get(body.id) else { continue };
        let named = || ComparedBody { name: record.name.clone(), ..ComparedBody::default() };
        let kept = log.entry(body.id).or_insert_with(named);
        (kept.poses, kept.missing) = (tracker.counts(), device.missing());
        failure.note(present.compare_all(kept, tracked));
    }
}

/// A time that is a whole number of steps but for this share of it is one. Smaller: quotients of
/// decimal fractions miss it; larger: what is a little longer loses the step that it needs.
const ROUNDING: f64 = 1e-9;

/// What depends on devices and settings alone.
#[derive(Clone, Copy, Debug)]
struct Timings {
    /// As poses arrive, and as they are shown.
    windows: [Window; 2],
    /// How many steps in a row a contact has to be deep, so that a device measures it.
    long: u64,
}

impl Timings {
    /// Of a pair of two.
    fn join(self, other: Option<Self>) -> Self {
        let Some(other) = other else { return self };
        let [raw, shown] = self.windows;
        let windows = [raw.join(other.windows[0]), shown.join(other.windows[1])];
        Self { windows, long: self.long.max(other.long) }
    }
}

/// How many samples, a step apart, surely span one of a device whose poses are so many steps apart.
/// Where that is a whole number, each of its poses is measured at a step.
fn samples_across(steps: f64) -> u64 {
    if steps.fract() == 0.0 { steps as u64 } else { steps.ceil() as u64 + 1 }
}

/// A body at its true pose, and at the one that arrived last.
struct BothPoses<'a> {
    id: BodyId,
    record: &'a BodyRecord,
    poses: [Pose; 2],
}

impl Present<'_, '_> {
    /// Compares a body with all others, but those beside which it counts already.
    fn compare_all(&self, kept: &mut ComparedBody, own: Tracked) -> Result<(), WorldError> {
        let Some(body) = self.both_poses(own) else { return Ok(()) };
        let pushes = self.effects.has_plugin(EffectKind::Response);
        for (entity, other, at, kind) in &self.transforms {
            let pair = ordered(body.id, other.id);
            let Some(tolerance) = self.effects.tracked(pair.0, pair.1) else { continue };
            let partner = self.devices.get(entity).ok();
            if partner.is_some() && other.id < body.id {
                continue;
            }
            if pushes && *kind == RigidBody::Dynamic {
                kept.uncompared.insert(other.id);
                continue;
            }
            let Some(record) = self.bodies.get(other.id) else { continue };
            let still = BothPoses { id: other.id, record, poses: [pose_of(at); 2] };
            let seen = partner.and_then(|partner| self.both_poses(partner)).unwrap_or(still);
            let timings = || self.timings(own).join(partner.map(|partner| self.timings(partner)));
            let new = || Compared::new(&timings());
            let compared = kept.others.entry(other.id).or_insert_with(new);
            self.note(compared, [&body, &seen], tolerance)?;
        }
        Ok(())
    }

    fn both_poses(&self, (body, device, _, transform): Tracked) -> Option<BothPoses<'_>> {
        let raw = device.arrived().unwrap_or_else(|| pose_of(transform));
        let poses = [device.truth(self.time.seconds()), raw];
        self.bodies.get(body.id).map(|record| BothPoses { id: body.id, record, poses })
    }

    /// How old a pose is as it arrives, and as the body is shown at it.
    fn timings(&self, (_, device, tracker, _): Tracked) -> Timings {
        let (settings, device) = (*tracker.settings(), *device.device());
        // A low pass shows a step to 1 - 1/e after 1 / (2 pi cutoff), and nearly all after thrice.
        let lag = settings.smoothing.map_or(0.0, |s| 3.0 / (TAU * s.min_cutoff));
        let window = |least, most, lag| Window {
            least: self.steps(least).floor() as u64,
            most: self.steps(most).ceil() as u64,
            lag: self.steps(lag).ceil() as u64,
        };
        let shown = TrackerDescription { settings, device }.greatest_age(self.time.step());
        let windows = [
            window(device.latency, device.greatest_age(), 0.0),
            window(device.latency.max(settings.delay), shown, lag),
        ];
        Timings { windows, long: samples_across(self.steps(1.0 / device.rate)) }
    }

    /// In how many steps so long passes, a whole number to rounding.
    fn steps(&self, seconds: f64) -> f64 {
        let steps = seconds / self.time.step();
        let whole = steps.round();
        if (steps - whole).abs() <= ROUNDING * whole { whole } else { steps }
    }

    /// Takes note of a pair in this step.
    fn note(
        &self,
        compared: &mut Compared,
        pair: [&BothPoses; 2],
        tolerance: f64,
    ) -> Result<(), WorldError> {
        let deep = 2.0 * tolerance;
        let memories = &mut compared.memories;
        let real = answer(pair, 0, Demand::contacts(deep), &mut memories[0])?;
        let seen = answer(pair, 1, Demand::Intersects, &mut memories[1])?;
        let step = self.time.steps();
        let is_deep = real.as_ref().is_some_and(|real| is_beyond(real, deep));
        let touches = |answer: &Option<Answer>| answer.as_ref().is_some_and(Answer::touches);
        compared.truth.note(step, touches(&real), is_deep);
        compared.raw.note(step, touches(&seen));
        let reported = self.triggered.touches(ordered(pair[0].id, pair[1].id));
        compared.reported.note(step, reported);
        Ok(())
    }
}

/// The answer at the poses of one kind; `None` where the bodies are too far apart to touch.
fn answer(
    pair: [&BothPoses; 2],
    kind: usize,
    demand: Demand,
    memory: &mut PairMemory,
) -> Result<Option<Answer>, WorldError> {
    let reach: f64 = pair.iter().map(|seen| seen.record.shape.radius()).sum();
    let [a, b] = pair.map(|seen| PlacedShape { shape: &seen.record.shape, pose: seen.poses[kind] });
    if a.pose.translation.distance(b.pose.translation) > reach {
        return Ok(None);
    }
    let answer = query_shapes(a, b, &PairQuery::of(demand), memory);
    answer.map(Some).map_err(|source| {
        let [a, b] = pair.map(|seen| seen.record.name.clone());
        WorldError::Query { a, b, source }
    })
}

#[cfg(test)]
mod tests {
    use super::samples_across;

    /// Two samples span one step, three span two.
    #[test]
    fn deep_samples_span_a_measurement() {
        let spanned = [1.0, 4.0, 0.5, 1.5, 2.25].map(samples_across);
        assert_eq!(spanned, [1, 4, 2, 3, 4]);
    }
}
