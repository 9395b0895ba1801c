//! The order of half-edges, and the edges that follow from it. Source and cost stand with the
//! module.

use crate::ids::{EdgeId, FaceId, HalfEdgeId, VertexId};
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

/// How a half-edge runs, in one word: where from, where to.
#[derive(Clone, Copy)]
struct DirectedEdge(u64);

impl DirectedEdge {
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
pub(super) struct Edges {
    pub(super) edges: Vec<Edge>,
    /// Where the half-edges of each edge begin, and one more, where the last end; none where all
    /// stand in pairs.
    pub(super) starts: Vec<u32>,
    pub(super) edge_of: Vec<EdgeId>,
    pub(super) is_sorted: bool,
    /// Whether all are between two faces that run along them in opposite directions.
    pub(super) is_paired: bool,
}

impl Edges {
    /// From all half-edges of a mesh, by edge, along an edge by number; in the end it is known
    /// whether they are sorted so. `join` is called for faces that share an edge. Near linear.
    pub(super) fn of(
        mesh: &Mesh,
        around: &[HalfEdgeId],
        mut join: impl FnMut(FaceId, FaceId),
    ) -> Self {
        let runs = runs_of(mesh);
        let of_pairs = Self::of_pairs(runs.as_flattened(), around, &mut join);
        of_pairs.unwrap_or_else(|| Self::of_groups(runs.as_flattened(), around, &mut join))
    }

    /// In short steps, where all edges are between two faces and two vertices, and sorted.
    fn of_pairs(
        runs: &[DirectedEdge],
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
        let blank = Edge { from, to, kind: EdgeKind::Manifold };
        let mut edges = vec![blank; pairs.len()];
        for (id, (edge, &[g, h])) in edges.iter_mut().zip(pairs).enumerate() {
            let id = id as u32;
            let (run, other) = (runs[g.index()], runs[h.index()]);
            if !run.is_opposite(other) || g > h || run.edge() <= before {
                return None;
            }
            before = run.edge();
            let (from, to) = ends(before);
            *edge = Edge { from, to, kind: EdgeKind::Manifold };
            edge_of[g.index()] = EdgeId(id);
            edge_of[h.index()] = EdgeId(id);
            join(g.face(), h.face());
        }
        Some(Self { edges, starts: Vec::new(), edge_of, is_sorted: true, is_paired: true })
    }

    /// In any case.
    fn of_groups(
        runs: &[DirectedEdge],
        around: &[HalfEdgeId],
        join: &mut impl FnMut(FaceId, FaceId),
    ) -> Self {
        let mut edges = Vec::with_capacity(around.len() / 2);
        let mut edge_of = vec![EdgeId(0); runs.len()];
        let mut is_sorted = true;
        let mut before = None;
        let mut starts = vec![0];
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
            // An edge from a vertex to itself is the short side of a collapsed face: nothing to
            // match.
            let is_balanced = from == to || 2 * forward == group.len();
            let kind = match (group.len(), is_balanced) {
                (1, false) => EdgeKind::Open,
                (2, true) => EdgeKind::Manifold,
                (2, false) => EdgeKind::Contradictory,
                (_, true) => EdgeKind::Balanced,
                (_, false) => EdgeKind::Tangled,
            };
            edges.push(Edge { from, to, kind });
            starts.push(starts[starts.len() - 1] + group.len() as u32);
        }
        Self { edges, starts, edge_of, is_sorted, is_paired: false }
    }
}

/// How the half-edges of each face run.
fn runs_of(mesh: &Mesh) -> Vec<[DirectedEdge; 3]> {
    let of_face = |&[a, b, c]: &[u32; 3]| [(a, b), (b, c), (c, a)].map(DirectedEdge::new);
    mesh.faces().iter().map(of_face).collect()
}

fn ascending((a, b): (u32, u32)) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// All half-edges, sorted by edge, along an edge by number: dealt out to their greater ends, and in
/// that order to their lesser ones.
pub(super) fn sorted_half_edges(mesh: &Mesh) -> Vec<HalfEdgeId> {
    // Where the next half-edge of each vertex goes, by the lesser end and by the greater.
    let mut places = vec![[0u32; 2]; mesh.vertices().len() + 1];
    for &[a, b, c] in mesh.faces() {
        for (from, to) in [(a, b), (b, c), (c, a)].map(ascending) {
            places[from as usize + 1][0] += 1;
            places[to as usize + 1][1] += 1;
        }
    }
    let mut before = [0; 2];
    for place in &mut places {
        before = [before[0] + place[0], before[1] + place[1]];
        *place = before;
    }
    let mut by_greater = vec![0u64; 3 * mesh.faces().len()];
    for (first, &[a, b, c]) in (0u64..).step_by(3).zip(mesh.faces()) {
        for (h, (from, to)) in (first..).zip([(a, b), (b, c), (c, a)].map(ascending)) {
            let place = &mut places[to as usize][1];
            by_greater[*place as usize] = u64::from(from) << 32 | h;
            *place += 1;
        }
    }
    let mut sorted = vec![HalfEdgeId(0); by_greater.len()];
    for key in by_greater {
        let place = &mut places[(key >> 32) as usize][0];
        sorted[*place as usize] = HalfEdgeId(key as u32);
        *place += 1;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::super::Topology;
    use super::super::tests::points;
    use super::*;

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
}
