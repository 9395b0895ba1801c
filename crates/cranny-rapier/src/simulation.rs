//! A rapier world of models: all of rapier's sets behind body numbers, with the settings that the
//! detector needs.
//!
//! | rapier setting | here | why |
//! |---|---|---|
//! | `contact_clustering` | off with [`Detector::Cranny`] | it merges normals within 5 degrees and keeps the first; ours are few and exact at their own points |
//! | `contact_recycling` | off with [`Detector::Cranny`] unless asked for, and then only of pairs at rest that drift by [`KEPT_WITHIN`] at most | by rapier's default contacts are kept while a pair drifts by several prediction distances; thin gaps do not forgive that |
//! | `friction_model` | Coulomb with [`Detector::Cranny`] | the simplified model rubs at a manifold's middle; most of ours have one point |
//! | `num_solver_iterations` | enough for [`SOLVER_SUBSTEP`] with [`Detector::Cranny`] unless asked for | they are rapier's substeps: at 1/60 s its default of 4 lets a falling chain sink in by half a link before it is stopped |
//! | `normalized_prediction_distance` | with [`Detector::Cranny`] at each step at least as far as any two bodies near each other can come nearer in it; each pair is looked at as far as *its* bodies can | fast bodies are stopped before they overlap, also where one of two that fall together is stopped by a third |
//! | `soft_ccd_prediction` of dynamic bodies | the body's radius with other detectors | rapier's own way to look ahead; it leaves out pairs that approach each other only once one of them is stopped |
//! | the rest | rapier's defaults | |
//!
//! Other detectors run with rapier's defaults but for the last of these, recycling as the options say.

use std::collections::HashSet;
use std::sync::Arc;

use cranny_exact::{DVec3, Pose, PoseError};
use cranny_geometry::Model;
use cranny_narrow_phase::{Answer, Demand, Normals};
use rapier3d::geometry::{ContactPair, Group, InteractionGroups, InteractionTestMode};
use rapier3d::math::Real;
use rapier3d::pipeline::PairFilterContext;
use rapier3d::prelude::{
    ActiveHooks, CCDSolver, ColliderBuilder, ColliderSet, DefaultBroadPhase, FrictionModel,
    ImpulseJointSet, IntegrationParameters, IslandManager, MultibodyJointSet, NarrowPhase,
    PhysicsHooks, PhysicsPipeline, RigidBody, RigidBodyBuilder, RigidBodyHandle, RigidBodySet,
    RigidBodyType, SoftBodySet, SolverFlags,
};
use thiserror::Error;

use crate::ahead::{Motions, Tagged, World};
use crate::convert::{narrow, pose_from_rapier, pose_to_rapier, wide};
use crate::detector::Detector;
use crate::dispatcher::Dispatcher;
use crate::joint::{JointSpec, generic_joint};
use crate::log::AnswerLog;
use crate::mass::{MassError, mass_properties};
use crate::shape::ShapeError;

/// The longest solver substep with our detector, seconds. rapier's default of four substeps has it at
/// 240 Hz. Longer: a chain of twelve links tears at 60 Hz; shorter: solving takes longer for nothing.
pub const SOLVER_SUBSTEP: f64 = 1.0 / 960.0;

/// How far, as a multiple of the length unit, a pair of slow bodies may drift and keep the contacts of an earlier step: a tenth of
/// rapier's own allowance for overlaps. A contact rides with its bodies meanwhile, its separation with it. Larger: what comes near while a
/// pair drifts is seen later by as much; smaller: what rests is asked about in each step.
pub const KEPT_WITHIN: f64 = 0.0005;

/// How a simulation runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationOptions {
    /// Who detects contacts.
    pub detector: Detector,
    /// Acceleration of dynamic bodies.
    pub gravity: DVec3,
    /// Seconds a step, > 0.
    pub step: f64,
    /// How many units of length make what rapier takes for a metre; scales its prediction distance
    /// (0.02 of it) and tolerances.
    pub length_unit: f64,
    /// Whether rapier may reuse contacts while a pair moves little. `None`: its default for its own
    /// detectors, never for ours. With ours, where asked for, within [`KEPT_WITHIN`], and never of what is about to move by
    /// more than half the prediction distance.
    pub recycling: Option<bool>,
    /// Solver substeps a step, at least 1. `None`: rapier's default for its own detectors, enough for
    /// [`SOLVER_SUBSTEP`] for ours.
    pub solver_iterations: Option<usize>,
    /// Into how many parts a step is divided at most in which two bodies near each other move farther than the thinner
    /// one is thick; contacts are found at the beginning of each. 1: never, as rapier's own pipeline.
    /// More than 2: fast chains overlap less, and large piles take longer to fall (figures in the README).
    /// Our detector only.
    pub most_parts: usize,
}

impl SimulationOptions {
    /// Solver substeps a step.
    #[must_use]
    pub fn substeps(&self) -> usize {
        let usual = IntegrationParameters::default().num_solver_iterations;
        match self.solver_iterations {
            Some(iterations) => iterations.max(1),
            None if self.detector == Detector::Cranny => Self::substeps_for(self.step),
            None => usual,
        }
    }

    /// Solver substeps that our detector's contacts need in a step of so many seconds: of
    /// [`SOLVER_SUBSTEP`] at most, and not fewer than rapier's default.
    #[must_use]
    pub fn substeps_for(step: f64) -> usize {
        let enough = (step / SOLVER_SUBSTEP).round() as usize;
        enough.max(IntegrationParameters::default().num_solver_iterations)
    }
}

impl SimulationOptions {
    /// Whether only what rests may keep its contacts.
    fn keeps_resting(&self) -> bool {
        self.detector == Detector::Cranny && self.recycling == Some(true)
    }
}

impl Default for SimulationOptions {
    fn default() -> Self {
        Self {
            detector: Detector::default(),
            gravity: DVec3::new(0.0, 0.0, -9.81),
            step: 1.0 / 60.0,
            length_unit: 1.0,
            recycling: None,
            solver_iterations: None,
            most_parts: 2,
        }
    }
}

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyKind {
    /// Not at all.
    Fixed,
    /// With its given velocity, whatever it meets.
    Kinematic,
    /// As forces and contacts say.
    Dynamic,
}

/// A body to be inserted.
#[derive(Clone, Debug)]
pub struct BodySpec<'a> {
    /// Geometry.
    pub model: &'a Model,
    /// How it moves.
    pub kind: BodyKind,
    /// Where it starts.
    pub pose: Pose,
    /// Units a second.
    pub linear_velocity: DVec3,
    /// Radians a second.
    pub angular_velocity: DVec3,
    /// Mass per volume.
    pub density: f64,
    /// Coulomb coefficient.
    pub friction: f64,
    /// 0 to 1.
    pub restitution: f64,
    /// Whose normals its contacts have for the solver: its facets' or, opted in, those of the curved surface that they
    /// stand for ([`MeshShape::with_smooth_normals`](crate::MeshShape::with_smooth_normals)). Our detector only.
    pub normals: Normals,
    /// Bodies meet where their bits overlap.
    pub groups: u32,
}

/// A body of a simulation, counted from 0 in order of insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyIndex(pub u32);

/// A body that cannot be inserted.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// Its shape.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// Its mass.
    #[error(transparent)]
    Mass(#[from] MassError),
    /// Its pose.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// Another number.
    #[error("{what} is {value}: it must be {expected}")]
    Number {
        /// Which field of [`BodySpec`].
        what: &'static str,
        /// The value found.
        value: f64,
        /// What it must be.
        expected: &'static str,
    },
}

/// Refuses what rapier would carry into every pose that it touches.
fn check_numbers(spec: &BodySpec) -> Result<(), SimulationError> {
    let (linear, angular) = (spec.linear_velocity, spec.angular_velocity);
    let velocities = linear.to_array().map(|v| ("linear velocity", v)).into_iter();
    let velocities = velocities.chain(angular.to_array().map(|v| ("angular velocity", v)));
    for (what, value) in velocities {
        if !(value as Real).is_finite() {
            return Err(SimulationError::Number {
                what,
                value,
                expected: "a number that rapier can hold",
            });
        }
    }
    for (what, value) in [("friction", spec.friction), ("restitution", spec.restitution)] {
        if !(value >= 0.0 && (value as Real).is_finite()) {
            let expected = "a finite number, 0 or more";
            return Err(SimulationError::Number { what, value, expected });
        }
    }
    Ok(())
}

/// What the detector said of a pair in rapier's last step.
#[derive(Clone, Debug)]
pub struct PairContacts {
    /// Lower body.
    pub a: BodyIndex,
    /// Higher body.
    pub b: BodyIndex,
    /// In world coordinates.
    pub answer: Arc<Answer>,
    /// Of a and b, from which the answer was computed: those at the beginning of the step, or of its last part.
    pub poses: [Pose; 2],
    /// Computed in the last step; otherwise rapier recycled older contacts.
    pub fresh: bool,
}

/// Mechanical energy of all dynamic bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Of motion.
    pub kinetic: f64,
    /// Of height: −mass · gravity · centre of mass.
    pub potential: f64,
}

impl Energy {
    /// Sum of both.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential
    }
}

/// Milliseconds of the last step, by rapier's own counters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timings {
    /// Broad phase.
    pub broad: f64,
    /// Narrow phase, contact detection included.
    pub narrow: f64,
    /// What [`Simulation::read_by`] cost besides: questions that the solver does not ask.
    pub reading: f64,
    /// Constraints solver.
    pub solver: f64,
    /// The whole step.
    pub step: f64,
}

impl Timings {
    fn plus(self, other: &Self) -> Self {
        Self {
            broad: self.broad + other.broad,
            narrow: self.narrow + other.narrow,
            reading: self.reading + other.reading,
            solver: self.solver + other.solver,
            step: self.step + other.step,
        }
    }
}

/// A rapier world of models.
pub struct Simulation {
    pub(crate) options: SimulationOptions,
    pub(crate) parameters: IntegrationParameters,
    pub(crate) pipeline: PhysicsPipeline,
    pub(crate) islands: IslandManager,
    pub(crate) broad_phase: DefaultBroadPhase,
    pub(crate) narrow_phase: NarrowPhase,
    pub(crate) bodies: RigidBodySet,
    pub(crate) colliders: ColliderSet,
    pub(crate) joints: ImpulseJointSet,
    pub(crate) multibody_joints: MultibodyJointSet,
    pub(crate) soft_bodies: SoftBodySet,
    pub(crate) ccd: CCDSolver,
    pub(crate) handles: Vec<RigidBodyHandle>,
    pub(crate) tagged: Vec<Tagged>,
    pub(crate) motions: Motions,
    /// Whether rapier has seen all bodies where they are.
    pub(crate) settled: bool,
    /// The prediction distance of the last step.
    pub(crate) looked_ahead: Real,
    /// In how many parts the last step was made, and what it took.
    pub(crate) parts: usize,
    timings: Timings,
    pub(crate) poses_before: Vec<Pose>,
    pub(crate) exclusions: Exclusions,
    pub(crate) log: AnswerLog,
    /// Whether joints were inserted that no step has seen: rapier's serde would lose that.
    #[cfg_attr(not(feature = "snapshot"), allow(dead_code, reason = "a snapshot asks"))]
    pub(crate) joined: bool,
}

/// Pairs of tags that never meet, lower first.
#[derive(Default)]
pub(crate) struct Exclusions(pub(crate) HashSet<(u32, u32)>);

impl PhysicsHooks for Exclusions {
    fn filter_contact_pair(&self, context: &PairFilterContext) -> Option<SolverFlags> {
        let tag = |handle| context.colliders.get(handle).map(|c| c.user_data as u32);
        let excluded = match (tag(context.collider1), tag(context.collider2)) {
            (Some(a), Some(b)) => self.0.contains(&(a.min(b), a.max(b))),
            _ => false,
        };
        (!excluded).then(SolverFlags::default)
    }
}

fn dispatcher_of(log: &AnswerLog, motions: &Motions) -> Dispatcher {
    Dispatcher::with_log(log.clone()).looking_ahead(motions.clone())
}

impl Simulation {
    /// An empty world.
    #[must_use]
    pub fn new(options: SimulationOptions) -> Self {
        let ours = options.detector == Detector::Cranny;
        let mut parameters = IntegrationParameters {
            dt: options.step as Real,
            length_unit: options.length_unit as Real,
            ..IntegrationParameters::default()
        };
        if ours {
            parameters.contact_clustering = false;
            parameters.friction_model = FrictionModel::Coulomb;
        }
        parameters.num_solver_iterations = options.substeps();
        parameters.contact_recycling = options.recycling.unwrap_or(!ours);
        if options.keeps_resting() {
            parameters.normalized_contact_recycle_distance = KEPT_WITHIN as Real;
        }
        let (log, motions) = (AnswerLog::default(), Motions::default());
        let dispatcher = dispatcher_of(&log, &motions);
        let mut pipeline = PhysicsPipeline::new();
        pipeline.counters.enable();
        Self {
            options,
            parameters,
            pipeline,
            islands: IslandManager::new(),
            broad_phase: DefaultBroadPhase::new(),
            narrow_phase: NarrowPhase::with_query_dispatcher(dispatcher),
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            joints: ImpulseJointSet::new(),
            multibody_joints: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            ccd: CCDSolver::new(),
            handles: Vec::new(),
            tagged: Vec::new(),
            motions,
            settled: false,
            looked_ahead: 0.0,
            parts: 1,
            timings: Timings::default(),
            poses_before: Vec::new(),
            exclusions: Exclusions::default(),
            log,
            joined: false,
        }
    }

    /// What puts the detector into rapier, and tells this simulation.
    #[cfg(feature = "snapshot")]
    pub(crate) fn dispatcher(&self) -> Dispatcher {
        dispatcher_of(&self.log, &self.motions)
    }

    /// rapier's parameters, for what the options do not say.
    pub fn parameters_mut(&mut self) -> &mut IntegrationParameters {
        &mut self.parameters
    }

    /// Inserts a body. Its pose is rounded to rapier's numbers.
    ///
    /// # Errors
    ///
    /// [`SimulationError`] where parry refuses the mesh, a dynamic body has no mass, a pose is none, or
    /// another number is out of range. Nothing is inserted then.
    pub fn insert(&mut self, spec: &BodySpec) -> Result<BodyIndex, SimulationError> {
        check_numbers(spec)?;
        let pose = Pose::checked(spec.pose.rotation, spec.pose.translation)?;
        let index = self.handles.len() as u32;
        let shape = self.options.detector.shape_with(spec.model, spec.normals, index)?;
        let groups = Group::from_bits_truncate(spec.groups);
        let mut collider = ColliderBuilder::new(shape)
            .density(0.0)
            .friction(spec.friction as Real)
            .restitution(spec.restitution as Real)
            .collision_groups(InteractionGroups::new(groups, groups, InteractionTestMode::And))
            .user_data(u128::from(index));
        if spec.kind == BodyKind::Dynamic {
            collider = collider.mass_properties(mass_properties(spec.model, spec.density)?);
        }
        let kind = match spec.kind {
            BodyKind::Fixed => RigidBodyType::Fixed,
            BodyKind::Kinematic => RigidBodyType::KinematicVelocityBased,
            BodyKind::Dynamic => RigidBodyType::Dynamic,
        };
        // What rapier looks ahead by itself, it looks ahead by a pair's velocity at the beginning of the step.
        let own = spec.kind == BodyKind::Dynamic && self.options.detector != Detector::Cranny;
        let body = RigidBodyBuilder::new(kind)
            .soft_ccd_prediction(if own { spec.model.radius() as Real } else { 0.0 })
            .pose(pose_to_rapier(&pose))
            .linvel(narrow(spec.linear_velocity))
            .angvel(narrow(spec.angular_velocity));
        let handle = self.bodies.insert(body);
        let collider = self.colliders.insert_with_parent(collider, handle, &mut self.bodies);
        self.handles.push(handle);
        self.tagged.push(Tagged::new(spec.model, collider));
        self.settled = false;
        self.poses_before.push(self.pose(BodyIndex(index)));
        Ok(BodyIndex(index))
    }

    /// Joins two bodies; a joint's frames are given in each body's.
    pub fn join(
        &mut self,
        parent: BodyIndex,
        child: BodyIndex,
        parent_from_joint: Pose,
        child_from_joint: Pose,
        spec: &JointSpec,
        contacts_enabled: bool,
    ) {
        let joint = generic_joint(&parent_from_joint, &child_from_joint, spec, contacts_enabled);
        self.joints.insert(self.handle(parent), self.handle(child), joint, true);
        self.joined = true;
    }

    /// Two bodies never meet from now on.
    pub fn exclude(&mut self, a: BodyIndex, b: BodyIndex) {
        self.exclusions.0.insert((a.0.min(b.0), a.0.max(b.0)));
        self.log.forget(a.0, b.0);
        self.log.forget(b.0, a.0);
        for index in [a, b] {
            for &collider in self.bodies[self.handle(index)].colliders() {
                self.colliders[collider].set_active_hooks(ActiveHooks::FILTER_CONTACT_PAIRS);
            }
        }
    }

    /// Advances by one step, which may be made in parts ([`SimulationOptions::most_parts`]).
    pub fn step(&mut self) {
        let whole = self.parameters;
        self.parts = self.parts_needed();
        self.timings = Timings::default();
        for _ in 0..self.parts {
            self.parameters.dt = whole.dt / self.parts as Real;
            let iterations = whole.num_solver_iterations.div_ceil(self.parts);
            self.parameters.num_solver_iterations = iterations;
            self.advance();
            self.timings = self.timings.plus(&self.timings_of_part());
        }
        self.parameters.dt = whole.dt;
        self.parameters.num_solver_iterations = whole.num_solver_iterations;
        self.joined = false;
        self.forget_parted();
    }

    /// How many parts the next step is made in.
    fn parts_needed(&mut self) -> usize {
        // Before the first step the broad phase knows nobody's neighbours.
        let may = self.options.detector == Detector::Cranny && self.options.most_parts > 1;
        if !(may && self.settled) {
            return 1;
        }
        let parameters = self.looking_ahead();
        let world =
            World { bodies: &self.bodies, colliders: &self.colliders, tagged: &self.tagged };
        self.motions.parts(&world, &mut self.broad_phase, &parameters, self.options.most_parts)
    }

    /// A step of rapier's.
    fn advance(&mut self) {
        self.log.begin_step();
        for index in 0..self.handles.len() {
            self.poses_before[index] = self.pose(BodyIndex(index as u32));
        }
        let parameters = self.looking_ahead();
        self.looked_ahead = parameters.prediction_distance();
        self.pipeline.step(
            narrow(self.options.gravity),
            &parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd,
            &self.exclusions,
            &(),
        );
    }

    /// In how many parts the last step was made.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// rapier's parameters, with a prediction distance as long as the longest reach of our pairs: rapier asks about
    /// no more, and the solver sees no more.
    fn looking_ahead(&mut self) -> IntegrationParameters {
        let mut parameters = self.parameters;
        if self.options.detector != Detector::Cranny {
            return parameters;
        }
        let world =
            World { bodies: &self.bodies, colliders: &self.colliders, tagged: &self.tagged };
        let broad_phase = &mut self.broad_phase;
        let ahead = self.motions.look(&world, broad_phase, &parameters, self.settled);
        self.settled = true;
        if self.options.keeps_resting() {
            self.refresh_hasty();
        }
        parameters.normalized_prediction_distance = ahead / parameters.length_unit;
        parameters
    }

    /// Has rapier ask anew about pairs of whatever may move far in this step: kept contacts are those of a shorter reach. It keeps none of
    /// a collider with hooks; ours does nothing.
    fn refresh_hasty(&mut self) {
        for (tag, tagged) in self.tagged.iter().enumerate() {
            let Some(collider) = self.colliders.get(tagged.collider) else { continue };
            let (hasty, hooks) = (self.motions.is_hasty(tag), collider.active_hooks());
            let mut wanted = hooks;
            wanted.set(ActiveHooks::MODIFY_SOLVER_CONTACTS, hasty);
            if wanted != hooks
                && let Some(collider) = self.colliders.get_mut(tagged.collider)
            {
                collider.set_active_hooks(wanted);
            }
        }
    }

    /// How far ahead bodies were looked at in the last step, at most: rapier's prediction distance, as long as nothing
    /// fast is near anything. With our detector each pair has a reach of its own, up to this.
    #[must_use]
    pub fn prediction_distance(&self) -> f64 {
        self.looked_ahead.into()
    }

    /// Drops answers about pairs that rapier no longer considers, whenever they are the greater part.
    fn forget_parted(&self) {
        if self.log.len() <= 2 * self.pair_count() {
            return;
        }
        let present: HashSet<(u32, u32)> =
            self.narrow_phase.contact_pairs().filter_map(|pair| self.tags(pair)).collect();
        self.log.retain(|first, second| present.contains(&(first, second)));
    }

    /// Numbers of a pair's bodies, in rapier's order.
    fn tags(&self, pair: &ContactPair) -> Option<(u32, u32)> {
        let tag = |handle| self.colliders.get(handle).map(|c| c.user_data as u32);
        Some((tag(pair.collider1)?, tag(pair.collider2)?))
    }

    fn handle(&self, body: BodyIndex) -> RigidBodyHandle {
        self.handles[body.0 as usize]
    }

    fn body(&self, body: BodyIndex) -> &RigidBody {
        &self.bodies[self.handle(body)]
    }

    /// Number of bodies.
    #[must_use]
    pub fn len(&self) -> usize {
        self.handles.len()
    }

    /// Whether there is no body.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.handles.is_empty()
    }

    /// Where a body is now.
    #[must_use]
    pub fn pose(&self, body: BodyIndex) -> Pose {
        pose_from_rapier(self.body(body).position())
    }

    /// Linear velocity of the centre of mass, and angular velocity.
    #[must_use]
    pub fn velocity(&self, body: BodyIndex) -> (DVec3, DVec3) {
        let b = self.body(body);
        (wide(b.linvel()), wide(b.angvel()))
    }

    /// Puts a body elsewhere.
    pub fn set_pose(&mut self, body: BodyIndex, pose: Pose) {
        let handle = self.handle(body);
        self.bodies[handle].set_position(pose_to_rapier(&pose), true);
        self.settled = false;
    }

    /// Gives a body other velocities.
    pub fn set_velocity(&mut self, body: BodyIndex, linear: DVec3, angular: DVec3) {
        let handle = self.handle(body);
        self.bodies[handle].set_linvel(narrow(linear), true);
        self.bodies[handle].set_angvel(narrow(angular), true);
    }

    /// Mass; 0 for bodies that are not dynamic.
    #[must_use]
    pub fn mass(&self, body: BodyIndex) -> f64 {
        self.body(body).mass().into()
    }

    /// Energy of all dynamic bodies, summed in f64 from rapier's state.
    #[must_use]
    pub fn energy(&self) -> Energy {
        let mut energy = Energy::default();
        for &handle in &self.handles {
            let body = &self.bodies[handle];
            if body.is_dynamic() {
                energy.kinetic += f64::from(body.kinetic_energy());
                let center = wide(body.center_of_mass());
                energy.potential -= f64::from(body.mass()) * self.options.gravity.dot(center);
            }
        }
        energy
    }

    /// Says what somebody wants to read, from now on, about a pair of bodies in
    /// [`contact_pairs`](Self::contact_pairs): it is answered in the step, at the poses that the solver's
    /// contacts come from, where what the solver asks does not [cover](Demand::covers) it. How bodies move
    /// does not depend on it.
    pub fn read_by(&self, demand: impl Fn(BodyIndex, BodyIndex) -> Demand + Send + Sync + 'static) {
        self.log.read_by(move |first, second| demand(BodyIndex(first), BodyIndex(second)));
    }

    /// What the detector said of each pair that rapier asked about in the last step, or whose older
    /// contacts it kept (bodies asleep, contacts recycled), by ascending bodies. Empty for detectors
    /// other than ours.
    #[must_use]
    pub fn contact_pairs(&self) -> Vec<PairContacts> {
        let step = self.log.step();
        let mut pairs: Vec<PairContacts> = self
            .narrow_phase
            .contact_pairs()
            .filter_map(|pair| {
                let (first, second) = self.tags(pair)?;
                let logged = self.log.get(first, second)?;
                let fresh = logged.step == step;
                if !fresh && pair.manifolds().is_empty() {
                    return None; // rapier dropped the pair without asking
                }
                let before = self.poses_before[first as usize];
                let world = before.world_from_body();
                let answer = logged.answer.as_ref().clone().moved(&world);
                let other = before.compose(&logged.first_from_second);
                let (a, b) = (BodyIndex(first), BodyIndex(second));
                Some(if a < b {
                    PairContacts { a, b, answer: Arc::new(answer), poses: [before, other], fresh }
                } else {
                    let answer = Arc::new(answer.swapped());
                    PairContacts { a: b, b: a, answer, poses: [other, before], fresh }
                })
            })
            .collect();
        pairs.sort_by_key(|p| (p.a, p.b));
        pairs
    }

    /// Points in the manifolds that rapier's solver saw in the last step.
    #[must_use]
    pub fn solver_contacts(&self) -> usize {
        self.narrow_phase
            .contact_pairs()
            .flat_map(|pair| pair.solver_manifolds())
            .map(|manifold| manifold.data.solver_contacts.len())
            .sum()
    }

    /// Pairs in rapier's contact graph.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.narrow_phase.contact_pairs().count()
    }

    /// Seconds spent in contact detection, any detector, since this was last asked.
    pub fn narrow_phase_seconds(&mut self) -> f64 {
        self.log.take_time().as_secs_f64()
    }

    /// Of the last step.
    #[must_use]
    pub fn timings_ms(&self) -> Timings {
        self.timings
    }

    /// Of rapier's last step.
    fn timings_of_part(&self) -> Timings {
        let counters = &self.pipeline.counters;
        let reading = 1e3 * self.log.reading_time().as_secs_f64();
        Timings {
            broad: counters.cd.broad_phase_time.time_ms()
                + counters.cd.final_broad_phase_time.time_ms(),
            narrow: (counters.cd.narrow_phase_time.time_ms() - reading).max(0.0),
            reading,
            solver: counters.stages.solver_time.time_ms(),
            step: counters.step_time_ms(),
        }
    }
}
