//! The invariants of a hull, as something to run.

use cranny_exact::{DVec3, Sign};

use super::flat::{Flat, edge_sign};
use super::{ConvexHull, FacetId, HullKind, HullVertexId, Location};
use crate::ids::{HalfEdgeId, VertexId};
use crate::projection::collinear;

/// An invariant that does not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum HullViolation {
    /// The numbers of vertices, triangles and facets are impossible for the kind.
    WrongCounts {
        /// Kind of the hull.
        kind: HullKind,
        /// Number of vertices.
        vertices: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// A half-edge and its twin do not run the same edge in opposite directions.
    TwinMismatch(HalfEdgeId),
    /// Vertices − edges + triangles is not 2.
    EulerOfTriangles(i64),
    /// Vertices − edges + facets of the merged layer is not 2.
    EulerOfFacets(i64),
    /// A triangle without area.
    DegenerateTriangle(u32),
    /// An edge that bends inwards.
    ReflexEdge(HalfEdgeId),
    /// A vertex that is not where its input point is.
    WrongSource(HullVertexId),
    /// A vertex that lies inside a facet or an edge.
    NotExtreme(HullVertexId),
    /// An input point outside the hull.
    PointOutside(VertexId),
    /// The support query outward through a vertex and from it does not find the highest vertex.
    SupportMissed(HullVertexId),
    /// A facet's outline has fewer than three corners, a corner twice, or an edge that the
    /// neighbour named for it does not have the other way round.
    BadOutline(FacetId),
    /// A facet's normal is not of length 1.
    BadNormal(FacetId),
    /// A vertex is not shown to lie below a facet's plane.
    AbovePlane(FacetId, HullVertexId),
    /// A vertex of a facet is not shown to lie within its thickness.
    BeyondThickness(FacetId, HullVertexId),
}

impl ConvexHull {
    /// Every invariant that is violated, `points` being the input. Exact where the invariant is.
    /// Empty for every hull that [`of_points`](Self::of_points) returns. O(points x triangles): for
    /// tests and fuzzers.
    #[must_use]
    pub fn validate(&self, points: &[DVec3]) -> Vec<HullViolation> {
        let mut found = Vec::new();
        self.validate_counts(&mut found);
        if found.is_empty() && self.validate_surface(&mut found) {
            self.validate_vertices(points, &mut found);
            self.validate_facets(&mut found);
        }
        found
    }

    fn validate_counts(&self, found: &mut Vec<HullViolation>) {
        let (vertices, triangles) = (self.vertex_count(), self.triangle_count());
        if !self.kind.allows(vertices, triangles) || self.surface.twins.len() != 3 * triangles {
            found.push(HullViolation::WrongCounts { kind: self.kind, vertices, triangles });
        }
    }

    /// Topology first; whether the rest may rely on it.
    fn validate_surface(&self, found: &mut Vec<HullViolation>) -> bool {
        let surface = &self.surface;
        for h in 0..surface.twins.len() as u32 {
            let twin = surface.twins[h as usize];
            let matches = (twin as usize) < surface.twins.len()
                && surface.twins[twin as usize] == h
                && twin != h
                && surface.ends(h) == [surface.ends(twin)[1], surface.ends(twin)[0]];
            if !matches {
                found.push(HullViolation::TwinMismatch(HalfEdgeId(h)));
            }
        }
        if !found.is_empty() {
            return false;
        }
        let (v, e, f) = (self.vertex_count(), surface.twins.len() / 2, self.triangle_count());
        let euler = v as i64 - e as i64 + f as i64;
        if f > 0 && euler != 2 {
            found.push(HullViolation::EulerOfTriangles(euler));
        }
        for (t, corners) in surface.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| self.positions[v as usize]);
            if collinear(a, b, c) {
                found.push(HullViolation::DegenerateTriangle(t as u32));
            }
        }
        for h in 0..surface.twins.len() as u32 {
            if edge_sign(&self.positions, surface, h) == Sign::Positive {
                found.push(HullViolation::ReflexEdge(HalfEdgeId(h)));
            }
        }
        found.is_empty()
    }

    fn validate_vertices(&self, points: &[DVec3], found: &mut Vec<HullViolation>) {
        for v in (0..self.vertex_count() as u32).map(HullVertexId) {
            if points.get(self.source(v).index()) != Some(&self.position(v)) {
                found.push(HullViolation::WrongSource(v));
            }
            let outward = self.position(v) - self.centroid().unwrap_or_default();
            let top = self.support(outward, Some(v));
            let highest = self.positions.iter().map(|&p| outward.dot(p)).fold(f64::MIN, f64::max);
            let first = self.positions.iter().position(|&p| outward.dot(p) == highest);
            if top.map(HullVertexId::index) != first {
                found.push(HullViolation::SupportMissed(v));
            }
        }
        found.extend(self.vertices_not_extreme().into_iter().map(HullViolation::NotExtreme));
        for (i, &p) in points.iter().enumerate() {
            let source = VertexId(i as u32);
            if self.excluded.binary_search(&source).is_err() && self.locate(p) == Location::Outside
            {
                found.push(HullViolation::PointOutside(source));
            }
        }
    }

    /// At an extreme point of a solid at least three edges are strictly convex; at one of a plate
    /// the outline turns.
    fn vertices_not_extreme(&self) -> Vec<HullVertexId> {
        match self.kind {
            HullKind::Volume => {
                let sign = |h| edge_sign(&self.positions, &self.surface, h);
                let flat = Flat::of(self.vertex_count(), &self.surface, |_| false, sign);
                flat.vertices.into_iter().map(HullVertexId).collect()
            }
            HullKind::Polygon => {
                let outline = self.plate_outline();
                let at = |k: usize| self.positions[outline[k % outline.len()] as usize];
                (0..outline.len())
                    .filter(|&k| collinear(at(k), at(k + 1), at(k + 2)))
                    .map(|k| HullVertexId(outline[(k + 1) % outline.len()]))
                    .collect()
            }
            HullKind::Empty | HullKind::Point | HullKind::Segment => Vec::new(),
        }
    }

    /// The exact outline of a plate, read from the fan in front.
    fn plate_outline(&self) -> Vec<u32> {
        let front = &self.surface.triangles[..self.triangle_count() / 2];
        front[0][..2].iter().copied().chain(front.iter().map(|t| t[2])).collect()
    }

    fn validate_facets(&self, found: &mut Vec<HullViolation>) {
        let mut is_corner = vec![false; self.vertex_count()];
        let mut edges = 0;
        for id in (0..self.facet_count() as u32).map(FacetId) {
            let facet = self.facet(id);
            edges += facet.corners.len();
            facet.corners.iter().for_each(|v| is_corner[v.index()] = true);
            self.validate_outline(id, found);
            self.validate_plane(id, found);
        }
        let corners = is_corner.into_iter().filter(|&is| is).count();
        let euler = corners as i64 - (edges / 2) as i64 + self.facet_count() as i64;
        if self.facet_count() > 0 && euler != 2 {
            found.push(HullViolation::EulerOfFacets(euler));
        }
    }

    fn validate_outline(&self, id: FacetId, found: &mut Vec<HullViolation>) {
        let facet = self.facet(id);
        let n = facet.corners.len();
        let mut distinct = facet.corners.to_vec();
        distinct.sort_unstable();
        distinct.dedup();
        let shared = |i: usize| {
            let (from, to) = (facet.corners[i], facet.corners[(i + 1) % n]);
            facet.neighbours[i] != id && {
                let other = self.facet(facet.neighbours[i]);
                let m = other.corners.len();
                (0..m).any(|k| {
                    other.corners[k] == to
                        && other.corners[(k + 1) % m] == from
                        && other.neighbours[k] == id
                })
            }
        };
        if n < 3 || distinct.len() != n || !(0..n).all(shared) {
            found.push(HullViolation::BadOutline(id));
        }
    }

    fn validate_plane(&self, id: FacetId, found: &mut Vec<HullViolation>) {
        let facet = self.facet(id);
        if (facet.normal.length() - 1.0).abs() > 4.0 * f64::EPSILON {
            found.push(HullViolation::BadNormal(id));
        }
        let rounding = self.graph().rounding(facet.normal);
        let height = |v: u32| facet.normal.dot(self.positions[v as usize]);
        for v in 0..self.vertex_count() as u32 {
            if height(v) + rounding > facet.offset {
                found.push(HullViolation::AbovePlane(id, HullVertexId(v)));
            }
        }
        for &t in facet.triangles {
            for v in self.surface.triangles[t as usize] {
                if height(v) - rounding < facet.offset - facet.thickness {
                    found.push(HullViolation::BeyondThickness(id, HullVertexId(v)));
                }
            }
        }
    }
}
