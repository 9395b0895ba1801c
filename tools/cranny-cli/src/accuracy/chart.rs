//! The drawings: what stays unknown, by the time spent on it, and by the frames at rest.

mod methods;
mod rest;

use std::ops::Range;

use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;

use crate::chart::{Area, CAPTION, Failed, LABEL};

pub(super) use methods::of_methods;
pub(super) use rest::of_rest;

const SIZE: (u32, u32) = (1100, 640);

/// Pixels on the right for the names of the lines.
const NAMES: u32 = 230;

/// Where the names begin.
const CORNER: (i32, i32) = ((SIZE.0 - NAMES + 12) as i32, 60);

/// What is known to rounding is drawn here at the lowest: there is no zero on a logarithmic axis.
const FLOOR: f64 = 1e-17;

type LogCoordinates = Cartesian2d<LogCoord<f64>, LogCoord<f64>>;

/// What is written at the edges.
struct Words {
    caption: &'static str,
    x: &'static str,
    y: &'static str,
}

/// Axes around all points.
fn axes<'a, 'b>(
    area: &'a Area<'b>,
    points: impl Iterator<Item = (f64, f64)>,
    words: &Words,
) -> Result<ChartContext<'a, SVGBackend<'b>, LogCoordinates>, Failed> {
    let (xs, ys): (Vec<f64>, Vec<f64>) = points.unzip();
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .margin_right(NAMES)
        .caption(words.caption, CAPTION)
        .x_label_area_size(48)
        .y_label_area_size(80)
        .build_cartesian_2d(span(&xs).log_scale(), span(&ys).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.05))
        .bold_line_style(BLACK.mix(0.15))
        .x_desc(words.x)
        .y_desc(words.y)
        .label_style(LABEL)
        .x_label_formatter(&|x| format!("{x}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()?;
    Ok(chart)
}

/// A little beyond all values.
fn span(values: &[f64]) -> Range<f64> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    if least <= most { 0.5 * least..2.0 * most } else { 1.0..10.0 }
}

/// As a share of the smaller body's size; `None` where nothing is known.
fn share(unknown: Option<f64>, size: f64) -> Option<f64> {
    unknown.map(|unknown| (unknown / size).max(FLOOR)).filter(|share| share.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_reach_beyond_all_values_and_stand_without_any() {
        assert_eq!(span(&[2.0, 8.0, 4.0]), 1.0..16.0);
        assert_eq!(span(&[]), 1.0..10.0);
    }

    #[test]
    fn what_is_exact_lies_on_the_floor() {
        assert_eq!((share(Some(0.0), 2.0), share(Some(1.0), 2.0)), (Some(FLOOR), Some(0.5)));
        assert_eq!((share(None, 2.0), share(Some(f64::INFINITY), 2.0)), (None, None));
    }
}
