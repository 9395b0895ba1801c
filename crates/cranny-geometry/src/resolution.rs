//! How finely a mesh was stored, and what 'the same place' therefore means by default.
//!
//! Writers round coordinates: to so many decimals, to single or to double precision. Two vertices
//! meant to be one, or a vertex meant to lie on an edge, then miss each other by what rounding does,
//! and no weld distance below that can join them. Measured on real meshes: a nut of 30.7 mm diagonal
//! stored in metres with six decimals has vertices up to 0.79 micrometres off the edges that they
//! were meant for, with a step of 1 micrometre.

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
const MAX_DECIMALS: i32 = 9;

/// Significant digits looked for: single precision shows itself by nine.
const MAX_DIGITS: i32 = 9;

/// Powers of ten that `f64` holds exactly, so that a decimal number is one rounding of a division.
const EXACT_POWERS: i32 = 22;

/// The default weld distance of a mesh. Deterministic; 0 only where all vertices coincide.
///
/// The step is the coarsest of: a decimal grid of 0 to 9 places that holds every coordinate, single
/// precision where every coordinate has it, double precision (both at the largest coordinate).
pub(crate) fn default_weld_distance(mesh: &Mesh) -> f64 {
    let binary = if is_single(mesh) { SINGLE } else { f64::EPSILON };
    let decimal = GRID_STEPS * grid_step(mesh).unwrap_or(0.0);
    let least = decimal.max(BINARY_STEPS * binary * largest(mesh));
    least.min(MAX_SHARE * mesh.bounds().diagonal())
}

/// The greatest coordinate magnitude.
pub(crate) fn largest(mesh: &Mesh) -> f64 {
    mesh.vertices().iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

/// Whether single precision holds every coordinate, whatever their scale.
pub(crate) fn is_single(mesh: &Mesh) -> bool {
    coordinates(mesh).all(|x| x.to_bits() & ((1 << 29) - 1) == 0)
}

/// The step between decimal numbers as they were written, at the largest coordinate: the coarser of
/// that of a grid of so many decimals and that of so many significant digits, of which a writer uses
/// either. Nothing where the coordinates are no short decimal numbers.
pub(crate) fn decimal_step(mesh: &Mesh) -> Option<f64> {
    grid_step(mesh).into_iter().chain(digit_step(mesh)).reduce(f64::max)
}

/// The step of the decimal grid of 0 to 9 places that holds every coordinate.
fn grid_step(mesh: &Mesh) -> Option<f64> {
    let written = written(mesh);
    (0..=MAX_DECIMALS)
        .find(|&places| written.clone().all(|x| has_places(x, places)))
        .map(|places| 1.0 / power_of_ten(places))
}

/// The step, at the largest coordinate, between numbers of as many significant digits as every
/// coordinate has at most.
fn digit_step(mesh: &Mesh) -> Option<f64> {
    let mut digits = 0;
    for x in written(mesh).map(f64::abs) {
        let decade = decade(x)?;
        digits = (digits.max(1)..=MAX_DIGITS).find(|&d| has_places(x, d - 1 - decade))?;
    }
    let places = digits - 1 - decade(largest(mesh)).filter(|_| digits > 0)?;
    Some(if places < 0 { power_of_ten(-places) } else { 1.0 / power_of_ten(places) })
}

/// Whether a number has no more decimal places; negative ones are zeros before the point.
fn has_places(x: f64, places: i32) -> bool {
    let scale = power_of_ten(places.abs());
    match places {
        0.. => (x * scale).round() / scale == x,
        _ => (x / scale).round() * scale == x,
    }
}

/// The power of ten of a number's first digit, if near enough to 0 for all its digits to be exact.
fn decade(x: f64) -> Option<i32> {
    let reach = EXACT_POWERS - MAX_DIGITS;
    if x >= 1.0 {
        (0..=reach).rev().find(|&e| x >= power_of_ten(e)).filter(|_| x < power_of_ten(reach))
    } else {
        (1..=reach).find(|&e| x * power_of_ten(e) >= 1.0).map(|e| -e)
    }
}

/// Exact up to [`EXACT_POWERS`].
fn power_of_ten(exponent: i32) -> f64 {
    (0..exponent).fold(1.0, |power, _| 10.0 * power)
}

/// The distance between 1 and the next number in single precision, 2^-23.
const SINGLE: f64 = 1.0 / (1u64 << 23) as f64;

/// The coordinates but for those that computing left where nothing was meant: the 6e-17 of a
/// quarter turn is written with all its digits beside a 1.
fn written(mesh: &Mesh) -> impl Iterator<Item = f64> + Clone + '_ {
    let noise = BINARY_STEPS * f64::EPSILON * largest(mesh);
    coordinates(mesh).filter(move |x| x.abs() > noise)
}

fn coordinates(mesh: &Mesh) -> impl Iterator<Item = f64> + Clone + '_ {
    mesh.vertices().iter().flat_map(|p| p.to_array())
}

#[cfg(test)]
mod tests {
    use cranny_exact::DVec3;

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

    #[test]
    fn what_is_left_of_a_quarter_turn_counts_for_nothing() {
        assert_eq!(step([1.25, 6.123_233_995_736_766e-17, 0.25]), Some(0.01));
        assert_eq!(distance(0.25, 1.653_27e-18), MAX_SHARE * 0.25 * 3f64.sqrt());
    }

    fn step(coordinates: [f64; 3]) -> Option<f64> {
        let vertices = vec![DVec3::from_array(coordinates), DVec3::ZERO, DVec3::ZERO];
        decimal_step(&Mesh::new(vertices, vec![[0, 1, 2]]).unwrap())
    }

    #[test]
    fn digits_count_where_decimals_do_not() {
        // Six digits: the largest has five decimals, others more.
        assert_eq!(step([1.27976, -0.0898721, 0.25]), Some(1e-5));
        assert_eq!(step([1.27976e3, -0.0898721, 1.224_65e-9]), Some(0.01));
        assert_eq!(step([123_456e7, 2e6, 3e7]), Some(1e7));
        // Six decimals, written in full.
        assert_eq!(step([1.279761, -0.089872, 0.25]), Some(1e-6));
        // Both hold: the coarser.
        assert_eq!(step([0.05, 0.00737769, 0.00130089]), Some(1e-7));
    }

    #[test]
    fn numbers_that_nobody_wrote_have_no_decimal_step() {
        assert_eq!(step([1.0 / 3.0, 0.5, 0.25]), None);
        assert_eq!(step([2f64.powi(-60); 3]), None);
        // Beyond 2^53 every number is whole.
        assert_eq!(step([2f64.powi(80), 0.5, 0.25]), Some(1.0));
        assert_eq!(step([0.1 + 0.2, 0.5, 0.25]), None);
    }
}
