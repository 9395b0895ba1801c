//! Volume, centre and inertia of the solid that a closed mesh bounds.
//!
//! Signed tetrahedra from a reference point to every face (Mirtich, 'Fast and accurate computation
//! of polyhedral mass properties', 1996, uses the same divergence argument). The reference is the
//! centre of the bounding box, so that a body far from its origin loses no digits.

use cranny_exact::{DMat3, DVec3};

use crate::ids::FaceId;
use crate::mesh::Mesh;

/// Roundings of a tetrahedron's volume, each by at most half an ulp of the sum of its products' magnitudes: three
/// differences, two products and two sums a term, and the division. Fewer, and sheets back to back may have a volume,
/// of either sign; more, and thin solids whose faces lie slanted have none.
const ROUNDINGS: f64 = 16.0;

/// Of a solid of density 1, in the body's frame. What holds no more than rounding could have left of nothing has
/// volume and inertia 0, and its centre is that of its box.
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
    /// Integrates over a closed, oriented mesh. For others the result means nothing. O(n).
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let reference = mesh.bounds().center();
        let (mut volume, mut first) = (0.0, DVec3::ZERO);
        // Of all products that are added up, regardless of sign: sums round in proportion to it.
        let mut magnitude = 0.0;
        // xx, yy, zz and xy, yz, zx.
        let [mut squares, mut mixed] = [DVec3::ZERO; 2];
        for face in (0..mesh.faces().len() as u32).map(FaceId) {
            let [a, b, c] = mesh.triangle(face).map(|p| p - reference);
            let six_volume = a.dot(b.cross(c));
            let sum = a + b + c;
            volume += six_volume / 6.0;
            let [p, q, r] = [a.abs(), b.abs(), c.abs()];
            let products =
                DVec3::new(q.y * r.z + q.z * r.y, q.z * r.x + q.x * r.z, q.x * r.y + q.y * r.x);
            magnitude += p.dot(products);
            first += six_volume / 24.0 * sum;
            // Integral of x xᵀ over the tetrahedron (0, a, b, c).
            let share = six_volume / 120.0;
            squares += (a * a + b * b + c * c + sum * sum) * share;
            let turned = |v: DVec3| DVec3::new(v.y, v.z, v.x);
            let products = a * turned(a) + b * turned(b) + c * turned(c) + sum * turned(sum);
            mixed += products * share;
        }
        let roundings = ROUNDINGS + mesh.faces().len() as f64;
        if volume.abs() <= 0.5 * f64::EPSILON * roundings * magnitude / 6.0 {
            return Self { volume: 0.0, center: reference, inertia: DMat3::ZERO };
        }
        let second = DMat3::from_cols(
            DVec3::new(squares.x, mixed.x, mixed.z),
            DVec3::new(mixed.x, squares.y, mixed.y),
            DVec3::new(mixed.z, mixed.y, squares.z),
        );
        let offset = first / volume;
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

    fn brick(size: DVec3, turn: DMat3) -> Mesh {
        let corner = |i: u32| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh::new((0..8).map(|i| turn * (size * corner(i))).collect(), faces).unwrap()
    }

    #[test]
    fn what_rounding_leaves_of_nothing_is_nothing_and_thin_things_have_their_volume() {
        let (s, c) = (0.6, 0.8);
        let about_z = DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z);
        let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c));
        for turn in [DMat3::IDENTITY, about_z, about_z * about_x] {
            for thin in [1e-13, 1e-8, 1e-3] {
                let mass = MassProperties::of(&brick(DVec3::new(1.0, 2.0, thin), turn));
                assert!((mass.volume - 2.0 * thin).abs() <= 0.02 * thin, "{thin}: {mass:?}");
            }
            let flat = brick(DVec3::new(1.0, 2.0, 0.0), turn);
            for mesh in [flat.clone().turned_inside_out(), flat] {
                let mass = MassProperties::of(&mesh);
                assert_eq!((mass.volume, mass.inertia), (0.0, DMat3::ZERO), "{mass:?}");
                assert_eq!(mass.center, mesh.bounds().center());
            }
        }
        let wire = MassProperties::of(&brick(DVec3::new(1.0, 1e-8, 1e-8), DMat3::IDENTITY));
        assert!((wire.volume / 1e-16 - 1.0).abs() < 1e-9, "{wire:?}");
    }

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
