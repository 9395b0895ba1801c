//! How finely a mesh was stored, and what 'the same place' therefore means by default.
//!
//! Writers round coordinates: to so many decimals, to single or to double precision. Two vertices
//! meant to be one, or a vertex meant to lie on an edge, then miss each other by what rounding
//! does, and no weld distance below that can join them. Measured on real meshes: a nut of 30.7 mm
//! diagonal stored in metres with six decimals has vertices up to 0.79 micrometres off the edges
//! that they were meant for, with a step of 1 micrometre.
//!
//! No source: this crate's own. Cost: O(n), some passes over the coordinates, most of which end at
//! the first number that does not fit.

use cranny_exact::DVec3;

use crate::grid::common_step;
use crate::mesh::Mesh;

/// Two roundings to a grid of step `s` displace by half a diagonal of its cell each, together by
/// `sqrt(3) s`: smaller, and a point on an edge may stay off it; larger, and finer detail than the
/// rounding leaves may be welded.
const GRID_STEPS: f64 = 2.0;

/// Coordinates in binary precision mostly come out of a few roundings (a rotation, a sum of
/// products). Smaller, and the turned copy of a vertex misses its twin; larger is of no use.
const BINARY_STEPS: f64 = 8.0;

/// The default is never more than this share of the diagonal: on a coarse lattice (whole numbers)
/// the step says nothing of precision. Smaller, and the nut above (2 steps = 6.5e-5 of its
/// diagonal) stays open; larger, and features of a thousandth of the body come within reach of
/// repairs.
const MAX_SHARE: f64 = 1e-4;

/// Decimals looked for; files with more digits are as fine as single precision.
const MAX_DECIMALS: i32 = 9;

/// Significant digits looked for: no writer uses fewer, and a few round numbers (a plate of 300,000
/// with a pocket of 80) have less without having been rounded.
const MIN_DIGITS: i32 = 5;

/// Significant digits looked for: single precision shows itself by nine.
const MAX_DIGITS: i32 = 9;

/// So many coordinates, spread over all, are looked at to see which powers of two are likely.
const SAMPLE: usize = 64;

/// Numbers of fewer steps may be drawn. Smaller, and shallow pockets in large drawings are taken
/// for rounding; larger, and numbers that were rounded to few digits pass for drawn.
const FEW_STEPS: f64 = 1000.0;

/// Powers of two by which written numbers are thought to have been scaled since.
const MAX_POWER: i32 = 40;

/// Powers of ten that `f64` holds exactly, so that a decimal number is one rounding of a division.
const EXACT_POWERS: i32 = 22;

/// The default weld distance of a mesh. Deterministic; 0 only where all vertices coincide.
///
/// The step is the coarsest of: the grid that holds every coordinate, single precision where every
/// coordinate has it or `was_single`, double precision (both at the largest coordinate).
pub(crate) fn default_weld_distance(mesh: &Mesh, was_single: bool) -> f64 {
    let binary = if was_single || is_single(mesh) { SINGLE } else { f64::EPSILON };
    let grid = GRID_STEPS * grid_step(mesh).unwrap_or(0.0);
    let least = grid.max(BINARY_STEPS * binary * largest(mesh));
    least.min(MAX_SHARE * mesh.bounds().diagonal())
}

/// The greatest coordinate magnitude.
pub(crate) fn largest(mesh: &Mesh) -> f64 {
    mesh.vertices().iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

/// Whether single precision holds every coordinate, whatever their scale.
pub(crate) fn is_single(mesh: &Mesh) -> bool {
    coordinates(mesh).all(|x| x.to_bits() & ((1 << SINGLE_CUT) - 1) == 0)
}

/// The step between numbers as they were written, at the largest coordinate: the coarser of that of
/// a grid and that of so many significant digits, of which a writer uses either. Nothing where the
/// coordinates are neither.
pub(crate) fn written_step(mesh: &Mesh) -> Option<f64> {
    steps(mesh).reduce(f64::max)
}

/// [`written_step`] if numbers were rounded to it: nothing where they were drawn at round
/// multiples.
pub(crate) fn rounding_step(mesh: &Mesh) -> Option<f64> {
    steps(mesh).filter(|&step| !is_drawn(mesh, step)).reduce(f64::max)
}

fn steps(mesh: &Mesh) -> impl Iterator<Item = f64> {
    [grid_step(mesh), digit_step(mesh)].into_iter().flatten()
}

/// Whether every coordinate is a multiple of ten steps, or only a few steps, from 0 or from the
/// corner of the body's box, which may have been moved away from 0 since: rounding leaves numbers
/// of many steps, one in ten of which is round.
fn is_drawn(mesh: &Mesh, step: f64) -> bool {
    let is_round = |x: f64| {
        let tens = x / (10.0 * step);
        tens.abs() < 0.1 * FEW_STEPS || (tens - tens.round()).abs() < 0.05
    };
    [DVec3::ZERO, mesh.bounds().min].into_iter().any(|origin| {
        coordinates(mesh).zip(origin.to_array().into_iter().cycle()).all(|(x, o)| is_round(x - o))
    })
}

/// The step of the grid that holds every coordinate: in any unit if it is coarse, otherwise of 0 to
/// 9 decimal places, which single precision may have rounded since.
fn grid_step(mesh: &Mesh) -> Option<f64> {
    let largest = largest(mesh);
    let written = written(mesh, largest);
    common_step(written.clone(), largest).or_else(|| {
        let is_single = is_single(mesh);
        let holds = |places: i32| {
            let is_seen = 1.0 / power_of_ten(places) >= LEAST_SINGLE_STEPS * SINGLE * largest;
            match is_single && is_seen {
                true => written.clone().all(|x| has_places_in_single(x, places)),
                false => written.clone().all(|x| has_places(x, places)),
            }
        };
        (0..=MAX_DECIMALS).find(|&places| holds(places)).map(|places| 1.0 / power_of_ten(places))
    })
}

/// The step, at the largest coordinate, between numbers of as many significant digits as every
/// coordinate has at most, before they were scaled by a power of two.
fn digit_step(mesh: &Mesh) -> Option<f64> {
    let largest = largest(mesh);
    let written = written(mesh, largest);
    let sample = written.clone().step_by((3 * mesh.vertices().len()).div_ceil(SAMPLE).max(1));
    let step = |numbers: &mut dyn Iterator<Item = f64>, scale: f64| {
        Some(digit_step_of(&mut numbers.map(|x| scale * x), scale * largest)? / scale)
    };
    let powers = (0..=MAX_POWER).flat_map(|power| [2f64.powi(power), 2f64.powi(-power)]);
    // A written number times another power of two has more digits, but perhaps not too many.
    let likely = powers.filter_map(|scale| Some((step(&mut sample.clone(), scale)?, scale)));
    let mut likely: Vec<(f64, f64)> = likely.collect();
    likely.sort_by(|a, b| b.0.total_cmp(&a.0));
    likely.into_iter().find_map(|(_, scale)| step(&mut written.clone(), scale))
}

/// The step between numbers of as many digits as these have, at the largest.
fn digit_step_of(numbers: &mut dyn Iterator<Item = f64>, largest: f64) -> Option<f64> {
    let mut digits = 0;
    for x in numbers.map(f64::abs) {
        let decade = decade(x)?;
        digits = (digits.max(MIN_DIGITS)..=MAX_DIGITS).find(|&d| has_places(x, d - 1 - decade))?;
    }
    let places = digits - 1 - decade(largest).filter(|_| digits > 0)?;
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

/// Whether a number of single precision is the nearest one to a number of no more decimal places.
fn has_places_in_single(x: f64, places: i32) -> bool {
    let scale = power_of_ten(places);
    to_single((x * scale).round() / scale) == x
}

/// The nearest number with the digits of single precision, of two the even one.
fn to_single(x: f64) -> f64 {
    let (bits, cut) = (x.to_bits(), SINGLE_CUT);
    let rounded = bits + ((1 << (cut - 1)) - 1) + ((bits >> cut) & 1);
    f64::from_bits(rounded & !((1 << cut) - 1))
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

/// Decimals that single precision has rounded are looked for if their step is so many of its own.
/// Fewer, and numbers of a coarse single precision pass for decimal ones by chance; more, and six
/// decimals of a body that reaches to 1 are missed.
const LEAST_SINGLE_STEPS: f64 = 4.0;

/// Binary digits that single precision has less than double precision.
const SINGLE_CUT: u32 = 29;

/// The distance between 1 and the next number in single precision, 2^-23.
const SINGLE: f64 = 1.0 / (1u64 << 23) as f64;

/// The coordinates but for those that computing left where nothing was meant: the 6e-17 of a
/// quarter turn is written with all its digits beside a 1.
fn written(mesh: &Mesh, largest: f64) -> impl Iterator<Item = f64> + Clone + '_ {
    let noise = BINARY_STEPS * f64::EPSILON * largest;
    coordinates(mesh).filter(move |x| x.abs() > noise)
}

fn coordinates(mesh: &Mesh) -> impl Iterator<Item = f64> + Clone + '_ {
    mesh.vertices().iter().flat_map(|p| p.to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(scale: f64, shift: f64) -> f64 {
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]
            .map(|p| scale * p + DVec3::new(shift, 0.0, 0.0));
        default_weld_distance(&Mesh::new(vertices.to_vec(), vec![[0, 1, 2]]).unwrap(), false)
    }

    fn close(a: f64, b: f64) -> bool {
        (a / b - 1.0).abs() < 1e-9
    }

    #[test]
    fn decimal_files_are_as_coarse_as_their_last_digit() {
        assert!(close(distance(1.0, 0.000_01), 2.0 / 100_000.0));
        assert!(close(distance(0.5, 0.000_001), 2.0 / 1_000_000.0));
        // In inches, now in metres.
        assert!(close(distance(0.5 * 0.0254, 0.000_001 * 0.0254), 2.0 * 0.0254 / 1_000_000.0));
    }

    #[test]
    fn a_lattice_is_no_sign_of_low_precision() {
        assert_eq!(distance(1.0, 0.0), MAX_SHARE * 3f64.sqrt());
    }

    #[test]
    fn single_and_double_precision_are_told_apart() {
        let numbers = [1.0 / 3.0, 0.1f64.sqrt(), 0.7];
        let single = numbers.map(to_single);
        assert_eq!(default_weld_distance(&mesh(single), false), 8.0 * SINGLE * single[2]);
        assert_eq!(default_weld_distance(&mesh(numbers), false), 8.0 * f64::EPSILON * 0.7);
        assert_eq!(default_weld_distance(&mesh(numbers), true), 8.0 * SINGLE * 0.7);
    }

    #[test]
    fn powers_of_two_scale_it() {
        for (scale, shift) in [(1.0 / 3.0, 0.1f64.sqrt()), (0.7, 0.000_013), (1.0, 0.0)] {
            let power = 2f64.powi(-13);
            assert_eq!(distance(scale * power, shift * power), power * distance(scale, shift));
        }
    }

    #[test]
    fn what_is_left_of_a_quarter_turn_counts_for_nothing() {
        assert_eq!(step([1.27976, 6.123_233_995_736_766e-17, 0.0898721]), Some(1e-5));
        assert_eq!(distance(0.25, 1.653_27e-18), MAX_SHARE * 0.25 * 3f64.sqrt());
    }

    fn mesh(coordinates: [f64; 3]) -> Mesh {
        let vertices = vec![DVec3::from_array(coordinates), DVec3::ZERO, DVec3::ZERO];
        Mesh::new(vertices, vec![[0, 1, 2]]).unwrap()
    }

    fn step(coordinates: [f64; 3]) -> Option<f64> {
        digit_step(&mesh(coordinates))
            .into_iter()
            .chain(grid_step(&mesh(coordinates)))
            .reduce(f64::max)
    }

    #[test]
    fn digits_count_where_decimals_do_not() {
        // Six digits: the largest has five decimals, others more.
        assert_eq!(step([1.27976, -0.0898721, 0.25]), Some(1e-5));
        assert_eq!(step([1.27976e3, -0.0898721, 1.224_65e-9]), Some(0.01));
        assert_eq!(step([123_457e7, 2e6, 3e7]), Some(1e7));
        // Scaled by a power of two since.
        let scaled = [1.27976, -0.0898721, 0.25].map(|x| x / 512.0);
        assert_eq!(step(scaled), Some(1e-5 / 512.0));
        // Six decimals, written in full.
        assert!(close(step([1.279761, -0.089872, 0.25]).unwrap(), 1e-6));
        // Both hold: the coarser.
        assert_eq!(step([0.05, 0.00737769, 0.00130089]), Some(1e-7));
        // Round numbers have few digits without having lost any.
        assert_eq!(rounding_step(&mesh([300_000.0, 80.0, 200_000.0])), None);
    }

    #[test]
    fn whole_numbers_far_from_the_origin_are_drawn_ones() {
        let corners = [[0.0, 0.0, 0.0], [7.0, 0.0, 3.0], [0.0, 11.0, 0.0], [3.0, 1.0, 500.0]];
        let at = |place: DVec3| {
            let vertices = corners.map(|c| place + DVec3::from_array(c)).to_vec();
            rounding_step(&Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap())
        };
        assert_eq!(at(DVec3::new(1e6, -1e6, 1e6)), None);
        assert_eq!(at(DVec3::new(1_234_567.0, 7_654_321.0, -1_111_113.0)), None);
        // Many steps of its own, few of them round.
        assert_eq!(at(DVec3::ZERO), None);
        let wide = [[0.0; 3], [1_237.0, 0.0, 3.0], [0.0, 4_311.0, 0.0], [3.0, 1.0, 2_501.0]];
        let wide = wide.map(|c| DVec3::splat(1e6) + DVec3::from_array(c)).to_vec();
        let wide = Mesh::new(wide, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        assert_eq!(rounding_step(&wide), Some(1.0));
    }

    #[test]
    fn decimals_are_seen_through_single_precision() {
        let single = [1.279761, -0.089872, 0.25].map(to_single);
        assert_eq!(step(single), Some(1e-6));
    }

    #[test]
    fn numbers_that_nobody_wrote_have_no_written_step() {
        assert_eq!(step([0.5f64.sqrt(), 0.5, 0.25]), None);
        assert_eq!(step([2f64.powi(-60), 3f64.sqrt() * 2f64.powi(-60), 0.0]), None);
        // Drawn on a grid of a third of a hundredth.
        assert_eq!(rounding_step(&mesh([1.0 / 3.0, 0.1, 0.77 / 3.0])), None);
    }
}
