//! A [`Simulation`] as bytes: rapier's world, and what the simulation keeps beside it.

use cranny_exact::{DMat3, DQuat, DVec3, Pose};
use cranny_geometry::Model;
use cranny_narrow_phase::{Approach, Demand, PairMemory, Query};
use rapier3d::geometry::ColliderHandle;
use rapier3d::math::{Real, Vector};
use rapier3d::prelude::{IntegrationParameters, PhysicsWorld, RigidBodyHandle};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

use super::attached::{crease_angle_of, normals_of};
use super::frame::Kind;
use super::{RestoreError, Sets, SnapshotError, read, written};
use crate::ahead::Tagged;
use crate::ask::ask;
use crate::log::LoggedAnswer;
use crate::pair::ours;
use crate::simulation::{ReducedJoints, Simulation, SimulationOptions};

/// What a simulation keeps beside rapier's sets.
#[derive(Serialize, Deserialize)]
struct Kept {
    detector: String,
    gravity: [f64; 3],
    step: f64,
    length_unit: f64,
    recycling: Option<bool>,
    solver_iterations: Option<u64>,
    most_parts: u64,
    handles: Vec<RigidBodyHandle>,
    /// Numbers of bodies that were removed, ascending.
    free: Vec<u32>,
    /// Collider, centre of mass, radius, thickness.
    tagged: Vec<(ColliderHandle, [Real; 3], Real, Real)>,
    settled: bool,
    looked_ahead: Real,
    poses_before: Vec<WrittenPose>,
    /// Bodies that were held back and got nowhere, ascending.
    stalled: Vec<u32>,
    reduced: ReducedJoints,
    /// The log's step.
    log_step: u64,
    answers: Vec<WrittenAnswer>,
    /// The searches whose contacts the next step may carry on.
    searches: Vec<WrittenSearch>,
}

/// Tags, pose, reach, how far a way out lasts.
type WrittenSearch = ((u32, u32), WrittenPose, f64, Option<f64>);

/// Rotation and translation.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct WrittenPose([f64; 4], [f64; 3]);

impl WrittenPose {
    fn of(pose: &Pose) -> Self {
        Self(pose.rotation.to_array(), pose.translation.to_array())
    }

    fn pose(self) -> Pose {
        let Self(rotation, translation) = self;
        Pose { rotation: DQuat::from_array(rotation), translation: DVec3::from_array(translation) }
    }
}

/// An answer of the log as its query: computed again, it is the same.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct WrittenAnswer {
    tags: (u32, u32),
    first_from_second: WrittenPose,
    step: u64,
    demand: WrittenDemand,
    approach: Option<WrittenApproach>,
}

/// Within, linear, spread by columns, turn, swing.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct WrittenApproach(f64, [f64; 3], [f64; 9], [f64; 3], [f64; 3]);

impl WrittenApproach {
    fn of(approach: Approach) -> Self {
        let Approach { within, linear, spread, turn, swing } = approach;
        let [linear, turn, swing] = [linear, turn, swing].map(|v| v.to_array());
        Self(within, linear, spread.to_cols_array(), turn, swing)
    }

    fn approach(self) -> Approach {
        let Self(within, linear, spread, turn, swing) = self;
        let [linear, turn, swing] = [linear, turn, swing].map(DVec3::from_array);
        Approach { within, linear, spread: DMat3::from_cols_array(&spread), turn, swing }
    }
}

#[derive(Clone, Copy, Serialize, Deserialize)]
enum WrittenDemand {
    None,
    Intersects,
    Distance(Option<f64>),
    Contacts(f64, Option<f64>),
    Regions(f64),
}

impl WrittenDemand {
    fn of(demand: Demand) -> Self {
        match demand {
            Demand::None => Self::None,
            Demand::Intersects => Self::Intersects,
            Demand::Distance { below } => Self::Distance(below),
            Demand::Contacts { margin, normals } => {
                Self::Contacts(margin, crease_angle_of(normals))
            }
            Demand::Regions { margin } => Self::Regions(margin),
        }
    }

    fn demand(self) -> Demand {
        match self {
            Self::None => Demand::None,
            Self::Intersects => Demand::Intersects,
            Self::Distance(below) => Demand::Distance { below },
            Self::Contacts(margin, crease_angle) => {
                Demand::Contacts { margin, normals: normals_of(crease_angle) }
            }
            Self::Regions(margin) => Demand::Regions { margin },
        }
    }
}

impl Simulation {
    /// The simulation between two steps as bytes, of which [`restore`](Self::restore) makes one
    /// that goes on to the bit as this one. See [`snapshot`](mod@crate::snapshot).
    ///
    /// # Errors
    ///
    /// [`SnapshotError`], as where a body or a joint was inserted since the last step.
    pub fn snapshot(&self) -> Result<Vec<u8>, SnapshotError> {
        if self.joined {
            return Err(SnapshotError::UnsettledJoint);
        }
        let SimulationOptions {
            detector,
            gravity,
            step,
            length_unit,
            recycling,
            solver_iterations,
            most_parts,
        } = self.options;
        let answers = self.log.all().into_iter().map(|(tags, logged)| WrittenAnswer {
            tags,
            first_from_second: WrittenPose::of(&logged.first_from_second),
            step: logged.step,
            demand: WrittenDemand::of(logged.question.demand),
            approach: logged.question.approach.map(WrittenApproach::of),
        });
        let searches = self.searches.lasting().into_iter();
        let tagged = self.tagged.iter();
        let kept = Kept {
            detector: detector.name().to_owned(),
            gravity: gravity.to_array(),
            step,
            length_unit,
            recycling,
            solver_iterations: solver_iterations.map(|n| n as u64),
            most_parts: most_parts as u64,
            handles: self.handles.clone(),
            free: self.free.iter().copied().collect(),
            tagged: tagged
                .map(|t| (t.collider, t.center.to_array(), t.radius, t.thickness))
                .collect(),
            settled: self.settled,
            looked_ahead: self.looked_ahead,
            poses_before: self.poses_before.iter().map(WrittenPose::of).collect(),
            stalled: self.stalled.iter().copied().collect(),
            reduced: self.reduced.clone(),
            log_step: self.log.step(),
            answers: answers.collect(),
            searches: searches
                .map(|(tags, s)| (tags, WrittenPose::of(&s.pose), s.reach, s.lasts))
                .collect(),
        };
        let sets = Sets {
            gravity: Vector::ZERO, // the options' is in double precision
            parameters: &self.parameters,
            islands: &self.islands,
            broad_phase: &self.broad_phase,
            narrow_phase: &self.narrow_phase,
            bodies: &self.bodies,
            colliders: &self.colliders,
            joints: &self.joints,
            multibody_joints: &self.multibody_joints,
            soft_bodies: &self.soft_bodies,
        };
        written(Kind::Simulation, &sets, &kept)
    }

    /// A simulation from the bytes of [`snapshot`](Self::snapshot). `models` are those of its
    /// bodies, in any order. Body numbers stay; [`read_by`](Self::read_by) has to be said again,
    /// and what it reads beyond the solver's answer is computed from the next step on.
    ///
    /// # Errors
    ///
    /// [`RestoreError`].
    pub fn restore(bytes: &[u8], models: &[Model]) -> Result<Self, RestoreError> {
        let (kept, world): (Kept, PhysicsWorld) = read(Kind::Simulation, bytes, models)?;
        let detector = kept.detector.parse();
        let detector = detector.map_err(|_| RestoreError::Content { flaw: "unknown detector" })?;
        let options = SimulationOptions {
            detector,
            gravity: DVec3::from_array(kept.gravity),
            step: kept.step,
            length_unit: kept.length_unit,
            recycling: kept.recycling,
            solver_iterations: kept.solver_iterations.map(|n| n as usize),
            most_parts: kept.most_parts as usize,
        };
        let mut simulation = Self::new(options);
        let bodies_are_known = kept.handles.len() == kept.tagged.len()
            && kept.handles.len() == kept.poses_before.len()
            && kept.free.iter().all(|&index| (index as usize) < kept.handles.len())
            && (0..kept.handles.len()).filter(|&i| !kept.free.contains(&(i as u32))).all(|i| {
                world.bodies.contains(kept.handles[i]) && world.colliders.contains(kept.tagged[i].0)
            });
        if !bodies_are_known {
            return Err(RestoreError::Content { flaw: "bodies are missing" });
        }
        simulation.put_in(world);
        simulation.handles = kept.handles;
        simulation.free = kept.free.into_iter().collect();
        let tagged = kept.tagged.into_iter().map(|(collider, center, radius, thickness)| Tagged {
            collider,
            center: Vector::from_array(center),
            radius,
            thickness,
        });
        simulation.tagged = tagged.collect();
        simulation.settled = kept.settled;
        simulation.looked_ahead = kept.looked_ahead;
        simulation.poses_before = kept.poses_before.into_iter().map(WrittenPose::pose).collect();
        simulation.stalled = kept.stalled.into_iter().collect();
        simulation.reduced = kept.reduced;
        simulation.log.continue_at(kept.log_step);
        for answer in kept.answers {
            simulation.ask_again(&answer)?;
        }
        for (tags, pose, reach, lasts) in kept.searches {
            simulation.searches.put_back(tags, (pose.pose(), reach, lasts));
        }
        Ok(simulation)
    }

    /// rapier's part of it, with this one's own dispatcher.
    fn put_in(&mut self, world: PhysicsWorld) {
        let PhysicsWorld {
            integration_parameters,
            islands,
            broad_phase,
            mut narrow_phase,
            bodies,
            colliders,
            impulse_joints,
            multibody_joints,
            soft_bodies,
            ..
        } = world;
        narrow_phase.set_query_dispatcher(self.dispatcher());
        self.parameters = IntegrationParameters { ..integration_parameters };
        self.islands = islands;
        self.broad_phase = broad_phase;
        self.narrow_phase = narrow_phase;
        self.bodies = bodies;
        self.colliders = colliders;
        self.joints = impulse_joints;
        self.multibody_joints = multibody_joints;
        self.soft_bodies = soft_bodies;
    }

    /// Fills the log again, which has for bodies asleep what was answered when they were last
    /// queried.
    fn ask_again(&self, written: &WrittenAnswer) -> Result<(), RestoreError> {
        let flaw = RestoreError::Content { flaw: "an answer is of no pair of bodies" };
        let model = |tag: u32| {
            let collider = self.tagged.get(tag as usize)?.collider;
            Some(ours(self.colliders.get(collider)?.shape())?.model())
        };
        let (first, second) = written.tags;
        let Some(models) = model(first).zip(model(second)) else { return Err(flaw) };
        let pose = written.first_from_second.pose();
        let approach = written.approach.map(WrittenApproach::approach);
        let question = Query { approach, ..Query::of(written.demand.demand()) };
        let answer = ask(models.into(), pose, &question, &mut PairMemory::default()).ok_or(flaw)?;
        let logged = LoggedAnswer {
            answer: Arc::new(answer),
            first_from_second: pose,
            step: written.step,
            question,
        };
        self.log.put_back(written.tags, logged);
        Ok(())
    }
}
