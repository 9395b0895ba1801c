//! The drawings: what each step cost, over the steps; and what steps cost beside how deep bodies
//! sank into each other.

use plotters::prelude::*;

use super::figures::{RunFigures, StepTimes};
use crate::chart::{
    Area, BLUE, CAPTION, Failed, GREEN, GREY, LABEL, ORANGE, PURPLE, SKY, VERMILION, Words, YELLOW,
    decades, legend, log_axes, plain, svg,
};
use crate::failure::Failure;

const SIZE: (u32, u32) = (1180, 540);

/// Steps that take no time that a clock sees are drawn here: there is no zero on a logarithmic
/// axis.
const FLOOR_MS: f64 = 1e-3;

/// Points a line at most; each is the median of the steps that it stands for.
const POINTS: usize = 400;

const COLORS: [RGBColor; 8] = [BLUE, VERMILION, GREEN, PURPLE, SKY, ORANGE, GREY, YELLOW];

/// Marks on the axis of steps at most: whole numbers, where there are few steps.
const MARKS: usize = 11;

/// Pixels on the right for the names of the lines.
const NAMES: u32 = 270;

/// Depths up to this share of the greatest are drawn here: there is no zero on a logarithmic axis.
const FLOOR_DEPTH: f64 = 1e-5;

const OUTCOME_SIZE: (u32, u32) = (760, 380);

/// Time of a step against the deepest overlap, a mark a detector, as SVG; `None` where nobody
/// overlapped or no detector came to the end.
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn outcome(rows: &[RunFigures]) -> Result<Option<String>, Failure> {
    let place = |row: &RunFigures| Some((row.step_ms?.mean, row.deepest.as_ref()?.depth));
    let marks: Vec<(String, (f64, f64))> = rows
        .iter()
        // A body that lies within another has no depth, and one that fell through has none left.
        .filter(|row| row.failure.is_none() && row.contained.is_none() && row.left.is_empty())
        .filter_map(|row| Some((row.name(), place(row)?)))
        .collect();
    let deepest = marks.iter().map(|(_, (_, depth))| *depth).fold(0.0, f64::max);
    if deepest == 0.0 {
        return Ok(None);
    }
    let floored = |(ms, depth): (f64, f64)| (ms.max(FLOOR_MS), depth.max(FLOOR_DEPTH * deepest));
    let marks: Vec<_> = marks.into_iter().map(|(name, at)| (name, floored(at))).collect();
    svg(OUTCOME_SIZE, |area| draw_outcome(area, &marks)).map(Some)
}

fn draw_outcome(area: &Area<'_>, marks: &[(String, (f64, f64))]) -> Result<(), Failed> {
    let (xs, ys) =
        (decades(marks.iter().map(|(_, at)| at.0)), decades(marks.iter().map(|(_, at)| at.1)));
    let words = Words {
        caption: "Deepest overlap by the time of a step",
        x: "mean time of a step, milliseconds",
        y: "deepest overlap, units of the scene",
    };
    let mut chart = log_axes(area, (xs, ys), &words, plain)?;
    for ((name, at), color) in marks.iter().zip(COLORS.into_iter().cycle()) {
        let text = Text::new(name.clone(), (9, -7), ("sans-serif", 14).into_font().color(&color));
        let mark = EmptyElement::at(*at) + Circle::new((0, 0), 5, color.filled()) + text;
        chart.draw_series([mark])?;
    }
    Ok(())
}

/// The chart of a scene's steps as SVG.
///
/// # Errors
///
/// What the drawing library says.
pub(super) fn drawn(scene: &str, rows: &[RunFigures]) -> Result<String, Failure> {
    svg(SIZE, |area| draw(area, scene, rows))
}

fn draw(area: &Area<'_>, scene: &str, rows: &[RunFigures]) -> Result<(), Failed> {
    let lines: Vec<Vec<(f64, f64)>> = rows.iter().map(|row| thinned(&row.times)).collect();
    let values = || lines.iter().flatten().map(|point| point.1);
    let (least, most) = (values().fold(f64::MAX, f64::min), values().fold(FLOOR_MS, f64::max));
    let steps = rows.iter().map(|row| row.times.len()).max().unwrap_or(0).max(1) as f64;
    let caption = format!("{scene}: time of a step (broad phase, narrow phase, solver)");
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .margin_right(NAMES)
        .caption(caption, CAPTION)
        .x_label_area_size(48)
        .y_label_area_size(72)
        .build_cartesian_2d(0.0..steps, (0.7 * least.min(most)..1.5 * most).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.05))
        .bold_line_style(BLACK.mix(0.15))
        .x_labels((steps as usize + 1).min(MARKS))
        .x_desc("step")
        .y_desc("milliseconds")
        .label_style(LABEL)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("{y}"))
        .draw()?;
    let colors = || COLORS.into_iter().cycle();
    for (line, color) in lines.into_iter().zip(colors()) {
        chart.draw_series(LineSeries::new(line, color.stroke_width(2)))?;
    }
    let corner = ((SIZE.0 - NAMES + 10) as i32, 70);
    legend(area, corner, rows.iter().map(RunFigures::name).zip(colors()))
}

/// Steps and their milliseconds, neighbours taken together where there are many.
fn thinned(times: &[StepTimes]) -> Vec<(f64, f64)> {
    let stride = times.len().div_ceil(POINTS).max(1);
    let chunks = times.chunks(stride).enumerate();
    chunks
        .map(|(i, chunk)| {
            let mut ms: Vec<f64> = chunk.iter().map(StepTimes::total).collect();
            ms.sort_unstable_by(f64::total_cmp);
            ((i * stride) as f64, ms[ms.len() / 2].max(FLOOR_MS))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_steps_are_drawn_as_few_points() {
        let times: Vec<StepTimes> =
            (0..1_000).map(|i| StepTimes { narrow: f64::from(i), ..Default::default() }).collect();
        let points = thinned(&times);
        assert_eq!((points.len(), points[1]), (334, (3.0, 4.0)));
        assert_eq!(thinned(&times[..1]), [(0.0, FLOOR_MS)]);
    }
}
