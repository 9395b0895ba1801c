//! What a walk does, for whoever wants to draw it or to know where it lost its way.

use cranny_exact::DVec3;
use cranny_geometry::hull::HullVertexId;

use super::WalkCounters;
use super::graph::HullFeature;

/// Sees each state of a walk, in order, as [`walk_hulls_observed`](super::walk_hulls_observed)
/// comes to it. What is counted in [`WalkCounters::steps`], `portals` and `exhausted` is seen here
/// one by one; a call that is `proved_at_once` shows the state that proves it. Every method does
/// nothing unless it is written anew, and `()` sees nothing.
pub trait WalkObserver {
    /// Last frame's pair, held against the certificate before any walk.
    fn kept_pair(&mut self, _pair: [HullFeature; 2]) {}

    /// Last frame's portal, with the depth of overlap that it proves still, or that the balls
    /// within the hulls do.
    fn kept_portal(&mut self, _portal: [[HullVertexId; 2]; 3], _depth: f64) {}

    /// The walk looks at a pair of features. Where the hulls overlap, `shift` is the way by which
    /// the second is moved to look for the features that part them (first's frame); else it is
    /// zero.
    fn pair(&mut self, _pair: [HullFeature; 2], _shift: DVec3) {}

    /// The base of a pseudo-internal region: three pairs of support points, the first hull's and
    /// the second's.
    fn portal(&mut self, _portal: [[HullVertexId; 2]; 3]) {}

    /// All triangles near the supports along this direction (first's frame) are put to the exact
    /// predicates.
    fn exhausted(&mut self, _direction: DVec3) {}
}

impl WalkObserver for () {}

/// Counts what is done, and shows it.
pub(super) struct Trail<'a, O> {
    pub(super) counters: &'a mut WalkCounters,
    pub(super) observer: &'a mut O,
    pub(super) shift: DVec3,
}

impl<O: WalkObserver> Trail<'_, O> {
    #[inline]
    pub(super) fn pair(&mut self, pair: [HullFeature; 2]) {
        self.counters.steps += 1;
        self.observer.pair(pair, self.shift);
    }

    #[inline]
    pub(super) fn portal(&mut self, portal: [[HullVertexId; 2]; 3]) {
        self.counters.portals += 1;
        self.observer.portal(portal);
    }

    pub(super) fn exhausted(&mut self, direction: DVec3) {
        self.counters.exhausted += 1;
        self.observer.exhausted(direction);
    }
}
