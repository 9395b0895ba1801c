//! Vertices in exactly the same place become one.
//!
//! Formats without indices (STL), and exporters that split vertices by normal or material, file one
//! point many times. Welding them moves nothing and is what makes edges meet. Face ids stay as they
//! were filed; a face that had two corners in one place keeps them and is a segment or a point.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};

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
    let mut first_at: HashMap<(u64, u64, u64), u32, Seed> =
        HashMap::with_capacity_and_hasher(mesh.vertices().len(), Seed::new());
    let mut new_id = vec![UNREFERENCED; mesh.vertices().len()];
    let mut vertices: Vec<DVec3> = Vec::with_capacity(mesh.vertices().len());
    let mut duplicates = 0;
    let mut faces = Vec::with_capacity(mesh.faces().len());
    for face in mesh.faces() {
        faces.push(face.map(|old| {
            if new_id[old as usize] == UNREFERENCED {
                let p = mesh.vertices()[old as usize];
                // `+ 0.0` makes −0 and 0 the same place.
                let bits = |x: f64| (x + 0.0).to_bits();
                let key = (bits(p.x), bits(p.y), bits(p.z));
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

/// How places are hashed: by folded multiplications (Wang Yi, wyhash, 2019), in a quarter of the time of what
/// a `HashMap` does by itself. The seed differs from map to map: nobody can file vertices that all collide.
struct Seed(u64);

impl Seed {
    fn new() -> Self {
        Self(RandomState::new().hash_one(0))
    }
}

impl BuildHasher for Seed {
    type Hasher = Mix;

    fn build_hasher(&self) -> Mix {
        Mix(self.0)
    }
}

/// What was hashed so far.
struct Mix(u64);

impl Hasher for Mix {
    fn write_u64(&mut self, number: u64) {
        /// Odd, with as many ones as zeros, in no pattern.
        const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;
        let product = u128::from(self.0 ^ number) * u128::from(FACTOR);
        self.0 = (product >> 64) as u64 ^ product as u64;
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(byte.into()));
    }

    fn finish(&self) -> u64 {
        self.0
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
