//! Which faces hang together: half-edges, edges, components, closedness.
//!
//! Half-edge `3f + c` runs from corner `c` of face `f` to the next corner. Topology knows vertex
//! numbers only, never positions.
//!
//! An edge is *balanced* when as many half-edges run one way along it as the other. A component all
//! of whose edges are balanced is an oriented cycle: it has no boundary, and every point off it has
//! a winding number. That is what *closed* means here; it holds for two boxes that share an edge
//! (four faces around it), which a test for 'exactly two faces' would refuse.
//!
//! Source: half-edges are those of Muller and Preparata (1978, "Finding the intersection of two
//! convex polyhedra"), here numbered by face and corner; they are sorted by counting (Knuth 1973,
//! section 5.2). Cycles are those of Munkres (1984, "Elements of algebraic topology", section 5).
//! Cost: O(n), and for components that of [`DisjointSets`].

mod codec;
mod components;
mod edges;
mod vertices;

use crate::ids::{ComponentId, EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::on_demand::OnDemand;
use crate::rows::row;
use components::components;
use edges::{Edges, sorted_half_edges};
use vertices::VertexFaces;

pub use components::{Component, DisjointSets};
pub use edges::{Edge, EdgeKind};

/// Adjacency of a mesh.
#[derive(Clone, Debug)]
pub struct Topology {
    edges: Vec<Edge>,
    /// Half-edges sorted by edge.
    around: Vec<HalfEdgeId>,
    /// Where those of each edge begin, and one more, where the last end; none where they stand in
    /// pairs.
    starts: Vec<u32>,
    edge_of: Vec<EdgeId>,
    /// Every edge is a manifold one between two vertices: its half-edges stand in pairs.
    is_paired: bool,
    /// Number of vertices.
    vertices: usize,
    /// Follows from the rest.
    faces_at: OnDemand<VertexFaces>,
    /// None where all faces are of one.
    component_of: Vec<ComponentId>,
    components: Vec<Component>,
}

impl Topology {
    /// Builds the adjacency of a mesh. Near linear, O(n log n) in any case: all but components is
    /// linear.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let around = sorted_half_edges(mesh);
        let mut sets = DisjointSets::new(mesh.faces().len());
        let edges = Edges::of(mesh, &around, |g, h| sets.union(g.index(), h.index()));
        let components = components(&sets);
        let faces_at = OnDemand::made(VertexFaces::of(mesh));
        Self::assembled(around, edges, (mesh.vertices().len(), faces_at), components)
    }

    fn assembled(
        around: Vec<HalfEdgeId>,
        Edges { edges, starts, edge_of, is_paired, is_sorted: _ }: Edges,
        (vertices, faces_at): (usize, OnDemand<VertexFaces>),
        (component_of, mut components): (Vec<ComponentId>, Vec<Component>),
    ) -> Self {
        for (edge, &first) in edges.iter().zip(&starts) {
            if !edge.kind.is_balanced() {
                let face = around[first as usize].face();
                components[component_among(&component_of, face).index()].closed = false;
            }
        }
        Self {
            edges,
            around,
            starts,
            edge_of,
            is_paired,
            vertices,
            faces_at,
            component_of,
            components,
        }
    }

    /// All edges, sorted by their ends.
    #[must_use]
    #[inline]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// All edges, ascending.
    #[inline]
    pub fn edge_ids(&self) -> impl ExactSizeIterator<Item = EdgeId> + Clone + use<> {
        (0..self.edges.len() as u32).map(EdgeId)
    }

    /// The edge between two vertices, the lesser first. O(log n) for n edges.
    #[must_use]
    pub fn edge_between(&self, ends: [VertexId; 2]) -> Option<EdgeId> {
        let found = self.edges.binary_search_by_key(&ends, |e| [e.from, e.to]);
        found.ok().map(|e| EdgeId(e as u32))
    }

    /// The two half-edges of each edge, where every edge is a manifold one between two vertices.
    #[must_use]
    pub fn pairs(&self) -> Option<&[[HalfEdgeId; 2]]> {
        self.is_paired.then(|| self.around.as_chunks().0)
    }

    /// The edge of a half-edge.
    #[must_use]
    #[inline]
    pub fn edge_of(&self, half_edge: HalfEdgeId) -> EdgeId {
        self.edge_of[half_edge.index()]
    }

    /// The half-edges along an edge, by ascending id.
    #[must_use]
    #[inline]
    pub fn half_edges(&self, edge: EdgeId) -> &[HalfEdgeId] {
        let edge = edge.index();
        if self.is_paired {
            return &self.around[2 * edge..2 * edge + 2];
        }
        &self.around[row(&self.starts, edge)]
    }

    /// The half-edge along the same manifold edge, in the other direction.
    #[must_use]
    #[inline]
    pub fn twin(&self, half_edge: HalfEdgeId) -> Option<HalfEdgeId> {
        let edge = self.edge_of(half_edge);
        if self.is_paired {
            let first = 2 * edge.index();
            let pair = &self.around[first..first + 2];
            return Some(HalfEdgeId(pair[0].0 ^ pair[1].0 ^ half_edge.0));
        }
        self.twin_along(edge, half_edge)
    }

    /// [`twin`](Self::twin), in any mesh.
    fn twin_along(&self, edge: EdgeId, half_edge: HalfEdgeId) -> Option<HalfEdgeId> {
        let Edge { from, to, kind, .. } = self.edges[edge.index()];
        match *self.half_edges(edge) {
            [g, h] if kind == EdgeKind::Manifold && from != to => {
                // It is one of the two; which is a coin's throw that no branch should have to
                // guess.
                Some(HalfEdgeId(g.0 ^ h.0 ^ half_edge.0))
            }
            _ => None,
        }
    }

    /// The faces at a vertex, by ascending id. Those of a mesh that was loaded are looked for at
    /// the first call, in linear time.
    #[must_use]
    #[inline]
    pub fn faces_at(&self, vertex: VertexId) -> &[FaceId] {
        self.all_faces_at().at(vertex)
    }

    #[inline]
    fn all_faces_at(&self) -> &VertexFaces {
        // Nearly always it is there: nothing but that is tested in the loops that call this.
        match self.faces_at.if_made() {
            Some(made) => made,
            None => self.make_faces_at(),
        }
    }

    #[cold]
    fn make_faces_at(&self) -> &VertexFaces {
        self.faces_at.get(|| VertexFaces::of_edges(self))
    }

    /// Makes what is made late where a mesh was loaded.
    pub(crate) fn prepare_all(&self) {
        self.all_faces_at();
    }

    /// Components, by ascending first face.
    #[must_use]
    pub fn components(&self) -> &[Component] {
        &self.components
    }

    /// The component of a face.
    #[must_use]
    pub fn component_of(&self, face: FaceId) -> ComponentId {
        component_among(&self.component_of, face)
    }

    /// Whether a face belongs to a closed component.
    #[must_use]
    pub fn in_closed_component(&self, face: FaceId) -> bool {
        self.components[self.component_of(face).index()].closed
    }

    /// Whether every component is closed.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.components.iter().all(|c| c.closed)
    }

    /// Whether no two faces contradict each other's orientation.
    #[must_use]
    pub fn is_oriented(&self) -> bool {
        let agrees = |e: &Edge| !matches!(e.kind, EdgeKind::Contradictory | EdgeKind::Tangled);
        self.is_paired || self.edges.iter().all(agrees)
    }

    /// Checks the invariants; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate(&self, mesh: &Mesh) -> Result<(), String> {
        let half_edges = 3 * mesh.faces().len();
        if self.edge_of.len() != half_edges || self.around.len() != half_edges {
            return Err(format!("{half_edges} half-edges, {} sorted", self.around.len()));
        }
        for h in (0..half_edges as u32).map(HalfEdgeId) {
            let edge = self.edges[self.edge_of(h).index()];
            let f = mesh.faces()[h.face().index()];
            let (a, b) = (f[h.corner()], f[(h.corner() + 1) % 3]);
            if (edge.from.0, edge.to.0) != (a.min(b), a.max(b)) {
                return Err(format!("half-edge {} is filed under a foreign edge", h.0));
            }
            if !self.half_edges(self.edge_of(h)).contains(&h) {
                return Err(format!("edge of half-edge {} does not list it", h.0));
            }
            if let Some(twin) = self.twin(h) {
                let g = mesh.faces()[twin.face().index()];
                if self.twin(twin) != Some(h) || g[twin.corner()] != b {
                    return Err(format!("half-edges {} and {} are no twins", h.0, twin.0));
                }
                if self.component_of(h.face()) != self.component_of(twin.face()) {
                    return Err(format!("twins {} and {} lie in two components", h.0, twin.0));
                }
            }
        }
        let total: u32 = self.components.iter().map(|c| c.faces).sum();
        if total as usize != mesh.faces().len() {
            return Err(format!("components hold {total} of {} faces", mesh.faces().len()));
        }
        Ok(())
    }
}

/// The component of a face, where each face has its own or all are of one.
fn component_among(component_of: &[ComponentId], face: FaceId) -> ComponentId {
    if component_of.is_empty() { ComponentId(0) } else { component_of[face.index()] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    pub(super) fn tetrahedron(offset: u32) -> Vec<[u32; 3]> {
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].iter().map(|f| f.map(|i| i + offset)).collect()
    }

    pub(super) fn points(count: usize) -> Vec<DVec3> {
        (0..count)
            .map(|i| {
                let t = i as f64;
                DVec3::new(t, t * t, t * t * t)
            })
            .collect()
    }

    #[test]
    fn a_tetrahedron_is_closed_and_every_half_edge_has_a_twin() {
        let mesh = Mesh::new(points(4), tetrahedron(0)).unwrap();
        let topology = Topology::of(&mesh);
        topology.validate(&mesh).unwrap();
        assert!(topology.is_closed() && topology.is_oriented());
        assert_eq!(topology.edges().len(), 6);
        assert!((0..12).all(|h| topology.twin(HalfEdgeId(h)).is_some()));
        assert_eq!(topology.faces_at(VertexId(0)), [FaceId(0), FaceId(1), FaceId(3)]);
    }

    #[test]
    fn a_missing_face_opens_three_edges() {
        let mut faces = tetrahedron(0);
        faces.pop();
        let mesh = Mesh::new(points(4), faces).unwrap();
        let topology = Topology::of(&mesh);
        topology.validate(&mesh).unwrap();
        assert!(!topology.is_closed() && topology.is_oriented());
        let open = topology.edges().iter().filter(|e| e.kind == EdgeKind::Open).count();
        assert_eq!(open, 3);
    }

    #[test]
    fn a_turned_face_contradicts_its_neighbours() {
        let mut faces = tetrahedron(0);
        faces[0].swap(0, 1);
        let topology = Topology::of(&Mesh::new(points(4), faces).unwrap());
        assert!(!topology.is_oriented() && !topology.is_closed());
    }

    #[test]
    fn two_solids_that_share_an_edge_are_one_closed_component() {
        let mut faces = tetrahedron(0);
        // Second tetrahedron on vertices 0, 1, 4, 5.
        faces.extend(tetrahedron(0).iter().map(|f| f.map(|i| if i > 1 { i + 2 } else { i })));
        let mesh = Mesh::new(points(6), faces).unwrap();
        let topology = Topology::of(&mesh);
        topology.validate(&mesh).unwrap();
        assert!(topology.is_closed());
        assert_eq!(topology.components().len(), 1);
        let balanced = topology.edges().iter().filter(|e| e.kind == EdgeKind::Balanced).count();
        assert_eq!(balanced, 1);
    }

    #[test]
    fn two_separate_solids_are_two_components() {
        let mut faces = tetrahedron(0);
        faces.extend(tetrahedron(4));
        let topology = Topology::of(&Mesh::new(points(8), faces).unwrap());
        assert_eq!(topology.components().len(), 2);
        assert_eq!(topology.components()[1].first_face, FaceId(4));
        assert_eq!(topology.component_of(FaceId(7)), ComponentId(1));
    }
}
