//! Another detector that answers the same questions.

use cranny_exact::{DVec3, Pose};
use cranny_geometry::Model;

/// What a peer says of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeerAnswer {
    /// Whether the two meet.
    pub meets: bool,
    /// How far apart they are, 0 where they meet.
    pub distance: f64,
}

/// Another detector. An `Err` says in words that it refuses, or panics.
pub trait Peer {
    /// Its name.
    fn name(&self) -> &'static str;

    /// Two surfaces.
    ///
    /// # Errors
    ///
    /// Where it gives no answer.
    fn surfaces(&mut self, models: [&Model; 2], poses: [Pose; 2]) -> Result<PeerAnswer, String>;

    /// Two convex hulls of points, the second posed in the first's frame.
    ///
    /// # Errors
    ///
    /// Where it gives no answer.
    fn hulls(&mut self, points: [&[DVec3]; 2], pose: Pose) -> Result<PeerAnswer, String>;

    /// The points as it stores them, and their convex hull.
    ///
    /// # Errors
    ///
    /// Where it gives none.
    fn hull(&mut self, points: &[DVec3]) -> Result<(Vec<DVec3>, Vec<[DVec3; 3]>), String>;
}
