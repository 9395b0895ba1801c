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

use cranny_exact::{Aabb, Meeting};
use cranny_geometry::{Content, PatchId};

use super::facet::{Facet, Outcodes, may_cross, ones};
use super::feature_pair::{Stand, edge_edge, vertex_face, vertex_rim};
use super::ownership::{Owned, Ownership};
use super::posed::{Posed, PosedTree, Sizes, are_apart};
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

/// What of a search serves the next one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    owned: [Ownership; 2],
    /// How much was posed: as much will be.
    sizes: [Sizes; 2],
}

impl Kept {
    /// Makes room for what faces own, which a search for contacts asks for.
    pub(super) fn reserve(&mut self, pair: &Pair) {
        for side in Side::BOTH {
            self.owned[side.index()].reserve(pair, side);
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.owned.iter().map(Ownership::bytes).sum()
    }
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
    /// Scratch: triangles of two leaves that may be within reach of the other leaf.
    near: [Vec<(u32, Aabb)>; 2],
    kept: Kept,
    /// Faces that meet, in the order of their discovery; a pair of patches searched twice tells twice.
    meeting: Vec<FacePair>,
}

/// Which contacts of two patches are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    /// None: only which faces meet.
    Nothing,
    Nearest,
    All,
}

/// What is looked for between two patches.
struct Quest {
    /// No contact farther than this is wanted; shrinks as nearer ones are found.
    limit: f64,
    wanted: Wanted,
    found: Vec<Contact>,
}

impl Quest {
    fn offer(&mut self, contact: Contact) {
        if contact.separation > self.limit {
            return;
        }
        if self.wanted == Wanted::All {
            self.found.push(contact);
        } else if self.found.first().is_none_or(|best| nearer(&contact, best).is_lt()) {
            self.limit = contact.separation.max(0.0);
            self.found = vec![contact];
        }
    }
}

impl<'a, 'b> Search<'a, 'b> {
    pub(super) fn new(pair: &'a Pair<'b>, kept: Kept) -> Self {
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
            posed: Side::BOTH.map(|side| Posed::new(pair, side, kept.sizes[side.index()])),
            near: [Vec::new(), Vec::new()],
            kept,
            meeting: Vec::new(),
        }
    }

    /// What is kept, and the faces that meet, by ascending ids.
    pub(super) fn end(&mut self) -> (Kept, Vec<FacePair>) {
        let mut meeting = std::mem::take(&mut self.meeting);
        meeting.sort_unstable();
        meeting.dedup();
        let Kept { owned, .. } = std::mem::take(&mut self.kept);
        (Kept { owned, sizes: self.posed.each_ref().map(Posed::sizes) }, meeting)
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
        let wanted = if self.is_coarse(patches) { Wanted::All } else { Wanted::Nearest };
        let mut quest = Quest { limit, wanted, found: Vec::new() };
        self.descend(patches, &mut quest, counters);
        quest.found
    }

    /// The faces of two patches that meet; are added to [`meeting`](Self::meeting).
    pub(super) fn meetings(&mut self, patches: [PatchId; 2], counters: &mut Counters) {
        let mut quest = Quest { limit: 0.0, wanted: Wanted::Nothing, found: Vec::new() };
        self.descend(patches, &mut quest, counters);
    }

    /// Whether faces that cross were seen.
    pub(super) fn has_crossed(&self) -> bool {
        self.meeting.iter().any(|p| p.meeting == Meeting::Cross)
    }

    fn descend(&mut self, patches: [PatchId; 2], quest: &mut Quest, counters: &mut Counters) {
        let pair = self.pair;
        let [first, second] = Side::BOTH.map(|side| pair.model(side).patches().trees().arena());
        let [posed_a, posed_b] = &mut self.posed;
        let (Some(tree_a), Some(tree_b)) =
            (posed_a.tree(pair, patches[0]), posed_b.tree(pair, patches[1]))
        else {
            return;
        };
        let trees = [tree_a, tree_b];
        let mut stack = std::mem::take(&mut self.stack);
        let (root_a, root_b) = (tree_a.root, tree_b.root);
        let lower = self.lower(&trees, root_a, root_b, quest.limit);
        stack.extend(lower.map(|lower| (lower, root_a, root_b)));
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
                    self.leaves(&trees, [a, b], quest, counters);
                    continue;
                }
            };
            let lower = |(a, b)| Some((self.lower(&trees, a, b, quest.limit)?, a, b));
            let mut children = children.map(lower);
            if let [Some(left), Some(right)] = children
                && left.0 < right.0
            {
                children.swap(0, 1); // the nearer one is popped first
            }
            stack.extend(children.into_iter().flatten());
        }
        self.stack = stack;
    }

    /// A lower bound of the gap between what two nodes of the patches' trees hold; `None` where that is beyond
    /// `limit`.
    fn lower(&self, trees: &[PosedTree; 2], a: u32, b: u32, limit: f64) -> Option<f64> {
        let [first, second] = &self.posed;
        let (posed_a, posed_b) = (first.node(&trees[0], a), second.node(&trees[1], b));
        let lower = posed_a.separation_lower(posed_b, limit + self.culling_error)?;
        Some(lower - self.culling_error)
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
        near_a.clear();
        near_b.clear();
        let [(tree_a, a), (tree_b, b)] = [(&trees[0], leaves[0]), (&trees[1], leaves[1])];
        let rounding = self.culling_error;
        let reach = quest.limit + rounding;
        let plane = |posed: &Posed, tree: &PosedTree, leaf: u32| {
            let node = posed.node(tree, leaf);
            (node.normal, node.height + reach)
        };
        let [first, second] = &mut self.posed;
        let bounds = [first.open(pair, (tree_a, a)), second.open(pair, (tree_b, b))];
        if !are_apart(&bounds[0], &bounds[1], reach) {
            let over_b = plane(second, tree_b, b);
            first.within((tree_a, a), (&bounds[1], reach), over_b, &mut near_a);
            let kept = near_a.iter().fold(Aabb::EMPTY, |all, (_, bounds)| all.union(bounds));
            let over_a = plane(first, tree_a, a);
            second.within((tree_b, b), (&kept, reach), over_a, &mut near_b);
        }
        for (i, bounds) in &near_a {
            for (j, others) in &near_b {
                let reach = quest.limit + rounding;
                if are_apart(bounds, others, reach) {
                    continue;
                }
                let [first, second] = &mut self.posed;
                let (i, j) = (first.make_facet(*i), second.make_facet(*j));
                let [first, second] = &self.posed;
                let (f, g) = (first.facet(i), second.facet(j));
                let Some(out) = Facet::outcodes([f, g], quest.limit, rounding) else { continue };
                counters.triangle_tests += 1;
                if out.iter().all(|of| of.least_height <= rounding) {
                    meeting.extend(FacePair::of([f.face, g.face], [&f.corners, &g.corners]));
                }
                if quest.wanted != Wanted::Nothing {
                    self.facets(f, g, out, quest);
                }
            }
        }
        (self.meeting, self.near) = (meeting, [near_a, near_b]);
    }

    /// Offers the contacts of two triangles; `out` tells where the corners of the first and of the second are.
    fn facets(&self, f: &Facet, g: &Facet, out: [Outcodes; 2], quest: &mut Quest) {
        let [own_f, own_g] = [self.owned(Side::First, f), self.owned(Side::Second, g)];
        for corner in ones(out[0].corners() & own_f.corners) {
            self.vertex(Side::First, f, corner, g, quest);
        }
        for corner in ones(out[1].corners() & own_g.corners) {
            self.vertex(Side::Second, g, corner, f, quest);
        }
        let sides = out[1].sides() & own_g.sides;
        for i in ones(out[0].sides() & own_f.sides) {
            for j in ones(sides) {
                let below = quest.limit + self.error;
                if !may_cross(f.side(i), g.side(j), below) {
                    continue;
                }
                let (e, k) = (
                    self.pair.edge(Side::First, f.face, i),
                    self.pair.edge(Side::Second, g.face, j),
                );
                if let Some(contact) = edge_edge(self.pair, e, k, quest.limit)
                    && contact.separation >= -self.error
                {
                    quest.offer(contact);
                }
            }
        }
    }

    /// What is looked at from a facet.
    fn owned(&self, side: Side, facet: &Facet) -> Owned {
        self.kept.owned[side.index()].of(self.pair, side, facet.face)
    }

    /// Offers the contact of a corner of one triangle before another.
    fn vertex(&self, side: Side, own: &Facet, corner: usize, its: &Facet, quest: &mut Quest) {
        let vertex = self.pair.corner(side, own.face, corner);
        let (own, before) = ((vertex, own.corners[corner]), (its.face, &its.corners));
        let found = match vertex_face(self.pair, side, own, before, quest.limit) {
            Stand::Over(found) => found,
            Stand::Beside(part) => {
                let other = side.other();
                let rim = part.feature(self.pair.model(other), its.face);
                let Owned { corners, sides } = self.owned(other, its);
                let owned = match part {
                    Part::Corner(i) => corners >> i & 1 != 0,
                    Part::Edge(i) => sides >> i & 1 != 0,
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
        for (wanted, expected) in [(Wanted::Nearest, vec![2]), (Wanted::All, vec![1, 3, 2])] {
            let mut quest = Quest { limit: 1.0, wanted, found: Vec::new() };
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
