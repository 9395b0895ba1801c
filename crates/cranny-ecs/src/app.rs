//! A scene that runs, for programs that know nothing of bevy.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use bevy_app::App;
use bevy_ecs::message::message_update_system;
use bevy_ecs::prelude::*;
use cranny_world::description::{Accuracy, BodyKind, SceneDescription};

use crate::clock::{CrannyEnd, CrannyStep, SimulatedTime};
use crate::effects::EffectKind;
use crate::error::{Failure, SceneAppError};
use crate::levels::in_words;
use crate::outputs::check_outputs;
use crate::plan::Plan;
use crate::plugins::{CrannyPlugins, PluginOptions};
use crate::report::{RunFacts, scene_hash, summarize};
use crate::summary::{RunSummary, Skipped};
use crate::trigger::TriggerLog;

/// How a scene is run.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// What plugins are built with.
    pub plugins: PluginOptions,
    /// Seconds a step, in place of the scene's.
    pub step: Option<f64>,
    /// Seconds to simulate, in place of the scene's.
    pub duration: Option<f64>,
    /// One level for all triggers and distances, in place of those that the scene states.
    pub accuracy: Option<Accuracy>,
    /// Elementary tests a step, in place of the scene's budget; `Some(None)`: as many as they need.
    pub budget: Option<Option<u64>>,
    /// The scene's text, where it came from one: part of the hash, attached to recordings.
    pub source: Option<String>,
    /// Files that the scene was read from: no output may replace them.
    pub inputs: Vec<PathBuf>,
    /// Recording to write. Its folder must exist.
    #[cfg(feature = "record")]
    pub record: Option<PathBuf>,
    /// Pictures to draw.
    #[cfg(feature = "render")]
    pub pictures: crate::rendering::PictureOptions,
}

/// A scene with everything that it names, stepped by hand.
///
/// No clock drives it: each [`step`](Self::step) advances by the scene's step, as fast as it can.
///
/// ```
/// use std::sync::Arc;
/// use cranny_ecs::{RunOptions, SceneApp};
/// use cranny_exact::{DVec3, Pose};
/// use cranny_world::description::*;
///
/// let body = |name: &str, kind, x, velocity| BodyDescription {
///     name: name.into(),
///     collision: Arc::new(cranny_shapes::Cuboid { size: [1.0, 1.0, 1.0] }.build().unwrap()),
///     shape: None,
///     visual: None,
///     color: None,
///     kind,
///     pose: Pose::at(DVec3::new(x, 0.0, 0.0)),
///     linear_velocity: DVec3::new(velocity, 0.0, 0.0),
///     angular_velocity: DVec3::ZERO,
///     path: None,
///     tracker: None,
///     material: Material::default(),
///     mass: None,
///     normals: Normals::default(),
///     sensor: false,
///     layers: vec!["all".into()],
///     effects: vec![],
/// };
/// let scene = SceneDescription {
///     name: "gate".into(),
///     gravity: DVec3::ZERO,
///     step: 0.25,
///     most_parts: None,
///     duration: 2.5,
///     seed: 0,
///     bodies: vec![
///         body("gate", BodyKind::Fixed, 0.0, 0.0),
///         body("guest", BodyKind::Kinematic, -3.0, 1.0),
///     ],
///     joints: vec![],
///     excluded_pairs: vec![],
///     effects: vec![Effect::Contacts { margin: 0.1 }],
///     accuracy: Accuracy::Exact,
///     budget: None,
///     pairs: vec![],
///     cameras: vec![],
///     record: RecordDescription::default(),
/// };
/// let mut app = SceneApp::new(&scene, &RunOptions::default())?;
/// while app.step()? {}
/// let summary = app.finish()?;
/// assert_eq!((summary.steps, summary.simulated_s), (10, 2.5));
/// assert!((summary.deepest.unwrap().depth - 0.5).abs() < 1e-8); // half in the gate, at the end
/// # Ok::<(), cranny_ecs::SceneAppError>(())
/// ```
pub struct SceneApp {
    app: App,
    total: u64,
    wall: Duration,
    facts: RunFacts,
}

impl SceneApp {
    /// Builds the scene's app. Everything that can be known to fail, fails here: outputs that
    /// cannot be written among them. Where no graphics adapter is found the scene runs without
    /// pictures, and [`RunSummary::skipped`] says so.
    ///
    /// # Errors
    ///
    /// [`SceneAppError`].
    pub fn new(scene: &SceneDescription, options: &RunOptions) -> Result<Self, SceneAppError> {
        let mut scene = scene.clone();
        scene.step = options.step.unwrap_or(scene.step);
        scene.duration = options.duration.unwrap_or(scene.duration);
        scene.budget = options.budget.unwrap_or(scene.budget);
        if let Some(level) = options.accuracy {
            scene.set_accuracy(level);
        }
        let total = step_count(scene.step, scene.duration)?;
        let inputs: Vec<&Path> = options.inputs.iter().map(PathBuf::as_path).collect();
        check_outputs(&outputs(options), &inputs)?;
        let plugins = CrannyPlugins::from_scene(&scene, &options.plugins)?;
        let plugins = plugins.summed_up().keep_failures();
        #[cfg_attr(
            not(any(feature = "record", feature = "render")),
            expect(unused_mut, reason = "recordings and pictures add what they write")
        )]
        let mut facts = RunFacts {
            scene: scene.name.clone(),
            scene_hash: scene_hash(&scene, options.source.as_deref()),
            detector: detector_name(options),
            accuracy: in_words(&scene.levels()),
            budget: scene.budget,
            threads: u32::try_from(options.plugins.thread_count().get()).unwrap_or(u32::MAX),
            seed: scene.seed,
            skipped: what_is_skipped(&scene, &plugins, options),
            outputs: Vec::new(),
            interrupted: false,
        };
        #[cfg(feature = "render")]
        let plugins = add_pictures(plugins, &scene, total, options, &mut facts)?;
        #[cfg(feature = "record")]
        let plugins = add_recording(plugins, &scene, options, &mut facts)?;
        let mut app = App::empty();
        app.add_plugins(plugins);
        app.init_resource::<TriggerLog>();
        app.finish();
        app.cleanup();
        let mut scene_app = Self { app, total, wall: Duration::ZERO, facts };
        scene_app.check()?;
        Ok(scene_app)
    }

    /// Makes one step. Returns whether steps are left; without any, or after
    /// [`interrupt`](Self::interrupt), nothing happens and the answer is `false`.
    ///
    /// # Errors
    ///
    /// Whatever went wrong in the step; the run cannot go on then. A recording stays behind as a
    /// partial file.
    pub fn step(&mut self) -> Result<bool, SceneAppError> {
        if self.facts.interrupted || self.steps_done() >= self.total {
            return Ok(false);
        }
        self.run(CrannyStep)?;
        Ok(self.steps_done() < self.total)
    }

    fn run(
        &mut self,
        schedule: impl bevy_ecs::schedule::ScheduleLabel,
    ) -> Result<(), SceneAppError> {
        let start = Instant::now();
        let world = self.app.world_mut();
        // Messages live for two steps, as they do for two frames in an app with a main schedule.
        // It cannot fail: the system takes nothing that could be missing.
        let _ = world.run_system_cached(message_update_system);
        world.run_schedule(schedule);
        // So do removals, which are kept for `RemovedComponents` until somebody clears them.
        world.clear_trackers();
        self.wall += start.elapsed();
        self.check()
    }

    fn check(&mut self) -> Result<(), SceneAppError> {
        let failure = self.app.world_mut().get_resource_mut::<Failure>();
        failure.and_then(|mut failure| failure.take()).map_or(Ok(()), Err)
    }

    /// Steps made so far.
    #[must_use]
    pub fn steps_done(&self) -> u64 {
        self.app.world().get_resource::<SimulatedTime>().map_or(0, SimulatedTime::steps)
    }

    /// Steps that the run has in all.
    #[must_use]
    pub fn steps_total(&self) -> u64 {
        self.total
    }

    /// Breaks the run off: no step is made any more, and the summary says so.
    pub fn interrupt(&mut self) {
        self.facts.interrupted = true;
    }

    /// Reports, records and draws the final state, completes the outputs and sums up.
    ///
    /// # Errors
    ///
    /// Where an output cannot be completed.
    pub fn finish(mut self) -> Result<RunSummary, SceneAppError> {
        self.run(CrannyEnd)?;
        let start = Instant::now();
        let world = self.app.world_mut();
        // A picture that fails must not cost the recording, so both are completed before either
        // fails.
        #[cfg(feature = "record")]
        let recorded = finish_recording(world, &self.facts);
        #[cfg(feature = "render")]
        if let Some(mut painter) = world.get_resource_mut::<crate::rendering::Painter>() {
            let start = Instant::now();
            painter.finish()?;
            let spent = 1e3 * start.elapsed().as_secs_f64();
            world.resource_mut::<crate::clock::PhaseTimes>().render += spent;
        }
        #[cfg(feature = "record")]
        recorded?;
        self.wall += start.elapsed();
        Ok(summarize(world, self.facts, self.wall))
    }

    /// The app, to look inside.
    pub fn app(&self) -> &App {
        &self.app
    }

    /// The app, to add systems or to change what is inside.
    pub fn app_mut(&mut self) -> &mut App {
        &mut self.app
    }

    /// What runs, in which order, for which pairs; nothing runs for that.
    ///
    /// # Errors
    ///
    /// As [`Plan::of`].
    pub fn plan(&mut self) -> Result<Plan, String> {
        Plan::of(self.app.world_mut())
    }
}

/// Seconds that a step may last. Shorter ones vanish in the solver's `f32` (and recordings count
/// nanoseconds); longer ones leave the range in which it can move anything.
const STEPS: std::ops::RangeInclusive<f64> = 1e-9..=1e6;

/// A duration that is longer than a number of steps by less than this share of one means that
/// number: 5 s are 1200 steps of 0.0041667 s.
const STEP_SHARE: f64 = 1e-3;

/// Every single file that a run writes.
fn outputs(options: &RunOptions) -> Vec<&Path> {
    #[cfg_attr(
        not(any(feature = "record", feature = "render")),
        expect(unused_mut, reason = "recordings and pictures add what they write")
    )]
    let mut outputs: Vec<&Path> = Vec::new();
    #[cfg(feature = "record")]
    outputs.extend(options.record.as_deref());
    #[cfg(feature = "render")]
    outputs.extend(options.pictures.preview.as_deref());
    let _ = options;
    outputs
}

/// Whether a run can make the steps of a scene, as it begins.
///
/// # Errors
///
/// [`SceneAppError::Duration`].
pub fn check_duration(scene: &SceneDescription) -> Result<(), SceneAppError> {
    step_count(scene.step, scene.duration).map(|_| ())
}

/// Steps of a run: as many as fit, where a step that is short by rounding counts.
fn step_count(step: f64, duration: f64) -> Result<u64, SceneAppError> {
    let refused = |why| Err(SceneAppError::Duration { step, duration, why });
    if !(step > 0.0 && step.is_finite()) {
        return refused("a step must last a finite time above 0");
    }
    if !STEPS.contains(&step) {
        return refused(
            "a step must last between 1e-9 and 1e6 s: solvers compute in single precision",
        );
    }
    if !(duration >= 0.0 && duration.is_finite()) {
        return refused("the duration must be finite and at least 0");
    }
    let count = (duration / step - STEP_SHARE).ceil().max(0.0);
    if count > f64::from(u32::MAX) {
        return refused("it has more than 4 billion steps");
    }
    Ok(count as u64)
}

fn detector_name(options: &RunOptions) -> String {
    #[cfg(feature = "rapier")]
    return options.plugins.detector.to_string();
    #[cfg(not(feature = "rapier"))]
    {
        let _ = options;
        "cranny".to_owned()
    }
}

fn what_is_skipped(
    scene: &SceneDescription,
    plugins: &CrannyPlugins,
    options: &RunOptions,
) -> Vec<Skipped> {
    let mut skipped = Vec::new();
    let mut skip = |what: String, why: &str| skipped.push(Skipped { what, why: why.to_owned() });
    let responds = plugins.has(EffectKind::Response);
    let dynamic = scene.bodies.iter().filter(|body| body.kind == BodyKind::Dynamic).count();
    if !responds && dynamic > 0 {
        skip(format!("motion of {dynamic} dynamic bodies"), "the scene asks for no Response");
    }
    if !responds && !scene.joints.is_empty() {
        let joints = scene.joints.len();
        let plural = if joints == 1 { "" } else { "s" };
        skip(format!("{joints} joint{plural}"), "the scene asks for no Response");
    }
    #[cfg(feature = "rapier")]
    if !responds && options.plugins.detector != cranny_rapier::Detector::Cranny {
        skip(
            format!("detector {}", options.plugins.detector),
            "it detects for the solver, and the scene asks for no Response",
        );
    }
    let _ = options;
    skipped
}

#[cfg(feature = "render")]
fn add_pictures(
    plugins: CrannyPlugins,
    scene: &SceneDescription,
    total: u64,
    options: &RunOptions,
    facts: &mut RunFacts,
) -> Result<CrannyPlugins, SceneAppError> {
    use cranny_render::{RenderError, Renderer, RendererOptions};
    let wanted = &options.pictures;
    if !wanted.any() {
        return Ok(plugins);
    }
    if let Some(folder) = &wanted.frames {
        crate::outputs::prepare_folder(folder)?;
    }
    if let Some(path) = &wanted.preview {
        crate::outputs::probe_file(path)?;
    }
    match Renderer::new(&RendererOptions::default()) {
        Ok(renderer) => {
            let paths = [&wanted.frames, &wanted.preview].into_iter().flatten();
            facts.outputs.extend(paths.map(|path: &PathBuf| path.display().to_string()));
            plugins.with_pictures(scene, total, renderer, wanted.clone())
        }
        Err(error @ (RenderError::NoAdapter { .. } | RenderError::Device { .. })) => {
            let (what, why) = ("pictures".to_owned(), error.to_string());
            facts.skipped.push(Skipped { what, why });
            Ok(plugins)
        }
        Err(error) => Err(SceneAppError::Picture {
            camera: crate::painting::DEFAULT_CAMERA.to_owned(),
            why: error.to_string(),
        }),
    }
}

#[cfg(feature = "record")]
fn add_recording(
    plugins: CrannyPlugins,
    scene: &SceneDescription,
    options: &RunOptions,
    facts: &mut RunFacts,
) -> Result<CrannyPlugins, SceneAppError> {
    use cranny_record::{RecordedAttachment, Recorder, RecordingInfo, topic};
    let Some(path) = &options.record else { return Ok(plugins) };
    crate::outputs::probe_file(path)?;
    let attachments = options.source.iter().map(|text| RecordedAttachment {
        name: topic::SCENE.to_owned(),
        media_type: "text/plain".to_owned(),
        data: text.clone().into_bytes(),
    });
    let budget = facts.budget.map(|budget| (topic::BUDGET_KEY, budget.to_string()));
    let cameras = crate::camera_lines::to_text(&scene.cameras);
    let cameras = (!cameras.is_empty()).then_some((topic::CAMERAS_KEY, cameras));
    let further = [(topic::EFFECTS_KEY, effect_names(scene))].into_iter();
    let further = further.chain(budget).chain(cameras);
    let further = further.map(|(key, value)| (key.to_owned(), value));
    let info = RecordingInfo {
        scene: facts.scene.clone(),
        scene_hash: facts.scene_hash.clone(),
        detector: facts.detector.clone(),
        accuracy: facts.accuracy.clone(),
        seed: facts.seed,
        attachments: attachments.collect(),
        further: further.collect(),
        ..RecordingInfo::new(scene.step)
    };
    let recorder = Recorder::create(path, &info)?;
    facts.outputs.push(path.display().to_string());
    Ok(plugins.with_recording(recorder, scene.record.every))
}

/// Effects that a scene names, anywhere, each once.
#[cfg(feature = "record")]
fn effect_names(scene: &SceneDescription) -> String {
    let kinds: std::collections::BTreeSet<_> =
        scene.all_effects().filter_map(EffectKind::of).collect();
    kinds.into_iter().map(EffectKind::name).collect::<Vec<_>>().join(", ")
}

#[cfg(feature = "record")]
fn finish_recording(world: &mut World, facts: &RunFacts) -> Result<(), SceneAppError> {
    let Some(mut recorder) = world.get_resource_mut::<crate::recording::FrameRecorder>() else {
        return Ok(());
    };
    for skipped in &facts.skipped {
        let text = format!("skipped: {}: {}", skipped.what, skipped.why);
        recorder.log(cranny_record::LogLevel::Warning, &text)?;
    }
    let why = facts.interrupted.then_some("interrupted");
    recorder.finish(why).transpose()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_counted_as_meant() {
        assert_eq!(step_count(0.0041667, 5.0).unwrap(), 1200);
        assert_eq!(step_count(1.0 / 240.0, 5.0).unwrap(), 1200);
        assert_eq!(step_count(0.1, 0.3).unwrap(), 3);
        assert_eq!(step_count(0.1, 0.25).unwrap(), 3);
        assert_eq!(step_count(0.1, 0.0).unwrap(), 0);
        let refused =
            [(0.0, 1.0), (f64::NAN, 1.0), (0.1, -1.0), (1e-9, 1e9), (1e-300, 0.0), (1e30, 1e31)];
        for (step, duration) in refused {
            assert!(step_count(step, duration).is_err());
        }
    }
}
