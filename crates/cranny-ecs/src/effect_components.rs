//! Effects as components: of a body for all its pairs, of a pair's entity for the pair. To add one
//! to Cranny: CONTRIBUTING, 'An effect'.

use bevy_ecs::prelude::*;
use cranny_world::description::{Accuracy, Effect};

use crate::admission::{note_change, note_removal};
use crate::effects::EffectTable;

/// `Trigger` for all pairs of a body, or for the pair whose entity has it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Trigger;

/// `Proximity` for all pairs of a body, or for the pair whose entity has it.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Proximity {
    /// Distance of surfaces up to which a pair is reported, > 0.
    pub within: f64,
}

/// How exactly the [`Trigger`] and the [`Proximity`] beside it are known; without it, at the level
/// of the pair ([`PairAccuracy`]) or else of the app
/// ([`CrannyPlugins::accuracy`](crate::CrannyPlugins::accuracy)). The most exact level of a
/// pair's effects counts, and effects other than these two are exact.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct EffectAccuracy {
    /// Of `Trigger`.
    pub trigger: Option<Accuracy>,
    /// Of `Proximity`.
    pub proximity: Option<Accuracy>,
}

/// Beside a [`BodyPair`](crate::BodyPair): the level of the pair's effects that state none.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct PairAccuracy(pub Accuracy);

/// `Contacts` for all pairs of a body, or for the pair whose entity has it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Contacts {
    /// Separation up to which near contacts are reported, >= 0.
    pub margin: f64,
}

/// `Response` for all pairs of a body, or for the pair whose entity has it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Response;

/// A body with it passes through no other one, nor any through it, however fast; beside a pair it
/// holds for both bodies. It needs [`Response`](crate::Response).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Continuous;

/// `Penetration` for all pairs of a body, or for the pair whose entity has it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Penetration;

/// `Sound` for all pairs of a body, or for the pair whose entity has it. It needs
/// [`Response`](crate::Response).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Sound {
    /// Speed above which a collision, sliding or rolling is heard, > 0, units of length a second.
    pub above: f64,
}

/// A body with it is dented where it is hit; beside a pair it holds for both bodies, where they hit
/// each other. It needs [`Response`](crate::Response).
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Deformation {
    /// Energy that it takes to displace a unit of volume, > 0: the pressure at which the material
    /// yields.
    pub hardness: f64,
    /// How far from where it is hit the body yields, > 0. Vertices of its mesh move, so its
    /// triangles have to be smaller.
    pub radius: f64,
}

/// A kinematic body with it feels what it meets; beside a pair it holds for the pair.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct ForceFeedback {
    /// Force a unit of length by which the body is moved into another one, > 0.
    pub stiffness: f64,
}

/// Collisions of all pairs of a body, or of the pair whose entity has it, begin and end where that
/// is certain though poses are known to a tolerance only. It needs [`Trigger`](crate::Trigger),
/// whose messages they are. A [`Tracker`](crate::Tracker) beside it takes a device's poses.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
#[component(immutable, on_insert = note_change, on_remove = note_removal)]
pub struct Tracking {
    /// By how much poses misplace a point of a body at most, > 0, units of length.
    pub tolerance: f64,
}

/// The effects that the components of an entity name.
pub(crate) fn effects_of(entity: EntityRef<'_>) -> Vec<Effect> {
    let levels = entity.get::<EffectAccuracy>().copied().unwrap_or_default();
    let trigger = entity.get::<Trigger>().map(|_| Effect::Trigger { accuracy: levels.trigger });
    let proximity = entity.get::<Proximity>();
    let proximity = proximity
        .map(|&Proximity { within }| Effect::Proximity { within, accuracy: levels.proximity });
    let contacts = entity.get::<Contacts>();
    let contacts = contacts.map(|contacts| Effect::Contacts { margin: contacts.margin });
    let response = entity.get::<Response>().map(|_| Effect::Response);
    let continuous = entity.get::<Continuous>().map(|_| Effect::Continuous);
    let penetration = entity.get::<Penetration>().map(|_| Effect::Penetration);
    let sound = entity.get::<Sound>().map(|&Sound { above }| Effect::Sound { above });
    let deformation = entity.get::<Deformation>();
    let deformation = deformation
        .map(|&Deformation { hardness, radius }| Effect::Deformation { hardness, radius });
    let feedback = entity.get::<ForceFeedback>();
    let feedback = feedback.map(|&ForceFeedback { stiffness }| Effect::ForceFeedback { stiffness });
    let tracking = entity.get::<Tracking>();
    let tracking = tracking.map(|&Tracking { tolerance }| Effect::Tracking { tolerance });
    let of_detection = [trigger, proximity, contacts, penetration, feedback, tracking];
    let of_response = [response, continuous, sound, deformation];
    of_detection.into_iter().chain(of_response).flatten().collect()
}

/// Gives an entity some effects more. Of two lengths and of two stiffnesses the larger counts, of
/// two thresholds and two hardnesses the smaller, of two levels the more exact; what states none is
/// then at the app's, also in a pair that states another one.
pub(crate) fn add_effects(entity: &mut EntityWorldMut<'_>, effects: &[Effect]) {
    for effect in effects {
        match *effect {
            Effect::Trigger { accuracy } => {
                let was_there = entity.contains::<Trigger>();
                let levels = entity.get::<EffectAccuracy>().copied().unwrap_or_default();
                let trigger = joined(entity, was_there.then_some(levels.trigger), accuracy);
                state(entity, EffectAccuracy { trigger, ..levels });
                entity.insert(Trigger);
            }
            Effect::Proximity { within, accuracy } => {
                let before = entity.get::<Proximity>().map(|proximity| proximity.within);
                let levels = entity.get::<EffectAccuracy>().copied().unwrap_or_default();
                let proximity = joined(entity, before.map(|_| levels.proximity), accuracy);
                state(entity, EffectAccuracy { proximity, ..levels });
                entity.insert(Proximity { within: before.map_or(within, |b| b.max(within)) });
            }
            Effect::Contacts { margin } => {
                let before = entity.get::<Contacts>().map_or(margin, |c| c.margin);
                entity.insert(Contacts { margin: margin.max(before) });
            }
            Effect::Response => drop(entity.insert(Response)),
            Effect::Continuous => drop(entity.insert(Continuous)),
            Effect::Penetration => drop(entity.insert(Penetration)),
            Effect::Sound { above } => {
                let before = entity.get::<Sound>().map_or(above, |sound| sound.above);
                entity.insert(Sound { above: above.min(before) });
            }
            Effect::Deformation { hardness, radius } => {
                let asked = Deformation { hardness, radius };
                let before = entity.get::<Deformation>().copied().unwrap_or(asked);
                entity.insert(softer(before, asked));
            }
            Effect::ForceFeedback { stiffness } => {
                let before = entity.get::<ForceFeedback>().map_or(stiffness, |f| f.stiffness);
                entity.insert(ForceFeedback { stiffness: stiffness.max(before) });
            }
            Effect::Tracking { tolerance } => {
                let before = entity.get::<Tracking>().map_or(tolerance, |t| t.tolerance);
                entity.insert(Tracking { tolerance: tolerance.max(before) });
            }
            _ => {}
        }
    }
}

/// The level of an effect that an entity has already and gets once more.
fn joined(
    entity: &EntityWorldMut<'_>,
    before: Option<Option<Accuracy>>,
    now: Option<Accuracy>,
) -> Option<Accuracy> {
    let Some(before) = before.filter(|before| *before != now) else { return now };
    let unstated = entity.world().resource::<EffectTable>().accuracy();
    Some(before.unwrap_or(unstated).join(now.unwrap_or(unstated)))
}

fn state(entity: &mut EntityWorldMut<'_>, levels: EffectAccuracy) {
    if levels != EffectAccuracy::default() || entity.contains::<EffectAccuracy>() {
        entity.insert(levels);
    }
}

/// What yields more.
pub(crate) fn softer(one: Deformation, other: Deformation) -> Deformation {
    if other.hardness < one.hardness { other } else { one }
}
