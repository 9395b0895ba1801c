//! From a scene's description to rapier's world.

use std::collections::{BTreeMap, BTreeSet};

use cranny_geometry::{FaceId, Model};
use cranny_rapier::{BodyIndex, BodySpec, Detector, JointSpec, Simulation, SimulationOptions};
use cranny_world::BodyId;
use cranny_world::description::{BodyKind, JointDescription, JointKind, SceneDescription};

use crate::body::{pose_of, transform_of};
use crate::effects::{EffectKind, EffectTable};
use crate::error::SceneAppError;
use crate::plugins::PluginOptions;

/// rapier tells bodies apart by 32 bits.
const LAYER_LIMIT: usize = 32;

/// rapier's world of a scene, before it is handed to the app.
pub(crate) struct RigidScene {
    pub(crate) simulation: Simulation,
    /// By the solver's numbers.
    pub(crate) ids: Vec<BodyId>,
    pub(crate) detection: Detector,
}

impl RigidScene {
    /// Inserts the bodies that have a partner to respond to, their joints and exclusions.
    ///
    /// Poses go in as the `Transform`s have them.
    pub(crate) fn new(
        scene: &SceneDescription,
        models: &[Model],
        effects: &EffectTable,
        options: &PluginOptions,
    ) -> Result<Self, SceneAppError> {
        let members = members(scene, effects);
        let layers = layer_bits(scene)?;
        let defaults = SimulationOptions::default();
        let mut simulation = Simulation::new(SimulationOptions {
            detector: options.detector,
            gravity: scene.gravity,
            step: scene.step,
            length_unit: options
                .length_unit
                .unwrap_or_else(|| typical_size(scene, models, &members)),
            recycling: options.recycling,
            solver_iterations: options.substeps,
            most_parts: options.most_parts.unwrap_or(defaults.most_parts),
        });
        let mut index_of = BTreeMap::new();
        for &id in &members {
            let body = &scene.bodies[id.0 as usize];
            let spec = BodySpec {
                model: &models[id.0 as usize],
                kind: match body.kind {
                    BodyKind::Fixed => cranny_rapier::BodyKind::Fixed,
                    BodyKind::Kinematic => cranny_rapier::BodyKind::Kinematic,
                    BodyKind::Dynamic => cranny_rapier::BodyKind::Dynamic,
                },
                pose: pose_of(&transform_of(&body.pose)),
                linear_velocity: body.linear_velocity,
                angular_velocity: body.angular_velocity,
                density: body.material.density,
                friction: body.material.friction,
                restitution: body.material.restitution,
                normals: body.normals,
                groups: body.layers.iter().filter_map(|l| layers.get(&**l)).fold(0, |m, b| m | b),
            };
            let index = simulation
                .insert(&spec)
                .map_err(|source| SceneAppError::Solver { body: body.name.clone(), source })?;
            index_of.insert(id, index);
        }
        join(scene, &index_of, &mut simulation);
        exclude(effects, &members, &index_of, &mut simulation);
        Ok(Self { simulation, ids: members.into_iter().collect(), detection: options.detector })
    }
}

/// Bodies with at least one partner that they respond to, and whatever a joint holds to one.
pub(crate) fn members(scene: &SceneDescription, effects: &EffectTable) -> BTreeSet<BodyId> {
    let count = scene.bodies.len() as u32;
    let by_scene =
        effects.of_scene().iter().any(|e| EffectKind::of(e) == Some(EffectKind::Response));
    if by_scene {
        return (0..count).map(BodyId).collect();
    }
    let mut members = BTreeSet::new();
    for (a, b) in (0..count).flat_map(|a| (a + 1..count).map(move |b| (BodyId(a), BodyId(b)))) {
        if effects.asks(EffectKind::Response, a, b) {
            members.extend([a, b]);
        }
    }
    // A joint carries the response on; chains of joints need several passes.
    loop {
        let before = members.len();
        for joint in &scene.joints {
            let ends = [BodyId(joint.parent as u32), BodyId(joint.child as u32)];
            if ends.iter().any(|end| members.contains(end)) {
                members.extend(ends);
            }
        }
        if members.len() == before {
            return members;
        }
    }
}

fn layer_bits(scene: &SceneDescription) -> Result<BTreeMap<&str, u32>, SceneAppError> {
    let names: BTreeSet<&str> =
        scene.bodies.iter().flat_map(|body| &body.layers).map(String::as_str).collect();
    if names.len() > LAYER_LIMIT {
        return Err(SceneAppError::TooManyLayers { count: names.len(), limit: LAYER_LIMIT });
    }
    Ok(names.into_iter().enumerate().map(|(bit, name)| (name, 1 << bit)).collect())
}

/// Twice the volume per area of the thinnest moving body (the thickness of a plate, the radius of a
/// wire): what rapier takes for a metre. Its prediction distance is a fiftieth of that. Larger:
/// contacts are looked for far away, at a cost, and the far flank of a groove joins in. Smaller:
/// bodies meet before their contacts are seen coming.
fn typical_size(scene: &SceneDescription, models: &[Model], members: &BTreeSet<BodyId>) -> f64 {
    let dynamic = members.iter().filter(|id| scene.bodies[id.0 as usize].kind == BodyKind::Dynamic);
    let size = |id: &BodyId| {
        let model = &models[id.0 as usize];
        let faces = (0..model.mesh().faces().len() as u32).map(FaceId);
        let area: f64 = faces.map(|face| model.mesh().area_vector(face).length()).sum();
        model.mass_properties().map(|mass| 2.0 * mass.volume / area).filter(|size| *size > 0.0)
    };
    dynamic.filter_map(size).reduce(f64::min).unwrap_or(1.0)
}

fn join(
    scene: &SceneDescription,
    index_of: &BTreeMap<BodyId, BodyIndex>,
    simulation: &mut Simulation,
) {
    for joint in &scene.joints {
        let index = |end: usize| index_of.get(&BodyId(end as u32)).copied();
        let (Some(parent), Some(child)) = (index(joint.parent), index(joint.child)) else {
            continue;
        };
        // Whether joined bodies meet is the scene's excluded pairs' to say.
        simulation.join(
            parent,
            child,
            joint.parent_anchor,
            joint.child_anchor,
            &joint_spec(joint),
            true,
        );
    }
}

fn joint_spec(joint: &JointDescription) -> JointSpec {
    let target = joint.target;
    match joint.kind {
        JointKind::Fixed => JointSpec::Fixed,
        JointKind::Revolute { axis, limits } => JointSpec::Revolute { axis, limits, target },
        JointKind::Prismatic { axis, limits } => JointSpec::Prismatic { axis, limits, target },
    }
}

/// Pairs that never meet, and pairs of members that are not asked to respond to each other.
fn exclude(
    effects: &EffectTable,
    members: &BTreeSet<BodyId>,
    index_of: &BTreeMap<BodyId, BodyIndex>,
    simulation: &mut Simulation,
) {
    let by_scene =
        effects.of_scene().iter().any(|e| EffectKind::of(e) == Some(EffectKind::Response));
    let mut exclude = |a: &BodyId, b: &BodyId| {
        if let (Some(&a), Some(&b)) = (index_of.get(a), index_of.get(b)) {
            simulation.exclude(a, b);
        }
    };
    if by_scene {
        effects.excluded().for_each(|(a, b)| exclude(&a, &b));
        return;
    }
    for a in members {
        for b in members.range(a..).skip(1) {
            if !effects.asks(EffectKind::Response, *a, *b) {
                exclude(a, b);
            }
        }
    }
}
