//! Detection by the world: what `Trigger`, `Proximity`, `Contacts` and `Penetration` need of pairs
//! that no solver detects.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::{Insert, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_exact::Pose;
use cranny_world::description::{Accuracy, Effect};
use cranny_world::{BodyId, BodySpec, ContactFields, StepReport, World as PairWorld};

use crate::body::{Bodies, Body, pose_of};
use crate::clock::{CrannyEnd, CrannyStep, PhaseTimes, SimulatedTime, StepSystems};
use crate::contacts::ContactsSystems;
use crate::contacts::QueryFrame;
use crate::effects::{EffectKind, EffectTable, Pair};
use crate::error::{Failure, SceneAppError};
use crate::penetration::PenetrationSystems;
use crate::plugins::PluginOptions;
use crate::proximity::ProximitySystems;
use crate::readers::ContactReaders;
use crate::tally::Tally;
use crate::trigger::TriggerSystems;

/// The systems of detection. They belong to the effects that need it, and are in their sets.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DetectionSystems {
    /// Transforms to the world's poses.
    Poses,
    /// Answers of the solver to the world.
    Supply,
    /// The world's step.
    Pairs,
    /// Sums.
    Tally,
}

impl DetectionSystems {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Poses, Self::Supply, Self::Pairs, Self::Tally];
}

/// The world that detects pairs. Change it (effects, excluded pairs) between steps.
#[derive(Resource, Debug)]
pub struct Detector {
    /// Its pair memories may be used by one thread at a time only.
    world: Mutex<PairWorld>,
    /// Whether a solver detects too: the world then works for reports only.
    beside_solver: bool,
    /// From which poses the supplied answers of this step were computed.
    pub(crate) supplied_poses: BTreeMap<(BodyId, BodyId), ([Pose; 2], QueryFrame)>,
    /// What the world knows of pairs, and of which revision of the effects that is.
    pairs: BTreeMap<Pair, Vec<Effect>>,
    levels: BTreeMap<Pair, Accuracy>,
    excluded: BTreeSet<Pair>,
    revision: u64,
}

/// What the world found at the poses that the `Transform`s hold during a step.
///
/// Within [`StepSystems::Report`], [`ContactReport`](crate::ContactReport) takes the answers that
/// it holds; events and sums stay.
#[derive(Resource, Clone, Debug, Default)]
pub struct Detected {
    /// `None` before the first step.
    pub report: Option<StepReport>,
}

/// Puts the [`Detector`] in.
pub(crate) struct DetectionPlugin {
    /// Effects of the scene, for all bodies.
    scene: Vec<Effect>,
    accuracy: Accuracy,
    budget: Option<u64>,
    threads: NonZeroUsize,
    /// Who needs it.
    trigger: bool,
    proximity: bool,
    contacts: bool,
    penetration: bool,
    /// What of contacts the program reads.
    program: ContactFields,
    /// Whether a solver detects too: its pairs and contacts are then the ones counted.
    beside_solver: bool,
}

impl DetectionPlugin {
    /// With effects that hold for all bodies.
    pub(crate) fn new(scene: &[Effect], effects: &EffectTable, options: &PluginOptions) -> Self {
        Self {
            scene: scene.to_vec(),
            accuracy: effects.accuracy(),
            budget: effects.budget(),
            threads: options.thread_count(),
            trigger: effects.has_plugin(EffectKind::Trigger),
            proximity: effects.has_plugin(EffectKind::Proximity),
            contacts: effects.has_plugin(EffectKind::Contacts),
            penetration: effects.has_plugin(EffectKind::Penetration),
            program: options.contact_fields,
            beside_solver: effects.has_plugin(EffectKind::Response),
        }
    }
}

impl Plugin for DetectionPlugin {
    fn build(&self, app: &mut App) {
        let mut world = PairWorld::new();
        let ready =
            world.set_threads(self.threads).and_then(|()| world.set_scene_effects(&self.scene));
        world.set_accuracy(self.accuracy);
        world.set_budget(self.budget);
        app.world_mut().resource_mut::<Failure>().note(ready);
        app.insert_resource(Detector {
            world: Mutex::new(world),
            beside_solver: self.beside_solver,
            supplied_poses: BTreeMap::new(),
            pairs: BTreeMap::new(),
            levels: BTreeMap::new(),
            excluded: BTreeSet::new(),
            revision: 0,
        });
        app.init_resource::<Detected>();
        app.add_observer(take_in).add_observer(forget_removed);
        app.world_mut().resource_mut::<Tally>().depths_known = self.contacts || self.penetration;
        if self.contacts {
            let counted = !self.beside_solver;
            let summary = ContactFields { depth: Some(0.0), points: counted, regions: false };
            let mut readers = ContactReaders::default();
            readers.set(ContactReaders::PROGRAM, self.program);
            readers.set(ContactReaders::SUMMARY, summary);
            app.insert_resource(readers);
            app.add_systems(CrannyStep, read_deeper.in_set(DetectionSystems::Poses));
        }
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            app.configure_sets(
                label,
                (
                    DetectionSystems::Poses.in_set(StepSystems::Sync),
                    (DetectionSystems::Supply, DetectionSystems::Pairs)
                        .chain()
                        .in_set(StepSystems::Detect),
                    DetectionSystems::Tally.in_set(StepSystems::Report),
                ),
            );
            // The systems belong to every effect that needs them.
            let [poses, supply, pairs, tally] = DetectionSystems::ALL;
            let all = || (poses, supply, pairs, tally);
            if self.trigger {
                app.configure_sets(label, all().in_set(TriggerSystems::Detect));
            }
            if self.proximity {
                app.configure_sets(label, all().in_set(ProximitySystems::Detect));
            }
            if self.contacts {
                app.configure_sets(label, all().in_set(ContactsSystems::Detect));
            }
            if self.penetration {
                app.configure_sets(label, all().in_set(PenetrationSystems::Detect));
            }
            app.add_systems(
                label,
                (
                    (read_transforms, relate_pairs).in_set(DetectionSystems::Poses),
                    detect_pairs.in_set(DetectionSystems::Pairs),
                    tally_depths.in_set(DetectionSystems::Tally),
                ),
            );
        }
        app.add_systems(CrannyStep, tally_pairs.in_set(DetectionSystems::Tally));
    }
}

/// Takes every pose from its one source.
fn read_transforms(
    moved: Query<(&Body, &Transform), Changed<Transform>>,
    bodies: Res<Bodies>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    for (body, transform) in &moved {
        if detector.world().body(body.id).is_none() {
            continue; // refused as it was taken in
        }
        if transform.scale != Vec3::ONE {
            let (body, scale) = (bodies.name(body.id).to_owned(), transform.scale.to_string());
            failure.set(SceneAppError::Scaled { body, scale });
            return;
        }
        failure.note(detector.world().set_pose(body.id, pose_of(transform)));
    }
}

impl Detector {
    /// Bodies, pairs, demands.
    pub fn world(&mut self) -> &mut PairWorld {
        // A panic elsewhere leaves a world that is whole: its steps either happen or do not.
        self.world.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// The poses from which the pair's latest answer was computed, to the bit, and the frame in
    /// which a solver did.
    pub(crate) fn poses(&mut self, a: BodyId, b: BodyId) -> ([Pose; 2], Option<QueryFrame>) {
        if let Some(&(poses, frame)) = self.supplied_poses.get(&(a, b)) {
            return (poses, Some(frame));
        }
        let world = self.world();
        let current = |id| world.body(id).map_or(Pose::IDENTITY, |body| body.pose());
        ([current(a), current(b)], None)
    }
}

fn detect_pairs(
    mut detector: ResMut<Detector>,
    readers: Option<Res<ContactReaders>>,
    mut detected: ResMut<Detected>,
    mut times: ResMut<PhaseTimes>,
    mut failure: ResMut<Failure>,
) {
    let start = Instant::now();
    if let Some(readers) = readers.filter(|readers| readers.is_changed()) {
        let world = detector.world();
        world.set_contact_fields(readers.fields());
        world.set_contact_fields_of_pairs(readers.fields_of_pairs());
    }
    detected.report = failure.note(detector.world().step());
    let spent = 1e3 * start.elapsed().as_secs_f64();
    if detector.beside_solver {
        times.report += spent;
    } else {
        times.narrow += spent;
    }
}

/// A sensor overlaps others by design: its pairs are no fault of the run.
fn tally_depths(
    detected: Res<Detected>,
    effects: Res<EffectTable>,
    time: Res<SimulatedTime>,
    mut tally: ResMut<Tally>,
) {
    let answers = detected.report.iter().flat_map(|report| &report.answers);
    for pair in answers.filter(|pair| !effects.is_sensed(pair.a, pair.b)) {
        tally.note_depth(pair.a, pair.b, &pair.answer, time.steps());
    }
}

/// The summary reads no depth below the deepest that it has seen.
fn read_deeper(tally: Res<Tally>, mut readers: ResMut<ContactReaders>) {
    let (deepest, reads) = (tally.deepest.map(|d| d.depth), readers.of(ContactReaders::SUMMARY));
    if deepest.is_some() && reads.depth != deepest {
        readers.set(ContactReaders::SUMMARY, ContactFields { depth: deepest, ..reads });
    }
}

/// Where there is a solver, its pairs and contacts are the ones counted.
fn tally_pairs(detected: Res<Detected>, detector: Res<Detector>, mut tally: ResMut<Tally>) {
    let Some(StepReport { stats, .. }) = &detected.report else { return };
    tally.estimates.push(&stats.estimates);
    if !detector.beside_solver {
        tally.pairs.push(stats.queried_pairs);
        tally.contacts.push(stats.contacts);
        tally.tests.push((stats.counters.tests() + stats.estimates.tests) as usize);
    }
}

/// Takes in a body that was admitted, or what has become of it.
fn take_in(
    inserted: On<Insert<Body>>,
    placed: Query<(&Body, &Transform)>,
    bodies: Res<Bodies>,
    effects: Res<EffectTable>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    let Ok((&Body { id }, transform)) = placed.get(inserted.entity) else { return };
    let (Some(record), Some(asked)) = (bodies.get(id), effects.body(id)) else { return };
    let world = detector.world();
    let taken = if let Some(known) = world.body(id) {
        let reshaped = !known.shape().is_same(&record.shape);
        let shaped = if reshaped { world.set_shape(id, &record.shape) } else { Ok(()) };
        shaped
            .and_then(|()| world.set_kind(id, record.kind))
            .and_then(|()| world.set_layers(id, asked.layers))
            .and_then(|()| world.set_sensor(id, asked.sensor))
            .and_then(|()| world.set_effects(id, &asked.effects))
    } else {
        let spec = BodySpec {
            pose: pose_of(transform),
            kind: record.kind,
            layers: asked.layers,
            sensor: asked.sensor,
            effects: asked.effects.clone(),
            ..BodySpec::new(record.name.clone(), &record.shape)
        };
        world.insert_as(id, spec)
    };
    failure.note(taken);
}

/// Hands the world the effects of pairs, their levels and which never meet, where these changed.
fn relate_pairs(
    effects: Res<EffectTable>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    if detector.revision == effects.revision() {
        return;
    }
    let detector = &mut *detector;
    detector.revision = effects.revision();
    let pairs: BTreeMap<Pair, Vec<Effect>> =
        effects.of_pairs().map(|(pair, effects)| (pair, effects.to_vec())).collect();
    let excluded: BTreeSet<Pair> = effects.excluded().collect();
    let pairs = std::mem::replace(&mut detector.pairs, pairs);
    let excluded = std::mem::replace(&mut detector.excluded, excluded);
    let levels = std::mem::replace(&mut detector.levels, effects.pair_levels().clone());
    let (now, apart) = (detector.pairs.clone(), detector.excluded.clone());
    let at = detector.levels.clone();
    let world = detector.world();
    let present =
        |world: &PairWorld, (a, b): Pair| [a, b].iter().all(|&id| world.body(id).is_some());
    for &(a, b) in pairs.keys().filter(|pair| !now.contains_key(pair)) {
        if present(world, (a, b)) {
            failure.note(world.set_pair_effects(a, b, &[]));
        }
    }
    for (&(a, b), effects) in now.iter().filter(|(pair, effects)| pairs.get(pair) != Some(effects))
    {
        failure.note(world.set_pair_effects(a, b, effects));
    }
    for &(a, b) in levels.keys().filter(|pair| !at.contains_key(pair)) {
        if present(world, (a, b)) {
            failure.note(world.set_pair_accuracy(a, b, None));
        }
    }
    for (&(a, b), &level) in at.iter().filter(|(pair, level)| levels.get(pair) != Some(level)) {
        failure.note(world.set_pair_accuracy(a, b, Some(level)));
    }
    for &(a, b) in excluded.difference(&apart) {
        if present(world, (a, b)) {
            failure.note(world.include_pair(a, b));
        }
    }
    for &(a, b) in apart.difference(&excluded) {
        failure.note(world.exclude_pair(a, b));
    }
}

/// Whatever removes a body removes it here too, at once: nothing is found about a body that is
/// gone.
fn forget_removed(
    removed: On<Remove<Body>>,
    bodies: Query<&Body>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    if let Ok(&Body { id }) = bodies.get(removed.entity) {
        let detector = &mut *detector;
        let others = |pair: &Pair| pair.0 != id && pair.1 != id;
        detector.pairs.retain(|pair, _| others(pair));
        detector.levels.retain(|pair, _| others(pair));
        detector.excluded.retain(others);
        detector.supplied_poses.retain(|pair, _| others(pair));
        if detector.world().body(id).is_some() {
            failure.note(detector.world().remove(id));
        }
    }
}
