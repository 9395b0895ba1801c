//! Meshes, hulls, trees and the prepared [`Model`]: all that is known of a body before it moves.
//!
//! # Promises
//!
//! - Any triangle mesh is accepted whose coordinates lie in the [`domain`](cranny_exact::domain)
//!   and of which one face at least has an area, open and non-manifold ones included; the
//!   [`Report`] names every defect that limits answers.
//! - Preparation moves nothing unless [`Repair`] says so: vertices in the same place are welded,
//!   unreferenced ones dropped, and a closed body that is inside out is turned round, which the
//!   report says. A repaired surface is proved to be the filed one within the weld distance.
//! - The hull is exactly convex, and the tree's boxes hold their faces exactly.
//! - No input or output, no clock, no globals, no graphics.
//!
//! # Non-promises
//!
//! Self-intersections are reported, never resolved; holes are reported, never filled.
//!
//! ```
//! use cranny_geometry::{BuildOptions, DVec3, Mesh, Model};
//!
//! let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let (model, report) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
//! assert!(model.is_closed() && report.is_sound());
//! assert!((model.mass_properties().unwrap().volume - 1.0 / 6.0).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A body changes its shape, and is saved:
//!
//! ```
//! use cranny_geometry::{BuildOptions, Model, VertexId};
//! use cranny_shapes::Cup;
//!
//! let (mut model, _) = Model::build(Cup::default().build()?, &BuildOptions::default())?;
//! // A vertex goes a little inward.
//! let (vertex, center) = (VertexId(0), model.bounds().center());
//! let place = model.mesh().position(vertex);
//! let change = model.deform(&[(vertex, place + 0.001 * (center - place))])?;
//! assert_eq!(change.vertices, [vertex]);
//!
//! let loaded = Model::decode(&model.encode())?;
//! assert_eq!(loaded.digest(), model.digest());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! What of a body is not convex is no part of its model: the crate `cranny-concavity` makes it on
//! demand.

mod angle;
mod chunks;
pub mod clusters;
mod codec;
mod deform;
mod digest;
mod each_once;
mod flatness;
mod grid;
pub mod hull;
mod ids;
mod mass;
mod mesh;
mod model;
mod near;
mod on_demand;
mod patches;
mod polygon;
mod projection;
mod reach;
mod repair;
mod report;
mod resolution;
pub mod rows;
mod scan;
mod smooth_normals;
mod topology;
mod tree;
pub mod triangle_distance;
pub mod triangulate;
mod weld;
mod winding;

/// What the interface of this crate is written in.
pub use cranny_exact::{Aabb, DVec3, Tolerance};

pub use angle::between as radians_between;
pub use clusters::ClusterTree;
pub use deform::{Blow, ChangeSet, DeformError, Dent, Trail, Work};
pub use each_once::each_once;
pub use flatness::Flatness;
pub use hull::ConvexHull;
pub use ids::{ComponentId, EdgeId, FaceId, HalfEdgeId, OptionalIndex, PatchId, VertexId};
pub use mass::{MassProperties, SurfaceProperties};
pub use mesh::{Mesh, MeshError};
pub use model::{BuildError, BuildOptions, DecodeError, Model, ModelTag, Stage};
pub use patches::{NormalCone, Patch, Patches};
pub use polygon::{SplitPolygon, split_polygon};
pub use repair::Repair;
pub use repair::proof::ProofError;
pub use report::{
    Element, Finding, FindingKind, MeetingScan, Provenance, RepairKind, RepairRecord, Report,
};
pub use smooth_normals::{
    Crease, CreaseAngleError, SmoothNormals, SurfaceNormal, check_crease_angle,
};
pub use topology::{Component, DisjointSets, Edge, EdgeKind, Topology};
pub use tree::{
    Content, FaceForest, FaceTree, GrownAreas, MovedFace, Node, NodeChanges, PairedStep, partition,
};

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
