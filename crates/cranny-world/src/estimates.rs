//! What is certain of pairs that are not answered exactly: at a level, or within the step's budget.
//!
//! The budget is shared at the present poses. Every pair keeps what is certain of it from the last
//! step, which costs no test. Then tests go to pairs whose verdict is open, then to those whose
//! distance may lie on either side of a reader's threshold, then to the widest intervals. Pairs of
//! one kind get equal shares (intervals, shares by their widths); what a pair leaves is shared
//! again among the others of its kind, and what a kind leaves goes on to the next.

use cranny_estimate::{Accuracy, Budget, Effort, EstimateMemory, Verdict, estimate};
use cranny_exact::{DVec3, Interval, Pose};
use cranny_narrow_phase::{Demand, Query, QueryError};

use crate::body::{Body, BodyId};
use crate::crew::Crew;

/// Tests of a share. Fewer: an estimate spends as much on beginning (two tests of the faces that
/// were nearest, a few of points) as on going on. More: a small budget serves fewer pairs a step.
const LEAST_SHARE: u64 = 32;

/// An interval whose width is this share of the coordinates, or less, has closed: what is left of
/// it is rounding. Smaller: tests go to faces that are equally near, as those of parallel planes.
/// Larger: distances are off by more than exact ones are.
/// `the_distance_of_parallel_planes_closes` has such planes.
const CLOSED: f64 = 1e-13;

/// What is certain of a pair; the lower id first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairEstimate {
    /// The body with the lower id.
    pub a: BodyId,
    /// The other: B.
    pub b: BodyId,
    /// The level that is asked of the pair.
    pub accuracy: Accuracy,
    /// Whether the bodies share a point. `Open` counts as touching.
    pub verdict: Verdict,
    /// Holds the distance between the surfaces, 0 where they meet.
    pub separation: Interval,
    /// A point of each surface, the nearest that were tested in this step; world coordinates. Where
    /// memory knows a tighter bound they are farther apart than `separation.hi`. `None` where no
    /// test was left for the pair.
    pub points: Option<[DVec3; 2]>,
    /// Elementary tests that were made in this step.
    pub tests: u64,
    /// Whether more tests bring nothing: the level is exhausted, or all that is read is certain. At
    /// the level `Exact` the verdict is then exact, and the distance but for rounding.
    pub is_settled: bool,
}

impl PairEstimate {
    /// Whether the bodies share a point, as far as is known.
    #[must_use]
    pub fn may_touch(&self) -> bool {
        self.verdict != Verdict::Excluded
    }
}

/// What is kept of a pair from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairState {
    pub(crate) memory: EstimateMemory,
    /// The latest estimate, and what it is an estimate of.
    last: Option<(Asked, PairEstimate)>,
    /// Steps since tests were left for it, though it was not settled.
    waited: u64,
    /// The least share that gets it on, where that is more than [`LEAST_SHARE`].
    least: u64,
}

/// What an estimate depends on, beside memory.
type Asked = ([Pose; 2], Query, Accuracy);

/// One pair, on its way to an estimate.
pub(crate) struct Refinement<'w> {
    pub(crate) pair: (BodyId, BodyId),
    pub(crate) bodies: [&'w Body; 2],
    pub(crate) query: Query,
    pub(crate) accuracy: Accuracy,
    pub(crate) state: PairState,
    /// What is known so far in this step.
    pub(crate) found: Option<PairEstimate>,
    /// What may be spent next; `None`: all that it takes.
    share: Option<u64>,
    /// No share moves it.
    stuck: bool,
}

/// What a pair needs most, the most urgent first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Need {
    Verdict,
    Threshold,
    Width,
}

impl<'w> Refinement<'w> {
    pub(crate) fn new(
        pair: (BodyId, BodyId),
        bodies: [&'w Body; 2],
        query: Query,
        accuracy: Accuracy,
        state: PairState,
    ) -> Self {
        Self { pair, bodies, query, accuracy, state, found: None, share: None, stuck: false }
    }

    fn asked(&self) -> Asked {
        (self.bodies.map(Body::pose), self.query, self.accuracy)
    }

    /// Takes the last estimate where nothing has changed that it depends on.
    fn recall(&mut self) -> bool {
        let asked = self.asked();
        let known = self.state.last.as_ref().filter(|(of, last)| *of == asked && last.is_settled);
        self.found = known.map(|(_, last)| PairEstimate { tests: 0, ..*last });
        self.found.is_some()
    }

    /// Spends its share.
    fn spend(&mut self) -> Result<(), QueryError> {
        let [a, b] = self.bodies.map(Body::placed);
        let budget = self.share.map_or(Budget::Unlimited, Budget::Tests);
        let effort = Effort { accuracy: self.accuracy, budget };
        let found = estimate(a, b, &self.query, &effort, &mut self.state.memory)?;
        let points = found.witnesses.map(|pair| pair.map(|witness| witness.point));
        let before = self.found.and_then(|before| before.points);
        let tests = self.tests() + found.tests();
        self.state.least = match self.share {
            // A step of an estimate may take more than a share, as a point for each component does.
            Some(share) if found.ended_by_budget && 2 * found.tests() < share => 2 * share,
            _ => 0,
        };
        let mut now = PairEstimate {
            a: self.pair.0,
            b: self.pair.1,
            accuracy: self.accuracy,
            verdict: found.verdict,
            separation: found.separation,
            points: nearer(before, points),
            tests,
            is_settled: !found.ended_by_budget,
        };
        now.is_settled |= self.is_answered(&now);
        self.found = Some(now);
        Ok(())
    }

    /// Tests made in this step so far.
    fn tests(&self) -> u64 {
        self.found.map_or(0, |found| found.tests)
    }

    /// The distance below which one is read; `None` where none is.
    fn within(&self) -> Option<f64> {
        match self.query.demand {
            Demand::Distance { below } => Some(below.unwrap_or(f64::INFINITY)),
            _ => None,
        }
    }

    /// Whether all that is read is certain, but for rounding.
    fn is_answered(&self, found: &PairEstimate) -> bool {
        let Interval { lo, hi } = found.separation;
        let is_known = |within| lo >= within || hi - lo <= CLOSED * self.extent(hi);
        found.verdict != Verdict::Open && self.within().is_none_or(is_known)
    }

    /// How large the coordinates are of which a distance is computed.
    fn extent(&self, distance: f64) -> f64 {
        let size = |body: &Body| {
            let [low, high] = [body.model.bounds().min, body.model.bounds().max];
            body.pose.translation.length() + low.abs().max(high.abs()).length()
        };
        distance + self.bodies.map(size).iter().sum::<f64>()
    }

    /// What it needs, and how much of it; `None` where more tests bring nothing.
    fn need(&self) -> Option<(Need, f64)> {
        let found = self.found.as_ref().filter(|found| !found.is_settled && !self.stuck)?;
        let Interval { lo, hi } = found.separation;
        let within = self.within().unwrap_or(f64::INFINITY);
        Some(match found.verdict {
            Verdict::Open => (Need::Verdict, 1.0),
            _ if hi >= within => (Need::Threshold, hi - lo),
            _ => (Need::Width, hi - lo),
        })
    }

    /// What is left for the next step, and what is known in this one.
    pub(crate) fn finish(mut self) -> (PairState, Option<PairEstimate>) {
        self.state.last = self.found.map(|found| (self.asked(), found));
        let is_served = self.found.is_none_or(|found| found.is_settled || found.tests > 0);
        self.state.waited = if is_served { 0 } else { self.state.waited + 1 };
        (self.state, self.found)
    }
}

/// The pair of points that are nearer to each other.
fn nearer(one: Option<[DVec3; 2]>, other: Option<[DVec3; 2]>) -> Option<[DVec3; 2]> {
    let apart = |[p, q]: &[DVec3; 2]| (*q - *p).length();
    one.into_iter().chain(other).min_by(|a, b| apart(a).total_cmp(&apart(b)))
}

/// Estimates all pairs, within a budget for them together.
pub(crate) fn refine(
    pairs: &mut [Refinement<'_>],
    budget: Option<u64>,
    crew: &Crew,
) -> Result<(), QueryError> {
    let mut moved: Vec<&mut Refinement<'_>> = pairs.iter_mut().filter_map(unless_still).collect();
    let share = budget.map(|_| 0);
    moved.iter_mut().for_each(|pair| pair.share = share);
    spend(&mut moved, crew)?;
    match budget {
        Some(budget) => share_out(moved, budget, crew),
        None => Ok(()),
    }
}

fn unless_still<'p, 'w>(pair: &'p mut Refinement<'w>) -> Option<&'p mut Refinement<'w>> {
    (!pair.recall()).then_some(pair)
}

fn spend(pairs: &mut [&mut Refinement<'_>], crew: &Crew) -> Result<(), QueryError> {
    crew.each(pairs, |pair| pair.spend()).into_iter().collect()
}

/// Shares a budget among pairs. Shares are fixed before anybody spends them, so it does not matter
/// how many threads do.
fn share_out(
    mut pairs: Vec<&mut Refinement<'_>>,
    budget: u64,
    crew: &Crew,
) -> Result<(), QueryError> {
    let mut left = budget;
    // Where no share got anybody on, the first pair gets all that is left.
    let mut whole = false;
    while left >= LEAST_SHARE.min(budget).max(1) {
        pairs.iter_mut().for_each(|pair| pair.share = None);
        let Some(first) = allot(&mut pairs, left, whole) else { break };
        let mut served: Vec<&mut Refinement<'_>> =
            pairs.iter_mut().map(|pair| &mut **pair).filter(|pair| pair.share.is_some()).collect();
        let before: u64 = served.iter().map(|pair| pair.tests()).sum();
        spend(&mut served, crew)?;
        let spent = served.iter().map(|pair| pair.tests()).sum::<u64>() - before;
        left = left.saturating_sub(spent);
        if spent == 0 && whole {
            pairs[first].stuck = true;
        }
        whole = spent == 0;
    }
    Ok(())
}

/// Allots what is left among those that need it most urgently, or all of it to the first of them,
/// whose index it returns; `None` where nobody needs anything.
fn allot(pairs: &mut [&mut Refinement<'_>], left: u64, whole: bool) -> Option<usize> {
    let wanting = most_urgent(pairs);
    let all: f64 = wanting.iter().map(|(_, weight)| weight).sum();
    let mut unshared = left;
    for &(index, weight) in &wanting {
        let fair = (left as f64 * (weight / all)) as u64;
        let least = pairs[index].state.least.max(LEAST_SHARE);
        let share = if whole { unshared } else { fair.max(least).min(unshared) };
        if share == 0 {
            break;
        }
        unshared -= share;
        pairs[index].share = Some(share);
    }
    wanting.first().map(|&(index, _)| index)
}

/// The pairs that need most urgently what they need, by index, with their weights: those that have
/// waited longest first, then the widest.
fn most_urgent(pairs: &[&mut Refinement<'_>]) -> Vec<(usize, f64)> {
    let needs: Vec<(usize, Need, f64)> = pairs
        .iter()
        .enumerate()
        .filter_map(|(index, pair)| pair.need().map(|(need, weight)| (index, need, weight)))
        .collect();
    let Some(urgent) = needs.iter().map(|&(_, need, _)| need).min() else { return Vec::new() };
    let mut wanting: Vec<(usize, f64)> = needs
        .into_iter()
        .filter(|&(_, need, _)| need == urgent)
        .map(|(index, _, weight)| (index, weight.max(f64::MIN_POSITIVE)))
        .collect();
    wanting.sort_by(|(i, v), (j, w)| {
        let waited = |index: usize| pairs[index].state.waited;
        waited(*j).cmp(&waited(*i)).then(w.total_cmp(v)).then(i.cmp(j))
    });
    wanting
}
