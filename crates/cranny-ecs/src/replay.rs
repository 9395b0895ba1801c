//! A recording computed anew: every pair from the poses and shapes that its answer came from,
//! compared to the bit; and its moments, to be drawn.
//!
//! Verdicts, containment and regions (with depth, area, points and curves) are functions of models,
//! poses and margin, so they must come out the same on every machine. Contacts for a solver, and
//! names of regions, carry history, and are not compared.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Answer, Demand, PairMemory, Query};
use cranny_primitives::{BodyShape, PlacedShape, Primitive, UnknownPrimitive, query_shapes};
use cranny_record::{
    DrawnBody, ExactPose, PairMessage, PosesByName, ReadError, Recording, answer_digest, topic,
};
use cranny_world::description::{
    Accuracy, BodyDescription, BodyKind, Effect, Material, Normals, RecordDescription,
    SceneDescription,
};
use thiserror::Error;

use crate::camera_lines::from_text;

/// A recording that cannot be replayed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// What collides of a body cannot be had from the recording.
    #[error("recording '{}': the model of body '{body}' cannot be prepared anew: {why}", path.display())]
    Model {
        /// The recording.
        path: PathBuf,
        /// The body's name.
        body: String,
        /// Why.
        why: String,
    },
    /// It holds no frame that can be replayed.
    #[error("recording '{}' {why}", path.display())]
    Empty {
        /// The recording.
        path: PathBuf,
        /// What is missing, and what to do.
        why: String,
    },
}

/// An opened recording with its bodies.
pub struct Replay {
    recording: Recording,
    path: PathBuf,
    /// By name.
    bodies: BTreeMap<String, ReplayBody>,
    frames: Vec<ReplayFrame>,
    prepared: Mutex<PreparedShapes>,
}

/// A body of a recording: what it was, from which log time on. Never empty.
type ReplayBody = Vec<(u64, DrawnBody)>;

/// What collides, as of the frames that were computed last. A body that is dented has hundreds of
/// shapes, each with trees of its own: it keeps one.
type PreparedShapes = BTreeMap<String, PreparedShape>;

/// What collides of a body.
#[derive(Clone, Debug)]
struct PreparedShape {
    /// Since which log time.
    since: u64,
    /// The model's digest, where it is one.
    digest: Option<String>,
    /// `None` where the recording does not say what collides; why, where it cannot be prepared.
    shape: Result<Option<BodyShape>, String>,
}

/// A recorded moment.
#[derive(Clone, Debug)]
pub struct ReplayFrame {
    /// Seconds simulated.
    pub time: f64,
    /// `world_from_body` by name.
    pub poses: PosesByName,
    /// What was found about pairs.
    pub pairs: Vec<PairMessage>,
    /// Log time, nanoseconds.
    pub at: u64,
}

/// What a comparison found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplayReport {
    /// Frames computed anew.
    pub frames: u64,
    /// Pairs that came out the same, to the bit.
    pub same: u64,
    /// Pairs that did not; the first of them by name.
    pub different: Vec<ReplayDifference>,
    /// Pairs for which the recording does not say what collides, or within what margin.
    pub unknown: u64,
}

/// A pair that differs from what was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct ReplayDifference {
    /// Seconds simulated.
    pub time: f64,
    /// The pair.
    pub a: String,
    /// The pair.
    pub b: String,
    /// Verdict and depth as recorded.
    pub recorded: String,
    /// The same as computed anew, or why it cannot be.
    pub computed: String,
}

const NANOSECONDS: f64 = 1e9;

impl Replay {
    /// Reads a recording, whole or cut short, and prepares its models.
    ///
    /// # Errors
    ///
    /// [`ReplayError`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReplayError> {
        let path = path.as_ref().to_owned();
        let recording = Recording::open(&path)?;
        let mut bodies = BTreeMap::<String, ReplayBody>::new();
        for (at, changes) in recording.body_changes()? {
            for drawn in changes.came {
                bodies.entry(drawn.name.clone()).or_default().push((at, drawn));
            }
        }
        let mut pairs: BTreeMap<u64, Vec<PairMessage>> =
            recording.contacts()?.into_iter().map(|(at, found)| (at, found.pairs)).collect();
        let frames = recording.transforms()?.into_iter().map(|(at, poses)| {
            let (time, pairs) = (at as f64 / NANOSECONDS, pairs.remove(&at).unwrap_or_default());
            ReplayFrame { time, poses, pairs, at }
        });
        let frames: Vec<ReplayFrame> = frames.collect();
        if frames.is_empty() || bodies.is_empty() {
            let why = match bodies.is_empty() && recording.is_complete() {
                true => {
                    "is whole, and its scene has no bodies: there is nothing to compute or draw"
                }
                false => "holds no whole frame: it was cut off before the first was written out",
            };
            return Err(ReplayError::Empty { path, why: why.to_owned() });
        }
        let replay = Self { recording, path, bodies, frames, prepared: Mutex::default() };
        // Models that are damaged are known at once; shapes that came later, when they are needed.
        for body in replay.bodies.keys() {
            replay.shape(body, replay.frames[0].at).map_err(|why| ReplayError::Model {
                path: replay.path.clone(),
                body: body.clone(),
                why,
            })?;
        }
        Ok(replay)
    }

    /// The file's own listing.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Frames in order of time; never empty.
    #[must_use]
    pub fn frames(&self) -> &[ReplayFrame] {
        &self.frames
    }

    /// Whether contacts are recorded, so that a frame without them means that nothing was near. Of
    /// recordings that name no effects, which are older, one contact is enough.
    #[must_use]
    pub fn has_contacts(&self) -> bool {
        let metadata = self.recording.metadata(topic::METADATA);
        let named = metadata.and_then(|entries| entries.get(topic::EFFECTS_KEY));
        named.is_some_and(|named| named.split(", ").any(|name| name == "Contacts"))
            || self.frames.iter().any(|frame| !frame.pairs.is_empty())
    }

    /// The frame nearest to a time in seconds.
    #[must_use]
    pub fn nearest(&self, time: f64) -> &ReplayFrame {
        let away = |frame: &ReplayFrame| (frame.time - time).abs();
        let nearest = self.frames.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.unwrap_or(&self.frames[0])
    }

    /// Computes the pairs of frames anew and compares.
    #[must_use]
    pub fn compare<'a>(&self, frames: impl Iterator<Item = &'a ReplayFrame>) -> ReplayReport {
        let mut report = ReplayReport::default();
        for frame in frames {
            report.frames += 1;
            for pair in &frame.pairs {
                let computed = match self.compute(pair, frame.at) {
                    None => {
                        report.unknown += 1;
                        continue;
                    }
                    Some(Ok(answer)) if answer_digest(&answer) == pair.digest => {
                        report.same += 1;
                        continue;
                    }
                    Some(Ok(answer)) => computed_words(&answer),
                    Some(Err(why)) => why,
                };
                let (a, b, recorded) = (pair.a.clone(), pair.b.clone(), recorded_words(pair));
                let time = frame.time;
                report.different.push(ReplayDifference { time, a, b, recorded, computed });
            }
        }
        report
    }

    /// The answer about a pair, in the frame and from the poses and shapes in which it was
    /// computed; `None` where the recording does not say what collides, or within what margin.
    fn compute(&self, pair: &PairMessage, at: u64) -> Option<Result<Answer, String>> {
        let shape = |name: &str| {
            let of = |why| format!("the model of body '{name}' cannot be prepared anew: {why}");
            self.shape(name, at).map_err(of)
        };
        let (a, b) = match shape(&pair.a).and_then(|a| Ok((a, shape(&pair.b)?))) {
            Ok((a, b)) => (a?, b?),
            Err(why) => return Some(Err(why)),
        };
        let margin = pair.margin?;
        let question = Query::of(Demand::Regions { margin });
        let ask = |shapes: [&BodyShape; 2], poses: [Pose; 2]| {
            let [first, second] = [0, 1].map(|i| PlacedShape { shape: shapes[i], pose: poses[i] });
            query_shapes(first, second, &question, &mut PairMemory::default())
        };
        let ExactPose(pose_a) = pair.pose_a;
        let ExactPose(pose_b) = pair.pose_b;
        let answer = match pair.frame {
            None => ask([&a, &b], [pose_a, pose_b]),
            Some(frame) => {
                let ExactPose(second) = frame.first_from_second;
                let poses = [Pose::IDENTITY, second];
                let [to_a, to_b] = [pose_a, pose_b].map(|pose| pose.world_from_body());
                match frame.first_is_a {
                    true => ask([&a, &b], poses).map(|answer| answer.moved(&to_a)),
                    false => ask([&b, &a], poses).map(|answer| answer.moved(&to_b).swapped()),
                }
            }
        };
        let near = |mut answer: Answer| {
            answer.regions.retain(|region| region.deepest.separation <= margin);
            answer
        };
        Some(answer.map(near).map_err(|error| error.to_string()))
    }

    /// What collides of a body at a log time; `None` where the recording does not say. Fails if it
    /// cannot be prepared, and says why.
    fn shape(&self, name: &str, at: u64) -> Result<Option<BodyShape>, String> {
        let Some(body) = self.bodies.get(name) else { return Ok(None) };
        let (since, drawn) = as_of(body, at);
        // What a panic leaves is as it was before or after a body's turn.
        let mut prepared = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = prepared.get(name).filter(|known| known.since == *since) {
            return known.shape.clone();
        }
        let same = |known: &&PreparedShape| drawn.model.is_some() && known.digest == drawn.model;
        let shape = match prepared.values().find(same) {
            Some(known) => known.shape.clone(),
            None => self.prepare(drawn),
        };
        let (since, digest) = (*since, drawn.model.clone());
        prepared.insert(name.to_owned(), PreparedShape { since, digest, shape: shape.clone() });
        shape
    }

    /// A primitive as it was written down, or the model: loaded where it is attached, else prepared
    /// of what is drawn.
    fn prepare(&self, body: &DrawnBody) -> Result<Option<BodyShape>, String> {
        if let Some(text) = &body.primitive {
            let primitive: Result<Primitive, UnknownPrimitive> = text.parse();
            return Ok(Some(primitive.map_err(|error| error.to_string())?.into()));
        }
        let Some(digest) = &body.model else { return Ok(None) };
        let name = topic::model(digest);
        let mut attachments = self.recording.attachments().iter();
        let model = match attachments.find(|attached| attached.name == name) {
            Some(attached) => Model::decode(&attached.data).map_err(|e| e.to_string())?,
            None => {
                let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
                let mesh = Mesh::clone(&body.mesh);
                Model::build(mesh, &options).map_err(|e| e.to_string())?.0
            }
        };
        let found = model.digest_text();
        match found == *digest {
            true => Ok(Some(model.into())),
            false => Err(format!(
                "its digest is {found}, and was {digest} when it was recorded: another version of \
                 the program prepared it, or the file is damaged"
            )),
        }
    }
}

/// What a body was at a log time, or first; and since when.
fn as_of(body: &ReplayBody, at: u64) -> &(u64, DrawnBody) {
    let since = body.partition_point(|(since, _)| *since <= at);
    &body[since.saturating_sub(1)]
}

fn recorded_words(pair: &PairMessage) -> String {
    let depth = pair.regions.iter().filter_map(|r| r.depth).reduce(f64::max);
    words(&pair.surface, pair.solid, pair.regions.len(), depth)
}

fn computed_words(answer: &Answer) -> String {
    let surface = match answer.surface {
        cranny_narrow_phase::Surface::None => "none",
        cranny_narrow_phase::Surface::Touch => "touch",
        cranny_narrow_phase::Surface::Cross => "cross",
    };
    let depth = answer.regions.iter().filter_map(|r| r.depth).reduce(f64::max);
    words(surface, answer.solid, answer.regions.len(), depth)
}

fn words(surface: &str, solid: bool, regions: usize, depth: Option<f64>) -> String {
    let depth = depth.map_or("no depth".to_owned(), |depth| format!("depth {depth}"));
    let solid = if solid { ", solids meet" } else { "" };
    format!("surfaces {surface}{solid}, {regions} regions, {depth}")
}

/// What is drawn of a replay.
impl Replay {
    /// The recorded bodies as a scene that stands at a frame: for cameras, colours and shapes.
    #[must_use]
    pub fn scene(&self, frame: &ReplayFrame) -> SceneDescription {
        let metadata = self.recording.metadata(topic::METADATA);
        let entry = |key: &str| metadata.and_then(|entries| entries.get(key)).cloned();
        let name = entry("scene").filter(|name| !name.is_empty());
        // Of contacts pictures need only whether they are recorded.
        let contacts = self.has_contacts().then_some(Effect::Contacts { margin: 0.0 });
        let stem = || self.path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        SceneDescription {
            name: name.or_else(stem).unwrap_or_default(),
            gravity: DVec3::ZERO,
            step: entry("dt").and_then(|dt| dt.parse().ok()).unwrap_or(1.0),
            most_parts: None,
            duration: 0.0,
            seed: 0,
            bodies: self.in_order().into_iter().map(|body| self.described(body, frame)).collect(),
            joints: Vec::new(),
            excluded_pairs: Vec::new(),
            effects: contacts.into_iter().collect(),
            accuracy: Accuracy::Exact,
            budget: None,
            pairs: Vec::new(),
            cameras: entry(topic::CAMERAS_KEY).map_or_else(Vec::new, |text| from_text(&text)),
            record: RecordDescription::default(),
        }
    }

    /// A frame as it is drawn: pairs are computed anew.
    #[cfg(feature = "render")]
    #[must_use]
    pub fn moment(&self, frame: &ReplayFrame) -> crate::painting::Moment {
        let id = self.ids();
        let is_sensor =
            |name| self.bodies.get(name).is_some_and(|body| as_of(body, frame.at).1.sensor);
        let pairs = frame.pairs.iter().filter_map(|pair| {
            let (a, b) = (id(&pair.a)?, id(&pair.b)?);
            let answer = self.compute(pair, frame.at)?.ok()?;
            let met = !answer.regions.is_empty();
            met.then_some(crate::painting::MeetingPair {
                a,
                b,
                answer,
                impulse: 0.0,
                sensed: [&pair.a, &pair.b].into_iter().any(is_sensor),
            })
        });
        let pairs = pairs.collect();
        crate::painting::Moment { time: frame.time, poses: self.poses(frame), pairs }
    }

    /// Gives the painter the shapes that bodies have in a frame.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be drawn.
    #[cfg(feature = "render")]
    pub fn dress(
        &self,
        painter: &mut crate::painting::ScenePainter,
        frame: &ReplayFrame,
    ) -> Result<(), crate::error::SceneAppError> {
        let changing = |name: &&String| self.bodies[*name].len() > 1;
        for (id, name) in (0..).map(cranny_world::BodyId).zip(self.in_order()) {
            if changing(&name) {
                painter.put_described(id, &self.described(name, frame))?;
            }
        }
        Ok(())
    }

    /// Where bodies are in a frame, by the numbers that pictures have for them.
    #[cfg(feature = "render")]
    #[must_use]
    pub fn poses(&self, frame: &ReplayFrame) -> BTreeMap<cranny_world::BodyId, Pose> {
        let id = self.ids();
        frame.poses.iter().filter_map(|(name, pose)| Some((id(name)?, *pose))).collect()
    }

    /// The number of a body, by its name: its place among all.
    #[cfg(feature = "render")]
    fn ids(&self) -> impl Fn(&String) -> Option<cranny_world::BodyId> {
        let names = (0..).map(cranny_world::BodyId).zip(self.in_order());
        let ids: BTreeMap<&String, _> = names.map(|(id, name)| (name, id)).collect();
        move |name| ids.get(name).copied()
    }

    /// Names by the numbers that bodies had in the run, so that pictures choose the same colors; in
    /// their own order where the recording does not say.
    fn in_order(&self) -> Vec<&String> {
        let mut names: Vec<&String> = self.bodies.keys().collect();
        names.sort_by_key(|&name| self.bodies[name][0].1.number.unwrap_or(u32::MAX));
        names
    }

    fn described(&self, name: &str, frame: &ReplayFrame) -> BodyDescription {
        let (_, drawn) = as_of(&self.bodies[name], frame.at);
        let kind = match drawn.kind.as_deref() {
            Some("fixed") => BodyKind::Fixed,
            Some("kinematic") => BodyKind::Kinematic,
            _ => BodyKind::Dynamic,
        };
        // A shape that cannot be prepared is drawn all the same: comparing says why.
        let shape = self.shape(name, frame.at).ok().flatten();
        let model = shape.as_ref().and_then(BodyShape::model);
        let collision = match model {
            Some(model) if *model.mesh() != *drawn.mesh => Arc::new(model.mesh().clone()),
            _ => drawn.mesh.clone(),
        };
        BodyDescription {
            name: drawn.name.clone(),
            collision,
            shape,
            visual: Some(drawn.mesh.clone()),
            color: drawn.stated_color,
            kind,
            pose: frame.poses.get(name).copied().unwrap_or(Pose::IDENTITY),
            linear_velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            path: None,
            tracker: None,
            material: Material::default(),
            mass: None,
            normals: Normals::default(),
            sensor: drawn.sensor,
            layers: Vec::new(),
            effects: Vec::new(),
        }
    }
}
