//! The pieces of the two surfaces that the intersection curves cut out: the parts of each that lie
//! inside the other solid, connected over the curves into regions.
//!
//! Only for generic intersections of closed surfaces. Starting at the curves, edges show which of
//! their ends are inside; from there vertices spread along edges that the other surface does not
//! cut, unless the caller has located them. The cost follows the pieces, not the meshes.

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

/// The vertices of a body that lie inside the other solid, each with the number of the set of them
/// that hangs together along edges that are not cut; sets ascend from 0.
pub(crate) type Inside = Vec<(VertexId, u32)>;

/// Splits a generic intersection into regions.
pub(crate) fn cut(pair: &Pair, intersection: &Intersection) -> Vec<RegionPieces> {
    let cuts = Cuts::of(pair, intersection);
    let mut regions = cuts.regions(&Side::BOTH.map(|side| cuts.spread_inside(side)));
    cuts.complete(&mut regions);
    regions
}

/// An end of the part of an edge that lies inside.
#[derive(Clone, Copy)]
enum PartEnd {
    Node(usize),
    Vertex(VertexId),
}

/// The edges of a body that the curves cut.
struct CutEdges {
    /// Their parts inside: by edge, then along it. Each edge has one at least, and a node is an end
    /// of each part.
    parts: Vec<(EdgeId, [PartEnd; 2])>,
    named: Numbering,
}

impl CutEdges {
    fn holds(&self, edge: EdgeId) -> bool {
        self.named.get(u64::from(edge.0)).is_some()
    }
}

/// A generic intersection and the edges that its curves cut.
pub(crate) struct Cuts<'a, 'm> {
    pair: &'a Pair<'m>,
    intersection: &'a Intersection,
    edges: [CutEdges; 2],
}

impl<'a, 'm> Cuts<'a, 'm> {
    pub(crate) fn of(pair: &'a Pair<'m>, intersection: &'a Intersection) -> Self {
        let edges = Side::BOTH.map(|side| {
            let parts = parts_inside(pair, side, intersection);
            let mut named = Numbering::for_keys(parts.len());
            parts.iter().for_each(|(edge, _)| _ = named.number(u64::from(edge.0)));
            CutEdges { parts, named }
        });
        Self { pair, intersection, edges }
    }

    /// The regions by segments and vertices alone, without edges and faces. `inside` holds all
    /// vertices inside that hang together with a cut edge; an end of a part that it lacks (of a
    /// component turned inside out) joins nothing.
    pub(crate) fn regions(&self, inside: &[Inside; 2]) -> Vec<RegionPieces> {
        let segments = &self.intersection.segments;
        // What is of one region has a number: nodes first, then sets, the first body's before the
        // second's.
        let sets = inside.each_ref().map(|of| of.last().map_or(0, |&(_, set)| set as usize + 1));
        let nodes = self.intersection.nodes.len();
        let first_set = [nodes, nodes + sets[0]];
        let mut joined = DisjointSets::new(first_set[1] + sets[1]);
        for s in segments {
            joined.union(s.nodes[0], s.nodes[1]);
        }
        for (side, inside) in inside.iter().enumerate() {
            let mut named = Numbering::for_keys(inside.len());
            inside.iter().for_each(|&(v, _)| _ = named.number(u64::from(v.0)));
            let member = |end: PartEnd| match end {
                PartEnd::Node(node) => Some(node),
                PartEnd::Vertex(v) => {
                    let number = named.get(u64::from(v.0))?;
                    Some(first_set[side] + inside[number as usize].1 as usize)
                }
            };
            for &(_, [from, to]) in &self.edges[side].parts {
                if let (Some(from), Some(to)) = (member(from), member(to)) {
                    joined.union(from, to);
                }
            }
        }
        let (region_of, count) = joined.numbered();
        let mut regions = vec![RegionPieces::default(); count];
        for (index, s) in segments.iter().enumerate() {
            regions[region_of[s.nodes[0]] as usize].segments.push(index);
        }
        for (side, inside) in inside.iter().enumerate() {
            for &(v, set) in inside {
                let region = region_of[first_set[side] + set as usize];
                regions[region as usize].pieces[side].vertices.push(v);
            }
        }
        regions.retain(|region| !region.segments.is_empty());
        regions
    }

    /// The vertices inside: ends of parts, and what is reached from these.
    fn spread_inside(&self, side: Side) -> Inside {
        let (topology, mesh) = (self.pair.topology(side), self.pair.mesh(side));
        let cut = &self.edges[side.index()];
        let mut reached = Numbering::for_keys(cut.parts.len());
        let mut inside = Inside::new();
        let (mut next, mut set) = (0, 0);
        for &end in cut.parts.iter().flat_map(|(_, ends)| ends) {
            let PartEnd::Vertex(start) = end else { continue };
            if !reached.number(u64::from(start.0)).1 {
                continue;
            }
            inside.push((start, set));
            while let Some(&(v, _)) = inside.get(next) {
                next += 1;
                for &face in topology.faces_at(v) {
                    // Closed: along every edge at the vertex some half-edge leaves it.
                    for (i, w) in leaving(mesh.corners(face), v) {
                        if reached.get(u64::from(w.0)).is_none()
                            && !cut.holds(topology.edge_of(HalfEdgeId::of(face, i)))
                        {
                            reached.number(u64::from(w.0));
                            inside.push((w, set));
                        }
                    }
                }
            }
            set += 1;
        }
        inside
    }

    /// Adds the edges and faces of the regions' pieces.
    pub(crate) fn complete(&self, regions: &mut [RegionPieces]) {
        let Self { pair, intersection, edges } = self;
        let mut region_of = vec![0; intersection.nodes.len()];
        for (index, region) in regions.iter().enumerate() {
            for &s in &region.segments {
                region_of[intersection.segments[s].nodes[0]] = index;
            }
        }
        for side in Side::BOTH {
            let cut = &edges[side.index()];
            for &(edge, ends) in &cut.parts {
                let mut region = 0;
                let ends = ends.map(|end| match end {
                    PartEnd::Node(node) => {
                        region = region_of[node];
                        intersection.nodes[node].point
                    }
                    PartEnd::Vertex(v) => pair.position(side, v),
                });
                regions[region].pieces[side.index()].edges.push((edge, ends));
            }
            for region in &mut *regions {
                let segments = region.segments.iter();
                let faces = segments.map(|&s| intersection.segments[s].faces[side.index()]);
                add_uncut(pair, side, (faces, cut), &mut region.pieces[side.index()]);
            }
        }
    }
}

/// Adds to a piece its faces, those that segments pierce first, and its edges that are not cut.
fn add_uncut(
    pair: &Pair,
    side: Side,
    (pierced, cut): (impl Iterator<Item = FaceId>, &CutEdges),
    piece: &mut Piece,
) {
    let (topology, mesh) = (pair.topology(side), pair.mesh(side));
    let Piece { vertices, edges, faces } = piece;
    let mut named = Numbering::for_keys(vertices.len());
    faces.extend(pierced.filter(|face| named.number(u64::from(face.0)).1));
    for &v in &*vertices {
        for &face in topology.faces_at(v) {
            if named.number(u64::from(face.0)).1 {
                faces.push(face);
            }
            for (i, w) in leaving(mesh.corners(face), v) {
                let half_edge = HalfEdgeId::of(face, i);
                let edge = topology.edge_of(half_edge);
                let leaves = |h: &HalfEdgeId| mesh.corners(h.face())[h.corner()] == v;
                // Each edge once: from its lesser vertex, along the first half-edge that leaves it.
                if v <= w
                    && !cut.holds(edge)
                    && topology.half_edges(edge).iter().copied().find(leaves) == Some(half_edge)
                {
                    edges.push((edge, [v, w].map(|v| pair.position(side, v))));
                }
            }
        }
    }
}

/// The sides of a face that leave a vertex, by number, and where they lead. (A face that has
/// collapsed may have two.)
#[inline]
pub(crate) fn leaving(
    corners: [VertexId; 3],
    vertex: VertexId,
) -> impl Iterator<Item = (usize, VertexId)> {
    (0..3).filter(move |&i| corners[i] == vertex).map(move |i| (i, corners[(i + 1) % 3]))
}

/// The parts inside of a body's edges that pass through the other surface.
fn parts_inside(
    pair: &Pair,
    side: Side,
    intersection: &Intersection,
) -> Vec<(EdgeId, [PartEnd; 2])> {
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
    let mut parts = Vec::with_capacity(passages.len());
    for list in passages.chunk_by(|x, y| x.0 == y.0) {
        let edge = list[0].0;
        let e = pair.topology(side).edges()[edge.index()];
        let ((_, first, at_first), (_, last, at_last)) = (list[0], list[list.len() - 1]);
        if !first.inward {
            parts.push((edge, [PartEnd::Vertex(e.from), PartEnd::Node(at_first)]));
        }
        if last.inward {
            parts.push((edge, [PartEnd::Node(at_last), PartEnd::Vertex(e.to)]));
        }
        for w in list.windows(2).filter(|w| w[0].1.inward && !w[1].1.inward) {
            parts.push((edge, [PartEnd::Node(w[0].2), PartEnd::Node(w[1].2)]));
        }
    }
    parts
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::answer::Counters;
    use crate::intersection::intersect;
    use crate::query::Placed;
    use crate::search::meeting_pairs;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};
    use cranny_shapes::{Comb, Cuboid, Cup, GolfBall, Shape};
    use cranny_testkit::Rng;
    use std::collections::BTreeSet;

    fn model(mesh: Mesh) -> Model {
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    }

    pub(crate) fn bodies() -> [Model; 4] {
        let shapes: [Shape; 4] = [
            Cuboid::default().into(),
            Cup { segments: 9, ..Cup::default() }.into(),
            Comb { teeth: 4, ..Comb::default() }.into(),
            GolfBall { dimples: 20, triangles: 800, ..GolfBall::default() }.into(),
        ];
        shapes.map(|shape| model(shape.build().unwrap()))
    }

    /// At the origin and turned anyhow, near it.
    pub(crate) fn placed<'m>(models: [&'m Model; 2], rng: &mut Rng) -> Pair<'m> {
        let rotation = DQuat::from_xyzw(rng.unit(), rng.unit(), rng.unit(), 1.5).normalize();
        let translation = 0.9 * DVec3::new(rng.unit(), rng.unit(), rng.unit());
        Pair::of_accepted(
            Placed { model: models[0], pose: Pose::IDENTITY },
            Placed { model: models[1], pose: Pose { rotation, translation } },
        )
    }

    /// The edges and faces of all regions of a body, with how many times edges are listed that are
    /// not cut.
    fn listed(pair: &Pair, side: Side, regions: &[RegionPieces]) -> [BTreeSet<u32>; 2] {
        let cut = |edge: EdgeId| {
            let [p, q] = pair.segment(side, edge);
            move |ends: [DVec3; 2]| ends != [p, q] && ends != [q, p]
        };
        let (mut edges, mut faces) = (BTreeSet::new(), BTreeSet::new());
        for piece in regions.iter().map(|region| &region.pieces[side.index()]) {
            for &(edge, ends) in &piece.edges {
                let is_new = edges.insert(edge.0);
                assert!(is_new || cut(edge)(ends), "{edge:?} is listed twice");
            }
            faces.extend(piece.faces.iter().map(|face| face.0));
        }
        [edges, faces]
    }

    /// Edges and faces with an end or a corner inside, and those that pierce or are pierced.
    fn expected(
        pair: &Pair,
        side: Side,
        (intersection, regions): (&Intersection, &[RegionPieces]),
    ) -> [BTreeSet<u32>; 2] {
        let pieces = regions.iter().map(|region| &region.pieces[side.index()]);
        let inside: BTreeSet<VertexId> = pieces.flat_map(|p| p.vertices.iter().copied()).collect();
        let has = |v: VertexId| inside.contains(&v);
        let topology = pair.topology(side);
        let edges = topology.edges().iter().enumerate();
        let mut edges: BTreeSet<u32> =
            edges.filter(|(_, e)| has(e.from) || has(e.to)).map(|(i, _)| i as u32).collect();
        let faces = pair.mesh(side).faces().iter().enumerate();
        let mut faces: BTreeSet<u32> = faces
            .filter(|(_, corners)| corners.iter().any(|&v| has(VertexId(v))))
            .map(|(i, _)| i as u32)
            .collect();
        faces.extend(intersection.segments.iter().map(|s| s.faces[side.index()].0));
        for node in &intersection.nodes {
            match (side, node.features) {
                (Side::First, (Feature::Edge(e), _)) | (Side::Second, (_, Feature::Edge(e))) => {
                    edges.insert(e.0);
                }
                _ => {}
            }
        }
        [edges, faces]
    }

    #[test]
    fn pieces_have_all_edges_and_faces_of_what_is_inside_once() {
        let bodies = bodies();
        let mut rng = Rng::new(23);
        let (mut edges, mut regions) = (0, 0);
        for round in 0..200 {
            let pair = placed([&bodies[rng.below(4)], &bodies[rng.below(4)]], &mut rng);
            let intersection = intersect(&pair, &meeting_pairs(&pair, &mut Counters::default()));
            assert!(intersection.generic, "round {round}");
            let found = cut(&pair, &intersection);
            for side in Side::BOTH {
                let all = expected(&pair, side, (&intersection, &found));
                assert_eq!(listed(&pair, side, &found), all, "round {round}");
                edges += all[0].len();
            }
            regions += found.len();
        }
        assert!(edges > 5_000 && regions > 100, "{edges} {regions}");
    }

    /// A face that has collapsed to an edge, before all others, takes no edge from a piece.
    #[test]
    fn collapsed_faces_hide_no_edge() {
        let mesh = Shape::from(Comb { teeth: 4, ..Comb::default() }).build().unwrap();
        let whole = model(mesh.clone());
        let ball = GolfBall { dimples: 20, triangles: 800, ..GolfBall::default() };
        let other = model(ball.build().unwrap());
        let mut compared = 0;
        for (round, &[v, w, _]) in mesh.faces().iter().enumerate() {
            for collapsed in [[v, v, w], [v, w, v], [w, v, v]] {
                let faces = [collapsed].into_iter().chain(mesh.faces().iter().copied()).collect();
                let with = model(Mesh::new(mesh.vertices().to_vec(), faces).unwrap());
                assert!(with.is_closed());
                let ends = |body: &Model| {
                    let pair = placed([body, &other], &mut Rng::new(round as u64));
                    let pairs = meeting_pairs(&pair, &mut Counters::default());
                    let intersection = intersect(&pair, &pairs);
                    if !intersection.generic {
                        // The collapsed face meets the other body: its position is special.
                        return None;
                    }
                    let side = if pair.is_swapped() { Side::Second } else { Side::First };
                    let regions = cut(&pair, &intersection);
                    let pieces = regions.iter().map(|region| &region.pieces[side.index()]);
                    // Building gives vertices other numbers.
                    let place = |v: VertexId| body.mesh().position(v).to_array().map(f64::to_bits);
                    let edges: BTreeSet<_> = pieces
                        .flat_map(|piece| &piece.edges)
                        .map(|(edge, _)| pair.topology(side).edges()[edge.index()])
                        .filter(|edge| edge.from != edge.to)
                        .map(|edge| BTreeSet::from([place(edge.from), place(edge.to)]))
                        .collect();
                    Some(edges)
                };
                let Some(edges) = ends(&with) else { continue };
                compared += edges.len();
                assert_eq!(Some(edges), ends(&whole), "{collapsed:?}");
            }
        }
        assert!(compared > 500, "{compared}");
    }
}
