//! The result of an estimate.

use cranny_exact::{Aabb, Interval};
use cranny_narrow_phase::{Answer, Containment, Counters, Surface, Witness};

/// Whether two bodies share a point, of their surfaces or their interiors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Verdict {
    /// They certainly do.
    Certain,
    /// They certainly do not.
    Excluded,
    /// Not decided within the effort.
    Open,
}

/// A box in which parts of the two surfaces may be near each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Holds all points of either part that are within the margin of the other part; world
    /// coordinates.
    pub bounds: Aabb,
    /// Holds the distance of the two parts.
    pub separation: Interval,
}

/// What is certain of a pair, in world coordinates and in the caller's order.
///
/// Where a budget ends the work, every field may depend on history: on the nodes that were opened
/// before, and on the bounds of the last estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Whether the bodies share a point. For the demand `None`, always `Open`.
    pub verdict: Verdict,
    /// [`Answer::surface`], if it is certain.
    pub surface: Option<Surface>,
    /// [`Answer::solid`], if it is certain.
    pub solid: Option<bool>,
    /// [`Answer::contained`], if `solid` is certain and the surfaces do not touch; else `None`.
    pub contained: Option<Containment>,
    /// Holds the distance between the surfaces, 0 where they meet. For the demands `Contacts` and
    /// `Regions`, where regions overlap, it holds minus the depth of the deepest, as
    /// [`Answer::separation`].
    pub separation: Interval,
    /// A point on each surface, the nearest that were tested; a common point where surfaces are
    /// known to meet. They are no farther apart than `separation.hi`, but for rounding, unless
    /// memory knows a tighter bound. `None` if no face and no vertex was tested, and where an exact
    /// [`answer`](Self::answer) has none.
    pub witnesses: Option<[Witness; 2]>,
    /// For the demands `Contacts` and `Regions`: boxes that hold all points of the two surfaces
    /// that are shared or within the margin, nearest first. Empty if there is an `answer`.
    pub places: Vec<Place>,
    /// The exact answer, if the effort was not limited.
    pub answer: Option<Answer>,
    /// Work done on trees, faces and points. Walks are counted by [`hull_steps`](Self::hull_steps).
    pub counters: Counters,
    /// Whether the budget ended the work before the level did: with more of it, more may be
    /// certain.
    pub ended_by_budget: bool,
    /// Where a budget of tests ended the work: the budget below which the next estimate of the same
    /// poses spends its tests on beginning, and gets no further. It may need more still. 0 where no
    /// budget did.
    pub needed_to_go_on: u64,
    /// Pairs of hull features and portals that a walk tested; 0 but for the levels
    /// [`Hulls`](crate::Accuracy::Hulls) and [`Caps`](crate::Accuracy::Caps).
    pub hull_steps: u64,
}

impl Estimate {
    /// The estimate before any work.
    pub(crate) fn blank() -> Self {
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
            ended_by_budget: false,
            needed_to_go_on: 0,
            hull_steps: 0,
        }
    }

    /// The estimate of an exact answer.
    pub(crate) fn of_answer(answer: Answer) -> Self {
        Self {
            verdict: match answer.touches() {
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
            counters: answer.counters,
            answer: Some(answer),
            ..Self::blank()
        }
    }

    /// Elementary tests that were made: those of [`Counters::tests`] and the steps of a walk.
    #[must_use]
    pub fn tests(&self) -> u64 {
        self.counters.tests() + self.hull_steps
    }
}
