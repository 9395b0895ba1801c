//! Plots over time as SVG that takes its colours from the page around it: the class `sN` is the
//! colour of series N, `currentColor` that of words.

use std::fmt::Write;

/// A number over time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PlotSeries {
    pub(super) name: String,
    /// Seconds, and the number.
    pub(super) points: Vec<(f64, f64)>,
}

/// Width and height of a plot, its margins, in units of the drawing; letters are 13 high.
const SIZE: [f64; 2] = [480.0, 240.0];
const LEFT: f64 = 58.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 30.0;

/// Points of a line: one a pixel.
const MOST_POINTS: usize = 400;

/// Values that differ by less than this share of their size are one value: rounding draws no hills,
/// and no axis has digits that nobody reads.
const FLAT: f64 = 1e-9;

/// How a plot treats its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    /// From 0 up.
    FromZero,
    /// Where the values are.
    Free,
}

/// The plot of some series; `None` where no series has a point.
pub(super) fn plot(series: &[PlotSeries], axis: Axis, label: &str) -> Option<String> {
    let all = || series.iter().flat_map(|series| &series.points);
    all().next()?;
    let last = all().fold(0.0f64, |last, point| last.max(point.0));
    let last = if last > 0.0 { last } else { 1.0 };
    let times = Ticks::of(0.0, last);
    let values = range(all().map(|point| point.1), axis);
    let x = |time: f64| LEFT + (SIZE[0] - LEFT - RIGHT) * time / last;
    let y = |value: f64| {
        SIZE[1] - BOTTOM - (SIZE[1] - TOP - BOTTOM) * (value - values.low) / values.span()
    };
    let mut svg = format!(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{label}\">",
        SIZE[0], SIZE[1]
    );
    let mut draw = |line: String| svg.push_str(&line);
    for (value, text) in values.marks() {
        let at = y(value);
        draw(format!("<path class=\"grid\" d=\"M{LEFT} {at:.1}H{:.1}\"/>", SIZE[0] - RIGHT));
        draw(format!(
            "<text class=\"end\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
            LEFT - 6.0,
            at + 4.5
        ));
    }
    for (time, text) in times.marks().filter(|mark| mark.0 <= last * (1.0 + FLAT)) {
        let at = x(time);
        draw(format!("<path class=\"grid\" d=\"M{at:.1} {:.1}v5\"/>", SIZE[1] - BOTTOM));
        let unit = if time == 0.0 { " s" } else { "" };
        draw(format!(
            "<text class=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{text}{unit}</text>",
            SIZE[1] - 9.0
        ));
    }
    for (number, series) in series.iter().enumerate() {
        let mut path = String::new();
        for (i, (time, value)) in thinned(&series.points).into_iter().enumerate() {
            let sign = if i == 0 { 'M' } else { 'L' };
            // Writing to a string cannot fail.
            let _ = write!(path, "{sign}{:.1} {:.1}", x(time), y(value));
        }
        draw(format!("<path class=\"line s{number}\" d=\"{path}\"/>"));
    }
    svg.push_str("</svg>");
    Some(svg)
}

/// As many points as a line can show: of each stretch the first, the least and the greatest.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let stretch = points.len().div_ceil(MOST_POINTS / 2).max(1);
    if stretch <= 2 {
        return points.to_vec();
    }
    points
        .chunks(stretch)
        .flat_map(|chunk| {
            let by_value = |p: &&(f64, f64), q: &&(f64, f64)| p.1.total_cmp(&q.1);
            let mut ends = [chunk.iter().min_by(by_value), chunk.iter().max_by(by_value)];
            ends.sort_by(|p, q| {
                p.map(|p| p.0).partial_cmp(&q.map(|q| q.0)).unwrap_or(std::cmp::Ordering::Equal)
            });
            ends.into_iter().flatten().copied()
        })
        .collect()
}

fn range(values: impl Iterator<Item = f64>, axis: Axis) -> Ticks {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = values.fold(none, |[low, high], value| [low.min(value), high.max(value)]);
    let [low, high] = match axis {
        Axis::FromZero => [low.min(0.0), high.max(0.0)],
        Axis::Free => [low, high],
    };
    let size = low.abs().max(high.abs());
    match () {
        () if size == 0.0 => Ticks::of(0.0, 1.0),
        () if high - low <= FLAT * size => Ticks::of(low - 0.5 * size, high + 0.5 * size),
        () => Ticks::of(low, high),
    }
}

/// An axis: whole steps of 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ticks {
    low: f64,
    step: f64,
    count: u32,
}

/// Steps of an axis, about. More: labels collide at 400 pixels.
const STEPS: f64 = 4.0;

impl Ticks {
    fn of(low: f64, high: f64) -> Self {
        let raw = (high - low) / STEPS;
        let power = 10f64.powf(raw.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|&s| s >= raw * 0.999);
        let step = step.unwrap_or(raw);
        let first = (low / step).floor();
        let last = (high / step - FLAT).ceil();
        Self { low: first * step, step, count: (last - first).clamp(1.0, 100.0) as u32 }
    }

    fn span(&self) -> f64 {
        f64::from(self.count) * self.step
    }

    /// Where marks stand, and what is written there.
    fn marks(&self) -> impl Iterator<Item = (f64, String)> + '_ {
        let first = (self.low / self.step).round();
        (0..=self.count).map(move |k| {
            let value = (first + f64::from(k)) * self.step;
            (value, number(value, self.step))
        })
    }
}

/// A multiple of a step with no more digits than the step has.
fn number(value: f64, step: f64) -> String {
    let exponent = step.log10().floor() as i32;
    match value {
        0.0 => "0".to_owned(),
        _ if (-4..=5).contains(&exponent) => {
            format!("{value:.*}", usize::try_from(-exponent).unwrap_or(0))
        }
        _ => {
            let digits = (value.abs().log10().floor() as i32 - exponent).clamp(0, 6);
            let text = format!("{value:.*e}", usize::try_from(digits).unwrap_or(0));
            match text.split_once('e') {
                Some((digits, power)) if digits.contains('.') => {
                    let digits = digits.trim_end_matches('0').trim_end_matches('.');
                    format!("{digits}e{power}")
                }
                _ => text,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64) -> Vec<String> {
        Ticks::of(low, high).marks().map(|mark| mark.1).collect()
    }

    #[test]
    fn axes_have_few_round_marks() {
        assert_eq!(labels(0.0, 2.5), ["0", "1", "2", "3"]);
        assert_eq!(labels(0.0, 0.04), ["0", "0.01", "0.02", "0.03", "0.04"]);
        assert_eq!(labels(-12.0, 30.0), ["-20", "0", "20", "40"]);
        assert_eq!(labels(0.0, 3.2e-7), ["0", "1e-7", "2e-7", "3e-7", "4e-7"]);
        assert_eq!(labels(0.0, 9.9e-4), ["0", "0.0005", "0.0010"]);
        assert_eq!(labels(0.0, 1.9e-6), ["0", "5e-7", "1e-6", "1.5e-6", "2e-6"]);
        assert_eq!(labels(0.0, 7e9).len(), 5);
    }

    #[test]
    fn rounding_draws_no_hills() {
        let noisy = [5.0, 5.0 + 4e-15, 5.0 - 2e-15];
        let axis = range(noisy.into_iter(), Axis::Free);
        assert!(axis.span() >= 4.0, "{axis:?}");
        let nothing = range([0.0, 0.0].into_iter(), Axis::FromZero);
        assert_eq!((nothing.low, nothing.span()), (0.0, 1.0));
    }

    #[test]
    fn long_series_keep_their_extremes() {
        let value = |i: u32| if i == 7_777 { 9.0 } else { f64::from(i % 3) };
        let points: Vec<(f64, f64)> = (0..20_000).map(|i| (f64::from(i), value(i))).collect();
        let drawn = thinned(&points);
        assert!(drawn.len() <= MOST_POINTS && drawn.is_sorted_by(|p, q| p.0 <= q.0));
        assert!(drawn.contains(&(7_777.0, 9.0)));
        assert_eq!(
            plot(&[PlotSeries { name: String::new(), points: vec![] }], Axis::Free, "x"),
            None
        );
    }
}
