//! The hard cases, in families, and what came out of them.
//!
//! # Promises
//!
//! - Cases are seeded: the same [`Settings`] give the same cases everywhere.
//! - The truth of a case is known by how it was made, or from `cranny-testkit`, which constructs in exact
//!   rationals what the product decides by signs. Nothing is judged by a tolerance, but for the walk's
//!   least distance, which brute force measures in `f64`.
//! - A [`Peer`] is asked the same; what it gets wrong is told beside ours and fails nobody.
//!
//! # Non-promises
//!
//! A family that passes proves nothing about other cases. Self-intersecting bodies are in none of them.
//!
//! # The story, file by file
//!
//! [`FAMILIES`] is the table: whoever has a new family adds a file to `families` and a line to the table.
//! A [`Family`] fills a `trial` with cases; `pair` judges two bodies, [`hull_judge`] two hulls, and [`Peer`]
//! is whoever else is asked. [`Outcome`] sums up.
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
mod pair;
mod peer;
mod trial;

pub use case::{Case, Outcome, PeerCase};
pub use families::FAMILIES;
pub use family::{Family, Settings};
pub use peer::{Peer, PeerAnswer};
