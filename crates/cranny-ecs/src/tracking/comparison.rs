//! What tracking made of contacts: those of the true motion, of the poses as they came, and of the
//! body as it was shown.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_exact::Pose;
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query as PairQuery, query};
use cranny_world::{BodyId, WorldError};

use super::judged::{Stretches, TrackedContacts, Window, judged};
use super::{SimulatedTracker, Tracker, TrackerCounts, is_beyond};
use crate::body::{Bodies, Body, BodyRecord, pose_of};
use crate::clock::SimulatedTime;
use crate::diagnostics::Stopwatch;
use crate::effects::{EffectKind, EffectTable, ordered};
use crate::error::Failure;
use crate::properties::RigidBody;
use crate::trigger::TriggeredPairs;

/// What became of the contacts of a body.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ComparedContacts {
    /// The body's name.
    pub body: String,
    /// Contacts of the true motion. With another body whose device is simulated they are those of
    /// both true motions, and count for the body of the lower id.
    pub truth: usize,
    /// Of the poses as they arrive, without filtering.
    pub raw: TrackedContacts,
    /// Of what [`CollisionStart`](crate::CollisionStart) and
    /// [`CollisionEnd`](crate::CollisionEnd) say.
    pub reported: TrackedContacts,
    /// What became of its poses.
    pub poses: TrackerCounts,
    /// Poses that never came.
    pub missing: u64,
    /// Other bodies with which nothing is compared, since the solver moves them: where they were
    /// without the device's errors is not known.
    pub uncompared: usize,
}

/// A tracked body beside another one.
#[derive(Debug, Default)]
struct Compared {
    /// As they arrive, and as they are shown.
    windows: [Window; 2],
    truth: Stretches,
    raw: Stretches,
    reported: Stretches,
    memories: [PairMemory; 2],
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
    pub fn bodies(&self) -> Vec<ComparedContacts> {
        let bodies = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        bodies.values().map(ComparedBody::compared).collect()
    }
}

impl ComparedBody {
    fn compared(&self) -> ComparedContacts {
        let mut sum = ComparedContacts {
            body: self.name.clone(),
            poses: self.poses,
            missing: self.missing,
            uncompared: self.uncompared.len(),
            ..ComparedContacts::default()
        };
        for Compared { windows, truth, raw, reported, .. } in self.others.values() {
            sum.truth += truth.all.len();
            add(&mut sum.raw, &judged(&truth.all, &raw.all, windows[0]));
            add(&mut sum.reported, &judged(&truth.all, &reported.all, windows[1]));
        }
        sum
    }
}

fn add(total: &mut TrackedContacts, one: &TrackedContacts) {
    total.contacts += one.contacts;
    total.spurious += one.spurious;
    total.repeated += one.repeated;
    total.late += one.late;
    total.missed += one.missed;
    total.merged += one.merged;
    total.latency = total.latency.max(one.latency);
    total.end_latency = total.end_latency.max(one.end_latency);
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
        let kept = log.entry(body.id).or_default();
        kept.name.clone_from(&record.name);
        (kept.poses, kept.missing) = (tracker.counts(), device.missing());
        failure.note(present.compare_all(kept, tracked));
    }
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
        let Some(body) = self.tracked(own) else { return Ok(()) };
        let pushes = self.effects.names(EffectKind::Response);
        for (entity, other, at, kind) in &self.transforms {
            let pair = ordered(body.id, other.id);
            let Some(tolerance) = self.effects.tolerance(pair.0, pair.1) else { continue };
            if !self.effects.asks(EffectKind::Trigger, pair.0, pair.1) {
                continue;
            }
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
            let seen = partner.and_then(|partner| self.tracked(partner)).unwrap_or(still);
            let compared = kept.others.entry(other.id).or_default();
            let devices = [Some(own), partner].into_iter().flatten();
            self.set_windows(compared, devices);
            self.note(compared, [&body, &seen], tolerance)?;
        }
        Ok(())
    }

    fn tracked(&self, (body, device, _, transform): Tracked) -> Option<BothPoses<'_>> {
        let raw = device.arrived().unwrap_or_else(|| pose_of(transform));
        let poses = [device.truth(self.time.seconds()), raw];
        self.bodies.get(body.id).map(|record| BothPoses { id: body.id, record, poses })
    }

    /// How old poses of a pair are, and how long a contact has to be deep to be seen.
    fn set_windows<'a>(&self, pair: &mut Compared, devices: impl Iterator<Item = Tracked<'a>>) {
        let ages = devices.map(|(_, device, tracker, _)| {
            pair.truth.long = pair.truth.long.max(self.steps(1.0 / device.device().rate));
            self.windows(device, tracker)
        });
        let joined = ages.reduce(|a, b| [a[0].join(b[0]), a[1].join(b[1])]);
        pair.windows = joined.unwrap_or_default();
    }

    /// How old a pose is as it arrives, and as the body is shown at it.
    fn windows(&self, device: &SimulatedTracker, tracker: &Tracker) -> [Window; 2] {
        let (settings, device) = (tracker.settings(), device.device());
        // A low pass shows a step to 1 - 1/e after 1 / (2 pi cutoff), and nearly all after thrice.
        let lag = settings.smoothing.map_or(0.0, |s| 3.0 / (std::f64::consts::TAU * s.min_cutoff));
        let whole = |seconds: f64| (seconds / self.time.step()).floor() as u64;
        let arriving = device.greatest_age();
        [
            Window { least: whole(device.latency), most: self.steps(arriving), lag: 0 },
            Window {
                least: whole(device.latency.max(settings.delay)),
                // The body gets there by the end of the step.
                most: self.steps(arriving + settings.delay) + 1,
                lag: self.steps(lag),
            },
        ]
    }

    /// So many steps take at least so long.
    fn steps(&self, seconds: f64) -> u64 {
        (seconds / self.time.step()).ceil() as u64
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
        compared.raw.note(step, touches(&seen), false);
        let reported = self.triggered.touches(ordered(pair[0].id, pair[1].id));
        compared.reported.note(step, reported, false);
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
    let reach: f64 = pair.iter().map(|seen| seen.record.model.radius()).sum();
    let [a, b] = pair.map(|seen| Placed { model: &seen.record.model, pose: seen.poses[kind] });
    if a.pose.translation.distance(b.pose.translation) > reach {
        return Ok(None);
    }
    let [of_a, of_b] = pair.map(|seen| seen.record.name.clone());
    let answer = query(a, b, &PairQuery::of(demand), memory);
    answer.map(Some).map_err(|source| WorldError::Query { a: of_a, b: of_b, source })
}
