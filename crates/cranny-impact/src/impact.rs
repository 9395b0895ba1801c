//! The one entry: from two moving bodies to their first meeting.

use cranny_exact::{DVec3, DomainError, Interval};
use cranny_narrow_phase::{
    Containment, Demand, PairMemory, Placed, Query, QueryError, Surface, Witness, query,
};
use thiserror::Error;

use crate::bodies::Bodies;
use crate::motion::{MAX_TURN, Moving};
use crate::search::search;

/// Motions or options that are refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ImpactError {
    /// A point or vector outside the coordinate domain.
    #[error("motion of body {body}: {what}: {source}")]
    Domain {
        /// `'A'` or `'B'`.
        body: char,
        /// "start", "pivot" or "travel".
        what: &'static str,
        /// What is wrong with it.
        source: DomainError,
    },
    /// A rotation that is not a unit quaternion.
    #[error("motion of body {body}: rotation quaternion has length {length}; normalise it")]
    Rotation {
        /// `'A'` or `'B'`.
        body: char,
        /// Length found.
        length: f64,
    },
    /// More than [`MAX_TURN`], or not a number.
    #[error("motion of body {body}: turn of {angle} radians; at most {MAX_TURN} are accepted")]
    Turn {
        /// `'A'` or `'B'`.
        body: char,
        /// Angle found.
        angle: f64,
    },
    /// A tolerance that is not a positive, finite number.
    #[error("tolerance is {value}: it must be a finite length, more than 0")]
    Tolerance {
        /// The value found.
        value: f64,
    },
    /// The bodies cannot be queried at the start.
    #[error(transparent)]
    Start(#[from] QueryError),
}

/// The tolerance and the budget of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactOptions {
    /// The surfaces may be this far apart at the end of [`Hit::time`], > 0. A thousandth of the
    /// smallest feature suits most scenes; finer costs little. Less than rounding
    /// permits (about 1e-12 of the lengths involved) is raised to that.
    pub tolerance: f64,
    /// Elementary tests (pairs of boxes, pairs of faces, boxes of parameters) that may be made.
    /// Default: [`ImpactOptions::DEFAULT_BUDGET`].
    pub budget: u64,
}

impl ImpactOptions {
    /// Some ten seconds of work, a thousand times as much as most pairs take.
    pub const DEFAULT_BUDGET: u64 = 20_000_000;

    /// The default budget.
    #[must_use]
    pub fn within(tolerance: f64) -> Self {
        Self { tolerance, budget: Self::DEFAULT_BUDGET }
    }
}

/// When and where two moving bodies meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Impact {
    /// Certified: the surfaces share no point from time 0 to 1, ends included.
    None,
    /// They meet at time 0: the surfaces share a point, or one body lies inside the other.
    Initially {
        /// How the surfaces meet at time 0.
        surface: Surface,
        /// One wholly inside the other.
        contained: Option<Containment>,
    },
    /// They meet, to the tolerance.
    Hit(Hit),
    /// The budget was spent.
    Open {
        /// Certified free before this; unknown from then on, to time 1.
        free_before: f64,
    },
}

/// A first meeting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The surfaces share no point before `lo`; at `hi` they are within the tolerance. The two are
    /// most often neighbouring numbers; they differ where the budget was spent on what may be
    /// earlier.
    pub time: Interval,
    /// Nearest points at `time.hi`, with their features: on A, on B. World coordinates.
    pub witnesses: [Witness; 2],
    /// Unit, from A to B, at the witnesses.
    pub normal: DVec3,
    /// Distance between the witnesses, at most the tolerance.
    pub distance: f64,
}

/// Work done for an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImpactCounters {
    /// Pairs of boxes, at a moment.
    pub node_tests: u64,
    /// Pairs of faces, at a moment.
    pub face_tests: u64,
    /// Linear motions of a vertex and a face, or of two edges.
    pub linear_tests: u64,
    /// Boxes of parameters that they tested.
    pub subdivisions: u64,
    /// Times at which the trees were descended from their roots.
    pub descents: u64,
}

impl ImpactCounters {
    /// What a budget is compared with.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.node_tests + self.face_tests + self.subdivisions
    }
}

/// Finds when two moving bodies first meet.
///
/// Exact at the start (by [`query`]: touching counts as meeting, as does one solid inside the
/// other; a body in the void of another is free), certified in between, and within the tolerance
/// at the hit.
///
/// # Errors
///
/// [`ImpactError`] if a motion or the tolerance is refused.
///
/// ```
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, Mesh, Model};
/// use cranny_impact::{Impact, ImpactOptions, Motion, Moving, time_of_impact};
///
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
/// let still = Moving { model: &model, motion: Motion::at_rest(Pose::IDENTITY) };
/// let fast = Motion::straight(Pose::at(DVec3::new(0.1, 0.1, 2.0)), DVec3::new(0.0, 0.0, -100.0));
/// let (impact, _) =
///     time_of_impact(still, Moving { model: &model, motion: fast }, &ImpactOptions::within(1e-6))?;
/// let Impact::Hit(hit) = impact else { panic!("a bullet does not tunnel") };
/// assert!((hit.time.hi - 0.012).abs() < 1e-6); // 1.2 above the slanted face, at speed 100
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn time_of_impact(
    a: Moving,
    b: Moving,
    options: &ImpactOptions,
) -> Result<(Impact, ImpactCounters), ImpactError> {
    let value = options.tolerance;
    if !(value > 0.0 && value.is_finite()) {
        return Err(ImpactError::Tolerance { value });
    }
    let bodies = Bodies::new(a, b)?;
    let [start_a, start_b] = bodies.starts();
    let start = query(
        Placed { model: a.model, pose: start_a },
        Placed { model: b.model, pose: start_b },
        &Query::of(Demand::Intersects),
        &mut PairMemory::default(),
    )?;
    if start.surface != Surface::None || start.solid {
        let impact = Impact::Initially { surface: start.surface, contained: start.contained };
        return Ok((impact, ImpactCounters::default()));
    }
    Ok(search(&bodies, options))
}
