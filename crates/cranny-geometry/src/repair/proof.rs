//! That two meshes are the same surface within a distance, proved from the outcome alone.
//!
//! Given where each filed vertex went and where edges were split, every filed face is laid out as a
//! tiling of triangles, and each of those has an image in the mended mesh. The map is linear on
//! each tile and moves its corners by no more than the distance, so it moves no point farther.
//! Then:
//!
//! - *nothing is missing*: the image of every tile is a face of the mended mesh, or (where corners
//!   fall together) an edge or a vertex of one;
//! - *nothing is new*: every mended face is the image of a tile of the filed face that it claims.
//!
//! So each surface lies within the distance of the other (Hausdorff), but for the sheets inside the
//! solid that `Full` drops, which are named.
//!
//! No source: this crate's own, argued above. Cost: O(n log n).

use thiserror::Error;

use super::subdivide::Splits;
use super::{Cover, is_collapsed};
use crate::ids::{FaceId, VertexId};
use crate::mesh::Mesh;
use crate::near::{distance, foot};
use crate::scan::faces::sorted;

/// What does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ProofError {
    /// A vertex moved too far, or an edge was split too far from where it was filed.
    #[error("a corner or edge of filed face {face} would move by {moved:e}, more than {limit:e}")]
    TooFar {
        /// Filed face.
        face: usize,
        /// How far.
        moved: f64,
        /// Weld distance.
        limit: f64,
    },
    /// A part of a filed face is no part of the mended mesh.
    #[error("a part of filed face {face} would be lost")]
    Missing {
        /// Filed face.
        face: usize,
    },
    /// A mended face is no part of the filed mesh.
    #[error("face {face} of the mended mesh is part of no filed face")]
    New {
        /// Mended face.
        face: usize,
    },
}

/// The claim: how the mended mesh came about.
pub(super) struct Proof<'a> {
    pub(super) filed: &'a Mesh,
    /// The mended vertex of each filed one.
    pub(super) vertex_of: &'a [u32],
    /// Vertices inserted into edges, between mended vertices.
    pub(super) splits: &'a Splits,
    /// Filed faces whose tiles may be missing, ascending.
    pub(super) without: &'a [FaceId],
}

impl Proof<'_> {
    /// Checks it against the mended mesh and the filed face of each of its faces. Returns an upper
    /// bound of how far any point moved, at most `limit`. O(n log n).
    pub(super) fn check(
        &self,
        mended: &Mesh,
        origin: &[FaceId],
        limit: f64,
    ) -> Result<f64, ProofError> {
        let cover = Cover::of(mended.faces().iter().copied());
        let mut faces: Vec<[u32; 3]> = mended.faces().iter().map(|&face| sorted(face)).collect();
        faces.sort_unstable();
        let mut claimed: Vec<([u32; 3], FaceId)> = Vec::with_capacity(faces.len());
        let mut moved = 0.0f64;
        for (f, corners) in self.filed.faces().iter().enumerate() {
            let face = FaceId(f as u32);
            let image = corners.map(|v| self.vertex_of[v as usize]);
            let off = self.displacement(mended, face, image);
            if off > limit {
                return Err(ProofError::TooFar { face: f, moved: off, limit });
            }
            moved = moved.max(off);
            let tiles = self.splits.parts(image);
            let may_miss = self.without.binary_search(&face).is_ok();
            for &tile in &tiles {
                let present = match is_collapsed(tile) {
                    true => cover.holds(tile),
                    false => faces.binary_search(&sorted(tile)).is_ok(),
                };
                if !present && !may_miss {
                    return Err(ProofError::Missing { face: f });
                }
                claimed.push((sorted(tile), face));
            }
            // A face that collapsed as a whole may stay as it was.
            if tiles.iter().all(|&tile| is_collapsed(tile)) {
                claimed.push((sorted(image), face));
            }
        }
        claimed.sort_unstable();
        for (face, (&corners, &origin)) in mended.faces().iter().zip(origin).enumerate() {
            if claimed.binary_search(&(sorted(corners), origin)).is_err() {
                return Err(ProofError::New { face });
            }
        }
        Ok(moved)
    }

    /// How far the map moves a filed face: its corners to their images, and points of its sides, in
    /// their order along the side, to the vertices inserted there.
    fn displacement(&self, mended: &Mesh, face: FaceId, image: [u32; 3]) -> f64 {
        let filed = self.filed.triangle(face);
        let mut moved = 0.0f64;
        for corner in 0..3 {
            let next = (corner + 1) % 3;
            moved = moved.max(distance(filed[corner], mended.position(VertexId(image[corner]))));
            let side = [filed[corner], filed[next]];
            let mut reached = 0.0;
            for vertex in self.splits.between(image[corner], image[next]) {
                let p = mended.position(VertexId(vertex));
                let foot = foot(p, side);
                moved = moved.max(foot.distance);
                if foot.parameter < reached {
                    // Out of order: its partner on the side is the point reached before.
                    moved = moved.max(distance(p, side[0].lerp(side[1], reached)));
                }
                reached = foot.parameter.max(reached);
            }
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    /// A quad of two faces; the claim is about meshes on the same vertices.
    fn quad() -> Mesh {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.0]];
        let vertices = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    fn checked(splits: &Splits, faces: &[[u32; 3]], origin: &[u32]) -> Result<f64, ProofError> {
        let filed = quad();
        let mended = Mesh::new(filed.vertices().to_vec(), faces.to_vec()).unwrap();
        let origin: Vec<FaceId> = origin.iter().map(|&f| FaceId(f)).collect();
        let vertex_of = [0, 1, 2, 3, 4];
        Proof { filed: &filed, vertex_of: &vertex_of, splits, without: &[] }
            .check(&mended, &origin, 0.5)
    }

    #[test]
    fn the_same_faces_and_a_split_edge_are_the_same_surface() {
        let none = Splits::default();
        assert_eq!(checked(&none, &[[0, 1, 2], [0, 2, 3]], &[0, 1]), Ok(0.0));
        let mut split = Splits::default();
        split.insert(VertexId(0), VertexId(1), vec![4]);
        assert_eq!(checked(&split, &[[0, 4, 2], [4, 1, 2], [0, 2, 3]], &[0, 0, 1]), Ok(0.0));
    }

    #[test]
    fn a_missing_face_a_new_one_and_a_wrong_origin_are_refused() {
        let none = Splits::default();
        let missing = checked(&none, &[[0, 1, 2]], &[0]);
        assert_eq!(missing, Err(ProofError::Missing { face: 1 }));
        let new = checked(&none, &[[0, 1, 2], [0, 2, 3], [0, 1, 3]], &[0, 1, 1]);
        assert_eq!(new, Err(ProofError::New { face: 2 }));
        let wrong = checked(&none, &[[0, 1, 2], [0, 2, 3]], &[1, 0]);
        assert_eq!(wrong, Err(ProofError::New { face: 0 }));
    }

    #[test]
    fn a_split_far_from_the_edge_is_refused() {
        let mut split = Splits::default();
        split.insert(VertexId(0), VertexId(2), vec![4]); // sqrt(1/2) off the diagonal
        let refused = checked(&split, &[[0, 1, 4], [4, 1, 2], [0, 4, 3], [4, 2, 3]], &[0, 0, 1, 1]);
        assert!(matches!(refused, Err(ProofError::TooFar { face: 0, .. })), "{refused:?}");
    }
}
