//! Neutral descriptions of scenes: what a scene file or a program says, before anything runs.
//!
//! Lengths are in the scene's unit, times in seconds, angles in radians, masses density x volume.

pub use cranny_estimate::Accuracy;
use cranny_exact::{DMat3, DVec3, Pose};
use cranny_geometry::Mesh;
pub use cranny_narrow_phase::Normals;
use cranny_primitives::{BodyShape, Primitive};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

mod keyframes;
mod motor_path;
mod path;
mod tracker;

pub use motor_path::{MotorKeyframe, MotorPath};
pub use path::{Interpolation, Keyframe, KeyframedPath, PathEnd, PathError};
pub use tracker::{OneEuro, SimulatedDevice, TrackerDescription, TrackerError, TrackerSettings};

/// A whole scene.
#[derive(Clone, Debug)]
pub struct SceneDescription {
    /// Title, usually the file's stem.
    pub name: String,
    /// Acceleration of every dynamic body.
    pub gravity: DVec3,
    /// Duration of a step, seconds, > 0.
    pub step: f64,
    /// Simulated seconds, >= 0.
    pub duration: f64,
    /// For generated worlds and anything random.
    pub seed: u64,
    /// In file order; the position is the body's stable id.
    pub bodies: Vec<BodyDescription>,
    /// Joints between bodies.
    pub joints: Vec<JointDescription>,
    /// Pairs of bodies (indices into [`bodies`](Self::bodies), the smaller first) that never meet:
    /// links joined by a joint overlap by design.
    pub excluded_pairs: Vec<(usize, usize)>,
    /// Effects that hold for all bodies.
    pub effects: Vec<Effect>,
    /// Level of the effects that state none, where their pair states none either.
    pub accuracy: Accuracy,
    /// Elementary tests a step that triggers and distances may take, shared over their pairs;
    /// `None`: as many as they need.
    pub budget: Option<u64>,
    /// Effects of single pairs.
    pub pairs: Vec<PairDescription>,
    /// Cameras for rendering.
    pub cameras: Vec<CameraDescription>,
    /// What a recording holds.
    pub record: RecordDescription,
}

impl SceneDescription {
    /// Effects that are named anywhere: for all bodies, for single ones, for pairs; in that order.
    pub fn all_effects(&self) -> impl Iterator<Item = &Effect> {
        let of_bodies = self.bodies.iter().flat_map(|body| &body.effects);
        let of_pairs = self.pairs.iter().flat_map(|pair| &pair.effects);
        self.effects.iter().chain(of_bodies).chain(of_pairs)
    }

    /// One level for all triggers and distances, in place of all levels that the scene states.
    pub fn set_accuracy(&mut self, accuracy: Accuracy) {
        let of_bodies = self.bodies.iter_mut().flat_map(|body| &mut body.effects);
        let of_pairs = self.pairs.iter_mut().flat_map(|pair| &mut pair.effects);
        let all = self.effects.iter_mut().chain(of_bodies).chain(of_pairs);
        all.for_each(|effect| *effect = effect.stating(None));
        self.pairs.iter_mut().for_each(|pair| pair.accuracy = None);
        self.accuracy = accuracy;
    }

    /// The levels that the scene's effects may have, the coarsest first: of triggers and distances
    /// as stated, `Exact` where another effect is named or none at all.
    #[must_use]
    pub fn levels(&self) -> Vec<Accuracy> {
        let stated = self.all_effects().map(|effect| effect.level(self.accuracy));
        let of_pairs = self.pairs.iter().filter_map(|pair| pair.accuracy);
        let levels: BTreeSet<Accuracy> = stated.chain(of_pairs).collect();
        if levels.is_empty() { vec![Accuracy::Exact] } else { levels.into_iter().collect() }
    }
}

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BodyKind {
    /// Never moves.
    Fixed,
    /// Moves by its velocity or along its path, pushed by nothing.
    Kinematic,
    /// Moves as physics says.
    Dynamic,
}

/// One body.
#[derive(Clone, Debug)]
pub struct BodyDescription {
    /// Unique; the frame id of recordings.
    pub name: String,
    /// Collision geometry in the body's frame, shared between bodies that use the same file.
    pub collision: Arc<Mesh>,
    /// What collides, where it is prepared already: a model of `collision`, or a primitive, for
    /// which `collision` stands in pictures only.
    pub shape: Option<BodyShape>,
    /// Geometry to draw where it differs.
    pub visual: Option<Arc<Mesh>>,
    /// Colour to draw it in; `None`: one that differs from its neighbours'.
    pub color: Option<BodyColor>,
    /// How it moves.
    pub kind: BodyKind,
    /// Where it starts.
    pub pose: Pose,
    /// Metres (units) a second.
    pub linear_velocity: DVec3,
    /// Radians a second.
    pub angular_velocity: DVec3,
    /// Where it goes, in place of its velocities. Kinematic bodies only; `pose` is the path's at
    /// time 0.
    pub path: Option<Arc<KeyframedPath>>,
    /// What measures it on its path, if it goes where a device sees it instead of where it is. It
    /// needs `Tracking`.
    pub tracker: Option<TrackerDescription>,
    /// What it is made of.
    pub material: Material,
    /// Its mass, where it does not follow from the material's density and the solid.
    pub mass: Option<StatedMass>,
    /// Whose normals its contacts have for a solver: its facets' or those of the curved surface
    /// that they stand for.
    pub normals: Normals,
    /// Whether it is noticed and never pushes.
    pub sensor: bool,
    /// Bodies meet only where they share a layer.
    pub layers: Vec<String>,
    /// Effects of this body beyond the scene's.
    pub effects: Vec<Effect>,
}

impl BodyDescription {
    /// The primitive that it is, if it is one.
    #[must_use]
    pub fn primitive(&self) -> Option<&Primitive> {
        self.shape.as_ref().and_then(BodyShape::primitive)
    }
}

/// A colour in sRGB: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BodyColor(pub [u8; 3]);

impl BodyColor {
    /// Of channels from 0 to 1; `None` where one is outside.
    #[must_use]
    pub fn of_shares(channels: [f64; 3]) -> Option<Self> {
        let known = channels.iter().all(|channel| (0.0..=1.0).contains(channel));
        known.then(|| Self(channels.map(|channel| (255.0 * channel).round() as u8)))
    }

    /// Channels from 0 to 1.
    #[must_use]
    pub fn shares(self) -> [f64; 3] {
        self.0.map(|channel| f64::from(channel) / 255.0)
    }
}

/// Mass, centre and inertia as somebody states them, whatever the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatedMass {
    /// Greater than 0.
    pub mass: f64,
    /// Centre of mass in the body's frame.
    pub center: DVec3,
    /// About the centre, along the axes of the body's frame: symmetric, positive definite.
    pub inertia: DMat3,
}

/// Physical constants of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Mass per volume.
    pub density: f64,
    /// Coulomb coefficient.
    pub friction: f64,
    /// 0: no bounce; 1: full bounce.
    pub restitution: f64,
}

impl Default for Material {
    fn default() -> Self {
        Self { density: 1.0, friction: 0.5, restitution: 0.0 }
    }
}

/// What a scene names; nothing else is computed, allocated or scheduled.
///
/// To add an effect, begin with a variant here and go on by CONTRIBUTING.md, 'An effect': it lists
/// every place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Effect {
    /// Overlap began and ended: yes or no.
    Trigger {
        /// How exactly that is known; `None`: at the level of the pair, or else of the scene.
        accuracy: Option<Accuracy>,
    },
    /// Distance and nearest points of pairs whose surfaces are nearer than `within`; what is
    /// farther apart costs the broad phase only.
    Proximity {
        /// Distance up to which pairs are reported, > 0.
        within: f64,
        /// How exactly it is known; `None`: at the level of the pair, or else of the scene.
        accuracy: Option<Accuracy>,
    },
    /// Contact points, curves and regions up to `margin` apart: as much of it as somebody reads
    /// ([`ContactFields`](crate::ContactFields)).
    Contacts {
        /// Separation up to which near contacts are reported, >= 0.
        margin: f64,
    },
    /// Rigid bodies through rapier.
    Response,
    /// A body passes through no other one, nor any through it, however fast. It needs `Response`.
    Continuous,
    /// How deep bodies overlap, and a way out, for whoever has no solver.
    Penetration,
    /// What is to be heard: impacts, sliding, rolling. It needs `Response`.
    Sound {
        /// Speed above which a collision, sliding or rolling is heard, > 0, units of length a
        /// second.
        above: f64,
    },
    /// Dents that stay where bodies are hit. It needs `Response`.
    Deformation {
        /// Energy that it takes to displace a unit of volume, > 0: the pressure at which the
        /// material yields.
        hardness: f64,
        /// How far from where it is hit a body yields, > 0.
        radius: f64,
    },
    /// Force and torque on kinematic bodies that somebody moves, at 1 kHz.
    ForceFeedback {
        /// Force a unit of length by which a body is moved into another one, > 0.
        stiffness: f64,
    },
    /// What [`Trigger`](Self::Trigger) says of pairs whose poses are known to a tolerance only: it
    /// begins and ends where that is certain. It needs `Trigger`.
    Tracking {
        /// By how much poses misplace a point of a body at most, > 0, units of length.
        tolerance: f64,
    },
}

impl Effect {
    /// `Trigger` that states no level.
    pub const TRIGGER: Self = Self::Trigger { accuracy: None };

    /// `Proximity` up to a distance, that states no level.
    #[must_use]
    pub const fn proximity(within: f64) -> Self {
        Self::Proximity { within, accuracy: None }
    }

    /// Whether it can be known at a level or within a budget: others need exact contacts.
    #[must_use]
    pub fn has_levels(&self) -> bool {
        matches!(self, Self::Trigger { .. } | Self::Proximity { .. })
    }

    /// Whether it works on the meshes of bodies, so that a primitive has no part in it.
    #[must_use]
    pub fn works_on_meshes(&self) -> bool {
        matches!(self, Self::Deformation { .. } | Self::ForceFeedback { .. })
    }

    /// Whether it works on what a solver does, which has no part in the pairs of sensors.
    #[must_use]
    pub fn pushes(&self) -> bool {
        match self {
            Self::Response
            | Self::Continuous
            | Self::Sound { .. }
            | Self::Deformation { .. }
            | Self::ForceFeedback { .. } => true,
            Self::Trigger { .. }
            | Self::Proximity { .. }
            | Self::Contacts { .. }
            | Self::Penetration
            | Self::Tracking { .. } => false,
        }
    }

    /// The level that it states; `None` where it states none.
    #[must_use]
    pub fn stated_level(&self) -> Option<Accuracy> {
        match *self {
            Self::Trigger { accuracy } | Self::Proximity { accuracy, .. } => accuracy,
            _ => None,
        }
    }

    /// The level at which a pair with it is known: the one that it states or else this one, or
    /// `Exact` for what needs contacts.
    #[must_use]
    pub fn level(&self, unstated: Accuracy) -> Accuracy {
        match self.has_levels() {
            true => self.stated_level().unwrap_or(unstated),
            false => Accuracy::Exact,
        }
    }

    /// The same effect, stating another level; unchanged where levels mean nothing.
    #[must_use]
    pub fn stating(self, accuracy: Option<Accuracy>) -> Self {
        match self {
            Self::Trigger { .. } => Self::Trigger { accuracy },
            Self::Proximity { within, .. } => Self::Proximity { within, accuracy },
            other => other,
        }
    }

    /// Its name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Trigger { .. } => "Trigger",
            Self::Proximity { .. } => "Proximity",
            Self::Contacts { .. } => "Contacts",
            Self::Response => "Response",
            Self::Continuous => "Continuous",
            Self::Penetration => "Penetration",
            Self::Sound { .. } => "Sound",
            Self::Deformation { .. } => "Deformation",
            Self::ForceFeedback { .. } => "ForceFeedback",
            Self::Tracking { .. } => "Tracking",
        }
    }
}

/// Effects of one pair of bodies.
#[derive(Clone, Debug)]
pub struct PairDescription {
    /// Name of a body.
    pub a: String,
    /// Name of another.
    pub b: String,
    /// What holds for the pair beyond the scene's and the bodies' effects.
    pub effects: Vec<Effect>,
    /// Level of the effects that state none; `None`: the scene's.
    pub accuracy: Option<Accuracy>,
}

/// A joint between two bodies.
#[derive(Clone, Debug)]
pub struct JointDescription {
    /// Unique.
    pub name: String,
    /// Index into [`SceneDescription::bodies`].
    pub parent: usize,
    /// Index into [`SceneDescription::bodies`].
    pub child: usize,
    /// `parent_from_joint`.
    pub parent_anchor: Pose,
    /// `child_from_joint`.
    pub child_anchor: Pose,
    /// Which motions are free.
    pub kind: JointKind,
    /// Motion of the joint in step with another: position = multiplier * other + offset.
    pub mimic: Option<Mimic>,
    /// What drives it, if anything does.
    pub motor: Option<Motor>,
    /// Where the motor leads it over time, in place of the motor's position and velocity.
    pub path: Option<Arc<MotorPath>>,
    /// What resists its motion.
    pub resistance: Resistance,
    /// Whether its position is a coordinate of a tree of bodies, so that it does not yield, rather
    /// than a constraint between two bodies. A robot's joints are.
    pub reduced: bool,
    /// Position of the joint at the poses of its bodies.
    pub start: f64,
}

/// What drives a joint: `stiffness * (position - q) + damping * (velocity - q') + effort`, at most
/// `max_effort` in either direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motor {
    /// Position (radians or units) that is held, if one is.
    pub position: Option<f64>,
    /// Velocity that is aimed at.
    pub velocity: f64,
    /// Force or torque that is there whatever the joint does.
    pub effort: f64,
    /// Per radian or unit of distance; `None`: as stiff as the solver resolves.
    pub stiffness: Option<f64>,
    /// Per unit of velocity; `None`: critical for the stiffness.
    pub damping: Option<f64>,
    /// Greatest force or torque; `None`: unbounded.
    pub max_effort: Option<f64>,
    /// Greatest velocity with which the position is approached; `None`: the solver's default.
    pub max_velocity: Option<f64>,
}

impl Motor {
    /// Holds a position.
    #[must_use]
    pub fn at(position: f64) -> Self {
        Self { position: Some(position), ..Self::default() }
    }
}

/// What resists the motion of a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resistance {
    /// Force or torque per velocity, against it, >= 0.
    pub damping: f64,
    /// Greatest force or torque of dry friction, >= 0.
    pub friction: f64,
}

/// Which motions a joint leaves free; axes are unit vectors in the joint's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// None.
    Fixed,
    /// Rotation about an axis, within limits (radians).
    Revolute {
        /// Unit axis.
        axis: DVec3,
        /// Least and greatest angle; `None`: unbounded.
        limits: Option<[f64; 2]>,
    },
    /// Translation along an axis, within limits.
    Prismatic {
        /// Unit axis.
        axis: DVec3,
        /// Least and greatest position; `None`: unbounded.
        limits: Option<[f64; 2]>,
    },
    /// Translation in a plane, and rotation about its normal.
    Planar {
        /// Unit normal.
        normal: DVec3,
    },
    /// Rotation about a point.
    Ball,
    /// All, as long as the anchors are no farther apart than this.
    Rope {
        /// Greatest distance of the anchors, > 0.
        length: f64,
    },
    /// All; a force along the line between the anchors.
    Spring(Spring),
    /// All: its bodies are not joined.
    Floating,
}

impl JointKind {
    /// Its name in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Fixed => "Fixed",
            Self::Revolute { .. } => "Revolute",
            Self::Prismatic { .. } => "Prismatic",
            Self::Planar { .. } => "Planar",
            Self::Ball => "Ball",
            Self::Rope { .. } => "Rope",
            Self::Spring(_) => "Spring",
            Self::Floating => "Floating",
        }
    }

    /// Least and greatest position, if it has one and is bounded.
    #[must_use]
    pub fn limits(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Revolute { limits, .. } | Self::Prismatic { limits, .. } => limits,
            _ => None,
        }
    }

    /// Whether one number says where it is: an angle or a distance along an axis.
    #[must_use]
    pub fn has_position(&self) -> bool {
        matches!(self, Self::Revolute { .. } | Self::Prismatic { .. })
    }
}

/// What pulls two anchors together that are farther apart than `length`, and pushes them apart
/// where they are nearer: `stiffness * (distance - length) + damping * (change of distance)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Distance at rest, >= 0.
    pub length: f64,
    /// Force a unit of distance, > 0.
    pub stiffness: f64,
    /// Force a unit of velocity, >= 0.
    pub damping: f64,
}

/// One joint follows another.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// Name of the joint that leads.
    pub joint: String,
    /// Factor.
    pub multiplier: f64,
    /// Offset.
    pub offset: f64,
}

/// Joint positions by name.
pub type JointPositions = BTreeMap<String, f64>;

/// From where a scene is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDescription {
    /// Unique; part of the recording's topic.
    pub name: String,
    /// View direction, or an explicit place.
    pub view: CameraView,
}

/// A preset fitted to the scene's bounds, or a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraView {
    /// From (1, −1, 0.8): three sides seen.
    Isometric,
    /// Along +y.
    Front,
    /// Along −x.
    Side,
    /// Along −z.
    Top,
    /// From a point towards another, world z up.
    LookAt {
        /// Where the camera stands.
        eye: DVec3,
        /// What it looks at.
        target: DVec3,
        /// Vertical field of view, radians.
        field_of_view: f64,
    },
}

/// What a recording holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordDescription {
    /// Every so many steps a frame, >= 1.
    pub every: u32,
}

impl Default for RecordDescription {
    fn default() -> Self {
        Self { every: 1 }
    }
}
