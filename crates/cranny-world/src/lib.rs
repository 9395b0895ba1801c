//! Bodies, poses and the lifetime of pairs; what is wanted of each pair; what began and what ended.
//! And the neutral [`description`] of a scene, which says all this before anything runs.
//!
//! # Promises
//!
//! - **Only what is wanted is computed.** A pair's [`Demand`](cranny_narrow_phase::Demand) is the
//!   least that gives what is read of the scene's, its two bodies' and its own
//!   [`Effect`](description::Effect)s: of `Contacts` all, unless [`World::set_contact_fields`] says
//!   less. A pair whose demand is `None` is never looked at. A pair that somebody else detects
//!   already (inside a solver's step) is handed in by [`World::supply`] and not detected twice.
//! - **No meeting is missed**: the broad phase's boxes hold the posed bodies and every margin, all
//!   rounding included.
//! - **Order is by stable ids.** Answers and events are sorted by body ids, which are never used
//!   again; the order of calls between two steps changes nothing.
//! - **Began and Ended alternate** for every pair, also when a body is removed or an effect is
//!   taken away while the bodies touch.
//! - **Any number of threads, the same answers** (feature `parallel`): pairs are answered by a pool
//!   if [`World::set_threads`] requests one, and are reported in order of ids, equal to the bit.
//! - **No level and no budget misses what exact answers find**: triggers and distances may be known
//!   at a level, or within a number of tests a step ([`World::set_accuracy`],
//!   [`World::set_budget`]); what is open then counts as touching ([`PairEstimate`]).
//! - **Memory changes no answer**, and whoever doubts it can have every answer checked:
//!   [`World::set_verification`]. Within a budget it says how much is left open; estimates are not
//!   checked.
//! - **A body is a model or a primitive** ([`BodyShape`](cranny_primitives::BodyShape)). A pair
//!   with a primitive is answered at once, whatever its level and the budget; what such an answer
//!   lacks, [`query_shapes`](cranny_primitives::query_shapes) lists. Its verdict is right to
//!   rounding.
//! - No input or output, no clock, no globals, no graphics.
//!
//! # Non-promises
//!
//! Nothing is said about what happens between two poses: a body that jumps through another one has
//! not met it.
//!
//! ```
//! use cranny_exact::{DVec3, Pose};
//! use cranny_geometry::{BuildOptions, Mesh, Model};
//! use cranny_world::description::{BodyKind, Effect};
//! use cranny_world::{BodySpec, PairEventKind, World};
//!
//! let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
//!
//! let mut world = World::new();
//! world.set_scene_effects(&[Effect::TRIGGER])?;
//! let mut insert = |name: &str, kind, x| {
//!     let pose = Pose::at(DVec3::new(x, 0.0, 0.0));
//!     world.insert(BodySpec { kind, pose, ..BodySpec::new(name, model.clone()) })
//! };
//! let post = insert("post", BodyKind::Fixed, 0.0)?;
//! let ball = insert("ball", BodyKind::Dynamic, 5.0)?;
//! assert!(world.step()?.events.is_empty());
//!
//! world.set_pose(ball, Pose::at(DVec3::new(0.25, 0.0, 0.0)))?;
//! let report = world.step()?;
//! assert_eq!((report.events[0].a, report.events[0].b), (post, ball));
//! assert_eq!(report.events[0].kind, PairEventKind::Began);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrangement;
mod body;
mod bounds;
mod crew;
mod demand;
pub mod description;
mod error;
mod estimates;
mod layers;
mod random;
mod report;
mod world;

pub use arrangement::{Arranged, Arrangement, ArrangementError, NearestPair, Wanted};
pub use body::{Body, BodyId, BodySpec};
pub use bounds::world_box;
pub use cranny_estimate::Verdict;
pub use demand::ContactFields;
pub use error::{WorldError, WorldInvariantError};
pub use estimates::PairEstimate;
pub use layers::Layers;
pub use random::Random;
pub use report::{
    Deepest, EstimateStats, PairAnswer, PairEvent, PairEventKind, PairMismatch, StepReport,
    StepStats,
};
pub use world::World;

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
