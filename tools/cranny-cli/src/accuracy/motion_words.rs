//! What the motion says of the detectors: who is quickest, under whom bodies sink deepest, whose
//! motion is another.
//!
//! There is no truth about a motion but that bodies do not overlap, that links and threads hold,
//! and that nobody leaves the world. What else differs is given as a distance from where our
//! detector leads.

use std::collections::BTreeMap;

use super::chart::rounded;
use super::conclusion::{capital, times};
use super::panel::Panel;
use crate::compare::{RunFigures, way};
use crate::words::counted;

/// Sizes of bodies by their names: from corner to corner of their boxes.
pub(super) type Sizes = BTreeMap<String, f64>;

const OURS: &str = "cranny";
const PIECES: &str = "rapier-decomposition";

/// Turns of a nut that differ by less than this share are called alike.
const ALIKE: f64 = 0.05;

/// Shares below this are rounding.
const TRACE: f64 = 1e-7;

/// What parry says where bodies are apart.
#[derive(Clone, Copy)]
pub(super) struct PeersApart {
    pub(super) mesh: Panel,
    pub(super) pieces: Panel,
}

impl PeersApart {
    /// Returns whether convex pieces mostly overlap where bodies are apart. Where triangle meshes
    /// do so too, gaps are smaller than single precision resolves.
    fn fills_gaps(&self) -> bool {
        let Self { mesh, pieces } = self;
        2 * pieces.wrong > pieces.poses && 10 * mesh.wrong <= mesh.poses
    }
}

/// What follows, a paragraph each.
pub(super) fn paragraphs(
    runs: &[RunFigures],
    sizes: &Sizes,
    apart: Option<&PeersApart>,
) -> Vec<String> {
    let ours = runs.iter().find(|run| run.setting.detector == OURS);
    let costs = [quickest(runs), depths(runs, sizes), choice(runs, ours, sizes)];
    let outcomes = [troubles(runs), turns(runs), ends(runs, ours, sizes), filled(runs, apart)];
    let joined = |sentences: Vec<String>| sentences.join(" ");
    [costs.into_iter().flatten().collect(), outcomes.into_iter().flatten().collect()]
        .map(joined)
        .into_iter()
        .filter(|words| !words.is_empty())
        .collect()
}

/// Who is quickest and who slowest, of those that came to the end.
fn quickest(runs: &[RunFigures]) -> Option<String> {
    let timed = |run: &&RunFigures| run.failure.is_none() && run.step_ms.is_some();
    let mut all: Vec<(f64, String)> =
        runs.iter().filter(timed).filter_map(|run| Some((run.step_ms?.mean, run.name()))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(least, first), .., (most, last)] = &all[..] else { return None };
    let mut words = format!("A step is quickest under {first}: {} ms on average", rounded(*least));
    if let Some((own, _)) = all.iter().find(|(_, name)| name == OURS && name != first) {
        words += &format!("; under {OURS} it takes {} times as long", times(own / least));
    }
    if last != OURS {
        words += &format!("; under {last}, the slowest, {} times", times(most / least));
    }
    Some(words + ".")
}

/// A detector's deepest overlap, where that says how far bodies sank.
fn depth(run: &RunFigures) -> Option<f64> {
    let whole = run.failure.is_none() && run.contained.is_none() && run.left.is_empty();
    run.deepest.as_ref().filter(|_| whole).map(|deepest| deepest.depth)
}

/// Under whom bodies sink deepest, and under whom least.
fn depths(runs: &[RunFigures], sizes: &Sizes) -> Option<String> {
    let known = || runs.iter().filter_map(|run| Some((depth(run)?, run)));
    let (most, worst) = known().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let (least, _) = known().min_by(|a, b| a.0.total_cmp(&b.0))?;
    if known().count() < 2 {
        return None;
    }
    let deepest = worst.deepest.as_ref()?;
    if most == 0.0 {
        return Some("Bodies overlap under none of them.".to_owned());
    }
    let best = listed(known().filter(|(depth, _)| *depth == least).map(|(_, run)| run.name()));
    let [a, b] = [&deepest.a, &deepest.b];
    let place = format!("between {a} and {b}, by {}{}", rounded(most), share(most, sizes, [a, b]));
    let least = match least == 0.0 {
        true => "not at all".to_owned(),
        false => format!("by {} at most", rounded(least)),
    };
    let aside = runs.iter().filter(|run| depth(run).is_none()).map(RunFigures::name);
    let aside = listed(aside);
    let aside = if aside.is_empty() { aside } else { format!(", {aside} aside") };
    Some(format!(
        "Bodies sink deepest into each other under {}{aside}: {place}; least under {best}: {least}.",
        worst.name()
    ))
}

/// The size of the smaller of two bodies.
pub(super) fn smaller(sizes: &Sizes, names: [&str; 2]) -> Option<f64> {
    let [a, b] = names.map(|name| sizes.get(name).copied());
    Some(a?.min(b?))
}

/// A share of a length, which is not called exact where it is small.
pub(super) fn part(share: f64) -> String {
    if share > 0.0 && share < TRACE {
        "a trace".to_owned()
    } else {
        format!("{} %", rounded(100.0 * share))
    }
}

/// A length beside the size of the smaller of two bodies, in brackets.
fn share(length: f64, sizes: &Sizes, names: [&str; 2]) -> String {
    smaller(sizes, names).map_or(String::new(), |size| {
        format!(" ({} of the size of the smaller)", part(length / size))
    })
}

/// The quickest of those that let bodies sink no deeper than ours.
fn choice(runs: &[RunFigures], ours: Option<&RunFigures>, sizes: &Sizes) -> Option<String> {
    let ours = ours?;
    let own = depth(ours)?;
    let parted = |run: &RunFigures| run.links.as_ref().map_or(0, |links| links.parted.len());
    let serves = |run: &&RunFigures| {
        parted(run) <= parted(ours) && depth(run).is_some_and(|depth| depth <= own)
    };
    let others: Vec<&RunFigures> = runs.iter().filter(|run| run.setting.detector != OURS).collect();
    if others.is_empty() {
        return None;
    }
    let serving = others.into_iter().filter(serves).chain([ours]);
    let ms = |run: &RunFigures| run.step_ms.map_or(f64::INFINITY, |step| step.mean);
    let best = serving.clone().min_by(|a, b| ms(a).total_cmp(&ms(b)))?;
    let troubled = runs.iter().any(|run| depth(run).is_none() || parted(run) > 0);
    Some(match (serving.count(), best.setting.detector == OURS) {
        (1, _) if troubled => format!(
            "Under every other detector, bodies sink deeper than under {OURS}, or fare worse, as said \
             below."
        ),
        (1, _) => format!("Under every other detector, bodies sink deeper than under {OURS}."),
        (_, true) => {
            format!(
                "Of those under which bodies sink no deeper than under {OURS}, it is the quickest."
            )
        }
        // A body that cannot get in sinks into nothing: how the motion differs belongs here.
        _ => format!(
            "Of those under which bodies sink no deeper than under {OURS}, {} is the quickest{}.",
            best.name(),
            farthest_off(best, ours).filter(|(off, _)| *off > 0.0).map_or(
                String::new(),
                |(off, body)| {
                    format!(
                        "; under it {body} ends {}{} from where {OURS} leads it",
                        rounded(off),
                        own_share(off, sizes, body)
                    )
                }
            )
        ),
    })
}

/// What must not happen, with the detectors under which it does.
fn troubles(runs: &[RunFigures]) -> Option<String> {
    type Holds = fn(&RunFigures) -> bool;
    let kinds: [(Holds, &str); 4] = [
        (|run| run.failure.is_some(), "The run does not come to its end under"),
        (|run| run.contained.is_some(), "A body lies wholly within another under"),
        (|run| !run.left.is_empty(), "A body leaves the world under"),
        (
            |run| run.links.as_ref().is_some_and(|links| !links.parted.is_empty()),
            "Rings that are linked come apart under",
        ),
    ];
    let sentence = |(holds, words): (Holds, &str)| {
        let names: Vec<String> =
            runs.iter().filter(|run| holds(run)).map(RunFigures::name).collect();
        (!names.is_empty()).then(|| format!("{words} {}.", listed(names.into_iter())))
    };
    let all: Vec<String> = kinds.into_iter().filter_map(sentence).collect();
    (!all.is_empty()).then(|| all.join(" "))
}

/// How far the first nut turns on its bolt.
fn turns(runs: &[RunFigures]) -> Option<String> {
    let all: Vec<(f64, String)> =
        runs.iter().filter_map(|run| Some((run.helices.first()?.turns, run.name()))).collect();
    let helix = runs.iter().find_map(|run| run.helices.first())?;
    let (own, _) = all.iter().find(|(_, name)| name == OURS)?;
    let alike = |turns: f64| (turns - own).abs() <= ALIKE * own.abs();
    let others = || all.iter().filter(|(_, name)| name != OURS);
    let same: Vec<String> =
        others().filter(|(turns, _)| alike(*turns)).map(|(_, name)| name.clone()).collect();
    // To two digits of ours, all alike.
    let places = (1.0 - own.abs().max(0.01).log10().floor()) as usize;
    let said = |turns: f64| format!("{:.places$}", turns + 0.0);
    let other: Vec<String> = others()
        .filter(|(turns, _)| !alike(*turns))
        .map(|(turns, name)| format!("{} under {name}", said(*turns)))
        .collect();
    let mut words = format!(
        "{} makes {} turns on {} under {OURS}",
        capital(&helix.nut),
        said(*own),
        helix.bolt
    );
    if !same.is_empty() {
        words += &format!(" and about as many under {}", listed(same.into_iter()));
    }
    if !other.is_empty() {
        words += &format!("; but {}", listed(other.into_iter()));
    }
    Some(words + ".")
}

/// The body that ends farthest from where ours leads it, under one detector.
fn farthest_off<'a>(run: &'a RunFigures, ours: &RunFigures) -> Option<(f64, &'a str)> {
    let own: BTreeMap<&str, [f64; 3]> =
        ours.motion.iter().map(|motion| (&*motion.body, motion.displacement)).collect();
    let off = |motion: &'a cranny_ecs::MotionSummary| {
        let [u, v, w] = own.get(&*motion.body)?;
        let [x, y, z] = motion.displacement;
        Some(((x - u).hypot(y - v).hypot(z - w), &*motion.body))
    };
    run.motion.iter().filter_map(off).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// A length beside the size of a body, in brackets.
fn own_share(length: f64, sizes: &Sizes, body: &str) -> String {
    sizes.get(body).map_or(String::new(), |size| format!(" ({} of its size)", part(length / size)))
}

/// Where bodies end, beside where ours leads them.
fn ends(runs: &[RunFigures], ours: Option<&RunFigures>, sizes: &Sizes) -> Option<String> {
    let ours = ours?;
    let mut all: Vec<(f64, &str, String)> = runs
        .iter()
        .filter(|run| run.setting.detector != OURS && run.failure.is_none())
        .filter_map(|run| farthest_off(run, ours).map(|(off, body)| (off, body, run.name())))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (off, body, name) = all.last()?;
    if *off == 0.0 {
        return Some("Bodies end in the same places under all of them.".to_owned());
    }
    let moved = ours.motion.iter().find(|motion| motion.body == *body)?;
    let own = own_share(*off, sizes, body);
    let mut words = format!(
        "Bodies end farthest from where {OURS} leads them under {name}: {body} by {}{own}; \
         under {OURS} it moves {}",
        rounded(*off),
        rounded(way(moved))
    );
    if let [(least, _, nearest), _, ..] = &all[..] {
        words += &format!(". They end nearest under {nearest}: all within {}", rounded(*least));
    }
    Some(words + ".")
}

/// Why convex pieces move bodies: they meet where bodies do not.
fn filled(runs: &[RunFigures], apart: Option<&PeersApart>) -> Option<String> {
    runs.iter().find(|run| run.setting.detector == PIECES)?;
    let apart = apart.filter(|apart| apart.fills_gaps())?;
    let Panel { poses, wrong, .. } = apart.pieces;
    Some(format!(
        "Convex pieces fill gaps: they overlap at {wrong} of {} at which the bodies are apart, and \
         the solver pushes them out of each other.",
        counted(poses, "pose")
    ))
}

/// Names one after another.
fn listed(names: impl Iterator<Item = String>) -> String {
    let mut names: Vec<String> = names.collect();
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last } else { format!("{} and {last}", names.join(", ")) }
}

#[cfg(test)]
mod tests {
    use cranny_ecs::{
        DeepestSummary, HelixSummary, LeftSummary, LinkSummary, MotionSummary, PartedSummary,
    };
    use cranny_rapier::Detector;

    use super::*;

    fn run(detector: Detector, ms: f64, depth: f64, end: f64) -> RunFigures {
        let mut run = RunFigures::sample(detector, &[ms]);
        let (a, b) = ("bolt".to_owned(), "nut".to_owned());
        run.deepest = Some(DeepestSummary { depth, a, b, step: 7 });
        let displacement = [0.0, 0.0, end];
        run.motion =
            vec![MotionSummary { body: "nut".to_owned(), displacement, axis: None, turns: None }];
        run
    }

    fn sizes() -> Sizes {
        [("bolt".to_owned(), 50.0), ("nut".to_owned(), 20.0)].into()
    }

    fn said(runs: &[RunFigures], apart: Option<&PeersApart>) -> String {
        paragraphs(runs, &sizes(), apart).join("\n")
    }

    #[test]
    fn the_quickest_the_deepest_and_the_best_are_named() {
        let runs = [
            run(Detector::Cranny, 8.0, 0.0, 1.0),
            run(Detector::RapierTrimesh, 20.0, 0.003, 0.5),
            run(Detector::RapierDecomposition, 0.5, 10.0, 5.0),
        ];
        assert_eq!(
            said(&runs, None),
            "A step is quickest under rapier-decomposition: 0.5 ms on average; under cranny it \
             takes 16 times as long; under rapier-trimesh, the slowest, 40 times. Bodies sink \
             deepest into each other under rapier-decomposition: between bolt and nut, by 10 \
             (50 % of the size of the smaller); least under cranny: not at all. Under every other \
             detector, bodies sink deeper than under cranny.\n\
             Bodies end farthest from where cranny leads them under rapier-decomposition: nut by 4 \
             (20 % of its size); under cranny it moves 1. They end nearest under rapier-trimesh: \
             all within 0.5."
        );
    }

    #[test]
    fn who_is_quicker_and_no_deeper_is_the_choice() {
        let mut runs = vec![
            run(Detector::Cranny, 2.0, 0.004, 1.0),
            run(Detector::RapierTrimesh, 1.0, 0.002, 1.0),
        ];
        let choice = "no deeper than under cranny, rapier-trimesh is the quickest.";
        assert!(said(&runs, None).contains(choice), "{}", said(&runs, None));
        assert!(said(&runs, None).contains("least under rapier-trimesh: by 0.002 at most."));
        runs[1].step_ms = RunFigures::sample(Detector::Cranny, &[3.0]).step_ms;
        assert!(said(&runs, None).contains("no deeper than under cranny, it is the quickest."));
        let parted = PartedSummary { a: "a".to_owned(), b: "b".to_owned(), step: 3 };
        runs[1].links = Some(LinkSummary { at_start: 2, parted: vec![parted] });
        let words = said(&runs, None);
        assert!(words.ends_with("Bodies end in the same places under all of them."), "{words}");
        assert!(words.contains("bodies sink deeper than under cranny, or fare worse"), "{words}");
        assert!(words.contains("linked come apart under rapier-trimesh."), "{words}");
    }

    /// A nut that does not get onto its bolt sinks into nothing.
    #[test]
    fn a_choice_that_moves_bodies_otherwise_says_how_far() {
        let runs = [
            run(Detector::Cranny, 2.0, 0.004, 6.0),
            run(Detector::RapierDecomposition, 1.0, 0.0, 1.0),
        ];
        let choice = "rapier-decomposition is the quickest; under it nut ends 5 (25 % of its size) \
                      from where cranny leads it.";
        assert!(said(&runs, None).contains(choice), "{}", said(&runs, None));
    }

    #[test]
    fn nuts_that_turn_alike_are_told_from_those_that_do_not() {
        let turning = |detector, turns| {
            let helix = HelixSummary {
                bolt: "bolt".to_owned(),
                nut: "nut".to_owned(),
                pitch: 2.0,
                turns,
                advance: 0.0,
                deviation_max: 0.0,
            };
            let mut run = run(detector, 1.0, 0.0, 0.0);
            run.helices = vec![helix];
            run
        };
        let runs = [
            turning(Detector::Cranny, 0.5),
            turning(Detector::RapierTrimesh, 0.49),
            turning(Detector::RapierDecomposition, -0.04),
        ];
        let panel = |wrong| Panel { poses: 120, wrong, ..Panel::default() };
        let apart = PeersApart { mesh: panel(1), pieces: panel(118) };
        let words = said(&runs, Some(&apart));
        let turns = "Nut makes 0.50 turns on bolt under cranny and about as many under \
                     rapier-trimesh; but -0.04 under rapier-decomposition.";
        assert!(words.contains(turns), "{words}");
        let filled = "Convex pieces fill gaps: they overlap at 118 of 120 poses";
        assert!(words.contains(filled), "{words}");
        for (mesh, pieces) in [(1, 60), (50, 118)] {
            let apart = PeersApart { mesh: panel(mesh), pieces: panel(pieces) };
            assert!(!said(&runs, Some(&apart)).contains("fill gaps"));
        }
        assert!(words.contains("Bodies overlap under none of them."), "{words}");
    }

    #[test]
    fn who_did_not_finish_is_neither_quickest_nor_deepest() {
        let mut runs = vec![
            run(Detector::Cranny, 2.0, 0.004, 1.0),
            run(Detector::RapierTrimesh, 0.1, 0.002, 9.0),
            run(Detector::RapierDecomposition, 3.0, 0.5, 2.0),
            run(Detector::RapierHulls, 4.0, 6.0, 2.0),
        ];
        runs[1].failure = Some("it panicked".to_owned());
        runs[3].left = vec![LeftSummary { body: "nut".to_owned(), step: 4 }];
        let words = said(&runs, None);
        assert!(
            words.starts_with("A step is quickest under cranny: 2 ms on average; under"),
            "{words}"
        );
        assert!(words.contains("deepest into each other under rapier-decomposition"), "{words}");
        assert!(words.contains("does not come to its end under rapier-trimesh."), "{words}");
        assert!(words.contains("A body leaves the world under rapier-hulls."), "{words}");
        assert!(paragraphs(&[], &sizes(), None).is_empty());
        let alone = [run(Detector::Cranny, 2.0, 0.004, 1.0)];
        assert!(paragraphs(&alone, &sizes(), None).is_empty());
    }
}
