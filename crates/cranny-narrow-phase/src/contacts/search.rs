//! Branch and bound for the nearest contact of each pair of patches.
//!
//! Along a thread all triangles of two flanks are nearly equally near, and boxes tell nothing: a box
//! around slanted triangles is thicker than the gap. What tells is a plane over them (`posed`);
//! of two triangles in the end, their own: if the corners of one
//! triangle all lie higher over the other's plane than the best contact so far, the pair has no
//! better one (nor do the triangles meet). Nothing else is done for most pairs.
//!
//! The descent sees every pair of triangles that meet, since a bound above 0 is what leaves a pair out:
//! the exact verdict on the surfaces comes with the contacts.

use cranny_geometry::{Content, PatchId};

use super::facet::{Facet, Outcodes, may_cross};
use super::feature_pair::{Stand, edge_edge, vertex_face, vertex_rim};
use super::posed::{Posed, PosedTree};
use crate::answer::{Contact, Counters, Feature};
use crate::descent::{BoxTest, Opened, opened};
use crate::pair::{Pair, Side};
use crate::surface::FacePair;
use crate::triangle_distance::Part;

/// A patch whose box is longer than this part of its body's counts as coarse: it has large faces (others
/// are cut to this length), so a whole side of the body may stand on it, and one point is not enough.
const COARSE: f64 = 0.26;

/// Order of contacts: the nearest first, ties by lowest features.
pub(super) fn nearer(x: &Contact, y: &Contact) -> std::cmp::Ordering {
    x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id))
}

/// Searches pairs of patches of one pair of bodies.
pub(super) struct Search<'a, 'b> {
    pair: &'a Pair<'b>,
    boxes: BoxTest,
    error: f64,
    /// What posing may add to a distance between nodes.
    culling_error: f64,
    coarse_beyond: [f64; 2],
    stack: Vec<(f64, u32, u32)>,
    posed: [Posed; 2],
    /// Scratch: facets of two leaves that are not wholly over the other leaf's plane.
    near: [Vec<u32>; 2],
    /// Faces that meet, in the order of their discovery; a pair of patches searched twice tells twice.
    pub(super) meeting: Vec<FacePair>,
}

/// What is looked for between two patches.
struct Quest {
    /// No contact farther than this is wanted; shrinks as nearer ones are found.
    limit: f64,
    /// All contacts, not only the nearest.
    all: bool,
    found: Vec<Contact>,
}

impl Quest {
    fn offer(&mut self, contact: Contact) {
        if contact.separation > self.limit {
            return;
        }
        if self.all {
            self.found.push(contact);
        } else if self.found.first().is_none_or(|best| nearer(&contact, best).is_lt()) {
            self.limit = contact.separation.max(0.0);
            self.found = vec![contact];
        }
    }
}

impl<'a, 'b> Search<'a, 'b> {
    pub(super) fn new(pair: &'a Pair<'b>) -> Self {
        let coarse_beyond = Side::BOTH.map(|side| {
            let b = pair.model(side).bounds();
            COARSE * COARSE * (b.max - b.min).length_squared()
        });
        Self {
            pair,
            boxes: BoxTest::of(pair),
            error: pair.length_error(),
            culling_error: pair.culling_error(),
            coarse_beyond,
            stack: Vec::new(),
            posed: Side::BOTH.map(Posed::new),
            near: [Vec::new(), Vec::new()],
            meeting: Vec::new(),
        }
    }

    /// All pairs of patches whose boxes may be within `margin`.
    pub(super) fn near_patches(&self, margin: f64, counters: &mut Counters) -> Vec<[PatchId; 2]> {
        let [first, second] = Side::BOTH.map(|side| self.pair.model(side).patches().top());
        let mut found = Vec::new();
        let mut stack = vec![(0u32, 0u32)];
        while let Some((a, b)) = stack.pop() {
            counters.node_tests += 1;
            let (box_a, box_b) = (first.bounds(a), second.bounds(b));
            if self.boxes.apart(box_a, box_b, margin) {
                continue;
            }
            let (content_a, content_b) = (first.content(a), second.content(b));
            match opened(content_a, content_b, box_a, box_b) {
                Opened::First(left, right) => stack.extend([(right, b), (left, b)]),
                Opened::Second(left, right) => stack.extend([(a, right), (a, left)]),
                Opened::Neither => {
                    if let (Content::Leaf { start: i, .. }, Content::Leaf { start: j, .. }) =
                        (content_a, content_b)
                    {
                        found.push([first.order()[i as usize], second.order()[j as usize]]);
                    }
                }
            }
        }
        found
    }

    /// Whether either patch is coarse, so that contacts are to span the pair.
    pub(super) fn is_coarse(&self, patches: [PatchId; 2]) -> bool {
        Side::BOTH.into_iter().any(|side| {
            let patch = self.pair.model(side).patches().patch(patches[side.index()]);
            let extent = (patch.bounds.max - patch.bounds.min).length_squared();
            extent > self.coarse_beyond[side.index()]
        })
    }

    /// The nearest contact of two patches across a gap of at most `margin`, or all of them where a
    /// patch is coarse. `limit <= margin`: that of a contact known to exist, or the margin.
    pub(super) fn between(
        &mut self,
        patches: [PatchId; 2],
        limit: f64,
        counters: &mut Counters,
    ) -> Vec<Contact> {
        let pair = self.pair;
        let mut quest = Quest { limit, all: self.is_coarse(patches), found: Vec::new() };
        let [first, second] = Side::BOTH.map(|side| pair.model(side).patches().trees().arena());
        let [posed_a, posed_b] = &mut self.posed;
        let (Some(tree_a), Some(tree_b)) =
            (posed_a.tree(pair, patches[0]), posed_b.tree(pair, patches[1]))
        else {
            return Vec::new();
        };
        let trees = [tree_a, tree_b];
        let mut stack = std::mem::take(&mut self.stack);
        let (root_a, root_b) = (tree_a.root, tree_b.root);
        stack.push((self.lower(&trees, root_a, root_b, limit), root_a, root_b));
        while let Some((lower, a, b)) = stack.pop() {
            if lower > quest.limit {
                continue;
            }
            counters.node_tests += 1;
            let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
            let children = match opened(first.content(a), second.content(b), box_a, box_b) {
                Opened::First(left, right) => [(left, b), (right, b)],
                Opened::Second(left, right) => [(a, left), (a, right)],
                Opened::Neither => {
                    self.leaves(&trees, [a, b], &mut quest, counters);
                    continue;
                }
            };
            let mut children = children.map(|(a, b)| (self.lower(&trees, a, b, quest.limit), a, b));
            if children[0].0 < children[1].0 {
                children.swap(0, 1); // the nearer one is popped first
            }
            stack.extend(children.into_iter().filter(|child| child.0 <= quest.limit));
        }
        self.stack = stack;
        quest.found
    }

    /// A lower bound of the gap between what two nodes of the patches' trees hold; boxes are not asked where
    /// balls and planes tell that it is beyond `limit`.
    fn lower(&self, trees: &[PosedTree; 2], a: u32, b: u32, limit: f64) -> f64 {
        let [first, second] = &self.posed;
        let (posed_a, posed_b) = (first.node(&trees[0], a), second.node(&trees[1], b));
        let lower = posed_a.separation_lower(posed_b) - self.culling_error;
        if lower > limit {
            return lower;
        }
        let arena = |side| self.pair.model(side).patches().trees().arena();
        let (box_a, box_b) =
            (&arena(Side::First).node(a).bounds, &arena(Side::Second).node(b).bounds);
        lower.max(self.boxes.distance_lower(box_a, box_b))
    }

    fn leaves(
        &mut self,
        trees: &[PosedTree; 2],
        leaves: [u32; 2],
        quest: &mut Quest,
        counters: &mut Counters,
    ) {
        let pair = self.pair;
        let mut meeting = std::mem::take(&mut self.meeting);
        let [mut near_a, mut near_b] = std::mem::take(&mut self.near);
        let [(tree_a, a), (tree_b, b)] = [(&trees[0], leaves[0]), (&trees[1], leaves[1])];
        let rounding = self.culling_error;
        let reach = quest.limit + rounding;
        let plane = |posed: &Posed, tree: &PosedTree, leaf: u32| {
            let node = posed.node(tree, leaf);
            (node.normal, node.height + reach)
        };
        let [first, second] = &mut self.posed;
        let over_b = plane(second, tree_b, b);
        first.facets_beneath(pair, (tree_a, a), over_b, &mut near_a);
        if !near_a.is_empty() {
            let over_a = plane(first, tree_a, a);
            second.facets_beneath(pair, (tree_b, b), over_a, &mut near_b);
        }
        let [first, second] = &self.posed;
        for f in near_a.iter().map(|&i| first.facet(i)) {
            for g in near_b.iter().map(|&i| second.facet(i)) {
                let reach = quest.limit + rounding;
                if f.is_far_from(g, reach) {
                    continue;
                }
                let Some(of_g) = f.outcodes(g, reach) else { continue };
                let Some(of_f) = g.outcodes(f, reach) else { continue };
                counters.triangle_tests += 1;
                if of_f.least_height.max(of_g.least_height) <= rounding {
                    meeting.extend(FacePair::of([f.face, g.face], [&f.corners, &g.corners]));
                }
                self.facets(f, g, [of_f, of_g], quest);
            }
        }
        (self.meeting, self.near) = (meeting, [near_a, near_b]);
    }

    /// Offers the contacts of two triangles; `out` tells where the corners of the first and of the second are.
    fn facets(&self, f: &Facet, g: &Facet, out: [Outcodes; 2], quest: &mut Quest) {
        for corner in 0..3 {
            if !out[0].corner_out(corner) && f.owns_corner(self.pair, Side::First, corner) {
                self.vertex(Side::First, f, corner, g, quest);
            }
        }
        for corner in 0..3 {
            if !out[1].corner_out(corner) && g.owns_corner(self.pair, Side::Second, corner) {
                self.vertex(Side::Second, g, corner, f, quest);
            }
        }
        for i in (0..3).filter(|&i| !out[0].side_out(i)) {
            for j in (0..3).filter(|&j| !out[1].side_out(j)) {
                let below = quest.limit + self.error;
                if !may_cross(f.side(i), g.side(j), below)
                    || !f.owns_side(self.pair, Side::First, i)
                    || !g.owns_side(self.pair, Side::Second, j)
                {
                    continue;
                }
                let (e, k) = (
                    self.pair.edge(Side::First, f.face, i),
                    self.pair.edge(Side::Second, g.face, j),
                );
                if let Some(contact) = edge_edge(self.pair, e, k, below)
                    && contact.separation >= -self.error
                {
                    quest.offer(contact);
                }
            }
        }
    }

    /// Offers the contact of a corner of one triangle before another.
    fn vertex(&self, side: Side, own: &Facet, corner: usize, its: &Facet, quest: &mut Quest) {
        let vertex = self.pair.corner(side, own.face, corner);
        let found = match vertex_face(self.pair, side, vertex, its.face, quest.limit) {
            Stand::Over(found) => found,
            Stand::Beside(part) => {
                let other = side.other();
                let rim = part.feature(self.pair.model(other), its.face);
                let owned = match part {
                    Part::Corner(i) => its.owns_corner(self.pair, other, i.into()),
                    Part::Edge(i) => its.owns_side(self.pair, other, i.into()),
                    Part::Inside => false,
                };
                // Two vertices are one pair, told from the first.
                let twice = side == Side::Second && matches!(rim, Feature::Vertex(_));
                if !owned || twice {
                    return;
                }
                vertex_rim(self.pair, side, vertex, rim, quest.limit)
            }
        };
        if let Some(contact) = found {
            quest.offer(contact);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;
    use cranny_geometry::{FaceId, VertexId};

    #[test]
    fn a_quest_keeps_the_nearest_or_all() {
        let contact = |v: u32, separation: f64| Contact {
            id: (Feature::Vertex(VertexId(v)), Feature::Face(FaceId(0))),
            point_a: DVec3::ZERO,
            point_b: DVec3::ZERO,
            normal: DVec3::Z,
            separation,
        };
        let offered = [contact(1, 0.5), contact(3, 0.25), contact(2, 0.25), contact(0, 2.0)];
        for (all, expected) in [(false, vec![2]), (true, vec![1, 3, 2])] {
            let mut quest = Quest { limit: 1.0, all, found: Vec::new() };
            offered.into_iter().for_each(|c| quest.offer(c));
            let found: Vec<u32> = quest
                .found
                .iter()
                .map(|c| if let Feature::Vertex(v) = c.id.0 { v.0 } else { u32::MAX })
                .collect();
            assert_eq!(found, expected);
        }
    }
}
