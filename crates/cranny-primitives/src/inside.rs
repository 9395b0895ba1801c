//! Whether a point lies inside a model's solid, by the nearest feature of its surface.

use std::cell::Cell;

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::triangle_distance::closest_on_triangle;
use cranny_geometry::{FaceId, Model, radians_between};
use cranny_narrow_phase::Feature;

/// A feature of a mesh and its point that is nearest to a given one.
#[derive(Clone, Copy)]
pub(crate) struct NearestPoint {
    pub(crate) feature: Feature,
    pub(crate) point: DVec3,
    /// Squared distance.
    pub(crate) squared: f64,
}

/// Whether a point (model's frame) lies inside a closed component of the model or on its surface,
/// to rounding. Surfaces that are not closed have no inside.
///
/// Cost: the faces about as near as the nearest one.
#[must_use]
pub fn contains_point(model: &Model, p: DVec3) -> bool {
    enclosing(model, p).is_some()
}

/// The nearest feature of the model's closed components, where the point lies inside of them.
pub(crate) fn enclosing(model: &Model, p: DVec3) -> Option<NearestPoint> {
    if !model.bounds().contains_point(p) {
        return None;
    }
    let here = Aabb::of_points([p]);
    let best = Cell::new(f64::INFINITY);
    let mut nearest: Option<NearestPoint> = None;
    model.tree().visit(
        |b| b.distance_squared_lower(&here) <= best.get(),
        |face| {
            if !model.topology().in_closed_component(face) {
                return;
            }
            let (point, part) = closest_on_triangle(p, &model.mesh().triangle(face));
            let squared = (point - p).length_squared();
            if squared < best.get() {
                best.set(squared);
                nearest = Some(NearestPoint {
                    feature: Feature::of_part(part, model, face),
                    point,
                    squared,
                });
            }
        },
    );
    nearest.filter(|foot| !leaves(model, foot.feature, p - foot.point))
}

/// Whether a way from a feature's point leads out of the solid that the feature bounds. An open
/// surface bounds none: every way leads out.
pub(crate) fn leaves(model: &Model, feature: Feature, way: DVec3) -> bool {
    let topology = model.topology();
    let face = match feature {
        Feature::Face(f) => Some(f),
        Feature::Edge(e) => topology.half_edges(e).first().map(|h| h.face()),
        Feature::Vertex(v) => topology.faces_at(v).first().copied(),
    };
    !face.is_some_and(|f| topology.in_closed_component(f))
        || outward_normal(model, feature).dot(way) > 0.0
}

/// Sum of the unit normals around a feature, weighted by the angle at a vertex: the sign of its
/// product with the way to a point distinguishes inside from outside (Bærentzen and Aanæs 2005).
pub(crate) fn outward_normal(model: &Model, feature: Feature) -> DVec3 {
    let mesh = model.mesh();
    let unit = |f: FaceId| mesh.area_vector(f).normalize_or_zero();
    match feature {
        Feature::Face(f) => unit(f),
        Feature::Edge(e) => model
            .topology()
            .half_edges(e)
            .iter()
            .map(|h| unit(h.face()))
            .sum::<DVec3>()
            .normalize_or_zero(),
        Feature::Vertex(v) => {
            let weighted = model.topology().faces_at(v).iter().map(|&f| {
                let corners = mesh.corners(f);
                let k = corners.iter().position(|&c| c == v).unwrap_or(0);
                let at = |i: usize| mesh.position(corners[(k + i) % 3]);
                let (a, b) = (at(1) - at(0), at(2) - at(0));
                unit(f) * radians_between(a.normalize_or_zero(), b.normalize_or_zero())
            });
            weighted.sum::<DVec3>().normalize_or_zero()
        }
    }
}
