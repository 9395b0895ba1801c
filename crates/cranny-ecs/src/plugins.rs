//! The plugin group of a scene: one plugin an effect, and none for effects that the scene does not
//! name.

use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::time::Duration;

use bevy_app::{App, FixedPostUpdate, Plugin, PluginGroup, PluginGroupBuilder};
use bevy_ecs::name::Name;
use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time};
use cranny_geometry::Model;
use cranny_world::description::{BodyDescription, BodyKind, SceneDescription};
use cranny_world::{BodyId, ContactFields};

use crate::body::{Bodies, Body, BodyRecord, build_models, transform_of};
use crate::clock::{ClockPlugin, CrannyStep, SimulatedTime};
use crate::contacts::ContactsPlugin;
use crate::detection::DetectionPlugin;
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};
use crate::kinematics::KinematicsPlugin;
use crate::links::{LinkPlugin, Ring};
use crate::motion::{Helix, MotionPlugin};
use crate::tally::Tally;
use crate::trigger::TriggerPlugin;

/// What a scene's plugins are built with, beyond the scene.
#[derive(Clone, Debug, Default)]
pub struct PluginOptions {
    /// Who detects contacts for the solver.
    #[cfg(feature = "rapier")]
    pub detector: cranny_rapier::Detector,
    /// Whether contacts are carried on while a pair drifts a little; `None`: they are. Our detector tells
    /// them anew at each pose, rapier keeps its own as they are.
    #[cfg(feature = "rapier")]
    pub recycling: Option<bool>,
    /// Solver substeps a step; `None`: enough for our detector, rapier's default with its own.
    #[cfg(feature = "rapier")]
    pub substeps: Option<usize>,
    /// Into how many parts a step is divided at most in which bodies near each other move farther than the thinner one is
    /// thick; `None`: 2. Our detector only.
    #[cfg(feature = "rapier")]
    pub most_parts: Option<usize>,
    /// What the solver takes for a metre, in units of length; `None`: twice the volume per
    /// area of the thinnest moving body.
    pub length_unit: Option<f64>,
    /// What the program itself reads of `Contacts` (in [`ContactReport`](crate::ContactReport) or
    /// [`Detected`](crate::Detected)): all, unless it says less. What summary, recording and pictures read is added
    /// to it, and nothing else is computed; [`ContactReaders`](crate::ContactReaders) changes it between steps.
    pub contact_fields: ContactFields,
    /// Pairs whose screw motion is followed.
    pub helices: Vec<Helix>,
    /// Bodies of which those that are linked at the start are watched.
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

/// The plugins of a scene: add them to an `App`, then run [`CrannyStep`] however often you like (or
/// add [`FixedUpdatePlugin`]).
pub struct CrannyPlugins {
    core: CorePlugin,
    detection: Option<DetectionPlugin>,
    effects: EffectTable,
    #[cfg(feature = "rapier")]
    response: Option<crate::response::ResponsePlugin>,
    #[cfg(feature = "record")]
    recording: Option<crate::recording::RecordingPlugin>,
    #[cfg(feature = "render")]
    rendering: Option<crate::rendering::RenderingPlugin>,
    kinematics: Option<KinematicsPlugin>,
    motion: MotionPlugin,
    links: LinkPlugin,
}

impl CrannyPlugins {
    /// Prepares everything that can fail: models, world, solver.
    ///
    /// # Errors
    ///
    /// [`SceneAppError`]: a mesh, pose, effect or step that is refused, or an effect that this
    /// program was built without.
    pub fn from_scene(
        scene: &SceneDescription,
        options: &PluginOptions,
    ) -> Result<Self, SceneAppError> {
        if !(scene.step > 0.0 && scene.step.is_finite()) {
            return Err(SceneAppError::Duration {
                step: scene.step,
                duration: scene.duration,
                why: "a step must last a finite time above 0",
            });
        }
        let models = build_models(scene)?;
        let effects = EffectTable::of(scene)?;
        let detects = effects.names(EffectKind::Trigger) || effects.names(EffectKind::Contacts);
        #[cfg(feature = "rapier")]
        let (response, simulated) = if effects.names(EffectKind::Response) {
            let rigid = crate::simulation::RigidScene::new(scene, &models, &effects, options)?;
            let simulated = rigid.ids.clone();
            (Some(crate::response::ResponsePlugin::new(rigid, detects)), simulated)
        } else {
            (None, Vec::new())
        };
        #[cfg(not(feature = "rapier"))]
        let simulated: Vec<BodyId> = Vec::new();
        #[cfg(not(feature = "rapier"))]
        if effects.names(EffectKind::Response) {
            return Err(SceneAppError::MissingFeature { what: "Response", feature: "rapier" });
        }
        let detection =
            detects.then(|| DetectionPlugin::new(scene, &models, &effects, options)).transpose()?;
        Ok(Self {
            core: CorePlugin::new(scene, models, effects.clone()),
            detection,
            kinematics: kinematics(scene, &simulated),
            motion: MotionPlugin {
                movers: scene
                    .bodies
                    .iter()
                    .enumerate()
                    .filter(|(_, body)| body.kind != BodyKind::Fixed)
                    .map(|(i, body)| (BodyId(i as u32), body.angular_velocity))
                    .collect(),
                helices: options.helices.clone(),
            },
            links: LinkPlugin { rings: options.rings.clone() },
            effects,
            #[cfg(feature = "rapier")]
            response,
            #[cfg(feature = "record")]
            recording: None,
            #[cfg(feature = "render")]
            rendering: None,
        })
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

    /// Effects by pairs.
    #[must_use]
    pub fn effects(&self) -> &EffectTable {
        &self.effects
    }
}

impl PluginGroup for CrannyPlugins {
    fn build(self) -> PluginGroupBuilder {
        // Bodies first: the others look them up.
        let clock = ClockPlugin { step: self.core.step };
        let mut group = PluginGroupBuilder::start::<Self>().add(clock).add(self.core);
        group = group.add(self.motion).add(self.links);
        if let Some(kinematics) = self.kinematics {
            group = group.add(kinematics);
        }
        if let Some(detection) = self.detection {
            group = group.add(detection);
        }
        if self.effects.names(EffectKind::Trigger) {
            group = group.add(TriggerPlugin);
        }
        if self.effects.names(EffectKind::Contacts) {
            group = group.add(ContactsPlugin);
        }
        #[cfg(feature = "rapier")]
        if let Some(response) = self.response {
            group = group.add(response);
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

/// Present where a kinematic body moves, whoever moves it: so another effect adds its own systems to
/// a plan and takes none away. Bodies that the solver moves are left to it.
fn kinematics(scene: &SceneDescription, simulated: &[BodyId]) -> Option<KinematicsPlugin> {
    let moves = |body: &BodyDescription| {
        body.kind == BodyKind::Kinematic
            && (body.linear_velocity.length_squared() > 0.0
                || body.angular_velocity.length_squared() > 0.0)
    };
    if !scene.bodies.iter().any(moves) {
        return None;
    }
    let bodies = scene.bodies.iter().enumerate().map(|(i, body)| (BodyId(i as u32), body));
    let bodies = bodies
        .filter(|(id, body)| moves(body) && simulated.binary_search(id).is_err())
        .map(|(id, body)| (id, body.linear_velocity, body.angular_velocity));
    Some(KinematicsPlugin { bodies: bodies.collect() })
}

/// Bodies as entities, the effect table, sums.
struct CorePlugin {
    step: f64,
    bodies: Vec<(BodyDescription, Model)>,
    effects: Mutex<EffectTable>,
}

impl CorePlugin {
    fn new(scene: &SceneDescription, models: Vec<Model>, effects: EffectTable) -> Self {
        let bodies = scene.bodies.iter().cloned().zip(models).collect();
        Self { step: scene.step, bodies, effects: Mutex::new(effects) }
    }
}

impl Plugin for CorePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Failure>().init_resource::<Tally>();
        if let Ok(effects) = self.effects.lock() {
            app.insert_resource(effects.clone());
        }
        let mut records = Bodies::default();
        for (i, (body, model)) in self.bodies.iter().enumerate() {
            let id = BodyId(i as u32);
            let parts = (Name::new(body.name.clone()), Body { id }, transform_of(&body.pose));
            let entity = app.world_mut().spawn(parts).id();
            records.push(BodyRecord {
                entity,
                name: body.name.clone(),
                model: model.clone(),
                visual: body.visual.clone(),
                kind: body.kind,
                density: body.material.density,
                normals: body.normals,
            });
        }
        app.insert_resource(records);
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

fn run_step(world: &mut World) {
    // A failure stays for the app to see; going on would hide it behind its consequences.
    if !world.get_resource::<Failure>().is_some_and(Failure::is_set) {
        world.run_schedule(CrannyStep);
    }
}
