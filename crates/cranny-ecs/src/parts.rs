//! Bodies of several colliders: those of the body's entity and of its children are one model.
//!
//! A collider belongs to the nearest entity above it that has a [`RigidBody`], or else to its own.
//! The meshes of a body's colliders are put together where their `Transform`s say, in the order of
//! the hierarchy, and prepared as one; bodies of the same parts share the model.

use std::collections::BTreeMap;

use bevy_ecs::hierarchy::{ChildOf, Children};
use bevy_ecs::lifecycle::{Discard, Insert};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, Mesh, Model};

use crate::admission::Noted;
use crate::body::{Body, pose_of};
use crate::collider::Collider;
use crate::error::{Failure, SceneAppError};
use crate::properties::RigidBody;

/// Beside a [`Collider`] that is a part of another entity's body: which one. A step inserts it.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
#[component(immutable)]
pub struct ColliderOf {
    /// The entity with the [`RigidBody`].
    pub body: Entity,
}

/// The digest of a collider's model and the bits of its `Transform` in the body's frame.
type Part = ([u8; 32], [u32; 7]);

/// Models of several colliders, by their parts, and who uses them.
#[derive(Resource, Debug, Default)]
pub(crate) struct MergedModels {
    models: BTreeMap<Vec<Part>, Model>,
    used_by: BTreeMap<Entity, Vec<Part>>,
}

impl MergedModels {
    /// A body left.
    pub(crate) fn leave(&mut self, body: Entity) {
        if let Some(parts) = self.used_by.remove(&body) {
            self.drop_unless_used(&parts);
        }
    }

    fn drop_unless_used(&mut self, parts: &[Part]) {
        if !self.used_by.values().any(|used| used == parts) {
            self.models.remove(parts);
        }
    }

    /// Drops what no body is made of any more.
    pub(crate) fn forget_unused(&mut self) {
        let Self { models, used_by } = self;
        models.retain(|parts, _| used_by.values().any(|used| used == parts));
    }
}

/// Reads the hierarchy, of a `World` and of one whose structure stands still.
pub(crate) trait Hierarchy {
    /// A component of an entity.
    fn component<C: Component>(&self, entity: Entity) -> Option<&C>;
}

impl Hierarchy for World {
    fn component<C: Component>(&self, entity: Entity) -> Option<&C> {
        self.get::<C>(entity)
    }
}

impl Hierarchy for bevy_ecs::world::DeferredWorld<'_> {
    fn component<C: Component>(&self, entity: Entity) -> Option<&C> {
        self.get::<C>(entity)
    }
}

/// The entity to whose body the collider of an entity belongs: the nearest one above it with a
/// [`RigidBody`], unless it has one itself; itself where there is none.
pub(crate) fn owner_of(world: &impl Hierarchy, entity: Entity) -> Entity {
    let mut at = entity;
    loop {
        if world.component::<RigidBody>(at).is_some() {
            return at;
        }
        match world.component::<ChildOf>(at) {
            Some(above) => at = above.parent(),
            None => return entity,
        }
    }
}

/// The colliders below an entity that belong to its body, in the order of the hierarchy, each with
/// the entities between.
fn parts_below<H: Hierarchy>(world: &H, body: Entity) -> Vec<Vec<Entity>> {
    let mut found = Vec::new();
    let mut open: Vec<Vec<Entity>> = vec![vec![body]];
    while let Some(path) = open.pop() {
        let Some(&entity) = path.last() else { continue };
        if entity != body {
            if world.component::<RigidBody>(entity).is_some() {
                continue;
            }
            if world.component::<Collider>(entity).is_some() {
                found.push(path[1..].to_vec());
            }
        }
        let children = world.component::<Children>(entity).into_iter().flat_map(|c| c.iter());
        let children: Vec<Entity> = children.collect();
        open.extend(children.into_iter().rev().map(|child| [&*path, &[child]].concat()));
    }
    found
}

/// The entities of the colliders below an entity that belong to its body.
pub(crate) fn parts_of(world: &impl Hierarchy, body: Entity) -> Vec<Entity> {
    parts_below(world, body).into_iter().filter_map(|path| path.last().copied()).collect()
}

/// Whether there are colliders below an entity that belong to its body.
pub(crate) fn has_parts(world: &impl Hierarchy, entity: Entity) -> bool {
    world.component::<RigidBody>(entity).is_some() && !parts_below(world, entity).is_empty()
}

/// The model of a body: that of its collider, or of all its colliders; `None` without any.
pub(crate) fn merge(world: &mut World, body: Entity) -> Result<Option<Model>, SceneAppError> {
    let own = world.get::<Collider>(body).map(|collider| collider.model().clone());
    let below = match world.get::<RigidBody>(body) {
        Some(_) => parts_below(world, body),
        None => Vec::new(),
    };
    if below.is_empty() {
        world.resource_mut::<MergedModels>().leave(body);
        return Ok(own);
    }
    let mut parts: Vec<(Model, Transform)> =
        own.into_iter().map(|model| (model, Transform::IDENTITY)).collect();
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
            parts.push((collider.model().clone(), place));
        }
    }
    for path in &below {
        if let Some(&part) =
            path.last().filter(|part| world.get::<ColliderOf>(**part) != Some(&ColliderOf { body }))
        {
            world.entity_mut(part).insert(ColliderOf { body });
        }
    }
    let key: Vec<Part> = parts.iter().map(|(model, place)| (model.digest(), bits(place))).collect();
    let known = world.resource::<MergedModels>().models.get(&key).cloned();
    let model = match known {
        Some(model) => model,
        None => put_together(&parts).map_err(|why| {
            let name = world.get::<Name>(body).map(|name| name.as_str().to_owned());
            SceneAppError::Parts { body: name.unwrap_or_else(|| body.to_string()), why }
        })?,
    };
    let mut merged = world.resource_mut::<MergedModels>();
    merged.models.insert(key.clone(), model.clone());
    merged.used_by.insert(body, key);
    Ok(Some(model))
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
pub(crate) fn note_parent(
    inserted: On<Insert<ChildOf>>,
    colliders: Query<(), With<Collider>>,
    children: Query<&Children>,
    bodies: Query<(&Body, Has<RigidBody>)>,
    above: Query<(&ChildOf, Has<RigidBody>)>,
    rigid: Query<(), With<RigidBody>>,
    records: Res<crate::body::Bodies>,
    mut noted: ResMut<Noted>,
    mut failure: ResMut<Failure>,
) {
    let owner = std::iter::successors(Some(inserted.entity), |&at| {
        above.get(at).ok().map(|(above, _)| above.parent())
    });
    let owner = owner.skip(1).find(|&entity| rigid.contains(entity));
    if let Ok((&Body { id }, own)) = bodies.get(inserted.entity)
        && (own || owner.is_none())
    {
        failure.set(SceneAppError::ChildBody { body: records.name(id).to_owned() });
        return;
    }
    if colliders.contains(inserted.entity) || children.contains(inserted.entity) {
        noted.entities.extend([Some(inserted.entity), owner].into_iter().flatten());
    }
}

/// What a collider leaves is another body than before.
pub(crate) fn note_orphan(
    removed: On<Discard<ChildOf>>,
    above: Query<&ChildOf>,
    hierarchy: Query<&Children>,
    rigid: Query<(), With<RigidBody>>,
    mut noted: ResMut<Noted>,
    mut commands: Commands,
) {
    let owner =
        std::iter::successors(Some(removed.entity), |&at| above.get(at).ok().map(ChildOf::parent));
    let owner = owner.skip(1).find(|&entity| rigid.contains(entity));
    noted.entities.extend([Some(removed.entity), owner].into_iter().flatten());
    for part in hierarchy.iter_descendants(removed.entity).chain([removed.entity]) {
        noted.entities.push(part);
        commands.entity(part).try_remove::<ColliderOf>();
    }
}
