//! The 1 euro filter (Casiez, Roussel and Vogel, CHI 2012) of poses.
//!
//! It departs from the paper in one thing: place and rotation share one cutoff, which follows the
//! speed of the body's fastest point. With a cutoff each, a body that turns while it moves would
//! lag in the one behind the other, and leave its own way.

use std::f64::consts::TAU;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_world::description::OneEuro;

use super::TrackedPose;

/// The cutoff of the speed, hertz, that of the paper. Higher: jitter counts as speed, and raises
/// the cutoff of the pose; lower: the filter lags where the body begins to move.
const SPEED_CUTOFF: f64 = 1.0;

/// What the filter knows after some poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Filtered {
    /// Of the newest pose, seconds.
    pub(super) time: f64,
    pub(super) pose: Pose,
    linear: DVec3,
    angular: DVec3,
}

impl Filtered {
    /// Nothing is known before.
    pub(super) fn first(sample: &TrackedPose) -> Self {
        let TrackedPose { time, pose } = *sample;
        Self { time, pose, linear: DVec3::ZERO, angular: DVec3::ZERO }
    }

    /// After one pose more, which is a later one. No point of the body is farther than `reach` from
    /// its origin.
    pub(super) fn after(
        &self,
        sample: &TrackedPose,
        smoothing: Option<OneEuro>,
        reach: f64,
    ) -> Self {
        let passed = sample.time - self.time;
        let moved = (sample.pose.translation - self.pose.translation) / passed;
        let turned = nearer(self.pose.rotation, sample.pose.rotation);
        let turned = (turned * self.pose.rotation.conjugate()).to_scaled_axis() / passed;
        let share = share_of(SPEED_CUTOFF, passed);
        let (linear, angular) = (self.linear.lerp(moved, share), self.angular.lerp(turned, share));
        let speed = linear.length() + reach * angular.length();
        let share = smoothing.map_or(1.0, |OneEuro { min_cutoff, per_speed }| {
            share_of(min_cutoff + per_speed * speed, passed)
        });
        let pose = blend(&self.pose, &sample.pose, share);
        Self { time: sample.time, pose, linear, angular }
    }

    /// Where the body is some seconds later if it goes on as it does.
    pub(super) fn extrapolated(&self, seconds: f64) -> Pose {
        let turned = DQuat::from_scaled_axis(seconds * self.angular) * self.pose.rotation;
        let rotation = turned * (1.0 / turned.length());
        Pose { rotation, translation: self.pose.translation + seconds * self.linear }
    }
}

/// How much of what is new a low pass lets through.
fn share_of(cutoff: f64, passed: f64) -> f64 {
    // So that a cutoff beyond all numbers lets all through.
    1.0 / (1.0 + 1.0 / (TAU * cutoff * passed))
}

/// Of the two quaternions of a rotation the one on the side of another.
fn nearer(to: DQuat, q: DQuat) -> DQuat {
    if to.dot(q) < 0.0 { -q } else { q }
}

/// A share of the way from one pose to another one near it. Rotations are blended along the chord,
/// which between poses that follow each other is the arc.
pub(super) fn blend(from: &Pose, to: &Pose, share: f64) -> Pose {
    let sum = from.rotation * (1.0 - share) + nearer(from.rotation, to.rotation) * share;
    let length = sum.length();
    // Half a turn has no middle.
    let rotation = if length > 0.0 { sum * (1.0 / length) } else { to.rotation };
    Pose { rotation, translation: from.translation.lerp(to.translation, share) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMOOTHING: Option<OneEuro> = Some(OneEuro { min_cutoff: 1.0, per_speed: 0.5 });

    fn sample(time: f64, x: f64) -> TrackedPose {
        TrackedPose { time, pose: Pose::at(DVec3::X * x) }
    }

    /// The paper's algorithm, step by step: 1 hertz, 0.1 s apart.
    #[test]
    fn the_published_filter() {
        let share = |cutoff: f64| 1.0 / (1.0 + 1.0 / (TAU * cutoff) / 0.1);
        let (mut x, mut speed) = (0.0, 0.0);
        let mut filtered = Filtered::first(&sample(0.0, 0.0));
        for (i, measured) in (1u32..).zip([1.0, 2.0, 1.5, -3.0]) {
            filtered = filtered.after(&sample(0.1 * f64::from(i), measured), SMOOTHING, 0.0);
            speed += share(1.0) * ((measured - x) / 0.1 - speed);
            x += share(1.0 + 0.5 * f64::abs(speed)) * (measured - x);
            assert!((filtered.pose.translation.x - x).abs() < 1e-9, "{i}");
        }
    }

    #[test]
    fn without_smoothing_poses_are_as_they_come_and_speeds_are_known() {
        let mut filtered = Filtered::first(&sample(0.0, 0.0));
        for i in 1..=500 {
            let time = 0.01 * f64::from(i);
            let rotation = DQuat::from_rotation_z(-2.0 * time);
            let rotation = if i % 2 == 0 { rotation } else { -rotation };
            let pose = Pose { rotation, translation: DVec3::X * 3.0 * time };
            filtered = filtered.after(&TrackedPose { time, pose }, None, 1.0);
            assert!((filtered.pose.translation - pose.translation).length() < 1e-12);
        }
        assert!((filtered.linear - 3.0 * DVec3::X).length() < 1e-6, "{}", filtered.linear);
        assert!((filtered.angular + 2.0 * DVec3::Z).length() < 1e-6, "{}", filtered.angular);
        let later = filtered.extrapolated(0.5);
        assert!((later.translation.x - 16.5).abs() < 1e-5, "{}", later.translation);
        assert!(later.rotation.dot(DQuat::from_rotation_z(-11.0)).abs() > 1.0 - 1e-9);
    }

    /// A mean of what came never goes beyond it, as a filter that predicts would.
    #[test]
    fn what_stops_is_never_overshot() {
        let mut filtered = Filtered::first(&sample(0.0, 0.0));
        for i in 1..=400 {
            let time = 0.01 * f64::from(i);
            filtered = filtered.after(&sample(time, (5.0 * time).min(1.0)), SMOOTHING, 0.0);
            assert!(filtered.pose.translation.x <= 1.0);
        }
        assert!(filtered.pose.translation.x > 0.99);
    }
}
