//! What accuracy costs, for somebody who never saw the project: the question, a picture, the plot,
//! what follows from it, the tables, and how to do it again.

use std::fs;
use std::path::Path;

use cranny_ecs::{PictureOptions, RunOptions, SceneApp};
use cranny_rapier::Detector;
use cranny_scene::LoadedScene;
use cranny_world::description::Effect;

use super::chart::percent;
use super::conclusion::paragraphs;
use super::figures::MethodFigures;
use super::motion::Judged;
use super::panel::Panel;
use crate::args::{AccuracyArgs, InsteadArgs};
use crate::compare::{self, RunFigures, figures, simulated};
use crate::failure::Failure;
use crate::page::Page;
use crate::png::first_picture;
use crate::run::failure;

/// The picture of a scene, in the folder of the report.
const PICTURE: &str = "scene.png";

/// What is measured, as a page shows it.
pub(super) struct PageSubject {
    title: String,
    /// Where the poses come from.
    source: String,
    command: String,
    /// A PNG, or why there is none.
    picture: Result<Vec<u8>, String>,
    /// The motion under each detector.
    runs: Vec<RunFigures>,
}

impl PageSubject {
    /// Two meshes.
    pub(super) fn of_pair(args: &AccuracyArgs) -> Self {
        let name = |path: &Path| {
            path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned())
        };
        let b = args.mesh_b.as_deref().map(name).unwrap_or_default();
        let poses = args.poses.as_deref().map(name).unwrap_or_default();
        let a = name(&args.subject);
        Self {
            title: format!("{a} and {b}"),
            source: format!("The poses are those of {poses}."),
            command: format!("cranny accuracy {a} {b} --poses {poses} --out DIR"),
            picture: Err("Two meshes without a scene have no picture.".to_owned()),
            runs: Vec::new(),
        }
    }

    /// A scene, run once more for its picture and under each detector.
    ///
    /// # Errors
    ///
    /// A run of ours that failed; a picture that cannot be written.
    pub(super) fn of_scene(scene: &LoadedScene, args: &AccuracyArgs) -> Result<Self, Failure> {
        let name = scene.path.file_name().unwrap_or(scene.path.as_os_str()).to_string_lossy();
        let duration = args.duration.map_or(String::new(), |s| format!(" --duration {s}"));
        let contests: Vec<(Detector, bool)> = match (responds(scene), args.no_peers) {
            (false, _) => Vec::new(),
            (true, true) => vec![(Detector::Cranny, true)],
            (true, false) => Detector::ALL.map(|detector| (detector, true)).to_vec(),
        };
        let instead = InsteadArgs { duration: args.duration, dt: None, seed: None };
        Ok(Self {
            title: scene.description.name.replace('_', " "),
            source: format!(
                "The poses are those of the scene {name}, of every pair of bodies whose boxes overlap while it runs."
            ),
            command: format!("cranny accuracy {name}{duration} --out DIR"),
            picture: picture(scene, args)?,
            runs: match contests.is_empty() {
                true => Vec::new(),
                false => simulated(scene, &contests, &instead, false)?,
            },
        })
    }
}

/// Whether a solver moves something.
fn responds(scene: &LoadedScene) -> bool {
    let description = &scene.description;
    let of_bodies = description.bodies.iter().flat_map(|body| &body.effects);
    let of_pairs = description.pairs.iter().flat_map(|pair| &pair.effects);
    let mut all = description.effects.iter().chain(of_bodies).chain(of_pairs);
    all.any(|effect| matches!(effect, Effect::Response))
}

/// The page of views of a run, or why nothing could be drawn.
fn picture(scene: &LoadedScene, args: &AccuracyArgs) -> Result<Result<Vec<u8>, String>, Failure> {
    let path = args.out.join(PICTURE);
    let options = RunOptions {
        duration: args.duration,
        pictures: PictureOptions { preview: Some(path.clone()), ..PictureOptions::default() },
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene.description, &options).map_err(failure)?;
    while app.step().map_err(failure)? {}
    let summary = app.finish().map_err(failure)?;
    if let Some(skipped) = summary.skipped.first() {
        return Ok(Err(format!("{} is missing here: {}", skipped.what, skipped.why)));
    }
    let read = fs::read(&path).map_err(|error| {
        Failure::run(format!("{}: cannot be read back ({error})", path.display()))
    })?;
    Ok(Ok(first_picture(&read).unwrap_or(read)))
}

/// The page as HTML.
///
/// # Errors
///
/// What the drawing library says.
pub(super) fn page(
    shown: &PageSubject,
    judged: &Judged,
    all: &[MethodFigures],
    chart: &str,
) -> Result<String, Failure> {
    let mut page = Page::new(&format!("What accuracy costs in time: {}", shown.title));
    page.paragraph(
        "How near to the truth is an answer about colliding bodies, and how long does it take? \
         Each method below answers the same questions at the same poses, on one thread of one \
         machine, and is judged by the exact answer.",
    );
    match &shown.picture {
        Ok(png) => page.picture(png, &shown.title),
        Err(why) => page.paragraph(why),
    }
    paragraphs(all).iter().for_each(|words| page.emphasis(words));
    page.drawing(
        chart,
        "Lower is more exact, farther left is quicker. Blue, red and orange lines bound the answer: \
         the error is the width of the interval that certainly holds it. Parry gives no bounds: its \
         error is how far it is off. Where bodies overlap, ours answers with whole regions: curves, \
         area, depth. Filled dots keep memory from pose to pose; parry begins anew at each, \
         without the manifolds that rapier would keep.",
    );
    if !shown.runs.is_empty() {
        motion(&mut page, &shown.runs)?;
    }
    page.heading("The figures");
    page.paragraph(&poses(shown, judged));
    let (headings, rows) = table(all);
    page.table(&headings, &rows);
    all.iter()
        .filter_map(|row| Some((row.name.label(), row.note.as_ref()?)))
        .for_each(|(name, note)| page.paragraph(&format!("{name} has no figures: {note}")));
    page.heading("To do it again");
    page.command(&shown.command);
    page.paragraph(
        "accuracy.csv beside this page has all columns, poses.csv every answer, and \
         `cranny accuracy --help` says what they mean.",
    );
    Ok(page.html())
}

fn motion(page: &mut Page, runs: &[RunFigures]) -> Result<(), Failure> {
    page.heading("What it does to the motion");
    page.paragraph(
        "The whole scene under each detector, with the same solver: what a step takes, and what \
         becomes of the bodies. Depths are exact answers at the poses that each detector led to.",
    );
    if let Some(svg) = compare::chart::outcome(runs)? {
        page.drawing(
            &svg,
            "Lower is shallower, farther left is quicker. A detector under which a body lay wholly \
             within another, or left the world, has no mark.",
        );
    }
    let (headings, rows) = figures::columns(runs);
    page.table(&headings, &rows);
    figures::notes(runs).iter().for_each(|note| page.paragraph(note));
    Ok(())
}

fn poses(shown: &PageSubject, judged: &Judged) -> String {
    let (truths, pairs) = (&judged.truths, judged.motion.pairs().len());
    let overlapping = truths.iter().filter(|truth| !truth.contacts.is_empty()).count();
    let apart = truths.iter().filter(|truth| !truth.meets).count();
    format!(
        "{} There are {} poses of {pairs} {}: apart at {apart}, overlapping at {overlapping}. Errors \
         are shares of the size of the smaller body, from corner to corner of its box.",
        shown.source,
        truths.len(),
        if pairs == 1 { "pair" } else { "pairs" },
    )
}

fn table(all: &[MethodFigures]) -> (Vec<String>, Vec<Vec<String>>) {
    let headings = [
        "method",
        "memory",
        "apart: us",
        "error",
        "wrong",
        "open",
        "overlap: us",
        "error",
        "wrong",
        "open",
    ];
    let row = |row: &MethodFigures| {
        let [apart, overlap] = [&row.apart, &row.overlapping].map(figures_of);
        let memory = if row.name.is_ours() { row.name.memory } else { "" };
        let names = [row.name.label(), memory.to_owned()];
        [&names[..], &apart[..], &overlap[..]].concat()
    };
    let measured = all.iter().filter(|row| row.note.is_none());
    (headings.map(str::to_owned).to_vec(), measured.map(row).collect())
}

/// Time, error, wrong verdicts and open ones.
fn figures_of(panel: &Panel) -> [String; 4] {
    let known = panel.mean_us.zip(panel.error);
    known.map_or_else(Default::default, |(us, error)| {
        let [wrong, open] = [panel.wrong, panel.open].map(|count| count.to_string());
        [format!("{us:.2}"), percent(error), wrong, open]
    })
}
