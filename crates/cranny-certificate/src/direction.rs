//! Directions along which two groups of faces are compared.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::exact::{Vector, cross, dot, minus, normal, times};

/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A corner, 0 to 2: `v0`.
    Corner(u8),
    /// The side from corner `i` to the next: `e0`.
    Side(u8),
    /// The whole: `f`.
    Face,
}

/// A part of a face of the first body and one of the second; stands for the direction of the
/// shortest way between the points, lines or planes that the two span.
///
/// Of two triangles that are apart there is always one that parts them, since two nearest points
/// lie on some two parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Parts(pub Part, pub Part);

impl Parts {
    /// All that have a direction.
    pub fn all() -> impl Iterator<Item = Self> {
        let corners = || (0..3).map(Part::Corner);
        let sides = || (0..3).map(Part::Side);
        let of_faces = [Self(Part::Face, Part::Corner(0)), Self(Part::Corner(0), Part::Face)];
        let mixed =
            corners().flat_map(move |c| sides().flat_map(move |s| [Self(c, s), Self(s, c)]));
        let lines = sides().flat_map(move |s| sides().map(move |t| Self(s, t)));
        let points = corners().flat_map(move |c| corners().map(move |d| Self(c, d)));
        of_faces.into_iter().chain(lines).chain(mixed).chain(points)
    }

    /// The direction, of any length and sense; zero where the parts have none.
    pub(crate) fn direction(self, a: &[Vector; 3], b: &[Vector; 3]) -> Vector {
        match (self.0, self.1) {
            (Part::Face, _) => normal(a),
            (_, Part::Face) => normal(b),
            (Part::Side(i), Part::Side(j)) => cross(&side(a, i).1, &side(b, j).1),
            (Part::Corner(i), Part::Corner(j)) => minus(corner(b, j), corner(a, i)),
            (Part::Corner(i), Part::Side(j)) => away(corner(a, i), side(b, j)),
            (Part::Side(i), Part::Corner(j)) => away(corner(b, j), side(a, i)),
        }
    }
}

/// Numbers beyond the third begin again: any direction may be tried.
fn corner(triangle: &[Vector; 3], i: u8) -> &Vector {
    &triangle[i as usize % 3]
}

/// Where a side starts, and where it leads.
fn side(triangle: &[Vector; 3], i: u8) -> (&Vector, Vector) {
    let (from, to) = (corner(triangle, i), &triangle[(i as usize + 1) % 3]);
    (from, minus(to, from))
}

/// From a line at right angles to a point, times the squared length of the line's vector.
fn away(point: &Vector, (start, along): (&Vector, Vector)) -> Vector {
    let way = minus(point, start);
    minus(&times(&way, &dot(&along, &along)), &times(&along, &dot(&way, &along)))
}

impl Display for Part {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Corner(i) => write!(f, "v{i}"),
            Self::Side(i) => write!(f, "e{i}"),
            Self::Face => write!(f, "f"),
        }
    }
}

impl From<Parts> for String {
    fn from(parts: Parts) -> Self {
        format!("{}{}", parts.0, parts.1)
    }
}

impl TryFrom<String> for Parts {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl FromStr for Parts {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::all().chain([Self(Part::Face, Part::Face)]);
        found.into_iter().find(|&parts| String::from(parts) == text).ok_or_else(|| {
            format!(
                "'{text}' names no two parts of triangles, such as \"fv0\", \"e1e2\" or \"v0e1\""
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::is_zero;
    use dashu_int::IBig;

    fn triangle(corners: [[i64; 3]; 3]) -> [Vector; 3] {
        corners.map(|p| p.map(IBig::from))
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        for parts in Parts::all() {
            assert_eq!(String::from(parts).parse(), Ok(parts));
        }
        assert_eq!(Parts::all().count(), 2 + 9 + 18 + 9);
        for wrong in ["", "f", "v3e0", "e0", "v0e1x"] {
            assert!(wrong.parse::<Parts>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn directions_lead_from_part_to_part() {
        let floor = triangle([[0, 0, 0], [4, 0, 0], [0, 4, 0]]);
        let above = triangle([[1, 1, 2], [5, 1, 2], [1, 9, 2]]);
        for (name, expected) in [("fv0", [0, 0, 16]), ("v0v0", [1, 1, 2]), ("v0e0", [0, -16, -32])]
        {
            let parts: Parts = name.parse().unwrap();
            assert_eq!(parts.direction(&floor, &above), expected.map(IBig::from), "{name}");
        }
        let parallel: Parts = "e0e0".parse().unwrap();
        assert!(is_zero(&parallel.direction(&floor, &above)));
    }
}
