//! Which faces off the hull and which cap triangles belong together.
//!
//! They hang together over the edges that they share, except over a *ridge*, an edge on the hull
//! that only off-hull faces meet at: there each face goes with the cap triangle that runs the edge
//! the same way. (Cap and faces of a pocket run its rim in the same direction, since both continue,
//! in reverse, the convex faces around. So at every edge the caps of a concavity, taken once, and
//! its faces, taken negatively, cancel, with or without ridges.)
//!
//! No source: this crate's own, proved in brackets above; sets are joined by union-find
//! (`DisjointSets`). Cost: O(m log m) for m cap triangles, near-linear in the faces.

use super::input::Input;
use crate::caps::CapSurface;
use crate::features::Features;
use cranny_geometry::{DisjointSets, Edge, EdgeId, FaceId, HalfEdgeId, Topology, VertexId};

/// Which elements belong together. Element `f` is a face, element `faces + c` a cap triangle.
pub(super) struct Components {
    faces: usize,
    elements: DisjointSets,
    lids: DisjointSets,
}

/// A half-edge of a cap triangle, by the edge.
#[derive(Clone, Copy)]
struct CapEdge {
    ends: (u32, u32),
    backward: bool,
    cap: u32,
}

impl Components {
    /// O(n log n) in the cap triangles, near linear in the faces.
    pub(super) fn of(input: &Input<'_>, caps: &CapSurface) -> Self {
        let &Input { mesh, topology, features, .. } = input;
        let faces = mesh.faces().len();
        let mut joined = Self {
            faces,
            elements: DisjointSets::new(faces + caps.triangles.len()),
            lids: DisjointSets::new(caps.triangles.len()),
        };
        let mut has_cap = vec![false; topology.edges().len()];
        let (mut at, mut off) = (0, Vec::new());
        // Edges of caps and of the mesh stand in one order.
        for group in cap_edges(&caps.triangles).chunk_by(|a, b| a.ends == b.ends) {
            let ends = |e: &Edge| (e.from.0, e.to.0);
            let edges = &topology.edges()[at..];
            at += edges.iter().take_while(|e| ends(e) < group[0].ends).count();
            off.clear();
            if topology.edges().get(at).is_some_and(|e| ends(e) == group[0].ends) {
                has_cap[at] = true;
                off_hull(input, EdgeId(at as u32), &mut off);
            }
            joined.join_at_cap(group, &off);
        }
        let join = |joined: &mut Self, pair: [HalfEdgeId; 2]| {
            let [f, g] = pair.map(HalfEdgeId::face);
            if !features.is_convex(f) && !features.is_convex(g) {
                joined.elements.union(f.index(), g.index());
            }
        };
        if let Some(pairs) = topology.pairs() {
            let without_cap = pairs.iter().zip(&has_cap).filter(|&(_, &has_cap)| !has_cap);
            without_cap.for_each(|(&pair, _)| join(&mut joined, pair));
            joined.join_at_tips(topology, features, caps);
            return joined;
        }
        for e in topology.edge_ids().filter(|e| !has_cap[e.index()]) {
            if let [g, h] = *topology.half_edges(e) {
                join(&mut joined, [g, h]);
                continue;
            }
            let off = topology.half_edges(e).iter().map(|h| h.face());
            joined.unite(off.filter(|&f| !features.is_convex(f)).map(FaceId::index));
        }
        joined.join_at_tips(topology, features, caps);
        joined
    }

    /// A surface that shares no edge with a cap but has a vertex on the hull goes with the caps
    /// around that vertex: a star touches its hull with its tips alone.
    fn join_at_tips(&mut self, topology: &Topology, features: &Features, caps: &CapSurface) {
        let mut has_cap = vec![false; self.faces];
        for cap in 0..caps.triangles.len() {
            let root = self.of_cap(cap);
            if root < self.faces {
                has_cap[root] = true;
            }
        }
        let mut tips: Vec<(u32, usize)> = Vec::new();
        for &tip in features.isolated_vertices() {
            let roots = topology.faces_at(tip).iter().map(|&f| self.of_face(f));
            tips.extend(roots.filter(|&root| !has_cap[root]).map(|root| (tip.0, root)));
        }
        if tips.is_empty() {
            return;
        }
        for (cap, corners) in caps.triangles.iter().enumerate() {
            for corner in corners {
                let first = tips.partition_point(|&(tip, _)| tip < *corner);
                for &(_, root) in tips[first..].iter().take_while(|&&(tip, _)| tip == *corner) {
                    self.elements.union(root, self.faces + cap);
                }
            }
        }
    }

    /// The same for some of the faces off the hull and some of the caps, both ascending, which are
    /// numbered anew; what meets at an edge of `ends`, which ascend, must be among them. Nothing is
    /// joined at tips.
    pub(super) fn among(
        input: &Input<'_>,
        faces: &[FaceId],
        triangles: &[[u32; 3]],
        ends: &[(u32, u32)],
    ) -> Self {
        let mut joined = Self {
            faces: faces.len(),
            elements: DisjointSets::new(faces.len() + triangles.len()),
            lids: DisjointSets::new(triangles.len()),
        };
        let mut edges = cap_edges(triangles);
        edges.retain(|edge| ends.binary_search(&edge.ends).is_ok());
        let mut groups = edges.chunk_by(|a, b| a.ends == b.ends).peekable();
        let mut off = Vec::new();
        for &ends in ends {
            off.clear();
            if let Some(edge) = input.topology.edge_between([ends.0, ends.1].map(VertexId)) {
                off_hull(input, edge, &mut off);
            }
            let local = |face: usize| faces.binary_search(&FaceId(face as u32)).ok();
            let off: Vec<_> = off.iter().filter_map(|&(f, way)| Some((local(f)?, way))).collect();
            match groups.next_if(|group| group[0].ends == ends) {
                Some(group) => joined.join_at_cap(group, &off),
                None => joined.unite(off.into_iter().map(|f| f.0)),
            }
        }
        joined
    }

    /// The least element that a face belongs with.
    pub(super) fn of_face(&mut self, face: FaceId) -> usize {
        self.elements.find(face.index())
    }

    /// The least element that a cap triangle belongs with: a face, if there is any.
    pub(super) fn of_cap(&mut self, cap: usize) -> usize {
        self.elements.find(self.faces + cap)
    }

    /// The least cap triangle of the same lid.
    pub(super) fn lid_of(&mut self, cap: usize) -> usize {
        self.lids.find(cap)
    }

    /// Joins what meets at one edge: cap triangles and off-hull faces with their directions.
    fn join_at_cap(&mut self, caps: &[CapEdge], off: &[(usize, bool)]) {
        let count = |backward: bool| {
            let caps = caps.iter().filter(|c| c.backward == backward).count();
            (caps, off.iter().filter(|f| f.1 == backward).count())
        };
        let (forward, backward) = (count(false), count(true));
        let is_rim = !off.is_empty() && forward.0 == forward.1 && backward.0 == backward.1;
        let faces = self.faces;
        if is_rim {
            for way in [false, true] {
                let of_caps = caps.iter().filter(|c| c.backward == way).map(|c| c.cap as usize);
                let of_faces = off.iter().filter(|f| f.1 == way).map(|f| f.0);
                self.unite(of_caps.map(|c| faces + c).chain(of_faces));
            }
            return;
        }
        let of_caps = caps.iter().map(|c| faces + c.cap as usize);
        self.unite(of_caps.chain(off.iter().map(|f| f.0)));
        for pair in caps.windows(2) {
            self.lids.union(pair[0].cap as usize, pair[1].cap as usize);
        }
    }

    fn unite(&mut self, mut elements: impl Iterator<Item = usize>) {
        if let Some(first) = elements.next() {
            elements.for_each(|other| self.elements.union(first, other));
        }
    }
}

/// All half-edges of cap triangles, sorted by edge.
fn cap_edges(triangles: &[[u32; 3]]) -> Vec<CapEdge> {
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for (cap, [a, b, c]) in triangles.iter().copied().enumerate() {
        edges.extend([(a, b), (b, c), (c, a)].map(|(from, to)| CapEdge {
            ends: (from.min(to), from.max(to)),
            backward: from > to,
            cap: cap as u32,
        }));
    }
    let key = |e: &CapEdge| {
        let [low, high, cap] = [e.ends.0, e.ends.1, e.cap].map(u64::from);
        (low << 32 | high, u64::from(e.backward) << 32 | cap)
    };
    edges.sort_unstable_by_key(key);
    edges
}

/// Appends the off-hull faces at an edge, and whether they run it backward.
fn off_hull(input: &Input<'_>, edge: EdgeId, off: &mut Vec<(usize, bool)>) {
    let Input { mesh, topology, features, .. } = input;
    let from = topology.edges()[edge.index()].from;
    let half_edges = topology.half_edges(edge).iter();
    off.extend(
        half_edges
            .filter(|h| !features.is_convex(h.face()))
            .map(|h| (h.face().index(), mesh.corners(h.face())[h.corner()] != from)),
    );
}
