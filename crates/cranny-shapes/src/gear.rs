//! A spur gear with involute teeth.

use std::f64::consts::{PI, TAU};

use cranny_exact::DVec2;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    error::{Checked, MIN_DETAIL, ShapeError},
    prism::Prism,
};

/// Angle between the line of action and the pitch circle's tangent: 20 degrees, the ISO 53 value.
const PRESSURE_ANGLE: f64 = 20.0 * PI / 180.0;

/// Height of a tooth beyond the pitch circle, in modules (ISO 53).
const ADDENDUM: f64 = 1.0;

/// Depth of a gap below the pitch circle, in modules (ISO 53, profile A).
const DEDENDUM: f64 = 1.25;

/// A spur gear about z, centred at the origin, with involute flanks at a pressure angle of 20
/// degrees and straight roots; tooth 0 is centred on +x. Below the base circle the flank is radial
/// (no undercut). Two gears of equal module mesh at a distance of half the sum of their teeth times
/// the module, if the teeth of one face gaps of the other, and clear each other by their backlash.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Gear {
    /// Number of teeth, 4 to 200. Default: 16.
    pub teeth: u32,
    /// Pitch diameter divided by the number of teeth, scene units. Default: 0.1.
    pub module: f64,
    /// Extent along z. Default: 0.3.
    pub thickness: f64,
    /// Radius of the bore, a regular polygon with a corner at the middle of each gap; 0 for none;
    /// less than the root circle's. Default: 0.3.
    pub bore: f64,
    /// What each tooth is thinner than half the circular pitch, along the pitch circle; less than
    /// makes the teeth pointed. Default: 0.
    pub backlash: f64,
    /// Chords of each flank's involute, at least 1. Default: 4.
    pub flank_segments: u32,
}

impl Default for Gear {
    fn default() -> Self {
        Self { teeth: 16, module: 0.1, thickness: 0.3, bore: 0.3, backlash: 0.0, flank_segments: 4 }
    }
}

impl Gear {
    /// Radius of the pitch circle, `teeth module / 2`.
    #[must_use]
    pub fn pitch_radius(&self) -> f64 {
        0.5 * f64::from(self.teeth) * self.module
    }

    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Gear" };
        self.check(&checked)?;
        let flank = self.flank();
        // A sector per tooth: its contour from one gap's middle to just before the next, and the
        // bore.
        let contour = 2 * flank.len() as u32 + 1;
        let (mut points, mut outline, mut bore) = (Vec::new(), Vec::new(), Vec::new());
        for tooth in 0..self.teeth {
            let turn = |angle: f64| TAU * (f64::from(tooth) / f64::from(self.teeth)) + angle;
            let polar = |radius: f64, angle: f64| radius * DVec2::from_angle(turn(angle));
            outline.extend((0..contour).map(|k| points.len() as u32 + k));
            points.push(polar(self.root_radius(), -PI / f64::from(self.teeth)));
            points.extend(flank.iter().map(|&[radius, half]| polar(radius, -half)));
            points.extend(flank.iter().rev().map(|&[radius, half]| polar(radius, half)));
            if self.bore > 0.0 {
                bore.push(points.len() as u32);
                points.push(polar(self.bore, -PI / f64::from(self.teeth)));
            }
        }
        let pieces = if self.bore > 0.0 {
            self.sectors(&outline, contour, |tooth| bore[tooth])
        } else {
            points.push(DVec2::ZERO);
            let centre = points.len() as u32 - 1;
            self.sectors(&outline, contour, |_| centre)
        };
        bore.reverse();
        let loops = [outline, bore].into_iter().filter(|l| !l.is_empty()).collect();
        Prism { points, loops, pieces }.build(&checked, self.thickness)
    }

    fn check(&self, checked: &Checked) -> Result<(), ShapeError> {
        checked.count("teeth", self.teeth, 4, 200)?;
        checked.length("module", self.module)?;
        checked.length("thickness", self.thickness)?;
        let sharp = Self { backlash: 0.0, ..*self };
        let most = 2.0 * self.pitch_radius() * sharp.half_angle(self.tip_radius());
        let reason = "nine tenths of what would make the teeth pointed";
        checked.within("backlash", self.backlash, [0.0, 0.9 * most], reason)?;
        checked.count("flank_segments", self.flank_segments, 1, 64)?;
        let root = self.root_radius();
        let most = (1.0 - MIN_DETAIL) * root;
        if self.bore != 0.0 {
            checked.detail("bore", self.bore, root, most, "0, or less than the root circle")?;
        }
        Ok(())
    }

    fn root_radius(&self) -> f64 {
        self.pitch_radius() - DEDENDUM * self.module
    }

    fn tip_radius(&self) -> f64 {
        self.pitch_radius() + ADDENDUM * self.module
    }

    fn base_radius(&self) -> f64 {
        self.pitch_radius() * PRESSURE_ANGLE.cos()
    }

    /// Half the angle that a tooth spans at a radius, at least the base circle's.
    fn half_angle(&self, radius: f64) -> f64 {
        let involute = |angle: f64| angle.tan() - angle;
        let pressure = (self.base_radius() / radius).min(1.0).acos();
        let half_at_pitch =
            0.5 * (PI / f64::from(self.teeth) - self.backlash / self.pitch_radius());
        half_at_pitch + involute(PRESSURE_ANGLE) - involute(pressure)
    }

    /// One flank from root to tip: radius and half the angle that the tooth spans there.
    fn flank(&self) -> Vec<[f64; 2]> {
        let (root, base, tip) = (self.root_radius(), self.base_radius(), self.tip_radius());
        let start = root.max(base);
        let mut flank = Vec::new();
        if root < base {
            flank.push([root, self.half_angle(base)]);
        }
        for k in 0..=self.flank_segments {
            let radius = start + (tip - start) * (f64::from(k) / f64::from(self.flank_segments));
            flank.push([radius, self.half_angle(radius)]);
        }
        flank
    }

    /// Cuts the region from each gap's middle to the bore (or centre).
    fn sectors(&self, outline: &[u32], contour: u32, foot: impl Fn(usize) -> u32) -> Vec<Vec<u32>> {
        let (n, contour) = (self.teeth as usize, contour as usize);
        let sector = |tooth: usize| {
            let next = (tooth + 1) % n;
            let mut piece = outline[tooth * contour..(tooth + 1) * contour].to_vec();
            piece.push(outline[next * contour]);
            piece.push(foot(next));
            if foot(tooth) != foot(next) {
                piece.push(foot(tooth));
            }
            piece
        };
        (0..n).map(sector).collect()
    }
}
