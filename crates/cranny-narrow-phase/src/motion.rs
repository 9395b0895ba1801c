//! How far a body can have moved, seen from the other, between two poses of a pair.
//!
//! What counts is the step `(M₁ − M₀) x + (t₁ − t₀)` of a point `x` of the second body, in the
//! first's frame; no angle is taken out of it. For points within `r` of `c` it is at most the step
//! of `c` plus `‖M₁ − M₀‖ r`, and the difference of two rotations stretches by its Frobenius norm
//! over √2: it is a half turn's share of a rotation in one plane and nothing along the third axis.
//!
//! Either body may be thought to move. A point of the first steps, seen from the second, as far as
//! the point of the second's frame that is where it is: so the bound of whichever ball is smaller,
//! or nearer to the axis, holds.

use cranny_exact::{Aabb, DMat3, DVec3, RigidMap};
use cranny_geometry::Model;

use crate::pair::{Pair, Side, length_error};

/// By how much the Frobenius norm of a difference of two accepted rotation matrices may exceed that
/// of the rotations which they round. Smaller, and a step could be underestimated; larger, and
/// bodies that move by less than that spend slack for nothing.
pub(crate) const MATRIX_ERROR: f64 = 128.0 * f64::EPSILON;

/// What lies within a distance of a point of a body's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
}

impl Ball {
    /// Around a box; its roundings are part of the step's error.
    pub(crate) fn around(bounds: &Aabb) -> Self {
        Self { center: bounds.center(), radius: 0.5 * bounds.diagonal() }
    }
}

/// How the bodies of a pair have moved relative to each other, between two relative poses.
///
/// All its bounds include the rounding of both poses.
#[derive(Clone, Copy, Debug)]
pub struct RelativeMotion {
    turn: DMat3,
    shift: DVec3,
    stretch: f64,
    second_from_first: RigidMap,
    error: f64,
}

impl RelativeMotion {
    /// From the relative pose `before` (first_from_second) to that of the pair; `None` where they
    /// are equal.
    #[must_use]
    pub fn since(before: &RigidMap, pair: &Pair) -> Option<Self> {
        let now = pair.first_from_second;
        (*before != now).then(|| Self::between(before, &now, pair.culling_error()))
    }

    /// From one relative pose to another, `posing` being by how much posed points round.
    fn between(before: &RigidMap, now: &RigidMap, posing: f64) -> Self {
        let turn = now.linear - before.linear;
        let columns = [turn.x_axis, turn.y_axis, turn.z_axis];
        let frobenius = columns.map(DVec3::length_squared).iter().sum::<f64>().sqrt();
        let reach = before.translation.length() + now.translation.length();
        Self {
            turn,
            shift: now.translation - before.translation,
            stretch: frobenius * 0.5f64.sqrt() + MATRIX_ERROR,
            second_from_first: now.inverse(),
            // Both poses round; so do matrices, which then are no more than nearly rigid.
            error: 2.0 * posing + MATRIX_ERROR * reach,
        }
    }

    /// By how much a unit direction of one body has turned at most, seen from the other.
    pub(crate) fn stretch(&self) -> f64 {
        self.stretch
    }

    /// A bound of the ratio between the way of a point on the screw that joins the poses and the
    /// distance between the ends of that way; `None` for turns of more than 60 degrees.
    ///
    /// An arc of angle θ is longer than its chord by (θ/2) / sin(θ/2), and `stretch` is 2 sin(θ/2):
    /// the factor is below 1 + stretch² / 16 up to a stretch of 1 (a turn of 60 degrees), doubled
    /// here.
    #[must_use]
    pub fn arc_over_chord(&self) -> Option<f64> {
        (self.stretch <= 1.0).then_some(1.0 + 0.125 * self.stretch * self.stretch)
    }

    /// No point of a ball of one body has gone farther than this, seen from the other body.
    pub(crate) fn step_of(&self, side: Side, ball: &Ball) -> f64 {
        let center = match side {
            Side::First => self.second_from_first.apply(ball.center),
            Side::Second => ball.center,
        };
        (self.turn * center + self.shift).length() + self.stretch * ball.radius + self.error
    }

    /// No distance between a point of the one model and a point of the other has changed by more
    /// than this. `models`: the first and the second of the pair.
    #[must_use]
    pub fn step(&self, models: [&Model; 2]) -> f64 {
        let balls = models.map(|model| Ball::around(&model.bounds()));
        self.step_of(Side::First, &balls[0]).min(self.step_of(Side::Second, &balls[1]))
    }
}

/// A bound of how much the distance of any point of the first model from any point of the second
/// can have changed between two poses of the second in the first's frame; 0 where they are the
/// same.
///
/// Both poses are [accepted](cranny_exact::Pose::accepted). The bound is taken from the pair of
/// poses, so it does not grow with the number of steps between them.
#[must_use]
pub fn drift(models: [&Model; 2], before: &RigidMap, now: &RigidMap) -> f64 {
    if before == now {
        return 0.0;
    }
    let posing = 2.0 * length_error(models, before).max(length_error(models, now));
    RelativeMotion::between(before, now, posing).step(models)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::BuildOptions;
    use cranny_shapes::{Cuboid, LPrism, Shape};
    use cranny_testkit::Rng;

    fn built(shape: impl Into<Shape>) -> Model {
        Model::build(shape.into().build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    /// Distances of vertices change by no more than the bound, and by a good part of it.
    #[test]
    fn no_distance_changes_by_more_than_the_drift() {
        let (long, bent) = (built(Cuboid { size: [3.0, 0.5, 0.5] }), built(LPrism::default()));
        let mut rng = Rng::new(5);
        let mut vector = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
        let mut nearest = 0.0f64;
        for round in 0..300 {
            let (way, turn) = [(1e-3, 0.0), (0.0, 1e-3), (1e-3, 1e-3)][round % 3];
            let before =
                Pose { rotation: DQuat::from_scaled_axis(vector()), translation: vector() };
            let now = Pose {
                rotation: DQuat::from_scaled_axis(turn * vector()) * before.rotation,
                translation: before.translation + way * vector(),
            };
            let (before, now) = (before.world_from_body(), now.world_from_body());
            let bound = drift([&long, &bent], &before, &now);
            let vertices = bent.mesh().vertices().iter();
            let pairs = vertices.flat_map(|q| long.mesh().vertices().iter().map(move |p| (p, q)));
            let changed = |(p, q): (&DVec3, &DVec3)| {
                ((now.apply(*q) - *p).length() - (before.apply(*q) - *p).length()).abs()
            };
            let most = pairs.map(changed).fold(0.0, f64::max);
            assert!(most <= bound, "round {round}: {most} beyond {bound}");
            nearest = nearest.max(most / bound);
        }
        assert!(nearest > 0.5, "{nearest}");
        assert_eq!(drift([&long, &bent], &RigidMap::IDENTITY, &RigidMap::IDENTITY), 0.0);
    }
}
