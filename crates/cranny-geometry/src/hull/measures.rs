//! Volume, area and centroid of a hull, in `f64`.
//!
//! Source: cones over the triangles, added up, as in Mirtich (1996, "Fast and accurate computation
//! of polyhedral mass properties"). Cost: O(n) a call.

use cranny_exact::DVec3;

use super::{ConvexHull, HullKind};

impl ConvexHull {
    /// The volume; 0 but for [`HullKind::Volume`]. A sum of positive terms about the first vertex:
    /// relative error a few `ε` times the number of triangles in the worst case, as far as the
    /// shape is not a sliver (whose terms themselves suffer from rounding).
    #[must_use]
    pub fn volume(&self) -> f64 {
        if self.kind == HullKind::Volume {
            self.cones().map(|(six_volumes, _)| six_volumes).sum::<f64>().max(0.0) / 6.0
        } else {
            0.0
        }
    }

    /// The area of the surface. Both sides of a plate count, as its triangles do; 0 for segments
    /// and points.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.surface_pieces().map(|(area, _)| area).sum()
    }

    /// The centroid of the solid, or of the plate, the segment, the point. Of the surface where a
    /// sliver's volume vanishes in `f64`, of the vertices where its area does too. `None` for an
    /// empty hull. Within the box of the hull.
    #[must_use]
    pub fn centroid(&self) -> Option<DVec3> {
        let origin = *self.positions.first()?;
        let bounds = self.bounds();
        let solid = (self.kind == HullKind::Volume).then(|| mean(self.cones())).flatten();
        let vertices = || self.positions.iter().map(|&p| (1.0, p - origin));
        let mean = solid
            .or_else(|| mean(self.surface_pieces()))
            .or_else(|| mean(vertices()))
            .unwrap_or(DVec3::ZERO);
        Some((origin + mean).clamp(bounds.min, bounds.max))
    }

    /// Six volumes and the centroid, relative to the first vertex, of the cones from it over the
    /// triangles.
    fn cones(&self) -> impl Iterator<Item = (f64, DVec3)> + '_ {
        self.corners_from_first().map(|[a, b, c]| (a.dot(b.cross(c)), (a + b + c) * 0.25))
    }

    /// Area and centroid, relative to the first vertex, of the triangles.
    fn surface_pieces(&self) -> impl Iterator<Item = (f64, DVec3)> + '_ {
        self.corners_from_first()
            .map(|[a, b, c]| (0.5 * (b - a).cross(c - a).length(), (a + b + c) * (1.0 / 3.0)))
    }

    fn corners_from_first(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        let origin = self.positions.first().copied().unwrap_or_default();
        self.surface.triangles.iter().map(move |t| t.map(|v| self.positions[v as usize] - origin))
    }
}

/// The weighted mean; `None` where the weights vanish.
fn mean(pieces: impl Iterator<Item = (f64, DVec3)>) -> Option<DVec3> {
    let (weight, sum) =
        pieces.fold((0.0, DVec3::ZERO), |(w, sum), (weight, at)| (w + weight, sum + weight * at));
    let mean = sum / weight;
    (weight > 0.0 && mean.is_finite()).then_some(mean)
}
