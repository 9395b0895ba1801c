//! What can go wrong with a scene that runs.

use std::path::PathBuf;

use bevy_ecs::prelude::{BevyError, ResMut, Resource};
use cranny_geometry::{BuildError, DeformError};
use cranny_primitives::PrimitiveError;
use cranny_world::WorldError;
use thiserror::Error;

/// A scene that cannot be built or cannot go on.
#[derive(Error)]
#[non_exhaustive]
pub enum SceneAppError {
    /// A body's mesh cannot be prepared.
    #[error("body '{body}': {source}")]
    Model {
        /// Whose mesh.
        body: String,
        /// What is wrong with it.
        source: BuildError,
    },
    /// A primitive with a number that is none.
    #[error("body '{body}': its {what} is refused: {source}")]
    Primitive {
        /// Which body.
        body: String,
        /// The kind of primitive: "ball".
        what: &'static str,
        /// What is wrong with it.
        source: PrimitiveError,
    },
    /// An effect of a primitive that works on a mesh.
    #[error(
        "{effect} works on a mesh, but body '{body}' is a {what}: give the body a mesh, or name {effect} for other bodies only"
    )]
    NeedsMesh {
        /// Which body.
        body: String,
        /// The kind of primitive: "ball".
        what: &'static str,
        /// Name of the effect.
        effect: &'static str,
    },
    /// A pair names a body that the scene does not have.
    #[error("the scene has no body '{name}', which one of its pairs names")]
    UnknownBody {
        /// The name.
        name: String,
    },
    /// An index without a body.
    #[error("body number {index} is asked for, but the scene has {bodies} bodies, numbered from 0")]
    NoSuchIndex {
        /// The index.
        index: usize,
        /// How many bodies there are.
        bodies: usize,
    },
    /// An effect that this version does not compute.
    #[error("effect {effect} is not available in this version: take it out of the scene")]
    UnsupportedEffect {
        /// Its name.
        effect: &'static str,
    },
    /// An effect whose plugin the app does not have.
    #[error(
        "body '{body}' asks for {effect}, but the app has no plugin of it: name it in CrannyPlugins::effects or CrannyPlugins::available"
    )]
    EffectNotPlugged {
        /// The body, or one of the pair.
        body: String,
        /// Name of the effect.
        effect: &'static str,
    },
    /// A sensor in an app that has no effect which notices one.
    #[error(
        "body '{body}' is a sensor, but no effect of the app notices what touches it: name Trigger in CrannyPlugins::available, or remove the Trigger that came with the Sensor"
    )]
    UnnoticedSensor {
        /// Which body.
        body: String,
    },
    /// An effect that works on what another one does, which the app does not have.
    #[error("{effect} needs {needs}: name {needs} too, or leave {effect} out")]
    NeedsEffect {
        /// The effect that needs another one.
        effect: &'static str,
        /// The one that is missing.
        needs: &'static str,
    },
    /// A level or a budget for pairs that are exact, because of another effect.
    #[error(
        "{what} changes nothing: {effect} needs exact contacts of the same pairs. Take it out, or name {effect} for single bodies or pairs instead"
    )]
    NotAtLevel {
        /// What is stated, and whose it is.
        what: String,
        /// The effect that needs exact contacts.
        effect: &'static str,
    },
    /// A level or a budget where nothing can be known at one.
    #[error(
        "{what} changes nothing: only Trigger and Proximity are known at a level or within a budget, and neither is named. Name one, or take it out"
    )]
    NoLevels {
        /// What is stated, and whose it is.
        what: String,
    },
    /// A path on a body that is not kinematic.
    #[error(
        "body '{body}' has a path, but is not kinematic: make it kinematic, or leave the path out"
    )]
    PathOfOtherKind {
        /// Which body.
        body: String,
    },
    /// A tracker of a body none of whose contacts is filtered.
    #[error(
        "body '{body}' has a tracker, but none of its pairs has both Trigger and Tracking: name Trigger and Tracking(tolerance: …) in its effects beside another body, or leave the tracker out"
    )]
    TrackerAlone {
        /// Which body.
        body: String,
    },
    /// `Tracking` where nothing triggers.
    #[error(
        "Tracking of body '{body}' is for none of its pairs, as none has Trigger: name Trigger in its effects too, or leave Tracking out"
    )]
    TrackingAlone {
        /// Which body.
        body: String,
    },
    /// A body that cannot be tracked as described.
    #[error("the tracker of body '{body}': {why}")]
    Tracker {
        /// Which body.
        body: String,
        /// What is wrong.
        why: String,
    },
    /// Colliders of a body that are no mesh together.
    #[error("the colliders of body '{body}' cannot be put together: {why}")]
    Parts {
        /// Which body.
        body: String,
        /// What is wrong.
        why: String,
    },
    /// A body of several colliders that is to be dented.
    #[error(
        "body '{body}' is to be dented, but consists of several colliders: put its meshes into one collider, or leave Deformation out for it"
    )]
    DentedParts {
        /// Which body.
        body: String,
    },
    /// A dent that the body's mesh cannot take.
    #[error("body '{body}' cannot be dented: {source}. A smaller `radius` of Deformation may help")]
    Dent {
        /// Which body.
        body: String,
        /// Why.
        source: DeformError,
    },
    /// A body that is the child of another entity.
    #[error(
        "body '{body}' is a child of another entity, but a body's Transform is its place in the world: spawn it as a root, or remove its ChildOf"
    )]
    ChildBody {
        /// Which body.
        body: String,
    },
    /// All 2^32 ids were given away.
    #[error("no id is left for another body: an app numbers at most 2^32 in its life")]
    NoIdLeft,
    /// An effect whose part of the program was left out when it was built.
    #[error(
        "{what} needs the feature `{feature}` of cranny-ecs, which this program was built without"
    )]
    MissingFeature {
        /// What needs the feature.
        what: &'static str,
        /// The Cargo feature.
        feature: &'static str,
    },
    /// A step that is no duration, or more steps than can be counted.
    #[error("a run of {duration:?} s in steps of {step:?} s cannot be made: {why}")]
    Duration {
        /// Seconds a step.
        step: f64,
        /// Seconds in all.
        duration: f64,
        /// What is wrong.
        why: &'static str,
    },
    /// More layers than a solver can distinguish.
    #[error(
        "the scene's bodies name {count} layers, but the solver tells at most {limit} apart: merge some"
    )]
    TooManyLayers {
        /// Layers found.
        count: usize,
        /// The most there can be.
        limit: usize,
    },
    /// One of rapier's own detectors, or its solver, panicked in a step.
    #[error("rapier panicked in step {step}: {why}")]
    SolverPanicked {
        /// Steps completed before.
        step: u64,
        /// What it said.
        why: String,
    },
    /// The world refused something, or a pair cannot be queried.
    #[error(transparent)]
    World(#[from] WorldError),
    /// A body's `Transform` scales.
    #[error(
        "body '{body}': its Transform has the scale {scale}, but bodies are rigid. Scale the mesh instead"
    )]
    Scaled {
        /// Which body.
        body: String,
        /// What was found.
        scale: String,
    },
    /// The solver refused a body.
    #[cfg(feature = "rapier")]
    #[error("body '{body}': {source}")]
    Solver {
        /// Which body.
        body: String,
        /// Why.
        source: cranny_rapier::SimulationError,
    },
    /// A body has left every bound, so that poses are no numbers any more.
    #[error(
        "body '{body}' has no finite pose after step {step}: the simulation has blown up. A smaller step (--dt) usually helps"
    )]
    NotFinite {
        /// Which body.
        body: String,
        /// Steps completed.
        step: u64,
    },
    /// The recording cannot be written.
    #[cfg(feature = "record")]
    #[error(transparent)]
    Record(#[from] cranny_record::RecordError),
    /// A file or folder that cannot be written.
    #[error("{}: cannot be written ({why})", path.display())]
    Output {
        /// Where.
        path: PathBuf,
        /// What was said.
        why: String,
    },
    /// An output that would destroy what is there, or another output.
    #[error("{}: nothing is written there: {why}. Choose another path", path.display())]
    OutputInTheWay {
        /// The requested output.
        path: PathBuf,
        /// What stands there.
        why: String,
    },
    /// A mesh that cannot be drawn.
    #[error("body '{body}' cannot be drawn: {why}")]
    Undrawable {
        /// Which body.
        body: String,
        /// What is wrong.
        why: String,
    },
    /// A camera that cannot see.
    #[error("camera '{camera}': {why}")]
    Camera {
        /// Its name.
        camera: String,
        /// What is wrong.
        why: String,
    },
    /// A picture could not be drawn.
    #[error("camera '{camera}': no picture could be drawn ({why})")]
    Picture {
        /// Whose picture.
        camera: String,
        /// What was said.
        why: String,
    },
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for SceneAppError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// The first error of the steps so far: what is wrong with a body, a pair or an output.
///
/// A step hands it to bevy's error handler once, as an error of a system: without a handler of its
/// own the app panics with the message. Where the handler does not panic, or the app
/// [keeps failures](crate::CrannyPlugins::keep_failures), the error stays here until the app takes
/// it, and [`FixedUpdatePlugin`](crate::FixedUpdatePlugin) makes no step in the meantime.
#[derive(Resource, Debug, Default)]
pub struct Failure {
    error: Option<SceneAppError>,
    handed_on: bool,
    /// Whether the app looks here by itself.
    kept: bool,
}

impl Failure {
    /// None yet, in an app that looks here by itself.
    pub(crate) fn kept() -> Self {
        Self { kept: true, ..Self::default() }
    }

    /// Keeps the first error.
    pub fn set(&mut self, error: SceneAppError) {
        self.error.get_or_insert(error);
    }

    /// Keeps the error of a result.
    pub(crate) fn note<T>(&mut self, result: Result<T, impl Into<SceneAppError>>) -> Option<T> {
        result.map_err(|error| self.set(error.into())).ok()
    }

    /// Whether something failed.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.error.is_some()
    }

    /// The error, which is then forgotten.
    pub fn take(&mut self) -> Option<SceneAppError> {
        self.handed_on = false;
        self.error.take()
    }

    /// The message of an error that neither bevy's error handler has seen nor the app will look at.
    ///
    /// # Errors
    ///
    /// That message, once.
    pub(crate) fn hand_on(&mut self) -> Result<(), BevyError> {
        match &self.error {
            Some(error) if !self.kept && !self.handed_on => {
                self.handed_on = true;
                Err(error.to_string().into())
            }
            _ => Ok(()),
        }
    }
}

/// Hands what failed in a step to bevy's error handler.
pub(crate) fn hand_on_failure(mut failure: ResMut<Failure>) -> Result<(), BevyError> {
    failure.hand_on()
}
