//! The pieces of the two surfaces that the intersection curves cut out: the parts of each that lie
//! inside the other solid, connected over the curves into regions.
//!
//! Only for generic intersections of closed surfaces. Starting at the curves, edges tell which of
//! their ends are inside; from there vertices spread along edges that the other surface does not
//! cut. The cost follows the pieces, not the meshes.

use std::collections::{BTreeMap, HashMap, HashSet};

use cranny_exact::{DVec3, Sign, orient3d};
use cranny_geometry::{DisjointSets, EdgeId, FaceId, VertexId};

use crate::answer::Feature;
use crate::intersection::{Intersection, crossing_parameter};
use crate::pair::{Pair, Side};

/// The part of one surface that belongs to a region.
#[derive(Clone, Debug, Default)]
pub(crate) struct Piece {
    /// Vertices inside the other solid.
    pub(crate) vertices: Vec<VertexId>,
    /// Parts of edges that lie inside, ends in the pair's frame.
    pub(crate) edges: Vec<(EdgeId, [DVec3; 2])>,
    /// Faces that lie inside, wholly or in part.
    pub(crate) faces: Vec<FaceId>,
}

/// A region: segments of the intersection and the two pieces that they bound.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cut {
    pub(crate) segments: Vec<usize>,
    pub(crate) pieces: [Piece; 2],
}

/// Something that belongs to exactly one region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Member {
    Node(usize),
    Vertex(Side, VertexId),
}

/// Splits a generic intersection into regions.
pub(crate) fn cut(pair: &Pair, intersection: &Intersection) -> Vec<Cut> {
    let mut links = Links::default();
    for s in &intersection.segments {
        links.join(Member::Node(s.nodes[0]), Member::Node(s.nodes[1]));
    }
    let spread = Side::BOTH.map(|side| spread_inside(pair, side, intersection, &mut links));
    let mut region_of = links.regions();

    let mut cuts: BTreeMap<usize, Cut> = BTreeMap::new();
    for (index, s) in intersection.segments.iter().enumerate() {
        let cut = cuts.entry(region_of(Member::Node(s.nodes[0]))).or_default();
        cut.segments.push(index);
        for side in Side::BOTH {
            cut.pieces[side.index()].faces.push(s.faces[side.index()]);
        }
    }
    for (side, inside) in Side::BOTH.into_iter().zip(spread) {
        for v in inside.vertices {
            let piece = &mut cuts.entry(region_of(Member::Vertex(side, v))).or_default().pieces
                [side.index()];
            piece.vertices.push(v);
            piece.faces.extend(pair.topology(side).faces_at(v));
        }
        for (edge, ends, member) in inside.edges {
            let piece = &mut cuts.entry(region_of(member)).or_default().pieces[side.index()];
            piece.edges.push((edge, ends));
        }
    }
    for piece in cuts.values_mut().flat_map(|c| &mut c.pieces) {
        piece.faces.sort_unstable();
        piece.faces.dedup();
    }
    cuts.into_values().filter(|c| !c.segments.is_empty()).collect()
}

/// What of one surface lies inside the other solid.
struct Inside {
    vertices: Vec<VertexId>,
    edges: Vec<(EdgeId, [DVec3; 2], Member)>,
}

/// A point where an edge passes through the other surface.
struct Passage {
    parameter: f64,
    node: usize,
    /// Along the edge's own direction (lesser to greater vertex) it goes inward.
    inward: bool,
}

fn passages(
    pair: &Pair,
    side: Side,
    intersection: &Intersection,
) -> BTreeMap<EdgeId, Vec<Passage>> {
    let mut by_edge: BTreeMap<EdgeId, Vec<Passage>> = BTreeMap::new();
    for (node, n) in intersection.nodes.iter().enumerate() {
        let (edge, face) = match (side, n.features) {
            (Side::First, (Feature::Edge(e), Feature::Face(f)))
            | (Side::Second, (Feature::Face(f), Feature::Edge(e))) => (e, f),
            _ => continue,
        };
        let [start, _] = pair.segment(side, edge);
        let t = pair.triangle(side.other(), face);
        by_edge.entry(edge).or_default().push(Passage {
            parameter: crossing_parameter(pair, side, edge, face),
            node,
            inward: orient3d(t[0], t[1], t[2], start) == Sign::Positive,
        });
    }
    for list in by_edge.values_mut() {
        list.sort_by(|p, q| p.parameter.total_cmp(&q.parameter).then(p.node.cmp(&q.node)));
    }
    by_edge
}

fn spread_inside(
    pair: &Pair,
    side: Side,
    intersection: &Intersection,
    links: &mut Links,
) -> Inside {
    let by_edge = passages(pair, side, intersection);
    let mut inside = Inside { vertices: Vec::new(), edges: Vec::new() };
    let mut seen: HashSet<VertexId> = HashSet::new();
    let mut edges_seen: HashSet<EdgeId> = HashSet::new();
    let mut front: Vec<VertexId> = Vec::new();
    let mut reach = |v: VertexId, front: &mut Vec<VertexId>| {
        if seen.insert(v) {
            front.push(v);
        }
    };
    for (&edge, list) in &by_edge {
        let e = pair.topology(side).edges()[edge.index()];
        let [p, q] = pair.segment(side, edge);
        let point = |passage: &Passage| intersection.nodes[passage.node].point;
        let (first, last) = (&list[0], &list[list.len() - 1]);
        if !first.inward {
            links.join(Member::Node(first.node), Member::Vertex(side, e.from));
            reach(e.from, &mut front);
            inside.edges.push((edge, [p, point(first)], Member::Node(first.node)));
        }
        if last.inward {
            links.join(Member::Node(last.node), Member::Vertex(side, e.to));
            reach(e.to, &mut front);
            inside.edges.push((edge, [point(last), q], Member::Node(last.node)));
        }
        for w in list.windows(2).filter(|w| w[0].inward && !w[1].inward) {
            links.join(Member::Node(w[0].node), Member::Node(w[1].node));
            inside.edges.push((edge, [point(&w[0]), point(&w[1])], Member::Node(w[0].node)));
        }
    }
    let mut next = 0;
    while next < front.len() {
        let v = front[next];
        next += 1;
        for &face in pair.topology(side).faces_at(v) {
            for i in 0..3 {
                let (a, b) = (pair.corner(side, face, i), pair.corner(side, face, (i + 1) % 3));
                if a != v && b != v {
                    continue;
                }
                let edge = pair.edge(side, face, i);
                if by_edge.contains_key(&edge) {
                    continue;
                }
                let w = if a == v { b } else { a };
                links.join(Member::Vertex(side, v), Member::Vertex(side, w));
                reach(w, &mut front);
                if edges_seen.insert(edge) {
                    inside.edges.push((edge, pair.segment(side, edge), Member::Vertex(side, v)));
                }
            }
        }
    }
    inside.vertices = front;
    inside
}

/// Which members belong together.
#[derive(Default)]
struct Links {
    ids: HashMap<Member, usize>,
    joins: Vec<(usize, usize)>,
}

impl Links {
    fn id(&mut self, member: Member) -> usize {
        let next = self.ids.len();
        *self.ids.entry(member).or_insert(next)
    }

    fn join(&mut self, a: Member, b: Member) {
        let pair = (self.id(a), self.id(b));
        self.joins.push(pair);
    }

    /// Ends the joining: a function from members to regions, numbered by their first member.
    fn regions(self) -> impl FnMut(Member) -> usize {
        let mut sets = DisjointSets::new(self.ids.len());
        for (a, b) in self.joins {
            sets.union(a, b);
        }
        move |member| sets.find(self.ids[&member])
    }
}
