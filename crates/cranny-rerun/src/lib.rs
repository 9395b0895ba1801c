//! Recordings for [Rerun](https://rerun.io)'s viewer: an `.rrd` file of what an MCAP file holds, or
//! the same sent to a viewer that runs.
//!
//! # Promises
//!
//! - **All that is drawn is there**: bodies as shaded meshes, a transform a frame, contacts as
//!   points coloured by depth, normals as arrows, curves as line strips, pictures; counts, depth,
//!   energy and milliseconds of phases as plots; events and the log as text. A layout comes with
//!   it.
//! - **Times are the recording's**: the timeline `time` is simulated seconds, `step` the steps. No
//!   clock is among them.
//! - **No half-written file under its final name**: it grows as `NAME.partial`.
//!
//! # Non-promises
//!
//! Rerun draws in single precision, and so is what is written. A recording that is cut off or
//! damaged is refused: `cranny_record::recover` makes a whole one of it.
//!
//! | entity | holds |
//! |---|---|
//! | `/bodies/NAME` | the body's mesh, static unless it comes late, changes or leaves; its transforms |
//! | `/contacts/points`, `/normals`, `/curves` | what touches, in the world |
//! | `/plots/GROUP/NAME` | a number over time |
//! | `/events`, `/log` | what began and ended; what was skipped, and why |
//! | `/camera/NAME` | pictures |
//! | `/about` | what was run |
//!
//! ```
//! use cranny_exact::{DVec3, Pose};
//! use cranny_record::{Frame, Recorder, Recording, RecordingInfo};
//!
//! # let folder = tempfile::tempdir()?;
//! # let (mcap, rrd) = (folder.path().join("run.mcap"), folder.path().join("run.rrd"));
//! let mut recorder = Recorder::create(&mcap, &RecordingInfo::new(1.0 / 240.0))?;
//! let pose = Pose::at(DVec3::new(0.1, 0.2, 0.3));
//! recorder.frame(&Frame { poses: vec![("ball", pose)], ..Frame::at_step(3) })?;
//! recorder.finish()?;
//!
//! let written = cranny_rerun::write(&Recording::open(&mcap)?, &rrd)?;
//! assert_eq!((written.frames, written.bytes), (1, std::fs::metadata(&rrd)?.len()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bodies;
mod clock;
mod colors;
mod contacts;
mod error;
mod layout;
mod notes;
mod output;
mod plots;
mod shading;
mod source;
mod stream;

use re_sdk_types::{archetypes, components};

pub use error::RerunError;
pub use output::{DEFAULT_VIEWER, Sent, Written, send, write};
