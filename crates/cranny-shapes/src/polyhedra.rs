//! Solids with a handful of faces: cuboid, tetrahedron, pyramid.

use cranny_exact::DVec3;
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    builder::MeshBuilder,
    error::{Checked, ShapeError},
};

/// A box with faces along the axes, centred at the origin: 8 vertices, 12 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Cuboid {
    /// Edge lengths along x, y and z, scene units. Default: 1 each.
    pub size: [f64; 3],
}

impl Default for Cuboid {
    fn default() -> Self {
        Self { size: [1.0; 3] }
    }
}

impl Cuboid {
    /// The mesh, in the frame said above. Coordinates are exactly half the sizes.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] for a size outside
    /// [`MIN_LENGTH`](crate::MIN_LENGTH) to [`MAX_LENGTH`](crate::MAX_LENGTH).
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Cuboid" };
        for (name, size) in ["size x", "size y", "size z"].into_iter().zip(self.size) {
            checked.length(name, size)?;
        }
        let half = 0.5 * DVec3::from_array(self.size);
        let mut builder = MeshBuilder::default();
        for z in [-half.z, half.z] {
            for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                builder.vertex(DVec3::new(x * half.x, y * half.y, z));
            }
        }
        builder.quad(3, 2, 1, 0);
        builder.quad(4, 5, 6, 7);
        builder.band(&[0, 1, 2, 3], &[4, 5, 6, 7]);
        builder.finish(checked.shape)
    }
}

/// A regular tetrahedron with its centroid at the origin and its four corners on alternate corners
/// of a cube along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tetrahedron {
    /// Length of each of the six edges, scene units. Default: 1.
    pub edge: f64,
}

impl Default for Tetrahedron {
    fn default() -> Self {
        Self { edge: 1.0 }
    }
}

impl Tetrahedron {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] for an edge outside
    /// [`MIN_LENGTH`](crate::MIN_LENGTH) to [`MAX_LENGTH`](crate::MAX_LENGTH).
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Tetrahedron" };
        checked.length("edge", self.edge)?;
        let half = self.edge / 8f64.sqrt();
        let mut builder = MeshBuilder::default();
        for signs in [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]] {
            builder.vertex(half * DVec3::from_array(signs));
        }
        for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] {
            builder.triangle(a, b, c);
        }
        builder.finish(checked.shape)
    }
}

/// A pyramid over a square with edges along x and y; axis z, apex up, centroid at the origin (so
/// the base lies at `z = -height / 4`). 5 vertices, 6 triangles.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Pyramid {
    /// Side of the square, scene units. Default: 1.
    pub base: f64,
    /// From the base to the apex, scene units. Default: 1.
    pub height: f64,
}

impl Default for Pyramid {
    fn default() -> Self {
        Self { base: 1.0, height: 1.0 }
    }
}

impl Pyramid {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] for a length outside
    /// [`MIN_LENGTH`](crate::MIN_LENGTH) to [`MAX_LENGTH`](crate::MAX_LENGTH).
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "Pyramid" };
        checked.length("base", self.base)?;
        checked.length("height", self.height)?;
        let (half, floor) = (0.5 * self.base, -0.25 * self.height);
        let mut builder = MeshBuilder::default();
        for [x, y] in [[-half, -half], [half, -half], [half, half], [-half, half]] {
            builder.vertex(DVec3::new(x, y, floor));
        }
        let apex = builder.vertex(DVec3::new(0.0, 0.0, 0.75 * self.height));
        builder.quad(3, 2, 1, 0);
        builder.band(&[0, 1, 2, 3], &[apex]);
        builder.finish(checked.shape)
    }
}
