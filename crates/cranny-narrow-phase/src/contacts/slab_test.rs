//! A lower bound of the gap between two groups of faces that lie along each other.
//!
//! Each group lies beneath a plane ([`Slab`]): n · x <= h for the first, m · y <= g for the second, in
//! the first's frame. Along n, then, the second's points are higher than the first's by at least
//! n · y − h = (n + m) · y − m · y − h >= (n + m) · y − g − h, and n + m nearly vanishes where the
//! planes face each other: the box of the second, thick as it is, bounds what is left. Likewise
//! along m.

use cranny_exact::{Aabb, DMat3, DVec3};
use cranny_geometry::Slab;

use crate::pair::Pair;

/// The test of a pair, with what it needs precomputed.
pub(super) struct SlabTest {
    rotation: DMat3,
    inverse: DMat3,
    translation: DVec3,
    error: f64,
}

impl SlabTest {
    pub(super) fn of(pair: &Pair) -> Self {
        let map = pair.first_from_second;
        Self {
            rotation: map.linear,
            inverse: map.linear.transpose(),
            translation: map.translation,
            error: pair.culling_error(),
        }
    }

    /// No point beneath the one slab and in its box is nearer than this to one of the other's; below 0
    /// where nothing is known. Slabs and boxes are in the bodies' own frames, the first body's first.
    pub(super) fn separation_lower(&self, slabs: [&Slab; 2], boxes: [&Aabb; 2]) -> f64 {
        let (n, m) = (slabs[0].normal, self.rotation * slabs[1].normal);
        let left = n + m;
        let heights = slabs[0].height + slabs[1].height;
        let least = |direction: DVec3, b: &Aabb| {
            direction.dot(b.center()) - direction.abs().dot(b.half_extents())
        };
        let along_first = n.dot(self.translation) + least(self.inverse * left, boxes[1]);
        let along_second = least(left, boxes[0]) - m.dot(self.translation);
        along_first.max(along_second) - heights - self.error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::PairMemory;
    use crate::query::Placed;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model};

    /// A triangle that rises by 1 along x, looking up.
    fn slope() -> Model {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]].map(DVec3::from_array);
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        Model::build(mesh, &BuildOptions::default()).unwrap().0
    }

    #[test]
    fn slopes_that_face_each_other_are_as_far_apart_as_their_planes() {
        let slope = slope();
        // Half a turn about the level direction across the slope that faces it back, then lifted.
        let axis = DVec3::new(1.0, 0.0, 1.0).normalize();
        let rotation = DQuat::from_axis_angle(axis, std::f64::consts::PI);
        for lift in [0.001, 0.5] {
            let up = DVec3::new(-0.5f64.sqrt(), 0.0, 0.5f64.sqrt()) * lift;
            let (a, b) = (
                Placed { model: &slope, pose: Pose::IDENTITY },
                Placed { model: &slope, pose: Pose { rotation, translation: up } },
            );
            let mut memory = PairMemory::default();
            let pair = Pair::new(a, b, &mut memory.posed);
            let slab = slope.patches().slab(0);
            let bounds = slope.bounds();
            let found = SlabTest::of(&pair).separation_lower([slab, slab], [&bounds, &bounds]);
            assert!(found <= lift && found > lift - 1e-13, "{found} for {lift}");
        }
    }
}
