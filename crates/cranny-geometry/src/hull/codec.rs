//! Hulls as bytes: triangles, the twins of half-edges, and the facets; positions and owners are
//! made again, and the graph at its first use.

use cranny_exact::{Aabb, DVec3};

use super::convexity::is_convex;
use super::facets::{FacetLayer, Plane};
use super::outline::Outlines;
use super::quickhull::HullSurface;
use super::{ConvexHull, FacetId, HullKind, HullVertexId, Leaving};
use crate::codec::{
    Flaw, Reader, Writer, check, check_below, check_rows, is_flatness, is_size, is_unit,
    owners_of_rows, plain_struct,
};
use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::on_demand::OnDemand;

plain_struct!(HullVertexId(u32));
plain_struct!(FacetId(u32));
plain_struct!(Plane { normal: DVec3, offset: f64, thickness: f64 });

impl ConvexHull {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self { kind, sources, surface, facets, excluded, .. } = self;
        let HullSurface { triangles, twins } = surface;
        out.one(*kind as u8);
        out.list(sources);
        out.list(triangles);
        out.list(twins);
        facets.encode(out);
        out.list(excluded);
    }

    /// Reads the hull of a mesh's vertices. That it is the boundary of a convex body is checked
    /// exactly, and that its box, which is the body's, holds the other vertices; not that it does.
    /// Its graph is made at its first use.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let kind = HullKind::of_code(input.one()?).ok_or("a byte stands for nothing known")?;
        let sources: Vec<VertexId> = input.list()?;
        let surface = HullSurface { triangles: input.list()?, twins: input.list()? };
        check_below(sources.iter().map(|v| v.0), mesh.vertices().len(), "a vertex is not there")?;
        check(sources.is_sorted_by(|a, b| a < b), "vertices are not ascending")?;
        let positions: Vec<_> = sources.iter().map(|&v| mesh.position(v)).collect();
        let around = |points: &[DVec3]| Aabb::of_points(points.iter().copied());
        check(
            around(&positions) == around(mesh.vertices()),
            "its box is not that of all vertices",
        )?;
        let corners = surface.triangles.as_flattened();
        check_below(corners.iter().copied(), positions.len(), "a corner is not there")?;
        check(kind.allows(positions.len(), surface.triangles.len()), "it has the wrong dimension")?;
        check_twins(&surface)?;
        check(is_convex(kind, &positions, &surface), "it is not convex")?;
        let facets = FacetLayer::decode(input, positions.len(), surface.triangles.len())?;
        let excluded: Vec<VertexId> = input.list()?;
        check_below(excluded.iter().map(|v| v.0), mesh.vertices().len(), "a point is not there")?;
        check(excluded.is_sorted_by(|a, b| a < b), "points are not ascending")?;
        let (graph, leaving, bounds) =
            (OnDemand::default(), Leaving::default(), OnDemand::default());
        Ok(Self { kind, sources, positions, surface, graph, leaving, bounds, facets, excluded })
    }
}

/// That each half-edge is the twin of its twin, which runs the opposite way, and that every
/// triangle has three corners.
fn check_twins(surface: &HullSurface) -> Result<(), Flaw> {
    let HullSurface { triangles, twins } = surface;
    let corners = triangles.as_flattened();
    check(twins.len() == corners.len(), "half-edges lack twins")?;
    let (of_triangles, _) = twins.as_chunks::<3>();
    let (mut are_there, mut do_match) = (true, true);
    for ((first, &[a, b, c]), own) in (0..).step_by(3).zip(triangles).zip(of_triangles) {
        do_match &= (a != b) & (b != c) & (c != a);
        for ((half_edge, to), &twin) in (first..).zip([b, c, a]).zip(own) {
            // Where its twin begins, it ends; that this holds of the twin as well is seen at the
            // twin.
            match (corners.get(twin as usize), twins.get(twin as usize)) {
                (Some(&from), Some(&back)) => do_match &= (from == to) & (back == half_edge),
                _ => are_there = false,
            }
        }
    }
    check(are_there, "a twin is not there")?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_is_as_wide_as_the_mesh() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.1, 0.1, 0.1)];
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 3, 4]]).unwrap();
        let read = |points: &[DVec3]| {
            let mut out = Writer::default();
            ConvexHull::of_points(points).encode(&mut out);
            ConvexHull::decode(&mut Reader::new(&out.into_bytes()), &mesh)
                .map_err(|Flaw(what)| what)
        };
        assert!(read(&corners).is_ok());
        // One, a few, and no vertices of it.
        for count in [0, 1, 3] {
            let error = read(&corners[..count]).unwrap_err();
            assert!(error.contains("its box"), "{count}: {error}");
        }
    }

    #[test]
    fn twins_run_opposite_ways_and_are_of_each_other() {
        let corners: Vec<DVec3> = (0..8)
            .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
            .collect();
        let flaw = |change: &dyn Fn(&mut HullSurface)| {
            let mut surface = ConvexHull::of_points(&corners).surface;
            change(&mut surface);
            check_twins(&surface).err().map(|Flaw(what)| what)
        };
        let says = |change: &dyn Fn(&mut HullSurface), what| {
            assert!(flaw(change).is_some_and(|flaw| flaw.contains(what)), "{what}");
        };
        assert_eq!(flaw(&|_| ()), None);
        says(&|surface| surface.twins.swap(0, 1), "do not match");
        says(&|surface| surface.twins[7] = 7, "do not match");
        says(&|surface| surface.triangles[3].swap(0, 1), "do not match");
        says(&|surface| surface.triangles[3][0] = surface.triangles[3][1], "do not match");
        says(&|surface| surface.twins[5] = 36, "not there");
        says(&|surface| surface.twins[5] = u32::MAX, "not there");
        says(&|surface| surface.twins.truncate(35), "lack twins");
    }
}
