//! Neutral descriptions of scenes: what a scene file or a program says, before anything runs.
//!
//! Lengths are in the scene's unit, times in seconds, angles in radians, masses density x volume.

use std::collections::BTreeSet;

pub use cranny_estimate::Accuracy;
use cranny_exact::DVec3;
pub use cranny_narrow_phase::Normals;

mod body;
mod camera;
mod effect;
mod joint;
mod keyframes;
mod motor_path;
mod path;
mod tracker;

pub use body::{BodyColor, BodyDescription, BodyKind, Material, StatedMass};
pub use camera::{CameraDescription, CameraView};
pub use effect::Effect;
pub use joint::{JointDescription, JointKind, JointPositions, Mimic, Motor, Resistance, Spring};
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
    /// Into how many parts, at least 1, the solver divides a step at most in which bodies near each
    /// other move farther than the thinner one is thick; `None`: 2.
    pub most_parts: Option<u32>,
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
