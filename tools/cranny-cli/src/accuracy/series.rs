//! One question to a method at many poses, several times.

use std::time::{Duration, Instant};

use super::method::Method;
use super::motion::{Motion, Posed};
use super::visits::{Visit, centers, visits};

/// Poses at which it is tried how long a question takes.
const TRIALS: usize = 5;

/// Puts a question to a method.
pub(super) type Ask<T> = fn(&mut dyn Method, Posed) -> T;

/// The answer at a pose, in the shortest time of all runs.
#[derive(Clone, Debug)]
pub(super) struct Reply<T> {
    pub(super) pose: usize,
    pub(super) time: Duration,
    pub(super) found: T,
}

impl<T> Reply<T> {
    pub(super) fn micros(&self) -> f64 {
        self.time.as_nanos() as f64 / 1e3
    }
}

/// One question to one method.
pub(super) struct Series<T> {
    ask: Ask<T>,
    visits: Vec<Visit>,
    /// One a pose that counts, in their order; empty before the first run.
    pub(super) replies: Vec<Reply<T>>,
}

impl<T> Series<T> {
    /// Decides which of the candidates to query, so that a run takes no longer than `patience`.
    pub(super) fn planned(
        motion: &Motion,
        method: &mut dyn Method,
        ask: Ask<T>,
        candidates: &[usize],
        patience: Duration,
    ) -> Self {
        let each = each(motion, method, ask, candidates, patience);
        let affordable = patience.as_nanos() / each.as_nanos().max(1);
        let affordable = usize::try_from(affordable).unwrap_or(usize::MAX);
        let visits = visits(candidates, method.is_warm(), affordable);
        Self { ask, visits, replies: Vec::new() }
    }

    /// Queries all poses; of the answers before, only that stays which took no longer.
    pub(super) fn run(&mut self, motion: &Motion, method: &mut dyn Method) {
        let mut index = 0;
        for (i, visit) in self.visits.iter().enumerate() {
            let posed = motion.posed(visit.pose);
            if i == 0 || !method.is_warm() || motion.begins(visit.pose) {
                method.begin(posed);
            }
            let start = Instant::now();
            let found = (self.ask)(method, posed);
            let time = start.elapsed();
            if !visit.counts {
                continue;
            }
            let reply = Reply { pose: visit.pose, time, found };
            match self.replies.get_mut(index) {
                Some(best) if best.time <= time => {}
                Some(best) => *best = reply,
                None => self.replies.push(reply),
            }
            index += 1;
        }
    }
}

/// How long a question takes on average, tried at some poses. Memory may follow for one pose.
fn each<T>(
    motion: &Motion,
    method: &mut dyn Method,
    ask: Ask<T>,
    candidates: &[usize],
    patience: Duration,
) -> Duration {
    let (mut spent, mut wanted) = (Duration::ZERO, 0);
    for pose in centers(candidates.len(), TRIALS).filter_map(|i| candidates.get(i).copied()) {
        method.begin(motion.posed(pose));
        if method.is_warm() && !motion.begins(pose) {
            ask(method, motion.posed(pose - 1));
        }
        let start = Instant::now();
        ask(method, motion.posed(pose));
        spent += start.elapsed();
        wanted += 1;
        if spent > patience {
            break;
        }
    }
    spent / wanted.max(1)
}
