//! Tracked bodies: contacts under jitter, delay and loss, beside those of the true motion.
//! Lengths are millimetres.

use std::sync::Arc;

use cranny_ecs::*;
use cranny_exact::{DVec3, Pose};
use cranny_shapes::{Cuboid, Cup};
use cranny_world::Random;
use cranny_world::description::{
    BodyDescription, BodyKind, Effect, Interpolation, Keyframe, KeyframedPath, OneEuro, PathEnd,
    SceneDescription, SimulatedDevice, TrackerDescription, TrackerSettings,
};

use crate::build::{cube, scene};

/// Steps a second, and poses.
const RATE: f64 = 240.0;
const JITTER: f64 = 2.0;

/// Errs by 2 mm, and in nothing else.
fn shaky(seed: u64) -> SimulatedDevice {
    SimulatedDevice {
        rate: RATE,
        jitter: JITTER,
        latency: 0.0,
        latency_spread: 0.0,
        dropouts: 0.0,
        occlusions: 0.0,
        occluded_for: 0.0,
        seed,
    }
}

/// A pen in and about a cup: a way with keyframes so many seconds apart.
fn pen_and_cup(
    keyframes: &[(f64, Pose)],
    tracker: TrackerDescription,
    tolerance: f64,
) -> SceneDescription {
    let keyframes = keyframes.iter().map(|&(time, pose)| Keyframe { time, pose });
    let path = KeyframedPath::new(keyframes.collect(), Interpolation::Eased, PathEnd::Hold);
    let cup = Cup { radius: 40.0, height: 80.0, wall: 8.0, ..Cup::default() };
    let pen = Cuboid { size: [6.0, 6.0, 60.0] };
    let still = |name, kind| cube(name, kind, DVec3::ZERO, DVec3::ZERO);
    let bodies = vec![
        BodyDescription {
            collision: Arc::new(cup.build().unwrap()),
            ..still("cup", BodyKind::Fixed)
        },
        BodyDescription {
            collision: Arc::new(pen.build().unwrap()),
            path: Some(Arc::new(path.unwrap())),
            tracker: Some(tracker),
            effects: vec![Effect::Trigger, Effect::Tracking { tolerance }],
            ..still("pen", BodyKind::Kinematic)
        },
    ];
    SceneDescription { step: 1.0 / RATE, duration: 3.0, ..scene(bodies, &[]) }
}

/// A random way: the pen's middle within the cup's wall, in its well and above it.
fn wander(seed: u64, pause: f64) -> Vec<(f64, Pose)> {
    let mut random = Random::new(seed);
    let count = (3.0 / pause) as u32;
    let key = |i: u32| {
        let place = DVec3::new(45.0, 45.0, 40.0) * random.in_ball() + DVec3::Z * 80.0;
        let rotation = random.rotation();
        (f64::from(i) * pause, Pose { rotation, translation: place })
    };
    (0..count).map(key).collect()
}

fn run(scene: &SceneDescription) -> RunSummary {
    let mut app = SceneApp::new(scene, &RunOptions::default()).unwrap();
    while app.step().unwrap() {}
    app.finish().unwrap()
}

#[test]
fn probe() {
    for (pause, smoothing, tolerance) in [
        (0.5, None, 2.0),
        (0.25, None, 2.0),
        (1.0, None, 2.0),
        (1.0, Some(OneEuro { min_cutoff: 1.0, per_speed: 0.02 }), 1.0),
        (1.0, Some(OneEuro { min_cutoff: 1.0, per_speed: 0.1 }), 1.0),
    ] {
        let mut sum = [[0usize; 5]; 2];
        let mut truth = 0;
        let start = std::time::Instant::now();
        for seed in 0..20 {
            let settings = TrackerSettings { smoothing, ..TrackerSettings::default() };
            let tracker = TrackerDescription { settings, device: shaky(seed) };
            let summary = run(&pen_and_cup(&wander(seed, pause), tracker, tolerance));
            let t = &summary.tracking[0];
            truth += t.truth;
            for (s, t) in sum.iter_mut().zip([t.raw, t.filtered]) {
                s[0] += t.contacts;
                s[1] += t.spurious;
                s[2] += t.repeated;
                s[3] += t.missed;
                s[4] = s[4].max(t.latency_steps as usize);
            }
        }
        println!(
            "{pause} {smoothing:?} {tolerance}: truth {truth} raw {:?} filtered {:?} {:?}",
            sum[0],
            sum[1],
            start.elapsed()
        );
    }
}
