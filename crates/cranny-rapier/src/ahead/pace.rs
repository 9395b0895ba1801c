//! Into how many parts a step is divided.
//!
//! Contacts are found at the beginning of a step, at the features that are nearest then. What
//! slides past an edge or turns meets others before the step ends, which no distance looked ahead
//! finds: a chain of thin rings that snaps taut goes through itself by half its wire. So a step in
//! which something moves too far beside what it may meet is made in parts, contacts found at the
//! beginning of each. Steps in which all are slow, nearly all, stay whole.
//!
//! No source: this crate's own. Cost: a question to the broad phase for each fast body.

use rapier3d::geometry::BroadPhaseBvh;
use rapier3d::math::Real;
use rapier3d::prelude::{IntegrationParameters, QueryFilter};

use super::{KnownMotions, Motions, PairAhead, World, longest};
use crate::dispatcher::Dispatcher;
use std::sync::PoisonError;

/// How far two bodies may move beside each other in a part of a step, in multiples of the thinner
/// one's thickness. With up to four parts a chain of wire of 0.06 is 0.0110, 0.0085, 0.0084, 0.0144
/// and, undivided, 0.0379 deep at 0.5, 0.7, 1, 1.5 and 99; its steps took 4.1, 3.8, 2.9, 2.3 and
/// 2.7 ms.
const LONGEST_PART: Real = 1.0;

/// A pair of bodies whose motion beside each other is bounded.
struct Pass {
    /// How far a point of one may move beside the other, turning included.
    travel: Real,
    /// Of the thinner.
    thickness: Real,
}

impl Pass {
    /// In how many parts it may be made, as a real number.
    fn parts(&self) -> Real {
        self.travel / (LONGEST_PART * self.thickness)
    }
}

impl Motions {
    /// How many parts the next step needs, from 1 to `most`; called after [`look`](Self::look).
    pub(crate) fn parts(
        &self,
        world: &World,
        broad_phase: &mut BroadPhaseBvh,
        parameters: &IntegrationParameters,
        most: usize,
    ) -> usize {
        let known = self.0.read().unwrap_or_else(PoisonError::into_inner);
        let needed = Passes { known: &known, world }.worst(broad_phase, parameters);
        // Not a number where something is nowhere: rapier stops there by itself.
        let whole = needed.ceil().clamp(1.0, most.max(1) as Real);
        if whole.is_nan() { 1 } else { whole as usize }
    }
}

struct Passes<'a> {
    known: &'a KnownMotions,
    world: &'a World<'a>,
}

impl Passes<'_> {
    /// The most parts that any two bodies near each other need.
    fn worst(&self, broad_phase: &mut BroadPhaseBvh, parameters: &IntegrationParameters) -> Real {
        let thinnest =
            self.world.tagged.iter().map(|tagged| tagged.thickness).fold(Real::INFINITY, Real::min);
        let World { bodies, colliders, .. } = *self.world;
        let dispatcher = Dispatcher::default();
        let tree =
            broad_phase.as_query_pipeline(&dispatcher, bodies, colliders, QueryFilter::new());
        let mut most: Real = 0.0;
        for (i, motion) in self.known.bodies.iter().enumerate() {
            // The faster of two makes half of what they do beside each other at least.
            let pass = Pass { travel: 2.0 * self.reach(i), thickness: thinnest };
            if pass.parts() <= most.max(1.0) {
                continue;
            }
            let around = motion.swept(0.5 * parameters.prediction_distance() + motion.spin);
            for (_, collider) in tree.intersect_aabb_conservative(around) {
                let j = collider.user_data as usize;
                if j != i && j < self.known.bodies.len() {
                    most = most.max(self.between(i, j).map_or(0.0, |pass| pass.parts()));
                }
            }
        }
        most
    }

    fn between(&self, i: usize, j: usize) -> Option<Pass> {
        let motions = [i, j].map(|k| self.known.bodies[k]);
        let turning = motions[0].spin + motions[1].spin;
        let base = self.known.base + turning;
        let pair = PairAhead { motions, base, reserve: base };
        let thickness = [i, j].map(|k| self.world.tagged[k].thickness);
        let travel = longest(&pair.may()) + turning;
        (!pair.stay_apart()).then_some(Pass { travel, thickness: thickness[0].min(thickness[1]) })
    }

    /// How far a point of a body may move.
    fn reach(&self, i: usize) -> Real {
        longest(&self.known.bodies[i].may) + self.known.bodies[i].spin
    }
}
