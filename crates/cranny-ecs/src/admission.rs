//! How an entity becomes a body, changes and leaves.
//!
//! Hooks of the components that make a body note its entity. At the beginning of the next step
//! [`admit_bodies`] gives those that are new an id, in the order in which they were spawned, and
//! inserts [`Body`]; of those that changed it inserts the same [`Body`] again. Whoever keeps bodies
//! of its own (the solver, detection, a recording) observes `Insert<Body>` and `Remove<Body>`, and
//! reads everything else from [`Bodies`], [`EffectTable`] and the components. A body that is
//! removed or despawned leaves at once. [`parts`](crate::parts) says of which colliders a body
//! consists.

use std::collections::{BTreeSet, VecDeque};

use bevy_app::{App, Plugin};
use bevy_ecs::component::ComponentId;
use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::lifecycle::{HookContext, Remove};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_primitives::BodyShape;
use cranny_world::description::{BodyKind, Effect};

use crate::body::{Bodies, Body, BodyRecord};
use crate::clock::{CoreSystems, CrannyEnd, CrannyStep, StepSystems};
use crate::collider::{Collider, Painted, VisualMesh};
use crate::effect_components::{Trigger, effects_of};
use crate::effects::{BodyEffects, EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};
use crate::motion::MotionLog;
use crate::pair::{BodyPair, relate_pairs};
use crate::parts::{
    ColliderOf, MergedModels, has_parts, merge, note_moved_parts, note_orphan, note_parent,
    owner_of, parts_of,
};
use crate::properties::{
    AngularVelocity, CollisionLayers, LinearVelocity, RigidBody, Sensor, SmoothNormals,
};
use crate::tally::Tally;
use crate::trigger::TriggerLog;

/// Entities of which a component that makes a body came, changed or went since the last step.
#[derive(Resource, Debug, Default)]
pub(crate) struct Noted {
    pub(crate) entities: Vec<Entity>,
    /// Whether pairs have to be related to bodies again.
    pub(crate) pairs: bool,
}

/// Hook of the components that make a body or a pair, as one is inserted.
pub(crate) fn note_change(mut world: DeferredWorld<'_>, context: HookContext) {
    let owner = owner_of(&world, context.entity);
    if let Some(mut noted) = world.get_resource_mut::<Noted>() {
        noted.entities.extend([context.entity, owner]);
    }
}

/// Hook of [`Sensor`]: one that nothing would notice brings [`Trigger`] along.
pub(crate) fn note_sensor(mut world: DeferredWorld<'_>, context: HookContext) {
    note_change(world.reborrow(), context);
    if is_unnoticed(&world, context.entity) {
        world.commands().entity(context.entity).try_insert(Trigger);
    }
}

/// Whether no effect beside an entity or of all bodies notices anything, and `Trigger` would: the
/// app has its plugin, or none that notices. (One without any fails.)
fn is_unnoticed(world: &World, entity: Entity) -> bool {
    let Some(table) = world.get_resource::<EffectTable>() else { return false };
    let own = effects_of(world.entity(entity));
    let others = [EffectKind::Proximity, EffectKind::Contacts, EffectKind::Penetration];
    own.iter().chain(table.of_scene()).all(Effect::pushes)
        && (table.has_plugin(EffectKind::Trigger)
            || !others.iter().any(|&kind| table.has_plugin(kind)))
}

/// Hook of what an app says of a whole body: said of a part of one, it is refused.
pub(crate) fn note_rule(world: DeferredWorld<'_>, context: HookContext) {
    if world.get::<ColliderOf>(context.entity).is_some() {
        note_change(world, context);
    }
}

/// Hook of the components that make a body or a pair, as one is removed. A body without a collider
/// is none any more.
pub(crate) fn note_removal(mut world: DeferredWorld<'_>, context: HookContext) {
    if world.component_id::<RigidBody>() == Some(context.component_id) {
        let parts = parts_of(&world, context.entity);
        if let Some(mut noted) = world.get_resource_mut::<Noted>() {
            noted.entities.extend(parts);
        }
    }
    note_change(world.reborrow(), context);
    if world.component_id::<Collider>() == Some(context.component_id)
        && !has_parts(&world, context.entity)
    {
        world.commands().entity(context.entity).try_remove::<Body>();
    }
}

/// Gives ids, takes leave.
pub(crate) struct AdmissionPlugin;

impl Plugin for AdmissionPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Noted>().init_resource::<Bodies>().init_resource::<MergedModels>();
        app.add_observer(take_leave).add_observer(note_parent).add_observer(note_orphan);
        note_present(app.world_mut());
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            let is_noted = |noted: Res<Noted>| noted.pairs || !noted.entities.is_empty();
            app.add_systems(
                label,
                (begin_step, note_moved_parts, admit_bodies.run_if(is_noted))
                    .chain()
                    .in_set(StepSystems::Admit)
                    .in_set(CoreSystems::Admit),
            );
        }
    }
}

/// Notes what was spawned before the plugins were added: no hook could.
fn note_present(world: &mut World) {
    for component in [world.component_id::<Collider>(), world.component_id::<BodyPair>()] {
        let entities = entities_with(world, component);
        world.resource_mut::<Noted>().entities.extend(entities);
    }
    for sensor in entities_with(world, world.component_id::<Sensor>()) {
        if is_unnoticed(world, sensor) {
            world.entity_mut(sensor).insert(Trigger);
        }
    }
}

/// The entities with a component that may not be registered, ascending.
pub(crate) fn entities_with(world: &World, component: Option<ComponentId>) -> Vec<Entity> {
    let Some(component) = component else { return Vec::new() };
    let with = world.archetypes().iter().filter(|archetype| archetype.contains(component));
    let entities = with.flat_map(|archetype| archetype.entities().iter().map(|e| e.id()));
    let mut entities: Vec<Entity> = entities.collect();
    entities.sort_unstable();
    entities
}

/// Makes bodies of what was spawned, and passes changes on.
pub(crate) fn admit_bodies(world: &mut World) {
    let mut noted = VecDeque::from(std::mem::take(&mut world.resource_mut::<Noted>().entities));
    let mut seen = BTreeSet::new();
    let mut pairs = false;
    while let Some(entity) = noted.pop_front() {
        if !seen.insert(entity) {
            continue;
        }
        let Ok(found) = world.get_entity(entity) else { continue };
        pairs |= found.contains::<BodyPair>();
        let owner = owner_of(world, entity);
        if owner != entity {
            become_part(world, entity);
            noted.push_back(owner);
            continue;
        }
        let merged = match merge(world, entity) {
            Ok(Some(shape)) => shape,
            Ok(None) => {
                world.entity_mut(entity).remove::<(Body, ColliderOf)>();
                continue;
            }
            Err(error) => {
                world.resource_mut::<Failure>().set(error);
                continue;
            }
        };
        let of_scene = world.resource::<EffectTable>().of_scene().to_vec();
        let (record, effects) = match described(world.entity(entity), merged, &of_scene) {
            Ok(described) => described,
            Err(error) => {
                world.resource_mut::<Failure>().set(error);
                continue;
            }
        };
        let known = world.get::<Body>(entity).map(|body| body.id);
        let Some(id) = world.resource_mut::<Bodies>().admit(known, record) else {
            world.resource_mut::<Failure>().set(SceneAppError::NoIdLeft);
            continue;
        };
        pairs |= known.is_none();
        let sensor = effects.sensor;
        let put = world.resource_mut::<EffectTable>().put_body(id, effects);
        if let Err(effect) = put {
            let body = world.resource::<Bodies>().name(id).to_owned();
            world.resource_mut::<Failure>().set(match effect {
                "Trigger" if sensor => SceneAppError::UnnoticedSensor { body },
                _ => SceneAppError::EffectNotPlugged { body, effect },
            });
        }
        world.entity_mut(entity).insert(Body { id });
    }
    if pairs || world.resource::<Noted>().pairs {
        world.resource_mut::<Noted>().pairs = false;
        relate_pairs(world);
    }
}

/// A body that became a part is none any more, and has no motion of its own.
pub(crate) fn become_part(world: &mut World, entity: Entity) {
    if world.get::<Body>(entity).is_some() {
        world.entity_mut(entity).remove::<(Body, LinearVelocity, AngularVelocity)>();
    }
}

/// What the components of an entity say of the body that it is.
fn described(
    entity: EntityRef<'_>,
    shape: BodyShape,
    of_scene: &[Effect],
) -> Result<(BodyRecord, BodyEffects), SceneAppError> {
    let given = entity.get::<Name>().map(|name| name.as_str().to_owned());
    let name = given.unwrap_or_default();
    let said = || if name.is_empty() { entity.id().to_string() } else { name.clone() };
    if let Some(transform) = entity.get::<Transform>().filter(|t| t.scale != Vec3::ONE) {
        let scale = transform.scale.to_string();
        return Err(SceneAppError::Scaled { body: said(), scale });
    }
    if entity.contains::<ChildOf>() {
        return Err(SceneAppError::ChildBody { body: said() });
    }
    let effects = effects_of(entity);
    let smooth = entity.contains::<SmoothNormals>();
    check_primitive(&shape, effects.iter().chain(of_scene), smooth, said)?;
    let kind = entity.get::<RigidBody>().map_or(BodyKind::Fixed, |&body| body.into());
    let layers = entity.get::<CollisionLayers>().copied().unwrap_or_default().0;
    let record = BodyRecord {
        entity: entity.id(),
        name,
        shape,
        visual: entity.get::<VisualMesh>().map(|visual| visual.0.clone()),
        color: entity.get::<Painted>().map(|painted| painted.0),
        kind,
        normals: SmoothNormals::normals(entity.get::<SmoothNormals>()),
    };
    let sensor = entity.contains::<Sensor>();
    Ok((record, BodyEffects { effects, kind, layers, sensor }))
}

/// Fails if a number of a primitive is invalid, or if an effect or smooth normals need a mesh.
fn check_primitive<'a>(
    shape: &BodyShape,
    mut effects: impl Iterator<Item = &'a Effect>,
    smooth: bool,
    body: impl Fn() -> String,
) -> Result<(), SceneAppError> {
    let Some(primitive) = shape.primitive() else { return Ok(()) };
    let what = primitive.name();
    let refused = |source| SceneAppError::Primitive { body: body(), what, source };
    primitive.check().map_err(refused)?;
    let needs = effects.find(|effect| effect.works_on_meshes()).map(Effect::name);
    let effect = needs.or(smooth.then_some("SmoothNormals"));
    effect.map_or(Ok(()), |effect| Err(SceneAppError::NeedsMesh { body: body(), what, effect }))
}

/// Whatever removes a body removes it here too, at once.
fn take_leave(
    removed: On<Remove<Body>>,
    bodies: Query<&Body>,
    mut records: ResMut<Bodies>,
    mut table: ResMut<EffectTable>,
    mut noted: ResMut<Noted>,
    mut merged: ResMut<MergedModels>,
    tally: Res<Tally>,
    (triggers, motion): (Option<Res<TriggerLog>>, Option<Res<MotionLog>>),
) {
    if let Ok(&Body { id }) = bodies.get(removed.entity) {
        merged.leave(removed.entity);
        let is_named = tally.mentions(id)
            || triggers.is_some_and(|log| log.mentions(id))
            || motion.is_some_and(|log| log.has_left(id));
        records.take_leave(id, is_named);
        table.remove_body(id);
        noted.pairs = true;
    }
}

fn begin_step(mut records: ResMut<Bodies>) {
    // It is a change for whoever looks at the bodies only where somebody left.
    if records.bypass_change_detection().begin_step() {
        records.set_changed();
    }
}
