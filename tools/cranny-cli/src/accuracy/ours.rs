//! Levels and budgets of ours, with memory and without.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use cranny_estimate::{
    Accuracy, Budget, Clock, Effort, Estimate, EstimateMemory, Verdict, estimate,
};
use cranny_exact::Interval;
use cranny_narrow_phase::{Demand, Placed, Query};

use super::method::{ContactAnswer, Method, Name, PoseAnswer};
use super::motion::Posed;

/// How long one estimate may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Allowance {
    /// As long as the level takes.
    Unlimited,
    /// So many elementary tests.
    Tests(u64),
    /// So long by the clock.
    Time(Duration),
}

/// A level within a budget, warm or cold.
pub(super) struct Ours {
    accuracy: Accuracy,
    allowance: Allowance,
    warm: bool,
    clock: SinceStart,
    memory: EstimateMemory,
    /// Memory in which only what the level prepares is there, by pair.
    prepared: BTreeMap<usize, EstimateMemory>,
}

/// Nanoseconds since it was made.
struct SinceStart(Instant);

impl Clock for SinceStart {
    fn now_ns(&self) -> u64 {
        u64::try_from(self.0.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

impl Ours {
    /// Cold and warm.
    pub(super) fn both(accuracy: Accuracy, allowance: Allowance) -> [Self; 2] {
        [false, true].map(|warm| Self::new(accuracy, allowance, warm))
    }

    pub(super) fn new(accuracy: Accuracy, allowance: Allowance, warm: bool) -> Self {
        let clock = SinceStart(Instant::now());
        let (memory, prepared) = (EstimateMemory::default(), BTreeMap::new());
        Self { accuracy, allowance, warm, clock, memory, prepared }
    }

    fn estimate(&mut self, posed: Posed, demand: Demand) -> Option<Estimate> {
        let [a, b] = [0, 1].map(|i| Placed { model: posed.models[i], pose: posed.poses[i] });
        let budget = match self.allowance {
            Allowance::Unlimited => Budget::Unlimited,
            Allowance::Tests(tests) => Budget::Tests(tests),
            Allowance::Time(time) => Budget::Until {
                clock: &self.clock,
                deadline_ns: self.clock.now_ns() + time.as_nanos() as u64,
            },
        };
        let effort = Effort { accuracy: self.accuracy, budget };
        // Poses were found good when the truth was computed.
        estimate(a, b, &Query::of(demand), &effort, &mut self.memory).ok()
    }
}

impl Method for Ours {
    fn name(&self) -> Name {
        Name {
            method: "cranny",
            level: Some(match self.accuracy {
                Accuracy::Boxes => "boxes".to_owned(),
                Accuracy::Hulls => "hulls".to_owned(),
                Accuracy::Caps => "caps".to_owned(),
                Accuracy::Tree(depth) => format!("tree:{depth}"),
                Accuracy::Exact => "exact".to_owned(),
            }),
            budget: match self.allowance {
                Allowance::Tests(tests) => Some(tests),
                _ => None,
            },
            deadline_us: match self.allowance {
                Allowance::Time(time) => Some(time.as_micros() as u64),
                _ => None,
            },
            memory: if self.warm { "warm" } else { "cold" },
        }
    }

    fn is_warm(&self) -> bool {
        self.warm
    }

    fn begin(&mut self, posed: Posed) {
        let prepared = self.prepared.entry(posed.pair).or_insert_with(|| {
            let mut memory = EstimateMemory::default();
            memory.prepare(posed.models[0], posed.models[1], self.accuracy);
            memory
        });
        self.memory = prepared.clone();
    }

    fn distance(&mut self, posed: Posed) -> PoseAnswer {
        let found = self.estimate(posed, Demand::Distance { below: None });
        let Some(found) = found else { return PoseAnswer::default() };
        PoseAnswer {
            meets: meets(&found),
            distance: Some(found.separation.hi),
            held: Some(found.separation),
            witnesses: found.witnesses.map(|w| w.map(|w| w.point)),
            tests: Some(found.tests()),
        }
    }

    fn contacts(&mut self, posed: Posed) -> ContactAnswer {
        let found = self.estimate(posed, Demand::Regions { margin: 0.0 });
        let Some(found) = found else { return ContactAnswer::default() };
        let (Interval { lo, hi }, meets) = (found.separation, meets(&found));
        let points = match found.answer {
            Some(answer) => {
                let contacts = answer.contacts.iter();
                contacts.map(|c| 0.5 * (c.point_a + c.point_b)).collect()
            }
            None => found.places.iter().map(|place| place.bounds.center()).collect(),
        };
        ContactAnswer { meets, points, depth: Some(Interval { lo: -hi, hi: -lo }) }
    }
}

fn meets(found: &Estimate) -> Option<bool> {
    match found.verdict {
        Verdict::Certain => Some(true),
        Verdict::Excluded => Some(false),
        Verdict::Open => None,
    }
}
