//! Where a prepared mesh comes from.

use crate::ids::VertexId;
use crate::report::RepairRecord;
use crate::weld::UNREFERENCED;

/// What was filed, and what became of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Vertices as filed.
    pub vertices: usize,
    /// Faces as filed.
    pub faces: usize,
    /// What was mended, in order.
    pub repairs: Vec<RepairRecord>,
    /// The prepared surface is proved to be the filed one within this distance, both ways. 0 where
    /// no vertex moved and no edge was split off its line. Unit: length.
    pub deviation: f64,
    /// What each filed vertex became.
    pub(crate) new_ids: Vec<u32>,
}

impl Provenance {
    /// What a filed vertex became: vertices are numbered anew by their first use, and several in
    /// one place become one. `None` of one that no face of the prepared mesh uses, and of a number
    /// that was not filed.
    #[must_use]
    pub fn vertex(&self, filed: u32) -> Option<VertexId> {
        let id = *self.new_ids.get(filed as usize)?;
        (id != UNREFERENCED).then_some(VertexId(id))
    }
}
