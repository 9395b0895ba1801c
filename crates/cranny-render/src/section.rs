//! A plane that cuts bodies open, and what of a mesh lies in it.
//!
//! `Renderer::draw_cut_faces` draws the faces, by `shaders/section.wgsl`.

use cranny_exact::{DVec3, Pose};

use crate::camera::Camera;
use crate::draw_list::Instance;
use crate::mesh::DrawMesh;

/// How much of a plane is seen, in distances from the eye to where it looks. Smaller: planes that
/// are seen at a slant end within the picture; larger: depths on the plane round.
const SEEN: f64 = 12.0;

/// A plane that takes away all in front of it of those instances that are [cut](Instance::cut).
///
/// Cut faces of closed bodies are filled and hatched, each body in a direction of its own; where
/// two cut bodies share space, the face has [the colour of overlaps](Self::overlap). Of a mesh that
/// is not closed the inside shows. The faces are counted out by the graphics adapter, pixel by
/// pixel, from the triangles as they are drawn: no hole appears, however many loops a cut face has.
/// A camera behind the plane sees bodies whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// A point of the plane.
    pub point: DVec3,
    /// Towards what is taken away; unit.
    pub normal: DVec3,
    /// Of what two cut bodies share.
    pub overlap: crate::Color,
}

impl Section {
    /// A plane through a point, seen from where `normal` points; `None` where that has no
    /// direction.
    #[must_use]
    pub fn through(point: DVec3, normal: DVec3, overlap: crate::Color) -> Option<Self> {
        let normal = normal.try_normalize()?;
        point.is_finite().then_some(Self { point, normal, overlap })
    }

    /// How far in front of the plane a point lies; above 0, it is taken away with what is cut.
    #[must_use]
    pub fn before(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }

    /// Whether the camera is in front of the plane, from where the cut faces are seen.
    #[must_use]
    pub fn faces(&self, camera: &Camera) -> bool {
        self.before(camera.eye()) > 0.0
    }

    /// Whether the plane passes through the ball about a mesh at a pose: its centre's place on the
    /// plane, and the ball's radius there.
    pub(crate) fn disc(&self, mesh: &DrawMesh, pose: &Pose) -> Option<(DVec3, f64)> {
        let center = pose.world_from_body().apply(mesh.center());
        let radius = mesh.radius() * 3.0f64.sqrt();
        let away = self.before(center);
        let there = (radius * radius - away * away).sqrt();
        (away.abs() < radius).then_some((center - away * self.normal, there))
    }

    /// A square in the plane that covers what the camera sees of it as far as `reach` from where it
    /// looks: its centre, and half its sides. All cut faces are drawn on this one square, so that
    /// where two bodies share space neither is nearer.
    pub(crate) fn square(&self, camera: &Camera, reach: f64) -> [DVec3; 3] {
        let center = camera.target() - self.before(camera.target()) * self.normal;
        let u = self.normal.any_orthonormal_vector();
        let half = reach.min(SEEN * camera.distance());
        [center, half * u, half * self.normal.cross(u)]
    }

    /// The segments in which the plane cuts an instance's faces, in world coordinates.
    pub(crate) fn segments<'a>(
        &'a self,
        instance: &'a Instance,
    ) -> impl Iterator<Item = [DVec3; 2]> + 'a {
        let world_from_body = instance.pose.world_from_body();
        let placed = instance.mesh.triangles();
        let placed = placed.map(move |corners| corners.map(|p| world_from_body.apply(p)));
        placed.filter_map(|corners| self.cut(corners))
    }

    fn cut(&self, corners: [DVec3; 3]) -> Option<[DVec3; 2]> {
        let before = corners.map(|p| self.before(p));
        let mut ends = [None; 2];
        let mut found = 0;
        for i in 0..3 {
            let j = (i + 1) % 3;
            if (before[i] > 0.0) != (before[j] > 0.0) && found < 2 {
                let t = before[i] / (before[i] - before[j]);
                ends[found] = Some(corners[i] + t * (corners[j] - corners[i]));
                found += 1;
            }
        }
        Some([ends[0]?, ends[1]?])
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::color::Color;

    #[test]
    fn a_triangle_is_cut_where_the_plane_passes() {
        let corners = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.0)];
        let mesh = Arc::new(DrawMesh::new(&corners, &[[0, 1, 2]]).unwrap());
        let instance = Instance::solid(mesh, Pose::IDENTITY, Color::WHITE);
        let section = Section::through(DVec3::X, 3.0 * DVec3::X, Color::BLACK).unwrap();
        let cut: Vec<_> = section.segments(&instance).collect();
        assert_eq!(cut.len(), 1);
        for end in cut[0] {
            assert!((end.x - 1.0).abs() < 1e-6 && (end.y * (end.y - 1.0)).abs() < 1e-6, "{end}");
        }
        let beside = Section::through(3.0 * DVec3::X, DVec3::X, Color::BLACK).unwrap();
        assert_eq!(beside.segments(&instance).count(), 0);
        assert!(beside.disc(&instance.mesh, &instance.pose).is_none());
        let (center, radius) = section.disc(&instance.mesh, &instance.pose).unwrap();
        assert!((center - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-6 && radius > 1.0);
        let camera = Camera::look_at(DVec3::new(9.0, 1.0, 2.0), DVec3::ZERO).unwrap();
        let [center, u, v] = section.square(&camera, 5.0);
        assert!((center - DVec3::X).length() < 1e-9 && u.dot(v).abs() < 1e-9 && u.x.abs() < 1e-9);
        assert!((u.length() - 5.0).abs() < 1e-9);
    }

    #[test]
    fn a_plane_needs_a_direction() {
        assert!(Section::through(DVec3::ZERO, DVec3::ZERO, Color::BLACK).is_none());
        assert!(Section::through(DVec3::NAN, DVec3::X, Color::BLACK).is_none());
    }
}
