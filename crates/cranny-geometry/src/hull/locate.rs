//! Where a point lies with respect to a hull: exact.

use cranny_exact::{Aabb, DVec3, Sign};

use super::side::Side;
use super::span::{Projection, collinear};
use super::{ConvexHull, HullKind};

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

impl ConvexHull {
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
        let Some(projection) = Projection::of_plane(first) else { return false };
        if !cranny_exact::orient3d(a, b, c, point).is_zero() {
            return false;
        }
        front_side.iter().any(|triangle| {
            let [a, b, c] = triangle.map(|v| self.positions[v as usize]);
            let front = projection.turn(a, b, c);
            [(a, b), (b, c), (c, a)].into_iter().all(|(from, to)| {
                let turn = projection.turn(from, to, point);
                turn.is_zero() || turn == front
            })
        })
    }
}
