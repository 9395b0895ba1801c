//! Features: what lies on the hull, what does not, and what borders both.
//!
//! A **convex** face lies on a facet of the hull, to within its slab; every other face is part of a
//! **concavity**, even where its corners are all on the hull (the flanks of a groove across a block
//! are an example: their ends lie on the block's sides). An edge or vertex between faces of both
//! classes is a **boundary** feature. Edges and vertices of off-hull faces alone count as convex
//! where they lie on the hull: a *ridge* is such an edge (a tooth's crest as sharp as a knife), an
//! *isolated* vertex such a vertex. The small stellated dodecahedron has no convex face and twelve
//! isolated vertices.
//!
//! Convex faces that hang together over edges are a *convex set*: a golf ball has one.
//!
//! Cost: O(n log n), as a rule less than the hull itself.
//!
//! No source: the classes are this crate's own definitions, and each follows from what lies on
//! which facet.

mod assign;
mod slabs;
mod update;
mod vertices;

pub(crate) use assign::{Assignment, NONE};
pub(crate) use update::Judged;

use crate::ids::ConvexSetId;
use cranny_geometry::hull::FacetId;
use cranny_geometry::{DisjointSets, EdgeId, FaceId, HalfEdgeId, Mesh, Model, Topology, VertexId};

/// Where a vertex or an edge of the mesh lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// On the hull, among convex faces or alone.
    Convex,
    /// Between a convex face and one of a concavity.
    Boundary,
    /// Off the hull.
    Concavity,
}

/// Faces on the hull that hang together over edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConvexSet {
    /// Its least face.
    pub first_face: FaceId,
    /// Number of faces.
    pub faces: u32,
}

/// The classification of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    facet_of_face: Vec<u32>,
    set_of_face: Vec<u32>,
    sets: Vec<ConvexSet>,
    vertices: Vec<Feature>,
    edges: Vec<Feature>,
    isolated: Vec<VertexId>,
    ridges: Vec<EdgeId>,
    slab_depth: f64,
}

/// A ridge and a facet that it lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct RidgeOnFacet {
    pub(crate) facet: u32,
    pub(crate) ends: [u32; 2],
}

impl Features {
    /// Classifies the features of a model.
    ///
    /// Cost: O(n log n), as a rule less than the hull itself.
    #[must_use]
    pub fn of(model: &Model) -> Self {
        Self::classified(model, &Assignment::of(model)).0
    }

    /// Classifies by an assignment of faces to facets; the second part lists ridges by facet.
    pub(crate) fn classified(model: &Model, assignment: &Assignment) -> (Self, Vec<RidgeOnFacet>) {
        let (mesh, topology) = (model.mesh(), model.topology());
        let (set_of_face, sets) = convex_sets(topology, &assignment.facet_of_face);
        let mut ridges = Vec::new();
        let mut ridges_on_facets = Vec::new();
        let on_hull = assignment.vertices_on_hull();
        let mut edges = Vec::with_capacity(topology.edges().len());
        for (e, edge) in (0..).map(EdgeId).zip(topology.edges()) {
            // Most edges of a body whose hull is small.
            if !(on_hull[edge.from.index()] & on_hull[edge.to.index()]) {
                edges.push(Feature::Concavity);
                continue;
            }
            let (feature, on_facets) = judge_edge(mesh, topology, assignment, e);
            edges.push(feature);
            if !on_facets.is_empty() {
                ridges.push(e);
                ridges_on_facets.extend(on_facets);
            }
        }
        let mut isolated = Vec::new();
        let mut on_ridge = vec![false; mesh.vertices().len()];
        for e in &ridges {
            let edge = topology.edges()[e.index()];
            on_ridge[edge.from.index()] = true;
            on_ridge[edge.to.index()] = true;
        }
        let vertex = |v: VertexId| {
            let (feature, alone) = judge_vertex(topology, assignment, v);
            if alone && !on_ridge[v.index()] {
                isolated.push(v);
            }
            feature
        };
        let vertices = mesh.vertex_ids().map(vertex).collect();
        ridges_on_facets.sort_unstable();
        let features = Self {
            facet_of_face: assignment.facet_of_face.clone(),
            set_of_face,
            sets,
            vertices,
            edges,
            isolated,
            ridges,
            slab_depth: assignment.depth(),
        };
        (features, ridges_on_facets)
    }

    /// The facet of the hull that a face lies on; `None` where it belongs to a concavity.
    ///
    /// # Panics
    ///
    /// Where there is no such face; so do the functions below for their ids.
    #[must_use]
    pub fn facet_of(&self, face: FaceId) -> Option<FacetId> {
        let facet = self.facet_of_face[face.index()];
        (facet != NONE).then_some(FacetId(facet))
    }

    /// The convex set of a face; `None` where it belongs to a concavity.
    #[must_use]
    pub fn convex_set_of(&self, face: FaceId) -> Option<ConvexSetId> {
        let set = self.set_of_face[face.index()];
        (set != NONE).then_some(ConvexSetId(set))
    }

    /// Of each face the facet that it lies on, or [`NONE`].
    pub(crate) fn facets_of_faces(&self) -> &[u32] {
        &self.facet_of_face
    }

    /// Whether a face lies on the hull.
    #[must_use]
    pub fn is_convex(&self, face: FaceId) -> bool {
        self.facet_of_face[face.index()] != NONE
    }

    /// The convex sets, by ascending first face.
    #[must_use]
    pub fn convex_sets(&self) -> &[ConvexSet] {
        &self.sets
    }

    /// Where a vertex lies.
    #[must_use]
    pub fn vertex(&self, vertex: VertexId) -> Feature {
        self.vertices[vertex.index()]
    }

    /// Where an edge lies.
    #[must_use]
    pub fn edge(&self, edge: EdgeId) -> Feature {
        self.edges[edge.index()]
    }

    /// Number of edges between a convex face and one of a concavity.
    #[must_use]
    pub fn boundary_edge_count(&self) -> usize {
        self.edges.iter().filter(|&&e| e == Feature::Boundary).count()
    }

    /// Vertices on the hull that no convex face and no ridge touches, ascending.
    #[must_use]
    pub fn isolated_vertices(&self) -> &[VertexId] {
        &self.isolated
    }

    /// Edges on the hull whose faces are all off it, ascending.
    #[must_use]
    pub fn ridges(&self) -> &[EdgeId] {
        &self.ridges
    }

    /// How deep beneath the hull a feature may lie and still be on it, at least: pockets no deeper
    /// are skin. A facet thicker than that makes its own slab as deep as it is thick.
    #[must_use]
    pub fn slab_depth(&self) -> f64 {
        self.slab_depth
    }

    /// Checks the invariants; for tests and debugging.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate(&self, mesh: &Mesh, topology: &Topology) -> Result<(), String> {
        let mut counted = vec![0u32; self.sets.len()];
        for f in mesh.face_ids() {
            if self.facet_of(f).is_some() != self.convex_set_of(f).is_some() {
                return Err(format!("face {} has a facet or a convex set, not both", f.0));
            }
            if let Some(set) = self.convex_set_of(f) {
                counted[set.index()] += 1;
            }
        }
        for (set, &count) in self.sets.iter().zip(&counted) {
            if set.faces != count || !self.is_convex(set.first_face) {
                return Err(format!("convex set of face {} miscounts", set.first_face.0));
            }
        }
        for (e, feature) in self.edges.iter().enumerate() {
            let around = topology.half_edges(EdgeId(e as u32));
            let sets: Vec<_> = around.iter().filter_map(|h| self.convex_set_of(h.face())).collect();
            let borders = !sets.is_empty() && sets.len() < around.len();
            if borders != (*feature == Feature::Boundary) {
                return Err(format!("edge {e} is filed as {feature:?}"));
            }
            if sets.windows(2).any(|pair| pair[0] != pair[1]) {
                return Err(format!("edge {e} joins two convex sets"));
            }
        }
        Ok(())
    }
}

/// Where an edge lies, and the facets that it lies on if it is a ridge.
fn judge_edge(
    mesh: &Mesh,
    topology: &Topology,
    assignment: &Assignment,
    id: EdgeId,
) -> (Feature, Vec<RidgeOnFacet>) {
    let edge = topology.edges()[id.index()];
    // Faces on the hull have all corners there.
    if assignment.facets_of(edge.from).is_empty() || assignment.facets_of(edge.to).is_empty() {
        return (Feature::Concavity, Vec::new());
    }
    let around = topology.half_edges(id);
    let on_hull = |h: &&HalfEdgeId| assignment.facet_of_face[h.face().index()] != NONE;
    match around.iter().filter(on_hull).count() {
        0 => {
            if edge.from == edge.to {
                return (Feature::Concavity, Vec::new()); // the short side of a collapsed face
            }
            let facets = assignment.facets_of_segment(mesh, [edge.from, edge.to]);
            if facets.is_empty() {
                return (Feature::Concavity, Vec::new());
            }
            let ends = [edge.from.0, edge.to.0];
            let ridge = |facet| RidgeOnFacet { facet, ends };
            (Feature::Convex, facets.into_iter().map(ridge).collect())
        }
        n if n == around.len() => (Feature::Convex, Vec::new()),
        _ => (Feature::Boundary, Vec::new()),
    }
}

/// Where a vertex lies, and whether it lies on the hull without a convex face.
fn judge_vertex(topology: &Topology, assignment: &Assignment, v: VertexId) -> (Feature, bool) {
    // Faces on the hull have all corners there.
    if assignment.facets_of(v).is_empty() {
        return (Feature::Concavity, false);
    }
    let faces = topology.faces_at(v);
    match faces.iter().filter(|f| assignment.facet_of_face[f.index()] != NONE).count() {
        0 => (Feature::Convex, true),
        n if n == faces.len() => (Feature::Convex, false),
        _ => (Feature::Boundary, false),
    }
}

/// Faces on the hull, joined over edges.
fn convex_sets(topology: &Topology, facet_of_face: &[u32]) -> (Vec<u32>, Vec<ConvexSet>) {
    let on_hull = |f: FaceId| facet_of_face[f.index()] != NONE;
    let mut joined = DisjointSets::new(facet_of_face.len());
    for face in (0..facet_of_face.len() as u32).map(FaceId).filter(|&face| on_hull(face)) {
        for half_edge in [0, 1, 2].map(|corner| HalfEdgeId::of(face, corner)) {
            // Of two faces the lesser one, of more each speaks for all.
            if let Some(twin) = topology.twin(half_edge) {
                if half_edge < twin && on_hull(twin.face()) {
                    joined.union(face.index(), twin.face().index());
                }
                continue;
            }
            let around = topology.half_edges(topology.edge_of(half_edge)).iter();
            let convex = around.map(|h| h.face()).filter(|&f| on_hull(f));
            convex.for_each(|f| joined.union(face.index(), f.index()));
        }
    }
    let mut sets: Vec<ConvexSet> = Vec::new();
    let mut set_of_root = vec![NONE; facet_of_face.len()];
    let set_of_face = (0..facet_of_face.len())
        .map(|f| {
            let face = FaceId(f as u32);
            if !on_hull(face) {
                return NONE;
            }
            let root = joined.find(f);
            if set_of_root[root] == NONE {
                set_of_root[root] = sets.len() as u32;
                sets.push(ConvexSet { first_face: face, faces: 0 });
            }
            sets[set_of_root[root] as usize].faces += 1;
            set_of_root[root]
        })
        .collect();
    (set_of_face, sets)
}
