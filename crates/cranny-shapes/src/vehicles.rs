//! Vehicles and their parts: the shell of an automobile, wheels, a submarine's hull, a propeller.

use std::f64::consts::TAU;

use cranny_exact::{DVec2, DVec3};
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    blocks::Blocks,
    error::{Checked, MIN_DETAIL, ShapeError},
};

/// The most segments of a vehicle's part.
const MAX_FINE: u32 = 1 << 8;

/// The shell of an automobile: floor, doors and roof about a cabin with open windows in front,
/// behind and on both sides, wheel arches, and an engine bay that is open above. x is forward, y to
/// the left; it is centred about z, and its floor lies on `z = 0`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CarBody {
    /// Extent along x, y and z, scene units. Default: 4.2, 1.8, 1.2.
    pub size: [f64; 3],
    /// Segments along the length, 8 to 256. Default: 32.
    pub segments: u32,
}

impl Default for CarBody {
    fn default() -> Self {
        Self { size: [4.2, 1.8, 1.2], segments: 32 }
    }
}

/// Where the bonnet ends and the cabin begins, in parts of the height.
const BELT: f64 = 0.55;

impl CarBody {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "CarBody" };
        for (name, size) in ["size x", "size y", "size z"].into_iter().zip(self.size) {
            checked.length(name, size)?;
        }
        checked.count("segments", self.segments, 8, MAX_FINE)?;
        let piece = 2.0 / f64::from(self.segments);
        let half = 0.5 * DVec3::new(self.size[0], self.size[1], 2.0 * self.size[2]);
        car().bent(&checked, [piece, 1.5 * piece, 1.5 * piece], |p| half * car_shape(p))
    }
}

/// x and y from -1 to 1, z from 0 to 1.
fn car() -> Blocks {
    let mut car = Blocks::default()
        .add([-1.0, -1.0, 0.0], [1.0, 1.0, BELT])
        .add([-0.78, -1.0, 0.5], [0.36, 1.0, 1.0])
        .cut([-0.48, -0.88, 0.08], [0.3, 0.88, 0.94])
        .cut([-0.7, -0.88, 0.48], [0.3, 0.88, 0.94])
        .cut([0.42, -0.68, 0.12], [0.9, 0.68, 2.0]);
    // Windows: behind and in front of the middle post, windscreen, rear window.
    for [from, to] in [[-0.62, -0.22], [-0.14, 0.24]] {
        car = car.cut([from, -2.0, 0.62], [to, 2.0, 0.9]);
    }
    car = car.cut([0.2, -0.8, 0.62], [0.6, 0.8, 0.9]).cut([-0.9, -0.8, 0.62], [-0.6, 0.8, 0.9]);
    for [from, to] in [[0.5, 0.8], [-0.82, -0.52]] {
        for [right, left] in [[-2.0, -0.74], [0.74, 2.0]] {
            car = car.cut([from, right, -1.0], [to, left, 0.42]);
        }
    }
    car
}

/// Leans the cabin, rounds the ends, slopes the bonnet.
fn car_shape(p: DVec3) -> DVec3 {
    let up = ((p.z - BELT) / (1.0 - BELT)).max(0.0);
    let middle = -0.2;
    let x = middle + (p.x - middle) * (1.0 - 0.32 * up);
    let y = p.y * (1.0 - 0.16 * up) * (1.0 - 0.12 * p.x.powi(4));
    let z = p.z * (1.0 - 0.18 * (1.0 - up) * p.x.powi(4));
    DVec3::new(x * (1.0 - 0.06 * p.y.powi(4)), y, z)
}

/// A wheel with spokes about z, centred at the origin: a rim, a bored hub, and straight spokes; a
/// steering wheel where the rim is thin.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpokedWheel {
    /// Radius, scene units. Default: 0.32.
    pub radius: f64,
    /// Extent along z. Default: 0.2.
    pub width: f64,
    /// Thickness of the rim along the radius, at most half of it. Default: 0.1.
    pub rim: f64,
    /// Number of spokes, 2 to 64. Default: 8.
    pub spokes: u32,
    /// Segments around the axis, at least 4 a spoke and at most 1,024. Default: 64.
    pub segments: u32,
}

impl Default for SpokedWheel {
    fn default() -> Self {
        Self { radius: 0.32, width: 0.2, rim: 0.1, spokes: 8, segments: 64 }
    }
}

impl SpokedWheel {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "SpokedWheel" };
        let Self { radius: r, width: w, rim, spokes, segments } = *self;
        checked.length("radius", r)?;
        checked.within(
            "width",
            w,
            [MIN_DETAIL * r, r / MIN_DETAIL],
            "comparable with the radius",
        )?;
        checked.detail("rim", rim, r, 0.5 * r, "at most half the radius")?;
        checked.count("spokes", spokes, 2, 64)?;
        checked.count("segments", segments, 4 * spokes, 1 << 10)?;
        let mut wheel = Blocks::around(1.0)
            .add([0.0, -0.5 * w, r - rim], [1.0, 0.5 * w, r])
            .add([0.0, -0.4 * w, 0.08 * r], [1.0, 0.4 * w, 0.24 * r]);
        // A spoke takes a quarter of its share of the turn.
        let share = 1.0 / f64::from(spokes);
        for k in 0..spokes {
            let start = share * f64::from(k);
            wheel = wheel
                .add([start, -0.2 * w, 0.2 * r], [start + 0.25 * share, 0.2 * w, r - 0.5 * rim]);
        }
        let longest = [1.0 / f64::from(segments), f64::INFINITY, f64::INFINITY];
        wheel.bent(&checked, longest, |p| turned(p.x, p.z).extend(p.y))
    }
}

/// The point at a part of a turn, so far from the axis.
fn turned(turns: f64, radius: f64) -> DVec2 {
    radius * DVec2::from_angle(TAU * turns)
}

/// A ship's propeller about z, centred at the origin: a bored hub and blades that are pitched.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Propeller {
    /// Radius of the blades' tips, scene units. Default: 0.5.
    pub radius: f64,
    /// Number of blades, 2 to 8. Default: 5.
    pub blades: u32,
    /// How far along z a blade reaches per unit of length around the axis, -1 to 1. Default: 0.6.
    pub pitch: f64,
    /// Segments around the axis, at least 4 a blade and at most 1,024. Default: 60.
    pub segments: u32,
}

impl Default for Propeller {
    fn default() -> Self {
        Self { radius: 0.5, blades: 5, pitch: 0.6, segments: 60 }
    }
}

impl Propeller {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Propeller" };
        let Self { radius, blades, pitch, segments } = *self;
        checked.length("radius", radius)?;
        checked.count("blades", blades, 2, 8)?;
        checked.within("pitch", pitch, [-1.0, 1.0], "a slope")?;
        checked.count("segments", segments, 4 * blades, 1 << 10)?;
        let (hub, share) = (0.24, 1.0 / f64::from(blades));
        let mut propeller = Blocks::around(1.0).add([0.0, -0.2, 0.08], [1.0, 0.2, hub]);
        for k in 0..blades {
            let start = share * f64::from(k);
            propeller = propeller.add([start, -0.03, 0.2], [start + 0.6 * share, 0.03, 1.0]);
        }
        let longest = [1.0 / f64::from(segments), f64::INFINITY, 0.2];
        propeller.bent(&checked, longest, |p| {
            // A blade rises from its root on, and is round at its tip.
            let across = (p.x / share).rem_euclid(1.0) / 0.6 - 0.5;
            let root = ((p.z - hub) / (0.5 - hub)).clamp(0.0, 1.0);
            let along = pitch * across * 0.6 * share * TAU * p.z * root;
            let tip = 1.0 - 0.5 * root * across * across;
            radius * turned(p.x, p.z * tip).extend(p.y + along)
        })
    }
}

/// The hull of a submarine about x, bow at +x, centred at the origin: a hollow shell with a sail
/// above, through which a hatch leads in, two bulkheads with round hatches, four fins at the stern,
/// and bores along the axis for a torpedo tube and the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SubmarineHull {
    /// Extent along x, scene units. Default: 16.
    pub length: f64,
    /// Greatest radius of the shell, at most a quarter of the length. Default: 2.
    pub radius: f64,
    /// Segments around the axis, 24 to 256. Default: 48.
    pub segments: u32,
}

impl Default for SubmarineHull {
    fn default() -> Self {
        Self { length: 16.0, radius: 2.0, segments: 48 }
    }
}

impl SubmarineHull {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "SubmarineHull" };
        checked.length("length", self.length)?;
        let most = 0.25 * self.length;
        checked.detail("radius", self.radius, self.length, most, "a quarter of the length")?;
        checked.count("segments", self.segments, 24, MAX_FINE)?;
        let longest = [1.0 / f64::from(self.segments), 0.05, f64::INFINITY];
        hull().bent(&checked, longest, |p| {
            let ends = ((p.y.abs() - 0.5) / 0.5).max(0.0);
            // Fins and sail stand on the shell; they do not become thinner with it.
            let within = p.z.min(1.0) * (1.0 - 0.6 * ends * ends) + (p.z - 1.0).max(0.0);
            let across = turned(p.x, self.radius * within);
            DVec3::new(0.5 * self.length * p.y, across.x, across.y)
        })
    }
}

/// Part of a turn (a quarter is up), place along the axis from -1 to 1, distance from it.
fn hull() -> Blocks {
    let up = 0.25;
    let mut hull = Blocks::around(1.0)
        .add([0.0, -0.92, 0.9], [1.0, 0.92, 1.0])
        .add([0.0, 0.92, 0.3], [1.0, 1.0, 1.0])
        .add([0.0, -1.0, 0.12], [1.0, -0.92, 1.0]);
    for at in [-0.38, 0.36] {
        hull = hull.add([0.0, at, 0.36], [1.0, at + 0.02, 0.95]);
    }
    for quarter in [0.0, 0.25, 0.5, 0.75] {
        hull = hull.add([quarter - 0.01, -0.98, 0.95], [quarter + 0.01, -0.84, 1.5]);
    }
    hull.add([up - 0.07, -0.06, 0.95], [up + 0.07, 0.3, 1.5])
        .cut([up - 0.05, -0.02, 0.5], [up + 0.05, 0.26, 2.0])
}
