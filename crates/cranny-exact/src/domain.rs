//! Which coordinates are accepted.
//!
//! A sign predicate multiplies three coordinates. Its exact expansion must neither overflow nor
//! underflow, or `robust` silently answers 'co-planar'. Inside the domain it cannot:
//!
//! - coordinates are at most [`MAX_COORDINATE`] = 2^120, so products of three stay below 2^370;
//! - a coordinate is zero or at least [`MIN_COORDINATE`] = 2^-200, hence a multiple of 2^-252.
//!   Posing multiplies it by a matrix entry that is zero or at least 2^-51 (see
//!   [`RigidMap`](crate::RigidMap)), so posed coordinates are multiples of 2^-355 and products of
//!   three are multiples of 2^-1065, which `f64` still represents.

use glam::DVec3;
use thiserror::Error;

/// The largest magnitude of a coordinate: 2^120, about 1.3e36.
pub const MAX_COORDINATE: f64 = f64::from_bits((1023 + 120) << 52);

/// The smallest magnitude of a coordinate that is not zero: 2^-200, about 6.2e-61.
pub const MIN_COORDINATE: f64 = f64::from_bits((1023 - 200) << 52);

/// A coordinate outside the domain.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DomainError {
    /// `NaN` or infinite.
    #[error("coordinate {axis} is {value}: coordinates must be finite numbers")]
    NotFinite {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// The value found.
        value: f64,
    },
    /// Larger than [`MAX_COORDINATE`].
    #[error(
        "coordinate {axis} is {value:e}, beyond the largest accepted magnitude {MAX_COORDINATE:e}: choose a larger unit of length"
    )]
    TooLarge {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// The value found.
        value: f64,
    },
    /// Not zero, and smaller than [`MIN_COORDINATE`].
    #[error(
        "coordinate {axis} is {value:e}, below the smallest accepted magnitude {MIN_COORDINATE:e}: round it to zero or choose a smaller unit of length"
    )]
    TooSmall {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// The value found.
        value: f64,
    },
}

/// Checks that all three coordinates of a point lie inside the domain.
///
/// # Errors
///
/// The first offending axis, with its value.
pub fn check_point(point: DVec3) -> Result<(), DomainError> {
    for (axis, value) in ['x', 'y', 'z'].into_iter().zip(point.to_array()) {
        if !value.is_finite() {
            return Err(DomainError::NotFinite { axis, value });
        }
        if value.abs() > MAX_COORDINATE {
            return Err(DomainError::TooLarge { axis, value });
        }
        if value.abs() < MIN_COORDINATE && value.abs() > 0.0 {
            return Err(DomainError::TooSmall { axis, value });
        }
    }
    Ok(())
}

/// Whether [`check_point`] has nothing to say of a point: without a branch, for loops over many.
#[must_use]
pub fn is_in_domain(point: DVec3) -> bool {
    let is_accepted = |x: f64| {
        let size = x.abs();
        // Not so of infinities, nor of NaN, which is no smaller than anything.
        (size <= MAX_COORDINATE) & ((size >= MIN_COORDINATE) | (size == 0.0))
    };
    is_accepted(point.x) & is_accepted(point.y) & is_accepted(point.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_are_powers_of_two() {
        assert_eq!(MAX_COORDINATE, 2f64.powi(120));
        assert_eq!(MIN_COORDINATE, 2f64.powi(-200));
    }

    #[test]
    fn both_ways_of_asking_agree() {
        let edges = [MAX_COORDINATE, MIN_COORDINATE];
        let around = edges.iter().flat_map(|x| [x.next_down(), *x, x.next_up()]);
        let special = [0.0, 1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::from_bits(1)];
        for x in around.chain(special).flat_map(|x| [x, -x]) {
            for p in [DVec3::new(x, 1.0, 0.0), DVec3::new(0.0, x, 1.0), DVec3::new(1.0, 0.0, x)] {
                assert_eq!(is_in_domain(p), check_point(p).is_ok(), "{p}");
            }
        }
    }

    #[test]
    fn each_kind_of_offender_is_named() {
        assert!(check_point(DVec3::new(0.0, -1.0, MAX_COORDINATE)).is_ok());
        assert!(matches!(
            check_point(DVec3::new(0.0, f64::NAN, 0.0)),
            Err(DomainError::NotFinite { axis: 'y', .. })
        ));
        assert!(matches!(
            check_point(DVec3::new(0.0, 0.0, -1e37)),
            Err(DomainError::TooLarge { axis: 'z', .. })
        ));
        assert!(matches!(
            check_point(DVec3::new(1e-110, 0.0, 0.0)),
            Err(DomainError::TooSmall { axis: 'x', .. })
        ));
    }
}
