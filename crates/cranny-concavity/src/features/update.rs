//! Features after some vertices have moved.
//!
//! A face's facet depends on its corners alone, a needle's also on the faces that it hangs together
//! with over other needles. An edge depends on its faces and its ends, a vertex on its faces and on
//! the edges around it. So what is looked at again is the faces of vertices that have moved or lie
//! on other facets than before, the needles beside them, and the edges and corners of all these.
//! Only where a face comes onto the hull or leaves it the convex sets are counted anew: a pass over
//! all edges, a few nanoseconds each.
//!
//! No source: this crate's own, and right because a feature depends on nothing but what is named
//! above. Cost: what is looked at again and the passes named; where the hull has changed, also
//! passes over all vertices, facets and faces.

use std::collections::BTreeSet;

use super::assign::{Assignment, NONE};
use super::vertices::facets_at;
use super::{Features, RidgeOnFacet, convex_sets, judge_edge, judge_vertex};
use cranny_geometry::hull::FacetChange;
use cranny_geometry::{EdgeId, FaceId, HalfEdgeId, Mesh, Model, Topology, VertexId, each_once};

/// A face that lies on another facet than it did, or was judged because its facet is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reassigned {
    pub(crate) face: FaceId,
    /// The facet that it lay on, as it is numbered now; [`NONE`] for none that is still there.
    pub(crate) before: u32,
    /// The facet that it lies on; [`NONE`] for none.
    pub(crate) after: u32,
    /// Whether it came onto the hull or left it.
    pub(crate) changes_class: bool,
}

/// What was judged again.
pub(crate) struct Judged {
    /// All faces judged.
    pub(crate) faces: BTreeSet<FaceId>,
    /// Those that are on another facet, ascending.
    pub(crate) reassigned: Vec<Reassigned>,
}

impl Assignment {
    /// After vertices have moved that were and are none of the hull, which is the same: judges them
    /// and `faces`, all that have one of them. `features` are still those before.
    pub(crate) fn update(
        &mut self,
        model: &Model,
        features: &Features,
        moved: &[VertexId],
        faces: &[FaceId],
    ) -> Judged {
        for &v in moved {
            let mut found = Vec::new();
            self.slabs.around(model.mesh().position(v), &mut found);
            self.moved.insert(v.0, found);
        }
        self.settle();
        self.judge(model, features, faces.iter().copied().collect())
    }

    /// After vertices have moved and facets of the hull have changed: judges these vertices, those
    /// in slabs that are gone or new, and the faces of those that lie on other facets than before.
    /// `features` are still those before.
    ///
    /// Cost: what is judged, and a look at which facet each face is on.
    pub(crate) fn follow(
        &mut self,
        model: &Model,
        features: &Features,
        change: &FacetChange,
        moved: &[VertexId],
        ridges: &mut Vec<RidgeOnFacet>,
    ) -> Judged {
        let (mesh, topology, hull) = (model.mesh(), model.topology(), model.hull());
        let mut vertices: BTreeSet<VertexId> = moved.iter().copied().collect();
        let mut faces = BTreeSet::new();
        let is_gone = |f: u32| change.gone.binary_search(&f).is_ok();
        for bounds in self.slabs.follow(hull, change) {
            let (within, reaching) = model.tree().vertices_within(mesh, &bounds);
            vertices.extend(within);
            faces.extend(reaching);
        }
        for v in vertices {
            let found = match hull.vertex_of_source(v) {
                Some(corner) => facets_at(hull, corner),
                None => {
                    let mut found = Vec::new();
                    self.slabs.around(mesh.position(v), &mut found);
                    found
                }
            };
            let before = self.facets_of(v);
            // Within its facet a face may have folded over.
            let has_moved =
                moved.binary_search(&v).is_ok() && !(before.is_empty() && found.is_empty());
            if has_moved || before != found || before.iter().any(|&f| is_gone(f)) {
                faces.extend(topology.faces_at(v));
                self.moved.insert(v.0, found);
            }
        }
        self.settle();
        ridges.retain(|ridge| {
            let stays = !is_gone(ridge.facet);
            if !stays {
                faces.extend(ridge.ends.iter().flat_map(|&v| topology.faces_at(VertexId(v))));
            }
            stays
        });
        if let (Some(&first), Some(&last)) = (change.gone.first(), change.gone.last()) {
            for (face, facet) in (0..).map(FaceId).zip(&mut self.facet_of_face) {
                if (first..=last).contains(facet) && is_gone(*facet) {
                    *facet = NONE;
                    faces.insert(face);
                }
            }
        }
        self.judge(model, features, faces)
    }

    /// Places faces, and needles that hang on them, again.
    fn judge(&mut self, model: &Model, features: &Features, mut faces: BTreeSet<FaceId>) -> Judged {
        let (mesh, topology) = (model.mesh(), model.topology());
        let mut front: Vec<FaceId> = faces.iter().copied().collect();
        while let Some(face) = front.pop() {
            for twin in (0..3).filter_map(|c| topology.twin(HalfEdgeId::of(face, c))) {
                let beside = twin.face();
                let hangs_on =
                    self.may_lie_on_a_facet(mesh, beside) && self.is_needle(mesh, beside);
                if hangs_on && faces.insert(beside) {
                    front.push(beside);
                }
            }
        }
        let before: Vec<u32> = faces.iter().map(|f| self.facet_of_face[f.index()]).collect();
        self.assign_faces(model, faces.iter().copied());
        let changed = faces.iter().zip(before).filter_map(|(&face, before)| {
            let after = self.facet_of_face[face.index()];
            let changes_class = features.is_convex(face) != (after != NONE);
            let change = Reassigned { face, before, after, changes_class };
            (after != before || changes_class).then_some(change)
        });
        Judged { reassigned: changed.collect(), faces }
    }
}

impl Features {
    /// Follows an [`Assignment`] that has judged faces again. `ridges` lists ridges by
    /// facet, and is kept so; returned are the facets whose ridges have changed, ascending.
    pub(crate) fn update(
        &mut self,
        model: &Model,
        assignment: &Assignment,
        judged: &Judged,
        ridges: &mut Vec<RidgeOnFacet>,
    ) -> Vec<u32> {
        let (mesh, topology) = (model.mesh(), model.topology());
        for face in &judged.faces {
            self.facet_of_face[face.index()] = assignment.facet_of_face[face.index()];
        }
        self.slab_depth = assignment.depth();
        if judged.reassigned.iter().any(|change| change.changes_class) {
            (self.set_of_face, self.sets) = convex_sets(topology, &self.facet_of_face);
        }
        let looked_at = &judged.faces;
        let edges: BTreeSet<EdgeId> = looked_at
            .iter()
            .flat_map(|&f| (0..3).map(move |c| topology.edge_of(HalfEdgeId::of(f, c))))
            .collect();
        let stale = self.judge_edges(mesh, topology, assignment, &edges, ridges);
        let vertices: BTreeSet<VertexId> =
            looked_at.iter().flat_map(|&f| mesh.corners(f)).collect();
        self.judge_vertices(topology, assignment, &vertices);
        stale
    }

    fn judge_edges(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        assignment: &Assignment,
        edges: &BTreeSet<EdgeId>,
        ridges: &mut Vec<RidgeOnFacet>,
    ) -> Vec<u32> {
        let mut fresh = Vec::new();
        let mut fresh_ridges = Vec::new();
        for &e in edges {
            let (feature, on_facets) = judge_edge(mesh, topology, assignment, e);
            self.edges[e.index()] = feature;
            if !on_facets.is_empty() {
                fresh_ridges.push(e);
                fresh.extend(on_facets);
            }
        }
        fresh.sort_unstable();
        let among = |r: &RidgeOnFacet| {
            let edge = topology.edge_between(r.ends.map(VertexId));
            edge.is_some_and(|e| edges.contains(&e))
        };
        let had_any = edges.iter().any(|e| self.ridges.binary_search(e).is_ok());
        if !had_any && fresh.is_empty() {
            return Vec::new();
        }
        let stale: Vec<RidgeOnFacet> = ridges.iter().copied().filter(among).collect();
        if stale != fresh {
            ridges.retain(|r| !among(r));
            ridges.extend(&fresh);
            ridges.sort_unstable();
        }
        self.ridges.retain(|e| !edges.contains(e));
        self.ridges.extend(fresh_ridges);
        self.ridges.sort_unstable();
        // A ridge that is the same edge may have moved.
        each_once(stale.iter().chain(&fresh).map(|r| r.facet))
    }

    fn judge_vertices(
        &mut self,
        topology: &Topology,
        assignment: &Assignment,
        vertices: &BTreeSet<VertexId>,
    ) {
        self.isolated.retain(|v| !vertices.contains(v));
        for &v in vertices {
            let (feature, alone) = judge_vertex(topology, assignment, v);
            self.vertices[v.index()] = feature;
            if alone && !self.is_on_ridge(topology, v) {
                self.isolated.push(v);
            }
        }
        self.isolated.sort_unstable();
    }

    fn is_on_ridge(&self, topology: &Topology, vertex: VertexId) -> bool {
        topology.faces_at(vertex).iter().any(|&face| {
            (0..3).map(|c| topology.edge_of(HalfEdgeId::of(face, c))).any(|e| {
                let edge = topology.edges()[e.index()];
                (edge.from == vertex || edge.to == vertex) && self.ridges.binary_search(&e).is_ok()
            })
        })
    }
}
