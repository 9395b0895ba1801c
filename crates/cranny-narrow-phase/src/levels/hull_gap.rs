//! How far two hulls are apart, by the walk: what it needs is made when first asked for, once for two
//! bodies of one model.

use std::sync::Arc;

use cranny_exact::DVec3;
use cranny_geometry::hull::HullVertexId;
use cranny_geometry::{Model, VertexId};

use crate::pair::{Pair, Side};
use cranny_concavity::walk::{
    FeatureGraph, HullFeature, Relation, WalkCounters, WalkHull, WalkState, walk_hulls,
};

/// The hulls of a pair and last frame's features. About 500 bytes a vertex of each hull.
#[derive(Clone, Debug, Default)]
pub(super) struct HullWalk {
    graphs: Option<[Arc<FeatureGraph>; 2]>,
    state: WalkState,
}

/// What the walk tells.
#[derive(Clone, Copy, Debug)]
pub(super) struct HullGap {
    /// The hulls share no point.
    pub(super) apart: bool,
    /// The distance between the hulls, hence between the surfaces, is this or more.
    pub(super) lower: f64,
    /// Vertices of the two surfaces, near where the hulls are nearest.
    pub(super) vertices: [VertexId; 2],
    /// Feature pairs and portals that were looked at.
    pub(super) steps: u64,
}

impl HullWalk {
    /// Makes the feature graphs, if they are not there. Linear in the hulls.
    pub(super) fn prepare(&mut self, pair: &Pair) {
        if self.graphs.is_none() {
            self.graphs = graphs(Side::BOTH.map(|side| pair.model(side)));
        }
    }

    /// Walks. `None` of hulls without features: no model has one.
    pub(super) fn walk(&mut self, pair: &Pair) -> Option<HullGap> {
        self.prepare(pair);
        let models = Side::BOTH.map(|side| pair.model(side));
        let graphs = self.graphs.as_ref()?;
        let hull = |i: usize| WalkHull { hull: models[i].hull(), graph: &graphs[i] };
        let map = &pair.first_from_second;
        let mut counters = WalkCounters::default();
        let found = walk_hulls(hull(0), hull(1), map, &mut self.state, &mut counters).ok()?;
        let [p, q] = found.points;
        let points = [p, map.inverse().apply(q)];
        Some(HullGap {
            apart: found.relation == Relation::Separated,
            lower: found.separation.lo.max(0.0),
            vertices: [0, 1].map(|i| nearest_corner(&hull(i), found.features[i], points[i])),
            steps: counters.steps + counters.portals,
        })
    }

    /// Where the next walk starts.
    pub(super) fn features(&self) -> Option<[HullFeature; 2]> {
        self.state.features()
    }

    pub(super) fn bytes(&self) -> usize {
        match &self.graphs {
            Some([a, b]) if Arc::ptr_eq(a, b) => a.bytes(),
            Some([a, b]) => a.bytes() + b.bytes(),
            None => 0,
        }
    }
}

fn graphs([a, b]: [&Model; 2]) -> Option<[Arc<FeatureGraph>; 2]> {
    let of = |model: &Model| FeatureGraph::new(model.hull()).ok().map(Arc::new);
    let first = of(a)?;
    let second = if a.is_same(b) { Arc::clone(&first) } else { of(b)? };
    Some([first, second])
}

/// The corner of a feature that is nearest to a point, all in the hull's frame.
fn nearest_corner(body: &WalkHull, feature: HullFeature, point: DVec3) -> VertexId {
    let hull = body.hull;
    let distance = |v: &HullVertexId| (hull.position(*v) - point).length_squared();
    let nearest = |corners: &[HullVertexId]| {
        corners.iter().copied().min_by(|v, w| distance(v).total_cmp(&distance(w)))
    };
    let corner = match feature {
        HullFeature::Vertex(v) => Some(v),
        HullFeature::Edge(e) => nearest(&body.graph.edge_ends(e)),
        HullFeature::Facet(f) => nearest(hull.facet(f).corners),
    };
    hull.source(corner.unwrap_or(HullVertexId(0)))
}
