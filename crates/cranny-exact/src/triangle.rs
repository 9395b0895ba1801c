//! Do two triangles meet, and how: exact in every case, degenerate ones included.
//!
//! Everything here is decided by signs of [`orient3d`](crate::orient3d) and
//! [`orient2d`](crate::orient2d) and by comparing coordinates. No point is constructed and no
//! epsilon is read, so the answers do not depend on the order of the arguments or of their corners,
//! nor on the unit of length. Coordinates must lie inside the [`domain`](crate::domain).

mod pair;
mod piercing;
mod planar;
mod plane;

pub use pair::{Crossing, CrossingEnd, classify_triangles, cross_triangles, judge_triangles};
pub use piercing::{
    Piercing, SegmentFeature, TriangleFeature, classify_segment_triangle, locate_piercing,
};

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

impl Meeting {
    /// Whether they share a point at all.
    #[must_use]
    pub fn meets(self) -> bool {
        self != Self::None
    }
}
