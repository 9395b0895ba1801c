//! Every case: its name, its motion, and its demands.

use super::corpus;
use super::demand::DemandKind;
use super::kinematic::{self, Way};
use super::recorded::{Excerpt, Recordings};
use super::stage::Motion;

/// A motion by name.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) demands: &'static [DemandKind],
    /// Number of frames, at most.
    pub(super) frames: usize,
    /// The case takes minutes: it runs only when its full name is given.
    pub(super) on_request: bool,
    pub(super) source: Source,
}

/// The source of a motion.
pub(super) enum Source {
    /// A function of the number of frames. Its error says why there is no motion.
    Moved(Box<dyn Fn(usize) -> Result<Motion, String>>),
    /// Steps of a simulation.
    Recorded(Excerpt),
}

impl Case {
    /// # Errors
    ///
    /// The reason why the case is skipped.
    pub(super) fn motion(&self, frames: usize, recordings: &Recordings) -> Result<Motion, String> {
        match &self.source {
            Source::Moved(moved) => moved(frames),
            Source::Recorded(excerpt) => recordings.motion(excerpt, frames),
        }
    }

    /// Returns whether the case runs for these parts of names. An empty list selects every case
    /// that is not on request.
    pub(super) fn is_wanted(&self, parts: &[String]) -> bool {
        let named = |part: &String| {
            if self.on_request { self.name == *part } else { self.name.contains(&**part) }
        };
        if parts.is_empty() { !self.on_request } else { parts.iter().any(named) }
    }
}

use DemandKind::{Contacts, Distance, Regions, Verdict};

/// Bodies apart have no regions and no contacts within the margin.
const APART: &[DemandKind] = &[Verdict, Distance];
const ALL: &[DemandKind] = &DemandKind::ALL;
/// The demands of a solver and of a summary of contacts.
const SOLVER: &[DemandKind] = &[Verdict, Contacts, Regions];

/// Frames of a case whose queries take microseconds, and of one whose queries take milliseconds.
const MANY: usize = 200;
const FEW: usize = 60;

/// Returns all cases in the order of the table. Nonempty `degrees` replace those of each kinematic
/// case.
pub(super) fn cases(degrees: &[f64]) -> Vec<Case> {
    let mut cases = moved(degrees);
    cases.extend(recorded());
    cases
}

fn moved(degrees: &[f64]) -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: &str, own: &[f64], frames, demands, make: fn(f64, usize) -> Made| {
        for &degrees in if degrees.is_empty() { own } else { degrees } {
            cases.push(Case {
                name: format!("{name}, {degrees} degrees"),
                demands,
                frames,
                on_request: false,
                source: Source::Moved(Box::new(move |frames| make(degrees, frames))),
            });
        }
    };
    add("tori 1k linked near", &[0.1], MANY, APART, |d, n| tori(1, 0.025, d, n));
    add("tori 1k linked in contact", &[0.1], MANY, ALL, |d, n| tori(1, -0.01, d, n));
    let paces = [0.01, 0.1, 1.0, 3.0];
    add("tori 10k linked near", &paces, MANY, APART, |d, n| tori(10, 0.025, d, n));
    add("tori 10k linked wide apart", &[0.1, 1.0], MANY, APART, |d, n| tori(10, 0.4, d, n));
    add("tori 10k linked in contact", &paces, MANY, ALL, |d, n| tori(10, -0.01, d, n));
    add("tori 10k linked deep", &[0.1], MANY, ALL, |d, n| tori(10, -0.05, d, n));
    add("tori 100k linked near", &[0.1], FEW, APART, |d, n| tori(100, 0.025, d, n));
    add("tori 100k linked in contact", &[0.1], FEW, ALL, |d, n| tori(100, -0.01, d, n));
    add("golf 1k in light contact", &[0.1], MANY, ALL, |d, n| golf(1, -0.005, d, n));
    add("golf 10k in light contact", &[0.1], MANY, ALL, |d, n| golf(10, -0.002, d, n));
    add("golf 1k in contact", &[0.1], MANY, ALL, |d, n| golf(1, -0.02, d, n));
    add("golf 10k in contact", &[0.1], MANY, ALL, |d, n| golf(10, -0.02, d, n));
    add("ball in cup near", &[0.1, 1.0], MANY, APART, |d, n| ball_in_cup(0.05, d, n));
    add("ball in cup in contact", &[0.1, 1.0], MANY, ALL, |d, n| ball_in_cup(-0.02, d, n));
    add("M16 nut along", &[0.1, 0.5, 1.5], FEW, ALL, |d, n| nut(Way::Along, d, n));
    add("M16 nut across", &[0.1], FEW, ALL, |d, n| nut(Way::Across, d, n));
    add("M12 nut along", &[0.1, 1.5], FEW, ALL, |d, n| corpus::m12_nut(Way::Along, d, n));
    add("M12 nut across", &[0.1], FEW, ALL, |d, n| corpus::m12_nut(Way::Across, d, n));
    let paces = [0.01, 0.1];
    add("corpus peg", &paces, MANY, ALL, |d, n| corpus::stroll("p02_roundpeg_hole_16mm", d, n));
    add("corpus gears", &paces, MANY, ALL, |d, n| corpus::stroll("p03_gears", d, n));
    add("corpus links", &paces, MANY, ALL, |d, n| corpus::stroll("p04_chain_links", d, n));
    add("corpus garage", &paces, MANY, ALL, |d, n| corpus::stroll("p05_garage_truck", d, n));
    add("golf 10k side by side", &[0.1], MANY, APART, |d, n| golf(10, 0.03, d, n));
    cases
}

fn recorded() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: &str, scene, pairs, start, frames, demands| {
        cases.push(Case {
            name: name.into(),
            demands,
            frames,
            on_request: name.starts_with("pile of 500"),
            source: Source::Recorded(Excerpt { scene, pairs, start }),
        });
    };
    add("ring of tori hanging", "ring_of_tori", &[], 480, MANY, ALL);
    add("ten cups at rest", "stack_of_cups", &[], 480, FEW, SOLVER);
    add("hook on ring at rest", "hook_on_ring", &[["ring", "hook"]], 240, MANY, ALL);
    add("peg in hole", "peg_in_hole", &[["block", "peg"]], 100, MANY, ALL);
    const KEYS: &[[&str; 2]] = &[
        ["plug_turned", "key_turned"],
        ["plug_entered", "key_entered"],
        ["plug_barred", "key_barred"],
    ];
    add("keys in locks", "key_in_lock", KEYS, 200, MANY, ALL);
    add("teeth of gears", "gears", &[["driver", "driven"]], 240, MANY, ALL);
    add("nut that climbs", "nut_on_bolt", &[["bolt", "nut"]], 120, FEW, SOLVER);
    add("pile of 50 in the fall", "mixed_pile_50", &[], 60, FEW, SOLVER);
    add("pile of 50 at rest", "mixed_pile_50", &[], 240, FEW, SOLVER);
    add("pile of 500 in the fall", "mixed_pile", &[], 120, FEW / 3, SOLVER);
    add("pile of 500 late", "mixed_pile", &[], 480, FEW / 3, SOLVER);
    cases
}

type Made = Result<Motion, String>;

fn tori(thousands: u32, gap: f64, degrees: f64, frames: usize) -> Made {
    kinematic::linked_tori(thousands, gap, degrees, frames).map_err(|error| error.to_string())
}

fn golf(thousands: u32, gap: f64, degrees: f64, frames: usize) -> Made {
    kinematic::golf_balls(thousands, gap, degrees, frames).map_err(|error| error.to_string())
}

fn ball_in_cup(gap: f64, degrees: f64, frames: usize) -> Made {
    kinematic::ball_in_cup(gap, degrees, frames).map_err(|error| error.to_string())
}

fn nut(way: Way, degrees: f64, frames: usize) -> Made {
    kinematic::nut(way, degrees, frames).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_parts_of_them_choose() {
        let cases = cases(&[]);
        let names: BTreeSet<&str> = cases.iter().map(|case| &*case.name).collect();
        assert_eq!(names.len(), cases.len());
        let count = |parts: &[&str]| {
            let parts: Vec<String> = parts.iter().map(|&part| part.into()).collect();
            cases.iter().filter(|case| case.is_wanted(&parts)).count()
        };
        assert_eq!(count(&["cups", "hook"]), 2);
        assert_eq!(count(&["pile"]), 2);
        assert_eq!(count(&["pile of 500 late"]), 1);
        assert_eq!(count(&[]), cases.len() - 2);
    }

    #[test]
    fn degrees_replace_those_of_each_moved_case() {
        let cases = cases(&[0.3]);
        let nuts: Vec<&str> = cases
            .iter()
            .map(|case| &*case.name)
            .filter(|name| name.starts_with("M16 nut along"))
            .collect();
        assert_eq!(nuts, ["M16 nut along, 0.3 degrees"]);
    }
}
