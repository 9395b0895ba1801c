//! The drawing: what each step cost, over the steps.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::figures::{Figures, StepTimes};

const SIZE: (u32, u32) = (960, 540);

/// Steps that take no time that a clock sees are drawn here: there is no zero on a logarithmic axis.
const FLOOR_MS: f64 = 1e-3;

/// Points a line at most; each is the median of the steps that it stands for.
const POINTS: usize = 400;

/// Colours that stay apart for whoever confuses red and green (Okabe and Ito, 2008).
const COLORS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(90, 90, 90),
    RGBColor(240, 228, 66),
];

/// The chart as SVG.
///
/// # Errors
///
/// What the drawing library says.
pub(super) fn drawn(rows: &[Figures]) -> Result<String, String> {
    let mut svg = String::new();
    draw(&SVGBackend::with_string(&mut svg, SIZE).into_drawing_area(), rows)
        .map_err(|error| error.to_string())?;
    Ok(svg)
}

type Failed<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

fn draw<'a>(area: &DrawingArea<SVGBackend<'a>, Shift>, rows: &[Figures]) -> Result<(), Failed<'a>> {
    let lines: Vec<Vec<(f64, f64)>> = rows.iter().map(|row| thinned(&row.times)).collect();
    let values = || lines.iter().flatten().map(|point| point.1);
    let (least, most) = (values().fold(f64::MAX, f64::min), values().fold(FLOOR_MS, f64::max));
    let steps = rows.iter().map(|row| row.times.len()).max().unwrap_or(0).max(1) as f64;
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .caption("Time of a step: broad phase, narrow phase, solver", ("sans-serif", 22))
        .x_label_area_size(48)
        .y_label_area_size(72)
        .build_cartesian_2d(0.0..steps, (0.7 * least.min(most)..1.5 * most).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.05))
        .bold_line_style(BLACK.mix(0.15))
        .x_desc("step")
        .y_desc("milliseconds")
        .label_style(("sans-serif", 14))
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("{y}"))
        .draw()?;
    for ((row, line), color) in rows.iter().zip(lines).zip(COLORS.iter().cycle()) {
        let style = color.stroke_width(2);
        chart
            .draw_series(LineSeries::new(line, style))?
            .label(row.name())
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font(("sans-serif", 14))
        .draw()?;
    area.present()
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
