//! The features of a hull as the walk wants them: vertices, edges and facets of the merged layer in
//! flat arrays, each with what its Voronoi region is bounded by.

use cranny_exact::DVec3;
use cranny_geometry::OptionalIndex;
use cranny_geometry::hull::{ConvexHull, FacetId, HullKind, HullVertexId};
use cranny_geometry::rows::{row, rows};
use thiserror::Error;

/// An edge of the merged layer, by one of its two half-edges: the lower one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HullEdgeId(pub u32);

impl HullEdgeId {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// A feature of the merged layer of a hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum HullFeature {
    /// A vertex.
    Vertex(HullVertexId),
    /// An edge between two facets, or the only one of a segment.
    Edge(HullEdgeId),
    /// A facet.
    Facet(FacetId),
}

/// No features can be listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum GraphError {
    /// The hull has no points.
    #[error("the hull has no points, hence no features: build it from at least one point")]
    Empty,
}

/// A half-edge of the merged layer. Vectors are in the hull's frame.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HalfEdge {
    pub(super) ends: [HullVertexId; 2],
    pub(super) twin: u32,
    facet: OptionalIndex,
    pub(super) from: DVec3,
    /// From the first end to the second.
    pub(super) along: DVec3,
    /// Whether the ends are neighbours on the exact hull: no vertex between them was left out.
    pub(super) is_exact: bool,
    /// Of length 1, in the facet's plane, across the edge and out of the facet; zero for a segment.
    pub(super) outward: DVec3,
}

impl HalfEdge {
    pub(super) fn facet(&self) -> Option<FacetId> {
        self.facet.get().map(FacetId)
    }
}

/// A facet's plane and the row of its half-edges.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FacetPlane {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
    pub(super) thickness: f64,
    /// How deep the centre lies below the plane (rounded).
    pub(super) depth: f64,
    row: [u32; 2],
}

/// The feature graph of one hull, made once and kept beside it. About 500 bytes a vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureGraph {
    pub(super) half_edges: Vec<HalfEdge>,
    pub(super) facets: Vec<FacetPlane>,
    fan_starts: Vec<u32>,
    fans: Vec<u32>,
    /// Neighbours on the exact hull: where they are, in rows by vertex.
    rim_starts: Vec<u32>,
    rim: Vec<(HullVertexId, DVec3)>,
    pub(super) center: DVec3,
    pub(super) inner_radius: f64,
    pub(super) reach: f64,
    pub(super) thickness_max: f64,
}

impl FeatureGraph {
    /// Lists the features of `hull`. O(n).
    ///
    /// # Errors
    ///
    /// [`GraphError::Empty`] where the hull has no points.
    pub fn new(hull: &ConvexHull) -> Result<Self, GraphError> {
        if hull.kind() == HullKind::Empty {
            return Err(GraphError::Empty);
        }
        let mut half_edges = Vec::new();
        let mut facets = Vec::new();
        for facet in hull.facets() {
            let first = half_edges.len() as u32;
            for (i, &from) in facet.corners.iter().enumerate() {
                let to = facet.corners[(i + 1) % facet.corners.len()];
                let id = facets.len() as u32;
                half_edges.push(half_edge(hull, [from, to], OptionalIndex::some(id), facet.normal));
            }
            let row = [first, half_edges.len() as u32];
            let (normal, offset, thickness) = (facet.normal, facet.offset, facet.thickness);
            facets.push(FacetPlane { normal, offset, thickness, depth: 0.0, row });
        }
        if hull.kind() == HullKind::Segment {
            let ends = [HullVertexId(0), HullVertexId(1)];
            half_edges.push(half_edge(hull, ends, OptionalIndex::NONE, DVec3::ZERO));
            half_edges.push(half_edge(hull, [ends[1], ends[0]], OptionalIndex::NONE, DVec3::ZERO));
        }
        pair_up(&mut half_edges);
        let origins: Vec<u32> = half_edges.iter().map(|h| h.ends[0].0).collect();
        let (fan_starts, fans) = rows(&origins, hull.vertex_count());
        let mut graph = Self {
            half_edges,
            facets,
            fan_starts,
            fans,
            rim_starts: vec![0],
            rim: Vec::new(),
            center: mean(hull.positions()),
            inner_radius: 0.0,
            reach: hull.positions().iter().fold(0.0f64, |most, p| most.max(p.length())).next_up(),
            thickness_max: hull.thickness_max(),
        };
        for v in (0..hull.vertex_count() as u32).map(HullVertexId) {
            graph.rim.extend(hull.neighbours(v).iter().map(|&w| (w, hull.position(w))));
            graph.rim_starts.push(graph.rim.len() as u32);
        }
        graph.measure_depths(hull.kind());
        Ok(graph)
    }

    /// Every exact boundary point over a facet lies at most the thickness below its plane, so the
    /// least depth less thickness is the radius of a ball in the exact hull about the centre.
    fn measure_depths(&mut self, kind: HullKind) {
        let rounding = 8.0 * f64::EPSILON * self.reach;
        let mut radius = f64::INFINITY;
        for facet in &mut self.facets {
            facet.depth = facet.offset - facet.normal.dot(self.center);
            radius = radius.min(facet.depth - facet.thickness - rounding);
        }
        if kind == HullKind::Volume {
            self.inner_radius = radius.max(0.0);
        }
    }

    /// The two ends of an edge.
    ///
    /// # Panics
    ///
    /// Where the id is not of this graph.
    #[must_use]
    pub fn edge_ends(&self, edge: HullEdgeId) -> [HullVertexId; 2] {
        self.half_edges[edge.index()].ends
    }

    /// The facets to the left and to the right of an edge; `None` for that of a segment.
    ///
    /// # Panics
    ///
    /// Where the id is not of this graph.
    #[must_use]
    pub fn edge_facets(&self, edge: HullEdgeId) -> Option<[FacetId; 2]> {
        let [h, twin] = self.both_halves(edge);
        Some([h.facet()?, twin.facet()?])
    }

    /// Heap bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.half_edges.as_slice())
            + size_of_val(self.facets.as_slice())
            + size_of_val(self.rim.as_slice())
            + size_of_val(self.fan_starts.as_slice())
            + size_of_val(self.fans.as_slice())
            + size_of_val(self.rim_starts.as_slice())
    }

    /// Every feature: vertices, then edges, then facets, by id. Vertices that the merged layer
    /// leaves out are among them.
    pub fn features(&self) -> impl Iterator<Item = HullFeature> {
        let vertices = 0..self.fan_starts.len() as u32 - 1;
        let edges = (0..self.half_edges.len() as u32).filter(|&h| self.edge_of(h).0 == h);
        vertices
            .map(|v| HullFeature::Vertex(HullVertexId(v)))
            .chain(edges.map(|h| HullFeature::Edge(HullEdgeId(h))))
            .chain((0..self.facets.len() as u32).map(|f| HullFeature::Facet(FacetId(f))))
    }

    pub(super) fn both_halves(&self, edge: HullEdgeId) -> [&HalfEdge; 2] {
        let h = &self.half_edges[edge.index()];
        [h, &self.half_edges[h.twin as usize]]
    }

    /// The edge that a half-edge is half of.
    pub(super) fn edge_of(&self, half_edge: u32) -> HullEdgeId {
        HullEdgeId(half_edge.min(self.half_edges[half_edge as usize].twin))
    }

    /// Half-edges around a facet, counter-clockwise, with their ids.
    pub(super) fn around(&self, facet: FacetId) -> impl Iterator<Item = (u32, &HalfEdge)> {
        let [from, to] = self.facets[facet.index()].row;
        (from..to).zip(&self.half_edges[from as usize..to as usize])
    }

    /// Half-edges that leave a vertex in the merged layer, with their ids. None at a vertex that
    /// the merged layer leaves out, or of a point.
    pub(super) fn fan(&self, vertex: HullVertexId) -> impl Iterator<Item = (u32, &HalfEdge)> {
        self.fans[row(&self.fan_starts, vertex.index())]
            .iter()
            .map(|&h| (h, &self.half_edges[h as usize]))
    }

    /// Neighbours on the exact hull, and where they are.
    pub(super) fn rim(&self, vertex: HullVertexId) -> &[(HullVertexId, DVec3)] {
        &self.rim[row(&self.rim_starts, vertex.index())]
    }

    /// Whether a feature is one of this hull: what a caller hands in as last frame's may be stale.
    pub(super) fn has(&self, feature: HullFeature) -> bool {
        match feature {
            HullFeature::Vertex(v) => v.index() + 1 < self.fan_starts.len(),
            HullFeature::Edge(e) => {
                self.half_edges.get(e.index()).is_some_and(|half_edge| e.0 <= half_edge.twin)
            }
            HullFeature::Facet(f) => f.index() < self.facets.len(),
        }
    }

    /// The exact triangles, a segment and a point being degenerate ones.
    pub(super) fn triangles(
        hull: &ConvexHull,
    ) -> impl Iterator<Item = ([HullVertexId; 3], Option<FacetId>)> {
        let thin = match hull.kind() {
            HullKind::Point => Some([0, 0, 0].map(HullVertexId)),
            HullKind::Segment => Some([0, 1, 1].map(HullVertexId)),
            _ => None,
        };
        let whole =
            (0..hull.triangle_count()).map(|t| (hull.triangle(t), Some(hull.facet_of_triangle(t))));
        thin.map(|corners| (corners, None)).into_iter().chain(whole)
    }

    /// Every invariant that is violated, in words. Empty for every graph that [`new`](Self::new)
    /// returns for `hull`. O(n): for tests and fuzzers.
    #[must_use]
    pub fn validate(&self, hull: &ConvexHull) -> Vec<String> {
        let mut found = Vec::new();
        for (id, h) in self.half_edges.iter().enumerate() {
            let twin = &self.half_edges[h.twin as usize];
            if twin.twin as usize != id || twin.ends != [h.ends[1], h.ends[0]] {
                found.push(format!("half-edge {id} and its twin do not run the same edge"));
            }
            if h.from != hull.position(h.ends[0]) || h.along != hull.position(h.ends[1]) - h.from {
                found.push(format!("half-edge {id} is not where its ends are"));
            }
            if !self.fan(h.ends[0]).any(|(other, _)| other as usize == id) {
                found.push(format!("half-edge {id} is missing from the fan of its origin"));
            }
        }
        for (facet, plane) in self.facets.iter().enumerate() {
            let mut row = self.around(FacetId(facet as u32));
            if !row.all(|(_, h)| h.facet() == Some(FacetId(facet as u32))) {
                found.push(format!("facet {facet} has half-edges of another"));
            }
            if hull.kind() == HullKind::Volume && plane.depth <= 0.0 && self.inner_radius > 0.0 {
                found.push(format!("facet {facet} does not have the centre below it"));
            }
        }
        if hull.positions().iter().any(|p| p.distance(self.center) < self.inner_radius) {
            found.push("a vertex lies within the inner ball".into());
        }
        found
    }
}

fn half_edge(
    hull: &ConvexHull,
    ends: [HullVertexId; 2],
    facet: OptionalIndex,
    normal: DVec3,
) -> HalfEdge {
    let from = hull.position(ends[0]);
    let along = hull.position(ends[1]) - from;
    let is_exact = hull.neighbours(ends[0]).binary_search(&ends[1]).is_ok();
    // Scaled first, so that lengths near the limits of the domain keep their digits.
    let outward = (along / along.abs().max_element()).cross(normal).normalize_or_zero();
    HalfEdge { ends, twin: 0, facet, from, along, is_exact, outward }
}

/// Finds the twins: sorted by their ends, lower end first, the two halves of an edge are adjacent.
/// (A plate's outline has each edge twice as well, so the two halves are always exactly two.)
fn pair_up(half_edges: &mut [HalfEdge]) {
    let mut order: Vec<u32> = (0..half_edges.len() as u32).collect();
    let key = |h: u32| {
        let [a, b] = half_edges[h as usize].ends;
        (a.min(b), a.max(b), h)
    };
    order.sort_unstable_by_key(|&h| key(h));
    for pair in order.chunks_exact(2) {
        half_edges[pair[0] as usize].twin = pair[1];
        half_edges[pair[1] as usize].twin = pair[0];
    }
}

/// The mean of some points, summed by halves: rounding grows with the logarithm of their number,
/// below 32 units in the last place for 2^29 points.
fn mean(points: &[DVec3]) -> DVec3 {
    fn sum(points: &[DVec3]) -> DVec3 {
        match points {
            [] => DVec3::ZERO,
            [p] => *p,
            _ => {
                let (low, high) = points.split_at(points.len() / 2);
                sum(low) + sum(high)
            }
        }
    }
    sum(points) / points.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> ConvexHull {
        let corner = |i: i32| {
            DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) * 2.0 - 1.0
        };
        ConvexHull::of_points(&(0..8).map(corner).collect::<Vec<_>>())
    }

    #[test]
    fn a_cube_has_six_facets_twelve_edges_and_an_inner_ball() {
        let hull = cube();
        let graph = FeatureGraph::new(&hull).unwrap();
        assert_eq!((graph.facets.len(), graph.half_edges.len()), (6, 24));
        assert_eq!(graph.center, DVec3::ZERO);
        assert!(graph.inner_radius <= 1.0 && graph.inner_radius > 1.0 - 1e-12);
        assert!((0..8).all(|v| graph.fan(HullVertexId(v)).count() == 3));
        assert_eq!(graph.validate(&hull), [""; 0]);
        for (_, h) in graph.around(FacetId(0)) {
            let middle = h.from + 0.5 * h.along;
            assert_eq!(h.outward.dot(middle), 1.0, "outward points out of the facet");
        }
    }

    #[test]
    fn thin_hulls_have_graphs_and_empty_ones_an_error() {
        let of = |points: &[DVec3]| {
            let hull = ConvexHull::of_points(points);
            FeatureGraph::new(&hull).inspect(|graph| assert_eq!(graph.validate(&hull), [""; 0]))
        };
        assert_eq!(of(&[]), Err(GraphError::Empty));
        assert_eq!(of(&[DVec3::X]).unwrap().half_edges, []);
        let segment = of(&[DVec3::X, DVec3::Y]).unwrap();
        assert_eq!(segment.edge_facets(HullEdgeId(0)), None);
        let plate = of(&[DVec3::ZERO, DVec3::X, DVec3::Y]).unwrap();
        assert_eq!((plate.facets.len(), plate.half_edges.len()), (2, 6));
        assert_eq!(plate.inner_radius, 0.0);
        assert!(plate.edge_facets(HullEdgeId(0)).is_some());
    }

    #[test]
    fn features_of_another_hull_are_told() {
        let graph = FeatureGraph::new(&cube()).unwrap();
        assert!(graph.has(HullFeature::Vertex(HullVertexId(7))));
        assert!(!graph.has(HullFeature::Vertex(HullVertexId(8))));
        assert!(graph.has(HullFeature::Edge(graph.edge_of(23))));
        assert!(!graph.has(HullFeature::Edge(HullEdgeId(24))));
        assert!(!graph.has(HullFeature::Facet(FacetId(6))));
    }
}
