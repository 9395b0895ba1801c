//! Rotations from rotation vectors and back, by sums, products and square roots alone.
//!
//! A rotation vector points along the axis; its length is the angle in radians and may be any
//! number of turns. Sines and cosines of small angles are power series, larger angles are doubled
//! up or halved down: every machine computes the same bits.

use cranny_exact::{DQuat, DVec3};

/// Angles up to this (as its square) are left to the power series. Larger, and eight terms no
/// longer reach the last bit (`rotations_agree_with_sines_and_cosines`); smaller, and doubling,
/// which doubles the rounding as well, is done more often than needed.
const SERIES_SQUARED: f64 = 1.0 / 16.0;

/// Terms of the series: the first one left out is (1/4)^16 / 16!, about 1e-23.
const TERMS: u32 = 8;

/// Halvings before the arc tangent is left to its series: a half angle of at most π/2 becomes one
/// of at most π/16.
const HALVINGS: u32 = 3;

/// Terms of the arc tangent's series: (1/5)^26 / 27 is left out, about 2e-20.
const TANGENT_TERMS: u32 = 13;

/// The unit quaternion that turns by `|turn|` radians about `turn`.
///
/// Its angle is off by at most 48 ulps of the angle plus 8 ulps of 1: the series is good to an ulp
/// or two, and every doubling doubles what is off and adds two more.
pub(crate) fn rotation_of(turn: DVec3) -> DQuat {
    let mut half = 0.5 * turn;
    let mut doublings = 0;
    while half.length_squared() > SERIES_SQUARED {
        half *= 0.5;
        doublings += 1;
    }
    let square = half.length_squared();
    // cos x = 1 − x²/(1·2) (1 − x²/(3·4) (1 − …)), and sin x / x with the factors one further.
    let (mut w, mut sinc) = (1.0, 1.0);
    for k in (1..TERMS).rev() {
        let n = f64::from(2 * k);
        w = 1.0 - square / ((n - 1.0) * n) * w;
        sinc = 1.0 - square / (n * (n + 1.0)) * sinc;
    }
    let mut v = half * sinc;
    for _ in 0..doublings {
        (w, v) = (w * w - v.length_squared(), 2.0 * w * v);
    }
    unit(DQuat::from_xyzw(v.x, v.y, v.z, w))
}

/// The rotation vector of a unit quaternion, at most half a turn long; of the two half turns about
/// opposite axes it takes the one that the quaternion names.
pub(crate) fn turn_of(rotation: DQuat) -> DVec3 {
    let mut q = if rotation.w < 0.0 { -rotation } else { rotation };
    for _ in 0..HALVINGS {
        q = unit(DQuat::from_xyzw(q.x, q.y, q.z, q.w + 1.0));
    }
    let tangent = DVec3::new(q.x, q.y, q.z) / q.w;
    let square = tangent.length_squared();
    let mut series = 0.0;
    for k in (0..TANGENT_TERMS).rev() {
        series = 1.0 / f64::from(2 * k + 1) - square * series;
    }
    tangent * (series * f64::from(1 << (HALVINGS + 1)))
}

/// The quaternion at length 1.
pub(crate) fn unit(q: DQuat) -> DQuat {
    q * (1.0 / q.length())
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: DVec3 = DVec3::new(2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0);

    #[test]
    fn rotations_agree_with_sines_and_cosines() {
        for angle in [0.0, 1e-9, 0.1, 0.5, 0.500001, 1.0, 3.0, 6.5, 40.0, 1000.0, 60_000.0] {
            let q = rotation_of(angle * AXIS);
            let (s, c) = (0.5f64 * angle).sin_cos();
            let bound = (24.0 * angle + 4.0) * f64::EPSILON;
            assert!((q.w - c).abs() <= bound, "{angle}: {} {c}", q.w);
            assert!((DVec3::new(q.x, q.y, q.z) - s * AXIS).length() <= bound, "{angle}");
        }
        assert_eq!(rotation_of(DVec3::ZERO), DQuat::IDENTITY);
    }

    #[test]
    fn a_turn_is_found_again_up_to_half_a_turn() {
        for angle in [0.0, 1e-12, 0.01, 1.0, 2.0, 3.0, 3.125] {
            let turn = turn_of(rotation_of(angle * AXIS));
            assert!((turn - angle * AXIS).length() <= 64.0 * f64::EPSILON * (1.0 + angle));
            assert!(
                (turn_of(-rotation_of(angle * AXIS)) - turn).length() <= 1e-15,
                "q and -q are one"
            );
        }
        let half_turn = turn_of(DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0));
        assert!((half_turn - std::f64::consts::PI * DVec3::Y).length() <= 1e-14);
    }
}
