//! How far one body's hull comes in the directions of the other's frame.
//!
//! Source: support points by hill climbing; see
//! [`ConvexHull::support`](cranny_geometry::hull::ConvexHull::support), which states their cost.

use std::cell::Cell;

use cranny_exact::DVec3;

use super::PosedModels;
use crate::envelope::Probe;

/// The hull of a body (`guest`: 0 or 1), seen from the other.
pub(super) fn hull_of_guest<'a>(
    pair: &PosedModels<'a>,
    guest: usize,
) -> Probe<impl Fn(DVec3) -> f64 + use<'a>> {
    let (hull, host_from_guest) = (pair.models[guest].hull(), pair.map_to(1 - guest));
    let error = pair.error;
    // Where the last climb ended.
    let last = Cell::new(None);
    let least = move |direction: DVec3| {
        let seen = host_from_guest.linear.transpose() * direction;
        let top = hull.support(-seen, last.get());
        last.set(top);
        // A body has faces, so its hull has vertices.
        top.map_or(f64::NEG_INFINITY, |top| {
            let place = host_from_guest.apply(hull.position(top));
            (direction.dot(place) - error).next_down()
        })
    };
    Probe::new(least, 0.0)
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
                let (hull, host) = (hull_of_guest(&pair, guest), pair.map_to(1 - guest));
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
