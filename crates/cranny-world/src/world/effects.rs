//! What is wanted of bodies and pairs: effects, margins, demands. CONTRIBUTING, 'An effect', says
//! how to add one.

use std::collections::BTreeMap;

use cranny_broad_phase::{BroadPhase, ProxyId};
use cranny_narrow_phase::Demand;

use super::{Pair, World};
use crate::body::{Body, BodyId};
use crate::bounds::world_box;
use crate::demand::{ContactFields, Wish};
use crate::description::{Accuracy, Effect};
use crate::error::WorldError;

/// Effects and demands.
impl World {
    /// Sets the scene's effects, which hold for all bodies, in place of those set before.
    ///
    /// # Errors
    ///
    /// A [margin](WorldError::Margin) that is no length.
    pub fn set_scene_effects(&mut self, effects: &[Effect]) -> Result<(), WorldError> {
        self.scene = Wish::of(effects, || "the scene".to_owned())?;
        let ids: Vec<BodyId> = self.bodies.keys().copied().collect();
        ids.into_iter().try_for_each(|id| self.refresh_box(id))
    }

    /// Sets the effects of one body, in place of those set before.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], or a [margin](WorldError::Margin) that is no length.
    pub fn set_effects(&mut self, body: BodyId, effects: &[Effect]) -> Result<(), WorldError> {
        let known = self.bodies.get_mut(&body).ok_or(WorldError::UnknownBody { body })?;
        known.wish = Wish::of(effects, || format!("body '{}'", known.name))?;
        known.effects = effects.to_vec();
        self.refresh_box(body)
    }

    /// Sets the effects of one pair, in place of those set before.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`], or a [margin](WorldError::Margin)
    /// that is no length.
    pub fn set_pair_effects(
        &mut self,
        a: BodyId,
        b: BodyId,
        effects: &[Effect],
    ) -> Result<(), WorldError> {
        let pair = self.known_pair(a, b)?;
        let names = (self.known(a)?.name(), self.known(b)?.name());
        let wish = Wish::of(effects, || format!("the pair '{}' and '{}'", names.0, names.1))?;
        if effects.is_empty() {
            self.pair_wishes.remove(&pair);
        } else {
            self.pair_wishes.insert(pair, wish);
        }
        self.refresh_box(a)?;
        self.refresh_box(b)
    }

    /// Says at which level triggers and distances that state none are answered, in place of
    /// `Exact`.
    pub fn set_accuracy(&mut self, accuracy: Accuracy) {
        self.accuracy = accuracy;
    }

    /// Says the same for one pair, whose level then counts in place of the world's; `None` takes it
    /// back.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn set_pair_accuracy(
        &mut self,
        a: BodyId,
        b: BodyId,
        accuracy: Option<Accuracy>,
    ) -> Result<(), WorldError> {
        let pair = self.known_pair(a, b)?;
        match accuracy {
            Some(accuracy) => self.pair_levels.insert(pair, accuracy),
            None => self.pair_levels.remove(&pair),
        };
        Ok(())
    }

    /// Sets how many elementary tests a step may take for all pairs together that have triggers
    /// and distances alone; `None`: as many as they need. Pairs with other effects are answered
    /// exactly, and do not count. What a pair keeps to go on with takes some 5 MiB at most
    /// while it moves.
    pub fn set_budget(&mut self, budget: Option<u64>) {
        self.budget = budget;
    }

    /// The level at which a pair is answered: the most exact of those of its effects, where an
    /// effect that states none is at the pair's level, or else at the world's. What needs contacts
    /// is exact; a pair with a primitive is answered at once, whatever its level.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn accuracy_of(&self, a: BodyId, b: BodyId) -> Result<Accuracy, WorldError> {
        let pair = self.known_pair(a, b)?;
        let [a, b] = [self.known(pair.0)?, self.known(pair.1)?];
        let level = self.level(&self.wish(pair, a, b), pair, a.sensor || b.sensor);
        Ok(level.unwrap_or_default())
    }

    /// The level at which a pair is estimated; `None` where it is answered exactly, at once.
    pub(super) fn level(&self, wish: &Wish, pair: Pair, sensor: bool) -> Option<Accuracy> {
        let unstated = self.pair_levels.get(&pair).copied().unwrap_or(self.accuracy);
        let level = wish.accuracy(unstated, sensor);
        let within_budget = self.budget.is_some() && wish.may_stay_open(sensor);
        (within_budget || level != Accuracy::Exact).then_some(level)
    }

    /// Says that a pair never meets, whatever is wanted: links joined by a joint overlap by design.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn exclude_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), WorldError> {
        let pair = self.known_pair(a, b)?;
        self.excluded.insert(pair);
        Ok(())
    }

    /// Takes back that a pair [never meets](Self::exclude_pair).
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn include_pair(&mut self, a: BodyId, b: BodyId) -> Result<(), WorldError> {
        let pair = self.known_pair(a, b)?;
        self.excluded.remove(&pair);
        Ok(())
    }

    /// Whether a pair may meet at all: its bodies' layers meet, they are not both fixed, and it is
    /// not
    /// [excluded](Self::exclude_pair).
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn may_meet(&self, a: BodyId, b: BodyId) -> Result<bool, WorldError> {
        let pair = self.known_pair(a, b)?;
        Ok(!self.excluded.contains(&pair) && self.known(a)?.may_meet(self.known(b)?))
    }

    /// Says what somebody reads of the effect `Contacts` from now on: no more is computed for it.
    /// Until then, all. Where nobody reads anything, the effect needs nothing. An answer may hold
    /// more than is read.
    ///
    /// Boxes keep the margins of the effects, so candidate pairs do not depend on it.
    pub fn set_contact_fields(&mut self, read: ContactFields) {
        self.read = read;
    }

    /// Says what somebody reads of single pairs besides from now on, in place of what was read of
    /// any before. The lower id comes first.
    pub fn set_contact_fields_of_pairs(&mut self, read: BTreeMap<(BodyId, BodyId), ContactFields>) {
        self.read_of_pairs = read;
    }

    /// What is read of a pair.
    pub(super) fn read_of(&self, pair: Pair) -> ContactFields {
        self.read_of_pairs.get(&pair).map_or(self.read, |&besides| besides.join(self.read))
    }

    /// What is wanted of the narrow phase for a pair: the least that gives the fields which are
    /// read, joined over the scene's, both bodies' and the pair's effects; [`Demand::None`] where
    /// the pair [may not meet](Self::may_meet).
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownBody`], [`WorldError::SameBody`].
    pub fn demand_of(&self, a: BodyId, b: BodyId) -> Result<Demand, WorldError> {
        let pair = self.known_pair(a, b)?;
        Ok(self.demand(pair, self.known(pair.0)?, self.known(pair.1)?))
    }

    pub(super) fn demand(&self, pair: Pair, a: &Body, b: &Body) -> Demand {
        self.wish(pair, a, b).fields(self.read_of(pair)).demand()
    }

    /// What the scene's, both bodies' and the pair's effects need together: nothing where the two
    /// may not meet.
    pub(super) fn wish(&self, pair: Pair, a: &Body, b: &Body) -> Wish {
        if self.excluded.contains(&pair) || !a.may_meet(b) {
            return Wish::default();
        }
        let of_pair = self.pair_wishes.get(&pair).copied().unwrap_or_default();
        self.scene.join(a.wish).join(b.wish).join(of_pair)
    }

    /// By how much a body's box is grown, so that boxes overlap wherever surfaces are no farther
    /// apart than the pair's margin. What both bodies know of (the scene's margin, the pair's) they
    /// share half and half; the body's own margin its partner does not know.
    pub(super) fn growth(&self, id: BodyId, body: &Body) -> f64 {
        let of_pairs = self.pair_wishes.iter().filter(|((a, b), _)| *a == id || *b == id);
        let shared = of_pairs.fold(self.scene.margin(), |m, (_, wish)| m.max(wish.margin()));
        body.wish.margin().max(0.5 * shared)
    }

    pub(super) fn refresh_box(&mut self, id: BodyId) -> Result<(), WorldError> {
        let body = self.known(id)?;
        let around = world_box(&body.shape, &body.pose, self.growth(id, body));
        let refused = self.broad_phase.set_box(ProxyId(id.0), around).err();
        refused.map_or(Ok(()), |source| {
            let name = self.name(id).unwrap_or_default().to_owned();
            Err(WorldError::BroadPhase { name, source })
        })
    }
}
