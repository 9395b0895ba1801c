//! Which faces of two leaves meet.

use cranny_exact::Aabb;

use super::facet::is_beneath;
use super::leaf::Parts;
use super::posed::are_apart;
use crate::answer::Counters;
use crate::pair::Pair;
use crate::surface::FacePair;

/// Lists the faces of two leaves that meet, of the first body and of the second.
pub(super) fn meet(
    pair: &Pair,
    [a, b]: [&Parts; 2],
    meeting: &mut Vec<FacePair>,
    counters: &mut Counters,
) {
    let (rounding, map) = (pair.culling_error(), &pair.first_from_second);
    let [points_a, points_b] = [a.points(), b.points()];
    for f in a.facets() {
        let own = f.corners(points_a);
        let bounds = Aabb::of_points(own);
        // Planes over the first body's faces are in the pair's frame as they are.
        if are_apart(&bounds, b.bounds(), rounding)
            || is_beneath(f.normal, f.top, points_b, rounding)
        {
            continue;
        }
        for g in b.facets() {
            let its = g.corners(points_b);
            if are_apart(&bounds, &Aabb::of_points(its), rounding)
                || is_beneath(f.normal, f.top, &its, rounding)
            {
                continue;
            }
            let normal = map.apply_vector(g.normal);
            let top = g.top + normal.dot(map.translation);
            if !is_beneath(normal, top, &own, rounding) {
                counters.triangle_tests += 1;
                meeting.extend(FacePair::of([f.face, g.face], [&own, &its]));
            }
        }
    }
}
