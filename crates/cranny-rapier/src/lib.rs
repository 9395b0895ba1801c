//! Cranny's detector as rapier's narrow phase.
//!
//! # Promises
//!
//! - `NarrowPhase::with_query_dispatcher(cranny_rapier::dispatcher())` and [`MeshShape`] are all
//!   that a rapier app needs: contacts between meshes are then the ones that their triangles really
//!   make, a bounded number of them, each with the normal of its own point.
//! - 'Exact' refers to the relative pose that rapier hands over: of f32 in `cranny-rapier`, of f64
//!   in `cranny-rapier-f64`, which is built from the same sources.
//! - Mass, centre and inertia are those of the solid, computed in f64.
//! - Normals are those of the meshes' facets; for a shape made so
//!   ([`MeshShape::with_smooth_normals`]), a solver gets those of the curved surface that the
//!   facets stand for. Points and separations are exact all the same.
//! - Impulses are carried over from step to step by features, or by place.
//! - With the feature `snapshot`, a world that was written and read again goes on to the bit as if
//!   nobody had stopped it: `snapshot` and `restore`.
//!
//! # Non-promises
//!
//! Shapes of an app's own meet our shape as a hollow parry mesh, and so do shape casts of all that
//! is round: see [`Dispatcher`]. rapier's own continuous detection leaves our shape out, as it does
//! its own meshes: look ahead of fast bodies, as [`simulation`] does. rapier's own settings matter:
//! see [`simulation`].
//!
//! ```
//! use cranny_exact::{DVec3, Pose};
//! use cranny_geometry::{BuildOptions, Model};
//! use cranny_rapier::{BodyKind, BodySpec, MassSource, Normals, Simulation, SimulationOptions};
//! use cranny_shapes::Cuboid;
//!
//! let cube = Cuboid { size: [1.0, 1.0, 1.0] }.build()?;
//! let (model, _) = Model::build(cube, &BuildOptions::default())?;
//! let mut simulation = Simulation::new(SimulationOptions::default());
//! let spec = |kind, z| BodySpec {
//!     shape: (&model).into(),
//!     kind,
//!     pose: Pose::at(DVec3::new(0.0, 0.0, z)),
//!     linear_velocity: DVec3::ZERO,
//!     angular_velocity: DVec3::ZERO,
//!     mass: MassSource::Density(1.0),
//!     friction: 0.5,
//!     restitution: 0.0,
//!     normals: Normals::Flat,
//!     groups: 1,
//! };
//! simulation.insert(&spec(BodyKind::Fixed, 0.0))?;
//! let upper = simulation.insert(&spec(BodyKind::Dynamic, 1.1))?;
//! for _ in 0..120 {
//!     simulation.step();
//! }
//! assert!((simulation.pose(upper).translation.z - 1.0).abs() < 0.01); // it rests on the lower one
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![allow(
    clippy::unnecessary_cast,
    clippy::useless_conversion,
    reason = "numbers of rapier are f32 in one build and f64, where nothing is left to convert, in the other"
)]

mod ahead;
mod apart;
mod ask;
mod carried;
mod casts;
mod compounds;
mod convert;
mod detector;
mod dispatcher;
mod joint;
mod log;
mod manifolds;
mod mass;
mod pair;
mod partners;
mod questions;
mod round_casts;
mod shape;
pub mod simulation;
#[cfg(feature = "snapshot")]
pub mod snapshot;

pub use carried::{CARRIED_WITHIN, PairCounts};
pub use convert::{narrow, pose_from_rapier, pose_to_rapier, wide};
pub use cranny_narrow_phase::Normals;
pub use detector::{Detector, TREE_DEPTH, UnknownDetector};
pub use dispatcher::{Dispatcher, dispatcher};
pub use joint::{APPROACH, JointIndex, JointSpec, Motor};
pub use log::{AnswerLog, LoggedAnswer};
pub use mass::{MassError, MassSource, StatedMass, mass_properties};
pub use shape::{MeshShape, ShapeError};
pub use simulation::{
    BodyIndex, BodyKind, BodySpec, Energy, PairContacts, Resistance, Simulation, SimulationError,
    SimulationOptions, SolvedContacts, SolvedPoint, StepHooks, Timings,
};
#[cfg(feature = "snapshot")]
pub use snapshot::{RestoreError, Sets, SnapshotError, restore, snapshot};

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
