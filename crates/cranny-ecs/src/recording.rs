//! `Recording`: frames to MCAP.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::{Insert, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_geometry::Mesh;
use cranny_primitives::BodyShape;
use cranny_record::{
    Frame, LogLevel, PairContacts, PairFrame, RecordError, RecordedBody, RecordedDepth,
    RecordedEvent, Recorder, Summary, topic,
};
use cranny_world::description::BodyColor;
use cranny_world::{BodyId, ContactFields, PairEvent, PairEventKind};

use crate::body::{Bodies, Body, BodyRecord, pose_of};
use crate::clock::{CrannyEnd, CrannyStep, PhaseTimes, SimulatedTime, StepSystems};
use crate::contacts::ContactReport;
use crate::detection::Detected;
use crate::effects::{EffectKind, EffectTable};
use crate::error::{Failure, SceneAppError};
use crate::properties::Sensor;
use crate::readers::ContactReaders;
use crate::trigger::TriggeredPairs;

/// What was recorded is written out after this time of work at the latest, so that a kill loses no
/// more. Smaller: chunks of slow scenes hold few frames and compress worse. Larger: a kill loses
/// more.
const FLUSH_AFTER: Duration = Duration::from_secs(1);

/// The systems of `Recording`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RecordingSystems {
    /// A frame of the poses at the beginning of the step, and of what was found there; in
    /// [`CrannyEnd`], of the final poses. Events are all those since the frame before.
    Frame,
}

/// The recording that is being written.
#[derive(Resource)]
pub struct FrameRecorder {
    /// Its compressor may be used by one thread at a time only.
    recorder: Mutex<Option<Recorder>>,
    every: u32,
    /// When what was recorded was last known to be written out.
    flushed: Instant,
    /// Step and times at the latest frame.
    measured: (u64, PhaseTimes),
    /// Since the latest frame: a frame holds all of them, so that none is lost between frames.
    events: Vec<(String, String, PairEventKind, bool)>,
    /// What is shown of each body.
    shown: BTreeMap<BodyId, ShownBody>,
}

impl FrameRecorder {
    /// Only pairs with `Trigger` have events. Names are taken now: a body may have left by the time
    /// of the frame.
    fn note_events(&mut self, sources: &Sources) {
        let Sources { records, effects, detected, triggered, .. } = sources;
        let report = detected.as_ref().and_then(|detected| detected.report.as_ref());
        let of_regions = report.iter().flat_map(|report| &report.events).copied().filter(|event| {
            !matches!(event.kind, PairEventKind::Began | PairEventKind::Ended)
                && effects.asks(EffectKind::Trigger, event.a, event.b)
        });
        let of_pairs = triggered.iter().flat_map(|triggered| triggered.events());
        let mut events: Vec<PairEvent> = of_pairs.chain(of_regions).collect();
        events.sort_unstable();
        self.events.extend(events.into_iter().map(|event| {
            let [a, b] = [event.a, event.b].map(|id| records.name(id).to_owned());
            let began = event.kind == PairEventKind::Began;
            let open = began && report.is_some_and(|report| report.is_open(event.a, event.b));
            (a, b, event.kind, open)
        }));
    }

    fn open(&mut self) -> Option<&mut Recorder> {
        self.slot().as_mut()
    }

    fn slot(&mut self) -> &mut Option<Recorder> {
        // A panic elsewhere leaves a recording that fails or works: it says so itself.
        self.recorder.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Completes the file and gives it its final name; `interrupted` says why, if the run was.
    /// `None` where that was done before.
    ///
    /// # Errors
    ///
    /// Where the file cannot be written or renamed; what was written stays in the partial file.
    pub fn finish(&mut self, interrupted: Option<&str>) -> Option<Result<Summary, RecordError>> {
        self.slot().take().map(|recorder| match interrupted {
            Some(why) => recorder.finish_interrupted(why),
            None => recorder.finish(),
        })
    }

    /// Writes a line to the recording's log.
    ///
    /// # Errors
    ///
    /// Where the file cannot be written.
    pub fn log(&mut self, level: LogLevel, text: &str) -> Result<(), RecordError> {
        self.open().map_or(Ok(()), |recorder| recorder.log(level, text))
    }

    /// Writes a camera's picture, a PNG.
    ///
    /// # Errors
    ///
    /// Where it is no PNG, or the file cannot be written.
    pub fn image(&mut self, camera: &str, step: u64, png: &[u8]) -> Result<(), RecordError> {
        self.open().map_or(Ok(()), |recorder| recorder.image(camera, step, png))
    }
}

/// Puts the [`FrameRecorder`] in.
pub(crate) struct RecordingPlugin {
    recorder: Mutex<Option<Recorder>>,
    every: u32,
}

impl RecordingPlugin {
    /// Records every so many steps.
    pub(crate) fn new(recorder: Recorder, every: u32) -> Self {
        Self { recorder: Mutex::new(Some(recorder)), every: every.max(1) }
    }
}

impl Plugin for RecordingPlugin {
    fn build(&self, app: &mut App) {
        let recorder = self.recorder.lock().ok().and_then(|mut recorder| recorder.take());
        let mut recorder = FrameRecorder {
            recorder: Mutex::new(recorder),
            every: self.every,
            flushed: Instant::now(),
            measured: (0, PhaseTimes::default()),
            events: Vec::new(),
            shown: BTreeMap::new(),
        };
        let bodies = app.world().resource::<Bodies>();
        let is_sensor = |record: &BodyRecord| app.world().get::<Sensor>(record.entity).is_some();
        let known = bodies.iter().map(|(id, record)| (id, record, IsSensor(is_sensor(record))));
        let step = app.world().resource::<SimulatedTime>().steps();
        let written = record_bodies(&mut recorder, step, known);
        let shown = bodies.iter().map(|(id, record)| (id, ShownBody::of(record)));
        recorder.shown = shown.collect();
        app.world_mut().resource_mut::<Failure>().note(written);
        app.insert_resource(recorder);
        app.add_observer(record_body).add_observer(record_removal);
        // In every step, not only where a frame is due: names of regions and their events follow
        // them.
        if let Some(mut readers) = app.world_mut().get_resource_mut::<ContactReaders>() {
            readers.set(ContactReaders::RECORDING, ContactFields::ALL);
        }
        let frame = (StepSystems::Record, RecordingSystems::Frame);
        app.add_systems(CrannyStep, record_step.in_set(frame.0).in_set(frame.1));
        app.add_systems(CrannyEnd, record_end.in_set(frame.0).in_set(frame.1));
    }
}

/// Whether a body is a sensor.
struct IsSensor(bool);

fn record_bodies<'a>(
    recorder: &mut FrameRecorder,
    step: u64,
    bodies: impl Iterator<Item = (BodyId, &'a BodyRecord, IsSensor)>,
) -> Result<(), SceneAppError> {
    let shown = bodies.map(|(id, record, is_sensor)| {
        let primitive = record.shape.primitive().map(ToString::to_string);
        Ok((id, record, is_sensor, record.drawn_mesh()?, primitive))
    });
    let shown = shown.collect::<Result<Vec<_>, SceneAppError>>()?;
    let bodies = shown.iter().map(|(id, record, is_sensor, mesh, primitive)| RecordedBody {
        name: &record.name,
        mesh,
        color: record.color.map_or_else(|| hue(id.0), opaque),
        color_is_stated: record.color.is_some(),
        number: Some(id.0),
        sensor: is_sensor.0,
        model: record.model(),
        primitive: primitive.as_deref(),
        kind: Some(record.kind),
    });
    let bodies: Vec<RecordedBody> = bodies.collect();
    recorder.open().map_or(Ok(()), |r| r.bodies(step, &bodies)).map_err(Into::into)
}

/// A body that comes while the run goes on, or one whose geometry has changed.
fn record_body(
    inserted: On<Insert<Body>>,
    query: Query<(&Body, Has<Sensor>)>,
    bodies: Res<Bodies>,
    time: Res<SimulatedTime>,
    mut recorder: ResMut<FrameRecorder>,
    mut failure: ResMut<Failure>,
) {
    let Ok((&Body { id }, is_sensor)) = query.get(inserted.entity) else { return };
    let Some(record) = bodies.get(id) else { return };
    let before = recorder.shown.insert(id, ShownBody::of(record));
    if before.is_some_and(|before| before.is_same(record)) {
        return;
    }
    if let Some(recorder) = recorder.open() {
        failure.note(recorder.remove_body(time.steps(), &record.name));
    }
    let bodies = [(id, record, IsSensor(is_sensor))];
    failure.note(record_bodies(&mut recorder, time.steps(), bodies.into_iter()));
}

fn record_removal(
    removed: On<Remove<Body>>,
    query: Query<&Body>,
    bodies: Res<Bodies>,
    time: Res<SimulatedTime>,
    mut recorder: ResMut<FrameRecorder>,
    mut failure: ResMut<Failure>,
) {
    let Ok(&Body { id }) = query.get(removed.entity) else { return };
    recorder.shown.remove(&id);
    if let Some(recorder) = recorder.open() {
        failure.note(recorder.remove_body(time.steps(), bodies.name(id)));
    }
}

/// What a recording shows of a body.
struct ShownBody {
    shape: BodyShape,
    visual: Option<Arc<Mesh>>,
    color: Option<BodyColor>,
}

impl ShownBody {
    fn of(record: &BodyRecord) -> Self {
        let (shape, visual) = (record.shape.clone(), record.visual.clone());
        Self { shape, visual, color: record.color }
    }

    fn is_same(&self, record: &BodyRecord) -> bool {
        let same_visual = match (&self.visual, &record.visual) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        self.shape.is_same(&record.shape) && same_visual && self.color == record.color
    }
}

fn opaque(color: BodyColor) -> [f64; 4] {
    let [red, green, blue] = color.shares();
    [red, green, blue, 1.0]
}

/// Colours of bodies: the colour wheel in steps of the golden ratio, so neighbours differ.
fn hue(number: u32) -> [f64; 4] {
    let turn = (f64::from(number) * 0.618_034).fract();
    let channel = |shift: f64| {
        let distance = ((turn + shift).fract() - 0.5).abs() * 6.0;
        0.3 + 0.55 * (distance - 1.0).clamp(0.0, 1.0)
    };
    [channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0), 1.0]
}

/// What a frame is made of; the last three exist only where something needs them.
#[derive(SystemParam)]
struct Sources<'w, 's> {
    bodies: Query<'w, 's, (&'static Body, &'static Transform)>,
    records: Res<'w, Bodies>,
    effects: Res<'w, EffectTable>,
    detected: Option<Res<'w, Detected>>,
    contacts: Option<Res<'w, ContactReport>>,
    triggered: Option<Res<'w, TriggeredPairs>>,
    #[cfg(feature = "rapier")]
    solver: Option<Res<'w, crate::solved::RigidBodies>>,
}

impl Sources<'_, '_> {
    /// Mechanical energy, where a solver moves bodies.
    fn energy(&self) -> Option<f64> {
        #[cfg(feature = "rapier")]
        return self.solver.as_ref().map(|solver| solver.energy().now);
        #[cfg(not(feature = "rapier"))]
        None
    }
}

impl FrameRecorder {
    /// Milliseconds a step of each phase since the latest frame.
    fn phases(&mut self, step: u64, now: &PhaseTimes) -> [(&'static str, f64); 6] {
        let (before, then) = std::mem::replace(&mut self.measured, (step, *now));
        let steps = step.saturating_sub(before).max(1) as f64;
        topic::PHASES.map(|name| (name, (phase(now, name) - phase(&then, name)) / steps))
    }
}

fn phase(times: &PhaseTimes, name: &str) -> f64 {
    match name {
        topic::MS_BROAD => times.broad,
        topic::MS_NARROW => times.narrow,
        topic::MS_SOLVER => times.solver,
        topic::MS_REPORT => times.report,
        topic::MS_RECORD => times.record,
        _ => times.render,
    }
}

fn record_step(
    sources: Sources,
    time: Res<SimulatedTime>,
    mut recorder: ResMut<FrameRecorder>,
    mut times: ResMut<PhaseTimes>,
    mut failure: ResMut<Failure>,
) {
    recorder.note_events(&sources);
    if time.steps().is_multiple_of(u64::from(recorder.every)) && !failure.is_set() {
        record(&sources, &time, &mut recorder, &mut times, &mut failure);
    }
}

fn record_end(
    sources: Sources,
    time: Res<SimulatedTime>,
    mut recorder: ResMut<FrameRecorder>,
    mut times: ResMut<PhaseTimes>,
    mut failure: ResMut<Failure>,
) {
    recorder.note_events(&sources);
    if !failure.is_set() {
        record(&sources, &time, &mut recorder, &mut times, &mut failure);
    }
}

fn record(
    sources: &Sources,
    time: &SimulatedTime,
    recorder: &mut FrameRecorder,
    times: &mut PhaseTimes,
    failure: &mut Failure,
) {
    let Sources { bodies, records, effects, detected, contacts, .. } = sources;
    let events = std::mem::take(&mut recorder.events);
    let start = Instant::now();
    let is_due = start.duration_since(recorder.flushed) >= FLUSH_AFTER;
    if is_due {
        recorder.flushed = start;
    }
    let phases = recorder.phases(time.steps(), times);
    let Some(recorder) = recorder.open() else { return };
    let mut placed: Vec<_> = bodies.iter().collect();
    placed.sort_by_key(|(body, _)| body.id);
    let mut frame = Frame::at_step(time.steps());
    frame.poses = placed
        .iter()
        .map(|(body, transform)| (records.name(body.id), pose_of(transform)))
        .collect();
    frame.measures =
        phases.into_iter().chain(sources.energy().map(|e| (topic::ENERGY, e))).collect();
    if let Some(report) = detected.as_ref().and_then(|detected| detected.report.as_ref()) {
        frame.stats = report.stats;
        frame.deepest = report.stats.deepest.map(|d| RecordedDepth {
            depth: d.depth,
            a: records.name(d.a),
            b: records.name(d.b),
        });
    }
    let recorded = events.iter();
    frame.events = recorded
        .map(|(a, b, kind, open)| RecordedEvent { a, b, kind: *kind, open: *open })
        .collect();
    frame.contacts = contacts
        .iter()
        .flat_map(|contacts| &contacts.pairs)
        .map(|pair| PairContacts {
            a: records.name(pair.a),
            b: records.name(pair.b),
            pose_a: pair.poses[0],
            pose_b: pair.poses[1],
            frame: pair.frame.map(|frame| PairFrame {
                first_is_a: frame.first_is_a,
                first_from_second: frame.first_from_second,
            }),
            margin: effects.contact_margin(pair.a, pair.b),
            answer: &pair.answer,
        })
        .collect();
    let mut written = recorder.frame(&frame);
    if is_due && written.is_ok() {
        written = recorder.flush();
    }
    failure.note(written);
    times.record += 1e3 * start.elapsed().as_secs_f64();
}
