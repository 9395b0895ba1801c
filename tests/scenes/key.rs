//! Keys: one turns its plug, one falls into its keyway, one is too thick.

use std::f64::consts::FRAC_PI_2;

use cranny_ecs::RunOptions;
use cranny_exact::{DVec3, Pose};

use crate::overlap::Judge;
use crate::run::{asset, body, tilt, watch};

const CLEARANCE: f64 = 0.01;

/// Of the exact overlap: a fifth of the clearance.
const OVERLAP: f64 = 2e-3;

fn angle(pose: &Pose) -> f64 {
    2.0 * pose.rotation.z.atan2(pose.rotation.w)
}

#[test]
fn the_right_key_enters_and_turns_and_the_wrong_one_does_not() {
    let scene = asset("key_in_lock.ron").description;
    let [plate, plug, key, keyway, enters, barrier, barred] = [
        "plate",
        "plug_turned",
        "key_turned",
        "plug_entered",
        "key_entered",
        "plug_barred",
        "key_barred",
    ]
    .map(|name| body(&scene, name));
    let judge = Judge::of(&scene);
    let (mut deepest, mut behind, mut most) = (0.0f64, 0.0f64, 0.0f64);
    let ended = watch(&scene, &RunOptions::default(), |now| {
        for (a, b) in [(key, plug), (enters, keyway), (enters, plate), (barred, barrier)] {
            deepest = deepest.max(judge.overlap(&now.poses, a, b));
        }
        behind = behind.max((angle(&now.poses[key]) - angle(&now.poses[plug])).abs());
        most = most.max(tilt(DVec3::Z, &Pose::IDENTITY, &now.poses[enters]));
    });
    let at = |k: usize| ended.poses[k].translation;
    eprintln!(
        "key turned by {:.4}, plug by {:.4}, never off by more than {behind:.4}; entered at {}, leaning by {most:.4} at most; barred at {}; deepest {deepest:.5}",
        angle(&ended.poses[key]),
        angle(&ended.poses[plug]),
        at(enters),
        at(barred)
    );
    // An L turned in an L that is wider by c meets it first at the corner farthest along a side
    // from the centroid: 0.8 − (0.24 · 0.4 + 0.15 · 0.15) / 0.39 = 0.496, and the angle is
    // c / 0.496.
    let lever = 0.8 - (0.24 * 0.4 + 0.15 * 0.15) / 0.39;
    let play = (CLEARANCE + OVERLAP) / lever;
    assert!((angle(&ended.poses[key]) - FRAC_PI_2).abs() < 0.01, "a quarter of a turn");
    assert!(behind < play, "{behind}, at most {play}");
    assert!((angle(&ended.poses[plug]) - FRAC_PI_2).abs() < play + 0.01);
    // Down to the plate, at z = −0.3, with half its length above; leaning within the 0.5 of the
    // plug.
    assert!(
        (at(enters) - DVec3::new(0.0, 0.0, 0.3)).length() < CLEARANCE + OVERLAP,
        "{}",
        at(enters)
    );
    assert!(most < (2.0 * (CLEARANCE + OVERLAP) / 0.25f64).atan().to_degrees(), "{most}");
    assert!(tilt(DVec3::Z, &Pose::IDENTITY, &ended.poses[enters]) < 0.1);
    // On top of the plug, at z = 0.25.
    assert!((at(barred) - DVec3::new(3.0, 0.0, 0.85)).length() < 0.01, "{}", at(barred));
    assert!(tilt(DVec3::Z, &Pose::IDENTITY, &ended.poses[barred]) < 0.5);
    assert!(deepest < OVERLAP, "{deepest}");
}
