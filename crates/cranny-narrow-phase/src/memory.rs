//! What a pair keeps from one query to the next: a value that the caller owns.

use crate::coherent::Coherent;
use crate::contacts::ContactMemory;
use crate::hulls::Parting;
use crate::pockets::PocketMemory;
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
    pub(crate) contacts: ContactMemory,
    pub(crate) coherent: Coherent,
    pub(crate) parting: Parting,
    pub(crate) pockets: PocketMemory,
    pub(crate) smooth: SmoothMemory,
    pub(crate) tracks: RegionTracks,
}

impl PairMemory {
    /// Heap bytes held; but for concavities, which pairs may share.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let kept = self.contacts.bytes() + self.coherent.bytes() + self.pockets.bytes();
        kept + self.smooth.bytes() + self.tracks.bytes()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
