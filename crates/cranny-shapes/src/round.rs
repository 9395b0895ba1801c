//! Sphere, torus, and the link of a chain.

use cranny_exact::DVec2;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    builder::{MeshBuilder, direction, directions},
    error::{Checked, MIN_DETAIL, ShapeError},
    lathe::{Profile, lathe},
};

/// The most segments around anything.
pub(crate) const MAX_SEGMENTS: u32 = 1 << 14;

/// A sphere of meridians and parallels with poles on z, centred at the origin; its vertices lie on
/// the sphere, so its volume is a little less. `2 segments (rings - 1)` triangles. For a sphere of
/// nearly equal triangles take a [`GolfBall`](crate::GolfBall) without dimples.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sphere {
    /// Radius, scene units. Default: 0.5.
    pub radius: f64,
    /// Meridians, at least 3. Default: 32.
    pub segments: u32,
    /// Bands from pole to pole, at least 2. Default: 16.
    pub rings: u32,
}

impl Default for Sphere {
    fn default() -> Self {
        Self { radius: 0.5, segments: 32, rings: 16 }
    }
}

impl Sphere {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Sphere" };
        checked.length("radius", self.radius)?;
        checked.count("segments", self.segments, 3, MAX_SEGMENTS)?;
        checked.count("rings", self.rings, 2, MAX_SEGMENTS)?;
        checked.faces(2 * u64::from(self.segments) * u64::from(self.rings - 1))?;
        let meridian = |k| {
            let d = direction(k, 2 * self.rings);
            self.radius * DVec2::new(d.y, 0.0 - d.x)
        };
        let profile: Vec<_> = (0..=self.rings).map(meridian).collect();
        lathe(checked.shape, &directions(self.segments), &profile, Profile::Open)
    }
}

/// A torus about the z axis, centred at the origin; its vertices lie on the torus.
/// `2 major_segments minor_segments` triangles: 2,048 by default.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Torus {
    /// From the axis to the middle of the tube, scene units. Default: 1.
    pub major_radius: f64,
    /// Radius of the tube, less than the major radius. Default: 0.2.
    pub minor_radius: f64,
    /// Segments around the axis, at least 3. Default: 64.
    pub major_segments: u32,
    /// Segments around the tube, at least 3. Default: 16.
    pub minor_segments: u32,
}

impl Default for Torus {
    fn default() -> Self {
        Self { major_radius: 1.0, minor_radius: 0.2, major_segments: 64, minor_segments: 16 }
    }
}

impl Torus {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Torus" };
        checked.length("major_radius", self.major_radius)?;
        check_tube(&checked, "minor_radius", self.minor_radius, self.major_radius)?;
        checked.count("major_segments", self.major_segments, 3, MAX_SEGMENTS)?;
        checked.count("minor_segments", self.minor_segments, 3, MAX_SEGMENTS)?;
        checked.faces(2 * u64::from(self.major_segments) * u64::from(self.minor_segments))?;
        let axis = DVec2::new(self.major_radius, 0.0);
        let section = directions(self.minor_segments);
        let profile: Vec<_> = section.iter().map(|&d| axis + self.minor_radius * d).collect();
        lathe(checked.shape, &directions(self.major_segments), &profile, Profile::Closed)
    }
}

/// The tube leaves a hole in the middle.
fn check_tube(
    checked: &Checked,
    parameter: &'static str,
    tube: f64,
    bend: f64,
) -> Result<(), ShapeError> {
    let most = (1.0 - MIN_DETAIL) * bend;
    checked.detail(parameter, tube, bend, most, "thinner than its bend, so that the hole is open")
}

/// A link of a chain: a round wire bent to a stadium (two half circles joined by straight pieces)
/// in the xy plane, long axis x, centred at the origin. Vertices lie on the wire's surface.
/// `4 (arc_segments + 1) wire_segments` triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChainLink {
    /// Length of the straight pieces along x, scene units. Default: 1.
    pub straight: f64,
    /// Radius of the half circles, measured to the middle of the wire. Default: 0.5.
    pub bend_radius: f64,
    /// Radius of the wire, less than the bend's. Default: 0.15.
    pub wire_radius: f64,
    /// Segments of each half circle, at least 2. Default: 16.
    pub arc_segments: u32,
    /// Segments around the wire, at least 3. Default: 12.
    pub wire_segments: u32,
}

impl Default for ChainLink {
    fn default() -> Self {
        Self {
            straight: 1.0,
            bend_radius: 0.5,
            wire_radius: 0.15,
            arc_segments: 16,
            wire_segments: 12,
        }
    }
}

impl ChainLink {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "ChainLink" };
        checked.length("bend_radius", self.bend_radius)?;
        checked.length("straight", self.straight)?;
        let ratio = [MIN_DETAIL * self.bend_radius, self.bend_radius / MIN_DETAIL];
        checked.within("straight", self.straight, ratio, "comparable with the bend radius")?;
        check_tube(&checked, "wire_radius", self.wire_radius, self.bend_radius)?;
        checked.count("arc_segments", self.arc_segments, 2, MAX_SEGMENTS)?;
        checked.count("wire_segments", self.wire_segments, 3, MAX_SEGMENTS)?;
        checked.faces(4 * u64::from(self.arc_segments + 1) * u64::from(self.wire_segments))?;

        let mut builder = MeshBuilder::default();
        let section = directions(self.wire_segments);
        // Angles count in half segments, so that a quarter turn is a whole number of them.
        let (turn, quarter) = (4 * self.arc_segments, self.arc_segments);
        let arc = 0..=self.arc_segments;
        let right = arc.clone().map(|k| (0.5, 3 * quarter + 2 * k));
        let left = arc.map(|k| (-0.5, quarter + 2 * k));
        let mut rings = Vec::new();
        for (side, angle) in right.chain(left) {
            let outward = direction(angle, turn);
            let centre = DVec2::new(side * self.straight, 0.0);
            let ring = section.iter().map(|d| {
                let flat = centre + (self.bend_radius + self.wire_radius * d.x) * outward;
                builder.vertex(flat.extend(self.wire_radius * d.y))
            });
            rings.push(ring.collect::<Vec<_>>());
        }
        for k in 0..rings.len() {
            builder.band(&rings[(k + 1) % rings.len()], &rings[k]);
        }
        builder.finish(checked.shape)
    }
}
