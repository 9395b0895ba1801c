//! How far vertices are from the origin of the body's frame.

use cranny_exact::DVec3;

/// The square of the distance of the farthest of some points.
pub(crate) fn farthest(points: &[DVec3]) -> f64 {
    points.iter().map(|p| p.length_squared()).fold(0.0, f64::max)
}

/// No point is farther than this, whose distance squared is at most `farthest`. The root of a
/// larger number is no smaller: one root, of the largest, is the largest root.
pub(crate) fn radius(farthest: f64) -> f64 {
    farthest.sqrt().next_up()
}
