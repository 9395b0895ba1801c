//! What lies between a body and its hull, and the run-time method that goes with it.
//!
//! # Promises
//!
//! - Caps close: faces off the hull and the caps above them have the same boundary, whatever
//!   rounding did, and volumes add up: what the hull has and the body lacks is the pockets and the
//!   skin.
//! - Nothing here is made unless it is called for: [`Concavities::of`] returns a value that its
//!   caller holds.
//! - After a deformation, what [follows](FollowedConcavities) equals what is made anew.
//! - No input or output, no clock, no globals, no graphics.
//!
//! # Non-promises
//!
//! Concavities of a body that is not closed, or passes through itself, are those of its faces as
//! they are; the [findings](Concavities::findings) say where caps cover the hull twice.
//!
//! # The story, file by file
//!
//! The method is that of Ponamgi, Manocha and Lin (1997). **Before bodies move**, `features` find
//! which faces lie on the hull. `caps` close what they leave open, along closed chains of edges
//! (`boundary`). `concavity` joins faces off the hull and caps to concavities with lids, loops,
//! sizes, and trees, and `envelope` wraps each in convex layers.
//!
//! **At each query of a pair**, [`walk`] follows the closest features of the two hulls from
//! the last ones, over exterior Voronoi regions, and on through pseudo-internal ones where the
//! hulls overlap (estimates do; an exact query parts hulls by a plane, which costs less). Where
//! hulls meet, [`pockets`] keeps the three cases apart: what lies on the hulls, a thing in a
//! pocket, a pocket in a pocket. It opens the concavities that the other hull may reach, goes down
//! the layers of their envelopes, and closes a pocket whose guest has left through the cap. It
//! hands over pairs of faces, on the hulls by `node_set`; who decides which of them meet is the
//! narrow phase, which offers all this as `Method::Envelopes`, under the same tests as its own
//! search.
//!
//! ```
//! use cranny_concavity::{Concavities, ConcavityKind};
//! use cranny_geometry::{BuildOptions, Model};
//! use cranny_shapes::Cup;
//!
//! let (model, _) = Model::build(Cup::default().build()?, &BuildOptions::default())?;
//! let concavities = Concavities::of(&model);
//! let well = concavities.iter().next().ok_or("a cup has a well")?;
//! assert_eq!((well.kind, well.lids().len()), (ConcavityKind::Pocket, 1));
//! assert!(well.measures.pocket_volume > 0.0 && !well.faces.is_empty() && !well.caps.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod boundary;
mod caps;
mod concavity;
pub mod envelope;
pub mod features;
mod ids;
mod node_set;
pub mod pockets;
pub mod walk;

pub use concavity::{
    Border, BoundaryLoop, CapTriangle, Concavities, Concavity, ConcavityChange, ConcavityKind,
    ConcavitySet, ConcavityWork, Cover, FollowedConcavities, Lid, Measures, Skin, Stage,
};
pub use envelope::{Envelope, EnvelopeOptions, Envelopes};
pub use features::Features;
pub use ids::{CapId, ConcavityId, ConvexSetId, EnvelopeFacetId, LayerId, LidId};
pub use node_set::NodeSet;
