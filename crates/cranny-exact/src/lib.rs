//! What every other crate of Cranny stands on: poses and frames, boxes, intervals, sign
//! predicates, the coordinate domain and every tolerance.
//!
//! # Promises
//!
//! - Every [`Sign`] is exact for coordinates inside the [`domain`]: a floating-point filter decides
//!   the easy cases, adaptive arithmetic ([`robust`]) the rest. No epsilon decides topology.
//! - Boxes and intervals are rounded outward: they may be too large by an ulp, never too small.
//! - One function ([`RigidMap::apply`]) poses a vertex into another frame; everybody reads its
//!   rounded result, so no two parts of the program can disagree about where a vertex is.
//! - No input or output, no clock, no globals, no graphics.
//!
//! # Non-promises
//!
//! Constructed numbers (lengths, points of intersection) are `f64` and carry rounding; they live in
//! the crates that construct them, with their error bounds.
//!
//! ```
//! use cranny_exact::{DVec3, Sign, orient3d};
//! let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::Y];
//! assert_eq!(orient3d(a, b, c, DVec3::Z), Sign::Positive); // above a counter-clockwise triangle
//! assert_eq!(orient3d(a, b, c, DVec3::new(0.25, 0.25, 0.0)), Sign::Zero);
//! ```

mod aabb;
mod direction;
pub mod domain;
mod expansion;
mod interval;
mod pose;
mod sign;
mod tolerance;
mod triangle;
mod weighted;

pub use aabb::Aabb;
pub use direction::generic_direction;
pub use domain::{DomainError, check_point, is_in_domain};
pub use glam::{DMat3, DQuat, DVec2, DVec3};
pub use interval::Interval;
pub use pose::{Pose, PoseError, RigidMap};
pub use sign::{Arithmetic, Sign, orient2d, orient3d};
pub use tolerance::Tolerance;
pub use triangle::{
    Crossing, CrossingEnd, Meeting, Piercing, SegmentFeature, TriangleFeature,
    classify_segment_triangle, classify_triangles, cross_triangles, judge_triangles,
    locate_piercing,
};
pub use weighted::WeightedPoint;

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
