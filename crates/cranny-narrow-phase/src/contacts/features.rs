//! What is looked at from a leaf of a patch's tree: corners and edges, and where they are.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{EdgeId, VertexId};

use super::gauss_map::Arc;

/// A vertex that is looked at from a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) vertex: VertexId,
    /// Which of the leaf's points.
    pub(super) at: u16,
}

/// An edge that is looked at from a leaf and may cross others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) edge: EdgeId,
    /// Which of the leaf's points: from the edge's lesser vertex to its greater.
    pub(super) ends: [u16; 2],
}

/// Where an edge is, and along which directions it is touched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) bounds: Aabb,
    pub(super) arc: Arc,
}

impl Corner {
    /// Where it is, given the leaf's points.
    #[inline]
    pub(super) fn at(&self, points: &[DVec3]) -> DVec3 {
        points[usize::from(self.at)]
    }
}

impl Segment {
    /// Where its ends are, given the leaf's points.
    #[inline]
    pub(super) fn ends(&self, points: &[DVec3]) -> [DVec3; 2] {
        self.ends.map(|end| points[usize::from(end)])
    }
}
