//! The tree over patches: boxes and cones, down to single patches.
//!
//! Source: trees of boxes and cones of normals are those of Johnson and Cohen (2001, "Spatialized
//! normal cone hierarchies"). Cost: O(p log p) for p patches as a rule; to fit it again costs the
//! patches that have changed, at each node whose old box may hold them.

use cranny_exact::Aabb;

use super::Patch;
use super::cone::NormalCone;
use crate::ids::PatchId;
use crate::tree::{Content, Grower, GrownAreas, Node};

/// A binary tree whose leaves are patches. Node 0 is the root.
#[derive(Clone, Debug)]
pub struct PatchTree {
    pub(super) nodes: Vec<Node>,
    pub(super) cones: Vec<NormalCone>,
    pub(super) order: Vec<PatchId>,
}

impl PatchTree {
    pub(super) fn over(patches: &[Patch]) -> Self {
        let (mut nodes, mut order) = (Vec::new(), Vec::new());
        let boxes = patches.iter().enumerate().map(|(i, p)| (PatchId(i as u32), p.bounds));
        Grower::new(1).grow(boxes, &mut nodes, &mut order);
        Self::with_cones(nodes, order, patches)
    }

    /// Puts cones around what the nodes of a tree hold.
    fn with_cones(nodes: Vec<Node>, order: Vec<PatchId>, patches: &[Patch]) -> Self {
        let cones = vec![NormalCone::WHOLE; nodes.len()];
        let mut tree = Self { nodes, cones, order };
        // Children stand behind their parents.
        for index in (0..tree.nodes.len() as u32).rev() {
            tree.cones[index as usize] = match tree.content(index) {
                Content::Inner { left, right } => tree.cone(left).union(tree.cone(right)),
                Content::Leaf { start, .. } => patches[tree.order[start as usize].index()].cone,
            };
        }
        tree
    }

    /// How large its boxes are now, for [`refit`](Self::refit).
    pub(crate) fn grown_areas(&self) -> GrownAreas {
        GrownAreas::of(&self.nodes)
    }

    /// Fits boxes and cones above some patches that have changed, given the boxes that they had.
    /// Whether the tree is well again: not where a box has spread too far since it was grown, or a
    /// patch was not found.
    pub(super) fn refit(
        &mut self,
        patches: &[Patch],
        old: &[(PatchId, Aabb)],
        grown: &GrownAreas,
    ) -> bool {
        let mut found = 0;
        let is_well = self.refit_beneath(0, patches, old, grown, &mut found);
        is_well && found == old.len()
    }

    /// Fits what hangs at a node, if one of the patches may; whether it is well.
    fn refit_beneath(
        &mut self,
        node: u32,
        patches: &[Patch],
        old: &[(PatchId, Aabb)],
        grown: &GrownAreas,
        found: &mut usize,
    ) -> bool {
        let bounds = *self.bounds(node);
        let may_hold = |(_, b): &&(PatchId, Aabb)| {
            bounds.contains_point(b.min) && bounds.contains_point(b.max)
        };
        let within: Vec<(PatchId, Aabb)> = old.iter().filter(may_hold).copied().collect();
        if within.is_empty() {
            return true;
        }
        let (mut is_well, at) = (true, node as usize);
        match self.content(node) {
            Content::Inner { left, right } => {
                is_well &= self.refit_beneath(left, patches, &within, grown, found);
                is_well &= self.refit_beneath(right, patches, &within, grown, found);
                self.nodes[at].bounds = self.bounds(left).union(self.bounds(right));
                self.cones[at] = self.cone(left).union(self.cone(right));
            }
            Content::Leaf { start, .. } => {
                let patch = self.order[start as usize];
                *found += usize::from(within.iter().any(|(p, _)| *p == patch));
                self.nodes[at].bounds = patches[patch.index()].bounds;
                self.cones[at] = patches[patch.index()].cone;
            }
        }
        is_well && !grown.has_spread(node, self.bounds(node))
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no nodes: never, since a mesh has faces.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The box of all patches beneath a node.
    #[must_use]
    pub fn bounds(&self, node: u32) -> &Aabb {
        &self.nodes[node as usize].bounds
    }

    /// A cone that holds the cones of all patches beneath a node.
    #[must_use]
    pub fn cone(&self, node: u32) -> &NormalCone {
        &self.cones[node as usize]
    }

    /// What a node holds: children, or a range of [`order`](Self::order) with one patch.
    #[must_use]
    pub fn content(&self, node: u32) -> Content {
        self.nodes[node as usize].content_at(node)
    }

    /// Patches in leaf order.
    #[must_use]
    pub fn order(&self) -> &[PatchId] {
        &self.order
    }

    pub(super) fn validate(&self, patches: &[Patch]) -> Result<(), String> {
        let mut seen = vec![0; patches.len()];
        for index in 0..self.nodes.len() as u32 {
            let (bounds, cone) = (self.bounds(index), self.cone(index));
            match self.content(index) {
                Content::Inner { left, right } => {
                    if self.bounds(left).union(self.bounds(right)) != *bounds {
                        return Err(format!("node {index} over patches has another box"));
                    }
                    for child in [left, right] {
                        if cone.is_bounded() && !cone.holds(self.cone(child)) {
                            return Err(format!("the cone of node {child} sticks out of {index}"));
                        }
                    }
                }
                Content::Leaf { start, end } => {
                    let patch = self.order[start as usize];
                    seen[patch.index()] += 1;
                    let held = &patches[patch.index()];
                    if end != start + 1 || held.bounds != *bounds || held.cone != *cone {
                        return Err(format!("leaf {index} is not its patch"));
                    }
                }
            }
        }
        match seen.iter().position(|&n| n != 1) {
            Some(patch) => Err(format!("patch {patch} stands in {} leaves", seen[patch])),
            None => Ok(()),
        }
    }
}
