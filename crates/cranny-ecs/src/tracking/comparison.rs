//! What tracking made of contacts: those of the true motion, of the poses as they came, and of the
//! body as it was shown.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_exact::Pose;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query as PairQuery, query};
use cranny_world::{BodyId, WorldError};

use super::{SimulatedTracker, Tracker, TrackerCounts};
use crate::body::{Bodies, Body, pose_of};
use crate::clock::SimulatedTime;
use crate::effects::{EffectKind, EffectTable, ordered};
use crate::error::Failure;
use crate::trigger::TriggeredPairs;

/// A stretch of steps in which two bodies touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Stretch {
    first: u64,
    last: u64,
    /// The first step from which on it was deep for long enough.
    deep: Option<u64>,
}

/// Stretches, as they grow.
#[derive(Clone, Debug, Default)]
struct Stretches {
    all: Vec<Stretch>,
    /// Steps in a row that were deep, and how many count.
    deep_for: u64,
    long: u64,
}

impl Stretches {
    fn note(&mut self, step: u64, touches: bool, deep: bool) {
        self.deep_for = if touches && deep { self.deep_for + 1 } else { 0 };
        if !touches {
            return;
        }
        match self.all.last_mut().filter(|last| last.last + 1 >= step) {
            Some(last) => last.last = step,
            None => self.all.push(Stretch { first: step, last: step, deep: None }),
        }
        if let Some(last) = self.all.last_mut().filter(|_| self.deep_for >= self.long) {
            last.deep.get_or_insert(step);
        }
    }
}

/// Contacts of one way to see a body beside those of its true motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackedContacts {
    /// Contacts in all.
    pub contacts: usize,
    /// Of them those during which, and for the age of a pose before, the true motion touches
    /// nothing there.
    pub spurious: usize,
    /// Of them those that are more than the true contacts which they could be.
    pub repeated: usize,
    /// True contacts of which none is reported, though they are deeper than twice the tolerance for
    /// longer than poses are apart.
    pub missed: usize,
    /// Steps from when a true contact is so deep until it is reported, at most.
    pub latency: u64,
}

/// What became of the contacts of a body.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ComparedContacts {
    /// The body's name.
    pub body: String,
    /// Contacts of the true motion.
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
}

/// How one way to see a body did.
fn judged(truth: &[Stretch], seen: &[Stretch], age: u64) -> TrackedContacts {
    let mut judged = TrackedContacts { contacts: seen.len(), ..TrackedContacts::default() };
    let meets = |t: &Stretch, s: &Stretch| t.first <= s.last && s.first <= t.last + age;
    let mut untold: Vec<bool> = vec![true; truth.len()];
    for stretch in seen {
        let own = (0..truth.len()).filter(|&i| meets(&truth[i], stretch));
        let own: Vec<usize> = own.collect();
        match own.iter().find(|&&i| untold[i]) {
            Some(&first) => untold[first] = false,
            None if own.is_empty() => judged.spurious += 1,
            None => judged.repeated += 1,
        }
    }
    for (real, deep) in truth.iter().filter_map(|t| Some((t, t.deep?))) {
        match seen.iter().find(|s| meets(real, s)) {
            None => judged.missed += 1,
            Some(first) => {
                judged.latency = judged.latency.max(first.first.saturating_sub(deep));
            }
        }
    }
    judged
}

/// A tracked body beside another one.
#[derive(Debug, Default)]
struct Compared {
    truth: Stretches,
    raw: Stretches,
    reported: Stretches,
    memories: [PairMemory; 2],
}

/// Of one tracked body.
#[derive(Debug, Default)]
struct ComparedBody {
    name: String,
    /// Of a pose at most as it arrives, and as it is shown; steps.
    ages: [u64; 2],
    others: BTreeMap<BodyId, Compared>,
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
            ..ComparedContacts::default()
        };
        for Compared { truth, raw, reported, .. } in self.others.values() {
            sum.truth += truth.all.len();
            let [of_raw, of_shown] = self.ages;
            let ways = [(&mut sum.raw, raw, of_raw), (&mut sum.reported, reported, of_shown)];
            for (total, seen, age) in ways {
                let one = judged(&truth.all, &seen.all, age);
                total.contacts += one.contacts;
                total.spurious += one.spurious;
                total.repeated += one.repeated;
                total.missed += one.missed;
                total.latency = total.latency.max(one.latency);
            }
        }
        sum
    }
}

/// Where bodies are.
#[derive(SystemParam)]
pub(super) struct Present<'w, 's> {
    bodies: Res<'w, Bodies>,
    effects: Res<'w, EffectTable>,
    triggered: Res<'w, TriggeredPairs>,
    time: Res<'w, SimulatedTime>,
    transforms: Query<'w, 's, (&'static Body, &'static Transform)>,
}

pub(super) fn compare(
    devices: Query<(&Body, &SimulatedTracker, &Tracker, &Transform)>,
    present: Present,
    mut log: ResMut<TrackingLog>,
    mut failure: ResMut<Failure>,
) {
    let log = log.0.get_mut().unwrap_or_else(PoisonError::into_inner);
    for (body, device, tracker, transform) in &devices {
        let Some(record) = present.bodies.get(body.id) else { continue };
        let kept = log.entry(body.id).or_default();
        kept.name.clone_from(&record.name);
        (kept.poses, kept.missing) = (tracker.counts(), device.missing());
        kept.ages = present.ages(device, tracker);
        let raw = device.arrived().unwrap_or_else(|| pose_of(transform));
        let poses = [device.truth(present.time.seconds()), raw];
        for (other, at) in &present.transforms {
            let pair = ordered(body.id, other.id);
            let Some(tolerance) = present.effects.tolerance(pair.0, pair.1) else { continue };
            if !present.effects.asks(EffectKind::Trigger, pair.0, pair.1) {
                continue;
            }
            let compared = kept.others.entry(other.id).or_default();
            compared.truth.long = present.steps(1.0 / device.device().rate);
            let noted = present.note(compared, [body.id, other.id], poses, pose_of(at), tolerance);
            failure.note(noted);
        }
    }
}

impl Present<'_, '_> {
    /// How old a pose is at most as it arrives, and as the body is shown at it; steps.
    fn ages(&self, device: &SimulatedTracker, tracker: &Tracker) -> [u64; 2] {
        let settings = tracker.settings();
        // A low pass shows a step to 1 - 1/e after 1 / (2 pi cutoff), and nearly all after thrice.
        let lag = settings.smoothing.map_or(0.0, |s| 3.0 / (std::f64::consts::TAU * s.min_cutoff));
        let arriving = device.device().greatest_age();
        // The body gets there by the end of the step.
        [self.steps(arriving), self.steps(arriving + settings.delay + lag) + 1]
    }

    /// So many steps take at least so long.
    fn steps(&self, seconds: f64) -> u64 {
        (seconds / self.time.step()).ceil() as u64
    }

    /// Takes note of a pair in this step.
    fn note(
        &self,
        compared: &mut Compared,
        [id, other]: [BodyId; 2],
        [truth, raw]: [Pose; 2],
        at: Pose,
        tolerance: f64,
    ) -> Result<(), WorldError> {
        let records = [self.bodies.get(id), self.bodies.get(other)];
        let [Some(body), Some(partner)] = records else { return Ok(()) };
        let other_placed = Placed { model: &partner.model, pose: at };
        let mut ask = |k: usize, pose: Pose, demand: Demand| {
            let own = Placed { model: &body.model, pose };
            let memory = &mut compared.memories[k];
            query(own, other_placed, &PairQuery::of(demand), memory).map_err(|source| {
                WorldError::Query { a: body.name.clone(), b: partner.name.clone(), source }
            })
        };
        let real = ask(0, truth, Demand::contacts(0.0))?;
        let seen = ask(1, raw, Demand::Intersects)?;
        let (step, deep) = (self.time.steps(), real.depth() > 2.0 * tolerance);
        let (a, b) = ordered(id, other);
        compared.truth.note(step, real.touches(), deep);
        compared.raw.note(step, seen.touches(), false);
        compared.reported.note(step, self.triggered.touches((a, b)), false);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stretches(all: &[(u64, u64)], deep: Option<u64>) -> Vec<Stretch> {
        all.iter().map(|&(first, last)| Stretch { first, last, deep }).collect()
    }

    #[test]
    fn what_is_spurious_repeated_and_missed_is_told_apart() {
        let truth = [stretches(&[(10, 20), (40, 50)], None), stretches(&[(70, 80)], Some(72))];
        let truth = truth.concat();
        let judged = |seen: &[(u64, u64)]| judged(&truth, &stretches(seen, None), 3);
        let none = TrackedContacts { missed: 1, ..TrackedContacts::default() };
        assert_eq!(judged(&[]), none);
        // As it was, a little later; the slight ones as one.
        let kept = judged(&[(12, 52), (75, 83)]);
        assert_eq!(kept, TrackedContacts { contacts: 2, latency: 3, ..TrackedContacts::default() });
        // In pieces, and where there is nothing.
        let shaken = judged(&[(2, 3), (9, 11), (13, 13), (15, 18), (23, 24), (24, 25), (71, 90)]);
        let expected =
            TrackedContacts { contacts: 7, spurious: 2, repeated: 3, missed: 0, latency: 0 };
        assert_eq!(shaken, expected);
    }

    #[test]
    fn a_contact_is_deep_once_it_was_so_for_long_enough() {
        let mut known = Stretches { long: 2, ..Stretches::default() };
        let depths =
            [None, Some(false), Some(true), Some(false), Some(true), Some(true), None, Some(true)];
        for (step, depth) in (0..).zip(depths) {
            known.note(step, depth.is_some(), depth == Some(true));
        }
        let expected = [
            Stretch { first: 1, last: 5, deep: Some(5) },
            Stretch { first: 7, last: 7, deep: None },
        ];
        assert_eq!(known.all, expected);
    }
}
