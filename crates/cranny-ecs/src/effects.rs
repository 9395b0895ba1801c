//! Which effects a scene has, for which pairs, and why. Their components are in
//! `effect_components`.
//!
//! To add one to Cranny: CONTRIBUTING, 'An effect'. An app's own needs a plugin alone:
//! `examples/custom_effect.rs`.

use std::collections::{BTreeMap, BTreeSet};

use bevy_ecs::prelude::*;
use cranny_world::description::{Accuracy, BodyKind, Effect};
use cranny_world::{BodyId, Layers};

use crate::effect_components::{Deformation, softer};

/// An effect without its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EffectKind {
    /// Overlap began and ended.
    Trigger,
    /// Distances of what is near.
    Proximity,
    /// Points, curves and regions.
    Contacts,
    /// Rigid bodies.
    Response,
    /// Bodies that pass through nothing.
    Continuous,
    /// Depth and way out.
    Penetration,
    /// Impacts, sliding, rolling.
    Sound,
    /// Dents.
    Deformation,
    /// Force and torque on bodies that somebody moves.
    ForceFeedback,
    /// Triggers of poses that are known to a tolerance.
    Tracking,
}

impl EffectKind {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Trigger,
        Self::Proximity,
        Self::Contacts,
        Self::Penetration,
        Self::Response,
        Self::Continuous,
        Self::Sound,
        Self::Deformation,
        Self::ForceFeedback,
        Self::Tracking,
    ];

    /// Its name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Trigger => "Trigger",
            Self::Proximity => "Proximity",
            Self::Contacts => "Contacts",
            Self::Response => "Response",
            Self::Continuous => "Continuous",
            Self::Penetration => "Penetration",
            Self::Sound => "Sound",
            Self::Deformation => "Deformation",
            Self::ForceFeedback => "ForceFeedback",
            Self::Tracking => "Tracking",
        }
    }

    /// `None` for an effect that this version does not compute.
    #[must_use]
    pub fn of(effect: &Effect) -> Option<Self> {
        match effect {
            Effect::Trigger { .. } => Some(Self::Trigger),
            Effect::Proximity { .. } => Some(Self::Proximity),
            Effect::Contacts { .. } => Some(Self::Contacts),
            Effect::Response => Some(Self::Response),
            Effect::Continuous => Some(Self::Continuous),
            Effect::Penetration => Some(Self::Penetration),
            Effect::Sound { .. } => Some(Self::Sound),
            Effect::Deformation { .. } => Some(Self::Deformation),
            Effect::ForceFeedback { .. } => Some(Self::ForceFeedback),
            Effect::Tracking { .. } => Some(Self::Tracking),
            _ => None,
        }
    }
}

/// Where an effect comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AskedBy {
    /// The scene, for all bodies.
    Scene,
    /// A body, for all its pairs.
    Body(BodyId),
    /// The pair itself.
    Pair,
}

/// Two bodies, the lower id first.
pub(crate) type Pair = (BodyId, BodyId);

/// The effects of the scene, of bodies and of pairs, and which pairs may meet at all.
#[derive(Resource, Clone, Debug, Default)]
pub struct EffectTable {
    /// Effects whose plugins the app has.
    plugged: BTreeSet<EffectKind>,
    scene: Vec<Effect>,
    /// Level of what states none.
    accuracy: Accuracy,
    budget: Option<u64>,
    bodies: BTreeMap<BodyId, BodyEffects>,
    pairs: BTreeMap<Pair, Vec<Effect>>,
    /// Levels of single pairs.
    levels: BTreeMap<Pair, Accuracy>,
    excluded: BTreeSet<Pair>,
    /// Bodies that name `Response` themselves.
    responding: BTreeSet<BodyId>,
    /// Counts changes of [`BodyEffects`] of bodies that were there before, and of pairs.
    revision: u64,
}

/// What decides which pairs of a body may meet, and with which effects.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodyEffects {
    pub(crate) effects: Vec<Effect>,
    pub(crate) kind: BodyKind,
    pub(crate) layers: Layers,
    pub(crate) sensor: bool,
}

impl EffectTable {
    /// Of no bodies yet, with effects for all that will come; `plugged` are those that bodies and
    /// pairs may name besides.
    pub(crate) fn new(scene: &[Effect], plugged: impl IntoIterator<Item = EffectKind>) -> Self {
        let of_scene = scene.iter().filter_map(EffectKind::of);
        let plugged = of_scene.chain(plugged).collect();
        Self { plugged, scene: scene.to_vec(), ..Self::default() }
    }

    /// With a level for what states none, and a budget for a step.
    pub(crate) fn at(self, accuracy: Accuracy, budget: Option<u64>) -> Self {
        Self { accuracy, budget, ..self }
    }

    /// Takes in the effects of a body, in place of those that it had before.
    ///
    /// Fails, and leaves out, if the app has no plugin of an effect.
    pub(crate) fn put_body(
        &mut self,
        body: BodyId,
        mut of_body: BodyEffects,
    ) -> Result<(), &'static str> {
        let missing = self.missing(&of_body.effects);
        if missing.is_some() {
            of_body.effects.retain(|effect| {
                EffectKind::of(effect).is_some_and(|kind| self.plugged.contains(&kind))
            });
        }
        if of_body.effects.iter().any(|effect| matches!(effect, Effect::Response)) {
            self.responding.insert(body);
        } else {
            self.responding.remove(&body);
        }
        let before = self.bodies.insert(body, of_body);
        if before.is_some_and(|before| before != self.bodies[&body]) {
            self.revision += 1;
        }
        missing.map_or(Ok(()), Err)
    }

    /// Lets a body go, with its pairs.
    pub(crate) fn remove_body(&mut self, body: BodyId) {
        self.bodies.remove(&body);
        self.responding.remove(&body);
        self.pairs.retain(|pair, _| pair.0 != body && pair.1 != body);
        self.levels.retain(|pair, _| pair.0 != body && pair.1 != body);
        self.excluded.retain(|pair| pair.0 != body && pair.1 != body);
    }

    /// Replaces the effects of pairs, their levels, and which never meet.
    pub(crate) fn set_pairs(
        &mut self,
        pairs: BTreeMap<Pair, Vec<Effect>>,
        levels: BTreeMap<Pair, Accuracy>,
        excluded: BTreeSet<Pair>,
    ) {
        if (&pairs, &levels, &excluded) != (&self.pairs, &self.levels, &self.excluded) {
            (self.pairs, self.levels, self.excluded) = (pairs, levels, excluded);
            self.revision += 1;
        }
    }

    /// The first of some effects whose plugin the app does not have, by name.
    pub(crate) fn missing(&self, effects: &[Effect]) -> Option<&'static str> {
        let has = |effect: &&Effect| {
            EffectKind::of(effect).is_some_and(|kind| self.plugged.contains(&kind))
        };
        effects.iter().find(|effect| !has(effect)).map(Effect::name)
    }

    /// Changes with the effects of bodies and pairs; not with bodies that come and go.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The effects of a body, and what decides which others it may meet.
    pub(crate) fn body(&self, body: BodyId) -> Option<&BodyEffects> {
        self.bodies.get(&body)
    }

    /// Whether the app has the plugin of an effect.
    #[must_use]
    pub fn has_plugin(&self, kind: EffectKind) -> bool {
        self.plugged.contains(&kind)
    }

    /// Whether a body has a part in some response: the scene, the body, a pair of its, or another
    /// body that it may meet names `Response`.
    pub(crate) fn responds(&self, body: BodyId) -> bool {
        let is_response = |effects: &[Effect]| effects.contains(&Effect::Response);
        if is_response(&self.scene) || self.responding.contains(&body) {
            return true;
        }
        let of_pair = |(pair, effects): (&Pair, &Vec<Effect>)| {
            (pair.0 == body || pair.1 == body) && is_response(effects)
        };
        self.pairs.iter().any(of_pair)
            || self.responding.iter().any(|&other| self.may_meet(body, other))
    }

    /// Whether the scene, a body or one of its pairs names `Continuous`, so that the body passes
    /// through nothing.
    pub(crate) fn is_continuous(&self, body: BodyId) -> bool {
        let names = |effects: &[Effect]| effects.contains(&Effect::Continuous);
        let of_pair = |(pair, effects): (&Pair, &Vec<Effect>)| {
            (pair.0 == body || pair.1 == body) && names(effects)
        };
        names(&self.scene) || names(self.of_body(body)) || self.pairs.iter().any(of_pair)
    }

    /// Effects of the scene as a whole.
    #[must_use]
    pub fn of_scene(&self) -> &[Effect] {
        &self.scene
    }

    /// Effects of one body beyond the scene's.
    #[must_use]
    pub fn of_body(&self, body: BodyId) -> &[Effect] {
        self.bodies.get(&body).map_or(&[], |b| &b.effects)
    }

    /// Pairs with effects of their own, the lower id first.
    pub fn of_pairs(&self) -> impl ExactSizeIterator<Item = ((BodyId, BodyId), &[Effect])> {
        self.pairs.iter().map(|(&pair, effects)| (pair, &**effects))
    }

    /// The level of effects that state none, where their pair states none either.
    #[must_use]
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// Elementary tests that a step may take for pairs with `Trigger` and `Proximity` alone, all
    /// together; `None`: as many as they need.
    #[must_use]
    pub fn budget(&self) -> Option<u64> {
        self.budget
    }

    /// Levels of single pairs, the lower id first.
    pub(crate) fn pair_levels(&self) -> &BTreeMap<Pair, Accuracy> {
        &self.levels
    }

    /// The level at which `Trigger` and `Proximity` of a pair are known; `None` where it has
    /// neither.
    #[must_use]
    pub fn accuracy_of(&self, a: BodyId, b: BodyId) -> Option<Accuracy> {
        let unstated = self.levels.get(&ordered(a, b)).copied().unwrap_or(self.accuracy);
        let mut read = self.of_pair(a, b).filter(|(effect, _)| effect.has_levels()).peekable();
        read.peek()?;
        self.of_pair(a, b).map(|(effect, _)| effect.level(unstated)).reduce(Accuracy::join)
    }

    /// Whether one of two bodies is a sensor.
    pub(crate) fn is_sensed(&self, a: BodyId, b: BodyId) -> bool {
        [a, b].into_iter().any(|id| self.bodies.get(&id).is_some_and(|body| body.sensor))
    }

    /// Pairs that never meet, the lower id first.
    pub fn excluded(&self) -> impl ExactSizeIterator<Item = (BodyId, BodyId)> {
        self.excluded.iter().copied()
    }

    /// Bodies, by id.
    pub fn bodies(&self) -> impl ExactSizeIterator<Item = BodyId> {
        self.bodies.keys().copied()
    }

    /// Pairs of which something is said by name.
    pub(crate) fn named_pairs(&self) -> impl Iterator<Item = Pair> {
        let levels = self.levels.keys();
        self.pairs.keys().chain(levels).chain(&self.excluded).copied()
    }

    /// Whether a pair may meet: its layers meet, it is not excluded, and not both are fixed.
    #[must_use]
    pub fn may_meet(&self, a: BodyId, b: BodyId) -> bool {
        let (Some(body_a), Some(body_b)) = (self.bodies.get(&a), self.bodies.get(&b)) else {
            return false;
        };
        let both_fixed = body_a.kind == BodyKind::Fixed && body_b.kind == BodyKind::Fixed;
        a != b
            && !both_fixed
            && body_a.layers.meets(body_b.layers)
            && !self.excluded.contains(&ordered(a, b))
    }

    /// Why a pair may not meet, in words.
    #[must_use]
    pub fn why_apart(&self, a: BodyId, b: BodyId) -> &'static str {
        let kind = |id: BodyId| self.bodies.get(&id).map(|body| body.kind);
        if self.may_meet(a, b) {
            "they may meet"
        } else if self.excluded.contains(&ordered(a, b)) {
            "the scene excludes them"
        } else if kind(a) == Some(BodyKind::Fixed) && kind(b) == Some(BodyKind::Fixed) {
            "both are fixed"
        } else {
            "they share no layer"
        }
    }

    /// The effects of a pair, each with where it comes from; the scene's first. Empty if it may not
    /// meet; without `Response` and `ForceFeedback` if one of the two is a sensor.
    pub fn of_pair(&self, a: BodyId, b: BodyId) -> impl Iterator<Item = (&Effect, AskedBy)> {
        let own: &[Effect] = self.pairs.get(&ordered(a, b)).map_or(&[], |effects| effects);
        let scene = self.scene.iter().map(|e| (e, AskedBy::Scene));
        let bodies = [a, b]
            .into_iter()
            .flat_map(|id| self.of_body(id).iter().map(move |e| (e, AskedBy::Body(id))));
        let own = own.iter().map(|e| (e, AskedBy::Pair));
        let meets = self.may_meet(a, b);
        let sensor = self.is_sensed(a, b);
        let all = scene.chain(bodies).chain(own);
        all.filter(move |(effect, _)| meets && !(sensor && effect.pushes()))
    }

    /// Whether a pair has an effect.
    #[must_use]
    pub fn asks(&self, kind: EffectKind, a: BodyId, b: BodyId) -> bool {
        self.of_pair(a, b).any(|(effect, _)| EffectKind::of(effect) == Some(kind))
    }

    /// The distance up to which a pair's distance is reported; `None` for a pair without
    /// `Proximity`.
    #[must_use]
    pub fn proximity(&self, a: BodyId, b: BodyId) -> Option<f64> {
        let distances = self.of_pair(a, b).filter_map(|(effect, _)| match *effect {
            Effect::Proximity { within, .. } => Some(within),
            _ => None,
        });
        distances.reduce(f64::max)
    }

    /// The margin up to which contacts of a pair are reported; `None` for a pair without
    /// `Contacts`.
    #[must_use]
    pub fn contact_margin(&self, a: BodyId, b: BodyId) -> Option<f64> {
        let margins = self.of_pair(a, b).filter_map(|(effect, _)| match *effect {
            Effect::Contacts { margin } => Some(margin),
            _ => None,
        });
        margins.reduce(f64::max)
    }

    /// The tolerance within which contacts of a pair neither begin nor end: of those with `Trigger`
    /// and `Tracking`; `None` for others.
    #[must_use]
    pub fn tracked(&self, a: BodyId, b: BodyId) -> Option<f64> {
        let tolerances = self.of_pair(a, b).filter_map(|(effect, _)| match *effect {
            Effect::Tracking { tolerance } => Some(tolerance),
            _ => None,
        });
        tolerances.reduce(f64::max).filter(|_| self.asks(EffectKind::Trigger, a, b))
    }

    /// The speed above which a pair is heard; `None` for a pair without `Sound`.
    #[must_use]
    pub fn heard_above(&self, a: BodyId, b: BodyId) -> Option<f64> {
        let speeds = self.of_pair(a, b).filter_map(|(effect, _)| match *effect {
            Effect::Sound { above } => Some(above),
            _ => None,
        });
        speeds.reduce(f64::min)
    }

    /// How a body yields to another one; `None` where no `Deformation` says that it does.
    #[must_use]
    pub fn yielding(&self, body: BodyId, to: BodyId) -> Option<Deformation> {
        let asked = self.of_pair(body, to).filter_map(|(effect, by)| match *effect {
            Effect::Deformation { hardness, radius } if by != AskedBy::Body(to) => {
                Some(Deformation { hardness, radius })
            }
            _ => None,
        });
        asked.reduce(softer)
    }

    /// How stiff a body that somebody moves feels another one; `None` for a pair without
    /// `ForceFeedback`, and for a body that is not kinematic.
    #[must_use]
    pub fn felt_stiffness(&self, body: BodyId, other: BodyId) -> Option<f64> {
        let kinematic = self.bodies.get(&body).is_some_and(|b| b.kind == BodyKind::Kinematic);
        let stiffnesses = self.of_pair(body, other).filter_map(|(effect, _)| match *effect {
            Effect::ForceFeedback { stiffness } => Some(stiffness),
            _ => None,
        });
        stiffnesses.reduce(f64::max).filter(|_| kinematic)
    }
}

/// The lower id first.
pub(crate) fn ordered(a: BodyId, b: BodyId) -> (BodyId, BodyId) {
    (a.min(b), a.max(b))
}
