//! From what is in the world at the end to the summary.

use std::time::Duration;

use bevy_ecs::prelude::World;
use bevy_transform::components::Transform;
use cranny_world::description::{Accuracy, SceneDescription};

use crate::body::Bodies;
use crate::clock::{PhaseTimes, SimulatedTime};
use crate::continuous::HeldBack;
#[cfg(feature = "rapier")]
use crate::energy::EnergyRange;
use crate::links::LinkLog;
use crate::motion::MotionLog;
use crate::properties::{AngularVelocity, LinearVelocity};
use crate::summary::{
    ContainedSummary, CountSummary, DeepestSummary, EnergySummary, EstimateSummary, HelixSummary,
    JointSummary, LeftSummary, LinkSummary, MotionSummary, PairsFound, PartedSummary, PartsSummary,
    RunSummary, Skipped, TriggerSummary,
};
use crate::tally::{DeepestSoFar, EstimateTally, Series, Tally};
use crate::tracking::TrackingLog;
use crate::trigger::{Fired, TriggerLog};

/// What is known of a run before it begins, and whether it was broken off.
#[derive(Clone, Debug)]
pub(crate) struct RunFacts {
    pub(crate) scene: String,
    pub(crate) scene_hash: String,
    pub(crate) detector: String,
    pub(crate) accuracy: String,
    pub(crate) budget: Option<u64>,
    pub(crate) threads: u32,
    pub(crate) seed: u64,
    pub(crate) skipped: Vec<Skipped>,
    pub(crate) outputs: Vec<String>,
    pub(crate) interrupted: bool,
}

/// Of the text that the scene came from, its step, its levels and its budget where they are not the
/// default, and every body's name, geometry and pose.
pub(crate) fn scene_hash(scene: &SceneDescription, source: Option<&str>) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut text = |text: &str| {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    };
    text(source.unwrap_or(""));
    scene.bodies.iter().for_each(|body| text(&body.name));
    levels_in_words(scene).iter().for_each(|level| text(level));
    for number in [scene.step, scene.duration] {
        hasher.update(&number.to_bits().to_le_bytes());
    }
    for body in &scene.bodies {
        if let Some(primitive) = body.primitive() {
            hasher.update(primitive.to_string().as_bytes());
        }
        for p in body.collision.vertices().iter().flat_map(|p| p.to_array()) {
            hasher.update(&(p + 0.0).to_bits().to_le_bytes());
        }
        for &corner in body.collision.faces().iter().flatten() {
            hasher.update(&corner.to_le_bytes());
        }
        for bits in body.pose.bits() {
            hasher.update(&bits.to_le_bytes());
        }
    }
    hasher.finalize().to_hex().to_string()
}

/// The budget and the level of everything that has one; empty where all is exact.
fn levels_in_words(scene: &SceneDescription) -> Vec<String> {
    let level = |stated: Option<Accuracy>| stated.map_or("none".to_owned(), |l| l.to_string());
    let mut levels: Vec<String> =
        scene.budget.map(|budget| budget.to_string()).into_iter().collect();
    if !levels.is_empty() || scene.levels() != [Accuracy::Exact] {
        levels.push(scene.accuracy.to_string());
        levels.extend(scene.all_effects().map(|effect| level(effect.stated_level())));
        levels.extend(scene.pairs.iter().map(|pair| level(pair.accuracy)));
    }
    levels
}

/// Sums a run up.
pub(crate) fn summarize(world: &mut World, facts: RunFacts, wall: Duration) -> RunSummary {
    let time = world.get_resource::<SimulatedTime>().copied().unwrap_or(SimulatedTime::new(0.0));
    let tally = world.get_resource::<Tally>().copied().unwrap_or_default();
    let times = world.get_resource::<PhaseTimes>().copied().unwrap_or_default();
    let bodies = world.get_resource::<Bodies>().cloned().unwrap_or_default();
    let name = |id| bodies.name(id).to_owned();
    let overlap = |d: DeepestSoFar| DeepestSummary {
        depth: d.depth,
        a: name(d.a),
        b: name(d.b),
        step: d.step,
    };
    let deepest = tally.depths_known.then(|| tally.deepest.map(overlap).unwrap_or_default());
    let contained = tally.contained.map(|c| ContainedSummary {
        steps: c.steps,
        a: name(c.a),
        b: name(c.b),
        step: c.first,
    });
    let (energy_drift, energy) = energies(world);
    let (motion, helices) = motions(world, &bodies);
    let links = links(world, &bodies);
    let joints = joints(world);
    let (wall_s, simulated_s) = (wall.as_secs_f64(), time.seconds());
    RunSummary {
        version: 1,
        scene: facts.scene,
        scene_hash: facts.scene_hash,
        accuracy: (facts.detector == "cranny").then_some(facts.accuracy),
        budget: facts.budget,
        detector: facts.detector,
        threads: facts.threads,
        seed: facts.seed,
        steps: time.steps(),
        dt: time.step(),
        simulated_s,
        wall_s,
        real_time_factor: if wall_s > 0.0 { simulated_s / wall_s } else { 0.0 },
        time_ms: times,
        pairs: count(&tally.pairs),
        pairs_found: pairs_found(world, &tally),
        parts: parts(world, &tally),
        tests: (tally.tests != Series::default()).then(|| count(&tally.tests)),
        estimates: estimated(&tally.estimates),
        contacts: count(&tally.contacts),
        deepest,
        first_overlap: tally.first_overlap.filter(|_| tally.depths_known).map(overlap),
        triggers: triggers(world, &bodies),
        tracking: world.get_resource().map(TrackingLog::bodies).unwrap_or_default(),
        left: left(world, &bodies),
        contained,
        energy_drift,
        energy,
        energy_unknown: energy_unknown(world),
        held_back: world.get_resource().map(|held: &HeldBack| held.total),
        state_hash: state_hash(world),
        motion,
        joints,
        helices,
        links,
        outputs: facts.outputs,
        skipped: facts.skipped,
        interrupted: facts.interrupted,
    }
}

#[cfg(feature = "rapier")]
fn joints(world: &World) -> Vec<JointSummary> {
    let Some(bodies) = world.get_resource::<crate::solved::RigidBodies>() else {
        return Vec::new();
    };
    let name = |entity| {
        let name = world.get::<bevy_ecs::name::Name>(entity);
        name.map_or_else(|| format!("joint of {entity}"), |name| name.as_str().to_owned())
    };
    let joints = bodies.held_joints().map(|(entity, held)| JointSummary {
        joint: name(entity),
        held: held.position,
        off: held.off,
        off_max: held.off_max,
        strained: held.strained,
    });
    joints.collect()
}

#[cfg(not(feature = "rapier"))]
fn joints(_: &World) -> Vec<JointSummary> {
    Vec::new()
}

fn triggers(world: &World, bodies: &Bodies) -> Vec<TriggerSummary> {
    let name = |id| bodies.name(id).to_owned();
    let log = world.get_resource::<TriggerLog>().into_iter().flat_map(TriggerLog::pairs);
    log.map(|((a, b), Fired { times, open, step })| TriggerSummary {
        a: name(a),
        b: name(b),
        times,
        open,
        step,
    })
    .collect()
}

fn left(world: &World, bodies: &Bodies) -> Vec<LeftSummary> {
    let log = world.get_resource::<MotionLog>().into_iter().flat_map(MotionLog::left);
    log.map(|(body, step)| LeftSummary { body: bodies.name(body).to_owned(), step }).collect()
}

fn estimated(tally: &EstimateTally) -> Option<EstimateSummary> {
    (tally.pairs.max() > 0).then(|| EstimateSummary {
        pairs: count(&tally.pairs),
        certain: tally.pairs.mean() - tally.open.mean(),
        open: count(&tally.open),
        unsettled: count(&tally.unsettled),
        tests: count(&tally.tests),
    })
}

fn count(series: &Series) -> CountSummary {
    CountSummary { mean: series.mean(), max: series.max() }
}

#[cfg(feature = "rapier")]
fn pairs_found(world: &World, tally: &Tally) -> Option<PairsFound> {
    let bodies = world.get_resource::<crate::solved::RigidBodies>()?;
    let found = PairsFound { carried: count(&tally.carried), searched: count(&tally.searched) };
    bodies.is_exact().then_some(found)
}

#[cfg(not(feature = "rapier"))]
fn pairs_found(_: &World, _: &Tally) -> Option<PairsFound> {
    None
}

#[cfg(feature = "rapier")]
fn parts(world: &World, tally: &Tally) -> Option<PartsSummary> {
    let bodies = world.get_resource::<crate::solved::RigidBodies>()?;
    let most_parts = bodies.simulation().most_parts() as u64;
    let parts = PartsSummary { most_parts, divided: tally.divided, max: tally.parts.max() };
    bodies.is_exact().then_some(parts)
}

#[cfg(not(feature = "rapier"))]
fn parts(_: &World, _: &Tally) -> Option<PartsSummary> {
    None
}

#[cfg(feature = "rapier")]
fn energy_unknown(world: &World) -> Option<String> {
    let bodies = world.get_resource::<crate::solved::RigidBodies>()?;
    let why = "the mechanical energy is no finite number: a body may be too light, too heavy or too fast for the solver (the units of a mesh, a density)";
    (!bodies.energy().is_finite()).then(|| why.to_owned())
}

#[cfg(not(feature = "rapier"))]
fn energy_unknown(_: &World) -> Option<String> {
    None
}

#[cfg(feature = "rapier")]
fn energies(world: &World) -> (Option<f64>, Option<EnergySummary>) {
    let energy = world.get_resource::<crate::solved::RigidBodies>().map(|b| b.energy());
    let energy = energy.filter(EnergyRange::is_finite);
    let summary = energy.map(|energy| EnergySummary {
        start: energy.start,
        end: energy.now,
        max: energy.max,
        scale: energy.scale(),
        loss: energy.loss(),
    });
    (energy.map(|energy| energy.drift()), summary)
}

#[cfg(not(feature = "rapier"))]
fn energies(_: &World) -> (Option<f64>, Option<EnergySummary>) {
    (None, None)
}

fn motions(world: &World, bodies: &Bodies) -> (Vec<MotionSummary>, Vec<HelixSummary>) {
    let Some(log) = world.get_resource::<MotionLog>() else { return (Vec::new(), Vec::new()) };
    let name = |id| bodies.name(id).to_owned();
    let motion = log.bodies().map(|motion| MotionSummary {
        body: name(motion.body),
        displacement: motion.displacement.to_array(),
        axis: motion.spin.map(|(axis, _)| axis.to_array()),
        turns: motion.spin.map(|(_, turns)| turns),
    });
    let helices = log.helices().map(|helix| HelixSummary {
        bolt: name(helix.bolt),
        nut: name(helix.nut),
        pitch: helix.pitch,
        turns: helix.turns,
        advance: helix.advance,
        deviation_max: helix.deviation_max,
    });
    (motion.collect(), helices.collect())
}

fn links(world: &World, bodies: &Bodies) -> Option<LinkSummary> {
    let log = world.get_resource::<LinkLog>()?;
    let name = |id| bodies.name(id).to_owned();
    let parted = log.links().filter_map(|link| {
        Some(PartedSummary { a: name(link.a), b: name(link.b), step: link.parted? })
    });
    Some(LinkSummary { at_start: log.links().len(), parted: parted.collect() })
}

/// A hash of the poses and velocities of all bodies as they are held, bit for bit, with their ids:
/// two apps of equal hashes are in the same state.
#[must_use]
pub fn state_hash(world: &World) -> String {
    let Some(bodies) = world.get_resource::<Bodies>() else { return String::new() };
    let mut hasher = blake3::Hasher::new();
    for (id, record) in bodies.iter() {
        let Some(transform) = world.get::<Transform>(record.entity) else { continue };
        hasher.update(&id.0.to_le_bytes());
        let linear = world.get::<LinearVelocity>(record.entity).copied().unwrap_or_default();
        let angular = world.get::<AngularVelocity>(record.entity).copied().unwrap_or_default();
        let numbers = transform
            .translation
            .to_array()
            .into_iter()
            .chain(transform.rotation.to_array())
            .chain(linear.0.to_array())
            .chain(angular.0.to_array());
        for number in numbers {
            // `+ 0.0`: −0 and 0 are the same state.
            hasher.update(&(number + 0.0).to_bits().to_le_bytes());
        }
    }
    hasher.finalize().to_hex().to_string()
}
