//! What a pair keeps from one query to the next: a value that the caller owns.

use crate::pair::PosedVertices;

/// Memory of one pair. Dropping it costs time, never a different answer.
///
/// It holds working space so far (posed vertices); what was true last frame comes with the coherent
/// descent, and belongs here.
#[derive(Clone, Debug, Default)]
pub struct PairMemory {
    pub(crate) posed: PosedVertices,
}

impl PairMemory {
    /// Heap bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.posed.bytes()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
