//! Where a prepared mesh comes from.

use crate::report::RepairRecord;

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
}
