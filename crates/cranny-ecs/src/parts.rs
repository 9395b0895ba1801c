//! Bodies of several colliders: those of the body's entity and of its children are one model.
//!
//! A collider belongs to the nearest entity above it that has a [`RigidBody`], or else to its own.
//! The meshes of a body's colliders are put together where their `Transform`s say, in the order of
//! the hierarchy, and prepared as one; bodies of the same parts share the model.

use std::collections::{BTreeMap, BTreeSet};

use bevy_ecs::hierarchy::{ChildOf, Children};
use bevy_ecs::lifecycle::{Discard, Insert};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_ecs::world::DeferredWorld;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_primitives::BodyShape;
use cranny_world::description::Effect;

use crate::admission::{Noted, become_part};
use crate::body::{Bodies, Body, pose_of};
use crate::collider::{Collider, Painted, VisualMesh};
use crate::effect_components::{EffectAccuracy, effects_of};
use crate::error::{Failure, SceneAppError};
use crate::paths::FollowsPath;
use crate::properties::{
    AngularDamping, AngularVelocity, CollisionLayers, Density, ExternalForce, ExternalImpulse,
    Friction, GravityScale, LinearDamping, LinearVelocity, LockedAxes, Mass, Restitution,
    RigidBody, Sensor, SmoothNormals,
};
use crate::tracking::Tracker;

/// Beside a [`Collider`] that is a part of another entity's body: which one. A step inserts it.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable)]
pub struct ColliderOf {
    /// The entity with the [`RigidBody`].
    pub body: Entity,
}

/// The digest of a collider's model and the bits of its `Transform` in the body's frame.
type Part = ([u8; 32], [u32; 7]);

/// Models of several colliders.
#[derive(Resource, Debug, Default)]
pub(crate) struct MergedModels {
    /// By their parts, with the bodies that use them.
    models: BTreeMap<Vec<Part>, (Model, BTreeSet<Entity>)>,
    parts_of: BTreeMap<Entity, Vec<Part>>,
}

impl MergedModels {
    /// The model of these parts, if a body uses it.
    fn get(&self, parts: &[Part]) -> Option<Model> {
        self.models.get(parts).map(|(model, _)| model.clone())
    }

    /// A body is made of these parts from now on.
    fn join(&mut self, body: Entity, parts: Vec<Part>, model: Model) {
        if self.parts_of.get(&body) == Some(&parts) {
            return;
        }
        self.leave(body);
        self.models.entry(parts.clone()).or_insert((model, BTreeSet::new())).1.insert(body);
        self.parts_of.insert(body, parts);
    }

    /// A body is made of none of them any more.
    pub(crate) fn leave(&mut self, body: Entity) {
        let Some(parts) = self.parts_of.remove(&body) else { return };
        if let Some((_, users)) = self.models.get_mut(&parts) {
            users.remove(&body);
            if users.is_empty() {
                self.models.remove(&parts);
            }
        }
    }
}

/// The entity to whose body the collider of an entity belongs: the nearest one above it with a
/// [`RigidBody`], unless it has one itself; itself where there is none.
pub(crate) fn owner_of(world: &World, entity: Entity) -> Entity {
    let mut at = entity;
    loop {
        if world.get::<RigidBody>(at).is_some() {
            return at;
        }
        match world.get::<ChildOf>(at) {
            Some(above) => at = above.parent(),
            None => return entity,
        }
    }
}

/// The colliders below an entity that belong to its body, in the order of the hierarchy, each with
/// the entities between.
fn parts_below(world: &World, body: Entity) -> Vec<Vec<Entity>> {
    let mut found = Vec::new();
    let mut open: Vec<Vec<Entity>> = vec![vec![body]];
    while let Some(path) = open.pop() {
        let Some(&entity) = path.last() else { continue };
        if entity != body {
            if world.get::<RigidBody>(entity).is_some() {
                continue;
            }
            if world.get::<Collider>(entity).is_some() {
                found.push(path[1..].to_vec());
            }
        }
        let children = world.get::<Children>(entity).into_iter().flat_map(|c| c.iter());
        let children: Vec<Entity> = children.collect();
        open.extend(children.into_iter().rev().map(|child| [&*path, &[child]].concat()));
    }
    found
}

/// The entities of the colliders below an entity that belong to its body.
pub(crate) fn parts_of(world: &World, body: Entity) -> Vec<Entity> {
    parts_below(world, body).into_iter().filter_map(|path| path.last().copied()).collect()
}

/// Whether there are colliders below an entity that belong to its body.
pub(crate) fn has_parts(world: &World, entity: Entity) -> bool {
    world.get::<RigidBody>(entity).is_some() && !parts_below(world, entity).is_empty()
}

/// The shape of a body: that of its collider, or the model of all its colliders; `None` without
/// any. A primitive is a body's only collider.
pub(crate) fn merge(world: &mut World, body: Entity) -> Result<Option<BodyShape>, SceneAppError> {
    let own = world.get::<Collider>(body).map(|collider| collider.shape().clone());
    let below = match world.get::<RigidBody>(body) {
        Some(_) => parts_below(world, body),
        None => Vec::new(),
    };
    if below.is_empty() {
        world.resource_mut::<MergedModels>().leave(body);
        return Ok(own);
    }
    let mut parts: Vec<(BodyShape, Transform)> =
        own.into_iter().map(|shape| (shape, Transform::IDENTITY)).collect();
    for path in &below {
        let mut place = Transform::IDENTITY;
        for &entity in path {
            let transform = world.get::<Transform>(entity).copied().unwrap_or_default();
            if transform.scale != Vec3::ONE {
                let name = world.get::<Name>(entity).map(|name| name.as_str().to_owned());
                let body = name.unwrap_or_else(|| entity.to_string());
                return Err(SceneAppError::Scaled { body, scale: transform.scale.to_string() });
            }
            place = place.mul_transform(transform);
        }
        if let Some(collider) = path.last().and_then(|&part| world.get::<Collider>(part)) {
            parts.push((collider.shape().clone(), place));
        }
    }
    for path in &below {
        if let Some(&part) =
            path.last().filter(|part| world.get::<ColliderOf>(**part) != Some(&ColliderOf { body }))
        {
            become_part(world, part);
            world.entity_mut(part).insert(ColliderOf { body });
        }
    }
    let name = world.get::<Name>(body).map(|name| name.as_str().to_owned());
    let name = name.unwrap_or_else(|| body.to_string());
    let refused = |why: String| SceneAppError::Parts { body: name.clone(), why };
    for part in below.iter().filter_map(|path| path.last().copied()) {
        check_rules(world.entity(part)).map_err(refused)?;
    }
    if let [(BodyShape::Primitive(primitive), place)] = &parts[..] {
        let moved = primitive.moved(&pose_of(place).world_from_body());
        world.resource_mut::<MergedModels>().leave(body);
        return Ok(Some(moved.into()));
    }
    let parts = models_of(parts).map_err(refused)?;
    let key: Vec<Part> = parts.iter().map(|(model, place)| (model.digest(), bits(place))).collect();
    let known = world.resource::<MergedModels>().get(&key);
    let model = match known {
        Some(model) => model,
        None => put_together(&parts).map_err(refused)?,
    };
    world.resource_mut::<MergedModels>().join(body, key, model.clone());
    Ok(Some(model.into()))
}

macro_rules! rules {
    ($($rule:ident)+) => { &[$((stringify!($rule), |part| part.contains::<$rule>())),+] };
}

/// Whether a part has a component.
type HasRule = fn(&EntityRef<'_>) -> bool;

/// What counts for a whole body, beside the effects: at a part of one it would be passed over.
const RULES: &[(&str, HasRule)] = rules!(
    Sensor EffectAccuracy Friction Restitution Density Mass GravityScale LinearDamping
    AngularDamping LockedAxes ExternalForce ExternalImpulse LinearVelocity AngularVelocity
    CollisionLayers SmoothNormals VisualMesh Painted Tracker FollowsPath
);

/// Fails if a part of a body says something of its own that counts for the whole body.
fn check_rules(part: EntityRef<'_>) -> Result<(), String> {
    let rule = RULES.iter().find(|(_, has)| has(&part)).map(|(name, _)| *name);
    let Some(rule) = rule.or_else(|| effects_of(part).first().map(Effect::name)) else {
        return Ok(());
    };
    let name = part.get::<Name>().map_or_else(|| part.id().to_string(), ToString::to_string);
    Err(format!(
        "'{name}' has a {rule} of its own, but all are one body. Put {rule} beside the RigidBody, \
         or make that collider a body of its own, a fixed one or one held by a fixed joint"
    ))
}

/// The parts, where all are meshes.
fn models_of(parts: Vec<(BodyShape, Transform)>) -> Result<Vec<(Model, Transform)>, String> {
    let of_part = |(shape, place): (BodyShape, Transform)| match shape {
        BodyShape::Model(model) => Ok((model, place)),
        BodyShape::Primitive(primitive) => Err(format!(
            "a {} is one of several, but only meshes are put together. Make it a body of its own, \
             held by a fixed joint, or a mesh",
            primitive.name()
        )),
    };
    parts.into_iter().map(of_part).collect()
}

fn bits(place: &Transform) -> [u32; 7] {
    let (t, r) = (place.translation, place.rotation);
    [t.x, t.y, t.z, r.x, r.y, r.z, r.w].map(f32::to_bits)
}

fn put_together(parts: &[(Model, Transform)]) -> Result<Model, String> {
    let (mut vertices, mut faces) = (Vec::<DVec3>::new(), Vec::new());
    for (model, place) in parts {
        let (map, first) = (pose_of(place).world_from_body(), vertices.len() as u32);
        vertices.extend(model.mesh().vertices().iter().map(|&p| map.apply(p)));
        faces.extend(model.mesh().faces().iter().map(|face| face.map(|v| v + first)));
    }
    let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
    let mesh = Mesh::new(vertices, faces).map_err(|error| error.to_string())?;
    Model::build(mesh, &options).map(|(model, _)| model).map_err(|error| error.to_string())
}

/// An entity above others that was moved and is no body.
type MovedGroup = (With<Children>, Without<Body>, Changed<Transform>);

/// A part that was moved in its body's frame makes another body of it.
pub(crate) fn note_moved_parts(
    moved: Query<&ColliderOf, Changed<Transform>>,
    between: Query<Entity, MovedGroup>,
    hierarchy: Query<&Children>,
    parts: Query<&ColliderOf>,
    mut noted: ResMut<Noted>,
) {
    noted.entities.extend(moved.iter().map(|part| part.body));
    let below = between.iter().flat_map(|entity| hierarchy.iter_descendants(entity));
    noted.entities.extend(below.filter_map(|child| parts.get(child).ok()).map(|part| part.body));
}

/// A body's `Transform` is its place in the world; what has no motion of its own becomes a part.
pub(crate) fn note_parent(inserted: On<Insert<ChildOf>>, mut world: DeferredWorld<'_>) {
    let entity = inserted.entity;
    let owner = owner_of(&world, entity);
    if owner != entity {
        world.resource_mut::<Noted>().entities.extend([entity, owner]);
    } else if let Some(&Body { id }) = world.get::<Body>(entity) {
        let body = world.resource::<Bodies>().name(id).to_owned();
        world.resource_mut::<Failure>().set(SceneAppError::ChildBody { body });
    }
}

/// What a collider leaves is another body than before.
pub(crate) fn note_orphan(removed: On<Discard<ChildOf>>, mut world: DeferredWorld<'_>) {
    let entity = removed.entity;
    let owner = owner_of(&world, entity);
    if owner == entity {
        return; // it takes its parts along
    }
    let parts = [vec![entity], parts_of(&world, entity)].concat();
    for &part in &parts {
        world.commands().entity(part).try_remove::<ColliderOf>();
    }
    world.resource_mut::<Noted>().entities.extend([vec![owner], parts].concat());
}

#[cfg(test)]
mod tests {
    use bevy_app::App;
    use cranny_shapes::Cuboid;

    use super::*;
    use crate::clock::CrannyStep;
    use crate::plugins::CrannyPlugins;

    #[test]
    fn a_model_of_parts_lasts_as_long_as_a_body_is_made_of_it() {
        let mut app = App::new();
        app.add_plugins(CrannyPlugins::new(0.25).unwrap());
        let world = app.world_mut();
        let cube = Collider::from_mesh(Cuboid { size: [1.0; 3] }.build().unwrap()).unwrap();
        let mut bodies = Vec::new();
        for _ in 0..2 {
            let body = world.spawn((RigidBody::Fixed, cube.clone())).id();
            let aside = Transform::from_xyz(2.0, 0.0, 0.0);
            bodies.push([body, world.spawn((cube.clone(), aside, ChildOf(body))).id()]);
        }
        let models = |world: &mut World| {
            world.run_schedule(CrannyStep);
            let merged = world.resource::<MergedModels>();
            (merged.models.len(), merged.parts_of.len())
        };
        assert_eq!(models(world), (1, 2));
        let [[_, part], [other, _]] = bodies[..] else { panic!("two bodies") };
        world.get_mut::<Transform>(part).unwrap().translation.y = 1.0;
        assert_eq!(models(world), (2, 2));
        world.despawn(part);
        assert_eq!(models(world), (1, 1));
        world.despawn(other);
        assert_eq!(models(world), (0, 0));
    }
}
