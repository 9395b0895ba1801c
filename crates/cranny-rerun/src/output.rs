//! Where it goes: a file that is whole or not there, or a viewer that runs.

use std::net::{TcpStream, ToSocketAddrs};
use std::path::Path;
use std::time::Duration;

use cranny_record::{Recording, topic, write_whole};
use re_sdk::external::re_uri::{self, RedapUri};
use re_sdk::{RecordingStream, RecordingStreamBuilder, RecordingStreamError};

use crate::archetypes::ViewCoordinates;
use crate::clock::Clock;
use crate::error::RerunError;
use crate::source::Source;
use crate::stream::Stream;
use crate::{bodies, contacts, layout, notes, plots};

/// The address at which Rerun's viewer listens by default.
pub const DEFAULT_VIEWER: &str = re_sdk::DEFAULT_CONNECT_URL;

/// By this name the viewer keeps what people change of the layout.
const APPLICATION: &str = "cranny";

/// How long a viewer may take. Smaller: a viewer that is far away or busy is given up; larger: it
/// takes long to learn that there is none.
const PATIENCE: Duration = Duration::from_secs(20);

/// A file that was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// Its size.
    pub bytes: u64,
    /// Frames that it holds.
    pub frames: usize,
}

/// What was sent to a viewer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sent {
    /// Frames that were sent.
    pub frames: usize,
}

/// Writes a recording as an `.rrd` file, replacing what lies there. It is put together in memory.
///
/// # Errors
///
/// [`RerunError`]; nothing new lies under the name then.
pub fn write(recording: &Recording, path: impl AsRef<Path>) -> Result<Written, RerunError> {
    let path = path.as_ref();
    let source = Source::of(recording)?;
    let (stream, storage) = builder(&source).memory().map_err(|error| failed("the file", error))?;
    tell(&stream, recording, &source)?;
    let bytes = storage
        .drain_as_bytes()
        .map_err(|error| RerunError::Encode { path: path.to_owned(), reason: error.to_string() })?;
    write_whole(path, &bytes)
        .map_err(|source| RerunError::Write { path: path.to_owned(), source })?;
    Ok(Written { bytes: bytes.len() as u64, frames: source.transforms.len() })
}

/// Sends a recording to a viewer, as [`DEFAULT_VIEWER`].
///
/// # Errors
///
/// [`RerunError`].
pub fn send(recording: &Recording, url: &str) -> Result<Sent, RerunError> {
    let source = Source::of(recording)?;
    let refused = |reason: String| RerunError::Viewer { url: url.to_owned(), reason };
    knock(url).map_err(refused)?;
    let stream = builder(&source).connect_grpc_opts(url).map_err(|e| refused(e.to_string()))?;
    tell(&stream, recording, &source)?;
    if let Err(error) = stream.flush_with_timeout(PATIENCE) {
        // Dropped, it would wait for its viewer for ever.
        std::mem::forget(stream);
        return Err(refused(error.to_string()));
    }
    Ok(Sent { frames: source.transforms.len() })
}

/// Whether anybody listens at an address. The library itself would wait until somebody does.
fn knock(url: &str) -> Result<(), String> {
    let RedapUri::Proxy(viewer) = url.parse().map_err(|error: re_uri::Error| error.to_string())?
    else {
        return Err("its address must end in '/proxy'".to_owned());
    };
    let place = (viewer.origin.host.to_string(), viewer.origin.port);
    let places = place.to_socket_addrs().map_err(|error| error.to_string())?;
    let mut reason = "the name has no address".to_owned();
    for place in places {
        match TcpStream::connect_timeout(&place, PATIENCE) {
            Ok(_) => return Ok(()),
            Err(error) => reason = error.to_string(),
        }
    }
    Err(reason)
}

fn builder(source: &Source) -> RecordingStreamBuilder {
    RecordingStreamBuilder::new(APPLICATION)
        // An environment variable would turn it off, and an empty file be called written.
        .enabled(true)
        // They hold the time at which the file is written.
        .send_properties(false)
        .with_blueprint(layout::layout(source, &plots::groups(&source.stats)))
}

fn tell(to: &RecordingStream, recording: &Recording, source: &Source) -> Result<(), RerunError> {
    // No clock is in the file.
    to.set_log_time_enabled(false);
    to.set_log_tick_enabled(false);
    let scene = recording.metadata(topic::METADATA).and_then(|said| said.get("scene"));
    if let Some(scene) = scene {
        to.send_recording_name(scene.as_str()).map_err(|error| failed("the name", error))?;
    }
    let clock = Clock::of(source);
    let stream = Stream { to, clock: &clock };
    stream.once(&re_sdk::EntityPath::root(), &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    bodies::tell(&stream, source)?;
    contacts::tell(&stream, source)?;
    plots::tell(&stream, source)?;
    notes::tell(&stream, recording, source)
}

fn failed(what: &str, source: RecordingStreamError) -> RerunError {
    RerunError::Stream { what: what.to_owned(), source: Box::new(source) }
}
