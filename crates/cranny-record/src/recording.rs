//! Reading what a [`Recorder`](crate::Recorder) wrote, whole or cut short.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cranny_exact::{DQuat, DVec3, Pose};
use foxglove::Decode;
use foxglove::messages::{FrameTransform, FrameTransforms, Log, log::Level};
use mcap::records::Record;
use mcap::{MAGIC, McapError};
use serde::de::DeserializeOwned;

use crate::drawn::DrawnBody;
use crate::error::ReadError;
use crate::frame::RecordedAttachment;
use crate::message::{ContactsMessage, EventsMessage, StatsMessage};
use crate::recorder::LogLevel;
use crate::records::for_each_record;
use crate::topic;

/// `world_from_body` by the bodies' names.
pub type PosesByName = BTreeMap<String, Pose>;

/// A line of the log: how urgent, and what.
pub type LogLine = (LogLevel, String);

/// A topic of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicSummary {
    /// Name of the schema of its messages; empty where they have none.
    pub schema: String,
    /// How many there are.
    pub messages: u64,
}

/// An opened recording. The file is held in memory as filed (compressed).
///
/// A file that ends early (a kill, a full disk) is read up to where it can be: see
/// [`is_complete`](Self::is_complete). Of a damaged one, whole chunks are read:
/// [`damaged_chunks`](Self::damaged_chunks).
#[derive(Clone, Debug)]
pub struct Recording {
    path: PathBuf,
    bytes: Vec<u8>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    attachments: Vec<RecordedAttachment>,
    topics: BTreeMap<String, TopicSummary>,
    channels: BTreeMap<u16, String>,
    complete: bool,
    damaged_chunks: u64,
}

impl Recording {
    /// Reads a file and lists what it holds.
    ///
    /// # Errors
    ///
    /// [`ReadError::Open`], or [`ReadError::NotMcap`] where not even the beginning is MCAP.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        let path = path.as_ref().to_owned();
        let bytes =
            fs::read(&path).map_err(|source| ReadError::Open { path: path.clone(), source })?;
        if !bytes.starts_with(MAGIC) {
            return Err(ReadError::NotMcap { path, source: McapError::BadMagic });
        }
        let mut recording = Self {
            path,
            bytes: Vec::new(),
            metadata: BTreeMap::new(),
            attachments: Vec::new(),
            topics: BTreeMap::new(),
            channels: BTreeMap::new(),
            complete: false,
            damaged_chunks: 0,
        };
        recording.list(&bytes);
        recording.bytes = bytes;
        Ok(recording)
    }

    /// Where it lies.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the file was finished. If not, what follows its last whole chunk is lost.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// How many chunks do not match their sums. What they held is missing.
    #[must_use]
    pub fn damaged_chunks(&self) -> u64 {
        self.damaged_chunks
    }

    /// Whether the run was broken off: by a signal, as its end says, or by a kill, so that it has
    /// no end.
    #[must_use]
    pub fn was_interrupted(&self) -> bool {
        let end = self.metadata(topic::METADATA_END);
        end.is_none_or(|end| end.get("interrupted").is_none_or(|said| said != "false"))
    }

    /// A metadata record by name: [`topic::METADATA`] or [`topic::METADATA_END`].
    #[must_use]
    pub fn metadata(&self, name: &str) -> Option<&BTreeMap<String, String>> {
        self.metadata.get(name)
    }

    /// Files that belong to the run.
    #[must_use]
    pub fn attachments(&self) -> &[RecordedAttachment] {
        &self.attachments
    }

    /// Topics by name.
    #[must_use]
    pub fn topics(&self) -> &BTreeMap<String, TopicSummary> {
        &self.topics
    }

    /// Log times (nanoseconds) and poses by body, frame by frame.
    ///
    /// # Errors
    ///
    /// [`ReadError::Message`] for a message that cannot be decoded or lacks a part.
    pub fn transforms(&self) -> Result<Vec<(u64, PosesByName)>, ReadError> {
        self.messages(topic::TRANSFORMS, |data| {
            let message = FrameTransforms::decode(data).map_err(|e| e.to_string())?;
            message.transforms.into_iter().map(named_pose).collect()
        })
    }

    /// Bodies in the order in which they came; one whose shape changes came once a shape.
    ///
    /// # Errors
    ///
    /// [`ReadError::Message`] for a message that cannot be decoded or holds no mesh.
    pub fn bodies(&self) -> Result<Vec<DrawnBody>, ReadError> {
        let changes = self.body_changes()?;
        Ok(changes.into_iter().flat_map(|(_, changes)| changes.came).collect())
    }

    /// Log times (nanoseconds) and what was found about pairs, frame by frame; poses to the bit.
    ///
    /// # Errors
    ///
    /// [`ReadError::Message`] for a message that is not as its schema says.
    pub fn contacts(&self) -> Result<Vec<(u64, ContactsMessage)>, ReadError> {
        self.messages(topic::CONTACTS, from_json)
    }

    /// Log times (nanoseconds) and events, frame by frame.
    ///
    /// # Errors
    ///
    /// As [`contacts`](Self::contacts).
    pub fn events(&self) -> Result<Vec<(u64, EventsMessage)>, ReadError> {
        self.messages(topic::EVENTS, from_json)
    }

    /// Log times (nanoseconds) and statistics, frame by frame.
    ///
    /// # Errors
    ///
    /// As [`contacts`](Self::contacts).
    pub fn stats(&self) -> Result<Vec<(u64, StatsMessage)>, ReadError> {
        self.messages(topic::STATS, from_json)
    }

    /// Log times (nanoseconds) and lines of the log: how urgent, and what.
    ///
    /// # Errors
    ///
    /// [`ReadError::Message`] for a message that cannot be decoded.
    pub fn log(&self) -> Result<Vec<(u64, LogLine)>, ReadError> {
        self.messages(topic::LOG, |data| {
            let line = Log::decode(data).map_err(|e| e.to_string())?;
            let level = match Level::try_from(line.level) {
                Ok(Level::Debug) => LogLevel::Debug,
                Ok(Level::Warning) => LogLevel::Warning,
                Ok(Level::Error | Level::Fatal) => LogLevel::Error,
                _ => LogLevel::Info,
            };
            Ok((level, line.message))
        })
    }

    fn list(&mut self, bytes: &[u8]) {
        let mut schemas = BTreeMap::new();
        let extent = for_each_record(bytes, &mut |record| match record {
            Record::Schema { header, .. } => {
                schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let schema = schemas.get(&channel.schema_id).cloned().unwrap_or_default();
                let summary = TopicSummary { schema, messages: 0 };
                self.topics.entry(channel.topic.clone()).or_insert(summary);
                self.channels.insert(channel.id, channel.topic);
            }
            Record::Message { header, .. } => {
                let topic = self.channels.get(&header.channel_id);
                if let Some(summary) = topic.and_then(|t| self.topics.get_mut(t)) {
                    summary.messages += 1;
                }
            }
            Record::Metadata(record) => {
                self.metadata.insert(record.name, record.metadata);
            }
            Record::Attachment { header, data, .. } => {
                self.attachments.push(RecordedAttachment {
                    name: header.name,
                    media_type: header.media_type,
                    data: data.into_owned(),
                });
            }
            Record::Footer(_) => self.complete = true,
            _ => {}
        });
        self.damaged_chunks = extent.damaged;
    }

    /// Decodes all messages of a topic.
    pub(crate) fn messages<T>(
        &self,
        topic: &str,
        decode: impl Fn(&[u8]) -> Result<T, String>,
    ) -> Result<Vec<(u64, T)>, ReadError> {
        let mut decoded = Vec::new();
        let mut failed = None;
        for_each_record(&self.bytes, &mut |record| {
            let Record::Message { header, data } = record else { return };
            let is_other = self.channels.get(&header.channel_id).is_none_or(|name| name != topic);
            if is_other || failed.is_some() {
                return;
            }
            match decode(&data) {
                Ok(message) => decoded.push((header.log_time, message)),
                Err(reason) => failed = Some(reason),
            }
        });
        match failed {
            None => Ok(decoded),
            Some(reason) => Err(ReadError::Message {
                path: self.path.clone(),
                topic: topic.to_owned(),
                number: decoded.len(),
                reason,
            }),
        }
    }
}

fn from_json<T: DeserializeOwned>(data: &[u8]) -> Result<T, String> {
    serde_json::from_slice(data).map_err(|e| e.to_string())
}

fn named_pose(transform: FrameTransform) -> Result<(String, Pose), String> {
    let name = transform.child_frame_id;
    let (Some(t), Some(q)) = (transform.translation, transform.rotation) else {
        return Err(format!("the transform of '{name}' lacks a rotation or a translation"));
    };
    let rotation = DQuat::from_xyzw(q.x, q.y, q.z, q.w);
    Ok((name, Pose { rotation, translation: DVec3::new(t.x, t.y, t.z) }))
}
