//! Time against what stays unknown, method by method.

use plotters::prelude::*;

use super::{CORNER, SIZE, Words, axes, share};
use crate::accuracy::figures::MethodFigures;
use crate::chart::{Area, BLUE, Failed, GREEN, ORANGE, PURPLE, SKY, VERMILION, marks, svg};
use crate::failure::Failure;

const WORDS: Words = Words {
    caption: "What stays unknown, by the time spent on it",
    x: "median time of a pose, microseconds",
    y: "width of the interval (parry: error of the distance) / size of the smaller body",
};

/// Pixels of a name: of a letter, roughly, and of a line.
const LETTER: i32 = 7;
const LINE: i32 = 13;

/// One line of the chart, or some dots.
struct ChartSeries<'a> {
    name: &'static str,
    color: RGBColor,
    filled: bool,
    /// Whether a line through them means anything.
    joined: bool,
    points: Vec<(&'a MethodFigures, (f64, f64))>,
}

/// Whether the level asks the walk over hulls.
fn walks(row: &MethodFigures) -> bool {
    matches!(row.name.level.as_deref(), Some("hulls" | "caps"))
}

fn series(all: &[MethodFigures], size: f64) -> Vec<ChartSeries<'_>> {
    let of = |name, color, memory: &str, belongs: fn(&MethodFigures) -> bool| {
        let rows = all.iter().filter(|row| row.name.memory == memory && belongs(row));
        let points = rows.filter_map(|row| Some((row, place(row, size)?))).collect();
        let filled = memory == "warm" || matches!(color, GREEN | PURPLE);
        ChartSeries { name, color, filled, joined: color != SKY, points }
    };
    let tree: fn(&MethodFigures) -> bool = |row| row.name.is_level() && !walks(row);
    let budget: fn(&MethodFigures) -> bool = |row| row.name.budget.is_some();
    let deadline: fn(&MethodFigures) -> bool = |row| row.name.deadline_us.is_some();
    let all = [
        of("boxes, trees, exact, cold", BLUE, "cold", tree),
        of("boxes, trees, exact, warm", BLUE, "warm", tree),
        of("hulls, caps, cold", SKY, "cold", walks),
        of("hulls, caps, warm", SKY, "warm", walks),
        of("budgets of tests, cold", VERMILION, "cold", budget),
        of("budgets of tests, warm", VERMILION, "warm", budget),
        of("budgets of time, cold", ORANGE, "cold", deadline),
        of("budgets of time, warm", ORANGE, "warm", deadline),
        of("parry, triangle mesh", GREEN, "cold", |row| row.name.method == "parry-trimesh"),
        of("parry, convex pieces", PURPLE, "cold", |row| row.name.method == "parry-decomposition"),
    ];
    all.into_iter().filter(|series| !series.points.is_empty()).collect()
}

/// Microseconds, and what stays unknown as a share of the smaller body's size; `None` where nothing
/// is known.
fn place(row: &MethodFigures, size: f64) -> Option<(f64, f64)> {
    Some((row.median_us?, share(row.width_mean.or(row.distance_error_mean), size)?))
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Room {
    left: i32,
    top: i32,
    width: i32,
}

impl Room {
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
pub(in crate::accuracy) fn of_methods(all: &[MethodFigures], size: f64) -> Result<String, Failure> {
    svg(SIZE, |area| draw(area, all, size))
}

fn draw(area: &Area<'_>, all: &[MethodFigures], size: f64) -> Result<(), Failed> {
    let series = series(all, size);
    let places = series.iter().flat_map(|series| series.points.iter().map(|point| point.1));
    let mut chart = axes(area, places, &WORDS)?;
    let mut taken: Vec<Room> = Vec::new();
    for ChartSeries { color, filled, joined, points, .. } in &series {
        let style = dot(*color, *filled);
        chart.draw_series(LineSeries::new(
            points.iter().filter(|_| *joined).map(|(_, at)| *at),
            color.mix(if *filled { 0.9 } else { 0.4 }).stroke_width(2),
        ))?;
        chart.draw_series(points.iter().map(|(_, at)| Circle::new(*at, 4, style)))?;
        // Warm ones stand beside the cold ones of the same name; where there is no room a dot has
        // none.
        let text = ("sans-serif", 13).into_font().color(color);
        for (row, at) in points.iter().filter(|(row, _)| names_dot(row)) {
            let (name, pixel) = (row.name.label(), chart.backend_coord(at));
            if let Some(Room { left, top, .. }) = room(pixel, &name, &mut taken) {
                let offset = (left - pixel.0, top - pixel.1);
                let name = Text::new(name, offset, text.clone());
                chart.draw_series([EmptyElement::at(*at) + name])?;
            }
        }
    }
    marks(area, CORNER, series.iter().map(|s| (s.name.to_owned(), dot(s.color, s.filled))))
}

/// Of the peers there is one dot each, and the legend names it.
fn names_dot(row: &MethodFigures) -> bool {
    row.name.is_ours() && row.name.memory == "cold"
}

fn dot(color: RGBColor, filled: bool) -> ShapeStyle {
    if filled { color.filled() } else { color.stroke_width(2) }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
