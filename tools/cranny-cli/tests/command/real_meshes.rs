//! `tools/real_meshes`: a scene of the corpus's meshes, which drop into a bowl and stay there.

use std::path::Path;
use std::process::Command;

use serde_json::json;

use crate::harness::{Folder, argument, corpus, run, run_command};

/// The command that writes the scene, for the meshes of a folder.
fn real_meshes(folder: &Path, scene: &str) -> Command {
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("../real_meshes");
    let mut command = Command::new(tool);
    command.arg(folder).args([scene, "--cranny", env!("CARGO_BIN_EXE_cranny")]);
    command
}

#[test]
fn scans_and_parts_of_the_corpus_stay_in_their_bowl() {
    let Some(corpus) = corpus() else { return };
    let folder = Folder::new();
    let scene = argument(&folder.path("real_meshes.ron"));
    let written = run_command(&mut real_meshes(&corpus, &scene));
    assert_eq!(written.code, Some(0), "{written:?}");
    let arguments = ["run", scene.as_str(), "--quiet", "--format", "json", "--duration", "1.5"];
    let lines = run(&arguments).json_lines();
    let [line] = &lines[..] else { panic!("one line a run") };
    let bodies = line["motion"].as_array().unwrap();
    assert_eq!(bodies.len(), 12, "{line}");
    // The highest starts 1.24 above the bowl's floor. What falls past the bowl falls 11 m.
    for body in bodies {
        let down = -body["displacement"][2].as_f64().unwrap();
        assert!(down > 0.05 && down < 1.5, "{body}");
    }
    assert_eq!(line["left"], json!([]), "{line}");
    // Each is 0.4 long.
    assert!(line["deepest"]["depth"].as_f64().unwrap() < 0.02, "{}", line["deepest"]);
}

#[test]
fn a_folder_without_the_meshes_is_named_and_nothing_is_written() {
    let folder = Folder::new();
    let scene = folder.path("real_meshes.ron");
    let refused = run_command(&mut real_meshes(&folder.path("nowhere"), &argument(&scene)));
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.stderr.contains("no such file: ") && refused.stderr.contains("newt.obj"));
    assert!(!scene.exists());
}
