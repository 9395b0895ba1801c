//! What can go wrong while a recording is written or read.

use std::io;
use std::path::PathBuf;

use cranny_world::BodyId;
use mcap::McapError;
use thiserror::Error;

/// A recording that cannot be written. Nothing lies under the final name then.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The path names a folder, or no file at all.
    #[error("cannot record to '{}': it names no file (a folder, a device or a pipe, or nothing); say e.g. 'out/run.mcap'", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// The folder does not exist.
    #[error(
        "cannot record to '{}': there is no folder '{}'; create it or choose another",
        path.display(),
        folder.display()
    )]
    MissingFolder {
        /// The path.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The partial file cannot be created.
    #[error("cannot record to '{}': creating the file failed: {source}", partial.display())]
    Create {
        /// The partial file.
        partial: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Writing failed: a full disk, as a rule.
    #[error(
        "recording {what} to '{}' failed: {}; what was written before is left there. Make room on the disk, or record to another one",
        partial.display(),
        reason(source)
    )]
    Write {
        /// The partial file.
        partial: PathBuf,
        /// What was being written.
        what: String,
        /// Why.
        source: McapError,
    },
    /// The finished file cannot be given its final name.
    #[error(
        "the recording is complete, but '{}' cannot be renamed to '{}': {source}; rename it by hand",
        partial.display(),
        path.display()
    )]
    Rename {
        /// The complete file.
        partial: PathBuf,
        /// Its final name.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A message that cannot be encoded.
    #[error("the message for {topic} cannot be encoded: {reason}")]
    Encode {
        /// Its topic.
        topic: String,
        /// Why.
        reason: String,
    },
    /// A step's duration that is none.
    #[error("the step's duration is {dt} s: it must be a finite number above 0")]
    StepDuration {
        /// The value found, seconds.
        dt: f64,
    },
    /// Times end after 2^32 seconds.
    #[error("step {step} of {dt} s lies beyond the 136 years that a recording can tell")]
    TimeOutOfRange {
        /// The step.
        step: u64,
        /// Its duration, seconds.
        dt: f64,
    },
    /// Two bodies of one name: they would share a frame.
    #[error("two recorded bodies are named '{name}': names are frames and must be unique")]
    DuplicateBody {
        /// The name.
        name: String,
    },
    /// An answer about a body that the world does not hold.
    #[error(
        "the report names body {body}, which the world does not hold: record a step before bodies are removed"
    )]
    UnknownBody {
        /// The body.
        body: BodyId,
    },
    /// An image that is no PNG.
    #[error("the picture of camera '{camera}' ({bytes} bytes) is not a PNG")]
    NotPng {
        /// The camera.
        camera: String,
        /// The picture's size.
        bytes: usize,
    },
}

/// A recording that cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be read.
    #[error("cannot read the recording '{}': {source}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file does not begin as MCAP does.
    #[error("'{}' is no MCAP recording: {}", path.display(), reason(source))]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// Why.
        source: McapError,
    },
    /// A message does not hold what its topic promises.
    #[error("message {number} of {topic} in '{}' cannot be understood: {reason}", path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Counts from 0 within the topic.
        number: usize,
        /// Why.
        reason: String,
    },
}

/// The cause, where the container's own message hides it.
fn reason(error: &McapError) -> String {
    match error {
        McapError::Io(cause) => cause.to_string(),
        other => other.to_string(),
    }
}
