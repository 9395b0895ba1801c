//! A rapier world of models and primitives: all of rapier's sets behind body numbers.
//!
//! [`SimulationOptions`] holds the one table of rapier's settings, each with its argument.
//! `stepping` makes a step, and a step report says what came of it.

mod body;
mod changes;
mod continuous;
mod hooks;
mod options;
mod reduced;
mod step_report;
mod stepping;

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{DVec3, Pose};
use cranny_primitives::CoresOfBodies;
use rapier3d::geometry::{ContactPair, Group, InteractionGroups, InteractionTestMode};
use rapier3d::math::Real;
use rapier3d::prelude::{
    CCDSolver, ColliderBuilder, ColliderSet, DefaultBroadPhase, FrictionModel, ImpulseJointSet,
    IntegrationParameters, IslandManager, MultibodyJointSet, NarrowPhase, PhysicsPipeline,
    RigidBody, RigidBodyBuilder, RigidBodyHandle, RigidBodySet, SoftBodySet,
};

pub use self::body::{BodyIndex, BodyKind, BodySpec, SimulationError};
use self::changes::rapier_kind;
pub use self::hooks::{SolvedContacts, StepHooks};
pub use self::options::{SOLVER_SUBSTEP, SimulationOptions};
pub(crate) use self::reduced::ReducedJoints;
pub use self::reduced::Resistance;
pub use self::step_report::{Energy, PairContacts, SolvedPoint, Timings};
use crate::ahead::{Motions, Tagged};
use crate::carried::{PairCounts, Searches};
use crate::convert::{narrow, pose_from_rapier, pose_to_rapier, wide};
use crate::detector::Detector;
use crate::dispatcher::Dispatcher;
use crate::joint::{JointIndex, JointPlace, JointSpec, generic_joint, set_impulse_motor};
use crate::log::AnswerLog;

/// A rapier world of models and primitives.
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
    /// By number; what stands at one that is free is stale.
    pub(crate) handles: Vec<RigidBodyHandle>,
    /// Numbers of bodies that were removed.
    pub(crate) free: BTreeSet<u32>,
    pub(crate) tagged: Vec<Tagged>,
    pub(crate) motions: Motions,
    /// Whether rapier has seen all bodies where they are.
    pub(crate) settled: bool,
    /// The prediction distance of the last step.
    pub(crate) looked_ahead: Real,
    /// In how many parts the last step was made, and what it took.
    pub(crate) parts: usize,
    timings: Timings,
    /// Bodies that were held back in the last step.
    held_back: usize,
    /// Bodies that were held back in the last step and got nowhere.
    pub(crate) stalled: BTreeSet<u32>,
    /// Of bodies that something named for it may have met, or that are named.
    cores: CoresOfBodies<BodyIndex>,
    pub(crate) poses_before: Vec<Pose>,
    /// What the solver's points did in the parts of the last step but its last one, by pairs of
    /// numbers, the lower first.
    earlier_points: BTreeMap<(u32, u32), Vec<SolvedPoint>>,
    pub(crate) log: AnswerLog,
    pub(crate) searches: Searches,
    /// How the contacts of the last step were found.
    pair_counts: PairCounts,
    /// Whether joints were inserted that no step has seen: rapier's serde would lose that.
    #[cfg_attr(not(feature = "snapshot"), allow(dead_code, reason = "a snapshot asks"))]
    pub(crate) joined: bool,
    /// Joints whose positions are coordinates.
    pub(crate) reduced: ReducedJoints,
}

fn dispatcher_of(
    options: &SimulationOptions,
    log: &AnswerLog,
    motions: &Motions,
    searches: &Searches,
) -> Dispatcher {
    let dispatcher = Dispatcher::with_log(log.clone()).looking_ahead(motions.clone());
    dispatcher.carrying(searches.clone(), options.carries())
}

/// Makes contacts between moving bodies as stiff as those with what is fixed, and both as stiff
/// beside a substep shorter than [`SOLVER_SUBSTEP`] as they are beside that. [`SimulationOptions`]
/// argues it, with rapier's other settings.
fn stiffen(parameters: &mut IntegrationParameters) {
    let substep = f64::from(parameters.dt) / parameters.num_solver_iterations as f64;
    let faster = (SOLVER_SUBSTEP / substep).max(1.0) as Real;
    parameters.static_contact_softness.natural_frequency *= faster;
    parameters.contact_softness = parameters.static_contact_softness;
}

impl Simulation {
    /// An empty world. [`SimulationOptions`] says which of rapier's settings it has, and why.
    #[must_use]
    pub fn new(options: SimulationOptions) -> Self {
        let ours = options.detector == Detector::Cranny;
        let mut parameters = IntegrationParameters {
            dt: options.step as Real,
            length_unit: options.length_unit as Real,
            normalized_max_linear_velocity: Real::MAX,
            ..IntegrationParameters::default()
        };
        parameters.num_solver_iterations = options.substeps();
        if ours {
            parameters.contact_clustering = false;
            parameters.friction_model = FrictionModel::Coulomb;
            stiffen(&mut parameters);
        }
        parameters.contact_recycling = options.rapier_recycles();
        let (log, motions) = (AnswerLog::default(), Motions::default());
        let searches = Searches::default();
        let dispatcher = dispatcher_of(&options, &log, &motions, &searches);
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
            free: BTreeSet::new(),
            tagged: Vec::new(),
            motions,
            settled: false,
            looked_ahead: 0.0,
            parts: 1,
            timings: Timings::default(),
            held_back: 0,
            stalled: BTreeSet::new(),
            cores: CoresOfBodies::default(),
            poses_before: Vec::new(),
            earlier_points: BTreeMap::new(),
            log,
            searches,
            pair_counts: PairCounts::default(),
            joined: false,
            reduced: ReducedJoints::default(),
        }
    }

    /// What puts the detector into rapier, and logs to this simulation.
    #[cfg(feature = "snapshot")]
    pub(crate) fn dispatcher(&self) -> Dispatcher {
        dispatcher_of(&self.options, &self.log, &self.motions, &self.searches)
    }

    /// rapier's parameters, for what the options do not say.
    pub fn parameters_mut(&mut self) -> &mut IntegrationParameters {
        &mut self.parameters
    }

    /// Inserts a body. Its pose is rounded to rapier's numbers.
    ///
    /// # Errors
    ///
    /// [`SimulationError`] where parry refuses the mesh, a dynamic body has no mass, a pose is
    /// none, or another number is out of range. Nothing is inserted then.
    pub fn insert(&mut self, spec: &BodySpec) -> Result<BodyIndex, SimulationError> {
        spec.check()?;
        let pose = Pose::checked(spec.pose.rotation, spec.pose.translation)?;
        let index = self.free.first().copied().unwrap_or(self.handles.len() as u32);
        let (shape, place) = self.options.detector.collider(&spec.shape, spec.normals, index)?;
        let groups = Group::from_bits_truncate(spec.groups);
        let mut collider = ColliderBuilder::new(shape)
            .position(place)
            .density(0.0)
            .friction(spec.friction as Real)
            .restitution(spec.restitution as Real)
            .collision_groups(InteractionGroups::new(groups, groups, InteractionTestMode::And))
            .user_data(u128::from(index));
        match (spec.kind, spec.mass.properties(&spec.shape)) {
            (BodyKind::Dynamic, mass) => collider = collider.mass_properties(mass?),
            // It turns about its centre of mass too; an open mesh has none.
            (BodyKind::Kinematic, Ok(mass)) => collider = collider.mass_properties(mass),
            _ => {}
        }
        // What rapier looks ahead by itself, it looks ahead by a pair's velocity at the beginning
        // of the step.
        let own = spec.kind == BodyKind::Dynamic && self.options.detector != Detector::Cranny;
        let body = RigidBodyBuilder::new(rapier_kind(spec.kind))
            .soft_ccd_prediction(if own { spec.shape.radius() as Real } else { 0.0 })
            .pose(pose_to_rapier(&pose))
            .linvel(narrow(spec.linear_velocity))
            .angvel(narrow(spec.angular_velocity));
        let handle = self.bodies.insert(body);
        let collider = self.colliders.insert_with_parent(collider, handle, &mut self.bodies);
        let (at, tagged) = (index as usize, Tagged::new(&spec.shape, collider, spec.mass.center()));
        if self.free.remove(&index) {
            (self.handles[at], self.tagged[at]) = (handle, tagged);
            self.poses_before[at] = self.pose(BodyIndex(index));
        } else {
            self.handles.push(handle);
            self.tagged.push(tagged);
            self.poses_before.push(self.pose(BodyIndex(index)));
        }
        self.settled = false;
        Ok(BodyIndex(index))
    }

    /// Joins two bodies; a joint's frames are given in each body's. It ends with either of them.
    pub fn join(
        &mut self,
        parent: BodyIndex,
        child: BodyIndex,
        parent_from_joint: Pose,
        child_from_joint: Pose,
        spec: &JointSpec,
        contacts_enabled: bool,
    ) -> JointIndex {
        let frames = [&parent_from_joint, &child_from_joint];
        let mut joint = generic_joint(frames[0], frames[1], spec, 0.0, contacts_enabled);
        if let Some((axis, motor)) = spec.driven_axis().zip(spec.motor()) {
            set_impulse_motor(&mut joint, axis, motor, 0.0);
        }
        self.joined = true;
        let handle = self.joints.insert(self.handle(parent), self.handle(child), joint, true);
        JointIndex(JointPlace::Impulses(handle))
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
        self.handles.len() - self.free.len()
    }

    /// Numbers of the bodies, ascending. They are those from 0 to [`len`](Self::len) as long as no
    /// body has left.
    pub fn indices(&self) -> impl Iterator<Item = BodyIndex> {
        let all = (0..self.handles.len() as u32).map(BodyIndex);
        all.filter(|index| !self.free.contains(&index.0))
    }

    /// Whether there is no body.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
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

    /// Whether a dynamic body is asleep: it rests, and is not computed until something wakes it.
    #[must_use]
    pub fn is_asleep(&self, body: BodyIndex) -> bool {
        let b = self.body(body);
        b.is_dynamic() && b.is_sleeping()
    }

    /// The point of a body, in its frame, that its linear velocity is of: the centre of mass of
    /// dynamic bodies, and of kinematic ones whose mesh is closed; else the origin.
    #[must_use]
    pub fn center_of_mass(&self, body: BodyIndex) -> DVec3 {
        wide(self.body(body).mass_properties().local_mprops.local_com)
    }

    /// Puts a body elsewhere.
    pub fn set_pose(&mut self, body: BodyIndex, pose: Pose) {
        let handle = self.handle(body);
        self.bodies[handle].set_position(pose_to_rapier(&pose), true);
        self.settled = false;
    }

    /// Gives a body other velocities; what its locked axes do not allow is left out.
    pub fn set_velocity(&mut self, body: BodyIndex, linear: DVec3, angular: DVec3) {
        let handle = self.handle(body);
        self.bodies[handle].set_linvel(narrow(linear), true);
        self.bodies[handle].set_angvel(narrow(angular), true);
        self.keep_locked(body);
        self.take_velocity_of_root(body);
    }

    /// Mass; 0 for bodies that are not dynamic.
    #[must_use]
    pub fn mass(&self, body: BodyIndex) -> f64 {
        let body = self.body(body);
        if body.is_dynamic() { body.mass().into() } else { 0.0 }
    }
}
