//! What a pair keeps from one query to the next: a value that the caller owns.

use std::sync::Arc;

use cranny_concavity::Concavities;
use cranny_exact::Pose;
use cranny_geometry::Model;

use crate::coherent::Coherent;
use crate::contacts::ContactMemory;
use crate::hulls::Parting;
use crate::pair::{Pair, PosedVertices};
use crate::pockets::PocketMemory;
use crate::query::Placed;
use crate::smooth::SmoothMemory;
use crate::tracks::RegionTracks;

/// Memory of one pair. Dropping it costs time, never a different answer.
///
/// It holds a plane between the hulls; where the last descent of the search trees ended (28 bytes
/// for each block of eight boxes, 40 for each pair of clusters within reach); the faces that
/// crossed or were nearest; and of contacts within a margin the candidates, 24 bytes each, where
/// motion is slow enough for their list to last, else those that won last.
/// With smooth normals, those of both models: a caller with many pairs of few models makes them
/// once, and turns contacts itself ([`smooth_normal`](crate::smooth_normal)). Of regions, the last
/// ones and their faces, which name the next. With [envelopes](crate::Method::Envelopes), the
/// concavities of both models. Models are recognised, not kept alive.
#[derive(Clone, Debug, Default)]
pub struct PairMemory {
    pub(crate) posed: PosedVertices,
    pub(crate) contacts: ContactMemory,
    pub(crate) coherent: Coherent,
    pub(crate) parting: Parting,
    pub(crate) pockets: PocketMemory,
    pub(crate) smooth: SmoothMemory,
    pub(crate) tracks: RegionTracks,
}

impl PairMemory {
    /// Gives the concavities of two models to [`Method::Envelopes`](crate::Method::Envelopes),
    /// which otherwise makes them at its first query about the pair: many pairs of few models then
    /// share them. Clones share them as well.
    ///
    /// `a` and `b` are the models of the queries to come, each with its own [`Concavities::of`] it.
    pub fn hold_concavities(
        &mut self,
        (a, of_a): (&Model, &Arc<Concavities>),
        (b, of_b): (&Model, &Arc<Concavities>),
    ) {
        let placed = |model| Placed { model, pose: Pose::IDENTITY };
        let pair = Pair::of_accepted(placed(a), placed(b));
        let of = pair.ordered(of_a, of_b);
        self.pockets.hold(&pair, of);
    }

    /// Heap bytes held; but for concavities, which pairs may share.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let kept = self.contacts.bytes() + self.coherent.bytes() + self.pockets.bytes();
        self.posed.bytes() + kept + self.smooth.bytes() + self.tracks.bytes()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
