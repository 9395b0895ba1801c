//! Branch and bound for the nearest contact of each pair of patches.
//!
//! Along a thread all triangles of two flanks are nearly equally near, and boxes tell nothing: a box
//! around slanted triangles is thicker than the gap. What tells is a plane over them (`slab_test`);
//! of two triangles in the end, their own: if the corners of one
//! triangle all lie higher over the other's plane than the best contact so far, the pair has no
//! better one (nor do the triangles meet). Nothing else is done for most pairs.
//!
//! The descent sees every pair of triangles that meet, since a bound above 0 is what leaves a pair out:
//! the exact verdict on the surfaces comes with the contacts.

use cranny_exact::{DVec3, classify_triangles};
use cranny_geometry::{Content, EdgeId, FaceId, HalfEdgeId, PatchId, Patches, VertexId};

use super::feature_pair::{Stand, edge_edge, vertex_face, vertex_rim};
use super::slab_test::SlabTest;
use crate::answer::{Contact, Counters, Feature};
use crate::descent::{BoxTest, Opened, opened};
use crate::pair::{Pair, Side};
use crate::surface::FacePair;

/// A patch whose box is longer than this part of its body's counts as coarse: it has large faces (others
/// are cut to this length), so a whole side of the body may stand on it, and one point is not enough.
const COARSE: f64 = 0.26;

/// A triangle and a plane on top of it: square to its unit normal (zero without area), as high as its
/// highest corner, so that heights over it are lower bounds also where rounding tilts a needle's normal.
struct Facet {
    face: FaceId,
    corners: [DVec3; 3],
    normal: DVec3,
    top: f64,
    /// For each side: its outward direction in the plane, as long as the side, and how far along it
    /// the whole triangle reaches from the side's start.
    outward: [(DVec3, f64); 3],
}

impl Facet {
    fn of(pair: &Pair, side: Side, face: FaceId) -> Self {
        let corners @ [a, b, c] = pair.triangle(side, face);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac).normalize_or_zero();
        let outward = [0, 1, 2].map(|i| {
            let start = corners[i];
            let direction = (corners[(i + 1) % 3] - start).cross(normal);
            let reach = corners.map(|p| direction.dot(p - start));
            (direction, reach[0].max(reach[1]).max(reach[2]))
        });
        let top = normal.dot(ab).max(normal.dot(ac)).max(0.0);
        Self { face, corners, normal, top, outward }
    }

    /// Whether another triangle lies farther than `limit` beyond one of the sides.
    fn is_beside(&self, other: &Self, limit: f64) -> bool {
        self.outward.iter().zip(&self.corners).any(|((direction, reach), start)| {
            let beyond = other.corners.map(|p| direction.dot(p - *start));
            let gap = least(&beyond) - reach;
            gap > 0.0 && gap * gap > limit * limit * direction.length_squared()
        })
    }

    fn heights(&self, other: &Self) -> [f64; 3] {
        other.corners.map(|p| self.normal.dot(p - self.corners[0]) - self.top)
    }
}

fn least(heights: &[f64; 3]) -> f64 {
    heights[0].min(heights[1]).min(heights[2])
}

fn side_of(facet: &Facet, i: usize) -> [DVec3; 2] {
    [facet.corners[i], facet.corners[(i + 1) % 3]]
}

/// By how much of its length two edges may miss each other, seen along their common normal, and still
/// be looked at closely. Smaller: rounding of edges at small angles loses crossings at ends.
const NEAR_MISS: f64 = 1e-3;

/// Whether two segments may cross when seen along their common normal, their lines no farther than
/// `below` apart: cheap, and true too often rather than too seldom.
fn may_cross([p0, p1]: [DVec3; 2], [q0, q1]: [DVec3; 2], below: f64) -> bool {
    let (d1, d2, apart) = (p1 - p0, q1 - q0, q0 - p0);
    let cross = d1.cross(d2);
    let squared = cross.length_squared();
    let lift = cross.dot(apart);
    if lift * lift > below * below * squared * (1.0 + NEAR_MISS) {
        return false;
    }
    let within = |t: f64| t >= -NEAR_MISS * squared && t <= (1.0 + NEAR_MISS) * squared;
    within(apart.cross(d2).dot(cross)) && within(apart.cross(d1).dot(cross))
}

/// Order of contacts: the nearest first, ties by lowest features.
pub(super) fn nearer(x: &Contact, y: &Contact) -> std::cmp::Ordering {
    x.separation.total_cmp(&y.separation).then(x.id.cmp(&y.id))
}

/// Searches pairs of patches of one pair of bodies.
pub(super) struct Search<'a, 'b> {
    pair: &'a Pair<'b>,
    boxes: BoxTest,
    slabs: SlabTest,
    error: f64,
    coarse_beyond: [f64; 2],
    stack: Vec<(f64, u32, u32)>,
    leaves: [Vec<Facet>; 2],
    /// Faces that meet, in the order of their discovery; a pair of patches searched twice tells twice.
    pub(super) meeting: Vec<FacePair>,
}

/// What is looked for between two patches.
struct Quest {
    patches: [PatchId; 2],
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
            slabs: SlabTest::of(pair),
            error: pair.length_error(),
            coarse_beyond,
            stack: Vec::new(),
            leaves: [Vec::new(), Vec::new()],
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
        let mut quest = Quest { patches, limit, all: self.is_coarse(patches), found: Vec::new() };
        let patches_of = Side::BOTH.map(|side| pair.model(side).patches());
        let forests = patches_of.map(Patches::trees);
        let roots = [forests[0].root(patches[0].index()), forests[1].root(patches[1].index())];
        let [Some(root_a), Some(root_b)] = roots else { return Vec::new() };
        let (first, second) = (forests[0].arena(), forests[1].arena());
        let mut stack = std::mem::take(&mut self.stack);
        stack.push((0.0, root_a, root_b));
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
                    self.leaves(first.leaf_faces(a), second.leaf_faces(b), &mut quest, counters);
                    continue;
                }
            };
            let bound = |(a, b): (u32, u32)| {
                let (box_a, box_b) = (&first.node(a).bounds, &second.node(b).bounds);
                let (slab_a, slab_b) = (patches_of[0].slab(a), patches_of[1].slab(b));
                let planes = self.slabs.separation_lower([slab_a, slab_b], [box_a, box_b]);
                if planes > quest.limit {
                    return planes;
                }
                planes.max(self.boxes.distance_lower(box_a, box_b))
            };
            let mut children = children.map(|(a, b)| (bound((a, b)), a, b));
            if children[0].0 < children[1].0 {
                children.swap(0, 1); // the nearer one is popped first
            }
            stack.extend(children.into_iter().filter(|child| child.0 <= quest.limit));
        }
        self.stack = stack;
        quest.found
    }

    fn leaves(
        &mut self,
        faces_a: &[FaceId],
        faces_b: &[FaceId],
        quest: &mut Quest,
        counters: &mut Counters,
    ) {
        let mut leaves = std::mem::take(&mut self.leaves);
        for (side, faces) in [(Side::First, faces_a), (Side::Second, faces_b)] {
            let facets = faces.iter().map(|&f| Facet::of(self.pair, side, f));
            leaves[side.index()].clear();
            leaves[side.index()].extend(facets);
        }
        for f in &leaves[0] {
            for g in &leaves[1] {
                let over_f = f.heights(g);
                if least(&over_f) - self.error > quest.limit {
                    continue;
                }
                let over_g = g.heights(f);
                if least(&over_g) - self.error > quest.limit {
                    continue;
                }
                let reach = quest.limit + self.error;
                if f.is_beside(g, reach) || g.is_beside(f, reach) {
                    continue;
                }
                counters.triangle_tests += 1;
                self.facets(f, g, [over_f, over_g], quest);
            }
        }
        self.leaves = leaves;
    }

    fn facets(&mut self, f: &Facet, g: &Facet, [over_f, over_g]: [[f64; 3]; 2], quest: &mut Quest) {
        if least(&over_f).max(least(&over_g)) <= self.error {
            let meeting = classify_triangles(&f.corners, &g.corners);
            if meeting.meets() {
                self.meeting.push(FacePair { first: f.face, second: g.face, meeting });
            }
        }
        for (side, face, its, heights) in
            [(Side::First, f.face, g.face, over_g), (Side::Second, g.face, f.face, over_f)]
        {
            for (corner, height) in heights.into_iter().enumerate() {
                if height - self.error <= quest.limit {
                    self.vertex(side, face, corner, its, quest);
                }
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                let (e, k) = (
                    self.pair.edge(Side::First, f.face, i),
                    self.pair.edge(Side::Second, g.face, j),
                );
                if may_cross(side_of(f, i), side_of(g, j), quest.limit + self.error)
                    && self.owns_edge(Side::First, f.face, e, quest)
                    && self.owns_edge(Side::Second, g.face, k, quest)
                    && let Some(contact) = edge_edge(self.pair, e, k, quest.limit + self.error)
                    && contact.separation >= -self.error
                {
                    quest.offer(contact);
                }
            }
        }
    }

    fn vertex(&self, side: Side, face: FaceId, corner: usize, its: FaceId, quest: &mut Quest) {
        let vertex = self.pair.corner(side, face, corner);
        if !self.owns_vertex(side, face, vertex, quest) {
            return;
        }
        let found = match vertex_face(self.pair, side, vertex, its) {
            Stand::Over(found) => found,
            Stand::Beside(part) => {
                let other = side.other();
                let rim = part.feature(self.pair.model(other), its);
                let owned = match rim {
                    Feature::Vertex(w) => self.owns_vertex(other, its, w, quest),
                    Feature::Edge(e) => self.owns_edge(other, its, e, quest),
                    Feature::Face(_) => false,
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

    /// Whether a corner is looked at from this face: the first of its patch's at the vertex, so that
    /// each vertex is looked at once for each face of the other patch.
    fn owns_vertex(&self, side: Side, face: FaceId, vertex: VertexId, quest: &Quest) -> bool {
        let faces = self.pair.topology(side).faces_at(vertex).iter().copied();
        self.is_first(side, face, faces, quest)
    }

    /// As [`owns_vertex`](Self::owns_vertex), of an edge.
    fn owns_edge(&self, side: Side, face: FaceId, edge: EdgeId, quest: &Quest) -> bool {
        let around = self.pair.topology(side).half_edges(edge).iter();
        self.is_first(side, face, around.map(|h: &HalfEdgeId| h.face()), quest)
    }

    /// Whether what lies between some faces belongs to the patch that is looked at, and this is the first
    /// face of that patch among them.
    fn is_first(
        &self,
        side: Side,
        face: FaceId,
        faces: impl Iterator<Item = FaceId>,
        quest: &Quest,
    ) -> bool {
        let patches = self.pair.model(side).patches();
        let first = faces.min_by_key(|&f| patches.patch_of_face(f));
        first == Some(face) && patches.patch_of_face(face) == quest.patches[side.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_tells_how_far_a_triangle_is() {
        let facet = |z: f64| Facet {
            face: FaceId(0),
            corners: [
                DVec3::new(0.0, 0.0, z),
                DVec3::new(1.0, 0.0, z),
                DVec3::new(0.0, 1.0, z + 1.0),
            ],
            normal: DVec3::Z,
            top: 1.0,
            outward: [(DVec3::ZERO, 0.0); 3],
        };
        assert_eq!(facet(0.0).heights(&facet(2.0)), [1.0, 1.0, 2.0]);
        assert_eq!(least(&facet(0.0).heights(&facet(-2.0))), -3.0);
    }

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
            let mut quest = Quest { patches: [PatchId(0); 2], limit: 1.0, all, found: Vec::new() };
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
