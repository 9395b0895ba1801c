//! The face trees of a pair, which levels are cuts through.

use cranny_geometry::FaceTree;

use crate::descent::BoxTest;
use crate::pair::{Pair, Side};

/// A pair of nodes: one of the first tree, one of the second.
pub(crate) type Nodes = [u32; 2];

/// The trees of a pair and the test of their boxes.
pub(crate) struct Ground<'a> {
    pub(crate) trees: [&'a FaceTree; 2],
    pub(crate) boxes: BoxTest,
    /// What posing may have eaten of any slack.
    pub(crate) error: f64,
}

impl<'a> Ground<'a> {
    pub(crate) fn of(pair: &Pair<'a>) -> Self {
        Self {
            trees: Side::BOTH.map(|side| pair.model(side).tree()),
            boxes: BoxTest::of(pair),
            error: pair.culling_error(),
        }
    }
}
