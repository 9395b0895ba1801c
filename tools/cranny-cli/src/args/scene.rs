//! Arguments of the commands that take a scene.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use cranny_ecs::PictureQuality;
use cranny_estimate::Accuracy;
use cranny_scene::{LoadOptions, Setting};

use super::{StepBudget, level, step_budget};

/// What of a scene is set otherwise than its file says.
#[derive(Debug, Default, Args)]
pub(crate) struct SetArgs {
    /// A value in place of the scene's, as the file would say it; may be given several times. PATH
    /// leads from field to field, to elements of lists by name, kind or number from 0, and to
    /// coordinates: gravity.z=-1.6, bodies.nut.material.friction=0.1, 'groups.piece.kind=Fixed'
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) settings: Vec<Setting>,
}

impl SetArgs {
    /// For a scene whose seed may be replaced.
    pub(crate) fn load_options(&self, seed: Option<u64>) -> LoadOptions {
        LoadOptions { seed, settings: self.settings.clone() }
    }
}

/// Arguments of `cranny check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  cranny check assets/scenes/ring_of_tori.ron
  cranny check assets/scenes/mixed_pile.ron --set gravity.z=-1.6")]
pub(crate) struct CheckArgs {
    /// Scene file; the meshes and robots that it names are read as well
    #[arg(value_name = "SCENE.ron")]
    pub(crate) scene: PathBuf,

    #[command(flatten)]
    pub(crate) set: SetArgs,
}

/// Arguments of `cranny explain`.
#[derive(Debug, Args)]
#[command(after_help = EXPLAIN_NOTES)]
pub(crate) struct ExplainArgs {
    /// Scene file
    #[arg(value_name = "SCENE.ron")]
    pub(crate) scene: PathBuf,

    #[command(flatten)]
    pub(crate) set: SetArgs,

    #[command(flatten)]
    pub(crate) effort: EffortArgs,
}

const EXPLAIN_NOTES: &str = "\
Nothing is simulated: the effects that the scene asks for are composed as `cranny run` would, and
what then stands in the schedule is read from it.

Example:
  cranny explain assets/scenes/ring_of_tori.ron";

/// What a run may take instead of what the scene says.
#[derive(Debug, Args)]
pub(crate) struct InsteadArgs {
    /// Simulated time in seconds, rounded up to whole steps [default: the scene's `duration`]
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) duration: Option<f64>,

    /// Length of a step in seconds [default: the scene's `step`]
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true)]
    pub(crate) dt: Option<f64>,

    /// Seed of whatever the scene leaves to chance [default: the scene's `seed`]
    #[arg(long, value_name = "N", value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: Option<u64>,

    #[command(flatten)]
    pub(crate) set: SetArgs,
}

impl InsteadArgs {
    /// How the scene is read.
    pub(crate) fn load_options(&self) -> LoadOptions {
        self.set.load_options(self.seed)
    }
}

/// Arguments of `cranny run`.
#[derive(Debug, Args)]
#[command(after_help = RUN_NOTES)]
pub(crate) struct RunArgs {
    /// Scene file
    #[arg(value_name = "SCENE.ron")]
    pub(crate) scene: PathBuf,

    /// Who finds the contacts
    #[arg(long, value_enum, value_name = "DETECTOR", default_value = "cranny")]
    pub(crate) detector: DetectorArg,

    #[command(flatten)]
    pub(crate) effort: EffortArgs,

    #[command(flatten)]
    pub(crate) instead: InsteadArgs,

    /// Threads for the pairs that no solver detects; results are the same with any number
    #[arg(long, value_name = "N", value_parser = threads, default_value = "1", allow_hyphen_values = true)]
    pub(crate) threads: NonZeroUsize,

    /// Record poses, contacts and pictures, for Foxglove and Lichtblick
    #[arg(long, value_name = "OUT.mcap")]
    pub(crate) record: Option<PathBuf>,

    /// Write the same for Rerun's viewer (a build with --features rerun)
    #[arg(long, value_name = "OUT.rrd")]
    pub(crate) rerun: Option<PathBuf>,

    /// Write each picture as a PNG into this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) frames: Option<PathBuf>,

    /// Write an animated picture of the run: the scene beside a section through what touches
    #[arg(long, value_name = "OUT.png")]
    pub(crate) preview: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) pictures: PictureArgs,
}

/// How much is spent on triggers and distances.
#[derive(Debug, Args)]
pub(crate) struct EffortArgs {
    /// Level of all triggers and distances: boxes, hulls, caps, tree:DEPTH or exact; no level
    /// misses what exact finds [default: the scene's levels]
    #[arg(long, value_name = "LEVEL", value_parser = level)]
    pub(crate) accuracy: Option<Accuracy>,

    /// Elementary tests a step for all triggers and distances together, or `unlimited`; what is
    /// open is narrowed in later steps [default: the scene's `budget`]
    #[arg(long, value_name = "N", value_parser = step_budget, allow_hyphen_values = true)]
    pub(crate) budget: Option<StepBudget>,
}

/// How pictures look.
#[derive(Debug, Args)]
pub(crate) struct PictureArgs {
    /// Width and height of each picture in pixels; of a preview, its width and the height of the
    /// pictures in it [default: 1280x720; 1180x360 for a preview]
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<[u32; 2]>,

    /// The only camera: one of the scene's, or isometric, front, side or top [default: all of the
    /// scene's; for a preview, its first]
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,

    /// How much is done for the eye: draft has no outlines and no shade, fine is drawn at twice the
    /// size and scaled down
    #[arg(long, value_enum, value_name = "QUALITY", default_value = "normal")]
    pub(crate) quality: QualityArg,
}

/// How much is done for the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum QualityArg {
    /// Light on the faces alone.
    Draft,
    /// Outlines, and shade where bodies stand close.
    Normal,
    /// The same at twice the size, scaled down.
    Fine,
}

impl From<QualityArg> for PictureQuality {
    fn from(argument: QualityArg) -> Self {
        match argument {
            QualityArg::Draft => Self::Draft,
            QualityArg::Normal => Self::Normal,
            QualityArg::Fine => Self::Fine,
        }
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X']).map(|(w, h)| [w, h].map(|side| side.parse::<u32>()));
    match sides {
        Some([Ok(width), Ok(height)])
            if (16..=8192).contains(&width) && (16..=8192).contains(&height) =>
        {
            Ok([width, height])
        }
        Some([Ok(_), Ok(_)]) => Err("each side must have 16 to 8192 pixels".to_owned()),
        _ => Err("a size is width x height in pixels, such as 1280x720".to_owned()),
    }
}

const RUN_NOTES: &str = "\
Summary (only lines of which something is known; lengths in units of the scene, wall-clock times):
  simulated   time in the scene, and steps
  - in parts  steps that the solver made in more than one part, since bodies near each other moved far in
              them; the scene's `most_parts` is the limit
  wall time   of all steps, without preparation; 2 x real time: a simulated second takes half a second
  time, ms    of it, in all: broad phase, narrow phase, solver, report (what effects read), recording, pictures
  pairs       examined in a step, on average and at most
  - contacts  pairs whose contacts were carried on from an earlier step, and those that were searched
  tests       elementary tests of a step, where no solver detects
  estimates   pairs known at a level or within a budget
  contacts    points that the solver got, or that effects report where there is none
  deepest     overlap of the exact shapes at the beginning of any step
  - first     the first overlap of all, however deep
  triggers    pairs with Trigger that touched
  tracking    contacts of a tracked body beside those that it truly makes
  left        bodies that left the world: a box about all bodies where they were put, grown by its own diagonal
  inside      steps in which a body lay wholly within another's material, whose depth is not known
  held back   bodies with Continuous that would have passed through another one
  joints      how far joints that motors hold are off
  energy      most gained over the start, and gained or lost at the end, in percent of what moved
  screw       of a nut on its bolt: turns, and how far off the helix at most
  links       rings linked at the start that stayed so
  motion      how far a body is from where it was put
  state       hash of the final poses and velocities: equal runs have equal ones
  skipped     what was requested and not done, with the reason
With --format json the summary is the last line, with everything that is known.

Ctrl-C ends the run after the step at hand: the recording is finished and the summary printed.
Without a graphics adapter the run goes on without pictures, and the summary says so.

A preview is a page a moment: the first camera's picture, the bodies that meet deepest cut open through their
contact, and that contact magnified. Bodies that move are coloured, bodies that stand still grey, and those of
them that hide what moves are drawn as x-rays. Pictures change nothing in the run: the state hash is the same.

A level or a budget is for pairs of which Trigger and Proximity alone are asked. A verdict that is open at it
counts as touching; the summary says how many were, and how many tests a step took. What that saved is the
difference to the tests of a run with --accuracy exact --budget unlimited.

Examples:
  cranny run assets/scenes/ring_of_tori.ron --preview tori.png
  cranny run assets/scenes/nut_on_bolt.ron --detector rapier-trimesh --duration 2 --format json
  cranny run assets/scenes/robot_arm.ron --record arm.mcap
  cranny run assets/scenes/robot_arm.ron --rerun arm.rrd
  cranny run assets/scenes/mixed_pile.ron --set gravity.z=-1.6 --set groups.piece.material=(friction:0)
  cranny run assets/scenes/budgeted_triggers.ron --budget unlimited";

/// Arguments of `cranny compare`.
#[derive(Debug, Args)]
#[command(after_help = COMPARE_NOTES)]
pub(crate) struct CompareArgs {
    /// Scene file, in which something responds to something
    #[arg(value_name = "SCENE.ron")]
    pub(crate) scene: PathBuf,

    /// Detectors to compare, in this order; may be given several times [default: all four]
    #[arg(long, value_enum, value_name = "DETECTOR", value_delimiter = ',')]
    pub(crate) detector: Vec<DetectorArg>,

    /// Whether a pair's contacts are carried on while the pair drifts a little
    #[arg(long, value_enum, value_name = "WHICH", default_value = "on")]
    pub(crate) recycling: RecyclingArg,

    /// How many substeps the solver makes of a step
    #[arg(long, value_enum, value_name = "WHICH", default_value = "same")]
    pub(crate) substeps: SubstepsArg,

    #[command(flatten)]
    pub(crate) instead: InsteadArgs,

    /// Folder for compare.csv, steps.csv, steps.svg and compare.svg (time of a step against deepest
    /// overlap); made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

const COMPARE_NOTES: &str = "\
All run in this process, on one thread, a step each in turn. The solver is the same for all, and so are its
substeps unless stated otherwise; what differs is how contacts come to it: our detector turns rapier's
contact clustering off and has Coulomb friction at each point, rapier's keep their defaults. Only with our
detector is a step divided, into as many parts as the scene's `most_parts` says (2 by default), where bodies
near each other move far in it; with rapier's it is made as a whole. Every run is
judged by exact answers at the poses that it came to; what that costs is not counted. A detector of
rapier's that fails says so in its row, and the others go on. Ctrl-C ends all after the step at hand.

Columns (only those of which something is known; lengths in units of the scene, wall-clock times in
milliseconds: on a busy machine trust medians, not means):
  ready          seconds until the first step; exact models for judging are part of it for each
  substeps       of the solver, a step
  step           broad phase, narrow phase and solver; narrow and solver of it, on average
  contacts       points that the solver got
  carried        of the pairs that our detector answered about, those whose contacts were carried on
  deepest        overlap of the exact shapes, at any step, along the normal of a contact region; where
                 shapes interlock, another way out may be shorter
  inside         steps in which a body lay wholly within another's material, whose depth is not known
  energy         most gained over the start, and gained at the end (negative: lost), in percent of
                 what moved
  left           bodies that left the world: a box about all bodies where they were put, grown by its own diagonal
  moved          how far the body is from where it was put that moved farthest
  links          rings linked at the start that stayed so
  screw          of the first nut on its bolt: turns, and how far off the helix at most
With --format json a row is a line, with everything that is known of it.

Examples:
  cranny compare assets/scenes/ring_of_tori.ron
  cranny compare assets/scenes/nut_on_bolt.ron --duration 0.5 --detector cranny,rapier-trimesh
  cranny compare assets/scenes/mixed_pile_50.ron --recycling both --out report";

/// Which recycling of contacts is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RecyclingArg {
    /// On for all
    On,
    /// Off for all
    Off,
    /// Each detector with and without
    Both,
}

/// Whose substeps the solver makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SubstepsArg {
    /// For all as many as our detector needs: of 1/960 s, at least 4
    Same,
    /// For rapier's detectors its default, 4
    Own,
}

/// Who finds the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DetectorArg {
    /// Exact contacts, by this project
    Cranny,
    /// Triangle meshes as rapier takes them
    RapierTrimesh,
    /// The same with rapier's flags that mend contacts at internal edges
    RapierTrimeshFixed,
    /// Convex pieces by rapier's approximate decomposition
    RapierDecomposition,
    /// The box of each mesh: what the level boxes knows of it
    RapierBoxes,
    /// The convex hull of each mesh: what the level hulls knows
    RapierHulls,
    /// The boxes of each mesh's tree, opened six times: what the level tree:6 knows
    RapierTree,
}

/// Threads for each of the machine's. More: they take turns, and nothing is faster.
const THREADS_EACH: usize = 4;

/// Threads whatever the machine. More: starting them takes longer than a step.
const MOST_THREADS: usize = 1024;

/// A number of threads.
fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let count: NonZeroUsize =
        text.parse().map_err(|_| "a number of threads is 1 or more, such as 4".to_owned())?;
    let machine = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let most = THREADS_EACH.saturating_mul(machine).min(MOST_THREADS);
    match count.get() <= most {
        true => Ok(count),
        false => Err(format!(
            "at most {most} threads, {THREADS_EACH} for each of the {machine} that this machine runs at once"
        )),
    }
}

/// A seed.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

/// A length of time above 0.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        Ok(_) => Err("a time must be finite and above 0 seconds, such as 0.0041667".to_owned()),
        Err(_) => Err("a time is a number of seconds, such as 0.0041667".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_as_many_threads_as_serve() {
        assert_eq!(threads("3").map(NonZeroUsize::get), Ok(3));
        for text in ["0", "-1", "x", ""] {
            assert!(threads(text).unwrap_err().contains("1 or more"), "{text:?}");
        }
        for text in ["1025", "20000"] {
            assert!(threads(text).unwrap_err().contains("at most"), "{text:?}");
        }
    }

    #[test]
    fn times_are_checked() {
        assert_eq!(seconds("0.5"), Ok(0.5));
        for text in ["0", "-1", "inf", "NaN", "soon"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
