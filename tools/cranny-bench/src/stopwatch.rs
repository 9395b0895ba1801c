//! Medians of CPU time, and two or more contestants that take turns.

use cpu_time::ThreadTime;
use std::hint::black_box;
use std::time::Duration;

/// How often a thing is measured: until it has taken `budget` in all, but at least `least` times
/// (once, if that took ten budgets) and at most `most` times.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Repeats {
    pub(crate) least: usize,
    pub(crate) most: usize,
    pub(crate) budget: Duration,
}

impl Repeats {
    pub(crate) fn of(quick: bool) -> Self {
        let budget = Duration::from_millis(if quick { 100 } else { 1500 });
        Self { least: if quick { 1 } else { 3 }, most: 200, budget }
    }
}

/// Runs the contestants in turn, as often as the repeats with the slowest allows; the median
/// seconds of each.
pub(crate) fn race<const N: usize>(
    repeats: Repeats,
    mut contestants: [&mut dyn FnMut(); N],
) -> [f64; N] {
    let mut times: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    let mut spent = Duration::ZERO;
    for round in 0..repeats.most {
        let least = if spent > 10 * repeats.budget { 1 } else { repeats.least };
        if round >= least && spent > repeats.budget {
            break;
        }
        for (contestant, times) in contestants.iter_mut().zip(&mut times) {
            let start = ThreadTime::now();
            contestant();
            let elapsed = start.elapsed();
            spent += elapsed;
            times.push(elapsed.as_secs_f64());
        }
    }
    times.map(median)
}

/// Keeps the optimiser from leaving out what is measured.
pub(crate) fn keep<T>(value: T) {
    black_box(value);
}

/// The middle value, or the mean of the two in the middle; 0 of nothing.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_of_odd_and_even_counts() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(median(vec![]), 0.0);
    }

    #[test]
    fn contestants_run_equally_often_and_as_often_as_the_budget_allows() {
        let (mut a, mut b) = (0, 0);
        let repeats = Repeats { least: 3, most: 9, budget: Duration::from_secs(3600) };
        let times = race(repeats, [&mut || a += 1, &mut || b += 1]);
        assert_eq!((a, b), (9, 9));
        assert!(times.iter().all(|t| *t >= 0.0));
        race(
            Repeats { budget: Duration::ZERO, ..repeats },
            [&mut || {
                a += 1;
                keep((0..1_000_000u64).map(|i| i ^ keep_as_is(i)).sum::<u64>());
            }],
        );
        assert_eq!(a, 10, "ten budgets are spent at once");
    }

    fn keep_as_is(i: u64) -> u64 {
        black_box(i)
    }
}
