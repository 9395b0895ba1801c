//! A described scene becomes entities: the same components that an app spawns by hand.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use cranny_geometry::Mesh;
use cranny_primitives::BodyShape;
use cranny_world::Layers;
use cranny_world::description::{
    Accuracy, BodyDescription, BodyKind, Effect, Normals, SceneDescription, TrackerDescription,
};

use crate::body::{narrowed, transform_of};
use crate::clock::SimulatedTime;
use crate::collider::{Collider, Painted, VisualMesh};
use crate::effect_components::{PairAccuracy, Trigger, add_effects};
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};
use crate::joints::{Follows, Joint};
use crate::pair::{BodyPair, NeverMeet};
use crate::paths::{FollowsMotorPath, FollowsPath};
use crate::properties::{
    AngularVelocity, CollisionLayers, Density, Friction, LinearVelocity, Mass, Restitution,
    RigidBody, Sensor, SmoothNormals,
};
use crate::tracking::{SimulatedTracker, Tracker, TrackingLog};

/// The bits of layers that scenes name. "all" is the first; others get theirs as they are first
/// named.
#[derive(Resource, Clone, Debug, PartialEq, Eq)]
pub struct LayerNames(BTreeMap<String, u32>);

impl Default for LayerNames {
    fn default() -> Self {
        Self(BTreeMap::from([("all".to_owned(), 1)]))
    }
}

impl LayerNames {
    /// The bit of a layer, a new one for a name that is new; `None` where all bits have names.
    pub fn bit(&mut self, name: &str) -> Option<u32> {
        if let Some(&bit) = self.0.get(name) {
            return Some(bit);
        }
        let bit = (self.0.len() < Layers::COUNT).then(|| 1 << self.0.len())?;
        self.0.insert(name.to_owned(), bit);
        Some(bit)
    }
}

/// A scene that is ready to be spawned, as often as an app likes.
///
/// ```no_run
/// # use bevy_ecs::prelude::*;
/// # fn drop_pile(mut commands: Commands, pile: Res<Pile>) {
/// commands.queue(pile.0.clone());
/// # }
/// # #[derive(Resource)] struct Pile(cranny_ecs::SpawnScene);
/// ```
///
/// Its bodies, joints, pairs and effects become entities and components; gravity, step, budget and
/// cameras stay those of the app. Each body has the scene's effects at the scene's level,
/// and each pair with a level of its own has them at that level. Of the two the more
/// exact counts: a pair whose level is coarser than the scene's is at the scene's. Effects of
/// bodies that state no level are at the app's.
#[derive(Clone, Debug)]
pub struct SpawnScene {
    scene: Arc<SceneDescription>,
    shapes: Vec<BodyShape>,
    /// Whether the app has the scene's effects already.
    effects_known: bool,
}

impl SpawnScene {
    /// Prepares the models of a scene's bodies, which share those of meshes that they share.
    ///
    /// # Errors
    ///
    /// [`SceneAppError`]: a mesh that is refused, a pair or joint of bodies that the scene does not
    /// have, or more layers than there are bits.
    pub fn new(scene: &SceneDescription) -> Result<Self, SceneAppError> {
        check(scene)?;
        let shapes = build_shapes(scene)?;
        Ok(Self { scene: Arc::new(scene.clone()), shapes, effects_known: false })
    }

    /// For an app whose effects for all bodies are the scene's.
    pub(crate) fn with_known_effects(self) -> Self {
        Self { effects_known: true, ..self }
    }

    /// What the bodies are made of, in the scene's order.
    #[must_use]
    pub fn shapes(&self) -> &[BodyShape] {
        &self.shapes
    }

    /// Spawns the scene; returns the entities of its bodies, in the scene's order.
    pub fn spawn(&self, world: &mut World) -> Vec<Entity> {
        let bodies: Vec<Entity> =
            (0..self.scene.bodies.len()).map(|i| self.spawn_body(world, i)).collect();
        self.spawn_joints(world, &bodies);
        for &(a, b) in &self.scene.excluded_pairs {
            world.spawn((NeverMeet, BodyPair { a: bodies[a], b: bodies[b] }));
        }
        let names: BTreeMap<&str, Entity> =
            self.scene.bodies.iter().map(|body| &*body.name).zip(bodies.iter().copied()).collect();
        for pair in &self.scene.pairs {
            let (a, b) = (names[&*pair.a], names[&*pair.b]);
            let mut entity = world.spawn(BodyPair { a, b });
            add_effects(&mut entity, &pair.effects);
            if let Some(level) = pair.accuracy {
                let mut of_scene = self.effects_of_scene(level);
                of_scene.retain(Effect::has_levels);
                add_effects(&mut entity, &of_scene);
                entity.insert(PairAccuracy(level));
            }
        }
        bodies
    }

    fn spawn_joints(&self, world: &mut World, bodies: &[Entity]) {
        let joints = &self.scene.joints;
        let entities: Vec<Entity> =
            joints.iter().map(|joint| world.spawn(Name::new(joint.name.clone())).id()).collect();
        for (joint, &entity) in joints.iter().zip(&entities) {
            let follows = joint.mimic.as_ref().and_then(|mimic| {
                let leader = joints.iter().position(|other| other.name == mimic.joint)?;
                let (multiplier, offset) = (mimic.multiplier, mimic.offset);
                Some(Follows { joint: entities[leader], multiplier, offset })
            });
            world.entity_mut(entity).insert(Joint {
                parent: bodies[joint.parent],
                child: bodies[joint.child],
                parent_anchor: joint.parent_anchor,
                child_anchor: joint.child_anchor,
                kind: joint.kind,
                motor: joint.motor,
                resistance: joint.resistance,
                follows,
                reduced: joint.reduced,
                start: joint.start,
            });
            if let Some(path) = &joint.path {
                let since = world.resource::<SimulatedTime>().seconds();
                let path = Arc::clone(path);
                world.entity_mut(entity).insert(FollowsMotorPath { path, since });
            }
        }
    }

    fn spawn_body(&self, world: &mut World, index: usize) -> Entity {
        let body = &self.scene.bodies[index];
        let layers = layers_of(world, body);
        let since = world.resource::<SimulatedTime>().seconds();
        let responds = world.resource::<EffectTable>().has_plugin(EffectKind::Response);
        if body.tracker.is_some() && !world.contains_resource::<TrackingLog>() {
            let why = "the app simulates no devices: add SimulatedTrackersPlugin".to_owned();
            let body = body.name.clone();
            world.resource_mut::<Failure>().set(SceneAppError::Tracker { body, why });
        }
        let mut entity = world.spawn((
            Name::new(body.name.clone()),
            RigidBody::from(body.kind),
            transform_of(&body.pose),
            LinearVelocity(narrowed(body.linear_velocity)),
            AngularVelocity(narrowed(body.angular_velocity)),
            CollisionLayers(layers),
        ));
        if let Some(path) = &body.path {
            entity.insert(transform_of(&path.pose_at(0.0)));
            match &body.tracker {
                Some(TrackerDescription { settings, device }) => entity.insert((
                    SimulatedTracker::new(Arc::clone(path), *device, since),
                    Tracker::new(*settings).unwrap_or_default(),
                )),
                None => entity.insert(FollowsPath { path: Arc::clone(path), since }),
            };
        }
        if let Some(visual) = &body.visual {
            entity.insert(VisualMesh(visual.clone()));
        }
        if let Some(color) = body.color {
            entity.insert(Painted(color));
        }
        if let Normals::Smooth { crease_angle } = body.normals {
            entity.insert(SmoothNormals { crease_angle });
        }
        if body.sensor {
            // A scene says by name what notices it.
            entity.insert(Sensor).remove::<Trigger>();
        }
        if responds {
            entity.insert((
                Friction::new(body.material.friction as f32),
                Restitution::new(body.material.restitution as f32),
                Density(body.material.density),
            ));
            if let Some(mass) = body.mass {
                entity.insert(Mass(mass));
            }
        }
        add_effects(&mut entity, &body.effects);
        add_effects(&mut entity, &self.effects_of_scene(self.scene.accuracy));
        entity.insert(Collider::from(self.shapes[index].clone())).id()
    }

    /// The scene's effects, at a level where it states none; empty where the app has them already.
    fn effects_of_scene(&self, unstated: Accuracy) -> Vec<Effect> {
        let level = |effect: &Effect| effect.stated_level().unwrap_or(unstated);
        let asked = self.scene.effects.iter().filter(|_| !self.effects_known);
        asked.map(|effect| effect.stating(Some(level(effect)))).collect()
    }
}

impl Command for SpawnScene {
    type Out = ();

    fn apply(self, world: &mut World) {
        self.spawn(world);
    }
}

fn layers_of(world: &mut World, body: &BodyDescription) -> Layers {
    let mut names = world.get_resource_or_init::<LayerNames>();
    let mut bits = 0;
    let mut full = false;
    for name in &body.layers {
        match names.bit(name) {
            Some(bit) => bits |= bit,
            None => full = true,
        }
    }
    if full {
        let count = Layers::COUNT + 1;
        let error = SceneAppError::TooManyLayers { count, limit: Layers::COUNT };
        world.resource_mut::<Failure>().set(error);
    }
    Layers::shared(bits)
}

/// What a scene must not contradict.
fn check(scene: &SceneDescription) -> Result<(), SceneAppError> {
    let count = scene.bodies.len();
    let ends = scene.joints.iter().map(|joint| (joint.parent, joint.child));
    for index in scene.excluded_pairs.iter().copied().chain(ends).flat_map(|(a, b)| [a, b]) {
        if index >= count {
            return Err(SceneAppError::NoSuchIndex { index, bodies: count });
        }
    }
    for name in scene.pairs.iter().flat_map(|pair| [&pair.a, &pair.b]) {
        if !scene.bodies.iter().any(|body| body.name == *name) {
            return Err(SceneAppError::UnknownBody { name: name.clone() });
        }
    }
    if let Some(effect) = scene.all_effects().find(|effect| EffectKind::of(effect).is_none()) {
        return Err(SceneAppError::UnsupportedEffect { effect: effect.name() });
    }
    let led = |body: &&BodyDescription| body.path.is_some() && body.kind != BodyKind::Kinematic;
    if let Some(body) = scene.bodies.iter().find(led) {
        return Err(SceneAppError::PathOfOtherKind { body: body.name.clone() });
    }
    check_trackers(scene)?;
    let mut names = LayerNames::default();
    let mut layers: Vec<&String> = scene.bodies.iter().flat_map(|body| &body.layers).collect();
    layers.sort_unstable();
    layers.dedup();
    if layers.iter().any(|name| names.bit(name).is_none()) {
        return Err(SceneAppError::TooManyLayers { count: layers.len(), limit: Layers::COUNT });
    }
    Ok(())
}

/// Whether bodies can be tracked as described.
fn check_trackers(scene: &SceneDescription) -> Result<(), SceneAppError> {
    for body in &scene.bodies {
        let Some(tracker) = &body.tracker else { continue };
        let refused = |why: String| SceneAppError::Tracker { body: body.name.clone(), why };
        tracker.check(scene.step).map_err(|why| refused(why.to_string()))?;
        if body.path.is_none() {
            return Err(refused("a device sees the body on a path: give it one".to_owned()));
        }
    }
    Ok(())
}

/// The shape of each body of a scene; bodies that share a mesh share the model.
fn build_shapes(scene: &SceneDescription) -> Result<Vec<BodyShape>, SceneAppError> {
    let mut built: BTreeMap<*const Mesh, BodyShape> = BTreeMap::new();
    let mut shapes = Vec::with_capacity(scene.bodies.len());
    for body in &scene.bodies {
        if body.primitive().is_some() {
            shapes.extend(body.shape.clone());
            continue;
        }
        let key = Arc::as_ptr(&body.collision);
        if let Some(prepared) = &body.shape {
            built.insert(key, prepared.clone());
        }
        let shape = match built.get(&key) {
            Some(shape) => shape.clone(),
            None => {
                let collider = Collider::from_mesh(Mesh::clone(&body.collision))
                    .map_err(|source| SceneAppError::Model { body: body.name.clone(), source })?;
                built.entry(key).or_insert(collider.shape().clone()).clone()
            }
        };
        shapes.push(shape);
    }
    Ok(shapes)
}
