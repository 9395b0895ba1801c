//! Hulls as bytes: the surface, its half-edges in order, and the facets; positions, neighbours and rows are
//! made again.

use cranny_exact::DVec3;

use super::convexity::is_convex;
use super::facets::{FacetLayer, Plane};
use super::outline::Outlines;
use super::quickhull::{Surface, Wedge};
use super::support::SupportGraph;
use super::{ConvexHull, FacetId, HullKind, HullVertexId};
use crate::codec::{
    Coded, Flaw, Reader, Writer, check, check_below, check_rows, coded, is_flatness, is_size,
    is_unit, owners_of_rows, plain_struct,
};
use crate::ids::VertexId;
use crate::mesh::Mesh;

coded!(HullKind {
    Self::Empty => 0 => Self::Empty,
    Self::Point => 1 => Self::Point,
    Self::Segment => 2 => Self::Segment,
    Self::Polygon => 3 => Self::Polygon,
    Self::Volume => 4 => Self::Volume,
});
plain_struct!(HullVertexId(u32));
plain_struct!(FacetId(u32));
plain_struct!(Plane { normal: DVec3, offset: f64, thickness: f64 });

impl ConvexHull {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { kind, sources, positions: _, surface, graph: _, facets, excluded } = self;
        let Surface { triangles, twins } = surface;
        out.one(kind.code());
        out.list(sources);
        out.list(triangles);
        out.list(twins);
        out.list(&sorted_half_edges(surface));
        facets.encode(out);
        out.list(excluded);
    }

    /// Reads the hull of a mesh's vertices. That it is the boundary of a convex body is checked exactly; not
    /// that this holds the other vertices.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let kind: HullKind = input.code()?;
        let sources: Vec<VertexId> = input.list()?;
        let surface = Surface { triangles: input.list()?, twins: input.list()? };
        check_below(sources.iter().map(|v| v.0), mesh.vertices().len(), "a vertex is not there")?;
        check(sources.is_sorted_by(|a, b| a < b), "vertices are not ascending")?;
        let positions: Vec<_> = sources.iter().map(|&v| mesh.position(v)).collect();
        let corners = surface.triangles.as_flattened();
        check_below(corners.iter().copied(), positions.len(), "a corner is not there")?;
        check(kind.allows(positions.len(), surface.triangles.len()), "it has the wrong dimension")?;
        let wedges = surface.wedges();
        check_twins(&surface.twins, &wedges)?;
        check(is_convex(kind, &positions, &surface, &wedges), "it is not convex")?;
        let sorted: Vec<u32> = input.list()?;
        check(sorted.len() == wedges.len(), "it is not one of all half-edges")?;
        check_below(sorted.iter().copied(), wedges.len(), "a half-edge is not there")?;
        let graph = SupportGraph::of_sorted(&positions, &surface, &wedges, &sorted);
        let graph = graph.ok_or("half-edges are not sorted")?;
        let facets = FacetLayer::decode(input, positions.len(), surface.triangles.len())?;
        let excluded: Vec<VertexId> = input.list()?;
        check_below(excluded.iter().map(|v| v.0), mesh.vertices().len(), "a point is not there")?;
        check(excluded.is_sorted_by(|a, b| a < b), "points are not ascending")?;
        Ok(Self { kind, sources, positions, surface, graph, facets, excluded })
    }
}

/// All half-edges by their ends, those with the same ones by number.
fn sorted_half_edges(surface: &Surface) -> Vec<u32> {
    let mut sorted: Vec<u32> = (0..surface.twins.len() as u32).collect();
    sorted.sort_unstable_by_key(|&h| (surface.ends(h), h));
    sorted
}

/// Every half-edge's twin runs the other way, and every triangle has three corners.
fn check_twins(twins: &[u32], wedges: &[Wedge]) -> Result<(), Flaw> {
    check(twins.len() == wedges.len(), "half-edges lack twins")?;
    check_below(twins.iter().copied(), twins.len(), "a twin is not there")?;
    let mut do_match = true;
    for ((h, own), &twin) in (0..).zip(wedges).zip(twins) {
        let other = &wedges[twin as usize];
        do_match &= own.from != own.to
            && twins[twin as usize] == h
            && other.ends() == own.ends().rotate_left(32);
    }
    check(do_match, "half-edges and twins do not match")
}

impl FacetLayer {
    fn encode(&self, out: &mut Writer) {
        let Self { tolerance, planes, facet_of: _, triangle_starts, triangles, outlines } = self;
        let Outlines { starts, corners, neighbours } = outlines;
        out.one(*tolerance);
        out.list(planes);
        out.list(triangle_starts);
        out.list(triangles);
        out.list(starts);
        out.list(corners);
        out.list(neighbours);
    }

    fn decode(input: &mut Reader, vertices: usize, triangle_count: usize) -> Result<Self, Flaw> {
        let tolerance: f64 = input.one()?;
        let planes: Vec<Plane> = input.list()?;
        let (triangle_starts, triangles): (Vec<u32>, Vec<u32>) = (input.list()?, input.list()?);
        let (starts, corners): (Vec<u32>, Vec<HullVertexId>) = (input.list()?, input.list()?);
        let outlines = Outlines { starts, corners, neighbours: input.list()? };
        let count = planes.len();
        check(is_flatness(tolerance), "the flatness is no number")?;
        check(planes.iter().all(Plane::is_sound), "a facet has no plane")?;
        let facet_of = owners_of_rows(&triangle_starts, count, &triangles, triangle_count)?;
        check(triangles.len() == triangle_count, "a facet for each triangle is needed")?;
        check(triangle_starts.is_sorted_by(|a, b| a < b), "a facet has no triangle")?;
        let Outlines { starts, corners, neighbours } = &outlines;
        check_rows(starts, count, corners.len())?;
        check(starts.windows(2).all(|s| s[1] - s[0] >= 3), "an outline has too few corners")?;
        check(neighbours.len() == corners.len(), "a neighbour for each corner is needed")?;
        check_below(corners.iter().map(|v| v.0), vertices, "an outline's corner is not there")?;
        check_below(neighbours.iter().map(|f| f.0), count, "a neighbour is not there")?;
        Ok(Self { tolerance, planes, facet_of, triangle_starts, triangles, outlines })
    }
}

impl Plane {
    fn is_sound(&self) -> bool {
        is_unit(self.normal) && self.offset.is_finite() && is_size(self.thickness)
    }
}
