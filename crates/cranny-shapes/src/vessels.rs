//! Bodies with wells: cup, nested shells, a pyramid in a cavity.

use cranny_exact::DVec2;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    builder::directions,
    error::{Checked, MIN_DETAIL, ShapeError},
    lathe::{Profile, lathe},
    round::MAX_SEGMENTS,
};

/// Leaves room beside a wall or above a floor.
const ALMOST: f64 = 1.0 - MIN_DETAIL;

/// A cup without a handle: a cylinder about z that stands on `z = 0`, with a well from above.
/// `8 segments` triangles; the vertices lie on the cylinders.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Cup {
    /// Outer radius, scene units. Default: 0.5.
    pub radius: f64,
    /// Outer height. Default: 1.
    pub height: f64,
    /// Thickness of the wall, less than the radius. Default: 0.1.
    pub wall: f64,
    /// Thickness of the floor, less than the height. Default: 0.1.
    pub floor: f64,
    /// Segments around the axis, at least 3. Default: 64.
    pub segments: u32,
}

impl Default for Cup {
    fn default() -> Self {
        Self { radius: 0.5, height: 1.0, wall: 0.1, floor: 0.1, segments: 64 }
    }
}

impl Cup {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Cup" };
        checked.length("radius", self.radius)?;
        checked.length("height", self.height)?;
        let (r, h, w) = (self.radius, self.height, self.wall);
        checked.detail("wall", w, r, ALMOST * r, "thinner than the radius")?;
        checked.detail("floor", self.floor, h, ALMOST * h, "lower than the height")?;
        checked.count("segments", self.segments, 3, MAX_SEGMENTS)?;
        let profile =
            [(0.0, 0.0), (r, 0.0), (r, h), (r - w, h), (r - w, self.floor), (0.0, self.floor)]
                .map(|(r, z)| DVec2::new(r, z));
        lathe(checked.shape, &directions(self.segments), &profile, Profile::Open)
    }
}

/// Concentric cylindrical shells of one height and decreasing diameter on a common floor: `shells`
/// lips, `shells - 1` annular grooves between them, and a central well. Axis z, standing on
/// `z = 0`. `8 segments shells` triangles; the vertices lie on the cylinders.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NestedShells {
    /// Number of shells, at least 1. Default: 3.
    pub shells: u32,
    /// Outer radius of the outermost shell, scene units. Default: 1.
    pub radius: f64,
    /// Thickness of each shell. Default: 0.1.
    pub wall: f64,
    /// Width of each groove; all shells and grooves together are narrower than the radius.
    /// Default: 0.2.
    pub gap: f64,
    /// Outer height. Default: 1.
    pub height: f64,
    /// Thickness of the floor, less than the height. Default: 0.2.
    pub floor: f64,
    /// Segments around the axis, at least 3. Default: 48.
    pub segments: u32,
}

impl Default for NestedShells {
    fn default() -> Self {
        Self { shells: 3, radius: 1.0, wall: 0.1, gap: 0.2, height: 1.0, floor: 0.2, segments: 48 }
    }
}

impl NestedShells {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "NestedShells" };
        self.check(&checked)?;
        let (r, h, floor) = (self.radius, self.height, self.floor);
        let mut profile = vec![DVec2::ZERO, DVec2::new(r, 0.0)];
        for shell in 0..self.shells {
            let outer = r - f64::from(shell) * (self.wall + self.gap);
            let inner = outer - self.wall;
            if shell > 0 {
                profile.push(DVec2::new(outer, floor));
            }
            profile.extend([(outer, h), (inner, h), (inner, floor)].map(|(r, z)| DVec2::new(r, z)));
        }
        profile.push(DVec2::new(0.0, floor));
        lathe(checked.shape, &directions(self.segments), &profile, Profile::Open)
    }

    fn check(&self, checked: &Checked) -> Result<(), ShapeError> {
        let (r, h) = (self.radius, self.height);
        checked.count("shells", self.shells, 1, 1 << 10)?;
        checked.length("radius", r)?;
        checked.length("height", h)?;
        let fits = "all shells and grooves together are narrower than the radius";
        let (shells, grooves) = (f64::from(self.shells), f64::from(self.shells - 1));
        checked.detail("wall", self.wall, r, ALMOST * r / shells, fits)?;
        if self.shells > 1 {
            let left = ALMOST * r - shells * self.wall;
            checked.detail("gap", self.gap, r, left / grooves, fits)?;
        }
        checked.detail("floor", self.floor, h, ALMOST * h, "lower than the height")?;
        checked.count("segments", self.segments, 3, MAX_SEGMENTS)?;
        checked.faces(8 * u64::from(self.shells) * u64::from(self.segments))
    }
}

/// A square block with a square well from above, from whose floor a square pyramid rises. Axis z,
/// edges along x and y, standing on `z = 0`. 40 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PyramidInCavity {
    /// Side of the block, scene units. Default: 1.
    pub side: f64,
    /// Height of the block. Default: 1.
    pub height: f64,
    /// Thickness of the walls, less than half the side. Default: 0.1.
    pub wall: f64,
    /// Thickness of the floor, less than the height. Default: 0.1.
    pub floor: f64,
    /// Side of the pyramid's base, less than that of the well. Default: 0.5.
    pub base: f64,
    /// Height of the pyramid above the floor; it may stick out of the well. Default: 0.6.
    pub pyramid_height: f64,
}

impl Default for PyramidInCavity {
    fn default() -> Self {
        Self { side: 1.0, height: 1.0, wall: 0.1, floor: 0.1, base: 0.5, pyramid_height: 0.6 }
    }
}

impl PyramidInCavity {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "PyramidInCavity" };
        checked.length("side", self.side)?;
        checked.length("height", self.height)?;
        let (outer, h, floor) = (0.5 * self.side, self.height, self.floor);
        checked.detail("wall", self.wall, outer, ALMOST * outer, "thinner than half the side")?;
        checked.detail("floor", floor, h, ALMOST * h, "lower than the height")?;
        let inner = outer - self.wall;
        let narrower = "narrower than the well";
        checked.detail("base", self.base, inner, ALMOST * 2.0 * inner, narrower)?;
        let most = h / MIN_DETAIL;
        checked.detail(
            "pyramid_height",
            self.pyramid_height,
            h,
            most,
            "comparable to the height",
        )?;
        let (foot, apex) = (0.5 * self.base, floor + self.pyramid_height);
        let profile = [
            (0.0, 0.0),
            (outer, 0.0),
            (outer, h),
            (inner, h),
            (inner, floor),
            (foot, floor),
            (0.0, apex),
        ]
        .map(|(r, z)| DVec2::new(r, z));
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(DVec2::from);
        lathe(checked.shape, &corners, &profile, Profile::Open)
    }
}
