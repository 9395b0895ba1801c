//! How a body moves during a step: rotation at constant rate about a point of the body that itself
//! moves on a straight line.
//!
//! For `t` from 0 to 1 the body's rotation is `exp(t · turn) · start.rotation`, and its pivot, a
//! point fixed in the body, is at `start(pivot) + t · travel`. That is what a solver means by
//! constant linear and angular velocity (pivot: centre of mass), and with a pivot on the axis and
//! a travel along it, it is a screw. A point of the body at distance `r` from the axis runs with
//! acceleration `|turn|² r`, so over a piece of length `d` it leaves its chord by at most
//! `|turn|² r d² / 8`; nothing else is needed to bound the motion, hence no sine and no cosine.

use cranny_exact::{DMat3, DVec3, Pose, check_point};
use cranny_geometry::Model;

use crate::impact::ImpactError;
use crate::rotation::{rotation_of, turn_of, unit};

/// The largest turn in one motion: some 10,000 revolutions. Rounding grows with it, by 1e-14 a
/// radian. A larger turn in one step is taken for a wrong unit.
pub const MAX_TURN: f64 = 65_536.0;

/// Deviation of a quaternion's squared length from 1 that is accepted, as by
/// [`query`](cranny_narrow_phase::query()): smaller, and rotations from an f32 engine are refused;
/// larger, and a scaled body passes. The rotation is used at length 1.
const UNIT_SLACK: f64 = 1e-5;

/// A rigid motion over the time from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Where the body is at time 0: world_from_body.
    pub start: Pose,
    /// The point that travels straight, in the body's frame.
    pub pivot: DVec3,
    /// Rotation vector of the whole motion: along the axis, as long as the angle in radians, which
    /// may be several turns, at most [`MAX_TURN`]. World axes.
    pub turn: DVec3,
    /// How far the pivot travels in all, world axes.
    pub travel: DVec3,
}

impl Motion {
    /// No motion.
    #[must_use]
    pub fn at_rest(start: Pose) -> Self {
        Self::straight(start, DVec3::ZERO)
    }

    /// Translation without rotation.
    #[must_use]
    pub fn straight(start: Pose, travel: DVec3) -> Self {
        Self { start, pivot: DVec3::ZERO, turn: DVec3::ZERO, travel }
    }

    /// A screw: rotation about an axis through `on_axis` (world) by `turn`, and `advance` along it.
    #[must_use]
    pub fn screw(start: Pose, on_axis: DVec3, turn: DVec3, advance: f64) -> Self {
        let pivot = start.world_from_body().inverse().apply(on_axis);
        Self { start, pivot, turn, travel: advance * turn.normalize_or_zero() }
    }

    /// From one pose to another by the shorter rotation (at most half a turn), the pivot (body
    /// frame) on a straight line. The end is met to rounding.
    #[must_use]
    pub fn between(start: Pose, end: Pose, pivot: DVec3) -> Self {
        let turn = turn_of(unit(end.rotation) * unit(start.rotation).conjugate());
        let at = |pose: &Pose| pose.world_from_body().apply(pivot);
        Self { start, pivot, turn, travel: at(&end) - at(&start) }
    }

    /// The first part of it, over the whole time.
    #[must_use]
    pub fn part(&self, share: f64) -> Self {
        Self { turn: share * self.turn, travel: share * self.travel, ..*self }
    }

    /// Where the body is at a time, to rounding (about `1e-14 · (1 + |turn|)` of the lengths
    /// involved); at time 0 exactly `start`, its quaternion at length 1.
    #[must_use]
    pub fn pose_at(&self, time: f64) -> Pose {
        let start = Pose { rotation: unit(self.start.rotation), ..self.start };
        if time == 0.0 {
            return start;
        }
        let rotation = unit(rotation_of(time * self.turn) * start.rotation);
        let pivot = self.pivot_at_start() + time * self.travel;
        let moved = Pose { rotation, translation: DVec3::ZERO };
        Pose { rotation, translation: pivot - moved.world_from_body().apply(self.pivot) }
    }

    /// World from body, the rotation alone.
    pub(crate) fn rotation_at(&self, time: f64) -> DMat3 {
        DMat3::from_quat(rotation_of(time * self.turn) * unit(self.start.rotation))
    }

    /// The pivot at time 0 in world coordinates.
    pub(crate) fn pivot_at_start(&self) -> DVec3 {
        let start = Pose { rotation: unit(self.start.rotation), ..self.start };
        start.world_from_body().apply(self.pivot)
    }

    /// The numbers that define the motion, as bits; for a canonical order of pairs.
    pub(crate) fn bits(&self) -> [u64; 16] {
        let mut bits = [0; 16];
        bits[..7].copy_from_slice(&self.start.bits());
        let rest = [self.pivot, self.turn, self.travel].map(|v| v.to_array());
        for (slot, x) in bits[7..].iter_mut().zip(rest.into_iter().flatten()) {
            *slot = (x + 0.0).to_bits();
        }
        bits
    }

    pub(crate) fn check(&self, body: char) -> Result<(), ImpactError> {
        let named =
            [("start", self.start.translation), ("pivot", self.pivot), ("travel", self.travel)];
        for (what, point) in named {
            check_point(point).map_err(|source| ImpactError::Domain { body, what, source })?;
        }
        let q = self.start.rotation;
        let angle = self.turn.length();
        // Both written so that NaN fails.
        let is_unit = (q.length_squared() - 1.0).abs() <= UNIT_SLACK;
        let turns_little = angle <= MAX_TURN;
        match (is_unit, turns_little) {
            (true, true) => Ok(()),
            (false, _) => Err(ImpactError::Rotation { body, length: q.length() }),
            (_, false) => Err(ImpactError::Turn { body, angle }),
        }
    }
}

/// A model in motion.
#[derive(Clone, Copy, Debug)]
pub struct Moving<'a> {
    /// The body.
    pub model: &'a Model,
    /// Its motion from time 0 to 1.
    pub motion: Motion,
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DQuat;
    use std::f64::consts::PI;

    fn near(a: &Pose, b: &Pose) -> bool {
        let q = if a.rotation.dot(b.rotation) < 0.0 { -b.rotation } else { b.rotation };
        (a.rotation - q).length() < 1e-14 && (a.translation - b.translation).length() < 1e-14
    }

    #[test]
    fn a_motion_between_poses_meets_both() {
        let start = Pose {
            rotation: DQuat::from_xyzw(0.1, -0.7, 0.3, 0.64).normalize(),
            translation: DVec3::new(1.0, 2.0, 3.0),
        };
        let end = Pose {
            rotation: DQuat::from_xyzw(-0.5, 0.2, 0.1, -0.84).normalize(),
            translation: DVec3::new(-1.0, 0.5, 3.5),
        };
        let motion = Motion::between(start, end, DVec3::new(0.3, 0.2, 0.1));
        assert!(near(&motion.pose_at(0.0), &start));
        assert!(near(&motion.pose_at(1.0), &end));
        assert!(motion.turn.length() <= PI);
    }

    #[test]
    fn the_pivot_travels_straight_and_a_screw_keeps_its_axis() {
        // About the line x = 1, y = 0: a quarter turn takes the origin to (1, -1), two up.
        let motion = Motion::screw(Pose::IDENTITY, DVec3::X, PI * DVec3::Z, 4.0);
        let half = motion.pose_at(0.5).world_from_body();
        assert!((half.apply(DVec3::ZERO) - DVec3::new(1.0, -1.0, 2.0)).length() < 1e-14);
        assert!((half.apply(DVec3::X) - DVec3::new(1.0, 0.0, 2.0)).length() < 1e-14);
    }

    #[test]
    fn turns_are_counted_in_full() {
        let spin = Motion { turn: 6.0 * PI * DVec3::Z, ..Motion::at_rest(Pose::IDENTITY) };
        let sixth = spin.pose_at(1.0 / 12.0).world_from_body(); // a quarter turn
        assert!((sixth.apply(DVec3::X) - DVec3::Y).length() < 1e-14);
        assert!(near(&spin.pose_at(1.0), &Pose::IDENTITY));
    }

    #[test]
    fn what_is_no_motion_is_refused() {
        let rest = Motion::at_rest(Pose::IDENTITY);
        assert_eq!(rest.check('A'), Ok(()));
        let nan = DVec3::new(0.0, f64::NAN, 0.0);
        for bad in [
            Motion { travel: nan, ..rest },
            Motion { pivot: DVec3::splat(f64::INFINITY), ..rest },
            Motion { start: Pose::at(nan), ..rest },
        ] {
            assert!(matches!(bad.check('A'), Err(ImpactError::Domain { .. })));
        }
        for turn in [nan, 2.0 * MAX_TURN * DVec3::X] {
            let bad = Motion { turn, ..rest };
            assert!(matches!(bad.check('B'), Err(ImpactError::Turn { body: 'B', .. })));
        }
        let mut scaled = rest;
        scaled.start.rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, 1.1);
        assert!(matches!(scaled.check('A'), Err(ImpactError::Rotation { .. })));
    }
}
