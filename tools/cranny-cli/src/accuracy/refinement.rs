//! Bodies at rest: what a budget leaves open in one frame is narrowed in the next.

use std::time::{Duration, Instant};

use cranny_estimate::Accuracy;
use cranny_exact::Interval;

use super::figures::{mean, most, quantile};
use super::method::Method;
use super::motion::Motion;
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
    width_mean: Option<f64>,
    /// As a share of the smaller body's size, at most 1.
    pub(super) share_mean: Option<f64>,
    width_max: Option<f64>,
    median_us: Option<f64>,
}

/// Queries each of some poses frame after frame, from no memory on. Ends early where that takes
/// longer than `patience`.
pub(super) fn rested(motion: &Motion, budget: u64, patience: Duration) -> Vec<Rested> {
    let poses: Vec<usize> = centers(motion.len(), POSES).collect();
    let new = |&pose: &usize| {
        let mut pair = Ours::new(Accuracy::Exact, Allowance::Tests(budget), true);
        pair.begin(motion.posed(pose));
        pair
    };
    let mut pairs: Vec<Ours> = poses.iter().map(new).collect();
    let begin = Instant::now();
    let mut rows = Vec::new();
    while rows.len() < FRAMES && (rows.is_empty() || begin.elapsed() < patience) {
        let found = poses.iter().zip(&mut pairs).map(|(&pose, pair)| {
            let start = Instant::now();
            let found = pair.distance(motion.posed(pose));
            (
                start.elapsed().as_nanos() as f64 / 1e3,
                found.meets,
                found.held.unwrap_or(Interval::WHOLE).width(),
                motion.posed(pose).size(),
            )
        });
        rows.push(Rested::of(budget, rows.len() + 1, found.collect()));
    }
    rows
}

impl Rested {
    fn of(budget: u64, frame: usize, found: Vec<(f64, Option<bool>, f64, f64)>) -> Self {
        let widths: Vec<f64> = found.iter().map(|found| found.2).collect();
        let mut micros: Vec<f64> = found.iter().map(|found| found.0).collect();
        micros.sort_unstable_by(f64::total_cmp);
        Self {
            budget,
            frame,
            poses: found.len(),
            open: found.iter().filter(|found| found.1.is_none()).count(),
            width_mean: mean(widths.iter().copied()),
            share_mean: mean(found.iter().map(|(_, _, width, size)| (width / size).min(1.0))),
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
