//! How far one body's hull comes in the directions of the other's frame.
//!
//! Source: support points by hill climbing; see
//! [`ConvexHull::support`](cranny_geometry::hull::ConvexHull::support), which states their cost.

use std::cell::Cell;

use cranny_exact::{DVec3, RigidMap};
use cranny_geometry::hull::{ConvexHull, HullVertexId};

use super::PosedModels;
use crate::envelope::Thing;

/// The hull of one body, seen from the other.
pub(super) struct HullExtent<'a> {
    hull: &'a ConvexHull,
    host_from_guest: RigidMap,
    error: f64,
    /// Where the last climb ended.
    top: Cell<Option<HullVertexId>>,
}

impl<'a> HullExtent<'a> {
    /// `guest`: the body, 0 or 1.
    pub(super) fn of(pair: &PosedModels<'a>, guest: usize) -> Self {
        Self {
            hull: pair.models[guest].hull(),
            host_from_guest: pair.map_to(1 - guest),
            error: pair.error,
            top: Cell::default(),
        }
    }

    /// At most the least of `direction · x` over the points x of the hull, in the host's frame.
    fn least(&self, direction: DVec3) -> f64 {
        let seen = self.host_from_guest.linear.transpose() * direction;
        let top = self.hull.support(-seen, self.top.get());
        self.top.set(top);
        // A body has faces, so its hull has vertices.
        top.map_or(f64::NEG_INFINITY, |top| {
            let place = self.host_from_guest.apply(self.hull.position(top));
            (direction.dot(place) - self.error).next_down()
        })
    }

    pub(super) fn thing(&self) -> Thing<impl Fn(DVec3) -> f64> {
        Thing::new(|direction| self.least(direction), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Model, VertexId};
    use cranny_shapes::Torus;

    #[test]
    fn no_vertex_comes_farther_than_the_extent_says_nor_the_extent_much_farther() {
        let torus = Torus { major_segments: 14, minor_segments: 6, ..Torus::default() };
        let (model, _) = Model::build(torus.build().unwrap(), &BuildOptions::default()).unwrap();
        for k in 0..60 {
            let t = f64::from(k);
            let axis = DVec3::new(t.sin(), t.cos(), 0.3 * t).normalize();
            let rotation = DQuat::from_axis_angle(axis, 0.7 * t);
            let pose = Pose { rotation, translation: DVec3::new(t, -3.0, 0.1 * t) };
            let size = pose.translation.length() + 2.0 * model.radius();
            let pair = PosedModels {
                models: [&model; 2],
                first_from_second: pose.world_from_body(),
                error: 128.0 * f64::EPSILON * size,
            };
            for guest in [0, 1] {
                let (hull, host) = (HullExtent::of(&pair, guest), pair.map_to(1 - guest));
                for direction in [DVec3::X, -DVec3::Y, axis, DVec3::new(0.6, 0.0, -0.8)] {
                    let count = model.mesh().vertices().len() as u32;
                    let height = |v| direction.dot(host.apply(model.mesh().position(VertexId(v))));
                    let least = (0..count).map(height).fold(f64::INFINITY, f64::min);
                    let found = hull.least(direction);
                    // With room for what rounds differently elsewhere.
                    let room = 0.5 * pair.error;
                    assert!(found <= least - room, "{k} {guest}: {found} of {least}");
                    assert!(found >= least - 3.0 * pair.error, "{k} {guest}: {found}");
                }
            }
        }
    }
}
