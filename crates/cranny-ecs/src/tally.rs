//! Sums and extremes over a run, for its summary.

use bevy_ecs::prelude::Resource;
use cranny_narrow_phase::Answer;
use cranny_world::{BodyId, EstimateStats};

/// Mean and maximum of a count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Series {
    sum: u64,
    max: u64,
    count: u64,
}

impl Series {
    /// Adds a value.
    pub fn push(&mut self, value: usize) {
        let value = value as u64;
        self.sum += value;
        self.max = self.max.max(value);
        self.count += 1;
    }

    /// 0 where nothing was added.
    #[must_use]
    pub fn mean(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.sum as f64 / self.count as f64 }
    }

    /// 0 where nothing was added.
    #[must_use]
    pub fn max(&self) -> u64 {
        self.max
    }
}

/// The deepest overlap so far, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeepestSoFar {
    /// Units of length, > 0.
    pub depth: f64,
    /// The body with the lower id.
    pub a: BodyId,
    /// The other.
    pub b: BodyId,
    /// Steps completed when it was found: the overlap is of the poses at that time.
    pub step: u64,
}

/// Bodies that lay wholly within another's material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contained {
    /// The body with the lower id of the first such pair.
    pub a: BodyId,
    /// The other.
    pub b: BodyId,
    /// Steps completed when it was first so.
    pub first: u64,
    /// The same of the latest such pair.
    pub last: u64,
    /// In how many steps there was such a pair.
    pub steps: u64,
}

/// What was known of pairs at a level or within a budget.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EstimateTally {
    /// Pairs estimated in a step.
    pub pairs: Series,
    /// Of these, pairs whose verdict was open.
    pub open: Series,
    /// Pairs that a larger budget would have narrowed.
    pub unsettled: Series,
    /// Elementary tests that they took.
    pub tests: Series,
}

impl EstimateTally {
    pub(crate) fn push(&mut self, step: &EstimateStats) {
        self.pairs.push(step.pairs);
        self.open.push(step.open);
        self.unsettled.push(step.unsettled);
        self.tests.push(step.tests as usize);
    }
}

/// Sums and extremes over a run.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Pairs examined in a step: by the solver where there is one, else by the world.
    pub pairs: Series,
    /// Pairs of a step whose contacts our detector carried on for the solver.
    pub carried: Series,
    /// Those that it searched for the solver.
    pub searched: Series,
    /// Parts in which the solver made a step.
    pub parts: Series,
    /// Steps that it made in more than one part.
    pub divided: u64,
    /// Contact points of a step: those that the solver got where there is one, else those reported.
    pub contacts: Series,
    /// Elementary tests of a step for the pairs that the world detects: of boxes, of triangles, of
    /// points against solids. Empty where a solver detects.
    pub tests: Series,
    /// Of pairs known at a level or within a budget; `None` where there were none.
    pub estimates: EstimateTally,
    /// Among exact answers.
    pub deepest: Option<DeepestSoFar>,
    /// Of the first exact answer with a depth.
    pub first_overlap: Option<DeepestSoFar>,
    /// Among exact answers: overlaps whose depth no region gives, as the surfaces do not meet.
    pub contained: Option<Contained>,
    /// Whether exact answers gave depths at all, so that no `deepest` means no overlap.
    pub depths_known: bool,
}

impl Tally {
    /// Whether a summary will name a body.
    pub(crate) fn mentions(&self, body: BodyId) -> bool {
        let deepest = [self.deepest, self.first_overlap];
        let deepest = deepest.into_iter().flatten().any(|d| d.a == body || d.b == body);
        deepest || self.contained.is_some_and(|c| c.a == body || c.b == body)
    }

    /// Takes note of an answer about a pair, `a` < `b`.
    pub(crate) fn note_depth(&mut self, a: BodyId, b: BodyId, answer: &Answer, step: u64) {
        if answer.solid && answer.contained.is_some() {
            let known =
                self.contained.get_or_insert(Contained { a, b, first: step, last: step, steps: 1 });
            if known.last != step {
                (known.last, known.steps) = (step, known.steps + 1);
            }
        }
        let depth = answer.depth();
        if depth > self.deepest.map_or(0.0, |d| d.depth) {
            let found = DeepestSoFar { depth, a, b, step };
            self.deepest = Some(found);
            self.first_overlap.get_or_insert(found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_counts_once_however_many_pairs_are_contained() {
        use cranny_exact::{DVec3, Pose};
        use cranny_geometry::{BuildOptions, Model};
        use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
        use cranny_shapes::Cuboid;

        let cube = |size| {
            let mesh = Cuboid { size: [size; 3] }.build().unwrap();
            Model::build(mesh, &BuildOptions::default()).unwrap().0
        };
        let (small, large) = (cube(0.1), cube(1.0));
        let asked = |x: f64| {
            let pose = Pose::at(DVec3::new(x, 0.0, 0.0));
            let (a, b) =
                (Placed { model: &small, pose }, Placed { model: &large, pose: Pose::IDENTITY });
            query(a, b, &Query::of(Demand::Intersects), &mut PairMemory::default()).unwrap()
        };
        let (inside, outside) = (asked(0.2), asked(2.0));
        let mut tally = Tally::default();
        for (a, b, step) in [(0, 1, 3), (0, 1, 3), (2, 3, 3), (2, 3, 4), (2, 3, 9)] {
            tally.note_depth(BodyId(a), BodyId(b), &inside, step);
        }
        tally.note_depth(BodyId(0), BodyId(1), &outside, 10);
        let expected = Contained { a: BodyId(0), b: BodyId(1), first: 3, last: 9, steps: 3 };
        assert_eq!((tally.contained, tally.deepest), (Some(expected), None));
    }

    #[test]
    fn mean_and_maximum() {
        let mut series = Series::default();
        assert_eq!((series.mean(), series.max()), (0.0, 0));
        [1, 4, 1].into_iter().for_each(|n| series.push(n));
        assert_eq!((series.mean(), series.max()), (2.0, 4));
    }
}
