//! Intersection segments of crossing faces, joined by the features that make their ends.
//!
//! An end of a segment is where an edge of one body pierces a face of the other (or, in special
//! positions, where lower features meet). It is known by its pair of features, which exact signs
//! tell; its coordinates are constructed once. Two segments meet if and only if they share an end:
//! no distance is compared.
//!
//! Every segment runs along n × m, n and m being the normals of the first and the second body's
//! face. Seen against n, the part of the first face that lies inside the second body is then on the
//! left. The direction too is told by signs: where the first body's edge, run through as its face
//! has it, goes inward through the other surface, the segment ends; where it goes outward, it begins.

use std::collections::HashMap;

use cranny_exact::{
    DVec3, Meeting, Piercing, SegmentFeature, Sign, TriangleFeature, locate_piercing, orient3d,
};
use cranny_geometry::{EdgeId, FaceId};

use crate::answer::Feature;
use crate::pair::{Pair, Side};
use crate::surface::FacePair;
use crate::triangle_distance::closest_on_segments;

/// A point of the intersection curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// On the first body, on the second.
    pub(crate) features: (Feature, Feature),
    /// In the pair's frame.
    pub(crate) point: DVec3,
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
    let mut builder = Builder { pair, by_features: HashMap::new(), out: Intersection::default() };
    builder.out.generic = true;
    for p in pairs {
        builder.add(p);
    }
    let mut balance = vec![0i32; builder.out.nodes.len()];
    for s in &builder.out.segments {
        balance[s.nodes[0]] += 1;
        balance[s.nodes[1]] -= 1;
    }
    if pair.model(Side::First).is_closed() && pair.model(Side::Second).is_closed() {
        builder.out.generic &= balance.iter().all(|&b| b == 0);
    }
    builder.out
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
        let (own, other) = match side {
            Side::First => (p.first, p.second),
            Side::Second => (p.second, p.first),
        };
        let corners = self.pair.triangle(side, own);
        let ends = [corners[i], corners[(i + 1) % 3]];
        let triangle = self.pair.triangle(side.other(), other);
        let Piercing::Point { on_segment, on_triangle } = locate_piercing(&ends, &triangle) else {
            return None;
        };
        let own_feature = match on_segment {
            SegmentFeature::Start => Feature::Vertex(self.pair.corner(side, own, i)),
            SegmentFeature::Interior => Feature::Edge(self.pair.edge(side, own, i)),
            SegmentFeature::End => Feature::Vertex(self.pair.corner(side, own, (i + 1) % 3)),
        };
        let other_side = side.other();
        let other_feature = match on_triangle {
            TriangleFeature::Vertex(k) => {
                Feature::Vertex(self.pair.corner(other_side, other, k as usize))
            }
            TriangleFeature::Edge(k) => {
                Feature::Edge(self.pair.edge(other_side, other, k as usize))
            }
            TriangleFeature::Interior => Feature::Face(other),
        };
        let simple = matches!((own_feature, other_feature), (Feature::Edge(_), Feature::Face(_)));
        // The side starts in front of the other face, so it goes inward.
        let inward = orient3d(triangle[0], triangle[1], triangle[2], ends[0]) == Sign::Positive;
        let begins = simple.then_some(match side {
            Side::First => !inward,
            Side::Second => inward,
        });
        let features = match side {
            Side::First => (own_feature, other_feature),
            Side::Second => (other_feature, own_feature),
        };
        Some(End { node: self.node(features), begins })
    }

    fn node(&mut self, features: (Feature, Feature)) -> usize {
        let (pair, nodes) = (self.pair, &mut self.out.nodes);
        *self.by_features.entry(features).or_insert_with(|| {
            nodes.push(Node { features, point: construct(pair, features) });
            nodes.len() - 1
        })
    }

    fn runs_against_the_normals(&self, p: &FacePair, a: usize, b: usize) -> bool {
        let along = self
            .pair
            .area_vector(Side::First, p.first)
            .cross(self.pair.area_vector(Side::Second, p.second));
        along.dot(self.out.nodes[b].point - self.out.nodes[a].point) < 0.0
    }
}

/// Where two features meet; which they do.
fn construct(pair: &Pair, features: (Feature, Feature)) -> DVec3 {
    match features {
        (Feature::Vertex(v), _) => pair.position(Side::First, v),
        (_, Feature::Vertex(v)) => pair.position(Side::Second, v),
        (Feature::Edge(e), Feature::Face(f)) => on_edge(pair, Side::First, e, f),
        (Feature::Face(f), Feature::Edge(e)) => on_edge(pair, Side::Second, e, f),
        (Feature::Edge(e), Feature::Edge(g)) => {
            let (p, q) = (pair.segment(Side::First, e), pair.segment(Side::Second, g));
            p[0] + (p[1] - p[0]) * closest_on_segments(&p, &q).0
        }
        (Feature::Face(f), Feature::Face(_)) => pair.triangle(Side::First, f)[0],
    }
}

/// The point in which an edge pierces a face's plane, between the edge's ends.
fn on_edge(pair: &Pair, side: Side, edge: EdgeId, face: FaceId) -> DVec3 {
    let [p, q] = pair.segment(side, edge);
    p + (q - p) * crossing_parameter(pair, side, edge, face)
}

/// How far along an edge, from 0 to 1, it pierces the plane of a face of the other body.
pub(crate) fn crossing_parameter(pair: &Pair, side: Side, edge: EdgeId, face: FaceId) -> f64 {
    let [p, q] = pair.segment(side, edge);
    let triangle = pair.triangle(side.other(), face);
    let normal = pair.area_vector(side.other(), face);
    let (dp, dq) = (normal.dot(p - triangle[0]), normal.dot(q - triangle[0]));
    if dp == dq { 0.5 } else { (dp / (dp - dq)).clamp(0.0, 1.0) }
}

impl Intersection {
    /// Polylines of a set of segments, each traversed once; closed ones first appear as found.
    pub(crate) fn chains(&self, segments: &[usize]) -> Vec<(Vec<usize>, bool)> {
        let mut leaving: HashMap<usize, Vec<usize>> = HashMap::new();
        let mut arriving: HashMap<usize, usize> = HashMap::new();
        for &s in segments.iter().rev() {
            leaving.entry(self.segments[s].nodes[0]).or_default().push(s);
            *arriving.entry(self.segments[s].nodes[1]).or_default() += 1;
        }
        // Open chains begin where more segments leave than arrive; what remains are cycles.
        let surplus = |leaving: &HashMap<usize, Vec<usize>>, node: usize| {
            leaving.get(&node).map_or(0, Vec::len) > arriving.get(&node).copied().unwrap_or(0)
        };
        let mut starts: Vec<usize> = segments
            .iter()
            .map(|&s| self.segments[s].nodes[0])
            .filter(|&n| surplus(&leaving, n))
            .collect();
        starts.extend(segments.iter().map(|&s| self.segments[s].nodes[0]));
        let mut chains = Vec::new();
        for start in starts {
            let mut nodes = vec![start];
            let mut at = start;
            while let Some(s) = leaving.get_mut(&at).and_then(Vec::pop) {
                at = self.segments[s].nodes[1];
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
