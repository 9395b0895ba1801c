//! The drawings: what each step cost, over the steps; and what steps cost beside how deep bodies
//! sank into each other.

use plotters::prelude::*;

use super::figures::{RunFigures, StepTimes};
use crate::chart::labels::{Field, Pixel, Room};
use crate::chart::{
    Area, BLUE, CAPTION, Failed, GREEN, GREY, LABEL, ORANGE, PURPLE, RADIUS, SKY, Sign, VERMILION,
    Words, YELLOW, decades, frame, legend, log_axes, plain, svg,
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

/// Depths up to this share of the greatest count as none. Smaller: rounding spreads over half the
/// chart; larger: overlaps that one would see are called none.
const NO_DEPTH: f64 = 1e-5;

const OUTCOME_SIZE: (u32, u32) = (900, 420);

/// Time of a step against the deepest overlap, a mark a detector.
pub(crate) struct Outcome {
    pub(crate) svg: String,
    /// Detectors that have no mark, each with the reason.
    pub(crate) unmarked: Vec<String>,
}

/// The chart of what each detector costs and leads to; `None` where nobody overlapped or no
/// detector came to the end.
///
/// # Errors
///
/// What the drawing library says.
pub(crate) fn outcome(rows: &[RunFigures]) -> Result<Option<Outcome>, Failure> {
    let mut spots = Vec::new();
    let mut unmarked = Vec::new();
    for (row, color) in rows.iter().zip(COLORS.into_iter().cycle()) {
        match place(row) {
            Ok(at) => spots.push(DetectorSpot { name: row.name(), color, at }),
            Err(why) => unmarked.push(format!("{} ({why})", row.name())),
        }
    }
    let deepest = spots.iter().map(|spot| spot.at.1).fold(0.0, f64::max);
    if deepest == 0.0 {
        return Ok(None);
    }
    let svg = svg(OUTCOME_SIZE, |area| draw_outcome(area, &spots, NO_DEPTH * deepest))?;
    Ok(Some(Outcome { svg, unmarked }))
}

/// A detector's mean time of a step and deepest overlap.
struct DetectorSpot {
    name: String,
    color: RGBColor,
    at: (f64, f64),
}

/// Where a detector's mark is, or why it has none.
fn place(row: &RunFigures) -> Result<(f64, f64), &'static str> {
    let ms = row.step_ms.ok_or("no step was made")?.mean;
    // A body that lies within another has no depth, and one that fell through has none left.
    match row.deepest.as_ref() {
        _ if row.failure.is_some() => Err("it did not finish"),
        _ if row.contained.is_some() => Err("a body lay wholly within another"),
        _ if !row.left.is_empty() => Err("a body left the world"),
        None => Err("no depth is known"),
        Some(deepest) => Ok((ms.max(FLOOR_MS), deepest.depth)),
    }
}

fn draw_outcome(area: &Area<'_>, spots: &[DetectorSpot], none: f64) -> Result<(), Failed> {
    let depths = || spots.iter().map(|spot| spot.at.1);
    let xs = decades(spots.iter().map(|spot| spot.at.0));
    let mut ys = decades(depths().filter(|&depth| depth > none));
    // No overlap is drawn a decade below all others: there is no zero on a logarithmic axis.
    let floor = 10f64.powf(ys.start.log10().round() - 1.0);
    if depths().any(|depth| depth <= none) {
        ys.start = 0.5 * floor;
    }
    let words = Words {
        caption: "Deepest overlap by the time of a step",
        x: "mean time of a step, milliseconds",
        y: "deepest overlap, units of the scene",
    };
    let mark = |y: f64| match y / floor {
        tiny if tiny < 0.9 => String::new(),
        same if same < 1.1 => "none".to_owned(),
        _ => plain(y),
    };
    let chart = log_axes(area, (xs, ys), &words, &mark)?;
    let drawn = |&(ms, depth): &(f64, f64)| (ms, if depth <= none { floor } else { depth });
    let pixels: Vec<Pixel> =
        spots.iter().map(|spot| chart.backend_coord(&drawn(&spot.at))).collect();
    let marks = pixels.iter().map(|at| Room::of_mark(*at, RADIUS)).collect();
    let mut field = Field::new(frame(&chart), marks, Vec::new(), f64::INFINITY);
    let root = area.use_screen_coord();
    for (spot, &at) in spots.iter().zip(&pixels) {
        Sign::Dot.draw(&root, at, spot.color.filled())?;
    }
    let names = pixels.into_iter().zip(spots.iter().map(|spot| &*spot.name)).collect::<Vec<_>>();
    for (spot, placing) in spots.iter().zip(field.place_all(RADIUS, &names)) {
        let Some(placing) = placing else { continue };
        crate::chart::name(&root, &placing, &spot.name, spot.color)?;
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
    use cranny_ecs::DeepestSummary;
    use cranny_rapier::Detector;

    use super::*;

    /// Times of a step in milliseconds, and deepest overlaps.
    fn rows(of: &[(Detector, f64, f64)]) -> Vec<RunFigures> {
        let row = |&(detector, ms, depth): &(Detector, f64, f64)| {
            let mut row = RunFigures::sample(detector, &[ms]);
            row.deepest = Some(DeepestSummary { depth, ..DeepestSummary::default() });
            row
        };
        of.iter().map(row).collect()
    }

    /// Text of a drawing, in pixels: left, right, and the line's middle.
    fn texts(svg: &str) -> Vec<(String, f64, f64, f64)> {
        let document = roxmltree::Document::parse(svg).unwrap();
        let texts = document.descendants().filter(|node| node.has_tag_name("text"));
        let of = |node: roxmltree::Node| {
            let number = |name| node.attribute(name).unwrap().parse::<f64>().unwrap();
            let words = node.text().unwrap().trim().to_owned();
            // Letters of sans-serif are 0.6 em wide on average.
            let width = 0.6 * number("font-size") * words.chars().count() as f64;
            let (x, y) = (number("x"), number("y"));
            (words, x, x + width, y)
        };
        texts.map(of).collect()
    }

    /// The nut on its bolt: four detectors are as deep and nearly as quick, one is at the border.
    #[test]
    fn names_of_detectors_keep_apart_and_inside() {
        let rows = rows(&[
            (Detector::Cranny, 8.653, 0.0),
            (Detector::RapierTrimesh, 21.991, 0.00324),
            (Detector::RapierTrimeshFixed, 950.0, 0.02085),
            (Detector::RapierDecomposition, 0.25, 17.37),
            (Detector::LEVELS[0], 0.107, 18.57),
            (Detector::LEVELS[1], 0.150, 16.92),
            (Detector::LEVELS[2], 0.2, 17.54),
        ]);
        let outcome = outcome(&rows).unwrap().unwrap();
        assert!(outcome.unmarked.is_empty());
        let all = texts(&outcome.svg);
        assert!(all.iter().any(|(words, ..)| words == "none"), "{all:?}");
        let names: Vec<_> =
            all.iter().filter(|(words, ..)| rows.iter().any(|row| row.name() == *words)).collect();
        assert_eq!(names.len(), rows.len());
        for (i, (name, left, right, y)) in names.iter().enumerate() {
            assert!(*left > 80.0 && *right < f64::from(OUTCOME_SIZE.0) - 10.0, "{name} {right}");
            let covers = |(_, l, r, v): &&(String, f64, f64, f64)| {
                *left < *r && *l < *right && (y - v).abs() < 12.0
            };
            assert!(!names[..i].iter().any(covers), "{names:?}");
        }
    }

    #[test]
    fn who_has_no_mark_is_named_with_the_reason() {
        let mut rows = rows(&[
            (Detector::Cranny, 1.0, 0.0),
            (Detector::RapierTrimesh, 2.0, 0.5),
            (Detector::RapierDecomposition, 3.0, 0.25),
        ]);
        rows[2].failure = Some("it panicked".to_owned());
        let drawn = outcome(&rows).unwrap().unwrap();
        assert_eq!(drawn.unmarked, ["rapier-decomposition (it did not finish)"]);
        assert!(!drawn.svg.contains("rapier-decomposition"));
        rows[1].deepest = None;
        assert!(outcome(&rows).unwrap().is_none(), "nobody overlapped");
    }

    #[test]
    fn many_steps_are_drawn_as_few_points() {
        let times: Vec<StepTimes> =
            (0..1_000).map(|i| StepTimes { narrow: f64::from(i), ..Default::default() }).collect();
        let points = thinned(&times);
        assert_eq!((points.len(), points[1]), (334, (3.0, 4.0)));
        assert_eq!(thinned(&times[..1]), [(0.0, FLOOR_MS)]);
    }
}
