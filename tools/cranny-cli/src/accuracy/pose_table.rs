//! Each method's answer at each pose: a table for programs.

use super::figures::witness_error;
use super::method::{Name, PoseAnswer};
use super::series::Reply;
use super::truth::Truth;
use crate::csv::cell;

const COLUMNS: &str =
    "pose,us,tests,told,meets,at_least,at_most,told_distance,distance,witness_error";

/// The table, begun.
pub(super) struct PoseTable(String);

impl PoseTable {
    pub(super) fn new() -> Self {
        Self(format!("{},{COLUMNS}\n", Name::COLUMNS))
    }

    /// Adds a line for each pose that a method answered at.
    pub(super) fn add(&mut self, name: &Name, replies: &[Reply<PoseAnswer>], truths: &[Truth]) {
        let name = name.csv();
        for reply in replies {
            self.0 += &format!("{name},{}\n", row(reply, &truths[reply.pose]));
        }
    }

    pub(super) fn csv(&self) -> &str {
        &self.0
    }
}

fn row(reply: &Reply<PoseAnswer>, truth: &Truth) -> String {
    let found = &reply.found;
    [
        reply.pose.to_string(),
        reply.micros().to_string(),
        cell(found.tests),
        word(found.meets).to_owned(),
        word(Some(truth.meets)).to_owned(),
        cell(found.held.map(|held| held.lo)),
        cell(found.held.map(|held| held.hi)),
        cell(found.distance),
        truth.distance.to_string(),
        cell(witness_error(truth, found)),
    ]
    .join(",")
}

fn word(meets: Option<bool>) -> &'static str {
    match meets {
        Some(true) => "meets",
        Some(false) => "apart",
        None => "open",
    }
}
