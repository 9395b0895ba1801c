//! What a method's answers are off by where bodies are apart, and where they overlap.

use cranny_exact::Interval;
use serde::Serialize;

use super::figures::mean;
use super::method::{ContactAnswer, PoseAnswer};
use super::motion::Judged;
use super::series::Reply;
use super::truth::Truth;

/// Time and error over the poses of one kind. Errors are shares of the smaller body's size: the
/// width of the interval that holds the length, or, of a method without bounds, how far its length
/// is off; 1 where nothing is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(super) struct Panel {
    /// Poses at which it answered: those for which there was time.
    pub(super) poses: usize,
    /// Poses of this kind.
    pub(super) poses_all: usize,
    /// Mean time, microseconds.
    pub(super) mean_us: Option<f64>,
    /// Mean.
    pub(super) error: Option<f64>,
    pub(super) error_max: Option<f64>,
    /// Poses at which the verdict was the wrong one.
    pub(super) wrong: usize,
    /// Poses at which there was none.
    pub(super) open: usize,
}

impl Panel {
    /// Of distances, at poses at which bodies are apart.
    pub(super) fn of_distances(judged: &Judged, replies: &[Reply<PoseAnswer>]) -> Self {
        let apart = replies.iter().filter(|reply| !judged.truths[reply.pose].meets);
        let all = judged.truths.iter().filter(|truth| !truth.meets).count();
        Self::of(judged, all, apart, |found, truth| Estimated {
            held: found.held.or(found.distance.map(Interval::point)),
            truth: truth.distance,
            meets: found.meets,
        })
    }

    /// Of depths, at poses at which bodies overlap.
    pub(super) fn of_depths(judged: &Judged, replies: &[Reply<ContactAnswer>]) -> Self {
        let all = judged.truths.iter().filter(|truth| truth.overlaps()).count();
        Self::of(judged, all, replies.iter(), |found, truth| Estimated {
            held: found.depth,
            truth: truth.depth,
            meets: found.meets,
        })
    }

    /// Returns whether there was no time for some of the poses.
    pub(super) fn is_partial(&self) -> bool {
        self.poses < self.poses_all
    }

    fn of<'r, T: 'r>(
        judged: &Judged,
        poses_all: usize,
        replies: impl Iterator<Item = &'r Reply<T>>,
        estimated: impl Fn(&T, &Truth) -> Estimated,
    ) -> Self {
        let (mut micros, mut errors, mut panel) = (Vec::new(), Vec::new(), Self::default());
        for reply in replies {
            let truth = &judged.truths[reply.pose];
            let found = estimated(&reply.found, truth);
            micros.push(reply.micros());
            errors.push((found.error() / judged.motion.posed(reply.pose).size()).min(1.0));
            match found.meets {
                Some(meets) => panel.wrong += usize::from(meets != truth.meets),
                None => panel.open += 1,
            }
        }
        Self {
            poses: errors.len(),
            poses_all,
            mean_us: mean(micros.into_iter()),
            error: mean(errors.iter().copied()),
            error_max: errors.iter().copied().reduce(f64::max),
            ..panel
        }
    }
}

/// An estimate of a length, beside that length.
struct Estimated {
    held: Option<Interval>,
    truth: f64,
    meets: Option<bool>,
}

impl Estimated {
    /// How far any length that the estimate allows may be from the true one.
    fn error(&self) -> f64 {
        self.held.map_or(f64::INFINITY, |held| {
            held.width().max(held.lo - self.truth).max(self.truth - held.hi)
        })
    }
}
