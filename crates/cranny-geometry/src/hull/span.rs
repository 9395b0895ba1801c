//! Which dimension a point set has, exactly, and the planar and linear hulls.
//!
//! Source: Andrew (1979) for the planar hull. None for the span: far points are only guesses, exact
//! signs decide, and where a guess fails each point is tested. Cost: O(n), and O(n log n) for the
//! planar hull.

use std::cmp::Ordering;

use cranny_exact::{DVec3, Sign, orient2d, orient3d};

use crate::polygon::lexicographic;
use crate::projection::{collinear, seen_along, turn};

/// Affinely independent points that span the set; indices into it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Span {
    /// No point.
    Empty,
    /// All points coincide.
    Point(u32),
    /// All points lie on a line; the two are its extremes.
    Line([u32; 2]),
    /// All points lie in a plane.
    Plane([u32; 3]),
    /// Four points that are not coplanar; the last lies above the first three.
    Space([u32; 4]),
}

/// Finds the span. Sizes steer the search, exact signs decide it.
pub(super) fn span_of(points: &[DVec3]) -> Span {
    let indices = || 0..points.len() as u32;
    let at = |i: u32| points[i as usize];
    if points.is_empty() {
        return Span::Empty;
    }
    let Extremes { ends: [first, last], sides } = Extremes::of(points);
    if at(first) == at(last) {
        return Span::Point(first);
    }
    let axis = at(last) - at(first);
    let off_line = |i: u32| !collinear(at(first), at(last), at(i));
    let Some(third) = farthest(points, sides, |p| axis.cross(p - at(first)).length_squared())
        .filter(|&i| off_line(i))
        .or_else(|| indices().find(|&i| off_line(i)))
    else {
        return Span::Line([first, last]);
    };
    let normal = axis.cross(at(third) - at(first));
    let side = |i: u32| orient3d(at(first), at(last), at(third), at(i));
    let Some(fourth) = farthest(points, sides, |p| normal.dot(p - at(first)).abs())
        .filter(|&i| !side(i).is_zero())
        .or_else(|| indices().find(|&i| !side(i).is_zero()))
    else {
        return Span::Plane([first, last, third]);
    };
    match side(fourth) {
        Sign::Positive => Span::Space([first, last, third, fourth]),
        _ => Span::Space([last, first, third, fourth]),
    }
}

/// Points at the sides of the box of a set.
struct Extremes {
    /// The first and the last in lexicographic order.
    ends: [u32; 2],
    /// Of least and greatest y and z.
    sides: [u32; 4],
}

impl Extremes {
    /// Of at least one point.
    fn of(points: &[DVec3]) -> Self {
        let (mut ends, mut sides) = ([0; 2], [0; 4]);
        let Some(&start) = points.first() else { return Self { ends, sides } };
        let (mut first, mut last, mut low, mut high) = (start, start, start, start);
        for (i, &p) in (0..).zip(points) {
            // One comparison decides nearly always.
            if p.x <= first.x && lexicographic(p, first).is_lt() {
                (ends[0], first) = (i, p);
            }
            if p.x >= last.x && lexicographic(p, last).is_gt() {
                (ends[1], last) = (i, p);
            }
            if p.y < low.y {
                (sides[0], low.y) = (i, p.y);
            }
            if p.y > high.y {
                (sides[1], high.y) = (i, p.y);
            }
            if p.z < low.z {
                (sides[2], low.z) = (i, p.z);
            }
            if p.z > high.z {
                (sides[3], high.z) = (i, p.z);
            }
        }
        Self { ends, sides }
    }
}

/// The point of largest measure, of a few if that is more than nothing, else of all; the first of
/// equals.
fn farthest(points: &[DVec3], few: [u32; 4], measure: impl Fn(DVec3) -> f64) -> Option<u32> {
    let largest = |(best, most): (Option<u32>, f64), i: u32| {
        let m = measure(points[i as usize]);
        if m > most { (Some(i), m) } else { (best, most) }
    };
    let of_few = few.into_iter().fold((None, 0.0), largest).0;
    of_few.or_else(|| (0..points.len() as u32).fold((None, 0.0), largest).0)
}

/// An axis along which the plane of three points is seen one to one: the one nearest its normal if
/// that will do. `None` where the points are collinear.
pub(super) fn axis_of_plane([a, b, c]: [DVec3; 3]) -> Option<usize> {
    let preferred = (b - a).cross(c - a).abs().max_position();
    [preferred, 0, 1, 2].into_iter().find(|&axis| !turn(axis, a, b, c).is_zero())
}

/// The extreme points of a coplanar set, counter-clockwise seen along `axis`: Andrew's monotone
/// chain (1979) on exact turns. Strict corners only; of coincident points the lowest index.
pub(super) fn planar_hull(points: &[DVec3], axis: usize) -> Vec<u32> {
    let flat = |i: u32| seen_along(axis, points[i as usize]);
    let by = |x: f64, y: f64| x.partial_cmp(&y).unwrap_or(Ordering::Equal);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_by(|&i, &j| {
        let (p, q) = (flat(i), flat(j));
        by(p.x, q.x).then(by(p.y, q.y)).then(i.cmp(&j))
    });
    order.dedup_by(|later, kept| flat(*later) == flat(*kept));
    let turn = |a: u32, b: u32, c: u32| orient2d(flat(a), flat(b), flat(c));
    let chain = |indices: &mut dyn Iterator<Item = u32>| {
        let mut chain: Vec<u32> = Vec::new();
        for i in indices {
            while let [.., a, b] = chain[..] {
                if turn(a, b, i) == Sign::Positive {
                    break;
                }
                chain.pop();
            }
            chain.push(i);
        }
        chain.pop(); // the first of the other chain
        chain
    };
    let mut outline = chain(&mut order.iter().copied());
    outline.extend(chain(&mut order.iter().rev().copied()));
    outline
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_dimension_is_told_exactly() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        assert_eq!(span_of(&[]), Span::Empty);
        assert_eq!(span_of(&[DVec3::ONE; 3]), Span::Point(0));
        assert_eq!(
            span_of(&[DVec3::ONE, DVec3::ZERO, 2.0 * DVec3::ONE, DVec3::ZERO]),
            Span::Line([1, 2])
        );
        let mut flat = vec![p(0.1, 0.1, 0.1), p(0.7, 0.2, 0.2), p(0.3, 0.9, 0.9), p(0.4, 0.4, 0.4)];
        assert!(matches!(span_of(&flat), Span::Plane(_)));
        flat[3].z = flat[3].z.next_up();
        assert!(matches!(span_of(&flat), Span::Space(_)));
    }

    #[test]
    fn a_planar_hull_keeps_strict_corners_of_the_lowest_index() {
        let mut points = Vec::new();
        for _ in 0..2 {
            for y in 0..4 {
                for x in 0..4 {
                    points.push(DVec3::new(f64::from(x), f64::from(y), f64::from(x + y)));
                }
            }
        }
        let axis = axis_of_plane([points[0], points[3], points[12]]).unwrap();
        let mut outline = planar_hull(&points, axis);
        outline.sort_unstable();
        assert_eq!(outline, [0, 3, 12, 15]);
    }
}
