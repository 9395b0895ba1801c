//! Areas and volumes of a hull and of all faces, kept in sums over chunks: what is left of them
//! once concavities are taken off is the skin.
//!
//! Sums over chunks in which something is other are made again when they are read, so that
//! errors of rounding do not gather. No source. Cost: those chunks, and a pass over the sums;
//! everything where the box of the hull is another.

use std::collections::BTreeSet;

use cranny_exact::DVec3;

use super::input::{Input, twice_area_vector};
use super::{Record, Skin};
use cranny_geometry::FaceId;

/// Triangles in a chunk. Fewer, and there are more sums to add up; more, and more triangles are
/// looked at again for each one that has changed.
const CHUNK: usize = 64;

/// An area, and a volume beneath it.
type Sum = [f64; 2];

/// Sums over triangles of the hull and over faces of the mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceSums {
    /// From where volumes are measured; none before the first question.
    center: Option<DVec3>,
    hull: Vec<Sum>,
    faces: Vec<Sum>,
    /// Chunks of the hull and of faces that have to be added up again.
    stale_hull: BTreeSet<usize>,
    stale_faces: BTreeSet<usize>,
}

impl SurfaceSums {
    /// Faces have moved.
    pub(crate) fn touch_faces(&mut self, faces: &[FaceId]) {
        self.stale_faces.extend(faces.iter().map(|f| f.index() / CHUNK));
    }

    /// Triangles of the hull are others, and there are so many.
    pub(crate) fn touch_hull(&mut self, triangles: &[u32], count: usize) {
        self.stale_hull.extend(triangles.iter().map(|&t| t as usize / CHUNK));
        self.stale_hull
            .extend([self.hull.len().saturating_sub(1), count.saturating_sub(1) / CHUNK]);
    }

    /// What lies between the hull and the faces on it; `caps` is how many caps belong to no
    /// concavity.
    pub(super) fn skin(&mut self, input: &Input<'_>, records: &[Record], caps: u32) -> Skin {
        let &Input { mesh, hull, center, .. } = input;
        if self.center != Some(center) {
            *self = Self { center: Some(center), ..Self::default() };
            self.stale_hull.extend(0..hull.triangle_count().div_ceil(CHUNK));
            self.stale_faces.extend(0..mesh.faces().len().div_ceil(CHUNK));
        }
        let of_hull = |t: usize| hull.corners(t);
        let of_mesh = |f: usize| mesh.triangle(FaceId(f as u32));
        renew(&mut self.hull, &mut self.stale_hull, hull.triangle_count(), center, of_hull);
        renew(&mut self.faces, &mut self.stale_faces, mesh.faces().len(), center, of_mesh);
        let mut skin = Skin { caps, ..Skin::default() };
        for (sums, sign) in [(&self.hull, 1.0), (&self.faces, -1.0)] {
            for [area, volume] in sums {
                skin.area += sign * area;
                skin.volume += sign * volume;
            }
        }
        for Record { measures, .. } in records {
            skin.area += measures.face_area - measures.cap_area;
            skin.volume -= measures.pocket_volume;
        }
        skin
    }
}

/// Adds up what is stale, of so many triangles.
fn renew(
    sums: &mut Vec<Sum>,
    stale: &mut BTreeSet<usize>,
    count: usize,
    center: DVec3,
    triangle: impl Fn(usize) -> [DVec3; 3],
) {
    sums.resize(count.div_ceil(CHUNK), [0.0; 2]);
    for chunk in std::mem::take(stale) {
        let Some(sum) = sums.get_mut(chunk) else { continue };
        *sum = [0.0; 2];
        for corners in (CHUNK * chunk..(CHUNK * (chunk + 1)).min(count)).map(&triangle) {
            let [a, b, c] = corners.map(|p| p - center);
            sum[0] += 0.5 * twice_area_vector(corners).length();
            sum[1] += a.dot(b.cross(c)) / 6.0;
        }
    }
}
