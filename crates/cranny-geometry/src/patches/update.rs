//! Patches after some faces have moved.
//!
//! A patch whose faces still make one keeps them, and is measured again. One that has become too
//! bent or too large is divided by growing it anew from its own faces; what is left over joins
//! neighbours where the limits allow, as when all patches are built. So patches keep their
//! promises, but *which* faces make one depends on the deformations before: growth is greedy, and
//! one face more or less would move every border behind it.
//!
//! No source: this crate's own; growth and merging are those of `grow`, which keep the limits from
//! whatever they begin with. Cost: with the function.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::Aabb;

use super::cone::Normal;
use super::grow::{Growing, Limits, Partition, divided};
use super::{Lists, Patch, Patches};
use crate::ids::{FaceId, PatchId};
use crate::mesh::Mesh;
use crate::topology::Topology;

/// What has become of patches.
pub(crate) struct PatchUpdate {
    /// By old number the new one, of those with the same faces; whether these have moved or not.
    pub(crate) map: Vec<Option<PatchId>>,
    /// Number of faces of the patches that were measured or divided.
    pub(crate) faces: usize,
}

/// What a patch is divided into: one part, where it stays whole.
type Division = Vec<(Growing, Vec<FaceId>)>;

impl Patches {
    /// Follows moved faces.
    ///
    /// Cost: the patches with a moved face, and a glance at each patch; where one is divided, a
    /// pass over all faces as well. `body` is the box of all faces.
    pub(crate) fn update(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        body: &Aabb,
        moved: &[FaceId],
    ) -> PatchUpdate {
        let limits = Limits::of(body);
        let mut touched: BTreeSet<PatchId> =
            moved.iter().map(|&face| self.patch_of_face(face)).collect();
        // A body that has shrunk has smaller patches.
        for (id, patch) in (0..).map(PatchId).zip(&self.patches) {
            let fits = || Growing::finished(mesh, patch, self.faces(id)).fits(&limits);
            if !limits.allow(&patch.bounds) && !fits() {
                touched.insert(id);
            }
        }
        let divided = |id: PatchId| divided(mesh, topology, &limits, self.faces(id));
        let parts: BTreeMap<PatchId, Division> =
            touched.into_iter().map(|id| (id, divided(id))).collect();
        let faces = parts.keys().map(|&id| self.faces(id).len()).sum();
        if parts.values().any(|parts| parts.len() > 1) {
            return PatchUpdate { map: self.divide(mesh, topology, &limits, &parts), faces };
        }
        for (&id, parts) in &parts {
            self.patches[id.index()] = Patch::of(mesh, self.faces(id), parts[0].0.cone);
        }
        let map = (0..self.len() as u32).map(|p| Some(PatchId(p))).collect();
        PatchUpdate { map, faces }
    }

    /// Replaces patches by parts of them, and joins what fits together.
    fn divide(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        limits: &Limits,
        parts: &BTreeMap<PatchId, Division>,
    ) -> Vec<Option<PatchId>> {
        let mut patch_of: Vec<u32> = self.patch_of_face.iter().map(|p| p.0).collect();
        let finished =
            |id: PatchId| Growing::finished(mesh, &self.patches[id.index()], self.faces(id));
        let mut patches: Vec<Growing> = (0..self.len() as u32).map(PatchId).map(finished).collect();
        for (id, parts) in parts {
            patches[id.index()] = parts[0].0;
            for (part, faces) in &parts[1..] {
                for face in faces {
                    patch_of[face.index()] = patches.len() as u32;
                }
                patches.push(*part);
            }
        }
        let mut partition = Partition { patch_of, patches }.merged(mesh, topology, limits);
        let faces = Lists::of(partition.patches.len(), &partition.patch_of);
        let mut map = vec![None; self.len()];
        for (new, grown) in partition.patches.iter_mut().enumerate() {
            let Some(old) = self.with_faces(faces.get(new)) else { continue };
            map[old.index()] = Some(PatchId(new as u32));
            if !parts.contains_key(&old) {
                // The axis of the cone that was measured.
                *grown = finished(old);
            }
        }
        *self = Self::assemble(mesh, partition, |face| Normal::of(mesh, face));
        map
    }
}
