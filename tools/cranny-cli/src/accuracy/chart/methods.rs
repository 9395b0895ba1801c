//! Time against error, method by method: where bodies are apart, and where they overlap.

use plotters::prelude::*;

use super::{NAMES, SIZE, axes, floored};
use crate::accuracy::figures::MethodFigures;
use crate::accuracy::panel::Panel;
use crate::chart::{Area, BLUE, Failed, ORANGE, PURPLE, SKY, VERMILION, Words, marks, svg};
use crate::failure::Failure;

/// Pixels of a name: of a letter, roughly, and of a line.
const LETTER: i32 = 7;
const LINE: i32 = 13;

/// Pixels from a dot's middle to its rim.
const DOT: i32 = 4;

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

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Room {
    left: i32,
    top: i32,
    width: i32,
}

impl Room {
    fn of_dot((x, y): (i32, i32)) -> Self {
        Self { left: x - DOT, top: y - LINE / 2, width: 2 * DOT }
    }

    fn overlaps(&self, other: &Self) -> bool {
        let beside = self.left + self.width <= other.left || other.left + other.width <= self.left;
        !beside && (self.top - other.top).abs() < LINE
    }
}

/// Where about a dot at a pixel its name covers no other, if anywhere; takes that room.
fn room((x, y): (i32, i32), name: &str, taken: &mut Vec<Room>) -> Option<Room> {
    let width = LETTER * name.len() as i32;
    let (right, left) = (x + 6, x - 6 - width);
    let (above, below) = (y - LINE - 2, y + 3);
    let places = [(right, above), (right, below), (left, above), (left, below)];
    let found = places
        .map(|(left, top)| Room { left, top, width })
        .into_iter()
        .find(|place| !taken.iter().any(|other| place.overlaps(other)))?;
    taken.push(found);
    Some(found)
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
    let names = used.map(|line| (line.name.to_owned(), dot(line)));
    marks(&legend, (12, 70), names)
}

fn draw_kind(area: &Area<'_>, all: &[MethodFigures], kind: &PanelChart) -> Result<(), Failed> {
    let fronts: Vec<(&MethodLine, Vec<Spot>)> =
        LINES.iter().map(|line| (line, front(all, line, kind))).collect();
    let times = fronts.iter().flat_map(|(_, spots)| spots.iter().map(|spot| spot.1.0));
    let mut chart = axes(area, times, &kind.words)?;
    // Names keep clear of all dots.
    let dots = fronts.iter().flat_map(|(_, spots)| spots.iter().map(|spot| spot.1));
    let mut taken: Vec<Room> = dots.map(|at| Room::of_dot(chart.backend_coord(&at))).collect();
    for (line, spots) in &fronts {
        for ends in spots.windows(2) {
            // Nothing lies between an error and none: there the line is a hint.
            let is_hint = floored(0.0) == ends[1].1.1;
            let strength = if line.filled { 0.9 } else { 0.4 } * if is_hint { 0.3 } else { 1.0 };
            let style = line.color.mix(strength).stroke_width(if is_hint { 1 } else { 2 });
            chart.draw_series(LineSeries::new(ends.iter().map(|spot| spot.1), style))?;
        }
        chart.draw_series(spots.iter().map(|(_, at)| Circle::new(*at, DOT, dot(line))))?;
        // Where there is no room a dot has no name; those of cold lines are called as the warm are.
        let text = ("sans-serif", 13).into_font().color(&line.color);
        for (row, at) in spots.iter().filter(|(row, _)| line.filled && row.name.is_ours()) {
            let (name, pixel) = (row.name.label(), chart.backend_coord(at));
            if let Some(Room { left, top, .. }) = room(pixel, &name, &mut taken) {
                let offset = (left - pixel.0, top - pixel.1);
                let name = Text::new(name, offset, text.clone());
                chart.draw_series([EmptyElement::at(*at) + name])?;
            }
        }
    }
    Ok(())
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
    fn names_keep_clear_of_each_other_or_are_left_out() {
        let mut taken = Vec::new();
        let first = room((100, 100), "tree:4", &mut taken).unwrap();
        assert_eq!((first.left, first.top, first.width), (106, 85, 42));
        for _ in 0..3 {
            assert!(room((101, 101), "tree:6", &mut taken).is_some());
        }
        assert_eq!(room((99, 100), "tree:8", &mut taken), None);
        assert_eq!(taken.len(), 4);
        assert!(taken.iter().enumerate().all(|(i, a)| taken[..i].iter().all(|b| !a.overlaps(b))));
        assert!(room((300, 100), "tree:8", &mut taken).is_some());
    }

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
