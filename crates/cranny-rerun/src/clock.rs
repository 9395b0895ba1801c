//! Simulated time and steps.

use std::collections::BTreeMap;

use re_sdk::log::TimeColumn;

use crate::source::Source;

/// Timeline of simulated time.
pub(crate) const TIME: &str = "time";

/// Timeline of steps.
pub(crate) const STEP: &str = "step";

/// The steps of a recording by their log times.
pub(crate) struct Clock {
    steps: BTreeMap<u64, u64>,
}

impl Clock {
    pub(crate) fn of(source: &Source) -> Self {
        Self { steps: source.stats.iter().map(|(time, stats)| (*time, stats.step)).collect() }
    }

    /// The step of a log time: that of the latest frame.
    fn step(&self, time: u64) -> u64 {
        self.steps.range(..=time).next_back().map_or(0, |(_, &step)| step)
    }

    /// Both timelines at some log times.
    pub(crate) fn columns(&self, times: impl Iterator<Item = u64> + Clone) -> [TimeColumn; 2] {
        let steps = times.clone().map(|time| signed(self.step(time)));
        let times = times.map(signed).collect::<Vec<_>>();
        [
            TimeColumn::new_duration_nanos(TIME, times),
            TimeColumn::new_sequence(STEP, steps.collect::<Vec<_>>()),
        ]
    }
}

/// Times and steps end long before this matters.
fn signed(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}
