//! What stays unknown of bodies at rest, frame after frame.

use plotters::prelude::*;

use super::{CORNER, SIZE, Words, axes, share};
use crate::accuracy::refinement::Rested;
use crate::chart::{Area, BLUE, Failed, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, legend, svg};
use crate::failure::Failure;

const COLORS: [RGBColor; 7] = [SKY, BLUE, GREEN, ORANGE, VERMILION, PURPLE, GREY];

const WORDS: Words = Words {
    caption: "What stays unknown of bodies at rest, frame after frame",
    x: "frames at one place",
    y: "mean width of the interval / size of the smaller body",
};

/// The chart as SVG.
///
/// # Errors
///
/// What the drawing library says.
pub(in crate::accuracy) fn of_rest(all: &[Rested], size: f64) -> Result<String, Failure> {
    svg(SIZE, |area| draw(area, all, size))
}

fn draw(area: &Area<'_>, all: &[Rested], size: f64) -> Result<(), Failed> {
    let lines: Vec<(String, Vec<(f64, f64)>)> = all
        .chunk_by(|one, next| one.budget == next.budget)
        .map(|rows| (format!("{} tests a frame", rows[0].budget), line(rows, size)))
        .collect();
    let mut chart = axes(area, lines.iter().flat_map(|line| line.1.iter().copied()), &WORDS)?;
    let colors = || COLORS.into_iter().cycle();
    for ((_, line), color) in lines.iter().zip(colors()) {
        chart.draw_series(LineSeries::new(line.iter().copied(), color.stroke_width(2)))?;
        chart.draw_series(line.iter().map(|at| Circle::new(*at, 2, color.filled())))?;
    }
    legend(area, CORNER, lines.into_iter().map(|line| line.0).zip(colors()))
}

fn line(rows: &[Rested], size: f64) -> Vec<(f64, f64)> {
    rows.iter().filter_map(|row| Some((row.frame as f64, share(row.width_mean, size)?))).collect()
}
