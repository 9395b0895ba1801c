//! A hook falls onto the ring that it hangs on, and hangs.

use cranny_ecs::RunOptions;
use cranny_exact::DVec3;

use crate::overlap::Judge;
use crate::run::{asset, body, tilt, watch};

#[test]
fn the_hook_hangs_by_its_bar() {
    let scene = asset("hook_on_ring.ron").description;
    let (ring, hook) = (body(&scene, "ring"), body(&scene, "hook"));
    let judge = Judge::of(&scene);
    // The bar's lower side lies on the ring's highest circle, z = 0.2. It is 0.9 above the shank's
    // end, the centroid is at (shank 0.36 · 0.6 + bar 0.3 · 1.05 + tip
    // 0.15 · 0.65) / 0.81 = 0.7759.
    let below = 0.9 - (0.36 * 0.6 + 0.3 * 1.05 + 0.15 * 0.65) / 0.81;
    let rest = DVec3::new(0.997, 0.0, 0.2 - below);
    let start = scene.bodies[hook].pose;
    assert!((start.translation - rest - 0.005 * DVec3::Z).length() < 1e-6);
    // What it falls by is all the energy there is: m g 0.005 lifts the centroid, which hangs 0.124
    // below the bar, by no more than 0.005, so it never swings by more than
    // acos(1 − 0.005 / 0.124) = 16 degrees. It has no reason to swing: within 1 degree.
    let (mut most, mut deepest) = (0.0f64, 0.0f64);
    let ended = watch(&scene, &RunOptions::default(), |now| {
        most = most.max(tilt(DVec3::Z, &start, &now.poses[hook]));
        most = most.max(tilt(DVec3::X, &start, &now.poses[hook]));
        deepest = deepest.max(judge.overlap(&now.poses, ring, hook));
    });
    let at = ended.poses[hook].translation;
    eprintln!("hook at {at}, expected {rest}, tilt {most:.4}, deepest {deepest:.5}");
    assert!((at.z - rest.z).abs() < 5e-3, "{at}, expected {rest}");
    assert!((at - rest).truncate().length() < 1e-2, "{at}, expected {rest}");
    assert!(most < 1.0, "{most}");
    assert!(deepest < 5e-3, "{deepest}");
    assert!(ended.summary.energy_drift.unwrap() < 0.01);
}
