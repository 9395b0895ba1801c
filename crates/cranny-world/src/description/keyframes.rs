//! What all keyframed motion has: values at rising times, and where between them a time lies.

use super::{Interpolation, PathEnd, PathError};

/// A value at a time.
pub(super) trait Keyed: Copy {
    /// Seconds since the path began.
    fn time(&self) -> f64;

    /// # Errors
    ///
    /// A value that nothing can have; `index` is the keyframe's.
    fn check(&self, index: usize) -> Result<(), PathError>;
}

/// Values at rising times, at least one.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Keyframes<K> {
    pub(super) list: Vec<K>,
    pub(super) interpolation: Interpolation,
    pub(super) end: PathEnd,
}

/// Where a time lies.
pub(super) enum Span<K> {
    /// At a keyframe, or where the path waits.
    At(K),
    /// Past the share `of_time` of the seconds between two keyframes.
    Between { from: K, to: K, of_time: f64 },
}

impl<K: Keyed> Keyframes<K> {
    pub(super) fn new(
        list: Vec<K>,
        interpolation: Interpolation,
        end: PathEnd,
    ) -> Result<Self, PathError> {
        let last = list.last().ok_or(PathError::Empty)?.time();
        for (index, keyframe) in list.iter().enumerate() {
            let time = keyframe.time();
            if !(time >= 0.0 && time.is_finite()) {
                return Err(PathError::Time { index, time });
            }
            let before = index.checked_sub(1).map(|before| list[before].time());
            if let Some(before) = before.filter(|before| *before >= time) {
                return Err(PathError::Order { index, time, before });
            }
            keyframe.check(index)?;
        }
        if end == PathEnd::Loop && last == 0.0 {
            return Err(PathError::NoLoop);
        }
        Ok(Self { list, interpolation, end })
    }

    pub(super) fn first(&self) -> K {
        self.list[0]
    }

    pub(super) fn last(&self) -> K {
        self.list[self.list.len() - 1]
    }

    /// Seconds to the last keyframe, or of one round.
    pub(super) fn duration(&self) -> f64 {
        self.last().time()
    }

    pub(super) fn span(&self, seconds: f64) -> Span<K> {
        let time = self.within(seconds);
        let next = self.list.partition_point(|keyframe| keyframe.time() <= time);
        let Some(before) = next.checked_sub(1) else { return Span::At(self.first()) };
        let (from, to) = (self.list[before], self.list.get(next));
        let Some(&to) = to.filter(|_| from.time() < time) else { return Span::At(from) };
        let of_time = (time - from.time()) / (to.time() - from.time());
        Span::Between { from, to, of_time }
    }

    /// The same time in the first round of a path that loops.
    fn within(&self, seconds: f64) -> f64 {
        match self.end {
            PathEnd::Hold => seconds,
            PathEnd::Loop => self.round_of(seconds).1,
        }
    }

    /// The round that a time is in, and the time in it: of one division, so that the two agree.
    pub(super) fn round_of(&self, seconds: f64) -> (f64, f64) {
        let duration = self.duration();
        let rest = seconds.rem_euclid(duration);
        (((seconds - rest) / duration).round(), rest)
    }
}

impl Interpolation {
    /// The share of the way at a share of the time.
    pub(super) fn of_way(self, share: f64) -> f64 {
        match self {
            Self::Linear => share,
            Self::Eased => share * share * (3.0 - 2.0 * share),
        }
    }

    /// The derivative of [`of_way`](Self::of_way).
    pub(super) fn pace(self, share: f64) -> f64 {
        match self {
            Self::Linear => 1.0,
            Self::Eased => 6.0 * share * (1.0 - share),
        }
    }

    /// The greatest [`pace`](Self::pace).
    pub(super) fn greatest_pace(self) -> f64 {
        self.pace(0.5)
    }
}
