//! Branch and bound for the nearest contact of each pair of patches.
//!
//! Along a thread all triangles of two flanks are nearly equally near, and boxes tell nothing: a box
//! around slanted triangles is thicker than the gap. What tells is a plane over them (`posed`);
//! of two leaves in the end, their points: if those of one all lie higher over the other's plane than
//! the best contact so far, the pair has no better one (nor do triangles meet). In what is left, corners
//! are compared with triangles and ridges with ridges, each from the one face that owns it.
//!
//! The descent sees every pair of triangles that meet, since a bound above 0 is what leaves a pair out:
//! the exact verdict on the surfaces comes with the contacts.

use cranny_exact::{Aabb, Meeting};
use cranny_geometry::{Content, PatchId};

use super::facet::{Facet, may_cross};
use super::feature_pair::{Stand, edge_edge, vertex_face, vertex_rim};
use super::leaf::{Corner, Parts};
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
        let (pair, rounding, wanted) = (self.pair, self.culling_error, quest.wanted);
        let at = [(&trees[0], leaves[0]), (&trees[1], leaves[1])];
        let reach = quest.limit + rounding;
        let [first, second] = &mut self.posed;
        first.open(pair, at[0]);
        // What is posed of the one may tell already.
        if first.outline(at[0]).is_apart_from_node(second.node(at[1].0, at[1].1), reach) {
            return;
        }
        second.open(pair, at[1]);
        let [first, second] = &self.posed;
        let (a, b) = (first.outline(at[0]), second.outline(at[1]));
        if a.is_apart_from(&b, reach) {
            return;
        }
        let may_meet = !a.is_apart_from(&b, rounding);
        for (posed, at) in self.posed.iter_mut().zip(at) {
            let side = posed.side();
            let ownership = &self.kept.owned[side.index()];
            // Which faces meet is no matter of owners.
            posed.fill(pair, at, |face| match wanted {
                Wanted::Nothing => Owned::NOTHING,
                _ => ownership.of(pair, side, face),
            });
        }
        let [first, second] = &self.posed;
        let (a, b) = (first.parts(at[0]), second.parts(at[1]));
        if may_meet {
            meet([&a, &b], rounding, &mut self.meeting, counters);
        }
        if wanted != Wanted::Nothing {
            self.corners(Side::First, [&a, &b], quest, counters);
            self.corners(Side::Second, [&b, &a], quest, counters);
            self.edges([&a, &b], quest, counters);
        }
    }

    /// Offers the contacts of a leaf's corners before another's faces, and beside them.
    fn corners(
        &self,
        side: Side,
        [own, its]: [&Parts; 2],
        quest: &mut Quest,
        counters: &mut Counters,
    ) {
        let rounding = self.culling_error;
        if !its.is_near(own.corner_bounds, quest.limit + rounding) {
            return;
        }
        for corner in own.corners {
            let reach = quest.limit + rounding;
            if !its.may_reach(&[corner.at], &Aabb { min: corner.at, max: corner.at }, reach) {
                continue;
            }
            for facet in its.facets {
                if facet.may_reach(corner.at, quest.limit + rounding) {
                    counters.triangle_tests += 1;
                    self.corner(side, corner, facet, quest);
                }
            }
        }
    }

    /// Offers the contact of a corner before a triangle.
    fn corner(&self, side: Side, corner: &Corner, its: &Facet, quest: &mut Quest) {
        let &Corner { vertex, at } = corner;
        let before = (its.face, &its.corners);
        let found = match vertex_face(self.pair, side, (vertex, at), before, quest.limit) {
            Stand::Over(found) => found,
            Stand::Beside(part) => {
                let other = side.other();
                let rim = part.feature(self.pair.model(other), its.face);
                let owned = self.kept.owned[other.index()].of(self.pair, other, its.face);
                let is_owned = match part {
                    Part::Corner(i) => owned.corners >> i & 1 != 0,
                    Part::Edge(i) => owned.sides >> i & 1 != 0,
                    Part::Inside => false,
                };
                // Two vertices are one pair, told from the first.
                let twice = side == Side::Second && matches!(rim, Feature::Vertex(_));
                if !is_owned || twice {
                    return;
                }
                vertex_rim(self.pair, side, vertex, rim, quest.limit)
            }
        };
        if let Some(contact) = found {
            quest.offer(contact);
        }
    }

    /// Offers the contacts of the edges of two leaves.
    fn edges(&self, [a, b]: [&Parts; 2], quest: &mut Quest, counters: &mut Counters) {
        let rounding = self.culling_error;
        if are_apart(a.edge_bounds, b.edge_bounds, quest.limit + rounding) {
            return;
        }
        for e in a.edges {
            let reach = quest.limit + rounding;
            if are_apart(&e.bounds, b.edge_bounds, reach) || !b.may_reach(&e.ends, &e.bounds, reach)
            {
                continue;
            }
            for k in b.edges {
                if are_apart(&e.bounds, &k.bounds, quest.limit + rounding)
                    || !may_cross(e.ends, k.ends, quest.limit + self.error)
                {
                    continue;
                }
                counters.triangle_tests += 1;
                if let Some(contact) = edge_edge(self.pair, e.edge, k.edge, quest.limit)
                    && contact.separation >= -self.error
                {
                    quest.offer(contact);
                }
            }
        }
    }
}

/// Lists the faces of two leaves that meet.
fn meet([a, b]: [&Parts; 2], rounding: f64, meeting: &mut Vec<FacePair>, counters: &mut Counters) {
    for f in a.facets {
        if f.is_beneath(b.points, rounding) {
            continue;
        }
        let bounds = Aabb::of_points(f.corners);
        for g in b.facets {
            if !are_apart(&bounds, &Aabb::of_points(g.corners), rounding)
                && !f.is_beneath(&g.corners, rounding)
                && !g.is_beneath(&f.corners, rounding)
            {
                counters.triangle_tests += 1;
                meeting.extend(FacePair::of([f.face, g.face], [&f.corners, &g.corners]));
            }
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
