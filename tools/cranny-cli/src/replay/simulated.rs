//! `cranny replay --scene`: the scene simulated again as far as the recording goes, and what came
//! of each body compared to the bit.
//!
//! The second run records too, into a folder of its own, so that both are read in one way. What a
//! run depends on comes from the recording: step, seed, detector and budget.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::Ordering;

use cranny_ecs::{
    ContactFields, PluginOptions, Replay, ReplayFrame, RunOptions, SceneApp, helices, rings,
};
use cranny_exact::Pose;
use cranny_rapier::Detector;
use cranny_record::{DrawnBody, Recording, topic};
use cranny_scene::LoadedScene;

use crate::args::SetArgs;
use crate::failure::Failure;
use crate::overlaps;
use crate::progress::RunProgress;
use crate::run::{failure, stop_flag};
use crate::scene_file::load;

/// What another run made of the recorded frames.
pub(super) struct SimulatedAgain {
    /// Poses that came out the same, to the bit.
    pub(super) same: u64,
    /// Poses that did not.
    pub(super) different: u64,
    /// Of each body that differs, where it does first, by time.
    pub(super) first: Vec<Differing>,
}

/// A body that differs.
pub(super) struct Differing {
    /// Seconds simulated.
    pub(super) time: f64,
    pub(super) body: String,
    pub(super) how: String,
}

/// Simulates a scene again, and compares it with frames of a recording.
///
/// # Errors
///
/// A scene that cannot be read, or is not the one that was recorded; a run that fails.
pub(super) fn simulate(
    replay: &Replay,
    frames: &[&ReplayFrame],
    path: &Path,
    set: &SetArgs,
) -> Result<SimulatedAgain, Failure> {
    let recorded = replay.recording();
    let settings = RecordedSettings::of(recorded)?;
    let mut scene = load(path, &set.load_options(Some(settings.seed)))?;
    check_same(recorded, &scene, path)?;
    overlaps::prepare(&mut scene.description);
    scene.description.record.every = 1;
    let folder = tempfile::tempdir()
        .map_err(|e| Failure::run(format!("no folder for the second recording: {e}")))?;
    let again = folder.path().join("again.mcap");
    let last = frames.last().map_or(0.0, |frame| frame.time);
    let options = RunOptions {
        plugins: PluginOptions {
            detector: settings.detector,
            helices: helices(&scene),
            rings: rings(&scene),
            contact_fields: ContactFields::NONE,
            ..PluginOptions::default()
        },
        step: Some(settings.step),
        duration: Some((last / settings.step).round() * settings.step),
        budget: Some(settings.budget),
        record: Some(again.clone()),
        source: Some(scene.source_text.clone()),
        ..RunOptions::default()
    };
    let stop = stop_flag();
    let mut app = SceneApp::new(&scene.description, &options).map_err(failure)?;
    let progress = RunProgress::new(app.steps_total(), settings.step);
    while app.step().map_err(failure)? {
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::run("interrupted before the end: nothing was compared"));
        }
        progress.set(app.steps_done());
    }
    app.finish().map_err(failure)?;
    progress.clear();
    let again = Recording::open(&again).map_err(Failure::run)?;
    settings.check_levels(&again, path)?;
    compared(recorded, &again, frames)
}

/// What a run depends on beside its scene.
struct RecordedSettings {
    step: f64,
    seed: u64,
    detector: Detector,
    budget: Option<u64>,
    /// Levels of triggers and distances, in words.
    accuracy: String,
}

impl RecordedSettings {
    fn of(recording: &Recording) -> Result<Self, Failure> {
        let metadata = recording.metadata(topic::METADATA);
        let entry = |key: &str| metadata.and_then(|all| all.get(key)).map(String::as_str);
        let unsaid = |key: &str| {
            Failure::input(format!(
                "recording '{}' does not say with which `{key}` it was made, or names one that is \
                 not known: its scene cannot be simulated again",
                recording.path().display()
            ))
        };
        let bits = entry("dt_bits").and_then(|bits| u64::from_str_radix(bits, 16).ok());
        let parsed = |key: &str| entry(key).and_then(|text| text.parse::<u64>().ok());
        Ok(Self {
            step: bits.map(f64::from_bits).ok_or_else(|| unsaid("dt_bits"))?,
            seed: parsed("seed").ok_or_else(|| unsaid("seed"))?,
            detector: entry("detector")
                .and_then(|name| name.parse().ok())
                .ok_or_else(|| unsaid("detector"))?,
            budget: parsed(topic::BUDGET_KEY),
            accuracy: entry("accuracy").unwrap_or("exact").to_owned(),
        })
    }

    /// Levels that were given by a flag are not those of the scene.
    fn check_levels(&self, again: &Recording, path: &Path) -> Result<(), Failure> {
        let metadata = again.metadata(topic::METADATA);
        let now = metadata.and_then(|all| all.get("accuracy")).map_or("exact", String::as_str);
        match now == self.accuracy {
            true => Ok(()),
            false => Err(Failure::input(format!(
                "--scene {}: it knows triggers and distances at {now}, the recording at {}. \
                 A run with --accuracy is simulated again with --set accuracy=…",
                path.display(),
                self.accuracy
            ))),
        }
    }
}

/// Fails if the scene's text is not the one that is attached.
fn check_same(recording: &Recording, scene: &LoadedScene, path: &Path) -> Result<(), Failure> {
    let mut attached = recording.attachments().iter();
    match attached.find(|attached| attached.name == topic::SCENE) {
        Some(attached) if attached.data != scene.source_text.as_bytes() => {
            Err(Failure::input(format!(
                "--scene {}: its text is not the one that was recorded, which is attached to the \
                 recording as {}. Name the scene as it was then, with the same --set.",
                path.display(),
                topic::SCENE
            )))
        }
        _ => Ok(()),
    }
}

/// What a body is in the course of a recording: its shapes and its poses, by log time.
#[derive(Default)]
struct Course {
    shapes: BTreeMap<u64, DrawnBody>,
    poses: BTreeMap<u64, Pose>,
}

fn courses(recording: &Recording) -> Result<BTreeMap<String, Course>, Failure> {
    let mut courses = BTreeMap::<String, Course>::new();
    for (at, changes) in recording.body_changes().map_err(Failure::input)? {
        for body in changes.came {
            courses.entry(body.name.clone()).or_default().shapes.insert(at, body);
        }
    }
    for (at, poses) in recording.transforms().map_err(Failure::input)? {
        for (name, pose) in poses {
            courses.entry(name).or_default().poses.insert(at, pose);
        }
    }
    Ok(courses)
}

fn compared(
    recorded: &Recording,
    again: &Recording,
    frames: &[&ReplayFrame],
) -> Result<SimulatedAgain, Failure> {
    let (recorded, again) = (courses(recorded)?, courses(again)?);
    let none = Course::default();
    let mut found = SimulatedAgain { same: 0, different: 0, first: Vec::new() };
    for (body, was) in &recorded {
        let is = again.get(body).unwrap_or(&none);
        let mut shapes = Shapes { was, is, latest: None };
        let mut first = None;
        for ReplayFrame { time, at, .. } in frames {
            let Some(pose) = was.poses.get(at) else { continue };
            let how = match is.poses.get(at) {
                None => "is not there".to_owned(),
                Some(_) if !shapes.are_same(*at) => "has another shape".to_owned(),
                Some(now) if now.bits() == pose.bits() => {
                    found.same += 1;
                    continue;
                }
                Some(now) => {
                    let off = (now.translation - pose.translation).length();
                    format!("is at {}, {off:e} from where it was", now.translation)
                }
            };
            found.different += 1;
            first.get_or_insert(Differing { time: *time, body: body.clone(), how });
        }
        found.first.extend(first);
    }
    found.first.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(found)
}

/// The shapes of a body in both recordings. Those of the latest moment are compared once.
struct Shapes<'a> {
    was: &'a Course,
    is: &'a Course,
    /// Since when the two are, and whether they are the same to the bit.
    latest: Option<([Option<u64>; 2], bool)>,
}

impl Shapes<'_> {
    fn are_same(&mut self, at: u64) -> bool {
        let shapes = [self.was, self.is].map(|course| course.shapes.range(..=at).next_back());
        let since = shapes.map(|shape| shape.map(|(since, _)| *since));
        if let Some((_, same)) = self.latest.filter(|(latest, _)| *latest == since) {
            return same;
        }
        let of = |body: &DrawnBody| (body.model.clone(), body.primitive.clone(), body.mesh.clone());
        let [was, is] = shapes.map(|shape| shape.map(|(_, body)| of(body)));
        self.latest = Some((since, was == is));
        was == is
    }
}
