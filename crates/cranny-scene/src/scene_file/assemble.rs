//! From what a file says to a description: meshes read, names resolved, everything checked that
//! only shows when the whole is known.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_world::description::{
    BodyDescription, BodyKind, CameraDescription, CameraView, Effect, Keyframe, KeyframedPath,
    Material, Normals, SceneDescription, StatedMass, TrackerDescription,
};

use super::body_syntax::{BodyFile, MassFile, PoseFile, ShapeFile};
use super::geometry::CollisionGeometry;
use super::include::{Sheet, Sheets};
use super::pair::NamedPairs;
use super::problem::{SceneError, SceneProblem, located};
use super::syntax::{CameraFile, PresetFile, SceneFile, effects};
use super::{LoadOptions, feedback, layers, locate, mass, place_robot, sensors};
use crate::mesh_file::MeshFormat;

type Assembled = (SceneDescription, Vec<PathBuf>, [Vec<String>; 2]);

/// Makes a description of what files say: included bodies come first, included cameras last.
pub(super) fn assemble(sheets: &Sheets, options: &LoadOptions) -> Result<Assembled, SceneError> {
    let Sheets { own, included } = sheets;
    let mut assembly = Assembly {
        source: own.source(),
        description: described(own, options),
        groups: BTreeMap::new(),
        pairs: NamedPairs::default(),
        robots: BTreeSet::new(),
        piles: 0,
        shapes: Vec::new(),
        drawn: Vec::new(),
        files: included.iter().map(|sheet| sheet.path.clone()).collect(),
        notes: included.iter().filter_map(note_of_included).collect(),
        warnings: Vec::new(),
    };
    let all = || included.iter().chain([own]);
    for sheet in all() {
        assembly.turn_to(sheet);
        assembly.add_standing(&sheet.scene)?;
    }
    // Groups keep clear of what stands there, whichever file says so.
    for sheet in all() {
        assembly.turn_to(sheet);
        assembly.add_groups(&sheet.scene)?;
    }
    for sheet in all() {
        assembly.turn_to(sheet);
        assembly.add_relations(&sheet.scene)?;
    }
    // What is kept from meeting is known before what is wanted of pairs, whichever file says so.
    for sheet in all() {
        assembly.turn_to(sheet);
        let meeting = sheet.scene.pairs.iter().filter(|pair| pair.collide);
        meeting.into_iter().try_for_each(|pair| assembly.pair(pair))?;
    }
    for sheet in [own].into_iter().chain(included) {
        assembly.turn_to(sheet);
        sheet.scene.cameras.iter().try_for_each(|camera| assembly.camera(camera))?;
    }
    if assembly.description.bodies.is_empty() {
        let what = "the scene has no bodies, so nothing happens in it. Add some to `bodies`, `groups` or `robots`, or include a scene that has some";
        assembly.warnings.push(what.to_owned());
    }
    assembly.warnings.extend(sensors::unread(&assembly.description));
    assembly.warnings.extend(feedback::unfelt(&assembly.description));
    assembly.warnings.extend(layers::alone(&assembly.description));
    assembly.description.excluded_pairs.sort_unstable();
    assembly.description.excluded_pairs.dedup();
    Ok((assembly.description, assembly.files, [assembly.notes, assembly.warnings]))
}

/// What holds for the whole scene; bodies and the like are still to come.
fn described(sheet: &Sheet, options: &LoadOptions) -> SceneDescription {
    let scene = &sheet.scene;
    let stem = sheet.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    SceneDescription {
        name: scene.name.clone().unwrap_or(stem),
        gravity: scene.gravity.0,
        step: scene.step.0,
        most_parts: scene.most_parts.map(|most| most.0),
        duration: scene.duration.0,
        seed: options.seed.unwrap_or(scene.seed),
        bodies: Vec::with_capacity(scene.bodies.len()),
        joints: Vec::new(),
        excluded_pairs: Vec::new(),
        effects: effects(&scene.effects),
        accuracy: scene.accuracy.level(),
        budget: scene.budget,
        pairs: Vec::new(),
        cameras: Vec::new(),
        record: scene.record.description(scene.step.0),
    }
}

/// Which values of an included file do not count.
fn note_of_included(sheet: &Sheet) -> Option<String> {
    let fields: Vec<_> = sheet.unheeded().iter().map(|field| format!("`{field}`")).collect();
    let verb = if fields.len() == 1 { "does" } else { "do" };
    (!fields.is_empty()).then(|| {
        format!("{}: included, so its {} {verb} not count", sheet.path.display(), fields.join(", "))
    })
}

/// The text that is being assembled, for places.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) text: &'a str,
    pub(super) path: &'a Path,
}

impl Source<'_> {
    pub(super) fn error(&self, place: Option<Range<usize>>, problem: SceneProblem) -> SceneError {
        located(self.path, self.text, place, problem)
    }

    /// Where `field: "value"` stands first.
    pub(super) fn find(&self, field: &str, value: &str) -> Option<Range<usize>> {
        locate::find(self.text, field, value, 0)
    }

    /// A path of the file, which is relative to it.
    pub(super) fn resolve(&self, relative: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(relative)
    }
}

/// Bodies of a group, or why it has none.
pub(super) type GroupBodies = Result<Vec<usize>, String>;

pub(super) struct Assembly<'a> {
    pub(super) source: Source<'a>,
    pub(super) description: SceneDescription,
    /// By name: piles and grids, and groups of SRDF files as `<robot>/<group>`.
    pub(super) groups: BTreeMap<String, GroupBodies>,
    pub(super) pairs: NamedPairs,
    /// Names of robots so far.
    pub(super) robots: BTreeSet<String>,
    /// Piles so far.
    pub(super) piles: u64,
    /// Geometry made so far: bodies of one shape share it.
    pub(super) shapes: Vec<(ShapeFile, CollisionGeometry)>,
    /// The same of what is drawn.
    pub(super) drawn: Vec<(ShapeFile, Arc<Mesh>)>,
    files: Vec<PathBuf>,
    pub(super) notes: Vec<String>,
    /// One sentence each: what somebody should know before the scene runs.
    pub(super) warnings: Vec<String>,
}

impl<'a> Assembly<'a> {
    /// Whose text is read from now on. Meshes are shared within a folder, to which paths are
    /// relative.
    fn turn_to(&mut self, sheet: &'a Sheet) {
        if self.source.path.parent() != sheet.path.parent() {
            self.shapes.clear();
            self.drawn.clear();
        }
        self.source = sheet.source();
    }
}

impl Assembly<'_> {
    /// Adds the bodies of a file that have places.
    fn add_standing(&mut self, scene: &SceneFile) -> Result<(), SceneError> {
        scene.bodies.iter().try_for_each(|body| self.body(body))?;
        scene.robots.iter().try_for_each(|robot| place_robot::place(self, robot))?;
        self.check_body_names()?;
        self.check_effects_of_primitives()
    }

    /// Adds the bodies of a file that are made by rule.
    fn add_groups(&mut self, scene: &SceneFile) -> Result<(), SceneError> {
        scene.groups.iter().try_for_each(|group| self.group(group))?;
        self.check_body_names()?;
        self.check_effects_of_primitives()
    }

    /// Adds what a file says of bodies that are there.
    fn add_relations(&mut self, scene: &SceneFile) -> Result<(), SceneError> {
        scene.joints.iter().try_for_each(|joint| self.joint(joint))?;
        self.check_joint_names()?;
        scene.pairs.iter().filter(|pair| !pair.collide).try_for_each(|pair| self.keep_apart(pair))
    }

    fn body(&mut self, body: &BodyFile) -> Result<(), SceneError> {
        let kind = BodyKind::from(body.kind);
        let velocity = [body.velocity.linear.0, body.velocity.angular.0];
        if kind == BodyKind::Fixed && velocity != [DVec3::ZERO; 2] {
            let what =
                "it is Fixed but has a velocity. Make it Kinematic, or leave the velocity out";
            return Err(self.contradicted(&body.name, what));
        }
        let geometry = self.geometry(&body.name, &body.shape)?;
        self.check_primitive(&body.name, &geometry, body.normals.into())?;
        let mass = self.mass(&body.name, kind, &geometry, body.mass, body.material.into())?;
        let visual = body.visual.as_ref().map(|visual| self.drawn(&body.name, visual));
        let path = self.path(body, kind)?;
        let tracker = self.tracker(body)?;
        let whose = format!("body {:?}", body.name);
        let pose = path.as_ref().map(|path| path.pose_at(0.0));
        let pose = pose.unwrap_or_else(|| self.pose(&whose, body.pose.unwrap_or_default()));
        let description = BodyDescription {
            name: body.name.clone(),
            collision: geometry.mesh,
            shape: geometry.shape,
            visual: visual.transpose()?,
            color: body.color.map(|color| color.0),
            kind,
            pose,
            linear_velocity: velocity[0],
            angular_velocity: velocity[1],
            path: path.map(Arc::new),
            tracker,
            material: body.material.into(),
            mass,
            normals: body.normals.into(),
            sensor: body.sensor,
            layers: body.layers.clone(),
            effects: effects(&body.effects),
        };
        self.description.bodies.push(description);
        Ok(())
    }

    /// Something is wrong with a body as a whole.
    pub(super) fn contradicted(&self, body: &str, what: impl Display) -> SceneError {
        let problem = SceneProblem::Contradiction(format!("body {body:?}: {what}"));
        self.source.error(self.source.find("name", body), problem)
    }

    /// The path of a body, if it has one.
    fn path(
        &mut self,
        body: &BodyFile,
        kind: BodyKind,
    ) -> Result<Option<KeyframedPath>, SceneError> {
        let Some(path) = &body.path else { return Ok(None) };
        let still = [body.velocity.linear.0, body.velocity.angular.0] == [DVec3::ZERO; 2];
        let wrong = match (kind, &body.pose) {
            (BodyKind::Kinematic, None) if still => None,
            (BodyKind::Kinematic, None) => Some("a velocity. Leave the velocity out"),
            (BodyKind::Kinematic, _) => Some("a pose. Leave the pose out: it starts on its path"),
            _ => Some("is not Kinematic. Make it Kinematic, or leave the path out"),
        };
        if let Some(wrong) = wrong {
            let and = if kind == BodyKind::Kinematic { "and " } else { "but " };
            return Err(self.contradicted(&body.name, format!("it has a path {and}{wrong}")));
        }
        let whose = format!("body {:?}", body.name);
        let keyframes = path.keyframes.iter().map(|keyframe| {
            let (time, pose) = (keyframe.time.0, self.pose(&whose, keyframe.pose));
            Keyframe { time, pose }
        });
        let keyframes = keyframes.collect();
        let path = KeyframedPath::new(keyframes, path.interpolation.into(), path.end.into());
        let path = path.map_err(|why| self.contradicted(&body.name, format!("its path: {why}")));
        path.map(Some)
    }

    /// What measures a body, if something does.
    fn tracker(&self, body: &BodyFile) -> Result<Option<TrackerDescription>, SceneError> {
        let Some(file) = &body.tracker else { return Ok(None) };
        if body.path.is_none() {
            let what = "it has a tracker but no path. Give it the path on which the device sees it, or leave the tracker out";
            return Err(self.contradicted(&body.name, what));
        }
        let tracker = file.description(&body.name, self.description.seed);
        let checked = tracker.check(self.description.step).map(|()| Some(tracker));
        checked.map_err(|why| self.contradicted(&body.name, format!("its tracker: {why}")))
    }

    /// Fails if a primitive is to have what only a mesh has.
    pub(super) fn check_primitive(
        &self,
        body: &str,
        geometry: &CollisionGeometry,
        normals: Normals,
    ) -> Result<(), SceneError> {
        match geometry.primitive() {
            Some(primitive) if normals != Normals::Flat => {
                let what = format!(
                    "a {} has no facets to smooth. Leave its `normals` out",
                    primitive.name()
                );
                Err(self.contradicted(body, what))
            }
            _ => Ok(()),
        }
    }

    /// Fails if an effect of a primitive works on a mesh.
    fn check_effects_of_primitives(&self) -> Result<(), SceneError> {
        for body in &self.description.bodies {
            let Some(primitive) = body.primitive() else { continue };
            let all = body.effects.iter().chain(&self.description.effects);
            let of_meshes = all.filter(|effect| effect.works_on_meshes()).map(Effect::name).next();
            if let Some(effect) = of_meshes {
                let what = format!(
                    "{effect} works on a mesh, but it is a {}. Give it a mesh, or name {effect} for other bodies only",
                    primitive.name()
                );
                return Err(self.contradicted(&body.name, what));
            }
        }
        Ok(())
    }

    /// The mass of a body, where it does not follow from its solid and density.
    pub(super) fn mass(
        &mut self,
        body: &str,
        kind: BodyKind,
        geometry: &CollisionGeometry,
        said: Option<MassFile>,
        material: Material,
    ) -> Result<Option<StatedMass>, SceneError> {
        if kind != BodyKind::Dynamic {
            return match said {
                None => Ok(None),
                Some(_) => {
                    Err(self.contradicted(body, "only a Dynamic body has a mass. Leave `mass` out"))
                }
            };
        }
        let found = mass::of(geometry, said, material.density)
            .map_err(|error| self.contradicted(body, error))?;
        let (mass, why) = found.unzip();
        self.warnings.extend(why.flatten().map(|why| format!("body {body:?}: {why}")));
        Ok(mass)
    }

    /// A pose as it was meant.
    pub(super) fn pose(&mut self, whose: &str, file: PoseFile) -> Pose {
        if let Some(length) = file.length {
            self.warnings.push(format!(
                "{whose}: its rotation is a quaternion of length {length} and counts as of length 1"
            ));
        }
        file.pose
    }

    pub(super) fn add_file(&mut self, path: PathBuf) {
        if !self.files.contains(&path) {
            self.files.push(path);
        }
    }

    fn check_body_names(&self) -> Result<(), SceneError> {
        let mut names = BTreeSet::new();
        for body in &self.description.bodies {
            let name = &body.name;
            let reason = match name.as_str() {
                "" => Some("is empty"),
                "world" => Some("is that of the frame in which all bodies are recorded"),
                _ if name.chars().any(char::is_control) => Some("holds control characters"),
                _ => None,
            };
            if let Some(reason) = reason {
                let problem = SceneProblem::Name { name: name.clone(), reason };
                return Err(self.source.error(self.source.find("name", name), problem));
            }
            if !names.insert(name) {
                return Err(self.duplicate("bodies", name));
            }
        }
        Ok(())
    }

    fn check_joint_names(&self) -> Result<(), SceneError> {
        let mut names = BTreeSet::new();
        let duplicate = self.description.joints.iter().find(|joint| !names.insert(&joint.name));
        duplicate.map_or(Ok(()), |joint| Err(self.duplicate("joints", &joint.name)))
    }

    /// Points at the second place of the name, else at the first.
    pub(super) fn duplicate(&self, kind: &'static str, name: &str) -> SceneError {
        let second = locate::find(self.source.text, "name", name, 1);
        let place = second.or_else(|| self.source.find("name", name));
        self.source.error(place, SceneProblem::DuplicateName { kind, name: name.to_owned() })
    }

    pub(super) fn index_of(&self, field: &str, name: &str) -> Result<usize, SceneError> {
        let bodies = &self.description.bodies;
        bodies.iter().position(|body| body.name == name).ok_or_else(|| {
            /// Enough to see a typing error.
            const NAMED: usize = 8;
            let names: Vec<_> =
                bodies.iter().take(NAMED).map(|body| format!("{:?}", body.name)).collect();
            let known = match bodies.len() {
                0 => "no bodies".to_owned(),
                n if n > NAMED => format!("{} and {} more", names.join(", "), n - NAMED),
                _ => names.join(", "),
            };
            let groups: Vec<_> = self.groups.keys().map(|name| format!("{name:?}")).collect();
            let known = match groups.len() {
                0 => known,
                _ => format!("{known}, and the groups {}", groups.join(", ")),
            };
            let problem = SceneProblem::UnknownBody { name: name.to_owned(), known };
            self.source.error(self.source.find(field, name), problem)
        })
    }

    fn camera(&mut self, camera: &CameraFile) -> Result<(), SceneError> {
        let name = &camera.name;
        let place = || self.source.find("name", name);
        if name.is_empty() || name.chars().any(|c| c == '/' || c.is_whitespace() || c.is_control())
        {
            let reason = "is no topic name: it must have letters, and no blanks or slashes";
            return Err(self
                .source
                .error(place(), SceneProblem::Name { name: name.clone(), reason }));
        }
        if self.description.cameras.iter().any(|other| other.name == *name) {
            return Err(self.duplicate("cameras", name));
        }
        let refuse = |problem: &str| {
            let what = format!("camera {name:?}: {problem}");
            self.source.error(place(), SceneProblem::Contradiction(what))
        };
        let view = match (camera.preset, camera.look_at) {
            (Some(_), Some(_)) => return Err(refuse("it has both a preset and look_at; keep one")),
            (None | Some(PresetFile::Isometric), None) => CameraView::Isometric,
            (Some(PresetFile::Front), None) => CameraView::Front,
            (Some(PresetFile::Side), None) => CameraView::Side,
            (Some(PresetFile::Top), None) => CameraView::Top,
            (None, Some(look)) => {
                let (eye, target) = (look.eye.0, look.target.0);
                if eye == target {
                    return Err(refuse("its eye is its target"));
                }
                if look.field_of_view.0 >= std::f64::consts::PI {
                    return Err(refuse("its field of view must be below pi radians"));
                }
                CameraView::LookAt { eye, target, field_of_view: look.field_of_view.0 }
            }
        };
        self.description.cameras.push(CameraDescription { name: name.clone(), view });
        Ok(())
    }
}

/// Whether a file name's extension is that of a mesh, for messages that guess what was meant.
pub(super) fn is_mesh(path: &Path) -> bool {
    MeshFormat::of_path(path).is_some()
}
