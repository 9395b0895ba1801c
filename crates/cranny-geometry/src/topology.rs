//! Which faces hang together: half-edges, edges, components, closedness.
//!
//! Half-edge `3f + c` runs from corner `c` of face `f` to the next corner. Topology knows vertex
//! numbers only, never positions.
//!
//! An edge is *balanced* when as many half-edges run one way along it as the other. A component
//! all of whose edges are balanced is an oriented cycle: it has no boundary, and every point off it
//! has a winding number. That is what *closed* means here; it holds for two boxes that share an edge
//! (four faces around it), which a test for 'exactly two faces' would refuse.

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
    first: u32,
    count: u32,
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
    /// Twin of each half-edge; `u32::MAX` off manifold edges.
    twins: Vec<u32>,
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
        Self(self.0 - self.0 % 3 + (self.0 + 1) % 3)
    }
}

impl Topology {
    /// Builds the adjacency of a mesh. Near linear where few edges end at each vertex, O(n log n) in any
    /// case.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        Self::of_sorted(mesh, sorted_half_edges(mesh))
    }

    /// From all half-edges, sorted by edge, along an edge by number. Near linear.
    fn of_sorted(mesh: &Mesh, around: Vec<HalfEdgeId>) -> Self {
        let runs = runs_of(mesh);
        let runs = runs.as_flattened();
        let mut edges: Vec<Edge> = Vec::with_capacity(around.len() / 2);
        let mut edge_of = vec![EdgeId(0); around.len()];
        let mut twins = vec![u32::MAX; around.len()];
        // Edges that are not between two faces and two vertices.
        let mut odd: Vec<EdgeId> = Vec::new();
        let mut rest = around.as_slice();
        while let Some(&leader) = rest.first() {
            let run = runs[leader.index()];
            let (edge, (from, to)) = (EdgeId(edges.len() as u32), run.ends());
            let is_along = |h: &HalfEdgeId| runs[h.index()].is_along(run);
            let plain = match rest {
                [_, other, others @ ..] if !others.first().is_some_and(is_along) => {
                    Some(*other).filter(|h| runs[h.index()].is_opposite(run) && from != to)
                }
                _ => None,
            };
            let count = match plain {
                Some(_) => 2,
                None => rest.iter().take_while(|h| is_along(h)).count(),
            };
            let group;
            (group, rest) = rest.split_at(count);
            let kind = if let Some(other) = plain {
                twins[leader.index()] = other.0;
                twins[other.index()] = leader.0;
                EdgeKind::Manifold
            } else {
                odd.push(edge);
                let forward = group.iter().filter(|h| runs[h.index()].is_forward()).count();
                // An edge from a vertex to itself is the short side of a collapsed face: nothing to match.
                let balanced = from == to || 2 * forward == count;
                match (count, balanced) {
                    (1, false) => EdgeKind::Open,
                    (2, true) => EdgeKind::Manifold,
                    (2, false) => EdgeKind::Contradictory,
                    (_, true) => EdgeKind::Balanced,
                    (_, false) => EdgeKind::Tangled,
                }
            };
            for h in group {
                edge_of[h.index()] = edge;
            }
            let first = (around.len() - rest.len() - count) as u32;
            let (from, to) = (VertexId(from), VertexId(to));
            edges.push(Edge { from, to, kind, first, count: count as u32 });
        }

        let (vertex_starts, vertex_faces) = faces_of_vertices(mesh);
        let odd: Vec<&Edge> = odd.iter().map(|e| &edges[e.index()]).collect();
        let (component_of, components) = components(&twins, &odd, &around);
        Self {
            edges,
            around,
            edge_of,
            twins,
            vertex_starts,
            vertex_faces,
            component_of,
            components,
        }
    }

    /// Writes the order of half-edges, which is what takes time to find.
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self {
            around,
            edges: _,
            edge_of: _,
            twins: _,
            vertex_starts: _,
            vertex_faces: _,
            component_of: _,
            components: _,
        } = self;
        out.list(around);
    }

    /// Reads the adjacency of a mesh.
    pub(crate) fn decode(input: &mut Reader, mesh: &Mesh) -> Result<Self, Flaw> {
        let around: Vec<HalfEdgeId> = input.list()?;
        let count = 3 * mesh.faces().len();
        check(around.len() == count, "it is not one of all half-edges")?;
        check_below(around.iter().map(|h| h.0), count, "a half-edge is not there")?;
        let read = Self::of_sorted(mesh, around);
        // As many as there are, strictly ascending: each once.
        let ends = |e: &Edge| (e.from, e.to);
        let is_sorted = read.edges.is_sorted_by(|a, b| ends(a) < ends(b))
            && read.edges.iter().all(|e| read.row(e).is_sorted_by(|g, h| g < h));
        check(is_sorted, "half-edges are not sorted")?;
        Ok(read)
    }

    /// All edges, sorted by their ends.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The edge of a half-edge.
    #[must_use]
    pub fn edge_of(&self, half_edge: HalfEdgeId) -> EdgeId {
        self.edge_of[half_edge.index()]
    }

    /// The half-edges along an edge, by ascending id.
    #[must_use]
    pub fn half_edges(&self, edge: EdgeId) -> &[HalfEdgeId] {
        self.row(&self.edges[edge.index()])
    }

    fn row(&self, edge: &Edge) -> &[HalfEdgeId] {
        &self.around[edge.first as usize..(edge.first + edge.count) as usize]
    }

    /// The half-edge along the same manifold edge, in the other direction.
    #[must_use]
    pub fn twin(&self, half_edge: HalfEdgeId) -> Option<HalfEdgeId> {
        let twin = self.twins[half_edge.index()];
        (twin != u32::MAX).then_some(HalfEdgeId(twin))
    }

    /// The faces at a vertex, by ascending id.
    #[must_use]
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
        self.edges.iter().all(|e| !matches!(e.kind, EdgeKind::Contradictory | EdgeKind::Tangled))
    }

    /// Checks the invariants; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate(&self, mesh: &Mesh) -> Result<(), String> {
        let half_edges = 3 * mesh.faces().len();
        if self.twins.len() != half_edges || self.around.len() != half_edges {
            return Err(format!("{half_edges} half-edges, but {} twins", self.twins.len()));
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

/// How a half-edge runs, in one word: its lesser end, its greater end, and whether it runs from the lesser
/// one. A vertex has a number below 2^30.
#[derive(Clone, Copy)]
struct Run(u64);

impl Run {
    fn new((a, b): (u32, u32)) -> Self {
        Self(u64::from(a.min(b)) << 32 | u64::from(a.max(b)) << 1 | u64::from(a <= b))
    }

    fn ends(self) -> (u32, u32) {
        ((self.0 >> 32) as u32, self.0 as u32 >> 1)
    }

    /// Whether it runs from the lesser end to the greater.
    fn is_forward(self) -> bool {
        self.0 & 1 == 1
    }

    fn is_along(self, other: Self) -> bool {
        (self.0 ^ other.0) <= 1
    }

    fn is_opposite(self, other: Self) -> bool {
        self.0 ^ other.0 == 1
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

/// All half-edges, sorted by edge, along an edge by number: dealt out to their lesser ends, and sorted there.
fn sorted_half_edges(mesh: &Mesh) -> Vec<HalfEdgeId> {
    let sides = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)].map(ascending);
    // Where the next half-edge of each vertex goes; in the end, where those of the next vertex begin.
    let mut places = vec![0u32; mesh.vertices().len() + 1];
    for (from, _) in mesh.faces().iter().flat_map(sides) {
        places[from as usize + 1] += 1;
    }
    for v in 1..places.len() {
        places[v] += places[v - 1];
    }
    let mut keys = vec![0u64; 3 * mesh.faces().len()];
    for (h, (from, to)) in (0u64..).zip(mesh.faces().iter().flat_map(sides)) {
        let place = &mut places[from as usize];
        keys[*place as usize] = u64::from(to) << 32 | h;
        *place += 1;
    }
    let mut start = 0;
    for &end in &places[..mesh.vertices().len()] {
        keys[start as usize..end as usize].sort_unstable();
        start = end;
    }
    keys.into_iter().map(|key| HalfEdgeId(key as u32)).collect()
}

fn faces_of_vertices(mesh: &Mesh) -> (Vec<u32>, Vec<FaceId>) {
    let mut starts = vec![0u32; mesh.vertices().len() + 1];
    for &i in mesh.faces().iter().flatten() {
        starts[i as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut cursor = starts.clone();
    let mut faces = vec![FaceId(0); 3 * mesh.faces().len()];
    for (f, corners) in mesh.faces().iter().enumerate() {
        for &i in corners {
            faces[cursor[i as usize] as usize] = FaceId(f as u32);
            cursor[i as usize] += 1;
        }
    }
    (starts, faces)
}

/// Faces are labelled in turn like their neighbours before them; labels that meet are joined, and so are
/// those around odd edges.
fn components(
    twins: &[u32],
    odd: &[&Edge],
    around: &[HalfEdgeId],
) -> (Vec<ComponentId>, Vec<Component>) {
    const UNLABELLED: u32 = u32::MAX;
    let mut labels: Vec<u32> = Vec::with_capacity(twins.len() / 3);
    let mut sets = DisjointSets::new(0);
    let mut components: Vec<Component> = Vec::new();
    let (faces, _) = twins.as_chunks::<3>();
    for (face, twins) in (0..).map(FaceId).zip(faces) {
        let mut label = UNLABELLED;
        for twin in twins {
            let Some(&other) = labels.get(*twin as usize / 3) else { continue };
            if label == UNLABELLED {
                label = other;
            } else if label != other {
                sets.union(label as usize, other as usize);
            }
        }
        if label == UNLABELLED {
            label = sets.add() as u32;
            components.push(Component { first_face: face, faces: 0, closed: true });
        }
        labels.push(label);
    }
    let group = |e: &Edge| &around[e.first as usize..(e.first + e.count) as usize];
    let label_of = |h: HalfEdgeId| labels[h.face().index()] as usize;
    for pair in odd.iter().flat_map(|edge| group(edge).windows(2)) {
        sets.union(label_of(pair[0]), label_of(pair[1]));
    }
    // A set's least label is that of its least face.
    let mut count = 0;
    let mut component_of_label: Vec<ComponentId> = Vec::with_capacity(components.len());
    for label in 0..components.len() {
        let root = sets.find(label);
        let component = if root == label {
            components[count] = components[label];
            count += 1;
            ComponentId(count as u32 - 1)
        } else {
            component_of_label[root]
        };
        component_of_label.push(component);
    }
    components.truncate(count);
    let component_of: Vec<ComponentId> =
        labels.iter().map(|&label| component_of_label[label as usize]).collect();
    for run in component_of.chunk_by(|a, b| a == b) {
        components[run[0].index()].faces += run.len() as u32;
    }
    for edge in odd.iter().filter(|e| !e.kind.is_balanced()) {
        let component = component_of[group(edge)[0].face().index()];
        components[component.index()].closed = false;
    }
    (component_of, components)
}

/// Union–find with path halving; the representative of a set is its least member.
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<u32>);

impl DisjointSets {
    /// `count` sets of one member each.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// One more set of one member, whose number is returned.
    fn add(&mut self) -> usize {
        let member = self.0.len();
        self.0.push(member as u32);
        member
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
    pub fn union(&mut self, i: usize, j: usize) {
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
    fn two_separate_solids_are_two_components() {
        let mut faces = tetrahedron(0);
        faces.extend(tetrahedron(4));
        let topology = Topology::of(&Mesh::new(points(8), faces).unwrap());
        assert_eq!(topology.components().len(), 2);
        assert_eq!(topology.components()[1].first_face, FaceId(4));
        assert_eq!(topology.component_of(FaceId(7)), ComponentId(1));
    }
}
