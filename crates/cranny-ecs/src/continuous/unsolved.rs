//! Kinematic bodies that follow their velocities: once they have moved, the way of each is held
//! against those of the bodies around it, and whoever would have met something stays just before.
//! What touches another one when a step begins parts from it or slides along, and is led into it by
//! next to nothing ([`last_apart`]).
//!
//! There is no solver that pushes them back, so slow ways count as fast ones do: a body that is led
//! into a wall stands before it until it is led elsewhere, and does not slide along.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use bevy_ecs::prelude::*;
use bevy_transform::components::Transform;
use cranny_broad_phase::BoxIndex;
use cranny_exact::{Aabb, DVec3, Pose};
use cranny_impact::{ImpactOptions, Motion, Way, shorten};
use cranny_primitives::{BodyShape, CoresOfBodies, MovingCores, last_apart};
use cranny_world::{BodyId, world_box};

use super::HeldBack;
use crate::body::{Bodies, Body, pose_of, transform_of, widened};
use crate::clock::SimulatedTime;
use crate::effects::EffectTable;
use crate::kinematics::Kinematic;
use crate::properties::AngularVelocity;

/// How near a body is let to what it would meet, as a part of the smaller one's size. Larger: it
/// stops visibly short; smaller: single precision does not resolve the gap.
const NEAR: f64 = 1e-5;

/// Where bodies are before anything moves, in each step.
#[derive(Resource, Debug, Default)]
pub(crate) struct Starts(BTreeMap<BodyId, Pose>);

/// Nothing, where nobody is named or nobody moves by velocity alone.
pub(super) fn note_starts(
    bodies: Query<(&Body, &Transform)>,
    moving: Query<(), With<Kinematic>>,
    effects: Res<EffectTable>,
    mut starts: ResMut<Starts>,
) {
    starts.0.clear();
    let named = bodies.iter().any(|(body, _)| effects.is_continuous(body.id));
    if named && !moving.is_empty() {
        starts.0.extend(bodies.iter().map(|(body, transform)| (body.id, pose_of(transform))));
    }
}

/// The cores of bodies that may have met others on their ways.
#[derive(Resource, Debug, Default)]
pub(crate) struct KnownCores(CoresOfBodies<BodyId>);

/// Puts bodies back to where their ways end.
pub(super) fn hold_back(
    mut bodies: Query<(&Body, &mut Transform, Has<Kinematic>, Option<&AngularVelocity>)>,
    starts: Res<Starts>,
    time: Res<SimulatedTime>,
    records: Res<Bodies>,
    effects: Res<EffectTable>,
    (mut cores, mut held): (ResMut<KnownCores>, ResMut<HeldBack>),
) {
    if starts.0.is_empty() {
        return;
    }
    let mut traffic = Traffic { records: &records, giving: BTreeMap::new() };
    let mut ways = BTreeMap::new();
    for (body, transform, is_kinematic, angular) in &bodies {
        let (Some(record), Some(&start)) = (records.get(body.id), starts.0.get(&body.id)) else {
            continue;
        };
        let (end, center) = (pose_of(transform), record.shape.center());
        // A rotation that stays has no turn, not even by rounding.
        let motion = match start.rotation == end.rotation {
            true => Motion {
                pivot: center,
                ..Motion::straight(start, end.translation - start.translation)
            },
            false => Motion::between(start, end, center),
        };
        let spin = angular.map_or(DVec3::ZERO, |angular| time.step() * widened(angular.0));
        // Two poses do not say that a body turned by more than half a turn.
        let turn = if is_kinematic && spin.length() > PI { spin } else { motion.turn };
        let way = Way::whole(Motion { turn, ..motion });
        traffic.giving.insert(body.id, is_kinematic && way.moves());
        ways.insert(body.id, way);
    }
    let pairs = traffic.pairs(&ways, &effects);
    cores.0.retain(|body| ways.contains_key(body));
    for &body in pairs.iter().flatten() {
        cores.0.note(body, shape_of(&records, body));
    }
    let gives_way = |body: BodyId| traffic.giving[&body];
    shorten(&mut ways, &pairs, gives_way, |pair, motions| meeting(&cores, pair, motions));
    for (body, mut transform, ..) in &mut bodies {
        let Some(way) = ways.get(&body.id).filter(|way| way.is_shortened()) else { continue };
        let scale = transform.scale;
        *transform = Transform { scale, ..transform_of(&way.motion.pose_at(way.until)) };
        held.bodies += 1;
        held.total += 1;
    }
}

/// Bodies on their ways.
struct Traffic<'a> {
    records: &'a Bodies,
    /// Whether each may be held back.
    giving: BTreeMap<BodyId, bool>,
}

/// What a body is made of that has a way.
fn shape_of(records: &Bodies, body: BodyId) -> &BodyShape {
    &records.get(body).expect("a way is of a body that is present").shape
}

/// At which share of the motions two bodies come as near each other as they are let, in
/// `Transform`'s numbers. `None` also where one begins within the other.
fn meeting(known: &KnownCores, pair: [BodyId; 2], motions: [Motion; 2]) -> Option<f64> {
    let cores = [known.0.get(&pair[0])?, known.0.get(&pair[1])?];
    let ends = [0, 1].map(|k| MovingCores { cores: cores[k], motion: motions[k] });
    let sizes = cores.map(|cores| size(cores.shape()));
    let options = ImpactOptions::within(NEAR * sizes[0].min(sizes[1]));
    last_apart(ends, &options, |pose| pose_of(&transform_of(pose)))
}

impl Traffic<'_> {
    /// Pairs that may meet on their ways: one of them is named, and one gives way.
    fn pairs(&self, ways: &BTreeMap<BodyId, Way>, effects: &EffectTable) -> Vec<[BodyId; 2]> {
        let bodies: Vec<BodyId> = ways.keys().copied().collect();
        let boxes: Vec<Aabb> =
            ways.iter().map(|(&body, way)| swept_box(shape_of(self.records, body), way)).collect();
        let index = BoxIndex::of(boxes.iter().copied());
        let mut pairs = Vec::new();
        for (&body, around) in bodies.iter().zip(&boxes).filter(|(body, _)| self.giving[body]) {
            let near = index.reached(|held| held.overlaps(around)).map(|number| bodies[number]);
            let met = near.filter(|&other| {
                let is_first = !self.giving[&other] || body < other;
                other != body && is_first && may_meet([body, other], effects)
            });
            pairs.extend(met.map(|other| [body.min(other), body.max(other)]));
        }
        pairs.sort_unstable();
        pairs
    }
}

/// Whether one of two bodies is named, and neither is there to be noticed only.
fn may_meet([a, b]: [BodyId; 2], effects: &EffectTable) -> bool {
    let is_sensor = |body| effects.body(body).is_some_and(|asked| asked.sensor);
    let named = effects.is_continuous(a) || effects.is_continuous(b);
    named && !is_sensor(a) && !is_sensor(b) && effects.may_meet(a, b)
}

/// A box that holds a body all along its way.
fn swept_box(shape: &BodyShape, way: &Way) -> Aabb {
    if !way.moves() {
        return world_box(shape, &way.motion.start, 0.0);
    }
    let pivot = way.motion.pivot;
    let center = |t| way.motion.pose_at(t).world_from_body().apply(pivot);
    Aabb::of_points([0.0, 1.0].map(center)).grown(size(shape) * (1.0 + f64::EPSILON.sqrt()))
}

/// The radius of a ball about its centre that holds a shape; infinite for a half-space.
fn size(shape: &BodyShape) -> f64 {
    shape.radius() + shape.center().length()
}
