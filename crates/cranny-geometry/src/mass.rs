//! Volume, centre and inertia of the solid that a closed mesh bounds.
//!
//! Signed tetrahedra from a reference point to every face (Mirtich, 'Fast and accurate computation
//! of polyhedral mass properties', 1996, uses the same divergence argument). The reference is the
//! centre of the bounding box, so that a body far from its origin loses no digits.

use cranny_exact::{DMat3, DVec3};

use crate::ids::FaceId;
use crate::mesh::Mesh;

/// Of a solid of density 1, in the body's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Volume, negative where the mesh is inside out. Unit: length^3.
    pub volume: f64,
    /// Centre of mass.
    pub center: DVec3,
    /// Inertia tensor about the centre of mass. Unit: length^5.
    pub inertia: DMat3,
}

impl MassProperties {
    /// Integrates over a closed, oriented mesh. For others the result means nothing.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let reference = mesh.bounds().center();
        let (mut volume, mut first) = (0.0, DVec3::ZERO);
        // xx, yy, zz and xy, yz, zx.
        let [mut squares, mut mixed] = [DVec3::ZERO; 2];
        for face in (0..mesh.faces().len() as u32).map(FaceId) {
            let [a, b, c] = mesh.triangle(face).map(|p| p - reference);
            let six_volume = a.dot(b.cross(c));
            let sum = a + b + c;
            volume += six_volume / 6.0;
            first += six_volume / 24.0 * sum;
            // Integral of x xᵀ over the tetrahedron (0, a, b, c).
            let share = six_volume / 120.0;
            squares += (a * a + b * b + c * c + sum * sum) * share;
            let turned = |v: DVec3| DVec3::new(v.y, v.z, v.x);
            let products = a * turned(a) + b * turned(b) + c * turned(c) + sum * turned(sum);
            mixed += products * share;
        }
        let second = DMat3::from_cols(
            DVec3::new(squares.x, mixed.x, mixed.z),
            DVec3::new(mixed.x, squares.y, mixed.y),
            DVec3::new(mixed.z, mixed.y, squares.z),
        );
        let offset = if volume == 0.0 { DVec3::ZERO } else { first / volume };
        let central = second - outer(offset) * volume;
        let trace = central.x_axis.x + central.y_axis.y + central.z_axis.z;
        Self {
            volume,
            center: reference + offset,
            inertia: DMat3::from_diagonal(DVec3::splat(trace)) - central,
        }
    }
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cuboid_far_from_the_origin() {
        let far = DVec3::new(1e4, -3e4, 2e4);
        let corner = |i: u32| {
            far + DVec3::new((i & 1) as f64, 2.0 * ((i >> 1) & 1) as f64, 3.0 * (i >> 2) as f64)
        };
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mesh = Mesh::new((0..8).map(corner).collect(), faces).unwrap();
        let mass = MassProperties::of(&mesh);
        assert!((mass.volume - 6.0).abs() < 1e-10);
        assert!((mass.center - far - DVec3::new(0.5, 1.0, 1.5)).length() < 1e-9);
        // m / 12 (b² + c²) and so on, for edges 1, 2, 3 and mass 6.
        let expected = DMat3::from_diagonal(DVec3::new(6.5, 5.0, 2.5));
        let error = (mass.inertia - expected).to_cols_array().map(f64::abs);
        assert!(error.into_iter().all(|e| e < 1e-9), "{error:?}");
        let inside_out = MassProperties::of(&mesh.turned_inside_out());
        assert!((inside_out.volume + 6.0).abs() < 1e-10);
    }
}
