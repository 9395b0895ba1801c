//! What is certain of pairs that are not answered exactly: at a level, or within the step's budget.
//!
//! The budget is shared at the present poses. Every pair keeps what is certain of it from the last
//! step, which costs no test. Then tests go to pairs whose verdict is open, then to those whose
//! distance may lie on either side of a reader's threshold, then to the widest intervals. Pairs of
//! one kind get equal shares (intervals, shares by their widths); what a pair leaves is shared
//! again among the others of its kind, and what a kind leaves goes on to the next. A pair that has
//! waited long comes first, with a least share. A pair that does not get on with what is left
//! waits; where the whole budget is too small for its next step, it overdraws once it stands still,
//! one pair a step.

use cranny_estimate::{Accuracy, Budget, Effort, EstimateMemory, Verdict, estimate};
use cranny_exact::{DVec3, Interval, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Demand, Placed, Query, QueryError};

use crate::body::{Body, BodyId};
use crate::crew::Crew;

/// Tests of a share. Fewer: an estimate spends as much on beginning (two tests of the faces that
/// were nearest, a few of points) as on going on. More: a small budget serves fewer pairs a step.
const LEAST_SHARE: u64 = 32;

/// Steps that a pair waits while others need tests more urgently. Fewer: open verdicts go short of
/// tests more often. More: the distance of a pair stays as wide for longer, at 100 steps a second
/// for a sixth of one.
const LONGEST_WAIT: u64 = 16;

/// Of a step's budget, this part goes to those that have waited longer. Less, that is a larger
/// number: of many of them, each waits longer still. More: they leave little to open verdicts.
const OVERDUE_PART: u64 = 4;

/// Rounds in which a budget is shared. Fewer: some of it is left where pairs take little of their
/// shares. More: every round costs time without a test, and the last ones serve few.
const MOST_ROUNDS: u32 = 32;

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
    /// The pair's level.
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
    /// Of a pair that is estimated: boxed, since most pairs are answered at once.
    kept: Option<Box<Kept>>,
}

/// What is kept of an estimate.
#[derive(Clone, Debug)]
struct Kept {
    /// The latest estimate, and what it is an estimate of.
    asked: Asked,
    last: PairEstimate,
    /// Steps since it got on, though it was not settled.
    waited: u64,
    /// The share below which it does not get on; 0 where it is settled.
    least: u64,
}

/// What an estimate depends on, beside memory.
type Asked = ([Pose; 2], Query, Accuracy);

/// One pair, on its way to an estimate.
pub(crate) struct Refinement<'w> {
    pub(crate) pair: (BodyId, BodyId),
    pub(crate) bodies: [&'w Body; 2],
    /// Those of the bodies: primitives are not estimated.
    models: [&'w Model; 2],
    pub(crate) query: Query,
    pub(crate) accuracy: Accuracy,
    pub(crate) state: PairState,
    /// What is known so far in this step.
    pub(crate) found: Option<PairEstimate>,
    /// What may be spent next; `None`: all that it takes.
    share: Option<u64>,
    /// Steps before this one since it got on.
    waited: u64,
    /// The share below which it does not get on.
    least: u64,
    /// Whether nothing has changed since the last step that an estimate depends on.
    is_still: bool,
    /// Whether it had a share that gets it on.
    is_served: bool,
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
        models: [&'w Model; 2],
        query: Query,
        accuracy: Accuracy,
        state: PairState,
    ) -> Self {
        let kept = state.kept.as_deref();
        let waited = kept.map_or(0, |kept| kept.waited);
        let mut new = Self {
            pair,
            bodies,
            models,
            query,
            accuracy,
            found: None,
            share: None,
            waited,
            least: 0,
            is_still: false,
            is_served: false,
            state,
        };
        if let Some(kept) = new.state.kept.as_deref().filter(|kept| kept.asked == new.asked()) {
            (new.least, new.is_still) = (kept.least, true);
        }
        new
    }

    fn asked(&self) -> Asked {
        (self.bodies.map(Body::pose), self.query, self.accuracy)
    }

    /// Takes the last estimate where nothing has changed that it depends on.
    fn recall(&mut self) -> bool {
        let kept = self.state.kept.as_deref().filter(|_| self.is_still);
        let settled = kept.map(|kept| kept.last).filter(|last| last.is_settled);
        self.found = settled.map(|last| PairEstimate { tests: 0, ..last });
        self.found.is_some()
    }

    /// Spends its share.
    fn spend(&mut self) -> Result<(), QueryError> {
        let [a, b] = [0, 1].map(|i| Placed { model: self.models[i], pose: self.bodies[i].pose });
        let budget = self.share.map_or(Budget::Unlimited, Budget::Tests);
        let effort = Effort { accuracy: self.accuracy, budget };
        let found = estimate(a, b, &self.query, &effort, &mut self.state.memory)?;
        let points = found.witnesses.map(|pair| pair.map(|witness| witness.point));
        let before = self.found.and_then(|before| before.points);
        let tests = self.tests() + found.tests();
        let had = self.share.unwrap_or(u64::MAX);
        self.is_served |= had > 0 && had >= self.least;
        self.least = self.next_least(had, found.needed_to_go_on);
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

    /// The share that gets it on next, where it had one and an estimate says what it needs.
    fn next_least(&self, had: u64, needed: u64) -> u64 {
        match had {
            // What it needed before, it needs as long as it is still.
            0 => needed.max(self.least),
            // It had what seemed to be enough, and was not: it does not creep up to what is.
            _ if self.least > 0 && had >= self.least && needed > had => {
                needed.max(self.least.saturating_mul(2))
            }
            _ => needed,
        }
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

    /// How large the coordinates are that a distance is computed from.
    fn extent(&self, distance: f64) -> f64 {
        let size = |i: usize| {
            let [low, high] = [self.models[i].bounds().min, self.models[i].bounds().max];
            self.bodies[i].pose.translation.length() + low.abs().max(high.abs()).length()
        };
        distance + [0, 1].map(size).iter().sum::<f64>()
    }

    /// What it needs, and how much of it; `None` where more tests bring nothing.
    fn need(&self) -> Option<(Need, f64)> {
        let found = self.found.as_ref().filter(|found| !found.is_settled)?;
        let Interval { lo, hi } = found.separation;
        let within = self.within().unwrap_or(f64::INFINITY);
        Some(match found.verdict {
            Verdict::Open => (Need::Verdict, 1.0),
            _ if hi >= within => (Need::Threshold, hi - lo),
            _ => (Need::Width, hi - lo),
        })
    }

    /// Whether it gets on with a share of what is left, or may overdraw.
    fn may_be_served(&self, left: Left) -> bool {
        self.least <= left.tests || left.is_whole && self.is_still
    }

    /// What is left for the next step, and what is known in this one.
    pub(crate) fn finish(mut self) -> (PairState, Option<PairEstimate>) {
        self.state.kept = self.found.map(|last| {
            let waited = if last.is_settled || self.is_served { 0 } else { self.waited + 1 };
            Box::new(Kept { asked: self.asked(), last, waited, least: self.least })
        });
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

/// What is left of a budget.
#[derive(Clone, Copy)]
struct Left {
    tests: u64,
    /// Nobody had any.
    is_whole: bool,
}

/// Shares a budget among pairs. Shares are fixed before anybody spends them, so it does not matter
/// how many threads do.
fn share_out(
    mut pairs: Vec<&mut Refinement<'_>>,
    budget: u64,
    crew: &Crew,
) -> Result<(), QueryError> {
    let mut left = Left { tests: budget, is_whole: true };
    for round in 0..MOST_ROUNDS {
        if left.tests < LEAST_SHARE.min(budget).max(1) {
            break;
        }
        pairs.iter_mut().for_each(|pair| pair.share = None);
        let is_anybody = match round {
            0 => allot_overdue(&mut pairs, left),
            _ => allot_urgent(&mut pairs, left),
        };
        match (is_anybody, round) {
            (true, _) => {}
            (false, 0) => continue,
            (false, _) => break,
        }
        let mut served: Vec<&mut Refinement<'_>> =
            pairs.iter_mut().map(|pair| &mut **pair).filter(|pair| pair.share.is_some()).collect();
        let before: u64 = served.iter().map(|pair| pair.tests()).sum();
        spend(&mut served, crew)?;
        let spent = served.iter().map(|pair| pair.tests()).sum::<u64>() - before;
        left = Left { tests: left.tests.saturating_sub(spent), is_whole: false };
    }
    Ok(())
}

/// Allots least shares to those that have waited too long, out of a part of what is left, but one
/// at least; returns whether anybody got one.
fn allot_overdue(pairs: &mut [&mut Refinement<'_>], left: Left) -> bool {
    let is_overdue = |pair: &Refinement| pair.waited > LONGEST_WAIT;
    let wanting = by_wait(pairs, |pair| is_overdue(pair) && pair.may_be_served(left));
    let most = left.tests / OVERDUE_PART;
    let mut given = 0;
    for (index, ..) in wanting {
        let share = pairs[index].least.max(LEAST_SHARE.min(left.tests));
        if given == 0 || given + share <= most {
            pairs[index].share = Some(share);
            given += share;
        }
    }
    given > 0
}

/// Allots what is left among those that need it most urgently; returns whether anybody needs any.
fn allot_urgent(pairs: &mut [&mut Refinement<'_>], left: Left) -> bool {
    let mut wanting = by_wait(pairs, |pair| pair.may_be_served(left));
    let urgent = wanting.iter().map(|&(_, need, _)| need).min();
    wanting.retain(|&(_, need, _)| Some(need) == urgent);
    let all: f64 = wanting.iter().map(|&(_, _, weight)| weight).sum();
    let mut unshared = left.tests;
    for (index, _, weight) in wanting {
        let pair = &mut pairs[index];
        let fair = (left.tests as f64 * (weight / all)) as u64;
        if pair.least <= unshared && unshared > 0 {
            let share = fair.max(pair.least).max(LEAST_SHARE).min(unshared);
            unshared -= share;
            pair.share = Some(share);
        } else if unshared == left.tests {
            // It has all, and overdraws: less would not get it on in any step.
            pair.share = Some(pair.least);
            unshared = 0;
        }
    }
    unshared < left.tests
}

/// Pairs that need something, by index, with what, and how much of it: those that have waited
/// longest first, then the most urgent, then the widest.
fn by_wait(
    pairs: &[&mut Refinement<'_>],
    is_meant: impl Fn(&Refinement<'_>) -> bool,
) -> Vec<(usize, Need, f64)> {
    let meant = pairs.iter().enumerate().filter(|(_, pair)| is_meant(pair));
    let needs = meant.filter_map(|(index, pair)| {
        pair.need().map(|(need, weight)| (index, need, weight.max(f64::MIN_POSITIVE)))
    });
    let mut needs: Vec<(usize, Need, f64)> = needs.collect();
    needs.sort_by(|(i, need, v), (j, other, w)| {
        let waited = pairs[*j].waited.cmp(&pairs[*i].waited);
        waited.then(need.cmp(other)).then(w.total_cmp(v)).then(i.cmp(j))
    });
    needs
}
