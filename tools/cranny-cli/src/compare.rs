//! `cranny compare`: one scene under several detectors, in one process, judged by exact answers.
//!
//! All take their steps in turn, so that what else the machine does meets all alike. `contestant`
//! is one of them, `figures` what is reported of it, `chart` the drawing.

pub(crate) mod chart;
mod contestant;
pub(crate) mod figures;

use std::path::Path;
use std::sync::atomic::Ordering;

use cranny_ecs::{
    ContactFields, PluginOptions, RunOptions, SceneAppError, check_outputs, helices, rings,
};
use cranny_rapier::{Detector, SimulationOptions};
use cranny_scene::LoadedScene;
use cranny_world::description::Effect;

use crate::args::{CompareArgs, Format, InsteadArgs, RecyclingArg, SubstepsArg};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{make_folder, write};
use crate::progress;
use crate::run::detector;
use crate::scene_file::load;
use crate::simulation::{failure, stop_flag};
use contestant::DetectorRun;
pub(crate) use figures::{RunFigures, way};

/// What is written into the folder; the last only where bodies overlapped.
const FILES: [&str; 4] = ["compare.csv", "steps.csv", "steps.svg", "compare.svg"];

/// Runs the command.
///
/// # Errors
///
/// Wrong arguments or a wrong scene; a step of ours that failed; files that cannot be written. What
/// a peer cannot do stands in its row.
pub(crate) fn compare(args: &CompareArgs, format: Option<Format>) -> Result<(), Failure> {
    let scene = load(&args.scene, &args.instead.load_options())?;
    let inputs: Vec<&Path> =
        std::iter::once(&*scene.path).chain(scene.files.iter().map(|file| &**file)).collect();
    if let Some(folder) = &args.out {
        make_folder(folder)?;
        let outputs = FILES.map(|name| folder.join(name));
        check_outputs(&outputs.each_ref().map(|path| &**path), &inputs).map_err(failure)?;
    }
    let wanted = if args.detector.is_empty() {
        Detector::ALL.to_vec()
    } else {
        each_once(args.detector.iter().map(|&argument| detector(argument)))
    };
    let ways = ways(args.recycling);
    let contests = wanted.iter().flat_map(|kind| ways.iter().map(|way| (*kind, *way)));
    let contests: Vec<(Detector, bool)> = contests.collect();
    let own_substeps = matches!(args.substeps, SubstepsArg::Own);
    let rows = simulated(&scene, &contests, &args.instead, own_substeps)?;
    print_rows(&title(&scene, &args.instead), &rows, format.unwrap_or(Format::Text))?;
    if let Some(folder) = &args.out {
        write(&folder.join(FILES[0]), &figures::csv(&rows))?;
        write(&folder.join(FILES[1]), &figures::steps_csv(&rows))?;
        let chart = chart::drawn(&scene.description.name, &rows)?;
        write(&folder.join(FILES[2]), &chart)?;
        if let Some(chart) = chart::outcome(&rows)? {
            write(&folder.join(FILES[3]), &chart.svg)?;
        }
    }
    Ok(())
}

/// Runs a scene under detectors, each with or without recycling of contacts, in turns.
///
/// # Errors
///
/// A wrong scene; a step of ours that failed. What a peer cannot do stands in its row.
pub(crate) fn simulated(
    scene: &LoadedScene,
    contests: &[(Detector, bool)],
    instead: &InsteadArgs,
    own_substeps: bool,
) -> Result<Vec<RunFigures>, Failure> {
    let mut description = scene.description.clone();
    // Depths are exact answers at the poses that each detector led to. They are found also where
    // the scene reports no contacts.
    if !description.effects.iter().any(|effect| matches!(effect, Effect::Contacts { .. })) {
        description.effects.push(Effect::Contacts { margin: 0.0 });
    }
    let step = instead.dt.unwrap_or(description.step);
    let substeps = (!own_substeps).then(|| SimulationOptions::substeps_for(step));
    let (helices, rings) = (helices(scene), rings(scene));
    let mut contestants = Vec::new();
    for &(kind, recycling) in contests {
        let spinner = progress::spinner(format!("preparing {kind}"));
        let options = RunOptions {
            plugins: PluginOptions {
                detector: kind,
                recycling: Some(recycling),
                substeps,
                helices: helices.clone(),
                rings: rings.clone(),
                // The judge reads depths of regions, which say how deep a failed peer is.
                detects_beside: true,
                contact_fields: ContactFields { depth: Some(0.0), regions: true, points: false },
                ..PluginOptions::default()
            },
            step: instead.dt,
            duration: instead.duration,
            source: Some(scene.source_text.clone()),
            ..RunOptions::default()
        };
        let contestant = DetectorRun::new(&description, &options);
        spinner.finish_and_clear();
        let contestant = contestant.map_err(failure)?;
        if !contestant.has_solver() {
            return Err(Failure::input(format!(
                "scene file {}: nothing in it responds to anything, so all detectors would give the same. Ask for the effect Response().",
                scene.path.display()
            )));
        }
        contestants.push(contestant);
    }
    in_turns(contestants)
}

/// Steps all to their ends.
fn in_turns(mut contestants: Vec<DetectorRun>) -> Result<Vec<RunFigures>, Failure> {
    // Until here Ctrl-C ends the command at once: nothing is lost.
    let stop = stop_flag();
    let steps = contestants.iter().map(DetectorRun::steps_total).max().unwrap_or(0);
    let bar = progress::bar(steps, "simulating");
    for _ in 0..steps {
        if stop.load(Ordering::Relaxed) {
            contestants.iter_mut().for_each(DetectorRun::interrupt);
            break;
        }
        for contestant in &mut contestants {
            contestant.step().map_err(failure)?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    contestants
        .into_iter()
        .map(DetectorRun::finish)
        .collect::<Result<Vec<RunFigures>, SceneAppError>>()
        .map_err(failure)
}

/// Whoever is named twice runs once, where it was named first.
fn each_once(named: impl Iterator<Item = Detector>) -> Vec<Detector> {
    let mut detectors = Vec::new();
    for detector in named {
        if !detectors.contains(&detector) {
            detectors.push(detector);
        }
    }
    detectors
}

/// With which recycling of contacts each detector runs.
fn ways(wanted: RecyclingArg) -> &'static [bool] {
    match wanted {
        RecyclingArg::On => &[true],
        RecyclingArg::Off => &[false],
        RecyclingArg::Both => &[true, false],
    }
}

/// What all rows have in common.
fn title(scene: &LoadedScene, instead: &InsteadArgs) -> String {
    let LoadedScene { description, path, .. } = scene;
    let step = instead.dt.unwrap_or(description.step);
    let duration = instead.duration.unwrap_or(description.duration);
    format!(
        "{} ({}, seed {}): {duration} s in steps of {step:.6} s",
        description.name,
        path.display(),
        description.seed
    )
}

fn print_rows(title: &str, rows: &[RunFigures], format: Format) -> Result<(), Failure> {
    let mut output = Output::new();
    match format {
        Format::Json => rows.iter().try_for_each(|row| output.json(row)),
        Format::Text => output.line(&format!(
            "{title}\n\n{}\n\n`cranny compare --help` explains the columns",
            figures::text(rows)
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_named_twice_runs_once() {
        let named = [Detector::RapierTrimesh, Detector::Cranny, Detector::RapierTrimesh];
        assert_eq!(each_once(named.into_iter()), named[..2]);
    }
}
