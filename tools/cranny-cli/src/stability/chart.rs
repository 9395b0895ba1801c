//! The drawing: the worst figure of each family, ours and parry's, on one logarithmic axis.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::FamilyOutcome;
use super::rows::Row;
use crate::chart::{Area, BLUE, CAPTION, Failed, GREEN, LABEL, VERMILION, svg};
use crate::failure::Failure;

const WIDTH: u32 = 960;

/// Height of a family's row, and of all that is not rows.
const ROW: u32 = 44;
const FRAME: u32 = 120;

/// Figures below are drawn here: there is no zero on a logarithmic axis.
const FLOOR: f64 = 1e-20;

/// Where the axis ends.
const CEILING: f64 = 10.0;

/// The chart as SVG.
///
/// # Errors
///
/// What the drawing library says.
pub(super) fn drawn(outcomes: &[FamilyOutcome]) -> Result<String, Failure> {
    svg((WIDTH, FRAME + ROW * outcomes.len() as u32), |area| draw(area, outcomes))
}

fn draw(area: &Area<'_>, outcomes: &[FamilyOutcome]) -> Result<(), Failed> {
    let count = outcomes.len() as f64;
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .margin_right(210)
        .caption("Worst figure of each family of hard cases", CAPTION)
        .x_label_area_size(48)
        .y_label_area_size(90)
        .build_cartesian_2d((FLOOR..CEILING).log_scale(), 0.0..count)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .y_labels(0)
        .x_labels(12)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("figure in sizes of the larger body: mostly the error of a distance (what is 0 stands at 1e-20)")
        .label_style(LABEL)
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .draw()?;
    for (i, (_, outcome)) in outcomes.iter().enumerate() {
        let y = count - i as f64 - 0.5;
        let row = Row::of(outcome);
        let dot = |x: f64, style: ShapeStyle| Circle::new((x.clamp(FLOOR, CEILING), y), 6, style);
        let ends = [(FLOOR, y), (CEILING, y)];
        chart.draw_series([PathElement::new(ends, BLACK.mix(0.08))])?;
        chart.draw_series(row.peer_worst.map(|x| dot(x, GREEN.stroke_width(2))))?;
        chart.draw_series(row.worst.map(|x| dot(x, BLUE.filled())))?;
        let style = |color: &RGBColor| LABEL.into_font().color(color);
        let left = style(&BLACK).pos(Pos::new(HPos::Right, VPos::Center));
        let name = EmptyElement::at((FLOOR, y)) + Text::new(row.family, (-10, 0), left);
        chart.plotting_area().draw(&name)?;
        let color = if row.failed == 0 { &BLUE } else { &VERMILION };
        let ours = style(color).pos(Pos::new(HPos::Left, VPos::Bottom));
        let theirs = style(&GREEN).pos(Pos::new(HPos::Left, VPos::Top));
        let failed = format!("failed: {} of {}", row.failed, row.cases);
        let wrong = match row.peer_cases {
            0 => String::new(),
            cases => format!("parry wrong: {} of {cases}", row.peer_wrong),
        };
        let beside = EmptyElement::at((CEILING, y))
            + Text::new(failed, (12, 0), ours)
            + Text::new(wrong, (12, 1), theirs);
        chart.plotting_area().draw(&beside)?;
    }
    let (x, y) = (WIDTH as i32 - 196, 30);
    for (shift, name, style, color) in
        [(0, "cranny", BLUE.filled(), BLUE), (90, "parry", GREEN.stroke_width(2), GREEN)]
    {
        area.draw(&Circle::new((x + shift, y), 6, style))?;
        let style = LABEL.into_font().color(&color);
        let style = style.pos(Pos::new(HPos::Left, VPos::Center));
        area.draw(&Text::new(name, (x + shift + 12, y), style))?;
    }
    Ok(())
}
