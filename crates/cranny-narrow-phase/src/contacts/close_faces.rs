//! Which faces of two leaves are close.

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::FaceId;

use super::facet::is_beneath;
use super::leaf::Parts;
use super::posed::are_apart;
use crate::pair::Pair;

/// Tells of all pairs of faces of two leaves, of the first body and of the second, that boxes and planes do not show
/// to be more than `reach` apart.
pub(super) fn for_close_faces(
    pair: &Pair,
    [a, b]: [&Parts; 2],
    reach: f64,
    mut told: impl FnMut([FaceId; 2], [&[DVec3; 3]; 2]),
) {
    let map = &pair.first_from_second;
    let [points_a, points_b] = [a.points(), b.points()];
    for f in a.facets() {
        let own = f.corners(points_a);
        let bounds = Aabb::of_points(own);
        // Planes over the first body's faces are in the pair's frame as they are.
        if are_apart(&bounds, b.bounds(), reach) || is_beneath(f.normal, f.top, points_b, reach) {
            continue;
        }
        for g in b.facets() {
            let its = g.corners(points_b);
            if are_apart(&bounds, &Aabb::of_points(its), reach)
                || is_beneath(f.normal, f.top, &its, reach)
            {
                continue;
            }
            let normal = map.apply_vector(g.normal);
            let top = g.top + normal.dot(map.translation);
            if !is_beneath(normal, top, &own, reach) {
                told([f.face, g.face], [&own, &its]);
            }
        }
    }
}
