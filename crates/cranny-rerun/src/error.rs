//! What can go wrong between a recording and the viewer.

use std::io;
use std::path::PathBuf;

use cranny_record::ReadError;
use re_sdk::RecordingStreamError;
use thiserror::Error;

/// A recording that cannot be made into what Rerun reads. Nothing new lies under the output's name
/// then.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RerunError {
    /// A message of the recording cannot be understood.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Parts of the recording are missing.
    #[error(
        "recording '{}' {why}: 'cranny recover' makes a whole recording of it, which Rerun can be given",
        path.display()
    )]
    NotWhole {
        /// The recording.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The recording holds no frame.
    #[error("recording '{}' holds no frame: there is nothing to show", path.display())]
    Empty {
        /// The recording.
        path: PathBuf,
    },
    /// Rerun's library refused something.
    #[error("{what} cannot be sent to Rerun: {source}")]
    Stream {
        /// What was being written.
        what: String,
        /// Why.
        source: Box<RecordingStreamError>,
    },
    /// What was gathered cannot be encoded.
    #[error("'{}' cannot be encoded: {reason}", path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The file cannot be written.
    #[error(
        "writing '{}' failed: {source}. Choose another folder or free the disk.",
        path.display()
    )]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// No viewer takes what is sent.
    #[error("no viewer takes it at {url}: {reason}. Start one by 'rerun', or name its address.")]
    Viewer {
        /// The address.
        url: String,
        /// Why.
        reason: String,
    },
}
