//! What a scene file may say of a body, as it says it: shape, pose, motion, material, mass.

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::Repair;
use cranny_shapes::Shape;
use cranny_world::description::{
    BodyKind, Interpolation, Material, MotorKeyframe, MotorPath, Normals, PathEnd, PathError,
};
use serde::Deserialize;

use super::effect::{EffectFile, distinct};
use super::primitive::PrimitiveFile;
use super::tracker::TrackerFile;
use super::values::{
    Axis, ColorFile, FaceAngle, Finite, Fraction, Grip, NotNegative, Positive, Rotation, Scale,
    Vector, Weight,
};
use crate::robot::about;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Body")]
pub(super) struct BodyFile {
    pub(super) name: String,
    pub(super) shape: ShapeFile,
    #[serde(default)]
    pub(super) visual: Option<ShapeFile>,
    #[serde(default)]
    pub(super) color: Option<ColorFile>,
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
    #[serde(default, deserialize_with = "distinct")]
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
        /// In which its lengths are, to be converted to metres; else they stay as they are.
        #[serde(default)]
        units: Option<UnitsFile>,
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
    /// What a few numbers say, and not tessellated.
    Primitive(PrimitiveFile),
}

/// In which unit of length a mesh file is.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Units")]
pub(super) enum UnitsFile {
    Metres,
    Centimetres,
    Millimetres,
    Inches,
    Feet,
}

impl UnitsFile {
    /// Metres a unit.
    pub(super) fn metres(self) -> f64 {
        match self {
            Self::Metres => 1.0,
            Self::Centimetres => 0.01,
            Self::Millimetres => 0.001,
            Self::Inches => 0.0254,
            Self::Feet => 0.3048,
        }
    }
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
    Total(Weight),
    /// Of a shell along the surface, at the material's density.
    Shell { thickness: Positive },
    /// Of the convex hull, at the material's density.
    Hull {},
    /// As it stands here: moments about the centre, along the body's axes.
    Stated {
        mass: Weight,
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

/// Positions of a joint at times.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "MotorPath")]
pub(super) struct MotorPathFile {
    keyframes: Vec<MotorKeyframeFile>,
    #[serde(default)]
    interpolation: InterpolationFile,
    #[serde(default)]
    end: PathEndFile,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "MotorKeyframe")]
struct MotorKeyframeFile {
    /// Seconds.
    time: NotNegative,
    position: Finite,
}

impl MotorPathFile {
    pub(super) fn path(&self) -> Result<MotorPath, PathError> {
        let keyframe = |MotorKeyframeFile { time, position }: &MotorKeyframeFile| MotorKeyframe {
            time: time.0,
            position: position.0,
        };
        let keyframes = self.keyframes.iter().map(keyframe).collect();
        MotorPath::new(keyframes, self.interpolation.into(), self.end.into())
    }
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
    density: Weight,
    friction: Grip,
    restitution: Fraction,
}

impl Default for MaterialFile {
    fn default() -> Self {
        let Material { density, friction, restitution } = Material::default();
        Self {
            density: Weight(density),
            friction: Grip(friction),
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
