//! What a house consists of: walls with openings, chairs, tables, shelves, tubs, lamps.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    blocks::Blocks,
    builder::directions,
    error::{Checked, MIN_DETAIL, ShapeError},
    lathe::{Profile, lathe},
    round::MAX_SEGMENTS,
};

/// Leaves room beside a part.
const ALMOST: f64 = 1.0 - MIN_DETAIL;

/// The most openings, compartments and the like of one body.
const MAX_PARTS: u32 = 64;

/// A wall along x from the origin, standing on `z = 0`, its thickness centred on `y = 0`, with
/// openings right through: doorways where they begin at the floor, else windows.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wall {
    /// Extent along x, scene units. Default: 4.
    pub length: f64,
    /// Extent along z. Default: 2.5.
    pub height: f64,
    /// Extent along y. Default: 0.2.
    pub thickness: f64,
    /// At most 64: x and z of the lower left corner, then of the upper right one. They lie in the
    /// wall, may reach the floor, and do not touch each other. Default: a doorway and a window.
    pub openings: Vec<[f64; 4]>,
}

impl Default for Wall {
    fn default() -> Self {
        let openings = vec![[0.5, 0.0, 1.4, 2.0], [2.0, 0.9, 3.4, 2.0]];
        Self { length: 4.0, height: 2.5, thickness: 0.2, openings }
    }
}

impl Wall {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::Pinched`] where openings
    /// touch.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Wall" };
        let (l, h, t) = (self.length, self.height, self.thickness);
        for (name, value) in [("length", l), ("height", h), ("thickness", t)] {
            checked.length(name, value)?;
        }
        checked.count("openings", self.openings.len() as u32, 0, MAX_PARTS)?;
        let mut wall = Blocks::default().add([0.0, -0.5 * t, 0.0], [l, 0.5 * t, h]);
        for &[left, bottom, right, top] in &self.openings {
            let [side, lintel] = [MIN_DETAIL * l, MIN_DETAIL * h];
            checked.within("an opening's left side", left, [side, l], "within the wall")?;
            checked.within(
                "an opening's right side",
                right,
                [left + side, l - side],
                "within it",
            )?;
            checked.within("an opening's lower side", bottom, [0.0, h], "at the floor or above")?;
            let range = [bottom + lintel, h - lintel];
            checked.within("an opening's upper side", top, range, "below the wall's top")?;
            wall = wall.cut([left, -t, bottom], [right, t, top]);
        }
        wall.build(&checked)
    }
}

/// A chair that stands on `z = 0`, centred about z, its back at +y: four legs, a seat, and a back
/// of two posts and three slats.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Chair {
    /// Extent along x and y, scene units. Default: 0.44.
    pub width: f64,
    /// Height of the seat. Default: 0.45.
    pub seat: f64,
    /// Height of the back's top, more than the seat's. Default: 0.92.
    pub back: f64,
    /// Thickness of legs, seat and slats; at most a fifth of width, seat and rise of the back.
    /// Default: 0.04.
    pub thickness: f64,
}

impl Default for Chair {
    fn default() -> Self {
        Self { width: 0.44, seat: 0.45, back: 0.92, thickness: 0.04 }
    }
}

impl Chair {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Chair" };
        let Self { width, seat, back, thickness: t } = *self;
        checked.length("width", width)?;
        checked.length("seat", seat)?;
        checked.within(
            "back",
            back,
            [seat * (1.0 + MIN_DETAIL), seat / MIN_DETAIL],
            "above the seat",
        )?;
        let rise = back - seat;
        let most = 0.2 * width.min(seat).min(rise);
        checked.detail("thickness", t, width.max(back), most, "a fifth of what it carries")?;
        let (e, i) = (0.5 * width, 0.5 * width - t);
        let mut chair = Blocks::default().add([-e, -e, seat - t], [e, e, seat]);
        for (x0, x1) in [(-e, -i), (i, e)] {
            chair = chair.add([x0, -e, 0.0], [x1, -i, seat]).add([x0, i, 0.0], [x1, e, back]);
        }
        for share in [0.3, 0.6, 0.9] {
            let z = seat + share * rise;
            chair = chair.add([-e, i + 0.25 * t, z], [e, e - 0.25 * t, z + 0.1 * rise]);
        }
        chair.build(&checked)
    }
}

/// A table that stands on `z = 0`, centred about z: four legs, a top, and stretchers between the
/// legs.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Extent along x, y and z, scene units. Default: 1.6, 0.9, 0.75.
    pub size: [f64; 3],
    /// Thickness of the top, and half that of the legs; at most an eighth of each extent.
    /// Default: 0.04.
    pub thickness: f64,
}

impl Default for Table {
    fn default() -> Self {
        Self { size: [1.6, 0.9, 0.75], thickness: 0.04 }
    }
}

impl Table {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Table" };
        sizes(&checked, self.size)?;
        let ([l, w, h], t) = (self.size, self.thickness);
        let (least, greatest) = (l.min(w).min(h), l.max(w).max(h));
        checked.detail("thickness", t, greatest, 0.125 * least, "an eighth of the extents")?;
        let [x, y] = [0.5 * l, 0.5 * w];
        let mut table = Blocks::default().add([-x, -y, h - t], [x, y, h]);
        let [fx, fy] = [x - t, y - t]; // feet stand back
        for (x0, x1) in [(-fx, -fx + 2.0 * t), (fx - 2.0 * t, fx)] {
            for (y0, y1) in [(-fy, -fy + 2.0 * t), (fy - 2.0 * t, fy)] {
                table = table.add([x0, y0, 0.0], [x1, y1, h]);
            }
            // A stretcher at a quarter of the height, and one along x between them.
            let inner = [x0 + 0.5 * t, x1 - 0.5 * t];
            table = table.add([inner[0], -fy, 0.25 * h], [inner[1], fy, 0.25 * h + t]);
        }
        table.add([-fx + t, -0.5 * t, 0.25 * h], [fx - t, 0.5 * t, 0.25 * h + t]).build(&checked)
    }
}

/// A shelf that stands on `z = 0`, centred about z, open towards -y: sides, a back, and boards that
/// make levels and columns of equal compartments.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Shelf {
    /// Extent along x, y and z, scene units. Default: 1, 0.3, 1.8.
    pub size: [f64; 3],
    /// Compartments above each other, at least 1. Default: 5.
    pub levels: u32,
    /// Compartments beside each other, at least 1. Default: 1.
    pub columns: u32,
    /// Thickness of boards; at most half a compartment's share. Default: 0.02.
    pub board: f64,
}

impl Default for Shelf {
    fn default() -> Self {
        Self { size: [1.0, 0.3, 1.8], levels: 5, columns: 1, board: 0.02 }
    }
}

impl Shelf {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Shelf" };
        sizes(&checked, self.size)?;
        checked.count("levels", self.levels, 1, MAX_PARTS)?;
        checked.count("columns", self.columns, 1, MAX_PARTS)?;
        let ([l, w, h], b) = (self.size, self.board);
        let [columns, levels] = [self.columns, self.levels].map(f64::from);
        let [wide, high] = [(l - b) / columns, (h - b) / levels];
        let most = 0.5 * w.min(l / (columns + 1.0)).min(h / (levels + 1.0));
        checked.detail("board", b, l.max(w).max(h), most, "half a compartment's share")?;
        let [x, y] = [0.5 * l, 0.5 * w];
        let mut shelf = Blocks::default().add([-x, -y, 0.0], [x, y, h]);
        for (i, k) in (0..self.columns).flat_map(|i| (0..self.levels).map(move |k| (i, k))) {
            let [left, floor] = [-x + b + wide * f64::from(i), b + high * f64::from(k)];
            shelf = shelf.cut([left, -2.0 * y, floor], [left + wide - b, y - b, floor + high - b]);
        }
        shelf.build(&checked)
    }
}

/// A bathtub, a sink or a tray: it stands on `z = 0`, centred about z, open above, narrower below,
/// its corners as round as one likes.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tub {
    /// Outer extent along x, y and z at the rim, scene units. Default: 1.7, 0.75, 0.55.
    pub size: [f64; 3],
    /// Thickness of walls and floor, at most a quarter of each extent. Default: 0.05.
    pub wall: f64,
    /// 0: corners are square; 1: the outline is an ellipse. Default: 0.8.
    pub roundness: f64,
    /// Extent at the floor as a part of that at the rim, 0.1 to 1. Default: 0.75.
    pub taper: f64,
    /// Segments along each side, 2 to 256. Default: 12.
    pub segments: u32,
}

impl Default for Tub {
    fn default() -> Self {
        Self { size: [1.7, 0.75, 0.55], wall: 0.05, roundness: 0.8, taper: 0.75, segments: 12 }
    }
}

impl Tub {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Tub" };
        sizes(&checked, self.size)?;
        let ([l, w, h], t) = (self.size, self.wall);
        let most = 0.25 * l.min(w).min(h);
        checked.detail("wall", t, l.max(w).max(h), most, "a quarter of the extents")?;
        checked.within("roundness", self.roundness, [0.0, 1.0], "from square to elliptic")?;
        checked.within("taper", self.taper, [0.1, 1.0], "a part of the extent at the rim")?;
        checked.count("segments", self.segments, 2, 1 << 8)?;
        let [x, y] = [1.0 - 2.0 * t / l, 1.0 - 2.0 * t / w];
        let tub = Blocks::default()
            .add([-1.0, -1.0, 0.0], [1.0, 1.0, h])
            .cut([-x, -y, t], [x, y, 2.0 * h]);
        let piece = 2.0 / f64::from(self.segments);
        tub.bent(&checked, [piece, piece, f64::INFINITY], |p| {
            let scale = self.taper + (1.0 - self.taper) * p.z / h;
            let half = 0.5 * self.roundness;
            let round =
                [p.x * (1.0 - half * p.y * p.y).sqrt(), p.y * (1.0 - half * p.x * p.x).sqrt()];
            DVec3::new(0.5 * l * scale * round[0], 0.5 * w * scale * round[1], p.z)
        })
    }
}

/// A standing lamp about z, standing on `z = 0`: a foot, a pole, and a shade that is hollow from
/// below. `28 segments` triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Lamp {
    /// Height of the shade's top, scene units. Default: 1.6.
    pub height: f64,
    /// Radius of the foot, less than a quarter of the height. Default: 0.16.
    pub foot: f64,
    /// Radius of the shade's rim, less than half the height. Default: 0.25.
    pub shade: f64,
    /// Radius of the pole and thickness of foot and shade; at most a fifth of foot and shade.
    /// Default: 0.02.
    pub thickness: f64,
    /// Segments around the axis, at least 3. Default: 24.
    pub segments: u32,
}

impl Default for Lamp {
    fn default() -> Self {
        Self { height: 1.6, foot: 0.16, shade: 0.25, thickness: 0.02, segments: 24 }
    }
}

impl Lamp {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above.
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Lamp" };
        let Self { height: h, foot, shade, thickness: t, segments } = *self;
        checked.length("height", h)?;
        checked.detail("foot", foot, h, 0.25 * h, "a quarter of the height")?;
        checked.detail("shade", shade, h, 0.5 * h * ALMOST, "half the height")?;
        let most = 0.2 * foot.min(shade);
        checked.detail("thickness", t, h, most, "a fifth of foot and shade")?;
        checked.count("segments", segments, 3, MAX_SEGMENTS)?;
        let (rim, top) = (h - shade, 0.5 * shade); // height of the rim, radius of the top
        let profile = [
            (0.0, 0.0),
            (foot, 0.0),
            (foot, t),
            (2.0 * t, 2.0 * t),
            (t, 3.0 * t),
            (t, h - 2.0 * t),
            (top - t, h - 2.0 * t),
            (shade - t, rim),
            (shade, rim),
            (0.5 * (shade + top) + 0.1 * shade, 0.5 * (rim + h)),
            (top, h),
            (0.0, h),
        ]
        .map(|(r, z)| cranny_exact::DVec2::new(r, z));
        lathe(checked.shape, &directions(segments), &profile, Profile::Open)
    }
}

fn sizes(checked: &Checked, size: [f64; 3]) -> Result<(), ShapeError> {
    let named = ["size x", "size y", "size z"].into_iter().zip(size);
    named.into_iter().try_for_each(|(name, value)| checked.length(name, value))
}
