//! Which way faces are turned, as far as rounded numbers decide it for certain.
//!
//! Source: bounds of rounding are derived below, by the rules of Higham (2002, "Accuracy and
//! stability of numerical algorithms", chapters 2 and 3). Cost: O(1) a question.

use cranny_exact::DVec3;

/// The area vector of a face, not halved, and what bounds the error of its product with a vector
/// whose components are no greater than 1.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    pub(super) normal: DVec3,
    error: f64,
}

impl Turn {
    /// With u and v the sides from the first corner and m the product of their greatest components,
    /// each component of the cross product is wrong by no more than 4.1 epsilons of m (two
    /// roundings of each factor, one of each product, one of their difference) and no greater than
    /// 2 m. So a dot product is wrong by 12.3 epsilons of m for these, nine for its own roundings,
    /// and three for those of the other vector.
    pub(super) fn of([a, b, c]: &[DVec3; 3]) -> Self {
        let (u, v) = (*b - *a, *c - *a);
        let error = 32.0 * f64::EPSILON * u.abs().max_element() * v.abs().max_element();
        Self { normal: u.cross(v), error }
    }

    /// Whether the face certainly has area.
    pub(super) fn has_area(&self) -> bool {
        self.normal.abs().max_element() > self.error
    }

    /// Whether the face is certainly turned towards a direction, no component of which is greater
    /// than 1.
    pub(super) fn looks_towards(&self, direction: DVec3) -> bool {
        self.normal.dot(direction) > self.error
    }

    /// Whether a point, as seen from a corner of the face, certainly lies off its plane.
    pub(super) fn is_off_plane(&self, point: DVec3) -> bool {
        self.normal.dot(point).abs() > self.error * point.abs().max_element()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_certain_is_said() {
        let triangle = [DVec3::ZERO, DVec3::new(0.3, 0.1, 0.0), DVec3::new(0.1, 0.7, 0.0)];
        let turn = Turn::of(&triangle);
        assert!(turn.has_area() && turn.looks_towards(DVec3::Z));
        assert!(!turn.looks_towards(-DVec3::Z) && !turn.looks_towards(DVec3::X));
        assert!(turn.is_off_plane(DVec3::new(0.5, 0.5, -1e-6)));
        assert!(!turn.is_off_plane(DVec3::new(0.5, 0.5, 0.0)));
        assert!(!turn.is_off_plane(DVec3::new(0.5, 0.5, f64::EPSILON)));
        // On a line but for rounding.
        let along = DVec3::new(0.1, 0.3, 0.7);
        assert!(!Turn::of(&[DVec3::ZERO, along, 3.0 * along]).has_area());
        assert!(!Turn::of(&[along; 3]).has_area());
    }
}
