//! Contestants take turns on the same frames. Each frame counts at its best.

use std::io;

use cpu_time::ThreadTime;

use crate::stopwatch::median;

/// A detector that answers about frames.
pub(crate) trait Contestant {
    /// Returns the seconds of each of these frames, in their order.
    ///
    /// # Errors
    ///
    /// A contestant that does not support the query, or one in another process that ended.
    fn run(&mut self, frames: &[usize]) -> io::Result<Vec<f64>>;
}

/// The effort of one row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    /// Turns of each contestant.
    pub(crate) rounds: usize,
    /// Seconds of a turn of every contestant but the first. A slow contestant gets fewer frames,
    /// evenly spread.
    pub(crate) turn: f64,
}

/// Least number of frames of a contestant. Fewer: a median is a matter of luck. More: parry's
/// distances of two large meshes take minutes.
const FRAMES_LEAST: usize = 5;

/// The first contestant's turn is its last if it takes longer than this many budgets. Smaller: rows
/// of milliseconds are measured once and are noisy. Larger: nuts take minutes.
const LONG_TURN: f64 = 8.0;

/// Least time of a frame, where the clock's own cost is more than what was measured. Smaller, as 0:
/// a ratio is not a number. Larger: a verdict of a parted pair counts as slower than it is.
const SECONDS_LEAST: f64 = 1e-9;

/// Frames of a contestant and its best seconds of each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times {
    pub(crate) frames: Vec<usize>,
    pub(crate) seconds: Vec<f64>,
}

impl Times {
    pub(crate) fn median(&self) -> f64 {
        median(self.seconds.clone())
    }

    /// Returns the 99th percentile without the first frame, which is without memory for each.
    pub(crate) fn p99(&self) -> f64 {
        let mut rest = self.seconds.get(1..).unwrap_or_default().to_vec();
        rest.sort_unstable_by(f64::total_cmp);
        rest.get((rest.len() * 99 / 100).min(rest.len().saturating_sub(1))).copied().unwrap_or(0.0)
    }

    /// Returns the median in multiples of that of a contestant with all frames, over the same
    /// frames.
    pub(crate) fn over(&self, whole: &Times) -> f64 {
        let same = self.frames.iter().map(|&frame| whole.seconds[frame]).collect();
        self.median() / median(same)
    }
}

/// Measures the first contestant on all frames, the others on as many as the budget affords. A
/// contestant that fails has no times.
pub(crate) fn take_turns(
    budget: Budget,
    frames: usize,
    contestants: &mut [&mut dyn Contestant],
) -> Vec<Option<Times>> {
    let mut times: Vec<Option<Times>> = contestants
        .iter_mut()
        .enumerate()
        .map(|(i, contestant)| {
            let chosen = if i == 0 {
                (0..frames).collect()
            } else {
                spread(frames, affordable(budget.turn, &mut **contestant, frames)?)
            };
            Some(Times { seconds: vec![f64::INFINITY; chosen.len()], frames: chosen })
        })
        .collect();
    for _ in 0..budget.rounds {
        for (contestant, slot) in contestants.iter_mut().zip(&mut times) {
            let Some(times) = slot else { continue };
            match contestant.run(&times.frames) {
                Ok(seconds) => times
                    .seconds
                    .iter_mut()
                    .zip(seconds)
                    .for_each(|(best, seconds)| *best = best.min(seconds)),
                Err(_) => *slot = None,
            }
        }
        let first = times[0].as_ref().map_or(0.0, |times| times.seconds.iter().sum());
        if first > LONG_TURN * budget.turn {
            break;
        }
    }
    times
}

/// Returns how many frames a turn affords, estimated from two of them.
fn affordable(turn: f64, contestant: &mut dyn Contestant, frames: usize) -> Option<usize> {
    let tried = contestant.run(&spread(frames, 2)).ok()?;
    let each = tried.iter().sum::<f64>() / tried.len().max(1) as f64;
    let affordable = (turn / each.max(SECONDS_LEAST)) as usize;
    Some(affordable.clamp(FRAMES_LEAST.min(frames), frames))
}

/// Returns evenly spread frames.
fn spread(frames: usize, count: usize) -> Vec<usize> {
    (0..count).map(|i| (2 * i + 1) * frames / (2 * count)).collect()
}

/// Seconds of the thread's CPU time, the clock's own subtracted.
pub(crate) struct Stopwatch {
    overhead: f64,
}

impl Stopwatch {
    pub(crate) fn new() -> Self {
        let empty = |_| ThreadTime::now().elapsed().as_secs_f64();
        Self { overhead: median((0..1_000).map(empty).collect()) }
    }

    pub(crate) fn seconds<T>(&self, work: impl FnOnce() -> T) -> (f64, T) {
        let start = ThreadTime::now();
        let made = work();
        let elapsed = start.elapsed().as_secs_f64();
        ((elapsed - self.overhead).max(SECONDS_LEAST), made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes as many seconds for a frame as its number says, and more each time.
    struct Counted(usize);

    impl Contestant for Counted {
        fn run(&mut self, frames: &[usize]) -> io::Result<Vec<f64>> {
            self.0 += 1;
            Ok(frames.iter().map(|&frame| (frame + self.0) as f64).collect())
        }
    }

    struct Refusing;

    impl Contestant for Refusing {
        fn run(&mut self, _: &[usize]) -> io::Result<Vec<f64>> {
            Err(io::Error::other("no"))
        }
    }

    #[test]
    fn the_best_of_each_frame_counts() {
        let budget = Budget { rounds: 3, turn: 1e9 };
        let (mut ours, mut peer, mut none) = (Counted(0), Counted(0), Refusing);
        let times = take_turns(budget, 7, &mut [&mut ours, &mut peer, &mut none]);
        let [ours, peer, none] = &times[..] else { panic!("three of them") };
        let (ours, peer) = (ours.as_ref().unwrap(), peer.as_ref().unwrap());
        assert_eq!(ours.seconds, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        assert_eq!((ours.median(), ours.p99()), (4.0, 7.0));
        assert_eq!(peer.median(), 5.0, "a turn was spent on finding out how long one takes");
        assert_eq!(peer.over(ours), 1.25);
        assert!(none.is_none());
    }

    #[test]
    fn dear_contestants_get_fewer_frames_evenly_spread() {
        let budget = Budget { rounds: 1, turn: 1.0 };
        let times = take_turns(budget, 100, &mut [&mut Counted(0), &mut Counted(0)]);
        assert_eq!(times[1].as_ref().unwrap().frames, [10, 30, 50, 70, 90]);
        assert_eq!(spread(4, 4), [0, 1, 2, 3]);
    }
}
