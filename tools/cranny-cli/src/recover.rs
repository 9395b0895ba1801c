//! `cranny recover`: from what a killed run left to a whole recording.

use std::path::{Path, PathBuf};

use cranny_record::{RecoverError, Recovered, recover as write_whole};
use serde_json::json;

use crate::args::{Format, RecoverArgs};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{check_input, check_output};

/// Runs the command.
///
/// # Errors
///
/// A file without a whole frame; one that cannot be read or written.
pub(crate) fn recover(args: &RecoverArgs, format: Option<Format>) -> Result<(), Failure> {
    check_input("recording", &args.recording)?;
    let out = match &args.out {
        Some(out) => named(&args.recording, out)?,
        None => unnamed(&args.recording)?,
    };
    let found = write_whole(&args.recording, &out).map_err(failure)?;
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&as_json(&found, &args.recording)),
        Format::Text => output.line(&as_text(&found, &args.recording)),
    }
}

fn failure(error: RecoverError) -> Failure {
    match error {
        RecoverError::Write(_) => Failure::run(error),
        _ => Failure::input(error),
    }
}

fn named(recording: &Path, out: &Path) -> Result<PathBuf, Failure> {
    check_output("--out", out, &["mcap"])?;
    let is_same = |a: &Path, b: &Path| {
        a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
    };
    match is_same(recording, out) {
        false => Ok(out.to_owned()),
        true => Err(Failure::input(format!(
            "--out {}: it is the file that is read. Name another.",
            out.display()
        ))),
    }
}

/// The name without `.partial`.
fn unnamed(recording: &Path) -> Result<PathBuf, Failure> {
    let name = recording.display();
    if recording.extension().is_none_or(|extension| extension != "partial") {
        return Err(Failure::input(format!(
            "recording {name}: its name does not end in .partial. Say --out REC.mcap."
        )));
    }
    let out = recording.with_extension("");
    match out.exists() {
        false => Ok(out),
        true => Err(Failure::input(format!(
            "recording {name}: {} is there already, of another run perhaps. Name another by --out.",
            out.display()
        ))),
    }
}

fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

fn as_text(found: &Recovered, recording: &Path) -> String {
    let [first, last] = found.steps;
    let [from, to] = found.times_ns.map(seconds);
    let mut lines = vec![
        format!("recovered  {}", found.path.display()),
        format!(
            "holds      {} frames, steps {first} to {last}, from {from:.3} s to {to:.3} s",
            found.frames
        ),
    ];
    if found.was_complete {
        lines.push("whole      the recording had an end: the run was not killed".to_owned());
    }
    if found.damaged_chunks > 0 {
        lines.push(format!(
            "damaged    {} left out, since sums do not match",
            match found.damaged_chunks {
                1 => "1 chunk or other record is".to_owned(),
                chunks => format!("{chunks} chunks or other records are"),
            }
        ));
    }
    if found.left_out > 0 {
        lines.push(format!(
            "left out   {} messages of a frame that is not whole, or of no known topic",
            found.left_out
        ));
    }
    if found.lost_bytes > 0 {
        lines.push(format!("lost       {} bytes behind the last whole record", found.lost_bytes));
    }
    lines.push(format!("kept       {}, unchanged; delete it at will", recording.display()));
    lines.join("\n")
}

fn as_json(found: &Recovered, recording: &Path) -> serde_json::Value {
    json!({
        "version": 1,
        "recording": recording.display().to_string(),
        "out": found.path.display().to_string(),
        "bytes": found.bytes,
        "frames": found.frames,
        "steps": found.steps,
        "seconds": found.times_ns.map(seconds),
        "was_complete": found.was_complete,
        "damaged_chunks": found.damaged_chunks,
        "left_out_messages": found.left_out,
        "lost_bytes": found.lost_bytes,
    })
}
