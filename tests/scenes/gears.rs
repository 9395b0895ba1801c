//! Two gears mesh: the driven one turns by the ratio of the teeth, and no tooth is skipped.

use std::f64::consts::TAU;

use cranny_ecs::RunOptions;
use cranny_exact::{DVec3, Pose};

use crate::overlap::Judge;
use crate::run::{asset, body, tilt, watch};

/// Play along the pitch circle: what the teeth of both are thinner by.
const PLAY: f64 = 2.0 * 0.004;

/// Pitch radii.
const RADII: [f64; 2] = [0.8, 1.2];

/// Of the exact overlap.
const OVERLAP: f64 = 2e-3;

fn angle(pose: &Pose) -> f64 {
    2.0 * pose.rotation.z.atan2(pose.rotation.w)
}

/// The angle nearest to the last one that is the same but for whole turns.
fn unwound(last: f64, angle: f64) -> f64 {
    angle + TAU * ((last - angle) / TAU).round()
}

#[test]
fn the_ratio_is_that_of_the_teeth() {
    let scene = asset("gears.ron").description;
    let (driver, driven) = (body(&scene, "driver"), body(&scene, "driven"));
    let judge = Judge::of(&scene);
    let start: Vec<Pose> = scene.bodies.iter().map(|body| body.pose).collect();
    assert_eq!(judge.overlap(&start, driver, driven), 0.0, "they start free");
    let mut turned = [driver, driven].map(|k| angle(&start[k]));
    let begun = turned;
    // Along the pitch circles both move alike, but for the play; a skipped tooth would be 0.1
    // π = 0.314.
    let (mut off, mut deepest, mut most) = ([0.0f64; 2], 0.0f64, 0.0f64);
    let ended = watch(&scene, &RunOptions::default(), |now| {
        for (turned, k) in turned.iter_mut().zip([driver, driven]) {
            *turned = unwound(*turned, angle(&now.poses[k]));
        }
        let along = RADII[0] * (turned[0] - begun[0]) + RADII[1] * (turned[1] - begun[1]);
        off = [off[0].min(along), off[1].max(along)];
        most = most.max(tilt(DVec3::Z, &start[driven], &now.poses[driven]));
        deepest = deepest.max(judge.overlap(&now.poses, driver, driven));
    });
    let (ahead, behind) = (turned[0] - begun[0], turned[1] - begun[1]);
    let ratio = behind / ahead;
    eprintln!(
        "driver {:.5} turns, ratio {ratio:.6}, off {off:?} along the pitch circle, deepest {deepest:.5}, tilt {most:.4}, {:?}",
        ahead / TAU,
        ended.summary.contacts
    );
    assert!((ahead / TAU - 2.0).abs() < 1e-3, "two turns: {ahead}");
    // Play at the end may be on either side: 0.008 / (0.8 · 4 π) = 0.08 %.
    assert!((ratio / (-16.0 / 24.0) - 1.0).abs() < 1e-3, "{ratio}");
    // Chords lie inside the flanks: teeth are thinner by up to 0.002 between the corners.
    let room = PLAY + OVERLAP + 0.002;
    assert!(off[1] - off[0] < room && off.iter().all(|x| x.abs() < room), "{off:?}");
    assert!(deepest < OVERLAP, "{deepest}");
    assert!(most < 0.1, "{most}: its axle holds it");
}
