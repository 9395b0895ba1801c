//! Scenes of primitives: run, recorded, replayed, drawn; what is wrong with one.

use crate::harness::{Folder, argument, run};

/// A marble over a cup, and others over the ground.
const MARBLES: &str = r#"(
    step: 0.0083333333, duration: 1.5,
    bodies: [
        (name: "ground", shape: Primitive(HalfSpace()), kind: Fixed),
        (name: "cup", shape: Generator(Cup()), kind: Fixed, pose: (at: (0, 0, 0.5))),
        (name: "marble", shape: Primitive(Ball(radius: 0.15)), pose: (at: (0.1, 0, 1.6))),
        (name: "pill", shape: Primitive(Capsule(radius: 0.1, length: 0.3)), pose: (at: (2, 0, 0.5))),
        (name: "drum", shape: Primitive(Cylinder(radius: 0.2, height: 0.3)), pose: (at: (-2, 0, 0.5))),
    ],
    effects: [Response(), Trigger(), Contacts(margin: 0.005)],
)"#;

#[test]
fn marbles_run_are_recorded_and_come_out_the_same_to_the_bit() {
    let folder = Folder::new();
    let scene = folder.write("marbles.ron", MARBLES);
    let path = argument(&folder.path("marbles.mcap"));
    let checked = run(&["check", &scene]);
    assert_eq!(checked.code, Some(0), "{checked:?}");
    let ran = run(&["run", &scene, "--record", &path, "--format", "json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let summary = ran.json_lines().remove(0);
    let fired: Vec<[&str; 2]> = summary["triggers"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pair| [pair["a"].as_str().unwrap(), pair["b"].as_str().unwrap()])
        .collect();
    for pair in [["cup", "marble"], ["ground", "pill"], ["ground", "drum"]] {
        assert!(fired.contains(&pair), "{pair:?} {fired:?}");
    }
    let replayed = run(&["replay", &path, "--format", "json"]).json_lines().remove(0);
    assert!(replayed["same"].as_u64().unwrap() > 100, "{replayed}");
    assert_eq!(replayed["unknown"], 0, "{replayed}");
    assert_eq!(replayed["different"].as_array().unwrap().len(), 0, "{replayed}");
}

#[test]
fn a_wrong_primitive_is_refused_with_its_place() {
    let folder = Folder::new();
    let wrong = MARBLES.replace("Ball(radius: 0.15)", "Ball(radius: -0.15)");
    let scene = folder.write("marbles.ron", wrong);
    run(&["check", &scene]).assert_refused(2, &["marbles.ron, line 6", "-0.15", "greater than 0"]);
    let falling = MARBLES.replace("HalfSpace()), kind: Fixed", "HalfSpace()), kind: Dynamic");
    let scene = folder.write("marbles.ron", falling);
    let words = ["marbles.ron, line 4", "\"ground\"", "half-space has no mass", "Make it Fixed"];
    run(&["run", &scene]).assert_refused(2, &words);
}
