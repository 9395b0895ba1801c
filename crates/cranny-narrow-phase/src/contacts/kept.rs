//! What searches keep for the next one of the same models.

use super::ownership::Ownership;
use super::posed::Posed;
use crate::pair::{Pair, Side, Whose};

/// What of a search serves the next one: what the models alone say of the leaves that it came across.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    whose: Whose,
    pub(super) owned: [Ownership; 2],
    pub(super) posed: Option<Box<[Posed; 2]>>,
}

impl Kept {
    /// Forgets what other models said. Whether these are the ones that it was of.
    pub(super) fn belong_to(&mut self, pair: &Pair) -> bool {
        let known = self.whose.are_of(pair);
        if !known {
            *self = Self { whose: Whose::of(pair), ..Self::default() };
        }
        known
    }

    /// Lets go of all leaves.
    pub(crate) fn let_go(&mut self) {
        self.posed = None;
    }

    /// Makes room for what faces own, which a search for contacts asks for.
    pub(super) fn reserve(&mut self, pair: &Pair) {
        for side in Side::BOTH {
            self.owned[side.index()].reserve(pair, side);
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        let posed = self.posed.as_ref().map_or(0, |posed| {
            size_of_val(&**posed) + posed.iter().map(Posed::bytes).sum::<usize>()
        });
        self.owned.iter().map(Ownership::bytes).sum::<usize>() + posed
    }
}
