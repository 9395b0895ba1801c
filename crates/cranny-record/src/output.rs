//! The file that grows: partial until it is whole, readable after a kill up to its last chunk.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use foxglove::Encode;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, McapError, WriteOptions, Writer};
use serde::Serialize;

use crate::error::RecordError;
use crate::message::Schema;

/// After how many frames what was recorded is written out, if not earlier because of its size.
///
/// Smaller: chunks compress worse. Larger: a kill loses more. `a_kill_loses_less_than_a_chunk`
/// holds it to its word.
pub const FRAMES_PER_CHUNK: u32 = 32;

/// Bytes before compression after which a chunk is closed. Smaller: chunks compress worse; larger:
/// viewers must unpack more to show one frame.
const CHUNK_SIZE: u64 = 768 * 1024;

/// Of zstd. Smaller: recordings are a quarter larger; larger: a frame takes longer for little.
const COMPRESSION_LEVEL: u32 = 9;

struct Channel {
    id: u16,
    messages: u32,
}

/// A channel of another recording.
#[derive(Clone, Debug)]
pub(crate) struct RawChannel {
    pub(crate) topic: String,
    pub(crate) message_encoding: String,
    /// Name, encoding, text.
    pub(crate) schema: (String, String, Vec<u8>),
}

/// How the name of a recording ends while it grows.
pub(crate) const PARTIAL: &str = ".partial";

/// An MCAP file under its partial name.
pub(crate) struct Output {
    writer: Writer<BufWriter<File>>,
    path: PathBuf,
    partial: PathBuf,
    channels: BTreeMap<String, Channel>,
    buffer: Vec<u8>,
    frames_in_chunk: u32,
}

impl Output {
    /// The file bears the name with this ending until it is finished.
    pub(crate) fn create(path: &Path, ending: &str) -> Result<Self, RecordError> {
        // Renaming onto a device or a pipe would replace it.
        let in_the_way = fs::metadata(path).is_ok_and(|found| !found.is_file());
        let (Some(name), false) = (path.file_name(), in_the_way) else {
            return Err(RecordError::NotAFile { path: path.to_owned() });
        };
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|f| !f.is_dir()) {
            let folder = folder.to_owned();
            return Err(RecordError::MissingFolder { path: path.to_owned(), folder });
        }
        let mut partial_name = name.to_owned();
        partial_name.push(ending);
        let partial = path.with_file_name(partial_name);
        let created = File::create(&partial)
            .map_err(|source| RecordError::Create { partial: partial.clone(), source })?;
        let options = WriteOptions::new()
            .chunk_size(Some(CHUNK_SIZE))
            .compression_level(COMPRESSION_LEVEL)
            .compression_threads(0);
        let writer = options
            .create(BufWriter::new(created))
            .map_err(|source| failed(&partial, "the header", source))?;
        Ok(Self {
            writer,
            path: path.to_owned(),
            partial,
            channels: BTreeMap::new(),
            buffer: Vec::new(),
            frames_in_chunk: 0,
        })
    }

    /// Writes a message of a well-known schema.
    pub(crate) fn message<T: Encode>(
        &mut self,
        topic: &str,
        time_ns: u64,
        message: &T,
    ) -> Result<(), RecordError> {
        let refused = |reason: String| RecordError::Encode { topic: topic.to_owned(), reason };
        if !self.channels.contains_key(topic) {
            let schema = T::get_schema().ok_or_else(|| refused("it has no schema".to_owned()))?;
            let encoding = T::get_message_encoding();
            self.add_channel(topic, &schema.name, &schema.encoding, &schema.data, &encoding)?;
        }
        let mut buffer = std::mem::take(&mut self.buffer);
        buffer.clear();
        message.encode(&mut buffer).map_err(|error| refused(error.to_string()))?;
        self.write(topic, time_ns, buffer)
    }

    /// Writes a message of our own.
    pub(crate) fn json<T: Serialize>(
        &mut self,
        topic: &str,
        schema: &Schema,
        time_ns: u64,
        message: &T,
    ) -> Result<(), RecordError> {
        if !self.channels.contains_key(topic) {
            self.add_channel(topic, schema.name, "jsonschema", schema.text.as_bytes(), "json")?;
        }
        let mut buffer = std::mem::take(&mut self.buffer);
        buffer.clear();
        serde_json::to_writer(&mut buffer, message).map_err(|error| RecordError::Encode {
            topic: topic.to_owned(),
            reason: error.to_string(),
        })?;
        self.write(topic, time_ns, buffer)
    }

    /// Writes a message as another recording holds it.
    pub(crate) fn raw(
        &mut self,
        channel: &RawChannel,
        time_ns: u64,
        data: &[u8],
    ) -> Result<(), RecordError> {
        let RawChannel { topic, message_encoding, schema: (name, encoding, schema) } = channel;
        if !self.channels.contains_key(topic) {
            self.add_channel(topic, name, encoding, schema, message_encoding)?;
        }
        let mut buffer = std::mem::take(&mut self.buffer);
        buffer.clear();
        buffer.extend_from_slice(data);
        self.write(topic, time_ns, buffer)
    }

    fn add_channel(
        &mut self,
        topic: &str,
        schema: &str,
        schema_encoding: &str,
        schema_data: &[u8],
        message_encoding: &str,
    ) -> Result<(), RecordError> {
        let id = self
            .writer
            .add_schema(schema, schema_encoding, schema_data)
            .and_then(|s| self.writer.add_channel(s, topic, message_encoding, &BTreeMap::new()))
            .map_err(|source| failed(&self.partial, topic, source))?;
        self.channels.insert(topic.to_owned(), Channel { id, messages: 0 });
        Ok(())
    }

    fn write(&mut self, topic: &str, time_ns: u64, buffer: Vec<u8>) -> Result<(), RecordError> {
        let Some(channel) = self.channels.get_mut(topic) else {
            return Err(failed(&self.partial, topic, McapError::UnknownChannel(0, 0)));
        };
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.messages,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.writer
            .write_to_known_channel(&header, &buffer)
            .map_err(|source| failed(&self.partial, topic, source))?;
        channel.messages += 1;
        self.buffer = buffer;
        Ok(())
    }

    pub(crate) fn attach(
        &mut self,
        name: &str,
        media_type: &str,
        data: &[u8],
    ) -> Result<(), RecordError> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Borrowed(data),
        };
        self.writer
            .attach(&attachment)
            .map_err(|source| failed(&self.partial, &format!("the attachment '{name}'"), source))
    }

    pub(crate) fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), RecordError> {
        self.writer
            .write_metadata(&Metadata { name: name.to_owned(), metadata })
            .map_err(|source| failed(&self.partial, &format!("the metadata '{name}'"), source))
    }

    /// Called after each frame: closes the chunk when it is old enough.
    pub(crate) fn end_frame(&mut self) -> Result<(), RecordError> {
        self.frames_in_chunk += 1;
        if self.frames_in_chunk < FRAMES_PER_CHUNK { Ok(()) } else { self.flush() }
    }

    /// Closes the chunk and hands it to the operating system.
    pub(crate) fn flush(&mut self) -> Result<(), RecordError> {
        self.frames_in_chunk = 0;
        self.writer.flush().map_err(|source| failed(&self.partial, "a chunk", source))
    }

    /// Messages by topic.
    pub(crate) fn counts(&self) -> BTreeMap<String, u64> {
        self.channels.iter().map(|(t, c)| (t.clone(), u64::from(c.messages))).collect()
    }

    pub(crate) fn partial(&self) -> &Path {
        &self.partial
    }

    /// Completes the file and gives it its final name. Returns path and size in bytes.
    pub(crate) fn finish(mut self) -> Result<(PathBuf, u64), RecordError> {
        let what = "the index";
        let io_failed = |e: io::Error| failed(&self.partial, what, McapError::Io(e));
        self.writer.finish().map_err(|source| failed(&self.partial, what, source))?;
        let file = self.writer.into_inner().into_inner().map_err(|e| io_failed(e.into_error()))?;
        file.sync_all().map_err(io_failed)?;
        let bytes = file.metadata().map_err(io_failed)?.len();
        drop(file);
        match fs::rename(&self.partial, &self.path) {
            Ok(()) => Ok((self.path, bytes)),
            Err(source) => {
                Err(RecordError::Rename { partial: self.partial, path: self.path, source })
            }
        }
    }
}

fn failed(partial: &Path, what: &str, source: McapError) -> RecordError {
    RecordError::Write { partial: partial.to_owned(), what: what.to_owned(), source }
}
