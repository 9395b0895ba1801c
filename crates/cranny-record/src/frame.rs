//! What the caller hands in.

use std::collections::BTreeMap;

use cranny_exact::Pose;
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::Answer;
use cranny_world::description::BodyKind;
use cranny_world::{BodyId, PairEventKind, StepReport, StepStats, World};

use crate::error::RecordError;

/// What is known before the first frame; it becomes the metadata record `cranny`.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingInfo {
    /// The scene's name.
    pub scene: String,
    /// A hash of the scene, in whatever form the caller writes it elsewhere.
    pub scene_hash: String,
    /// Who detects collisions.
    pub detector: String,
    /// How exactly.
    pub accuracy: String,
    /// The run's seed.
    pub seed: u64,
    /// Duration of a step, seconds, finite and > 0.
    pub dt: f64,
    /// Further entries; they give way to the above where names collide.
    pub further: BTreeMap<String, String>,
    /// Files that belong to the run: the scene, its models.
    pub attachments: Vec<RecordedAttachment>,
}

impl RecordingInfo {
    /// An unnamed run of steps of `dt` seconds, by the exact detector.
    #[must_use]
    pub fn new(dt: f64) -> Self {
        Self {
            scene: String::new(),
            scene_hash: String::new(),
            detector: "cranny".to_owned(),
            accuracy: "exact".to_owned(),
            seed: 0,
            dt,
            further: BTreeMap::new(),
            attachments: Vec::new(),
        }
    }

    pub(crate) fn metadata(&self) -> BTreeMap<String, String> {
        let entries = [
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("format", "2".to_owned()),
            ("scene", self.scene.clone()),
            ("scene_hash", self.scene_hash.clone()),
            ("detector", self.detector.clone()),
            ("accuracy", self.accuracy.clone()),
            ("seed", self.seed.to_string()),
            ("dt", self.dt.to_string()),
            ("dt_bits", format!("{:016x}", self.dt.to_bits())),
        ];
        let mut all = self.further.clone();
        all.extend(entries.map(|(name, value)| (name.to_owned(), value)));
        all
    }
}

/// A file that belongs to the run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedAttachment {
    /// Its name.
    pub name: String,
    /// Its kind, as `text/plain`.
    pub media_type: String,
    /// What it holds.
    pub data: Vec<u8>,
}

/// A body as viewers shall draw it.
#[derive(Clone, Copy, Debug)]
pub struct RecordedBody<'a> {
    /// Unique; the name of its frame.
    pub name: &'a str,
    /// What is drawn, in the body's frame.
    pub mesh: &'a Mesh,
    /// Red, green, blue and opacity, 0 to 1.
    pub color: [f64; 4],
    /// Whether somebody chose that color; otherwise a replay chooses one of its own.
    pub color_is_stated: bool,
    /// Its number in the run, by which pictures choose colors; `None` where there is none.
    pub number: Option<u32>,
    /// Whether it is a sensor, which overlaps others by design.
    pub sensor: bool,
    /// What collides: its digest is recorded, and all of it where it differs from what is drawn.
    /// `None`: a primitive, or nothing can be computed anew.
    pub model: Option<&'a Model>,
    /// The primitive that collides, in words that are recorded as they are.
    pub primitive: Option<&'a str>,
    /// How it moves; `None` where the caller does not say.
    pub kind: Option<BodyKind>,
}

/// One recorded step.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame<'a> {
    /// The log time is this times the step's duration.
    pub step: u64,
    /// Where each body is: `world_from_body`.
    pub poses: Vec<(&'a str, Pose)>,
    /// What was found about pairs.
    pub contacts: Vec<PairContacts<'a>>,
    /// What began and ended.
    pub events: Vec<RecordedEvent<'a>>,
    /// Counts and sums; the deepest pair is named by [`deepest`](Self::deepest), by names.
    pub stats: StepStats,
    /// The deepest overlap.
    pub deepest: Option<RecordedDepth<'a>>,
    /// Further numbers by name: milliseconds of a phase, energy. Measured times make the recording
    /// differ from run to run.
    pub measures: Vec<(&'a str, f64)>,
}

/// What was found about a pair, and the poses from which.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContacts<'a> {
    /// Name of the answer's A.
    pub a: &'a str,
    /// Name of its B.
    pub b: &'a str,
    /// Where A was: `world_from_body`, to the bit.
    pub pose_a: Pose,
    /// Where B was.
    pub pose_b: Pose,
    /// The frame in which it was computed; `None`: in the world's, from these poses.
    pub frame: Option<PairFrame>,
    /// Regions farther apart were not looked for, >= 0; `None` where the caller does not say, and
    /// then the answer cannot be computed anew.
    pub margin: Option<f64>,
    /// What was found.
    pub answer: &'a Answer,
}

/// The frame of one body of a pair, in which the other is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairFrame {
    /// Whether the frame is that of A.
    pub first_is_a: bool,
    /// The other body's pose in it, to the bit.
    pub first_from_second: Pose,
}

/// Something that happened between two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedEvent<'a> {
    /// Name of the one.
    pub a: &'a str,
    /// Name of the other.
    pub b: &'a str,
    /// What happened.
    pub kind: PairEventKind,
    /// Of a beginning: whether it is open if the two touch.
    pub open: bool,
}

/// The deepest overlap of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedDepth<'a> {
    /// > 0, in units of length.
    pub depth: f64,
    /// Name of the one body.
    pub a: &'a str,
    /// Name of the other.
    pub b: &'a str,
}

impl<'a> Frame<'a> {
    /// A frame in which nothing is known but its step.
    #[must_use]
    pub fn at_step(step: u64) -> Self {
        Self {
            step,
            poses: Vec::new(),
            contacts: Vec::new(),
            events: Vec::new(),
            stats: StepStats::default(),
            deepest: None,
            measures: Vec::new(),
        }
    }

    /// All that a world's last step reported, under the report's own number; bodies and pairs in
    /// the order of ids. Call it before bodies are moved or removed again.
    ///
    /// # Errors
    ///
    /// [`RecordError::UnknownBody`] where an answer's body was removed.
    pub fn of_step(world: &'a World, report: &'a StepReport) -> Result<Self, RecordError> {
        let name = |body: BodyId| world.name(body).ok_or(RecordError::UnknownBody { body });
        let contacts = report.answers.iter().map(|pair| {
            let pose =
                |body| world.body(body).map(|b| b.pose()).ok_or(RecordError::UnknownBody { body });
            Ok(PairContacts {
                a: name(pair.a)?,
                b: name(pair.b)?,
                pose_a: pose(pair.a)?,
                pose_b: pose(pair.b)?,
                frame: None,
                margin: None,
                answer: &pair.answer,
            })
        });
        let events = report.events.iter().map(|e| {
            let open = e.kind == PairEventKind::Began && report.is_open(e.a, e.b);
            Ok(RecordedEvent { a: name(e.a)?, b: name(e.b)?, kind: e.kind, open })
        });
        let deepest = report.stats.deepest;
        Ok(Self {
            step: report.step,
            poses: world.bodies().map(|(_, body)| (body.name(), body.pose())).collect(),
            contacts: contacts.collect::<Result<_, RecordError>>()?,
            events: events.collect::<Result<_, RecordError>>()?,
            stats: report.stats,
            deepest: deepest
                .map(|d| Ok(RecordedDepth { depth: d.depth, a: name(d.a)?, b: name(d.b)? }))
                .transpose()?,
            measures: Vec::new(),
        })
    }
}
