//! The plugin group: one plugin an effect, and none for effects that nobody names.
//!
//! To add an effect to Cranny: CONTRIBUTING, 'An effect'.

use std::num::NonZeroUsize;
use std::time::Duration;

use bevy_app::{App, FixedPostUpdate, Plugin, PluginGroup, PluginGroupBuilder};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::ScheduleLabel;
use bevy_time::{Fixed, Time};
use cranny_exact::DVec3;
use cranny_primitives::BodyShape;
use cranny_world::ContactFields;
use cranny_world::description::{Accuracy, BodyDescription, BodyKind, Effect, SceneDescription};

use crate::admission::{AdmissionPlugin, admit_bodies};
use crate::clock::{ClockPlugin, CoreSystems, CrannyEnd, CrannyStep, SimulatedTime, StepSystems};
use crate::contacts::ContactsPlugin;
use crate::continuous::ContinuousPlugin;
use crate::detection::DetectionPlugin;
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError, hand_on_failure};
use crate::force_feedback::ForceFeedbackPlugin;
use crate::kinematics::KinematicsPlugin;
use crate::levels::{check_app_levels, check_levels};
use crate::links::{LinkPlugin, Ring};
use crate::motion::{Helix, MotionPlugin};
use crate::paths::PathPlugin;
use crate::penetration::PenetrationPlugin;
use crate::proximity::ProximityPlugin;
use crate::spawn::SpawnScene;
use crate::tally::Tally;
use crate::tracking::{SimulatedTrackersPlugin, TrackingPlugin};
use crate::trigger::TriggerPlugin;

/// What a scene's plugins are built with, beyond the scene.
#[derive(Clone, Debug, Default)]
pub struct PluginOptions {
    /// Who detects contacts for the solver.
    #[cfg(feature = "rapier")]
    pub detector: cranny_rapier::Detector,
    /// Whether contacts are carried on while a pair drifts a little; `None`: they are. Our detector
    /// computes them anew at each pose, rapier keeps its own as they are.
    #[cfg(feature = "rapier")]
    pub recycling: Option<bool>,
    /// Solver substeps a step; `None`: enough for our detector, rapier's default with its own.
    #[cfg(feature = "rapier")]
    pub substeps: Option<usize>,
    /// Into how many parts a step is divided at most in which bodies near each other move farther
    /// than the thinner one is thick; `None`: what the scene says, or else 2. Our detector only.
    #[cfg(feature = "rapier")]
    pub most_parts: Option<usize>,
    /// Whether what effects report is detected beside the solver with our detector too, as it is
    /// with rapier's own: all detectors are judged alike then, and none searches between pairs for
    /// who reads. Depths and verdicts are the same.
    #[cfg(feature = "rapier")]
    pub detects_beside: bool,
    /// What the solver takes for a metre, in units of length; `None`: twice the volume per area of
    /// a scene's thinnest moving body, 1 without a scene.
    pub length_unit: Option<f64>,
    /// What the program itself reads of `Contacts` (in [`ContactReport`](crate::ContactReport) or
    /// [`Detected`](crate::Detected)): all, unless it says less. What summary, recording and
    /// pictures read is added to it, and nothing else is computed;
    /// [`ContactReaders`](crate::ContactReaders) changes it between steps.
    pub contact_fields: ContactFields,
    /// Pairs whose screw motion a [`SceneApp`](crate::SceneApp) follows for its summary.
    pub helices: Vec<Helix>,
    /// Bodies of which a [`SceneApp`](crate::SceneApp) watches those that are linked at the start.
    pub rings: Vec<Ring>,
    /// How many threads answer the pairs that the world detects; `None`: the caller's own. A solver
    /// detects its pairs in its own thread. More than one needs the feature `parallel`.
    pub threads: Option<NonZeroUsize>,
}

impl PluginOptions {
    pub(crate) fn thread_count(&self) -> NonZeroUsize {
        self.threads.unwrap_or(NonZeroUsize::MIN)
    }
}

/// Our plugins: add them to an `App`, then run [`CrannyStep`] however often you like (or add
/// [`FixedUpdatePlugin`]). Bodies are entities with a [`Collider`](crate::Collider), before and
/// while the app runs.
///
/// ```
/// use bevy_app::App;
/// use bevy_transform::components::Transform;
/// use cranny_ecs::{Collider, CrannyPlugins, CrannyStep, EffectKind, RigidBody};
/// use cranny_world::description::Effect;
///
/// let cube = Collider::from_mesh(cranny_shapes::Cuboid { size: [1.0; 3] }.build()?)?;
/// let mut app = App::new();
/// // All bodies report where they begin to touch.
/// app.add_plugins(CrannyPlugins::new(1.0 / 60.0)?.effects(&[Effect::TRIGGER])?);
/// app.world_mut().spawn((RigidBody::Fixed, cube.clone(), Transform::default()));
/// app.world_mut().spawn((RigidBody::Kinematic, cube, Transform::from_xyz(0.5, 0.0, 0.0)));
/// app.world_mut().run_schedule(CrannyStep);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct CrannyPlugins {
    step: f64,
    #[cfg_attr(not(feature = "rapier"), allow(dead_code, reason = "the solver reads it"))]
    gravity: DVec3,
    scene_effects: Vec<Effect>,
    accuracy: Accuracy,
    budget: Option<u64>,
    /// Effects that bodies and pairs may name besides.
    available: Vec<EffectKind>,
    options: PluginOptions,
    scene: Option<SpawnScene>,
    /// Whether a summary reads how bodies moved, energies, links and joints.
    summed_up: bool,
    /// Whether devices of the scene's bodies are simulated.
    simulated_trackers: bool,
    /// Whether the app looks at [`Failure`] by itself.
    keeps_failures: bool,
    /// Adds the system that makes the solver's step.
    #[cfg(feature = "rapier")]
    add_step: fn(&mut App),
    #[cfg(feature = "record")]
    recording: Option<crate::recording::RecordingPlugin>,
    #[cfg(feature = "render")]
    rendering: Option<crate::rendering::RenderingPlugin>,
}

impl CrannyPlugins {
    /// No body and no effect yet. Steps take so many seconds, and gravity is 9.81 along -z.
    ///
    /// # Errors
    ///
    /// [`SceneAppError::Duration`] for a step that is none.
    pub fn new(step: f64) -> Result<Self, SceneAppError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(SceneAppError::Duration {
                step,
                duration: 0.0,
                why: "a step must last a finite time above 0",
            });
        }
        Ok(Self {
            step,
            gravity: DVec3::new(0.0, 0.0, -9.81),
            scene_effects: Vec::new(),
            accuracy: Accuracy::Exact,
            budget: None,
            available: Vec::new(),
            options: PluginOptions::default(),
            scene: None,
            summed_up: false,
            simulated_trackers: false,
            keeps_failures: false,
            #[cfg(feature = "rapier")]
            add_step: crate::response::add_step::<()>,
            #[cfg(feature = "record")]
            recording: None,
            #[cfg(feature = "render")]
            rendering: None,
        })
    }

    /// Effects for all bodies.
    ///
    /// # Errors
    ///
    /// [`SceneAppError`]: an effect that this program was built without, or a margin that is no
    /// length.
    pub fn effects(mut self, effects: &[Effect]) -> Result<Self, SceneAppError> {
        self.scene_effects = effects.to_vec();
        cranny_world::World::new().set_scene_effects(effects)?;
        self.checked()
    }

    /// Effects that single bodies and pairs may name, by components. Of an effect that is named
    /// neither here nor in [`effects`](Self::effects) there is nothing in the app.
    ///
    /// # Errors
    ///
    /// [`SceneAppError::MissingFeature`]: an effect that this program was built without.
    pub fn available(mut self, effects: &[EffectKind]) -> Result<Self, SceneAppError> {
        self.available = effects.to_vec();
        self.checked()
    }

    /// The level of triggers and distances that state none, in place of `Exact`.
    /// [`EffectAccuracy`](crate::EffectAccuracy) and [`PairAccuracy`](crate::PairAccuracy) state
    /// levels of their own.
    ///
    /// # Errors
    ///
    /// [`SceneAppError::NotAtLevel`] where an effect of all bodies needs exact contacts.
    pub fn accuracy(mut self, accuracy: Accuracy) -> Result<Self, SceneAppError> {
        self.accuracy = accuracy;
        self.checked()
    }

    /// Elementary tests that a step may take for all pairs together that have `Trigger` and
    /// `Proximity` alone; `None`, as without it: as many as they need. What is left open is
    /// narrowed in later steps.
    ///
    /// # Errors
    ///
    /// [`SceneAppError::NotAtLevel`] where an effect of all bodies needs exact contacts.
    pub fn budget(mut self, budget: Option<u64>) -> Result<Self, SceneAppError> {
        self.budget = budget;
        self.checked()
    }

    /// Acceleration of dynamic bodies, in place of 9.81 along -z. `Gravity` changes it later.
    #[must_use]
    pub fn gravity(self, gravity: DVec3) -> Self {
        Self { gravity, ..self }
    }

    /// Hooks, which decide about pairs while the solver makes a step. Without them nothing is
    /// called.
    #[cfg(feature = "rapier")]
    #[must_use]
    pub fn hooks<H>(self) -> Self
    where
        H: bevy_ecs::system::SystemParam + 'static,
        for<'w, 's> bevy_ecs::system::SystemParamItem<'w, 's, H>: crate::hooks::CollisionHooks,
    {
        Self { add_step: crate::response::add_hooked_step::<H>, ..self }
    }

    /// For an app that looks at [`Failure`] after each step by itself. Without it what fails goes
    /// to bevy's error handler, which panics unless the app has set another one.
    #[must_use]
    pub fn keep_failures(self) -> Self {
        Self { keeps_failures: true, ..self }
    }

    /// How plugins are built.
    #[must_use]
    pub fn options(self, options: &PluginOptions) -> Self {
        Self { options: options.clone(), ..self }
    }

    /// The plugins that a scene needs, and a plugin that spawns it.
    ///
    /// # Errors
    ///
    /// [`SceneAppError`]: a mesh, effect, pair or step that is refused, or an effect that this
    /// program was built without. What the solver refuses, as a mass of 0, is in
    /// [`Failure`] once the plugins are added.
    pub fn from_scene(
        scene: &SceneDescription,
        options: &PluginOptions,
    ) -> Result<Self, SceneAppError> {
        let spawn = SpawnScene::new(scene)?.with_known_effects();
        check_effects(scene)?;
        // Of bodies and pairs; those of all bodies are among them without harm.
        let available = scene.all_effects().filter_map(EffectKind::of).collect();
        let plugins = Self { available, ..Self::new(scene.step)? }.effects(&scene.effects)?;
        let mut options = options.clone();
        let size = || typical_size(scene, spawn.shapes());
        options.length_unit = Some(options.length_unit.unwrap_or_else(size));
        #[cfg(feature = "rapier")]
        {
            let by_scene = scene.most_parts.map(|most| most as usize);
            options.most_parts = options.most_parts.or(by_scene);
        }
        let simulated_trackers = scene.bodies.iter().any(|body| body.tracker.is_some());
        let (gravity, accuracy, budget) = (scene.gravity, scene.accuracy, scene.budget);
        let scene = Some(spawn);
        Ok(Self { gravity, accuracy, budget, options, scene, simulated_trackers, ..plugins })
    }

    /// Follows what a summary reads of motion, energies, links and joints.
    pub(crate) fn summed_up(self) -> Self {
        Self { summed_up: true, ..self }
    }

    fn checked(self) -> Result<Self, SceneAppError> {
        #[cfg(not(feature = "rapier"))]
        if self.table().has_plugin(EffectKind::Response) {
            return Err(SceneAppError::MissingFeature { what: "Response", feature: "rapier" });
        }
        let table = self.table();
        go_together(|kind| table.has_plugin(kind))?;
        check_app_levels(&self.scene_effects, self.accuracy, self.budget)?;
        Ok(self)
    }

    fn table(&self) -> EffectTable {
        EffectTable::new(&self.scene_effects, self.available.iter().copied())
            .at(self.accuracy, self.budget)
    }

    /// Whether the app will have the plugin of an effect.
    #[must_use]
    pub fn has(&self, effect: EffectKind) -> bool {
        self.table().has_plugin(effect)
    }

    /// Records every so many steps, and at the end.
    #[cfg(feature = "record")]
    #[must_use]
    pub fn with_recording(mut self, recorder: cranny_record::Recorder, every: u32) -> Self {
        self.recording = Some(crate::recording::RecordingPlugin::new(recorder, every));
        self
    }

    /// Draws pictures of a run of so many steps.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be drawn, or a camera that cannot see.
    #[cfg(feature = "render")]
    pub fn with_pictures(
        mut self,
        scene: &SceneDescription,
        steps: u64,
        renderer: cranny_render::Renderer,
        options: crate::rendering::PictureOptions,
    ) -> Result<Self, SceneAppError> {
        let plugin = crate::rendering::RenderingPlugin::new(scene, steps, renderer, options)?;
        self.rendering = Some(plugin);
        Ok(self)
    }
}

impl PluginGroup for CrannyPlugins {
    fn build(self) -> PluginGroupBuilder {
        let effects = self.table();
        let named = |kind| effects.has_plugin(kind);
        let [trigger, proximity, contacts, penetration] = [
            EffectKind::Trigger,
            EffectKind::Proximity,
            EffectKind::Contacts,
            EffectKind::Penetration,
        ]
        .map(named);
        let detects = trigger || proximity || contacts || penetration;
        let clock = ClockPlugin { step: self.step };
        let core = CorePlugin { effects: effects.clone(), keeps_failures: self.keeps_failures };
        // Those that keep bodies of their own come before the scene, whose bodies they take in.
        let mut group = PluginGroupBuilder::start::<Self>().add(clock).add(core);
        group = group.add(AdmissionPlugin).add(KinematicsPlugin).add(PathPlugin);
        if detects {
            group = group.add(DetectionPlugin::new(&self.scene_effects, &effects, &self.options));
        }
        if trigger {
            group = group.add(TriggerPlugin);
        }
        if proximity {
            group = group.add(ProximityPlugin);
        }
        if penetration {
            group = group.add(PenetrationPlugin);
        }
        if contacts {
            group = group.add(ContactsPlugin);
        }
        if named(EffectKind::ForceFeedback) {
            group = group.add(ForceFeedbackPlugin);
        }
        if named(EffectKind::Tracking) {
            group = group.add(TrackingPlugin);
        }
        if self.simulated_trackers {
            group = group.add(SimulatedTrackersPlugin);
        }
        #[cfg(feature = "rapier")]
        if effects.has_plugin(EffectKind::Response) {
            group = group.add(crate::response::ResponsePlugin {
                gravity: self.gravity,
                step: self.step,
                length_unit: self.options.length_unit.unwrap_or(1.0),
                options: self.options.clone(),
                detection_present: detects,
                add_step: self.add_step,
            });
        }
        if effects.has_plugin(EffectKind::Continuous) {
            group = group.add(ContinuousPlugin);
        }
        #[cfg(feature = "rapier")]
        if effects.has_plugin(EffectKind::Sound) {
            group = group.add(crate::sound::SoundPlugin);
        }
        #[cfg(feature = "rapier")]
        if effects.has_plugin(EffectKind::Deformation) {
            group = group.add(crate::deformation::DeformationPlugin);
        }
        if let Some(scene) = self.scene {
            group = group.add(ScenePlugin { scene });
        }
        if self.summed_up {
            group = group
                .add(MotionPlugin { helices: self.options.helices.clone() })
                .add(LinkPlugin { rings: self.options.rings.clone() });
            #[cfg(feature = "rapier")]
            if effects.has_plugin(EffectKind::Response) {
                group = group.add(crate::energy::EnergyPlugin);
            }
        }
        #[cfg(feature = "record")]
        if let Some(recording) = self.recording {
            group = group.add(recording);
        }
        #[cfg(feature = "render")]
        if let Some(rendering) = self.rendering {
            group = group.add(rendering);
        }
        group
    }
}

/// Fails if an effect is named and another one is not on which it works.
fn go_together(named: impl Fn(EffectKind) -> bool) -> Result<(), SceneAppError> {
    let of_response = [EffectKind::Sound, EffectKind::Deformation];
    let of_response = of_response.map(|kind| (kind, EffectKind::Response));
    let needing = of_response.into_iter().chain([(EffectKind::Tracking, EffectKind::Trigger)]);
    let lacks = |&(kind, needs): &(EffectKind, EffectKind)| named(kind) && !named(needs);
    match needing.into_iter().find(lacks) {
        Some((kind, needs)) => {
            Err(SceneAppError::NeedsEffect { effect: kind.name(), needs: needs.name() })
        }
        None => Ok(()),
    }
}

/// Whether the effects that a scene, its bodies and its pairs name go together, and with the levels
/// and the budget that it states.
///
/// # Errors
///
/// [`SceneAppError::NeedsEffect`], [`SceneAppError::NotAtLevel`], [`SceneAppError::NoLevels`]; a
/// tracker of a body, or `Tracking` of it, that is for none of its pairs.
pub fn check_effects(scene: &SceneDescription) -> Result<(), SceneAppError> {
    go_together(|kind| scene.all_effects().any(|effect| EffectKind::of(effect) == Some(kind)))?;
    scene.bodies.iter().try_for_each(|body| check_tracking(scene, body))?;
    check_levels(scene)
}

/// Whether what is said of a body's tracking is for one of its pairs at least.
fn check_tracking(scene: &SceneDescription, body: &BodyDescription) -> Result<(), SceneAppError> {
    let kinds = [EffectKind::Trigger, EffectKind::Tracking];
    let named = |effects: &[Effect]| {
        kinds.map(|kind| effects.iter().any(|effect| EffectKind::of(effect) == Some(kind)))
    };
    let join = |a: [bool; 2], b: [bool; 2]| [a[0] || b[0], a[1] || b[1]];
    let [triggers, tracks] = named(&body.effects);
    if body.tracker.is_none() && !tracks {
        return Ok(());
    }
    let own = join([triggers, tracks], named(&scene.effects));
    let of_pair = |other: &BodyDescription| {
        let is = |a: &str, b: &str| a == body.name && b == other.name;
        let said = scene.pairs.iter().filter(|p| is(&p.a, &p.b) || is(&p.b, &p.a));
        said.fold(join(own, named(&other.effects)), |all, pair| join(all, named(&pair.effects)))
    };
    let others = || scene.bodies.iter().filter(|other| other.name != body.name);
    let applies = others().any(|other| of_pair(other) == [true; 2]);
    let name = || body.name.clone();
    if body.tracker.is_some() && !applies {
        return Err(SceneAppError::TrackerAlone { body: name() });
    }
    // An app may spawn others beside a body that triggers by itself.
    let refused = tracks && !applies && !own[0];
    if refused { Err(SceneAppError::TrackingAlone { body: name() }) } else { Ok(()) }
}

/// Twice the volume per area of the thinnest moving body (the thickness of a plate, the radius of a
/// wire): what rapier takes for a metre. Its prediction distance is a fiftieth of that. Larger:
/// contacts are looked for far away, at a cost, and the far flank of a groove joins in. Smaller:
/// bodies meet before their contacts are seen coming.
fn typical_size(scene: &SceneDescription, shapes: &[BodyShape]) -> f64 {
    let dynamic = scene.bodies.iter().zip(shapes).filter(|(b, _)| b.kind == BodyKind::Dynamic);
    let sizes = dynamic.map(|(_, shape)| shape.thickness()).filter(|size| size.is_finite());
    sizes.reduce(f64::min).unwrap_or(1.0)
}

/// The effect table, sums, what failed.
struct CorePlugin {
    effects: EffectTable,
    keeps_failures: bool,
}

impl Plugin for CorePlugin {
    fn build(&self, app: &mut App) {
        let failure = if self.keeps_failures { Failure::kept() } else { Failure::default() };
        app.insert_resource(failure).init_resource::<Tally>();
        app.insert_resource(self.effects.clone());
        for label in [CrannyStep.intern(), CrannyEnd.intern()] {
            let last = hand_on_failure.in_set(CoreSystems::Failure).after(StepSystems::Advance);
            app.add_systems(label, last);
        }
    }
}

/// Spawns a scene, whose bodies are there before the first step.
struct ScenePlugin {
    scene: SpawnScene,
}

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        self.scene.spawn(app.world_mut());
        admit_bodies(app.world_mut());
    }
}

/// Runs [`CrannyStep`] in `FixedPostUpdate`, for apps with bevy's own main schedule and time: the
/// fixed time step becomes the scene's. Add it after [`CrannyPlugins`] and `TimePlugin`.
///
/// Note that bevy's first update runs no fixed step.
#[derive(Clone, Copy, Debug, Default)]
pub struct FixedUpdatePlugin;

impl Plugin for FixedUpdatePlugin {
    fn build(&self, app: &mut App) {
        let step = app.world().get_resource::<SimulatedTime>().map(SimulatedTime::step);
        let step = step.and_then(|step| Duration::try_from_secs_f64(step).ok());
        if let Some(step) = step.filter(|step| !step.is_zero()) {
            app.insert_resource(Time::<Fixed>::from_duration(step));
        }
        app.add_systems(FixedPostUpdate, run_step);
    }
}

fn run_step(world: &mut World) -> Result<(), BevyError> {
    if let Some(mut failure) = world.get_resource_mut::<Failure>() {
        failure.hand_on()?; // what failed as plugins were added
        if failure.is_set() {
            return Ok(()); // what follows are consequences
        }
    }
    world.run_schedule(CrannyStep);
    Ok(())
}
