//! What all drawings have in common: a file in memory, colours, letters, a legend, names of marks.

pub(crate) mod labels;

use std::io;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::failure::Failure;
use labels::{Pixel, Placing, Room};

/// Colours that stay apart for whoever confuses red and green (Okabe and Ito, 2008).
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const VERMILION: RGBColor = RGBColor(213, 94, 0);
pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const PURPLE: RGBColor = RGBColor(204, 121, 167);
pub(crate) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(crate) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(crate) const GREY: RGBColor = RGBColor(90, 90, 90);
pub(crate) const YELLOW: RGBColor = RGBColor(240, 228, 66);

/// Letters of a caption, and of all else.
pub(crate) const CAPTION: (&str, u32) = ("sans-serif", 22);
pub(crate) const LABEL: (&str, u32) = ("sans-serif", 14);

/// Pixels from one line of a legend to the next.
const LEGEND_LINE: i32 = 22;

/// What is drawn on.
pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What a drawing may fail with.
pub(crate) type Failed = DrawingAreaErrorKind<io::Error>;

/// A chart whose axes are both logarithmic.
pub(crate) type LogChart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// What is written at the edges of a chart.
pub(crate) struct Words {
    pub(crate) caption: &'static str,
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
}

/// A power of ten, twice or five times one; numbers between are not written beside an axis, where
/// they would cover each other.
pub(crate) fn is_round(x: f64) -> bool {
    // Marks of an axis are products of powers, and are off by rounding.
    let leading = format!("{x:.3e}");
    ["1.000e", "2.000e", "5.000e"].iter().any(|round| leading.starts_with(round))
}

/// From a little below the power of ten below all values to a little above that above: numbers at
/// the very ends are not written.
pub(crate) fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (least, most) =
        values.fold((f64::INFINITY, 0.0f64), |(least, most), x| (least.min(x), most.max(x)));
    match least <= most && least > 0.0 {
        true => {
            let (low, high) = ((0.8 * least).log10().floor(), (1.25 * most).log10().ceil());
            0.99 * 10f64.powf(low)..1.01 * 10f64.powf(high)
        }
        false => 1.0..10.0,
    }
}

/// Logarithmic axes over ranges above 0; `mark` writes the numbers of the vertical one, where they
/// are [round](is_round).
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn log_axes<'a, 'b>(
    area: &'a Area<'b>,
    (xs, ys): (Range<f64>, Range<f64>),
    words: &Words,
    mark: &dyn Fn(f64) -> String,
) -> Result<LogChart<'a, 'b>, Failed> {
    let mut chart = ChartBuilder::on(area)
        .margin(14)
        .caption(words.caption, CAPTION)
        .x_label_area_size(48)
        .y_label_area_size(80)
        .build_cartesian_2d(xs.log_scale(), ys.log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(BLACK.mix(0.03))
        .bold_line_style(BLACK.mix(0.15))
        .x_desc(words.x)
        .y_desc(words.y)
        .label_style(LABEL)
        .x_label_formatter(&|x| if is_round(*x) { plain(*x) } else { String::new() })
        .y_label_formatter(&|y| if is_round(*y) { mark(*y) } else { String::new() })
        .draw()?;
    Ok(chart)
}

/// A power of ten as people write it: that of an axis is off by rounding.
pub(crate) fn plain(power: f64) -> String {
    let rounded = format!("{power:.0e}").parse::<f64>().unwrap_or(power);
    format!("{rounded}")
}

/// A drawing as SVG, on white.
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn svg(
    size: (u32, u32),
    draw: impl FnOnce(&Area<'_>) -> Result<(), Failed>,
) -> Result<String, Failure> {
    let mut svg = String::new();
    let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
    area.fill(&WHITE)
        .and_then(|()| draw(&area))
        .and_then(|()| area.present())
        .map_err(|error| Failure::run(format!("the chart cannot be drawn: {error}")))?;
    drop(area);
    Ok(svg)
}

/// Names lines in a column whose upper left corner is at a pixel: beside the drawing, where it
/// covers nothing.
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn legend(
    area: &Area<'_>,
    corner: Pixel,
    names: impl Iterator<Item = (String, RGBColor)>,
) -> Result<(), Failed> {
    column(area, corner, names, |area, (x, y), color| {
        area.draw(&PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)))
    })
}

/// What marks a place in a chart.
#[derive(Clone, Copy)]
pub(crate) enum Sign {
    Dot,
    Triangle,
}

/// Pixels from a mark's middle to its rim.
pub(crate) const RADIUS: i32 = 4;

impl Sign {
    /// The mark at a pixel.
    ///
    /// # Errors
    ///
    /// What the drawing library says.
    pub(crate) fn draw(self, area: &Area<'_>, at: Pixel, style: ShapeStyle) -> Result<(), Failed> {
        match self {
            Self::Dot => area.draw(&Circle::new(at, RADIUS, style)),
            Self::Triangle => {
                let (x, y) = at;
                // As large as the dot to the eye.
                let corners = [
                    (x, y - RADIUS - 1),
                    (x + RADIUS + 1, y + RADIUS),
                    (x - RADIUS - 1, y + RADIUS),
                ];
                match style.filled {
                    true => area.draw(&Polygon::new(corners, style)),
                    false => {
                        let [top, right, left] = corners;
                        area.draw(&PathElement::new([top, right, left, top], style))
                    }
                }
            }
        }
    }
}

/// Names marks in a column, as [`legend`] does lines.
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn marks(
    area: &Area<'_>,
    corner: Pixel,
    names: impl Iterator<Item = (String, (Sign, ShapeStyle))>,
) -> Result<(), Failed> {
    column(area, corner, names, |area, (x, y), (sign, style)| sign.draw(area, (x + 9, y), style))
}

/// Writes a name where it was placed, with the line that leads to it.
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn name(
    area: &Area<'_>,
    placing: &Placing,
    name: &str,
    color: RGBColor,
) -> Result<(), Failed> {
    if let Some([from, to]) = placing.leader {
        area.draw(&PathElement::new([from, to], color.mix(0.6).stroke_width(1)))?;
    }
    let Room { left, top, bottom, .. } = placing.room;
    let style = LABEL.into_font().color(&color).pos(Pos::new(HPos::Left, VPos::Center));
    area.draw(&Text::new(name.to_owned(), (left, (top + bottom) / 2), style))
}

/// The part of a chart inside its axes, in pixels of the whole drawing.
pub(crate) fn frame(chart: &LogChart<'_, '_>) -> Room {
    let (xs, ys) = chart.plotting_area().get_pixel_range();
    Room { left: xs.start, top: ys.start, right: xs.end, bottom: ys.end }
}

fn column<S>(
    area: &Area<'_>,
    (x, y): Pixel,
    names: impl Iterator<Item = (String, S)>,
    sign: impl Fn(&Area<'_>, Pixel, S) -> Result<(), Failed>,
) -> Result<(), Failed> {
    let style = LABEL.into_font().color(&BLACK).pos(Pos::new(HPos::Left, VPos::Center));
    for (i, (name, own)) in names.enumerate() {
        let y = y + LEGEND_LINE * i as i32;
        sign(area, (x, y), own)?;
        area.draw(&Text::new(name, (x + 24, y), style.clone()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_written_plainly() {
        let named = [0.000_009_999_999_999, 0.01, 1.000_000_000_1, 1e3].map(plain);
        assert_eq!(named, ["0.00001", "0.01", "1", "1000"]);
    }

    #[test]
    fn axes_run_from_power_to_power_and_name_round_numbers() {
        for (values, low, high) in
            [([0.236, 0.767], 0.1, 1.0), ([0.101, 9.5], 0.01, 100.0), ([2.0, 2.0], 1.0, 10.0)]
        {
            let Range { start, end } = decades(values.into_iter());
            assert!(start < low && start > 0.9 * low && end > high && end < 1.1 * high);
        }
        assert_eq!(decades([].into_iter()), 1.0..10.0);
        for x in [1.0, 0.1, 1e-3, 2e-2, 500.0, 1e6] {
            assert!(is_round(x), "{x}");
        }
        for x in [3.0, 0.9, 7e-3, 1.5] {
            assert!(!is_round(x), "{x}");
        }
    }
}
