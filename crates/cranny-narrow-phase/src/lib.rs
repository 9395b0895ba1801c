//! The exact pair query: verdicts, distances, contact curves and regions.
//!
//! # Promises
//!
//! - The verdict on the surfaces, solidity and containment are exact for the vertices as stored and
//!   the poses as [accepted](cranny_exact::Pose::accepted): no epsilon decides them, and exchanging
//!   A and B exchanges the answer (of one model twice at the very same pose there is nothing to
//!   exchange: its contacts and regions stay as found).
//! - Distances, depths, areas and points are `f64`; lengths are within a few dozen ulps of the
//!   largest length of the pair.
//! - Memory is a value that the caller owns ([`PairMemory`]); it never changes an answer. (Names of
//!   regions and counters are history, and no part of an answer.)
//! - No input or output, no clock, no globals, no graphics.
//!
//! # Non-promises
//!
//! Depth and area of *special* positions (faces flush, edges meeting edges) are read from a
//! position 2^-30 of the pair's size beside them. Self-intersecting meshes are taken as they are.
//!
//! # The story, file by file
//!
//! `query` says what is computed, for the `fields` that somebody reads, and how bodies `approach`;
//! `evaluate` conducts.
//!
//! **Separate.** `pair` puts the two models in canonical order and poses vertices; `hulls` looks
//! for a plane between their hulls, beyond which nothing is searched.
//!
//! **Search.** One descent of the models' two trees of clusters serves every question (`search`,
//! which has a story of its own). `coherent` keeps what the next query of the pair begins with, as
//! long as that pays (`backoff`), by bounds of `motion`.
//!
//! **Decide.** `surface` classifies faces that may meet; `inside`, `wedge` and `containment` decide
//! about solids, seeing planes by `projection`; `closest` measures faces, among those that lie
//! `foremost` where a plane parts the hulls, along the line that `hulls` finds; `contacts`
//! evaluates features that face each other.
//!
//! **Describe.** `intersection` chains the segments of crossing faces, `pieces` cuts the surfaces
//! along them, `outline` measures what curves enclose, `way_out` chooses the direction along which
//! a piece parts (vertices by what is `nearest_on` a surface) and `depth` measures it there (seen
//! as `footprints`, within its `borders`). `special_position` reads flush faces from beside;
//! `touch` and `near` describe contact without overlap, `regions` puts it together (each is `found`
//! before it is the caller's; `penetration` the depths alone), `reduce` keeps what matters and
//! `tracks` names regions after those of the last query; `smooth` gives contacts the normals of
//! curved surfaces.
//!
//! Beside these: `pockets` is the second way to the faces that meet, by the envelopes of
//! concavities, which are the subject of the crate `cranny-concavity` ([`Method`] chooses) and are
//! searched by boxes over faces (`descent`);
//! `brute_force` is the slow, obviously right version of the verdict and the distance. `observe`
//! shows what a search looks at, for drawing, and `heat` sums it up: work is counted in a `tally`,
//! which is compiled with an observer and without. `verify` computes every answer twice, with
//! memory and without: [`query_verified`].
//!
//! [`operations`] are the operations that a query is made of, for other methods about pairs. Crates
//! above this one are such methods: `cranny-estimate` says what is certain of a pair within a
//! budget, `cranny-impact` when two moving bodies first meet, `cranny-primitives` measures against
//! balls, cylinders and the like.
//!
//! ```
//! use cranny_exact::{DVec3, Pose};
//! use cranny_geometry::{BuildOptions, Mesh, Model};
//! use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
//!
//! let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
//! let a = Placed { model: &model, pose: Pose::IDENTITY };
//! let b = Placed { model: &model, pose: Pose::at(DVec3::new(3.0, 0.0, 0.0)) };
//! let answer = query(a, b, &Query::of(Demand::Distance { below: None }), &mut PairMemory::default())?;
//! assert_eq!(answer.distance, Some(2.0));
//! assert!(!answer.solid);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answer;
mod approach;
mod backoff;
mod borders;
mod box_test;
pub mod brute_force;
mod closest;
mod coherent;
mod contacts;
mod containment;
mod depth;
mod evaluate;
mod fields;
mod footprints;
mod foremost;
mod found;
mod heat;
mod hulls;
mod inside;
mod intersection;
mod memory;
mod motion;
mod near;
mod nearest_on;
mod numbering;
mod observe;
mod outline;
mod pair;
mod penetration;
mod per_model;
mod pieces;
mod pockets;
mod projection;
mod query;
mod reduce;
mod regions;
mod search;
mod smooth;
mod special_position;
mod surface;
mod tally;
mod touch;
mod tracks;
mod verify;
mod way_out;
mod wedge;

pub use answer::{
    Answer, Contact, Containment, Counters, Curve, Feature, Region, RegionId, Surface, Witness,
};
pub use approach::Approach;
pub use contacts::overlaps_by_regions;
pub use evaluate::{QueryError, query, query_observed};
pub use fields::Fields;
pub use heat::SearchHeat;
pub use memory::PairMemory;
pub use motion::drift;
pub use observe::{ComparedBoxes, SearchObserver};
pub use penetration::Penetration;
pub use query::{Demand, Method, Normals, Placed, Query};
pub use reduce::{SAME_NORMAL, reduce as reduce_contacts, reduce_level as reduce_level_contacts};
pub use smooth::smooth_normal;
pub use verify::{Mismatch, query_verified};

/// The operations that a [`query`] is made of, for other methods about pairs of models.
///
/// A method takes a [`Pair`](operations::Pair): two placed models in an order and a frame that do
/// not depend on which one the caller names A. It excludes pairs of nodes of the models' trees by
/// the [`BoxTest`](operations::BoxTest), decides about faces by
/// [`FacePair::of`](operations::FacePair::of), measures them by
/// [`NearestFaces`](operations::NearestFaces), and decides about solids whose surfaces are disjoint
/// by [`Solidity`](operations::Solidity). What it keeps for the next pose of the pair is valid as
/// far as [`RelativeMotion`](operations::RelativeMotion) bounds what has changed, and for the
/// models of its [`PairTag`](operations::PairTag).
///
/// ```
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, FaceId, Mesh, Model};
/// use cranny_narrow_phase::operations::{BoxTest, NearestFaces, Pair};
/// use cranny_narrow_phase::{Counters, Placed};
///
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
/// let a = Placed { model: &model, pose: Pose::IDENTITY };
/// let b = Placed { model: &model, pose: Pose::at(DVec3::new(3.0, 0.0, 0.0)) };
/// let pair = Pair::new(a, b)?;
/// // The boxes of the two roots are 2 apart, and so are the surfaces.
/// let root = &model.tree().node(0).bounds;
/// assert!(BoxTest::of(&pair).apart(root, root, 1.9));
/// let (mut nearest, mut counters) = (NearestFaces::less_than(&pair, 5.0), Counters::default());
/// for f in 0..4 {
///     for g in 0..4 {
///         nearest.offer(FaceId(f), FaceId(g), &mut counters);
///     }
/// }
/// assert_eq!(nearest.found().map(|found| found.distance), Some(2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub mod operations {
    pub use crate::box_test::BoxTest;
    pub use crate::closest::{Closest, NearestFaces};
    pub use crate::containment::Solidity;
    pub use crate::motion::RelativeMotion;
    pub use crate::pair::{Pair, PairTag, Side};
    pub use crate::per_model::PerModel;
    pub use crate::search::common_point;
    pub use crate::surface::FacePair;
    pub use crate::tally::Tally;
}

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
