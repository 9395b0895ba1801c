//! Certificates of verdicts about two meshes, and their check.
//!
//! A pair query says how two surfaces meet, whether the bodies share interior points, and whether
//! one lies in the other. A certificate is what anybody needs to check that without trusting the
//! detector: two triangles that cross, or planes that part all triangles of A from all of B.
//!
//! # Promises
//!
//! - [`verify`] accepts no false claim. It decides in whole and rational numbers alone, for the
//!   vertices as filed and as the certificate's map poses them, rounded to `f64` as the query does.
//! - This crate depends on no other crate of Cranny: it shares no code with what it checks.
//! - No input panics.
//!
//! # Non-promises
//!
//! Distances, depths and regions are not certified. Faces of a body may pass through each other;
//! what is inside is then what the closed components wind around.
//!
//! # The story, file by file
//!
//! `certificate` is the format, with `groups` of faces and `direction`s between parts of them.
//! `exact` is the arithmetic. `body` and `posed` are the two meshes in one frame; `verify` follows
//! the evidence. For the solids, `winding` locates a point, `cells` cuts faces that touch, and
//! `solids` concludes.
//!
//! ```
//! use cranny_certificate::{
//!     Certificate, Claim, Evidence, Frame, Step, SurfaceVerdict, Triangles, verify,
//! };
//!
//! let corner = Triangles {
//!     vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
//!     faces: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
//! };
//! let at = |x: f64| {
//!     [1.0, 0.0, 0.0, x, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
//! };
//! let mut certificate = Certificate {
//!     poses: [at(0.0), at(1.5)],
//!     frame: Frame::A,
//!     map: [1.0, 0.0, 0.0, 1.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
//!     evidence: Evidence {
//!         crossing: None,
//!         touching: None,
//!         apart: vec![Step::Direction([1.0, 0.0, 0.0])],
//!     },
//! };
//! let apart = Claim { surface: SurfaceVerdict::None, solid: false, contained: None };
//! assert_eq!(verify(&apart, &certificate, [&corner, &corner]), Ok(()));
//! certificate.evidence.apart = vec![Step::Direction([0.0, 1.0, 0.0])];
//! assert!(verify(&apart, &certificate, [&corner, &corner]).is_err());
//! ```

mod body;
mod cells;
mod certificate;
mod direction;
mod exact;
mod groups;
mod posed;
mod solids;
mod verify;
mod winding;

pub use body::{Body, Triangles};
pub use certificate::{Certificate, Claim, Contained, Evidence, Frame, Step, SurfaceVerdict};
pub use direction::{Part, Parts};
pub use groups::{Groups, halves};
pub use posed::{Parting, PosedPair};
pub use verify::{Refusal, verify};
