//! The metric bolt and the nut that runs on it.

use cranny_geometry::Mesh;
use serde::{Deserialize, Deserializer};

use crate::{
    builder::MeshBuilder,
    error::{Checked, MIN_DETAIL, ShapeError},
    thread::{
        Chamfer, Facing, Keep, MIN_FLATS, Thread, check_thread, collar, disc, hexagon, thread_depth,
    },
};

/// A fully threaded hexagon bolt: a right-hand ISO 68-1 thread about z from the head's underside at
/// `z = 0` to the tip at `z = length`, the head below, down to `z = -head_height`. The thread has
/// the basic profile; all clearance is the nut's. Crests are centred at
/// `z = pitch (angle / 2 pi + k)`.
///
/// Vertices lie on the ideal surface: between columns the mesh is inside by at most
/// `diameter / 2 (1 - cos(pi / segments))`, 0.002 mm for M16 at 144 segments.
/// The default, M16 x 2 x 48, has about 28,700 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct IsoBolt {
    /// Major diameter of the thread, scene units (millimetres, usually). Default: 16.
    pub diameter: f64,
    /// Climb of the helix a turn; a thousandth to a quarter of the diameter. Default: 2.
    pub pitch: f64,
    /// Length of the thread, 2 to 1,000 pitches. Default: 3 diameters.
    #[serde(deserialize_with = "some")]
    pub length: Option<f64>,
    /// Segments around the axis, at least 12. Default: 144.
    pub segments: u32,
    /// Chords of each flank along the profile, at least 1. Default: 1.
    pub flank_segments: u32,
    /// How far below the crest the 45 degree lead-in at the tip begins; 0 for none. Default: a
    /// sixteenth of a pitch more than the thread is deep, so that the tip is round.
    #[serde(deserialize_with = "some")]
    pub lead_in: Option<f64>,
    /// Width of the head across flats, 1.2 to 4 diameters. Default: 1.5 diameters.
    #[serde(deserialize_with = "some")]
    pub across_flats: Option<f64>,
    /// Height of the head. Default: 0.625 diameters.
    #[serde(deserialize_with = "some")]
    pub head_height: Option<f64>,
}

impl Default for IsoBolt {
    fn default() -> Self {
        Self {
            diameter: 16.0,
            pitch: 2.0,
            length: None,
            segments: 144,
            flank_segments: 1,
            lead_in: None,
            across_flats: None,
            head_height: None,
        }
    }
}

impl IsoBolt {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "IsoBolt" };
        let (diameter, pitch) = (self.diameter, self.pitch);
        check_thread(&checked, diameter, pitch, self.segments, self.flank_segments)?;
        let length = self.length.unwrap_or(3.0 * diameter);
        let reason = "2 to 1000 pitches";
        checked.within("length", length, [2.0 * pitch, 1e3 * pitch], reason)?;
        let lead_in = self.lead_in.unwrap_or_else(|| default_lead_in(pitch));
        check_lead_in(&checked, lead_in, pitch)?;
        let across_flats = self.across_flats.unwrap_or(1.5 * diameter);
        check_flats(&checked, across_flats, diameter)?;
        let head_height = self.head_height.unwrap_or(0.625 * diameter);
        checked.detail(
            "head_height",
            head_height,
            diameter,
            4.0 * diameter,
            "up to 4 diameters",
        )?;

        let thread = Thread {
            pitch,
            crest: 0.5 * diameter,
            segments: self.segments,
            flank_segments: self.flank_segments,
            ends: [0.0, length],
        };
        checked.faces(thread.faces())?;
        let tip =
            Chamfer { z: length, radius: thread.crest - lead_in, slope: -1.0, keep: Keep::Inner };
        let mut builder = MeshBuilder::default();
        let [neck, rim] = thread.build(&mut builder, &[tip], Facing::Outward);
        disc(&mut builder, &rim, length);
        let under = hexagon(&mut builder, across_flats, 0.0);
        let top = hexagon(&mut builder, across_flats, -head_height);
        collar(&mut builder, &neck, &under, true);
        builder.band(&top, &under);
        for k in 1..5 {
            builder.triangle(top[0], top[k + 1], top[k]);
        }
        builder.finish(checked.shape)
    }
}

/// A hexagon nut for the [`IsoBolt`] of the same diameter and pitch: axis z, centred at the origin,
/// from `z = -height / 2` to `z = height / 2`. Its thread is the bolt's, moved outward by the
/// radial clearance (so flanks are `clearance / 2` apart when centred, measured along their
/// normal), and in the same phase in its own frame: at a height that is a multiple of the pitch the
/// nut fits unturned, elsewhere turned about z by `2 pi z / pitch`.
///
/// With equal segments and flank segments, and turned by a whole number of segments, it fits with
/// any clearance beyond rounding; otherwise the clearance must exceed the bolt's chord error (see
/// there). The default has about 22,200 triangles: its flanks are cut finer than the bolt's.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct IsoNut {
    /// Major diameter of the bolt that it fits, scene units (millimetres, usually). Default: 16.
    pub diameter: f64,
    /// Climb of the helix a turn; a thousandth to a quarter of the diameter. Default: 2.
    pub pitch: f64,
    /// Radial clearance, at most the thread's depth. Default: 0.1.
    pub clearance: f64,
    /// Extent along z, 2 to 1,000 pitches. Default: 0.9 diameters.
    #[serde(deserialize_with = "some")]
    pub height: Option<f64>,
    /// Segments around the axis, at least 12. Default: 144.
    pub segments: u32,
    /// Chords of each flank along the profile, at least 1. Default: 4.
    pub flank_segments: u32,
    /// How far beyond the inner crest the 45 degree lead-ins at both faces begin; 0 for none.
    /// Default: a sixteenth of a pitch more than the thread is deep, so that both mouths are round.
    #[serde(deserialize_with = "some")]
    pub lead_in: Option<f64>,
    /// Width across flats, at least 1.2 times the mouth. Default: 1.5 diameters.
    #[serde(deserialize_with = "some")]
    pub across_flats: Option<f64>,
}

impl Default for IsoNut {
    fn default() -> Self {
        Self {
            diameter: 16.0,
            pitch: 2.0,
            clearance: 0.1,
            height: None,
            segments: 144,
            flank_segments: 4,
            lead_in: None,
            across_flats: None,
        }
    }
}

impl IsoNut {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "IsoNut" };
        let (diameter, pitch) = (self.diameter, self.pitch);
        check_thread(&checked, diameter, pitch, self.segments, self.flank_segments)?;
        let depth = thread_depth(pitch);
        let reason = "0 to the depth of the thread";
        checked.within("clearance", self.clearance, [0.0, depth], reason)?;
        let height = self.height.unwrap_or(0.9 * diameter);
        let reason = "2 to 1000 pitches";
        checked.within("height", height, [2.0 * pitch, 1e3 * pitch], reason)?;
        let lead_in = self.lead_in.unwrap_or_else(|| default_lead_in(pitch));
        check_lead_in(&checked, lead_in, pitch)?;

        let thread = Thread {
            pitch,
            crest: 0.5 * diameter + self.clearance,
            segments: self.segments,
            flank_segments: self.flank_segments,
            ends: [-0.5 * height, 0.5 * height],
        };
        checked.faces(thread.faces())?;
        let mouth = thread.crest - depth + lead_in;
        let across_flats = self.across_flats.unwrap_or(1.5 * diameter);
        check_flats(&checked, across_flats, 2.0 * mouth.max(thread.crest))?;
        let chamfer = |z, slope| Chamfer { z, radius: mouth, slope, keep: Keep::Outer };
        let chamfers = [chamfer(thread.ends[0], -1.0), chamfer(thread.ends[1], 1.0)];
        let mut builder = MeshBuilder::default();
        let mouths = thread.build(&mut builder, &chamfers, Facing::Inward);
        let faces = thread.ends.map(|z| hexagon(&mut builder, across_flats, z));
        collar(&mut builder, &mouths[0], &faces[0], false);
        collar(&mut builder, &mouths[1], &faces[1], true);
        builder.band(&faces[0], &faces[1]);
        builder.finish(checked.shape)
    }
}

fn default_lead_in(pitch: f64) -> f64 {
    thread_depth(pitch) + 0.0625 * pitch
}

/// Half a pitch beyond the thread's depth at most: both ends' cones then stay apart.
fn check_lead_in(checked: &Checked, lead_in: f64, pitch: f64) -> Result<(), ShapeError> {
    let most = thread_depth(pitch) + 0.4 * pitch;
    if lead_in == 0.0 {
        return Ok(());
    }
    checked.detail("lead_in", lead_in, pitch, most, "0, or up to 0.94 pitches")
}

fn check_flats(checked: &Checked, across_flats: f64, hole: f64) -> Result<(), ShapeError> {
    let range = [MIN_FLATS * hole * (1.0 - MIN_DETAIL), 4.0 * hole];
    checked.within("across_flats", across_flats, range, "1.2 to 4 diameters of the hole")
}

/// Reads a plain number where the default depends on other parameters.
fn some<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    f64::deserialize(deserializer).map(Some)
}
