//! Arguments of `cranny accuracy`.

use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::Args;
use cranny_estimate::Accuracy;

use super::scene::{SetArgs, seconds};
use super::{budget, level, scale};

/// Arguments of `cranny accuracy`.
#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub(crate) struct AccuracyArgs {
    /// A scene, whose pairs are queried at the poses of its run; or mesh A or saved model A
    #[arg(value_name = "SCENE.ron|A")]
    pub(crate) subject: PathBuf,

    /// Mesh or model B, to be queried with A; may be the same file
    #[arg(value_name = "B", requires = "poses")]
    pub(crate) mesh_b: Option<PathBuf>,

    /// Scale of mesh A, applied to its vertices before anything else
    #[arg(long, value_name = "S", default_value = "1", value_parser = scale, allow_hyphen_values = true, requires = "mesh_b")]
    pub(crate) scale_a: f64,

    /// Scale of mesh B
    #[arg(long, value_name = "S", default_value = "1", value_parser = scale, allow_hyphen_values = true, requires = "mesh_b")]
    pub(crate) scale_b: f64,

    /// List of poses of A and B, as for `query`: in the order of a motion, so that memory can help
    #[arg(long, value_name = "POSES.json", requires = "mesh_b")]
    pub(crate) poses: Option<PathBuf>,

    /// Simulated time of a scene in seconds [default: the scene's `duration`]
    #[arg(long, value_name = "S", value_parser = seconds, allow_hyphen_values = true, conflicts_with = "mesh_b")]
    pub(crate) duration: Option<f64>,

    #[command(flatten)]
    pub(crate) set: SetArgs,

    /// Folder for the page, the tables and the charts; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Levels of accuracy, as for `query`, with commas between, or `none`
    #[arg(long, value_name = "LIST", value_parser = levels, allow_hyphen_values = true, default_value = "boxes,hulls,caps,tree:2,tree:4,tree:6,tree:8,tree:12,tree:16,exact")]
    pub(crate) levels: List<Accuracy>,

    /// Budgets for exact answers, in elementary tests a pose, or `none`
    #[arg(long, value_name = "LIST", value_parser = budgets, allow_hyphen_values = true, default_value = "10,30,100,300,1000,3000,10000")]
    pub(crate) budgets: List<u64>,

    /// Times for exact answers, in whole microseconds a pose, or `none`
    #[arg(long, value_name = "LIST", value_parser = deadlines, allow_hyphen_values = true, default_value = "10,100,1000")]
    pub(crate) deadlines: List<u64>,

    /// How many times each method answers at each pose; the shortest time counts
    #[arg(long, value_name = "N", default_value = "3", value_parser = runs, allow_hyphen_values = true)]
    pub(crate) runs: NonZeroU32,

    /// Seconds that a method may take to answer once at all poses; one that is slower answers at
    /// some of them
    #[arg(long, value_name = "S", default_value = "4", value_parser = patience, allow_hyphen_values = true)]
    pub(crate) patience: f64,

    /// Leave parry out: its triangle mesh and its convex decomposition (which may take minutes to
    /// make)
    #[arg(long)]
    pub(crate) no_peers: bool,
}

/// What was written with commas between.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct List<T>(pub(crate) Vec<T>);

fn list<T>(text: &str, item: impl Fn(&str) -> Result<T, String>) -> Result<List<T>, String> {
    match text.trim() {
        "none" => Ok(List(Vec::new())),
        text => text
            .split(',')
            .map(|part| item(part.trim()).map_err(|error| format!("{part:?}: {error}")))
            .collect::<Result<_, _>>()
            .map(List),
    }
}

fn levels(text: &str) -> Result<List<Accuracy>, String> {
    list(text, level)
}

fn budgets(text: &str) -> Result<List<u64>, String> {
    list(text, budget)
}

/// The longest time that may be given, an hour: longer ones are meant to be none.
const LONGEST_US: u64 = 3_600_000_000;

fn deadlines(text: &str) -> Result<List<u64>, String> {
    let wrong = format!("a time is a whole number of microseconds from 1 to {LONGEST_US}");
    list(text, |part| {
        let micros = part.parse().ok().filter(|micros| (1..=LONGEST_US).contains(micros));
        micros.ok_or_else(|| wrong.clone())
    })
}

fn runs(text: &str) -> Result<NonZeroU32, String> {
    text.parse().map_err(|_| "a number of runs is 1 or more, such as 3".to_owned())
}

/// Seconds. Smaller: nothing is quick enough to answer twice, whatever the machine.
const LEAST_PATIENCE: f64 = 1e-5;

fn patience(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds| (LEAST_PATIENCE..=3600.0).contains(seconds));
    seconds.ok_or_else(|| "a patience is a number of seconds from 0.00001 to 3600".to_owned())
}

const NOTES: &str = "\
Each level of accuracy, exact answers within budgets of elementary tests and within times, and parry's
triangle meshes and convex decompositions answer at the same poses, on one thread, in rounds, and judged
by the exact answer: for verdict and distance at all poses, and for regions of contact where bodies are in
contact. `warm` keeps memory from pose to pose, `cold` keeps none; what a level prepares once is not counted.
A method that takes longer than --patience answers at some poses: evenly spread, or, if it keeps memory, at
stretches of consecutive ones. So rows with different `poses` are not quite about the same.

Of a SCENE.ron, the poses are those of every pair of bodies whose boxes overlap while the scene runs under our
detector: of all steps, or of a long run in 20 stretches of 24 steps. Then the scene runs under each detector,
as `cranny compare` does.

accuracy.html is the report: a picture of the scene, the plot, what follows from it, the motion under each
detector, the figures. It needs no other file.

Columns of accuracy.csv (lengths in units of the meshes; empty: no answer):
  method, level, budget, deadline_us, memory
                                  the detector: cranny, parry-trimesh, parry-decomposition
  poses                           at which it answered
  median_us, p99_us               time of a pose, the shortest of all runs; tests_mean: elementary tests
  false_negatives                 apart by its answer, but they meet: 0 for cranny
  false_positives                 meet by its answer, but they are apart: 0 for cranny; open: no answer
  outside                         intervals that do not hold the distance: 0 for cranny
  width_mean, width_max           of the interval that holds the distance
  distance_error_mean, _max       of the distance: of the interval's upper end
  witness_error_mean, _max        how far witness points are from the exact ones, where bodies are apart
                                  (where several are as near, others may be named)
  contact_poses                   poses at which bodies are in contact, and regions were demanded
  contact_median_us, _p99_us      time of that; contacts_mean: contacts reported, or places where they may be
  contacts_missed                 regions at poses where no contact was reported
  contact_error_mean, _max        how far the nearest contact reported is from each region's deepest one; who
                                  reports many is near everything
  apart_poses, _mean_us           poses at which bodies are apart, and the mean time there
  apart_error, _error_max         of the distance, as a share of the size of the smaller body, at most 1: the
                                  interval's width, or what a method without intervals is off by
  apart_wrong, apart_open         wrong verdicts, and none
  overlapping_...                 the same of the depth, where bodies overlap; wrong: no contact reported
  note                            why there are no figures: what parry says of a mesh, or that it panicked

poses.csv: each method's answer at each pose, beside what is so.
accuracy.svg: mean time against mean error, where bodies are apart and where they overlap, both axes
logarithmic. A line goes through the methods of a kind that more time makes more exact.
refinement.csv, refinement.svg: bodies at rest, at up to 32 of the poses: what is known after each of up to 64
frames, of so many tests each.

Examples:
  cranny accuracy assets/scenes/nut_on_bolt.ron --duration 1 --out report
  cranny accuracy bolt.obj nut.obj --poses poses.json --out report
  cranny accuracy a.obj b.obj --poses poses.json --out report --levels hulls,exact --budgets 50,500 --no-peers";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_item_by_item() {
        assert_eq!(budgets("10, 0,7"), Ok(List(vec![10, 0, 7])));
        assert_eq!(levels("none"), Ok(List(Vec::new())));
        assert_eq!(levels("tree:3,exact"), Ok(List(vec![Accuracy::Tree(3), Accuracy::Exact])));
        assert_eq!(deadlines("1"), Ok(List(vec![1])));
        for text in ["", "10,", "10,x", "-1"] {
            assert!(budgets(text).unwrap_err().contains("whole number"), "{text:?}");
        }
        assert!(levels("exact,bxes").unwrap_err().starts_with("\"bxes\": choose"));
        for text in ["0", "1.5", "4000000000", "soon"] {
            assert!(deadlines(text).unwrap_err().contains("microseconds"), "{text:?}");
        }
    }

    #[test]
    fn runs_and_patience_are_checked() {
        assert_eq!((runs("3").map(NonZeroU32::get), patience("0.5")), (Ok(3), Ok(0.5)));
        assert!(["0", "-1", "x"].iter().all(|text| runs(text).is_err()));
        assert!(["0", "-1", "inf", "NaN", "x"].iter().all(|text| patience(text).is_err()));
    }
}
