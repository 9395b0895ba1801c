//! `cranny report`: one page about a recorded run.

mod facts;
mod page;
mod pictures;
mod plot;

use std::path::Path;

use cranny_ecs::Replay;
use serde_json::json;

use crate::args::{Format, ReportArgs};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{check_output, check_recording, write};
use crate::progress;
use facts::Facts;
use page::RunPage;
use pictures::Artist;

/// Runs the command.
///
/// # Errors
///
/// A recording that cannot be read; pictures that cannot be drawn; a page that cannot be written.
pub(crate) fn report(args: &ReportArgs, format: Option<Format>) -> Result<(), Failure> {
    check_recording(&args.recording)?;
    check_output("--out", &args.out, &["html", "htm"])?;
    let waiting = progress::spinner("reading");
    let replay = Replay::open(&args.recording).map_err(Failure::input)?;
    let facts = Facts::of(&replay).map_err(Failure::input)?;
    waiting.set_message("drawing");
    let mut artist = Artist::new(&replay)?;
    let strip = artist.strip(args.pictures)?;
    let mut close_ups = Vec::new();
    for overlap in &facts.deepest {
        close_ups.push((overlap.clone(), artist.close_up(overlap)?));
    }
    let recording = args.recording.display().to_string();
    let page = RunPage { facts: &facts, recording, ending: ending(&replay), strip, close_ups };
    let html = page.html();
    write(&args.out, &html)?;
    waiting.finish_and_clear();
    conclude(&facts, &args.out, html.len(), format)
}

fn ending(replay: &Replay) -> Option<String> {
    let recording = replay.recording();
    let text = match () {
        () if recording.damaged_chunks() > 0 => {
            "The recording is damaged: parts of it are missing."
        }
        () if !recording.is_complete() => {
            "The recording was cut off: the run was killed, or the disk was full."
        }
        () if recording.was_interrupted() => "The run was interrupted before its end.",
        () => return None,
    };
    Some(text.to_owned())
}

fn conclude(
    facts: &Facts,
    out: &Path,
    bytes: usize,
    format: Option<Format>,
) -> Result<(), Failure> {
    let mut output = Output::new();
    let (frames, last) = (facts.stats.len(), facts.last());
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&json!({
            "version": 1, "out": out.display().to_string(), "bytes": bytes, "frames": frames,
            "seconds": last,
        })),
        Format::Text => output.line(&format!(
            "written    {} ({:.1} MB): {frames} frames, up to {last:.3} s",
            out.display(),
            bytes as f64 / 1e6
        )),
    }
}
