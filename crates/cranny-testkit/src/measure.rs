//! Distances of points from meshes, in a way that the product does not share.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Model;

/// The faces of a model at a pose, in world coordinates.
#[must_use]
pub fn world_triangles(model: &Model, pose: &Pose) -> Vec<[DVec3; 3]> {
    let map = pose.world_from_body();
    let corner = |i: u32| map.apply(model.mesh().vertices()[i as usize]);
    model.mesh().faces().iter().map(|f| f.map(corner)).collect()
}

/// The distance of a point from a surface; infinite if it has no triangles.
#[must_use]
pub fn from_surface(p: DVec3, triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|&t| from_triangle(p, t)).fold(f64::INFINITY, f64::min)
}

/// The distance from the plane where the point stands over the inside, else from the nearest side.
fn from_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize();
    let over = |u: DVec3, v: DVec3| normal.dot((v - u).cross(p - u)) >= 0.0;
    if over(a, b) && over(b, c) && over(c, a) {
        return normal.dot(p - a).abs();
    }
    from_segment(p, a, b).min(from_segment(p, b, c)).min(from_segment(p, c, a))
}

fn from_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let t = along.dot(p - a) / along.length_squared();
    (p - (a + along * t.clamp(0.0, 1.0))).length()
}
