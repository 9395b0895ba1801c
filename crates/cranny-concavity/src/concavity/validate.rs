//! The invariants of concavities, as something to run.

use std::collections::BTreeMap;

use super::{ConcavitySet, Cover};
use crate::features::Features;
use crate::ids::CapId;
use cranny_geometry::hull::{ConvexHull, FacetId};
use cranny_geometry::{Mesh, Topology, VertexId, each_once};

/// Directed edges with multiplicities, by lesser and greater end: those of a closed surface cancel.
#[derive(Debug, Default)]
struct Rim(BTreeMap<[VertexId; 2], i64>);

impl Rim {
    fn add(&mut self, corners: [VertexId; 3], times: i64) {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if a != b {
                let forward = if a < b { times } else { -times };
                *self.0.entry([a.min(b), a.max(b)]).or_default() += forward;
            }
        }
    }

    fn left(&self) -> impl Iterator<Item = [VertexId; 2]> + '_ {
        self.0.iter().filter(|&(_, &n)| n != 0).map(|(&e, _)| e)
    }
}

impl ConcavitySet {
    /// Checks the invariants; for tests and debugging. O(n log n).
    ///
    /// - Every face is convex or of one concavity, every cap triangle skin or of one lid.
    /// - Caps and faces of a concavity, the faces turned around, have no boundary but along edges
    ///   at which the mesh itself is open, contradictory or tangled.
    /// - On every facet, hull and faces and caps add up: what is left has no boundary, together.
    /// - Loops are simple, follow edges of the concavity's faces, and are all of their boundary.
    ///
    /// # Errors
    ///
    /// The first broken invariant, in words.
    pub fn validate(
        &self,
        mesh: &Mesh,
        topology: &Topology,
        hull: &ConvexHull,
        features: &Features,
    ) -> Result<(), String> {
        self.validate_owners(mesh, features)?;
        self.validate_cover(hull)?;
        let mut whole = Rim::default();
        for t in hull.source_triangles() {
            whole.add(t, 1);
        }
        for f in mesh.face_ids().filter(|&f| features.is_convex(f)) {
            whole.add(mesh.corners(f), -1);
        }
        for cap in self.caps() {
            whole.add(cap.corners, -1);
        }
        if let Some([a, b]) = whole.left().next() {
            return Err(format!("hull, faces and caps do not add up at edge {} {}", a.0, b.0));
        }
        let is_tight = |[a, b]: [VertexId; 2]| {
            topology
                .edge_between([a, b])
                .is_none_or(|e| topology.edges()[e.index()].kind.is_balanced())
        };
        for concavity in self.iter() {
            let id = concavity.id().0;
            let (mut closed, mut rim) = (Rim::default(), Rim::default());
            for &f in concavity.faces {
                closed.add(mesh.corners(f), -1);
                rim.add(mesh.corners(f), 1);
            }
            for &cap in concavity.caps {
                closed.add(self.cap(cap).corners, 1);
            }
            if let Some([a, b]) = closed.left().find(|&e| is_tight(e)) {
                return Err(format!("concavity {id} has a boundary at edge {} {}", a.0, b.0));
            }
            for (i, l) in concavity.loops().enumerate() {
                let distinct = each_once(l.vertices);
                if distinct.len() != l.vertices.len() || l.vertices.len() < 2 {
                    return Err(format!("loop {i} of concavity {id} is not simple"));
                }
                for (k, &a) in l.vertices.iter().enumerate() {
                    let b = l.vertices[(k + 1) % l.vertices.len()];
                    let forward = if a < b { -1 } else { 1 };
                    *rim.0.entry([a.min(b), a.max(b)]).or_default() += forward;
                }
            }
            if let Some([a, b]) = rim.left().next() {
                return Err(format!("loops of concavity {id} miss edge {} {}", a.0, b.0));
            }
        }
        Ok(())
    }

    fn validate_owners(&self, mesh: &Mesh, features: &Features) -> Result<(), String> {
        for f in mesh.face_ids() {
            let listed = |c| self.get(c).faces.binary_search(&f).is_ok();
            match self.of_face(f) {
                None if features.is_convex(f) => {}
                Some(c) if !features.is_convex(f) && listed(c) => {}
                other => return Err(format!("face {} is filed under {other:?}", f.0)),
            }
        }
        let lids: usize = self.iter().map(|c| c.lids().map(|l| l.caps.len()).sum::<usize>()).sum();
        if lids != self.cap_order.len() {
            return Err("some lid is listed under no concavity, or twice".into());
        }
        let faces: usize = self.iter().map(|c| c.faces.len()).sum();
        if faces != self.faces.len() {
            return Err("some face is listed twice".into());
        }
        let mut skin = 0;
        for id in (0..self.cap_count() as u32).map(CapId) {
            let cap = self.cap(id);
            match (cap.concavity, cap.lid) {
                (None, None) => skin += 1,
                (Some(c), Some(l)) if self.lid(l).concavity == c => {
                    if self.lid(l).caps.binary_search(&id).is_err() {
                        return Err(format!("cap triangle {} is not listed by its lid", id.0));
                    }
                }
                other => return Err(format!("cap triangle {} is filed under {other:?}", id.0)),
            }
        }
        if skin != self.skin.caps {
            return Err(format!("{skin} cap triangles of skin, filed as {}", self.skin.caps));
        }
        Ok(())
    }

    fn validate_cover(&self, hull: &ConvexHull) -> Result<(), String> {
        for facet in (0..hull.facet_count() as u32).map(FacetId) {
            let range = self.caps.of_facet(facet);
            if let Some(cap) = range.clone().map(|c| self.cap(CapId(c))).find(|c| c.facet != facet)
            {
                return Err(format!("{cap:?} stands under facet {}", facet.0));
            }
            let mut over = self.caps_over(facet).map(|c| self.cap(c)).peekable();
            let right = match (self.cover(facet), over.peek().is_some()) {
                (Cover::Solid, is_covered) => !is_covered,
                (Cover::Lid(c), true) => over.all(|o| o.concavity == Some(c)),
                (Cover::Mixed(caps), true) => caps == range,
                _ => false,
            };
            if !right {
                return Err(format!("facet {} is filed as {:?}", facet.0, self.cover(facet)));
            }
        }
        Ok(())
    }
}
