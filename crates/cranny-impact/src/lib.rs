//! Time of impact: when do two moving bodies, convex or not, first meet?
//!
//! # Promises
//!
//! - **Nothing is missed.** Every answer is certified against the exact motion ([`Motion`]), not
//!   against samples of it: [`Impact::None`] means that the surfaces share no point at any time
//!   from 0 to 1, and [`Hit::time`] begins where the certificate ends.
//! - **A hit is real to a tolerance**: at the end of [`Hit::time`] the surfaces are no farther
//!   apart than [`ImpactOptions::tolerance`]. Bodies that pass each other nearer than that without
//!   touching may be reported; farther apart, never.
//! - Exchanging A and B exchanges the answer. No history, no clock, no randomness.
//! - Work is bounded by [`ImpactOptions::budget`]. When it is spent, the answer is the certified
//!   part: free until then, unknown from then on.
//! - No input or output, no globals, no graphics, no sine and no cosine.
//!
//! # Non-promises
//!
//! Bodies are rigid while they move, and move at constant linear and angular velocity. Bodies that
//! meet at time 0 are reported as such, without depth: [`cranny_narrow_phase::query`] measures it.
//!
//! # The story, file by file
//!
//! `impact` is the question and the answer: [`time_of_impact`]. `motion` says what moves how,
//! `rotation` computes it without sines. `bodies` is a pair at a moment, in canonical order.
//! `reach` bounds how long two boxes or two triangles stay apart; `search` descends the box trees
//! with these bounds, the earliest candidate first; `faces` settles two triangles: curved motion is
//! cut into pieces that are linear to within a fraction of the tolerance, and `linear` finds when
//! the vertices, edges and faces of a piece meet. `ways` lets several bodies move at once.
//!
//! # Cost
//!
//! Half a microsecond a pair of boxes, one a pair of faces. Two 2,000-triangle tori that fly at
//! each other from a diameter away, tumbling or not, take about 1,800 and 200 of them: a
//! millisecond, most of it before the hit's neighbourhood; ten times finer tolerance adds a tenth.
//! Surfaces that slide along each other at a gap `g` all over cost most: every pair of faces near
//! each other is tested once in about `√(2g / acceleration)`. A nut of 22,000 triangles that turns
//! by 0.05 radians on its bolt takes half a second, in proportion to the angle.

mod bodies;
mod faces;
mod impact;
mod linear;
mod motion;
mod reach;
mod rotation;
mod search;
mod ways;

pub use impact::{Hit, Impact, ImpactCounters, ImpactError, ImpactOptions, time_of_impact};
pub use linear::{LinearImpact, LinearLimits, linear_edge_edge, linear_vertex_face};
pub use motion::{MAX_TURN, Motion, Moving};
pub use ways::{Way, shorten};

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
