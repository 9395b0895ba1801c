//! From where a scene is seen.

use cranny_exact::DVec3;

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
