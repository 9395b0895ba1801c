//! `cranny accuracy`: what certainty costs in time, and what haste costs in certainty.
//!
//! Every method answers at the same poses, in this process and on this thread, in rounds (a spell
//! in which the machine is busy slows one run of each), and judged by exact answers: `truth` has
//! those; `ours` and `peer` are the methods; a `contestant` is one of them with a `series` of
//! replies to each question, at poses that `visits` chooses; `figures` judges these, and `table`
//! and `pose_table` tell them. `refinement` asks bodies at rest again and again. `chart` draws.

mod chart;
mod contestant;
mod figures;
mod method;
mod ours;
mod peer;
mod pose_table;
mod refinement;
mod series;
mod table;
mod truth;
mod visits;

use std::time::Duration;

use cranny_estimate::Accuracy;
use cranny_geometry::{BuildOptions, Model};

use crate::args::{AccuracyArgs, Format};
use crate::failure::Failure;
use crate::model_file::load;
use crate::output::Output;
use crate::paths::{check_writable, make_folder, write};
use crate::pose_file::{PosePair, read_poses};
use crate::progress;
use contestant::MethodContestant;
use figures::MethodFigures;
use ours::{Allowance, Ours};
use peer::Peer;
use pose_table::PoseTable;
use refinement::{Rested, rested};
use truth::Truth;

/// Two bodies and the poses at which they are queried.
struct Scene<'a> {
    models: [&'a Model; 2],
    poses: &'a [PosePair],
    truths: Vec<Truth>,
}

/// What is written; the last two only where a budget is given.
const FILES: [&str; 5] =
    ["accuracy.csv", "poses.csv", "accuracy.svg", "refinement.csv", "refinement.svg"];

/// Runs the command.
///
/// # Errors
///
/// Wrong meshes, poses or options; files or standard output that cannot be written.
pub(crate) fn accuracy(args: &AccuracyArgs, format: Option<Format>) -> Result<(), Failure> {
    let ours = ours(args);
    if ours.is_empty() && args.no_peers {
        return Err(Failure::input(
            "nothing is left to measure: name a level in --levels, a budget in --budgets or a time in --deadlines",
        ));
    }
    let poses = read_poses(&args.poses)?;
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let a = load(&args.pair.mesh_a, args.pair.scale_a, &options)?;
    let b = load(&args.pair.mesh_b, args.pair.scale_b, &options)?;
    // What cannot be written is reported before the long work.
    make_folder(&args.out)?;
    FILES.iter().try_for_each(|name| check_writable(&args.out.join(name)))?;
    let truths = truth::truths([&a, &b], &poses)
        .map_err(|error| Failure::input(format!("pose file {}: {error}", args.poses.display())))?;
    let scene = Scene { models: [&a, &b], poses: &poses, truths };

    let contestants = measured(&scene, ours, args);
    let all: Vec<MethodFigures> = contestants.iter().map(|one| one.figures(&scene)).collect();
    print_rows(&all, format.unwrap_or(Format::Text))?;

    let mut pose_table = PoseTable::new();
    for (name, replies) in contestants.iter().map(MethodContestant::replies) {
        pose_table.add(name, replies, &scene.truths);
    }
    let patience = Duration::from_secs_f64(args.patience);
    let rest: Vec<Rested> =
        args.budgets.0.iter().flat_map(|&budget| rested(&scene, budget, patience)).collect();
    let size = smaller_size(scene.models);
    let mut texts =
        vec![table::csv(&all), pose_table.csv().to_owned(), chart::of_methods(&all, size)?];
    if !rest.is_empty() {
        texts.extend([refinement::csv(&rest), chart::of_rest(&rest, size)?]);
    }
    FILES.iter().zip(texts).try_for_each(|(name, text)| write(&args.out.join(name), &text))
}

/// All levels, then all budgets, then all deadlines; each cold, then warm.
fn ours(args: &AccuracyArgs) -> Vec<Ours> {
    let exact_within = |allowance| (Accuracy::Exact, allowance);
    let levels = args.levels.0.iter().map(|&level| (level, Allowance::Unlimited));
    let budgets = args.budgets.0.iter().map(|&tests| exact_within(Allowance::Tests(tests)));
    let deadlines = args
        .deadlines
        .0
        .iter()
        .map(|&micros| exact_within(Allowance::Time(Duration::from_micros(micros))));
    let all = levels.chain(budgets).chain(deadlines);
    all.flat_map(|(accuracy, allowance)| Ours::both(accuracy, allowance)).collect()
}

/// Asks all in rounds.
fn measured(scene: &Scene, ours: Vec<Ours>, args: &AccuracyArgs) -> Vec<MethodContestant> {
    let patience = Duration::from_secs_f64(args.patience);
    let bar = progress::bar(ours.len() as u64, "trying");
    let mut all: Vec<MethodContestant> = Vec::new();
    for method in ours {
        all.push(MethodContestant::ours(scene, method, patience));
        bar.inc(1);
    }
    bar.finish_and_clear();
    for kind in if args.no_peers { &[][..] } else { &Peer::KINDS[..] } {
        let spinner = progress::spinner(format!("preparing {}", kind.name()));
        all.push(MethodContestant::peer(scene, *kind, patience));
        spinner.finish_and_clear();
    }
    let runs = args.runs.get();
    let bar = progress::bar(u64::from(runs) * all.len() as u64, "measuring");
    for _ in 0..runs {
        for one in &mut all {
            one.run(scene);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    all
}

fn print_rows(all: &[MethodFigures], format: Format) -> Result<(), Failure> {
    let mut output = Output::new();
    if format == Format::Text {
        output.line(&table::heading())?;
    }
    all.iter().try_for_each(|figures| match format {
        Format::Json => output.json(figures),
        Format::Text => output.line(&figures.text()),
    })
}

/// From corner to corner of the smaller body's box: what errors are compared with.
fn smaller_size([a, b]: [&Model; 2]) -> f64 {
    a.bounds().diagonal().min(b.bounds().diagonal())
}
