//! `Rendering`: pictures of a run, without a window.
//!
//! # What it costs at most
//!
//! Without a graphics card a picture of 400,000 triangles takes about half a second of processor
//! time. So pictures are drawn at moments of *simulated* time: with [`PictureOptions::frames`]
//! [`FRAMES_PER_SECOND`] of them a second, else [`PREVIEW_FRAMES`] in all; and the final state.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use bevy_app::{App, Plugin};
use bevy_ecs::lifecycle::{Insert, Remove};
use bevy_ecs::prelude::*;
use bevy_ecs::system::SystemParam;
use bevy_transform::components::Transform;
use cranny_narrow_phase::Answer;
use cranny_render::palette;
use cranny_render::{Animation, Image, ImageSize, Renderer};
use cranny_world::description::SceneDescription;
use cranny_world::{BodyId, ContactFields};

use crate::body::{Bodies, Body, BodyRecord, pose_of};
use crate::clock::{CrannyEnd, CrannyStep, PhaseTimes, SimulatedTime, StepSystems};
use crate::contacts::ContactReport;
use crate::effects::{EffectTable, Pair};
use crate::error::{Failure, SceneAppError};
use crate::painting::{MeetingPair, Moment, PictureQuality, ScenePainter, panel_sizes};
use crate::readers::ContactReaders;

/// Pictures a simulated second, with [`PictureOptions::frames`].
pub const FRAMES_PER_SECOND: f64 = 30.0;

/// Pictures of a preview, at most. More: minutes of drawing in software for a file of megabytes;
/// fewer: motion is a slide show.
pub const PREVIEW_FRAMES: usize = 32;

/// Width of a preview, and height of its pictures, which stand side by side.
pub const PREVIEW_SIZE: [u32; 2] = [1180, 360];

/// Width and height of the pictures in a recording.
pub const RECORDED_SIZE: [u32; 2] = [480, 270];

/// Width and height of [`PictureOptions::frames`].
pub const FRAME_SIZE: [u32; 2] = [1280, 720];

/// The systems of `Rendering`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RenderingSystems {
    /// Says what the pictures of this step will read of `Contacts`; present where a scene names
    /// that.
    Read,
    /// A picture of each camera, at the beginning of the step; in [`CrannyEnd`], of the final
    /// state.
    Picture,
}

/// Where pictures go.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PictureOptions {
    /// A folder for one PNG a moment and camera: `main_00000.png`.
    pub frames: Option<PathBuf>,
    /// An animated PNG of pages: the first camera's picture beside a section through the deepest
    /// contact. Its first picture, which is all that other viewers show, is the last moment with a
    /// contact, or the final state.
    pub preview: Option<PathBuf>,
    /// Into the recording, as `/camera/<name>`.
    pub record: bool,
    /// Width and height of frames; width of the preview and height of its pictures. `None`:
    /// [`FRAME_SIZE`] and [`PREVIEW_SIZE`].
    pub size: Option<[u32; 2]>,
    /// The only camera: one of the scene's, or `isometric`, `front`, `side`, `top`. `None`: all of
    /// the scene's.
    pub camera: Option<String>,
    /// How much is done for the eye.
    pub quality: PictureQuality,
}

impl PictureOptions {
    /// Whether pictures are wanted at all.
    #[must_use]
    pub fn any(&self) -> bool {
        self.frames.is_some() || self.preview.is_some() || self.record
    }
}

/// When pictures are due.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    /// Pictures a step.
    rate: f64,
    /// Of the pictures, every so many belongs to the preview.
    preview_every: usize,
    /// Seconds of a picture of the preview.
    pub(crate) preview_seconds: f64,
}

impl Moments {
    /// For a run of so many steps of `dt` seconds.
    pub(crate) fn new(steps: u64, dt: f64, frames: bool) -> Self {
        // The first and the last picture are always drawn, and the rate gives those between.
        let between = (PREVIEW_FRAMES - 2) as f64;
        let even = between / steps.max(1) as f64;
        let rate = if frames { (FRAMES_PER_SECOND * dt).min(1.0) } else { even.min(1.0) };
        let drawn = rate * steps as f64;
        let preview_every = (drawn / between).ceil().max(1.0) as usize;
        let preview_seconds = preview_every as f64 * dt / rate;
        Self { rate, preview_every, preview_seconds }
    }

    /// Whether the step begins with a picture: the first does, and each that passes a multiple.
    fn is_due(&self, step: u64) -> bool {
        step == 0 || (step as f64 * self.rate).floor() > ((step - 1) as f64 * self.rate).floor()
    }
}

/// Why a file is not written, which the error around it names.
fn unsaved(error: &dyn std::error::Error) -> String {
    let why = error.source().map_or_else(|| error.to_string(), ToString::to_string);
    format!("{why}; make room on the disk, or name another folder")
}

/// Draws, and keeps what a preview needs.
#[derive(Resource)]
pub struct Painter {
    renderer: Mutex<Renderer>,
    /// For frames and recordings, and for the pages of the preview: sizes differ.
    scene: ScenePainter,
    pages: ScenePainter,
    size: ImageSize,
    page_size: [u32; 2],
    moments: Moments,
    options: PictureOptions,
    drawn: usize,
    /// Pages, and whether something meets on each.
    preview: Vec<(Image, bool)>,
    /// Pictures for the recording: camera, step, PNG.
    encoded: Vec<(String, u64, Vec<u8>)>,
}

impl Painter {
    /// Moments that were drawn so far.
    #[must_use]
    pub fn drawn(&self) -> usize {
        self.drawn
    }

    /// Writes the preview, if one is wanted. Call it once, after [`CrannyEnd`].
    ///
    /// # Errors
    ///
    /// Where the file cannot be written.
    pub fn finish(&mut self) -> Result<(), SceneAppError> {
        let Some(path) = &self.options.preview else { return Ok(()) };
        let pages = std::mem::take(&mut self.preview);
        let telling = pages.iter().rev().find(|(_, meets)| *meets).or(pages.last());
        let Some((poster, _)) = telling.cloned() else { return Ok(()) };
        // Players hold a picture for 20 ms at least.
        let delay = (1e3 * self.moments.preview_seconds).round().clamp(20.0, 1e3) as u16;
        let mut animation = Animation::new(delay);
        let failed = |why: String| SceneAppError::Output { path: path.clone(), why };
        let size = poster.size();
        for page in std::iter::once(poster).chain(pages.into_iter().map(|(page, _)| page)) {
            // Legends differ in length from moment to moment.
            let page = page.on_canvas(size, palette::PAPER);
            animation.push(page).map_err(|error| failed(error.to_string()))?;
        }
        animation.save(path).map_err(|error| failed(unsaved(&error)))
    }

    fn put(&mut self, id: BodyId, record: &BodyRecord) -> Result<(), SceneAppError> {
        self.scene.put(id, record)?;
        self.pages.put(id, record)
    }

    fn remove(&mut self, id: BodyId) {
        self.scene.remove(id);
        self.pages.remove(id);
    }

    fn paint(&mut self, moment: &Moment, step: u64, last: bool) -> Result<(), SceneAppError> {
        let in_preview = last || self.drawn.is_multiple_of(self.moments.preview_every);
        let cameras = self.scene.cameras().to_vec();
        let renderer = &mut self.renderer;
        let renderer = renderer.get_mut().unwrap_or_else(PoisonError::into_inner);
        let recorded = self.options.record && in_preview;
        let pictured = cameras.iter().filter(|_| recorded || self.options.frames.is_some());
        for (name, camera) in pictured {
            let failed = |why: String| SceneAppError::Picture { camera: name.clone(), why };
            let image = self
                .scene
                .picture(renderer, moment, camera, self.size)
                .map_err(|error| failed(error.to_string()))?;
            if let Some(folder) = &self.options.frames {
                let path = frame_path(folder, name, self.drawn);
                image
                    .save_png(&path)
                    .map_err(|error| SceneAppError::Output { path, why: unsaved(&error) })?;
            }
            if recorded {
                let small = image.scaled_down(RECORDED_SIZE[0]);
                let png = small.encode_png().map_err(|error| failed(error.to_string()))?;
                self.encoded.push((name.clone(), step, png));
            }
        }
        if in_preview && self.options.preview.is_some() {
            let [width, height] = self.page_size;
            let page = self.pages.page(renderer, moment, width, height)?;
            self.preview.push((page, !moment.pairs.is_empty()));
        }
        self.drawn += 1;
        Ok(())
    }
}

/// The file of a camera's picture: `main_00000.png`.
#[must_use]
pub fn frame_path(folder: &Path, camera: &str, number: usize) -> PathBuf {
    folder.join(format!("{camera}_{number:05}.png"))
}

/// Puts the [`Painter`] in.
pub(crate) struct RenderingPlugin {
    painter: Mutex<Option<Painter>>,
}

impl RenderingPlugin {
    /// Pictures of a run of so many steps.
    pub(crate) fn new(
        scene: &SceneDescription,
        steps: u64,
        renderer: Renderer,
        options: PictureOptions,
    ) -> Result<Self, SceneAppError> {
        let refused = |why: String| SceneAppError::Picture {
            camera: crate::painting::DEFAULT_CAMERA.to_owned(),
            why,
        };
        let usual = if options.frames.is_some() { FRAME_SIZE } else { RECORDED_SIZE };
        let [width, height] = options.size.unwrap_or(usual);
        let size = ImageSize::new(width, height).map_err(|error| refused(error.to_string()))?;
        let page_size = options.size.unwrap_or(PREVIEW_SIZE);
        let [main, ..] = panel_sizes(page_size[0], page_size[1])
            .ok_or_else(|| refused(format!("{} x {} pixels", page_size[0], page_size[1])))?;
        let painter = |size| {
            let mut painter = ScenePainter::new(scene, size, options.quality)?;
            if let Some(name) = &options.camera {
                painter.choose_camera(scene, name, size)?;
            }
            Ok::<_, SceneAppError>(painter)
        };
        Ok(Self {
            painter: Mutex::new(Some(Painter {
                renderer: Mutex::new(renderer),
                scene: painter(size)?,
                pages: painter(main)?,
                size,
                page_size,
                moments: Moments::new(steps, scene.step, options.frames.is_some()),
                options,
                drawn: 0,
                preview: Vec::new(),
                encoded: Vec::new(),
            })),
        })
    }
}

impl Plugin for RenderingPlugin {
    fn build(&self, app: &mut App) {
        let Some(painter) = self.painter.lock().ok().and_then(|mut painter| painter.take()) else {
            return; // built twice: the first build took it
        };
        let records = painter.options.record;
        app.insert_resource(painter);
        app.add_observer(paint_body).add_observer(paint_no_more);
        if app.world().contains_resource::<ContactReaders>() {
            let read = (StepSystems::Sync, RenderingSystems::Read);
            app.add_systems(CrannyStep, read_for_step.in_set(read.0).in_set(read.1));
            app.add_systems(CrannyEnd, read_for_end.in_set(read.0).in_set(read.1));
        }
        let set = (StepSystems::Draw, RenderingSystems::Picture);
        app.add_systems(CrannyStep, draw_step.in_set(set.0).in_set(set.1));
        app.add_systems(CrannyEnd, draw_end.in_set(set.0).in_set(set.1));
        #[cfg(feature = "record")]
        if records {
            app.add_systems(
                CrannyStep,
                record_pictures.in_set(set.0).in_set(set.1).after(draw_step),
            );
            app.add_systems(CrannyEnd, record_pictures.in_set(set.0).in_set(set.1).after(draw_end));
        }
        #[cfg(not(feature = "record"))]
        let _ = records;
    }
}

/// A body that comes while the run goes on, or one whose geometry has changed.
fn paint_body(
    inserted: On<Insert<Body>>,
    query: Query<&Body>,
    bodies: Res<Bodies>,
    mut painter: ResMut<Painter>,
    mut failure: ResMut<Failure>,
) {
    let Ok(&Body { id }) = query.get(inserted.entity) else { return };
    if let Some(record) = bodies.get(id) {
        failure.note(painter.put(id, record));
    }
}

fn paint_no_more(removed: On<Remove<Body>>, query: Query<&Body>, mut painter: ResMut<Painter>) {
    if let Ok(&Body { id }) = query.get(removed.entity) {
        painter.remove(id);
    }
}

/// What pictures mark.
const MARKED: ContactFields = ContactFields { depth: None, points: true, regions: false };

fn read_for_step(
    painter: Res<Painter>,
    time: Res<SimulatedTime>,
    mut readers: ResMut<ContactReaders>,
) {
    let due = painter.moments.is_due(time.steps());
    let fields = if due { MARKED } else { ContactFields::NONE };
    // Looked at first: what is set counts as changed.
    if readers.of(ContactReaders::PICTURES) != fields {
        readers.set(ContactReaders::PICTURES, fields);
    }
}

fn read_for_end(mut readers: ResMut<ContactReaders>) {
    readers.set(ContactReaders::PICTURES, MARKED);
}

/// Everything that a picture reads but the painter. With the painter among it, the bounds that the
/// derive writes make the compiler look through the graphics device's types, six seconds a build.
#[derive(SystemParam)]
struct PictureSources<'w, 's> {
    bodies: Query<'w, 's, (&'static Body, &'static Transform)>,
    contacts: Option<Res<'w, ContactReport>>,
    effects: Res<'w, EffectTable>,
    #[cfg(feature = "rapier")]
    solver: Option<Res<'w, crate::solved::RigidBodies>>,
    time: Res<'w, SimulatedTime>,
}

impl PictureSources<'_, '_> {
    fn moment(&self) -> Moment {
        let poses = self.bodies.iter().map(|(body, transform)| (body.id, pose_of(transform)));
        let reported = self.contacts.iter().flat_map(|report| &report.pairs);
        let pairs: BTreeMap<Pair, Answer> =
            reported.map(|pair| ((pair.a, pair.b), pair.answer.clone())).collect();
        #[cfg(not(feature = "rapier"))]
        let impulse = |_: Pair| 0.0;
        // What the solver found of pairs that nobody reports.
        #[cfg(feature = "rapier")]
        let (pairs, impulse) = {
            let mut pairs = pairs;
            for (a, b, found) in self.solver.iter().flat_map(|solver| solver.contacts()) {
                if !found.answer.contacts.is_empty() {
                    pairs.entry((a, b)).or_insert_with(|| (*found.answer).clone());
                }
            }
            let impulse =
                |(a, b): Pair| self.solver.as_ref().map_or(0.0, |solver| solver.impulse(a, b));
            (pairs, impulse)
        };
        let pairs = pairs.into_iter().map(|((a, b), answer)| {
            let impulse = impulse((a, b));
            let sensed = self.effects.is_sensed(a, b);
            MeetingPair { a, b, answer, impulse, sensed }
        });
        Moment { time: self.time.seconds(), poses: poses.collect(), pairs: pairs.collect() }
    }
}

fn draw_step(
    sources: PictureSources,
    painter: ResMut<Painter>,
    times: ResMut<PhaseTimes>,
    failure: ResMut<Failure>,
) {
    if painter.moments.is_due(sources.time.steps()) {
        draw(&sources, painter, times, failure, false);
    }
}

fn draw_end(
    sources: PictureSources,
    painter: ResMut<Painter>,
    times: ResMut<PhaseTimes>,
    failure: ResMut<Failure>,
) {
    draw(&sources, painter, times, failure, true);
}

fn draw(
    sources: &PictureSources,
    mut painter: ResMut<Painter>,
    mut times: ResMut<PhaseTimes>,
    mut failure: ResMut<Failure>,
    last: bool,
) {
    if failure.is_set() {
        return;
    }
    let start = Instant::now();
    failure.note(painter.paint(&sources.moment(), sources.time.steps(), last));
    times.render += 1e3 * start.elapsed().as_secs_f64();
}

#[cfg(feature = "record")]
fn record_pictures(
    mut painter: ResMut<Painter>,
    mut recorder: ResMut<crate::recording::FrameRecorder>,
    mut times: ResMut<PhaseTimes>,
    mut failure: ResMut<Failure>,
) {
    let start = Instant::now();
    for (camera, step, png) in painter.encoded.drain(..) {
        failure.note(recorder.image(&camera, step, &png));
    }
    times.record += 1e3 * start.elapsed().as_secs_f64();
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(moments: &Moments, steps: u64) -> usize {
        (0..steps).filter(|&step| moments.is_due(step)).count()
    }

    #[test]
    fn a_preview_has_few_pictures_however_long_the_run() {
        for (steps, dt) in [(1, 0.1), (20, 0.01), (1200, 1.0 / 240.0), (1_000_000, 1e-3)] {
            let moments = Moments::new(steps, dt, false);
            let drawn = count(&moments, steps) + 1;
            assert!(drawn <= PREVIEW_FRAMES && drawn >= (steps as usize).min(PREVIEW_FRAMES - 2));
            assert_eq!(moments.preview_every, 1);
        }
    }

    #[test]
    fn frames_come_thirty_a_second_and_the_preview_keeps_some() {
        let moments = Moments::new(1200, 1.0 / 240.0, true);
        let drawn = count(&moments, 1200);
        assert!((150..=151).contains(&drawn), "{drawn}");
        assert!(drawn.div_ceil(moments.preview_every) < PREVIEW_FRAMES);
        let slow = Moments::new(10, 0.5, true);
        assert_eq!(count(&slow, 10), 10);
    }
}
