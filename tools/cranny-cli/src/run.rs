//! `cranny run`: simulates a scene, records and draws it, and sums up.

use std::fmt::Write;
use std::path::Path;

use cranny_ecs::{
    CAMERA_PRESETS, DEFAULT_CAMERA, DeepestSummary, EstimateSummary, JointSummary, LeftSummary,
    PairsFound, PartsSummary, PictureOptions, PluginOptions, RunOptions, RunSummary, SceneAppError,
    TrackedContacts, TrackingSummary, TriggerSummary, check_outputs,
};
use cranny_rapier::Detector;
use cranny_world::description::SceneDescription;
use serde::Serialize;

use crate::args::{DetectorArg, EffortArgs, Format, RunArgs, StepBudget};
use crate::failure::Failure;
use crate::output::Output;
use crate::overlaps::{self, StartOverlap};
use crate::paths::check_output;
use crate::rerun;
use crate::scene_file::load;
use crate::simulation::{failure, plugins, simulate};
use crate::words::counted;

/// Things of a kind that the text summary lists; the JSON lists all.
const LISTED: usize = 8;

/// A joint that is farther off at the end, while its motor was at its greatest effort, is named.
/// Smaller: motors that reach it on their way are; larger: arms that sag are not.
const OFF: f64 = 1e-3;

/// The summary for programs.
#[derive(Serialize)]
struct RunLine<'a> {
    #[serde(flatten)]
    summary: &'a RunSummary,
    /// Bodies that overlap where the scene begins, the deepest first.
    overlaps_at_start: Vec<StartOverlap>,
}

/// Runs the command.
///
/// # Errors
///
/// Wrong arguments or a wrong scene; a step, a recording or a picture that failed.
pub(crate) fn run(args: &RunArgs, format: Option<Format>) -> Result<(), Failure> {
    if let Some(path) = &args.rerun {
        rerun::check_file(path)?;
    }
    let mut scene = load(&args.scene, &args.instead.load_options())?;
    overlaps::prepare(&mut scene.description);
    let overlaps_at_start = overlaps::at_start(&scene.description);
    for overlap in overlaps::sentences(&overlaps_at_start) {
        tracing::warn!(scene = %args.scene.display(), "{overlap}");
    }
    check_camera(args, &scene.description)?;
    let names_cameras = !scene.description.cameras.is_empty() || args.pictures.camera.is_some();
    let pictured = args.frames.is_some() || args.preview.is_some() || names_cameras;
    let recording = rerun::recording_of_run(args.record.as_deref(), args.rerun.as_deref());
    let options = RunOptions {
        // It prints the summary, and nothing of a single contact.
        plugins: PluginOptions {
            threads: Some(args.threads),
            ..plugins(&scene, detector(args.detector))
        },
        step: args.instead.dt,
        duration: args.instead.duration,
        accuracy: args.effort.accuracy,
        budget: args.effort.budget.map(|budget| budget.0),
        record: recording.clone(),
        pictures: PictureOptions {
            frames: args.frames.clone(),
            preview: args.preview.clone(),
            record: args.record.is_some() && pictured,
            size: args.pictures.size,
            camera: args.pictures.camera.clone(),
            quality: args.pictures.quality.into(),
        },
        inputs: std::iter::once(scene.path).chain(scene.files).collect(),
        source: Some(scene.source_text),
    };
    let outputs = [&recording, &args.rerun, &args.preview, &args.frames];
    let outputs: Vec<&Path> = outputs.into_iter().flatten().map(|p| &**p).collect();
    let inputs: Vec<&Path> = options.inputs.iter().map(|p| &**p).collect();
    check_outputs(&outputs, &inputs).map_err(failure)?;
    if let Some(path) = &args.record {
        check_output("--record", path, &["mcap"])?;
    }
    if let Some(path) = args.frames.as_ref().filter(|path| path.is_file()) {
        return Err(Failure::run(format!(
            "--frames {}: it is a file. Name a folder for the pictures, which need not exist.",
            path.display()
        )));
    }
    if let Some(path) = &args.preview {
        check_output("--preview", path, &["png", "apng"])?;
    }
    let refused = |error| of_flags(&args.effort, error);
    let (mut summary, progress) = simulate(&scene.description, &options, refused)?;
    let converted = match (&recording, &args.rerun) {
        (Some(recording), Some(out)) => {
            convert(recording, args.record.is_some(), out, &mut summary.outputs)
        }
        _ => Ok(()),
    };
    progress.clear();
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&RunLine { summary: &summary, overlaps_at_start }),
        Format::Text => output.line(&text(&summary)),
    }?;
    converted
}

/// Makes the recording into a file of Rerun's, and names it among what was written.
fn convert(
    recording: &Path,
    is_wanted: bool,
    out: &Path,
    outputs: &mut Vec<String>,
) -> Result<(), Failure> {
    rerun::finish_run(recording, is_wanted, out)?;
    let recorded = recording.display().to_string();
    outputs.retain(|output| is_wanted || *output != recorded);
    outputs.push(out.display().to_string());
    Ok(())
}

/// Fails if `--camera` names none, or chooses one of pictures that nobody wants.
fn check_camera(args: &RunArgs, scene: &SceneDescription) -> Result<(), Failure> {
    let Some(name) = &args.pictures.camera else { return Ok(()) };
    if args.record.is_none() && args.frames.is_none() && args.preview.is_none() {
        return Err(Failure::input(format!(
            "--camera {name}: nothing is drawn. Add --frames, --preview or --record, or leave it out."
        )));
    }
    let of_scene: Vec<&str> = match &scene.cameras[..] {
        [] => vec![DEFAULT_CAMERA],
        cameras => cameras.iter().map(|camera| camera.name.as_str()).collect(),
    };
    let presets = CAMERA_PRESETS.iter().filter(|preset| !of_scene.contains(preset));
    let known: Vec<&str> = of_scene.iter().chain(presets).copied().collect();
    if known.contains(&name.as_str()) {
        return Ok(());
    }
    Err(Failure::input(format!(
        "--camera {name}: there is none of that name. Choose one of {}.",
        known.join(", ")
    )))
}

/// The detector that an argument names.
pub(crate) fn detector(argument: DetectorArg) -> Detector {
    match argument {
        DetectorArg::Cranny => Detector::Cranny,
        DetectorArg::RapierTrimesh => Detector::RapierTrimesh,
        DetectorArg::RapierTrimeshFixed => Detector::RapierTrimeshFixed,
        DetectorArg::RapierDecomposition => Detector::RapierDecomposition,
        DetectorArg::RapierBoxes => Detector::RapierBoxes,
        DetectorArg::RapierHulls => Detector::RapierHulls,
        DetectorArg::RapierTree => Detector::RapierTree,
    }
}

/// A level or a budget that changes nothing is that of a flag, where one is given.
pub(crate) fn of_flags(effort: &EffortArgs, mut error: SceneAppError) -> Failure {
    if let SceneAppError::NotAtLevel { what, .. } | SceneAppError::NoLevels { what } = &mut error {
        let is_of_pair = what.contains(" of ");
        match (effort.accuracy, effort.budget) {
            (Some(level), _) if what.starts_with("`accuracy: ") && !is_of_pair => {
                *what = format!("`--accuracy {level}`");
            }
            (_, Some(StepBudget(Some(tests)))) if what.starts_with("`budget: ") => {
                *what = format!("`--budget {tests}`");
            }
            _ => {}
        }
    }
    failure(error)
}

/// The summary for people.
fn text(summary: &RunSummary) -> String {
    let mut lines = Lines::default();
    let ending = if summary.interrupted { ", interrupted" } else { "" };
    lines.add("scene", format!("{} (seed {})", summary.scene, summary.seed));
    let accuracy = summary.accuracy.as_ref().map_or(String::new(), |level| format!(", {level}"));
    let budget = summary.budget.map_or(String::new(), |n| format!(", {n} tests a step"));
    lines.add("detector", format!("{}{accuracy}{budget}", summary.detector));
    lines.add(
        "simulated",
        format!(
            "{:.3} s in {} of {:.6} s{ending}",
            summary.simulated_s,
            counted(summary.steps, "step"),
            summary.dt
        ),
    );
    if let Some(parts) = &summary.parts {
        lines.add("- in parts", divided(parts));
    }
    lines.add(
        "wall time",
        format!("{:.3} s, {:.2} x real time", summary.wall_s, summary.real_time_factor),
    );
    let times = &summary.time_ms;
    let phases = [
        ("broad", times.broad),
        ("narrow", times.narrow),
        ("solver", times.solver),
        ("report", times.report),
        ("record", times.record),
        ("render", times.render),
    ];
    let spent = phases.iter().filter(|(_, ms)| *ms > 0.0);
    let spent: Vec<String> = spent.map(|(phase, ms)| format!("{phase} {ms:.1}")).collect();
    if !spent.is_empty() {
        lines.add("time, ms", spent.join(", "));
    }
    lines.add("pairs", format!("{:.1} a step, at most {}", summary.pairs.mean, summary.pairs.max));
    if let Some(PairsFound { carried, searched }) = &summary.pairs_found {
        let found = format!("{:.1} carried on a step, {:.1} searched", carried.mean, searched.mean);
        lines.add("- contacts", found);
    }
    if let Some(tests) = &summary.tests {
        lines.add("tests", format!("{:.1} a step, at most {}", tests.mean, tests.max));
    }
    if let Some(estimates) = &summary.estimates {
        lines.add("estimates", estimated(estimates));
    }
    let contacts = &summary.contacts;
    lines.add("contacts", format!("{:.1} a step, at most {}", contacts.mean, contacts.max));
    lines.add("deepest", deepest(summary));
    if let Some(first) = &summary.first_overlap {
        lines.add("- first", overlap(first));
    }
    for trigger in summary.triggers.iter().take(LISTED) {
        let TriggerSummary { a, b, times, open, step } = trigger;
        let times = if *times == 1 { "once".to_owned() } else { format!("{times} times") };
        let times = if *open == 0 { times } else { format!("{times} ({open} of them open)") };
        lines.add(
            "triggers",
            format!("{a} and {b} began to touch {times}, after {}", counted(*step, "step")),
        );
    }
    more(&mut lines, "triggers", "pairs", summary.triggers.len());
    summary.tracking.iter().take(LISTED).for_each(|tracked| add_tracking(&mut lines, tracked));
    more(&mut lines, "tracking", "bodies", summary.tracking.len());
    for LeftSummary { body, step } in summary.left.iter().take(LISTED) {
        lines.add("left", format!("{body} left the world after {}", counted(*step, "step")));
    }
    more(&mut lines, "left", "bodies", summary.left.len());
    if let Some(c) = &summary.contained {
        let value = format!(
            "a body wholly within another in {}, first {} and {} after {}",
            counted(c.steps, "step"),
            c.a,
            c.b,
            counted(c.step, "step")
        );
        lines.add("inside", value);
    }
    if let Some(total @ 1..) = summary.held_back {
        let value =
            format!("{} before what they would have passed through", counted(total, "time"));
        lines.add("held back", value);
    }
    let off = |joint: &JointSummary| joint.off_max;
    if let Some(worst) = summary.joints.iter().max_by(|a, b| off(a).total_cmp(&off(b))) {
        let value = format!(
            "{} held, at most {:.6} off ({}), {:.6} at the end",
            summary.joints.len(),
            worst.off_max,
            worst.joint,
            worst.off
        );
        lines.add("joints", value);
        let gave_way = |joint: &&JointSummary| joint.strained > 0 && joint.off > OFF;
        for joint in summary.joints.iter().filter(gave_way).take(LISTED) {
            let value = format!(
                "the motor of {} was at its greatest effort in {}: it cannot hold more (`motors` gives it a larger max_effort)",
                joint.joint,
                counted(joint.strained, "step")
            );
            lines.add("joints", value);
        }
    }
    if let (Some(drift), Some(energy)) = (summary.energy_drift, &summary.energy) {
        let end = if energy.loss < 0.0 { "above" } else { "below" };
        let value = format!(
            "at most {:.3} % above its start, {:.3} % {end} it at the end; 100 % is {:.6}, the greatest kinetic energy or change of potential energy",
            100.0 * drift,
            100.0 * energy.loss.abs(),
            energy.scale
        );
        lines.add("energy", value);
    }
    if let Some(why) = &summary.energy_unknown {
        lines.add("energy", format!("not known: {why}"));
    }
    for helix in &summary.helices {
        let value = format!(
            "{} on {}: {:.4} turns, advanced {:.4} (pitch {}), at most {:.4} off the helix",
            helix.nut, helix.bolt, helix.turns, helix.advance, helix.pitch, helix.deviation_max
        );
        lines.add("screw", value);
    }
    if let Some(links) = &summary.links {
        let kept = links.at_start - links.parted.len();
        let first = links.parted.iter().min_by_key(|parted| parted.step);
        let torn = first.map_or(String::new(), |p| {
            format!("; first parted: {} and {}, after {}", p.a, p.b, counted(p.step, "step"))
        });
        lines.add("links", format!("{kept} of {} kept{torn}", links.at_start));
    }
    for motion in summary.motion.iter().take(LISTED) {
        let [x, y, z] = motion.displacement;
        let turns = motion.turns.map_or(String::new(), |t| format!(", {t:.3} turns"));
        lines.add("motion", format!("{} by ({x:.4}, {y:.4}, {z:.4}){turns}", motion.body));
    }
    more(&mut lines, "motion", "bodies", summary.motion.len());
    lines.add("state", summary.state_hash.clone());
    summary.outputs.iter().for_each(|path| lines.add("written", path.clone()));
    for skipped in &summary.skipped {
        lines.add("skipped", format!("{}: {}", skipped.what, skipped.why));
    }
    lines.0
}

/// Pairs at a level or within a budget.
fn estimated(
    EstimateSummary { pairs, certain, open, unsettled, tests }: &EstimateSummary,
) -> String {
    format!(
        "{:.1} pairs a step: {certain:.2} certain, {:.2} open and counted as touching; {:.2} left by the budget; {:.1} tests, at most {}",
        pairs.mean, open.mean, unsettled.mean, tests.mean, tests.max
    )
}

/// Steps that were made in parts.
fn divided(&PartsSummary { most_parts, divided, max }: &PartsSummary) -> String {
    match (most_parts, divided) {
        (1, _) => "no step: most_parts is 1".to_owned(),
        (_, 0) => format!("no step; most_parts is {most_parts}"),
        _ => format!(
            "{}, at most {max} parts each; most_parts is {most_parts}",
            counted(divided, "step")
        ),
    }
}

fn deepest(summary: &RunSummary) -> String {
    match &summary.deepest {
        None => "not known: no exact answers (ask for Contacts in the scene)".to_owned(),
        Some(d) if d.depth > 0.0 => overlap(d),
        Some(_) => "no overlap".to_owned(),
    }
}

fn overlap(DeepestSummary { depth, a, b, step }: &DeepestSummary) -> String {
    format!("{depth:.6} between {a} and {b}, after {}", counted(*step, "step"))
}

/// How many of so many things are not listed.
fn more(lines: &mut Lines, heading: &'static str, what: &str, all: usize) {
    if all > LISTED {
        let more = all - LISTED;
        lines.add(heading, format!("and {more} more {what} (--format json lists all)"));
    }
}

/// What tracking made of a body's contacts.
fn add_tracking(lines: &mut Lines, tracked: &TrackingSummary) {
    let TrackingSummary { body, truth, poses, late, refused, missing, lost, .. } = tracked;
    let [truth, lost] = [counted(*truth, "contact"), counted(*lost, "time")];
    let poses = counted(*poses, "pose");
    lines.add(
        "tracking",
        format!("{body} truly makes {truth}; {poses} came, {late} of them too late and {refused} refused; {missing} did not; it was lost {lost}"),
    );
    for (poses, seen) in [("raw", &tracked.raw), ("filtered", &tracked.filtered)] {
        let TrackedContacts {
            contacts, spurious, repeated, cut_short, late, missed, merged, ..
        } = seen;
        let [begin, end] =
            [seen.latency_steps, seen.end_latency_steps].map(|steps| counted(steps, "step"));
        lines.add(
            "tracking",
            format!("{poses} poses make {contacts}: {spurious} spurious, {repeated} repeated, {cut_short} cut short, {late} after the true one, {missed} missed, {merged} merged; they begin up to {begin} late and end up to {end} late"),
        );
    }
    if tracked.uncompared > 0 {
        let others = counted(tracked.uncompared, "body");
        lines.add("tracking", format!("not compared: {others} that the solver moves"));
    }
}

/// Aligned lines; a repeated heading is left blank.
#[derive(Default)]
struct Lines(String, &'static str);

impl Lines {
    fn add(&mut self, heading: &'static str, value: String) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        let found = if heading == self.1 { "" } else { heading };
        self.1 = heading;
        // Writing to a string cannot fail.
        let _ = write!(self.0, "{found:<10} {value}");
    }
}
