//! Convex hulls, in two layers.
//!
//! 1. **The exact hull**: a triangulated surface, decided by exact signs alone. Its vertices are
//!    exactly the extreme points of the input, every edge is convex or flat, every input point lies
//!    inside or on it.
//! 2. **The facets**: nearly coplanar triangles merged into polygons, each with a supporting plane
//!    that all points lie below (rounded outward) and the thickness that its own vertices have
//!    below that plane. Exact merging alone is not enough: turned and rounded, the side of a
//!    subdivided cube is a shallow dome of dozens of exactly planar pieces.
//!
//! Points, segments and polygons are results, not errors: see [`HullKind`].
//!
//! The hull is quickhull's (Barber, Dobkin and Huhdanpaa 1996, "The quickhull algorithm for convex
//! hulls") on exact signs; other sources stand with the parts, costs with the functions.
//!
//! ```
//! use cranny_exact::DVec3;
//! use cranny_geometry::hull::{ConvexHull, HullKind, Location};
//! let corners: Vec<DVec3> = (0..8)
//!     .map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)))
//!     .collect();
//! let hull = ConvexHull::of_points(&corners);
//! assert_eq!(hull.kind(), HullKind::Volume);
//! assert_eq!((hull.triangle_count(), hull.facet_count()), (12, 6));
//! assert_eq!(hull.volume(), 1.0);
//! assert_eq!(hull.locate(DVec3::splat(0.5)), Location::Inside);
//! let top = hull.support(DVec3::new(1.0, 2.0, 3.0), None).unwrap();
//! assert_eq!(hull.position(top), DVec3::ONE);
//! ```

mod canonical;
mod codec;
mod convexity;
mod facet_order;
mod facets;
mod facets_update;
mod fan;
mod flat;
mod kind;
mod locate;
mod measures;
mod numbering;
mod outline;
mod quickhull;
mod repair;
mod shapes;
mod side;
mod sieve;
mod span;
mod support;
mod twofold;
mod update;
mod validate;

use cranny_exact::{Aabb, DVec3, DomainError, check_point, is_in_domain};
use thiserror::Error;

use crate::ids::{HalfEdgeId, VertexId};
use crate::on_demand::OnDemand;
use crate::typed_index;
pub use canonical::lowest_first;
pub use facet_order::FacetOrder;
use facets::FacetLayer;
pub use facets::{FLATNESS, Facet, FacetId};
pub use kind::HullKind;
pub use locate::Location;
use quickhull::{HullSurface, previous};
use span::Span;
use support::SupportGraph;
pub use update::FacetChange;
pub(crate) use update::Followed;
pub use validate::HullViolation;

typed_index! {
    /// A vertex of a hull, numbered from 0 in the order of the input points: an index into
    /// [`ConvexHull::positions`].
    HullVertexId
}

/// Points of which no hull can be built.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HullError {
    /// A coordinate outside the domain.
    #[error("point {point}: {source}")]
    Coordinate {
        /// Index of the offending point.
        point: usize,
        /// What is wrong with it.
        source: DomainError,
    },
    /// More points than indices.
    #[error("{count} points were given; a hull takes at most {limit}: split or thin the point set")]
    TooMany {
        /// How many there are.
        count: usize,
        /// How many are accepted.
        limit: usize,
    },
}

/// The most points that a hull takes: half-edges are numbered by `u32`, six a vertex.
pub const MAX_POINTS: usize = 1 << 29;

/// The convex hull of a point set. Owns copies of its vertices; needs the input no more.
#[derive(Clone, Debug)]
pub struct ConvexHull {
    kind: HullKind,
    sources: Vec<VertexId>,
    positions: Vec<DVec3>,
    surface: HullSurface,
    /// Made of positions and surface: `graph()`.
    graph: OnDemand<SupportGraph>,
    /// A half-edge that starts at each vertex; made of the surface when it is first needed.
    leaving: Leaving,
    /// Made of positions.
    bounds: OnDemand<Aabb>,
    facets: FacetLayer,
    excluded: Vec<VertexId>,
}

/// A half-edge for each vertex that starts there, whichever.
#[derive(Clone, Default)]
struct Leaving(OnDemand<Vec<u32>>);

/// Which half-edges these are means nothing, so it is not shown.
impl std::fmt::Debug for Leaving {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str("Leaving")
    }
}

/// The graph follows from the rest.
impl PartialEq for ConvexHull {
    fn eq(&self, other: &Self) -> bool {
        let Self { kind, sources, positions, surface, facets, excluded, .. } = self;
        *kind == other.kind
            && *sources == other.sources
            && *positions == other.positions
            && *surface == other.surface
            && *facets == other.facets
            && *excluded == other.excluded
    }
}

impl ConvexHull {
    /// The hull, its facets merged by [`FLATNESS`].
    ///
    /// The points should be vertices of a [`Mesh`](crate::Mesh), which have been checked. A point
    /// outside the [`domain`](cranny_exact::domain), or beyond the first [`MAX_POINTS`], takes no
    /// part and is listed by [`excluded`](Self::excluded); [`checked`](Self::checked) refuses it
    /// instead.
    ///
    /// Of points in the same place the lowest index is meant. The answer depends on the points and
    /// their order only. O(n log n) on the clouds measured, as is usual for quickhull; never
    /// panics.
    #[must_use]
    pub fn of_points(points: &[DVec3]) -> Self {
        Self::with_flatness(points, FLATNESS)
    }

    /// The hull of points that may come from anywhere.
    ///
    /// # Errors
    ///
    /// The first point outside the domain, or more than [`MAX_POINTS`] points.
    pub fn checked(points: &[DVec3]) -> Result<Self, HullError> {
        if points.len() > MAX_POINTS {
            return Err(HullError::TooMany { count: points.len(), limit: MAX_POINTS });
        }
        for (point, &p) in points.iter().enumerate() {
            check_point(p).map_err(|source| HullError::Coordinate { point, source })?;
        }
        Ok(Self::of_points(points))
    }

    /// As [`of_points`](Self::of_points), with facets up to `flatness` times the largest coordinate
    /// magnitude thick (at least 0; `NaN` counts as 0). Meshes stored in single precision want
    /// about `2e-7`: their rounding is that much coarser.
    #[must_use]
    pub fn with_flatness(points: &[DVec3], flatness: f64) -> Self {
        let are_inside = || points.iter().fold(true, |all, &p| all & is_in_domain(p));
        if points.len() <= MAX_POINTS && are_inside() {
            return Self::of_accepted(points, flatness);
        }
        let accepted = |i: usize| i < MAX_POINTS && is_in_domain(points[i]);
        let (inside, outside): (Vec<usize>, Vec<usize>) =
            (0..points.len()).partition(|&i| accepted(i));
        let subset: Vec<DVec3> = inside.iter().map(|&i| points[i]).collect();
        let mut hull = Self::of_accepted(&subset, flatness);
        for source in &mut hull.sources {
            *source = VertexId(inside[source.index()] as u32);
        }
        hull.excluded = outside.into_iter().map(|i| VertexId(i as u32)).collect();
        hull
    }

    fn of_accepted(points: &[DVec3], flatness: f64) -> Self {
        let at = |i: u32| points[i as usize];
        let (kind, mut surface, mut vertices) = match span::span_of(points) {
            Span::Empty => (HullKind::Empty, HullSurface::default(), vec![]),
            Span::Point(p) => (HullKind::Point, HullSurface::default(), vec![p]),
            Span::Line(ends) => (HullKind::Segment, HullSurface::default(), ends.to_vec()),
            Span::Plane(triangle) => {
                let outline = span::axis_of_plane(triangle.map(at))
                    .map(|axis| span::planar_hull(points, axis))
                    .unwrap_or_default();
                (HullKind::Polygon, plate(&outline), outline)
            }
            Span::Space(simplex) => {
                let surface = quickhull::exact_hull(points, simplex);
                let mut is_vertex = vec![false; points.len()];
                for &v in surface.triangles.iter().flatten() {
                    is_vertex[v as usize] = true;
                }
                let vertices =
                    (0..points.len() as u32).filter(|&v| is_vertex[v as usize]).collect();
                (HullKind::Volume, surface, vertices)
            }
        };
        vertices.sort_unstable();
        let mut number = vec![0; points.len()];
        for (id, &v) in (0..).zip(&vertices) {
            number[v as usize] = id;
        }
        for corner in surface.triangles.as_flattened_mut() {
            *corner = number[*corner as usize];
        }
        let positions: Vec<DVec3> = vertices.iter().map(|&v| at(v)).collect();
        let graph = SupportGraph::new(&positions, &surface);
        let facets = FacetLayer::new(kind, &positions, &surface, &graph, flatness);
        Self {
            kind,
            sources: vertices.into_iter().map(VertexId).collect(),
            positions,
            surface,
            graph: OnDemand::made(graph),
            leaving: Leaving::default(),
            bounds: OnDemand::default(),
            facets,
            excluded: Vec::new(),
        }
    }

    /// The dimension.
    #[must_use]
    pub fn kind(&self) -> HullKind {
        self.kind
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Where the vertices are, in the frame of the input, by [`HullVertexId`].
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Where a vertex is.
    ///
    /// # Panics
    ///
    /// Where the id is not of this hull.
    #[must_use]
    pub fn position(&self, vertex: HullVertexId) -> DVec3 {
        self.positions[vertex.index()]
    }

    /// The input points that are vertices, ascending, by [`HullVertexId`]: the extreme points.
    #[must_use]
    pub fn sources(&self) -> &[VertexId] {
        &self.sources
    }

    /// The input point of a vertex.
    ///
    /// # Panics
    ///
    /// Where the id is not of this hull.
    #[must_use]
    pub fn source(&self, vertex: HullVertexId) -> VertexId {
        self.sources[vertex.index()]
    }

    /// The vertex that an input point is, if it is extreme and the first of its place.
    #[must_use]
    pub fn vertex_of_source(&self, point: VertexId) -> Option<HullVertexId> {
        self.sources.binary_search(&point).ok().map(|i| HullVertexId(i as u32))
    }

    /// Number of triangles of the exact hull.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.surface.triangles.len()
    }

    /// Corners of a triangle (`0..triangle_count`), counter-clockwise seen from outside.
    ///
    /// # Panics
    ///
    /// Where there is no such triangle.
    #[must_use]
    pub fn triangle(&self, triangle: usize) -> [HullVertexId; 3] {
        self.surface.triangles[triangle].map(HullVertexId)
    }

    /// Where the corners of a triangle are.
    ///
    /// # Panics
    ///
    /// Where there is no such triangle.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.surface.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// All triangles as indices into the input points.
    pub fn source_triangles(&self) -> impl ExactSizeIterator<Item = [VertexId; 3]> + '_ {
        self.surface.triangles.iter().map(|t| t.map(|v| self.sources[v as usize]))
    }

    /// The half-edge that runs along the same edge the other way. Half-edges are numbered
    /// `3 * triangle + corner` within the hull.
    ///
    /// # Panics
    ///
    /// Where there is no such half-edge.
    #[must_use]
    pub fn twin(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(self.surface.twins[half_edge.index()])
    }

    /// Vertices that share an edge of a triangle with this one, ascending.
    ///
    /// # Panics
    ///
    /// Where the id is not of this hull.
    #[must_use]
    pub fn neighbours(&self, vertex: HullVertexId) -> &[HullVertexId] {
        self.graph().neighbours(vertex)
    }

    /// Number of merged facets.
    #[must_use]
    pub fn facet_count(&self) -> usize {
        self.facets.len()
    }

    /// A merged facet (`0..facet_count`).
    ///
    /// # Panics
    ///
    /// Where there is no such facet.
    #[must_use]
    pub fn facet(&self, facet: FacetId) -> Facet<'_> {
        self.facets.facet(facet)
    }

    /// All merged facets, by id.
    pub fn facets(&self) -> impl ExactSizeIterator<Item = Facet<'_>> {
        (0..self.facet_count() as u32).map(|f| self.facet(FacetId(f)))
    }

    /// The facet that a triangle was merged into.
    ///
    /// # Panics
    ///
    /// Where there is no such triangle.
    #[must_use]
    pub fn facet_of_triangle(&self, triangle: usize) -> FacetId {
        self.facets.of_triangle(triangle)
    }

    /// The greatest thickness of a facet; 0 without facets.
    #[must_use]
    pub fn thickness_max(&self) -> f64 {
        self.facets().fold(0.0, |most, facet| most.max(facet.thickness))
    }

    /// How deep below its plane a vertex of a facet could be and still be merged into it: the
    /// flatness given times the largest coordinate magnitude.
    #[must_use]
    pub fn flatness(&self) -> f64 {
        self.facets.tolerance
    }

    /// The box of the hull (exact).
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        *self.bounds.get(|| Aabb::of_points(self.positions.iter().copied()))
    }

    /// Input points that took no part, being outside the domain.
    #[must_use]
    pub fn excluded(&self) -> &[VertexId] {
        &self.excluded
    }

    /// The vertex that lies farthest in a direction: the one whose `direction.dot(position)`,
    /// computed in `f64`, is greatest among all vertices, and of several such the one of lowest id.
    /// `None` for an empty hull.
    ///
    /// Steepest ascent over the edges, from `start` (last frame's answer, say) or from the extreme
    /// vertex of the dominant axis. The start has no influence on the answer, only on the time. The
    /// direction's length does not matter, but it must be finite and no component's magnitude above
    /// 1e250; otherwise some vertex is returned.
    ///
    /// # Panics
    ///
    /// Where `start` is not of this hull.
    #[must_use]
    pub fn support(&self, direction: DVec3, start: Option<HullVertexId>) -> Option<HullVertexId> {
        self.graph().support(&self.positions, direction, start)
    }

    /// The graph over the vertices. A hull that was read makes it at the first call, in linear
    /// time.
    fn graph(&self) -> &SupportGraph {
        self.graph.get(|| SupportGraph::new(&self.positions, &self.surface))
    }

    /// The triangle with these corners, in this order but from any of them on, if there is one.
    /// Looks at the triangles around the corner that has the fewest.
    pub fn triangle_of(&self, corners: [VertexId; 3]) -> Option<usize> {
        let [a, b, c] = corners.map(|v| self.vertex_of_source(v).map(|v| v.0));
        let (a, b, c) = (a?, b?, c?);
        let leaving = self.leaving.0.get(|| self.surface.leaving(self.positions.len()));
        // Side by side, so that the one with the fewest ends it.
        let around = |v: u32| self.surface.spokes(leaving[v as usize]);
        let at_once = around(a).zip(around(b)).zip(around(c));
        let found = |h: u32, second: u32, third: u32| {
            (self.surface.ends(h)[1] == second && self.surface.origin(previous(h)) == third)
                .then_some(h as usize / 3)
        };
        at_once
            .into_iter()
            .find_map(|((p, q), r)| found(p, b, c).or(found(q, c, a)).or(found(r, a, b)))
    }

    /// The triangles around a vertex.
    pub fn triangles_at(&self, vertex: HullVertexId) -> impl Iterator<Item = usize> + '_ {
        let leaving = self.leaving.0.get(|| self.surface.leaving(self.positions.len()));
        self.surface.spokes(leaving[vertex.index()]).map(|h| h as usize / 3)
    }

    /// Makes what a hull that was read makes late.
    pub(crate) fn prepare_all(&self) {
        self.graph();
        self.leaving.0.get(|| self.surface.leaving(self.positions.len()));
        let _ = self.bounds();
    }
}

/// The two-sided plate over a planar outline (at least three corners, counter-clockwise in front):
/// triangles `0..k` in front, then the same turned over, each `[0, i + 1, i + 2]` of the outline.
fn plate(outline: &[u32]) -> HullSurface {
    let n = outline.len() as u32;
    let k = n.saturating_sub(2);
    let mut surface = HullSurface::default();
    for i in 0..k {
        surface.triangles.push([0, i + 1, i + 2].map(|c| outline[c as usize]));
        let (front, back) = (3 * i, 3 * (k + i));
        surface.twins.extend([
            if i == 0 { back + 2 } else { front - 1 },
            back + 1,
            if i + 1 == k { back } else { front + 3 },
        ]);
    }
    for i in 0..k {
        // Half-edges: 0 to i + 2, i + 2 to i + 1, i + 1 to 0.
        surface.triangles.push([0, i + 2, i + 1].map(|c| outline[c as usize]));
        let (front, back) = (3 * i, 3 * (k + i));
        surface.twins.extend([
            if i + 1 == k { front + 2 } else { back + 5 },
            front + 1,
            if i == 0 { front } else { back - 3 },
        ]);
    }
    surface
}
