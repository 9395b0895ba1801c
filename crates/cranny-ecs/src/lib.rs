//! One plugin per effect; the one composer of worlds, solver, recordings and pictures.
//!
//! # Promises
//!
//! - **A body is an entity with a [`Collider`]**, spawned, changed and despawned in any schedule,
//!   before and while the app runs. What is written counts in the next step; what is removed is
//!   gone at once. A scene is one more way to spawn such entities ([`SpawnScene`]).
//! - **Only what the scene names exists.** An effect that it does not name has no system in the
//!   schedules, no registered component, no message and no resource ([`Plan`] reads this from the
//!   app itself).
//! - **`Transform` is the truth** about where a body is. Queries, recordings and pictures read it
//!   through [`pose_of`]; the solver, which is f32 as well, is kept in step with it both ways.
//! - **Contacts, frames and pictures of a step refer to the poses at its beginning**; after the
//!   last step [`CrannyEnd`] reports the final ones, newly detected.
//! - A pair with `Response` is searched inside the solver's step, and all other readers get that
//!   answer ([`DetectionSystems::Supply`]). Fields of `Contacts` that [`ContactReaders`] read and
//!   that answer lacks (regions, a wider margin) are a second query there, at the same pose, and
//!   move no body. Where the solver's detector gives no exact answer, kept an old one or did not
//!   look at a pair, the world queries it.
//! - Steps are driven by hand: no wall clock changes a result, and order is by stable [`BodyId`]s.
//! - Whatever comes and goes leaves nothing behind: no pair, shape, joint or number.
//!
//! # Non-promises
//!
//! A body is a root entity; its colliders are meshes, or one primitive. Dynamic bodies without
//! `Response` stand still.
//!
//! # Features
//!
//! `rapier` brings [`Response`](cranny_world::description::Effect::Response), `record` and `render`
//! recordings and pictures, `scene` scene files.
//!
//! For programs without bevy there is [`SceneApp`], which has an example; for those with it
//! [`CrannyPlugins`], [`FixedUpdatePlugin`] and the [`prelude`].

mod admission;
mod app;
mod body;
#[cfg(feature = "record")]
mod camera_lines;
mod clock;
mod collider;
mod collision;
mod contacts;
mod continuous;
#[cfg(feature = "rapier")]
mod deformation;
mod detection;
mod diagnostics;
mod effect_components;
mod effects;
#[cfg(feature = "rapier")]
mod energy;
mod error;
#[cfg(feature = "scene")]
mod excerpt;
mod force_feedback;
#[cfg(feature = "rapier")]
mod hooks;
mod joints;
mod kinematics;
mod levels;
mod links;
mod motion;
mod outputs;
#[cfg(feature = "render")]
mod painting;
mod pair;
mod parts;
mod paths;
mod penetration;
mod plan;
mod plugins;
mod properties;
mod proximity;
mod readers;
#[cfg(feature = "record")]
mod recording;
#[cfg(feature = "render")]
mod rendering;
#[cfg(feature = "record")]
mod replay;
mod report;
#[cfg(feature = "rapier")]
mod response;
#[cfg(feature = "rapier")]
mod solved;
#[cfg(feature = "rapier")]
mod sound;
mod spatial;
mod spatial_index;
mod spawn;
mod summary;
mod tally;
mod tracking;
mod trigger;

pub use app::{RunOptions, SceneApp, check_duration};
pub use body::{Bodies, Body, BodyRecord, pose_of, transform_of};
pub use clock::{CoreSystems, CrannyEnd, CrannyStep, PhaseTimes, SimulatedTime, StepSystems};
pub use collider::{Collider, CuboidError, Painted, VisualMesh};
pub use collision::{Collision, CollisionContact, CollisionPoint, Collisions};
pub use contacts::{
    BodyContacts, ContactPair, ContactReport, ContactsPlugin, ContactsSystems, QueryFrame,
};
pub use continuous::{ContinuousPlugin, ContinuousSystems, HeldBack};
pub use cranny_world::description::{Accuracy, Effect, StatedMass};
pub use cranny_world::{BodyId, ContactFields, PairEstimate, Verdict};
#[cfg(feature = "rapier")]
pub use deformation::{DeformationPlugin, DeformationSystems, Dented};
pub use detection::{Detected, DetectionSystems, Detector};
pub use diagnostics::{DiagnosticsPlugin, StepCosts, StepDiagnostics};
pub use effect_components::{
    Contacts, Continuous, Deformation, EffectAccuracy, ForceFeedback, PairAccuracy, Penetration,
    Proximity, Response, Sound, Tracking, Trigger,
};
pub use effects::{AskedBy, EffectKind, EffectTable};
#[cfg(feature = "rapier")]
pub use energy::EnergyRange;
pub use error::{Failure, SceneAppError};
#[cfg(feature = "scene")]
pub use excerpt::{helices, rings};
pub use force_feedback::{
    FeltForces, ForceFeedbackPlugin, ForceFeedbackReport, ForceFeedbackSystems, Obstacle, Proxy,
    Wrench,
};
#[cfg(feature = "rapier")]
pub use hooks::{CollisionHooks, SolverContacts};
pub use joints::{Follows, Joint};
pub use kinematics::{Kinematic, KinematicsPlugin, KinematicsSystems};
pub use links::{Link, LinkLog, Ring};
pub use motion::{BodyMotion, Helix, HelixMotion, MotionLog};
pub use outputs::check_outputs;
#[cfg(feature = "render")]
pub use painting::{
    CAMERA_PRESETS, DEFAULT_CAMERA, MARKS_MAX, MeetingPair, Moment, NamedCamera, PictureQuality,
    ScenePainter, ScenePainterView,
};
pub use pair::{BodyPair, NeverMeet};
pub use parts::ColliderOf;
pub use paths::{FollowsMotorPath, FollowsPath, PathPlugin, PathSystems};
pub use penetration::{PenetrationPair, PenetrationPlugin, PenetrationReport, PenetrationSystems};
pub use plan::{AbsentEffect, Plan, PlannedEffect, PlannedPairs, PlannedSchedule, PlannedSystem};
pub use plugins::{CrannyPlugins, FixedUpdatePlugin, PluginOptions, check_effects};
pub use properties::{
    AngularDamping, AngularVelocity, CollisionLayers, Density, ExternalForce, ExternalImpulse,
    Friction, GravityScale, LinearDamping, LinearVelocity, LockedAxes, Mass, Restitution,
    RigidBody, Sensor, Sleeping, SmoothNormals,
};
pub use proximity::{ProximityPair, ProximityPlugin, ProximityReport, ProximitySystems};
pub use readers::ContactReaders;
#[cfg(feature = "record")]
pub use recording::{FrameRecorder, RecordingSystems};
#[cfg(feature = "render")]
pub use rendering::{
    FRAME_SIZE, FRAMES_PER_SECOND, PREVIEW_FRAMES, PREVIEW_SIZE, Painter, PictureOptions,
    RECORDED_SIZE, RenderingSystems, frame_path,
};
#[cfg(feature = "record")]
pub use replay::{Replay, ReplayDifference, ReplayError, ReplayFrame, ReplayReport};
pub use report::state_hash;
#[cfg(feature = "rapier")]
pub use response::{Gravity, ResponseSystems};
#[cfg(feature = "rapier")]
pub use solved::{HeldJoint, RigidBodies, SolverBody};
#[cfg(feature = "rapier")]
pub use sound::{OngoingSounds, SoundEvent, SoundKind, SoundPlugin, SoundSystems};
pub use spatial::{
    ClosestPoints, PointProjection, RayHitData, ShapeHitData, SpatialQuery, SpatialQueryError,
    SpatialQueryFilter, TimeOfImpact,
};
pub use spawn::{LayerNames, SpawnScene};
pub use summary::{
    ContainedSummary, CountSummary, DeepestSummary, EnergySummary, EstimateSummary, HelixSummary,
    JointSummary, LeftSummary, LinkSummary, MotionSummary, PairsFound, PartedSummary, PartsSummary,
    RunSummary, Skipped, TrackingSummary, TriggerSummary,
};
pub use tally::{Contained, DeepestSoFar, EstimateTally, Series, Tally};
pub use tracking::{
    PoseRefused, SimulatedTracker, SimulatedTrackersPlugin, TrackedContacts, TrackedPose, Tracker,
    TrackerCounts, TrackingLog, TrackingPlugin, TrackingSystems,
};
pub use trigger::{
    CollisionEnd, CollisionStart, Fired, TouchingBodies, TriggerLog, TriggerPlugin, TriggerSystems,
};

/// What most bevy apps want.
pub mod prelude {
    pub use crate::{
        Accuracy, AngularDamping, AngularVelocity, Bodies, Body, BodyContacts, BodyId, BodyPair,
        Collider, Collision, CollisionContact, CollisionEnd, CollisionLayers, CollisionPoint,
        CollisionStart, Collisions, ContactReport, Contacts, Continuous, CrannyPlugins, CrannyStep,
        Deformation, Density, DiagnosticsPlugin, Effect, EffectAccuracy, EffectKind, ExternalForce,
        ExternalImpulse, Failure, FixedUpdatePlugin, ForceFeedback, ForceFeedbackReport, Friction,
        GravityScale, Joint, LinearDamping, LinearVelocity, LockedAxes, Mass, NeverMeet,
        PairAccuracy, Penetration, PenetrationReport, PluginOptions, Proximity, ProximityReport,
        ProximitySystems, Proxy, Response, Restitution, RigidBody, Sensor, SimulatedTime, Sleeping,
        SmoothNormals, Sound, SpatialQuery, SpatialQueryFilter, SpawnScene, StatedMass,
        StepDiagnostics, StepSystems, TouchingBodies, TrackedPose, Tracker, Tracking, Trigger,
        TriggerSystems,
    };
    #[cfg(feature = "rapier")]
    pub use crate::{
        CollisionHooks, Dented, Gravity, OngoingSounds, RigidBodies, SolverContacts, SoundEvent,
        SoundKind,
    };
}

// The example of the README must compile and run as well.
#[cfg(all(doctest, feature = "scene"))]
#[doc = include_str!("../README.md")]
struct Readme;
