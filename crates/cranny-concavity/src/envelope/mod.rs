//! Envelopes: nested convex layers of a concavity, from the cap inwards.
//!
//! A **facet** is a half-space `normal · x <= offset` with some faces of the concavity beneath it:
//! each of their vertices lies in it, as real numbers; the normal points into the pocket. A probe
//! all of whose points have `normal · x > offset` touches nothing that lies beneath. A **layer** is
//! a set of at most [`EnvelopeOptions::width`] facets. Those of the first layer divide the faces of
//! the concavity among them; what is beyond all of them is the layer's **core**, a convex region
//! that touches no face: a ball in a cup, a peg in a hole stay there nearly always, and a dozen
//! planes say so. Where the probe **offends** a facet, the layer beneath is looked at: the same
//! construction for the facet's faces alone, finer by a factor of a dozen. So layers nest down to a
//! few faces, and each facet with what lies beneath is a sub-cavity.
//!
//! A half-space holds too much sideways (the far leg of a bent pocket lies beneath facets of the
//! near one). So a facet has a box too, and a *reach*: how far towards the cap its faces come.
//! Facets of a layer stand in the order of their reach, from the cap inwards, and a look at a layer
//! ends at the first facet below the probe: a probe that enters meets slice after slice.
//!
//! How faces are divided: into `groups` of a few that lie together and face the same way; and these
//! by where they lie along and around the opening direction, or by their normals, whichever leaves
//! the thinner layers beneath the planes; the thickest part is divided first (`cluster`). Nothing
//! is assumed of the pocket: voids have no lid, openings may be flat, faces may face anywhere.
//!
//! **Cells.** The facet with the least slack, `least(normal · x) − offset`, says where in the core
//! a probe is: for a point, its cell in the Voronoi diagram of the layer's planes; for a body,
//! pseudo-Voronoi (after Ponamgi, Manocha and Lin 1997, who walk exterior regions; here planes
//! replace features, so that a concavity needs as few of them as one likes). [`Envelope::track`]
//! keeps it from frame to frame with one evaluation while the motion stays within what the other
//! facets leave.
//!
//! All envelopes of a model lie in one set of flat arrays. Cost of building: O(n log n), a third
//! to half a microsecond a face.

mod build;
mod cluster;
mod face_groups;
mod moments;
mod probe;
mod update;
mod validate;
mod walk;

use cranny_exact::{Aabb, DVec3};

pub use self::probe::Probe;
pub use self::walk::{Cell, Opened, Passage};
use crate::ids::{EnvelopeFacetId, LayerId};
use cranny_geometry::{FaceId, OptionalIndex};

/// How to build envelopes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnvelopeOptions {
    /// Facets of a layer at most, at least 2. Default: [`DEFAULT_WIDTH`](Self::DEFAULT_WIDTH).
    pub width: usize,
    /// Faces at most beneath a facet without a further layer, at least 1. Default:
    /// [`DEFAULT_LEAF_FACES`](Self::DEFAULT_LEAF_FACES).
    pub leaf_faces: usize,
}

impl EnvelopeOptions {
    /// Fewer make a smaller core, so that probes offend more; more are looked at in vain: in a cup
    /// and on a thread 8, 16 and 32 differ by less than a third (`docs/notebook`).
    pub const DEFAULT_WIDTH: usize = 16;
    /// Fewer make more facets than faces; more hand faces over that are far away.
    pub const DEFAULT_LEAF_FACES: usize = 4;
}

impl Default for EnvelopeOptions {
    fn default() -> Self {
        Self { width: Self::DEFAULT_WIDTH, leaf_faces: Self::DEFAULT_LEAF_FACES }
    }
}

/// What an envelope is built for: the faces of a concavity, and how it opens.
#[derive(Clone, Copy, Debug)]
pub struct Pocket<'a> {
    /// Its faces, each once; their normals point into the pocket.
    pub faces: &'a [FaceId],
    /// For each lid a vector across it that points out of the pocket, of any length (its area
    /// vector, say). None: a void, or unknown. Zero vectors count as none.
    pub openings: &'a [DVec3],
}

/// The half-space `normal · x <= offset`, in the body's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Unit vector, to rounding.
    pub normal: DVec3,
    /// Rounded up, so that what should be held is held as real numbers.
    pub offset: f64,
}

/// A facet of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvelopeFacet {
    /// Holds the faces beneath. Its normal points into the pocket.
    pub beneath: HalfSpace,
    /// Box of the faces beneath, exact.
    pub bounds: Aabb,
    /// No face beneath comes farther along the envelope's axis; rounded up.
    pub reach: f64,
    /// Faces beneath: a range of all faces.
    faces: [u32; 2],
    /// None: the faces themselves come next.
    layer: OptionalIndex,
}

/// Envelopes of concavities, in flat arrays. The layers and facets are numbered through all of
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelopes {
    heads: Vec<Head>,
    /// Ranges of facets.
    layers: Vec<[u32; 2]>,
    facets: Vec<EnvelopeFacet>,
    faces: Vec<FaceId>,
    lids: Vec<HalfSpace>,
    options: EnvelopeOptions,
}

/// What is known of an envelope as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Head {
    axis: DVec3,
    bounds: Aabb,
    lids: [u32; 2],
    /// None for a concavity without faces.
    layer: OptionalIndex,
}

/// One of [`Envelopes`].
#[derive(Clone, Copy, Debug)]
pub struct Envelope<'a> {
    all: &'a Envelopes,
    head: &'a Head,
}

impl Envelopes {
    /// Number of envelopes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.heads.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.heads.is_empty()
    }

    /// Envelope `index < len()`, in the order of the pockets.
    #[must_use]
    pub fn envelope(&self, index: usize) -> Envelope<'_> {
        Envelope { all: self, head: &self.heads[index] }
    }

    /// All facets of all envelopes; those of a layer stand together.
    #[must_use]
    pub fn facets(&self) -> &[EnvelopeFacet] {
        &self.facets
    }

    /// A facet by number.
    #[must_use]
    pub fn facet(&self, facet: EnvelopeFacetId) -> &EnvelopeFacet {
        &self.facets[facet.index()]
    }

    /// The facets of a layer, from the cap inwards: at least one.
    pub fn layer(&self, layer: LayerId) -> impl ExactSizeIterator<Item = EnvelopeFacetId> + use<> {
        let [first, end] = self.layers[layer.index()];
        (first..end).map(EnvelopeFacetId)
    }

    /// The layer beneath a facet; `None` where its faces come next.
    #[must_use]
    pub fn layer_beneath(&self, facet: EnvelopeFacetId) -> Option<LayerId> {
        self.facet(facet).layer.get().map(LayerId)
    }

    /// All faces beneath a facet.
    #[must_use]
    pub fn faces_beneath(&self, facet: EnvelopeFacetId) -> &[FaceId] {
        let [first, end] = self.facet(facet).faces;
        &self.faces[first as usize..end as usize]
    }

    /// How they were built.
    #[must_use]
    pub fn options(&self) -> &EnvelopeOptions {
        &self.options
    }
}

impl<'a> Envelope<'a> {
    /// The first layer; `None` for a pocket without faces.
    #[must_use]
    pub fn first_layer(&self) -> Option<LayerId> {
        self.head.layer.get().map(LayerId)
    }

    /// The direction out of the pocket: the sum of the openings; the largest where they cancel (a
    /// hole right through); for a void the direction in which its box is shortest.
    #[must_use]
    pub fn axis(&self) -> DVec3 {
        self.head.axis
    }

    /// Box of all faces of the pocket, exact; empty where there are none.
    #[must_use]
    pub fn bounds(&self) -> &'a Aabb {
        &self.head.bounds
    }

    /// A half-space across each lid that holds the whole pocket.
    #[must_use]
    pub fn lids(&self) -> &'a [HalfSpace] {
        let [first, end] = self.head.lids;
        &self.all.lids[first as usize..end as usize]
    }
}
