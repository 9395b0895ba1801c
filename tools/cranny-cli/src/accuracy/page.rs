//! What accuracy costs, for somebody who never saw the project: the question, a picture, the plot,
//! what follows from it, the tables, and how to do it again.

use std::path::Path;

use cranny_ecs::DeepestSummary;
use cranny_rapier::Detector;
use cranny_scene::LoadedScene;
use cranny_world::description::Effect;

use super::chart::{percent, rounded};
use super::conclusion::{about_pieces, ladder, paragraphs};
use super::figures::{MethodFigures, quantile};
use super::method::Name;
use super::motion::{Judged, Motion};
use super::motion_words::{PeersApart, Sizes, paragraphs as paragraphs_of_motion, part, smaller};
use super::panel::Panel;
use super::truth::Truth;
use crate::args::{AccuracyArgs, InsteadArgs, SetArgs};
use crate::compare::chart::Outcome;
use crate::compare::{self, RunFigures, figures, simulated};
use crate::failure::Failure;
use crate::page::Page;
use crate::png::first_picture;

/// The picture of a scene, in the folder of the report.
pub(super) const PICTURE: &str = "scene.png";

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
    sizes: Sizes,
}

impl PageSubject {
    /// Two meshes.
    pub(super) fn of_pair(args: &AccuracyArgs) -> Self {
        let b = args.mesh_b.as_deref().map(file_name).unwrap_or_default();
        let poses = args.poses.as_deref().map(file_name).unwrap_or_default();
        let a = file_name(&args.subject);
        Self {
            title: format!("{a} and {b}"),
            source: format!("The poses are those of {poses}."),
            command: command(),
            picture: Err("Two meshes without a scene have no picture.".to_owned()),
            runs: Vec::new(),
            sizes: Sizes::new(),
        }
    }

    /// A scene: the poses and the picture of a run, and its motion under each detector.
    ///
    /// # Errors
    ///
    /// A run of ours that failed; a picture that cannot be written.
    pub(super) fn of_scene(
        scene: &LoadedScene,
        args: &AccuracyArgs,
    ) -> Result<(Motion, Self), Failure> {
        let name = scene.path.file_name().unwrap_or(scene.path.as_os_str()).to_string_lossy();
        let (motion, picture) = Motion::of_scene(scene, args.duration, &args.out.join(PICTURE))?;
        let detectors: &[Detector] = match (responds(scene), args.no_peers) {
            (false, _) => &[],
            (true, true) => &[Detector::Cranny],
            (true, false) => &Detector::ALL,
        };
        // Without the exact shapes no motion is compared, and without levels none is wanted.
        let levels: &[Detector] =
            if detectors.is_empty() || args.levels.0.is_empty() { &[] } else { &Detector::LEVELS };
        let contests = detectors.iter().chain(levels).map(|&detector| (detector, true));
        let contests: Vec<(Detector, bool)> = contests.collect();
        let instead =
            InsteadArgs { duration: args.duration, dt: None, seed: None, set: SetArgs::default() };
        let shown = Self {
            title: scene.description.name.replace('_', " "),
            source: format!(
                "The poses are those of the scene {name}, of every pair of bodies whose boxes overlap while it runs."
            ),
            command: command(),
            picture: picture.map(|png| first_picture(&png).unwrap_or(png)),
            runs: match contests.is_empty() {
                true => Vec::new(),
                false => simulated(scene, &contests, &instead, false)?,
            },
            sizes: scene
                .description
                .bodies
                .iter()
                .map(|body| (body.name.clone(), body.collision.bounds().diagonal()))
                .collect(),
        };
        Ok((motion, shown))
    }
}

/// Whether a solver moves something.
fn responds(scene: &LoadedScene) -> bool {
    scene.description.all_effects().any(|effect| matches!(effect, Effect::Response))
}

/// The command as it was given, but for where files lie.
fn command() -> String {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |(i, word): (usize, &String)| match i.checked_sub(1).map(|before| &*words[before]) {
        Some("--out") => "DIR".to_owned(),
        _ if word.starts_with("--out=") => "--out=DIR".to_owned(),
        _ => file_name(Path::new(word)),
    };
    let all: Vec<String> = words.iter().enumerate().map(word).collect();
    format!("cranny {}", all.join(" "))
}

/// The last part of a path; a word that is no path is one.
fn file_name(path: &Path) -> String {
    path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned())
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
         machine, and is judged by the exact answer. 'Ours' is cranny, the detector that this page \
         is about; parry is another library of collision detection, which answers on the triangles \
         too, or on convex pieces that stand for them.",
    );
    match &shown.picture {
        Ok(png) => page.picture(png, &shown.title),
        Err(why) => page.paragraph(why),
    }
    paragraphs(all).iter().for_each(|words| page.emphasis(words));
    about_pieces(all, typical(judged), &shown.runs).iter().for_each(|words| page.emphasis(words));
    page.heading("What ten times less error costs");
    let (headings, rows) = ladder(all);
    page.table(&headings, &rows);
    page.paragraph(
        "The least time in which ours keeps within an error on average, by level or by budget; \
         errors are shares of the size of the smaller body.",
    );
    page.heading("Time against error");
    page.drawing(
        chart,
        "Lower is more exact, farther left is quicker. Ours bound the answer: the error is the width \
         of the interval that certainly holds it. Parry gives no bounds: its error is how far it is \
         off. Where bodies overlap, ours answers with whole regions: curves, area, depth. Parry \
         begins anew at each pose, without the manifolds that rapier would keep. Filled marks of \
         ours keep what they found at the pose before (warm), hollow ones begin anew (cold). \
         Triangles, where there are any, are means over fewer poses: a method that is too slow for \
         all answers at some of them, evenly spread.",
    );
    if !shown.runs.is_empty() {
        let panel = |method| all.iter().find(|row| row.name.method == method).map(|row| row.apart);
        let peers = panel("parry-trimesh").zip(panel("parry-decomposition"));
        let peers = peers.map(|(mesh, pieces)| PeersApart { mesh, pieces });
        motion(&mut page, shown, peers.as_ref())?;
    }
    page.heading("The figures");
    page.paragraph(&poses(shown, judged));
    open(all).iter().for_each(|words| page.paragraph(words));
    let (headings, rows) = table(all);
    page.table(&headings, &rows);
    all.iter()
        .filter_map(|row| Some((row.name.label(), row.note.as_ref()?)))
        .for_each(|(name, note)| page.paragraph(&format!("{name} has no figures: {note}")));
    page.heading("Words");
    page.glossary(&WORDS);
    page.heading("To do it again");
    page.command(&shown.command);
    page.paragraph(
        "accuracy.csv beside this page has all columns, poses.csv every answer, and \
         `cranny accuracy --help` says what they mean.",
    );
    Ok(page.html())
}

/// Words of the tables and drawings.
const WORDS: [(&str, &str); 13] = [
    (
        "cranny, ours",
        "the detector that this page is about; parry is a library of collision detection, and \
         rapier an engine of rigid bodies that uses it",
    ),
    ("exact", "what the triangles really make, decided without tolerance"),
    (
        "boxes, hulls, caps, tree:N",
        "levels of ours: each body is answered for by its box, by its convex hull, by its hull and \
         the faces on it, or by a tree of boxes down to depth N; the answer is an interval",
    ),
    (
        "N tests, N µs",
        "budgets of ours: the exact search, ended after so many elementary tests or microseconds; \
         the answer is an interval. The clock is read between steps of the search, and a single one \
         may take longer",
    ),
    (
        "warm, cold",
        "with what was kept from the pose before, and without: keeping takes time, and pays where \
         bodies move little between poses",
    ),
    (
        "error",
        "how far any length that the answer allows is from the true one, mean over the poses; \
         'none here' is of methods that do not promise to be exact",
    ),
    (
        "wrong",
        "poses at which a method says that bodies meet which do not, or the other way round; gaps \
         that are smaller than a small error suffice",
    ),
    (
        "open",
        "poses at which the interval of a length leaves open whether the bodies meet: no answer to \
         that question, and neither right nor wrong",
    ),
    (
        "poses",
        "at how many of the poses of a kind the method answered, where there was no time for all",
    ),
    (
        "parry-trimesh, parry-decomposition",
        "Parry's triangle mesh, and its convex pieces; rapier-trimesh and rapier-decomposition are \
         the same in rapier, and rapier-trimesh-fixed corrects normals at inner edges",
    ),
    (
        "rapier-boxes, rapier-hulls, rapier-tree",
        "what a level of ours knows of a body, given to rapier in place of its mesh: the box, the \
         convex hull, the boxes of a tree",
    ),
    (
        "energy % gained, at end",
        "the most that motion and height hold beyond the beginning, and what they hold at the end, \
         in percent of what the scene can set free",
    ),
    (
        "ready, carried",
        "seconds until the first step; percentage of pairs whose contacts went on from the step \
         before without a search",
    ),
];

fn motion(page: &mut Page, shown: &PageSubject, peers: Option<&PeersApart>) -> Result<(), Failure> {
    let PageSubject { runs, sizes, .. } = shown;
    page.heading("What it does to the motion");
    let is_level =
        |run: &RunFigures| Detector::LEVELS.map(|d| d.name()).contains(&run.setting.detector);
    let has_levels = runs.iter().any(is_level);
    let levels = "Three rows give the solver what a level knows in place of the meshes: their \
                  boxes, their hulls, the boxes of their trees. ";
    page.paragraph(&format!(
        "The whole scene under each detector, with the same solver: what a step takes, and what \
         becomes of the bodies. {}Depths are exact answers at the poses that each detector led to.",
        if has_levels { levels } else { "" },
    ));
    paragraphs_of_motion(runs, sizes, peers).iter().for_each(|words| page.emphasis(words));
    if let Some(Outcome { svg, unmarked }) = compare::chart::outcome(runs)? {
        let missing = match unmarked.is_empty() {
            true => String::new(),
            false => format!(" Without a mark: {}.", unmarked.join(", ")),
        };
        page.drawing(
            &svg,
            &format!(
                "Lower is shallower, farther left is quicker. Overlaps of less than a 100,000th of \
                 the deepest count as none.{missing}"
            ),
        );
    }
    let (headings, rows) = figures::columns(runs);
    page.table(&headings, &rows);
    page.paragraph("Where that was, and who moved:");
    let (headings, rows) = places(runs, sizes);
    page.table(&headings, &rows);
    runs.iter().flat_map(RunFigures::troubles).for_each(|note| page.paragraph(&note));
    Ok(())
}

/// Of each run the deepest overlap, and the body that moved farthest.
fn places(runs: &[RunFigures], sizes: &Sizes) -> (Vec<String>, Vec<Vec<String>>) {
    let headings = [
        "detector",
        "deepest overlap",
        "of the smaller",
        "between",
        "at s",
        "moved farthest",
        "by (x, y, z)",
    ];
    let row = |run: &RunFigures| {
        let mut cells = vec![run.name()];
        cells.extend(match run.deepest.as_ref() {
            Some(DeepestSummary { depth, a, b, step }) if *depth > 0.0 => {
                let size = smaller(sizes, [a, b]);
                [
                    rounded(*depth).to_string(),
                    size.map_or(String::new(), |size| part(depth / size)),
                    format!("{a}, {b}"),
                    run.dt.map_or(String::new(), |dt| format!("{:.3}", dt * *step as f64)),
                ]
            }
            Some(_) => ["none".to_owned(), String::new(), String::new(), String::new()],
            None => Default::default(),
        });
        cells.extend(run.farthest.as_ref().map_or_else(Default::default, |motion| {
            let [x, y, z] = motion.displacement;
            [motion.body.clone(), format!("({x:.3}, {y:.3}, {z:.3})")]
        }));
        cells
    };
    (headings.map(str::to_owned).to_vec(), runs.iter().map(row).collect())
}

/// How many answers left open whether bodies meet; `None` where none did.
fn open(all: &[MethodFigures]) -> Option<String> {
    let counts = |row: &MethodFigures| {
        let open = row.apart.open + row.overlapping.open;
        (open, row.apart.poses + row.overlapping.poses)
    };
    let measured = || all.iter().filter(|row| row.note.is_none());
    let (open, answers) = measured()
        .map(counts)
        .fold((0, 0), |(open, all), (its_open, its_all)| (open + its_open, all + its_all));
    let share = |row: &MethodFigures| counts(row).0 as f64 / counts(row).1.max(1) as f64;
    let whole = measured().filter(|row| share(row) == 1.0).count();
    let worst = measured().max_by(|a, b| share(a).total_cmp(&share(b)))?;
    let most = match whole {
        _ if open == 0 => return None,
        0 => {
            let (open, answers) = counts(worst);
            let Name { memory, .. } = worst.name;
            format!("{}, {memory}, has most: {open} of {answers}", worst.name.label())
        }
        whole => format!("{whole} of {} methods leave every pose open", measured().count()),
    };
    Some(format!(
        "An open pose has no answer whether the bodies meet: the interval allows both. Of {answers} \
         answers in this table {open} are open; {most}."
    ))
}

/// Ascending lengths of the poses that are meant, as shares of the size of the smaller body.
fn shares(judged: &Judged, length: fn(&Truth) -> f64, is_meant: fn(&Truth) -> bool) -> Vec<f64> {
    let meant = judged.truths.iter().enumerate().filter(|(_, truth)| is_meant(truth));
    let all = meant.map(|(i, truth)| length(truth) / judged.motion.posed(i).size());
    let mut all: Vec<f64> = all.collect();
    all.sort_unstable_by(f64::total_cmp);
    all
}

/// Gaps of poses that are apart and depths of those that overlap.
fn gaps_and_depths(judged: &Judged) -> [Vec<f64>; 2] {
    [
        shares(judged, |truth| truth.distance, |truth| !truth.meets),
        shares(judged, |truth| truth.depth, Truth::overlaps),
    ]
}

/// The gap and the depth in the middle.
fn typical(judged: &Judged) -> [Option<f64>; 2] {
    gaps_and_depths(judged).map(|all| quantile(&all, 50))
}

fn poses(shown: &PageSubject, judged: &Judged) -> String {
    let (truths, pairs) = (&judged.truths, judged.motion.pairs().len());
    let share = |all: Vec<f64>| (all.len(), quantile(&all, 50), all.last().copied());
    let reported = |(count, median, most): (usize, Option<f64>, Option<f64>)| {
        let [median, most] = [median, most].map(|share| share.map(part));
        match median.zip(most) {
            None => format!("at {count}"),
            Some((median, most)) => {
                format!("at {count}, by {median} in the middle and {most} at most")
            }
        }
    };
    let [apart, overlapping] = gaps_and_depths(judged).map(share);
    format!(
        "{} There are {} poses of {pairs} {}: apart {}; overlapping {}. Lengths and errors are \
         shares of the size of the smaller body, from corner to corner of its box.",
        shown.source,
        truths.len(),
        if pairs == 1 { "pair" } else { "pairs" },
        reported(apart),
        reported(overlapping),
    )
}

fn table(all: &[MethodFigures]) -> (Vec<String>, Vec<Vec<String>>) {
    let kind = |kind: &str| {
        [format!("{kind}: poses"), format!("{kind}: µs"), format!("{kind}: error")]
            .into_iter()
            .chain(["wrong", "open"].map(str::to_owned))
            .collect::<Vec<String>>()
    };
    let names = ["method", "memory"].map(str::to_owned).to_vec();
    let headings = [names, kind("apart"), kind("overlap")].concat();
    let row = |row: &MethodFigures| {
        let of_panel = |panel| figures_of(panel, row.name.is_exact());
        let [apart, overlap] = [&row.apart, &row.overlapping].map(of_panel);
        let memory = if row.name.is_ours() { row.name.memory } else { "" };
        let names = [row.name.label(), memory.to_owned()];
        [&names[..], &apart[..], &overlap[..]].concat()
    };
    let measured = all.iter().filter(|row| row.note.is_none());
    (headings, measured.map(row).collect())
}

/// Poses, time, error, wrong verdicts and open ones. A method that does not promise to be exact may
/// show no error at these poses.
fn figures_of(panel: &Panel, is_exact: bool) -> [String; 5] {
    let known = panel.mean_us.zip(panel.error);
    known.map_or_else(Default::default, |(us, error)| {
        let [wrong, open] = [panel.wrong, panel.open].map(|count| count.to_string());
        let error = if error == 0.0 && !is_exact { "none here".to_owned() } else { percent(error) };
        let Panel { poses, poses_all, .. } = panel;
        let poses = match panel.is_partial() {
            true => format!("{poses} of {poses_all}"),
            false => poses.to_string(),
        };
        [poses, format!("{us:.2}"), error, wrong, open]
    })
}
