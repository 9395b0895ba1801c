//! The figures as tables: one for programs, one for people.

use super::figures::MethodFigures;
use super::method::Name;
use crate::csv::{cell, quoted, table};

const COLUMNS: &str = "poses,median_us,p99_us,tests_mean,false_negatives,false_positives,open,outside,\
width_mean,width_max,distance_error_mean,distance_error_max,witness_error_mean,witness_error_max,\
contact_poses,contact_median_us,contact_p99_us,contacts_mean,contacts_missed,contact_error_mean,\
contact_error_max,apart_poses,apart_mean_us,apart_error,apart_error_max,apart_wrong,apart_open,\
overlapping_poses,overlapping_mean_us,overlapping_error,overlapping_error_max,overlapping_wrong,overlapping_open,\
note";

/// All rows, below a line of names. Numbers are written so that they read back to the bit.
pub(super) fn csv(all: &[MethodFigures]) -> String {
    table(&format!("{},{COLUMNS}", Name::COLUMNS), all.iter().map(MethodFigures::csv))
}

impl MethodFigures {
    fn csv(&self) -> String {
        [
            self.name.csv(),
            self.poses.to_string(),
            cell(self.median_us),
            cell(self.p99_us),
            cell(self.tests_mean),
            self.false_negatives.to_string(),
            self.false_positives.to_string(),
            self.open.to_string(),
            self.outside.to_string(),
            cell(self.width_mean),
            cell(self.width_max),
            cell(self.distance_error_mean),
            cell(self.distance_error_max),
            cell(self.witness_error_mean),
            cell(self.witness_error_max),
            self.contact_poses.to_string(),
            cell(self.contact_median_us),
            cell(self.contact_p99_us),
            cell(self.contacts_mean),
            self.contacts_missed.to_string(),
            cell(self.contact_error_mean),
            cell(self.contact_error_max),
            self.apart.poses.to_string(),
            cell(self.apart.mean_us),
            cell(self.apart.error),
            cell(self.apart.error_max),
            self.apart.wrong.to_string(),
            self.apart.open.to_string(),
            self.overlapping.poses.to_string(),
            cell(self.overlapping.mean_us),
            cell(self.overlapping.error),
            cell(self.overlapping.error_max),
            self.overlapping.wrong.to_string(),
            self.overlapping.open.to_string(),
            cell(self.note.as_deref().map(quoted)),
        ]
        .join(",")
    }

    /// The line for people, below [`heading`].
    pub(super) fn text(&self) -> String {
        if let Some(note) = &self.note {
            return format!("{:<20}  {:<4}  {note}", self.name.label(), self.name.memory);
        }
        let dash = || "-".to_owned();
        let short = |value: Option<f64>| value.map_or_else(dash, |x| format!("{x:.2e}"));
        let micros = |value: Option<f64>| value.map_or_else(dash, |x| format!("{x:.1}"));
        let tests = self.tests_mean.map_or_else(dash, |x| format!("{x:.0}"));
        line([
            &self.name.label(),
            self.name.memory,
            &self.poses.to_string(),
            &micros(self.median_us),
            &micros(self.p99_us),
            &tests,
            &self.false_negatives.to_string(),
            &self.false_positives.to_string(),
            &self.open.to_string(),
            &short(self.width_mean),
            &short(self.distance_error_mean),
            &short(self.witness_error_mean),
            &micros(self.contact_median_us),
            &self.contacts_missed.to_string(),
            &short(self.contact_error_mean),
        ])
    }
}

/// What the columns of [`MethodFigures::text`] mean.
pub(super) fn heading() -> String {
    line([
        "level, budget",
        "",
        "poses",
        "median us",
        "p99 us",
        "tests",
        "miss",
        "false",
        "open",
        "width",
        "distance",
        "witness",
        "contact us",
        "lost",
        "contact",
    ])
}

const WIDTHS: [usize; 15] = [20, 4, 5, 9, 9, 8, 4, 5, 5, 8, 8, 8, 10, 4, 8];

fn line(cells: [&str; 15]) -> String {
    let padded = cells.iter().zip(WIDTHS).enumerate().map(|(i, (cell, width))| match i {
        0 | 1 => format!("{cell:<width$}"),
        _ => format!("{cell:>width$}"),
    });
    padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
}
