//! What is held against an envelope.

use cranny_exact::{Aabb, DVec3};

/// Something in the body's frame that is known by how far it comes in any direction: a body, its
/// hull, its box, a point.
///
/// `least(n)` is at most the least of `n · x` over its points x, for unit vectors n. A bound that
/// is too low is safe: more facets are opened. Bounds that posing may have rounded carry that
/// rounding ([`RigidMap::posing_error`](cranny_exact::RigidMap::posing_error)).
#[derive(Clone, Copy, Debug)]
pub struct Probe<F> {
    least: F,
    bounds: Aabb,
    margin: f64,
}

impl<F: Fn(DVec3) -> f64> Probe<F> {
    /// From its support function; everything within `margin >= 0` of the probe counts as met. Cost:
    /// six evaluations, for the box.
    #[must_use]
    pub fn new(least: F, margin: f64) -> Self {
        let min = DVec3::new(least(DVec3::X), least(DVec3::Y), least(DVec3::Z));
        let max = -DVec3::new(least(-DVec3::X), least(-DVec3::Y), least(-DVec3::Z));
        // Room for normals whose length is not quite 1.
        let margin = (margin * (1.0 + 8.0 * f64::EPSILON)).next_up();
        Self { least, bounds: Aabb { min, max }.grown(margin), margin }
    }

    /// The box of the probe, grown by the margin.
    #[must_use]
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// At most the least of `direction · x` over its points x.
    #[must_use]
    pub fn least(&self, direction: DVec3) -> f64 {
        (self.least)(direction)
    }

    /// Whether all of it certainly has `direction · x > offset`, the margin kept.
    pub(super) fn is_beyond(&self, direction: DVec3, offset: f64) -> bool {
        self.is_above(self.least(direction), offset)
    }

    /// Whether a probe whose `least` in some direction is `lowest` certainly misses all that comes
    /// no farther than `reach` in that direction, the margin kept.
    pub(super) fn is_above(&self, lowest: f64, reach: f64) -> bool {
        lowest > (reach + self.margin).next_up()
    }
}

/// The hull of some points. Cost of an evaluation: one dot product a point.
impl<'p> Probe<Box<dyn Fn(DVec3) -> f64 + 'p>> {
    /// From at least one point; see [`new`](Self::new).
    #[must_use]
    pub fn of_points(points: &'p [DVec3], margin: f64) -> Self {
        let size = points.iter().fold(DVec3::ZERO, |size, p| size.max(p.abs()));
        Self::new(
            Box::new(move |n: DVec3| {
                let least = points.iter().map(|&p| n.dot(p)).fold(f64::INFINITY, f64::min);
                // As for the half-spaces of facets: five roundings, and underflow.
                let rounding = 2.0 * f64::EPSILON * n.abs().dot(size) + f64::MIN_POSITIVE;
                (least - rounding).next_down()
            }),
            margin,
        )
    }
}
