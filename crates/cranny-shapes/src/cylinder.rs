//! A cylinder: peg, wheel.

use cranny_exact::DVec2;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    builder::directions,
    error::{Checked, MIN_DETAIL, ShapeError},
    lathe::{Profile, lathe},
    round::MAX_SEGMENTS,
};

/// A cylinder about z, centred at the origin; its vertices lie on the cylinder. `4 segments`
/// triangles, and `4 segments` more with chamfers.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Cylinder {
    /// Radius, scene units. Default: 0.5.
    pub radius: f64,
    /// Extent along z. Default: 1.
    pub height: f64,
    /// What is cut off both rims at 45 degrees, along the radius and along z: less than the radius
    /// and than half the height; 0 for none. Default: 0.
    pub chamfer: f64,
    /// Segments around the axis, at least 3. Default: 64.
    pub segments: u32,
}

impl Default for Cylinder {
    fn default() -> Self {
        Self { radius: 0.5, height: 1.0, chamfer: 0.0, segments: 64 }
    }
}

impl Cylinder {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Cylinder" };
        checked.length("radius", self.radius)?;
        checked.length("height", self.height)?;
        checked.count("segments", self.segments, 3, MAX_SEGMENTS)?;
        let (r, top, cut) = (self.radius, 0.5 * self.height, self.chamfer);
        let room = r.min(top);
        let most = (1.0 - MIN_DETAIL) * room;
        let profile = if cut == 0.0 {
            vec![(0.0, -top), (r, -top), (r, top), (0.0, top)]
        } else {
            checked.detail("chamfer", cut, room, most, "0, or less than radius and half height")?;
            let (rim, side) = (r - cut, top - cut);
            vec![(0.0, -top), (rim, -top), (r, -side), (r, side), (rim, top), (0.0, top)]
        };
        let profile: Vec<DVec2> = profile.into_iter().map(DVec2::from).collect();
        lathe(checked.shape, &directions(self.segments), &profile, Profile::Open)
    }
}
