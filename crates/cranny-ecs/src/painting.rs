//! What is drawn of a run: bodies, what hides them, where they meet, and a page that explains it.
//!
//! Nothing here changes the run. A [`ScenePainter`] is given a [`Moment`] (poses, and what was
//! found of pairs) and draws it: [`coats`] has meshes and colours, [`hiding`] says which stationary
//! bodies stand before moving ones, [`cameras`] where from, [`focus`] which contact shows most and
//! the plane that shows it, [`marks`] how contacts look, [`motion`] how bodies came to where they
//! are, [`heat`] what the search looks at, [`page`] puts views beside each other.

mod cameras;
mod coats;
mod focus;
mod heat;
mod hiding;
mod marks;
mod motion;
mod names;
mod page;

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::Pose;
use cranny_narrow_phase::Answer;
use cranny_render::{
    Camera, DrawList, Ground, Image, ImageSize, Instance, RenderError, Renderer, Shading, Style,
};
use cranny_world::BodyId;
use cranny_world::description::{Effect, SceneDescription};

pub use self::cameras::{CAMERA_PRESETS, DEFAULT_CAMERA, NamedCamera};
use self::coats::Coats;
use self::focus::Focus;
pub use self::marks::MARKS_MAX;
use self::motion::Trails;
pub(crate) use self::page::panel_sizes;
use crate::body::BodyRecord;
use crate::error::SceneAppError;

/// How much a picture does for the eye, and what that costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PictureQuality {
    /// Light on the faces alone: the fastest.
    Draft,
    /// Outlines, and shade where bodies stand close.
    #[default]
    Normal,
    /// The same at twice the size, scaled down: four times the pixels.
    Fine,
}

/// What a picture of a moment shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ScenePainterView {
    /// The scene beside a section through what touches, and that magnified.
    #[default]
    Page,
    /// The scene with its contacts.
    Scene,
    /// The section through what touches.
    Section,
    /// The scene, bodies as x-rays, with its legend.
    XRay,
    /// The scene, bodies as wireframes, with its legend.
    Wireframe,
    /// The scene, with the way of each moving body, where it was before, and its velocity: of the
    /// moments that were drawn or [followed](ScenePainter::follow).
    Motion,
    /// What the search of the narrow phase looks at, as heat on the faces, twice: from nothing, and
    /// with what the moments before have left that were drawn or followed.
    Heat,
}

/// What is drawn.
#[derive(Clone, Debug, Default)]
pub struct Moment {
    /// Seconds simulated.
    pub time: f64,
    /// `world_from_body`.
    pub poses: BTreeMap<BodyId, Pose>,
    /// What was found of pairs that meet or nearly do, by ascending ids.
    pub pairs: Vec<MeetingPair>,
}

/// Two bodies that meet or nearly do.
#[derive(Clone, Debug, PartialEq)]
pub struct MeetingPair {
    /// The answer's A.
    pub a: BodyId,
    /// Its B.
    pub b: BodyId,
    /// World coordinates; contacts at least, regions where they are known.
    pub answer: Answer,
    /// What they gave each other along their normals in the step; 0 where nobody says.
    pub impulse: f64,
    /// Whether one of them is a sensor: it overlaps by design, and no close-up looks at it.
    pub sensed: bool,
}

/// Draws moments of a scene.
pub struct ScenePainter {
    title: String,
    coats: Coats,
    cameras: Vec<NamedCamera>,
    ground: Ground,
    quality: PictureQuality,
    /// Why moments hold no contacts that can be drawn, if so.
    without_contacts: Option<&'static str>,
    /// Stationary bodies that have hidden moving ones: they stay faded, so that nothing flickers.
    faded: BTreeSet<BodyId>,
    /// What the last close-up showed.
    focus: Option<Focus>,
    trails: Trails,
    /// The greatest so far: arrows and colours keep their scale.
    impulse_max: f64,
    depth_max: f64,
}

/// Whether moments hold what an effect finds.
fn makes_contacts(effect: &Effect) -> bool {
    matches!(effect, Effect::Contacts { .. } | Effect::Response)
}

/// Why a picture of bodies that touch shows no contact.
const UNCOMPUTED: &str = "contacts are not computed: no effect needs them";

/// The same of a recording.
const UNRECORDED: &str = "contacts are not recorded";

impl ScenePainter {
    /// Draws moments of a recording without contacts: pictures say so, instead of that nothing is
    /// near.
    #[must_use]
    pub fn without_recorded_contacts(self) -> Self {
        Self { without_contacts: Some(UNRECORDED), ..self }
    }

    /// Prepares meshes, and cameras for pictures of `size`.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be drawn, or a camera that cannot see.
    pub fn new(
        scene: &SceneDescription,
        size: ImageSize,
        quality: PictureQuality,
    ) -> Result<Self, SceneAppError> {
        let (coats, instances) = Coats::of_scene(scene)?;
        let room = cameras::room(scene, &instances);
        Ok(Self {
            title: scene.name.clone(),
            coats,
            cameras: cameras::of_scene(scene, &room, size)?,
            ground: cameras::ground(scene, &instances),
            quality,
            without_contacts: (!scene.all_effects().any(makes_contacts)).then_some(UNCOMPUTED),
            faded: BTreeSet::new(),
            focus: None,
            trails: Trails::default(),
            impulse_max: 0.0,
            depth_max: 0.0,
        })
    }

    /// The cameras by name, in the scene's order; never empty.
    #[must_use]
    pub fn cameras(&self) -> &[NamedCamera] {
        &self.cameras
    }

    /// Keeps one camera, by its name or the name of a preset (`isometric`, `front`, `side`, `top`),
    /// fitted as a scene's own.
    ///
    /// # Errors
    ///
    /// [`SceneAppError::Camera`] where there is none of that name, naming those there are.
    pub fn choose_camera(
        &mut self,
        scene: &SceneDescription,
        name: &str,
        size: ImageSize,
    ) -> Result<(), SceneAppError> {
        if let Some(at) = self.cameras.iter().position(|(known, _)| known == name) {
            self.cameras = vec![self.cameras.swap_remove(at)];
            return Ok(());
        }
        let (_, instances) = Coats::of_scene(scene)?;
        let room = cameras::room(scene, &instances);
        self.cameras = vec![cameras::preset(name, &self.cameras, &room, size)?];
        Ok(())
    }

    /// Takes in a body that the scene does not describe, or another geometry of one that it does.
    pub(crate) fn put(&mut self, id: BodyId, record: &BodyRecord) -> Result<(), SceneAppError> {
        self.coats.put(id, record)
    }

    /// Takes in another geometry of a body, as a scene describes it.
    #[cfg(feature = "record")]
    pub(crate) fn put_described(
        &mut self,
        id: BodyId,
        body: &cranny_world::description::BodyDescription,
    ) -> Result<(), SceneAppError> {
        self.coats.put_described(id, body).map(drop)
    }

    /// Draws a body no more.
    pub(crate) fn remove(&mut self, id: BodyId) {
        self.coats.remove(id);
    }

    /// The size for which cameras of a view of this size are fitted.
    ///
    /// # Errors
    ///
    /// A size that no picture can have.
    pub fn camera_size(
        view: ScenePainterView,
        [width, height]: [u32; 2],
    ) -> Result<ImageSize, SceneAppError> {
        let size = match view {
            ScenePainterView::Page => panel_sizes(width, height).map(|[main, ..]| main),
            ScenePainterView::Heat => heat::panel_sizes(width, height).map(|[whole, _]| whole),
            _ => ImageSize::new(width, height).ok(),
        };
        size.ok_or_else(|| SceneAppError::Picture {
            camera: DEFAULT_CAMERA.to_owned(),
            why: format!("a picture of {width} x {height} pixels is too small or too large"),
        })
    }

    /// A moment in a view, by the first camera.
    ///
    /// # Errors
    ///
    /// Where a picture cannot be drawn.
    pub fn draw(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        view: ScenePainterView,
        [width, height]: [u32; 2],
    ) -> Result<Image, SceneAppError> {
        let size = Self::camera_size(view, [width, height])?;
        let (name, camera) = self.cameras[0].clone();
        let failed =
            |error: RenderError| SceneAppError::Picture { camera: name, why: error.to_string() };
        let style = match view {
            ScenePainterView::Page => return self.page(renderer, moment, width, height),
            ScenePainterView::Section => return self.section(renderer, moment, size),
            ScenePainterView::Scene => {
                return self.picture(renderer, moment, &camera, size).map_err(failed);
            }
            ScenePainterView::Heat => return self.heat(renderer, moment, [width, height]),
            ScenePainterView::Motion => {
                self.follow(moment.time, &moment.poses);
                let mut list = self.unmarked(moment, &camera);
                motion::push(&mut list, &self.trails, &self.coats, moment, &camera);
                return self.render(renderer, &list, &camera, size).map_err(failed);
            }
            ScenePainterView::XRay => Style::XRay,
            ScenePainterView::Wireframe => Style::Wireframe,
        };
        self.seen_through(renderer, moment, style, size)
    }

    /// Notes where bodies were, for pictures of their [motion](ScenePainterView::Motion) and of the
    /// [heat](ScenePainterView::Heat) of what follows: moments in the order of time.
    pub fn follow(&mut self, time: f64, poses: &BTreeMap<BodyId, Pose>) {
        self.trails.note(time, poses, &self.coats);
    }

    /// A moment as a camera sees it: bodies, contacts, stationary bodies faded where they hide.
    ///
    /// # Errors
    ///
    /// As [`Renderer::render`].
    pub fn picture(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        camera: &Camera,
        size: ImageSize,
    ) -> Result<Image, RenderError> {
        let list = self.view(moment, camera);
        self.render(renderer, &list, camera, size)
    }

    fn view(&mut self, moment: &Moment, camera: &Camera) -> DrawList {
        self.note_scales(moment);
        let mut list = self.unmarked(moment, camera);
        marks::push_contacts(&mut list, moment, &self.scales(), camera);
        list
    }

    /// Bodies, those faded that hide what moves.
    fn unmarked(&mut self, moment: &Moment, camera: &Camera) -> DrawList {
        let hiding = hiding::of(&self.coats, moment, camera.eye());
        self.faded.extend(hiding);
        let mut list = self.bodies(moment);
        for (id, instance) in self.placed(moment).zip(&mut list.instances) {
            if self.faded.contains(&id) {
                instance.style = Style::XRay;
            }
        }
        list
    }

    /// The greatest impulse and depth so far.
    fn note_scales(&mut self, moment: &Moment) {
        for pair in &moment.pairs {
            self.impulse_max = self.impulse_max.max(pair.impulse);
            self.depth_max = self.depth_max.max(pair.answer.depth());
        }
    }

    fn scales(&self) -> marks::Scales<'_> {
        marks::Scales { impulse: self.impulse_max, depth: self.depth_max, coats: &self.coats }
    }

    /// Those that are drawn, in the order of the list's instances.
    fn placed(&self, moment: &Moment) -> impl Iterator<Item = BodyId> + use<> {
        let drawn = moment.poses.keys().copied().filter(|id| self.coats.get(*id).is_some());
        drawn.collect::<Vec<_>>().into_iter()
    }

    /// All bodies, opaque, cut where the list gets a section.
    fn bodies(&self, moment: &Moment) -> DrawList {
        let shading = match self.quality {
            PictureQuality::Draft => Shading::PLAIN,
            PictureQuality::Normal | PictureQuality::Fine => Shading::FULL,
        };
        let mut list = DrawList { shading, ground: Some(self.ground), ..DrawList::new() };
        for (id, pose) in &moment.poses {
            if let Some(coat) = self.coats.get(*id) {
                let instance = Instance::solid(coat.mesh.clone(), *pose, coat.color);
                list.instances.push(Instance { cut: true, ..instance });
            }
        }
        list
    }

    fn render(
        &self,
        renderer: &mut Renderer,
        list: &DrawList,
        camera: &Camera,
        size: ImageSize,
    ) -> Result<Image, RenderError> {
        let twice = ImageSize::new(2 * size.width(), 2 * size.height());
        match (self.quality, twice) {
            (PictureQuality::Fine, Ok(twice)) => {
                let image = renderer.render(&list.enlarged(2.0), camera, twice)?;
                Ok(image.scaled_down(size.width()))
            }
            _ => renderer.render(list, camera, size),
        }
    }
}
