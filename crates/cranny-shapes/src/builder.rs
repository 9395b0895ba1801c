//! Collects vertices and faces; rings of vertices and the bands between them.

use std::f64::consts::FRAC_PI_2;

use cranny_exact::{DVec2, DVec3};
use cranny_geometry::Mesh;

use crate::error::ShapeError;

/// A mesh in the making.
#[derive(Default)]
pub(crate) struct MeshBuilder {
    vertices: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
}

impl MeshBuilder {
    pub(crate) fn vertex(&mut self, p: DVec3) -> u32 {
        self.vertices.push(p);
        self.vertices.len() as u32 - 1
    }

    pub(crate) fn triangle(&mut self, a: u32, b: u32, c: u32) {
        self.faces.push([a, b, c]);
    }

    /// Two triangles that share the diagonal from `a` to `c`.
    pub(crate) fn quad(&mut self, a: u32, b: u32, c: u32, d: u32) {
        self.triangle(a, b, c);
        self.triangle(a, c, d);
    }

    /// A ring about the z axis at one height; a single vertex where `radius` is 0.
    pub(crate) fn ring(&mut self, directions: &[DVec2], radius: f64, z: f64) -> Vec<u32> {
        if radius == 0.0 {
            return vec![self.vertex(DVec3::new(0.0, 0.0, z))];
        }
        directions.iter().map(|&d| self.vertex((radius * d).extend(z))).collect()
    }

    /// The closed band between two rings of equal length, either of which may be one vertex. Seen
    /// from outside, `lower` runs to the right with `upper` above it.
    pub(crate) fn band(&mut self, lower: &[u32], upper: &[u32]) {
        let n = lower.len().max(upper.len());
        for i in 0..n {
            let j = (i + 1) % n;
            match (lower, upper) {
                (&[pole], _) => self.triangle(pole, upper[j], upper[i]),
                (_, &[pole]) => self.triangle(lower[i], lower[j], pole),
                _ => self.quad(lower[i], lower[j], upper[j], upper[i]),
            }
        }
    }

    pub(crate) fn finish(self, shape: &'static str) -> Result<Mesh, ShapeError> {
        Mesh::new(self.vertices, self.faces).map_err(|source| ShapeError::Mesh { shape, source })
    }
}

/// The unit vector at `2 pi i / n`. Its symmetries are exact: quarter turns give exact zeros and
/// ones, and mirrored angles give mirrored coordinates to the bit.
pub(crate) fn direction(i: u32, n: u32) -> DVec2 {
    let n = u64::from(n);
    let quarters = 4 * (u64::from(i) % n);
    let (quadrant, rest) = (quarters / n, quarters % n);
    let angle = |part: u64| FRAC_PI_2 * (part as f64 / n as f64);
    let (cos, sin) = if rest == 0 {
        (1.0, 0.0)
    } else if 2 * rest <= n {
        (angle(rest).cos(), angle(rest).sin())
    } else {
        (angle(n - rest).sin(), angle(n - rest).cos())
    };
    match quadrant {
        0 => DVec2::new(cos, sin),
        1 => DVec2::new(0.0 - sin, cos),
        2 => DVec2::new(-cos, 0.0 - sin),
        _ => DVec2::new(sin, -cos),
    }
}

/// All `n` directions, counter-clockwise from +x.
pub(crate) fn directions(n: u32) -> Vec<DVec2> {
    (0..n).map(|i| direction(i, n)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_the_rest_is_close() {
        assert_eq!(direction(0, 12), DVec2::X);
        assert_eq!(direction(3, 12), DVec2::Y);
        assert_eq!(direction(6, 12), -DVec2::X);
        assert_eq!(direction(9, 12), -DVec2::Y);
        for n in [3, 5, 7, 144] {
            for i in 0..n {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
                assert!((direction(i, n) - DVec2::from_angle(angle)).length() < 1e-14);
            }
        }
    }

    #[test]
    fn mirrored_angles_mirror_to_the_bit() {
        for i in 1..10 {
            let (d, m) = (direction(i, 20), direction(20 - i, 20));
            assert_eq!((d.x, d.y), (m.x, -m.y));
        }
    }
}
