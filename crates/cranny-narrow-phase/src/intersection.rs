//! Intersection segments of crossing faces, joined by the features that make their ends.
//!
//! An end of a segment is where an edge of one body pierces a face of the other (or, in special
//! positions, where lower features meet). It is known by its pair of features, which exact signs
//! decide; its coordinates are constructed once. Two segments meet if and only if they share an
//! end: no distance is compared.
//!
//! Every segment runs along n × m, n and m being the normals of the first and the second body's
//! face. Seen against n, the part of the first face that lies inside the second body is then on the
//! left. The direction too is decided by signs: where the first body's edge, run through as its
//! face has it, goes inward through the other surface, the segment ends; where it goes outward, it
//! begins.
//!
//! In general position the signs that decide that two faces cross also decide which edges make the
//! ends ([`cross_triangles`](cranny_exact::cross_triangles)); only what is not in general position
//! is looked at feature by feature.

use std::collections::HashMap;

use cranny_exact::{
    Crossing, CrossingEnd, DVec3, Meeting, Piercing, SegmentFeature, Sign, TriangleFeature,
    locate_piercing, orient3d,
};
use cranny_geometry::{EdgeId, FaceId, HalfEdgeId};

use crate::answer::Feature;
use crate::numbering::Numbering;
use crate::pair::{Pair, Side};
use crate::surface::FacePair;
use cranny_geometry::triangle_distance::closest_on_segments;

/// A point of the intersection curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// On the first body, on the second.
    pub(crate) features: (Feature, Feature),
    /// In the pair's frame.
    pub(crate) point: DVec3,
    /// Where an edge pierces a face, how it does.
    pub(crate) passage: Option<EdgePassage>,
}

/// How an edge, in its own direction (from its lesser to its greater vertex), passes through a
/// face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgePassage {
    /// How far along the edge, from 0 to 1.
    pub(crate) parameter: f64,
    /// It goes from the front to the back.
    pub(crate) inward: bool,
}

/// Where two faces intersect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub(crate) faces: [FaceId; 2],
    /// Start and end, as indices of nodes.
    pub(crate) nodes: [usize; 2],
}

/// All intersection segments of a pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct Intersection {
    pub(crate) nodes: Vec<Node>,
    pub(crate) segments: Vec<Segment>,
    /// Every pair of faces crosses, each end is an edge in a face, and the directions agree: the
    /// curves of closed surfaces are then closed, and cut out pieces without doubt.
    pub(crate) generic: bool,
}

/// Builds the segments of the pairs that share more than a plane.
pub(crate) fn intersect(pair: &Pair, pairs: &[FacePair]) -> Intersection {
    let mut out =
        in_general_position(pair, pairs).unwrap_or_else(|| feature_by_feature(pair, pairs));
    if pair.is_closed() {
        let mut balance = vec![0i32; out.nodes.len()];
        for s in &out.segments {
            balance[s.nodes[0]] += 1;
            balance[s.nodes[1]] -= 1;
        }
        out.generic &= balance.iter().all(|&b| b == 0);
    }
    out
}

/// The segments of pairs that all cross in general position; `None` if some do not.
fn in_general_position(pair: &Pair, pairs: &[FacePair]) -> Option<Intersection> {
    let mut out = Intersection { generic: true, ..Intersection::default() };
    out.segments.reserve(pairs.len());
    out.nodes.reserve(pairs.len());
    let mut named = Numbering::default();
    for p in pairs {
        let crossing = p.crossing?;
        let mut nodes = [0; 2];
        for which in numbered_ends(crossing) {
            let end = PiercedEnd::of(pair, p, crossing, which);
            let (number, is_new) = named.number(end.key());
            if is_new {
                out.nodes.push(end.node(pair));
            }
            nodes[which] = number as usize;
        }
        out.segments.push(Segment { faces: [p.first, p.second], nodes });
    }
    Some(out)
}

/// The segments of any pairs.
fn feature_by_feature(pair: &Pair, pairs: &[FacePair]) -> Intersection {
    let mut builder = Builder { pair, by_features: HashMap::new(), out: Intersection::default() };
    builder.out.generic = true;
    for p in pairs {
        builder.add(p);
    }
    builder.out
}

/// The first node of two faces' intersection, as [`intersect`] numbers them; `None` where it has
/// none.
pub(crate) fn first_node(pair: &Pair, faces: &FacePair) -> Option<Node> {
    match faces.crossing {
        Some(crossing) => {
            let [first, _] = numbered_ends(crossing);
            Some(PiercedEnd::of(pair, faces, crossing, first).node(pair))
        }
        None => feature_by_feature(pair, std::slice::from_ref(faces)).nodes.first().copied(),
    }
}

/// The ends of a segment in the order in which its nodes are numbered: one of their own, whichever
/// way the segment runs.
fn numbered_ends(crossing: Crossing) -> [usize; 2] {
    if crossing.ends[1] < crossing.ends[0] { [1, 0] } else { [0, 1] }
}

/// Where an edge of one of two faces that cross pierces the other.
struct PiercedEnd {
    edge: EdgeId,
    end: CrossingEnd,
    /// The segment ends here, and does not begin.
    is_end: bool,
    faces: [FaceId; 2],
}

impl PiercedEnd {
    fn of(pair: &Pair, p: &FacePair, crossing: Crossing, which: usize) -> Self {
        let (end, faces) = (crossing.ends[which], [p.first, p.second]);
        let owner = usize::from(end.owner);
        let half_edge = HalfEdgeId::of(faces[owner], usize::from(end.edge));
        let edge = pair.topology(Side::BOTH[owner]).edge_of(half_edge);
        Self { edge, end, is_end: which == 1, faces }
    }

    /// The edge, the pierced face and whose the edge is, in one number.
    fn key(&self) -> u64 {
        // A mesh has fewer than 2^31 faces, since its half-edges have numbers.
        let pierced = self.faces[1 - usize::from(self.end.owner)];
        let pierced = u64::from(pierced.0) << 1 | u64::from(self.end.owner);
        u64::from(self.edge.0) << 32 | pierced
    }

    fn node(&self, pair: &Pair) -> Node {
        let Self { edge, end, is_end, faces } = *self;
        let (owner, i) = (usize::from(end.owner), usize::from(end.edge));
        let triangle = |k: usize| pair.triangle(Side::BOTH[k], faces[k]);
        let (own, other) = (triangle(owner), triangle(1 - owner));
        let corners = pair.mesh(Side::BOTH[owner]).corners(faces[owner]);
        let along = corners[i] <= corners[(i + 1) % 3];
        // As the first's face has its edge, it goes inward where the segment ends; as the second's,
        // where it begins.
        let inward = (is_end == (owner == 0)) == along;
        let ends = if along { [own[i], own[(i + 1) % 3]] } else { [own[(i + 1) % 3], own[i]] };
        let pierced = Feature::Face(faces[1 - owner]);
        let features = Side::BOTH[owner].ordered(Feature::Edge(edge), pierced);
        pierced_node(features.into(), &ends, &other, inward)
    }
}

struct Builder<'a, 'b> {
    pair: &'a Pair<'b>,
    by_features: HashMap<(Feature, Feature), usize>,
    out: Intersection,
}

/// An end of a segment as one pair of faces sees it.
#[derive(Clone, Copy)]
struct End {
    node: usize,
    /// Whether the segment begins here; `None` where the position is special.
    begins: Option<bool>,
}

impl Builder<'_, '_> {
    fn add(&mut self, p: &FacePair) {
        let mut ends: Vec<End> = Vec::with_capacity(2);
        for side in Side::BOTH {
            for i in 0..3 {
                if let Some(end) = self.pierce(p, side, i)
                    && ends.iter().all(|e| e.node != end.node)
                {
                    ends.push(end);
                }
            }
        }
        self.out.generic &= p.meeting == Meeting::Cross && ends.len() == 2;
        if let [a, b] = ends[..] {
            let reversed = match (a.begins, b.begins) {
                (Some(x), Some(y)) if x != y => y,
                _ => {
                    self.out.generic = false;
                    self.runs_against_the_normals(p, a.node, b.node)
                }
            };
            let nodes = if reversed { [b.node, a.node] } else { [a.node, b.node] };
            self.out.segments.push(Segment { faces: [p.first, p.second], nodes });
        }
    }

    /// Whether and where side `i` of a face meets the other face off its plane.
    fn pierce(&mut self, p: &FacePair, side: Side, i: usize) -> Option<End> {
        let (pair, other_side) = (self.pair, side.other());
        let (own, other) = (p.face(side), p.face(other_side));
        let corners = pair.triangle(side, own);
        let ends = [corners[i], corners[(i + 1) % 3]];
        let triangle = pair.triangle(other_side, other);
        let Piercing::Point { on_segment, on_triangle } = locate_piercing(&ends, &triangle) else {
            return None;
        };
        let own_feature = match on_segment {
            SegmentFeature::Start => Feature::Vertex(pair.corner(side, own, i)),
            SegmentFeature::Interior => Feature::Edge(pair.edge(side, own, i)),
            SegmentFeature::End => Feature::Vertex(pair.corner(side, own, (i + 1) % 3)),
        };
        let other_feature = match on_triangle {
            TriangleFeature::Vertex(k) => {
                Feature::Vertex(pair.corner(other_side, other, k as usize))
            }
            TriangleFeature::Edge(k) => Feature::Edge(pair.edge(other_side, other, k as usize)),
            TriangleFeature::Interior => Feature::Face(other),
        };
        let simple = matches!((own_feature, other_feature), (Feature::Edge(_), Feature::Face(_)));
        // The side starts in front of the other face, so it goes inward.
        let inward = orient3d(triangle[0], triangle[1], triangle[2], ends[0]) == Sign::Positive;
        let begins = simple.then_some(inward == (side == Side::Second));
        let features = side.ordered(own_feature, other_feature);
        Some(End { node: self.node(features.into()), begins })
    }

    fn node(&mut self, features: (Feature, Feature)) -> usize {
        let (pair, nodes) = (self.pair, &mut self.out.nodes);
        *self.by_features.entry(features).or_insert_with(|| {
            nodes.push(construct(pair, features));
            nodes.len() - 1
        })
    }

    fn runs_against_the_normals(&self, p: &FacePair, a: usize, b: usize) -> bool {
        let [n, m] = Side::BOTH.map(|side| self.pair.area_vector(side, p.face(side)));
        n.cross(m).dot(self.out.nodes[b].point - self.out.nodes[a].point) < 0.0
    }
}

/// Where two features meet; which they do.
fn construct(pair: &Pair, features: (Feature, Feature)) -> Node {
    let at = |point| Node { features, point, passage: None };
    let (side, edge, face) = match features {
        (Feature::Edge(e), Feature::Face(f)) => (Side::First, e, f),
        (Feature::Face(f), Feature::Edge(e)) => (Side::Second, e, f),
        (Feature::Vertex(v), _) => return at(pair.position(Side::First, v)),
        (_, Feature::Vertex(v)) => return at(pair.position(Side::Second, v)),
        (Feature::Edge(e), Feature::Edge(g)) => {
            let (p, q) = (pair.segment(Side::First, e), pair.segment(Side::Second, g));
            return at(p[0] + (p[1] - p[0]) * closest_on_segments(&p, &q).0);
        }
        (Feature::Face(f), Feature::Face(_)) => return at(pair.triangle(Side::First, f)[0]),
    };
    let (ends, triangle) = (pair.segment(side, edge), pair.triangle(side.other(), face));
    let inward = orient3d(triangle[0], triangle[1], triangle[2], ends[0]) == Sign::Positive;
    pierced_node(features, &ends, &triangle, inward)
}

/// The node in which an edge pierces a face's plane, between the edge's ends.
fn pierced_node(
    features: (Feature, Feature),
    &[p, q]: &[DVec3; 2],
    [a, b, c]: &[DVec3; 3],
    inward: bool,
) -> Node {
    let normal = 0.5 * (*b - *a).cross(*c - *a);
    let (dp, dq) = (normal.dot(p - *a), normal.dot(q - *a));
    let parameter = if dp == dq { 0.5 } else { (dp / (dp - dq)).clamp(0.0, 1.0) };
    let passage = Some(EdgePassage { parameter, inward });
    Node { features, point: p + (q - p) * parameter, passage }
}

/// The segments that leave each node, for following them.
pub(crate) struct Chains<'i> {
    intersection: &'i Intersection,
    /// Of the segments in `leaving` those of each node that were not followed yet.
    rest: Vec<[u32; 2]>,
    /// Segments by the node where they begin, ascending.
    leaving: Vec<u32>,
    /// How many more segments begin at a node than end there.
    surplus: Vec<i32>,
}

impl<'i> Chains<'i> {
    pub(crate) fn of(intersection: &'i Intersection) -> Self {
        let count = intersection.nodes.len();
        let (mut rest, mut surplus) = (vec![[0u32; 2]; count], vec![0i32; count]);
        for s in &intersection.segments {
            rest[s.nodes[0]][1] += 1;
            surplus[s.nodes[0]] += 1;
            surplus[s.nodes[1]] -= 1;
        }
        let mut start = 0;
        for range in &mut rest {
            start += range[1];
            *range = [start - range[1]; 2];
        }
        let mut leaving = vec![0; intersection.segments.len()];
        for (i, s) in intersection.segments.iter().enumerate() {
            let range = &mut rest[s.nodes[0]];
            leaving[range[1] as usize] = i as u32;
            range[1] += 1;
        }
        Self { intersection, rest, leaving, surplus }
    }

    /// Polylines of a set of segments that hang together with no others, each traversed once;
    /// closed ones first appear as found. Of a set once followed, nothing is left.
    pub(crate) fn follow(&mut self, segments: &[usize]) -> Vec<(Vec<usize>, bool)> {
        let all = &self.intersection.segments;
        let starts = || segments.iter().map(|&s| all[s].nodes[0]);
        let mut chains = Vec::new();
        // Open chains begin where more segments leave than arrive; what remains are cycles.
        for (start, is_open) in starts().map(|n| (n, true)).chain(starts().map(|n| (n, false))) {
            if is_open && self.surplus[start] <= 0 {
                continue;
            }
            let mut nodes = vec![start];
            let mut at = start;
            while self.rest[at][0] < self.rest[at][1] {
                let segment = self.leaving[self.rest[at][0] as usize];
                self.rest[at][0] += 1;
                at = all[segment as usize].nodes[1];
                nodes.push(at);
                if at == start {
                    break;
                }
            }
            if nodes.len() > 1 {
                let closed = at == start;
                if closed {
                    nodes.pop();
                }
                chains.push((nodes, closed));
            }
        }
        chains
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::Counters;
    use crate::query::Placed;
    use crate::search::meeting_pairs;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Model};
    use cranny_shapes::{Cuboid, GolfBall, Torus};

    #[test]
    fn in_general_position_the_signs_of_the_crossing_tell_all_that_features_do() {
        let model = |mesh| Model::build(mesh, &BuildOptions::default()).unwrap().0;
        let ball = GolfBall { dimples: 0, triangles: 180, ..GolfBall::default() };
        let torus = Torus { major_segments: 18, minor_segments: 8, ..Torus::default() };
        let models =
            [ball.build(), torus.build(), Cuboid::default().build()].map(|m| model(m.unwrap()));
        let mut segments = 0;
        for k in 0..30u32 {
            let x = f64::from(k);
            let rotation = DQuat::from_xyzw(0.3, 0.1 * x, 1.0 - 0.07 * x, 0.4).normalize();
            let translation = DVec3::new(0.4 + 0.02 * x, 0.3, 0.01 * x);
            let a = Placed { model: &models[k as usize % 3], pose: Pose::IDENTITY };
            let b =
                Placed { model: &models[k as usize / 3 % 3], pose: Pose { rotation, translation } };
            let pair = Pair::of_accepted(a, b);
            let pairs = meeting_pairs(&pair, &mut Counters::default());
            let fast = in_general_position(&pair, &pairs).unwrap();
            let slow = feature_by_feature(&pair, &pairs);
            assert!(slow.generic && fast.generic);
            assert_eq!(format!("{:?}", fast.nodes), format!("{:?}", slow.nodes), "round {k}");
            assert_eq!(format!("{:?}", fast.segments), format!("{:?}", slow.segments));
            segments += slow.segments.len();
        }
        assert!(segments > 600, "{segments}");
    }

    #[test]
    fn chains_follow_open_lines_before_rings() {
        let node = Node {
            features: (Feature::Face(FaceId(0)), Feature::Face(FaceId(0))),
            point: DVec3::ZERO,
            passage: None,
        };
        // A ring 0 1 2, a line 5 4 3, each in some disorder.
        let segments = [[1, 2], [4, 3], [0, 1], [5, 4], [2, 0]]
            .map(|nodes| Segment { faces: [FaceId(0); 2], nodes });
        let curves =
            Intersection { nodes: vec![node; 6], segments: segments.to_vec(), generic: false };
        let mut chains = Chains::of(&curves);
        assert_eq!(chains.follow(&[1, 3]), [(vec![5, 4, 3], false)]);
        assert_eq!(chains.follow(&[0, 2, 4]), [(vec![1, 2, 0], true)]);
        assert!(chains.follow(&[0, 2, 4]).is_empty());
    }
}
