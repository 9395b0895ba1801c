//! What an estimate tells of a pair.

use cranny_exact::{Aabb, Interval};

use crate::answer::{Answer, Containment, Counters, Surface, Witness};

/// Whether two bodies share a point: one of the surfaces, or of what lies inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Verdict {
    /// They certainly do.
    Certain,
    /// They certainly do not.
    Excluded,
    /// They may: what was spent does not tell.
    Open,
}

/// Where parts of the two surfaces may come near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Holds all points of both parts that may be within the margin of the other part; world
    /// coordinates.
    pub bounds: Aabb,
    /// Holds the distance of the two parts.
    pub separation: Interval,
}

/// What is certain of a pair, however little was spent, in world coordinates and in the caller's order.
///
/// Where a budget ends the work, everything but [`places`](Self::places) may depend on history: what was
/// opened before, and how near bodies were.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Whether the bodies share a point. Where the demand is `None`, nobody has looked: `Open`.
    pub verdict: Verdict,
    /// How the surfaces meet, where that is certain: what [`Answer::surface`] says.
    pub surface: Option<Surface>,
    /// Whether the bodies share interior points, where that is certain: what [`Answer::solid`] says.
    pub solid: Option<bool>,
    /// One wholly inside the other, where `solid` is certain and the surfaces do not touch; else `None`.
    pub contained: Option<Containment>,
    /// Holds the distance between the surfaces, 0 where they meet; or, if contacts or regions were asked for
    /// and regions overlap, minus the depth of the deepest: what [`Answer::separation`] tells.
    pub separation: Interval,
    /// A point on each surface; they are no farther apart than `separation.hi`, but for rounding. Where
    /// surfaces are known to meet, a common point of theirs. `None` where no points were looked at.
    pub witnesses: Option<[Witness; 2]>,
    /// If contacts or regions were asked for: what may be within the margin, nearest first. Whatever points of
    /// the two surfaces are that near, or shared, lie in one of these. Empty where `answer` tells more.
    pub places: Vec<Place>,
    /// The exact answer, where effort was not limited.
    pub answer: Option<Answer>,
    /// What it cost.
    pub counters: Counters,
}

impl Estimate {
    /// Nothing is known.
    pub(super) fn blank() -> Self {
        Self {
            verdict: Verdict::Open,
            surface: None,
            solid: None,
            contained: None,
            separation: Interval::WHOLE,
            witnesses: None,
            places: Vec::new(),
            answer: None,
            counters: Counters::default(),
        }
    }

    /// What an exact answer tells.
    pub(super) fn of_answer(answer: Answer) -> Self {
        Self {
            verdict: match answer.solid || answer.surface.meets() {
                true => Verdict::Certain,
                false => Verdict::Excluded,
            },
            surface: Some(answer.surface),
            solid: Some(answer.solid),
            contained: answer.contained,
            separation: match answer.surface.meets() {
                // A verdict alone measures nothing.
                false if answer.separation == Interval::WHOLE => {
                    Interval { lo: 0.0, hi: f64::INFINITY }
                }
                true if answer.separation == Interval::WHOLE => Interval::point(0.0),
                _ => answer.separation,
            },
            witnesses: answer.witnesses,
            places: Vec::new(),
            counters: answer.counters,
            answer: Some(answer),
        }
    }
}
