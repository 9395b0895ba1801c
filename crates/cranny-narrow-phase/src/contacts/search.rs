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

use cranny_exact::{Aabb, DVec3, Meeting, RigidMap};
use cranny_geometry::{Content, PatchId};

use super::coarse::Coarse;
use super::facet::{Facet, may_cross};
use super::feature_pair::{Stand, edge_edge_at, vertex_face, vertex_rim};
use super::kept::Kept;
use super::leaf::{Corner, Parts, Segment};
use super::meet::meet;
use super::posed::{Posed, are_apart};
use crate::answer::{Contact, Counters, Feature};
use crate::descent::{BoxTest, Opened, opened};
use crate::pair::{Pair, Side};
use crate::surface::FacePair;
use crate::triangle_distance::Part;

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
    coarse: Coarse,
    second_from_first: RigidMap,
    stack: Vec<(f64, u32, u32)>,
    /// Scratch: edges of the second leaf that may be near any of the first's.
    near_edges: Vec<(Segment, [DVec3; 2], Aabb)>,
    posed: Box<[Posed; 2]>,
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
    pub(super) fn new(pair: &'a Pair<'b>, mut kept: Kept) -> Self {
        kept.belong_to(pair);
        let mut posed = kept.posed.take().unwrap_or_else(|| Side::BOTH.map(Posed::new).into());
        posed.iter_mut().for_each(|posed| posed.begin(pair));
        Self {
            pair,
            boxes: BoxTest::of(pair),
            error: pair.length_error(),
            culling_error: pair.culling_error(),
            coarse: Coarse::of(pair),
            second_from_first: pair.first_from_second.inverse(),
            stack: Vec::new(),
            near_edges: Vec::new(),
            posed,
            kept,
            meeting: Vec::new(),
        }
    }

    /// What is kept, and the faces that meet, by ascending ids.
    pub(super) fn end(self) -> (Kept, Vec<FacePair>) {
        let Self { mut meeting, mut kept, mut posed, .. } = self;
        meeting.sort_unstable();
        meeting.dedup();
        posed.iter_mut().for_each(Posed::end);
        kept.posed = Some(posed);
        (kept, meeting)
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

    /// The nearest contact of two patches across a gap of at most `margin`, or all of them where a
    /// patch is coarse. `limit <= margin`: that of a contact known to exist, or the margin.
    pub(super) fn between(
        &mut self,
        patches: [PatchId; 2],
        limit: f64,
        counters: &mut Counters,
    ) -> Vec<Contact> {
        let wanted =
            if self.coarse.holds(self.pair, patches) { Wanted::All } else { Wanted::Nearest };
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
        let [posed_a, posed_b] = &mut *self.posed;
        let roots = (posed_a.root(self.pair, patches[0]), posed_b.root(self.pair, patches[1]));
        let (Some(root_a), Some(root_b)) = roots else { return };
        let mut stack = std::mem::take(&mut self.stack);
        let lower = self.lower(root_a, root_b, quest.limit);
        stack.extend(lower.map(|lower| (lower, root_a, root_b)));
        while let Some((lower, a, b)) = stack.pop() {
            if lower > quest.limit {
                continue;
            }
            counters.node_tests += 1;
            let [node_a, node_b] = [self.posed[0].node(a), self.posed[1].node(b)];
            // The larger of two nodes is opened, or the one that can be.
            let children = match (node_a.children(), node_b.children()) {
                (Some([left, right]), other) if other.is_none() || node_a.size >= node_b.size => {
                    [(left, b), (right, b)]
                }
                (_, Some([left, right])) => [(a, left), (a, right)],
                _ => {
                    self.leaves([a, b], quest, counters);
                    continue;
                }
            };
            let [x, y] = children;
            let lower_x = self.lower(x.0, x.1, quest.limit);
            let lower_y = self.lower(y.0, y.1, quest.limit);
            // The nearer one is popped first.
            let is_x_nearer = lower_x < lower_y;
            if is_x_nearer {
                stack.extend(lower_y.map(|lower| (lower, y.0, y.1)));
            }
            stack.extend(lower_x.map(|lower| (lower, x.0, x.1)));
            if !is_x_nearer {
                stack.extend(lower_y.map(|lower| (lower, y.0, y.1)));
            }
        }
        self.stack = stack;
    }

    /// A lower bound of the gap between what two nodes of the patches' trees hold; `None` where that is beyond
    /// `limit`.
    #[inline]
    fn lower(&self, a: u32, b: u32, limit: f64) -> Option<f64> {
        let [first, second] = &*self.posed;
        let lower = first.node(a).separation_lower(second.node(b), limit + self.culling_error)?;
        Some(lower - self.culling_error)
    }

    fn leaves(&mut self, [a, b]: [u32; 2], quest: &mut Quest, counters: &mut Counters) {
        let (pair, rounding, wanted) = (self.pair, self.culling_error, quest.wanted);
        let reach = quest.limit + rounding;
        let [first, second] = &mut *self.posed;
        first.open(pair, a);
        // What is posed of the one may tell already.
        if first.outline(a).is_apart_from_node(second.node(b), reach) {
            return;
        }
        second.open(pair, b);
        let (outline_a, outline_b) = (first.outline(a), second.outline(b));
        if outline_a.is_apart_from(&outline_b, reach) {
            return;
        }
        let may_meet = !outline_a.is_apart_from(&outline_b, rounding);
        for (posed, (at, owned)) in
            [first, second].into_iter().zip([a, b].into_iter().zip(&self.kept.owned))
        {
            // Which faces meet is no matter of owners.
            posed.fill(pair, at, (wanted != Wanted::Nothing).then_some(owned));
        }
        let [first, second] = &*self.posed;
        let (parts_a, parts_b) = (first.parts(a), second.parts(b));
        if may_meet {
            meet(pair, [&parts_a, &parts_b], &mut self.meeting, counters);
        }
        if wanted != Wanted::Nothing {
            self.corners([&parts_a, &parts_b], quest, counters);
            self.corners([&parts_b, &parts_a], quest, counters);
            self.edges([a, b], quest, counters);
        }
    }

    /// Offers the contacts of a leaf's corners before another's faces, and beside them.
    fn corners(&self, [own, its]: [&Parts; 2], quest: &mut Quest, counters: &mut Counters) {
        let rounding = self.culling_error;
        if are_apart(own.corner_bounds(), its.bounds(), quest.limit + rounding) {
            return;
        }
        let (points, its_points) = (own.points(), its.points());
        for corner in own.corners() {
            let (at, reach) = (corner.at(points), quest.limit + rounding);
            if !its.may_reach(&[at], &Aabb { min: at, max: at }, reach) {
                continue;
            }
            let local = match its.side() {
                Side::First => at,
                Side::Second => self.second_from_first.apply(at),
            };
            for facet in its.facets() {
                if facet.may_reach(local, quest.limit + rounding) {
                    counters.triangle_tests += 1;
                    let triangle = facet.corners(its_points);
                    self.corner(own.side(), (corner, at), (facet, &triangle), quest);
                }
            }
        }
    }

    /// Offers the contact of a corner before a triangle.
    fn corner(
        &self,
        side: Side,
        (corner, at): (&Corner, DVec3),
        (its, corners): (&Facet, &[DVec3; 3]),
        quest: &mut Quest,
    ) {
        let (vertex, before) = (corner.vertex, (its.face, corners));
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
    fn edges(&mut self, [a, b]: [u32; 2], quest: &mut Quest, counters: &mut Counters) {
        let rounding = self.culling_error;
        let mut near = std::mem::take(&mut self.near_edges);
        let [a, b] = [self.posed[0].parts(a), self.posed[1].parts(b)];
        let [points_a, points_b] = [a.points(), b.points()];
        near.clear();
        if !are_apart(a.edge_bounds(), b.edge_bounds(), quest.limit + rounding) {
            let reach = quest.limit + rounding;
            for (k, around) in b.edges() {
                let ends = k.ends(points_b);
                if !are_apart(around, a.edge_bounds(), reach) && a.may_reach(&ends, around, reach) {
                    near.push((*k, ends, *around));
                }
            }
        }
        for (e, around) in a.edges() {
            if near.is_empty() {
                break;
            }
            let (ends, reach) = (e.ends(points_a), quest.limit + rounding);
            if are_apart(around, b.edge_bounds(), reach) || !b.may_reach(&ends, around, reach) {
                continue;
            }
            for (k, its_ends, its_box) in &near {
                if are_apart(around, its_box, quest.limit + rounding)
                    || !may_cross(ends, *its_ends, quest.limit + self.error)
                {
                    continue;
                }
                counters.triangle_tests += 1;
                let segments = [ends, *its_ends];
                let found = edge_edge_at(self.pair, [e.edge, k.edge], segments, quest.limit);
                if let Some(contact) = found
                    && contact.separation >= -self.error
                {
                    quest.offer(contact);
                }
            }
        }
        self.near_edges = near;
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
