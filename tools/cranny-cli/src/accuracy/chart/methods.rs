//! Time against error, method by method: where bodies are apart, and where they overlap.

use plotters::prelude::*;

use super::{NAMES, SIZE, axes, floored};
use crate::accuracy::figures::MethodFigures;
use crate::accuracy::panel::Panel;
use crate::chart::labels::{Field, Pixel, Room};
use crate::chart::{
    Area, BLUE, Failed, GREY, LogChart, ORANGE, PURPLE, RADIUS, SKY, Sign, VERMILION, Words, frame,
    marks, name, svg,
};
use crate::failure::Failure;

/// A name that finds no room this near to its mark, in pixels, is left out: the table has it.
const REACH: f64 = 26.0;

/// A point that is no better than this share of the error of a quicker one is left out: a line
/// shows what more time buys.
const BETTER: f64 = 0.99;

/// One kind of poses.
struct PanelChart {
    words: Words,
    of: fn(&MethodFigures) -> &Panel,
}

const CHARTS: [PanelChart; 2] = [
    PanelChart {
        words: Words {
            caption: "Bodies apart: their distance",
            x: "mean time of a pose, µs",
            y: "error / size of the smaller body",
        },
        of: |row| &row.apart,
    },
    PanelChart {
        words: Words {
            caption: "Bodies that overlap: how deep",
            x: "mean time of a pose, µs",
            y: "error / size of the smaller body",
        },
        of: |row| &row.overlapping,
    },
];

/// One line of the chart, or a dot.
struct MethodLine {
    name: &'static str,
    color: RGBColor,
    /// With memory, or without choice: filled dots.
    filled: bool,
    belongs: fn(&MethodFigures) -> bool,
}

// The colours of parry are those of its detectors in `compare`.
const LINES: [MethodLine; 8] = [
    MethodLine {
        name: "levels, warm",
        color: BLUE,
        filled: true,
        belongs: |row| row.name.is_level() && row.name.is_warm(),
    },
    MethodLine {
        name: "levels, cold",
        color: BLUE,
        filled: false,
        belongs: |row| row.name.is_level() && !row.name.is_warm(),
    },
    MethodLine {
        name: "budgets of tests, warm",
        color: SKY,
        filled: true,
        belongs: |row| row.name.budget.is_some() && row.name.is_warm(),
    },
    MethodLine {
        name: "budgets of tests, cold",
        color: SKY,
        filled: false,
        belongs: |row| row.name.budget.is_some() && !row.name.is_warm(),
    },
    MethodLine {
        name: "budgets of time, warm",
        color: ORANGE,
        filled: true,
        belongs: |row| row.name.deadline_us.is_some() && row.name.is_warm(),
    },
    MethodLine {
        name: "budgets of time, cold",
        color: ORANGE,
        filled: false,
        belongs: |row| row.name.deadline_us.is_some() && !row.name.is_warm(),
    },
    MethodLine {
        name: "parry, triangle mesh",
        color: VERMILION,
        filled: true,
        belongs: |row| row.name.method == "parry-trimesh",
    },
    MethodLine {
        name: "parry, convex pieces",
        color: PURPLE,
        filled: true,
        belongs: |row| row.name.method == "parry-decomposition",
    },
];

/// A method's place in a panel.
type Spot<'a> = (&'a MethodFigures, (f64, f64));

/// The places of one line, by ascending time, each more exact than those before.
fn front<'a>(all: &'a [MethodFigures], line: &MethodLine, kind: &PanelChart) -> Vec<Spot<'a>> {
    let place = |row: &MethodFigures| {
        let panel = (kind.of)(row);
        Some((panel.mean_us?, floored(panel.error?)))
    };
    let rows = all.iter().filter(|row| (line.belongs)(row));
    let mut spots: Vec<Spot> = rows.filter_map(|row| Some((row, place(row)?))).collect();
    spots.sort_by(|(_, p), (_, q)| p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1)));
    let mut least = f64::INFINITY;
    spots.retain(|(_, (_, error))| {
        let is_better = *error <= BETTER * least;
        least = least.min(*error);
        is_better
    });
    spots
}

/// The chart as SVG.
///
/// # Errors
///
/// What the drawing library says.
pub(in crate::accuracy) fn of_methods(all: &[MethodFigures]) -> Result<String, Failure> {
    svg(SIZE, |area| draw(area, all))
}

fn draw(area: &Area<'_>, all: &[MethodFigures]) -> Result<(), Failed> {
    let (drawing, legend) = area.split_horizontally(SIZE.0 - NAMES);
    let shown: Vec<&PanelChart> =
        CHARTS.iter().filter(|kind| all.iter().any(|row| (kind.of)(row).error.is_some())).collect();
    let panels = drawing.split_evenly((1, shown.len().max(1)));
    for (kind, panel) in shown.iter().zip(&panels) {
        draw_kind(panel, all, kind)?;
    }
    let used = LINES.iter().filter(|line| all.iter().any(|row| (line.belongs)(row)));
    let names = used.map(|line| (line.name.to_owned(), (Sign::Dot, dot(line))));
    let is_partial = |kind: &PanelChart| all.iter().any(|row| (kind.of)(row).is_partial());
    let fewer = shown.iter().any(|kind| is_partial(kind));
    let partial = ("timed on fewer poses".to_owned(), (Sign::Triangle, GREY.filled()));
    marks(&legend, (12, 70), names.chain(fewer.then_some(partial)))
}

fn draw_kind(area: &Area<'_>, all: &[MethodFigures], kind: &PanelChart) -> Result<(), Failed> {
    let fronts: Vec<(&MethodLine, Vec<Spot>)> =
        LINES.iter().map(|line| (line, front(all, line, kind))).collect();
    let times = fronts.iter().flat_map(|(_, spots)| spots.iter().map(|spot| spot.1.0));
    let mut chart = axes(area, times, &kind.words)?;
    for (line, spots) in &fronts {
        for ends in spots.windows(2) {
            // Nothing lies between an error and none: there the line is a hint.
            let is_hint = floored(0.0) == ends[1].1.1;
            let strength = if line.filled { 0.9 } else { 0.4 } * if is_hint { 0.3 } else { 1.0 };
            let style = line.color.mix(strength).stroke_width(if is_hint { 1 } else { 2 });
            chart.draw_series(LineSeries::new(ends.iter().map(|spot| spot.1), style))?;
        }
    }
    // From here on pixels count: those of the whole drawing.
    let root = area.use_screen_coord();
    let mut field = field(&chart, &fronts);
    for (line, spots) in &fronts {
        for (row, at) in spots {
            let sign = if (kind.of)(row).is_partial() { Sign::Triangle } else { Sign::Dot };
            sign.draw(&root, chart.backend_coord(at), dot(line))?;
        }
        // Those of cold lines are called as the warm are.
        for (row, at) in spots.iter().filter(|(row, _)| line.filled && row.name.is_ours()) {
            let label = row.name.label();
            if let Some(placing) = field.place(chart.backend_coord(at), RADIUS, &label) {
                name(&root, &placing, &label, line.color)?;
            }
        }
    }
    Ok(())
}

/// Marks and lines, of which names keep clear.
fn field(chart: &LogChart<'_, '_>, fronts: &[(&MethodLine, Vec<Spot>)]) -> Field {
    let pixels: Vec<Vec<Pixel>> = fronts
        .iter()
        .map(|(_, spots)| spots.iter().map(|spot| chart.backend_coord(&spot.1)).collect())
        .collect();
    let marks = pixels.iter().flatten().map(|at| Room::of_mark(*at, RADIUS)).collect();
    let lines = pixels.iter().flat_map(|line| line.windows(2).map(|ends| [ends[0], ends[1]]));
    Field::new(frame(chart), marks, lines.collect(), REACH)
}

fn dot(line: &MethodLine) -> ShapeStyle {
    if line.filled { line.color.filled() } else { line.color.stroke_width(2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::chart::FLOOR;
    use crate::accuracy::method::Name;

    #[test]
    fn a_line_rises_in_time_and_falls_in_error() {
        let row = |us: f64, error: f64| {
            let name = Name { level: Some("tree:3".into()), ..Name::of_peer("cranny") };
            let apart = Panel { mean_us: Some(us), error: Some(error), ..Panel::default() };
            MethodFigures { apart, ..MethodFigures::none(name, String::new()) }
        };
        let all = [row(3.0, 0.5), row(1.0, 0.25), row(9.0, 0.0), row(2.0, 0.249), row(5.0, 0.125)];
        let line = front(&all, &LINES[1], &CHARTS[0]);
        let places: Vec<(f64, f64)> = line.iter().map(|spot| spot.1).collect();
        assert_eq!(places, [(1.0, 0.25), (5.0, 0.125), (9.0, FLOOR)]);
        assert!(front(&all, &LINES[0], &CHARTS[0]).is_empty(), "no warm ones");
        assert!(front(&all, &LINES[1], &CHARTS[1]).is_empty(), "none that overlap");
    }
}
