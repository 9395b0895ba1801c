//! Which bodies' boxes overlap, kept from frame to frame.
//!
//! A [`BroadPhase`] holds one axis-aligned box per proxy (world frame, the caller's unit of length)
//! and answers after every [`update`](BroadPhase::update) which pairs of boxes meet and which pairs
//! began or ended since the update before.
//!
//! # Promises
//!
//! - **Exact on boxes**: a pair is held if and only if the two closed boxes share a point, so boxes
//!   that only touch overlap. There is no margin: whoever wants one grows the boxes.
//! - **Warm equals cold**: pairs and events are a function of the boxes and kinds at this update
//!   and at the last one, never of the order of the calls in between or of older frames.
//! - **Events are the difference** of the pair sets of two consecutive updates, sorted by ids.
//! - Two [`Stationary`](Motion::Stationary) proxies are never a pair.
//! - Boxes with infinite faces are accepted (a half-space has one); `NaN` and empty boxes are
//!   refused with a [`BroadPhaseError`].
//!
//! # Non-promises
//!
//! Between a change and the next update the pairs are those of the last update. A box that is
//! tunnelled through between two updates is not reported.
//!
//! # Back ends
//!
//! [`SweepAndPrune`] costs about the number of moved boxes plus the number of end points that pass
//! each other: best when few boxes move. [`BoxTree`] costs about the number of boxes, however they
//! move: best when many do. [`AdaptiveBroadPhase`] is the one or the other, by the swaps it counts.
//! All three report the same pairs and events; every back end must pass the conformance suite in
//! `tests/conformance.rs`, pair for pair.
//!
//! Each back end notices by itself that the boxes of a pair have parted, `pairs` drops the pair,
//! and the caller forgets what it keeps about it: the header of `pairs` names the places.
//!
//! ```
//! use cranny_broad_phase::{BroadPhase, Motion, OverlapEvent, ProxyId, SweepAndPrune};
//! use cranny_exact::{Aabb, DVec3};
//!
//! let cube_at = |x: f64| Aabb { min: DVec3::new(x, 0.0, 0.0), max: DVec3::new(x + 1.0, 1.0, 1.0) };
//! let (ball, wall) = (ProxyId(0), ProxyId(7));
//! let mut broad = SweepAndPrune::default();
//! broad.insert(ball, cube_at(0.0), Motion::Moving)?;
//! broad.insert(wall, cube_at(3.0), Motion::Stationary)?;
//! assert!(broad.update().is_empty());
//!
//! broad.set_box(ball, cube_at(2.0))?; // its face now lies on the wall's
//! assert_eq!(broad.update(), [OverlapEvent::Began(ball, wall)]);
//! assert_eq!(broad.pairs(), [(ball, wall)]);
//!
//! broad.remove(wall)?;
//! assert_eq!(broad.update(), [OverlapEvent::Ended(ball, wall)]);
//! # Ok::<(), cranny_broad_phase::BroadPhaseError>(())
//! ```

mod adaptive;
mod box_index;
mod box_tree;
mod error;
mod index;
mod keeper;
mod pairs;
mod slots;
mod sweep_and_prune;

pub use adaptive::AdaptiveBroadPhase;
pub use box_index::BoxIndex;
pub use box_tree::BoxTree;
pub use error::{BroadPhaseError, InvariantError};
pub use keeper::PairKeeper;
pub use sweep_and_prune::SweepAndPrune;

use cranny_exact::Aabb;

/// The caller's name for a box. Any number will do; nothing is allocated per unused number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ProxyId(pub u32);

/// Two proxies whose boxes overlap, the lower id first.
pub type OverlapPair = (ProxyId, ProxyId);

/// Whether a proxy is expected to move. It decides which pairs are of interest, not what may be
/// done: a stationary box can be set anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Motion {
    /// Pairs with every other proxy are reported.
    Moving,
    /// Pairs with moving proxies only are reported.
    Stationary,
}

impl Motion {
    /// Whether two proxies of these kinds can be a pair.
    #[must_use]
    pub fn pairs_with(self, other: Self) -> bool {
        self == Self::Moving || other == Self::Moving
    }
}

/// A pair that is new or gone since the last update. The lower id comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OverlapEvent {
    /// The pair is held now and was not after the last update.
    Began(ProxyId, ProxyId),
    /// The pair was held after the last update and is not now: the boxes parted, a proxy was
    /// removed, or both are stationary now.
    Ended(ProxyId, ProxyId),
}

impl OverlapEvent {
    /// The pair that the event is about.
    #[must_use]
    pub fn pair(self) -> OverlapPair {
        match self {
            Self::Began(a, b) | Self::Ended(a, b) => (a, b),
        }
    }
}

/// What the last update did. History decides these numbers; nothing else depends on them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BroadPhaseCounters {
    /// Boxes that were inserted, removed, set to another value or switched in kind.
    pub changed: u64,
    /// Neighbouring end points that changed places, over the three axes.
    pub swaps: u64,
    /// Tests of one box against another.
    pub box_tests: u64,
    /// 1 if everything was sorted, or the tree built, anew, else 0.
    pub rebuilds: u64,
    /// 1 if a tree of boxes answered, or answers from the next update on; else 0.
    pub tree: u64,
}

/// Finds overlapping pairs of boxes and keeps them from frame to frame.
///
/// Changes are collected by the other functions and take effect together in
/// [`update`](Self::update).
pub trait BroadPhase {
    /// Adds a box under a new id. An id removed earlier may be used again, even before the next
    /// update; the events then compare what is now under that id with what was before.
    ///
    /// # Errors
    ///
    /// [`DuplicateProxy`](BroadPhaseError::DuplicateProxy), a box that is
    /// [empty](BroadPhaseError::EmptyBox) or holds [`NaN`](BroadPhaseError::NotANumber), or
    /// [`Full`](BroadPhaseError::Full). Nothing is changed then.
    fn insert(&mut self, id: ProxyId, aabb: Aabb, motion: Motion) -> Result<(), BroadPhaseError>;

    /// Takes a box out.
    ///
    /// # Errors
    ///
    /// [`UnknownProxy`](BroadPhaseError::UnknownProxy).
    fn remove(&mut self, id: ProxyId) -> Result<(), BroadPhaseError>;

    /// Gives a proxy another box, near the old one or not.
    ///
    /// # Errors
    ///
    /// [`UnknownProxy`](BroadPhaseError::UnknownProxy), or a box that is
    /// [empty](BroadPhaseError::EmptyBox) or holds [`NaN`](BroadPhaseError::NotANumber). The old
    /// box stays then.
    fn set_box(&mut self, id: ProxyId, aabb: Aabb) -> Result<(), BroadPhaseError>;

    /// Says whether a proxy moves from now on.
    ///
    /// # Errors
    ///
    /// [`UnknownProxy`](BroadPhaseError::UnknownProxy).
    fn set_moving(&mut self, id: ProxyId, motion: Motion) -> Result<(), BroadPhaseError>;

    /// Brings the pairs up to date and returns what began and ended since the last update, sorted
    /// by ids; no pair occurs twice.
    fn update(&mut self) -> &[OverlapEvent];

    /// The pairs as of the last update, sorted by ids, the lower id first in each.
    fn pairs(&self) -> &[OverlapPair];

    /// The box of a proxy, as last set; `None` for an unknown id.
    fn aabb(&self, id: ProxyId) -> Option<Aabb>;

    /// The kind of a proxy, as last set; `None` for an unknown id.
    fn motion(&self, id: ProxyId) -> Option<Motion>;

    /// The number of proxies.
    fn len(&self) -> usize;

    /// Whether there is no proxy.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What the last update did.
    fn counters(&self) -> BroadPhaseCounters;

    /// Checks every invariant of the structure, the pairs against brute force among them where no
    /// change awaits an update. Quadratic in the number of boxes: for tests.
    ///
    /// # Errors
    ///
    /// The first invariant that is broken. It would be a bug of this crate.
    fn validate(&self) -> Result<(), InvariantError>;
}

// The example of the README must compile and run as well.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
