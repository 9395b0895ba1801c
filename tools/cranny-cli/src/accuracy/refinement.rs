//! Bodies at rest: what a budget leaves open in one frame is narrowed in the next.

use std::time::{Duration, Instant};

use cranny_estimate::Accuracy;
use cranny_exact::Interval;

use super::Scene;
use super::figures::{mean, most, quantile};
use super::method::Method;
use super::ours::{Allowance, Ours};
use super::visits::centers;
use crate::csv::{cell, table};

/// Frames that bodies rest at most.
const FRAMES: usize = 64;

/// Poses at which they do, evenly spread.
const POSES: usize = 32;

/// What is known after so many frames at one place, within a budget of tests each.
#[derive(Clone, Debug)]
pub(super) struct Rested {
    pub(super) budget: u64,
    /// From 1.
    pub(super) frame: usize,
    pub(super) poses: usize,
    open: usize,
    pub(super) width_mean: Option<f64>,
    width_max: Option<f64>,
    median_us: Option<f64>,
}

/// Asks at each of some poses frame after frame, from no memory on. Ends early where that takes
/// longer than `patience`.
pub(super) fn rested(scene: &Scene, budget: u64, patience: Duration) -> Vec<Rested> {
    let poses: Vec<usize> = centers(scene.poses.len(), POSES).collect();
    let new = |_| {
        let mut pair = Ours::new(Accuracy::Exact, Allowance::Tests(budget), true);
        pair.begin(scene.models);
        pair
    };
    let mut pairs: Vec<Ours> = poses.iter().map(new).collect();
    let begin = Instant::now();
    let mut rows = Vec::new();
    while rows.len() < FRAMES && (rows.is_empty() || begin.elapsed() < patience) {
        let found = poses.iter().zip(&mut pairs).map(|(&pose, pair)| {
            let start = Instant::now();
            let found = pair.ask(scene.models, scene.poses[pose]);
            (
                start.elapsed().as_nanos() as f64 / 1e3,
                found.meets,
                found.held.unwrap_or(Interval::WHOLE),
            )
        });
        rows.push(Rested::of(budget, rows.len() + 1, found.collect()));
    }
    rows
}

impl Rested {
    fn of(budget: u64, frame: usize, found: Vec<(f64, Option<bool>, Interval)>) -> Self {
        let widths: Vec<f64> = found.iter().map(|(_, _, held)| held.width()).collect();
        let mut micros: Vec<f64> = found.iter().map(|found| found.0).collect();
        micros.sort_unstable_by(f64::total_cmp);
        Self {
            budget,
            frame,
            poses: found.len(),
            open: found.iter().filter(|found| found.1.is_none()).count(),
            width_mean: mean(widths.iter().copied()),
            width_max: most(&widths),
            median_us: quantile(&micros, 50),
        }
    }

    fn csv(&self) -> String {
        [
            self.budget.to_string(),
            self.frame.to_string(),
            self.poses.to_string(),
            self.open.to_string(),
            cell(self.width_mean),
            cell(self.width_max),
            cell(self.median_us),
        ]
        .join(",")
    }
}

/// A table of all rows.
pub(super) fn csv(all: &[Rested]) -> String {
    table("budget,frame,poses,open,width_mean,width_max,median_us", all.iter().map(Rested::csv))
}
