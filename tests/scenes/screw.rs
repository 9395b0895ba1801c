//! Two screws are turned into their nuts: one that stands straight goes home, one that leans jams.

use cranny_ecs::{HelixSummary, PluginOptions, RunOptions, helices};

use crate::overlap::Judge;
use crate::run::{asset, body, watch};

/// Where the nuts' upper faces are.
const NUT_TOP: f64 = 5.0;

/// Of the exact overlap of a screw and its nut, mm, of threads that are 1.6 deep: that of the screw
/// that jams, against which its hand keeps turning. A run shows 0.19.
const OVERLAP: f64 = 0.4;

#[test]
fn a_straight_screw_goes_home_and_a_leaning_one_jams() {
    let loaded = asset("screw_insertion.ron");
    let options = RunOptions {
        plugins: PluginOptions { helices: helices(&loaded), ..PluginOptions::default() },
        ..RunOptions::default()
    };
    let scene = loaded.description;
    let judge = Judge::of(&scene);
    let [straight, tilted] = ["straight", "tilted"]
        .map(|which| ["nut", "screw"].map(|what| body(&scene, &format!("{what}_{which}"))));
    let mut deepest = 0.0f64;
    let ended = watch(&scene, &options, |now| {
        if now.step.is_multiple_of(48) {
            for [nut, screw] in [straight, tilted] {
                deepest = deepest.max(judge.overlap(&now.poses, nut, screw));
            }
        }
    });
    let turns = |which: &str| {
        let own = |helix: &&HelixSummary| {
            helix.nut == format!("nut_{which}") && helix.bolt == format!("screw_{which}")
        };
        ended.summary.helices.iter().find(own).expect("threads that fit each other").turns
    };
    // The underside of the head is the screw's origin.
    let head = |[_, screw]: [usize; 2]| ended.poses[screw].translation.z - NUT_TOP;
    eprintln!(
        "straight: {:.3} turns, head {:.4} above its nut; tilted: {:.3} turns, {:.4}; deepest {deepest:.4}",
        turns("straight"),
        head(straight),
        turns("tilted"),
        head(tilted)
    );
    // 14 mm are 4.67 turns of 3 mm; it starts up to a turn into the thread.
    assert!(head(straight).abs() < 0.1, "{}", head(straight));
    assert!(turns("straight") < -3.6 && turns("straight") > -4.8, "{}", turns("straight"));
    assert!(head(tilted) > 10.0, "{}", head(tilted));
    assert!(turns("tilted") > -1.0, "{}", turns("tilted"));
    assert!(deepest < OVERLAP, "{deepest}");
}
