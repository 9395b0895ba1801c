//! What is said of a body: what it is made of, where it is and how it moves.

use std::sync::Arc;

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_narrow_phase::Normals;
use cranny_primitives::{BodyShape, Primitive};

use super::effect::Effect;
use super::path::KeyframedPath;
use super::tracker::TrackerDescription;

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
