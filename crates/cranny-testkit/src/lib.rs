//! Judges for tests: oracles in exact rationals, slow brute force, and generators of hard cases.
//!
//! # Promises
//!
//! - The rational oracles share no method with the code that they judge: they *construct* what two
//!   things have in common, in exact rational arithmetic, and look at the result. The product
//!   constructs nothing and needs signs only.
//! - Generators are seeded: the same seed gives the same cases on every machine.
//!
//! # Non-promises
//!
//! Nothing here is fast (tens of microseconds a triangle pair), and nothing but tests, benches and
//! `cranny stability` may depend on it. Solids must be embedded: closed meshes may have several
//! shells, but no shell may pass through itself or another.
//!
//! ```
//! use cranny_exact::{DVec3, Meeting, classify_triangles};
//! use cranny_testkit::{Family, Rng, rational_meeting};
//!
//! let mut rng = Rng::new(1);
//! let (a, b) = Family::VertexOnFace.pair(&mut rng);
//! assert_eq!(classify_triangles(&a, &b), rational_meeting(&a, &b));
//! ```

pub mod bodies;
mod brute_force;
mod convex;
mod distance;
mod generate;
mod hull;
mod locate;
mod measure;
mod models;
mod nearly_flat;
mod random;
mod rational;
mod solid;
mod surface;
mod triangle;
mod wander;

pub use brute_force::brute_force_meeting;
pub use distance::{
    error_of_root, is_root_within, rational_distance_squared, rational_gap_squared,
};
pub use generate::Family;
pub use hull::{HullFault, rational_hull_fault, spans_a_solid};
pub use locate::{Location, PosedMesh};
pub use measure::{from_surface, world_triangles};
pub use models::{model, shape, small_models};
pub use nearly_flat::{Bytes, few_moves, nearly_flat_solid};
pub use random::Rng;
pub use rational::{Q, Q3};
pub use solid::{Contained, OracleVerdict, rational_verdict};
pub use surface::{brute_force_surface, rational_surface};
pub use triangle::{rational_contact, rational_meeting, rational_piercing};
pub use wander::Walk;

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
