//! Two hulls and the motion between their frames, as every part of the walk sees them.

use cranny_exact::{DVec3, RigidMap};
use cranny_geometry::hull::{ConvexHull, HullVertexId};

use super::graph::{FeatureGraph, HullFeature};

/// A hull with its features.
#[derive(Clone, Copy, Debug)]
pub struct WalkHull<'a> {
    /// The hull.
    pub hull: &'a ConvexHull,
    /// [`FeatureGraph::new`] of that hull.
    pub graph: &'a FeatureGraph,
}

/// Rounding of every length that the walk constructs, relative to the pair's scale (the two reaches
/// from the origins of their frames plus the translation). With `u = 2^-53` and lengths in units of
/// the scale, a bound along a direction collects: two support heights 8 u, turning the direction
/// into the second frame 11 u, the translation 4 u, two sums 3 u, division by the length 4 u, a
/// facet's stored plane in place of a support 6 u; the posed vertex itself, rounded, lies within 32
/// u of its exact image. Together 68 u. A distance of two witnesses collects 45 u. Smaller, and
/// intervals are not certain; larger, and more pairs are sent to the exact predicates
/// (`distances_hold_the_rational_one`).
const ROUNDING: f64 = 40.0 * f64::EPSILON;

pub(super) struct Sides<'a> {
    pub(super) hulls: [WalkHull<'a>; 2],
    /// `from[i]` leads from the other's frame into that of `i`.
    pub(super) from: [RigidMap; 2],
    /// Bound of the rounding of a constructed length; see [`ROUNDING`].
    pub(super) rounding: f64,
}

impl<'a> Sides<'a> {
    pub(super) fn new(hulls: [WalkHull<'a>; 2], first_from_second: &RigidMap) -> Self {
        let scale =
            hulls[0].graph.reach + hulls[1].graph.reach + first_from_second.translation.length();
        Self {
            hulls,
            from: [*first_from_second, first_from_second.inverse()],
            rounding: ROUNDING * scale,
        }
    }

    /// The same pair, the second moved by `offset` in the first's frame.
    pub(super) fn moved(&self, offset: DVec3) -> Self {
        let mut first_from_second = self.from[0];
        first_from_second.translation += offset;
        Self::new(self.hulls, &first_from_second)
    }

    pub(super) fn graph(&self, side: usize) -> &'a FeatureGraph {
        self.hulls[side].graph
    }

    /// Where a vertex is, in the frame of `side`, which need not be its own.
    #[inline]
    pub(super) fn vertex_in(&self, side: usize, of: usize, vertex: HullVertexId) -> DVec3 {
        self.point_in(side, of, self.hulls[of].hull.position(vertex))
    }

    /// A point given in the frame of `of`, in the frame of `side`.
    #[inline]
    pub(super) fn point_in(&self, side: usize, of: usize, p: DVec3) -> DVec3 {
        if side == of { p } else { self.from[side].apply(p) }
    }

    #[inline]
    pub(super) fn vector_in(&self, side: usize, of: usize, v: DVec3) -> DVec3 {
        if side == of { v } else { self.from[side].linear * v }
    }

    /// A direction of the first's frame, as the second sees it, by the transpose: the height of a
    /// point `p` of the second along `d` is exactly `(Lᵀ d) · p` plus that of the translation,
    /// whether or not `L` is a rotation to the last bit.
    #[inline]
    pub(super) fn second_direction(&self, d: DVec3) -> DVec3 {
        self.from[1].linear * d
    }

    /// How wide an interval between certified bounds may be if nothing went wrong: rounding of both
    /// ends, and what merged facets are thick.
    pub(super) fn resolution(&self) -> f64 {
        4.0 * self.rounding + self.graph(0).thickness_max + self.graph(1).thickness_max
    }

    /// The vertex of `side` that lies farthest in a direction of its own frame.
    pub(super) fn support(
        &self,
        side: usize,
        direction: DVec3,
        start: Option<HullVertexId>,
    ) -> HullVertexId {
        // A hull with a feature graph has a vertex.
        self.hulls[side].hull.support(direction, start).unwrap_or(HullVertexId(0))
    }

    /// Some vertex of a feature.
    pub(super) fn corner_of(&self, side: usize, feature: HullFeature) -> HullVertexId {
        let graph = self.graph(side);
        match feature {
            HullFeature::Vertex(v) => v,
            HullFeature::Edge(e) => graph.half_edges[e.index()].ends[0],
            HullFeature::Facet(f) => {
                graph.around(f).next().map_or(HullVertexId(0), |(_, h)| h.ends[0])
            }
        }
    }
}
