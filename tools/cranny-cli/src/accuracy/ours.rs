//! Levels and budgets of ours, with memory and without.

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_narrow_phase::{
    Accuracy, Budget, Demand, Effort, Estimate, PairMemory, Placed, Query, Verdict, estimate,
};

use super::Told;
use super::figures::Method;
use crate::pose_file::PosePair;

const LEVELS: [Accuracy; 10] = [
    Accuracy::Boxes,
    Accuracy::Hulls,
    Accuracy::Caps,
    Accuracy::Tree(2),
    Accuracy::Tree(4),
    Accuracy::Tree(6),
    Accuracy::Tree(8),
    Accuracy::Tree(12),
    Accuracy::Tree(16),
    Accuracy::Exact,
];

const BUDGETS: [u64; 7] = [10, 30, 100, 300, 1_000, 3_000, 10_000];

/// A level or a budget, warm or cold.
pub(super) struct Ours {
    effort: Effort<'static>,
    warm: bool,
    memory: PairMemory,
    /// Memory in which only what the level prepares is there, and whose it is.
    prepared: Option<PairMemory>,
}

impl Ours {
    /// All levels, then all budgets; each cold, then warm.
    pub(super) fn all() -> Vec<Self> {
        let efforts = LEVELS.map(Effort::of).into_iter().chain(BUDGETS.map(Effort::tests));
        let both = |effort| [false, true].map(|warm| Self::new(effort, warm));
        efforts.flat_map(both).collect()
    }

    fn new(effort: Effort<'static>, warm: bool) -> Self {
        Self { effort, warm, memory: PairMemory::default(), prepared: None }
    }

    fn estimate(
        &mut self,
        [a, b]: [&Model; 2],
        poses: PosePair,
        demand: Demand,
    ) -> Option<Estimate> {
        let [a, b] = [Placed { model: a, pose: poses[0] }, Placed { model: b, pose: poses[1] }];
        // Poses were found good when the truth was asked.
        estimate(a, b, &Query::of(demand), &self.effort, &mut self.memory).ok()
    }
}

impl Method for Ours {
    fn name(&self) -> &'static str {
        "cranny"
    }

    fn level(&self) -> Option<String> {
        Some(match self.effort.accuracy {
            Accuracy::Boxes => "boxes".to_owned(),
            Accuracy::Hulls => "hulls".to_owned(),
            Accuracy::Caps => "caps".to_owned(),
            Accuracy::Tree(depth) => format!("tree:{depth}"),
            Accuracy::Exact => "exact".to_owned(),
        })
    }

    fn budget(&self) -> Option<u64> {
        match self.effort.budget {
            Budget::Tests(tests) => Some(tests),
            Budget::Unlimited | Budget::Until { .. } => None,
        }
    }

    fn is_warm(&self) -> bool {
        self.warm
    }

    fn begin(&mut self, [a, b]: [&Model; 2]) {
        let prepared = self.prepared.get_or_insert_with(|| {
            let mut memory = PairMemory::default();
            memory.prepare(a, b, self.effort.accuracy);
            memory
        });
        self.memory = prepared.clone();
    }

    fn ask(&mut self, models: [&Model; 2], poses: PosePair) -> Told {
        let found = self.estimate(models, poses, Demand::Distance { below: None });
        let Some(found) = found else { return Told::default() };
        let counters = &found.counters;
        Told {
            meets: match found.verdict {
                Verdict::Certain => Some(true),
                Verdict::Excluded => Some(false),
                Verdict::Open => None,
            },
            distance: Some(found.separation.hi),
            width: Some(found.separation.width()),
            witnesses: found.witnesses.map(|w| w.map(|w| w.point)),
            tests: Some(
                counters.node_tests
                    + counters.triangle_tests
                    + counters.inside_tests
                    + counters.hull_steps
                    + counters.planes_tried,
            ),
        }
    }

    fn contacts(&mut self, models: [&Model; 2], poses: PosePair) -> Vec<DVec3> {
        let found = self.estimate(models, poses, Demand::Regions { margin: 0.0 });
        let Some(found) = found else { return Vec::new() };
        match found.answer {
            Some(answer) => {
                let contacts = answer.contacts.iter();
                contacts.map(|c| 0.5 * (c.point_a + c.point_b)).collect()
            }
            None => found.places.iter().map(|place| place.bounds.center()).collect(),
        }
    }
}
