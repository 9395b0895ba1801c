//! What is added up or compared over a whole body, kept in parts so that moved vertices touch few
//! of them.
//!
//! No source: sums and maxima over chunks, of which those with something that has moved are made
//! again, so that errors of rounding do not gather. Cost: a chunk for each vertex or face that has
//! moved, at most, and a pass over what is kept of all chunks; all faces where the middle of the
//! body's box has moved.

use crate::chunks::{CHUNK, touched};
use crate::digest::BlockHashes;
use crate::ids::{FaceId, VertexId};
use crate::mass::MassSums;
use crate::mesh::Mesh;
use crate::model::Parts;
use crate::reach::{farthest, radius};

/// Sums, maxima and hashes of parts of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Totals {
    /// Of a closed mesh.
    mass: Option<MassSums>,
    /// The square of the distance of the farthest vertex of each chunk.
    farthest: Vec<f64>,
    hashes: BlockHashes,
}

impl Totals {
    pub(super) fn of(parts: &Parts) -> Self {
        let Parts { mesh, mass, hull, .. } = parts;
        let reference = hull.bounds().center();
        Self {
            mass: mass.is_some().then(|| MassSums::of(mesh, reference)),
            farthest: mesh.vertices().chunks(CHUNK).map(farthest).collect(),
            hashes: BlockHashes::of(mesh),
        }
    }

    /// Follows vertices that have moved, and their faces, which ascend; the hull is theirs already.
    /// Returns how many faces and vertices were looked at.
    pub(super) fn follow(
        &mut self,
        parts: &mut Parts,
        vertices: &[VertexId],
        faces: &[FaceId],
    ) -> usize {
        let Parts { mesh, mass, hull, radius: reach, digest, .. } = parts;
        let mut looked_at = self.follow_farthest(mesh, vertices);
        *reach = radius(self.farthest.iter().copied().fold(0.0, f64::max));
        if let (Some(mass), Some(sums)) = (mass, &mut self.mass) {
            looked_at += sums.update(mesh, hull.bounds().center(), faces);
            *mass = sums.properties(mesh);
        }
        self.hashes.update(mesh, vertices);
        *digest = self.hashes.digest(mesh);
        looked_at
    }

    fn follow_farthest(&mut self, mesh: &Mesh, vertices: &[VertexId]) -> usize {
        let mut looked_at = 0;
        for (chunk, range) in touched(vertices.iter().map(|v| v.index()), mesh.vertices().len()) {
            let points = &mesh.vertices()[range];
            self.farthest[chunk] = farthest(points);
            looked_at += points.len();
        }
        looked_at
    }
}
