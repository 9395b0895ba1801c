//! Cylinders and capsules of URDF: round about z, centred at the origin, inscribed.

use std::f64::consts::{FRAC_PI_2, TAU};

use cranny_exact::DVec3;
use cranny_geometry::{Mesh, MeshError};

/// Sides of a round body. Fewer, and the flat facets stand visibly inside the circle (by 2 % of the
/// radius at 16); more, and every link costs for roundness that its maker approximated anyway.
pub(super) const SEGMENTS: u32 = 32;

/// Rings of each cap of a capsule.
const CAP_RINGS: u32 = 8;

/// Caps flat, `length` from end to end.
pub(super) fn cylinder(radius: f64, length: f64) -> Result<Mesh, MeshError> {
    let h = 0.5 * length;
    stack(&[(0.0, -h), (radius, -h), (radius, h), (0.0, h)])
}

/// `length` between the centres of its half-spheres.
pub(super) fn capsule(radius: f64, length: f64) -> Result<Mesh, MeshError> {
    let h = 0.5 * length;
    let angle = |k: u32| FRAC_PI_2 * f64::from(k) / f64::from(CAP_RINGS);
    let mut profile = vec![(0.0, -h - radius)];
    profile.extend((1..=CAP_RINGS).map(|k| {
        let (sin, cos) = angle(k).sin_cos();
        (radius * sin, -h - radius * cos)
    }));
    profile.extend((0..CAP_RINGS).map(|k| {
        let (sin, cos) = angle(k).sin_cos();
        (radius * cos, h + radius * sin)
    }));
    profile.push((0.0, h + radius));
    stack(&profile)
}

/// Rings of (radius, height), from a pole at the bottom to a pole at the top.
fn stack(profile: &[(f64, f64)]) -> Result<Mesh, MeshError> {
    let n = SEGMENTS;
    let rings = &profile[1..profile.len() - 1];
    let mut vertices = vec![DVec3::new(0.0, 0.0, profile[0].1)];
    for &(radius, z) in rings {
        vertices.extend((0..n).map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
            DVec3::new(radius * cos, radius * sin, z)
        }));
    }
    let top = vertices.len() as u32;
    vertices.push(DVec3::new(0.0, 0.0, profile[profile.len() - 1].1));
    let at = |ring: usize, i: u32| 1 + ring as u32 * n + i % n;
    let mut faces = Vec::new();
    for i in 0..n {
        faces.push([0, at(0, i + 1), at(0, i)]);
        for ring in 1..rings.len() {
            let (a, b) = (at(ring - 1, i), at(ring - 1, i + 1));
            let (c, d) = (at(ring, i + 1), at(ring, i));
            faces.extend([[a, b, c], [a, c, d]]);
        }
        faces.push([top, at(rings.len() - 1, i), at(rings.len() - 1, i + 1)]);
    }
    Mesh::new(vertices, faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_geometry::MassProperties;
    use std::f64::consts::PI;

    #[test]
    fn volumes_approach_the_smooth_ones_from_inside() {
        let inscribed = |mesh: Mesh, smooth: f64| {
            let volume = MassProperties::of(&mesh).volume;
            assert!(volume < smooth && volume > 0.97 * smooth, "{volume} {smooth}");
        };
        inscribed(cylinder(0.5, 2.0).unwrap(), PI * 0.25 * 2.0);
        inscribed(capsule(0.5, 2.0).unwrap(), PI * 0.25 * 2.0 + 4.0 / 3.0 * PI * 0.125);
    }

    #[test]
    fn every_edge_is_shared_by_two_opposite_faces() {
        for mesh in [cylinder(1.0, 1.0).unwrap(), capsule(1.0, 1.0).unwrap()] {
            let mut edges: Vec<[u32; 2]> =
                mesh.faces().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            edges.sort_unstable();
            assert!(edges.windows(2).all(|pair| pair[0] != pair[1]));
            assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()));
        }
    }
}
