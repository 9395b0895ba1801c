//! From what a killed run left to a whole recording.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Record};
use mcap::{MAGIC, McapError};
use thiserror::Error;

use crate::error::{ReadError, RecordError};
use crate::message::StatsMessage;
use crate::output::{Output, RawChannel};
use crate::records::{Extent, for_each_record};
use crate::topic;

/// How the name of a recording ends while it is being recovered. Not that of the partial file,
/// which is read meanwhile.
const RECOVERING: &str = ".recovering";

/// What was recovered.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    /// The whole recording.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// Whole frames.
    pub frames: u64,
    /// Steps of the first and the last frame.
    pub steps: [u64; 2],
    /// Log times of the first and the last frame, nanoseconds.
    pub times_ns: [u64; 2],
    /// Chunks that were damaged, and left out.
    pub damaged_chunks: u64,
    /// Messages of a frame that was not whole, and of topics that only a damaged chunk declared;
    /// left out.
    pub left_out: u64,
    /// Bytes behind the last whole record.
    pub lost_bytes: u64,
    /// The file had been finished: nothing was lost by a kill.
    pub was_complete: bool,
}

/// A recording that cannot be recovered.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecoverError {
    /// The partial file cannot be read, or is no recording.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No frame of it is whole.
    #[error(
        "'{}' holds no whole frame ({damaged} chunks are damaged): there is nothing to recover",
        path.display()
    )]
    NoFrame {
        /// The file.
        path: PathBuf,
        /// Chunks that do not match their sums; 0: the run ended before a frame was written out.
        damaged: u64,
    },
    /// The bodies are lost.
    #[error(
        "'{}' holds {frames} whole frames, but the bodies are lost: the chunk that held them is damaged, and without them nothing replays",
        path.display()
    )]
    NoBodies {
        /// The file.
        path: PathBuf,
        /// Whole frames.
        frames: u64,
    },
    /// The whole recording cannot be written.
    #[error(transparent)]
    Write(#[from] RecordError),
}

/// Writes the whole frames of a recording that was cut off or damaged to `out`, replacing what lies
/// there. The file that is read stays as it is.
///
/// # Errors
///
/// [`RecoverError`].
pub fn recover(partial: &Path, out: &Path) -> Result<Recovered, RecoverError> {
    let path = partial.to_owned();
    let bytes =
        fs::read(partial).map_err(|source| ReadError::Open { path: path.clone(), source })?;
    if !bytes.starts_with(MAGIC) {
        return Err(ReadError::NotMcap { path, source: McapError::BadMagic }.into());
    }
    let channels = Channels::of(&bytes);
    let found = Survey::of(&bytes, &channels);
    let (Some(first), Some(last)) = (found.first, found.last) else {
        return Err(RecoverError::NoFrame { path, damaged: found.damaged });
    };
    if !found.has_bodies {
        return Err(RecoverError::NoBodies { path, frames: found.frames });
    }
    let mut copy = Copy {
        output: Output::create(out, RECOVERING)?,
        until: last.1,
        channels: &channels,
        end: None,
        left_out: 0,
    };
    let mut written = Ok(());
    for_each_record(&bytes, &mut |record| {
        if written.is_ok() {
            written = copy.take(record);
        }
    });
    written?;
    let left_out = copy.left_out;
    // What the file says of its end is true if nothing of it is lost.
    let has_all = |end: &BTreeMap<_, _>| end.get("frames") == Some(&found.frames.to_string());
    let end = match copy.end.take() {
        Some(end) if found.damaged == 0 && left_out == 0 && has_all(&end) => end,
        _ => end_of(found.frames, last.0, found.damaged),
    };
    copy.output.metadata(topic::METADATA_END, end)?;
    let (path, size) = copy.output.finish()?;
    Ok(Recovered {
        path,
        bytes: size,
        frames: found.frames,
        steps: [first.0, last.0],
        times_ns: [first.1, last.1],
        damaged_chunks: found.damaged,
        left_out,
        lost_bytes: found.lost,
        was_complete: found.complete,
    })
}

fn end_of(frames: u64, last_step: u64, damaged: u64) -> BTreeMap<String, String> {
    let why = match damaged {
        0 => "recovered: the run was killed, could not write on, or parts of the file are lost"
            .to_owned(),
        1 => "recovered: 1 damaged chunk is left out".to_owned(),
        n => format!("recovered: {n} damaged chunks are left out"),
    };
    let entries = [
        ("interrupted", "true".to_owned()),
        ("frames", frames.to_string()),
        ("last_step", last_step.to_string()),
        ("why", why),
    ];
    entries.map(|(key, value)| (key.to_owned(), value)).into()
}

/// What a file holds, before it is copied.
#[derive(Default)]
struct Survey {
    frames: u64,
    /// Step and log time of the first and of the last whole frame: the statistics end a frame.
    first: Option<(u64, u64)>,
    last: Option<(u64, u64)>,
    /// Whether what moves in them is there.
    has_bodies: bool,
    damaged: u64,
    lost: u64,
    complete: bool,
}

impl Survey {
    fn of(bytes: &[u8], channels: &Channels) -> Self {
        let mut found = Self::default();
        let Extent { damaged, lost } = for_each_record(bytes, &mut |record| match record {
            Record::Footer(_) => found.complete = true,
            Record::Message { header, data } => match channels.topic(header.channel_id) {
                Some(topic::BODIES) => found.has_bodies = true,
                Some(topic::STATS) => {
                    if let Ok(stats) = serde_json::from_slice::<StatsMessage>(&data) {
                        found.frames += 1;
                        found.first = found.first.or(Some((stats.step, header.log_time)));
                        found.last = Some((stats.step, header.log_time));
                    }
                }
                _ => {}
            },
            _ => {}
        });
        (found.damaged, found.lost) = (damaged, lost);
        found
    }
}

/// Channels as the file that is read numbers them.
#[derive(Default)]
struct Channels {
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    channels: BTreeMap<u16, RawChannel>,
}

impl Channels {
    /// All channels of a file: one that was finished names them again at its end, so that none is
    /// lost with a damaged chunk.
    fn of(bytes: &[u8]) -> Self {
        let mut channels = Self::default();
        for_each_record(bytes, &mut |record| channels.note(&record));
        channels
    }

    fn note(&mut self, record: &Record<'_>) {
        match record {
            Record::Schema { header, data } => {
                let schema = (header.name.clone(), header.encoding.clone(), data.to_vec());
                self.schemas.insert(header.id, schema);
            }
            Record::Channel(channel) => {
                let schema = self.schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                let raw = RawChannel {
                    topic: channel.topic.clone(),
                    message_encoding: channel.message_encoding.clone(),
                    schema,
                };
                self.channels.insert(channel.id, raw);
            }
            _ => {}
        }
    }

    fn topic(&self, id: u16) -> Option<&str> {
        self.channels.get(&id).map(|channel| channel.topic.as_str())
    }
}

/// The recording that is being written.
struct Copy<'a> {
    output: Output,
    /// Log time of the last whole frame.
    until: u64,
    channels: &'a Channels,
    /// What the file says of its end.
    end: Option<BTreeMap<String, String>>,
    left_out: u64,
}

impl Copy<'_> {
    fn take(&mut self, record: Record<'_>) -> Result<(), RecordError> {
        match record {
            Record::Message { header, data } => self.message(&header, &data),
            Record::Metadata(record) if record.name == topic::METADATA_END => {
                self.end = Some(record.metadata);
                Ok(())
            }
            Record::Metadata(record) => self.output.metadata(&record.name, record.metadata),
            Record::Attachment { header, data, .. } => {
                self.output.attach(&header.name, &header.media_type, &data)
            }
            _ => Ok(()),
        }
    }

    fn message(&mut self, header: &MessageHeader, data: &[u8]) -> Result<(), RecordError> {
        let channel = self.channels.channels.get(&header.channel_id);
        let Some(channel) = channel.filter(|_| header.log_time <= self.until) else {
            self.left_out += 1;
            return Ok(());
        };
        self.output.raw(channel, header.log_time, data)?;
        if channel.topic == topic::STATS { self.output.end_frame() } else { Ok(()) }
    }
}
