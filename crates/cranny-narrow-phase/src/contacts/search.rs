//! Branch and bound for the nearest contact of each pair of patches.
//!
//! Along a thread all triangles of two flanks are nearly equally near, and boxes along the axes of a frame tell nothing: one
//! around slanted triangles is thicker than the gap. What tells is a box that lies along them (`oriented`). In what
//! these leave, corners are compared with triangles and ridges with ridges, each from the one face that owns it, where one
//! lies over the other as the leaf's box has them; ridges only if they touch as they are turned (`gauss_map`).
//!
//! The descent sees every pair of triangles that meet, since a bound above 0 is what leaves a pair out:
//! the exact verdict on the surfaces comes with the contacts.

use cranny_exact::RigidMap;
use cranny_geometry::{Content, PatchId};

use super::close_faces::for_close_faces;
use super::cut::{Cut, End};
use super::gauss_map::Touch;
use super::kept::Kept;
use super::leaf::Parts;
use super::oriented::{Bound, Extent, Oriented};
use super::posed::{Node, Posed, are_apart};
use super::quest::{Ground, Quest, Tip};
use crate::answer::Counters;
use crate::descent::{BoxTest, Opened, opened};
use crate::pair::{Pair, Side};

/// Of two nodes, squares of whose diagonals differ by no more than this factor, both are opened at once. Smaller: what lies
/// between is tested, too; larger: a small node is compared with what it need not be opened for.
const MUCH: f64 = 8.0;

/// Searches pairs of patches of one pair of bodies.
pub(super) struct Search<'a, 'b> {
    pair: &'a Pair<'b>,
    boxes: BoxTest,
    /// What posing may add to a distance between nodes.
    culling_error: f64,
    second_from_first: RigidMap,
    stack: Vec<(Bound, u32, u32)>,
    posed: Box<[Posed; 2]>,
    kept: Kept,
}

impl<'a, 'b> Search<'a, 'b> {
    pub(super) fn new(pair: &'a Pair<'b>, mut kept: Kept) -> Self {
        kept.belong_to(pair);
        let mut posed = kept.posed.take().unwrap_or_else(|| Side::BOTH.map(Posed::new).into());
        posed.iter_mut().for_each(Posed::begin);
        Self {
            pair,
            boxes: BoxTest::of(pair),
            culling_error: pair.culling_error(),
            second_from_first: pair.first_from_second.inverse(),
            stack: Vec::new(),
            posed,
            kept,
        }
    }

    /// What is kept.
    pub(super) fn end(self) -> Kept {
        let Self { mut kept, mut posed, .. } = self;
        posed.iter_mut().for_each(Posed::end);
        kept.posed = Some(posed);
        kept
    }

    pub(super) fn pair(&self) -> &'a Pair<'b> {
        self.pair
    }

    pub(super) fn ground(&self) -> Ground<'_, 'b> {
        Ground { pair: self.pair, owned: &self.kept.owned }
    }

    /// Whether the boxes of two patches may be within `margin`.
    pub(super) fn may_be_within(
        &self,
        patches: [PatchId; 2],
        margin: f64,
        counters: &mut Counters,
    ) -> bool {
        counters.node_tests += 1;
        let bounds =
            |side: Side| &self.pair.model(side).patches().patch(patches[side.index()]).bounds;
        !self.boxes.apart(bounds(Side::First), bounds(Side::Second), margin)
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

    /// Looks at two patches.
    pub(super) fn look(
        &mut self,
        patches: [PatchId; 2],
        quest: &mut impl Quest,
        counters: &mut Counters,
    ) {
        let Some(roots) = self.roots(patches) else { return };
        let ([a, b], limit) = (self.oriented(roots), quest.limit() + self.culling_error);
        let bound = a.apart(b, limit);
        if bound.lower <= limit {
            self.descend((bound, roots), quest, counters, |_, _, _| {});
        }
    }

    /// Looks at two patches from where the last search of them ended.
    pub(super) fn look_on(
        &mut self,
        patches: [PatchId; 2],
        cut: &mut Cut,
        quest: &mut impl Quest,
        counters: &mut Counters,
    ) {
        let Some([root_a, root_b]) = self.roots(patches) else { return };
        let (begun, mut nearest) = (cut.begin(), 0);
        for at in 0..begun {
            let limit = quest.limit() + self.culling_error;
            if cut.is_apart(at, limit) {
                continue;
            }
            let End { nodes, axis, .. } = cut.ends()[at];
            let nodes = [root_a + nodes[0], root_b + nodes[1]];
            counters.node_tests += 1;
            let [a, b] = self.oriented(nodes);
            let lower = a.apart_along(b, axis);
            if lower > limit {
                cut.stays(at, Bound { lower, axis });
                continue;
            }
            let bound = a.apart(b, limit);
            if bound.lower > limit {
                cut.stays(at, bound);
                continue;
            }
            self.descend((bound, nodes), quest, counters, |[a, b], bound, is_nearer| {
                if is_nearer {
                    nearest = cut.ends().len();
                }
                cut.add([a - root_a, b - root_b], bound);
            });
            // Whatever is beneath it has been added.
            nearest = if nearest + 1 == cut.ends().len() { at } else { nearest };
            cut.drop(at);
        }
        cut.end(nearest);
    }

    /// Where the roots of two patches stand; `None` where one holds no faces.
    fn roots(&mut self, patches: [PatchId; 2]) -> Option<[u32; 2]> {
        let [posed_a, posed_b] = &mut *self.posed;
        Some([posed_a.root(self.pair, patches[0])?, posed_b.root(self.pair, patches[1])?])
    }

    #[inline]
    fn oriented(&self, [a, b]: [u32; 2]) -> [&Oriented; 2] {
        [self.posed[0].node(a).oriented(), self.posed[1].node(b).oriented()]
    }

    /// Opens two nodes, whose bound is given, and what is beneath them. Pairs of nodes that are not opened are told, with what parts
    /// them and whether something was found there that is nearer than all before.
    fn descend(
        &mut self,
        (bound, [a, b]): (Bound, [u32; 2]),
        quest: &mut impl Quest,
        counters: &mut Counters,
        mut ended: impl FnMut([u32; 2], Bound, bool),
    ) {
        let (mut stack, rounding) = (std::mem::take(&mut self.stack), self.culling_error);
        stack.push((bound, a, b));
        while let Some((bound, a, b)) = stack.pop() {
            if bound.lower > quest.limit() + rounding {
                ended([a, b], bound, false);
                continue;
            }
            counters.node_tests += 1;
            let [first, second] = &*self.posed;
            let (node_a, node_b) = (first.node(a), second.node(b));
            let (limit, start) = (quest.limit(), stack.len());
            // Both are opened, unless one is much larger or cannot be: what lies between is mostly opened, too.
            let (own, its) = ([a], [b]);
            let (beneath_a, beneath_b): (&[u32], &[u32]) =
                match [node_a, node_b].map(Node::children) {
                    [None, None] => {
                        self.leaves([a, b], bound.lower - rounding, quest, counters);
                        ended([a, b], bound, quest.limit() < limit);
                        continue;
                    }
                    [Some(left), None] => (left, &its),
                    [None, Some(right)] => (&own, right),
                    [Some(_), Some(right)] if node_b.size >= MUCH * node_a.size => (&own, right),
                    [Some(left), Some(_)] if node_a.size >= MUCH * node_b.size => (left, &its),
                    [Some(left), Some(right)] => (left, right),
                };
            for &a in beneath_a {
                let own = first.node(a).oriented();
                for &b in beneath_b {
                    let bound = own.apart(second.node(b).oriented(), limit + rounding);
                    if bound.lower > limit + rounding {
                        ended([a, b], bound, false);
                    } else {
                        stack.push((bound, a, b));
                    }
                }
            }
            // The nearest is popped first.
            let (mut nearest, last) = (start, stack.len());
            for at in start..last {
                if stack[at].0.lower < stack[nearest].0.lower {
                    nearest = at;
                }
            }
            if start < last {
                stack.swap(nearest, last - 1);
            }
        }
        self.stack = stack;
    }

    /// Compares what two leaves have, given how far apart they are at least.
    fn leaves(
        &mut self,
        [a, b]: [u32; 2],
        lower: f64,
        quest: &mut impl Quest,
        counters: &mut Counters,
    ) {
        let (pair, rounding) = (self.pair, self.culling_error);
        let [first, second] = &mut *self.posed;
        first.open(pair, a);
        second.open(pair, b);
        let close = quest.closeness().filter(|&length| lower <= length).map(|l| l + rounding);
        let close =
            close.filter(|&reach| !first.outline(a).is_apart_from(&second.outline(b), reach));
        // Which faces meet is no matter of owners.
        let (owned, wanted) = (&self.kept.owned, quest.wants_features());
        first.fill(pair, a, wanted.then_some(&owned[0]));
        second.fill(pair, b, wanted.then_some(&owned[1]));
        let [first, second] = &*self.posed;
        let (parts_a, parts_b) = (first.parts(a), second.parts(b));
        if let Some(reach) = close {
            for_close_faces(pair, [&parts_a, &parts_b], reach, |faces, triangles| {
                quest.faces(faces, triangles, counters);
            });
        }
        if wanted {
            self.corners([&parts_a, &parts_b], quest, counters);
            self.corners([&parts_b, &parts_a], quest, counters);
            self.edges([&parts_a, &parts_b], quest, counters);
        }
    }

    /// Tells of a leaf's corners before another's faces, and beside them.
    fn corners(&self, [own, its]: [&Parts; 2], quest: &mut impl Quest, counters: &mut Counters) {
        let rounding = self.culling_error;
        let mut reach = quest.limit() + rounding;
        if are_apart(own.corner_bounds(), its.bounds(), reach) {
            return;
        }
        let ground = self.ground();
        let (points, its_points, oriented) = (own.points(), its.points(), its.oriented());
        let (facets, extents) = (its.facets(), its.facet_extents());
        for corner in own.corners() {
            let at = corner.at(points);
            let Some(within) = oriented.reached(at, reach) else { continue };
            let local = match its.side() {
                Side::First => at,
                Side::Second => self.second_from_first.apply(at),
            };
            let tip = Tip { side: own.side(), vertex: corner.vertex, at };
            for (facet, extent) in facets.iter().zip(extents) {
                if extent.may_reach(within, reach) && facet.may_reach(local, reach) {
                    quest.corner(ground, tip, (facet.face, &facet.corners(its_points)), counters);
                    reach = quest.limit() + rounding;
                }
            }
        }
    }

    /// Tells of the edges of two leaves.
    fn edges(&self, [a, b]: [&Parts; 2], quest: &mut impl Quest, counters: &mut Counters) {
        let rounding = self.culling_error;
        if are_apart(a.edge_bounds(), b.edge_bounds(), quest.limit() + rounding) {
            return;
        }
        let (ground, are_turned_so) = (self.ground(), quest.is_for_now());
        let oriented = b.oriented();
        let ([own, its], extents) = ([a.points(), b.points()], b.edge_extents());
        let (others, spans) = (b.edges(), b.spans());
        let bounds = b.edge_bounds();
        for (e, span) in a.edges().iter().zip(a.spans()) {
            let reach = quest.limit() + rounding;
            if are_apart(&span.bounds, bounds, reach) {
                continue;
            }
            let [start, end] = e.ends(own);
            let extent = Extent::of([oriented.within(start), oriented.within(end)]);
            for (at, other) in extents.iter().enumerate() {
                if !extent.may_meet(other, reach) {
                    continue;
                }
                let (k, beside) = (&others[at], &spans[at]);
                let touch = if are_turned_so {
                    span.arc.touch(&beside.arc, rounding)
                } else {
                    Touch::Perhaps
                };
                if touch != Touch::Never {
                    let segments = [[start, end], k.ends(its)];
                    quest.edges(ground, [e.edge, k.edge], segments, touch, counters);
                }
            }
        }
    }
}
