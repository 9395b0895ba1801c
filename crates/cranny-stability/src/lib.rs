//! The hard cases, in families, and what came out of them.
//!
//! # Promises
//!
//! - Cases are seeded: the same [`Settings`] give the same cases everywhere.
//! - The truth of a case is known by how it was made, or from `cranny-testkit`, which constructs in
//!   exact rationals what the product decides by signs. Three things are not judged so: the walk's
//!   lengths, which are compared with the rational distance to some hundred roundings; the walk's
//!   penetration depth, which is held against all faces of the set of differences in `f64`; and
//!   what memory changes, which is the product against itself: without memory, and by its own brute
//!   force over all pairs of faces.
//! - A [`Peer`] answers the same questions; its errors stand beside ours and fail nobody.
//!
//! # Non-promises
//!
//! A family that passes proves nothing about other cases. Self-intersecting bodies are in none of
//! them.
//!
//! # The story, file by file
//!
//! [`FAMILIES`] is the table: whoever has a new family adds a file to `families` and a line to the
//! table. A [`Family`] fills a `trial` with cases; `pair` judges two bodies, [`hull_judge`] two
//! hulls by what [`HullTruth`] knows of them, and [`Peer`] is another detector. [`Outcome`]
//! sums up.
//!
//! ```
//! use cranny_stability::{FAMILIES, Settings};
//!
//! let contacts = FAMILIES.iter().find(|family| family.name == "contacts").ok_or("no such family")?;
//! let outcome = contacts.run(&Settings { seed: 1, variants: 1 }, None);
//! assert!(outcome.cases.len() > 50 && outcome.failed() == 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bodies;
mod case;
mod families;
mod family;
pub mod hull_judge;
mod hull_truth;
mod pair;
mod peer;
mod trial;

pub use case::{Case, Outcome, PeerCase};
pub use families::FAMILIES;
pub use family::{Family, Settings};
pub use hull_truth::HullTruth;
pub use peer::{Peer, PeerAnswer};

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
