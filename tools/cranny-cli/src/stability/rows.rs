//! A family in a line, and the files of numbers.

use std::collections::BTreeMap;

use cranny_stability::{Case, Family, Outcome};
use serde::Serialize;

use super::FamilyOutcome;
use crate::csv::{cell, quoted};

/// What came out of a family.
#[derive(Debug, Serialize)]
pub(super) struct Row<'a> {
    pub(super) family: &'static str,
    pub(super) cases: usize,
    pub(super) failed: usize,
    pub(super) worst: Option<f64>,
    pub(super) worst_case: Option<&'a str>,
    pub(super) of_claim: Option<f64>,
    pub(super) peer_cases: usize,
    pub(super) peer_wrong: usize,
    pub(super) peer_refused: usize,
    pub(super) peer_worst: Option<f64>,
    pub(super) seconds: f64,
    pub(super) counts: &'a BTreeMap<&'static str, u64>,
}

impl<'a> Row<'a> {
    pub(super) fn of(outcome: &'a Outcome) -> Self {
        let peers = || outcome.peer_cases().map(|(_, peer)| peer);
        Self {
            family: outcome.family,
            cases: outcome.cases.len(),
            failed: outcome.failed(),
            worst: outcome.worst().map(|(_, figure)| figure),
            worst_case: outcome.worst().map(|(case, _)| case.name.as_str()),
            of_claim: outcome.worst_of_claim(),
            peer_cases: peers().count(),
            peer_wrong: peers().filter(|peer| peer.wrong).count(),
            peer_refused: peers().filter(|peer| peer.refused).count(),
            peer_worst: outcome.peer_worst(),
            seconds: outcome.time.as_secs_f64(),
            counts: &outcome.counts,
        }
    }

    /// The line for people, below [`heading`].
    pub(super) fn text(&self) -> String {
        let parry = match self.peer_cases {
            0 => ["-", "-", "-"].map(str::to_owned),
            _ => [
                format!("{} of {}", self.peer_wrong, self.peer_cases),
                self.peer_refused.to_string(),
                number(self.peer_worst),
            ],
        };
        format!(
            "{:<10}  {:>6}  {:>6}  {:>8}  {:>8}  {:>12}  {:>7}  {:>11}  {:>7.2}",
            self.family,
            self.cases,
            self.failed,
            number(self.worst),
            number(self.of_claim),
            parry[0],
            parry[1],
            parry[2],
            self.seconds
        )
    }
}

/// What the columns of [`Row::text`] mean.
pub(super) fn heading() -> String {
    format!(
        "{:<10}  {:>6}  {:>6}  {:>8}  {:>8}  {:>12}  {:>7}  {:>11}  {:>7}",
        "family",
        "cases",
        "failed",
        "worst",
        "of claim",
        "parry wrong",
        "refused",
        "parry worst",
        "seconds"
    )
}

/// As people read it: three digits are more than enough.
pub(super) fn number(value: Option<f64>) -> String {
    match value {
        None => "-".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(x) if (0.01..1000.0).contains(&x) => format!("{x:.2}"),
        Some(x) => format!("{x:.1e}"),
    }
}

/// A family, before it is run.
#[derive(Debug, Serialize)]
pub(super) struct Listed {
    family: &'static str,
    #[serde(rename = "asked")]
    question: &'static str,
    made: &'static str,
    fails: &'static str,
    figure: &'static str,
}

impl Listed {
    pub(super) fn of(family: &Family) -> Self {
        let Family { name, question, made, fails, figure, .. } = *family;
        Self { family: name, question, made, fails, figure }
    }

    pub(super) fn text(&self) -> String {
        let Self { family, question, made, fails, figure } = self;
        format!(
            "{family}\n  question  {question}\n  made      {made}\n  fails     {fails}\n  figure    {figure}\n"
        )
    }
}

/// Reads back to the bit.
fn figure(value: Option<f64>) -> String {
    cell(value.map(|value| format!("{value:e}")))
}

/// All families, below a line of names. Figures are written so that they read back to the bit.
pub(super) fn csv(outcomes: &[FamilyOutcome]) -> String {
    let mut text =
        "family,cases,failed,worst,worst_case,of_claim,peer_cases,peer_wrong,peer_refused,\
                    peer_worst,seconds\n"
            .to_owned();
    for (_, outcome) in outcomes {
        let row = Row::of(outcome);
        let peer = |count: usize| cell((row.peer_cases > 0).then_some(count));
        let cells = [
            row.family.to_owned(),
            row.cases.to_string(),
            row.failed.to_string(),
            figure(row.worst),
            quoted(row.worst_case.unwrap_or_default()),
            figure(row.of_claim),
            peer(row.peer_cases),
            peer(row.peer_wrong),
            peer(row.peer_refused),
            figure(row.peer_worst),
            row.seconds.to_string(),
        ];
        text += &cells.join(",");
        text.push('\n');
    }
    text
}

/// Every case of every family.
pub(super) fn cases_csv(outcomes: &[FamilyOutcome]) -> String {
    let mut text =
        "family,case,asked,truth,told,passed,faults,figure,of_claim,peer_told,peer_wrong,\
                    peer_refused,peer_figure\n"
            .to_owned();
    for (family, outcome) in outcomes {
        for (index, case) in outcome.cases.iter().enumerate() {
            text += &case_row(family.name, index, case);
            text.push('\n');
        }
    }
    text
}

fn case_row(family: &str, index: usize, case: &Case) -> String {
    let peer = case.peer.as_ref();
    [
        family.to_owned(),
        index.to_string(),
        quoted(&case.name),
        quoted(&case.truth),
        quoted(&case.answer),
        case.faults.is_empty().to_string(),
        quoted(&case.faults.join("; ")),
        figure(case.figure),
        figure(case.of_claim),
        quoted(peer.map_or("", |peer| &peer.answer)),
        cell(peer.map(|peer| peer.wrong)),
        cell(peer.map(|peer| peer.refused)),
        figure(peer.and_then(|peer| peer.figure)),
    ]
    .join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [None, Some(0.0), Some(0.25), Some(1.5e-20)].map(number);
        assert_eq!(texts, ["-", "0", "0.25", "1.5e-20"]);
    }
}
