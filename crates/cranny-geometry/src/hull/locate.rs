//! Where a point lies with respect to a hull: exact.
//!
//! Source: the walk is that of Devillers, Pion and Teillaud (2002, "Walking in a triangulation").
//! To look at all triangles needs none: a point lies in a convex body where no triangle has it
//! above. Cost: O(n) for that, and for a walk the triangles that it passes.

use cranny_exact::{Aabb, DVec3, Sign, orient3d};

use super::side::Side;
use super::span::axis_of_plane;
use super::{ConvexHull, HullKind};
use crate::projection::{collinear, turn};

/// Where a point lies with respect to a hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Location {
    /// In the interior. Only a hull of kind [`HullKind::Volume`] has one.
    Inside,
    /// On the surface; or in a hull that has no interior.
    On,
    /// Not in the hull.
    Outside,
}

/// Where a walk over a hull has found a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Found {
    pub(crate) location: Location,
    /// The triangle through which the ray from the inner point to this one leaves: if it lies on
    /// the hull, there.
    pub(crate) triangle: u32,
    /// Number of triangles that the walk came to.
    pub(crate) passed: usize,
}

impl ConvexHull {
    /// A point certainly in the interior, if one is found. O(n).
    pub(crate) fn inner_point(&self) -> Option<DVec3> {
        self.centroid().filter(|&middle| self.locate(middle) == Location::Inside)
    }

    /// [`locate`](Self::locate) for a hull with an interior, given a point in it: a walk from
    /// triangle `start` towards the one through which the ray from there to the point leaves
    /// (Devillers, Pion and Teillaud 2002, "Walking in a triangulation"). `None` where it runs into
    /// itself.
    ///
    /// Cost: the triangles on the way; on smooth hulls about the root of their number, from
    /// anywhere.
    pub(crate) fn locate_from(&self, inside: DVec3, point: DVec3, start: u32) -> Option<Found> {
        let at = |v: u32| self.positions[v as usize];
        let lies_beyond = |h: u32| {
            let [a, b] = self.surface.ends(h).map(at);
            orient3d(inside, a, b, point) == Sign::Negative
        };
        let (triangle, passed) = self.surface.walk(start, lies_beyond)?;
        let [a, b, c] = self.surface.triangles[triangle as usize].map(at);
        let location = match orient3d(a, b, c, point) {
            Sign::Positive => Location::Outside,
            Sign::Zero => Location::On,
            Sign::Negative => Location::Inside,
        };
        Some(Found { location, triangle, passed })
    }

    /// Where a point lies: decided by exact signs. A point with a coordinate outside the
    /// [`domain`](cranny_exact::domain) by being `NaN` or infinite is `Outside`; others outside it
    /// may get a wrong answer. Looks at every triangle unless one has the point above it: O(n).
    #[must_use]
    pub fn locate(&self, point: DVec3) -> Location {
        let bounds = self.bounds();
        if !bounds.contains_point(point) {
            return Location::Outside;
        }
        let inside = match self.kind {
            HullKind::Empty => false,
            HullKind::Point => true, // the box is the point
            HullKind::Segment => collinear(self.positions[0], self.positions[1], point),
            HullKind::Polygon => self.plate_holds(point),
            HullKind::Volume => return self.locate_in_volume(&bounds, point),
        };
        if inside { Location::On } else { Location::Outside }
    }

    /// Whether the closed hull holds a point: [`locate`](Self::locate) is not `Outside`.
    #[must_use]
    pub fn contains_point(&self, point: DVec3) -> bool {
        self.locate(point) != Location::Outside
    }

    fn locate_in_volume(&self, bounds: &Aabb, point: DVec3) -> Location {
        let extent = bounds.max - bounds.min;
        let mut location = Location::Inside;
        for triangle in &self.surface.triangles {
            let corners = triangle.map(|v| self.positions[v as usize]);
            let side = Side::new(corners, extent);
            match side.sign(side.height(point), point, || corners) {
                Sign::Positive => return Location::Outside,
                Sign::Zero => location = Location::On,
                Sign::Negative => {}
            }
        }
        location
    }

    /// For points of the plane, under a projection that is one to one on it.
    fn plate_holds(&self, point: DVec3) -> bool {
        let front_side = &self.surface.triangles[..self.triangle_count() / 2];
        let first = front_side[0].map(|v| self.positions[v as usize]);
        let [a, b, c] = first;
        let Some(axis) = axis_of_plane(first) else { return false };
        if !orient3d(a, b, c, point).is_zero() {
            return false;
        }
        front_side.iter().any(|triangle| {
            let [a, b, c] = triangle.map(|v| self.positions[v as usize]);
            let front = turn(axis, a, b, c);
            [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
                let side = turn(axis, from, to, point);
                side.is_zero() || side == front
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_walk_from_anywhere_finds_what_looking_at_every_triangle_finds() {
        // Corners, middles of sides and edges, and points around them, of a grid's hull with a
        // bump.
        let steps = [-1.0, -0.5, 0.0, 0.5, 1.0];
        let grid = || {
            let pairs = steps.into_iter().flat_map(|x| steps.map(|y| (x, y)));
            pairs.flat_map(|(x, y)| steps.map(|z| DVec3::new(x, y, z)))
        };
        let points: Vec<DVec3> = grid().chain([DVec3::new(0.3, 0.4, 1.25)]).collect();
        let hull = ConvexHull::of_points(&points);
        let inside = hull.inner_point().unwrap();
        let mut count = [0; 3];
        for p in grid().chain(grid().map(|p| 1.0625 * p)).chain([inside, points[125]]) {
            let expected = hull.locate(p);
            count[expected as usize] += 1;
            for start in 0..hull.triangle_count() as u32 {
                let found = hull.locate_from(inside, p, start).unwrap();
                assert_eq!(found.location, expected, "{p} from {start}");
                if expected == Location::On {
                    let corners = hull.corners(found.triangle as usize);
                    let is_corner = hull.positions().contains(&p);
                    assert_eq!(corners.contains(&p), is_corner, "{p} from {start}");
                }
            }
        }
        assert!(count.into_iter().all(|n| n > 20), "{count:?}");
    }

    #[test]
    fn a_flat_hull_has_no_inner_point() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
        assert_eq!(ConvexHull::of_points(&square).inner_point(), None);
        assert_eq!(ConvexHull::of_points(&square[..1]).inner_point(), None);
    }
}
