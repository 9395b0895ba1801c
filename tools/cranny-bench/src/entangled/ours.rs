//! Cranny as a contestant, with memory or without.

use std::io;

use cranny_narrow_phase::{Counters, Demand, PairMemory, Query, query};

use super::digest::Digest;
use super::stage::Stage;
use crate::turns::{Contestant, Stopwatch};

/// The answers about the pairs of a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// Hash of all answers.
    pub(super) digest: u64,
    /// Whether the surfaces meet, pair by pair.
    pub(super) meets: Vec<bool>,
    /// Distances, pair by pair, for a demand that includes them.
    pub(super) distances: Vec<Option<f64>>,
    pub(super) counters: Counters,
}

pub(super) struct Ours<'a> {
    stage: &'a Stage,
    query: Query,
    keeps: bool,
    stopwatch: Stopwatch,
    /// One a pair.
    memories: Vec<PairMemory>,
    /// One a frame that was run.
    pub(super) outcomes: Vec<Option<Outcome>>,
}

impl<'a> Ours<'a> {
    /// `keeps`: memory is kept from frame to frame.
    pub(super) fn new(stage: &'a Stage, demand: Demand, keeps: bool) -> Self {
        Self {
            stage,
            query: Query::of(demand),
            keeps,
            stopwatch: Stopwatch::new(),
            memories: Vec::new(),
            outcomes: vec![None; stage.len()],
        }
    }

    /// Returns the mean bytes of memory of a pair after the last frame.
    pub(super) fn bytes(&self) -> usize {
        let kept: Vec<usize> =
            self.memories.iter().map(PairMemory::bytes).filter(|&bytes| bytes > 0).collect();
        kept.iter().sum::<usize>() / kept.len().max(1)
    }

    fn frame(&mut self, frame: usize) -> io::Result<f64> {
        let near = &self.stage.near[frame];
        let (query_of_pair, stage) = (&self.query, self.stage);
        let memories = &mut self.memories;
        let (seconds, answers) = self.stopwatch.seconds(|| {
            let answers = near.iter().map(|&pair| {
                let [a, b] = stage.placed(frame, pair);
                query(a, b, query_of_pair, &mut memories[pair])
            });
            answers.collect::<Result<Vec<_>, _>>()
        });
        let answers = answers.map_err(io::Error::other)?;
        if self.outcomes[frame].is_none() {
            let (mut digest, mut outcome) = (Digest::default(), Outcome::default());
            for answer in &answers {
                digest.word(Digest::of(answer));
                outcome.meets.push(answer.surface.meets());
                outcome.distances.push(answer.distance);
                outcome.counters += answer.counters;
            }
            outcome.digest = digest.value();
            self.outcomes[frame] = Some(outcome);
        }
        Ok(seconds)
    }
}

impl Contestant for Ours<'_> {
    fn run(&mut self, frames: &[usize]) -> io::Result<Vec<f64>> {
        let pairs = &self.stage.motion.pairs;
        self.memories = pairs.iter().map(|_| PairMemory::default()).collect();
        let mut seconds = Vec::with_capacity(frames.len());
        let mut last: Option<usize> = None;
        for &frame in frames {
            // A world drops the memory of a pair whose boxes part.
            let before = last.filter(|_| self.keeps).map(|last| &self.stage.near[last]);
            for &pair in &self.stage.near[frame] {
                if before.is_none_or(|before| before.binary_search(&pair).is_err()) {
                    self.memories[pair] = PairMemory::default();
                }
            }
            seconds.push(self.frame(frame)?);
            last = Some(frame);
        }
        Ok(seconds)
    }
}
