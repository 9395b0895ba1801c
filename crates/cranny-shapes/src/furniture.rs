//! Prisms that others hang on, stand on or turn in: hook, stairs, keyway.

use cranny_exact::DVec2;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    builder::directions,
    error::{Checked, MAX_LENGTH, MIN_DETAIL, ShapeError},
    prism::Prism,
    profiles::about_centroid,
    round::MAX_SEGMENTS,
};

/// Leaves room beside a part.
const ALMOST: f64 = 1.0 - MIN_DETAIL;

/// A hook: a prism over a J upside down. A long shank on the left, a bar across, a short tip on the
/// right, all of one thickness; it hangs by the bar's lower side. The origin is the centroid, z the
/// axis, y up. 28 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Hook {
    /// Length of the shank along y, the bar included, scene units. Default: 1.2.
    pub length: f64,
    /// From shank to tip, inside. Default: 0.7.
    pub opening: f64,
    /// Length of the tip below the bar, less than the shank's. Default: 0.5.
    pub tip: f64,
    /// Of shank, bar and tip; less than the length. Default: 0.3.
    pub thickness: f64,
    /// Extent along z. Default: 0.3.
    pub depth: f64,
}

impl Default for Hook {
    fn default() -> Self {
        Self { length: 1.2, opening: 0.7, tip: 0.5, thickness: 0.3, depth: 0.3 }
    }
}

impl Hook {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Hook" };
        let (h, o, t) = (self.length, self.opening, self.thickness);
        checked.length("length", h)?;
        checked.length("depth", self.depth)?;
        checked.detail("thickness", t, h, ALMOST * h, "less than the length")?;
        checked.detail("opening", o, h, h / MIN_DETAIL, "comparable with the length")?;
        checked.detail("tip", self.tip, h, ALMOST * (h - t), "shorter than the shank")?;
        let (under, end, right) = (h - t, h - t - self.tip, 2.0 * t + o);
        let outline = [
            (0.0, 0.0),
            (t, 0.0),
            (t, under),
            (t + o, under),
            (t + o, end),
            (right, end),
            (right, h),
            (0.0, h),
        ]
        .map(DVec2::from);
        Prism::simple(about_centroid(&outline)).build(&checked, self.depth)
    }
}

/// Stairs that go down towards +x, as a solid block: a landing up to `x = 0`, where the first step
/// down is, then the treads. y is up, the block stands on `y = 0`, z is the axis and centred.
/// `8 steps + 12` triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stairs {
    /// Treads below the landing, at least 1: the last one lies one rise above `y = 0`. Default: 5.
    pub steps: u32,
    /// Height of a step, scene units. Default: 0.12.
    pub rise: f64,
    /// Length of a tread along x. Default: 0.5.
    pub tread: f64,
    /// Length of the landing along x. Default: 1.
    pub landing: f64,
    /// Extent along z. Default: 1.
    pub depth: f64,
}

impl Default for Stairs {
    fn default() -> Self {
        Self { steps: 5, rise: 0.12, tread: 0.5, landing: 1.0, depth: 1.0 }
    }
}

impl Stairs {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Stairs" };
        checked.count("steps", self.steps, 1, 1 << 10)?;
        for (name, value) in [
            ("rise", self.rise),
            ("tread", self.tread),
            ("landing", self.landing),
            ("depth", self.depth),
        ] {
            checked.length(name, value)?;
        }
        let comparable = "comparable with the treads";
        let range = [MIN_DETAIL * self.tread, self.tread / MIN_DETAIL];
        checked.within("rise", self.rise, range, comparable)?;
        checked.within("landing", self.landing, range, comparable)?;
        let at = |x: u32, y: u32| DVec2::new(self.tread * f64::from(x), self.rise * f64::from(y));
        let n = self.steps;
        let mut outline = vec![DVec2::new(-self.landing, 0.0), at(n, 0)];
        // From the lowest tread up; tread k ends at x = k treads.
        for k in (1..=n).rev() {
            outline.extend([at(k, n + 1 - k), at(k - 1, n + 1 - k)]);
        }
        outline.extend([at(0, n + 1), DVec2::new(-self.landing, self.rise * f64::from(n + 1))]);
        Prism::simple(outline).build(&checked, self.depth)
    }
}

/// A lock's plug: a cylinder about z, centred at the origin, with a keyway through it along z. The
/// keyway is that of an [`LPrism`](crate::LPrism) of the same width, height and thickness, with its
/// centroid on the axis, and wider than that by the clearance on every side. The cylinder's
/// vertices lie on it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LockPlug {
    /// Radius, scene units. Default: 1.
    pub radius: f64,
    /// The key's extent along x. Default: 0.8.
    pub width: f64,
    /// The key's extent along y. Default: 0.8.
    pub height: f64,
    /// Of the key's arms, less than either extent. Default: 0.3.
    pub thickness: f64,
    /// From each side of the key to the keyway's, more than 0. Default: 0.01.
    pub clearance: f64,
    /// Extent along z. Default: 0.5.
    pub depth: f64,
    /// Segments around the axis, at least 12. Default: 48.
    pub segments: u32,
}

impl Default for LockPlug {
    fn default() -> Self {
        Self {
            radius: 1.0,
            width: 0.8,
            height: 0.8,
            thickness: 0.3,
            clearance: 0.01,
            depth: 0.5,
            segments: 48,
        }
    }
}

impl LockPlug {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "LockPlug" };
        let (w, h, t, c) = (self.width, self.height, self.thickness, self.clearance);
        for (name, value) in
            [("radius", self.radius), ("width", w), ("height", h), ("depth", self.depth)]
        {
            checked.length(name, value)?;
        }
        let least = w.min(h);
        checked.detail("thickness", t, w.max(h), ALMOST * least, "less than width and height")?;
        let room = "what leaves the keyway's arms apart";
        checked.detail("clearance", c, t, ALMOST * 0.5 * (least - t), room)?;
        checked.count("segments", self.segments, 12, MAX_SEGMENTS)?;
        let key = [(0.0, 0.0), (w, 0.0), (w, t), (t, t), (t, h), (0.0, h)].map(DVec2::from);
        let key = about_centroid(&key);
        // Outward at each corner, along both axes.
        let outward = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (1.0, 1.0), (1.0, 1.0), (-1.0, 1.0)];
        let keyway: Vec<DVec2> =
            key.iter().zip(outward.map(DVec2::from)).map(|(&p, out)| p + c * out).collect();
        let n = self.segments;
        let reach = keyway.iter().map(|p| p.length()).fold(0.0, f64::max);
        let flat = (std::f64::consts::PI / f64::from(n)).cos(); // of the rim's segments, of radius 1
        let range = [reach / (ALMOST * flat), MAX_LENGTH];
        checked.within("radius", self.radius, range, "more than the keyway's reach")?;

        let mut points: Vec<DVec2> = directions(n).iter().map(|&d| self.radius * d).collect();
        points.extend(&keyway);
        // Two bridges cut the ring in two: from the outer corner, and from the end of the arm along
        // y.
        let rim = |p: DVec2| {
            let turn = p.to_angle().rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
            (turn * f64::from(n)).round() as u32 % n
        };
        let (corner, end) = (0, 4);
        let [from, to] = [corner, end].map(|k: usize| rim(keyway[k]));
        let arc =
            |start: u32, stop: u32| (0..=(stop + n - start) % n).map(move |k| (start + k) % n);
        // Counter-clockwise along the rim, back along the keyway.
        let hole = |k: u32| n + k;
        let right: Vec<u32> = arc(from, to).chain([4, 3, 2, 1, 0].map(hole)).collect();
        let left: Vec<u32> = arc(to, from).chain([0, 5, 4].map(hole)).collect();
        let loops = vec![(0..n).collect(), (0..6).rev().map(hole).collect()];
        Prism { points, loops, pieces: vec![right, left] }.build(&checked, self.depth)
    }
}
