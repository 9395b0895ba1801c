//! `--rerun`: a file of Rerun's where the build can write one, a clear refusal where it cannot.

use crate::harness::{Folder, argument, run};

/// A box that falls onto another one.
const DROP: &str = r#"(
    step: 0.015625, duration: 0.5, seed: 3,
    bodies: [
        (name: "floor", shape: Generator(Cuboid(size: (4, 4, 1))), kind: Fixed),
        (name: "box", shape: Generator(Cuboid(size: (1, 1, 1))), pose: (at: (0.125, 0, 1.05))),
    ],
    effects: [Response(), Contacts(margin: 0.01)],
)"#;

fn names(folder: &Folder) -> Vec<String> {
    let files = std::fs::read_dir(folder.path("")).unwrap();
    let mut names: Vec<String> =
        files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
#[cfg(not(feature = "rerun"))]
fn a_build_without_the_library_says_how_to_get_one_with_it() {
    let folder = Folder::new();
    let (scene, out) = (folder.write("drop.ron", DROP), argument(&folder.path("drop.rrd")));
    let words = ["--features rerun", "cargo run --release -p cranny-cli"];
    run(&["run", &scene, "--rerun", &out]).assert_refused(2, &words);
    let recording = folder.write("drop.mcap", "");
    run(&["replay", &recording, "--rerun", &out]).assert_refused(2, &words);
    run(&["replay", &recording, "--rerun-connect"]).assert_refused(2, &words);
    assert_eq!(names(&folder), ["drop.mcap", "drop.ron"]);
}

#[test]
#[cfg(feature = "rerun")]
fn a_run_leaves_its_file_and_no_recording_that_nobody_asked_for() {
    let folder = Folder::new();
    let (scene, out) = (folder.write("drop.ron", DROP), argument(&folder.path("drop.rrd")));
    let outcome = run(&["run", &scene, "--rerun", &out, "--format", "json"]);
    let line = outcome.json_lines().remove(0);
    assert_eq!(line["outputs"], serde_json::json!([out]), "{line}");
    assert_eq!(names(&folder), ["drop.ron", "drop.rrd"]);
    assert!(std::fs::read(&out).unwrap().starts_with(b"RRF"));

    let [mcap, again] = ["drop.mcap", "again.rrd"].map(|name| argument(&folder.path(name)));
    let outcome = run(&["run", &scene, "--rerun", &out, "--record", &mcap]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{outcome:?}");
    let outcome = run(&["replay", &mcap, "--rerun", &again, "--format", "json"]);
    let line = outcome.json_lines().remove(0);
    assert_eq!((&line["frames"], &line["out"]), (&33.into(), &again.into()), "{line}");
    assert_eq!(outcome.stderr, "", "nobody else's noise");
    assert_eq!(names(&folder), ["again.rrd", "drop.mcap", "drop.ron", "drop.rrd"]);
}

#[test]
#[cfg(feature = "rerun")]
fn a_recording_that_is_not_whole_is_refused() {
    let folder = Folder::new();
    let (scene, mcap) = (folder.write("drop.ron", DROP), argument(&folder.path("drop.mcap")));
    assert_eq!(run(&["run", &scene, "--record", &mcap]).code, Some(0));
    let bytes = std::fs::read(&mcap).unwrap();
    let cut = folder.write("cut.mcap", &bytes[..bytes.len() / 2]);
    let out = argument(&folder.path("cut.rrd"));
    run(&["replay", &cut, "--rerun", &out]).assert_refused(2, &["cut.mcap", "cranny recover"]);
    let wrong = argument(&folder.path("cut.mcap2"));
    run(&["replay", &mcap, "--rerun", &wrong]).assert_refused(2, &["--rerun", ".rrd"]);
    run(&["replay", &mcap, "--rerun-connect", "nowhere"])
        .assert_refused(1, &["nowhere", "'rerun'"]);
    assert_eq!(names(&folder), ["cut.mcap", "drop.mcap", "drop.ron"]);
}
