//! The world: bodies by id, pairs by their boxes, and the step that computes what is wanted.
//! [`effects`] says what that is. A pair begins when boxes overlap and is dropped when they part
//! ([`World::update_pairs`]).

mod effects;

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;

use cranny_broad_phase::{AdaptiveBroadPhase, BroadPhase, Motion, OverlapEvent, ProxyId};
use cranny_exact::Pose;
use cranny_narrow_phase::{Answer, Demand, Fields, Query};
use cranny_primitives::{BodyShape, Primitive, PrimitiveError, ShapeQueryError};

use crate::body::{Body, BodyId, BodySpec};
use crate::bounds::world_box;
use crate::crew::{Crew, Job};
use crate::demand::{ContactFields, Wish};
use crate::description::{Accuracy, BodyKind};
use crate::error::{WorldError, WorldInvariantError};
use crate::estimates::{PairEstimate, PairState, Refinement, refine};
use crate::layers::Layers;
use crate::report::{
    PairAnswer, PairEvent, PairEventKind, PairMismatch, StepReport, StepStats, region_events,
};

/// Two bodies, the lower id first.
type Pair = (BodyId, BodyId);

/// Bodies at poses, and what is wanted of their pairs.
///
/// Calls between two steps take effect at the next [`step`](Self::step); their order is irrelevant
/// (but for the ids that insertion gives).
#[derive(Clone, Debug, Default)]
pub struct World {
    bodies: BTreeMap<BodyId, Body>,
    by_name: BTreeMap<String, BodyId>,
    inserted: u32,
    scene: Wish,
    /// What of the effect `Contacts` somebody reads.
    read: ContactFields,
    /// Of single pairs, besides.
    read_of_pairs: BTreeMap<Pair, ContactFields>,
    pair_wishes: BTreeMap<Pair, Wish>,
    /// Level of what states none.
    accuracy: Accuracy,
    /// The same of single pairs.
    pair_levels: BTreeMap<Pair, Accuracy>,
    /// Tests that pairs which may stay open take in a step together.
    budget: Option<u64>,
    excluded: BTreeSet<Pair>,
    broad_phase: AdaptiveBroadPhase,
    /// Of pairs whose boxes overlapped at the last step and of which something is wanted.
    memories: BTreeMap<Pair, PairState>,
    crew: Crew,
    /// Whether pairs are answered without memory as well.
    verify: bool,
    supplied: BTreeMap<Pair, Answer>,
    /// How deep pairs overlap at most in the coming step, as somebody else knows.
    depths_at_most: BTreeMap<Pair, f64>,
    /// Pairs that met within the coming step, whatever their answers.
    pressed: BTreeSet<Pair>,
    /// Pairs with a demand that touched at the last step.
    touching: BTreeSet<Pair>,
    /// Names of bodies that were removed since the last step, and before it.
    leaving: BTreeMap<BodyId, String>,
    left: BTreeMap<BodyId, String>,
    steps: u64,
}

/// Bodies.
impl World {
    /// An empty world without effects.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts a body in.
    ///
    /// # Errors
    ///
    /// A [name](WorldError::DuplicateName) that is taken, a [margin](WorldError::Margin) that is no
    /// length, a [pose](WorldError::Pose) or a [primitive](WorldError::Primitive) that is refused,
    /// or no [id](WorldError::NoIdLeft) or [room](WorldError::BroadPhase) left.
    pub fn insert(&mut self, spec: BodySpec) -> Result<BodyId, WorldError> {
        let id = BodyId(self.inserted);
        self.insert_as(id, spec).map(|()| id)
    }

    /// Puts a body in under an id that the caller gives, which must be higher than those of all
    /// bodies before it: for whoever counts bodies in several worlds.
    ///
    /// # Errors
    ///
    /// As [`insert`](Self::insert), and [`WorldError::IdUsed`] for an id that is not higher.
    pub fn insert_as(&mut self, id: BodyId, spec: BodySpec) -> Result<(), WorldError> {
        let BodySpec { name, shape, pose, kind, layers, sensor, effects } = spec;
        if id.0 < self.inserted {
            return Err(WorldError::IdUsed { name, body: id });
        }
        if let Some(&body) = self.by_name.get(&name) {
            return Err(WorldError::DuplicateName { name, body });
        }
        let wish = Wish::of(&effects, || format!("body '{name}'"))?;
        let pose =
            pose.accepted().map_err(|source| WorldError::Pose { name: name.clone(), source })?;
        shape.check().map_err(refused_primitive(&name, &shape))?;
        let Some(inserted) = id.0.checked_add(1) else {
            return Err(WorldError::NoIdLeft { name });
        };
        let body = Body { name, shape, pose, kind, layers, sensor, effects, wish };
        let around = world_box(&body.shape, &body.pose, self.growth(id, &body));
        self.broad_phase
            .insert(ProxyId(id.0), around, motion_of(kind))
            .map_err(|source| WorldError::BroadPhase { name: body.name.clone(), source })?;
        self.inserted = inserted;
        self.by_name.insert(body.name.clone(), id);
        self.bodies.insert(id, body);
        Ok(())
    }

    /// Takes a body out, with all that was said about its pairs. The next step reports that its
    /// touching pairs ended.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`].
    pub fn remove(&mut self, body: BodyId) -> Result<Body, WorldError> {
        let name = self.known(body)?.name.clone();
        self.broad_phase
            .remove(ProxyId(body.0))
            .map_err(|source| WorldError::BroadPhase { name: name.clone(), source })?;
        let removed = self.bodies.remove(&body).ok_or(WorldError::UnknownBody { body })?;
        self.by_name.remove(&name);
        self.leaving.insert(body, name);
        let others = |pair: &Pair| pair.0 != body && pair.1 != body;
        self.excluded.retain(others);
        self.pair_levels.retain(|pair, _| others(pair));
        self.read_of_pairs.retain(|pair, _| others(pair));
        self.supplied.retain(|pair, _| others(pair));
        self.depths_at_most.retain(|pair, _| others(pair));
        self.pressed.retain(others);
        let freed: Vec<Pair> = self.pair_wishes.keys().copied().filter(|p| !others(p)).collect();
        for (a, b) in freed {
            self.pair_wishes.remove(&(a, b));
            self.refresh_box(if a == body { b } else { a })?;
        }
        Ok(removed)
    }

    /// A body, if it is present.
    #[must_use]
    pub fn body(&self, body: BodyId) -> Option<&Body> {
        self.bodies.get(&body)
    }

    /// All bodies, by id.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = (BodyId, &Body)> {
        self.bodies.iter().map(|(&id, body)| (id, body))
    }

    /// Whose name it is.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<BodyId> {
        self.by_name.get(name).copied()
    }

    /// A body's name. Bodies that were removed keep theirs until the step after the one that
    /// reports their pairs' end, so that every event can be given by names.
    #[must_use]
    pub fn name(&self, body: BodyId) -> Option<&str> {
        let present = self.bodies.get(&body).map(|b| &b.name);
        let name = present.or_else(|| self.leaving.get(&body)).or_else(|| self.left.get(&body));
        name.map(String::as_str)
    }

    /// Moves a body. A quaternion of unit length to rounding is kept to the bit, others are
    /// normalised: [`Body::pose`] is what queries read.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], or a [pose](WorldError::Pose) that is refused.
    pub fn set_pose(&mut self, body: BodyId, pose: Pose) -> Result<(), WorldError> {
        let known = self.bodies.get_mut(&body).ok_or(WorldError::UnknownBody { body })?;
        known.pose = pose
            .accepted()
            .map_err(|source| WorldError::Pose { name: known.name.clone(), source })?;
        self.refresh_box(body)
    }

    /// Gives a body another geometry, in place of its own. Its id, pose and effects stay.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], a [primitive](WorldError::Primitive) that is refused, or no
    /// [room](WorldError::BroadPhase) for its box.
    pub fn set_shape(
        &mut self,
        body: BodyId,
        shape: impl Into<BodyShape>,
    ) -> Result<(), WorldError> {
        let shape = shape.into();
        let known = self.bodies.get_mut(&body).ok_or(WorldError::UnknownBody { body })?;
        shape.check().map_err(refused_primitive(&known.name, &shape))?;
        known.shape = shape;
        self.memories.retain(|pair, _| pair.0 != body && pair.1 != body);
        self.supplied.retain(|pair, _| pair.0 != body && pair.1 != body);
        self.depths_at_most.retain(|pair, _| pair.0 != body && pair.1 != body);
        self.pressed.retain(|pair| pair.0 != body && pair.1 != body);
        self.refresh_box(body)
    }

    /// Says how a body moves from now on.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], or no [room](WorldError::BroadPhase) for its box.
    pub fn set_kind(&mut self, body: BodyId, kind: BodyKind) -> Result<(), WorldError> {
        let known = self.bodies.get_mut(&body).ok_or(WorldError::UnknownBody { body })?;
        if motion_of(known.kind) != motion_of(kind) {
            let name = known.name.clone();
            self.broad_phase
                .set_moving(ProxyId(body.0), motion_of(kind))
                .map_err(|source| WorldError::BroadPhase { name, source })?;
        }
        known.kind = kind;
        Ok(())
    }

    /// Says which other bodies a body may meet from now on.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`].
    pub fn set_layers(&mut self, body: BodyId, layers: Layers) -> Result<(), WorldError> {
        let known = self.bodies.get_mut(&body).ok_or(WorldError::UnknownBody { body })?;
        known.layers = layers;
        Ok(())
    }

    /// Says whether a body is a sensor from now on: one that is noticed and never pushes.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`].
    pub fn set_sensor(&mut self, body: BodyId, sensor: bool) -> Result<(), WorldError> {
        let known = self.bodies.get_mut(&body).ok_or(WorldError::UnknownBody { body })?;
        known.sensor = sensor;
        Ok(())
    }

    fn known(&self, body: BodyId) -> Result<&Body, WorldError> {
        self.bodies.get(&body).ok_or(WorldError::UnknownBody { body })
    }

    /// Whether both are bodies with a mesh: what else there is has no memory to be verified.
    fn are_models(&self, bodies: [BodyId; 2]) -> bool {
        let shapes = bodies.map(|body| self.bodies.get(&body).map(|body| &body.shape));
        shapes.iter().all(|shape| matches!(shape, Some(BodyShape::Model(_))))
    }

    /// The pair in order of ids.
    fn known_pair(&self, a: BodyId, b: BodyId) -> Result<Pair, WorldError> {
        self.known(a)?;
        self.known(b)?;
        match a.cmp(&b) {
            std::cmp::Ordering::Less => Ok((a, b)),
            std::cmp::Ordering::Greater => Ok((b, a)),
            std::cmp::Ordering::Equal => Err(WorldError::SameBody { body: a }),
        }
    }
}

/// Steps.
impl World {
    /// Hands in an answer that somebody else found at the present poses (the solver's step, for
    /// pairs with `Response`): the next step reports it and does not query the pair. `answer` has
    /// `a` as A and `b` as B. A second call for the same pair replaces the first.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn supply(&mut self, a: BodyId, b: BodyId, answer: Answer) -> Result<(), WorldError> {
        let pair = self.known_pair(a, b)?;
        let answer = if pair == (a, b) { answer } else { answer.swapped() };
        self.supplied.insert(pair, answer);
        Ok(())
    }

    /// Says how deep two bodies overlap at most at the present poses, below 0 where a gap is left.
    /// The next step does not search the pair for a depth that is [read](ContactFields::depth) only
    /// where it is deeper; of what may touch it still computes the verdict.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn bound_depth(&mut self, a: BodyId, b: BodyId, at_most: f64) -> Result<(), WorldError> {
        let pair = self.known_pair(a, b)?;
        self.depths_at_most.insert(pair, at_most);
        Ok(())
    }

    /// Says that two bodies press on each other in the coming step: a solver kept them apart by an
    /// impulse. They then count as touching, however far apart their surfaces are at its poses.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn press(&mut self, a: BodyId, b: BodyId) -> Result<(), WorldError> {
        let pair = self.known_pair(a, b)?;
        self.pressed.insert(pair);
        Ok(())
    }

    /// Brings boxes and pairs up to date and answers, in the order of ids, every pair that has a
    /// demand and whose boxes overlap: exactly, or at its [level](Self::set_accuracy) and within
    /// the [budget](Self::set_budget).
    ///
    /// # Errors
    ///
    /// [`WorldError::Query`] where the narrow phase refuses a pair. The step has then not happened:
    /// the next one reports the difference to the last that did, and supplied answers are kept.
    pub fn step(&mut self) -> Result<StepReport, WorldError> {
        self.update_pairs();
        let mut stats = StepStats {
            boxes: self.bodies.len(),
            candidate_pairs: self.broad_phase.pairs().len(),
            supplied_pairs: self.supplied.len(),
            broad_phase: self.broad_phase.counters(),
            ..StepStats::default()
        };
        let queried = self.query_candidates();
        self.depths_at_most.clear();
        let Found { mut answers, mut estimates, mismatches, .. } = queried?;
        stats.queried_pairs = answers.len() + estimates.len();
        let is_verified = |pair: &&PairAnswer| self.verify && self.are_models([pair.a, pair.b]);
        stats.verified_pairs = answers.iter().filter(is_verified).count();
        let supplied = std::mem::take(&mut self.supplied);
        answers.extend(supplied.into_iter().map(|((a, b), answer)| PairAnswer { a, b, answer }));
        answers.sort_by_key(|pair| (pair.a, pair.b));
        estimates.sort_by_key(|pair| (pair.a, pair.b));
        let is_sensor = |id| self.bodies.get(id).is_some_and(Body::is_sensor);
        answers.iter().for_each(|pair| stats.add(pair, is_sensor(&pair.a) || is_sensor(&pair.b)));
        estimates.iter().for_each(|pair| stats.add_estimate(pair));
        let events = self.update_touching(&answers, &estimates);
        self.left = std::mem::take(&mut self.leaving);
        let step = self.steps;
        self.steps += 1;
        let touching = self.touching.iter().copied().collect();
        Ok(StepReport { step, answers, estimates, events, touching, stats, mismatches })
    }

    /// Says how many threads answer pairs from now on; until then one does, the caller's. Answers
    /// are the same to the bit with any number. A world that is cloned shares its threads with the
    /// clone.
    ///
    /// # Errors
    ///
    /// [`WorldError::Threads`] for more than one where the feature `parallel` is missing or the
    /// system refuses them. Those there were stay.
    pub fn set_threads(&mut self, threads: NonZeroUsize) -> Result<(), WorldError> {
        self.crew = Crew::of(threads).map_err(|why| WorldError::Threads { threads, why })?;
        Ok(())
    }

    /// Says whether from now on every pair that is queried is answered a second time without
    /// memory, and the two compared, to the bit; off until then. Answers and events stay those with
    /// memory; differences, which would be faults of Cranny's, are listed in
    /// [`StepReport::mismatches`]. A step then costs what it costs warm and cold together. Supplied
    /// answers are not compared, nor are estimates, which depend on memory where a budget ends
    /// them.
    pub fn set_verification(&mut self, verify: bool) {
        self.verify = verify;
    }

    /// How many steps were made: the number that the next one will carry.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The memory that is kept of pairs, as a count of pairs.
    #[must_use]
    pub fn remembered_pairs(&self) -> usize {
        self.memories.len()
    }

    /// Updates the broad phase and forgets pairs whose boxes have parted. `cranny-broad-phase`
    /// decides that they have: the header of its `pairs` says where.
    fn update_pairs(&mut self) {
        for event in self.broad_phase.update() {
            if let OverlapEvent::Ended(a, b) = *event {
                self.memories.remove(&(BodyId(a.0), BodyId(b.0)));
            }
        }
    }

    /// Answers what is wanted of pairs whose boxes overlap, but for what was supplied.
    fn query_candidates(&mut self) -> Result<Found, WorldError> {
        let mut memories = std::mem::take(&mut self.memories);
        let answers = self.query_with(&mut memories);
        self.memories = memories;
        answers
    }

    /// The demand that a pair's fields leave to the narrow phase, beside what somebody else knows
    /// of the pair.
    fn left_to_ask(&self, pair: &Pair, fields: Fields) -> Demand {
        if self.supplied.contains_key(pair) {
            return Demand::None;
        }
        match self.depths_at_most.get(pair) {
            None => fields.demand(),
            // A gap that is known is a verdict too.
            Some(&at_most) if at_most < 0.0 => fields.knowing_depth(at_most).demand(),
            Some(&at_most) => fields.knowing_depth(at_most).demand().join(Demand::Intersects),
        }
    }

    fn query_with(&self, memories: &mut BTreeMap<Pair, PairState>) -> Result<Found, WorldError> {
        let (mut jobs, mut refinements) = self.wanted(memories)?;
        let mut found = Found::default();
        let refined = refine(&mut refinements, self.budget, &self.crew);
        for refinement in refinements {
            let (pair, bodies) = (refinement.pair, refinement.bodies);
            let (state, estimate) = refinement.finish();
            memories.insert(pair, state);
            found.estimates.extend(estimate);
            if let (None, Err(source)) = (estimate, &refined) {
                found.refuse(bodies, (*source).into());
            }
        }
        let answers = self.crew.each(&mut jobs, |(_, job)| job.answer());
        for (((a, b), job), answer) in jobs.into_iter().zip(answers) {
            memories.insert((a, b), job.state);
            match answer {
                Ok((answer, mismatch)) => {
                    found.answers.push(PairAnswer { a, b, answer });
                    found.mismatches.extend(mismatch.map(|m| PairMismatch { a, b, mismatch: m }));
                }
                Err(source) => found.refuse(job.bodies, source),
            }
        }
        found.refused.take().map_or(Ok(found), Err)
    }

    /// Questions about pairs with overlapping boxes, with their memories: those answered exactly,
    /// and those estimated.
    fn wanted<'w>(
        &'w self,
        memories: &mut BTreeMap<Pair, PairState>,
    ) -> Result<AskedPairs<'w>, WorldError> {
        let (mut jobs, mut refinements) = (Vec::new(), Vec::new());
        for &(ProxyId(a), ProxyId(b)) in self.broad_phase.pairs() {
            let pair @ (a, b) = (BodyId(a), BodyId(b));
            let bodies @ [body_a, body_b] = [self.known(a)?, self.known(b)?];
            let wish = self.wish(pair, body_a, body_b);
            let fields = wish.fields(self.read_of(pair));
            if fields.demand() == Demand::None {
                memories.remove(&pair);
                continue;
            }
            let demand = self.left_to_ask(&pair, fields);
            if demand == Demand::None {
                continue;
            }
            let state = memories.remove(&pair).unwrap_or_default();
            let query = Query::of(demand);
            let level = self.level(&wish, pair, body_a.sensor || body_b.sensor);
            match (level, body_a.shape.model(), body_b.shape.model()) {
                (Some(level), Some(a), Some(b)) => {
                    refinements.push(Refinement::new(pair, bodies, [a, b], query, level, state));
                }
                _ => jobs.push((pair, Job { bodies, query, state, verify: self.verify })),
            }
        }
        Ok((jobs, refinements))
    }

    /// Replaces the set of touching pairs. Returns the difference, and the events of regions.
    fn update_touching(
        &mut self,
        answers: &[PairAnswer],
        estimates: &[PairEstimate],
    ) -> Vec<PairEvent> {
        let pressed = std::mem::take(&mut self.pressed);
        let asked = |a: &BodyId, b: &BodyId| match (self.bodies.get(a), self.bodies.get(b)) {
            (Some(body_a), Some(body_b)) => self.demand((*a, *b), body_a, body_b) != Demand::None,
            _ => false,
        };
        let met = answers.iter().filter(|pair| pair.answer.touches());
        let met = met.map(|pair| (pair.a, pair.b)).chain(pressed);
        let may_meet = estimates.iter().filter(|pair| pair.may_touch());
        let met = met.chain(may_meet.map(|pair| (pair.a, pair.b)));
        let touching: BTreeSet<Pair> = met.filter(|(a, b)| asked(a, b)).collect();
        let changed = self.touching.symmetric_difference(&touching).map(|&(a, b)| {
            let began = touching.contains(&(a, b));
            let kind = if began { PairEventKind::Began } else { PairEventKind::Ended };
            PairEvent { a, b, kind }
        });
        let asked = answers.iter().filter(|pair| asked(&pair.a, &pair.b));
        let of_regions = asked.flat_map(|pair| {
            region_events(&pair.answer).map(|kind| PairEvent { a: pair.a, b: pair.b, kind })
        });
        let mut events: Vec<PairEvent> = changed.chain(of_regions).collect();
        events.sort_unstable();
        self.touching = touching;
        events
    }

    /// Checks every invariant of the structure, those of the broad phase included. Quadratic in the
    /// number of bodies: for tests.
    ///
    /// # Errors
    ///
    /// The first invariant that is broken. It would be a bug of this crate.
    pub fn validate(&self) -> Result<(), WorldInvariantError> {
        let unless = |holds: bool, what: &str| {
            if holds { Ok(()) } else { Err(WorldInvariantError { what: what.to_owned() }) }
        };
        self.broad_phase
            .validate()
            .map_err(|error| WorldInvariantError { what: error.to_string() })?;
        unless(self.broad_phase.len() == self.bodies.len(), "one box a body")?;
        unless(self.by_name.len() == self.bodies.len(), "one name a body")?;
        for (&id, body) in &self.bodies {
            unless(id.0 < self.inserted, "ids count up")?;
            unless(self.by_name.get(&body.name) == Some(&id), "names lead to their bodies")?;
            let around = world_box(&body.shape, &body.pose, self.growth(id, body));
            unless(self.broad_phase.aabb(ProxyId(id.0)) == Some(around), "boxes follow poses")?;
        }
        let present =
            |(a, b): &Pair| a < b && self.bodies.contains_key(a) && self.bodies.contains_key(b);
        unless(self.pair_wishes.keys().all(present), "pair effects are of bodies present")?;
        unless(self.pair_levels.keys().all(present), "levels are of bodies present")?;
        unless(self.excluded.iter().all(present), "excluded pairs are of bodies present")?;
        unless(self.pressed.iter().all(present), "pressing pairs are of bodies present")?;
        unless(self.depths_at_most.keys().all(present), "bounds are of bodies present")?;
        unless(self.supplied.keys().all(present), "supplied answers are of bodies present")
    }
}

/// Pairs that are answered exactly, and pairs that are estimated.
type AskedPairs<'w> = (Vec<(Pair, Job<'w>)>, Vec<Refinement<'w>>);

/// What a step found about pairs, but for what was supplied.
#[derive(Default)]
struct Found {
    answers: Vec<PairAnswer>,
    estimates: Vec<PairEstimate>,
    mismatches: Vec<PairMismatch>,
    /// The first pair that the narrow phase refused.
    refused: Option<WorldError>,
}

impl Found {
    fn refuse(&mut self, [a, b]: [&Body; 2], source: ShapeQueryError) {
        let (a, b) = (a.name.clone(), b.name.clone());
        self.refused.get_or_insert(WorldError::Query { a, b, source });
    }
}

/// What is wrong with a primitive, as an error about the body.
fn refused_primitive<'a>(
    name: &'a str,
    shape: &BodyShape,
) -> impl Fn(PrimitiveError) -> WorldError + use<'a> {
    let what = shape.primitive().map_or("mesh", Primitive::name);
    move |source| WorldError::Primitive { name: name.to_owned(), what, source }
}

fn motion_of(kind: BodyKind) -> Motion {
    match kind {
        BodyKind::Fixed => Motion::Stationary,
        BodyKind::Kinematic | BodyKind::Dynamic => Motion::Moving,
    }
}
