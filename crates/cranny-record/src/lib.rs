//! Frames to and from MCAP: what a run did, for viewers now and for replay later.
//!
//! # Promises
//!
//! - **Every viewer finds something.** Meshes are written once and follow `/tf`; contacts are
//!   written as a scene, as points and as poses, because no viewer shows all three; pictures are
//!   pictures. The topics are constants in [`topic`].
//! - **Bit-exact where it matters**: `/contacts` holds the very poses that contacts were computed
//!   from; reading gives them back to the bit. `/tf` holds `f64` (a zero loses its sign).
//! - **No half-written file under its final name.** A recording grows as `NAME.partial` and is
//!   renamed when it is finished or interrupted. After a kill the partial file is readable up to
//!   its last chunk, which is at most [`FRAMES_PER_CHUNK`] frames old; [`recover`] makes a whole
//!   recording of it.
//! - **Deterministic**: the log time is the step times its duration. No clock is read; the same
//!   calls give the same bytes (unless the caller records measured times).
//!
//! # Non-promises
//!
//! Nothing is recorded that the caller does not hand in. [`Recording`] reads what [`Recorder`]
//! writes; other MCAP files are for other readers.
//!
//! ```
//! use cranny_exact::{DVec3, Pose};
//! use cranny_record::{Frame, Recorder, Recording, RecordingInfo, topic};
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("run.mcap");
//! let info = RecordingInfo { scene: "drop".into(), ..RecordingInfo::new(1.0 / 240.0) };
//! let mut recorder = Recorder::create(&path, &info)?;
//! let pose = Pose::at(DVec3::new(0.1, 0.2, 0.3));
//! recorder.frame(&Frame { poses: vec![("ball", pose)], ..Frame::at_step(3) })?;
//! let summary = recorder.finish()?;
//! assert_eq!(summary.messages[topic::TRANSFORMS], 1);
//!
//! let recording = Recording::open(&path)?;
//! let (time_ns, poses) = recording.transforms()?.remove(0);
//! assert_eq!((time_ns, poses["ball"]), (12_500_000, pose));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod contact_marks;
mod convert;
mod digest;
mod drawn;
mod error;
mod exact_pose;
mod frame;
mod message;
mod output;
mod recorder;
mod recording;
mod records;
mod recover;
pub mod topic;
mod whole_file;

pub use digest::answer_digest;
pub use drawn::{BodyChanges, DrawnBody, DrawnContact, DrawnCurve, RecordedPicture};
pub use error::{ReadError, RecordError};
pub use exact_pose::ExactPose;
pub use frame::{
    Frame, PairContacts, PairFrame, RecordedAttachment, RecordedBody, RecordedDepth, RecordedEvent,
    RecordingInfo,
};
pub use message::{
    ContactMessage, ContactsMessage, DeepestMessage, EventMessage, EventsMessage, FrameMessage,
    IntervalMessage, MeasureMessage, PairMessage, RegionMessage, StatsMessage, VectorMessage,
    WitnessMessage,
};
pub use output::FRAMES_PER_CHUNK;
pub use recorder::{LogLevel, Recorder, Summary};
pub use recording::{LogLine, PosesByName, Recording, TopicSummary};
pub use recover::{RecoverError, Recovered, recover};
pub use whole_file::write_whole;
