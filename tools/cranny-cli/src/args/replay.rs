//! Arguments of `cranny replay`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::scene::{PictureArgs, SetArgs};

/// Arguments of `cranny replay`.
#[derive(Debug, Args)]
#[command(after_help = REPLAY_NOTES)]
pub(crate) struct ReplayArgs {
    /// Recording of `cranny run --record`; that of a killed run ends in .partial
    #[arg(value_name = "REC.mcap")]
    pub(crate) recording: PathBuf,

    /// Only the frame nearest to this time in seconds
    #[arg(long, value_name = "S", value_parser = moment, conflicts_with_all = ["from", "to", "every"], allow_hyphen_values = true)]
    pub(crate) at: Option<f64>,

    /// From this time on
    #[arg(long, value_name = "S", value_parser = moment, allow_hyphen_values = true)]
    pub(crate) from: Option<f64>,

    /// Up to this time
    #[arg(long, value_name = "S", value_parser = moment, allow_hyphen_values = true)]
    pub(crate) to: Option<f64>,

    /// Every so many frames
    #[arg(long, value_name = "N", default_value = "1", value_parser = every, allow_hyphen_values = true)]
    pub(crate) every: u32,

    /// Simulate the scene again, as far as these frames go, and compare poses, shapes and events
    #[arg(long, value_name = "SCENE.ron")]
    pub(crate) scene: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) set: SetArgs,

    /// Draw the frame, or an animation of several
    #[arg(long, value_name = "OUT.png")]
    pub(crate) render: Option<PathBuf>,

    /// What is drawn
    #[arg(long, value_enum, value_name = "VIEW", default_value = "page", requires = "render")]
    pub(crate) view: ViewArg,

    /// Write all of it for Rerun's viewer, in place of computing it anew (a build with
    /// --features rerun)
    #[arg(long, value_name = "OUT.rrd", conflicts_with_all = ["at", "from", "to", "every", "scene", "render"])]
    pub(crate) rerun: Option<PathBuf>,

    /// Send all of it to a viewer of Rerun's that runs, in place of computing it anew; without URL,
    /// to the one on this machine (a build with --features rerun)
    #[arg(long, value_name = "URL", num_args = 0..=1, default_missing_value = VIEWER,
          conflicts_with_all = ["at", "from", "to", "every", "scene", "render"])]
    pub(crate) rerun_connect: Option<String>,

    #[command(flatten)]
    pub(crate) pictures: PictureArgs,
}

fn moment(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("a time is a number of seconds of at least 0, such as 0.35".to_owned()),
    }
}

fn every(text: &str) -> Result<u32, String> {
    let refused = || format!("a number of frames is a whole number from 1 to {}", u32::MAX);
    text.parse().ok().filter(|every| *every > 0).ok_or_else(refused)
}

/// What is drawn of a recorded moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ViewArg {
    /// The scene beside a section through what touches, and that magnified.
    Page,
    /// The scene with its contacts.
    Scene,
    /// The section through what touches, alone.
    Section,
    /// The scene, bodies as x-rays.
    Xray,
    /// The scene, bodies as wireframes.
    Wireframe,
    /// The scene with the way of each moving body since --from or the beginning, where it was
    /// before, and its velocity.
    Motion,
    /// The scene twice, faces coloured by how often the search for contacts looks at them: from
    /// nothing, and with what the frames before have left.
    Heat,
}

/// Where Rerun's viewer listens by default.
const VIEWER: &str = "rerun+http://127.0.0.1:9876/proxy";

const REPLAY_NOTES: &str = "\
Every pair of every frame is computed anew from the poses that its answer came from, to the bit, and compared:
verdicts, containment, and regions with depth, area, points and curves. A pair that differs is named, and the
exit code is 1. Contacts for a solver depend on earlier steps and are not compared.

With --scene, the scene is simulated again too, with the recorded step, seed, detector, levels and budget, and
each pose, shape and event is compared to the bit: what a solver made of the contacts as well. It needs no
contacts. A run with --set is simulated again with the same --set.

Where nothing is compared, as without --scene and without Contacts in the scene, nothing is verified: the exit
code is 1 as well, but for --render.

A recording that was cut off is read as far as it is whole. For Rerun it must be whole: see cranny recover.

Examples:
  cranny replay run.mcap
  cranny replay run.mcap --scene assets/scenes/ring_of_tori.ron
  cranny replay run.mcap --at 0.35 --render moment.png
  cranny replay run.mcap --from 1 --to 2 --every 3 --render second.png --view section --size 640x480
  cranny replay run.mcap --rerun run.rrd";
