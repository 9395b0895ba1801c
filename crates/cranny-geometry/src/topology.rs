//! Which faces hang together: half-edges, edges, components, closedness.
//!
//! Half-edge `3f + c` runs from corner `c` of face `f` to the next corner. Topology knows vertex
//! numbers only, never positions.
//!
//! An edge is *balanced* when as many half-edges run one way along it as the other. A component
//! all of whose edges are balanced is an oriented cycle: it has no boundary, and every point off it
//! has a winding number. That is what *closed* means here; it holds for two boxes that share an edge
//! (four faces around it), which a test for 'exactly two faces' would refuse.
//!
//! Source: half-edges are those of Muller and Preparata (1978, "Finding the intersection of two convex polyhedra"),
//! here numbered by face and corner; they are sorted by counting (Knuth 1973, section 5.2). Cycles are those of
//! Munkres (1984, "Elements of algebraic topology", section 5). Cost: O(n), and for components that of
//! [`DisjointSets`].

use crate::codec::{Flaw, Reader, Writer, check, check_below};
use crate::ids::{ComponentId, EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;

/// An undirected edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Lesser end.
    pub from: VertexId,
    /// Greater end.
    pub to: VertexId,
    /// How the faces meet there.
    pub kind: EdgeKind,
    /// Where its half-edges begin; where they end, those of the next edge do.
    first: u32,
}

/// How faces meet along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EdgeKind {
    /// Two faces, in opposite directions.
    Manifold,
    /// One face.
    Open,
    /// Two faces in the same direction: their orientations contradict.
    Contradictory,
    /// More than two faces, as many in one direction as in the other.
    Balanced,
    /// More than two faces, otherwise.
    Tangled,
}

impl EdgeKind {
    /// Whether the edge is part of no boundary.
    #[must_use]
    pub fn is_balanced(self) -> bool {
        matches!(self, Self::Manifold | Self::Balanced)
    }
}

/// Faces that hang together over edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Component {
    /// Its least face.
    pub first_face: FaceId,
    /// Number of faces.
    pub faces: u32,
    /// Every edge is balanced: the component bounds a region of space.
    pub closed: bool,
}

/// Adjacency of a mesh.
#[derive(Clone, Debug)]
pub struct Topology {
    edges: Vec<Edge>,
    /// Half-edges sorted by edge.
    around: Vec<HalfEdgeId>,
    edge_of: Vec<EdgeId>,
    /// Every edge is a manifold one between two vertices: its half-edges stand in pairs.
    is_paired: bool,
    vertex_starts: Vec<u32>,
    vertex_faces: Vec<FaceId>,
    component_of: Vec<ComponentId>,
    components: Vec<Component>,
}

impl HalfEdgeId {
    /// The half-edge of a face that starts at a corner (0, 1 or 2).
    #[must_use]
    pub fn of(face: FaceId, corner: usize) -> Self {
        Self(3 * face.0 + corner as u32)
    }

    /// Its face.
    #[must_use]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// The corner at which it starts: 0, 1 or 2.
    #[must_use]
    pub fn corner(self) -> usize {
        (self.0 % 3) as usize
    }

    /// The next one around the face.
    #[must_use]
    pub fn next(self) -> Self {
        Self(if self.0 % 3 == 2 { self.0 - 2 } else { self.0 + 1 })
    }

    /// The one before, which begins at the corner across.
    pub(crate) fn previous(self) -> Self {
        Self(if self.0.is_multiple_of(3) { self.0 + 2 } else { self.0 - 1 })
    }
}

impl Topology {
    /// Builds the adjacency of a mesh. Near linear, O(n log n) in any case: all but components is linear.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let around = sorted_half_edges(mesh);
        let mut sets = DisjointSets::new(mesh.faces().len());
        let edges = Edges::of(mesh, &around, |g, h| sets.union(g.index(), h.index()));
        let components = components(&sets);
        Self::assembled(around, edges, faces_of_vertices(mesh), components)
    }

    fn assembled(
        around: Vec<HalfEdgeId>,
        Edges { edges, edge_of, is_paired, is_sorted: _ }: Edges,
        (vertex_starts, vertex_faces): (Vec<u32>, Vec<FaceId>),
        (component_of, mut components): (Vec<ComponentId>, Vec<Component>),
    ) -> Self {
        let unbalanced = |e: &&Edge| !is_paired && !e.kind.is_balanced();
        for edge in edges.iter().filter(unbalanced) {
            let face = around[edge.first as usize].face();
            components[component_of[face.index()].index()].closed = false;
        }
        Self {
            edges,
            around,
            edge_of,
            is_paired,
            vertex_starts,
            vertex_faces,
            component_of,
            components,
        }
    }

    /// Writes what takes time to find: the order of half-edges, how many faces in a row are of one component,
    /// and how many are at each vertex.
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self {
            around,
            component_of,
            vertex_starts,
            vertex_faces: _,
            edges: _,
            edge_of: _,
            is_paired: _,
            components: _,
        } = self;
        out.list(around);
        let runs = component_of.chunk_by(|a, b| a == b);
        let runs: Vec<[u32; 2]> = runs.map(|run| [run[0].0, run.len() as u32]).collect();
        out.list(&runs);
        out.list(vertex_starts);
    }

    /// Reads the adjacency of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let (around, runs): (Vec<HalfEdgeId>, Vec<[u32; 2]>) = (input.list()?, input.list()?);
        let count = 3 * mesh.faces().len();
        check(around.len() == count, "it is not one of all half-edges")?;
        check_below(around.iter().map(|h| h.0), count, "a half-edge is not there")?;
        let components = components_of_runs(&runs, mesh.faces().len())?;
        let starts: Vec<u32> = input.list()?;
        check(starts.len() == mesh.vertices().len() + 1, "a row for each vertex is needed")?;
        let vertex_faces = faces_in_rows(mesh, &starts).ok_or("rows of vertices are too short")?;
        let component_of = components.0.as_slice();
        let mut is_one = true;
        // As many half-edges as there are, strictly ascending: each once.
        let edges = if components.1.len() == 1 {
            Edges::of(mesh, &around, |_, _| ())
        } else {
            let join = |g: FaceId, h: FaceId| {
                is_one &= component_of[g.index()] == component_of[h.index()];
            };
            Edges::of(mesh, &around, join)
        };
        check(edges.is_sorted, "half-edges are not sorted")?;
        check(is_one, "an edge joins two components")?;
        Ok(Self::assembled(around, edges, (starts, vertex_faces), components))
    }

    /// All edges, sorted by their ends.
    #[must_use]
    #[inline]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The two half-edges of each edge, where every edge is a manifold one between two vertices.
    pub(crate) fn pairs(&self) -> Option<&[[HalfEdgeId; 2]]> {
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
        let first = self.edges[edge.index()].first as usize;
        let next = self.edges.get(edge.index() + 1);
        &self.around[first..next.map_or(self.around.len(), |next| next.first as usize)]
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
                // It is one of the two; which is a coin's throw that no branch should have to guess.
                Some(HalfEdgeId(g.0 ^ h.0 ^ half_edge.0))
            }
            _ => None,
        }
    }

    /// The faces at a vertex, by ascending id.
    #[must_use]
    #[inline]
    pub fn faces_at(&self, vertex: VertexId) -> &[FaceId] {
        let v = vertex.index();
        &self.vertex_faces[self.vertex_starts[v] as usize..self.vertex_starts[v + 1] as usize]
    }

    /// Components, by ascending first face.
    #[must_use]
    pub fn components(&self) -> &[Component] {
        &self.components
    }

    /// The component of a face.
    #[must_use]
    pub fn component_of(&self, face: FaceId) -> ComponentId {
        self.component_of[face.index()]
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

/// How a half-edge runs, in one word: where from, where to.
#[derive(Clone, Copy)]
struct Run(u64);

impl Run {
    fn new((from, to): (u32, u32)) -> Self {
        Self(u64::from(from) << 32 | u64::from(to))
    }

    fn turned(self) -> Self {
        Self(self.0.rotate_left(32))
    }

    /// The same for all that run along an edge, either way; orders edges by their ends.
    fn edge(self) -> u64 {
        self.0.min(self.turned().0)
    }

    /// Whether it runs from the lesser end to the greater.
    fn is_forward(self) -> bool {
        self.0 == self.edge()
    }

    /// Whether it runs along the same edge the other way, and this is one between two vertices.
    fn is_opposite(self, other: Self) -> bool {
        self.0 == other.turned().0 && self.0 != other.0
    }
}

/// The ends of an edge, the lesser first.
fn ends(edge: u64) -> (VertexId, VertexId) {
    (VertexId((edge >> 32) as u32), VertexId(edge as u32))
}

/// What follows from the order of half-edges.
struct Edges {
    edges: Vec<Edge>,
    edge_of: Vec<EdgeId>,
    is_sorted: bool,
    /// Whether all are between two faces that run along them in opposite directions.
    is_paired: bool,
}

impl Edges {
    /// From all half-edges of a mesh, by edge, along an edge by number; in the end it is known whether they are
    /// sorted so. `join` is told of faces that share an edge. Near linear.
    fn of(mesh: &Mesh, around: &[HalfEdgeId], mut join: impl FnMut(FaceId, FaceId)) -> Self {
        let runs = runs_of(mesh);
        let of_pairs = Self::of_pairs(runs.as_flattened(), around, &mut join);
        of_pairs.unwrap_or_else(|| Self::of_groups(runs.as_flattened(), around, &mut join))
    }

    /// In short steps, where all edges are between two faces and two vertices, and sorted.
    fn of_pairs(
        runs: &[Run],
        around: &[HalfEdgeId],
        join: &mut impl FnMut(FaceId, FaceId),
    ) -> Option<Self> {
        let (pairs, []) = around.as_chunks::<2>() else { return None };
        let mut edge_of = vec![EdgeId(0); around.len()];
        // The same length: one check serves both.
        let runs = &runs[..edge_of.len()];
        // Of no edge between two vertices.
        let mut before = 0;
        let (from, to) = ends(before);
        let blank = Edge { from, to, kind: EdgeKind::Manifold, first: 0 };
        let mut edges = vec![blank; pairs.len()];
        for (id, (edge, &[g, h])) in edges.iter_mut().zip(pairs).enumerate() {
            let id = id as u32;
            let (run, other) = (runs[g.index()], runs[h.index()]);
            if !run.is_opposite(other) || g > h || run.edge() <= before {
                return None;
            }
            before = run.edge();
            let (from, to) = ends(before);
            *edge = Edge { from, to, kind: EdgeKind::Manifold, first: 2 * id };
            edge_of[g.index()] = EdgeId(id);
            edge_of[h.index()] = EdgeId(id);
            join(g.face(), h.face());
        }
        Some(Self { edges, edge_of, is_sorted: true, is_paired: true })
    }

    /// In any case.
    fn of_groups(
        runs: &[Run],
        around: &[HalfEdgeId],
        join: &mut impl FnMut(FaceId, FaceId),
    ) -> Self {
        let mut edges = Vec::with_capacity(around.len() / 2);
        let mut edge_of = vec![EdgeId(0); runs.len()];
        let mut is_sorted = true;
        let mut before = None;
        let mut first = 0;
        let edge_at = |h: HalfEdgeId| runs[h.index()].edge();
        for group in around.chunk_by(|&g, &h| edge_at(g) == edge_at(h)) {
            let edge = edge_at(group[0]);
            let forward = group.iter().filter(|h| runs[h.index()].is_forward()).count();
            for h in group {
                edge_of[h.index()] = EdgeId(edges.len() as u32);
                join(group[0].face(), h.face());
            }
            is_sorted &= group.is_sorted_by(|g, h| g < h) && before < Some(edge);
            before = Some(edge);
            let (from, to) = ends(edge);
            // An edge from a vertex to itself is the short side of a collapsed face: nothing to match.
            let is_balanced = from == to || 2 * forward == group.len();
            let kind = match (group.len(), is_balanced) {
                (1, false) => EdgeKind::Open,
                (2, true) => EdgeKind::Manifold,
                (2, false) => EdgeKind::Contradictory,
                (_, true) => EdgeKind::Balanced,
                (_, false) => EdgeKind::Tangled,
            };
            edges.push(Edge { from, to, kind, first });
            first += group.len() as u32;
        }
        Self { edges, edge_of, is_sorted, is_paired: false }
    }
}

/// How the half-edges of each face run.
fn runs_of(mesh: &Mesh) -> Vec<[Run; 3]> {
    let of_face = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)].map(Run::new);
    mesh.faces().iter().map(of_face).collect()
}

fn ascending((a, b): (u32, u32)) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// All half-edges, sorted by edge, along an edge by number: dealt out to their greater ends, and in that order to
/// their lesser ones.
fn sorted_half_edges(mesh: &Mesh) -> Vec<HalfEdgeId> {
    let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)].map(ascending);
    // Where the next half-edge of each vertex goes, by the lesser end and by the greater.
    let mut places = vec![[0u32; 2]; mesh.vertices().len() + 1];
    for (from, to) in mesh.faces().iter().flat_map(sides) {
        places[from as usize + 1][0] += 1;
        places[to as usize + 1][1] += 1;
    }
    let mut before = [0; 2];
    for place in &mut places {
        before = [before[0] + place[0], before[1] + place[1]];
        *place = before;
    }
    let mut by_greater = vec![0u64; 3 * mesh.faces().len()];
    for (h, (from, to)) in (0u64..).zip(mesh.faces().iter().flat_map(sides)) {
        let place = &mut places[to as usize][1];
        by_greater[*place as usize] = u64::from(from) << 32 | h;
        *place += 1;
    }
    let mut sorted = vec![HalfEdgeId(0); by_greater.len()];
    for key in by_greater {
        let place = &mut places[(key >> 32) as usize][0];
        sorted[*place as usize] = HalfEdgeId(key as u32);
        *place += 1;
    }
    sorted
}

/// Where the faces of each vertex begin, and one more, where the last end; and these faces.
fn faces_of_vertices(mesh: &Mesh) -> (Vec<u32>, Vec<FaceId>) {
    let mut starts = vec![0u32; mesh.vertices().len() + 1];
    for &i in mesh.faces().as_flattened() {
        starts[i as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let faces = faces_in_rows(mesh, &starts);
    debug_assert!(faces.is_some(), "each row is as long as it was counted");
    (starts, faces.unwrap_or_default())
}

/// The faces of each vertex in its row, if rows that begin at `starts` have just the length for that.
fn faces_in_rows(mesh: &Mesh, starts: &[u32]) -> Option<Vec<FaceId>> {
    let (&first, ends) = starts.split_first()?;
    let mut places = starts.to_vec();
    let mut faces = vec![FaceId(0); 3 * mesh.faces().len()];
    for (f, corners) in (0..).zip(mesh.faces()) {
        for &i in corners {
            let place = &mut places[i as usize];
            *faces.get_mut(*place as usize)? = FaceId(f);
            *place += 1;
        }
    }
    // Each row was filled from its beginning to where the next one begins, as often as there are places.
    (first == 0 && places[..ends.len()] == *ends).then_some(faces)
}

/// Numbers the sets of faces that hang together, by their least members; all closed, for now.
fn components(sets: &DisjointSets) -> (Vec<ComponentId>, Vec<Component>) {
    let mut components: Vec<Component> = Vec::new();
    let mut component_of: Vec<ComponentId> = Vec::with_capacity(sets.0.len());
    for (face, &before) in (0..).map(FaceId).zip(&sets.0) {
        let component = component_of.get(before as usize).copied().unwrap_or_else(|| {
            components.push(Component { first_face: face, faces: 0, closed: true });
            ComponentId(components.len() as u32 - 1)
        });
        component_of.push(component);
    }
    for run in component_of.chunk_by(|a, b| a == b) {
        components[run[0].index()].faces += run.len() as u32;
    }
    (component_of, components)
}

/// The same from the components of faces in a row, each with its number of faces.
fn components_of_runs(
    runs: &[[u32; 2]],
    faces: usize,
) -> Result<(Vec<ComponentId>, Vec<Component>), Flaw> {
    let total: u64 = runs.iter().map(|&[_, count]| u64::from(count)).sum();
    check(total == faces as u64, "components hold too many or too few faces")?;
    let is_apart = |a: &[u32; 2], b: &[u32; 2]| a[0] != b[0];
    let is_whole = runs.is_sorted_by(is_apart) && runs.iter().all(|&[_, count]| count > 0);
    check(is_whole, "faces of a component are not told together")?;
    let mut components: Vec<Component> = Vec::new();
    let mut component_of: Vec<ComponentId> = Vec::with_capacity(faces);
    for &[component, count] in runs {
        if component as usize == components.len() {
            let first_face = FaceId(component_of.len() as u32);
            components.push(Component { first_face, faces: 0, closed: true });
        }
        let own = components.get_mut(component as usize);
        own.ok_or("components are not in order")?.faces += count;
        component_of.resize(component_of.len() + count as usize, ComponentId(component));
    }
    Ok((component_of, components))
}

/// Union–find with path halving; the representative of a set is its least member, and each member but that
/// leads to a lesser one.
///
/// Source: Tarjan and van Leeuwen (1984, "Worst-case analysis of set union algorithms"). Cost: O(log n) a call at
/// most, on average over all calls: sets are joined by number, not by rank.
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// `count` sets of one member each.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// The least member of the set of `i < count`.
    pub fn find(&mut self, mut i: usize) -> usize {
        while self.0[i] as usize != i {
            let parent = self.0[i] as usize;
            self.0[i] = self.0[parent];
            i = self.0[i] as usize;
        }
        i
    }

    /// Makes one set of the sets of `i` and `j`.
    #[inline]
    pub fn union(&mut self, i: usize, j: usize) {
        // As often as not, it is one already.
        if self.0[i] == self.0[j] {
            return;
        }
        let (i, j) = (self.find(i), self.find(j));
        self.0[i.max(j)] = i.min(j) as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    fn tetrahedron(offset: u32) -> Vec<[u32; 3]> {
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].iter().map(|f| f.map(|i| i + offset)).collect()
    }

    fn points(count: usize) -> Vec<DVec3> {
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
    fn half_edges_are_sorted_by_edge_then_number() {
        // Edges of many faces, contradictory and collapsed ones, a vertex that no face names.
        let faces: Vec<[u32; 3]> = (0..90u32)
            .map(|i| [i * 7 % 5, i * i % 11, if i % 3 == 0 { 12 } else { i % 7 }])
            .collect();
        let mesh = Mesh::new(points(14), faces).unwrap();
        let mut expected: Vec<HalfEdgeId> = (0..270).map(HalfEdgeId).collect();
        expected.sort_by_key(|&h| {
            let corners = mesh.corners(h.face());
            let (from, to) = (corners[h.corner()].0, corners[h.next().corner()].0);
            (ascending((from, to)), h)
        });
        assert_eq!(sorted_half_edges(&mesh), expected);
        Topology::of(&mesh).validate(&mesh).unwrap();
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
    fn components_are_read_from_runs_or_refused() {
        let read = |runs: &[[u32; 2]]| components_of_runs(runs, 6).map_err(|Flaw(what)| what);
        let (of_faces, all) = read(&[[0, 1], [1, 2], [0, 1], [2, 2]]).unwrap();
        assert_eq!(of_faces, [0, 1, 1, 0, 2, 2].map(ComponentId));
        let told: Vec<_> = all.iter().map(|c| (c.first_face.0, c.faces)).collect();
        assert_eq!(told, [(0, 2), (1, 2), (4, 2)]);
        for (runs, flaw) in [
            (&[[0, 5]][..], "too few"),
            (&[[0, 3], [1, u32::MAX]], "too many"),
            (&[[0, 3], [0, 3]], "not told together"),
            (&[[0, 6], [1, 0]], "not told together"),
            (&[[1, 6]], "not in order"),
            (&[[0, 3], [2, 3]], "not in order"),
        ] {
            let error = read(runs).unwrap_err();
            assert!(error.contains(flaw), "{runs:?}: {error}");
        }
    }

    #[test]
    fn an_edge_does_not_join_two_components() {
        let mesh = Mesh::new(points(4), tetrahedron(0)).unwrap();
        let whole = Topology::of(&mesh);
        let read = |runs: &[[u32; 2]]| {
            let mut out = Writer::default();
            out.list(&whole.around);
            out.list(runs);
            out.list(&whole.vertex_starts);
            let read = Topology::decode(&mut Reader::new(&out.into_bytes()), &mesh);
            read.map_err(|Flaw(what)| what)
        };
        assert_eq!(read(&[[0, 4]]).unwrap().components(), whole.components());
        assert!(read(&[[0, 3], [1, 1]]).unwrap_err().contains("joins two"));
    }

    #[test]
    fn rows_of_vertices_have_just_the_length_that_is_needed() {
        let mesh = Mesh::new(points(5), tetrahedron(0)).unwrap();
        let (starts, faces) = faces_of_vertices(&mesh);
        assert_eq!(starts, [0, 3, 6, 9, 12, 12]);
        assert_eq!(faces_in_rows(&mesh, &starts), Some(faces));
        for wrong in [
            [0, 2, 6, 9, 12, 12],
            [0, 4, 6, 9, 12, 12],
            [1, 3, 6, 9, 12, 12],
            [0, 3, 6, 9, 12, 13],
            [0, 3, 6, u32::MAX, 12, 12],
            [3, 0, 6, 9, 12, 12],
        ] {
            assert_eq!(faces_in_rows(&mesh, &wrong), None, "{wrong:?}");
        }
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
