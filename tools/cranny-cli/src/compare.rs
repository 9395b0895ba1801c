//! `cranny compare`: one scene under several detectors, in one process, judged by exact answers.
//!
//! All take their steps in turn, so that what else the machine does meets all alike. `contestant`
//! is one of them, `figures` what is reported of it, `chart` the drawing.

mod chart;
mod contestant;
mod figures;

use std::path::Path;
use std::sync::atomic::Ordering;

use cranny_ecs::{
    ContactFields, PluginOptions, RunOptions, SceneAppError, check_outputs, helices, rings,
};
use cranny_rapier::{Detector, SimulationOptions};
use cranny_world::description::Effect;

use crate::args::{CompareArgs, Format, RecyclingArg, SubstepsArg};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{make_folder, write};
use crate::progress;
use crate::run::{detector, failure, stop_flag};
use crate::scene_file::load;
use contestant::DetectorRun;
use figures::RunFigures;

/// What is written into the folder.
const FILES: [&str; 3] = ["compare.csv", "steps.csv", "compare.svg"];

/// Runs the command.
///
/// # Errors
///
/// Wrong arguments or a wrong scene; a step of ours that failed; files that cannot be written. What
/// a peer cannot do stands in its row.
pub(crate) fn compare(args: &CompareArgs, format: Option<Format>) -> Result<(), Failure> {
    let mut scene = load(&args.scene, args.instead.seed)?;
    let (helices, rings) = (helices(&scene), rings(&scene));
    let inputs: Vec<&Path> =
        std::iter::once(&*scene.path).chain(scene.files.iter().map(|file| &**file)).collect();
    if let Some(folder) = &args.out {
        make_folder(folder)?;
        let outputs = FILES.map(|name| folder.join(name));
        check_outputs(&outputs.each_ref().map(|path| &**path), &inputs).map_err(failure)?;
    }
    // Depths are exact answers at the poses that each detector led to, whatever the scene asks to
    // be reported.
    let description = &mut scene.description;
    if !description.effects.iter().any(|effect| matches!(effect, Effect::Contacts { .. })) {
        description.effects.push(Effect::Contacts { margin: 0.0 });
    }

    let wanted = if args.detector.is_empty() {
        Detector::ALL.to_vec()
    } else {
        each_once(args.detector.iter().map(|&argument| detector(argument)))
    };
    let step = args.instead.dt.unwrap_or(description.step);
    let substeps = match args.substeps {
        SubstepsArg::Same => Some(SimulationOptions::substeps_for(step)),
        SubstepsArg::Own => None,
    };
    let mut contestants = Vec::new();
    let ways = ways(args.recycling);
    for (kind, recycling) in wanted.iter().flat_map(|kind| ways.iter().map(|way| (*kind, *way))) {
        let spinner = progress::spinner(format!("preparing {kind}"));
        let options = RunOptions {
            plugins: PluginOptions {
                detector: kind,
                recycling: Some(recycling),
                substeps,
                helices: helices.clone(),
                rings: rings.clone(),
                // The judge reads depths of regions, which tell how deep a failed peer is.
                contact_fields: ContactFields { depth: Some(0.0), regions: true, points: false },
                ..PluginOptions::default()
            },
            step: args.instead.dt,
            duration: args.instead.duration,
            source: Some(scene.source_text.clone()),
            ..RunOptions::default()
        };
        let contestant = DetectorRun::new(description, &options);
        spinner.finish_and_clear();
        let contestant = contestant.map_err(failure)?;
        if !contestant.has_solver() {
            return Err(Failure::input(format!(
                "scene file {}: nothing in it responds to anything, so all detectors would give the same. Ask for the effect Response().",
                args.scene.display()
            )));
        }
        contestants.push(contestant);
    }
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
    let rows = contestants
        .into_iter()
        .map(DetectorRun::finish)
        .collect::<Result<Vec<RunFigures>, SceneAppError>>()
        .map_err(failure)?;
    print_rows(&rows, format.unwrap_or(Format::Text))?;
    if let Some(folder) = &args.out {
        write(&folder.join(FILES[0]), &figures::csv(&rows))?;
        write(&folder.join(FILES[1]), &figures::steps_csv(&rows))?;
        let chart = chart::drawn(&description.name, &rows)?;
        write(&folder.join(FILES[2]), &chart)?;
    }
    Ok(())
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

fn print_rows(rows: &[RunFigures], format: Format) -> Result<(), Failure> {
    let mut output = Output::new();
    match format {
        Format::Json => rows.iter().try_for_each(|row| output.json(row)),
        Format::Text => output.line(&figures::text(rows)),
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
