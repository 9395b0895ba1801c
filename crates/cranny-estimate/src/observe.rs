//! The contents of a memory of estimates, shown for drawing. Nothing is kept for that alone.

use cranny_concavity::walk::HullFeature;
use cranny_narrow_phase::operations::Pair;

use crate::trees::PairTrees;
use crate::warm_start::WarmStart;

/// A pair of nodes of the two bodies' trees that is not opened, and a bound of their distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptNodes {
    /// A node of A's [`tree`](cranny_geometry::Model::tree), one of B's: indices for
    /// [`FaceTree::node`](cranny_geometry::FaceTree::node).
    pub nodes: [u32; 2],
    /// No face beneath the one is nearer to a face beneath the other than this, at the poses
    /// observed; 0 where they may meet.
    pub separation: f64,
}

/// Sees what a memory holds, in no particular order. The default methods do nothing.
pub trait EstimateObserver {
    /// How far [`estimate`](crate::estimate()) has opened the trees. Each pair of faces lies
    /// beneath exactly one of these.
    fn cut(&mut self, _kept: KeptNodes) {}

    /// Features of A's hull and of B's from which the next walk starts.
    fn walk(&mut self, _features: [HullFeature; 2]) {}
}

/// Shows what was left at this pose of the pair.
pub(crate) fn show(warm: &WarmStart, pair: &Pair, observer: &mut impl EstimateObserver) {
    for (nodes, separation) in warm.cut(&PairTrees::of(pair)) {
        let [first, second] = nodes;
        let nodes = pair.ordered(first, second);
        observer.cut(KeptNodes { nodes, separation: separation.max(0.0) });
    }
    if let Some([first, second]) = warm.walked() {
        observer.walk(pair.ordered(first, second));
    }
}
