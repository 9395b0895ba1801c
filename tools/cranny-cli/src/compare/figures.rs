//! What is told of a contestant, as a row of text, of CSV and of JSON.

use std::fmt::Write;

use cranny_ecs::{
    CountSummary, DeepestSummary, EnergySummary, HelixSummary, LinkSummary, RunSummary,
};
use cranny_rapier::Detector;
use serde::Serialize;

/// Milliseconds of a step, by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StepTimes {
    pub(super) broad: f64,
    pub(super) narrow: f64,
    pub(super) solver: f64,
}

impl StepTimes {
    pub(super) fn total(&self) -> f64 {
        self.broad + self.narrow + self.solver
    }
}

/// A row.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Figures {
    pub(super) detector: &'static str,
    /// Whether rapier kept contacts while pairs drifted a little.
    pub(super) recycling: bool,
    /// Until the first step; the exact models by which all are judged are part of it for each.
    pub(super) prepared_s: f64,
    pub(super) steps: usize,
    pub(super) dt: Option<f64>,
    /// Broad phase, narrow phase and solver, without what is computed to judge by.
    pub(super) step_ms: Spread,
    /// Means.
    pub(super) broad_ms: f64,
    pub(super) narrow_ms: f64,
    pub(super) solver_ms: f64,
    pub(super) contacts: Option<CountSummary>,
    pub(super) deepest: Option<DeepestSummary>,
    pub(super) energy: Option<EnergySummary>,
    /// The greatest gain of energy over the start, relative to its scale.
    pub(super) energy_drift: Option<f64>,
    pub(super) links: Option<LinkSummary>,
    pub(super) helices: Vec<HelixSummary>,
    pub(super) state_hash: Option<String>,
    pub(super) interrupted: bool,
    /// Why it did not come to the end.
    pub(super) failure: Option<String>,
    #[serde(skip)]
    pub(super) times: Vec<StepTimes>,
}

/// How values spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(super) struct Spread {
    pub(super) mean: f64,
    pub(super) median: f64,
    pub(super) p99: f64,
    pub(super) max: f64,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        values.sort_unstable_by(f64::total_cmp);
        let last = values.len() - 1;
        Self {
            mean: mean(&values),
            median: values[last / 2],
            p99: values[last * 99 / 100],
            max: values[last],
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

impl Figures {
    pub(super) fn new(
        detector: Detector,
        recycling: bool,
        prepared_s: f64,
        times: Vec<StepTimes>,
        summary: Option<RunSummary>,
        failure: Option<String>,
    ) -> Self {
        let of = |phase: fn(&StepTimes) -> f64| times.iter().map(phase).collect::<Vec<f64>>();
        let mut row = Self {
            detector: detector.name(),
            recycling,
            prepared_s,
            steps: times.len(),
            dt: None,
            step_ms: Spread::of(of(StepTimes::total)),
            broad_ms: mean(&of(|t| t.broad)),
            narrow_ms: mean(&of(|t| t.narrow)),
            solver_ms: mean(&of(|t| t.solver)),
            contacts: None,
            deepest: None,
            energy: None,
            energy_drift: None,
            links: None,
            helices: Vec::new(),
            state_hash: None,
            interrupted: false,
            failure,
            times,
        };
        if let Some(summary) = summary {
            row.dt = Some(summary.dt);
            row.contacts = Some(summary.contacts);
            row.deepest = summary.deepest;
            row.energy = summary.energy;
            row.energy_drift = summary.energy_drift;
            row.links = summary.links;
            row.helices = summary.helices;
            row.state_hash = Some(summary.state_hash);
            row.interrupted = summary.interrupted;
        }
        row
    }

    /// Its name, and whether it recycles where that is not what it usually does.
    pub(super) fn name(&self) -> String {
        let usual = self.detector != Detector::Cranny.name();
        match (self.recycling, usual) {
            (true, false) => format!("{}, recycled", self.detector),
            (false, true) => format!("{}, not recycled", self.detector),
            _ => self.detector.to_owned(),
        }
    }

    fn links_kept(&self) -> Option<String> {
        let links = self.links.as_ref()?;
        Some(format!("{} of {}", links.at_start - links.parted.len(), links.at_start))
    }

    /// The texts of its columns; empty where nothing is known.
    fn cells(&self) -> Vec<String> {
        let energy = self.energy.as_ref().map(|energy| -100.0 * energy.loss);
        let drift = self.energy_drift.map(|drift| 100.0 * drift);
        let helix = self.helices.first();
        let ms = |value: f64| format!("{value:.3}");
        let told = |value: Option<f64>, digits: usize| {
            value.map_or(String::new(), |value| format!("{value:.digits$}"))
        };
        vec![
            self.name(),
            format!("{:.2}", self.prepared_s),
            ms(self.step_ms.mean),
            ms(self.step_ms.median),
            ms(self.step_ms.p99),
            ms(self.narrow_ms),
            ms(self.solver_ms),
            told(self.contacts.map(|c| c.mean), 0),
            told(self.deepest.as_ref().map(|d| d.depth), 5),
            told(drift, 2),
            told(energy, 2),
            self.links_kept().unwrap_or_default(),
            told(helix.map(|h| h.turns), 3),
            told(helix.map(|h| h.deviation_max), 4),
        ]
    }
}

/// Headings of the columns, in two lines; the first column is a name, the others are numbers.
const HEADINGS: [[&str; 2]; 14] = [
    ["", "detector"],
    ["ready", "s"],
    ["step ms", "mean"],
    ["", "median"],
    ["", "p99"],
    ["narrow", "mean"],
    ["solver", "mean"],
    ["contacts", "a step"],
    ["deepest", "overlap"],
    ["energy %", "gained"],
    ["", "at end"],
    ["links", "kept"],
    ["screw", "turns"],
    ["", "off helix"],
];

/// The table for people. Columns of which nobody knows anything are left out.
pub(super) fn text(rows: &[Figures]) -> String {
    let cells: Vec<Vec<String>> = rows.iter().map(Figures::cells).collect();
    let shown: Vec<usize> = (0..HEADINGS.len())
        .filter(|&column| cells.iter().any(|row| !row[column].is_empty()))
        .collect();
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
fn notes(rows: &[Figures]) -> Vec<String> {
    let mut notes = Vec::new();
    for row in rows {
        let name = row.name();
        if let Some(why) = &row.failure {
            notes.push(format!("{name} did not finish, {why}"));
        }
        if row.interrupted {
            notes.push(format!("{name} was interrupted after {} steps", row.steps));
        }
        if let Some(d) = row.deepest.as_ref().filter(|d| d.depth > 0.0) {
            notes.push(format!(
                "{name}: deepest between {} and {}, after {} steps",
                d.a, d.b, d.step
            ));
        }
        for parted in row.links.iter().flat_map(|links| links.parted.first()) {
            notes.push(format!(
                "{name}: {} and {} parted, after {} steps",
                parted.a, parted.b, parted.step
            ));
        }
        for helix in row.helices.iter().skip(1) {
            notes.push(format!(
                "{name}: {} on {}: {:.3} turns, {:.4} off the helix",
                helix.nut, helix.bolt, helix.turns, helix.deviation_max
            ));
        }
    }
    notes
}

/// All rows, a line each.
pub(super) fn csv(rows: &[Figures]) -> String {
    let mut text = String::from(
        "detector,recycling,prepared_s,steps,step_ms_mean,step_ms_median,step_ms_p99,step_ms_max,\
         broad_ms,narrow_ms,solver_ms,contacts_mean,contacts_max,deepest,energy_drift,energy_loss,\
         links,parted,turns,deviation_max,state_hash,failure\n",
    );
    let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for row in rows {
        let helix = row.helices.first();
        let links = row.links.as_ref();
        let cells = [
            row.detector.to_owned(),
            row.recycling.to_string(),
            row.prepared_s.to_string(),
            row.steps.to_string(),
            row.step_ms.mean.to_string(),
            row.step_ms.median.to_string(),
            row.step_ms.p99.to_string(),
            row.step_ms.max.to_string(),
            row.broad_ms.to_string(),
            row.narrow_ms.to_string(),
            row.solver_ms.to_string(),
            number(row.contacts.map(|c| c.mean)),
            row.contacts.map_or(String::new(), |c| c.max.to_string()),
            number(row.deepest.as_ref().map(|d| d.depth)),
            number(row.energy_drift),
            number(row.energy.as_ref().map(|e| e.loss)),
            links.map_or(String::new(), |l| l.at_start.to_string()),
            links.map_or(String::new(), |l| l.parted.len().to_string()),
            number(helix.map(|h| h.turns)),
            number(helix.map(|h| h.deviation_max)),
            row.state_hash.clone().unwrap_or_default(),
            row.failure.as_deref().map_or(String::new(), quoted),
        ];
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// A text in quotes, as CSV has them.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\"").replace(['\n', '\r'], " "))
}

/// Every step of every row.
pub(super) fn steps_csv(rows: &[Figures]) -> String {
    let mut text = String::from("detector,recycling,step,broad_ms,narrow_ms,solver_ms\n");
    for row in rows {
        for (step, times) in row.times.iter().enumerate() {
            let (name, recycling) = (row.detector, row.recycling);
            let StepTimes { broad, narrow, solver } = times;
            let _ = writeln!(text, "{name},{recycling},{step},{broad},{narrow},{solver}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(detector: Detector, recycling: bool, ms: &[f64]) -> Figures {
        let times = ms.iter().map(|&narrow| StepTimes { narrow, ..StepTimes::default() });
        Figures::new(detector, recycling, 0.5, times.collect(), None, None)
    }

    #[test]
    fn spreads_are_of_sorted_values() {
        let hundred: Vec<f64> = (1..=101).rev().map(f64::from).collect();
        let spread = Spread::of(hundred);
        assert_eq!(
            (spread.mean, spread.median, spread.p99, spread.max),
            (51.0, 51.0, 100.0, 101.0)
        );
        assert_eq!(Spread::of(Vec::new()), Spread::default());
    }

    #[test]
    fn what_nobody_knows_has_no_column() {
        let mut rows = vec![
            row(Detector::Cranny, false, &[1.0, 3.0]),
            row(Detector::RapierTrimesh, false, &[2.0]),
        ];
        rows[1].failure = Some("after 1 steps: it panicked: \"no\"".to_owned());
        let told = text(&rows);
        let lines: Vec<&str> = told.lines().collect();
        assert!(lines[1].starts_with("detector") && !told.contains("links"), "{told}");
        assert!(lines[2].starts_with("cranny  ") && lines[2].contains("2.000"), "{told}");
        assert!(lines[3].starts_with("rapier-trimesh, not recycled"), "{told}");
        assert!(lines[4].contains("did not finish, after 1 steps"), "{told}");
        rows[0].links = Some(LinkSummary { at_start: 3, parted: Vec::new() });
        assert!(text(&rows).contains("3 of 3"));
        let csv = csv(&rows);
        assert!(
            csv.lines().nth(2).unwrap().ends_with("\"after 1 steps: it panicked: \"\"no\"\"\"")
        );
        let columns = csv.lines().next().unwrap().split(',').count();
        assert_eq!(csv.lines().nth(1).unwrap().split(',').count(), columns);
        assert_eq!(steps_csv(&rows).lines().count(), 4);
    }
}
