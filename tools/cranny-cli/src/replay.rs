//! `cranny replay`: computes a recording anew, compares, and draws any moment of it.

mod simulated;

use std::path::Path;

use cranny_ecs::{
    PREVIEW_SIZE, Replay, ReplayError, ReplayFrame, ReplayReport, ScenePainter, ScenePainterView,
};
use cranny_record::topic;
use cranny_render::{Animation, Image, Renderer, RendererOptions, palette};
use serde_json::json;

use crate::args::{Format, ReplayArgs, ViewArg};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{check_output, check_recording};
use crate::rerun;
use crate::words::counted;
use simulated::SimulatedAgain;

/// Pairs, and bodies, that differ and that the text lists.
const DIFFERENCES_TOLD: usize = 8;

/// Width and height of pictures other than pages.
const PICTURE_SIZE: [u32; 2] = [1280, 720];

/// Runs the command.
///
/// # Errors
///
/// A recording that cannot be read, a picture that cannot be drawn or written, a pair that differs.
pub(crate) fn replay(args: &ReplayArgs, format: Option<Format>) -> Result<(), Failure> {
    check_recording(&args.recording)?;
    if args.rerun.is_some() || args.rerun_connect.is_some() {
        return rerun::replay(args, format);
    }
    if let Some(path) = &args.render {
        check_output("--render", path, &["png", "apng"])?;
    }
    if let (Some(name), None) = (&args.pictures.camera, &args.render) {
        return Err(Failure::input(format!(
            "--camera {name}: nothing is drawn. Add --render, or leave it out."
        )));
    }
    if !args.set.settings.is_empty() && args.scene.is_none() {
        return Err(Failure::input(
            "--set: nothing is simulated. Add --scene, or leave it out.".to_owned(),
        ));
    }
    let replay = Replay::open(&args.recording).map_err(failure)?;
    let frames = chosen(&replay, args)?;
    let report = replay.compare(frames.iter().copied());
    let simulated = match &args.scene {
        Some(scene) => Some(simulated::simulate(&replay, &frames, scene, &args.set)?),
        None => None,
    };
    if let Some(path) = &args.render {
        draw(&replay, &frames, args, path)?;
    }
    let found = Found { report, simulated };
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&as_json(&replay, &found, args)),
        Format::Text => output.line(&as_text(&replay, &found, args)),
    }?;
    match found.different() {
        Some(differs) => Err(Failure::run(Differs { what: differs, damage: damage(&replay) })),
        None if found.is_compared() || args.render.is_some() => Ok(()),
        None => Err(Failure::run(NothingCompared::of(&replay, &found.report))),
    }
}

/// What was compared.
struct Found {
    report: ReplayReport,
    /// Of the scene, where it was simulated again.
    simulated: Option<SimulatedAgain>,
}

impl Found {
    /// What differs, in words; `None` where nothing does.
    fn different(&self) -> Option<String> {
        let pairs = self.report.different.len() as u64;
        let again = self.simulated.as_ref();
        let poses = again.map_or(0, |again| again.different);
        let named = [
            (pairs, counted(pairs, "pair")),
            (poses, format!("{} or shapes", counted(poses, "pose"))),
        ];
        let named = named.into_iter().filter_map(|(count, words)| (count > 0).then_some(words));
        let event = again.and_then(|again| again.other_event.as_ref()).map(|_| "events".to_owned());
        let all: Vec<String> = named.chain(event).collect();
        (!all.is_empty()).then(|| all.join(" and "))
    }

    fn is_compared(&self) -> bool {
        self.report.same > 0 || self.simulated.as_ref().is_some_and(|again| again.same > 0)
    }
}

/// What is missing, in words; empty where nothing is.
fn damage(replay: &Replay) -> &'static str {
    match replay.recording().damaged_chunks() {
        0 => "",
        _ => "; it is damaged, so shapes and frames are missing that it held",
    }
}

#[derive(Debug, thiserror::Error)]
#[error("what was found is not what was recorded: {what}{damage}")]
struct Differs {
    what: String,
    damage: &'static str,
}

/// Why a replay verifies nothing.
#[derive(Debug, thiserror::Error)]
enum NothingCompared {
    #[error(
        "nothing was compared, so nothing is verified: the recording does not say what collides, or within what margin"
    )]
    Unknown,
    #[error(
        "nothing was compared, so nothing is verified: the recording holds no pairs. A scene records those that Contacts(margin: …) asks for, where they come as near; --scene SCENE.ron simulates it again and compares poses and shapes"
    )]
    NoPairs,
    #[error(
        "nothing was compared, so nothing is verified: the frames that were chosen hold no pairs, but others do. Choose those with --at, --from and --to"
    )]
    NoPairsChosen,
}

impl NothingCompared {
    fn of(replay: &Replay, report: &ReplayReport) -> Self {
        match replay.frames().iter().all(|frame| frame.pairs.is_empty()) {
            _ if report.unknown > 0 => Self::Unknown,
            true => Self::NoPairs,
            false => Self::NoPairsChosen,
        }
    }
}

fn failure(error: ReplayError) -> Failure {
    Failure::input(error)
}

fn chosen<'a>(replay: &'a Replay, args: &ReplayArgs) -> Result<Vec<&'a ReplayFrame>, Failure> {
    if let Some(at) = args.at {
        check_within(replay, at)?;
        return Ok(vec![replay.nearest(at)]);
    }
    let (from, to) = (args.from.unwrap_or(0.0), args.to.unwrap_or(f64::INFINITY));
    let within = replay.frames().iter().filter(|frame| (from..=to).contains(&frame.time));
    let frames: Vec<&ReplayFrame> = within.step_by(args.every as usize).collect();
    let last = replay.frames().last().map_or(0.0, |frame| frame.time);
    match frames.is_empty() {
        false => Ok(frames),
        true => Err(Failure::input(NoFrame { from, to, last })),
    }
}

/// Fails if a time is farther from all frames than the last two are from each other.
fn check_within(replay: &Replay, at: f64) -> Result<(), Failure> {
    let times: Vec<f64> = replay.frames().iter().rev().take(2).map(|frame| frame.time).collect();
    let last = times.first().copied().unwrap_or_default();
    let spacing = times.get(1).map_or(0.0, |before| last - before);
    match (-spacing..=last + spacing).contains(&at) {
        true => Ok(()),
        false => Err(Failure::input(format!(
            "--at {at}: the recording runs from 0 to {last} s. Name a time in it."
        ))),
    }
}

#[derive(Debug, thiserror::Error)]
#[error("no frame lies between --from {from} and --to {to}: the recording runs from 0 to {last} s")]
struct NoFrame {
    from: f64,
    to: f64,
    last: f64,
}

fn draw(
    replay: &Replay,
    frames: &[&ReplayFrame],
    args: &ReplayArgs,
    path: &Path,
) -> Result<(), Failure> {
    let mut renderer = Renderer::new(&RendererOptions::default()).map_err(Failure::run)?;
    let is_page = args.view == ViewArg::Page;
    let usual = if is_page { PREVIEW_SIZE } else { PICTURE_SIZE };
    let size = args.pictures.size.unwrap_or(usual);
    let scene = replay.scene(frames[0]);
    let view = match args.view {
        ViewArg::Page => ScenePainterView::Page,
        ViewArg::Scene => ScenePainterView::Scene,
        ViewArg::Section => ScenePainterView::Section,
        ViewArg::Xray => ScenePainterView::XRay,
        ViewArg::Wireframe => ScenePainterView::Wireframe,
        ViewArg::Motion => ScenePainterView::Motion,
        ViewArg::Heat => ScenePainterView::Heat,
    };
    let quality = args.pictures.quality.into();
    let camera_size = ScenePainter::camera_size(view, size).map_err(crate::simulation::failure)?;
    let mut painter =
        ScenePainter::new(&scene, camera_size, quality).map_err(crate::simulation::failure)?;
    if !replay.has_contacts() {
        painter = painter.without_recorded_contacts();
    }
    if let Some(name) = &args.pictures.camera {
        painter.choose_camera(&scene, name, camera_size).map_err(crate::simulation::failure)?;
    }
    if matches!(view, ScenePainterView::Motion | ScenePainterView::Heat) {
        let from = args.from.unwrap_or(0.0);
        let before = replay.frames().iter().filter(|f| (from..frames[0].time).contains(&f.time));
        for frame in before {
            replay.dress(&mut painter, frame).map_err(crate::simulation::failure)?;
            painter.follow(frame.time, &replay.poses(frame));
        }
    }
    let delay = milliseconds(frames);
    let mut animation = Animation::new(delay);
    let mut first: Option<Image> = None;
    for frame in frames {
        let moment = replay.moment(frame);
        replay.dress(&mut painter, frame).map_err(crate::simulation::failure)?;
        let image =
            painter.draw(&mut renderer, &moment, view, size).map_err(crate::simulation::failure)?;
        // One at a time: an animation keeps what changes.
        let size = first.as_ref().map_or(image.size(), Image::size);
        animation.push(image.on_canvas(size, palette::PAPER)).map_err(Failure::run)?;
        first.get_or_insert(image);
    }
    match first.filter(|_| frames.len() == 1) {
        Some(image) => image.save_png(path).map_err(Failure::run),
        None => animation.save(path).map_err(Failure::run),
    }
}

/// How long each picture of an animation is shown: as long as its frame lasted.
fn milliseconds(frames: &[&ReplayFrame]) -> u16 {
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else { return 0 };
    let gaps = frames.len().saturating_sub(1).max(1) as f64;
    (1e3 * (last.time - first.time) / gaps).round().clamp(1.0, f64::from(u16::MAX)) as u16
}

fn as_text(replay: &Replay, found: &Found, args: &ReplayArgs) -> String {
    let Found { report, simulated } = found;
    let whole = replay.recording().is_complete();
    let last = replay.frames().last().map_or(0.0, |frame| frame.time);
    let mut lines = vec![
        format!("recording  {}", args.recording.display()),
        format!("holds      {}, up to {last:.3} s", counted(replay.frames().len() as u64, "frame")),
    ];
    if !whole {
        lines.push(
            "cut off    the file has no end: the run was killed, or the disk was full; \
             'cranny recover' makes a whole recording of it"
                .to_owned(),
        );
    } else if replay.recording().was_interrupted() {
        lines.push("broken off the run was interrupted; the file is whole".to_owned());
    }
    if replay.recording().damaged_chunks() > 0 {
        lines.push(format!(
            "damaged    {} not read: sums do not match",
            match replay.recording().damaged_chunks() {
                1 => "1 chunk was".to_owned(),
                chunks => format!("{chunks} chunks were"),
            }
        ));
    }
    lines.push(match report.same + report.different.len() as u64 {
        0 => {
            format!(
                "computed   nothing anew: no pair of {} can be compared",
                counted(report.frames, "frame")
            )
        }
        _ => format!(
            "computed   {} anew: {} the same to the bit, {} different",
            counted(report.frames, "frame"),
            counted(report.same, "pair"),
            report.different.len()
        ),
    });
    if let Some((accuracy, budget)) = levels(replay) {
        let budget = budget.map_or(String::new(), |tests| format!(", {tests} tests a step"));
        lines.push(format!(
            "not anew   triggers and distances were known at {accuracy}{budget}: they depend on what \
             was known before, so only pairs in /contacts are computed anew"
        ));
    }
    if report.unknown > 0 {
        lines.push(format!(
            "unknown    {} cannot be computed anew: the recording does not say what collides",
            counted(report.unknown, "pair")
        ));
    }
    for pair in report.different.iter().take(DIFFERENCES_TOLD) {
        lines.push(format!("differs    {} and {} at {:.6} s", pair.a, pair.b, pair.time));
        lines.push(format!("           recorded {}", pair.recorded));
        lines.push(format!("           computed {}", pair.computed));
    }
    if let Some(simulated) = simulated {
        lines.push(format!(
            "simulated  {} again: {} of bodies the same to the bit, with their shapes, {} different; {} the same",
            counted(report.frames, "frame"),
            counted(simulated.same, "pose"),
            simulated.different,
            counted(simulated.events, "event"),
        ));
        if let Some((time, event)) = &simulated.other_event {
            lines.push(format!("differs    the first other event at {time:.6} s: {event}"));
        }
        for first in simulated.first.iter().take(DIFFERENCES_TOLD) {
            let simulated::Differing { time, body, how } = first;
            lines.push(format!("differs    {body} {how}, from {time:.6} s on"));
        }
    }
    if let Some(path) = &args.render {
        lines.push(format!("written    {}", path.display()));
    }
    lines.join("\n")
}

/// The levels and the budget of a recording whose triggers and distances were not exact.
fn levels(replay: &Replay) -> Option<(&str, Option<&str>)> {
    let metadata = replay.recording().metadata(topic::METADATA)?;
    let entry = |key: &str| metadata.get(key).map(String::as_str);
    let (accuracy, budget) = (entry("accuracy")?, entry(topic::BUDGET_KEY));
    (accuracy != "exact" || budget.is_some()).then_some((accuracy, budget))
}

fn as_json(replay: &Replay, found: &Found, args: &ReplayArgs) -> serde_json::Value {
    let Found { report, simulated } = found;
    let different: Vec<_> = report
        .different
        .iter()
        .map(|d| json!({"time": d.time, "a": d.a, "b": d.b, "recorded": d.recorded, "computed": d.computed}))
        .collect();
    json!({
        "version": 1,
        "recording": args.recording.display().to_string(),
        "complete": replay.recording().is_complete(),
        "damaged_chunks": replay.recording().damaged_chunks(),
        "interrupted": replay.recording().was_interrupted(),
        "held_frames": replay.frames().len(),
        "frames": report.frames,
        "verified": found.is_compared() && found.different().is_none(),
        "same": report.same,
        "different": different,
        "unknown": report.unknown,
        "simulated": simulated.as_ref().map(simulated_json),
        "accuracy": levels(replay).map_or("exact", |(accuracy, _)| accuracy),
        "budget": levels(replay).and_then(|(_, budget)| budget),
    })
}

fn simulated_json(simulated: &SimulatedAgain) -> serde_json::Value {
    let first = simulated.first.iter();
    let first: Vec<_> = first
        .map(|first| json!({"time": first.time, "body": first.body, "how": first.how}))
        .collect();
    let other = simulated.other_event.as_ref();
    let other = other.map(|(time, event)| json!({"time": time, "event": event}));
    json!({
        "same": simulated.same,
        "different": simulated.different,
        "first": first,
        "events": simulated.events,
        "other_event": other,
    })
}
