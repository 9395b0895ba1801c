//! Vertices in exactly the same place become one.
//!
//! Formats without indices (STL), and exporters that split vertices by normal or material, file one
//! point many times. Welding them moves nothing and is what makes edges meet. Face ids stay as they
//! were filed; a face that had two corners in one place keeps them and is a segment or a point.

use std::collections::HashMap;

use cranny_exact::DVec3;

use crate::mesh::Mesh;

/// A mesh without coincident or unreferenced vertices, and how it came about.
pub(crate) struct Welded {
    pub(crate) mesh: Mesh,
    /// Vertices that were merged into another in the same place.
    pub(crate) duplicates: usize,
    /// Vertices that no face used.
    pub(crate) unreferenced: usize,
    /// New id of each filed vertex; [`UNREFERENCED`] where no face uses it.
    pub(crate) new_id: Vec<u32>,
}

/// In place of an id: no face uses the vertex.
pub(crate) const UNREFERENCED: u32 = u32::MAX;

/// Merges coincident vertices and drops unreferenced ones; the order of first use is kept.
pub(crate) fn weld(mesh: &Mesh) -> Welded {
    let mut first_at: HashMap<[u64; 3], u32> = HashMap::with_capacity(mesh.vertices().len());
    let mut new_id = vec![UNREFERENCED; mesh.vertices().len()];
    let mut vertices: Vec<DVec3> = Vec::with_capacity(mesh.vertices().len());
    let mut duplicates = 0;
    let mut faces = Vec::with_capacity(mesh.faces().len());
    for face in mesh.faces() {
        faces.push(face.map(|old| {
            if new_id[old as usize] == UNREFERENCED {
                let p = mesh.vertices()[old as usize];
                // `+ 0.0` makes −0 and 0 the same place.
                let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
                let next = vertices.len() as u32;
                let id = *first_at.entry(key).or_insert(next);
                if id == next {
                    // Boxes then do not depend on the order in which zeros of both signs are met.
                    vertices.push(p + DVec3::ZERO);
                } else {
                    duplicates += 1;
                }
                new_id[old as usize] = id;
            }
            new_id[old as usize]
        }));
    }
    let unreferenced = new_id.iter().filter(|&&id| id == UNREFERENCED).count();
    Welded { mesh: Mesh::from_trusted(vertices, faces), duplicates, unreferenced, new_id }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quad_filed_as_two_loose_triangles_gets_four_vertices() {
        let [a, b, c, d] = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let unused = DVec3::Z;
        let negative_zero = DVec3::new(-0.0, 0.0, -0.0);
        let mesh =
            Mesh::new(vec![a, b, c, negative_zero, c, d, unused], vec![[0, 1, 2], [3, 4, 5]])
                .unwrap();
        let welded = weld(&mesh);
        assert_eq!(welded.mesh.vertices(), [a, b, c, d]);
        assert_eq!(welded.mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!((welded.duplicates, welded.unreferenced), (2, 1));
        assert_eq!(welded.new_id, [0, 1, 2, 0, 2, 3, UNREFERENCED]);
    }

    #[test]
    fn no_zero_keeps_a_sign() {
        let mesh = Mesh::new(vec![DVec3::new(-0.0, 1.0, -2.0); 3], vec![[0, 1, 2]]).unwrap();
        let welded = weld(&mesh);
        assert_eq!(welded.mesh.vertices().len(), 1);
        assert_eq!(
            welded.mesh.vertices()[0].to_array().map(f64::to_bits),
            [0.0, 1.0, -2.0].map(f64::to_bits)
        );
    }
}
