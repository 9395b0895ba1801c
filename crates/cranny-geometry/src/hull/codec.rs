//! Hulls as bytes: triangles, the half-edges along each edge, and the facets; positions, neighbours and owners
//! are made again.

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
        let Surface { triangles, twins: _ } = surface;
        out.one(kind.code());
        out.list(sources);
        out.list(triangles);
        out.list(&surface.pairs());
        facets.encode(out);
        out.list(excluded);
    }

    /// Reads the hull of a mesh's vertices. That it is the boundary of a convex body is checked exactly; not
    /// that this holds the other vertices.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let kind: HullKind = input.code()?;
        let sources: Vec<VertexId> = input.list()?;
        let mut surface = Surface { triangles: input.list()?, twins: Vec::new() };
        check_below(sources.iter().map(|v| v.0), mesh.vertices().len(), "a vertex is not there")?;
        check(sources.is_sorted_by(|a, b| a < b), "vertices are not ascending")?;
        let positions: Vec<_> = sources.iter().map(|&v| mesh.position(v)).collect();
        let corners = surface.triangles.as_flattened();
        check_below(corners.iter().copied(), positions.len(), "a corner is not there")?;
        check(kind.allows(positions.len(), surface.triangles.len()), "it has the wrong dimension")?;
        let wedges = surface.wedges();
        let pairs: Vec<[u32; 2]> = input.list()?;
        let order;
        (surface.twins, order) = twins_of(&wedges, &pairs)?;
        check(is_convex(kind, &positions, &surface, &wedges), "it is not convex")?;
        let graph = match order {
            Order::Strict => SupportGraph::of_pairs(&positions, &surface, &wedges, &pairs),
            Order::WithEquals => SupportGraph::new(&positions, &surface),
        };
        let facets = FacetLayer::decode(input, positions.len(), surface.triangles.len())?;
        let excluded: Vec<VertexId> = input.list()?;
        check_below(excluded.iter().map(|v| v.0), mesh.vertices().len(), "a point is not there")?;
        check(excluded.is_sorted_by(|a, b| a < b), "points are not ascending")?;
        Ok(Self { kind, sources, positions, surface, graph, facets, excluded })
    }
}

/// How edges are sorted.
enum Order {
    /// No two have the same ends, and there are some.
    Strict,
    /// Some may: a plate has each diagonal twice.
    WithEquals,
}

/// The twin of each half-edge, from [`Surface::pairs`]: they run opposite ways, and every triangle has three
/// corners.
fn twins_of(wedges: &[Wedge], pairs: &[[u32; 2]]) -> Result<(Vec<u32>, Order), Flaw> {
    const NONE: u32 = u32::MAX;
    check(2 * pairs.len() == wedges.len(), "half-edges lack twins")?;
    check_below(pairs.as_flattened().iter().copied(), wedges.len(), "a twin is not there")?;
    let mut twins = vec![NONE; wedges.len()];
    let (mut do_match, mut is_strict, mut before) = (true, !pairs.is_empty(), 0);
    for &[g, h] in pairs {
        let (own, other) = (wedges[g as usize], wedges[h as usize]);
        do_match &= own.ends == other.ends.rotate_left(32) && own.ends != other.ends && g < h;
        // The first edge has an end other than vertex 0.
        is_strict &= before < own.edge();
        before = own.edge();
        twins[g as usize] = h;
        twins[h as usize] = g;
    }
    // As many places as were written to: each once.
    let are_all = twins.iter().fold(true, |all, &twin| all & (twin != NONE));
    check(do_match && are_all, "half-edges and twins do not match")?;
    if is_strict {
        return Ok((twins, Order::Strict));
    }
    let key = |[g, _]: [u32; 2]| (wedges[g as usize].edge(), g);
    check(pairs.is_sorted_by(|&a, &b| key(a) < key(b)), "edges are not sorted")?;
    Ok((twins, Order::WithEquals))
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
        let are_sound = planes.iter().fold(true, |all, plane| all & plane.is_sound());
        check(are_sound, "a facet has no plane")?;
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
        is_unit(self.normal) & self.offset.is_finite() & is_size(self.thickness)
    }
}
