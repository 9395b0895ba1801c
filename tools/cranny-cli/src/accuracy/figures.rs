//! One method's figures over all poses: a row of the report.

use std::time::{Duration, Instant};

use cranny_exact::DVec3;
use cranny_geometry::Model;
use serde::Serialize;

use super::{Scene, Told};
use crate::pose_file::PosePair;

/// Something that is asked about pairs.
pub(super) trait Method {
    fn name(&self) -> &'static str;

    fn level(&self) -> Option<String> {
        None
    }

    fn budget(&self) -> Option<u64> {
        None
    }

    /// Whether it is told when a motion begins only, and keeps what it likes from then on.
    fn is_warm(&self) -> bool {
        false
    }

    /// Forgets what it knows of earlier poses.
    fn begin(&mut self, _models: [&Model; 2]) {}

    fn ask(&mut self, models: [&Model; 2], poses: PosePair) -> Told;

    /// Where it tells that bodies are in contact.
    fn contacts(&mut self, models: [&Model; 2], poses: PosePair) -> Vec<DVec3>;
}

/// Times are the best of so many runs, pose by pose: a spike that does not come back is the machine's.
const RUNS: usize = 3;

/// What one run may take; a method that is slower is asked at fewer poses, evenly spread.
const PATIENCE: Duration = Duration::from_secs(4);

/// A row.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Figures {
    pub(super) method: &'static str,
    pub(super) level: Option<String>,
    pub(super) budget: Option<u64>,
    pub(super) memory: &'static str,
    pub(super) poses: usize,
    pub(super) median_us: f64,
    pub(super) p99_us: f64,
    pub(super) tests_mean: Option<f64>,
    pub(super) false_negatives: usize,
    pub(super) false_positives: usize,
    pub(super) open: usize,
    pub(super) width_mean: Option<f64>,
    pub(super) width_max: Option<f64>,
    pub(super) distance_error_mean: Option<f64>,
    pub(super) distance_error_max: Option<f64>,
    pub(super) witness_error_mean: Option<f64>,
    pub(super) contact_error_mean: Option<f64>,
}

/// Asks a method at all poses, several times, and judges what it told.
pub(super) fn measured(scene: &Scene, method: &mut impl Method) -> Figures {
    let asked = asked(scene, method);
    let mut best = vec![Duration::MAX; asked.len()];
    let mut told = Vec::new();
    for _ in 0..RUNS {
        told.clear();
        method.begin(scene.models);
        for (&pose, best) in asked.iter().zip(&mut best) {
            if !method.is_warm() {
                method.begin(scene.models);
            }
            let start = Instant::now();
            let here = method.ask(scene.models, scene.poses[pose]);
            *best = start.elapsed().min(*best);
            told.push(here);
        }
    }
    let contact_errors = contact_errors(scene, method, &asked);
    let mut micros: Vec<f64> = best.iter().map(|time| time.as_secs_f64() * 1e6).collect();
    micros.sort_unstable_by(f64::total_cmp);
    let truths = || asked.iter().map(|&pose| &scene.truths[pose]).zip(&told);
    let count = |wrong: fn(bool, Option<bool>) -> bool| {
        truths().filter(|(truth, told)| wrong(truth.meets, told.meets)).count()
    };
    let of = |value: fn(&Told) -> Option<f64>| told.iter().filter_map(value).collect::<Vec<_>>();
    let widths = of(|told| told.width);
    let tests = of(|told| told.tests.map(|tests| tests as f64));
    let distances: Vec<f64> = truths()
        .filter_map(|(truth, told)| Some((told.distance? - truth.distance).abs()))
        .collect();
    let witnesses: Vec<f64> = truths()
        .filter_map(|(truth, told)| {
            let ([p, q], [v, w]) = (truth.witnesses?, told.witnesses?);
            Some(p.distance(v).max(q.distance(w)))
        })
        .collect();
    Figures {
        method: method.name(),
        level: method.level(),
        budget: method.budget(),
        memory: if method.is_warm() { "warm" } else { "cold" },
        poses: asked.len(),
        median_us: quantile(&micros, 50),
        p99_us: quantile(&micros, 99),
        tests_mean: mean(&tests),
        false_negatives: count(|meets, told| meets && told == Some(false)),
        false_positives: count(|meets, told| !meets && told == Some(true)),
        open: count(|_, told| told.is_none()),
        width_mean: mean(&widths),
        width_max: most(&widths),
        distance_error_mean: mean(&distances),
        distance_error_max: most(&distances),
        witness_error_mean: mean(&witnesses),
        contact_error_mean: mean(&contact_errors),
    }
}

/// The poses that a method is asked at: all, or as many as its patience allows.
fn asked(scene: &Scene, method: &mut impl Method) -> Vec<usize> {
    let start = Instant::now();
    method.begin(scene.models);
    let all = scene.poses.len();
    for &pose in scene.poses.iter().take(2) {
        method.ask(scene.models, pose);
    }
    let run = start.elapsed().as_secs_f64() * 0.5 * all as f64;
    let stride = ((run / PATIENCE.as_secs_f64()).ceil() as usize).clamp(1, all);
    (0..all).step_by(stride).collect()
}

/// How far each region's deepest contact is from the nearest place that a method tells, at those poses
/// where it tells any.
fn contact_errors(scene: &Scene, method: &mut impl Method, asked: &[usize]) -> Vec<f64> {
    let start = Instant::now();
    let mut errors = Vec::new();
    method.begin(scene.models);
    for &pose in asked {
        let truth = &scene.truths[pose];
        if truth.contacts.is_empty() || start.elapsed() > PATIENCE {
            continue;
        }
        if !method.is_warm() {
            method.begin(scene.models);
        }
        let told = method.contacts(scene.models, scene.poses[pose]);
        let nearest = |p: &DVec3| told.iter().map(|q| p.distance(*q)).fold(f64::INFINITY, f64::min);
        errors.extend(truth.contacts.iter().map(nearest).filter(|error| error.is_finite()));
    }
    errors
}

/// Of sorted values; 0 of none.
fn quantile(sorted: &[f64], percent: usize) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted.get((sorted.len() * percent / 100).min(last)).copied().unwrap_or(0.0)
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn most(values: &[f64]) -> Option<f64> {
    values.iter().copied().reduce(f64::max)
}

const COLUMNS: &str = "method,level,budget,memory,poses,median_us,p99_us,tests_mean,false_negatives,\
false_positives,open,width_mean,width_max,distance_error_mean,distance_error_max,witness_error_mean,\
contact_error_mean";

/// All rows, below a line of names. Numbers are written so that they read back to the bit.
pub(super) fn csv(all: &[Figures]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for row in all {
        text += &row.csv();
        text.push('\n');
    }
    text
}

impl Figures {
    fn csv(&self) -> String {
        fn cell(value: Option<impl ToString>) -> String {
            value.map_or_else(String::new, |value| value.to_string())
        }
        [
            self.method.to_owned(),
            cell(self.level.as_ref()),
            cell(self.budget),
            self.memory.to_owned(),
            self.poses.to_string(),
            self.median_us.to_string(),
            self.p99_us.to_string(),
            cell(self.tests_mean),
            self.false_negatives.to_string(),
            self.false_positives.to_string(),
            self.open.to_string(),
            cell(self.width_mean),
            cell(self.width_max),
            cell(self.distance_error_mean),
            cell(self.distance_error_max),
            cell(self.witness_error_mean),
            cell(self.contact_error_mean),
        ]
        .join(",")
    }

    /// What it is, in a word.
    pub(super) fn label(&self) -> String {
        match (&self.level, self.budget) {
            (_, Some(budget)) => budget.to_string(),
            (Some(level), None) => level.clone(),
            (None, None) => self.method.to_owned(),
        }
    }

    /// The line for people, below [`heading`].
    pub(super) fn text(&self) -> String {
        let number =
            |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |x| format!("{x:.2e}"));
        format!(
            "{:<20}  {:<4}  {:>5}  {:>9.1}  {:>9.1}  {:>8.0}  {:>5}  {:>5}  {:>5}  {:>8}  {:>8}  {:>8}  {:>8}",
            self.label(),
            self.memory,
            self.poses,
            self.median_us,
            self.p99_us,
            self.tests_mean.unwrap_or(0.0),
            self.false_negatives,
            self.false_positives,
            self.open,
            number(self.width_mean),
            number(self.distance_error_mean),
            number(self.witness_error_mean),
            number(self.contact_error_mean),
        )
    }
}

/// What the columns of [`Figures::text`] mean.
pub(super) fn heading() -> String {
    format!(
        "{:<20}  {:<4}  {:>5}  {:>9}  {:>9}  {:>8}  {:>5}  {:>5}  {:>5}  {:>8}  {:>8}  {:>8}  {:>8}",
        "level, budget",
        "",
        "poses",
        "median us",
        "p99 us",
        "tests",
        "miss",
        "false",
        "open",
        "width",
        "distance",
        "witness",
        "contact"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_means_and_greatest() {
        let sorted: Vec<f64> = (0..100).map(f64::from).collect();
        assert_eq!((quantile(&sorted, 50), quantile(&sorted, 99)), (50.0, 99.0));
        assert_eq!((quantile(&[7.0], 99), quantile(&[], 50)), (7.0, 0.0));
        assert_eq!((mean(&[1.0, 2.0, 6.0]), mean(&[])), (Some(3.0), None));
        assert_eq!((most(&[1.0, f64::INFINITY]), most(&[])), (Some(f64::INFINITY), None));
    }
}
