//! Writing: bodies once, then frame after frame.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use foxglove::bytes::Bytes;
use foxglove::messages::{
    CompressedImage, FrameTransform, FrameTransforms, KeyValuePair, Log, SceneEntity,
    SceneEntityDeletion, SceneUpdate, Timestamp, TriangleListPrimitive, log::Level,
    scene_entity_deletion,
};

use crate::contact_marks::{ContactMarks, normal_poses, point_cloud};
use crate::convert::{color, point3, pose, quaternion, time_ns, timestamp, vector3};
use crate::error::RecordError;
use crate::frame::{Frame, RecordedBody, RecordingInfo};
use crate::message::{
    CONTACTS_SCHEMA, ContactsMessage, EVENTS_SCHEMA, EventsMessage, STATS_SCHEMA, StatsMessage,
};
use crate::output::{Output, PARTIAL};
use crate::topic;
use cranny_exact::Pose;
use cranny_world::description::BodyKind;

/// How urgent a line of the log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LogLevel {
    /// For whoever looks for a fault.
    Debug,
    /// For whoever follows the run.
    Info,
    /// Something is doubtful.
    Warning,
    /// Something failed.
    Error,
}

/// What a finished recording holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Summary {
    /// The file.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// Frames written.
    pub frames: u64,
    /// Messages by topic.
    pub messages: BTreeMap<String, u64>,
}

/// Writes a recording.
///
/// Dropped without [`finish`](Self::finish) it leaves a readable `NAME.partial`, and nothing under
/// the final name.
pub struct Recorder {
    output: Output,
    dt: f64,
    /// Of the latest frame, image or change of bodies, nanoseconds.
    now: u64,
    frames: u64,
    last_step: Option<u64>,
    names: BTreeSet<String>,
    /// Digests of models that are attached.
    attached: BTreeSet<String>,
    marks: ContactMarks,
}

/// Diameter of a contact's mark, in parts of the smallest body's diagonal. Smaller: marks vanish on
/// large bodies; larger: they hide the region that they mark.
const MARK_SIZE: f64 = 0.03;

/// Diameter of a mark where no body was given, units of length.
const LONE_MARK_SIZE: f64 = 0.02;

/// What a PNG begins with.
const PNG_SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

impl Recorder {
    /// Opens `path.partial` (replacing what lies there) and writes what is known beforehand.
    ///
    /// # Errors
    ///
    /// A [path](RecordError::NotAFile) or [folder](RecordError::MissingFolder) that is none, a file
    /// that cannot be [created](RecordError::Create) or [written](RecordError::Write), or a
    /// [step](RecordError::StepDuration) without duration.
    pub fn create(path: impl AsRef<Path>, info: &RecordingInfo) -> Result<Self, RecordError> {
        if !(info.dt > 0.0 && info.dt.is_finite()) {
            return Err(RecordError::StepDuration { dt: info.dt });
        }
        let mut output = Output::create(path.as_ref(), PARTIAL)?;
        output.metadata(topic::METADATA, info.metadata())?;
        for attachment in &info.attachments {
            output.attach(&attachment.name, &attachment.media_type, &attachment.data)?;
        }
        output.flush()?;
        Ok(Self {
            output,
            dt: info.dt,
            now: 0,
            frames: 0,
            last_step: None,
            names: BTreeSet::new(),
            attached: BTreeSet::new(),
            marks: ContactMarks::of_size(LONE_MARK_SIZE),
        })
    }

    /// Where the recording lies until it is finished.
    #[must_use]
    pub fn partial_path(&self) -> &Path {
        self.output.partial()
    }

    /// Writes bodies that are there from a step on, in one message: its frame, and what was found
    /// in it, are of these. Call it before the first frame, and before the first frame of bodies
    /// that come later.
    ///
    /// # Errors
    ///
    /// A [name](RecordError::DuplicateBody) of a body that is there;
    /// [`RecordError::TimeOutOfRange`], [`RecordError::Write`].
    pub fn bodies(&mut self, step: u64, bodies: &[RecordedBody]) -> Result<(), RecordError> {
        let mut names = self.names.clone();
        for body in bodies {
            if !names.insert(body.name.to_owned()) {
                return Err(RecordError::DuplicateBody { name: body.name.to_owned() });
            }
        }
        self.now = self.time_of(step)?;
        bodies.iter().try_for_each(|body| self.attach_model(body))?;
        let time = timestamp(self.now);
        let entities = bodies.iter().map(|body| entity(body, time)).collect();
        let update = SceneUpdate { deletions: Vec::new(), entities };
        self.output.message(topic::BODIES, self.now, &update)?;
        self.names = names;
        let diagonals = bodies.iter().map(|b| b.mesh.bounds().diagonal()).filter(|&d| d > 0.0);
        if let Some(smallest) = diagonals.reduce(f64::min) {
            self.marks.resize(MARK_SIZE * smallest);
        }
        self.output.flush()
    }

    /// What is drawn of most bodies is what collides; of the others both are kept.
    fn attach_model(&mut self, body: &RecordedBody) -> Result<(), RecordError> {
        let Some(model) = body.model.filter(|model| model.mesh() != body.mesh) else {
            return Ok(());
        };
        let digest = model.digest_text();
        if self.attached.insert(digest.clone()) {
            let name = topic::model(&digest);
            self.output.attach(&name, "application/octet-stream", &model.encode())?;
        }
        Ok(())
    }

    /// Takes a body out of the picture from a step on. Its name is free then. Nothing is written
    /// for one that is not there.
    ///
    /// # Errors
    ///
    /// [`RecordError::TimeOutOfRange`], [`RecordError::Write`].
    pub fn remove_body(&mut self, step: u64, name: &str) -> Result<(), RecordError> {
        if !self.names.contains(name) {
            return Ok(());
        }
        self.now = self.time_of(step)?;
        self.names.remove(name);
        let deletion = SceneEntityDeletion {
            timestamp: Some(timestamp(self.now)),
            r#type: scene_entity_deletion::Type::MatchingId as i32,
            id: name.to_owned(),
        };
        let update = SceneUpdate { deletions: vec![deletion], entities: Vec::new() };
        self.output.message(topic::BODIES, self.now, &update)
    }

    /// Writes one step to all topics that are due every frame.
    ///
    /// # Errors
    ///
    /// [`RecordError::TimeOutOfRange`], [`RecordError::Write`].
    pub fn frame(&mut self, frame: &Frame) -> Result<(), RecordError> {
        let now = self.time_of(frame.step)?;
        self.now = now;
        let time = timestamp(now);
        let output = &mut self.output;
        let transforms = frame.poses.iter().map(|(name, pose)| transform(name, pose, time));
        let transforms = FrameTransforms { transforms: transforms.collect() };
        output.message(topic::TRANSFORMS, now, &transforms)?;
        output.message(topic::CONTACT_SCENE, now, &self.marks.scene(frame, time))?;
        output.message(topic::CONTACT_POINTS, now, &point_cloud(frame, time))?;
        output.message(topic::CONTACT_NORMALS, now, &normal_poses(frame, time))?;
        output.json(topic::CONTACTS, &CONTACTS_SCHEMA, now, &ContactsMessage::of(frame))?;
        output.json(topic::EVENTS, &EVENTS_SCHEMA, now, &EventsMessage::of(frame))?;
        output.json(topic::STATS, &STATS_SCHEMA, now, &StatsMessage::of(frame))?;
        self.frames += 1;
        self.last_step = Some(frame.step);
        output.end_frame()
    }

    /// Closes the chunk at hand and hands it to the operating system: a kill loses nothing that was
    /// recorded before. Chunks are closed after [`FRAMES_PER_CHUNK`](crate::FRAMES_PER_CHUNK)
    /// frames anyway; a caller whose frames take long calls this in between.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`].
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.output.flush()
    }

    /// Writes a camera's picture of a step.
    ///
    /// # Errors
    ///
    /// [`RecordError::NotPng`], [`RecordError::TimeOutOfRange`], [`RecordError::Write`].
    pub fn image(&mut self, camera: &str, step: u64, png: &[u8]) -> Result<(), RecordError> {
        if !png.starts_with(PNG_SIGNATURE) {
            let (camera, bytes) = (camera.to_owned(), png.len());
            return Err(RecordError::NotPng { camera, bytes });
        }
        let now = self.time_of(step)?;
        self.now = now;
        let image = CompressedImage {
            timestamp: Some(timestamp(now)),
            frame_id: camera.to_owned(),
            data: Bytes::copy_from_slice(png),
            format: "png".to_owned(),
        };
        self.output.message(&topic::camera(camera), now, &image)
    }

    /// Writes a line of the log, at the time of the latest frame, picture or change of bodies.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`].
    pub fn log(&mut self, level: LogLevel, text: &str) -> Result<(), RecordError> {
        let level = match level {
            LogLevel::Debug => Level::Debug,
            LogLevel::Info => Level::Info,
            LogLevel::Warning => Level::Warning,
            LogLevel::Error => Level::Error,
        };
        let log = Log {
            timestamp: Some(timestamp(self.now)),
            level: level as i32,
            message: text.to_owned(),
            name: "cranny".to_owned(),
            ..Log::default()
        };
        self.output.message(topic::LOG, self.now, &log)
    }

    /// Completes the recording and gives it its final name, replacing what lies there.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`], [`RecordError::Rename`]. The partial file is left.
    pub fn finish(self) -> Result<Summary, RecordError> {
        self.end(None)
    }

    /// As [`finish`](Self::finish), and notes in the metadata that the run was broken off, and why.
    ///
    /// # Errors
    ///
    /// As [`finish`](Self::finish).
    pub fn finish_interrupted(self, why: &str) -> Result<Summary, RecordError> {
        self.end(Some(why))
    }

    fn end(mut self, interrupted: Option<&str>) -> Result<Summary, RecordError> {
        let mut end = BTreeMap::from([
            ("interrupted".to_owned(), interrupted.is_some().to_string()),
            ("frames".to_owned(), self.frames.to_string()),
        ]);
        end.extend(self.last_step.map(|step| ("last_step".to_owned(), step.to_string())));
        end.extend(interrupted.map(|why| ("why".to_owned(), why.to_owned())));
        self.output.metadata(topic::METADATA_END, end)?;
        let messages = self.output.counts();
        let (path, bytes) = self.output.finish()?;
        Ok(Summary { path, bytes, frames: self.frames, messages })
    }

    fn time_of(&self, step: u64) -> Result<u64, RecordError> {
        time_ns(step, self.dt).ok_or(RecordError::TimeOutOfRange { step, dt: self.dt })
    }
}

fn entity(body: &RecordedBody, timestamp: Timestamp) -> SceneEntity {
    let triangles = TriangleListPrimitive {
        pose: Some(pose(&Pose::IDENTITY)),
        points: body.mesh.vertices().iter().map(|&p| point3(p)).collect(),
        color: Some(color(body.color)),
        indices: body.mesh.faces().iter().flatten().copied().collect(),
        ..TriangleListPrimitive::default()
    };
    SceneEntity {
        timestamp: Some(timestamp),
        frame_id: body.name.to_owned(),
        id: body.name.to_owned(),
        frame_locked: true,
        metadata: facts(body),
        triangles: vec![triangles],
        ..SceneEntity::default()
    }
}

fn facts(body: &RecordedBody) -> Vec<KeyValuePair> {
    let entry = |key: &str, value: String| KeyValuePair { key: key.to_owned(), value };
    let model = body.model.map(|model| entry(topic::MODEL_KEY, model.digest_text()));
    let kind = body.kind.map(|kind| match kind {
        BodyKind::Fixed => "fixed",
        BodyKind::Kinematic => "kinematic",
        BodyKind::Dynamic => "dynamic",
    });
    let color = body.color_is_stated.then(|| entry(topic::COLOR_KEY, color_text(body.color)));
    let primitive = body.primitive.map(|text| entry(topic::PRIMITIVE_KEY, text.to_owned()));
    model
        .into_iter()
        .chain(primitive)
        .chain(kind.map(|kind| entry(topic::KIND_KEY, kind.to_owned())))
        .chain(color)
        .chain(body.number.map(|number| entry(topic::NUMBER_KEY, number.to_string())))
        .chain(body.sensor.then(|| entry(topic::SENSOR_KEY, true.to_string())))
        .collect()
}

/// `#rrggbb`, without opacity.
fn color_text([red, green, blue, _]: [f64; 4]) -> String {
    let [red, green, blue] = [red, green, blue].map(|share| (255.0 * share).round() as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn transform(name: &str, pose: &Pose, timestamp: Timestamp) -> FrameTransform {
    FrameTransform {
        timestamp: Some(timestamp),
        parent_frame_id: topic::WORLD_FRAME.to_owned(),
        child_frame_id: name.to_owned(),
        translation: Some(vector3(pose.translation)),
        rotation: Some(quaternion(pose.rotation)),
    }
}
