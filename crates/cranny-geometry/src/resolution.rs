//! How finely a mesh was stored, and what 'the same place' therefore means by default.
//!
//! Writers round coordinates: to so many decimals, to single or to double precision. Two vertices
//! meant to be one, or a vertex meant to lie on an edge, then miss each other by what rounding does,
//! and no weld distance below that can join them. Measured on real meshes: a nut of 30.7 mm diagonal
//! stored in metres with six decimals has vertices up to 0.79 micrometres off the edges that they
//! were meant for, with a step of 1 micrometre.

use cranny_exact::DVec3;

use crate::mesh::Mesh;

/// Two roundings to a grid of step `s` displace by half a diagonal of its cell each, together by
/// `sqrt(3) s`: smaller, and a point on an edge may stay off it; larger, and finer detail than the
/// rounding leaves may be welded.
const GRID_STEPS: f64 = 2.0;

/// Coordinates in binary precision mostly come out of a few roundings (a rotation, a sum of
/// products). Smaller, and the turned copy of a vertex misses its twin; larger is of no use.
const BINARY_STEPS: f64 = 8.0;

/// The default is never more than this share of the diagonal: on a coarse lattice (whole numbers) the
/// step says nothing of precision. Smaller, and the nut above (2 steps = 6.5e-5 of its diagonal)
/// stays open; larger, and features of a thousandth of the body come within reach of repairs.
const MAX_SHARE: f64 = 1e-4;

/// Decimals looked for; files with more digits are as fine as single precision.
const MAX_DECIMALS: usize = 9;

/// The default weld distance of a mesh. Deterministic; 0 only where all vertices coincide.
///
/// The step is the coarsest of: a decimal grid of 0 to 9 places that holds every coordinate, single
/// precision where every coordinate has it, double precision (both at the largest coordinate).
pub(crate) fn default_weld_distance(mesh: &Mesh) -> f64 {
    let vertices = mesh.vertices();
    let largest = vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let binary = if vertices.iter().all(|&p| all(p, is_single)) { SINGLE } else { f64::EPSILON };
    let decimal = (0..=MAX_DECIMALS)
        .map(|places| (0..places).fold(1.0, |scale, _| 10.0 * scale))
        .find(|&scale| vertices.iter().all(|&p| all(p, |x| (x * scale).round() / scale == x)))
        .map_or(0.0, |scale| GRID_STEPS / scale);
    decimal.max(BINARY_STEPS * binary * largest).min(MAX_SHARE * mesh.bounds().diagonal())
}

/// The distance between 1 and the next number in single precision, 2^-23.
const SINGLE: f64 = 1.0 / (1u64 << 23) as f64;

/// Whether the last 29 bits, which single precision lacks, are zero.
fn is_single(x: f64) -> bool {
    x.to_bits() & ((1 << 29) - 1) == 0
}

fn all(p: DVec3, holds: impl Fn(f64) -> bool) -> bool {
    p.to_array().into_iter().all(holds)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(scale: f64, shift: f64) -> f64 {
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]
            .map(|p| scale * p + DVec3::new(shift, 0.0, 0.0));
        default_weld_distance(&Mesh::new(vertices.to_vec(), vec![[0, 1, 2]]).unwrap())
    }

    #[test]
    fn decimal_files_are_as_coarse_as_their_last_digit() {
        assert_eq!(distance(1.0, 0.000_25), 2.0 / 100_000.0);
        assert_eq!(distance(0.5, 0.000_001), 2.0 / 1_000_000.0);
    }

    #[test]
    fn a_lattice_is_no_sign_of_low_precision() {
        assert_eq!(distance(1.0, 0.0), MAX_SHARE * 3f64.sqrt());
    }

    #[test]
    fn single_and_double_precision_are_told_apart() {
        let third = 1.0 / 3.0;
        let single = f64::from_bits(f64::to_bits(third) & !((1 << 29) - 1));
        assert_eq!(distance(single, 0.0), 8.0 * SINGLE * single);
        assert_eq!(distance(third, 0.0), 8.0 * f64::EPSILON * third);
    }

    #[test]
    fn powers_of_two_scale_it() {
        assert_eq!(distance(1.0 / 3.0 * 1024.0, 0.0), 1024.0 * distance(1.0 / 3.0, 0.0));
    }
}
