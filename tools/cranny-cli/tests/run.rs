//! End-to-end tests of `cranny run`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use cranny_record::{Recording, StatsMessage};
use serde_json::Value;
use tempfile::TempDir;

/// A box that falls a quarter of a unit on a fixed one.
const DROP: &str = r#"(
    step: 0.015625, duration: 0.5, seed: 3,
    bodies: [
        (name: "floor", shape: Generator(Cuboid(size: (1, 1, 1))), kind: Fixed),
        (name: "box", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (0.125, 0, 1.25)),
         velocity: (angular: (0, 0, 0.5))),
    ],
    effects: [Response(), Contacts(margin: 0.001), Trigger()],
    record: (every: 8),
)"#;

fn scene() -> (TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drop.ron");
    fs::write(&path, DROP).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (folder, path)
}

fn cranny(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cranny"));
    command.env_remove("RUST_LOG").stdin(Stdio::null());
    command.args(arguments).output().unwrap()
}

/// The last line of standard output; the command must have succeeded.
fn summary(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let stdout = str::from_utf8(&output.stdout).unwrap();
    serde_json::from_str(stdout.lines().last().unwrap()).unwrap()
}

fn run_json(scene: &str, more: &[&str]) -> Value {
    summary(&cranny(&[&["run", scene, "--format", "json"], more].concat()))
}

fn assert_refused(output: &Output, code: i32, words: &[&str]) {
    let stderr = str::from_utf8(&output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{output:?}");
    assert!(output.stdout.is_empty() && !stderr.contains("panicked"), "{output:?}");
    for word in words {
        assert!(stderr.contains(word), "{word:?} is missing in {stderr}");
    }
}

/// A stone passes a gate that only notices it and falls out of the world; another one is stuck in
/// a fixed one from the start.
#[test]
fn the_summary_says_what_happened() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fall.ron");
    let text = r#"(gravity: (0, 0, -10), step: 0.015625, duration: 1.5, bodies: [
        (name: "gate", shape: Generator(Cuboid(size: (2, 2, 0.5))), kind: Fixed, sensor: true),
        (name: "stone", shape: Generator(Cuboid(size: (0.5, 0.5, 0.5))), pose: (at: (0, 0, 1))),
        (name: "wall", shape: Generator(Cuboid(size: (1, 1, 1))), kind: Fixed, pose: (at: (4, 0, 0))),
        (name: "bird", shape: Generator(Cuboid(size: (0.1, 0.1, 0.1))), kind: Kinematic, pose: (at: (0, 0.9, 1)), velocity: (linear: (0, 50, 50))),
        (name: "stuck", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (4, 0, 0.875))),
    ], effects: [Response(), Contacts(margin: 0)],
       pairs: [(a: "gate", b: "stone", effects: [Trigger()])])"#;
    fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap();
    let line = run_json(path, &[]);
    let first = &line["first_overlap"];
    assert_eq!(
        (&first["a"], &first["b"], &first["step"]),
        (&"wall".into(), &"stuck".into(), &0.into())
    );
    assert!((first["depth"].as_f64().unwrap() - 0.125).abs() < 1e-6, "{first}");
    let [start] = line["overlaps_at_start"].as_array().unwrap().as_slice() else {
        panic!("{line}")
    };
    assert_eq!((&start["a"], &start["b"]), (&"wall".into(), &"stuck".into()));
    assert!((start["depth"].as_f64().unwrap() - 0.125).abs() < 1e-6, "{start}");
    let [trigger] = line["triggers"].as_array().unwrap().as_slice() else { panic!("{line}") };
    assert_eq!(
        (&trigger["a"], &trigger["b"], &trigger["times"]),
        (&"gate".into(), &"stone".into(), &1.into())
    );
    // 0.5 down: after sqrt(0.1) s.
    let step = trigger["step"].as_u64().unwrap();
    assert!((19..=21).contains(&step), "{trigger}");
    let [left] = line["left"].as_array().unwrap().as_slice() else { panic!("{line}") };
    assert_eq!(left["body"], "stone");
    // The world: about 5.6 wide and 1.9 high; it ends its diagonal below the wall, at -6.4.
    let fallen = left["step"].as_f64().unwrap() * 0.015625;
    assert!((1.0 - 5.0 * fallen * fallen + 6.4).abs() < 0.5, "{fallen}");
    let text = String::from_utf8(cranny(&["run", path]).stdout).unwrap();
    for words in [
        "- first    0.125000 between wall and stuck, after 0 steps",
        "triggers   gate and stone began to touch once, after ",
        "left       stone left the world after ",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    // Nothing of it in a scene where nothing of it happens.
    let (_folder, calm) = scene();
    let line = run_json(&calm, &[]);
    assert_eq!(
        (line["left"].as_array().unwrap().len(), line["triggers"][0]["times"].as_u64()),
        (0, Some(1))
    );
}

#[test]
fn the_summary_has_every_field_of_the_contract() {
    let (_folder, scene) = scene();
    let line = run_json(&scene, &[]);
    let fields = [
        "version",
        "scene",
        "scene_hash",
        "detector",
        "accuracy",
        "threads",
        "seed",
        "steps",
        "dt",
        "simulated_s",
        "wall_s",
        "real_time_factor",
        "time_ms",
        "pairs",
        "contacts",
        "deepest",
        "energy_drift",
        "state_hash",
        "outputs",
        "skipped",
        "interrupted",
    ];
    for field in fields {
        assert!(line.get(field).is_some(), "{field} is missing in {line}");
    }
    for phase in ["broad", "narrow", "solver", "record", "render"] {
        assert!(line["time_ms"][phase].as_f64().unwrap() >= 0.0);
    }
    assert_eq!((line["steps"].as_u64(), line["seed"].as_u64()), (Some(32), Some(3)));
    assert_eq!(line["simulated_s"], 0.5);
    assert_eq!(
        (line["detector"].as_str(), line["accuracy"].as_str()),
        (Some("cranny"), Some("exact"))
    );
    assert_eq!(
        (&line["interrupted"], line["outputs"].as_array().map(Vec::len)),
        (&false.into(), Some(0))
    );
    let depth = line["deepest"]["depth"].as_f64().unwrap();
    assert!((0.0..0.05).contains(&depth), "{line}");
    assert!(line["energy_drift"].as_f64().unwrap() < 0.01, "{line}");
    assert!(line["contacts"]["max"].as_u64().unwrap() >= 3, "{line}");
    let motion = &line["motion"][0];
    assert_eq!(motion["body"], "box");
    assert!((motion["displacement"][2].as_f64().unwrap() + 0.25).abs() < 0.02, "{motion}");
    // The same command gives the same state; neither a seed that nothing reads nor threads change
    // it.
    let again = run_json(&scene, &["--seed", "7", "--threads", "3"]);
    assert_eq!(again["state_hash"], line["state_hash"]);
    assert_eq!(
        (&line["threads"], &again["threads"], &again["seed"]),
        (&1.into(), &3.into(), &7.into())
    );
}

#[test]
fn step_and_duration_replace_the_scenes() {
    let (_folder, scene) = scene();
    let line = run_json(&scene, &["--dt", "0.03125", "--duration", "0.25"]);
    assert_eq!((line["steps"].as_u64(), line["dt"].as_f64()), (Some(8), Some(0.03125)));
}

#[test]
fn every_detector_runs_and_exact_reports_stay() {
    let (_folder, scene) = scene();
    for detector in ["cranny", "rapier-trimesh", "rapier-trimesh-fixed", "rapier-decomposition"] {
        let line = run_json(&scene, &["--detector", detector]);
        assert_eq!(line["detector"], detector);
        assert!(line["deepest"]["depth"].as_f64().unwrap() < 0.05, "{line}");
    }
}

#[test]
fn the_recording_ends_with_the_final_poses() {
    let (folder, scene) = scene();
    let path = folder.path().join("drop.mcap");
    let line = run_json(&scene, &["--record", path.to_str().unwrap()]);
    assert_eq!(line["outputs"][0], path.to_str().unwrap());
    let recording = Recording::open(&path).unwrap();
    assert!(recording.is_complete() && !recording.was_interrupted());
    let frames = recording.transforms().unwrap();
    // Steps 0, 8, 16, 24 and the end, 32.
    assert_eq!(frames.iter().map(|f| f.0 / 15_625_000).collect::<Vec<_>>(), [0, 8, 16, 24, 32]);
    let moved = frames[4].1["box"].translation - frames[0].1["box"].translation;
    for (axis, expected) in moved.to_array().into_iter().enumerate() {
        assert_eq!(line["motion"][0]["displacement"][axis].as_f64(), Some(expected));
    }
    assert_eq!(recording.attachments()[0].data, DROP.as_bytes());
    assert!(recording.events().unwrap().iter().any(|(_, message)| !message.events.is_empty()));
}

#[test]
fn the_text_summary_names_what_matters() {
    let (_folder, scene) = scene();
    let output = cranny(&["run", &scene]);
    let text = String::from_utf8(output.stdout).unwrap();
    for word in ["drop", "32 steps", "real time", "narrow", "deepest", "energy", "box by"] {
        assert!(text.contains(word), "{word:?} is missing in {text}");
    }
}

/// A hook on the way through a ring, which it does not touch though their hulls overlap.
const THROUGH: &str = r#"(
    step: 0.0625, duration: 2,
    bodies: [
        (name: "ring", shape: Generator(Torus(major_radius: 1, minor_radius: 0.2)), kind: Fixed),
        (name: "bar", shape: Generator(Cuboid(size: (0.3, 0.3, 1))), kind: Kinematic,
         pose: (at: (0.1, 0, -1.5)), velocity: (linear: (0, 0, 1.5))),
        (name: "wall", shape: Generator(Cuboid(size: (2, 2, 0.2))), kind: Fixed, pose: (at: (0, 0, 1.5))),
    ],
    effects: [Trigger(), Proximity(within: 0.7)],
)"#;

/// What exact answers find every level finds; the summary says what was open, what it took and
/// what it would have taken.
#[test]
fn levels_and_budgets_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("through.ron");
    fs::write(&path, THROUGH).unwrap();
    let path = path.to_str().unwrap();
    let exact = run_json(path, &[]);
    assert_eq!((&exact["accuracy"], &exact["budget"]), (&"exact".into(), &Value::Null));
    assert_eq!(exact["estimates"], Value::Null);
    let named = |line: &Value| {
        let triggers = line["triggers"].as_array().unwrap().clone();
        triggers.iter().map(|t| [t["a"].clone(), t["b"].clone()]).collect::<Vec<_>>()
    };
    assert_eq!(named(&exact), [["bar", "wall"]]);
    for more in [
        ["--accuracy", "boxes"],
        ["--accuracy", "hulls"],
        ["--accuracy", "caps"],
        ["--accuracy", "tree:3"],
        ["--budget", "0"],
        ["--budget", "60"],
    ] {
        let line = run_json(path, &more);
        assert!(named(&line).contains(&["bar".into(), "wall".into()]), "{more:?}: {line}");
        assert_eq!(line["state_hash"], exact["state_hash"]);
        assert!(line["estimates"]["pairs"]["mean"].as_f64().unwrap() > 0.0, "{line}");
        let open = line["estimates"]["open"]["mean"].as_f64().unwrap();
        let told = line["triggers"].as_array().unwrap().iter().any(|t| t["open"] != 0);
        assert_eq!(open > 0.0, told, "{more:?}: {line}");
        let level = if more[0] == "--accuracy" { more[1] } else { "exact" };
        assert_eq!(line["accuracy"], level);
        if more[0] == "--budget" {
            assert_eq!(line["budget"].to_string(), more[1]);
            let tests = line["tests"]["max"].as_u64().unwrap();
            assert!(
                tests <= more[1].parse().unwrap() && line["estimates"]["tests"]["max"] == tests
            );
        }
    }
    let text = cranny(&["run", path, "--accuracy", "hulls", "--budget", "500"]);
    let text = String::from_utf8(text.stdout).unwrap();
    for word in ["cranny, hulls, 500 tests a step", "counted as touching", "of them open"] {
        assert!(text.contains(word), "{word:?} is missing in {text}");
    }
    let twice = ["--budget", "60", "--threads", "2"];
    let [one, other] = [&twice[..2], &twice[..]].map(|more| run_json(path, more));
    assert_eq!(one["estimates"], other["estimates"]);
    assert_eq!(one["triggers"], other["triggers"]);
}

/// The recording says at which level it was made, and which events are open; a replay says what it
/// cannot compute anew.
#[test]
fn a_recording_says_at_which_level_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("through.ron");
    fs::write(&path, THROUGH).unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (path, recording) = (at("through.ron"), at("through.mcap"));
    let of_run = ["--accuracy", "hulls", "--budget", "500", "--record", &recording];
    run_json(&path, &of_run);
    let opened = Recording::open(&recording).unwrap();
    let metadata = opened.metadata("cranny").unwrap();
    assert_eq!((&*metadata["accuracy"], &*metadata["budget"]), ("hulls", "500"));
    let events: Vec<_> = opened.events().unwrap().into_iter().flat_map(|(_, e)| e.events).collect();
    assert!(events.iter().any(|event| event.kind == "began" && event.open), "{events:?}");
    assert!(events.iter().all(|event| event.kind == "began" || !event.open), "{events:?}");
    let stats = opened.stats().unwrap();
    let count = |of: fn(&StatsMessage) -> bool| stats.iter().filter(|(_, stats)| of(stats)).count();
    assert!(count(|stats| stats.estimated_pairs > 0 && stats.estimate_tests > 0) > 0);
    assert!(count(|stats| stats.open_pairs > 0) > 0);
    let text = String::from_utf8(cranny(&["replay", &recording]).stdout).unwrap();
    assert!(text.contains("hulls, 500 tests a step: they depend on what"), "{text}");
    // Triggers alone leave nothing to compare.
    let replayed = cranny(&["replay", &recording, "--format", "json"]);
    assert_eq!(replayed.status.code(), Some(1), "{replayed:?}");
    let line: Value = serde_json::from_slice(&replayed.stdout).unwrap();
    assert_eq!((&line["accuracy"], &line["budget"]), (&"hulls".into(), &"500".into()));
    // An exact one says nothing of the kind.
    let exact = at("exact.mcap");
    run_json(&path, &["--record", &exact]);
    let text = String::from_utf8(cranny(&["replay", &exact]).stdout).unwrap();
    assert!(!text.contains("not anew"), "{text}");
}

#[test]
fn levels_and_budgets_that_mean_nothing_are_refused() {
    let (_folder, scene) = scene();
    let refused = |arguments: [&str; 2], words: &[&str]| {
        for command in ["run", "explain"] {
            let output = cranny(&[&[command, &*scene][..], &arguments].concat());
            assert_refused(&output, 2, words);
        }
    };
    refused(["--accuracy", "perfect"], &["--accuracy", "boxes, hulls, caps, tree:DEPTH or exact"]);
    refused(["--accuracy", "tree"], &["how deep"]);
    for none in ["-1", "1.5", "much"] {
        refused(["--budget", none], &["--budget", none, "whole number", "unlimited"]);
    }
    // The scene has contacts and a solver.
    refused(["--accuracy", "hulls"], &["`--accuracy hulls`", "Response needs exact contacts"]);
    refused(["--budget", "100"], &["`--budget 100`", "Response needs exact contacts"]);
    assert_eq!(run_json(&scene, &["--accuracy", "exact", "--budget", "unlimited"])["steps"], 32);
    for none in ["0", "two"] {
        let refused = cranny(&["run", &scene, "--threads", none]);
        assert_refused(&refused, 2, &["--threads", none, "1 or more"]);
    }
    assert_refused(&cranny(&["run", "nowhere.ron"]), 2, &["nowhere.ron"]);
}

#[test]
fn unwritable_outputs_are_refused_before_anything_runs() {
    let (folder, scene) = scene();
    let missing = folder.path().join("missing");
    for (flag, name) in [("--record", "out.mcap"), ("--preview", "out.png")] {
        let file: PathBuf = missing.join(name);
        let refused = cranny(&["run", &scene, flag, file.to_str().unwrap()]);
        assert_refused(&refused, 1, &[flag, file.to_str().unwrap(), "there is no folder"]);
        let refused = cranny(&["run", &scene, flag, folder.path().to_str().unwrap()]);
        assert_refused(&refused, 1, &[flag, "it is a folder"]);
        // A name that does not say what is written.
        let other = folder.path().join("out.txt");
        let refused = cranny(&["run", &scene, flag, other.to_str().unwrap()]);
        let known = &name[3..];
        assert_refused(&refused, 2, &[flag, other.to_str().unwrap(), "must end in", known]);
    }
    let refused = cranny(&["run", &scene, "--frames", &scene]);
    assert_refused(&refused, 2, &[&scene, "it is the input"]);
    let occupied = folder.path().join("occupied");
    fs::write(&occupied, "a file").unwrap();
    let refused = cranny(&["run", &scene, "--frames", occupied.to_str().unwrap()]);
    assert_refused(&refused, 1, &[occupied.to_str().unwrap()]);
    fs::remove_file(&occupied).unwrap();
    assert_eq!(names(folder.path()), ["drop.ron"]);
}

/// Also where no graphics adapter would have looked for it.
#[test]
fn a_camera_that_draws_nothing_is_refused_before_anything_runs() {
    let (folder, scene) = scene();
    let out = folder.path().join("out.mcap").to_str().unwrap().to_owned();
    let refused = cranny(&["run", &scene, "--record", &out, "--camera", "zz"]);
    assert_refused(&refused, 2, &["--camera zz", "main, isometric, front, side, top"]);
    let refused = cranny(&["run", &scene, "--camera", "front"]);
    assert_refused(&refused, 2, &["--camera front", "Add --frames, --preview or --record"]);
    assert_eq!(names(folder.path()), ["drop.ron"]);
}

/// Standard error is no terminal here.
#[test]
fn warnings_show_unless_they_are_silenced() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("overlap.ron");
    fs::write(&scene, DROP.replace("at: (0.125, 0, 1.25)", "at: (0.125, 0, 0.75)")).unwrap();
    let scene = scene.to_str().unwrap();
    let stderr = |more: &[&str]| {
        let output = cranny(&[&["run", scene, "--duration", "0.01"], more].concat());
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(stderr(&[]).contains("WARN") && stderr(&[]).contains("overlap by"), "{}", stderr(&[]));
    assert_eq!(stderr(&["--quiet"]), "");
}

#[test]
fn outputs_replace_no_input_and_each_other_neither() {
    let (folder, scene) = scene();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    assert_refused(&cranny(&["run", &scene, "--record", &scene]), 2, &["drop.ron", "input"]);
    let both = at("both");
    let twice = ["run", &scene, "--record", &both, "--preview", &both];
    assert_refused(&cranny(&twice), 2, &["both", "two outputs"]);
    assert_refused(&cranny(&["run", &scene, "--dt", "1e-300"]), 2, &["1e-300", "a step must last"]);
    assert_eq!(fs::read_to_string(&scene).unwrap(), DROP);
    assert_eq!(names(folder.path()), ["drop.ron"]);
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
}

#[cfg(unix)]
#[test]
fn ctrl_c_completes_the_recording_and_the_summary_says_so() {
    a_signal_completes_the_recording("-INT");
}

#[cfg(unix)]
#[test]
fn the_signal_that_ends_jobs_does_as_well() {
    a_signal_completes_the_recording("-TERM");
}

#[cfg(unix)]
fn a_signal_completes_the_recording(signal: &str) {
    let (folder, scene) = scene();
    let path = folder.path().join("drop.mcap");
    let partial = folder.path().join("drop.mcap.partial");
    let run = Command::new(env!("CARGO_BIN_EXE_cranny"))
        .args(["run", &scene, "--format", "json", "--duration", "1e6", "--record"])
        .arg(&path)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The partial file is there once the run has begun to listen to signals.
    while !partial.exists() {
        std::thread::yield_now();
    }
    let sent = Command::new("kill").args([signal, &run.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let line = summary(&run.wait_with_output().unwrap());
    assert_eq!(line["interrupted"], true);
    assert!(line["steps"].as_u64().unwrap() < 64_000_000);
    let recording = Recording::open(&path).unwrap();
    assert!(recording.is_complete() && recording.was_interrupted());
    assert!(!partial.exists());
}

/// An arm that is stretched out level: a frame of nothing, links with an open mesh and with none,
/// two fingers of which one follows.
const ARM: &str = r#"<robot name="arm">
  <link name="base"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="frame"/>
  <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="8"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="lower"><collision><geometry><mesh filename="sheet.obj"/></geometry></collision>
    <inertial><origin xyz="0.2 0 0"/><mass value="3"/>
    <inertia ixx="0.004" ixy="0" ixz="0" iyy="0.04" iyz="0" izz="0.04"/></inertial></link>
  <link name="left"><collision><origin xyz="0.05 0.1 0"/><geometry><box size="0.1 0.02 0.02"/></geometry></collision></link>
  <link name="right"><collision><origin xyz="0.05 -0.1 0"/><geometry><box size="0.1 0.02 0.02"/></geometry></collision></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="frame"/>
    <origin xyz="0 0 0.2"/><axis xyz="0 0 1"/></joint>
  <joint name="lift" type="revolute"><parent link="frame"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="EFFORT" velocity="2"/></joint>
  <joint name="bend" type="continuous"><parent link="upper"/><child link="lower"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 1 0"/><dynamics damping="0.5" friction="0.1"/></joint>
  <joint name="open" type="revolute"><parent link="lower"/><child link="left"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
  <joint name="follow" type="revolute"><parent link="lower"/><child link="right"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5" velocity="2"/>
    <mimic joint="open" multiplier="-1"/></joint>
</robot>"#;

#[test]
fn the_motors_of_a_robot_hold_as_far_as_their_effort_goes() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("sheet.obj", "v 0 -0.02 0\nv 0.4 -0.02 0\nv 0.4 0.02 0\nv 0 0.02 0\nf 1 2 3\nf 1 3 4\n");
    let scene = folder.path().join("arm.ron");
    // Shoulder: (8 * 0.2 + 3 * 0.6) * 9.81 = 33.4, and the fingers.
    for (effort, held) in [("50", true), ("20", false)] {
        write("arm.urdf", &ARM.replace("EFFORT", effort));
        let robot = r#"path: "arm.urdf", material: (density: 1000), targets: {"open": 0.4}"#;
        let text = format!("(robots: [({robot})], effects: [Response()], duration: 1)");
        fs::write(&scene, text).unwrap();
        let line = run_json(scene.to_str().unwrap(), &[]);
        let joints = line["joints"].as_array().unwrap();
        assert_eq!(joints.len(), 4, "{joints:?}");
        for joint in joints {
            let (off, strained) =
                (joint["off"].as_f64().unwrap(), joint["strained"].as_u64().unwrap());
            if held {
                assert!(off < 1e-3 && strained == 0, "{joint}");
            } else if joint["joint"] == "arm/lift" {
                assert!(off > 0.1 && strained > 100, "{joint}");
            }
        }
        let text = cranny(&["run", scene.to_str().unwrap()]);
        let text = str::from_utf8(&text.stdout).unwrap();
        assert!(text.contains("joints     4 held, at most"), "{text}");
        assert_eq!(text.contains("motor of arm/lift was at its greatest effort"), !held, "{text}");
    }
    let checked = cranny(&["check", scene.to_str().unwrap()]);
    let said = str::from_utf8(&checked.stdout).unwrap();
    assert!(said.contains("warning: ") && said.contains("\"arm/frame\""), "{said}");
}

/// A stylus whose device errs by 2 mm: what filtering does to its contacts.
#[test]
fn contacts_of_a_tracked_body_are_counted_beside_the_truth() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scenes/imprecise_tracking.ron");
    let line = run_json(scene, &["--quiet"]);
    let [stylus] = line["tracking"].as_array().unwrap().as_slice() else { panic!("{line}") };
    let count = |way: &str, what: &str| stylus[way][what].as_u64().unwrap();
    assert_eq!((&stylus["body"], &stylus["truth"]), (&"stylus".into(), &3.into()), "{stylus}");
    let wrong = ["spurious", "repeated", "cut_short", "late", "missed"];
    assert_eq!(count("filtered", "contacts"), 3, "{stylus}");
    assert_eq!(wrong.map(|wrong| count("filtered", wrong)), [0; 5], "{stylus}");
    assert_eq!(stylus["refused"], 0, "{stylus}");
    assert!(count("raw", "spurious") > 20 && count("raw", "repeated") > 0, "{stylus}");
    let [trigger] = line["triggers"].as_array().unwrap().as_slice() else { panic!("{line}") };
    assert_eq!(trigger["times"], 3);
    assert_eq!(run_json(scene, &["--quiet"])["state_hash"], line["state_hash"]);
    assert_ne!(run_json(scene, &["--quiet", "--seed", "2"])["state_hash"], line["state_hash"]);
    let text = cranny(&["run", scene, "--quiet"]);
    let text = str::from_utf8(&text.stdout).unwrap();
    for said in [
        "stylus truly makes 3 contacts; ",
        "filtered poses make 3: 0 spurious, 0 repeated, 0 cut short",
    ] {
        assert!(text.contains(said), "{said:?} is missing in {text}");
    }
}

#[test]
fn a_tracker_that_cannot_be_is_refused_by_name_with_its_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tracked.ron");
    let refused = |path_of: &str, tracker: &str, effects: &str, words: &[&str]| {
        let text = format!(
            "(bodies: [\n(name: \"hand\", shape: Generator(Cuboid()), kind: Kinematic,{path_of} tracker: ({tracker}), effects: [{effects}])])"
        );
        fs::write(&path, text).unwrap();
        let path = path.to_str().unwrap();
        for command in ["check", "run"] {
            assert_refused(&cranny(&[command, path]), 2, words);
        }
    };
    let on = " path: (keyframes: [(time: 0)]),";
    let both = "Trigger(), Tracking(tolerance: 1)";
    let device = "device: (rate: 100)";
    refused("", device, both, &["hand", "path", "line 2"]);
    refused(on, device, "Trigger()", &["hand", "Tracking(tolerance"]);
    refused(on, device, "Tracking(tolerance: 1)", &["Tracking needs Trigger"]);
    refused(on, "device: (rate: 5)", both, &["hand", "lost_after", "line 2"]);
    refused(on, "device: (rate: 0)", both, &["greater than 0", "line 2"]);
    refused(on, "device: (rate: 9, dropouts: 1.5)", both, &["from 0 to 1", "1.5", "line 2"]);
    refused(on, "", both, &["device", "line 2"]);
}

/// The summary of a scene that is written here, and its text.
fn summed_up(scene: &str) -> (Value, String) {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.ron");
    fs::write(&path, scene).unwrap();
    let path = path.to_str().unwrap();
    let text = cranny(&["run", path]);
    (run_json(path, &[]), String::from_utf8(text.stdout).unwrap())
}

#[test]
fn what_a_sensor_overlaps_is_no_fault() {
    let (summary, text) = summed_up(
        r#"(duration: 1, bodies: [
            (name: "zone", shape: Generator(Cuboid()), kind: Fixed, sensor: true),
            (name: "ball", shape: Primitive(Ball(radius: 0.1)), pose: (at: (0, 0, 1))),
        ], effects: [Response(), Trigger(), Contacts()])"#,
    );
    assert_eq!(summary["deepest"]["depth"], 0.0, "{summary}");
    assert_eq!((&summary["contained"], &summary["first_overlap"]), (&Value::Null, &Value::Null));
    assert_eq!(summary["triggers"][0]["times"], 1, "{summary}");
    assert!(text.contains("deepest    no overlap") && !text.contains("\ninside"), "{text}");
}

/// A cube flies at another one by more than its thickness a step.
#[test]
fn steps_that_were_divided_are_counted() {
    let scene = |settings: &str| {
        summed_up(&format!(
            r#"(gravity: (0, 0, 0), step: 0.015625, duration: 0.25, {settings} effects: [Response()], bodies: [
                (name: "wall", shape: Generator(Cuboid()), kind: Fixed, pose: (at: (6, 0, 0))),
                (name: "thrown", shape: Generator(Cuboid()), velocity: (linear: (64, 0, 0))),
            ])"#
        ))
    };
    let (summary, text) = scene("");
    let parts = &summary["parts"];
    assert_eq!((&parts["most_parts"], &parts["max"]), (&2.into(), &2.into()), "{summary}");
    let divided = parts["divided"].as_u64().unwrap();
    assert!(divided > 0 && divided < summary["steps"].as_u64().unwrap(), "{summary}");
    assert!(text.contains(&format!("\n- in parts {divided} step")), "{text}");
    assert!(text.contains("at most 2 parts each; most_parts is 2"), "{text}");
    let (summary, text) = scene("most_parts: 1,");
    assert_eq!(
        (&summary["parts"]["most_parts"], &summary["parts"]["divided"]),
        (&1.into(), &0.into())
    );
    assert!(text.contains("\n- in parts no step: most_parts is 1"), "{text}");
}

/// `cranny run --help` has a line for each heading of the summary that does not explain itself.
#[test]
fn the_help_explains_the_summary() {
    let help = String::from_utf8(cranny(&["run", "--help"]).stdout).unwrap();
    let (_folder, scene) = scene();
    let text = String::from_utf8(cranny(&["run", &scene]).stdout).unwrap();
    for line in text.lines().filter(|line| !line.starts_with(' ')) {
        let heading = line[..10].trim_end();
        let explained = help.lines().any(|line| line.starts_with(&format!("  {heading} ")));
        assert!(
            explained || ["scene", "detector", "written"].contains(&heading),
            "{heading}: {help}"
        );
    }
}

#[test]
fn bodies_that_were_held_back_are_counted() {
    let scene = |effects: &str| {
        summed_up(&format!(
            r#"(duration: 0.5, bodies: [
                (name: "wall", shape: Generator(Cuboid(size: (0.01, 3, 3))), kind: Fixed),
                (name: "pellet", shape: Generator(Cuboid(size: (0.05, 0.05, 0.05))), pose: (at: (-1, 0, 0)),
                 velocity: (linear: (120, 0, 0))),
            ], effects: [Response(), {effects}])"#
        ))
    };
    let (summary, text) = scene("Continuous()");
    assert!(summary["held_back"].as_u64().unwrap() > 0, "{summary}");
    assert!(text.contains("\nheld back "), "{text}");
    let (summary, text) = scene("");
    assert_eq!(summary["held_back"], Value::Null);
    assert!(!text.contains("held back"), "{text}");
}

#[test]
fn energies_that_are_not_finite_are_said_to_be_unknown() {
    let (summary, text) = summed_up(
        r#"(duration: 0.1, bodies: [
            (name: "floor", shape: Generator(Floor()), kind: Fixed),
            (name: "mote", shape: Generator(Cuboid(size: (1e-5, 1e-5, 1e-5))), pose: (at: (0, 0, 0.4)),
             material: (density: 1e-3), velocity: (angular: (1, 2, 3))),
        ], effects: [Response()])"#,
    );
    assert_eq!((&summary["energy"], &summary["energy_drift"]), (&Value::Null, &Value::Null));
    assert!(summary["energy_unknown"].as_str().unwrap().contains("no finite number"), "{summary}");
    assert!(text.contains("energy     not known: ") && !text.contains("NaN"), "{text}");
}
