//! A direction that parts two clouds, with few digits.

use cranny_exact::DVec3;

use crate::cloud::Cloud;

/// Directions tried for two clouds before they are halved. Fewer: groups are halved that a plane
/// parts, and certificates grow. More: groups that no plane parts cost more before they are.
const TRIALS: u32 = 12;

/// A dot product of three terms and its comparison round less than so many half ulps of the sum of
/// the terms' magnitudes. Smaller: a direction may pass here that exact numbers refuse.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Largest components of directions that are tried, shortest first. All are whole numbers.
const LENGTHS: [f64; 4] = [8.0, 64.0, 1e3, 1e6];

/// A direction that surely parts the clouds by a gap; `None` where none was found. `guess` is tried
/// first, and is the last one tried afterwards.
pub(crate) fn parting_direction(a: &Cloud, b: &Cloud, guess: &mut DVec3) -> Option<DVec3> {
    let mut direction = match guess.try_normalize() {
        Some(direction) => direction,
        None => (b.bounds.center() - a.bounds.center()).normalize_or(DVec3::X),
    };
    for _ in 0..TRIALS {
        // Chung and Wang (1996): mirrored at the way between the support points, a direction comes
        // nearer to one that parts them, if any does.
        let between = b.support(-direction) - a.support(direction);
        *guess = direction;
        if direction.dot(between) > 0.0 && parts(a, b, direction) {
            return Some(shortened(a, b, direction));
        }
        let rest = between.normalize_or_zero();
        direction = (direction - 2.0 * direction.dot(rest) * rest).normalize_or_zero();
        if direction == DVec3::ZERO {
            return None;
        }
    }
    None
}

/// Whether a direction surely parts the clouds, rounding included.
pub(crate) fn parts(a: &Cloud, b: &Cloud, direction: DVec3) -> bool {
    let (top, bottom) = (a.support(direction), b.support(-direction));
    let largest =
        |cloud: &Cloud| direction.abs().dot(cloud.bounds.min.abs().max(cloud.bounds.max.abs()));
    let error = ROUNDING * (largest(a) + largest(b));
    direction.dot(bottom) - direction.dot(top) > error
}

/// The shortest whole numbers near a direction that still part the clouds.
fn shortened(a: &Cloud, b: &Cloud, direction: DVec3) -> DVec3 {
    let scale = direction.abs().max_element();
    let rounded = LENGTHS.iter().map(|length| (direction * (length / scale)).round());
    rounded.into_iter().find(|&short| parts(a, b, short)).unwrap_or(direction)
}
