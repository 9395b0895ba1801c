//! Vertices in exactly the same place become one.
//!
//! Formats without indices (STL), and exporters that split vertices by normal or material, file one
//! point many times. Welding them moves nothing and is what makes edges meet. Face ids stay as they
//! were filed; a face that had two corners in one place keeps them and is a segment or a point.
//!
//! Source: linear probing is in Knuth (1973, section 6.4). Cost: O(n) expected.

use std::hash::{BuildHasher, RandomState};

use cranny_exact::DVec3;

use crate::mesh::Mesh;

/// A mesh without coincident or unreferenced vertices, and how it came about.
pub(crate) struct Welded {
    pub(crate) mesh: Mesh,
    /// Filed vertices that were merged into another in the same place, ascending.
    pub(crate) duplicates: Vec<u32>,
    /// Filed vertices that no face used, ascending.
    pub(crate) unreferenced: Vec<u32>,
    /// New id of each filed vertex; [`UNREFERENCED`] where no face uses it.
    pub(crate) new_id: Vec<u32>,
}

/// In place of an id: no face uses the vertex.
pub(crate) const UNREFERENCED: u32 = u32::MAX;

/// Merges coincident vertices and drops unreferenced ones; the order of first use is kept.
pub(crate) fn weld(mesh: &Mesh) -> Welded {
    let mut places = Places::new(mesh.vertices().len());
    let mut new_id = vec![UNREFERENCED; mesh.vertices().len()];
    let mut vertices: Vec<DVec3> = Vec::with_capacity(mesh.vertices().len());
    let mut duplicates = Vec::new();
    let mut faces = Vec::with_capacity(mesh.faces().len());
    for face in mesh.faces() {
        let mut corners = *face;
        for corner in &mut corners {
            let old = *corner;
            if new_id[old as usize] == UNREFERENCED {
                // No zero keeps a sign: boxes then do not depend on the order in which zeros of
                // both signs are met.
                let p = mesh.vertices()[old as usize] + DVec3::ZERO;
                let count = vertices.len();
                let id = places.id_of(p, &mut vertices);
                if vertices.len() == count {
                    duplicates.push(old);
                }
                new_id[old as usize] = id;
            }
            *corner = new_id[old as usize];
        }
        faces.push(corners);
    }
    duplicates.sort_unstable();
    let ids = (0..).zip(&new_id).filter(|&(_, &id)| id == UNREFERENCED);
    let unreferenced = ids.map(|(old, _)| old).collect();
    Welded { mesh: Mesh::from_trusted(vertices, faces), duplicates, unreferenced, new_id }
}

/// Who is where: a table of ids, searched from the place that a hash names (linear probing). Hashed
/// by folded multiplications (Wang Yi, wyhash, 2019) of the bits of coordinates; the seed differs
/// from table to table, so that nobody can file vertices that all collide.
struct Places {
    /// Less than half full.
    ids: Vec<u32>,
    seed: u64,
}

impl Places {
    /// For at most `count` vertices.
    fn new(count: usize) -> Self {
        let size = (2 * count + 1).next_power_of_two();
        Self { ids: vec![UNREFERENCED; size], seed: RandomState::new().hash_one(0) }
    }

    /// The id of the vertex at `p`, of those listed; if there is none, the point is appended.
    fn id_of(&mut self, p: DVec3, vertices: &mut Vec<DVec3>) -> u32 {
        let mut at = self.hash(p) as usize & (self.ids.len() - 1);
        loop {
            let id = self.ids[at];
            if id == UNREFERENCED {
                self.ids[at] = vertices.len() as u32;
                vertices.push(p);
                return self.ids[at];
            }
            if vertices[id as usize] == p {
                return id;
            }
            at = (at + 1) & (self.ids.len() - 1);
        }
    }

    fn hash(&self, p: DVec3) -> u64 {
        /// Odd, with as many ones as zeros, in no pattern.
        const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
        p.to_array().into_iter().fold(self.seed, |hash, x| {
            let product = u128::from(hash ^ x.to_bits()) * u128::from(FACTOR);
            (product >> 64) as u64 ^ product as u64
        })
    }
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
        assert_eq!((welded.duplicates, welded.unreferenced), (vec![3, 4], vec![6]));
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
