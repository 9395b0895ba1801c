//! Detection by the world: what `Trigger` and `Contacts` need of pairs that no solver detects.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::Remove;
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_math::Vec3;
use bevy_transform::components::Transform;
use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_world::description::SceneDescription;
use cranny_world::{BodyId, BodySpec, ContactFields, StepReport, World as PairWorld};

use crate::body::{Bodies, Body, pose_of, transform_of};
use crate::clock::{CrannyEnd, CrannyStep, PhaseTimes, SimulatedTime, StepSystems};
use crate::contacts::ContactsSystems;
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};
use crate::plugins::PluginOptions;
use crate::readers::ContactReaders;
use crate::tally::Tally;
use crate::trigger::TriggerSystems;

/// The systems of detection. They belong to the effects that ask for it, and are in their sets.
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
    pub(crate) supplied_poses: BTreeMap<(BodyId, BodyId), [Pose; 2]>,
}

/// What the world found at the poses that the `Transform`s hold during a step.
///
/// Within [`StepSystems::Report`], [`ContactReport`](crate::ContactReport) takes the answers that it
/// holds; events and sums stay.
#[derive(Resource, Clone, Debug, Default)]
pub struct Detected {
    /// `None` before the first step.
    pub report: Option<StepReport>,
}

/// Puts the [`Detector`] in.
pub(crate) struct DetectionPlugin {
    world: Mutex<Option<PairWorld>>,
    /// Who needs it.
    trigger: bool,
    contacts: bool,
    /// What of contacts the program reads.
    program: ContactFields,
    /// Whether a solver detects too: its pairs and contacts are then the ones counted.
    beside_solver: bool,
}

impl DetectionPlugin {
    /// Fills a world with the scene's bodies, effects and excluded pairs.
    pub(crate) fn new(
        scene: &SceneDescription,
        models: &[Model],
        effects: &EffectTable,
        options: &PluginOptions,
    ) -> Result<Self, SceneAppError> {
        let mut world = PairWorld::new();
        world.set_threads(options.thread_count())?;
        world.set_scene_effects(&scene.effects)?;
        for (body, model) in scene.bodies.iter().zip(models) {
            world.insert(BodySpec {
                name: body.name.clone(),
                model: model.clone(),
                pose: pose_of(&transform_of(&body.pose)),
                kind: body.kind,
                layers: body.layers.clone(),
                effects: body.effects.clone(),
            })?;
        }
        for ((a, b), effects) in effects.of_pairs() {
            world.set_pair_effects(a, b, effects)?;
        }
        for (a, b) in effects.excluded() {
            world.exclude_pair(a, b)?;
        }
        Ok(Self {
            world: Mutex::new(Some(world)),
            trigger: effects.names(EffectKind::Trigger),
            contacts: effects.names(EffectKind::Contacts),
            program: options.contact_fields,
            beside_solver: effects.names(EffectKind::Response),
        })
    }
}

impl Plugin for DetectionPlugin {
    fn build(&self, app: &mut App) {
        let taken = self.world.lock().ok().and_then(|mut world| world.take());
        app.insert_resource(Detector {
            world: Mutex::new(taken.unwrap_or_default()),
            beside_solver: self.beside_solver,
            supplied_poses: BTreeMap::new(),
        });
        app.init_resource::<Detected>();
        app.add_observer(forget_removed);
        if self.contacts {
            app.world_mut().resource_mut::<Tally>().depths_known = true;
            let counted = !self.beside_solver;
            let summary = ContactFields { depth: true, points: counted, regions: false };
            let mut readers = ContactReaders::default();
            readers.set(ContactReaders::PROGRAM, self.program);
            readers.set(ContactReaders::SUMMARY, summary);
            app.insert_resource(readers);
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
            // The systems belong to whoever asks for them.
            let [poses, supply, pairs, tally] = DetectionSystems::ALL;
            let all = || (poses, supply, pairs, tally);
            if self.trigger {
                app.configure_sets(label, all().in_set(TriggerSystems::Detect));
            }
            if self.contacts {
                app.configure_sets(label, all().in_set(ContactsSystems::Detect));
            }
            app.add_systems(
                label,
                (
                    read_transforms.in_set(DetectionSystems::Poses),
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

    /// The poses from which the pair's latest answer was computed, to the bit.
    pub(crate) fn poses(&mut self, a: BodyId, b: BodyId) -> [Pose; 2] {
        let supplied = self.supplied_poses.get(&(a, b)).copied();
        let world = self.world();
        let current = |id| world.body(id).map_or(Pose::IDENTITY, |body| body.pose());
        supplied.unwrap_or_else(|| [current(a), current(b)])
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
        detector.world().set_contact_fields(readers.fields());
    }
    detected.report = failure.note(detector.world().step());
    let spent = 1e3 * start.elapsed().as_secs_f64();
    if detector.beside_solver {
        times.report += spent;
    } else {
        times.narrow += spent;
    }
}

fn tally_depths(detected: Res<Detected>, time: Res<SimulatedTime>, mut tally: ResMut<Tally>) {
    for pair in detected.report.iter().flat_map(|report| &report.answers) {
        tally.note_depth(pair.a, pair.b, &pair.answer, time.steps());
    }
}

/// Where there is a solver, its pairs and contacts are the ones counted.
fn tally_pairs(detected: Res<Detected>, detector: Res<Detector>, mut tally: ResMut<Tally>) {
    if let Some(report) = detected.report.as_ref().filter(|_| !detector.beside_solver) {
        tally.pairs.push(report.stats.queried_pairs);
        tally.contacts.push(report.stats.contacts);
    }
}

/// Whatever removes a body removes it here too, at once: nothing is found about a body that is gone.
fn forget_removed(
    removed: On<Remove<Body>>,
    bodies: Query<&Body>,
    mut detector: ResMut<Detector>,
    mut failure: ResMut<Failure>,
) {
    if let Ok(body) = bodies.get(removed.entity) {
        failure.note(detector.world().remove(body.id));
    }
}
