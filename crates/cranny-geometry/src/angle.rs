//! Angles by arithmetic alone, so that they are the same on every machine.

use std::f64::consts::{FRAC_PI_2, PI};

use cranny_exact::DVec3;

/// How often an arc is halved before its series is summed: a quotient of at most 1 comes below
/// 0.099 so, where eight terms leave less than a thousandth of an ulp.
const HALVINGS: i32 = 3;

/// Odd denominators of the arctangent's series (Gregory's), the last first.
const DENOMINATORS: [f64; 8] = [15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0];

/// The direction of a vector, however short or long: unit, or zero.
pub(crate) fn direction(v: DVec3) -> DVec3 {
    let longest = v.abs().max_element();
    if longest > 0.0 && longest.is_finite() { (v / longest).normalize() } else { DVec3::ZERO }
}

/// Radians between two unit vectors, 0 to π, within a few ulps. Also near 0 and π, where the
/// cosine says nothing (Kahan 2006, "How futile are mindless assessments of roundoff", section 12).
pub fn between(u: DVec3, v: DVec3) -> f64 {
    2.0 * arctangent((u - v).length(), (u + v).length())
}

/// Radians, 0 to π/2, of the angle whose tangent is y / x, both at least 0.
fn arctangent(y: f64, x: f64) -> f64 {
    if y > x {
        FRAC_PI_2 - arc(x / y)
    } else if y > 0.0 {
        arc(y / x)
    } else {
        0.0
    }
}

/// Of a tangent of at most 1.
fn arc(mut t: f64) -> f64 {
    for _ in 0..HALVINGS {
        t /= 1.0 + (1.0 + t * t).sqrt();
    }
    let minus_squared = -t * t;
    let series = DENOMINATORS.iter().fold(0.0, |sum, d| sum * minus_squared + 1.0 / d);
    t * series * f64::from(1 << HALVINGS)
}

/// Whether a number is an angle between faces: 0 to π.
pub(crate) fn is_between_faces(angle: f64) -> bool {
    (0.0..=PI).contains(&angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_library() {
        let turned = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        for k in 0..=4000 {
            let angle = PI * f64::from(k) / 4000.0;
            let found = between(turned(0.3), turned(0.3 + angle));
            assert!((found - angle).abs() < 3e-15, "{angle}: {found}");
        }
        for angle in [1e-3, 1e-8, 1e-15] {
            let v = DVec3::new(1.0, angle, 0.0);
            assert!((between(DVec3::X, v) / angle - 1.0).abs() < angle * angle + 1e-15);
        }
        assert_eq!(between(DVec3::Y, DVec3::Y), 0.0);
        assert_eq!(between(DVec3::Y, -DVec3::Y), PI);
        assert!((between(DVec3::X, DVec3::Z) - FRAC_PI_2).abs() < 1e-15);
        for k in 0..=1000 {
            let t = f64::from(k) / 1000.0;
            assert!((arc(t) - t.atan()).abs() < 4e-16);
        }
    }

    #[test]
    fn directions_know_no_size() {
        let v = DVec3::new(3.0, 0.0, -4.0);
        for scale in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
            assert!((direction(v * scale) - v / 5.0).length() < 1e-15);
        }
        assert_eq!(direction(DVec3::ZERO), DVec3::ZERO);
    }
}
