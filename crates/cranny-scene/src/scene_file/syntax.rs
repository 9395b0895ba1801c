//! What a scene file may say, as it says it. [`parse`] reads it, `locate` gives errors their line
//! and column.

use std::collections::BTreeMap;
use std::path::Path;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Repair;
use cranny_shapes::Shape;
use cranny_world::description::{
    Accuracy, BodyKind, Effect, Interpolation, Material, Normals, PathEnd, RecordDescription,
};
use ron::Error;
use ron::extensions::Extensions;
use serde::Deserialize;

use super::effect::EffectFile;
use super::locate::{byte_at, field_before};
use super::problem::{SceneError, SceneProblem, located};
use super::tracker::TrackerFile;
use super::values::{
    Axis, FaceAngle, Finite, Fraction, NotNegative, Positive, Rotation, Scale, Vector,
};
use crate::robot::about;

/// A whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Scene")]
pub(super) struct SceneFile {
    #[serde(default, rename = "version")]
    _version: Version,
    #[serde(default)]
    pub(super) name: Option<String>,
    #[serde(default = "earth")]
    pub(super) gravity: Vector,
    #[serde(default = "default_step")]
    pub(super) step: Positive,
    #[serde(default = "default_duration")]
    pub(super) duration: NotNegative,
    #[serde(default)]
    pub(super) seed: u64,
    #[serde(default)]
    pub(super) bodies: Vec<BodyFile>,
    #[serde(default)]
    pub(super) groups: Vec<GroupFile>,
    #[serde(default)]
    pub(super) robots: Vec<RobotFile>,
    #[serde(default)]
    pub(super) joints: Vec<JointFile>,
    #[serde(default)]
    pub(super) effects: Vec<EffectFile>,
    #[serde(default)]
    pub(super) accuracy: AccuracyFile,
    #[serde(default)]
    pub(super) budget: Option<u64>,
    #[serde(default)]
    pub(super) pairs: Vec<PairFile>,
    #[serde(default)]
    pub(super) cameras: Vec<CameraFile>,
    #[serde(default)]
    pub(super) record: RecordFile,
}

/// The one version of the format that there is.
#[derive(Debug, Default, Deserialize)]
#[serde(try_from = "u32")]
struct Version;

impl TryFrom<u32> for Version {
    type Error = String;

    fn try_from(version: u32) -> Result<Self, String> {
        if version == 1 {
            Ok(Self)
        } else {
            Err(format!("expected version 1, found version {version}"))
        }
    }
}

fn earth() -> Vector {
    Vector(DVec3::new(0.0, 0.0, -9.81))
}

fn default_step() -> Positive {
    Positive(1.0 / 240.0)
}

fn default_duration() -> NotNegative {
    NotNegative(5.0)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Body")]
pub(super) struct BodyFile {
    pub(super) name: String,
    pub(super) shape: ShapeFile,
    #[serde(default)]
    pub(super) visual: Option<ShapeFile>,
    #[serde(default)]
    pub(super) kind: KindFile,
    #[serde(default)]
    pub(super) pose: Option<PoseFile>,
    #[serde(default)]
    pub(super) velocity: VelocityFile,
    /// Where a kinematic body goes, in place of pose and velocity.
    #[serde(default)]
    pub(super) path: Option<PathFile>,
    /// What measures it on its path.
    #[serde(default)]
    pub(super) tracker: Option<TrackerFile>,
    #[serde(default)]
    pub(super) material: MaterialFile,
    #[serde(default)]
    pub(super) mass: Option<MassFile>,
    #[serde(default)]
    pub(super) normals: NormalsFile,
    /// Whether it is noticed and never pushes.
    #[serde(default)]
    pub(super) sensor: bool,
    #[serde(default = "all_layers")]
    pub(super) layers: Vec<String>,
    #[serde(default)]
    pub(super) effects: Vec<EffectFile>,
}

pub(super) fn all_layers() -> Vec<String> {
    vec!["all".to_owned()]
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Shape")]
pub(super) enum ShapeFile {
    /// Relative to the scene file; factors along the axes, negative ones mirror.
    Mesh {
        path: String,
        #[serde(default = "unscaled")]
        scale: Scale,
        /// Whether the middle of its box, after scaling, is moved to the body's origin.
        #[serde(default)]
        recenter: bool,
        /// What of it may be mended.
        #[serde(default)]
        repair: RepairFile,
    },
    Generator(Shape),
}

/// What of a mesh may be mended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "Repair")]
pub(super) enum RepairFile {
    None,
    #[default]
    Safe,
    Full,
}

impl From<RepairFile> for Repair {
    fn from(file: RepairFile) -> Self {
        match file {
            RepairFile::None => Self::None,
            RepairFile::Safe => Self::Safe,
            RepairFile::Full => Self::Full,
        }
    }
}

/// Where a body's mass comes from, if not from its solid and density.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Mass")]
pub(super) enum MassFile {
    /// So much, spread over the solid, or over the surface where that is open.
    Total(Positive),
    /// Of a shell along the surface, at the material's density.
    Shell { thickness: Positive },
    /// Of the convex hull, at the material's density.
    Hull {},
    /// As it stands here: moments about the centre, along the body's axes.
    Stated {
        mass: Positive,
        #[serde(default)]
        center: Option<Vector>,
        inertia: MomentsFile,
        #[serde(default)]
        products: Option<Vector>,
    },
}

/// Moments xx, yy, zz, all above 0.
pub(super) type MomentsFile = [Positive; 3];

fn unscaled() -> Scale {
    Scale(DVec3::ONE)
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename = "Kind")]
pub(super) enum KindFile {
    Fixed,
    Kinematic,
    #[default]
    Dynamic,
}

impl From<KindFile> for BodyKind {
    fn from(kind: KindFile) -> Self {
        match kind {
            KindFile::Fixed => Self::Fixed,
            KindFile::Kinematic => Self::Kinematic,
            KindFile::Dynamic => Self::Dynamic,
        }
    }
}

/// A place and an orientation, the latter written in one of three ways.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "PoseParts")]
pub(super) struct PoseFile {
    pub(super) pose: Pose,
    /// The length of its quaternion, where that was normalised.
    pub(super) length: Option<f64>,
}

impl Default for PoseFile {
    fn default() -> Self {
        Self { pose: Pose::IDENTITY, length: None }
    }
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Pose")]
struct PoseParts {
    at: Option<Vector>,
    /// A quaternion.
    rotation: Option<Rotation>,
    /// About the fixed axes x, then y, then z.
    euler_degrees: Option<Vector>,
    turn: Option<TurnFile>,
}

/// A rotation about an axis.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Turn")]
struct TurnFile {
    axis: Axis,
    degrees: Finite,
}

impl TryFrom<PoseParts> for PoseFile {
    type Error = &'static str;

    fn try_from(parts: PoseParts) -> Result<Self, Self::Error> {
        let PoseParts { at, rotation, euler_degrees, turn } = parts;
        let ways = [rotation.is_some(), euler_degrees.is_some(), turn.is_some()];
        if ways.into_iter().filter(|given| *given).count() > 1 {
            return Err("a pose has one of `rotation`, `euler_degrees` and `turn`; keep one");
        }
        let of_euler = euler_degrees.map(|Vector(degrees)| {
            let [x, y, z] = degrees.to_array().map(f64::to_radians);
            about(DVec3::Z, z) * about(DVec3::Y, y) * about(DVec3::X, x)
        });
        let of_turn = turn.map(|TurnFile { axis, degrees }| about(axis.0, degrees.0.to_radians()));
        let unit = rotation.map(|rotation| rotation.unit).or(of_euler).or(of_turn);
        let rotation_of_pose = unit.unwrap_or(DQuat::IDENTITY);
        let translation = at.map_or(DVec3::ZERO, |at| at.0);
        let pose = Pose { rotation: rotation_of_pose, translation };
        Ok(Self { pose, length: rotation.and_then(|rotation| rotation.length) })
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Velocity")]
pub(super) struct VelocityFile {
    pub(super) linear: Vector,
    pub(super) angular: Vector,
}

impl Default for VelocityFile {
    fn default() -> Self {
        Self { linear: Vector(DVec3::ZERO), angular: Vector(DVec3::ZERO) }
    }
}

/// Poses at times.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Path")]
pub(super) struct PathFile {
    pub(super) keyframes: Vec<KeyframeFile>,
    #[serde(default)]
    pub(super) interpolation: InterpolationFile,
    #[serde(default)]
    pub(super) end: PathEndFile,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Keyframe")]
pub(super) struct KeyframeFile {
    /// Seconds.
    pub(super) time: NotNegative,
    #[serde(default)]
    pub(super) pose: PoseFile,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename = "Interpolation")]
pub(super) enum InterpolationFile {
    #[default]
    Linear,
    Eased,
}

impl From<InterpolationFile> for Interpolation {
    fn from(interpolation: InterpolationFile) -> Self {
        match interpolation {
            InterpolationFile::Linear => Self::Linear,
            InterpolationFile::Eased => Self::Eased,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename = "PathEnd")]
pub(super) enum PathEndFile {
    #[default]
    Hold,
    Loop,
}

impl From<PathEndFile> for PathEnd {
    fn from(end: PathEndFile) -> Self {
        match end {
            PathEndFile::Hold => Self::Hold,
            PathEndFile::Loop => Self::Loop,
        }
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Material")]
pub(super) struct MaterialFile {
    density: Positive,
    friction: NotNegative,
    restitution: Fraction,
}

impl Default for MaterialFile {
    fn default() -> Self {
        let Material { density, friction, restitution } = Material::default();
        Self {
            density: Positive(density),
            friction: NotNegative(friction),
            restitution: Fraction(restitution),
        }
    }
}

impl MaterialFile {
    pub(super) fn density(&self) -> f64 {
        self.density.0
    }
}

impl From<MaterialFile> for Material {
    fn from(material: MaterialFile) -> Self {
        Self {
            density: material.density.0,
            friction: material.friction.0,
            restitution: material.restitution.0,
        }
    }
}

/// Whose normals a body's contacts have for a solver.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename = "Normals")]
pub(super) enum NormalsFile {
    #[default]
    Flat,
    Smooth {
        /// Radians.
        crease_angle: FaceAngle,
    },
}

impl From<NormalsFile> for Normals {
    fn from(normals: NormalsFile) -> Self {
        match normals {
            NormalsFile::Flat => Self::Flat,
            NormalsFile::Smooth { crease_angle } => Self::Smooth { crease_angle: crease_angle.0 },
        }
    }
}

/// Bodies made by rule.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Group")]
pub(super) enum GroupFile {
    Pile(PileFile),
}

/// Bodies `<name>_0` … in a region, apart from each other, in random order and orientation.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Pile")]
pub(super) struct PileFile {
    #[serde(default = "pile_name")]
    pub(super) name: String,
    pub(super) count: u32,
    /// Instead of the scene's.
    #[serde(default)]
    pub(super) seed: Option<u64>,
    pub(super) region: RegionFile,
    /// Least distance between bounding spheres, as a fraction of the largest one's diameter.
    #[serde(default = "pile_gap")]
    pub(super) gap: NotNegative,
    pub(super) shapes: Vec<ShapeFile>,
    #[serde(default)]
    pub(super) kind: KindFile,
    #[serde(default)]
    pub(super) material: MaterialFile,
    #[serde(default)]
    pub(super) normals: NormalsFile,
    #[serde(default = "all_layers")]
    pub(super) layers: Vec<String>,
    #[serde(default)]
    pub(super) effects: Vec<EffectFile>,
}

fn pile_name() -> String {
    "piece".to_owned()
}

fn pile_gap() -> NotNegative {
    NotNegative(0.02)
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Region")]
pub(super) struct RegionFile {
    pub(super) min: Vector,
    pub(super) max: Vector,
}

/// A robot: bodies `<name>/<link>`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Robot")]
pub(super) struct RobotFile {
    /// Of a URDF file, relative to the scene file.
    pub(super) path: String,
    /// Default: the URDF's own.
    #[serde(default)]
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) pose: PoseFile,
    #[serde(default = "yes")]
    pub(super) fixed_base: bool,
    /// Radians or metres by joint name; 0 for the others.
    #[serde(default)]
    pub(super) positions: BTreeMap<String, Finite>,
    /// Where motors hold the joints; default: where they start.
    #[serde(default)]
    pub(super) targets: BTreeMap<String, Finite>,
    /// Whether motors hold the joints not named in `targets` or `motors`.
    #[serde(default = "yes")]
    pub(super) hold: bool,
    /// What drives single joints.
    #[serde(default)]
    pub(super) motors: BTreeMap<String, MotorFile>,
    /// Which links may meet each other.
    #[serde(default)]
    pub(super) self_collisions: SelfCollisionsFile,
    /// An SRDF file, relative to the scene file: the pairs that it disables never meet.
    #[serde(default)]
    pub(super) srdf: Option<String>,
    /// Its density is for links whose URDF states no mass.
    #[serde(default)]
    pub(super) material: MaterialFile,
    #[serde(default)]
    pub(super) normals: NormalsFile,
    #[serde(default = "all_layers")]
    pub(super) layers: Vec<String>,
    #[serde(default)]
    pub(super) effects: Vec<EffectFile>,
}

fn yes() -> bool {
    true
}

/// Which links of a robot may meet each other. Those that fixed joints hold together never do.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename = "SelfCollisions")]
pub(super) enum SelfCollisionsFile {
    /// All that no joint joins and that are apart where the robot starts.
    #[default]
    Apart,
    /// All that no joint joins.
    Adjacent,
    /// All.
    All,
    /// None.
    None,
}

/// stiffness * (position - q) + damping * (velocity - q') + effort, at most max_effort.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Motor")]
pub(super) struct MotorFile {
    pub(super) position: Option<Finite>,
    pub(super) velocity: Finite,
    pub(super) effort: Finite,
    pub(super) stiffness: Option<NotNegative>,
    pub(super) damping: Option<NotNegative>,
    pub(super) max_effort: Option<NotNegative>,
    pub(super) max_velocity: Option<Positive>,
}

impl Default for MotorFile {
    fn default() -> Self {
        Self {
            position: None,
            velocity: Finite(0.0),
            effort: Finite(0.0),
            stiffness: None,
            damping: None,
            max_effort: None,
            max_velocity: None,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Joint")]
pub(super) struct JointFile {
    pub(super) name: String,
    pub(super) parent: String,
    pub(super) child: String,
    #[serde(default)]
    pub(super) parent_anchor: PoseFile,
    #[serde(default)]
    pub(super) child_anchor: PoseFile,
    pub(super) kind: JointKindFile,
    #[serde(default)]
    pub(super) target: Option<Finite>,
    #[serde(default)]
    pub(super) motor: Option<MotorFile>,
    /// Whether the two bodies may meet.
    #[serde(default)]
    pub(super) collide: bool,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "JointKind")]
pub(super) enum JointKindFile {
    Fixed {},
    Revolute {
        axis: Axis,
        #[serde(default)]
        limits: Option<[Finite; 2]>,
    },
    Prismatic {
        axis: Axis,
        #[serde(default)]
        limits: Option<[Finite; 2]>,
    },
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Pair")]
pub(super) struct PairFile {
    pub(super) a: String,
    pub(super) b: String,
    /// Whether the two may meet.
    #[serde(default = "yes")]
    pub(super) collide: bool,
    #[serde(default)]
    pub(super) effects: Vec<EffectFile>,
    #[serde(default)]
    pub(super) accuracy: Option<AccuracyFile>,
}

/// How exactly triggers and distances are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename = "Accuracy")]
pub(super) enum AccuracyFile {
    Boxes,
    Hulls,
    Caps,
    Tree(u8),
    #[default]
    Exact,
}

impl AccuracyFile {
    pub(super) fn level(self) -> Accuracy {
        match self {
            Self::Boxes => Accuracy::Boxes,
            Self::Hulls => Accuracy::Hulls,
            Self::Caps => Accuracy::Caps,
            Self::Tree(depth) => Accuracy::Tree(depth),
            Self::Exact => Accuracy::Exact,
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Camera")]
pub(super) struct CameraFile {
    pub(super) name: String,
    #[serde(default)]
    pub(super) preset: Option<PresetFile>,
    #[serde(default)]
    pub(super) look_at: Option<LookAtFile>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename = "Preset")]
pub(super) enum PresetFile {
    Isometric,
    Front,
    Side,
    Top,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "LookAt")]
pub(super) struct LookAtFile {
    pub(super) eye: Vector,
    pub(super) target: Vector,
    /// Vertical, radians.
    #[serde(default = "field_of_view")]
    pub(super) field_of_view: Positive,
}

fn field_of_view() -> Positive {
    Positive(0.8)
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Record")]
pub(super) struct RecordFile {
    /// `None`: as many as make [`FRAMES_PER_SECOND`].
    pub(super) every: Option<Every>,
}

/// Frames a second of a scene that does not say how many steps apart they are: what screens show.
const FRAMES_PER_SECOND: f64 = 60.0;

impl RecordFile {
    /// For steps of so many seconds.
    pub(super) fn description(self, step: f64) -> RecordDescription {
        let by_rate = (1.0 / (FRAMES_PER_SECOND * step)).round().max(1.0) as u32;
        RecordDescription { every: self.every.map_or(by_rate, |every| every.0) }
    }
}

/// At least 1.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "u32")]
pub(super) struct Every(pub(super) u32);

impl TryFrom<u32> for Every {
    type Error = String;

    fn try_from(every: u32) -> Result<Self, String> {
        if every == 0 {
            Err("expected a number of steps of at least 1, found 0".to_owned())
        } else {
            Ok(Self(every))
        }
    }
}

pub(super) fn effects(files: &[EffectFile]) -> Vec<Effect> {
    files.iter().map(|file| file.0).collect()
}

/// Reads the text as RON. Errors of the `ron` crate have line and column; [`located`] reports them.
pub(super) fn parse(text: &str, path: &Path) -> Result<SceneFile, SceneError> {
    let extensions = Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME;
    let options = ron::Options::default().with_default_extension(extensions);
    options.from_str(text).map_err(|error| {
        let start = byte_at(text, error.span.start.line, error.span.start.col);
        let end = byte_at(text, error.span.end.line, error.span.end.col);
        // What the reader says of a value does not name its field.
        let field = field_before(text, start).filter(|_| matches!(error.code, Error::Message(_)));
        let said = field.map_or(String::new(), |field| format!("`{field}`: "));
        let problem = SceneProblem::Syntax(said + &error.code.to_string());
        located(path, text, Some(start..end.max(start)), problem)
    })
}
