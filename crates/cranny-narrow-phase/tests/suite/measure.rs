//! Distances of points from meshes, measured here in a way of our own.

use cranny_exact::DVec3;
use cranny_narrow_phase::Placed;

/// A placed mesh in world coordinates.
pub(crate) fn world_triangles(placed: Placed) -> Vec<[DVec3; 3]> {
    let map = placed.pose.world_from_body();
    let corner = |i: u32| map.apply(placed.model.mesh().vertices()[i as usize]);
    placed.model.mesh().faces().iter().map(|f| f.map(corner)).collect()
}

/// How far a point is from a segment.
fn from_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let t = along.dot(p - a) / along.length_squared();
    (p - (a + along * t.clamp(0.0, 1.0))).length()
}

/// How far a point is from a triangle: from its plane where it stands over the inside, else from the
/// nearest side.
fn from_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize();
    let over = |u: DVec3, v: DVec3| normal.dot((v - u).cross(p - u)) >= 0.0;
    if over(a, b) && over(b, c) && over(c, a) {
        return normal.dot(p - a).abs();
    }
    from_segment(p, a, b).min(from_segment(p, b, c)).min(from_segment(p, c, a))
}

/// How far a point is from a surface.
pub(crate) fn from_surface(p: DVec3, triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|&t| from_triangle(p, t)).fold(f64::INFINITY, f64::min)
}
