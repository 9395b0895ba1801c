//! Poses of one body as a device reports them, late, out of order or not at all.

use std::collections::VecDeque;

use bevy_ecs::prelude::Component;
use cranny_exact::{DVec3, Pose, PoseError};
use cranny_impact::Motion;
use cranny_world::description::{TrackerError, TrackerSettings};
use thiserror::Error;

use super::filter::Filtered;

const MOST_WAITING: usize = TrackerSettings::MOST_WAITING;

/// A pose that a device measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackedPose {
    /// When it was measured, seconds of [`SimulatedTime`](crate::SimulatedTime).
    pub time: f64,
    /// `world_from_body`.
    pub pose: Pose,
}

/// Why a tracker leaves a pose out.
#[derive(Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum PoseRefused {
    /// A time that is no number.
    #[error("its time is {time}, which is no time")]
    NoTime {
        /// What it is.
        time: f64,
    },
    /// A place or rotation that is none: not finite, out of the domain, or a quaternion whose
    /// length is off 1 by more than 1 %.
    #[error("it is no pose: {0}")]
    NoPose(PoseError),
    /// The body has been shown at a later one already.
    #[error(
        "it was measured at {time} s, and the body has been shown as of {shown} s: a longer `delay` waits for it"
    )]
    Late {
        /// When it was measured.
        time: f64,
        /// Of the newest pose that was shown.
        shown: f64,
    },
    /// There is one of that time.
    #[error("there is a pose of {time} s already")]
    Repeated {
        /// When it was measured.
        time: f64,
    },
    /// Too many wait for their time to come.
    #[error(
        "{MOST_WAITING} poses wait for their time to come: the device's clock is ahead, or `delay` is too long"
    )]
    Crowded,
}

/// The message: a `main` that fails prints an error by `Debug`.
impl std::fmt::Debug for PoseRefused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// What became of the poses of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackerCounts {
    /// Poses that were reported.
    pub reported: u64,
    /// Of them those that came too late, see [`PoseRefused::Late`].
    pub late: u64,
    /// Of them those that were refused for other reasons.
    pub refused: u64,
    /// How often the body was lost.
    pub lost: u64,
}

/// Makes a kinematic body go where a device sees it: the app [reports](Self::report) poses, and in
/// each step the body moves to the newest, [`TrackerSettings::delay`] ago. It writes the body's
/// velocities, so that it pushes as fast as it goes. On bodies of another kind it does nothing.
///
/// Where a body appears for the first time, or anew after it was [lost](Self::is_lost), its
/// `Transform` is set, and for that step it has no velocity.
#[derive(Component, Clone, Debug, Default)]
pub struct Tracker {
    settings: TrackerSettings,
    /// Times rising.
    waiting: VecDeque<TrackedPose>,
    known: Option<Filtered>,
    counts: TrackerCounts,
    found: bool,
}

/// Where a body is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shown {
    pub(super) pose: Pose,
    /// Whether it was not seen before, so that it has come from nowhere.
    pub(super) appears: bool,
}

impl Tracker {
    /// Of no poses yet: until the first the body stays where it is.
    ///
    /// # Errors
    ///
    /// [`TrackerError::Number`] for a setting that is out of range.
    pub fn new(settings: TrackerSettings) -> Result<Self, TrackerError> {
        settings.check().map(|()| Self { settings, ..Self::default() })
    }

    /// How poses are taken.
    #[must_use]
    pub fn settings(&self) -> &TrackerSettings {
        &self.settings
    }

    /// Takes a pose in. The order of arrival does not matter as long as none is late. A quaternion
    /// that is nearly of unit length is normalised.
    ///
    /// # Errors
    ///
    /// [`PoseRefused`]: the pose is left out, and [counted](Self::counts).
    pub fn report(&mut self, sample: TrackedPose) -> Result<(), PoseRefused> {
        self.counts.reported += 1;
        let put = self.put(sample);
        match put {
            Ok(()) => {}
            Err(PoseRefused::Late { .. }) => self.counts.late += 1,
            Err(_) => self.counts.refused += 1,
        }
        put
    }

    fn put(&mut self, TrackedPose { time, pose }: TrackedPose) -> Result<(), PoseRefused> {
        if !time.is_finite() {
            return Err(PoseRefused::NoTime { time });
        }
        let pose = Pose::of_few_digits(pose.rotation, pose.translation);
        let pose = pose.map_err(PoseRefused::NoPose)?;
        if let Some(known) = self.known.filter(|known| time <= known.time) {
            return Err(PoseRefused::Late { time, shown: known.time });
        }
        let at = self.waiting.partition_point(|other| other.time < time);
        if self.waiting.get(at).is_some_and(|other| other.time == time) {
            return Err(PoseRefused::Repeated { time });
        }
        if self.waiting.len() >= MOST_WAITING {
            if at == self.waiting.len() {
                return Err(PoseRefused::Crowded);
            }
            // Of those that wait, what is due last gives way.
            self.waiting.pop_back();
            self.counts.refused += 1;
        }
        self.waiting.insert(at, TrackedPose { time, pose });
        Ok(())
    }

    /// Whether the body's newest pose is older than [`TrackerSettings::lost_after`], or there was
    /// none: nobody knows where it is, and no contact with it begins.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        !self.found
    }

    /// What became of the poses.
    #[must_use]
    pub fn counts(&self) -> TrackerCounts {
        self.counts
    }

    /// Moves on to a time; returns where the body is then, `None` before the first pose.
    pub(super) fn advance(&mut self, now: f64, reach: f64) -> Option<Shown> {
        let horizon = now - self.settings.delay;
        let mut appears = false;
        while let Some(sample) = self.waiting.pop_front_if(|sample| sample.time <= horizon) {
            let goes_on = self.known.filter(|known| !self.is_gap(known.time, sample.time));
            appears |= goes_on.is_none();
            self.known = Some(match goes_on {
                Some(known) => known.after(&sample, self.settings.smoothing, reach),
                None => Filtered::first(&sample),
            });
        }
        let known = self.known?;
        let found = !self.is_gap(known.time, horizon);
        self.counts.lost += u64::from(self.found && !found);
        appears |= found && !self.found;
        self.found = found;
        Some(Shown { pose: self.pose_at(&known, horizon, reach), appears })
    }

    /// Whether so much time without a pose is more than is borne.
    fn is_gap(&self, from: f64, to: f64) -> bool {
        to - from > self.settings.lost_after
    }

    /// On the way to the next pose where that is there, else as far as poses are extrapolated.
    fn pose_at(&self, known: &Filtered, horizon: f64, reach: f64) -> Pose {
        let age = horizon - known.time;
        let next = self.waiting.front().filter(|next| !self.is_gap(known.time, next.time));
        match next {
            Some(next) => {
                let ahead = known.after(next, self.settings.smoothing, reach);
                let way = Motion::between(known.pose, ahead.pose, DVec3::ZERO);
                way.pose_at(age / (next.time - known.time))
            }
            None if self.settings.extrapolate > 0.0 => {
                known.extrapolated(age.min(self.settings.extrapolate))
            }
            None => known.pose,
        }
    }
}

#[cfg(test)]
mod tests {
    use cranny_exact::DQuat;

    use super::*;

    fn sample(time: f64, x: f64) -> TrackedPose {
        TrackedPose { time, pose: Pose::at(DVec3::X * x) }
    }

    fn tracker(delay: f64, extrapolate: f64) -> Tracker {
        let settings = TrackerSettings { delay, extrapolate, ..TrackerSettings::default() };
        Tracker::new(settings).unwrap()
    }

    fn x(tracker: &mut Tracker, now: f64) -> f64 {
        tracker.advance(now, 1.0).unwrap().pose.translation.x
    }

    #[test]
    fn what_is_no_pose_is_refused_by_its_kind_and_counted() {
        let mut tracker = tracker(0.0, 0.0);
        assert_eq!(tracker.advance(0.0, 1.0), None);
        let with = |rotation| TrackedPose { time: 0.0, pose: Pose { rotation, ..Pose::IDENTITY } };
        let half = with(DQuat::IDENTITY * 0.5);
        assert!(matches!(tracker.report(half), Err(PoseRefused::NoPose(_))));
        let zero = with(DQuat::IDENTITY * 0.0);
        assert!(matches!(tracker.report(zero), Err(PoseRefused::NoPose(_))));
        let nan = sample(0.0, f64::NAN);
        assert!(matches!(tracker.report(nan), Err(PoseRefused::NoPose(_))));
        let when = sample(f64::NAN, 0.0);
        assert!(matches!(tracker.report(when), Err(PoseRefused::NoTime { .. })));
        tracker.report(with(DQuat::IDENTITY * 1.005)).unwrap();
        let repeated = PoseRefused::Repeated { time: 0.0 };
        assert_eq!(tracker.report(sample(0.0, 1.0)), Err(repeated));
        assert_eq!(tracker.advance(0.0, 1.0).unwrap().pose, Pose::IDENTITY);
        assert_eq!(
            tracker.report(sample(0.0, 1.0)),
            Err(PoseRefused::Late { time: 0.0, shown: 0.0 })
        );
        let expected = TrackerCounts { reported: 7, late: 1, refused: 5, lost: 0 };
        assert_eq!(tracker.counts(), expected);
    }

    #[test]
    fn a_clock_that_is_ahead_fills_no_memory() {
        let mut tracker = tracker(0.0, 0.0);
        let refused =
            (0..5000).filter(|&i| tracker.report(sample(1e6 + f64::from(i), 0.0)).is_err());
        assert_eq!(refused.count(), 5000 - MOST_WAITING);
        assert_eq!(tracker.report(sample(2e6, 0.0)), Err(PoseRefused::Crowded));
        assert_eq!(tracker.report(sample(0.0, 3.0)), Ok(()));
        assert_eq!(tracker.counts().refused, 5002 - MOST_WAITING as u64);
        assert_eq!(x(&mut tracker, 0.0), 3.0);
    }

    /// With a delay that covers them, poses out of order are the same as in order.
    #[test]
    fn a_delay_brings_poses_into_order() {
        let times = [0.0, 0.02, 0.01, 0.03, 0.05, 0.04, 0.06];
        let (mut ordered, mut disordered) = (tracker(0.02, 0.0), tracker(0.02, 0.0));
        let mut sorted = times;
        sorted.sort_by(f64::total_cmp);
        for (step, (a, b)) in (0u32..).zip(times.into_iter().zip(sorted)) {
            disordered.report(sample(a, 7.0 * a)).unwrap();
            ordered.report(sample(b, 7.0 * b)).unwrap();
            let now = 0.01 * f64::from(step);
            assert_eq!(disordered.advance(now, 1.0), ordered.advance(now, 1.0), "{now}");
        }
        assert!((x(&mut ordered, 0.065) - 7.0 * 0.045).abs() < 1e-12, "half-way between two poses");
        let mut hasty = tracker(0.0, 0.0);
        let late = times.into_iter().filter(|&time| {
            let is_late = hasty.report(sample(time, 0.0)).is_err();
            hasty.advance(0.1, 1.0);
            is_late
        });
        assert_eq!(late.count(), 2);
        assert_eq!(hasty.counts().late, 2);
    }

    #[test]
    fn what_is_missing_is_held_or_extrapolated_and_then_lost() {
        for (extrapolate, expected) in [(0.0, 1.0), (0.05, 1.25)] {
            let mut tracker = tracker(0.0, extrapolate);
            assert!(tracker.is_lost(), "nobody has seen it");
            for i in 0..=200 {
                let time = 0.01 * f64::from(i) - 1.8;
                tracker.report(sample(time, 5.0 * time)).unwrap();
            }
            assert!(tracker.advance(0.2, 1.0).unwrap().appears);
            assert!(!tracker.advance(0.21, 1.0).unwrap().appears);
            assert!((x(&mut tracker, 0.29) - expected).abs() < 1e-3, "{extrapolate}");
            assert!(!tracker.is_lost());
            assert!((x(&mut tracker, 0.35) - expected).abs() < 1e-3, "and no farther");
            assert!(tracker.is_lost());
            tracker.report(sample(0.6, 9.0)).unwrap();
            let found = tracker.advance(0.61, 1.0).unwrap();
            assert_eq!((found.pose.translation.x, found.appears), (9.0, true));
            assert!(!tracker.is_lost());
            assert_eq!(tracker.counts().lost, 1);
        }
    }

    #[test]
    fn settings_out_of_range_are_refused_by_name() {
        let settings = TrackerSettings { lost_after: 0.0, ..TrackerSettings::default() };
        let error = Tracker::new(settings).unwrap_err().to_string();
        assert_eq!(error, "`lost_after` is 0, but must be a finite number greater than 0");
    }
}
