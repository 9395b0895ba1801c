//! Vertices at which very many faces meet: the tip of a cone, the middle of a disc.
//!
//! The boxes of these faces all hold the vertex, so they say nothing: of k faces k²/2 pairs would be
//! judged. But two triangles with a common corner meet elsewhere only along rays from that corner; so
//! they are paired by boxes around the arcs that they cut out of the unit sphere about it. Where the
//! star is [spread out](Star::Spread) nothing needs judging at all. In either case pairs of nodes of the
//! face tree whose faces all have the vertex need not be opened.

use std::ops::ControlFlow;

use cranny_exact::{Aabb, DVec3};

use super::pairs::overlapping_pairs;
use super::stars::Star;
use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::topology::Topology;
use crate::tree::{Content, FaceTree, Grower};

/// Faces that make a crowd. Fewer, and the pairs are judged as soon as paired by directions; more, and
/// the pairs of so many faces are judged at every vertex of that degree.
const CROWD: usize = 32;

/// No vertex.
const NONE: u32 = u32::MAX;

/// The crowded vertices of a mesh.
pub(super) struct Crowds<'a> {
    mesh: &'a Mesh,
    topology: &'a Topology,
    /// Those whose stars are not spread out, ascending.
    judged: Vec<VertexId>,
    /// Of each node of the face tree the crowded vertex that all faces beneath have, or [`NONE`]. Empty
    /// where nothing is crowded.
    of_node: Vec<u32>,
}

impl<'a> Crowds<'a> {
    /// O(n).
    pub(super) fn of(
        mesh: &'a Mesh,
        topology: &'a Topology,
        tree: &FaceTree,
        stars: &[Star],
    ) -> Self {
        let vertices = (0..mesh.vertices().len() as u32).map(VertexId);
        let crowded: Vec<VertexId> =
            vertices.filter(|&v| topology.faces_at(v).len() >= CROWD).collect();
        let of_node = match crowded.is_empty() {
            true => Vec::new(),
            false => crowds_of_nodes(mesh, topology, tree),
        };
        let judged = crowded.into_iter().filter(|v| stars[v.index()] != Star::Spread).collect();
        Self { mesh, topology, judged, of_node }
    }

    /// Whether the pairs of the faces at a vertex are among [`pairs`](Self::pairs).
    pub(super) fn holds(&self, vertex: VertexId) -> bool {
        !self.judged.is_empty() && self.judged.binary_search(&vertex).is_ok()
    }

    /// Whether all faces beneath two nodes share one crowded vertex.
    pub(super) fn share(&self, i: u32, j: u32) -> bool {
        !self.of_node.is_empty() && {
            let [i, j] = [i, j].map(|node| self.of_node[node as usize]);
            i != NONE && i == j
        }
    }

    /// Calls `visit` with all pairs of faces around crowded vertices, not spread out, that may meet
    /// elsewhere; two faces with two crowded vertices are named twice. O(k log k) for k faces around a
    /// vertex, but for pairs that lie in directions near each other.
    pub(super) fn pairs(
        &self,
        mut visit: impl FnMut(FaceId, FaceId) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut grower = Grower::new(1);
        let (mut nodes, mut leaves) = (Vec::new(), Vec::new());
        for &vertex in &self.judged {
            nodes.clear();
            leaves.clear();
            let faces = self.topology.faces_at(vertex).iter();
            let arcs = faces.filter_map(|&face| Some((face, arc(self.mesh, vertex, face)?)));
            grower.grow(arcs, &mut nodes, &mut leaves);
            overlapping_pairs(&nodes, &leaves, |_, _| true, &mut visit)?;
        }
        ControlFlow::Continue(())
    }
}

/// A box around the arc of the unit sphere that a face cuts out about one of its corners; none for a
/// face that ends there.
///
/// An arc of angle a rises 1 − cos(a/2) above its chord, and that is no more than sin²(a/2), a quarter
/// of the chord's square. Directions are wrong by a few roundings.
fn arc(mesh: &Mesh, vertex: VertexId, face: FaceId) -> Option<Aabb> {
    let corners = mesh.corners(face);
    let at = corners.iter().position(|&v| v == vertex)?;
    let middle = mesh.position(vertex);
    let [p, q] = [1, 2].map(|i| mesh.position(corners[(at + i) % 3]) - middle);
    if p == DVec3::ZERO || q == DVec3::ZERO {
        return None;
    }
    let [p, q] = [p, q].map(|p| p / p.length());
    let rise = 0.25 * p.distance_squared(q);
    Some(Aabb::of_points([p, q]).grown(rise + 16.0 * f64::EPSILON))
}

/// Of each node the crowded vertex that all faces beneath have: of each face the one with most faces, the
/// least of equals.
fn crowds_of_nodes(mesh: &Mesh, topology: &Topology, tree: &FaceTree) -> Vec<u32> {
    let degree = |v: VertexId| topology.faces_at(v).len();
    let of_face = |face: FaceId| {
        let crowded = mesh.corners(face).into_iter().filter(|&v| degree(v) >= CROWD);
        crowded.max_by_key(|&v| (degree(v), std::cmp::Reverse(v))).map_or(NONE, |v| v.0)
    };
    let common = |a: u32, b: u32| if a == b { a } else { NONE };
    let count = tree.nodes().len();
    let mut of_node = vec![NONE; count];
    // Children stand behind their parents.
    for node in (0..count as u32).rev() {
        of_node[node as usize] = match tree.content(node) {
            Content::Inner { left, right } => {
                common(of_node[left as usize], of_node[right as usize])
            }
            Content::Leaf { .. } => {
                tree.leaf_faces(node).iter().map(|&f| of_face(f)).reduce(common).unwrap_or(NONE)
            }
        };
    }
    of_node
}

#[cfg(test)]
mod tests {
    use super::super::judge::judge;
    use super::super::stars::stars;
    use super::*;

    /// A tip, and a closed ring of others around it at distances that swing between 1 and `far`; the
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
        let crowds = Crowds::of(mesh, &topology, &tree, &stars(mesh, &topology));
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
        for far in [1.0, 1.5] {
            let mesh = fan(1000, far, DVec3::new(0.0, -1.0, -1.0));
            let (count, met) = paired(&mesh);
            assert!(count < 20_000, "{count}");
            assert_eq!(met, []);
        }
    }

    #[test]
    fn what_crosses_around_a_tip_is_found() {
        // The first face reaches over to the other side, through all that lie between.
        let mesh = fan(200, 1.2, DVec3::new(0.9, 0.5, -1.0));
        let (_, met) = paired(&mesh);
        let all = (0..199).flat_map(|f| (f + 1..199).map(move |g| [FaceId(f), FaceId(g)]));
        let expected: Vec<_> =
            all.filter(|&pair| judge(&mesh, pair, |_| false).is_some()).collect();
        assert!(expected.len() > 50);
        assert_eq!(met, expected);
    }

    #[test]
    fn nodes_of_one_crowd_are_known() {
        let mesh = fan(100, 1.0, DVec3::new(0.0, -1.0, -1.0));
        let topology = Topology::of(&mesh);
        let tree = FaceTree::of(&mesh, 2);
        let crowds = Crowds::of(&mesh, &topology, &tree, &stars(&mesh, &topology));
        assert!((0..tree.nodes().len() as u32).all(|i| crowds.share(0, i)));
        assert!(crowds.holds(VertexId(0)) && !crowds.holds(VertexId(1)));
        // One more face, apart.
        let apart = mesh.joined(&Mesh::new(vec![9.0 * DVec3::X; 3], vec![[0, 1, 2]]).unwrap());
        let topology = Topology::of(&apart);
        let tree = FaceTree::of(&apart, 1);
        let crowds = Crowds::of(&apart, &topology, &tree, &stars(&apart, &topology));
        assert!(!crowds.share(0, 0));
    }
}
