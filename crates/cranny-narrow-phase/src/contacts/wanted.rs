//! Which contacts count: those within a margin, and those that bodies may come to.

use crate::answer::Contact;
use crate::approach::Approach;
use crate::pair::Pair;
use crate::search::{Closing, Ground};

/// Which contacts count.
pub(crate) struct Wanted {
    margin: f64,
    /// Of the pair's first body, in the pair's frame; it looks farther than the margin.
    approach: Option<Approach>,
    /// How deep a contact is from which on regions are measured along their normals.
    deep: f64,
}

impl Wanted {
    /// All within a margin.
    pub(crate) fn within(margin: f64) -> Self {
        Self { margin, approach: None, deep: f64::INFINITY }
    }

    /// Those within a margin and, of an approach of the caller's A that looks farther, those beyond
    /// that it closes.
    pub(crate) fn of(pair: &Pair, margin: f64, approach: Option<&Approach>) -> Self {
        let approach = approach.map(|approach| pair.own_approach(approach));
        Self { approach, ..Self::within(margin) }
    }

    /// The same, and penetrations where a contact is so deep.
    pub(crate) fn with_penetrations_from(self, depth: Option<f64>) -> Self {
        Self { deep: depth.unwrap_or(f64::INFINITY), ..self }
    }

    /// Whether a contact is so deep that penetrations are wanted.
    pub(crate) fn is_deep(&self, contact: &Contact) -> bool {
        -contact.separation >= self.deep
    }

    /// None is farther.
    pub(crate) fn farthest(&self) -> f64 {
        self.approach.as_ref().map_or(self.margin, |approach| approach.within)
    }

    /// Whether those beyond the margin depend on motion.
    pub(super) fn is_of_motion(&self) -> bool {
        self.approach.is_some()
    }

    pub(super) fn closing(&self, pair: &Pair, ground: &Ground) -> Option<Closing> {
        let approach = self.approach.as_ref()?;
        Some(Closing::of(pair, ground, self.margin, approach))
    }

    /// Whether a contact, in the pair's frame and no farther than any, counts.
    pub(super) fn holds(&self, contact: &Contact) -> bool {
        let Contact { point_a, normal, separation, .. } = *contact;
        separation <= self.margin
            || self.approach.is_none_or(|a| separation <= a.closing(point_a, normal))
    }
}
