//! What each effect costs in a scene: time a step and memory, each alone and all together, beside
//! the solver that moves the bodies.
//!
//! Each is measured in a process of its own, whose peak of resident memory the kernel counts; the
//! time is the process's CPU time of the steps, without preparation.

use std::io::{self, Error, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use clap::Args;
use cpu_time::ProcessTime;
use cranny_ecs::{RunOptions, SceneApp};
use cranny_exact::{Aabb, DVec3, Pose};
use cranny_scene::load_scene;
use cranny_world::description::{
    BodyDescription, BodyKind, Effect, Interpolation, Keyframe, KeyframedPath, PathEnd,
    SceneDescription, SimulatedDevice, TrackerDescription, TrackerSettings,
};

/// Which scene, and for how long.
#[derive(Debug, Args)]
pub(crate) struct EffectsArgs {
    /// The scene; its own effects are left out, and a body that is led through it is added
    #[arg(value_name = "SCENE", default_value = "assets/scenes/mixed_pile.ron")]
    scene: PathBuf,

    /// Steps of the scene that are made
    #[arg(long, default_value_t = 180)]
    steps: u64,

    /// Measures one row in this process
    #[arg(long, hide = true)]
    row: Option<usize>,
}

/// Prints the table, in Markdown.
pub(crate) fn tabulate(args: &EffectsArgs) -> io::Result<()> {
    let EffectsArgs { scene, steps, row } = args;
    let said = match row {
        Some(row) => measure(scene, *row, *steps)?,
        None => table(scene, *steps)?,
    };
    io::stdout().lock().write_all(said.as_bytes())
}

/// Where the kernel counts a process's memory.
const STATUS: &str = "/proc/self/status";

/// Effects in the order of the table, each with what else it needs.
fn measured() -> Vec<(&'static str, Vec<Effect>)> {
    let alone: [(&str, Effect); 8] = [
        ("`Trigger()`", Effect::TRIGGER),
        ("`Proximity(within: 0.1)`", Effect::proximity(0.1)),
        ("`Contacts(margin: 0.01)`", Effect::Contacts { margin: 0.01 }),
        ("`Penetration()`", Effect::Penetration),
        ("`Continuous()`", Effect::Continuous),
        ("`Sound(above: 0.3)`", Effect::Sound { above: 0.3 }),
        ("`Deformation(hardness: 100, radius: 0.3)`", DENTS),
        ("`ForceFeedback(stiffness: 500)`", Effect::ForceFeedback { stiffness: 500.0 }),
    ];
    let all = alone.iter().map(|(_, effect)| *effect).chain([TRACKING]).collect();
    let mut rows = vec![("`Response()`", Vec::new())];
    rows.extend(alone.into_iter().map(|(name, effect)| (name, vec![effect])));
    rows.push(("`Tracking(tolerance: 0.01)`, `Trigger()`", vec![Effect::TRIGGER, TRACKING]));
    rows.push(("all of them", all));
    rows
}

const TRACKING: Effect = Effect::Tracking { tolerance: 0.01 };

const DENTS: Effect = Effect::Deformation { hardness: 100.0, radius: 0.3 };

/// Measures the hand, where it is tracked.
const DEVICE: SimulatedDevice = SimulatedDevice {
    rate: 120.0,
    jitter: 0.01,
    latency: 0.005,
    latency_spread: 0.005,
    dropouts: 0.05,
    occlusions: 0.0,
    occluded_for: 0.0,
    seed: 1,
};

/// A body like the first that falls, which somebody leads once through all of them, near the
/// bottom: without one nobody feels a force, and no pose is tracked.
fn hand(scene: &SceneDescription, is_tracked: bool) -> Result<BodyDescription, String> {
    let moving = || scene.bodies.iter().filter(|body| body.kind == BodyKind::Dynamic);
    let first = moving().next().ok_or("a scene without a body that falls")?;
    let places = Aabb::of_points(moving().map(|body| body.pose.translation));
    let (low, high) = (places.min, places.max);
    let start = DVec3::new(low.x, 0.5 * (low.y + high.y), low.z + 0.1 * (high.z - low.z));
    let end = DVec3 { x: high.x, ..start };
    let key = |time, place| Keyframe { time, pose: Pose::at(place) };
    let keys = vec![key(0.0, start), key(scene.duration, end)];
    let path = KeyframedPath::new(keys, Interpolation::Linear, PathEnd::Hold);
    let tracker = TrackerDescription { settings: TrackerSettings::default(), device: DEVICE };
    Ok(BodyDescription {
        name: "hand".to_owned(),
        kind: BodyKind::Kinematic,
        pose: Pose::at(start),
        path: Some(Arc::new(path.map_err(|error| error.to_string())?)),
        tracker: is_tracked.then_some(tracker),
        mass: None,
        ..first.clone()
    })
}

/// Milliseconds a step and MiB of one row.
#[derive(Clone, Copy)]
struct Measured {
    milliseconds: f64,
    mebibytes: f64,
}

/// Measures one row in this process, and prints it for the process that started it.
fn measure(scene: &Path, row: usize, steps: u64) -> io::Result<String> {
    let mut description = load_scene(scene).map_err(Error::other)?.description;
    let rows = measured();
    let (_, effects) =
        rows.get(row).ok_or_else(|| Error::other(format!("there is no row {row}")))?;
    description.effects = [&[Effect::Response][..], effects].concat();
    description.bodies.iter_mut().for_each(|body| body.effects.clear());
    description.duration = description.step * steps as f64;
    let is_tracked = description.effects.contains(&TRACKING);
    let hand = hand(&description, is_tracked).map_err(Error::other)?;
    description.bodies.push(hand);
    let mut app = SceneApp::new(&description, &RunOptions::default()).map_err(Error::other)?;
    let start = ProcessTime::now();
    while app.step().map_err(Error::other)? {}
    let spent = start.elapsed().as_secs_f64();
    Ok(format!("{} {}", 1e3 * spent / steps as f64, peak_mebibytes()?))
}

/// The most memory that this process had at once.
fn peak_mebibytes() -> io::Result<f64> {
    let status = std::fs::read_to_string(STATUS).map_err(|error| {
        Error::other(format!("memory is counted on Linux only: {STATUS}: {error}"))
    })?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes =
        line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    let lacks = || Error::other(format!("{STATUS} has no VmHWM"));
    Ok(kibibytes.ok_or_else(lacks)? / 1024.0)
}

fn table(scene: &Path, steps: u64) -> io::Result<String> {
    let program = std::env::current_exe()?;
    let mut rows: Vec<(&str, Measured)> = Vec::new();
    for (row, (name, _)) in measured().into_iter().enumerate() {
        rows.push((name, in_a_process(&program, scene, row, steps)?));
    }
    let alone = rows[0].1;
    let mut table = String::from("| effect | ms a step | more than `Response` | MiB | more |\n");
    table += "|---|---|---|---|---|\n";
    for (name, Measured { milliseconds, mebibytes }) in rows {
        let more = (milliseconds - alone.milliseconds, mebibytes - alone.mebibytes);
        table += &format!(
            "| {name} | {milliseconds:.2} | {:.2} | {mebibytes:.1} | {:.1} |\n",
            more.0, more.1
        );
    }
    Ok(table)
}

fn in_a_process(program: &Path, scene: &Path, row: usize, steps: u64) -> io::Result<Measured> {
    let mut command = Command::new(program);
    command.args(["effects", "--row", &row.to_string(), "--steps", &steps.to_string()]);
    let output = command.arg(scene).output()?;
    let said = String::from_utf8_lossy(&output.stdout);
    let numbers: Vec<f64> = said.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [milliseconds, mebibytes] => Ok(Measured { milliseconds, mebibytes }),
        _ => Err(Error::other(String::from_utf8_lossy(&output.stderr).trim().to_owned())),
    }
}
