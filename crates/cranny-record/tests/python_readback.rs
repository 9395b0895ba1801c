//! A recording, read by public readers that share no code with the writer.
//!
//! Wants a Python with `mcap` and `mcap-protobuf-support`: the one that the variable
//! `CRANNY_PYTHON` names, or `python3`. Where there is none, says so and checks nothing.

mod pendulum;

use std::fs;
use std::path::Path;
use std::process::Command;

use pendulum::{Pendulum, record};

/// The script's exit code where a module is missing.
const MODULE_MISSING: i32 = 3;

/// The last frame has contacts: the bob stands in the post when the run ends.
const STEPS: u64 = 60;
const WHOLE_SWING: u64 = 75;

#[expect(clippy::print_stderr, reason = "a skipped test must say so")]
fn skip(why: &str) {
    eprintln!("skipped: {why}");
}

#[test]
fn python_reads_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let (mut recorder, mut pendulum) = record(&path, 0).unwrap();
    for _ in 0..STEPS {
        pendulum.step(&mut recorder, WHOLE_SWING).unwrap();
    }
    let summary = recorder.finish().unwrap();
    let poses: serde_json::Map<String, serde_json::Value> = pendulum
        .world
        .bodies()
        .map(|(_, body)| {
            let (q, t) = (body.pose().rotation.to_array(), body.pose().translation.to_array());
            (body.name().to_owned(), q.into_iter().chain(t).collect::<Vec<f64>>().into())
        })
        .collect();
    assert_eq!(
        poses["bob"][4].as_f64(),
        Some(Pendulum::pose(STEPS - 1, WHOLE_SWING).translation.x)
    );
    let expected = folder.path().join("expected.json");
    let json = serde_json::json!({ "messages": summary.messages, "poses": poses });
    fs::write(&expected, json.to_string()).unwrap();

    let python = std::env::var("CRANNY_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/read_back.py");
    let output = match Command::new(&python).arg(script).arg(&path).arg(&expected).output() {
        Ok(output) => output,
        Err(error) => return skip(&format!("'{python}' cannot be run: {error}")),
    };
    let said = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(MODULE_MISSING) {
        return skip(&format!("'{python}': {}", said.trim()));
    }
    assert!(output.status.success(), "{}{said}", String::from_utf8_lossy(&output.stdout));
}
