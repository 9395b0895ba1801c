//! Pairs of bodies of which something else holds than of all: entities with two ends.

use std::collections::{BTreeMap, BTreeSet};

use bevy_ecs::lifecycle::HookContext;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use cranny_world::BodyId;
use cranny_world::description::{Accuracy, Effect};

use crate::admission::{Noted, entities_with, note_change, note_removal};
use crate::body::{Bodies, Body};
use crate::effect_components::{PairAccuracy, effects_of};
use crate::effects::{EffectTable, Pair, ordered};
use crate::error::{Failure, SceneAppError};

/// A pair of bodies. Effects ([`Trigger`](crate::Trigger), [`Contacts`](crate::Contacts),
/// [`Response`](crate::Response)) beside it hold for the pair, whatever effects its bodies have;
/// [`NeverMeet`] keeps them apart.
///
/// It counts as long as both ends are bodies, and has no effect otherwise.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_pairs)]
pub struct BodyPair {
    /// One end.
    pub a: Entity,
    /// The other.
    pub b: Entity,
}

/// Beside a [`BodyPair`]: the two pass through each other, whatever their effects.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct NeverMeet;

/// A pair that went leaves no entity to look at.
fn note_pairs(mut world: DeferredWorld<'_>, _: HookContext) {
    if let Some(mut noted) = world.get_resource_mut::<Noted>() {
        noted.pairs = true;
    }
}

/// Puts the effects of pair entities into the [`EffectTable`].
pub(crate) fn relate_pairs(world: &mut World) {
    let mut pairs: BTreeMap<Pair, Vec<Effect>> = BTreeMap::new();
    let mut levels: BTreeMap<Pair, Accuracy> = BTreeMap::new();
    let mut excluded: BTreeSet<Pair> = BTreeSet::new();
    let (mut missing, mut meshless) = (None, None);
    let Some(pair_id) = world.component_id::<BodyPair>() else { return };
    // Ascending, so that nothing depends on the order in which components came.
    let entities = entities_with(world, Some(pair_id));
    let table = world.resource::<EffectTable>();
    for entity in entities {
        let Ok(pair) = world.get_entity(entity) else { continue };
        let Some(&BodyPair { a, b }) = pair.get::<BodyPair>() else { continue };
        let id = |end: Entity| world.get::<Body>(end).map(|body| body.id);
        let (Some(a), Some(b)) = (id(a), id(b)) else { continue };
        if a == b {
            continue;
        }
        let effects = effects_of(pair);
        if let Some(effect) = table.missing(&effects) {
            missing.get_or_insert((a, effect));
            continue;
        }
        if pair.contains::<NeverMeet>() {
            excluded.insert(ordered(a, b));
        }
        if let Some(&PairAccuracy(level)) = pair.get::<PairAccuracy>() {
            let joined = levels.entry(ordered(a, b)).or_insert(level);
            *joined = joined.join(level);
        }
        let works_on = effects.iter().find(|effect| effect.works_on_meshes()).map(Effect::name);
        let primitive = |id: BodyId| {
            let record = world.resource::<Bodies>().get(id)?;
            Some((record.name.clone(), record.shape.primitive()?.name()))
        };
        let refused = works_on.and_then(|effect| {
            [a, b].into_iter().find_map(primitive).map(|(body, what)| (body, what, effect))
        });
        if let Some((body, what, effect)) = refused {
            meshless.get_or_insert(SceneAppError::NeedsMesh { body, what, effect });
            continue;
        }
        if !effects.is_empty() {
            pairs.entry(ordered(a, b)).or_default().extend(effects);
        }
    }
    if let Some((body, effect)) = missing {
        let body = world.resource::<Bodies>().name(body).to_owned();
        world.resource_mut::<Failure>().set(SceneAppError::EffectNotPlugged { body, effect });
    }
    if let Some(error) = meshless {
        world.resource_mut::<Failure>().set(error);
    }
    world.resource_mut::<EffectTable>().set_pairs(pairs, levels, excluded);
}
