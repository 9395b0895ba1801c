//! What the detector answered inside rapier's step, for everybody else who wants to know.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, Demand, Fields, Query, drift, overlaps_by_regions};

/// The latest answer about a pair of tagged shapes.
#[derive(Clone, Debug)]
pub struct LoggedAnswer {
    /// In the frame of the first shape. What the solver got, unless a [reader](AnswerLog::read_by)
    /// reads fields that it does not hold.
    pub answer: Arc<Answer>,
    /// The relative pose that it was computed from.
    pub first_from_second: Pose,
    /// The step in which it was computed.
    pub step: u64,
    /// The question. Beyond its demand's margin there are contacts that bodies approached.
    pub question: Query,
}

impl LoggedAnswer {
    /// How deep the bodies can overlap at another relative pose, below 0 where a gap is left;
    /// `None` where the answer does not bound it: it holds no contacts for a solver, overlaps are
    /// measured by regions, whose direction may change, or a body lay within the other's material.
    ///
    /// A listed contact has come nearer by the [drift](drift()) at most. One that was not listed
    /// was farther than the contact that stood for its patches, but for as much again.
    pub(crate) fn depth_at_most(&self, models: [&Model; 2], pose: &Pose) -> Option<f64> {
        let Demand::Contacts { margin, .. } = self.question.demand else { return None };
        let [before, now] = [&self.first_from_second, pose].map(Pose::world_from_body);
        let depth = self.answer.depth();
        let by_regions = !self.answer.regions.is_empty() || overlaps_by_regions(models);
        if by_regions || self.answer.solid && depth == 0.0 {
            return None;
        }
        let nearest = self.answer.contacts.iter().map(|c| c.separation).fold(margin, f64::min);
        Some(-nearest + 2.0 * drift(models, &before, &now))
    }
}

/// Answers by pairs of tags, and the time spent. Shared by a dispatcher and its owner.
#[derive(Clone, Debug, Default)]
pub struct AnswerLog(Arc<Mutex<Entries>>);

#[derive(Debug, Default)]
struct Entries {
    step: u64,
    answers: BTreeMap<(u32, u32), LoggedAnswer>,
    reader: Reader,
    /// For the solver, since it was last read.
    spent: Duration,
    /// For the reader beyond that, in this step.
    reading: Duration,
}

/// What somebody reads about pairs, by their tags.
type FieldsOf = dyn Fn(u32, u32) -> Fields + Send + Sync;

#[derive(Clone, Default)]
struct Reader(Option<Arc<FieldsOf>>);

impl fmt::Debug for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Reader" } else { "nobody" })
    }
}

impl AnswerLog {
    fn entries(&self) -> std::sync::MutexGuard<'_, Entries> {
        // A panic elsewhere leaves plain values that stay usable.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Says that a new step begins; returns its number, from 1.
    pub fn begin_step(&self) -> u64 {
        let mut entries = self.entries();
        entries.step += 1;
        entries.reading = Duration::ZERO;
        entries.step
    }

    /// The number of the step that began last.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.entries().step
    }

    /// The latest answer about a pair, in the order of the tags given at the call.
    #[must_use]
    pub fn get(&self, first: u32, second: u32) -> Option<LoggedAnswer> {
        self.entries().answers.get(&(first, second)).cloned()
    }

    /// Forgets a pair, as when its boxes have parted. The order of the tags matters, as for
    /// [`get`](Self::get).
    pub fn forget(&self, first: u32, second: u32) {
        self.entries().answers.remove(&(first, second));
    }

    /// Forgets all pairs that fail a test.
    pub fn retain(&self, mut keep: impl FnMut(u32, u32) -> bool) {
        self.entries().answers.retain(|&(first, second), _| keep(first, second));
    }

    /// Number of pairs that it knows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.entries().answers.len()
    }

    /// Whether it knows no pair.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Says which fields a reader of the log reads about a pair of tags, in either order, from now
    /// on. Where the solver's answer does not [hold](Fields::held_by) them, a second question is
    /// computed in the same step, at the same pose; the solver's contacts do not depend on it.
    pub fn read_by(&self, fields: impl Fn(u32, u32) -> Fields + Send + Sync + 'static) {
        self.entries().reader = Reader(Some(Arc::new(fields)));
    }

    /// What the reader reads about a pair.
    pub(crate) fn fields(&self, first: u32, second: u32) -> Fields {
        let reader = self.entries().reader.clone();
        reader.0.map_or(Fields::NONE, |fields| fields(first, second))
    }

    /// Time spent in contact detection for the solver since this was last read.
    pub fn take_time(&self) -> Duration {
        std::mem::take(&mut self.entries().spent)
    }

    /// Time that the [reader](Self::read_by) cost beyond that, in the step that began last.
    #[must_use]
    pub fn reading_time(&self) -> Duration {
        self.entries().reading
    }

    pub(crate) fn add_time(&self, spent: Duration, reading: Duration) {
        let mut entries = self.entries();
        entries.spent += spent;
        entries.reading += reading;
    }

    pub(crate) fn put(
        &self,
        tags: (u32, u32),
        (answer, question): (Answer, Query),
        first_from_second: Pose,
    ) {
        let mut entries = self.entries();
        let (step, answer) = (entries.step, Arc::new(answer));
        entries.answers.insert(tags, LoggedAnswer { answer, first_from_second, step, question });
    }

    /// All that it knows, by ascending tags.
    #[cfg(feature = "snapshot")]
    pub(crate) fn all(&self) -> Vec<((u32, u32), LoggedAnswer)> {
        self.entries().answers.iter().map(|(&tags, logged)| (tags, logged.clone())).collect()
    }

    /// Goes on as a log that was read back.
    #[cfg(feature = "snapshot")]
    pub(crate) fn continue_at(&self, step: u64) {
        self.entries().step = step;
    }

    /// Knows again what it knew of a pair.
    #[cfg(feature = "snapshot")]
    pub(crate) fn put_back(&self, tags: (u32, u32), logged: LoggedAnswer) {
        self.entries().answers.insert(tags, logged);
    }
}
