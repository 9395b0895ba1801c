//! What a scene file may say, as it says it; of bodies in `body_syntax`. `reading` reads it.

use std::collections::BTreeMap;

use cranny_exact::DVec3;
use cranny_world::description::{
    Accuracy, BodyColor, BodyKind, Effect, Material, Normals, RecordDescription,
};
use serde::Deserialize;

use super::body_syntax::{
    BodyFile, KindFile, MaterialFile, MotorPathFile, NormalsFile, PoseFile, ShapeFile, all_layers,
};
use super::effect::{EffectFile, distinct};
use super::values::{Axis, ColorFile, Finite, NotNegative, Positive, Vector};

/// A whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Scene")]
pub(super) struct SceneFile {
    #[serde(default, rename = "version")]
    _version: Version,
    #[serde(default)]
    pub(super) name: Option<String>,
    /// Scene files, relative to this one.
    #[serde(default)]
    pub(super) includes: Vec<String>,
    #[serde(default = "earth")]
    pub(super) gravity: Vector,
    #[serde(default = "default_step")]
    pub(super) step: Positive,
    #[serde(default)]
    pub(super) most_parts: Option<AtLeastOne>,
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
    #[serde(default, deserialize_with = "distinct")]
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

/// What a vector is that a scene does not state, by its name; `None`: it has no default of its own.
pub(super) fn default_of_vector(field: &str) -> Option<DVec3> {
    match field {
        "gravity" => Some(earth().0),
        "at" | "linear" | "angular" | "euler_degrees" | "center" | "products" => Some(DVec3::ZERO),
        "scale" => Some(DVec3::ONE),
        "normal" => Some(DVec3::Z),
        _ => None,
    }
}

fn default_step() -> Positive {
    Positive(1.0 / 240.0)
}

fn default_duration() -> NotNegative {
    NotNegative(5.0)
}

/// Bodies made by rule.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Group")]
pub(super) enum GroupFile {
    Pile(PileFile),
    Grid(GridFile),
}

/// What all groups say of their bodies.
pub(super) struct PieceFile<'a> {
    /// How the group is made, as the file says it.
    pub(super) rule: &'static str,
    pub(super) name: &'a str,
    pub(super) shapes: &'a [ShapeFile],
    pub(super) color: Option<BodyColor>,
    pub(super) kind: BodyKind,
    pub(super) material: Material,
    pub(super) normals: Normals,
    pub(super) layers: &'a [String],
    pub(super) effects: &'a [EffectFile],
}

impl PieceFile<'_> {
    /// The name of a body, by number.
    pub(super) fn name_of(&self, number: usize) -> String {
        format!("{}_{number}", self.name)
    }
}

macro_rules! pieces {
    ($group:ident, $rule:literal) => {
        PieceFile {
            rule: $rule,
            name: &$group.name,
            shapes: &$group.shapes,
            color: $group.color.map(|color| color.0),
            kind: $group.kind.into(),
            material: $group.material.into(),
            normals: $group.normals.into(),
            layers: &$group.layers,
            effects: &$group.effects,
        }
    };
}

impl GroupFile {
    pub(super) fn pieces(&self) -> PieceFile<'_> {
        match self {
            Self::Pile(pile) => pieces!(pile, "Pile"),
            Self::Grid(grid) => pieces!(grid, "Grid"),
        }
    }
}

/// Bodies `<name>_0` … in rows, columns and layers, all in one orientation.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Grid")]
pub(super) struct GridFile {
    #[serde(default = "pile_name")]
    pub(super) name: String,
    /// Along x, y and z.
    pub(super) count: [u32; 3],
    /// From body to body.
    pub(super) spacing: Vector,
    /// Of the first one.
    #[serde(default)]
    pub(super) pose: PoseFile,
    pub(super) shapes: Vec<ShapeFile>,
    #[serde(default)]
    pub(super) color: Option<ColorFile>,
    #[serde(default)]
    pub(super) kind: KindFile,
    #[serde(default)]
    pub(super) material: MaterialFile,
    #[serde(default)]
    pub(super) normals: NormalsFile,
    #[serde(default = "all_layers")]
    pub(super) layers: Vec<String>,
    #[serde(default, deserialize_with = "distinct")]
    pub(super) effects: Vec<EffectFile>,
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
    pub(super) color: Option<ColorFile>,
    #[serde(default)]
    pub(super) kind: KindFile,
    #[serde(default)]
    pub(super) material: MaterialFile,
    #[serde(default)]
    pub(super) normals: NormalsFile,
    #[serde(default = "all_layers")]
    pub(super) layers: Vec<String>,
    #[serde(default, deserialize_with = "distinct")]
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
#[derive(Clone, Debug, Deserialize)]
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
    /// Where motors lead single joints over time.
    #[serde(default)]
    pub(super) paths: BTreeMap<String, MotorPathFile>,
    /// Which links may meet each other.
    #[serde(default)]
    pub(super) self_collisions: SelfCollisionsFile,
    /// An SRDF file, relative to the scene file: the pairs that it disables never meet.
    #[serde(default)]
    pub(super) srdf: Option<String>,
    /// A named state of the SRDF file: where joints start that `positions` does not name.
    #[serde(default)]
    pub(super) state: Option<String>,
    /// Its density is for links whose URDF states no mass.
    #[serde(default)]
    pub(super) material: MaterialFile,
    #[serde(default)]
    pub(super) normals: NormalsFile,
    #[serde(default = "all_layers")]
    pub(super) layers: Vec<String>,
    #[serde(default, deserialize_with = "distinct")]
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
    /// Where the motor leads it over time.
    #[serde(default)]
    pub(super) path: Option<MotorPathFile>,
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
    Ball {},
    Rope {
        length: Positive,
    },
    Spring {
        length: NotNegative,
        stiffness: Positive,
        #[serde(default = "undamped")]
        damping: NotNegative,
    },
}

fn undamped() -> NotNegative {
    NotNegative(0.0)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Pair")]
pub(super) struct PairFile {
    pub(super) a: String,
    pub(super) b: String,
    /// Whether the two may meet.
    #[serde(default = "yes")]
    pub(super) collide: bool,
    #[serde(default, deserialize_with = "distinct")]
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
    pub(super) every: Option<AtLeastOne>,
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

/// A whole number from 1.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "u32")]
pub(super) struct AtLeastOne(pub(super) u32);

impl TryFrom<u32> for AtLeastOne {
    type Error = String;

    fn try_from(number: u32) -> Result<Self, String> {
        match number {
            0 => Err("expected a whole number of at least 1, found 0".to_owned()),
            number => Ok(Self(number)),
        }
    }
}

pub(super) fn effects(files: &[EffectFile]) -> Vec<Effect> {
    files.iter().map(|file| file.0).collect()
}
