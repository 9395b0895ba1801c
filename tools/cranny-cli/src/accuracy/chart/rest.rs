//! The error about bodies at rest, frame after frame.

use plotters::prelude::*;

use super::{NAMES, SIZE, axes, floored};
use crate::accuracy::refinement::Rested;
use crate::chart::{
    Area, BLUE, Failed, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, Words, legend, svg,
};
use crate::failure::Failure;

const COLORS: [RGBColor; 7] = [SKY, BLUE, GREEN, ORANGE, VERMILION, PURPLE, GREY];

const WORDS: Words = Words {
    caption: "Bodies at rest: what a budget leaves open is narrowed in the next frame",
    x: "frames at one place",
    y: "width of the interval / size",
};

/// The chart as SVG.
///
/// # Errors
///
/// What the drawing library says.
pub(in crate::accuracy) fn of_rest(all: &[Rested]) -> Result<String, Failure> {
    svg(SIZE, |area| draw(area, all))
}

fn draw(area: &Area<'_>, all: &[Rested]) -> Result<(), Failed> {
    let (drawing, names) = area.split_horizontally(SIZE.0 - NAMES);
    let lines: Vec<(String, Vec<(f64, f64)>)> = all
        .chunk_by(|one, next| one.budget == next.budget)
        .map(|rows| (format!("{} tests a frame", rows[0].budget), line(rows)))
        .collect();
    let frames = lines.iter().flat_map(|line| line.1.iter().map(|point| point.0));
    let mut chart = axes(&drawing, frames, &WORDS)?;
    let colors = || COLORS.into_iter().cycle();
    for ((_, line), color) in lines.iter().zip(colors()) {
        chart.draw_series(LineSeries::new(line.iter().copied(), color.stroke_width(2)))?;
        chart.draw_series(line.iter().map(|at| Circle::new(*at, 2, color.filled())))?;
    }
    legend(&names, (12, 70), lines.into_iter().map(|line| line.0).zip(colors()))
}

fn line(rows: &[Rested]) -> Vec<(f64, f64)> {
    rows.iter().filter_map(|row| Some((row.frame as f64, floored(row.share_mean?)))).collect()
}
