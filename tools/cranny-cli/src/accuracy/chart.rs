//! The drawings: the error by the time spent on it, and by the frames at rest.

mod methods;
mod rest;

use std::ops::Range;

use crate::chart::{Area, Failed, LogChart, Words, log_axes};

pub(super) use methods::of_methods;
pub(super) use rest::of_rest;

const SIZE: (u32, u32) = (1180, 480);

/// Pixels on the right for the names of the lines.
const NAMES: u32 = 210;

/// Errors up to this share of a body's size are drawn here, as exact: there is no zero on a
/// logarithmic axis. Smaller: rounding spreads over half the chart; larger: single precision
/// (1e-7) counts as exact.
const FLOOR: f64 = 1e-8;

/// Axes around all values of the one, and all errors.
fn axes<'a, 'b>(
    area: &'a Area<'b>,
    xs: impl Iterator<Item = f64>,
    words: &Words,
) -> Result<LogChart<'a, 'b>, Failed> {
    let xs: Vec<f64> = xs.collect();
    log_axes(area, (span(&xs), 0.15 * FLOOR..2.0), words, &percent)
}

/// Smaller shares are written with an exponent.
const SHORT: f64 = 1e-6;

/// A share in words, to two digits.
pub(super) fn percent(share: f64) -> String {
    match share {
        share if share <= 1.5 * FLOOR => "exact".to_owned(),
        share if share < SHORT => format!("{:.0e} %", 100.0 * share),
        share => format!("{} %", rounded(100.0 * share)),
    }
}

/// Two significant digits.
pub(super) fn rounded(x: f64) -> f64 {
    if x == 0.0 {
        return 0.0;
    }
    let digits = (1.0 - x.abs().log10().floor()) as i32;
    (x * 10f64.powi(digits)).round() / 10f64.powi(digits)
}

/// A little beyond all values.
fn span(values: &[f64]) -> Range<f64> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    if least <= most { 0.5 * least..3.0 * most } else { 1.0..10.0 }
}

/// An error as it is drawn.
fn floored(error: f64) -> f64 {
    error.max(FLOOR)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_reach_beyond_all_values_and_stand_without_any() {
        assert_eq!(span(&[2.0, 8.0, 4.0]), 1.0..24.0);
        assert_eq!(span(&[]), 1.0..10.0);
    }

    #[test]
    fn what_is_exact_lies_on_the_floor_and_is_called_so() {
        assert_eq!((floored(0.0), floored(0.5)), (FLOOR, 0.5));
        let said = [1.0, 0.52356, 0.1, 1.234e-3, 1e-6, 1e-7, FLOOR].map(percent);
        let words = ["100 %", "52 %", "10 %", "0.12 %", "0.0001 %", "1e-5 %", "exact"];
        assert_eq!(said, words);
    }
}
