//! `Deformation`: dents that stay where bodies are hit.
//!
//! A plastic dent takes up energy in proportion to its volume (Martel, 1895; "dynamic hardness" is
//! the energy a unit of volume). The energy of a hit is half of its impulse times the speed at
//! which the surfaces met; two bodies that both yield share it in inverse proportion to their
//! hardness, as bodies do that press on each other by one force. The vertices around the hit move
//! along it so that the body loses that volume ([`Dent`]); its hull, trees and patches follow, and
//! with the next step the dented collider takes the place of the one before: for solver, detection,
//! questions, recordings and pictures alike. Its mass stays: the material is pressed together.

use std::collections::BTreeMap;

use bevy_app::{App, Plugin};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_exact::DVec3;
use cranny_geometry::{Blow, Dent, Model};
use cranny_primitives::cast_ray;
use cranny_world::BodyId;

use crate::body::{Bodies, pose_of};
use crate::clock::{CrannyStep, StepSystems};
use crate::collider::Collider;
use crate::collision::{Velocities, hardest};
use crate::diagnostics::Stopwatch;
use crate::effect_components::Deformation;
use crate::effects::{EffectKind, EffectTable, Pair};
use crate::error::{Failure, SceneAppError};
use crate::properties::{Density, Mass};
use crate::response::ResponseSystems;
use crate::solved::RigidBodies;

/// What would dent a body by less than this share of the dent's radius springs back. Larger: what
/// lands softly leaves no trace; smaller: what rests creeps in, and each step prepares a model.
const ELASTIC: f64 = 1e-3;

/// How much of a body's thickness a dent takes at most. Larger: a later hit on the other side meets
/// the dent; smaller: a thin sheet hardly yields.
const OF_THICKNESS: f64 = 0.4;

/// How far a dent's depth goes at most, as a share of its radius. Larger: the dent's walls are so
/// steep that faces turn into needles; smaller: a hard hit is taken for a softer one.
const OF_RADIUS: f64 = 0.5;

/// How far beneath the surface a ray begins that measures the thickness, as a share of the radius.
/// Smaller: it meets the surface that was hit; larger: a sheet that thin is not measured.
const BENEATH: f64 = 1e-4;

/// The systems of `Deformation`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DeformationSystems {
    /// [`Dented`], and colliders that take the place of those before in the next step.
    Dent,
}

/// A body was dented.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct Dented {
    /// Which body.
    pub body: Entity,
    /// Its stable id.
    pub id: BodyId,
    /// By which one.
    pub by: Entity,
    /// Where, world coordinates, at the beginning of the step.
    pub point: DVec3,
    /// Unit, into the body, world axes.
    pub inward: DVec3,
    /// Of the dent's middle.
    pub depth: f64,
    /// The volume that the body lost.
    pub volume: f64,
    /// The energy that the dent took up: less than that of the hit where the body is too thin, or
    /// the dent would be too steep.
    pub energy: f64,
}

/// Dents bodies, and reports [`Dented`].
#[derive(Clone, Copy, Debug, Default)]
pub struct DeformationPlugin;

impl Plugin for DeformationPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<Dented>();
        app.add_systems(
            CrannyStep,
            dent_bodies
                .in_set(StepSystems::Report)
                .in_set(DeformationSystems::Dent)
                .after(ResponseSystems::Tally),
        );
    }
}

/// A hit that a body may yield to, world coordinates.
struct Hit {
    on: BodyId,
    by: BodyId,
    point: DVec3,
    inward: DVec3,
    energy: f64,
    yields: Deformation,
}

/// What is known of hits.
#[derive(SystemParam)]
struct Hits<'w, 's> {
    solver: Res<'w, RigidBodies>,
    effects: Res<'w, EffectTable>,
    bodies: Res<'w, Bodies>,
    velocities: Velocities<'w, 's>,
}

impl Hits<'_, '_> {
    /// Of a pair that presses.
    fn of(&self, (a, b): Pair, impulse: f64) -> Vec<Hit> {
        let yields = [(a, b), (b, a)].map(|(on, by)| self.effects.yielding(on, by));
        if yields.iter().all(Option::is_none) {
            return Vec::new();
        }
        let Some(at) = hardest(&self.solver.presses((a, b))) else { return Vec::new() };
        let speed = self.velocities.closing(&self.bodies, [a, b], &at);
        let energy = 0.5 * impulse * speed.max(0.0);
        // Pressed by one force, each yields by its softness.
        let softness = yields.map(|yields| yields.map_or(0.0, |yields| 1.0 / yields.hardness));
        let share = |k: usize| softness[k] / (softness[0] + softness[1]);
        let ends = [(a, b, -at.normal), (b, a, at.normal)].into_iter().zip(yields).enumerate();
        let hits = ends.filter_map(|(k, ((on, by, inward), yields))| {
            let (point, energy) = (at.point, share(k) * energy);
            Some(Hit { on, by, point, inward, energy, yields: yields? })
        });
        hits.collect()
    }
}

fn dent_bodies(
    hits: Hits,
    colliders: Query<(&Collider, &Transform, Option<&Density>, Option<&Mass>)>,
    mut dented: MessageWriter<Dented>,
    mut failure: ResMut<Failure>,
    mut commands: Commands,
    mut stopwatch: Stopwatch,
) {
    let _running = stopwatch.start(EffectKind::Deformation);
    let pressing = hits.solver.impulses_in_order();
    let mut changed: BTreeMap<BodyId, Model> = BTreeMap::new();
    for hit in pressing.into_iter().flat_map(|(pair, impulse)| hits.of(pair, impulse)) {
        let Some(record) = hits.bodies.get(hit.on) else { continue };
        let Some(by) = hits.bodies.entity(hit.by) else { continue };
        let of_body = colliders.get(record.entity);
        // Primitives were refused as they came.
        let Some(own) = record.model() else { continue };
        let is_own = |collider: &Collider| collider.model().is_some_and(|m| m.is_same(own));
        let Some((_, transform, ..)) = of_body.ok().filter(|(collider, ..)| is_own(collider))
        else {
            failure.set(SceneAppError::DentedParts { body: record.name.clone() });
            return;
        };
        let model = changed.get(&hit.on).unwrap_or(own);
        let Some(dent) = dent_of(model, transform, &hit) else { continue };
        let mut model = model.clone();
        if let Err(source) = model.deform(&dent.moves) {
            failure.set(SceneAppError::Dent { body: record.name.clone(), source });
            return;
        }
        changed.insert(hit.on, model);
        let Hit { on: id, point, inward, .. } = hit;
        let (Dent { depth, volume, .. }, body) = (dent, record.entity);
        let energy = volume * hit.yields.hardness;
        dented.write(Dented { body, id, by, point, inward, depth, volume, energy });
    }
    for (id, model) in changed {
        let Some(record) = hits.bodies.get(id) else { continue };
        let mut entity = commands.entity(record.entity);
        if let Ok((_, _, density, None)) = colliders.get(record.entity) {
            let before = record.model().unwrap_or(&model);
            entity.insert(Density(kept_mass(density, before, &model)));
        }
        entity.insert(Collider::from(model));
    }
}

/// The density at which a body weighs what it weighed.
fn kept_mass(density: Option<&Density>, before: &Model, after: &Model) -> f64 {
    let density = density.copied().unwrap_or_default().0;
    let volume = |model: &Model| model.mass_properties().map(|mass| mass.volume);
    match (volume(before), volume(after)) {
        (Some(before), Some(after)) if after > 0.0 => density * before / after,
        _ => density,
    }
}

/// The dent that a hit makes in a body; `None` where it leaves none.
fn dent_of(model: &Model, transform: &Transform, hit: &Hit) -> Option<Dent> {
    let body_from_world = pose_of(transform).world_from_body().inverse();
    let Deformation { hardness, radius } = hit.yields;
    let (at, inward) = (body_from_world.apply(hit.point), body_from_world.apply_vector(hit.inward));
    let thick = OF_THICKNESS * thickness(model, at, inward, radius);
    let most_depth = thick.min(OF_RADIUS * radius);
    let blow = Blow { at, inward, radius, volume: hit.energy / hardness, most_depth };
    Dent::of(model, &blow).filter(|dent| dent.depth >= ELASTIC * radius)
}

/// How thick a body is beneath a place.
fn thickness(model: &Model, at: DVec3, inward: DVec3, radius: f64) -> f64 {
    let from = at + BENEATH * radius * inward;
    let out = cast_ray(model, from, inward, f64::INFINITY).ok().flatten();
    match out {
        Some(hit) if hit.from_behind => hit.distance + BENEATH * radius,
        // The place lies above the surface: through it.
        Some(hit) => {
            let beneath = hit.point + BENEATH * radius * inward;
            let out = cast_ray(model, beneath, inward, f64::INFINITY).ok().flatten();
            out.map_or(f64::INFINITY, |out| out.distance + BENEATH * radius)
        }
        None => f64::INFINITY,
    }
}
