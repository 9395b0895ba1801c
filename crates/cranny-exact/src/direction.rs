//! Directions for segments that lead out of a body.

use glam::DVec3;

/// Returns the direction of number `attempt` of an equidistributed sequence: at least 0.6 long,
/// none near an axis or a diagonal at first.
///
/// Whether a point is inside is decided along a segment that leads out. A segment that meets an
/// edge or a vertex says nothing, and the next direction is tried.
///
/// Source: fractional parts of multiples of the plastic number's inverse powers (Roberts 2018), on
/// the cube's surface rather than the sphere's: no transcendental function is needed.
#[must_use]
pub fn generic_direction(attempt: u32) -> DVec3 {
    let n = f64::from(attempt) + 1.0;
    let (u, v) = ((n * 0.754_877_666_246_692_7).fract(), (n * 0.569_840_290_998_053_2).fract());
    let p = DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.618_033_988_749_894_9);
    match attempt % 3 {
        0 => p,
        1 => DVec3::new(p.z, p.x, p.y),
        _ => DVec3::new(p.y, -p.z, p.x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_long_enough_and_differ() {
        let all: Vec<DVec3> = (0..32).map(generic_direction).collect();
        assert!(all.iter().all(|d| d.length() >= 0.6 && d.abs().max_element() <= 1.0));
        let angle = |a: DVec3, b: DVec3| a.normalize().cross(b.normalize()).length();
        for (i, &a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|&b| angle(a, b) > 0.04), "{i}");
        }
        assert!([DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE].iter().all(|&a| angle(all[0], a) > 0.3));
    }
}
