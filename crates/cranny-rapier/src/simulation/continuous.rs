//! Bodies that pass through nothing, however fast they are.
//!
//! The solver looks ahead by what it knows at the beginning of a step. What is faster than that can
//! be beyond a thin wall at its end. So once rapier has moved the bodies, the way of each one that
//! is named for it is held against those of the bodies around it, by the certified time of impact,
//! and whoever would have met something on its way stays where it was just before. It keeps its
//! velocity, unless it gets nowhere: the next step finds the contact, and solves it.
//!
//! Ways are screws from the pose before to the pose after. Of several bodies that meet, each is
//! held back to the earliest of its meetings; as that changes ways, they are held against each
//! other again, and what has not come to an end after [`ROUNDS`] stops at one common time, up to
//! which nothing met anything.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_impact::{Impact, ImpactOptions, Motion, Moving, time_of_impact};
use cranny_narrow_phase::{Answer, Demand, PairMemory, Placed, Query, Surface, query};
use rapier3d::math::Real;
use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::prelude::QueryFilter;

use super::hooks::StepHooks;
use super::{BodyIndex, Simulation};
use crate::convert::{narrow, pose_from_rapier, pose_to_rapier, wide};
use crate::dispatcher::Dispatcher;
use crate::pair::ours;

/// How often ways are held against each other anew. More: a pile that is hit hard takes longer;
/// fewer: bodies stop that would have gone on.
const ROUNDS: usize = 4;

/// How near a body is let to what it would meet, as a part of the thinner body's thickness. Larger:
/// it hovers; smaller: f32 cannot tell the gap from none.
const NEAR: f64 = 0.01;

/// The least gap, as a part of the same. Larger: what touches is held; smaller: it is none in f32.
const NEAREST: f64 = 1e-5;

/// The share of its way below which a body gets nowhere, and what is left of its velocities then: a
/// rod that swings about a tip which the solver holds would go on to swing through the wall.
/// Larger: what slides along a wall is braked; smaller: it hangs there for many steps.
const NOWHERE: f64 = 0.05;
const KEPT_SPEED: Real = 0.5;

/// Elementary tests of a way. More: what slides along a thread stalls the step; fewer: ways among
/// many faces end before they have to.
const BUDGET: u64 = 200_000;

/// Bodies that met each other, by the lowest of each group.
#[derive(Default)]
struct Groups(BTreeMap<BodyIndex, BodyIndex>);

impl Groups {
    fn of(&self, body: BodyIndex) -> BodyIndex {
        let mut at = body;
        while let Some(&next) = self.0.get(&at) {
            at = next;
        }
        at
    }

    fn join(&mut self, [a, b]: [BodyIndex; 2]) {
        let [a, b] = [self.of(a), self.of(b)];
        if a != b {
            self.0.insert(a.max(b), a.min(b));
        }
    }
}

/// What a body does within a step, and up to which share of its way.
#[derive(Clone, Copy)]
struct Going {
    motion: Motion,
    until: f64,
}

impl Going {
    /// Whether it goes anywhere.
    fn moves(&self) -> bool {
        self.motion.travel != DVec3::ZERO || self.motion.turn != DVec3::ZERO
    }

    /// As far as it may go.
    fn motion(&self) -> Motion {
        let Motion { turn, travel, .. } = self.motion;
        Motion { turn: self.until * turn, travel: self.until * travel, ..self.motion }
    }
}

impl Simulation {
    /// Says whether a body passes through no other one, and no other one through it, however fast,
    /// from now on; until then it may, where it moves by more than its radius in a step. It costs a
    /// certified time of impact for each body that is near its way, in steps in which it moves by
    /// more than the thinner of both is thick. With our detector, and where neither is overlapped
    /// by the other already; kinematic bodies and links of a robot are not held back. Of an app's
    /// hooks [`StepHooks::responds`] counts, not [`StepHooks::modify`].
    pub fn set_continuous(&mut self, body: BodyIndex, continuous: bool) {
        let handle = self.handle(body);
        // rapier's own way is off for our shapes, which are as thick as can be to it.
        if self.body(body).is_ccd_enabled() != continuous {
            self.bodies[handle].enable_ccd(continuous);
        }
    }

    /// How many bodies were held back in the last step.
    #[must_use]
    pub fn held_back(&self) -> usize {
        self.held_back
    }

    /// Holds back what would have passed through something.
    pub(super) fn hold_back(&mut self, hooks: &impl StepHooks) {
        let named: Vec<BodyIndex> =
            self.indices().filter(|&index| self.body(index).is_ccd_enabled()).collect();
        if named.is_empty() {
            self.stalled.clear();
            return;
        }
        let pairs = self.pairs_on_the_way(&named, hooks);
        let mut going: BTreeMap<BodyIndex, Going> = BTreeMap::new();
        for &[a, b] in &pairs {
            for body in [a, b] {
                let all = || Going { motion: self.way_of(body), until: 1.0 };
                going.entry(body).or_insert_with(all);
            }
        }
        let free = going.clone();
        let mut together = Groups::default();
        for round in 0.. {
            let meetings: Vec<([BodyIndex; 2], f64)> = pairs
                .iter()
                .filter_map(|&pair| Some((pair, self.meeting(pair, &going)?)))
                .collect();
            if meetings.is_empty() {
                break;
            }
            let before = going.clone();
            for (pair, time) in meetings {
                if pair.iter().all(|&body| self.can_be_held(body)) {
                    together.join(pair);
                }
                for body in pair.into_iter().filter(|&body| self.can_be_held(body)) {
                    if let Some(going) = going.get_mut(&body) {
                        going.until = going.until.min(time * before[&body].until);
                    }
                }
            }
            if round == ROUNDS {
                // Whoever met stops together, as far as none of them has met another.
                let mut earliest: BTreeMap<BodyIndex, f64> = BTreeMap::new();
                for (&body, going) in &going {
                    let first = earliest.entry(together.of(body)).or_insert(1.0);
                    *first = first.min(going.until);
                }
                for (body, going) in &mut going {
                    *going = Going { until: earliest[&together.of(*body)], ..free[body] };
                }
                break;
            }
        }
        let stopped: Vec<(BodyIndex, Going)> = going
            .into_iter()
            .filter(|(body, going)| going.until < 1.0 && going.moves() && self.can_be_held(*body))
            .collect();
        self.held_back += stopped.len();
        let stalled_before = std::mem::take(&mut self.stalled);
        for (body, going) in stopped {
            let pose = going.motion.pose_at(going.until);
            let handle = self.handle(body);
            let rigid = &mut self.bodies[handle];
            rigid.set_position(pose_to_rapier(&pose), true);
            if going.until < NOWHERE {
                self.stalled.insert(body.0);
                if stalled_before.contains(&body.0) {
                    rigid.set_linvel(rigid.linvel() * KEPT_SPEED, true);
                    rigid.set_angvel(rigid.angvel() * KEPT_SPEED, true);
                }
            }
            self.settled = false;
        }
    }

    /// Whether a body may be put elsewhere on its way: a link of a robot is where its joints say.
    fn can_be_held(&self, body: BodyIndex) -> bool {
        let is_link = || self.multibody_joints.rigid_body_link(self.handle(body)).is_some();
        self.body(body).is_dynamic() && !is_link()
    }

    fn model_of(&self, body: BodyIndex) -> Option<&Model> {
        let collider = self.colliders.get(self.tagged[body.0 as usize].collider)?;
        Some(ours(collider.shape())?.model())
    }

    /// From the pose before the step to the one after it.
    fn way_of(&self, body: BodyIndex) -> Motion {
        let before = self.poses_before[body.0 as usize];
        let center = wide(self.tagged[body.0 as usize].center);
        Motion::between(before, self.pose(body), center)
    }

    /// Pairs of bodies, one of them named, that may have met on their ways.
    fn pairs_on_the_way(
        &self,
        named: &[BodyIndex],
        hooks: &impl StepHooks,
    ) -> BTreeSet<[BodyIndex; 2]> {
        let dispatcher = Dispatcher::default();
        let tree = self.broad_phase.as_query_pipeline(
            &dispatcher,
            &self.bodies,
            &self.colliders,
            QueryFilter::new(),
        );
        // Others may have come from as far as any of them moves and turns.
        let travel = |body: BodyIndex| {
            let (way, radius) = (self.way_of(body), self.tagged[body.0 as usize].radius);
            way.travel.length() as Real + (way.turn.length() as Real).min(2.0) * radius
        };
        let farthest = self.indices().map(travel).fold(0.0, Real::max);
        let mut pairs = BTreeSet::new();
        for &body in named {
            let Some(swept) = self.swept(body) else { continue };
            for (_, collider) in tree.intersect_aabb_conservative(swept.loosened(farthest)) {
                let other = BodyIndex(collider.user_data as u32);
                let pair = [body.min(other), body.max(other)];
                let crosses = || self.swept(other).is_some_and(|way| way.intersects(&swept));
                if other != body
                    && self.may_pass(pair)
                    && self.can_give_way(pair)
                    && crosses()
                    && self.responds(pair, hooks)
                {
                    pairs.insert(pair);
                }
            }
        }
        pairs
    }

    /// A box that holds a body all along its way.
    fn swept(&self, body: BodyIndex) -> Option<Aabb> {
        let tagged = &self.tagged[body.0 as usize];
        let motion = self.way_of(body);
        let centers = [0.0, 1.0].map(|t| motion.pose_at(t).world_from_body().apply(motion.pivot));
        let around = centers.map(|center| Aabb::new(narrow(center), narrow(center)));
        let reach = tagged.radius * (1.0 + Real::EPSILON.sqrt());
        let swept = around[0].merged(&around[1]).loosened(reach);
        (swept.mins.is_finite() && swept.maxs.is_finite()).then_some(swept)
    }

    /// Whether two bodies move far enough beside each other for one to be beyond the other.
    fn may_pass(&self, pair: [BodyIndex; 2]) -> bool {
        // A surface without a volume is as thin as can be.
        let thin = pair.map(|body| f64::from(self.tagged[body.0 as usize].thickness));
        let thin = thin.map(|thin| if thin.is_finite() { thin } else { 0.0 });
        let moved = pair.map(|body| {
            let (motion, tagged) = (self.way_of(body), &self.tagged[body.0 as usize]);
            (motion.travel, motion.turn.length() * f64::from(tagged.radius))
        });
        let travel = (moved[0].0 - moved[1].0).length() + moved[0].1 + moved[1].1;
        travel > 0.5 * thin[0].min(thin[1])
    }

    /// Whether one of two bodies has a way of its own to give up: what is at rest cannot flee.
    fn can_give_way(&self, pair: [BodyIndex; 2]) -> bool {
        let goes = |body| Going { motion: self.way_of(body), until: 1.0 }.moves();
        pair.into_iter().any(|body| self.can_be_held(body) && goes(body))
    }

    /// Whether two bodies meet at all.
    fn responds(&self, [a, b]: [BodyIndex; 2], hooks: &impl StepHooks) -> bool {
        let [first, second] =
            [a, b].map(|body| &self.colliders[self.tagged[body.0 as usize].collider]);
        first.collision_groups().test(second.collision_groups())
            && !self.excluded.contains(&(a.0, b.0))
            && hooks.responds(a, b)
    }

    /// At which share of the ways that are left two bodies come as near each other as they are let:
    /// half as near as they are at the beginning, where they are very near already. `None` also
    /// where they overlap at the beginning.
    fn meeting(&self, pair: [BodyIndex; 2], going: &BTreeMap<BodyIndex, Going>) -> Option<f64> {
        let moving = |body: BodyIndex| {
            Some(Moving { model: self.model_of(body)?, motion: going.get(&body)?.motion() })
        };
        let ends = [moving(pair[0])?, moving(pair[1])?];
        let sizes = pair.map(|body| {
            let tagged = &self.tagged[body.0 as usize];
            f64::from(tagged.thickness.min(tagged.radius))
        });
        let near = NEAR * sizes[0].min(sizes[1]);
        let gap = answered(&ends, 0.0, Demand::Distance { below: Some(near) })?.distance?;
        if gap == 0.0 {
            return None;
        }
        let options = ImpactOptions { tolerance: near.min(0.5 * gap), budget: BUDGET };
        let time = match time_of_impact(ends[0], ends[1], &options) {
            Ok((Impact::None | Impact::Initially { .. }, _)) | Err(_) => return None,
            Ok((Impact::Hit(hit), _)) => hit.time.lo,
            Ok((Impact::Open { free_before }, _)) => free_before,
        };
        // What is as near as rapier can tell stays where it is, or leaves.
        let stays = 0.5 * gap < NEAREST * sizes[0].min(sizes[1]);
        Some(if stays { 0.0 } else { free_until(&ends, time) })
    }
}

/// What is true of two bodies at a share of their ways, in rapier's numbers.
fn answered(ends: &[Moving<'_>; 2], time: f64, demand: Demand) -> Option<Answer> {
    let [a, b] = ends.map(|end| {
        let pose = pose_from_rapier(&pose_to_rapier(&end.motion.pose_at(time)));
        Placed { model: end.model, pose }
    });
    query(a, b, &Query::of(demand), &mut PairMemory::default()).ok()
}

/// The time, or an earlier one if rounding to rapier's numbers makes the bodies meet there.
fn free_until(ends: &[Moving<'_>; 2], mut time: f64) -> f64 {
    while time > f64::from(Real::EPSILON) {
        let answer = answered(ends, time, Demand::Intersects);
        if answer.is_some_and(|answer| !answer.solid && answer.surface == Surface::None) {
            return time;
        }
        time *= 0.5;
    }
    0.0
}
