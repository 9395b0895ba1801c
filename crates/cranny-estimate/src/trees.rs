//! The face trees of a pair, which levels are cuts through.

use cranny_geometry::FaceTree;
use cranny_narrow_phase::operations::{BoxTest, Pair};

/// A pair of nodes: an index of the first tree, one of the second.
pub(crate) type NodePair = [u32; 2];

/// The trees of a pair and the test of their boxes.
pub(crate) struct PairTrees<'a> {
    /// Of the first model and of the second.
    pub(crate) sides: [&'a FaceTree; 2],
    pub(crate) boxes: BoxTest,
    /// By how much posing may have reduced any slack.
    pub(crate) error: f64,
}

impl<'a> PairTrees<'a> {
    pub(crate) fn of(pair: &Pair<'a>) -> Self {
        Self {
            sides: pair.models().map(|model| model.tree()),
            boxes: BoxTest::of(pair),
            error: pair.culling_error(),
        }
    }
}
