//! The least distance of two triangles, in exact rationals.

use cranny_exact::{Aabb, DVec3, Meeting};

use crate::locate::PosedMesh;
use crate::rational::{Q, Q3};
use crate::triangle::rational_meeting;

/// The *square* of the least distance of two closed triangles: 0 where they meet. Roots are
/// irrational, so whoever has a distance compares its square.
///
/// All fifteen pairs of features that can attain it are tried, whole: a segment's nearest point to
/// a point by its parameter cut to \[0, 1\], a triangle's by barycentric coordinates where none is
/// negative, two lines' by the parameters where the connection is at right angles to both.
///
/// # Panics
///
/// Where a coordinate is not finite.
#[must_use]
pub fn rational_distance_squared(a: &[DVec3; 3], b: &[DVec3; 3]) -> Q {
    if rational_meeting(a, b) != Meeting::None {
        return Q::ZERO;
    }
    let (a, b) = (a.map(Q3::exactly), b.map(Q3::exactly));
    let mut found = Vec::new();
    for (from, to) in [(&a, &b), (&b, &a)] {
        for p in from {
            found.extend(over_inside(p, to));
            found.extend((0..3).map(|i| from_segment(p, &to[i], &to[(i + 1) % 3])));
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            found.extend(between_lines([&a[i], &a[(i + 1) % 3]], [&b[j], &b[(j + 1) % 3]]));
        }
    }
    found.into_iter().reduce(|least, x| if x < least { x } else { least }).unwrap_or(Q::ZERO)
}

/// The *square* of the least distance of two posed surfaces: 0 where they meet.
///
/// Pairs of faces whose boxes are certainly farther apart than some pair of corners are left out;
/// all others are measured as [`rational_distance_squared`] does.
#[must_use]
pub fn rational_gap_squared(a: &PosedMesh, b: &PosedMesh) -> Q {
    let mut order: Vec<(f64, usize, usize)> = Vec::new();
    for (i, f) in a.triangles().iter().enumerate() {
        for (j, g) in b.triangles().iter().enumerate() {
            order.push((box_gap_squared(f, g), i, j));
        }
    }
    order.sort_by(|x, y| x.0.total_cmp(&y.0));
    let mut least: Option<Q> = None;
    for (low, i, j) in order {
        let low = Q::try_from(low).unwrap_or(Q::ZERO);
        if least.as_ref().is_some_and(|least| *least <= low) {
            break;
        }
        let found = rational_distance_squared(&a.triangles()[i], &b.triangles()[j]);
        if least.as_ref().is_none_or(|least| found < *least) {
            least = Some(found);
        }
    }
    least.unwrap_or(Q::ZERO)
}

/// No more than the squared distance of the triangles' boxes: rounded, and then less by more than
/// all of it.
fn box_gap_squared(f: &[DVec3; 3], g: &[DVec3; 3]) -> f64 {
    let [f, g] = [f, g].map(|t| Aabb::of_points(*t));
    let apart = (f.min - g.max).max(g.min - f.max).max(DVec3::ZERO);
    apart.length_squared() * (1.0 - 16.0 * f64::EPSILON)
}

/// By how much `distance` misses the root of `squared`, to a few units in the last place of the
/// error itself: the difference of the squares is exact.
///
/// # Panics
///
/// Where `distance` is not finite.
#[must_use]
pub fn error_of_root(distance: f64, squared: &Q) -> f64 {
    let exact = Q::try_from(distance).unwrap_or_else(|_| panic!("{distance} is not a number"));
    let sum = distance.abs() + squared.to_f64().value().sqrt();
    if sum == 0.0 {
        return 0.0;
    }
    let difference: Q = &exact * &exact - squared;
    difference.to_f64().value() / sum
}

/// Whether `distance` is within `error` of the root of `squared`.
///
/// # Panics
///
/// Where a number is not finite.
#[must_use]
pub fn is_root_within(distance: f64, squared: &Q, error: f64) -> bool {
    let exact = |x: f64| Q::try_from(x).unwrap_or_else(|_| panic!("{x} is not a number"));
    let (low, high) = (exact(distance) - exact(error), exact(distance) + exact(error));
    let above = low <= Q::ZERO || &low * &low <= *squared;
    above && high >= Q::ZERO && *squared <= &high * &high
}

/// From a point to a triangle's plane, where it stands over the closed triangle.
fn over_inside(p: &Q3, [a, b, c]: &[Q3; 3]) -> Option<Q> {
    let normal = (b - a).cross(&(c - a));
    if normal.is_zero() {
        return None;
    }
    let inward = |u: &Q3, v: &Q3| normal.dot(&(v - u).cross(&(p - u))) >= Q::ZERO;
    let over = inward(a, b) && inward(b, c) && inward(c, a);
    let height = normal.dot(&(p - a));
    over.then(|| &height * &height / normal.dot(&normal))
}

fn from_segment(p: &Q3, a: &Q3, b: &Q3) -> Q {
    let along = b - a;
    let squared = along.dot(&along);
    let t = if squared.is_zero() { Q::ZERO } else { along.dot(&(p - a)) / squared };
    let t = if t < Q::ZERO {
        Q::ZERO
    } else if t > Q::ONE {
        Q::ONE
    } else {
        t
    };
    let apart = p - &a.towards(b, &t);
    apart.dot(&apart)
}

/// Between two lines that are not parallel, where both nearest points lie on the segments.
fn between_lines(p: [&Q3; 2], q: [&Q3; 2]) -> Option<Q> {
    let (d, e, r) = (p[1] - p[0], q[1] - q[0], q[0] - p[0]);
    let normal = d.cross(&e);
    let squared = normal.dot(&normal);
    if squared.is_zero() {
        return None;
    }
    let (s, t) = (normal.dot(&r.cross(&e)) / &squared, normal.dot(&r.cross(&d)) / &squared);
    let within = |x: &Q| *x >= Q::ZERO && *x <= Q::ONE;
    let height = normal.dot(&r);
    (within(&s) && within(&t)).then(|| &height * &height / squared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies::cuboid;
    use cranny_exact::Pose;

    const FLOOR: [DVec3; 3] =
        [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

    fn squared(a: [[f64; 3]; 3], b: &[DVec3; 3]) -> Q {
        let a = a.map(DVec3::from_array);
        let found = rational_distance_squared(&a, b);
        assert_eq!(found, rational_distance_squared(b, &a));
        found
    }

    #[test]
    fn each_kind_of_features_can_be_nearest() {
        let over = squared([[1.0, 1.0, 3.0], [9.0, 9.0, 9.0], [1.0, 9.0, 9.0]], &FLOOR);
        assert_eq!(over, Q::from(9));
        let beside_a_side = squared([[4.0, 4.0, 0.0], [9.0, 9.0, 9.0], [9.0, 9.0, 1.0]], &FLOOR);
        assert_eq!(beside_a_side, Q::from(8));
        let beyond_a_corner =
            squared([[7.0, -4.0, 0.0], [9.0, -3.0, 9.0], [9.0, -9.0, 0.0]], &FLOOR);
        assert_eq!(beyond_a_corner, Q::from(25));
        let crossed = squared([[1.0, -2.0, -1.0], [1.0, -1.0, 2.0], [1.0, -9.0, 2.0]], &FLOOR);
        // The side from (1, −2, −1) to (1, −1, 2): its line is 5/√10 off the origin of the y–z
        // plane.
        assert_eq!(crossed, Q::from(25) / Q::from(10));
        let edges = squared([[1.0, -1.0, 2.0], [1.0, 1.0, 2.0], [1.0, 0.0, 9.0]], &{
            [DVec3::ZERO, 4.0 * DVec3::X, DVec3::new(2.0, 0.0, -5.0)]
        });
        assert_eq!(edges, Q::from(4));
    }

    #[test]
    fn what_meets_has_no_distance_and_needles_have_one() {
        assert_eq!(squared([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0; 3]], &FLOOR), Q::ZERO);
        assert_eq!(squared([[5.0, 0.0, 0.0]; 3], &FLOOR), Q::ONE);
        let needle = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
        assert_eq!(squared([[1.0, 1.0, 1.0]; 3], &needle), Q::from(2));
    }

    #[test]
    fn a_distance_is_compared_by_its_square() {
        assert!(is_root_within(2f64.sqrt(), &Q::from(2), 1e-15));
        assert!(!is_root_within(2f64.sqrt() + 2e-15, &Q::from(2), 1e-15));
        assert!(!is_root_within(2f64.sqrt() - 2e-15, &Q::from(2), 1e-15));
        assert!(is_root_within(0.0, &Q::ZERO, 0.0));
        assert!(is_root_within(1e-20, &Q::ZERO, 1e-19));
    }

    #[test]
    fn the_least_of_all_pairs_is_found_though_few_are_measured() {
        // A cube over the middle of a slab, 1/4 above it, and the same turned through a quarter.
        let slab = cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0]);
        let cube = cuboid([0.0, 0.0, 0.25], [1.0, 1.0, 1.25]);
        let posed = |mesh, by| PosedMesh::new(mesh, &Pose::at(by));
        let gap = |by| rational_gap_squared(&posed(&slab, DVec3::ZERO), &posed(&cube, by));
        assert_eq!(gap(DVec3::ZERO), Q::from(1) / Q::from(16));
        assert_eq!(gap(DVec3::new(7.0, 8.0, -0.25)), Q::from(9 + 16));
        assert_eq!(gap(-0.25 * DVec3::Z), Q::ZERO);
        assert_eq!(gap(-DVec3::Z), Q::ZERO);
    }

    #[test]
    fn the_error_of_a_root_is_told_below_the_roots_own_rounding() {
        assert_eq!(error_of_root(3.0, &Q::from(9)), 0.0);
        assert_eq!(error_of_root(0.0, &Q::ZERO), 0.0);
        assert_eq!(error_of_root(1e-30, &Q::ZERO), 1e-30);
        // 9 + 2^-60: its root is 3 + 2^-60 / 6 to first order.
        let squared = Q::from(9) + Q::try_from(0.5f64.powi(60)).unwrap();
        let error = error_of_root(3.0, &squared);
        assert!((error + 0.5f64.powi(60) / 6.0).abs() < 1e-30, "{error:e}");
    }
}
