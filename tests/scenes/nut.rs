//! A nut on its bolt: it runs, and says how far it turned and how far it left the helix.

use cranny_ecs::RunOptions;

use crate::run::{asset, run};

#[test]
fn the_nut_reports_turns_and_deviation() {
    let scene = asset("nut_on_bolt.ron");
    let names: Vec<&str> = scene.description.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["bolt", "nut"]);
    let options = RunOptions {
        plugins: cranny_ecs::PluginOptions {
            helices: cranny_ecs::helices(&scene),
            ..Default::default()
        },
        duration: Some(0.1),
        ..RunOptions::default()
    };
    let summary = run(&scene, &options).summary;
    let [helix] = &summary.helices[..] else { panic!("{:?}", summary.helices) };
    eprintln!("nut: {helix:?}, deepest {:?}, wall {:.1} s", summary.deepest, summary.wall_s);
    assert_eq!((helix.bolt.as_str(), helix.nut.as_str(), helix.pitch), ("bolt", "nut", 2.0));
    assert!(helix.turns > 0.0 && helix.deviation_max.is_finite());
    // The thread holds it: it neither falls through nor tunnels into the next turn.
    assert!(helix.deviation_max < 1.0, "{helix:?}");
}
