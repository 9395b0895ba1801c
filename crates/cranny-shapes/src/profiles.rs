//! Prisms over L, U, C and comb.

use std::f64::consts::TAU;

use cranny_exact::DVec2;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    error::{Checked, MIN_DETAIL, ShapeError},
    prism::Prism,
    round::MAX_SEGMENTS,
};

/// Leaves room beside an arm.
const ALMOST: f64 = 1.0 - MIN_DETAIL;

/// Accepted openings of a C: neither end's faces come so near that they round into one another.
const OPENINGS: [f64; 2] = [1e-3, TAU - 1e-3];

/// A prism over an L: one arm along x, one along y, both of the same thickness. The origin is the
/// centroid, z the axis. 20 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LPrism {
    /// Extent along x, scene units. Default: 1.
    pub width: f64,
    /// Extent along y. Default: 1.
    pub height: f64,
    /// Thickness of both arms, less than either extent. Default: 0.3.
    pub thickness: f64,
    /// Extent along z. Default: 0.5.
    pub depth: f64,
}

impl Default for LPrism {
    fn default() -> Self {
        Self { width: 1.0, height: 1.0, thickness: 0.3, depth: 0.5 }
    }
}

impl LPrism {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "LPrism" };
        let (w, h, t) = (self.width, self.height, self.thickness);
        check_extents(&checked, w, h, self.depth)?;
        let most = ALMOST * w.min(h);
        checked.detail("thickness", t, w.max(h), most, "less than width and height")?;
        let outline = [(0.0, 0.0), (w, 0.0), (w, t), (t, t), (t, h), (0.0, h)].map(DVec2::from);
        Prism::simple(about_centroid(&outline)).build(&checked, self.depth)
    }
}

/// A prism over a U that opens towards +y: a floor and two arms of the same thickness. The origin
/// is the centroid, z the axis. 28 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct UPrism {
    /// Extent along x, scene units. Default: 1.
    pub width: f64,
    /// Extent along y. Default: 1.
    pub height: f64,
    /// Thickness of floor and arms, less than the height and half the width. Default: 0.25.
    pub thickness: f64,
    /// Extent along z. Default: 0.5.
    pub depth: f64,
}

impl Default for UPrism {
    fn default() -> Self {
        Self { width: 1.0, height: 1.0, thickness: 0.25, depth: 0.5 }
    }
}

impl UPrism {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "UPrism" };
        let (w, h, t) = (self.width, self.height, self.thickness);
        check_extents(&checked, w, h, self.depth)?;
        let most = ALMOST * (0.5 * w).min(h);
        checked.detail("thickness", t, w.max(h), most, "less than height and half the width")?;
        let outline =
            [(0.0, 0.0), (w, 0.0), (w, h), (w - t, h), (w - t, t), (t, t), (t, h), (0.0, h)]
                .map(DVec2::from);
        Prism::simple(about_centroid(&outline)).build(&checked, self.depth)
    }
}

fn check_extents(checked: &Checked, w: f64, h: f64, depth: f64) -> Result<(), ShapeError> {
    checked.length("width", w)?;
    checked.length("height", h)?;
    checked.length("depth", depth)
}

/// The polygon, moved so that its centroid is the origin.
pub(crate) fn about_centroid(outline: &[DVec2]) -> Vec<DVec2> {
    let (mut area, mut moment) = (0.0, DVec2::ZERO);
    for (k, &p) in outline.iter().enumerate() {
        let q = outline[(k + 1) % outline.len()];
        area += 0.5 * p.perp_dot(q);
        moment += p.perp_dot(q) * (p + q) / 6.0;
    }
    outline.iter().map(|&p| p - moment / area).collect()
}

/// A prism over a C: a ring about z whose opening is centred on +x. The vertices lie on the two
/// cylinders, centred at the origin. `8 segments + 4` triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CPrism {
    /// Outer radius, scene units. Default: 0.5.
    pub outer_radius: f64,
    /// Inner radius, less than the outer. Default: 0.3.
    pub inner_radius: f64,
    /// Angle of the opening, radians, from 0.001 to 0.001 less than a whole turn. Default: 1.
    pub opening: f64,
    /// Extent along z. Default: 0.5.
    pub depth: f64,
    /// Segments along the arc, each below half a turn; at least 3. Default: 48.
    pub segments: u32,
}

impl Default for CPrism {
    fn default() -> Self {
        Self { outer_radius: 0.5, inner_radius: 0.3, opening: 1.0, depth: 0.5, segments: 48 }
    }
}

impl CPrism {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "CPrism" };
        let outer = self.outer_radius;
        checked.length("outer_radius", outer)?;
        let less = "less than the outer radius";
        checked.detail("inner_radius", self.inner_radius, outer, ALMOST * outer, less)?;
        checked.within("opening", self.opening, OPENINGS, "an angle below a whole turn")?;
        checked.length("depth", self.depth)?;
        checked.count("segments", self.segments, 3, MAX_SEGMENTS)?;

        let n = self.segments;
        let step = (TAU - self.opening) / f64::from(n);
        let arc = |radius: f64| {
            (0..=n)
                .map(move |k| radius * DVec2::from_angle(0.5 * self.opening + f64::from(k) * step))
        };
        let points = arc(outer).chain(arc(self.inner_radius)).collect();
        let inner = n + 1;
        let outline = (0..=n).chain((inner..=inner + n).rev()).collect();
        let pieces = (0..n).map(|k| vec![k, k + 1, inner + k + 1, inner + k]).collect();
        Prism { points, loops: vec![outline], pieces }.build(&checked, self.depth)
    }
}

/// A comb: a bar along x with equal, equally spaced prongs towards +y; the gaps are as wide as
/// said. The bar's lower edge is `y = 0`, x and z are centred. `16 teeth + 4` triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Comb {
    /// Number of prongs, at least 2. Default: 8.
    pub teeth: u32,
    /// Width of a prong, scene units. Default: 0.1.
    pub tooth_width: f64,
    /// Width of a gap between prongs. Default: 0.1.
    pub gap: f64,
    /// Length of a prong beyond the bar. Default: 0.6.
    pub tooth_length: f64,
    /// Extent of the bar along y. Default: 0.2.
    pub bar: f64,
    /// Extent along z. Default: 0.1.
    pub depth: f64,
}

impl Default for Comb {
    fn default() -> Self {
        Self { teeth: 8, tooth_width: 0.1, gap: 0.1, tooth_length: 0.6, bar: 0.2, depth: 0.1 }
    }
}

impl Comb {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Comb" };
        checked.count("teeth", self.teeth, 2, MAX_SEGMENTS)?;
        checked.length("tooth_width", self.tooth_width)?;
        checked.length("tooth_length", self.tooth_length)?;
        checked.length("depth", self.depth)?;
        let comparable = "comparable with the prongs";
        let range = |size: f64| [MIN_DETAIL * size, size / MIN_DETAIL];
        checked.within("gap", self.gap, range(self.tooth_width), comparable)?;
        checked.within("bar", self.bar, range(self.tooth_length), comparable)?;

        let teeth = self.teeth;
        let (pitch, top) = (self.tooth_width + self.gap, self.bar + self.tooth_length);
        let width = f64::from(teeth) * pitch - self.gap;
        let (left, right) = (-0.5 * width, 0.5 * width);
        // Per prong, from left to right: both ends at the bar, then both tips; then the bar below.
        let mut points = Vec::new();
        for tooth in 0..teeth {
            let start = if tooth == 0 { left } else { left + f64::from(tooth) * pitch };
            let end = if tooth + 1 == teeth { right } else { start + self.tooth_width };
            for (x, y) in [(start, self.bar), (end, self.bar), (start, top), (end, top)] {
                points.push(DVec2::new(x, y));
            }
        }
        let [low_left, low_right] = [4 * teeth, 4 * teeth + 1];
        points.extend([DVec2::new(left, 0.0), DVec2::new(right, 0.0)]);

        let mut outline = vec![low_left, low_right];
        let mut pieces = Vec::new();
        for tooth in (0..teeth).rev() {
            let [start, end, start_tip, end_tip] = [0, 1, 2, 3].map(|k| 4 * tooth + k);
            outline.extend([end, end_tip, start_tip, start]);
            pieces.push(vec![start, end, end_tip, start_tip]);
        }
        pieces.extend(self.bar_triangles(low_left, low_right));
        Prism { points, loops: vec![outline], pieces }.build(&checked, self.depth)
    }

    /// The bar's upper corners, fanned from the nearer lower one.
    fn bar_triangles(&self, low_left: u32, low_right: u32) -> Vec<Vec<u32>> {
        let upper: Vec<u32> = (0..self.teeth).flat_map(|t| [4 * t, 4 * t + 1]).collect();
        let middle = upper.len() / 2;
        let mut triangles = vec![vec![low_left, low_right, upper[middle]]];
        for (k, pair) in upper.windows(2).enumerate() {
            let foot = if k < middle { low_left } else { low_right };
            triangles.push(vec![foot, pair[1], pair[0]]);
        }
        triangles
    }
}
