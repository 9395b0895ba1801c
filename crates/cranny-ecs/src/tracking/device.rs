//! A tracking device that is simulated: what it measures of a body on a path, and when that
//! arrives. The same seed makes the same errors.

use std::sync::Arc;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_world::Random;
use cranny_world::description::{KeyframedPath, SimulatedDevice};

use super::comparison::{TrackingLog, compare};
use super::{TrackedPose, Tracker, TrackingSystems};
use crate::body::{Bodies, Body};
use crate::clock::{CoreSystems, CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::trigger::TriggerSystems;

/// A device that measures a body on its path, in place of the one that an app would have; it
/// reports to the [`Tracker`] beside it.
#[derive(Component, Clone, Debug)]
pub struct SimulatedTracker {
    path: Arc<KeyframedPath>,
    device: SimulatedDevice,
    since: f64,
    random: Random,
    /// Measurements made.
    made: u64,
    /// When the body is seen again.
    hidden_until: f64,
    /// With the time of arrival.
    on_the_way: Vec<(f64, TrackedPose)>,
    arrived: Option<Pose>,
    missing: u64,
}

impl SimulatedTracker {
    /// Measures from a time on, seconds of [`SimulatedTime`]; the path begins then.
    #[must_use]
    pub fn new(path: Arc<KeyframedPath>, device: SimulatedDevice, since: f64) -> Self {
        Self {
            path,
            device,
            since,
            random: Random::new(device.seed),
            made: 0,
            hidden_until: since,
            on_the_way: Vec::new(),
            arrived: None,
            missing: 0,
        }
    }

    /// What measures.
    #[must_use]
    pub fn device(&self) -> &SimulatedDevice {
        &self.device
    }

    /// Where the body really is.
    #[must_use]
    pub fn truth(&self, seconds: f64) -> Pose {
        self.path.pose_at(seconds - self.since)
    }

    /// The pose that arrived last, as it came: what an app without filtering would show.
    #[must_use]
    pub fn arrived(&self) -> Option<Pose> {
        self.arrived
    }

    /// How many poses never came.
    #[must_use]
    pub fn missing(&self) -> u64 {
        self.missing
    }

    /// All that was measured up to now and arrives up to now, by arrival.
    fn arrivals(&mut self, now: f64, reach: f64) -> Vec<TrackedPose> {
        loop {
            let time = self.since + self.made as f64 / self.device.rate;
            if time > now {
                break;
            }
            self.made += 1;
            self.measure(time, reach);
        }
        self.on_the_way.sort_by(|a, b| a.0.total_cmp(&b.0));
        let due = self.on_the_way.partition_point(|(arrival, _)| *arrival <= now);
        self.on_the_way.drain(..due).map(|(_, sample)| sample).collect()
    }

    fn measure(&mut self, time: f64, reach: f64) {
        let device = self.device;
        let mut chance = || 0.5 * (self.random.signed() + 1.0);
        // Each draws as often, so that one number more or less changes no other.
        let [hides, drops, waits, moves] = [chance(), chance(), chance(), chance()];
        let [shift, axis] = [self.random.in_ball(), self.random.in_ball()];
        if hides < device.occlusions / device.rate && time >= self.hidden_until {
            self.hidden_until = time + device.occluded_for;
        }
        if time < self.hidden_until || drops < device.dropouts {
            self.missing += 1;
            return;
        }
        let pose = misplaced(&self.truth(time), device.jitter, moves, [shift, axis], reach);
        let arrival = time + device.latency + waits * device.latency_spread;
        self.on_the_way.push((arrival, TrackedPose { time, pose }));
    }
}

/// A pose at which no point within `reach` of the origin is off by more than `error`: a share of it
/// in place, the rest by turning.
fn misplaced(pose: &Pose, error: f64, share: f64, [shift, axis]: [DVec3; 2], reach: f64) -> Pose {
    let (shift, turn) = (error * share * shift, error * (1.0 - share));
    // A rotation by an angle moves a point by less than the angle times its distance, and that of
    // `1 + angle / 2` is by less than the angle. It needs no trigonometry.
    let half = if reach > 0.0 { 0.5 * turn / reach * axis } else { DVec3::ZERO };
    let turned = DQuat::from_xyzw(half.x, half.y, half.z, 1.0) * pose.rotation;
    let rotation = turned * (1.0 / turned.length());
    Pose { rotation, translation: pose.translation + shift }
}

/// Lets [`SimulatedTracker`]s measure, and [counts](TrackingLog) what becomes of contacts. An app
/// that is made of a scene has it where the scene needs it; others add it after the plugins of
/// `Tracking`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedTrackersPlugin;

impl Plugin for SimulatedTrackersPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<TrackingLog>();
        app.add_systems(
            CrannyStep,
            simulate
                .in_set(TrackingSystems::Simulate)
                .in_set(StepSystems::Admit)
                .after(CoreSystems::Admit)
                .before(TrackingSystems::Lead),
        );
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.add_systems(
                label,
                compare
                    .in_set(TrackingSystems::Compare)
                    .in_set(StepSystems::Report)
                    .after(TriggerSystems::Report),
            );
        }
    }
}

fn simulate(
    mut devices: Query<(&Body, &mut SimulatedTracker, &mut Tracker)>,
    bodies: Res<Bodies>,
    time: Res<SimulatedTime>,
) {
    for (body, mut device, mut tracker) in &mut devices {
        let reach = bodies.get(body.id).map_or(0.0, |record| record.extent());
        for sample in device.arrivals(time.seconds(), reach) {
            device.arrived = Some(sample.pose);
            // What is late is counted there.
            let _ = tracker.report(sample);
        }
    }
}

#[cfg(test)]
mod tests {
    use cranny_world::description::{
        Interpolation, Keyframe, PathEnd, TrackerDescription, TrackerSettings,
    };

    use super::*;

    fn device() -> SimulatedDevice {
        SimulatedDevice {
            rate: 100.0,
            jitter: 0.25,
            latency: 0.02,
            latency_spread: 0.05,
            dropouts: 0.1,
            occlusions: 0.5,
            occluded_for: 0.3,
            seed: 5,
        }
    }

    fn run(device: SimulatedDevice, reach: f64) -> (SimulatedTracker, Vec<(f64, TrackedPose)>) {
        let key = |time, x| Keyframe { time, pose: Pose::at(DVec3::X * x) };
        let keys = vec![key(0.0, 0.0), key(10.0, 10.0)];
        let path = KeyframedPath::new(keys, Interpolation::Linear, PathEnd::Hold).unwrap();
        let mut tracker = SimulatedTracker::new(Arc::new(path), device, 0.0);
        let mut all = Vec::new();
        for step in 0..1000u32 {
            let now = f64::from(step) * 0.01;
            all.extend(tracker.arrivals(now, reach).into_iter().map(|sample| (now, sample)));
        }
        (tracker, all)
    }

    #[test]
    fn no_point_is_misplaced_farther_than_stated_and_some_nearly_so() {
        let (tracker, all) = run(device(), 2.0);
        let (mut worst, mut shift, mut turn) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (_, sample) in &all {
            let place = tracker.truth(sample.time).translation;
            shift = shift.max(sample.pose.translation.distance(place));
            turn = turn.max(2.0 * sample.pose.rotation.xyz().length());
            let truth = tracker.truth(sample.time).world_from_body();
            for point in [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| 2.0 * axis) {
                let seen = sample.pose.world_from_body().apply(point);
                worst = worst.max(seen.distance(truth.apply(point)));
            }
        }
        assert!(worst <= 0.25 && worst > 0.2, "{worst}");
        assert!(shift <= 0.25 && shift > 0.15, "{shift}");
        assert!(turn <= 0.125 && turn > 0.075, "{turn}");
    }

    #[test]
    fn poses_are_late_disordered_and_missing_as_stated() {
        let (tracker, all) = run(device(), 2.0);
        let ages: Vec<f64> = all.iter().map(|(now, sample)| now - sample.time).collect();
        assert!(ages.iter().all(|age| (0.02..0.0801).contains(age)));
        let disordered = all.windows(2).filter(|w| w[1].1.time < w[0].1.time).count();
        assert!(disordered > 100, "{disordered}");
        // A tenth at random, and some 5 times 0.3 s of 10.
        assert!((150..400).contains(&tracker.missing()), "{}", tracker.missing());
        let times: Vec<f64> = all.iter().map(|(_, sample)| sample.time).collect();
        let mut sorted = times;
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).any(|w| w[1] - w[0] >= 0.3), "it was hidden once");
    }

    /// The greatest ages of the pose that arrived last, and of the one that is shown, on a path
    /// whose x is the time; then their bounds.
    fn ages(settings: TrackerSettings, device: SimulatedDevice, step: f64) -> [[f64; 2]; 2] {
        let description = TrackerDescription { settings, device };
        description.check(step).unwrap();
        let key = |time| Keyframe { time, pose: Pose::at(DVec3::X * time) };
        let path =
            KeyframedPath::new(vec![key(0.0), key(100.0)], Interpolation::Linear, PathEnd::Hold);
        let mut measures = SimulatedTracker::new(Arc::new(path.unwrap()), device, 0.0);
        let mut tracker = Tracker::new(settings).unwrap();
        let mut ages = [0.0_f64; 2];
        for now in (0..2000u32).map(|i| f64::from(i) * step) {
            let mut last = None;
            for sample in measures.arrivals(now, 1.0) {
                last = Some(sample.pose);
                let _ = tracker.report(sample);
            }
            measures.arrived = last.or(measures.arrived);
            let shown =
                tracker.advance(now + step, 1.0).map(|shown| now + step - shown.pose.translation.x);
            let raw = measures.arrived().map(|pose| now - pose.translation.x);
            for (age, seen) in ages.iter_mut().zip([raw, shown]) {
                *age = seen.filter(|_| now > 1.0).map_or(*age, |seen| age.max(seen));
            }
        }
        [ages, [device.greatest_age(), description.greatest_age(step)]]
    }

    #[test]
    fn no_pose_is_older_than_stated_as_it_arrives_or_is_shown() {
        for (delay, latency, latency_spread, rate, step) in [
            (0.0, 0.0, 0.0, 30.0, 0.01),
            (0.0, 0.02, 0.05, 100.0, 0.01),
            (0.0, 0.02, 0.1, 20.0, 0.01),
            (0.03, 0.02, 0.1, 50.0, 0.004),
            (0.15, 0.02, 0.1, 50.0, 0.004),
        ] {
            let settings = TrackerSettings { delay, lost_after: 1.0, ..Default::default() };
            let perfect =
                SimulatedDevice { jitter: 0.0, dropouts: 0.0, occlusions: 0.0, ..device() };
            let device = SimulatedDevice { latency, latency_spread, rate, ..perfect };
            let [ages, bounds] = ages(settings, device, step);
            for (kind, (age, bound)) in ages.into_iter().zip(bounds).enumerate() {
                assert!(age <= bound + 1e-9, "{kind}: {age} of {bound}, {settings:?} {device:?}");
                assert!(age > 0.45 * bound, "{kind}: {age} of {bound}, {settings:?} {device:?}");
            }
        }
    }

    #[test]
    fn one_seed_makes_one_run_and_another_another() {
        let (one, again) = (run(device(), 2.0).1, run(device(), 2.0).1);
        assert_eq!(one, again);
        assert_ne!(one, run(SimulatedDevice { seed: 6, ..device() }, 2.0).1);
    }
}
