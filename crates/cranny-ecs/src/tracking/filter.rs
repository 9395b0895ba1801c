//! The 1 euro filter (Casiez, Roussel and Vogel, CHI 2012) of poses.
//!
//! It departs from the paper in one thing: place and rotation share one cutoff, which follows the
//! speed of the body's fastest point. With a cutoff each, a body that turns while it moves would
//! lag in the one behind the other, and leave its own way.

use std::f64::consts::TAU;

use cranny_exact::{DVec3, Pose};
use cranny_impact::Motion;
use cranny_world::description::OneEuro;

use super::TrackedPose;
use crate::kinematics::moved;
use crate::paths::velocities;

/// The cutoff of speeds, hertz, that of the paper. Higher: jitter counts as speed, and raises the
/// cutoff of the pose; lower: the filter lags where the body begins to move.
const SPEED_CUTOFF: f64 = 1.0;

/// Linear and angular, world axes.
type Speeds = [DVec3; 2];

/// What the filter knows after some poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Filtered {
    /// Of the newest pose, seconds.
    pub(super) time: f64,
    pub(super) pose: Pose,
    /// Of the filtered poses.
    velocities: Speeds,
    /// The paper's, for the cutoff alone: from a filtered pose to the next one as it came. The
    /// filtered poses lag, so it is too fast.
    estimated: Speeds,
}

impl Filtered {
    /// Nothing is known before.
    pub(super) fn first(sample: &TrackedPose) -> Self {
        let TrackedPose { time, pose } = *sample;
        Self { time, pose, velocities: [DVec3::ZERO; 2], estimated: [DVec3::ZERO; 2] }
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
        let share = share_of(SPEED_CUTOFF, passed);
        let to = |pose: &Pose| velocities(&self.pose, pose, DVec3::ZERO, passed);
        let estimated = mean(self.estimated, to(&sample.pose), share);
        let pose = smoothing.map_or(sample.pose, |OneEuro { min_cutoff, per_speed }| {
            let speed = estimated[0].length() + reach * estimated[1].length();
            let share = share_of(min_cutoff + per_speed * speed, passed);
            Motion::between(self.pose, sample.pose, DVec3::ZERO).pose_at(share)
        });
        let velocities = mean(self.velocities, to(&pose), share);
        Self { time: sample.time, pose, velocities, estimated }
    }

    /// Where the body is some seconds later if it goes on as it does.
    pub(super) fn extrapolated(&self, seconds: f64) -> Pose {
        moved(&self.pose, DVec3::ZERO, self.velocities, seconds)
    }
}

/// How much of what is new a low pass lets through.
fn share_of(cutoff: f64, passed: f64) -> f64 {
    // So that a cutoff beyond all numbers lets all through.
    1.0 / (1.0 + 1.0 / (TAU * cutoff * passed))
}

/// What a low pass makes of velocities.
fn mean(old: Speeds, new: Speeds, share: f64) -> Speeds {
    [old[0].lerp(new[0], share), old[1].lerp(new[1], share)]
}

#[cfg(test)]
mod tests {
    use cranny_exact::DQuat;

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
        let [linear, angular] = filtered.velocities;
        assert!((linear - 3.0 * DVec3::X).length() < 1e-6, "{linear}");
        assert!((angular + 2.0 * DVec3::Z).length() < 1e-6, "{angular}");
        let later = filtered.extrapolated(0.5);
        assert!((later.translation.x - 16.5).abs() < 1e-5, "{}", later.translation);
        assert!(later.rotation.dot(DQuat::from_rotation_z(-11.0)).abs() > 1.0 - 1e-9);
    }

    /// The paper's speed is taken from where the filter lags behind, so it is too fast.
    #[test]
    fn what_is_smoothed_is_extrapolated_at_its_own_speed() {
        let mut filtered = Filtered::first(&sample(0.0, 0.0));
        for i in 1..=200 {
            let time = 0.01 * f64::from(i);
            let rotation = DQuat::from_rotation_z(0.25 * time);
            let pose = Pose { rotation, translation: DVec3::X * 0.3 * time };
            filtered = filtered.after(&TrackedPose { time, pose }, SMOOTHING, 1.0);
        }
        let later = filtered.extrapolated(0.1);
        let speed = (later.translation.x - filtered.pose.translation.x) / 0.1;
        assert!((speed / 0.3 - 1.0).abs() < 0.05, "{speed}");
        let turned = (later.rotation * filtered.pose.rotation.conjugate()).to_scaled_axis();
        assert!((turned.z / 0.025 - 1.0).abs() < 0.05, "{turned}");
    }

    #[test]
    fn what_is_smoothed_lags_by_the_cutoff_s_time() {
        let smoothing = Some(OneEuro { min_cutoff: 0.8, per_speed: 0.0 });
        let mut filtered = Filtered::first(&sample(0.0, 0.0));
        for i in 1..=300 {
            let time = 0.01 * f64::from(i);
            filtered = filtered.after(&sample(time, time), smoothing, 0.0);
        }
        let lag = 3.0 - filtered.pose.translation.x;
        assert!((lag - 1.0 / (TAU * 0.8)).abs() < 1e-6, "{lag}");
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
