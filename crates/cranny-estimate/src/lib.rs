//! Estimates: what is certain of a pair of models when only so much may be spent on it.
//!
//! # Promises
//!
//! - No level and no budget excludes what [`query`](cranny_narrow_phase::query()) finds:
//!   [`Verdict::Excluded`] and [`Verdict::Certain`] agree with it, the interval holds its distance,
//!   and the places hold its contacts across gaps and the points where surfaces meet.
//! - An effort without limits *is* the query, at its cost.
//! - Exchanging A and B exchanges the estimate.
//! - No input or output, no clock (a caller may [lend one](Clock)), no globals, no graphics.
//!
//! An [`Answer`](cranny_narrow_phase::Answer) is exact in every field. What is not certain is an
//! [`Estimate`], another type.
//!
//! # Non-promises
//!
//! Memory makes estimates tighter: they depend on history where a budget ends the work. Places do
//! not hold the points of a contact that is deeper than the margin.
//!
//! # The story, file by file
//!
//! `estimator` conducts: [`estimate()`] takes an [`Effort`] (`effort`): a level ([`Accuracy`]),
//! which says what may be read of the bodies, and a budget, which says how long. Boxes, trees to a
//! depth and the whole are one method, `refinement`: a cut through the pairs of nodes of the two
//! `trees`, opened nearest first, with the limits that the level sets (`scope`); `findings` keeps
//! the results of tests of faces. Hulls and caps begin with the walk between the hulls
//! (`hull_gap`), and caps go on with the nodes that hold faces on the hull. `places` lists where
//! contact may be, and `estimate` is the result.
//!
//! What was certain in the last frame stays so but for motion (`warm_start`, in the caller's
//! `memory`): successive estimates narrow what a level or a budget left open. `observe` shows what
//! memory holds, for drawing.

mod effort;
mod estimate;
mod estimator;
mod findings;
mod hull_gap;
mod memory;
mod observe;
mod places;
mod refinement;
mod scope;
mod trees;
mod warm_start;

pub use effort::{Accuracy, Budget, Clock, Effort};
pub use estimate::{Estimate, Place, Verdict};
pub use estimator::estimate;
pub use memory::EstimateMemory;
pub use observe::{EstimateObserver, KeptNodes};

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
