//! Solids that a scene file describes itself: boxes put together, profiles turned about an axis.

use cranny_exact::{DVec2, Sign, orient2d};
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    blocks::Blocks,
    builder::directions,
    error::{Checked, MAX_LENGTH, ShapeError},
    lathe::{Profile, lathe},
    round::MAX_SEGMENTS,
};

/// A box: its least and its greatest corner.
pub type Corners = [[f64; 3]; 2];

/// The most boxes of one solid: with more, the grid of their coordinates has too many cells.
const MAX_BOXES: u32 = 256;

/// Boxes along the axes put together, less others that are cut out. What remains is one solid;
/// parts that would touch along an edge or at a corner only are refused. Coordinates nearer to each
/// other than a millionth of the extent count as one.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Boxes {
    /// Boxes that make up the solid, 1 to 256, scene units. Default: two that make an L.
    pub add: Vec<Corners>,
    /// Boxes that are cut out of all of them, at most 256. Default: none.
    pub cut: Vec<Corners>,
}

impl Default for Boxes {
    fn default() -> Self {
        let add = vec![[[0.0; 3], [1.0, 0.3, 0.3]], [[0.0; 3], [0.3, 0.3, 1.0]]];
        Self { add, cut: Vec::new() }
    }
}

impl Boxes {
    /// The mesh, in the frame of its coordinates.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::Pinched`],
    /// [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Boxes" };
        checked.count("add", self.add.len() as u32, 1, MAX_BOXES)?;
        checked.count("cut", self.cut.len() as u32, 0, MAX_BOXES)?;
        for [min, max] in self.add.iter().chain(&self.cut) {
            for (low, high) in min.iter().zip(max) {
                let range = [-MAX_LENGTH, MAX_LENGTH];
                checked.within("a least corner", *low, range, "a coordinate in scene units")?;
                checked.within("a greatest corner", *high, range, "a coordinate in scene units")?;
                checked.length("an extent from least to greatest corner", high - low)?;
            }
        }
        let added = self.add.iter().fold(Blocks::default(), |all, [min, max]| all.add(*min, *max));
        self.cut.iter().fold(added, |all, [min, max]| all.cut(*min, *max)).build(&checked)
    }
}

/// A profile turned about z. The profile is a polygon of points (distance from the axis, z) that
/// does not cross itself; where it begins and ends on the axis the solid is a lump, else a ring.
/// The vertices lie on the turned profile.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Lathe {
    /// At least 3 points, either way round, scene units. Default: a bowl.
    pub profile: Vec<[f64; 2]>,
    /// Segments around the axis, at least 3. Default: 32.
    pub segments: u32,
}

impl Default for Lathe {
    fn default() -> Self {
        let profile = [[0.0, 0.0], [0.3, 0.0], [0.5, 0.3], [0.46, 0.3], [0.27, 0.06], [0.0, 0.06]];
        Self { profile: profile.to_vec(), segments: 32 }
    }
}

impl Lathe {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::Outline`] where the
    /// profile crosses itself or touches the axis on its way, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Lathe" };
        checked.count("segments", self.segments, 3, MAX_SEGMENTS)?;
        checked.count("profile", self.profile.len() as u32, 3, MAX_SEGMENTS)?;
        checked.faces(2 * u64::from(self.segments) * self.profile.len() as u64)?;
        for &[radius, z] in &self.profile {
            checked.within("a radius", radius, [0.0, MAX_LENGTH], "a distance from the axis")?;
            checked.within("a height", z, [-MAX_LENGTH, MAX_LENGTH], "a coordinate")?;
        }
        let mut profile: Vec<DVec2> = self.profile.iter().copied().map(DVec2::from).collect();
        if doubled_area(&profile) < 0.0 {
            profile.reverse();
        }
        let on_axis = |p: &DVec2| p.x == 0.0;
        let ends = [0, profile.len() - 1].map(|end| on_axis(&profile[end]));
        let inner = profile[1..profile.len() - 1].iter().any(on_axis);
        let kind = match ends {
            [true, true] => Profile::Open,
            _ => Profile::Closed,
        };
        let half_open = ends[0] != ends[1];
        if inner || half_open || crosses_itself(&profile) {
            return Err(ShapeError::Outline { shape: checked.shape });
        }
        lathe(checked.shape, &directions(self.segments), &profile, kind)
    }
}

fn doubled_area(polygon: &[DVec2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(p, q)| p.perp_dot(*q)).sum()
}

/// Whether sides of a closed polygon meet elsewhere than at their common ends.
fn crosses_itself(polygon: &[DVec2]) -> bool {
    let n = polygon.len();
    let side = |k: usize| [polygon[k], polygon[(k + 1) % n]];
    let folds = |k: usize| {
        let ([p, q], [_, r]) = (side(k), side((k + 1) % n));
        p == q || orient2d(p, q, r).is_zero() && (r - q).dot(p - q) > 0.0
    };
    (0..n).any(folds)
        || (0..n)
            .any(|k| (k + 2..n).any(|l| !(k == 0 && l == n - 1) && segments_meet(side(k), side(l))))
}

fn segments_meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let signs = [(a, b, c), (a, b, d), (c, d, a), (c, d, b)].map(|(p, q, r)| orient2d(p, q, r));
    let within = |[p, q]: [DVec2; 2], r: DVec2| p.min(q).cmple(r).all() && r.cmple(p.max(q)).all();
    let touches = [([a, b], c), ([a, b], d), ([c, d], a), ([c, d], b)]
        .into_iter()
        .zip(signs)
        .any(|((side, point), sign)| sign.is_zero() && within(side, point));
    let opposite = |p: Sign, q: Sign| !p.is_zero() && !q.is_zero() && p != q;
    touches || opposite(signs[0], signs[1]) && opposite(signs[2], signs[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(profile: &[[f64; 2]]) -> bool {
        let lathe = Lathe { profile: profile.to_vec(), segments: 8 };
        lathe.build() == Err(ShapeError::Outline { shape: "Lathe" })
    }

    #[test]
    fn a_profile_that_crosses_or_touches_itself_is_refused() {
        let square = [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]];
        assert!(!refused(&square));
        assert!(refused(&[square[0], square[2], square[1], square[3]]), "it crosses");
        assert!(refused(&[[1.0, 0.0], [3.0, 0.0], [2.0, 0.0], [2.0, 1.0]]), "it turns back");
        let touching = [[1.0, 0.0], [3.0, 0.0], [3.0, 1.0], [2.0, 0.0], [1.0, 1.0]];
        assert!(refused(&touching), "a corner lies on a side");
        assert!(refused(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]), "it ends off the axis");
        assert!(refused(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.5], [1.0, 1.0], [0.0, 1.0]]));
    }

    #[test]
    fn either_way_round_gives_the_same_solid() {
        let bowl = Lathe::default();
        let profile = bowl.profile.iter().rev().copied().collect();
        assert_eq!(Lathe { profile, ..bowl.clone() }.build(), bowl.build());
    }
}
