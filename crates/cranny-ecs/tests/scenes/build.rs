//! Small scenes.

use std::sync::Arc;

use bevy_ecs::message::Messages;
use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_ecs::{Collider, PluginOptions, RunOptions, SceneApp};
use cranny_exact::{DVec3, Pose};
use cranny_shapes::Cuboid;
use cranny_world::description::{
    Accuracy, BodyDescription, BodyKind, Effect, Material, Normals, RecordDescription,
    SceneDescription,
};

/// A unit cube.
pub(crate) fn cube(name: &str, kind: BodyKind, at: DVec3, velocity: DVec3) -> BodyDescription {
    BodyDescription {
        name: name.into(),
        collision: Arc::new(Cuboid { size: [1.0, 1.0, 1.0] }.build().unwrap()),
        shape: None,
        visual: None,
        color: None,
        kind,
        pose: Pose::at(at),
        linear_velocity: velocity,
        angular_velocity: DVec3::ZERO,
        path: None,
        tracker: None,
        material: Material::default(),
        mass: None,
        normals: Normals::Flat,
        sensor: false,
        layers: vec!["all".into()],
        effects: Vec::new(),
    }
}

pub(crate) fn scene(bodies: Vec<BodyDescription>, effects: &[Effect]) -> SceneDescription {
    SceneDescription {
        name: "test".into(),
        gravity: DVec3::new(0.0, 0.0, -10.0),
        step: 1.0 / 64.0,
        most_parts: None,
        duration: 1.0,
        seed: 0,
        bodies,
        joints: Vec::new(),
        excluded_pairs: Vec::new(),
        effects: effects.to_vec(),
        accuracy: Accuracy::Exact,
        budget: None,
        pairs: Vec::new(),
        cameras: Vec::new(),
        record: RecordDescription::default(),
    }
}

/// A guest passes through a gate, from x = -4 to 4 in 32 steps of a quarter each: touching at
/// x = -1 (step 12) and no more at x = 1.25 (step 21).
pub(crate) fn gate(effects: &[Effect]) -> SceneDescription {
    let bodies = vec![
        cube("gate", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO),
        cube("guest", BodyKind::Kinematic, DVec3::new(-4.0, 0.0, 0.0), DVec3::X),
    ];
    SceneDescription { step: 0.25, duration: 8.0, ..scene(bodies, effects) }
}

/// A cube a little above a fixed one.
#[cfg(feature = "rapier")]
pub(crate) fn drop(effects: &[Effect]) -> SceneDescription {
    let bodies = vec![
        cube("floor", BodyKind::Fixed, DVec3::ZERO, DVec3::ZERO),
        cube("box", BodyKind::Dynamic, DVec3::new(0.125, 0.0, 1.25), DVec3::ZERO),
    ];
    scene(bodies, effects)
}

/// An app without bodies.
pub(crate) fn empty(effects: &[Effect]) -> SceneApp {
    let mut description = scene(Vec::new(), effects);
    description.duration = 100.0;
    // As a scene of unit cubes has it.
    let plugins = PluginOptions { length_unit: Some(1.0 / 3.0), ..PluginOptions::default() };
    SceneApp::new(&description, &RunOptions { plugins, ..RunOptions::default() }).unwrap()
}

pub(crate) fn cuboid(size: [f64; 3]) -> Collider {
    Collider::from_mesh(Cuboid { size }.build().unwrap()).unwrap()
}

pub(crate) fn unit() -> Collider {
    cuboid([1.0; 3])
}

pub(crate) fn up(z: f32) -> Transform {
    Transform::from_xyz(0.0, 0.0, z)
}

pub(crate) fn world(app: &mut SceneApp) -> &mut World {
    app.app_mut().world_mut()
}

pub(crate) fn steps(app: &mut SceneApp, count: usize) {
    (0..count).for_each(|_| assert!(app.step().unwrap()));
}

pub(crate) fn height(app: &SceneApp, entity: Entity) -> f32 {
    app.app().world().get::<Transform>(entity).unwrap().translation.z
}

pub(crate) fn messages<M: Message + Clone>(app: &SceneApp) -> Vec<M> {
    app.app().world().resource::<Messages<M>>().iter_current_update_messages().cloned().collect()
}
