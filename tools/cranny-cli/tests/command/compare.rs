//! What `compare` reports of a scene under several detectors.

use std::fs;

use serde_json::Value;

use crate::harness::{Folder, argument, run};

/// Two links of a chain, the lower one falling into the upper; and nothing wanted but that it
/// happens.
const LINKS: &str = r#"(
    step: 0.004166666666666667, duration: 0.25,
    bodies: [
        (name: "upper", shape: Generator(Torus(minor_radius: 0.2, major_segments: 24, minor_segments: 8)), kind: Fixed),
        (name: "lower", shape: Generator(Torus(minor_radius: 0.2, major_segments: 24, minor_segments: 8)),
         pose: (at: (1.45, 0, 0), rotation: (0.7071067811865476, 0, 0, 0.7071067811865476))),
    ],
    gravity: (9.81, 0, 0),
    effects: [Response()],
)"#;

fn texts<'a>(rows: &'a [Value], field: &str) -> Vec<&'a str> {
    rows.iter().map(|row| row[field].as_str().unwrap()).collect()
}

#[test]
fn all_detectors_run_the_same_scene_and_are_judged_alike() {
    let folder = Folder::new();
    let scene = folder.write("links.ron", LINKS);
    let out = argument(&folder.path("report"));
    let rows = run(&["compare", &scene, "--format", "json", "--out", &out]).json_lines();
    assert_eq!(
        texts(&rows, "detector"),
        ["cranny", "rapier-trimesh", "rapier-trimesh-fixed", "rapier-decomposition"]
    );
    for row in &rows {
        assert_eq!(row["steps"], 60, "{row}");
        assert_eq!(row["links"]["at_start"], 1, "{row}");
        assert_eq!(row["failure"], Value::Null, "{row}");
        // It falls into the other, and is held there.
        assert!(row["deepest"]["depth"].as_f64().unwrap() < 0.1, "{row}");
        assert!(row["energy"]["loss"].as_f64().unwrap() > 0.9, "{row}");
        assert!(row["contacts"]["mean"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["step_ms"]["mean"].as_f64().unwrap() > 0.0, "{row}");
    }
    assert!(rows.iter().any(|row| row["deepest"]["depth"].as_f64().unwrap() > 0.0), "{rows:?}");
    let shares: Vec<bool> = rows.iter().map(|row| row["carried_share"].is_number()).collect();
    assert_eq!(shares, [true, false, false, false], "only ours carries contacts on: {rows:?}");
    assert_eq!(rows[0]["recycling"], true);
    assert_eq!(rows[1]["recycling"], true);
    // What is compared is what `run` does.
    for (row, detector) in rows.iter().zip(["cranny", "rapier-trimesh"]) {
        let alone = run(&["run", &scene, "--detector", detector, "--format", "json"]).json_lines();
        assert_eq!(alone[0]["state_hash"], row["state_hash"], "{detector}");
        assert_eq!(alone[0]["links"], row["links"], "{detector}");
    }

    let read = |name: &str| fs::read_to_string(folder.path("report").join(name)).unwrap();
    let csv = read("compare.csv");
    assert_eq!(csv.lines().count(), 5);
    assert!(csv.lines().nth(2).unwrap().starts_with("rapier-trimesh,true,"), "{csv}");
    assert_eq!(read("steps.csv").lines().count(), 1 + 4 * 60);
    assert!(read("compare.svg").contains("rapier-decomposition"));
}

#[test]
fn recycling_is_compared_where_it_is_asked_for() {
    let folder = Folder::new();
    let scene = folder.write("links.ron", LINKS);
    let options = ["--detector", "rapier-trimesh", "--recycling", "both", "--duration", "0.05"];
    let found = run(&[&["compare", &scene][..], &options].concat());
    assert_eq!(found.code, Some(0), "{found:?}");
    let lines: Vec<&str> = found.stdout.lines().collect();
    assert!(lines[0].starts_with("links (") && lines[0].contains("links.ron, seed 0"), "{found:?}");
    assert!(lines[0].ends_with("0.05 s in steps of 0.004167 s"), "{found:?}");
    assert!(lines[3].starts_with("detector") && lines[3].contains("kept"), "{found:?}");
    assert!(lines[4].starts_with("rapier-trimesh  ") && lines[4].ends_with("1 of 1"), "{found:?}");
    assert!(lines[5].starts_with("rapier-trimesh, not recycled"), "{found:?}");
    assert!(found.stdout.ends_with("--help` explains the columns\n"), "{found:?}");
    assert!(!found.stdout.contains("screw"), "nobody turns on anything: {found:?}");
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = Folder::new();
    let still = LINKS.replace("Response()", "Contacts(margin: 0.1)");
    let scene = folder.write("still.ron", still);
    run(&["compare", &scene])
        .assert_refused(2, &["still.ron", "nothing in it responds", "Response()"]);
    let scene = folder.write("links.ron", LINKS);
    let file = folder.write("file", "");
    run(&["compare", &scene, "--out", &file]).assert_refused(1, &["file", "cannot be made"]);
    for wrong in [["--detector", "bullet"], ["--recycling", "never"], ["--duration", "0"]] {
        assert_eq!(run(&[&["compare", &scene][..], &wrong].concat()).code, Some(2), "{wrong:?}");
    }
    assert_eq!(run(&["compare", "nowhere.ron"]).code, Some(2));
}
