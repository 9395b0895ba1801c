//! An arm takes a mug by its handle, carries it over and sets it down.

use cranny_ecs::RunOptions;
use cranny_exact::{DVec3, Pose};

use crate::overlap::Judge;
use crate::run::{asset, body, lowest, tilt, watch};

/// Of the exact overlap of hook and mug, metres: three times what a run shows.
const OVERLAP: f64 = 1e-3;

/// Degrees: the handle's hole is 0.03 wide and 0.095 high, the blade in it 0.022 and 0.055. It
/// leaves the handle 0.008 of play over 0.055: 8.3 degrees, and some in the rounded corners.
const LEAN: f64 = 12.0;

#[test]
fn the_arm_takes_the_mug_by_its_handle_and_sets_it_down() {
    let scene = asset("robot_cell.ron").description;
    let [mug, hook, table, shelf] =
        ["mug", "picker/hook", "table", "shelf"].map(|name| body(&scene, name));
    let judge = Judge::of(&scene);
    let top = |k: usize| -lowest(&scene, k, &scene.bodies[k].pose, -DVec3::Z);
    let (mut highest, mut most, mut deepest) = (f64::NEG_INFINITY, 0.0f64, 0.0f64);
    let ended = watch(&scene, &RunOptions::default(), |now| {
        highest = highest.max(lowest(&scene, mug, &now.poses[mug], DVec3::Z));
        most = most.max(tilt(DVec3::Z, &Pose::IDENTITY, &now.poses[mug]));
        if now.step.is_multiple_of(24) {
            deepest = deepest.max(judge.overlap(&now.poses, mug, hook));
        }
    });
    let pose = &ended.poses[mug];
    let (from, to) = (scene.bodies[mug].pose.translation, pose.translation);
    let (stands, leans) =
        (lowest(&scene, mug, pose, DVec3::Z), tilt(DVec3::Z, &Pose::IDENTITY, pose));
    eprintln!(
        "mug at {to}, {stands:.5} high, leans {leans:.3}, at most {most:.3}, up to {highest:.5}, deepest {deepest:.6}"
    );
    // Nothing but the hook holds it over the floor between table and shelf.
    assert!(highest > top(shelf) + 0.008 && highest > top(table) + 0.04, "{highest}");
    assert!((to - from).truncate().length() > 0.7, "{to}");
    assert!((stands - top(shelf)).abs() < 1e-3 && leans < 1.0, "{stands} {leans}");
    assert!(most < LEAN, "{most}");
    assert!(deepest < OVERLAP, "{deepest}");
}
