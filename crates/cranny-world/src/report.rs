//! What a step reports.

use cranny_broad_phase::BroadPhaseCounters;
use cranny_estimate::Verdict;
use cranny_narrow_phase::{Answer, Counters, Mismatch, RegionId};

use crate::body::BodyId;
use crate::estimates::PairEstimate;

/// Everything that one step found. Answers and events are sorted by body ids.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// Counts from 0: the first call of [`World::step`](crate::World::step).
    pub step: u64,
    /// One a pair that was queried or supplied.
    pub answers: Vec<PairAnswer>,
    /// One a pair that is answered at a level or within the budget.
    pub estimates: Vec<PairEstimate>,
    /// Which pairs began or ended to touch, among those that have a demand, and which regions of
    /// contact split or merged, where regions are wanted.
    pub events: Vec<PairEvent>,
    /// Pairs with a demand that touch or overlap, or have an open verdict; ascending.
    pub touching: Vec<(BodyId, BodyId)>,
    /// Counts and sums.
    pub stats: StepStats,
    /// Where memory changed an answer, sorted by body ids: faults of Cranny's. Always empty unless
    /// [`World::set_verification`](crate::World::set_verification) requests a comparison. Estimates
    /// are not compared: a pair of `estimates` is never here.
    pub mismatches: Vec<PairMismatch>,
}

impl StepReport {
    /// What is certain of a pair; `None` of one that was answered exactly or not at all.
    #[must_use]
    pub fn estimate(&self, a: BodyId, b: BodyId) -> Option<&PairEstimate> {
        let pair = (a.min(b), a.max(b));
        let at = self.estimates.binary_search_by_key(&pair, |estimate| (estimate.a, estimate.b));
        at.ok().map(|at| &self.estimates[at])
    }

    /// Whether it is open if two bodies touch.
    #[must_use]
    pub fn is_open(&self, a: BodyId, b: BodyId) -> bool {
        self.estimate(a, b).is_some_and(|estimate| estimate.verdict == Verdict::Open)
    }
}

/// An answer that memory changed; the lower id first.
#[derive(Clone, Debug, PartialEq)]
pub struct PairMismatch {
    /// The body with the lower id: A of the answers.
    pub a: BodyId,
    /// The other: B.
    pub b: BodyId,
    /// Both answers.
    pub mismatch: Box<Mismatch>,
}

/// The answer about a pair; the lower id first, and the answer in that order.
#[derive(Clone, Debug, PartialEq)]
pub struct PairAnswer {
    /// The body with the lower id: A of the answer.
    pub a: BodyId,
    /// The other: B.
    pub b: BodyId,
    /// What was found.
    pub answer: Answer,
}

/// Something happened between two bodies; the lower id first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PairEvent {
    /// The body with the lower id.
    pub a: BodyId,
    /// The other.
    pub b: BodyId,
    /// What happened.
    pub kind: PairEventKind,
}

/// Kinds of events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum PairEventKind {
    /// The bodies touch or overlap, and did not (or nothing was wanted of them) at the step before.
    Began,
    /// They touched or overlapped at the step before and do not now, or one was removed, or nothing
    /// is wanted of the pair any more.
    Ended,
    /// A region of their contact came apart: `part` is new, `region` goes on. Reported once for
    /// each part.
    RegionSplit {
        /// The part that keeps the name.
        region: RegionId,
        /// The other.
        part: RegionId,
    },
    /// Two regions of their contact grew together. Reported once for each that was.
    RegionMerged {
        /// The one that goes on.
        region: RegionId,
        /// The one that is part of it now.
        gone: RegionId,
    },
}

impl PairEventKind {
    /// Its name in recordings.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Began => "began",
            Self::Ended => "ended",
            Self::RegionSplit { .. } => "region_split",
            Self::RegionMerged { .. } => "region_merged",
        }
    }
}

/// What a step cost and found, in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepStats {
    /// Bodies in the world, each with one box.
    pub boxes: usize,
    /// Pairs of boxes that overlap.
    pub candidate_pairs: usize,
    /// Pairs that were queried in the narrow phase.
    pub queried_pairs: usize,
    /// Of those, pairs that were answered without memory as well.
    pub verified_pairs: usize,
    /// Pairs whose answer was supplied.
    pub supplied_pairs: usize,
    /// Pairs that touch or overlap, by their answers and estimates; not those that are open.
    pub touching_pairs: usize,
    /// What was estimated.
    pub estimates: EstimateStats,
    /// Contacts, summed over the answers: each region's points, and contacts outside regions.
    pub contacts: usize,
    /// Regions, summed over the answers.
    pub regions: usize,
    /// What the narrow phase did, summed. Not part of any hash.
    pub counters: Counters,
    /// What the broad phase did. Not part of any hash.
    pub broad_phase: BroadPhaseCounters,
    /// The deepest overlap among the answers that give depths, but for those of sensors.
    pub deepest: Option<Deepest>,
}

/// What a step estimated, in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EstimateStats {
    /// Pairs that were estimated.
    pub pairs: usize,
    /// Of these, pairs with an open verdict.
    pub open: usize,
    /// Pairs that more tests would narrow: the budget ended the work.
    pub unsettled: usize,
    /// Elementary tests that they took together.
    pub tests: u64,
}

/// The deepest overlap of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deepest {
    /// > 0, in units of length.
    pub depth: f64,
    /// The body with the lower id.
    pub a: BodyId,
    /// The other.
    pub b: BodyId,
}

impl StepStats {
    /// Adds what is certain of a pair.
    pub(crate) fn add_estimate(&mut self, pair: &PairEstimate) {
        self.touching_pairs += usize::from(pair.verdict == Verdict::Certain);
        self.estimates.pairs += 1;
        self.estimates.open += usize::from(pair.verdict == Verdict::Open);
        self.estimates.unsettled += usize::from(!pair.is_settled);
        self.estimates.tests += pair.tests;
    }

    /// Adds what an answer found; whether it was queried or supplied is the caller's to count.
    /// A sensor overlaps others by design: `sensed` keeps its pair out of the deepest.
    pub(crate) fn add(&mut self, pair: &PairAnswer, sensed: bool) {
        let answer = &pair.answer;
        self.touching_pairs += usize::from(answer.touches());
        let in_regions: usize = answer.regions.iter().map(|r| r.points.len()).sum();
        // Where regions are given, the answer's contacts are their points again.
        self.contacts += if in_regions > 0 { in_regions } else { answer.contacts.len() };
        self.regions += answer.regions.len();
        self.counters += answer.counters;
        let depth = if sensed { 0.0 } else { answer.depth() };
        if depth > self.deepest.map_or(0.0, |d| d.depth) {
            self.deepest = Some(Deepest { depth, a: pair.a, b: pair.b });
        }
    }
}

/// How the regions of a pair's contact split and merged since its last answer.
///
/// A region's share of a former one that goes on elsewhere, and whose name is new, was split from
/// that; a former one whose name nobody bears any more has merged into whatever has a share of it
/// and bears an older name.
pub(crate) fn region_events(answer: &Answer) -> impl Iterator<Item = PairEventKind> {
    let is_there = |id: RegionId| answer.regions.iter().any(|region| region.id == id);
    answer.regions.iter().flat_map(move |region| {
        let (id, is_new) = (region.id, !region.from.contains(&region.id));
        let parent = region.from.iter().copied().find(|&old| is_there(old)).filter(|_| is_new);
        let split = parent.map(|old| PairEventKind::RegionSplit { region: old, part: id });
        let gone = region.from.iter().copied().filter(move |&old| !is_new && !is_there(old));
        split
            .into_iter()
            .chain(gone.map(move |gone| PairEventKind::RegionMerged { region: id, gone }))
    })
}
