//! Patches for which one point is not enough.

use cranny_geometry::PatchId;

use crate::pair::{Pair, Side};

/// A patch whose box is longer than this part of its body's counts as coarse: it has large faces
/// (others are cut to this length), so a whole side of the body may stand on it, and one point is
/// not enough.
const COARSE: f64 = 0.26;

/// Which patches are coarse.
#[derive(Clone, Copy)]
pub(super) struct Coarse {
    /// Square of the longest diagonal that is not.
    beyond: [f64; 2],
}

impl Coarse {
    pub(super) fn of(pair: &Pair) -> Self {
        let beyond = Side::BOTH.map(|side| {
            let b = pair.model(side).bounds();
            COARSE * COARSE * (b.max - b.min).length_squared()
        });
        Self { beyond }
    }

    /// As if all patches were.
    #[cfg(test)]
    pub(super) fn all() -> Self {
        Self { beyond: [-1.0; 2] }
    }

    /// Whether either of two patches is coarse, so that contacts are to span the pair.
    pub(super) fn holds(&self, pair: &Pair, patches: [PatchId; 2]) -> bool {
        Side::BOTH.into_iter().any(|side| {
            let patch = pair.model(side).patches().patch(patches[side.index()]);
            (patch.bounds.max - patch.bounds.min).length_squared() > self.beyond[side.index()]
        })
    }
}
