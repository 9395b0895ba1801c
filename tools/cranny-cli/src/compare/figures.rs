//! What is reported of a contestant, as a row of text, of CSV and of JSON.

use std::fmt::Write;

use cranny_ecs::{
    ContainedSummary, CountSummary, DeepestSummary, EnergySummary, HelixSummary, LeftSummary,
    LinkSummary, MotionSummary, PairsFound, PartedSummary, RunSummary,
};
use serde::Serialize;

use crate::csv::{cell, quoted};

/// Milliseconds of a step, by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct StepTimes {
    pub(super) broad: f64,
    pub(super) narrow: f64,
    pub(super) solver: f64,
}

impl StepTimes {
    pub(super) fn total(&self) -> f64 {
        self.broad + self.narrow + self.solver
    }
}

/// With what a row was run.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Setting {
    pub(crate) detector: &'static str,
    /// Whether rapier kept contacts while pairs drifted a little.
    pub(super) recycling: bool,
    /// Of the solver, a step.
    pub(super) substeps: usize,
    /// Until the first step; the exact models by which all are judged are part of it for each.
    pub(crate) prepared_s: f64,
}

/// A row.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RunFigures {
    #[serde(flatten)]
    pub(crate) setting: Setting,
    pub(super) steps: usize,
    pub(crate) dt: Option<f64>,
    /// Broad phase, narrow phase and solver, without what is computed to judge by; `None` without a
    /// step.
    pub(crate) step_ms: Option<Spread>,
    /// Means.
    pub(super) broad_ms: Option<f64>,
    pub(super) narrow_ms: Option<f64>,
    pub(super) solver_ms: Option<f64>,
    pub(super) contacts: Option<CountSummary>,
    /// Of the pairs that our detector answered about, the part whose contacts were carried on.
    pub(super) carried_share: Option<f64>,
    pub(crate) deepest: Option<DeepestSummary>,
    /// Bodies wholly within others, whose depth nothing gives.
    pub(crate) contained: Option<ContainedSummary>,
    pub(super) energy: Option<EnergySummary>,
    /// The greatest gain of energy over the start, relative to its scale.
    pub(super) energy_drift: Option<f64>,
    /// Bodies that left the world.
    pub(crate) left: Vec<LeftSummary>,
    /// The body that moved farthest from where it was put.
    pub(crate) farthest: Option<MotionSummary>,
    pub(crate) links: Option<LinkSummary>,
    pub(crate) helices: Vec<HelixSummary>,
    pub(super) state_hash: Option<String>,
    pub(super) interrupted: bool,
    /// Why it did not come to the end.
    pub(crate) failure: Option<String>,
    /// How each body moved.
    #[serde(skip)]
    pub(crate) motion: Vec<MotionSummary>,
    #[serde(skip)]
    pub(super) times: Vec<StepTimes>,
}

/// How values spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Spread {
    pub(crate) mean: f64,
    pub(super) median: f64,
    pub(super) p99: f64,
    pub(super) max: f64,
}

impl Spread {
    /// Quantiles are values that occur: the least that so many of a hundred do not exceed. `None`
    /// of nothing.
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        let quantile = |percent: usize| {
            let rank = (values.len() * percent).div_ceil(100).max(1);
            values.get(rank - 1).copied()
        };
        Some(Self {
            mean: mean(&values)?,
            median: quantile(50)?,
            p99: quantile(99)?,
            max: *values.last()?,
        })
    }
}

/// How far a body has moved.
pub(crate) fn way(motion: &MotionSummary) -> f64 {
    let [x, y, z] = motion.displacement;
    x.hypot(y).hypot(z)
}

fn share_carried(found: PairsFound) -> Option<f64> {
    let all = found.carried.mean + found.searched.mean;
    (all > 0.0).then(|| found.carried.mean / all)
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

impl RunFigures {
    pub(super) fn new(
        setting: Setting,
        times: Vec<StepTimes>,
        summary: Option<RunSummary>,
        failure: Option<String>,
    ) -> Self {
        let of = |phase: fn(&StepTimes) -> f64| times.iter().map(phase).collect::<Vec<f64>>();
        let mut row = Self {
            setting,
            steps: times.len(),
            dt: None,
            step_ms: Spread::of(of(StepTimes::total)),
            broad_ms: mean(&of(|t| t.broad)),
            narrow_ms: mean(&of(|t| t.narrow)),
            solver_ms: mean(&of(|t| t.solver)),
            contacts: None,
            carried_share: None,
            deepest: None,
            contained: None,
            energy: None,
            energy_drift: None,
            left: Vec::new(),
            farthest: None,
            links: None,
            helices: Vec::new(),
            state_hash: None,
            interrupted: false,
            failure,
            motion: Vec::new(),
            times,
        };
        if let Some(summary) = summary {
            row.dt = Some(summary.dt);
            row.contacts = Some(summary.contacts);
            row.carried_share = summary.pairs_found.and_then(share_carried);
            row.deepest = summary.deepest;
            row.contained = summary.contained;
            row.energy = summary.energy;
            row.energy_drift = summary.energy_drift;
            row.left = summary.left;
            let farthest = summary.motion.iter().max_by(|a, b| way(a).total_cmp(&way(b)));
            row.farthest = farthest.cloned();
            row.motion = summary.motion;
            row.links = summary.links;
            row.helices = summary.helices;
            row.state_hash = Some(summary.state_hash);
            row.interrupted = summary.interrupted;
        }
        row
    }

    /// Its name, and whether it recycles, which it usually does.
    pub(crate) fn name(&self) -> String {
        let Setting { detector, recycling, .. } = self.setting;
        if recycling { detector.to_owned() } else { format!("{detector}, not recycled") }
    }

    /// The rings that parted first.
    fn parted(&self) -> Option<&PartedSummary> {
        self.links.iter().flat_map(|links| &links.parted).min_by_key(|parted| parted.step)
    }

    /// Whether there is a summary of its steps.
    fn steps_counted(&self) -> bool {
        self.state_hash.is_some()
    }

    fn links_kept(&self) -> Option<String> {
        let links = self.links.as_ref()?;
        Some(format!("{} of {}", links.at_start - links.parted.len(), links.at_start))
    }

    /// The texts of its columns; empty where nothing is known.
    fn cells(&self) -> Vec<String> {
        // 0 is added so that nothing lost is not printed as -0.
        let end = self.energy.as_ref().map(|energy| -100.0 * energy.loss + 0.0);
        let gained = self.energy_drift.map(|drift| 100.0 * drift);
        let (spread, helix) = (self.step_ms, self.helices.first());
        let reported = |value: Option<f64>, digits: usize| {
            value.map_or(String::new(), |value| format!("{value:.digits$}"))
        };
        vec![
            self.name(),
            reported(Some(self.setting.prepared_s), 2),
            self.steps.to_string(),
            self.setting.substeps.to_string(),
            reported(spread.map(|s| s.mean), 3),
            reported(spread.map(|s| s.median), 3),
            reported(spread.map(|s| s.p99), 3),
            reported(self.narrow_ms, 3),
            reported(self.solver_ms, 3),
            reported(self.contacts.map(|c| c.mean), 0),
            reported(self.carried_share.map(|share| 100.0 * share), 0),
            reported(self.deepest.as_ref().map(|d| d.depth), 5),
            self.contained.as_ref().map_or(String::new(), |c| c.steps.to_string()),
            reported(gained, 2),
            reported(end, 2),
            match self.left.len() {
                0 => String::new(),
                left => left.to_string(),
            },
            reported(self.farthest.as_ref().map(way), 3),
            self.links_kept().unwrap_or_default(),
            reported(helix.map(|h| h.turns), 3),
            reported(helix.map(|h| h.deviation_max), 4),
        ]
    }
}

/// Headings of the columns, in two lines; the first column is a name, the others are numbers.
const HEADINGS: [[&str; 2]; 20] = [
    ["", "detector"],
    ["ready", "s"],
    ["", "steps"],
    ["", "substeps"],
    ["step ms", "mean"],
    ["step ms", "median"],
    ["step ms", "p99"],
    ["narrow ms", "mean"],
    ["solver ms", "mean"],
    ["contacts", "a step"],
    ["carried", "% pairs"],
    ["deepest", "overlap"],
    ["inside", "steps"],
    ["energy %", "gained"],
    ["energy %", "at end"],
    ["bodies", "left"],
    ["moved", "farthest"],
    ["links", "kept"],
    ["screw", "turns"],
    ["screw", "off helix"],
];

/// Columns that a page leaves out: it has no room for numbers of steps, of substeps, and for the
/// parts of a step.
const NOT_ON_PAGES: [usize; 5] = [2, 3, 6, 7, 8];

/// Headings and rows of the columns that a page shows: those that have a value in some row.
pub(crate) fn columns(rows: &[RunFigures]) -> (Vec<String>, Vec<Vec<String>>) {
    let cells: Vec<Vec<String>> = rows.iter().map(RunFigures::cells).collect();
    let mut shown = shown(&cells);
    shown.retain(|column| !NOT_ON_PAGES.contains(column));
    let heading = |&column: &usize| HEADINGS[column].join(" ").trim().to_owned();
    let of_row = |row: &Vec<String>| shown.iter().map(|&column| row[column].clone()).collect();
    (shown.iter().map(heading).collect(), cells.iter().map(of_row).collect())
}

fn shown(cells: &[Vec<String>]) -> Vec<usize> {
    (0..HEADINGS.len()).filter(|&column| cells.iter().any(|row| !row[column].is_empty())).collect()
}

/// The table for people. Columns of which nobody knows anything are left out.
pub(super) fn text(rows: &[RunFigures]) -> String {
    let cells: Vec<Vec<String>> = rows.iter().map(RunFigures::cells).collect();
    let shown = shown(&cells);
    let width = |column: usize| {
        let texts = cells.iter().map(|row| row[column].len());
        texts.chain(HEADINGS[column].map(str::len)).max().unwrap_or(0)
    };
    let mut text = String::new();
    let mut line = |of: &dyn Fn(usize) -> String| {
        let cells = shown.iter().map(|&column| {
            let (cell, width) = (of(column), width(column));
            if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        let cells: Vec<String> = cells.collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", cells.join("  ").trim_end());
    };
    [0, 1].into_iter().for_each(|i| line(&|column| HEADINGS[column][i].to_owned()));
    cells.iter().for_each(|row| line(&|column| row[column].clone()));
    for note in notes(rows) {
        let _ = writeln!(text, "{note}");
    }
    text.trim_end().to_owned()
}

/// What does not fit into a table.
fn notes(rows: &[RunFigures]) -> Vec<String> {
    rows.iter().flat_map(|row| [row.troubles(), row.places()].concat()).collect()
}

impl RunFigures {
    /// What went wrong, and threads beyond the first.
    pub(crate) fn troubles(&self) -> Vec<String> {
        let (name, mut notes) = (self.name(), Vec::new());
        if let Some(why) = &self.failure {
            notes.push(format!("{name} did not finish, {why}"));
        }
        if self.interrupted {
            notes.push(format!("{name} was interrupted after {} steps", self.steps));
        }
        if let Some(ContainedSummary { a, b, step, .. }) = &self.contained {
            notes.push(format!(
                "{name}: {a} and {b}, one wholly within the other, after {step} steps"
            ));
        }
        if let Some(PartedSummary { a, b, step }) = self.parted() {
            notes.push(format!("{name}: {a} and {b} parted first, after {step} steps"));
        }
        if let Some(LeftSummary { body, step }) = self.left.iter().min_by_key(|left| left.step) {
            notes.push(format!("{name}: {body} left the world after {step} steps"));
        }
        for helix in self.helices.iter().skip(1) {
            notes.push(format!(
                "{name}: {} on {}: {:.3} turns, {:.4} off the helix",
                helix.nut, helix.bolt, helix.turns, helix.deviation_max
            ));
        }
        notes
    }

    /// Where bodies overlapped, and which went farthest.
    fn places(&self) -> Vec<String> {
        let (name, mut notes) = (self.name(), Vec::new());
        if let Some(d) = self.deepest.as_ref().filter(|d| d.depth > 0.0) {
            let DeepestSummary { a, b, step, .. } = d;
            notes.push(format!("{name}: deepest between {a} and {b}, after {step} steps"));
        }
        if let Some(MotionSummary { body, displacement: [x, y, z], .. }) = &self.farthest {
            notes.push(format!("{name}: {body} moved farthest, by ({x:.3}, {y:.3}, {z:.3})"));
        }
        notes
    }
}

/// All rows, a line each.
pub(super) fn csv(rows: &[RunFigures]) -> String {
    let mut text = String::from(
        "detector,recycling,substeps,prepared_s,dt,steps,step_ms_mean,step_ms_median,step_ms_p99,\
         step_ms_max,broad_ms,narrow_ms,solver_ms,contacts_mean,contacts_max,carried_share,deepest,contained_steps,\
         energy_drift,energy_loss,left,moved_farthest,links,parted,turns,deviation_max,state_hash,interrupted,failure\n",
    );
    for row in rows {
        let Setting { detector, recycling, substeps, prepared_s } = &row.setting;
        let (spread, helix, links) = (row.step_ms, row.helices.first(), row.links.as_ref());
        let cells = [
            (*detector).to_owned(),
            recycling.to_string(),
            substeps.to_string(),
            prepared_s.to_string(),
            cell(row.dt),
            row.steps.to_string(),
            cell(spread.map(|s| s.mean)),
            cell(spread.map(|s| s.median)),
            cell(spread.map(|s| s.p99)),
            cell(spread.map(|s| s.max)),
            cell(row.broad_ms),
            cell(row.narrow_ms),
            cell(row.solver_ms),
            cell(row.contacts.map(|c| c.mean)),
            cell(row.contacts.map(|c| c.max)),
            cell(row.carried_share),
            cell(row.deepest.as_ref().map(|d| d.depth)),
            cell(row.contained.as_ref().map(|c| c.steps)),
            cell(row.energy_drift),
            cell(row.energy.as_ref().map(|e| e.loss)),
            cell(row.steps_counted().then_some(row.left.len())),
            cell(row.farthest.as_ref().map(way)),
            cell(links.map(|l| l.at_start)),
            cell(links.map(|l| l.parted.len())),
            cell(helix.map(|h| h.turns)),
            cell(helix.map(|h| h.deviation_max)),
            row.state_hash.clone().unwrap_or_default(),
            row.interrupted.to_string(),
            row.failure.as_deref().map_or(String::new(), quoted),
        ];
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// Every step of every row.
pub(super) fn steps_csv(rows: &[RunFigures]) -> String {
    let mut text = String::from("detector,recycling,step,broad_ms,narrow_ms,solver_ms\n");
    for row in rows {
        let Setting { detector, recycling, .. } = row.setting;
        for (step, times) in row.times.iter().enumerate() {
            let StepTimes { broad, narrow, solver } = times;
            let _ = writeln!(text, "{detector},{recycling},{step},{broad},{narrow},{solver}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_rapier::Detector;

    impl RunFigures {
        /// Of steps that took so many milliseconds.
        pub(crate) fn sample(detector: Detector, ms: &[f64]) -> Self {
            let times = ms.iter().map(|&narrow| StepTimes { narrow, ..StepTimes::default() });
            let detector = detector.name();
            let setting = Setting { detector, recycling: true, substeps: 4, prepared_s: 0.5 };
            Self::new(setting, times.collect(), None, None)
        }
    }

    fn row(detector: Detector, recycling: bool, ms: &[f64]) -> RunFigures {
        let mut row = RunFigures::sample(detector, ms);
        row.setting.recycling = recycling;
        row
    }

    #[test]
    fn quantiles_are_values_that_occur() {
        let hundred: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        let spread = Spread::of(hundred).unwrap();
        assert_eq!((spread.mean, spread.median, spread.p99, spread.max), (50.5, 50.0, 99.0, 100.0));
        // Of few values, the worst is seen.
        let spread = Spread::of(vec![3.0, 1.0, 2.0]).unwrap();
        assert_eq!((spread.median, spread.p99), (2.0, 3.0));
        assert_eq!(Spread::of(Vec::new()), None);
    }

    #[test]
    fn what_nobody_knows_has_no_column_and_what_failed_no_time() {
        let mut rows = vec![
            row(Detector::Cranny, true, &[1.0, 3.0]),
            row(Detector::RapierTrimesh, false, &[]),
        ];
        rows[1].failure = Some("before its first step: \"no\"".to_owned());
        let reported = text(&rows);
        let lines: Vec<&str> = reported.lines().collect();
        assert!(lines[1].starts_with("detector") && !reported.contains("links"), "{reported}");
        assert!(lines[2].starts_with("cranny  ") && lines[2].contains("2.000"), "{reported}");
        assert!(lines[3].starts_with("rapier-trimesh, not recycled"), "{reported}");
        assert!(!lines[3].contains("0.000"), "{reported}");
        assert!(lines[4].contains("did not finish, before its first step"), "{reported}");
        let csv = csv(&rows);
        let failed = csv.lines().nth(2).unwrap();
        assert!(failed.ends_with(",false,\"before its first step: \"\"no\"\"\""), "{failed}");
        let columns = csv.lines().next().unwrap().split(',').count();
        assert_eq!(csv.lines().nth(1).unwrap().split(',').count(), columns);
        assert_eq!(steps_csv(&rows).lines().count(), 3);
    }

    #[test]
    fn the_body_that_moved_farthest_is_named_with_its_way() {
        let mut rows = vec![row(Detector::RapierTrimesh, true, &[1.0])];
        let wheel = MotionSummary {
            body: "wheel".to_owned(),
            displacement: [3.0, 4.0, -12.0],
            axis: None,
            turns: None,
        };
        rows[0].farthest = Some(wheel);
        let reported = text(&rows);
        assert!(reported.contains("farthest") && reported.contains("13.000"), "{reported}");
        let said = "rapier-trimesh: wheel moved farthest, by (3.000, 4.000, -12.000)";
        assert!(reported.contains(said), "{reported}");
        let csv = csv(&rows);
        let column = csv.lines().next().unwrap().split(',').position(|c| c == "moved_farthest");
        assert_eq!(csv.lines().nth(1).unwrap().split(',').nth(column.unwrap()), Some("13"));
    }

    #[test]
    fn the_first_to_part_is_named() {
        let mut rows = vec![row(Detector::RapierDecomposition, true, &[1.0])];
        let parted = |a: &str, step| PartedSummary { a: a.to_owned(), b: "ring".to_owned(), step };
        rows[0].links =
            Some(LinkSummary { at_start: 3, parted: vec![parted("late", 9), parted("early", 2)] });
        let reported = text(&rows);
        assert!(reported.contains("1 of 3"), "{reported}");
        assert!(reported.contains("early and ring parted first, after 2 steps"), "{reported}");
    }
}
