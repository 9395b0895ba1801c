//! What concavities are made of, and how parts of it are measured.

use cranny_exact::DVec3;
use cranny_geometry::hull::ConvexHull;
use cranny_geometry::{FaceId, Mesh, Model, Topology};

use super::Measures;
use crate::caps::CapSurface;
use crate::features::Features;

/// A model, its features, and where volumes are measured from.
pub(super) struct Input<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) topology: &'a Topology,
    pub(super) hull: &'a ConvexHull,
    pub(super) features: &'a Features,
    /// Volumes are measured from here: the less, the less they round.
    pub(super) center: DVec3,
}

impl<'a> Input<'a> {
    pub(super) fn of(model: &'a Model, features: &'a Features) -> Self {
        let (mesh, topology, hull) = (model.mesh(), model.topology(), model.hull());
        Self { mesh, topology, hull, features, center: hull.bounds().center() }
    }

    pub(super) fn position(&self, vertex: u32) -> DVec3 {
        self.mesh.vertices()[vertex as usize]
    }

    pub(super) fn cap_triangle(&self, caps: &CapSurface, cap: usize) -> [DVec3; 3] {
        caps.triangles[cap].map(|v| self.position(v))
    }

    /// What faces alone add to the measures of their concavity, in their order.
    pub(super) fn measures_of(&self, faces: &[FaceId]) -> Measures {
        let mut measures = Measures::default();
        for &face in faces {
            let corners = self.mesh.triangle(face);
            measures.face_area += 0.5 * twice_area_vector(corners).length();
            measures.pocket_volume -= self.volume_below(corners);
        }
        measures
    }

    /// Signed volume between a triangle and the centre.
    pub(super) fn volume_below(&self, corners: [DVec3; 3]) -> f64 {
        let [a, b, c] = corners.map(|p| p - self.center);
        a.dot(b.cross(c)) / 6.0
    }
}

pub(super) fn twice_area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}
