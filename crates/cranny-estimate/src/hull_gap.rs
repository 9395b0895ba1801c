//! How far two hulls are apart, by the walk of `cranny-concavity`. Its feature graphs are made when
//! first needed.

use cranny_concavity::walk::{
    FeatureGraph, HullFeature, Relation, WalkCounters, WalkHull, WalkState, walk_hulls,
};
use cranny_exact::DVec3;
use cranny_geometry::VertexId;
use cranny_geometry::hull::HullVertexId;
use cranny_narrow_phase::operations::{Pair, PerModel};

/// The feature graphs of a pair's hulls, about 500 bytes a vertex, and the features of the last
/// walk.
#[derive(Clone, Debug, Default)]
pub(crate) struct HullWalk {
    /// `None` for a hull without features: no model has one.
    graphs: Option<PerModel<Option<FeatureGraph>>>,
    state: WalkState,
}

/// The result of a walk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HullGap {
    /// The hulls share no point.
    pub(crate) apart: bool,
    /// A lower bound of the distance between the hulls, hence of that between the surfaces.
    pub(crate) lower: f64,
    /// Vertices of the two surfaces, near the witness points of the hulls.
    pub(crate) vertices: [VertexId; 2],
    /// Feature pairs and portals that were tested.
    pub(crate) steps: u64,
}

impl HullWalk {
    /// Makes the feature graphs, if they are not there. Linear in the hulls.
    pub(crate) fn prepare(&mut self, pair: &Pair) {
        let graph = |side| FeatureGraph::new(pair.model(side).hull()).ok();
        self.graphs.get_or_insert_with(|| PerModel::of(pair, graph));
    }

    /// Walks. `None` for hulls without features.
    pub(crate) fn walk(&mut self, pair: &Pair) -> Option<HullGap> {
        self.prepare(pair);
        let [Some(first), Some(second)] = self.graphs.as_ref()?.both() else { return None };
        let [a, b] = pair.models().map(|model| model.hull());
        let hulls = [WalkHull { hull: a, graph: first }, WalkHull { hull: b, graph: second }];
        let map = pair.first_from_second();
        let mut counters = WalkCounters::default();
        let [a, b] = hulls;
        let found = walk_hulls(a, b, map, &mut self.state, &mut counters).ok()?;
        let [p, q] = found.points;
        let points = [p, map.inverse().apply(q)];
        Some(HullGap {
            apart: found.relation == Relation::Separated,
            lower: found.separation.lo.max(0.0),
            vertices: [0, 1].map(|i| nearest_corner(&hulls[i], found.features[i], points[i])),
            steps: counters.steps + counters.portals,
        })
    }

    /// The next walk starts where one without memory does.
    pub(crate) fn start_anew(&mut self) {
        self.state = WalkState::default();
    }

    /// Where the next walk starts.
    pub(crate) fn features(&self) -> Option<[HullFeature; 2]> {
        self.state.features()
    }

    pub(crate) fn bytes(&self) -> usize {
        let bytes = |graph: &Option<FeatureGraph>| graph.as_ref().map_or(0, FeatureGraph::bytes);
        self.graphs.as_ref().map_or(0, |graphs| graphs.bytes(bytes))
    }
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
