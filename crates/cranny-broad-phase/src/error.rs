//! What can be wrong with a call, and what can be wrong with the structure.

use crate::ProxyId;
use cranny_exact::Aabb;
use thiserror::Error;

/// A call that was refused; the broad phase is as it was before.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BroadPhaseError {
    /// No proxy of this id is present.
    #[error("proxy {} is not in the broad phase: insert it first", .id.0)]
    UnknownProxy {
        /// The id.
        id: ProxyId,
    },
    /// A proxy of this id is present already.
    #[error("proxy {} is in the broad phase already: remove it first, or set its box", .id.0)]
    DuplicateProxy {
        /// The id.
        id: ProxyId,
    },
    /// A face of the box is `NaN`.
    #[error("the {face} face of proxy {}'s box along {axis} is NaN: check the pose of its body", .id.0)]
    NotANumber {
        /// The proxy concerned.
        id: ProxyId,
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// `"lower"` or `"upper"`.
        face: &'static str,
    },
    /// The box holds no point.
    #[error(
        "the box of proxy {} is empty: along {axis} it runs from {min} to {max}; a body without points has no proxy",
        .id.0
    )]
    EmptyBox {
        /// The proxy concerned.
        id: ProxyId,
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// Lower face.
        min: f64,
        /// Upper face, below the lower one.
        max: f64,
    },
    /// No room for another proxy.
    #[error("proxy {} does not fit: the broad phase holds at most {max} boxes", .id.0)]
    Full {
        /// The proxy concerned.
        id: ProxyId,
        /// The most boxes that fit.
        max: u32,
    },
}

/// A broken invariant, found by [`validate`](crate::BroadPhase::validate): a bug of this crate.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("broad phase invariant broken: {what}")]
pub struct InvariantError {
    /// Which invariant, and where.
    pub what: String,
}

impl InvariantError {
    /// `Ok` where the invariant holds.
    pub(crate) fn unless(holds: bool, what: impl FnOnce() -> String) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self { what: what() }) }
    }
}

/// Accepts boxes that hold a point, infinite faces included.
///
/// A zero is returned as +0: `-0.0` and `0.0` are the same place, and must be one key for every
/// way of sorting.
pub(crate) fn checked_box(id: ProxyId, aabb: Aabb) -> Result<Aabb, BroadPhaseError> {
    let faces = aabb.min.to_array().into_iter().zip(aabb.max.to_array());
    for (axis, (min, max)) in ['x', 'y', 'z'].into_iter().zip(faces) {
        for (face, value) in [("lower", min), ("upper", max)] {
            if value.is_nan() {
                return Err(BroadPhaseError::NotANumber { id, axis, face });
            }
        }
        if min > max {
            return Err(BroadPhaseError::EmptyBox { id, axis, min, max });
        }
    }
    Ok(Aabb { min: aabb.min + 0.0, max: aabb.max + 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    const ID: ProxyId = ProxyId(4);

    #[test]
    fn nan_and_empty_boxes_are_told_apart() {
        let nan = Aabb { min: DVec3::ZERO, max: DVec3::new(1.0, f64::NAN, 1.0) };
        assert_eq!(
            checked_box(ID, nan),
            Err(BroadPhaseError::NotANumber { id: ID, axis: 'y', face: "upper" })
        );
        let empty = Aabb { min: DVec3::new(0.0, 0.0, 2.0), max: DVec3::ONE };
        assert_eq!(
            checked_box(ID, empty),
            Err(BroadPhaseError::EmptyBox { id: ID, axis: 'z', min: 2.0, max: 1.0 })
        );
        assert!(checked_box(ID, Aabb::EMPTY).is_err());
    }

    #[test]
    fn points_and_half_spaces_are_boxes_and_zeros_are_positive() {
        let point = Aabb { min: DVec3::splat(-0.0), max: DVec3::splat(-0.0) };
        let kept = checked_box(ID, point).expect("a point is a box");
        assert!(kept.min.to_array().iter().all(|x| x.is_sign_positive()));
        let half_space = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::new(1.0, 1.0, 0.0) };
        assert_eq!(checked_box(ID, half_space), Ok(half_space));
    }

    #[test]
    fn messages_name_the_proxy_and_what_to_do() {
        let text = BroadPhaseError::UnknownProxy { id: ID }.to_string();
        assert!(text.contains("proxy 4") && text.contains("insert"), "{text}");
    }
}
