//! Points seen along a coordinate axis: a coordinate is left out, so nothing is rounded.
//!
//! No source: signs of the components of a cross product. Cost: O(1).

use cranny_exact::{DVec2, DVec3, Sign, orient2d};

/// A point seen along an axis. The handedness of the other two is kept.
pub(crate) fn seen_along(axis: usize, p: DVec3) -> DVec2 {
    DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3])
}

/// Which way three points turn, seen along an axis: exact.
pub(crate) fn turn(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> Sign {
    orient2d(seen_along(axis, a), seen_along(axis, b), seen_along(axis, c))
}

/// Whether three points lie on a line: exact, since the three projected areas are the components of
/// the cross product.
pub(crate) fn collinear(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (0..3).all(|axis| turn(axis, a, b, c).is_zero())
}
