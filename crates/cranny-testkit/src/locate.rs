//! Where a point lies relative to a closed mesh, in exact rationals.

use std::cmp::Ordering;
use std::collections::HashMap;

use cranny_exact::{Aabb, DVec3, Piercing, Pose, SegmentFeature, TriangleFeature};
use cranny_geometry::Mesh;

use crate::convex::Region;
use crate::random::Rng;
use crate::rational::{Q, Q3};
use crate::surface::posed_triangles;
use crate::triangle::piercing;

/// Where a point lies relative to a closed mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Location {
    /// In the open inside: the mesh winds around the point.
    Inside,
    /// On some face.
    On,
    /// In the open outside, voids included.
    Outside,
}

/// A mesh with its vertices posed in the world and rounded to `f64`: what the oracles judge.
#[derive(Clone, Debug)]
pub struct PosedMesh {
    triangles: Vec<[DVec3; 3]>,
    regions: Vec<Region>,
    boxes: Vec<Aabb>,
    bounds: Aabb,
    closed: bool,
}

impl PosedMesh {
    /// Poses every vertex by [`Pose::world_from_body`] and rounds it.
    #[must_use]
    pub fn new(mesh: &Mesh, pose: &Pose) -> Self {
        let triangles = posed_triangles(mesh, &pose.world_from_body());
        let boxes: Vec<Aabb> = triangles.iter().map(|&t| Aabb::of_points(t)).collect();
        Self {
            regions: triangles.iter().map(|t| Region::of(&t.map(Q3::exactly))).collect(),
            bounds: boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one)),
            closed: is_closed(mesh),
            triangles,
            boxes,
        }
    }

    /// Whether every edge is run as often forth as back, vertices in one place counted as one. Only
    /// then has the mesh an inside.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The faces in world coordinates.
    #[must_use]
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        &self.triangles
    }

    pub(crate) fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// Faces that hold the point.
    pub(crate) fn faces_at<'a>(&'a self, p: &'a Q3) -> impl Iterator<Item = &'a Region> + 'a {
        let around = enclosure(p, p);
        let near = move |(_, one): &(&Region, &Aabb)| one.overlaps(&around);
        self.regions.iter().zip(&self.boxes).filter(near).map(|(r, _)| r).filter(|r| r.contains(p))
    }

    /// Where the point lies; never `Inside` where the mesh is not closed.
    ///
    /// Counts the faces that a ray crosses, with their directions. A ray that meets an edge or a
    /// corner, or runs in a face, proves nothing: another direction is taken. Rays run almost along
    /// +x, so that the boxes of the faces rule out most of them.
    #[must_use]
    pub fn locate(&self, p: &Q3) -> Location {
        if self.faces_at(p).next().is_some() {
            return Location::On;
        }
        if !self.closed {
            return Location::Outside;
        }
        let Ok(far) = Q::try_from(self.bounds.max.x) else { return Location::Outside };
        let reach = far + Q::ONE - &p.xyz[0];
        if reach <= Q::ZERO {
            return Location::Outside;
        }
        let mut rng = Rng::new(0);
        loop {
            let slant = DVec3::new(1.0, rng.unit() / 64.0, rng.unit() / 64.0);
            let end = p + &(&Q3::exactly(slant) * &reach);
            if let Some(winding) = self.winding_along(&[p.clone(), end]) {
                return if winding == 0 { Location::Outside } else { Location::Inside };
            }
        }
    }

    /// How often the segment, which ends outside, leaves more than it enters; `None` where it meets
    /// an edge or a corner or runs in a face.
    fn winding_along(&self, segment: &[Q3; 2]) -> Option<i32> {
        let around = enclosure(&segment[0], &segment[1]);
        let mut winding = 0;
        for (region, one) in self.regions.iter().zip(&self.boxes) {
            // A face without area bounds nothing; its neighbours notice a ray through it.
            if !region.has_area() || !one.overlaps(&around) {
                continue;
            }
            match piercing(segment, &region.corners) {
                (Piercing::Miss, _) => {}
                (
                    Piercing::Point {
                        on_segment: SegmentFeature::Interior,
                        on_triangle: TriangleFeature::Interior,
                    },
                    direction,
                ) => winding += if direction == Ordering::Greater { 1 } else { -1 },
                _ => return None,
            }
        }
        Some(winding)
    }
}

/// A box of `f64` that surely holds the segment between two rational points.
fn enclosure(p: &Q3, q: &Q3) -> Aabb {
    let rounded = |p: &Q3| {
        let [x, y, z] = p.xyz.each_ref().map(|x| x.to_f64().value());
        DVec3::new(x, y, z)
    };
    let around = Aabb::of_points([rounded(p), rounded(q)]);
    around.grown(0.0) // an ulp outward: the rounding to nearest was less
}

fn is_closed(mesh: &Mesh) -> bool {
    // Adding zero makes −0 and 0 one place.
    let key = |p: DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let place: Vec<[u64; 3]> = mesh.vertices().iter().map(|&p| key(p)).collect();
    let mut balance: HashMap<[[u64; 3]; 2], i64> = HashMap::new();
    for face in mesh.faces() {
        for corner in 0..3 {
            let [p, q] = [face[corner], face[(corner + 1) % 3]].map(|i| place[i as usize]);
            *balance.entry([p.min(q), p.max(q)]).or_default() += if p < q { 1 } else { -1 };
        }
    }
    balance.iter().all(|(edge, &count)| count == 0 || edge[0] == edge[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        Mesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
    }

    fn located(mesh: &Mesh, p: [f64; 3]) -> Location {
        PosedMesh::new(mesh, &Pose::IDENTITY).locate(&Q3::exactly(DVec3::from_array(p)))
    }

    #[test]
    fn points_beside_a_slanted_face_are_told_apart_by_an_ulp() {
        let mesh = tetrahedron();
        assert_eq!(located(&mesh, [0.25, 0.25, 0.5]), Location::On);
        assert_eq!(located(&mesh, [0.25, 0.25, 0.5f64.next_down()]), Location::Inside);
        assert_eq!(located(&mesh, [0.25, 0.25, 0.5f64.next_up()]), Location::Outside);
        assert_eq!(located(&mesh, [0.0, 0.0, 0.5]), Location::On); // on an edge
        assert_eq!(located(&mesh, [-1.0, 0.0, 0.0]), Location::Outside); // +x runs along an edge
        assert_eq!(located(&mesh, [9.0, 0.0, 0.0]), Location::Outside);
    }

    #[test]
    fn an_open_mesh_has_no_inside() {
        let faces = tetrahedron().faces()[..3].to_vec();
        let open = Mesh::new(tetrahedron().vertices().to_vec(), faces).unwrap();
        assert!(!PosedMesh::new(&open, &Pose::IDENTITY).is_closed());
        assert_eq!(located(&open, [0.125; 3]), Location::Outside);
    }

    #[test]
    fn a_mesh_whose_faces_share_no_vertices_is_closed_by_position() {
        let solid = tetrahedron();
        let soup = (0..4).flat_map(|f| solid.triangle(cranny_geometry::FaceId(f))).collect();
        let faces = (0..4).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let mesh = Mesh::new(soup, faces).unwrap();
        assert_eq!(located(&mesh, [0.125; 3]), Location::Inside);
    }
}
