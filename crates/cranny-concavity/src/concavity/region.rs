//! Concavities of a part of the surface: faces and caps that hang together there.
//!
//! No source: what belongs together, and what is skin, are decided as for the whole (`components`,
//! `build`). Cost: O(m log m) in the faces and caps of the part, and a glance at all caps.

use super::components::Components;
use super::input::Input;
use crate::caps::CapSurface;
use crate::ids::CapId;
use cranny_geometry::{FaceId, HalfEdgeId, VertexId, each_once};

/// A part of the surface: faces off the hull and caps, ascending.
pub(super) struct Part {
    pub(super) faces: Vec<FaceId>,
    pub(super) caps: Vec<u32>,
}

/// Faces and caps that hang together.
#[derive(Default)]
pub(super) struct Group {
    /// Ascending.
    pub(super) faces: Vec<FaceId>,
    /// The caps of each lid, ascending, by the first of each.
    pub(super) lids: Vec<Vec<CapId>>,
}

impl Part {
    /// The groups in this part, skin left out; `None` where something of it hangs together with
    /// what is no part of it.
    pub(super) fn groups(&self, input: &Input<'_>, caps: &CapSurface) -> Option<Vec<Group>> {
        let Input { mesh, topology, features, .. } = input;
        let corners = |cap: u32| caps.triangles[cap as usize];
        let mut ends: Vec<(u32, u32)> = Vec::new();
        let sorted = |[a, b]: [u32; 2]| (a.min(b), a.max(b));
        for &cap in &self.caps {
            let [a, b, c] = corners(cap);
            ends.extend([[a, b], [b, c], [c, a]].map(sorted));
        }
        for &face in &self.faces {
            let edges = (0..3).map(|c| topology.edge_of(HalfEdgeId::of(face, c)));
            ends.extend(edges.map(|e| {
                let edge = topology.edges()[e.index()];
                (edge.from.0, edge.to.0)
            }));
        }
        let ends = each_once(ends);
        // What else meets at these edges.
        let mut is_at = vec![false; mesh.vertices().len()];
        ends.iter().flat_map(|&(a, b)| [a, b]).for_each(|v| is_at[v as usize] = true);
        let meets = |&cap: &u32| {
            let [a, b, c] = corners(cap);
            [[a, b], [b, c], [c, a]].into_iter().any(|[a, b]| {
                is_at[a as usize]
                    && is_at[b as usize]
                    && ends.binary_search(&sorted([a, b])).is_ok()
            })
        };
        let all_caps: Vec<u32> = (0..caps.triangles.len() as u32).filter(meets).collect();
        let mut all_faces = self.faces.clone();
        for &(from, to) in &ends {
            if let Some(edge) = topology.edge_between([from, to].map(VertexId)) {
                let faces = topology.half_edges(edge).iter().map(|h| h.face());
                all_faces.extend(faces.filter(|&f| !features.is_convex(f)));
            }
        }
        let all_faces = each_once(all_faces);
        let triangles: Vec<[u32; 3]> = all_caps.iter().map(|&cap| corners(cap)).collect();
        let components = Components::among(input, &all_faces, &triangles, &ends);
        self.gather(input, caps, components, &all_faces, &all_caps)
    }

    fn gather(
        &self,
        input: &Input<'_>,
        caps: &CapSurface,
        mut components: Components,
        all_faces: &[FaceId],
        all_caps: &[u32],
    ) -> Option<Vec<Group>> {
        let count = all_faces.len() + all_caps.len();
        let mut is_skin = vec![false; all_caps.len()];
        let own = |cap: u32| self.caps.binary_search(&cap).is_ok();
        let bare = (0..all_caps.len()).map(|i| (i, components.of_cap(i)));
        let bare = bare.filter(|&(i, _)| own(all_caps[i]));
        let bare: Vec<(usize, usize)> = bare
            .filter_map(|(i, root)| {
                Some((all_caps[i] as usize, root.checked_sub(all_faces.len())?))
            })
            .collect();
        input.skin(caps, bare, &mut is_skin);
        // By the least element of each; those of others alone stay empty.
        let mut groups: Vec<Option<Group>> = (0..count).map(|_| None).collect();
        let mut is_foreign = vec![false; count];
        for (i, &face) in all_faces.iter().enumerate() {
            let root = components.of_face(FaceId(i as u32));
            if self.faces.binary_search(&face).is_ok() {
                groups[root].get_or_insert_default().faces.push(face);
            } else {
                is_foreign[root] = true;
            }
        }
        let mut lid_of_root: Vec<Option<usize>> = vec![None; all_caps.len()];
        for (i, &cap) in all_caps.iter().enumerate() {
            let (root, lid) = (components.of_cap(i), components.lid_of(i));
            if !own(cap) {
                is_foreign[root] = true;
                continue;
            }
            if root >= all_faces.len() && is_skin[root - all_faces.len()] {
                continue;
            }
            let lids = &mut groups[root].get_or_insert_default().lids;
            let at = *lid_of_root[lid].get_or_insert_with(|| {
                lids.push(Vec::new());
                lids.len() - 1
            });
            lids[at].push(CapId(cap));
        }
        let is_mixed = |(group, foreign): (&Option<Group>, &bool)| group.is_some() && *foreign;
        let found = !groups.iter().zip(&is_foreign).any(is_mixed);
        found.then(|| groups.into_iter().flatten().collect())
    }
}
