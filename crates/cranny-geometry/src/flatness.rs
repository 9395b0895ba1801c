//! How flat is flat: by how much coordinates, rounded as they were stored, leave the plane they
//! were meant for.
//!
//! No source: this crate's own, each number with its reason. Cost: passes over the coordinates, as
//! many as `resolution` takes.

use crate::hull::FLATNESS;
use crate::mesh::Mesh;
use crate::resolution::{is_single, largest, rounding_step, written_step};

/// How far from a plane, relative to the largest coordinate magnitude, points may lie that are
/// meant to lie in it: the rounding of the coordinates as they were stored. Facets of the hull are
/// merged by it, and what lies no deeper beneath them is on the hull.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Flatness {
    /// Read off the coordinates; which flatness was taken is in the report.
    ///
    /// Numbers rounded to a grid (few decimals, whatever unit they were scaled to since), or to few
    /// significant digits, give [`GRID_STEPS`](Self::GRID_STEPS) of the grid, or of the last digit
    /// of the largest, at most [`GRID_LIMIT`](Self::GRID_LIMIT) of the body's extent and at least
    /// what follows. Where all numbers are round ones, of ten steps, or small ones, of a few,
    /// counted from 0 or from the corner of the body's box, the body was drawn on the grid, and the
    /// grid says nothing. [`Single`](Self::Single) where every coordinate has no more than nine
    /// digits, with which such numbers are written, or is a number of single precision; otherwise
    /// [`Double`](Self::Double). Turned after it was read, a mesh no longer shows how it was
    /// written: then say it by [`Single`](Self::Single) or [`Relative`](Self::Relative).
    #[default]
    Auto,
    /// Coordinates are rounded to `f64`: [`FLATNESS`].
    Double,
    /// Coordinates are rounded to `f32`: [`Flatness::SINGLE`].
    Single,
    /// This much; at least [`LEAST`](Self::LEAST), `NaN` counting as that.
    Relative(f64),
}

impl Flatness {
    /// How exactly a plane is measured that points lie on. Smaller, and rounding of the measurement
    /// alone distinguishes sides that are flat to the last digit
    /// (`drawn_sides_are_flat_at_any_flatness`); larger, and a quarter of [`FLATNESS`], which tests
    /// use, is not to be had.
    pub const LEAST: f64 = 4.0 * f64::EPSILON;

    /// Rounding to `f32` moves a point by up to 2^-24 of each coordinate, so of a plane's points,
    /// the plane being given by three of them, up to a few times that. Smaller, and the quads of a
    /// torus stored so are not flat (`a_torus_is_one_passage_however_it_is_rounded`); larger, and
    /// shallow marks on a surface are taken for rounding.
    pub const SINGLE: f64 = 2e-7;

    /// Rounding to a grid moves a point by up to half a diagonal of a cell, 0.87 of a step, and so
    /// the plane through three others. Smaller, and a torus written with six decimals has dents
    /// (`decimals_make_no_dents`); larger, and marks a few steps deep are taken for rounding.
    pub const GRID_STEPS: f64 = 2.0;

    /// A share of the greatest coordinate magnitude or of the greatest extent, whichever is less.
    /// On a coarse lattice (whole numbers) the step says nothing of precision. Smaller, and nuts of
    /// 15 mm written in metres with six decimals, a step of 7e-5, have dents; larger, and pockets
    /// of a thousandth of the body are taken for rounding (`shallow_pockets_on_a_lattice_stay`).
    pub const GRID_LIMIT: f64 = 1.5e-4;

    /// The step of nine digits is no less than this share of the largest number. Smaller, and all
    /// large numbers of double precision, whole as they are, pass for written ones; larger, and
    /// numbers of single precision that were written so are taken for exact.
    const NINE_DIGITS: f64 = 1e-9;

    /// As a share of the largest coordinate magnitude, for this mesh.
    #[must_use]
    pub fn resolve(self, mesh: &Mesh) -> f64 {
        match self {
            Self::Auto => {
                let (largest, bounds) = (largest(mesh), mesh.bounds());
                let share = |step: Option<f64>| step.map_or(0.0, |step| step / largest);
                let is_single = is_single(mesh) || share(written_step(mesh)) >= Self::NINE_DIGITS;
                let step = share(rounding_step(mesh));
                let binary = if is_single { Self::SINGLE } else { FLATNESS };
                // A body far from the origin is no larger for it.
                let extent = (bounds.max - bounds.min).max_element().min(largest) / largest;
                binary.max((Self::GRID_STEPS * step).min(Self::GRID_LIMIT * extent))
            }
            Self::Double => FLATNESS,
            Self::Single => Self::SINGLE,
            Self::Relative(flatness) => flatness.max(Self::LEAST),
        }
    }

    /// As a distance from a plane, for this mesh.
    #[must_use]
    pub fn distance(self, mesh: &Mesh) -> f64 {
        self.resolve(mesh) * largest(mesh)
    }
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

    use super::*;

    #[test]
    fn a_grid_says_no_more_of_a_body_far_away_than_its_size_allows() {
        let far = [[0.0; 3], [1_237.0, 0.0, 3.0], [0.0, 4_311.0, 0.0], [3.0, 1.0, 2_501.0]]
            .map(|c| DVec3::splat(1e6) + DVec3::from_array(c));
        let mesh = Mesh::new(far.to_vec(), vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let most = Flatness::GRID_LIMIT * 4_311.0;
        assert!((Flatness::Auto.distance(&mesh) / most - 1.0).abs() < 1e-12);
    }
}
