//! What a back end is to the rest: an index over boxes that finds the pairs which change.

use crate::pairs::PairSet;
use crate::slots::Slots;
use crate::{BroadPhaseCounters, InvariantError};
use std::fmt::Debug;

/// Finds, at each update, the pairs that came and went by motion, insertion and waking.
///
/// The keeper has already ended the pairs of boxes that leave and of boxes that have become
/// stationary.
pub trait Index: Clone + Debug + Default {
    /// Follows what changed in `slots` since the last call.
    fn follow(&mut self, slots: &Slots, pairs: &PairSet, found: &mut Found);

    /// Checks every invariant of the index. `slots` is as it was after the last update but for
    /// what awaits the next one.
    ///
    /// # Errors
    ///
    /// The first invariant that is broken.
    fn validate(&self, slots: &Slots) -> Result<(), InvariantError>;
}

/// What an update has found so far, as packed pairs.
///
/// Pairs may be named too often, never wrongly: `began` receives only pairs that hold by now and
/// all of them that are new; `ended` all that are gone, and nothing else but pairs that `began` has
/// too, or that were never held. The pair set takes care of the rest.
#[derive(Clone, Debug, Default)]
pub struct Found {
    pub(crate) began: Vec<u64>,
    pub(crate) ended: Vec<u64>,
    pub(crate) counters: BroadPhaseCounters,
}
