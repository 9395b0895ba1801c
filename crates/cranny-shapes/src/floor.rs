//! A slab cut into squares: level ground with many inner edges.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    builder::MeshBuilder,
    error::{Checked, ShapeError},
};

/// The most squares along an axis.
const MAX_SQUARES: u32 = 1 << 11;

/// A slab whose top, at `z = 0`, is cut into equal squares (or oblongs) with diagonals that
/// alternate; x and y are centred. All of the top is in one plane, to the bit. `2 n m` triangles on
/// top, and as many below.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Floor {
    /// Edge lengths along x, y and z, scene units. Default: 10, 10 and 1.
    pub size: [f64; 3],
    /// Squares along x and y, at least 1 each. Default: 10 each.
    pub squares: [u32; 2],
}

impl Default for Floor {
    fn default() -> Self {
        Self { size: [10.0, 10.0, 1.0], squares: [10, 10] }
    }
}

impl Floor {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above, [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Floor" };
        for (name, size) in ["size x", "size y", "size z"].into_iter().zip(self.size) {
            checked.length(name, size)?;
        }
        let [n, m] = self.squares;
        for (name, count) in [("squares x", n), ("squares y", m)] {
            checked.count(name, count, 1, MAX_SQUARES)?;
        }
        checked.faces(4 * (u64::from(n) * u64::from(m) + u64::from(n) + u64::from(m)))?;

        let [width, length, thickness] = self.size;
        let along = |k: u32, count: u32, size: f64| size * (f64::from(k) / f64::from(count) - 0.5);
        let mut builder = MeshBuilder::default();
        let mut level = |z: f64| -> Vec<u32> {
            let corners = (0..=n).flat_map(|i| (0..=m).map(move |j| (i, j)));
            corners
                .map(|(i, j)| {
                    builder.vertex(DVec3::new(along(i, n, width), along(j, m, length), z))
                })
                .collect()
        };
        let (top, bottom) = (level(0.0), level(-thickness));
        let at = |i: u32, j: u32| (i * (m + 1) + j) as usize;
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            let around = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let first = ((i + j) % 2) as usize; // where the diagonal begins
            let corner = |level: &[u32], k: usize| level[around[(first + k) % 4]];
            builder.quad(corner(&top, 0), corner(&top, 1), corner(&top, 2), corner(&top, 3));
            builder.quad(
                corner(&bottom, 0),
                corner(&bottom, 3),
                corner(&bottom, 2),
                corner(&bottom, 1),
            );
        }
        let rim = (0..n)
            .map(|i| at(i, 0))
            .chain((0..m).map(|j| at(n, j)))
            .chain((0..n).map(|i| at(n - i, m)))
            .chain((0..m).map(|j| at(0, m - j)));
        let (low, high): (Vec<u32>, Vec<u32>) = rim.map(|k| (bottom[k], top[k])).unzip();
        builder.band(&low, &high);
        builder.finish(checked.shape)
    }
}
