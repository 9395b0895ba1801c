//! The cap surface: the hull, minus the faces of the mesh that lie on it. Caps close holes, such as
//! that of a torus, over which `CapSurface::close_facet` lays their triangles.
//!
//! Of every facet the *cap chain* is taken: the boundary of its triangles, divided where the mesh
//! divides it ([`interface`]), minus the boundary of the faces that lie on it. Where nothing is
//! left the facet is solid. What is left is a closed chain over vertices of the mesh, and is
//! triangulated in the projection along the facet's dominant axis.
//!
//! So caps close by construction, whatever rounding did: the boundary of all caps together is the
//! boundary of the hull, which is none, minus that of the faces on it. It equals the boundary of
//! the faces off the hull, if the mesh is closed. How *well* the triangles cover the facet is
//! another matter: they do so exactly once where the chain does not cross itself in the projection.
//! Facets into which faces of their neighbours reach are covered [together](share). Where faces lie
//! on a facet twice, some triangles come out clockwise, negative: they count as such in all sums.
//!
//! Cost: passes over all faces and triangles, and O(n log n) in those of facets that are not wholly
//! covered.
//!
//! Source: chains are those of Munkres (1984, "Elements of algebraic topology", sections 5 and 6),
//! the triangulation that of Hertel and Mehlhorn (1983); to define caps as a difference of chains
//! is this crate's own.

mod chain;
mod findings;
mod interface;
mod share;
mod straddle;
mod update;

use cranny_exact::{DVec2, DVec3, Sign, orient2d};

use crate::features::{Assignment, RidgeOnFacet};
use crate::ids::CapId;
use chain::{ChainEdge, Origin, cancel};
use cranny_geometry::hull::{ConvexHull, Facet, FacetId};
use cranny_geometry::rows::{row, rows};
use cranny_geometry::triangulate::triangulate;
use cranny_geometry::{FaceId, HalfEdgeId, Mesh, Model, VertexId, each_once};
use interface::Divisions;
use share::Sharing;
use straddle::drop_straddled;

/// The cap triangles of a hull, by facet.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CapSurface {
    /// Corners; counter-clockwise seen from outside unless the triangle is negative.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Per facet, and one more: where its triangles begin.
    pub(crate) facet_starts: Vec<u32>,
    /// Triangles that count negative, their facet being covered more than once there.
    pub(crate) negative: Vec<CapId>,
    /// Facets whose chain crosses itself: triangles may overlap.
    pub(crate) crossed: Vec<FacetId>,
    /// Facets that are covered together with others, ascending, each with the first of its group.
    pub(crate) shared: Vec<[u32; 2]>,
}

impl CapSurface {
    /// Builds the caps of all facets.
    pub(crate) fn build(model: &Model, assignment: &Assignment, ridges: &[RidgeOnFacet]) -> Self {
        let (mesh, hull) = (model.mesh(), model.hull());
        let facets = 0..hull.facet_count() as u32;
        let (starts, faces) = rows(&assignment.facet_of_face, hull.facet_count());
        let faces: Vec<FaceId> = faces.into_iter().map(FaceId).collect();
        let of_facet = |f: u32| &faces[row(&starts, f as usize)];
        let mut chains = open_chains(model, assignment, facets, of_facet);
        divide_alike(mesh, hull, &mut chains, ridges, assignment.depth());
        drop_straddled(mesh, hull, &mut chains, assignment.depth());
        let mut surface = Self { facet_starts: vec![0], ..Self::default() };
        for (facet, chain) in chains.iter().filter(|(_, chain)| !chain.is_empty()) {
            let id = FacetId(*facet);
            surface.facet_starts.resize(id.index() + 1, surface.triangles.len() as u32);
            surface.close_facet(mesh, hull.facet(id), id, chain, ridges_of(ridges, *facet));
        }
        surface.facet_starts.resize(hull.facet_count() + 1, surface.triangles.len() as u32);
        if surface.is_sound() {
            return surface;
        }
        Sharing { mesh, hull, assignment, chains: &chains, ridges }.share(surface)
    }

    /// Whether no triangle is negative, no chain crosses itself and no facets are covered together.
    pub(crate) fn is_sound(&self) -> bool {
        self.negative.is_empty() && self.crossed.is_empty() && self.shared.is_empty()
    }

    /// The facets that are covered together with this one, ascending, itself among them; none where
    /// it is covered by itself. O(k) where it shares, of k facets that do.
    pub(crate) fn sharing(&self, facet: FacetId) -> impl Iterator<Item = FacetId> + '_ {
        let place = self.shared.binary_search_by_key(&facet.0, |entry| entry[0]);
        let home = place.ok().map(|at| self.shared[at][1]);
        let all = home.map_or(&[][..], |_| &self.shared[..]);
        all.iter().filter(move |entry| Some(entry[1]) == home).map(|entry| FacetId(entry[0]))
    }

    /// The cap triangles of a facet.
    pub(crate) fn of_facet(&self, facet: FacetId) -> std::ops::Range<u32> {
        self.facet_starts[facet.index()]..self.facet_starts[facet.index() + 1]
    }

    /// The facet of a cap triangle.
    pub(crate) fn facet_of(&self, cap: CapId) -> FacetId {
        FacetId(self.facet_starts.partition_point(|&start| start <= cap.0) as u32 - 1)
    }

    /// Closes the cap over a chain: triangulates it in its facet.
    fn close_facet(
        &mut self,
        mesh: &Mesh,
        facet: Facet<'_>,
        id: FacetId,
        chain: &[ChainEdge],
        ridges: &[RidgeOnFacet],
    ) {
        let projection = Projection::along(facet.normal);
        if let Some(corners) = single_triangle(chain).filter(|_| ridges.is_empty()) {
            let points = corners.map(|v| projection.apply(mesh.position(VertexId(v))));
            if let Some(triangle) = as_swept(corners, points) {
                self.triangles.push(triangle);
                return;
            }
        }
        let covering = Covering::of(mesh, projection, chain, ridges);
        if !covering.exact {
            self.crossed.push(id);
        }
        for (corners, is_negative) in covering.triangles {
            self.push(corners, is_negative);
        }
    }

    /// Appends the caps of a facet, which is `before` in `other`.
    fn copy(&mut self, other: &Self, before: FacetId, facet: FacetId) {
        let range = other.of_facet(before);
        if range.is_empty() {
            return;
        }
        let first = self.triangles.len() as u32;
        let row = range.start as usize..range.end as usize;
        self.triangles.extend_from_slice(&other.triangles[row]);
        let from = other.negative.partition_point(|cap| cap.0 < range.start);
        let to = other.negative.partition_point(|cap| cap.0 < range.end);
        let negative = &other.negative[from..to];
        self.negative.extend(negative.iter().map(|cap| CapId(cap.0 - range.start + first)));
        if other.crossed.binary_search(&before).is_ok() {
            self.crossed.push(facet);
        }
    }

    fn push(&mut self, corners: [u32; 3], is_negative: bool) {
        if is_negative {
            self.negative.push(CapId(self.triangles.len() as u32));
        }
        self.triangles.push(corners);
    }
}

/// What a chain bounds, in a projection.
struct Covering {
    /// Corners, and whether they count negative.
    triangles: Vec<([u32; 3], bool)>,
    /// Whether no two edges cross.
    exact: bool,
}

impl Covering {
    fn of(
        mesh: &Mesh,
        projection: Projection,
        chain: &[ChainEdge],
        ridges: &[RidgeOnFacet],
    ) -> Self {
        let of_ridges = ridges.iter().flat_map(|r| r.ends);
        let vertices = each_once(chain.iter().flat_map(|e| e.ends).chain(of_ridges));
        let local = |v: u32| vertices.partition_point(|&w| w < v) as u32;
        let points: Vec<DVec2> =
            vertices.iter().map(|&v| projection.apply(mesh.position(VertexId(v)))).collect();
        let mut edges: Vec<[u32; 2]> = chain.iter().map(|e| e.ends.map(local)).collect();
        edges.sort_unstable();
        let in_chain = |[a, b]: [u32; 2]| {
            edges.binary_search(&[a, b]).is_ok() || edges.binary_search(&[b, a]).is_ok()
        };
        let forced: Vec<[u32; 2]> =
            ridges.iter().map(|r| r.ends.map(local)).filter(|&e| !in_chain(e)).collect();
        let made = triangulate(&points, &edges, &forced);
        let judged = |corners: [u32; 3]| {
            let [a, b, c] = corners.map(|i| points[i as usize]);
            let is_negative = orient2d(a, b, c) == Sign::Negative;
            (corners.map(|i| vertices[i as usize]), is_negative)
        };
        Self { triangles: made.triangles.into_iter().map(judged).collect(), exact: made.exact }
    }

    fn is_sound(&self) -> bool {
        self.exact && self.triangles.iter().all(|(_, is_negative)| !is_negative)
    }
}

/// The corners of the triangle that a chain runs around, if it is one.
fn single_triangle(chain: &[ChainEdge]) -> Option<[u32; 3]> {
    let &[first, second, third] = chain else { return None };
    let [a, b] = first.ends;
    let (next, last) = if second.ends[0] == b { (second, third) } else { (third, second) };
    let c = next.ends[1];
    let runs_around = next.ends[0] == b && last.ends == [c, a] && c != a;
    runs_around.then_some([a, b, c])
}

/// What a sweep makes of a counter-clockwise triangle; `None` where it is not one.
fn as_swept(corners: [u32; 3], points: [DVec2; 3]) -> Option<[u32; 3]> {
    let [a, b, c] = points;
    if orient2d(a, b, c) != Sign::Positive {
        return None;
    }
    // The corner that the sweep comes to last stands in the middle.
    let is_behind = |i: usize, j: usize| (points[i].x, points[i].y) > (points[j].x, points[j].y);
    let last = (1..3).fold(0, |last, i| if is_behind(i, last) { i } else { last });
    Some([2, 0, 1].map(|turn| corners[(last + turn) % 3]))
}

/// The chains of those among some facets, with the faces on them, that the mesh does not cover edge
/// for edge, by facet.
fn open_chains<'f>(
    model: &Model,
    assignment: &Assignment,
    facets: impl Iterator<Item = u32>,
    faces_of: impl Fn(u32) -> &'f [FaceId],
) -> Vec<(u32, Vec<ChainEdge>)> {
    let (mesh, topology, hull) = (model.mesh(), model.topology(), model.hull());
    let mut chains = Vec::new();
    let mut chain = Vec::new();
    for id in facets {
        let faces = faces_of(id);
        let facet = hull.facet(FacetId(id));
        if let ([face], [triangle]) = (faces, facet.triangles)
            && is_same(mesh.corners(*face), hull, *triangle as usize)
        {
            continue;
        }
        chain.clear();
        for &t in facet.triangles {
            chain.extend((3 * t..3 * t + 3).filter_map(|h| rim_of_facet(hull, h)));
        }
        for &face in faces {
            let rim = (0..3).map(|c| HalfEdgeId::of(face, c)).filter(|&h| {
                topology.twin(h).is_none_or(|t| assignment.facet_of_face[t.face().index()] != id)
            });
            chain.extend(rim.map(|h| {
                let corners = mesh.faces()[face.index()];
                // Against the face: its boundary is subtracted.
                let ends = [corners[(h.corner() + 1) % 3], corners[h.corner()]];
                ChainEdge::new(ends, Origin::Mesh)
            }));
        }
        cancel(&mut chain);
        if !chain.is_empty() {
            chains.push((id, chain.clone()));
        }
    }
    chains
}

/// Divides the edges of the hull that are left in two chains, and cancels again.
fn divide_alike(
    mesh: &Mesh,
    hull: &ConvexHull,
    chains: &mut [(u32, Vec<ChainEdge>)],
    ridges: &[RidgeOnFacet],
    reach: f64,
) {
    let mut divisions = Divisions::default();
    let mut is_left = vec![false; 3 * hull.triangle_count()];
    for (facet, chain) in chains.iter() {
        for edge in chain {
            if let Origin::Hull(h) = edge.origin {
                is_left[h as usize] = true;
            }
        }
        let ends = ridges_of(ridges, *facet).iter().flat_map(|r| r.ends);
        divisions.find(mesh, hull, chain, ends, reach);
    }
    divisions.keep(|h| is_left[h as usize] && is_left[hull.twin(HalfEdgeId(h)).index()]);
    for (_, chain) in chains.iter_mut() {
        let touched = |e: &ChainEdge| match e.origin {
            Origin::Hull(h) => divisions.touches(hull, h),
            Origin::Mesh => false,
        };
        if chain.iter().any(touched) {
            divisions.divide(hull, chain);
            cancel(chain);
        }
    }
}

/// The ridges on a facet, of all, which are sorted by facet.
fn ridges_of(ridges: &[RidgeOnFacet], facet: u32) -> &[RidgeOnFacet] {
    let first = ridges.partition_point(|r| r.facet < facet);
    let count = ridges[first..].partition_point(|r| r.facet == facet);
    &ridges[first..first + count]
}

/// Whether a face is a triangle of the hull, corner for corner.
fn is_same(face: [VertexId; 3], hull: &ConvexHull, triangle: usize) -> bool {
    let [a, b, c] = hull.triangle(triangle).map(|v| hull.source(v));
    face == [a, b, c] || face == [b, c, a] || face == [c, a, b]
}

/// The half-edge of the hull as an edge of its facet's boundary, if it is one.
fn rim_of_facet(hull: &ConvexHull, h: u32) -> Option<ChainEdge> {
    let (triangle, twin) = (h as usize / 3, hull.twin(HalfEdgeId(h)).index() / 3);
    if hull.facet_of_triangle(triangle) == hull.facet_of_triangle(twin) {
        return None;
    }
    let corners = hull.triangle(triangle).map(|v| hull.source(v).0);
    let corner = h as usize % 3;
    Some(ChainEdge::new([corners[corner], corners[(corner + 1) % 3]], Origin::Hull(h)))
}

/// A projection along a coordinate axis that sees a facet from outside: what is counter-clockwise
/// there is so in the plane. It drops a coordinate, which is exact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    kept: [usize; 2],
}

impl Projection {
    /// Along the axis nearest a normal; the first of equals.
    pub(crate) fn along(normal: DVec3) -> Self {
        let dropped = normal.abs().max_position();
        let kept = [(dropped + 1) % 3, (dropped + 2) % 3];
        Self { kept: if normal[dropped] < 0.0 { [kept[1], kept[0]] } else { kept } }
    }

    pub(crate) fn apply(self, p: DVec3) -> DVec2 {
        DVec2::new(p[self.kept[0]], p[self.kept[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(edges: [[u32; 2]; 3]) -> [ChainEdge; 3] {
        edges.map(|ends| ChainEdge::new(ends, Origin::Mesh))
    }

    #[test]
    fn a_triangle_needs_no_sweep() {
        let points = [[0.0, 0.0], [2.0, 1.0], [2.0, -1.0], [0.0, 3.0]].map(DVec2::from_array);
        for [a, b, c] in [[0, 2, 1], [1, 0, 2], [2, 1, 3], [0, 1, 3], [3, 0, 2]] {
            for edges in [[[a, b], [b, c], [c, a]], [[b, c], [a, b], [c, a]]] {
                let corners = single_triangle(&chain(edges)).unwrap();
                let of_sweep = triangulate(&points, &edges, &[]);
                let quick = as_swept(corners, corners.map(|v| points[v as usize]));
                assert_eq!((of_sweep.triangles, of_sweep.exact), (vec![quick.unwrap()], true));
            }
            let clockwise = [c, b, a];
            assert_eq!(as_swept(clockwise, clockwise.map(|v| points[v as usize])), None);
        }
    }

    #[test]
    fn three_edges_that_do_not_run_around_are_no_triangle() {
        assert_eq!(single_triangle(&chain([[0, 1], [1, 2], [0, 2]])), None);
        assert_eq!(single_triangle(&chain([[0, 1], [1, 0], [0, 1]])), None);
        assert_eq!(single_triangle(&chain([[0, 1], [2, 3], [3, 0]])), None);
    }
}
