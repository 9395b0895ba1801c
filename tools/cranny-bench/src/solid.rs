//! The solids that preparation is measured on.

use cranny_geometry::Mesh;
use cranny_shapes::{GolfBall, IsoBolt, ShapeError, Torus};

/// A golf ball of about so many triangles, with as many dimples as it is fine enough for, up
/// to 336.
pub(crate) fn golf_ball(triangles: u32) -> Result<Mesh, ShapeError> {
    let dimples = if triangles >= 10_000 { 336 } else { 36 };
    GolfBall { triangles, dimples, ..GolfBall::default() }.build()
}

/// A torus of about ten thousand triangles.
pub(crate) fn torus() -> Result<Mesh, ShapeError> {
    Torus { major_segments: 144, minor_segments: 36, ..Torus::default() }.build()
}

/// An M16 bolt of about 28,000 triangles.
pub(crate) fn bolt() -> Result<Mesh, ShapeError> {
    IsoBolt::default().build()
}
