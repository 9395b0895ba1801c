//! `--rerun OUT.rrd` and `--rerun-connect`: what a recording holds, for Rerun's viewer.
//!
//! They need the feature `rerun`. A build without it refuses them before any work is done.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::args::{Format, ReplayArgs};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{check_input, check_output};
use crate::progress;

/// What became of a recording.
struct Told {
    frames: usize,
    /// Of the file, if one was written.
    bytes: Option<u64>,
}

/// Whether the file could be written, by a build that can.
///
/// # Errors
///
/// A build without the feature; a name that is none of its files', or stands in no folder.
pub(crate) fn check_file(path: &Path) -> Result<(), Failure> {
    check_feature("--rerun")?;
    check_output("--rerun", path, &["rrd"])
}

/// `cranny replay REC.mcap --rerun OUT.rrd`, or `--rerun-connect`.
///
/// # Errors
///
/// A recording that cannot be read or is not whole; a file that cannot be written, or no viewer.
pub(crate) fn replay(args: &ReplayArgs, format: Option<Format>) -> Result<(), Failure> {
    check_input("recording", &args.recording)?;
    let mut lines = vec![format!("recording  {}", args.recording.display())];
    let mut line = json!({"version": 1, "recording": args.recording.display().to_string()});
    let waiting = progress::spinner("converting");
    let mut frames = 0;
    if let Some(out) = &args.rerun {
        check_file(out)?;
        let converted = convert(&args.recording, out)?;
        let bytes = converted.bytes.unwrap_or_default();
        lines.push(format!("written    {} ({:.1} MB)", out.display(), bytes as f64 / 1e6));
        line["out"] = out.display().to_string().into();
        line["bytes"] = bytes.into();
        frames = converted.frames;
    }
    if let Some(url) = &args.rerun_connect {
        check_feature("--rerun-connect")?;
        frames = send(&args.recording, url)?.frames;
        lines.push(format!("sent to    {url}"));
        line["viewer"] = url.as_str().into();
    }
    waiting.finish_and_clear();
    lines.insert(1, format!("holds      {frames} frames"));
    line["frames"] = frames.into();
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&line),
        Format::Text => output.line(&lines.join("\n")),
    }
}

/// Where a run is recorded that is to be a file of Rerun's: in the recording that is wanted anyway,
/// or in one beside the file.
pub(crate) fn recording_of_run(record: Option<&Path>, out: Option<&Path>) -> Option<PathBuf> {
    let beside = |out: &Path| {
        let mut name = out.as_os_str().to_owned();
        name.push(".mcap");
        PathBuf::from(name)
    };
    record.map(Path::to_owned).or_else(|| out.map(beside))
}

/// Makes the recording of a run into a file of Rerun's. A recording that is not wanted is removed
/// then; where this fails, it is kept.
///
/// # Errors
///
/// As [`replay`].
pub(crate) fn finish_run(recording: &Path, is_wanted: bool, out: &Path) -> Result<(), Failure> {
    convert(recording, out).map_err(|failure| {
        Failure::run(format!(
            "--rerun {}: {failure}. {} is kept.",
            out.display(),
            recording.display()
        ))
    })?;
    if !is_wanted {
        // A file too many is no failed run.
        if let Err(error) = fs::remove_file(recording) {
            tracing::warn!("{} cannot be removed ({error}): delete it", recording.display());
        }
    }
    Ok(())
}

#[cfg(feature = "rerun")]
fn check_feature(_option: &str) -> Result<(), Failure> {
    Ok(())
}

#[cfg(not(feature = "rerun"))]
fn check_feature(option: &str) -> Result<(), Failure> {
    Err(missing(option))
}

#[cfg(not(feature = "rerun"))]
fn missing(option: &str) -> Failure {
    Failure::input(format!(
        "{option}: this build is without Rerun's library, which takes minutes to compile. \
         Build it in: cargo run --release -p cranny-cli --features rerun -- ... \
         (or cargo install --path tools/cranny-cli --features rerun)."
    ))
}

#[cfg(feature = "rerun")]
fn convert(recording: &Path, out: &Path) -> Result<Told, Failure> {
    let recording = cranny_record::Recording::open(recording).map_err(Failure::input)?;
    let written = cranny_rerun::write(&recording, out).map_err(failure)?;
    Ok(Told { frames: written.frames, bytes: Some(written.bytes) })
}

#[cfg(feature = "rerun")]
fn send(recording: &Path, url: &str) -> Result<Told, Failure> {
    let recording = cranny_record::Recording::open(recording).map_err(Failure::input)?;
    let sent = cranny_rerun::send(&recording, url).map_err(failure)?;
    Ok(Told { frames: sent.frames, bytes: None })
}

#[cfg(feature = "rerun")]
fn failure(error: cranny_rerun::RerunError) -> Failure {
    use cranny_rerun::RerunError::{Empty, NotWhole, Read};
    match error {
        Read(_) | NotWhole { .. } | Empty { .. } => Failure::input(error),
        _ => Failure::run(error),
    }
}

#[cfg(not(feature = "rerun"))]
fn convert(_recording: &Path, _out: &Path) -> Result<Told, Failure> {
    Err(missing("--rerun"))
}

#[cfg(not(feature = "rerun"))]
fn send(_recording: &Path, _url: &str) -> Result<Told, Failure> {
    Err(missing("--rerun-connect"))
}
