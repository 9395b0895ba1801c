//! Makes certificates of what a pair query says, for `cranny_certificate::verify`.
//!
//! # Promises
//!
//! - Evidence is sought on the triangles as filed, not on what the query did. A wrong verdict has
//!   none, and [`ProveError::Contradicted`] says which faces contradict it.
//! - [`prove`] finds evidence for every right verdict.
//! - No input or output, no clock, no globals.
//!
//! # Non-promises
//!
//! Evidence is not the shortest there is.
//!
//! # The story, file by file
//!
//! `cloud` keeps the vertices of groups of faces; `plane` looks for a direction that parts two
//! groups; `descent` halves groups until each pair is parted, or finds faces that cross; `prove`
//! puts a certificate together.
//!
//! ```
//! use cranny_certificate::verify;
//! use cranny_exact::{DVec3, Pose};
//! use cranny_geometry::{BuildOptions, Mesh, Model};
//! use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
//! use cranny_prover::{claim, filed, prove};
//!
//! let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
//! let mesh = Mesh::new(vertices, faces)?;
//! let triangles = filed(&mesh);
//! let (model, _) = Model::build(mesh, &BuildOptions::default())?;
//! let a = Placed { model: &model, pose: Pose::IDENTITY };
//! let b = Placed { model: &model, pose: Pose::at(DVec3::new(0.3, 0.0, 0.0)) };
//! let answer = query(a, b, &Query::of(Demand::Intersects), &mut PairMemory::default())?;
//! let claim = claim(answer.surface, answer.solid, answer.contained);
//! let certificate = prove(&claim, [a, b], [&triangles, &triangles])?;
//! assert!(certificate.evidence.crossing.is_some());
//! verify(&claim, &certificate, [&triangles, &triangles])?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cloud;
mod descent;
mod plane;
mod prove;

pub use prove::{ProveError, claim, filed, prove};
