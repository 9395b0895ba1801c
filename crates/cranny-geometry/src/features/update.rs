//! Features after some vertices have moved and the hull has not changed.
//!
//! A face's facet depends on its corners alone, a needle's also on the faces that it hangs together
//! with over other needles. An edge depends on its faces and its ends, a vertex on its faces and on the
//! edges around it. So what is looked at again is the faces of moved vertices, the needles beside them,
//! and the edges and corners of all these. Only where a face comes onto the hull or leaves it the convex
//! sets are counted anew: a pass over all edges, a few nanoseconds each.

use std::collections::BTreeSet;

use super::assign::{Assignment, NONE};
use super::{Features, RidgeOnFacet, convex_sets, judge_edge, judge_vertex};
use crate::ids::{EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::topology::Topology;

/// A face that lies on another facet than it did, and that one; [`NONE`] for none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reassigned {
    pub(crate) face: FaceId,
    pub(crate) before: u32,
    pub(crate) after: u32,
}

impl Reassigned {
    /// Whether the face came onto the hull or left it.
    pub(crate) fn changes_class(&self) -> bool {
        (self.before == NONE) != (self.after == NONE)
    }
}

impl Assignment {
    /// Judges moved vertices and the faces that they take along again. `moved` are no vertices of the
    /// hull; `faces` are all that have one of them, ascending. Returns the faces whose facet has changed,
    /// ascending, and how many were judged.
    pub(crate) fn update(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        moved: &[VertexId],
        faces: &[FaceId],
    ) -> (Vec<Reassigned>, usize) {
        for &v in moved {
            let mut found = Vec::new();
            self.slabs.around(mesh.position(v), &mut found);
            self.moved.insert(v.0, found);
        }
        let mut judged: BTreeSet<FaceId> = faces.iter().copied().collect();
        let mut front = faces.to_vec();
        while let Some(face) = front.pop() {
            for twin in (0..3).filter_map(|c| topology.twin(HalfEdgeId::of(face, c))) {
                let beside = twin.face();
                let hangs_on =
                    self.may_lie_on_a_facet(mesh, beside) && self.is_needle(mesh, beside);
                if hangs_on && judged.insert(beside) {
                    front.push(beside);
                }
            }
        }
        let before: Vec<u32> = judged.iter().map(|f| self.facet_of_face[f.index()]).collect();
        let needles = self.assign_wide(mesh, judged.iter().copied());
        self.assign_needles(mesh, topology, &needles);
        let changed = judged.iter().zip(before).filter_map(|(&face, before)| {
            let after = self.facet_of_face[face.index()];
            (after != before).then_some(Reassigned { face, before, after })
        });
        (changed.collect(), judged.len())
    }
}

impl Features {
    /// Follows an [`Assignment::update`] of the same faces. `ridges` lists ridges by facet, and is kept
    /// so; returned are the facets whose ridges have changed, ascending.
    pub(crate) fn update(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        assignment: &Assignment,
        faces: &[FaceId],
        reassigned: &[Reassigned],
        ridges: &mut Vec<RidgeOnFacet>,
    ) -> Vec<u32> {
        for change in reassigned {
            self.facet_of_face[change.face.index()] = change.after;
        }
        if reassigned.iter().any(Reassigned::changes_class) {
            (self.set_of_face, self.sets) = convex_sets(topology, &self.facet_of_face);
        }
        let looked_at: BTreeSet<FaceId> =
            faces.iter().copied().chain(reassigned.iter().map(|c| c.face)).collect();
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
            let key = (r.ends[0], r.ends[1]);
            let found = topology.edges().binary_search_by_key(&key, |e| (e.from.0, e.to.0));
            found.is_ok_and(|e| edges.contains(&EdgeId(e as u32)))
        };
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
        let mut facets: Vec<u32> = stale.iter().chain(&fresh).map(|r| r.facet).collect();
        facets.sort_unstable();
        facets.dedup();
        facets
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
