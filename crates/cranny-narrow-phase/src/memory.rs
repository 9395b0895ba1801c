//! What a pair keeps from one query to the next: a value that the caller owns.

use crate::contacts::ContactMemory;
use crate::pair::PosedVertices;

/// Memory of one pair. Dropping it costs time, never a different answer.
///
/// It holds working space (posed vertices) and the features of the last contacts for a solver.
#[derive(Clone, Debug, Default)]
pub struct PairMemory {
    pub(crate) posed: PosedVertices,
    pub(crate) contacts: ContactMemory,
}

impl PairMemory {
    /// Heap bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.posed.bytes() + self.contacts.bytes()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
