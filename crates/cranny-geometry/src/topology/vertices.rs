//! The faces at each vertex: dealt out by counting, in linear time; source with the module.

use super::Topology;
use crate::ids::{FaceId, HalfEdgeId, VertexId};
use crate::mesh::Mesh;
use crate::rows::{row, rows};

/// The faces of each vertex in its row.
#[derive(Clone, Debug)]
pub(super) struct VertexFaces {
    /// Where the faces of each vertex begin, and one more, where the last end.
    starts: Vec<u32>,
    faces: Vec<FaceId>,
}

impl VertexFaces {
    pub(super) fn of(mesh: &Mesh) -> Self {
        Self::of_corners(mesh.vertices().len(), mesh.faces().as_flattened())
    }

    /// The same without the mesh, from edges.
    pub(super) fn of_edges(topology: &Topology) -> Self {
        let faces = 0..topology.edge_of.len() as u32 / 3;
        let corners: Vec<u32> = faces.flat_map(|f| corners(topology, FaceId(f))).collect();
        Self::of_corners(topology.vertices, &corners)
    }

    /// Given three corners of each face, in any order. O(n).
    fn of_corners(vertices: usize, corners: &[u32]) -> Self {
        let (starts, half_edges) = rows(corners, vertices);
        let faces = half_edges.into_iter().map(|h| HalfEdgeId(h).face()).collect();
        Self { starts, faces }
    }

    /// Those of one vertex, by ascending id.
    #[inline]
    pub(super) fn at(&self, vertex: VertexId) -> &[FaceId] {
        &self.faces[row(&self.starts, vertex.index())]
    }
}

/// The corners of a face in some order: the ends of its first side, and the one across, which the
/// other two sides share with each other and with nobody else. So it is found by sums, also where
/// corners coincide.
fn corners(topology: &Topology, face: FaceId) -> [u32; 3] {
    let ends = |corner: usize| {
        let edge = topology.edges[topology.edge_of(HalfEdgeId::of(face, corner)).index()];
        [edge.from.0, edge.to.0]
    };
    let [[a, b], second, third] = [0, 1, 2].map(ends);
    let sum = |ends: [u32; 2]| u64::from(ends[0]) + u64::from(ends[1]);
    [a, b, ((sum(second) + sum(third) - sum([a, b])) / 2) as u32]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{points, tetrahedron};
    use super::*;

    #[test]
    fn each_vertex_names_its_faces_in_order() {
        let mesh = Mesh::new(points(5), tetrahedron(0)).unwrap();
        let VertexFaces { starts, faces } = VertexFaces::of(&mesh);
        assert_eq!(starts, [0, 3, 6, 9, 12, 12]);
        assert_eq!(faces, [0, 1, 3, 0, 1, 2, 0, 2, 3, 1, 2, 3].map(FaceId));
    }

    #[test]
    fn edges_tell_what_faces_do() {
        // Corners that coincide in every way, edges of many faces, a vertex that no face names.
        let collapsed = [[0, 0, 1], [0, 1, 0], [1, 0, 0], [1, 1, 0], [2, 2, 2], [3, 2, 3]];
        let others = (0..90u32).map(|i| [i * 7 % 5, i * i % 11, (i * 5 + 1) % 7]);
        let mesh = Mesh::new(points(14), collapsed.into_iter().chain(others).collect()).unwrap();
        let VertexFaces { starts, faces } = VertexFaces::of(&mesh);
        let of_edges = VertexFaces::of_edges(&Topology::of(&mesh));
        assert_eq!((of_edges.starts, of_edges.faces), (starts, faces));
    }
}
