//! `cranny accuracy`: what certainty costs in time, and what haste costs in certainty.
//!
//! Every method answers at the poses of one `motion`, in this process and on this thread, in rounds
//! (a spell in which the machine is busy slows one run of each), and judged by exact answers:
//! `truth` has those; `ours` and `peer` are the methods; a `contestant` is one of them with a
//! `series` of replies to each question, at poses that `visits` chooses; `figures` judges these,
//! each `panel` those of one kind, and `table` and `pose_table` list them. `refinement` looks again
//! and again at bodies at rest. `chart` draws, `conclusion` says it in words, and `page` has it all
//! for somebody who never saw the project.

mod chart;
mod conclusion;
mod contestant;
mod figures;
mod method;
mod motion;
mod motion_words;
mod ours;
mod page;
mod panel;
mod peer;
mod pose_table;
mod refinement;
mod series;
mod table;
mod truth;
mod visits;

use std::path::Path;
use std::time::Duration;

use cranny_estimate::Accuracy;
use cranny_geometry::BuildOptions;
use cranny_scene::LoadedScene;

use crate::args::{AccuracyArgs, Format};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{check_writable, make_folder, write};
use crate::pose_file::read_poses;
use crate::progress;
use crate::{model_file, scene_file};
use contestant::MethodContestant;
use figures::MethodFigures;
use motion::{Judged, Motion};
use ours::{Allowance, Ours};
use page::PageSubject;
use peer::Peer;
use pose_table::PoseTable;
use refinement::{Rested, rested};

/// What is written; the last two only where a budget is given.
const FILES: [&str; 6] = [
    "accuracy.csv",
    "poses.csv",
    "accuracy.svg",
    "accuracy.html",
    "refinement.csv",
    "refinement.svg",
];

/// Runs the command.
///
/// # Errors
///
/// Wrong scenes, meshes, poses or options; files or standard output that cannot be written.
pub(crate) fn accuracy(args: &AccuracyArgs, format: Option<Format>) -> Result<(), Failure> {
    let ours = ours(args);
    if ours.is_empty() && args.no_peers {
        return Err(Failure::input(
            "nothing is left to measure: name a level in --levels, a budget in --budgets or a time in --deadlines",
        ));
    }
    let subject = Subject::read(args)?;
    // What cannot be written is reported before the long work.
    make_folder(&args.out)?;
    let files = FILES.iter().chain([&page::PICTURE]);
    files.into_iter().try_for_each(|name| check_writable(&args.out.join(name)))?;
    let (judged, shown) = subject.prepared(args)?;

    let contestants = measured(&judged, ours, args);
    let all: Vec<MethodFigures> = contestants.iter().map(|one| one.figures(&judged)).collect();
    print_rows(&all, format.unwrap_or(Format::Text))?;

    let mut pose_table = PoseTable::new();
    for (name, replies) in contestants.iter().map(MethodContestant::replies) {
        pose_table.add(name, replies, &judged.truths);
    }
    let patience = Duration::from_secs_f64(args.patience);
    let rest: Vec<Rested> = args
        .budgets
        .0
        .iter()
        .flat_map(|&budget| rested(&judged.motion, budget, patience))
        .collect();
    let chart = chart::of_methods(&all)?;
    let page = page::page(&shown, &judged, &all, &chart)?;
    let mut texts = vec![table::csv(&all), pose_table.csv().to_owned(), chart, page];
    if !rest.is_empty() {
        texts.extend([refinement::csv(&rest), chart::of_rest(&rest)?]);
    }
    FILES.iter().zip(texts).try_for_each(|(name, text)| write(&args.out.join(name), &text))
}

/// What is measured.
enum Subject {
    Scene(Box<LoadedScene>),
    /// Two meshes, at poses.
    Pair(Motion),
}

impl Subject {
    fn read(args: &AccuracyArgs) -> Result<Self, Failure> {
        let Some((mesh_b, poses)) = args.mesh_b.as_ref().zip(args.poses.as_ref()) else {
            let options = args.set.load_options(None);
            return Ok(Self::Scene(Box::new(scene_file::load(&args.subject, &options)?)));
        };
        if let Some(setting) = args.set.settings.first() {
            return Err(Failure::input(format!(
                "--set {setting}: it is for scenes, and {} and {} are meshes. Leave it out.",
                args.subject.display(),
                mesh_b.display()
            )));
        }
        let poses = read_poses(poses)?;
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        let a = model_file::load(&args.subject, args.scale_a, &options)?;
        let b = model_file::load(mesh_b, args.scale_b, &options)?;
        Ok(Self::Pair(Motion::of_pair([a, b], &poses)))
    }

    /// The poses, with what is so at each, and what the page says of them.
    fn prepared(self, args: &AccuracyArgs) -> Result<(Judged, PageSubject), Failure> {
        let (motion, shown, source) = match self {
            Self::Scene(scene) => {
                let (motion, shown) = PageSubject::of_scene(&scene, args)?;
                (motion, shown, format!("scene {}", scene.path.display()))
            }
            Self::Pair(motion) => {
                let poses = args.poses.as_deref().unwrap_or(Path::new(""));
                (motion, PageSubject::of_pair(args), format!("pose file {}", poses.display()))
            }
        };
        let judged = motion.judged().map_err(|error| Failure::input(format!("{source}: {error}")));
        Ok((judged?, shown))
    }
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

/// Runs all in rounds.
fn measured(judged: &Judged, ours: Vec<Ours>, args: &AccuracyArgs) -> Vec<MethodContestant> {
    let patience = Duration::from_secs_f64(args.patience);
    let bar = progress::bar(ours.len() as u64, "trying");
    let mut all: Vec<MethodContestant> = Vec::new();
    for method in ours {
        all.push(MethodContestant::ours(judged, method, patience));
        bar.inc(1);
    }
    bar.finish_and_clear();
    for kind in if args.no_peers { &[][..] } else { &Peer::KINDS[..] } {
        let spinner = progress::spinner(format!("preparing {}", kind.name()));
        all.push(MethodContestant::peer(judged, *kind, patience));
        spinner.finish_and_clear();
    }
    let runs = args.runs.get();
    let bar = progress::bar(u64::from(runs) * all.len() as u64, "measuring");
    for _ in 0..runs {
        for one in &mut all {
            one.run(&judged.motion);
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
