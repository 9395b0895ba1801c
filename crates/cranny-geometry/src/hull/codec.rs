//! Hulls as bytes: the surface and the facets; positions, neighbours and rows are made again.

use cranny_exact::DVec3;

use super::convexity::is_convex;
use super::facets::{FacetLayer, Plane};
use super::outline::Outlines;
use super::quickhull::Surface;
use super::support::SupportGraph;
use super::{ConvexHull, FacetId, HullKind, HullVertexId};
use crate::codec::{
    Coded, Flaw, Reader, Writer, check, check_below, check_rows, coded, is_flatness, is_size,
    is_unit, plain_struct,
};
use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::rows::rows;

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
        check_twins(&surface)?;
        check(is_convex(kind, &positions, &surface), "it is not convex")?;
        let graph = SupportGraph::new(&positions, &surface);
        let facets = FacetLayer::decode(input, positions.len(), surface.triangles.len())?;
        let excluded: Vec<VertexId> = input.list()?;
        check_below(excluded.iter().map(|v| v.0), mesh.vertices().len(), "a point is not there")?;
        check(excluded.is_sorted_by(|a, b| a < b), "points are not ascending")?;
        Ok(Self { kind, sources, positions, surface, graph, facets, excluded })
    }
}

/// Every half-edge's twin runs the other way, and every triangle has three corners.
fn check_twins(surface: &Surface) -> Result<(), Flaw> {
    let twins = &surface.twins;
    check(twins.len() == 3 * surface.triangles.len(), "half-edges lack twins")?;
    check_below(twins.iter().copied(), twins.len(), "a twin is not there")?;
    let mut do_match = true;
    for (first, &[a, b, c]) in (0u32..).step_by(3).zip(&surface.triangles) {
        for (h, ends) in (first..).zip([[a, b], [b, c], [c, a]]) {
            let twin = twins[h as usize];
            do_match &= ends[0] != ends[1]
                && twins[twin as usize] == h
                && surface.ends(twin) == [ends[1], ends[0]];
        }
    }
    check(do_match, "half-edges and twins do not match")
}

impl FacetLayer {
    fn encode(&self, out: &mut Writer) {
        let Self { tolerance, planes, facet_of, triangle_starts: _, triangles: _, outlines } = self;
        let Outlines { starts, corners, neighbours } = outlines;
        out.one(*tolerance);
        out.list(planes);
        out.list(facet_of);
        out.list(starts);
        out.list(corners);
        out.list(neighbours);
    }

    fn decode(input: &mut Reader, vertices: usize, triangles: usize) -> Result<Self, Flaw> {
        let tolerance: f64 = input.one()?;
        let (planes, facet_of): (Vec<Plane>, Vec<u32>) = (input.list()?, input.list()?);
        let (starts, corners): (Vec<u32>, Vec<HullVertexId>) = (input.list()?, input.list()?);
        let outlines = Outlines { starts, corners, neighbours: input.list()? };
        let count = planes.len();
        check(is_flatness(tolerance), "the flatness is no number")?;
        check(planes.iter().all(Plane::is_sound), "a facet has no plane")?;
        check(facet_of.len() == triangles, "a facet for each triangle is needed")?;
        check_below(facet_of.iter().copied(), count, "a facet is not there")?;
        let (triangle_starts, triangles) = rows(&facet_of, count);
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
