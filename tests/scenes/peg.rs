//! A peg in a hole that is wider by 0.05 mm all around: it goes in to the bottom.

use cranny_ecs::RunOptions;
use cranny_exact::DVec3;

use crate::overlap::Judge;
use crate::run::{asset, body, lowest, tilt, watch};

/// Millimetres, all around.
const CLEARANCE: f64 = 0.05;

/// Length of the peg that is in the hole at the start, its chamfer left out, and at the end: the
/// well is 15 deep.
const ENGAGED: [f64; 2] = [1.0, 15.0 - 2.0 * 0.5];

/// Of the exact overlap, mm: a fifth of the clearance. The solver takes the peg's 2·V/A = 4.2 mm
/// for a metre and leaves 0.001 of that.
const OVERLAP: f64 = 0.01;

#[test]
fn the_peg_goes_in_to_the_bottom() {
    let scene = asset("peg_in_hole.ron").description;
    let (block, peg) = (body(&scene, "block"), body(&scene, "peg"));
    let judge = Judge::of(&scene);
    let start: Vec<_> = scene.bodies.iter().map(|body| body.pose).collect();
    assert_eq!(judge.overlap(&start, block, peg), 0.0, "it starts free");
    // Jammed against both sides, a peg leans by the gap over the length that is in the hole.
    let lean = |engaged: f64| (2.0 * (CLEARANCE + OVERLAP) / engaged).atan().to_degrees();
    let (mut most, mut deepest) = (0.0f64, 0.0f64);
    let upright = cranny_exact::Pose::IDENTITY;
    let ended = watch(&scene, &RunOptions::default(), |now| {
        let leans = tilt(DVec3::Z, &upright, &now.poses[peg]);
        most = most.max(leans);
        // The lower end's depth in the hole, less the chamfer at either end of what touches.
        let engaged = 20.0 - lowest(&scene, peg, &now.poses[peg], DVec3::Z) - 0.5;
        assert!(leans < lean(engaged.min(ENGAGED[1])), "step {}: {leans}", now.step);
        deepest = deepest.max(judge.overlap(&now.poses, block, peg));
    });
    let at = ended.poses[peg].translation;
    let leans = tilt(DVec3::Z, &upright, &ended.poses[peg]);
    eprintln!(
        "peg at {at}, leans {leans:.4}, at most {most:.4}, deepest {deepest:.5}, {:?}",
        ended.summary.contacts
    );
    // On the floor of the well, at z = 5, flat: its centre is half its length above.
    assert!((at.z - (5.0 + 12.5)).abs() < OVERLAP, "{at}");
    assert!(at.truncate().length() < CLEARANCE + OVERLAP, "{at}");
    assert!(leans < 0.05, "{leans}: it stands on its end");
    assert!(deepest < OVERLAP, "{deepest}");
    assert!(most < lean(ENGAGED[0]));
    assert!(ended.summary.energy_drift.unwrap() < 0.01);
}
