//! Bodies that pass through nothing, however fast they are.
//!
//! The solver looks ahead by what it knows at the beginning of a step. What is faster than that can
//! be beyond a thin wall at its end. So once rapier has moved the bodies, the way of each one that
//! is named for it is held against those of the bodies around it, by the time of their first
//! meeting, and whoever would have met something on its way stays where it was just before. It
//! keeps its velocity: the next step finds the contact, and solves it.
//!
//! Ways are screws from the pose before to the pose after; [`shorten`] settles them among several
//! bodies.

use std::collections::BTreeMap;

use cranny_exact::DVec3;
use cranny_geometry::Model;
use cranny_impact::{Motion, Way, shorten};
use cranny_primitives::{BodyShape, MovingCores, let_until};
use rapier3d::math::Real;
use rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use rapier3d::prelude::QueryFilter;

use super::hooks::StepHooks;
use super::{BodyIndex, Simulation};
use crate::convert::{narrow, pose_from_rapier, pose_to_rapier, wide};
use crate::detector::Detector;
use crate::dispatcher::Dispatcher;
use crate::pair::ours;
use crate::partners::primitive;

/// The share of its way below which a body gets nowhere. Larger: what slides along a wall counts;
/// smaller: what hangs there for many steps does not.
const NOWHERE: f64 = 0.05;

/// What is left of the velocities of a body that gets nowhere twice in a row: a rod that swings
/// about a tip which the solver holds would go on to swing through the wall. Larger: it hangs there
/// for more steps; smaller: a throw that the solver would turn back loses its speed.
const KEPT_SPEED: Real = 0.5;

/// Elementary tests of a way. More: what slides along a thread stalls the step; fewer: ways among
/// many faces end before they have to.
const BUDGET: u64 = 200_000;

impl Simulation {
    /// Says whether a body passes through no other one, and no other one through it, however fast,
    /// from now on; until then it may, where it moves by more than its radius in a step. It costs
    /// some sweeps for each body that is near its way, certified between meshes, in steps in which
    /// it moves by more than half of what the thinner of both is thick; and once for a mesh, the
    /// cores that are swept. With our detector, and where neither lies wholly within the other;
    /// kinematic bodies and links of a robot are not held back, nor are two surfaces without a
    /// volume that touch. Of hooks [`StepHooks::responds`] counts, not [`StepHooks::modify`].
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
        let mut ways = BTreeMap::new();
        if !named.is_empty() && self.options.detector == Detector::Cranny {
            ways.extend(self.indices().map(|body| (body, self.way_of(body))));
            let pairs = self.pairs_on_the_way(&named, &ways, hooks);
            for &body in pairs.iter().flatten() {
                if let Some(shape) = self.shape_of(body) {
                    self.cores.note(body, &shape);
                }
            }
            let gives_way = |body| self.can_be_held(body);
            shorten(&mut ways, &pairs, gives_way, |pair, motions| self.meeting(pair, motions));
        }
        self.cores.retain(|body| ways.contains_key(body));
        self.stop(&ways);
    }

    /// From the pose before the step to the one after it.
    fn way_of(&self, body: BodyIndex) -> Way {
        let before = self.poses_before[body.0 as usize];
        let center = wide(self.tagged[body.0 as usize].center);
        Way::whole(Motion::between(before, self.pose(body), center))
    }

    /// Puts bodies where their ways end now, and brakes what gets nowhere for the second time.
    fn stop(&mut self, ways: &BTreeMap<BodyIndex, Way>) {
        let stalled = std::mem::take(&mut self.stalled);
        for (&body, way) in ways.iter().filter(|(_, way)| way.is_shortened()) {
            let pose = pose_to_rapier(&way.motion.pose_at(way.until));
            let handle = self.handle(body);
            let rigid = &mut self.bodies[handle];
            rigid.set_position(pose, true);
            if way.until < NOWHERE {
                self.stalled.insert(body.0);
                if stalled.contains(&body.0) {
                    rigid.set_linvel(rigid.linvel() * KEPT_SPEED, true);
                    rigid.set_angvel(rigid.angvel() * KEPT_SPEED, true);
                }
            }
            self.held_back += 1;
            self.settled = false;
        }
    }

    /// Whether a body may be put elsewhere on its way: a link of a robot is where its joints say.
    fn can_be_held(&self, body: BodyIndex) -> bool {
        let is_link = || self.multibody_joints.rigid_body_link(self.handle(body)).is_some();
        self.body(body).is_dynamic() && !is_link()
    }

    pub(super) fn model_of(&self, body: BodyIndex) -> Option<&Model> {
        let collider = self.colliders.get(self.tagged[body.0 as usize].collider)?;
        Some(ours(collider.shape())?.model())
    }

    /// What a body is made of, if Cranny knows it.
    fn shape_of(&self, body: BodyIndex) -> Option<BodyShape> {
        let collider = self.colliders.get(self.tagged[body.0 as usize].collider)?;
        if let Some(shape) = ours(collider.shape()) {
            return Some(shape.model().into());
        }
        let place = collider.position_wrt_parent().copied().unwrap_or_default();
        let body_from_shape = pose_from_rapier(&place).world_from_body();
        Some(primitive(collider.shape())?.moved(&body_from_shape).into())
    }

    /// Pairs of bodies, one of them named, that may meet on their ways.
    fn pairs_on_the_way(
        &self,
        named: &[BodyIndex],
        ways: &BTreeMap<BodyIndex, Way>,
        hooks: &impl StepHooks,
    ) -> Vec<[BodyIndex; 2]> {
        let dispatcher = Dispatcher::default();
        let tree = self.broad_phase.as_query_pipeline(
            &dispatcher,
            &self.bodies,
            &self.colliders,
            QueryFilter::new(),
        );
        // Its boxes are those at the end: others may have come from as far as any of them moves.
        let travel = |(&body, way): (&BodyIndex, &Way)| {
            let radius = self.tagged[body.0 as usize].radius;
            way.motion.travel.length() as Real
                + (way.motion.turn.length() as Real).min(2.0) * radius
        };
        let farthest = ways.iter().map(travel).fold(0.0, Real::max);
        let mut pairs: Vec<[BodyIndex; 2]> = Vec::new();
        for &body in named {
            let Some(swept) = self.swept(body, &ways[&body]) else { continue };
            for (_, collider) in tree.intersect_aabb_conservative(swept.loosened(farthest)) {
                let other = BodyIndex(collider.user_data as u32);
                let pair = [body.min(other), body.max(other)];
                let of_pair = pair.map(|body| &ways[&body]);
                // A half-space has no box.
                let crosses = || {
                    let way = self.swept(other, &ways[&other]);
                    way.is_none_or(|way| way.intersects(&swept))
                };
                if other != body && self.may_pass(pair, of_pair) && crosses() {
                    pairs.push(pair);
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs.retain(|&pair| self.responds(pair, hooks));
        pairs
    }

    /// A box that holds a body all along its way.
    fn swept(&self, body: BodyIndex, way: &Way) -> Option<Aabb> {
        let center = |t| way.motion.pose_at(t).world_from_body().apply(way.motion.pivot);
        let around = [0.0, 1.0].map(|t| Aabb::new(narrow(center(t)), narrow(center(t))));
        let reach = self.tagged[body.0 as usize].radius * (1.0 + Real::EPSILON.sqrt());
        let swept = around[0].merged(&around[1]).loosened(reach);
        (swept.mins.is_finite() && swept.maxs.is_finite()).then_some(swept)
    }

    /// Whether two bodies move far enough beside each other for one to be beyond the other, and one
    /// of them has a way of its own to give up.
    fn may_pass(&self, pair: [BodyIndex; 2], ways: [&Way; 2]) -> bool {
        let tagged = pair.map(|body| &self.tagged[body.0 as usize]);
        // A surface without a volume is as thin as can be.
        let thin = tagged.map(|t| if t.thickness.is_finite() { t.thickness } else { 0.0 });
        // One of them may be held back, and the other go on.
        let [a, b] = ways.map(|way| way.motion);
        let stopped = |of: Motion| Motion { travel: DVec3::ZERO, ..of };
        let travel = [[a, b], [stopped(a), b], [a, stopped(b)]]
            .map(|motions| self.travel_beside(pair, motions))
            .into_iter()
            .fold(0.0, f64::max);
        let gives_way = |k: usize| ways[k].moves() && self.can_be_held(pair[k]);
        travel > 0.5 * f64::from(thin[0].min(thin[1])) && (gives_way(0) || gives_way(1))
    }

    /// How far a point of one body moves beside another one, at most.
    fn travel_beside(&self, pair: [BodyIndex; 2], [a, b]: [Motion; 2]) -> f64 {
        let [of_a, of_b] = pair.map(|body| f64::from(self.tagged[body.0 as usize].radius));
        // A half-space that does not turn reaches no farther by it.
        let turned = |turn: DVec3, radius: f64| match turn.length() {
            0.0 => 0.0,
            turn => turn * radius,
        };
        (a.travel - b.travel).length() + turned(a.turn, of_a) + turned(b.turn, of_b)
    }

    /// Whether two bodies meet at all.
    fn responds(&self, [a, b]: [BodyIndex; 2], hooks: &impl StepHooks) -> bool {
        let [first, second] =
            [a, b].map(|body| &self.colliders[self.tagged[body.0 as usize].collider]);
        first.collision_groups().test(second.collision_groups()) && hooks.responds(a, b)
    }

    /// At which share of the ways that are left two bodies come as near each other as they are let.
    /// `None` also where one begins within the other.
    fn meeting(&self, pair: [BodyIndex; 2], motions: [Motion; 2]) -> Option<f64> {
        let cores = [self.cores.get(&pair[0])?, self.cores.get(&pair[1])?];
        let ends = [0, 1].map(|k| MovingCores { cores: cores[k], motion: motions[k] });
        let_until(ends, BUDGET)
    }
}
