//! The second way to the faces that meet, by concavities and their envelopes: what is kept of a
//! pair for it.
//!
//! The way itself, its sources and its costs stand in [`cranny_concavity::pockets`]: it hands over
//! pairs of faces that hold all that meet, and the exact test here is the same as by boxes. Which
//! way is taken changes the time, never the answer.

use std::ops::ControlFlow;
use std::sync::Arc;

use cranny_concavity::Concavities;
use cranny_concavity::pockets::{Near, PocketBody, PocketCounters, Pockets, PosedModels};
use cranny_exact::{Meeting, RigidMap};
use cranny_geometry::FaceId;

use crate::box_test::for_each_near_pair_beneath;
use crate::motion::{Ball, RelativeMotion};
use crate::pair::{Pair, PairTag, Side};
use crate::per_model::PerModel;
use crate::surface::{FacePair, looked_at};
use crate::tally::Tally;

/// What is kept of a pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct PocketMemory {
    tag: PairTag,
    /// The relative pose of the last query.
    map: Option<RigidMap>,
    pockets: Pockets,
    bodies: Option<PerModel<PocketBody>>,
}

impl PocketMemory {
    /// The pairs of faces that meet, by ascending ids. `only_verdict`: ends at the first that
    /// cross, which is then among them.
    pub(crate) fn meetings<T: Tally>(
        &mut self,
        pair: &Pair,
        only_verdict: bool,
        counters: &mut T,
    ) -> Vec<FacePair> {
        if !self.tag.is_of(pair) {
            *self = Self { tag: PairTag::of(pair), ..Self::default() };
        }
        let both = self.bodies(pair, counters);
        let bodies = both.both();
        let posed = PosedModels {
            models: pair.models(),
            first_from_second: pair.first_from_second,
            error: pair.culling_error(),
        };
        let mut done = PocketCounters::default();
        let steps = self.steps(pair);
        self.pockets.open(&posed, bodies, steps, &mut done);
        let mut found = Vec::new();
        let mut look = |f: FaceId, g: FaceId, counters: &mut T| {
            let meeting = looked_at(pair, f, g, counters);
            found.extend(meeting);
            let ends = only_verdict && meeting.is_some_and(|m| m.meeting == Meeting::Cross);
            if ends { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let holds = |side: Side, node| bodies[side.index()].rest().has(node);
        let is_on_hulls = |f, g| bodies[0].is_on_hull(f) && bodies[1].is_on_hull(g);
        // Whether all was looked at does not matter to whoever wants a verdict.
        let _ = self.pockets.for_each_near(&posed, bodies, &mut done, |near| match near {
            Near::Faces(f, g) => look(f, g, counters),
            Near::Rests => for_each_near_pair_beneath(pair, 0.0, holds, counters, |f, g, c| {
                if is_on_hulls(f, g) { look(f, g, c) } else { ControlFlow::Continue(()) }
            }),
        });
        counters.counters().pockets_opened += done.opened;
        counters.counters().pockets_passed += done.passed;
        counters.counters().facets_compared += done.facets_compared;
        found.sort_unstable();
        found
    }

    /// For each body how far points of the other may have gone since the last query, seen from it.
    fn steps(&mut self, pair: &Pair) -> Option<[f64; 2]> {
        let before = self.map.replace(pair.first_from_second)?;
        let motion = RelativeMotion::since(&before, pair);
        Some(Side::BOTH.map(|side| {
            let guest = Ball::around(&pair.model(side.other()).bounds());
            motion.as_ref().map_or(0.0, |motion| motion.step_of(side.other(), &guest))
        }))
    }

    /// What the models do not hold; made now, where nobody has.
    fn bodies(&mut self, pair: &Pair, counters: &mut impl Tally) -> PerModel<PocketBody> {
        let bodies = self.bodies.get_or_insert_with(|| {
            let bodies = PerModel::of(pair, |side| {
                let model = pair.model(side);
                PocketBody::of(model, Arc::new(Concavities::of(model)))
            });
            counters.counters().concavities_made += bodies.count() as u64;
            bodies
        });
        bodies.clone()
    }

    pub(crate) fn bytes(&self) -> usize {
        let rest = |body: &PocketBody| body.rest().bytes();
        self.pockets.bytes() + self.bodies.as_ref().map_or(0, |bodies| bodies.bytes(rest))
    }
}
