//! `cranny replay --scene`: the scene simulated again as far as the recording goes, and what came
//! of it compared to the bit: poses, shapes and events.
//!
//! The second run records too, into a folder of its own, so that both are read in one way. What a
//! run depends on comes from the recording: step, seed, detector, levels and budget.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use cranny_ecs::{Replay, ReplayFrame, RunOptions};
use cranny_estimate::Accuracy;
use cranny_exact::Pose;
use cranny_rapier::Detector;
use cranny_record::{DrawnBody, EventMessage, Recording, topic};
use cranny_scene::LoadedScene;
use cranny_world::description::SceneDescription;

use crate::args::{SetArgs, level};
use crate::failure::Failure;
use crate::overlaps;
use crate::scene_file::load;
use crate::simulation::{failure, plugins};

/// What another run made of the recorded frames.
pub(super) struct SimulatedAgain {
    /// Bodies in frames whose pose and shape came out the same, to the bit.
    pub(super) same: u64,
    /// Those that did not.
    pub(super) different: u64,
    /// Events up to the last frame that are the same.
    pub(super) events: u64,
    /// The first event that is not, by its time, as words.
    pub(super) other_event: Option<(f64, String)>,
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
    let accuracy = settings.level_instead(&scene.description, path)?;
    scene.description.record.every = 1;
    let folder = tempfile::tempdir()
        .map_err(|e| Failure::run(format!("no folder for the second recording: {e}")))?;
    let again = folder.path().join("again.mcap");
    let last = frames.last().map_or(0.0, |frame| frame.time);
    let options = RunOptions {
        plugins: plugins(&scene, settings.detector),
        step: Some(settings.step),
        duration: Some((last / settings.step).round() * settings.step),
        accuracy,
        budget: Some(settings.budget),
        record: Some(again.clone()),
        source: Some(scene.source_text.clone()),
        ..RunOptions::default()
    };
    let (summary, progress) = crate::simulation::simulate(&scene.description, &options, failure)?;
    progress.clear();
    if summary.interrupted {
        return Err(Failure::run("interrupted before the end: nothing was compared"));
    }
    let again = Recording::open(&again).map_err(Failure::run)?;
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

    /// The level that a flag gave the run in place of those of its scene; `None` without one.
    fn level_instead(
        &self,
        scene: &SceneDescription,
        path: &Path,
    ) -> Result<Option<Accuracy>, Failure> {
        let words = |scene: &SceneDescription| {
            let levels: Vec<String> = scene.levels().iter().map(Accuracy::to_string).collect();
            levels.join(", ")
        };
        let own = words(scene);
        if own == self.accuracy {
            return Ok(None);
        }
        let known = self.accuracy.split(", ").filter_map(|text| level(text).ok());
        for level in known {
            let mut at_level = scene.clone();
            at_level.set_accuracy(level);
            if words(&at_level) == self.accuracy {
                return Ok(Some(level));
            }
        }
        Err(Failure::input(format!(
            "--scene {}: its triggers and distances are known at {own}, those of the recording at \
             {}, and no --accuracy makes these of them.",
            path.display(),
            self.accuracy
        )))
    }
}

/// Fails if the scene's text is not the one that is attached.
fn check_same(recording: &Recording, scene: &LoadedScene, path: &Path) -> Result<(), Failure> {
    let mut attached = recording.attachments().iter();
    match attached.find(|attached| attached.name == topic::SCENE) {
        Some(attached) if attached.data != scene.source_text.as_bytes() => {
            let metadata = recording.metadata(topic::METADATA);
            let name = metadata.and_then(|all| all.get("scene")).map_or("", String::as_str);
            Err(Failure::input(format!(
                "--scene {}: its text is not the one that was recorded, of '{name}', which is \
                 attached to the recording as {} ('cranny report' prints it). Name the scene as it \
                 was then, with the same --set.",
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
    let until = frames.last().map_or(0, |frame| frame.at);
    let [were, are] = [events(recorded, until)?, events(again, until)?];
    let same = were.iter().zip(&are).take_while(|(was, is)| was.1 == is.1).count();
    let words = |(at, event): &(f64, EventMessage)| {
        (*at, format!("{} and {}: {}", event.a, event.b, event.kind))
    };
    let other_event = were.get(same).or(are.get(same)).map(words);
    let mut found = SimulatedAgain {
        same: 0,
        different: 0,
        events: same as u64,
        other_event,
        first: Vec::new(),
    };
    let (recorded, again) = (courses(recorded)?, courses(again)?);
    let none = Course::default();
    let bodies: BTreeSet<&String> = recorded.keys().chain(again.keys()).collect();
    for body in bodies {
        let [was, is] = [&recorded, &again].map(|all| all.get(body).unwrap_or(&none));
        let mut shapes = Shapes { was, is, latest: None };
        let mut first = None;
        for ReplayFrame { time, at, .. } in frames {
            let how = match (was.poses.get(at), is.poses.get(at)) {
                (None, None) => continue,
                (Some(_), None) => "is not there".to_owned(),
                (None, Some(_)) => "was not there".to_owned(),
                (Some(_), Some(_)) if !shapes.are_same(*at) => "has another shape".to_owned(),
                (Some(before), Some(now)) if now.bits() == before.bits() => {
                    found.same += 1;
                    continue;
                }
                (Some(before), Some(now)) => {
                    let off = (now.translation - before.translation).length();
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

/// Events up to a log time, with the time of the frame that holds them. Frames may be farther apart
/// in one recording than in another; the order of events is the same.
fn events(recording: &Recording, until: u64) -> Result<Vec<(f64, EventMessage)>, Failure> {
    let frames = recording.events().map_err(Failure::input)?.into_iter();
    let frames = frames.filter(|(at, _)| *at <= until);
    let events = frames.flat_map(|(at, found)| {
        found.events.into_iter().map(move |event| (at as f64 / 1e9, event))
    });
    Ok(events.collect())
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
