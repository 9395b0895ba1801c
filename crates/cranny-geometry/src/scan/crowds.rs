//! Vertices at which very many faces meet: the tip of a cone, the middle of a disc.
//!
//! The boxes of these faces all hold the vertex, so they say nothing: of k faces k²/2 pairs would
//! be judged, and as many again with those of a second crowd beyond the same ring, a cone's base.
//! So they are paired by the [directions](super::arcs) in which they lie, from the vertex, or from
//! the line through both; where the star is [spread out](Stars::is_spread) nothing needs judging at
//! all. Pairs of nodes of the face tree whose faces all belong to one crowd, or two such crowds,
//! need not be opened.
//!
//! No source: this crate's own, by the argument in `arcs`. Cost: O(n) to find crowds, O(k log k) as
//! a rule to pair the k faces of one, and the pairs that lie in directions near each other.

use std::ops::ControlFlow;

use cranny_exact::Aabb;

use super::arcs::{Line, about_point};
use super::pairs::overlapping_pairs;
use super::stars::Stars;
use crate::ids::{FaceId, HalfEdgeId, OptionalIndex, VertexId};
use crate::mesh::Mesh;
use crate::topology::Topology;
use crate::tree::{Content, FaceTree, Grower};

/// Faces that make a crowd. Fewer, and the pairs are judged as soon as paired by directions; more,
/// and the pairs of so many faces are judged at every vertex of that degree.
const CROWD: usize = 32;

/// The crowded vertices of a mesh.
pub(super) struct Crowds<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    /// Those whose stars are not spread out, ascending.
    judged: Vec<VertexId>,
    /// Two crowded vertices, the lesser first, whose faces share very many sides; ascending.
    couples: Vec<[u32; 2]>,
    /// Of each face the crowded vertex to which it belongs, or none: of its corners the one
    /// with most faces, the least of equals. Empty where nothing is crowded, and so is the next.
    of_face: Vec<OptionalIndex>,
    /// Of each node of the face tree the crowded vertex to which all faces beneath belong, or
    /// none.
    of_node: Vec<OptionalIndex>,
}

impl<'a> Crowds<'a> {
    /// O(n), and O(k log k) for k sides between crowds.
    pub(super) fn of(
        mesh: &'a Mesh,
        topology: &'a Topology,
        tree: &FaceTree,
        stars: &mut Stars,
    ) -> Self {
        let vertices = mesh.vertex_ids();
        let crowded: Vec<VertexId> =
            vertices.filter(|&v| topology.faces_at(v).len() >= CROWD).collect();
        let (mut of_face, mut couples) = (Vec::new(), Vec::new());
        if !crowded.is_empty() {
            of_face = crowds_of_faces(mesh, topology, &crowded);
            couples = couples_of(mesh, topology, &crowded, &of_face);
        }
        let of_node = crowds_of_nodes(tree, &of_face);
        let judged = crowded.into_iter().filter(|&v| !stars.is_spread(v)).collect();
        Self { mesh, topology, judged, couples, of_face, of_node }
    }

    /// Whether all pairs of the faces at a vertex are among [`pairs`](Self::pairs).
    pub(super) fn holds(&self, vertex: VertexId) -> bool {
        !self.judged.is_empty() && self.judged.binary_search(&vertex).is_ok()
    }

    /// Whether no pair of a face beneath one node and a face beneath another needs to be looked at,
    /// but for those among [`pairs`](Self::pairs).
    pub(super) fn settle(&self, i: u32, j: u32) -> bool {
        !self.of_node.is_empty() && {
            let [i, j] = [i, j].map(|node| self.of_node[node as usize].get());
            i.zip(j).is_some_and(|(i, j)| {
                i == j || self.couples.binary_search(&[i.min(j), i.max(j)]).is_ok()
            })
        }
    }

    /// Calls `visit` with all pairs of faces of one crowd that is not spread out, or of a couple,
    /// which may meet elsewhere than by right; some are named twice. O(k log k) for k faces, but
    /// for pairs that lie in directions near each other.
    pub(super) fn pairs(
        &self,
        mut visit: impl FnMut(FaceId, FaceId) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        for &vertex in &self.judged {
            let faces = self.topology.faces_at(vertex).iter();
            let arc = |&face: &FaceId| Some((face, about_point(self.mesh, vertex, face)?));
            overlapping_arcs(faces.filter_map(arc), &mut visit)?;
        }
        for couple in &self.couples {
            let couple = couple.map(VertexId);
            let line = Line::through(self.mesh.position(couple[0]), self.mesh.position(couple[1]));
            let belongs =
                |face: &FaceId, v: VertexId| self.of_face[face.index()].get() == Some(v.0);
            let arcs = couple.into_iter().flat_map(|v| {
                let faces = self.topology.faces_at(v).iter().copied();
                let line = &line;
                faces
                    .filter(move |face| belongs(face, v))
                    .filter_map(move |face| Some((face, line.about(self.mesh, v, face)?)))
            });
            overlapping_arcs(arcs, |f, g| {
                match belongs(&f, couple[0]) == belongs(&g, couple[0]) {
                    true => ControlFlow::Continue(()),
                    false => visit(f, g),
                }
            })?;
        }
        ControlFlow::Continue(())
    }
}

/// Calls `visit` with pairs of faces whose boxes around arcs overlap.
fn overlapping_arcs(
    arcs: impl Iterator<Item = (FaceId, Aabb)>,
    visit: impl FnMut(FaceId, FaceId) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut tree = FaceTree::default();
    Grower::new(1).grow(arcs, &mut tree);
    overlapping_pairs(&tree, |_, _| true, visit)
}

fn crowds_of_faces(mesh: &Mesh, topology: &Topology, crowded: &[VertexId]) -> Vec<OptionalIndex> {
    let mut of_face = vec![OptionalIndex::NONE; mesh.faces().len()];
    for &vertex in crowded {
        let faces = topology.faces_at(vertex);
        for face in faces {
            let other = &mut of_face[face.index()];
            if other.get().is_none_or(|v| topology.faces_at(VertexId(v)).len() < faces.len()) {
                *other = OptionalIndex::some(vertex.0);
            }
        }
    }
    of_face
}

/// The crowds that share as many sides as make a crowd.
fn couples_of(
    mesh: &Mesh,
    topology: &Topology,
    crowded: &[VertexId],
    of_face: &[OptionalIndex],
) -> Vec<[u32; 2]> {
    let mut sides = Vec::new();
    for &VertexId(v) in crowded {
        let faces =
            topology.faces_at(VertexId(v)).iter().filter(|f| of_face[f.index()].get() == Some(v));
        for h in faces.flat_map(|&f| [0, 1, 2].map(|corner| HalfEdgeId::of(f, corner))) {
            let beyond = topology.twin(h).and_then(|twin| of_face[twin.face().index()].get());
            sides.extend(beyond.filter(|&beyond| v < beyond).map(|beyond| [v, beyond]));
        }
    }
    sides.sort_unstable();
    let couples = sides.chunk_by(|a, b| a == b).filter(|group| group.len() >= CROWD);
    let apart = |couple: &[u32; 2]| {
        let [v, w] = couple.map(|v| mesh.position(VertexId(v)));
        v != w
    };
    couples.map(|group| group[0]).filter(apart).collect()
}

fn crowds_of_nodes(tree: &FaceTree, of_face: &[OptionalIndex]) -> Vec<OptionalIndex> {
    if of_face.is_empty() {
        return Vec::new();
    }
    let common = |a, b| if a == b { a } else { OptionalIndex::NONE };
    let count = tree.nodes().len();
    let mut of_node = vec![OptionalIndex::NONE; count];
    // Children stand behind their parents.
    for node in (0..count as u32).rev() {
        of_node[node as usize] = match tree.content(node) {
            Content::Inner { left, right } => {
                common(of_node[left as usize], of_node[right as usize])
            }
            Content::Leaf { .. } => {
                let faces = tree.leaf_faces(node).iter();
                faces.map(|f| of_face[f.index()]).reduce(common).unwrap_or(OptionalIndex::NONE)
            }
        };
    }
    of_node
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::super::judge::judge;
    use super::*;

    /// A tip, and half a ring of others around it at distances that swing between 1 and `far`; the
    /// first of them is set apart.
    fn fan(count: u32, far: f64, first: DVec3) -> Mesh {
        let ring = (0..count).map(|i| {
            // Points of a circle with rational coordinates (Euclid).
            let t = 2.0 * f64::from(i) / f64::from(count) - 1.0;
            let (c, s) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
            let r = if i % 2 == 0 { 1.0 } else { far };
            r * DVec3::new(c, s, 0.0) - DVec3::Z
        });
        let mut vertices: Vec<DVec3> = [DVec3::ZERO].into_iter().chain(ring).collect();
        vertices[1] = first;
        let faces = (0..count - 1).map(|i| [0, 1 + i, 2 + i]).collect();
        Mesh::new(vertices, faces).unwrap()
    }

    /// How many pairs are named, and those that meet.
    fn paired(mesh: &Mesh) -> (usize, Vec<[FaceId; 2]>) {
        let topology = Topology::of(mesh);
        let tree = FaceTree::of(mesh, 1);
        let crowds = Crowds::of(mesh, &topology, &tree, &mut Stars::of(mesh, &topology));
        let (mut count, mut met) = (0, Vec::new());
        let ended = crowds.pairs(|f, g| {
            count += 1;
            let pair = [f.min(g), f.max(g)];
            met.extend(judge(mesh, pair, |_| false).map(|_| pair));
            ControlFlow::Continue(())
        });
        assert_eq!(ended, ControlFlow::Continue(()));
        met.sort_unstable();
        (count, met)
    }

    #[test]
    fn faces_around_a_tip_are_paired_with_few_others() {
        // Of half a million. Boxes around spikes that stand aslant hold some of their neighbours.
        for (far, few) in [(1.0, 10_000), (1.5, 100_000)] {
            let mesh = fan(1000, far, DVec3::new(0.0, -1.0, -1.0));
            let (count, met) = paired(&mesh);
            assert!(count < few, "{count}");
            assert!(met.is_empty(), "{met:?}");
        }
    }

    #[test]
    fn what_crosses_around_a_tip_is_found() {
        // The first face reaches over to the other side, through all that lie between.
        let mesh = fan(200, 3.0, DVec3::new(2.7, 1.5, -1.0));
        let (_, met) = paired(&mesh);
        let all = (0..199).flat_map(|f| (f + 1..199).map(move |g| [FaceId(f), FaceId(g)]));
        let expected: Vec<_> =
            all.filter(|&pair| judge(&mesh, pair, |_| false).is_some()).collect();
        assert!(expected.len() > 50);
        assert_eq!(met, expected);
    }

    /// A closed ring of radius 1 about the origin, and two fans over it.
    fn cone(count: u32, tips: [DVec3; 2]) -> Mesh {
        let half = (0..count / 2).map(|i| {
            let t = 4.0 * f64::from(i) / f64::from(count) - 1.0;
            DVec3::new(1.0 - t * t, 2.0 * t, 0.0) / (1.0 + t * t)
        });
        let ring: Vec<DVec3> = half.clone().chain(half.map(|p| -p)).collect();
        let next = |i: u32| 2 + (i + 1) % count;
        let faces = (0..count).flat_map(|i| [[0, 2 + i, next(i)], [1, next(i), 2 + i]]).collect();
        Mesh::new([tips.to_vec(), ring].concat(), faces).unwrap()
    }

    #[test]
    fn two_fans_over_one_ring_are_paired_with_few_others() {
        let slanted = DVec3::new(0.3, -0.2, 1.5);
        for tips in [[DVec3::Z, -DVec3::Z], [slanted, DVec3::ZERO], [slanted, 0.5 * slanted]] {
            let mesh = cone(2000, tips);
            let (count, met) = paired(&mesh);
            // Of two million: each face with its neighbours beyond the ring.
            assert!((2000..30_000).contains(&count), "{count}");
            assert!(met.is_empty(), "{met:?}");
            let topology = Topology::of(&mesh);
            let tree = FaceTree::of(&mesh, 1);
            let crowds = Crowds::of(&mesh, &topology, &tree, &mut Stars::of(&mesh, &topology));
            let leaves = (0..tree.nodes().len() as u32).filter(|&i| !tree.leaf_faces(i).is_empty());
            assert!(
                leaves.clone().all(|i| leaves.clone().step_by(97).all(|j| crowds.settle(i, j)))
            );
        }
    }

    #[test]
    fn what_crosses_between_two_fans_is_found() {
        // The second tip out at the side, above the first, beside it.
        let mut crossings = 0;
        for second in [DVec3::new(3.0, 0.1, 0.2), 2.0 * DVec3::Z, DVec3::new(0.0, 0.5, 1.0)] {
            let mesh = cone(80, [DVec3::Z, second]);
            let all = (0..160).flat_map(|f| (f + 1..160).map(move |g| [FaceId(f), FaceId(g)]));
            let expected: Vec<_> =
                all.filter(|&pair| judge(&mesh, pair, |_| false).is_some()).collect();
            let (_, mut met) = paired(&mesh);
            met.dedup();
            crossings += expected.len();
            assert_eq!(met, expected);
        }
        assert!(crossings > 20, "{crossings}");
    }

    #[test]
    fn nodes_of_one_crowd_are_known() {
        let mesh = fan(100, 1.0, DVec3::new(0.0, -1.0, -1.0));
        let topology = Topology::of(&mesh);
        let tree = FaceTree::of(&mesh, 2);
        let crowds = Crowds::of(&mesh, &topology, &tree, &mut Stars::of(&mesh, &topology));
        assert!((0..tree.nodes().len() as u32).all(|i| crowds.settle(0, i)));
        assert!(crowds.holds(VertexId(0)) && !crowds.holds(VertexId(1)));
        // One more face, apart.
        let apart = mesh.joined(&Mesh::new(vec![9.0 * DVec3::X; 3], vec![[0, 1, 2]]).unwrap());
        let topology = Topology::of(&apart);
        let tree = FaceTree::of(&apart, 1);
        let crowds = Crowds::of(&apart, &topology, &tree, &mut Stars::of(&apart, &topology));
        assert!(!crowds.settle(0, 0));
    }
}
