//! What the user means by 'the same place'. Never mixed with rounding.

/// Lengths in the unit of the model, chosen by the user. Nothing topological reads them unless the
/// caller requests a repair or contacts at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Vertices at most this far apart may be welded by a repair.
    /// Smaller: cracks between faces stay open. Larger: fine detail collapses.
    pub weld_distance: f64,
}

impl Tolerance {
    /// Only vertices in exactly the same place are the same.
    pub const EXACT: Self = Self { weld_distance: 0.0 };
}

impl Default for Tolerance {
    /// [`Tolerance::EXACT`].
    fn default() -> Self {
        Self::EXACT
    }
}
