//! Where edges that nothing matches nearly meet: T-vertices, and vertices almost in one place.
//!
//! A T-vertex lies in the inside of another face's edge, so that the long edge on one side meets
//! two (or more) short ones on the other: no crack is seen, yet no edge is matched. Only unmatched
//! edges are searched: where every edge is matched there is nothing to join.
//!
//! No source: definitions, with distances rounded upward. Cost: O(k log n) as a rule for k
//! unmatched edges, O(n log n) for vertices near each other.

use cranny_exact::DVec3;

use super::row::Row;
use crate::ids::{EdgeId, VertexId};
use crate::mesh::Mesh;
use crate::near::{corners_along, distance, foot};
use crate::report::{Finding, FindingKind};
use crate::topology::{Edge, Topology};
use crate::tree::FaceTree;

/// A vertex within an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TVertex {
    /// The edge.
    pub(crate) edge: EdgeId,
    /// The vertex.
    pub(crate) vertex: VertexId,
    /// An upper bound of its distance from the edge.
    pub(crate) distance: f64,
}

fn is_unmatched(edge: &Edge) -> bool {
    !edge.kind.is_balanced() && edge.from != edge.to
}

/// Whether each vertex ends an edge that is not matched.
pub(crate) fn on_unmatched_edges(topology: &Topology, vertices: usize) -> Vec<bool> {
    let mut on = vec![false; vertices];
    for edge in topology.edges().iter().filter(|e| is_unmatched(e)) {
        on[edge.from.index()] = true;
        on[edge.to.index()] = true;
    }
    on
}

/// The T-vertices of all unmatched edges, by edge and vertex. O(k log n) for k unmatched edges that
/// are not long against their surroundings.
///
/// A vertex counts where it lies within the distance of the edge, farther than that from its ends
/// (those would be [`near`]), and nearer to each end than the ends are to each other.
pub(crate) fn t_vertices(
    mesh: &Mesh,
    topology: &Topology,
    tree: &FaceTree,
    weld_distance: f64,
) -> Vec<TVertex> {
    let mut found = Vec::new();
    if topology.pairs().is_some() {
        return found;
    }
    let unmatched = on_unmatched_edges(topology, mesh.vertices().len());
    for (e, edge) in topology.edges().iter().enumerate().filter(|(_, e)| is_unmatched(e)) {
        let ends = [edge.from, edge.to].map(|v| mesh.position(v));
        let other = |v: VertexId| unmatched[v.index()] && v != edge.from && v != edge.to;
        for vertex in corners_along(mesh, tree, ends, weld_distance, other) {
            let p = mesh.position(vertex);
            let foot = foot(p, ends);
            if foot.distance <= weld_distance && is_within(p, ends, weld_distance) {
                let edge = EdgeId(e as u32);
                found.push(TVertex { edge, vertex, distance: foot.distance });
            }
        }
    }
    found
}

/// Apart from both ends, and nearer to each than they are to each other.
fn is_within(p: DVec3, ends: [DVec3; 2], weld_distance: f64) -> bool {
    let length = ends[0].distance_squared(ends[1]);
    ends.into_iter().all(|end| distance(end, p) > weld_distance && end.distance_squared(p) < length)
}

/// A vertex and the one that stands for its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Near {
    /// The vertex.
    pub(crate) vertex: VertexId,
    /// Its leader, of lower id.
    pub(crate) leader: VertexId,
    /// An upper bound of their distance.
    pub(crate) distance: f64,
}

/// Vertices within the distance of another, among those that `among` names: each with the nearest
/// leader (on a tie the least), where a leader is a vertex that has none itself. So nobody is
/// farther than the distance from who stands for him, however long the chain. O(n log n).
pub(crate) fn near(
    mesh: &Mesh,
    tree: &FaceTree,
    weld_distance: f64,
    among: impl Fn(VertexId) -> bool,
) -> Vec<Near> {
    let row = Row::of(mesh, weld_distance, among);
    let mut found: Vec<Near> = Vec::new();
    let mut beside = Vec::new();
    let mut follows = vec![false; mesh.vertices().len()];
    for vertex in row.close() {
        let p = mesh.position(vertex);
        row.beside(mesh, tree, vertex, weld_distance, &mut beside);
        let nearest = beside
            .iter()
            .copied()
            .filter(|&v| v < vertex && row.holds(v) && !follows[v.index()])
            .map(|leader| Near { vertex, leader, distance: distance(mesh.position(leader), p) })
            .min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.leader.cmp(&b.leader)))
            .filter(|near| near.distance <= weld_distance);
        if let Some(near) = nearest {
            follows[vertex.index()] = true;
            found.push(near);
        }
    }
    found
}

pub(super) fn t_vertex_findings(
    mesh: &Mesh,
    topology: &Topology,
    found: &[TVertex],
) -> Vec<Finding> {
    let finding = |t: &TVertex| {
        let edge = topology.edges()[t.edge.index()];
        let ids = vec![t.vertex.0, edge.from.0, edge.to.0];
        Finding::one(FindingKind::TVertex, ids, mesh.position(t.vertex), t.distance)
    };
    found.iter().map(finding).collect()
}

pub(super) fn near_findings(mesh: &Mesh, found: &[Near]) -> Vec<Finding> {
    let finding = |near: &Near| {
        let ids = vec![near.leader.0, near.vertex.0];
        Finding::one(FindingKind::NearVertices, ids, mesh.position(near.leader), near.distance)
    };
    found.iter().map(finding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prepared(vertices: &[[f64; 2]], faces: &[[u32; 3]]) -> (Mesh, Topology, FaceTree) {
        let vertices = vertices.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
        let mesh = Mesh::new(vertices, faces.to_vec()).unwrap();
        (mesh.clone(), Topology::of(&mesh), FaceTree::of(&mesh, 1))
    }

    /// A long edge below, two vertices on it from above: one exactly, one `lift` off.
    fn crack(lift: f64) -> (Mesh, Topology, FaceTree) {
        prepared(
            &[[0.0, 0.0], [4.0, 0.0], [2.0, -2.0], [1.0, 0.0], [3.0, lift], [2.0, 2.0]],
            &[[1, 0, 2], [0, 3, 5], [3, 4, 5], [4, 1, 5]],
        )
    }

    #[test]
    fn several_t_vertices_of_one_edge_are_found_within_the_distance() {
        let lift = 1.0 / 1024.0;
        let (mesh, topology, tree) = crack(lift);
        let found = t_vertices(&mesh, &topology, &tree, lift * 1.001);
        let vertices: Vec<u32> = found.iter().map(|t| t.vertex.0).collect();
        assert_eq!(vertices, [3, 4]);
        assert_eq!(found[0].distance, 0.0);
        assert!(found[1].distance >= lift && found[1].distance < lift * 1.001);
        let exact = t_vertices(&mesh, &topology, &tree, 0.0);
        assert_eq!(exact.iter().map(|t| t.vertex.0).collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn ends_and_what_is_near_them_are_no_t_vertices() {
        let (mesh, topology, tree) = crack(0.0);
        let found = t_vertices(&mesh, &topology, &tree, 1.5);
        assert!(found.iter().all(|t| t.vertex.0 != 3 && t.vertex.0 != 4), "{found:?}");
    }

    #[test]
    fn nobody_is_far_from_his_leader_in_a_chain() {
        let points: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), 0.0]).collect();
        let faces: Vec<[u32; 3]> = (0..7).map(|i| [i, i + 1, i + 2]).collect();
        let (mesh, _, tree) = prepared(&points, &faces);
        let found = near(&mesh, &tree, 1.25, |_| true);
        assert_eq!(
            found.iter().map(|n| (n.vertex.0, n.leader.0)).collect::<Vec<_>>(),
            [(1, 0), (3, 2), (5, 4), (7, 6)]
        );
        assert!(found.iter().all(|n| n.distance >= 1.0 && n.distance <= 1.25));
        assert_eq!(near(&mesh, &tree, 1.25, |v| v.0 % 3 == 0), []);
    }
}
