//! Arguments of `cranny accuracy`.

use std::path::PathBuf;

use clap::Args;

use super::PairArgs;

/// Arguments of `cranny accuracy`.
#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub(crate) struct AccuracyArgs {
    #[command(flatten)]
    pub(crate) pair: PairArgs,

    /// List of poses, as for `query`: in the order of a motion, so that memory can help
    #[arg(long, value_name = "POSES.json")]
    pub(crate) poses: PathBuf,

    /// Folder for accuracy.csv and accuracy.svg; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Leave parry out: its triangle mesh and its convex decomposition (which may take minutes to make)
    #[arg(long)]
    pub(crate) no_peers: bool,
}

const NOTES: &str = "\
Each level of accuracy, exact answers within budgets of elementary tests, and parry's triangle meshes and
convex decompositions are asked for verdict and distance at the same poses, on one thread, and judged by the
exact answer. `warm` keeps memory from pose to pose, `cold` keeps none; what a level prepares once is
not counted.

Columns of accuracy.csv (lengths in units of the meshes; empty: not told):
  method, level, budget, memory   what was asked: cranny, parry-trimesh, parry-decomposition
  poses                           asked; a slow peer is asked at some of them, evenly spread
  median_us, p99_us               time of a pose, the best of three; tests_mean: elementary tests
  false_negatives                 told apart, but they meet: 0 for cranny
  false_positives                 told to meet, but they are apart; open: neither was told
  width_mean, width_max           of the interval that holds the distance
  distance_error_mean, _max       of the distance: of the interval's upper end
  witness_error_mean              how far witness points are from the exact ones, where bodies are apart
                                  (where several are as near, others may be named)
  contact_error_mean              how far the nearest place told is from each region's deepest contact

accuracy.svg: median time against mean width (for peers: mean error of the distance), divided by the
size of the smaller body, both axes logarithmic. What is exact lies at the bottom.

Example:
  cranny accuracy bolt.obj nut.obj --poses poses.json --out report";
