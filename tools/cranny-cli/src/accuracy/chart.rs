//! The drawing: time against what stays unknown, both axes logarithmic.

use plotters::prelude::*;

use super::figures::Figures;
use crate::chart::{Area, BLUE, CAPTION, Failed, GREEN, LABEL, PURPLE, SKY, VERMILION, svg};
use crate::failure::Failure;

const SIZE: (u32, u32) = (960, 640);

/// What is known to rounding is drawn here at the lowest: there is no zero on a logarithmic axis.
const FLOOR: f64 = 1e-17;

/// One line of the chart, or some dots.
struct Series<'a> {
    name: &'static str,
    color: RGBColor,
    filled: bool,
    /// Whether a line through them means anything.
    joined: bool,
    rows: Vec<&'a Figures>,
}

/// Whether the level asks the walk over hulls.
fn walks(row: &Figures) -> bool {
    matches!(row.level.as_deref(), Some("hulls" | "caps"))
}

fn series(all: &[Figures]) -> Vec<Series<'_>> {
    let of = |name, color, memory: &str, belongs: fn(&Figures) -> bool| {
        let rows: Vec<&Figures> =
            all.iter().filter(|row| row.memory == memory && belongs(row)).collect();
        let filled = memory == "warm" || rows.len() == 1;
        Series { name, color, filled, joined: color != SKY, rows }
    };
    let tree: fn(&Figures) -> bool =
        |row| row.level.is_some() && row.budget.is_none() && !walks(row);
    let budget: fn(&Figures) -> bool = |row| row.budget.is_some();
    vec![
        of("boxes, trees, exact, cold", BLUE, "cold", tree),
        of("boxes, trees, exact, warm", BLUE, "warm", tree),
        of("hulls, caps, cold", SKY, "cold", walks),
        of("hulls, caps, warm", SKY, "warm", walks),
        of("budgets of tests, cold", VERMILION, "cold", budget),
        of("budgets of tests, warm", VERMILION, "warm", budget),
        of("parry, triangle mesh", GREEN, "cold", |row| row.method == "parry-trimesh"),
        of("parry, convex decomposition", PURPLE, "cold", |row| {
            row.method == "parry-decomposition"
        }),
    ]
}

/// Microseconds, and what stays unknown as a share of the smaller body's size; `None` where nothing is known.
fn place(row: &Figures, size: f64) -> Option<(f64, f64)> {
    let unknown = row.width_mean.or(row.distance_error_mean)? / size;
    unknown.is_finite().then(|| (row.median_us, unknown.max(FLOOR)))
}

/// Whether labels at two places do not cover each other.
fn is_clear_of(at: (f64, f64), other: (f64, f64)) -> bool {
    let apart = |a: f64, b: f64, factor: f64| a > b * factor || b > a * factor;
    apart(at.0, other.0, 1.25) || apart(at.1, other.1, 6.0)
}

/// The chart as SVG.
///
/// # Errors
///
/// What the drawing library says.
pub(super) fn drawn(all: &[Figures], size: f64) -> Result<String, Failure> {
    svg(SIZE, |area| draw(area, all, size))
}

fn draw(area: &Area<'_>, all: &[Figures], size: f64) -> Result<(), Failed> {
    let places: Vec<(f64, f64)> = all.iter().filter_map(|row| place(row, size)).collect();
    let span = |of: fn(&(f64, f64)) -> f64| {
        let (least, most) = places
            .iter()
            .map(of)
            .fold((f64::INFINITY, 0.0f64), |(least, most), x| (least.min(x), most.max(x)));
        if least <= most { 0.5 * least..2.0 * most } else { 1.0..10.0 }
    };
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .caption("What stays unknown, by the time spent on it", CAPTION)
        .x_label_area_size(48)
        .y_label_area_size(80)
        .build_cartesian_2d(span(|p| p.0).log_scale(), span(|p| p.1).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.05))
        .bold_line_style(BLACK.mix(0.15))
        .x_desc("median time of a pose, microseconds")
        .y_desc("interval's width (parry: error of the distance) / size of the smaller body")
        .label_style(LABEL)
        .x_label_formatter(&|x| format!("{x}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()?;
    let mut labelled: Vec<(f64, f64)> = Vec::new();
    for Series { name, color, filled, joined, rows } in series(all) {
        let points: Vec<(&Figures, (f64, f64))> =
            rows.iter().filter_map(|&row| Some((row, place(row, size)?))).collect();
        if points.is_empty() {
            continue;
        }
        let style = if filled { color.filled() } else { color.stroke_width(2) };
        chart.draw_series(LineSeries::new(
            points.iter().filter(|_| joined).map(|(_, at)| *at),
            color.mix(if filled { 0.9 } else { 0.4 }).stroke_width(2),
        ))?;
        chart
            .draw_series(points.iter().map(|(_, at)| Circle::new(*at, 4, style)))?
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 4, style));
        // Warm ones stand beside the cold ones of the same name; what is on top of others has none.
        let text = ("sans-serif", 13).into_font().color(&color);
        for (row, at) in points.into_iter().filter(|_| !filled) {
            if labelled.iter().all(|&other| is_clear_of(at, other)) {
                labelled.push(at);
                let label = Text::new(row.label(), (6, -14), text.clone());
                chart.draw_series([EmptyElement::at(at) + label])?;
            }
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .label_font(LABEL)
        .draw()
}
