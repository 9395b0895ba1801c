//! Words: what was run, what began and ended, the log; and pictures.

use std::fmt::Write;

use cranny_record::{EventMessage, LogLevel, Recording, topic};

use crate::archetypes::{EncodedImage, TextDocument, TextLog};
use crate::components::TextLogLevel;
use crate::error::RerunError;
use crate::source::Source;
use crate::stream::{Stream, path};

/// What was run.
pub(crate) const ABOUT: &str = "about";

/// What began and ended.
pub(crate) const EVENTS: &str = "events";

/// What was skipped, and why.
pub(crate) const LOG: &str = "log";

/// The group of cameras.
pub(crate) const CAMERAS: &str = "camera";

/// Writes all words and pictures.
pub(crate) fn tell(
    stream: &Stream,
    recording: &Recording,
    source: &Source,
) -> Result<(), RerunError> {
    stream.once(&path(&[], ABOUT), &TextDocument::from_markdown(about(recording)))?;
    let events: Vec<(u64, (&str, String))> = source
        .events
        .iter()
        .flat_map(|(time, message)| {
            message.events.iter().map(|event| (*time, (TextLogLevel::INFO, sentence(event))))
        })
        .collect();
    tell_lines(stream, EVENTS, &events)?;
    let log: Vec<(u64, (&str, String))> =
        source.log.iter().map(|(time, (how, text))| (*time, (level(*how), text.clone()))).collect();
    tell_lines(stream, LOG, &log)?;
    tell_pictures(stream, source)
}

fn tell_lines(
    stream: &Stream,
    name: &str,
    lines: &[(u64, (&str, String))],
) -> Result<(), RerunError> {
    stream.rows(&path(&[], name), lines, |rows| {
        let lines = TextLog::update_fields()
            .with_many_text(rows.iter().map(|(_, (_, text))| text.as_str()))
            .with_many_level(rows.iter().map(|(_, (level, _))| *level));
        Ok(lines.columns_of_unit_batches()?.collect())
    })
}

fn tell_pictures(stream: &Stream, source: &Source) -> Result<(), RerunError> {
    for (time, picture) in &source.pictures {
        let image = EncodedImage::from_file_contents(picture.png.clone());
        stream.at(*time, &path(&[CAMERAS], &picture.camera), &image)?;
    }
    Ok(())
}

/// A table of what the recording says of its run.
fn about(recording: &Recording) -> String {
    let mut text = "| | |\n|---|---|\n".to_owned();
    for (key, value) in recording.metadata(topic::METADATA).into_iter().flatten() {
        let value = value.replace('|', "\\|").replace('\n', " ");
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {key} | {value} |");
    }
    text
}

fn sentence(event: &EventMessage) -> String {
    let EventMessage { kind, a, b, .. } = event;
    let ids = event.region.zip(event.other);
    match (kind.as_str(), ids) {
        ("began", _) if event.open => format!("{a} and {b} may touch"),
        ("began", _) => format!("{a} and {b} begin to touch"),
        ("ended", _) => format!("{a} and {b} part"),
        ("region_split", Some((region, other))) => {
            format!("{a} and {b}: region {other} splits from region {region}")
        }
        ("region_merged", Some((region, other))) => {
            format!("{a} and {b}: region {other} merges into region {region}")
        }
        _ => format!("{a} and {b}: {kind}"),
    }
}

fn level(level: LogLevel) -> &'static str {
    match level {
        LogLevel::Debug => TextLogLevel::DEBUG,
        LogLevel::Info => TextLogLevel::INFO,
        LogLevel::Warning => TextLogLevel::WARN,
        LogLevel::Error => TextLogLevel::ERROR,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_sentences() {
        let event = |kind: &str, ids: [Option<u32>; 2]| {
            let [region, other] = ids;
            let (kind, a, b) = (kind.to_owned(), "cup".to_owned(), "table".to_owned());
            sentence(&EventMessage { kind, a, b, open: false, region, other })
        };
        assert_eq!(event("began", [None; 2]), "cup and table begin to touch");
        assert_eq!(event("ended", [None; 2]), "cup and table part");
        let split = event("region_split", [Some(3), Some(4)]);
        assert_eq!(split, "cup and table: region 4 splits from region 3");
        assert_eq!(event("region_split", [None; 2]), "cup and table: region_split");
    }
}
