//! The pieces of the two surfaces that the intersection curves cut out: the parts of each that lie
//! inside the other solid, connected over the curves into regions.
//!
//! Only for generic intersections of closed surfaces. Starting at the curves, edges show which of
//! their ends are inside; from there vertices spread along edges that the other surface does not
//! cut. The cost follows the pieces, not the meshes.

use cranny_exact::DVec3;
use cranny_geometry::{DisjointSets, EdgeId, FaceId, HalfEdgeId, VertexId};

use crate::answer::Feature;
use crate::intersection::{EdgePassage, Intersection};
use crate::numbering::Numbering;
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
pub(crate) struct RegionPieces {
    pub(crate) segments: Vec<usize>,
    pub(crate) pieces: [Piece; 2],
}

/// What belongs to exactly one region has a number: nodes first, then the vertices inside, the
/// first body's before the second's.
type Member = usize;

/// Splits a generic intersection into regions.
pub(crate) fn cut(pair: &Pair, intersection: &Intersection) -> Vec<RegionPieces> {
    let mut joins: Vec<[Member; 2]> = intersection.segments.iter().map(|s| s.nodes).collect();
    let first =
        spread_inside(pair, Side::First, intersection, intersection.nodes.len(), &mut joins);
    let behind = first.first_vertex + first.vertices.len();
    let second = spread_inside(pair, Side::Second, intersection, behind, &mut joins);
    let mut sets = DisjointSets::new(second.first_vertex + second.vertices.len());
    for [a, b] in joins {
        sets.union(a, b);
    }
    // All hang on a curve, so on a node.
    let (cut_of, count) = sets.numbered();
    let cut_of = |member: Member| cut_of[member] as usize;
    let mut cuts = vec![RegionPieces::default(); count];
    let mut faces = [Numbering::default(), Numbering::default()];
    let mut add_face = |cuts: &mut [RegionPieces], cut: usize, side: Side, face: FaceId| {
        let key = (cut as u64) << 32 | u64::from(face.0);
        if faces[side.index()].number(key).1 {
            cuts[cut].pieces[side.index()].faces.push(face);
        }
    };
    for (index, s) in intersection.segments.iter().enumerate() {
        let cut = cut_of(s.nodes[0]);
        cuts[cut].segments.push(index);
        for side in Side::BOTH {
            add_face(&mut cuts, cut, side, s.faces[side.index()]);
        }
    }
    for (side, inside) in [(Side::First, first), (Side::Second, second)] {
        for (&v, member) in inside.vertices.iter().zip(inside.first_vertex..) {
            let cut = cut_of(member);
            cuts[cut].pieces[side.index()].vertices.push(v);
            for &face in pair.topology(side).faces_at(v) {
                add_face(&mut cuts, cut, side, face);
            }
        }
        for (edge, ends, member) in inside.edges {
            cuts[cut_of(member)].pieces[side.index()].edges.push((edge, ends));
        }
    }
    cuts
}

/// What of one surface lies inside the other solid.
struct Inside {
    vertices: Vec<VertexId>,
    /// The member that the first of the vertices is.
    first_vertex: Member,
    edges: Vec<(EdgeId, [DVec3; 2], Member)>,
}

/// The passages of a body's edges through the other surface: by edge, then along it; and the nodes
/// there.
fn passages(side: Side, intersection: &Intersection) -> Vec<(EdgeId, EdgePassage, usize)> {
    let mut passages: Vec<(EdgeId, EdgePassage, usize)> = Vec::new();
    for (node, n) in intersection.nodes.iter().enumerate() {
        let edge = match (side, n.features) {
            (Side::First, (Feature::Edge(e), Feature::Face(_)))
            | (Side::Second, (Feature::Face(_), Feature::Edge(e))) => e,
            _ => continue,
        };
        passages.extend(n.passage.map(|passage| (edge, passage, node)));
    }
    passages.sort_unstable_by(|(e, p, n), (g, q, m)| {
        e.cmp(g).then(p.parameter.total_cmp(&q.parameter)).then(n.cmp(m))
    });
    passages
}

fn spread_inside(
    pair: &Pair,
    side: Side,
    intersection: &Intersection,
    first_vertex: Member,
    joins: &mut Vec<[Member; 2]>,
) -> Inside {
    let topology = pair.topology(side);
    let passages = passages(side, intersection);
    let (mut cut_edges, mut reached) = (Numbering::default(), Numbering::default());
    let mut inside = Inside { vertices: Vec::new(), first_vertex, edges: Vec::new() };
    let mut reach = |v: VertexId, vertices: &mut Vec<VertexId>| {
        let (number, is_new) = reached.number(u64::from(v.0));
        if is_new {
            vertices.push(v);
        }
        first_vertex + number as usize
    };
    for list in passages.chunk_by(|x, y| x.0 == y.0) {
        let edge = list[0].0;
        cut_edges.number(u64::from(edge.0));
        let e = topology.edges()[edge.index()];
        let point = |node: usize| intersection.nodes[node].point;
        let ((_, first, at_first), (_, last, at_last)) = (list[0], list[list.len() - 1]);
        if !first.inward {
            joins.push([at_first, reach(e.from, &mut inside.vertices)]);
            let ends = [pair.position(side, e.from), point(at_first)];
            inside.edges.push((edge, ends, at_first));
        }
        if last.inward {
            joins.push([at_last, reach(e.to, &mut inside.vertices)]);
            inside.edges.push((edge, [point(at_last), pair.position(side, e.to)], at_last));
        }
        for w in list.windows(2).filter(|w| w[0].1.inward && !w[1].1.inward) {
            joins.push([w[0].2, w[1].2]);
            inside.edges.push((edge, [point(w[0].2), point(w[1].2)], w[0].2));
        }
    }
    let mut next = 0;
    while next < inside.vertices.len() {
        let v = inside.vertices[next];
        let member = first_vertex + next;
        next += 1;
        let p = pair.position(side, v);
        for &face in topology.faces_at(v) {
            let corners = pair.mesh(side).corners(face);
            // Closed: along every edge at the vertex some half-edge leaves it.
            for i in (0..3).filter(|&i| corners[i] == v) {
                let half_edge = HalfEdgeId::of(face, i);
                let edge = topology.edge_of(half_edge);
                if cut_edges.get(u64::from(edge.0)).is_some() {
                    continue;
                }
                let w = corners[(i + 1) % 3];
                joins.push([member, reach(w, &mut inside.vertices)]);
                let leaves = |h: &HalfEdgeId| pair.mesh(side).corners(h.face())[h.corner()] == v;
                // Each edge once: from its lesser vertex, along the first half-edge that leaves it.
                if v <= w
                    && topology.half_edges(edge).iter().copied().find(leaves) == Some(half_edge)
                {
                    inside.edges.push((edge, [p, pair.position(side, w)], member));
                }
            }
        }
    }
    inside
}
