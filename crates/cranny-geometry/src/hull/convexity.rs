//! Whether a closed surface is the boundary of a convex body, exactly: what is demanded of a hull
//! that was read.
//!
//! No edge that bends inwards is not enough: the sides of a pyramid over a five-pointed star go
//! twice around its axis and bend outwards everywhere. After Mehlhorn, Näher, Seel, Seidel, Schilz,
//! Schirra and Uhrig ('Checking geometric programs or verification of geometric structures', 1999)
//! it is enough that no edge bends inwards, that some point is strictly beneath every triangle, and
//! that a ray from it meets one triangle only: seen from the point, the surface covers the sphere
//! as often as it covers the ray.
//!
//! The point is the mean of the vertices. Where the body is so thin that rounding puts it outside,
//! the hull is built again, and its edges compared. Cost: linear, but for such bodies and for
//! plates.

use cranny_exact::{Aabb, DVec2, DVec3, Sign, orient2d};

use super::flat::edge_sign;
use super::quickhull::{HullSurface, hull_of_some, previous};
use super::side::Side;
use super::span::{axis_of_plane, planar_hull};
use super::{HullKind, plate, twofold};
use crate::projection::turn;

/// Whether a surface whose twins match is that of a hull with these vertices.
pub(super) fn is_convex(kind: HullKind, positions: &[DVec3], surface: &HullSurface) -> bool {
    match kind {
        HullKind::Empty | HullKind::Point | HullKind::Segment => true,
        HullKind::Polygon => is_plate(positions, surface),
        HullKind::Volume => is_around_a_body(positions, surface),
    }
}

fn is_around_a_body(positions: &[DVec3], surface: &HullSurface) -> bool {
    let bounds = Aabb::of_points(positions.iter().copied());
    let mean = positions.iter().sum::<DVec3>() / positions.len() as f64;
    let middle = mean.clamp(bounds.min, bounds.max);
    let extent = bounds.max - bounds.min;
    let margin = Side::greatest_margin(extent);
    let (twins, _) = surface.twins.as_chunks::<3>();
    let origins = surface.triangles.as_flattened();
    let (mut is_beneath_all, mut crossed) = (true, 0);
    for ((t, corners), twins) in (0..).zip(&surface.triangles).zip(twins) {
        let triangle @ [a, b, c] = corners.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        // Each edge is looked at from one side.
        for &twin in twins.iter().filter(|&&twin| twin > 3 * t) {
            let apex = positions[origins[previous(twin) as usize] as usize];
            let is_beneath = normal.dot(apex - a) < -margin;
            if !is_beneath && nearly_on(triangle, extent, apex) == Sign::Positive {
                return false;
            }
        }
        is_beneath_all &= normal.dot(middle - a) < -margin
            || nearly_on(triangle, extent, middle) == Sign::Negative;
        crossed += usize::from(is_crossed(triangle, middle));
    }
    if is_beneath_all { crossed == 1 } else { has_edges_of_hull(positions, surface) }
}

/// The side of a triangle's plane on which a point lies, looked at more closely.
#[cold]
fn nearly_on(triangle: [DVec3; 3], extent: DVec3, p: DVec3) -> Sign {
    let side = Side::new(triangle, extent);
    let height = side.height(p);
    let is_near = height.abs() <= side.margin();
    let by_pairs = if is_near { twofold::sign(&side, triangle, p) } else { None };
    by_pairs.unwrap_or_else(|| side.sign(height, p, || triangle))
}

/// Whether the ray from a point along x meets a triangle that it is beneath: whether it does so
/// seen along x, and comes out. A corner or edge that the ray hits counts for one of the triangles
/// around it.
fn is_crossed(triangle: [DVec3; 3], from: DVec3) -> bool {
    let is_right = triangle.map(|p| p.y >= from.y);
    if is_right[0] == is_right[1] && is_right[1] == is_right[2] {
        return false;
    }
    let [from, a, b, c] =
        [from, triangle[0], triangle[1], triangle[2]].map(|p| DVec2::new(p.y, p.z));
    // The winding number of the triangle about the point (Sunday 2001).
    let winding: i32 = [(a, b), (b, c), (c, a)]
        .into_iter()
        .map(|(p, q)| match (p.x >= from.x, q.x >= from.x) {
            (false, true) => i32::from(orient2d(p, q, from) == Sign::Positive),
            (true, false) => -i32::from(orient2d(p, q, from) == Sign::Negative),
            _ => 0,
        })
        .sum();
    winding > 0
}

/// Whether the edges that bend are those of the hull of the vertices, all of which are extreme.
fn has_edges_of_hull(positions: &[DVec3], surface: &HullSurface) -> bool {
    let bends = |surface: &HullSurface| {
        let half_edges = 0..surface.twins.len() as u32;
        let bends = |&h: &u32| edge_sign(positions, surface, h) == Sign::Negative;
        let mut edges: Vec<[u32; 2]> = half_edges.filter(bends).map(|h| surface.ends(h)).collect();
        edges.sort_unstable();
        edges
    };
    hull_of_some(positions).is_some_and(|hull| bends(&hull) == bends(surface))
}

/// Whether a surface is a fan over the outline of its vertices, and the same turned over.
fn is_plate(positions: &[DVec3], surface: &HullSurface) -> bool {
    let front = &surface.triangles[..surface.triangles.len() / 2];
    let Some(&[first, second, _]) = front.first() else { return false };
    let outline: Vec<u32> = [first, second].into_iter().chain(front.iter().map(|t| t[2])).collect();
    if *surface != plate(&outline) {
        return false;
    }
    let corners = |t: [u32; 3]| t.map(|v| positions[v as usize]);
    let is_flat = |h: u32| edge_sign(positions, surface, h).is_zero();
    let Some(axis) = axis_of_plane(corners(front[0])) else { return false };
    let mut expected = planar_hull(positions, axis);
    let [a, b, c] = corners(front[0]);
    if turn(axis, a, b, c) == Sign::Negative {
        expected.reverse();
    }
    let Some(start) = expected.iter().position(|&v| v == first) else { return false };
    expected.rotate_left(start);
    expected == outline && (0..surface.twins.len() as u32).all(is_flat)
}

#[cfg(test)]
mod tests {
    use super::super::ConvexHull;
    use super::*;

    /// Whether the hull of some points passes, once as it is and once with its triangles changed.
    fn passes(points: &[DVec3], change: impl Fn(&mut HullSurface)) -> bool {
        let ConvexHull { kind, positions, mut surface, .. } = ConvexHull::of_points(points);
        assert!(is_convex(kind, &positions, &surface));
        change(&mut surface);
        is_convex(kind, &positions, &surface)
    }

    fn points(points: &[[f64; 3]]) -> Vec<DVec3> {
        points.iter().map(|&p| DVec3::from_array(p)).collect()
    }

    /// Twins by the ends of half-edges, each pair of which runs once each way.
    fn surface(triangles: Vec<[u32; 3]>) -> HullSurface {
        let mut surface = HullSurface { triangles, twins: Vec::new() };
        let count = 3 * surface.triangles.len() as u32;
        let ends = |h| surface.ends(h);
        let is_twin = |g: u32, h: u32| ends(g) == [ends(h)[1], ends(h)[0]];
        let twin = |h| (0..count).find(|&g| is_twin(g, h)).unwrap();
        surface.twins = (0..count).map(twin).collect();
        surface
    }

    /// Two apexes above and below a regular pentagon, around which the sides step by `step`
    /// corners.
    fn bipyramid(step: u32) -> (Vec<DVec3>, HullSurface) {
        let corners = [[10.0, 0.0], [3.1, 9.5], [-8.1, 5.9], [-8.1, -5.9], [3.1, -9.5]];
        let mut positions: Vec<DVec3> = corners.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        positions.extend([DVec3::new(0.0, 0.0, 7.0), DVec3::new(0.0, 0.0, -7.0)]);
        let side = |i: u32| [(i * step) % 5, ((i + 1) * step) % 5];
        let above = (0..5).map(side).map(|[a, b]| [a, b, 5]);
        let below = (0..5).map(side).map(|[a, b]| [b, a, 6]);
        (positions, surface(above.chain(below).collect()))
    }

    #[test]
    fn what_goes_around_twice_is_no_hull() {
        for (step, is_hull) in [(1, true), (2, false)] {
            let (positions, surface) = bipyramid(step);
            assert!(HullKind::Volume.allows(positions.len(), surface.triangles.len()));
            let reflex = |h: u32| edge_sign(&positions, &surface, h) == Sign::Positive;
            assert!(!(0..surface.twins.len() as u32).any(reflex), "no edge gives it away");
            assert_eq!(is_convex(HullKind::Volume, &positions, &surface), is_hull);
        }
    }

    #[test]
    fn what_goes_around_twice_is_found_out_however_thin() {
        // Two apexes an ulp apart, and the middle rounded onto one of them.
        let low = 2f64.powi(60);
        for (step, is_hull) in [(1, true), (2, false)] {
            let (mut positions, surface) = bipyramid(step);
            positions[..5].iter_mut().for_each(|p| p.z = low);
            (positions[5].z, positions[6].z) = (low.next_up(), low.next_down());
            assert_eq!(is_convex(HullKind::Volume, &positions, &surface), is_hull);
        }
    }

    #[test]
    fn hulls_pass_however_thin() {
        let cube: Vec<[f64; 3]> =
            (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        assert!(passes(&points(&cube), |_| ()));
        for height in [1e-9, 1e-300f64.sqrt(), 4.9e-60] {
            let flat: Vec<DVec3> =
                points(&cube).iter().map(|&p| p * DVec3::new(1.0, 1.0, height)).collect();
            assert!(passes(&flat, |_| ()));
        }
        // One ulp high, far away: the middle is rounded onto a side.
        let (low, high) = (2f64.powi(60), 2f64.powi(60).next_up());
        let thin = [[0.0, 0.0, low], [1.0, 0.0, low], [0.0, 1.0, low], [0.3, 0.3, high]];
        assert!(passes(&points(&thin), |_| ()));
    }

    #[test]
    fn a_surface_turned_inside_out_is_no_hull() {
        let cube: Vec<[f64; 3]> =
            (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
        let turned = |own: &mut HullSurface| {
            *own = surface(own.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect());
        };
        assert!(!passes(&points(&cube), turned));
    }

    #[test]
    fn a_plate_is_a_fan_over_its_outline() {
        let square = points(&[[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
        assert!(passes(&square, |_| ()));
        assert!(!passes(&square, |surface| *surface = plate(&[0, 2, 1, 3])));
        assert!(!passes(&square, |surface| surface.triangles.swap(0, 1)));
        // Turned over as a whole, it is a plate still.
        assert!(passes(&square, |surface| *surface = plate(&[3, 2, 1, 0])));
        let pentagon = &bipyramid(1).0[..5];
        assert!(passes(pentagon, |_| ()));
        assert!(!passes(pentagon, |surface| *surface = plate(&[0, 2, 4, 1, 3])));
    }
}
