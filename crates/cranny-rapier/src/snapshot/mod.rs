//! rapier's world as bytes, and back, so that it goes on to the bit as if nobody had stopped it.
//!
//! rapier's serde writes its world, but for shapes that it does not know, and reads it with its own
//! dispatcher. Here our shapes are written as stand-ins beside a list of which collider held which
//! model; [`restore`] is given the models, and puts shapes and dispatcher back. What pairs of ours
//! keep from step to step is left behind: it saves time and changes no answer; impulses are in
//! rapier's manifolds.
//!
//! # Promises
//!
//! - The restored world goes on as the one that was written: the same poses and velocities, to the
//!   bit, for the same build on the same machine (rapier's `enhanced-determinism` says more).
//! - A model that is missing or is not the one that was saved is an error, and so are bytes that
//!   were cut off or damaged: all of them carry a checksum. Without our `restore`, rapier's serde
//!   refuses to write our shapes: no body ever comes back as a hollow mesh.
//!
//! # Non-promises
//!
//! - The checksum shows damage, not malice: rapier believes what a forger gives a right checksum.
//! - What rapier's serde leaves out is left out: hooks, event handlers, and the changes of joints
//!   since the last step. So step once after the last change.
//! - Snapshots are read by the versions of Cranny and rapier that wrote them.
//!
//! ```
//! use cranny_geometry::{BuildOptions, Model};
//! use cranny_rapier::{MeshShape, dispatcher, restore, snapshot};
//! use rapier3d::prelude::*;
//!
//! let cube = cranny_shapes::Cuboid { size: [1.0, 1.0, 1.0] }.build()?;
//! let (model, _) = Model::build(cube, &BuildOptions::default())?;
//! let mut world = PhysicsWorld {
//!     narrow_phase: NarrowPhase::with_query_dispatcher(dispatcher()),
//!     ..PhysicsWorld::default()
//! };
//! world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::cuboid(5.0, 0.5, 5.0));
//! let fall = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 1.2, 0.0));
//! let (body, _) = world.insert(fall, ColliderBuilder::new(MeshShape::shared(&model, 0)?));
//! (0..10).for_each(|_| world.step());
//!
//! let bytes = snapshot(&world)?;
//! let mut restored = restore(&bytes, &[model])?;
//! for _ in 0..50 {
//!     world.step();
//!     restored.step();
//! }
//! assert_eq!(world.bodies[body].position(), restored.bodies[body].position());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod attached;
mod frame;
mod simulation;
mod stand_in;

use cranny_geometry::Model;
use rapier3d::math::Vector;
use rapier3d::prelude::{
    BroadPhaseBvh, ColliderSet, ImpulseJointSet, IntegrationParameters, IslandManager,
    MultibodyJointSet, NarrowPhase, PhysicsWorld, RigidBodySet, SoftBodySet,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use self::attached::{Attached, attach, attached};
pub use self::attached::{ModelPrint, Place};
pub use self::frame::FrameError;
use self::frame::{Kind, content, framed};
pub(crate) use self::stand_in::StandIn;
use crate::dispatcher::Dispatcher;
use crate::shape::ShapeError;

/// A world that cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// Colliders were inserted, removed or changed since the last step.
    #[error(
        "{changed} colliders were inserted, removed or changed since the last step: make a step before the snapshot"
    )]
    Unsettled {
        /// How many.
        changed: usize,
    },
    /// Joints were inserted since the last step.
    #[error("a joint was inserted since the last step: make a step before the snapshot")]
    UnsettledJoint,
    /// A shape of the app's own, which rapier's serde does not know.
    #[error("rapier cannot write the world: {0}")]
    Write(#[source] postcard::Error),
}

/// Bytes from which no world can be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RestoreError {
    /// They are no snapshot, or not as it was written.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// Another version of rapier wrote it.
    #[error("the snapshot was written with rapier {found}, and this is rapier {own}")]
    Rapier {
        /// Version found.
        found: String,
        /// Version of this build.
        own: &'static str,
    },
    /// The checksum is right, yet it is no world.
    #[error("the snapshot holds no world that rapier can read: {0}")]
    Read(#[source] postcard::Error),
    /// The checksum is right, yet it is no world that was written between two steps.
    #[error("the snapshot is none that was written here: {flaw}")]
    Content {
        /// What is wrong with it.
        flaw: &'static str,
    },
    /// No model was given that is the one saved.
    #[error(
        "{place} holds a model of {model}; {}",
        match given.as_slice() {
            [] => "no model was given".to_owned(),
            given => format!(
                "of the models given none is that one: {}",
                given.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
            ),
        }
    )]
    Model {
        /// Where it is.
        place: Place,
        /// The one saved.
        model: ModelPrint,
        /// Those given.
        given: Vec<ModelPrint>,
    },
    /// A model of which no shape can be made.
    #[error("{place}: {source}")]
    Shape {
        /// Where it is.
        place: Place,
        /// Why.
        source: ShapeError,
    },
    /// A shape of ours is listed where there is none.
    #[error("the snapshot is none that was written here: {place} is to hold a model, and does not")]
    Place {
        /// Where.
        place: Place,
    },
    /// A shape of ours that the list leaves out.
    #[error(
        "the snapshot is none that was written here: it does not say which model {place} holds"
    )]
    Unattached {
        /// Where.
        place: Place,
    },
}

/// What of a rapier world goes into a snapshot: for apps that keep the sets themselves. A
/// [`PhysicsWorld`] turns into it.
#[derive(Clone, Copy, Serialize)]
pub struct Sets<'a> {
    /// Acceleration of dynamic bodies.
    pub gravity: Vector,
    /// rapier's settings.
    pub parameters: &'a IntegrationParameters,
    /// Who is asleep.
    pub islands: &'a IslandManager,
    /// Boxes.
    pub broad_phase: &'a BroadPhaseBvh,
    /// Contacts.
    pub narrow_phase: &'a NarrowPhase,
    /// Bodies.
    pub bodies: &'a RigidBodySet,
    /// Their shapes.
    pub colliders: &'a ColliderSet,
    /// Joints.
    pub joints: &'a ImpulseJointSet,
    /// Joints in reduced coordinates.
    pub multibody_joints: &'a MultibodyJointSet,
    /// Bodies that are soft.
    pub soft_bodies: &'a SoftBodySet,
}

impl<'a> From<&'a PhysicsWorld> for Sets<'a> {
    fn from(world: &'a PhysicsWorld) -> Self {
        Self {
            gravity: world.gravity,
            parameters: &world.integration_parameters,
            islands: &world.islands,
            broad_phase: &world.broad_phase,
            narrow_phase: &world.narrow_phase,
            bodies: &world.bodies,
            colliders: &world.colliders,
            joints: &world.impulse_joints,
            multibody_joints: &world.multibody_joints,
            soft_bodies: &world.soft_bodies,
        }
    }
}

/// The same as it is read, field by field.
#[derive(Deserialize)]
struct ReadSets {
    gravity: Vector,
    parameters: IntegrationParameters,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
}

/// A world between two steps as bytes: `&PhysicsWorld`, or [`Sets`].
///
/// Cost: linear in the world, and in the bytes of each model once.
///
/// # Errors
///
/// [`SnapshotError`].
pub fn snapshot<'a>(world: impl Into<Sets<'a>>) -> Result<Vec<u8>, SnapshotError> {
    written(Kind::World, &world.into(), &())
}

/// A world from the bytes of [`snapshot`], with [`dispatcher`](crate::dispatcher()). `models` are
/// those that its shapes were made of, in any order; more do no harm. An app that keeps the sets
/// itself takes them out of the world.
///
/// # Errors
///
/// [`RestoreError`].
pub fn restore(bytes: &[u8], models: &[Model]) -> Result<PhysicsWorld, RestoreError> {
    let ((), world) = read(Kind::World, bytes, models)?;
    Ok(world)
}

/// rapier's version, what else the caller writes, shapes, sets.
fn written(kind: Kind, sets: &Sets, more: &impl Serialize) -> Result<Vec<u8>, SnapshotError> {
    let mut colliders = sets.colliders.clone();
    let changed = colliders.take_modified().len() + colliders.take_removed().len();
    if changed > 0 {
        return Err(SnapshotError::Unsettled { changed });
    }
    let (attached, writing) = attached(sets.colliders);
    let bytes = postcard::to_stdvec(&(rapier3d::VERSION, more, attached, sets));
    drop(writing);
    Ok(framed(kind, &bytes.map_err(SnapshotError::Write)?))
}

fn read<T: DeserializeOwned>(
    kind: Kind,
    bytes: &[u8],
    models: &[Model],
) -> Result<(T, PhysicsWorld), RestoreError> {
    let content = content(kind, bytes)?;
    let (version, content): (String, _) =
        postcard::take_from_bytes(content).map_err(RestoreError::Read)?;
    if version != rapier3d::VERSION {
        return Err(RestoreError::Rapier { found: version, own: rapier3d::VERSION });
    }
    let ((more, attached, sets), rest): ((T, Vec<Attached>, ReadSets), _) =
        postcard::take_from_bytes(content).map_err(RestoreError::Read)?;
    if !rest.is_empty() {
        return Err(RestoreError::Content { flaw: "bytes are left over" });
    }
    let mut colliders = sets.colliders;
    if !(colliders.take_modified().is_empty() && colliders.take_removed().is_empty()) {
        return Err(RestoreError::Content { flaw: "colliders were changed since the last step" });
    }
    attach(&mut colliders, &attached, models)?;
    let mut narrow_phase = sets.narrow_phase;
    narrow_phase.set_query_dispatcher(Dispatcher::default());
    let world = PhysicsWorld {
        gravity: sets.gravity,
        integration_parameters: sets.parameters,
        islands: sets.islands,
        broad_phase: sets.broad_phase,
        narrow_phase,
        bodies: sets.bodies,
        colliders,
        impulse_joints: sets.joints,
        multibody_joints: sets.multibody_joints,
        soft_bodies: sets.soft_bodies,
        ..PhysicsWorld::default()
    };
    Ok((more, world))
}
