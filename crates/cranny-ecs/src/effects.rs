//! Which effects a scene asks for, for which pairs, and why.

use std::collections::{BTreeMap, BTreeSet};

use bevy_ecs::prelude::Resource;
use cranny_world::BodyId;
use cranny_world::description::{BodyKind, Effect, SceneDescription};

use crate::error::SceneAppError;

/// An effect without its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EffectKind {
    /// Overlap began and ended.
    Trigger,
    /// Points, curves and regions.
    Contacts,
    /// Rigid bodies.
    Response,
}

impl EffectKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Trigger, Self::Contacts, Self::Response];

    /// Its name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Trigger => "Trigger",
            Self::Contacts => "Contacts",
            Self::Response => "Response",
        }
    }

    /// `None` for an effect that this version does not compute.
    #[must_use]
    pub fn of(effect: &Effect) -> Option<Self> {
        match effect {
            Effect::Trigger => Some(Self::Trigger),
            Effect::Contacts { .. } => Some(Self::Contacts),
            Effect::Response => Some(Self::Response),
            _ => None,
        }
    }
}

/// Who asks for an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AskedBy {
    /// The scene, for all bodies.
    Scene,
    /// A body, for all its pairs.
    Body(BodyId),
    /// The pair itself.
    Pair,
}

/// The effects of a scene, and which pairs may meet at all.
#[derive(Resource, Clone, Debug, Default)]
pub struct EffectTable {
    scene: Vec<Effect>,
    bodies: Vec<BodyEffects>,
    pairs: BTreeMap<(BodyId, BodyId), Vec<Effect>>,
    excluded: BTreeSet<(BodyId, BodyId)>,
}

#[derive(Clone, Debug)]
struct BodyEffects {
    effects: Vec<Effect>,
    kind: BodyKind,
    layers: BTreeSet<String>,
}

impl EffectTable {
    /// Of a scene.
    ///
    /// # Errors
    ///
    /// A [pair](SceneAppError::UnknownBody) that names a body which the scene does not have, an
    /// [index](SceneAppError::NoSuchIndex) without a body, or an
    /// [effect](SceneAppError::UnsupportedEffect) that this version does not compute.
    pub fn of(scene: &SceneDescription) -> Result<Self, SceneAppError> {
        let ids: BTreeMap<&str, BodyId> =
            scene.bodies.iter().enumerate().map(|(i, b)| (&*b.name, BodyId(i as u32))).collect();
        let mut table = Self { scene: scene.effects.clone(), ..Self::default() };
        for body in &scene.bodies {
            table.bodies.push(BodyEffects {
                effects: body.effects.clone(),
                kind: body.kind,
                layers: body.layers.iter().cloned().collect(),
            });
        }
        for pair in &scene.pairs {
            let id = |name: &String| {
                ids.get(&**name)
                    .copied()
                    .ok_or_else(|| SceneAppError::UnknownBody { name: name.clone() })
            };
            let key = ordered(id(&pair.a)?, id(&pair.b)?);
            table.pairs.entry(key).or_default().extend(&pair.effects);
        }
        for &(a, b) in &scene.excluded_pairs {
            let known = |index: usize| {
                if index < scene.bodies.len() {
                    Ok(BodyId(index as u32))
                } else {
                    Err(SceneAppError::NoSuchIndex { index, bodies: scene.bodies.len() })
                }
            };
            table.excluded.insert(ordered(known(a)?, known(b)?));
        }
        for effect in table.all() {
            if EffectKind::of(effect).is_none() {
                return Err(SceneAppError::UnsupportedEffect { effect: effect.name() });
            }
        }
        Ok(table)
    }

    fn all(&self) -> impl Iterator<Item = &Effect> {
        let of_bodies = self.bodies.iter().flat_map(|b| &b.effects);
        self.scene.iter().chain(of_bodies).chain(self.pairs.values().flatten())
    }

    /// Whether the scene names the effect anywhere.
    #[must_use]
    pub fn names(&self, kind: EffectKind) -> bool {
        self.all().any(|effect| EffectKind::of(effect) == Some(kind))
    }

    /// Effects of the scene as a whole.
    #[must_use]
    pub fn of_scene(&self) -> &[Effect] {
        &self.scene
    }

    /// Effects of one body beyond the scene's.
    #[must_use]
    pub fn of_body(&self, body: BodyId) -> &[Effect] {
        self.bodies.get(body.0 as usize).map_or(&[], |b| &b.effects)
    }

    /// Pairs with effects of their own, the lower id first.
    pub fn of_pairs(&self) -> impl ExactSizeIterator<Item = ((BodyId, BodyId), &[Effect])> {
        self.pairs.iter().map(|(&pair, effects)| (pair, &**effects))
    }

    /// Pairs that never meet, the lower id first.
    pub fn excluded(&self) -> impl ExactSizeIterator<Item = (BodyId, BodyId)> {
        self.excluded.iter().copied()
    }

    /// Number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// Whether a pair may meet: it shares a layer, is not excluded, and not both are fixed.
    #[must_use]
    pub fn may_meet(&self, a: BodyId, b: BodyId) -> bool {
        let (Some(body_a), Some(body_b)) =
            (self.bodies.get(a.0 as usize), self.bodies.get(b.0 as usize))
        else {
            return false;
        };
        let both_fixed = body_a.kind == BodyKind::Fixed && body_b.kind == BodyKind::Fixed;
        a != b
            && !both_fixed
            && !body_a.layers.is_disjoint(&body_b.layers)
            && !self.excluded.contains(&ordered(a, b))
    }

    /// Why a pair may not meet, in words.
    #[must_use]
    pub fn why_apart(&self, a: BodyId, b: BodyId) -> &'static str {
        let kind = |id: BodyId| self.bodies.get(id.0 as usize).map(|body| body.kind);
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

    /// The effects of a pair, each with who asks; the scene's first. Empty if it may not meet.
    pub fn of_pair(&self, a: BodyId, b: BodyId) -> impl Iterator<Item = (&Effect, AskedBy)> {
        let own: &[Effect] = self.pairs.get(&ordered(a, b)).map_or(&[], |effects| effects);
        let scene = self.scene.iter().map(|e| (e, AskedBy::Scene));
        let bodies = [a, b]
            .into_iter()
            .flat_map(|id| self.of_body(id).iter().map(move |e| (e, AskedBy::Body(id))));
        let own = own.iter().map(|e| (e, AskedBy::Pair));
        let meets = self.may_meet(a, b);
        scene.chain(bodies).chain(own).filter(move |_| meets)
    }

    /// Whether a pair is asked for an effect.
    #[must_use]
    pub fn asks(&self, kind: EffectKind, a: BodyId, b: BodyId) -> bool {
        self.of_pair(a, b).any(|(effect, _)| EffectKind::of(effect) == Some(kind))
    }

    /// The margin up to which contacts of a pair are reported; `None` where nobody asks for any.
    #[must_use]
    pub fn contact_margin(&self, a: BodyId, b: BodyId) -> Option<f64> {
        let margins = self.of_pair(a, b).filter_map(|(effect, _)| match *effect {
            Effect::Contacts { margin } => Some(margin),
            _ => None,
        });
        margins.reduce(f64::max)
    }
}

/// The lower id first.
pub(crate) fn ordered(a: BodyId, b: BodyId) -> (BodyId, BodyId) {
    (a.min(b), a.max(b))
}
