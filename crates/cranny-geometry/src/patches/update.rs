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

use cranny_exact::{Aabb, DVec3};

use super::cone::Measured;
use super::grow::{Growing, Limits, Partition, divided};
use super::{Lists, Patch, PatchTree, Patches, Slab};
use crate::ids::{FaceId, PatchId};
use crate::mesh::Mesh;
use crate::topology::Topology;
use crate::tree::{FaceForest, GrownAreas, MovedFace, NodeChanges};

/// What has become of patches.
pub(crate) struct PatchUpdate {
    /// By old number the new one, of those with the same faces; whether these have moved or not.
    pub(crate) map: Vec<Option<PatchId>>,
    /// Number of faces of the patches that were measured or divided.
    pub(crate) faces: usize,
    pub(crate) nodes: NodeChanges,
}

impl Patches {
    /// Follows moved faces.
    ///
    /// Cost: the patches with a moved face, the nodes above them, and a glance at each patch; where
    /// one is divided, a pass over all faces as well. `body` is the box of all faces.
    pub(crate) fn update(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        body: &Aabb,
        moved: &[MovedFace],
        grown: &mut GrownAreas,
        grown_top: &mut GrownAreas,
    ) -> PatchUpdate {
        let limits = Limits::of(body);
        let mut by_patch: BTreeMap<u32, Vec<MovedFace>> = BTreeMap::new();
        for m in moved {
            by_patch.entry(self.patch_of_face(m.face).0).or_default().push(*m);
        }
        // A body that has shrunk has smaller patches.
        for p in 0..self.len() as u32 {
            let faces = self.faces(PatchId(p));
            let is_small = limits.allow(&self.patches[p as usize].bounds);
            let fits = || Growing::finished(mesh, &self.patches[p as usize], faces).fits(&limits);
            if !is_small && !fits() {
                by_patch.entry(p).or_default();
            }
        }
        let mut parts: BTreeMap<u32, Vec<(Growing, Vec<FaceId>)>> = BTreeMap::new();
        for &p in by_patch.keys() {
            parts.insert(p, divided(mesh, topology, &limits, self.faces(PatchId(p))));
        }
        let mut nodes = NodeChanges::default();
        let mut is_well = true;
        for (&p, moved) in &by_patch {
            is_well &=
                self.trees.refit(p as usize, mesh, moved, Self::LEAF_SIZE, grown, &mut nodes);
        }
        let touched: BTreeSet<u32> = by_patch.into_keys().collect();
        let faces = touched.iter().map(|&p| self.faces(PatchId(p)).len()).sum();
        if is_well && parts.values().all(|parts| parts.len() == 1) {
            let mut old = Vec::with_capacity(parts.len());
            for (&p, parts) in &parts {
                old.push((PatchId(p), self.patches[p as usize].bounds));
                self.measure(mesh, p as usize, &parts[0].0);
            }
            if !self.top.refit(&self.patches, &old, grown_top) {
                self.top = PatchTree::over(&self.patches);
                *grown_top = self.top.grown_areas();
            }
            nodes.settle();
            let map = (0..self.len() as u32).map(|p| Some(PatchId(p))).collect();
            return PatchUpdate { map, faces, nodes };
        }
        let map = self.divide(mesh, topology, &limits, &parts);
        *grown = GrownAreas::of(self.trees.arena().nodes());
        *grown_top = self.top.grown_areas();
        let nodes = NodeChanges { renumbered: true, ..NodeChanges::default() };
        PatchUpdate { map, faces, nodes }
    }

    fn measure(&mut self, mesh: &Mesh, p: usize, grown: &Growing) {
        self.patches[p] = Patch::of(mesh, &self.trees, p, grown.cone);
        let range = self.trees.node_range(p);
        let slabs = Slab::of_tree(mesh, self.trees.arena(), range.clone());
        self.slabs[range].copy_from_slice(&slabs);
    }

    /// Replaces patches by parts of them, and joins what fits together.
    fn divide(
        &mut self,
        mesh: &Mesh,
        topology: &Topology,
        limits: &Limits,
        parts: &BTreeMap<u32, Vec<(Growing, Vec<FaceId>)>>,
    ) -> Vec<Option<PatchId>> {
        let mut patch_of: Vec<u32> = self.patch_of_face.iter().map(|p| p.0).collect();
        let finished = |p: usize| Growing::finished(mesh, &self.patches[p], self.trees.faces(p));
        let mut patches: Vec<Growing> = (0..self.len()).map(finished).collect();
        for (&p, parts) in parts {
            patches[p as usize] = parts[0].0;
            for (part, faces) in &parts[1..] {
                for face in faces {
                    patch_of[face.index()] = patches.len() as u32;
                }
                patches.push(*part);
            }
        }
        let partition = Partition { patch_of, patches }.merged(mesh, topology, limits);
        let count = partition.patches.len();
        let faces = Lists::of(count, &partition.patch_of);
        let same = |new: usize| {
            let old = self.patch_of_face(faces.get(new)[0]);
            let same = faces.get(new).len() == self.faces(old).len()
                && faces.get(new).iter().all(|&f| self.patch_of_face(f) == old);
            same.then_some(old.index())
        };
        let kept = |new: usize| same(new).filter(|&old| !parts.contains_key(&(old as u32)));
        let groups = (0..count).map(|p| faces.get(p));
        let trees: FaceForest = self.trees.updated(mesh, groups, Self::LEAF_SIZE, kept);
        let mut slabs = Vec::with_capacity(trees.arena().nodes().len());
        let mut map = vec![None; self.len()];
        let mut partition = partition;
        for new in 0..count {
            if let Some(old) = same(new) {
                map[old] = Some(PatchId(new as u32));
            }
            match kept(new) {
                Some(old) => {
                    slabs.extend_from_slice(&self.slabs[self.trees.node_range(old)]);
                    // The axis of the cone that was measured.
                    partition.patches[new] = finished(old);
                }
                None => {
                    let range = trees.node_range(new);
                    slabs.extend(Slab::of_tree(mesh, trees.arena(), range));
                }
            }
        }
        let measure = |faces: &[FaceId], axis: DVec3| Measured::of(mesh, faces, axis);
        *self = Self::assemble(mesh, partition, trees, slabs, measure);
        map
    }
}
