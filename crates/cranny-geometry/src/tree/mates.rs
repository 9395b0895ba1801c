//! Which two faces hang together most: over the longest side of both.
//!
//! Most surfaces are quadrangles cut in two; trees that keep the two halves together are grown in
//! half the time, and would part nearly all of them last anyway.
//!
//! No source: this crate's own; a tree is right whatever is paired. Cost: O(n).

use cranny_exact::{Aabb, DVec3};

use crate::ids::{FaceId, HalfEdgeId};
use crate::mesh::Mesh;
use crate::topology::Topology;

/// The box of a pair has at most so many times the mean area of its faces' boxes. Larger, and trees
/// over balls have 4 % more area; smaller, and the halves of slanted quadrangles are no pairs (with
/// 1.5 the boxes of all nodes have as much area as without pairs, to within 0.7 %).
const SNUG: f64 = 1.5;

/// For each face the one that it is paired with, if any, and its box: trees and patches need it
/// again and again.
pub(crate) struct Mates {
    mates: Vec<FaceId>,
    boxes: Vec<Aabb>,
}

impl Mates {
    /// Cost: O(n).
    pub(crate) fn of(mesh: &Mesh, topology: &Topology) -> Self {
        let count = mesh.faces().len();
        let all = || (0..count as u32).map(FaceId);
        let (mut longest, mut boxes) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for face in all() {
            let triangle = mesh.triangle(face);
            longest.push(HalfEdgeId::of(face, longest_side(&triangle)));
            boxes.push(Aabb::of_points(triangle));
        }
        let mut mates: Vec<FaceId> = all().collect();
        for face in all() {
            let side = longest[face.index()];
            // Of two the lesser one speaks for both.
            let Some(twin) = topology.twin(side).filter(|twin| *twin > side) else { continue };
            let other = twin.face();
            if longest[other.index()] == twin
                && fit_in_one_box(&boxes[face.index()], &boxes[other.index()])
            {
                (mates[face.index()], mates[other.index()]) = (other, face);
            }
        }
        Self { mates, boxes }
    }

    /// The other face of a pair.
    pub(super) fn of_face(&self, face: FaceId) -> Option<FaceId> {
        Some(self.mates[face.index()]).filter(|&mate| mate != face)
    }

    /// The box of a face.
    #[inline]
    pub(crate) fn bounds(&self, face: FaceId) -> &Aabb {
        &self.boxes[face.index()]
    }
}

/// The corner at which the longest side of a face begins, the first of equals.
fn longest_side(&[a, b, c]: &[DVec3; 3]) -> usize {
    DVec3::from_array([b - a, c - b, a - c].map(DVec3::length_squared)).max_position()
}

/// Whether the box of both faces is hardly larger than that of either.
fn fit_in_one_box(a: &Aabb, b: &Aabb) -> bool {
    2.0 * a.union(b).half_area() <= SNUG * (a.half_area() + b.half_area())
}
