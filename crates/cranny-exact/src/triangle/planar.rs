//! Closed triangles that lie in one plane or on one line, degenerate ones included: a segment is
//! the triangle `[p, q, q]`, a point `[p, p, p]`.

use glam::{DVec2, DVec3};

use crate::sign::{Sign, orient2d, orient3d};

/// Whether the three points lie on one line; coincident points do.
pub(super) fn collinear(points: &[DVec3; 3]) -> bool {
    AXES.into_iter().all(|axis| turn(points.map(|p| without(p, axis))).is_zero())
}

/// The closed segment that collinear points span: their least and their greatest in lexicographic
/// order, which is monotone along every line.
pub(super) fn span(points: &[DVec3; 3]) -> [DVec3; 2] {
    let [a, b, c] = *points;
    [least(least(a, b), c), greatest(greatest(a, b), c)]
}

/// Whether two closed segments in space share a point; either may be a single point.
pub(super) fn segments_meet(s: &[DVec3; 2], t: &[DVec3; 2]) -> bool {
    orient3d(s[0], s[1], t[0], t[1]).is_zero()
        && coplanar_triangles_meet(&[s[0], s[1], s[1]], &[t[0], t[1], t[1]])
}

/// Whether two closed triangles share a point, where one plane holds both.
pub(super) fn coplanar_triangles_meet(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let (in_a, in_b) = (span(a), span(b));
    let ends = [least(in_a[0], in_b[0]), greatest(in_a[1], in_b[1])];
    // Seen along this axis the plane is a plane and not a line: dropping it loses nothing.
    let axis = AXES.into_iter().find(|&axis| {
        a.iter().chain(b).any(|&p| !turn([ends[0], ends[1], p].map(|p| without(p, axis))).is_zero())
    });
    match axis {
        Some(axis) => {
            planar_triangles_meet(&a.map(|p| without(p, axis)), &b.map(|p| without(p, axis)))
        }
        None => !before(in_a[1], in_b[0]) && !before(in_b[1], in_a[0]), // all on one line
    }
}

/// Either some edges meet, or one triangle holds the other.
fn planar_triangles_meet(a: &[DVec2; 3], b: &[DVec2; 3]) -> bool {
    let edges = |t: &[DVec2; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    edges(a).iter().any(|e| edges(b).iter().any(|f| planar_segments_meet(e, f)))
        || holds_inside(a, b[0])
        || holds_inside(b, a[0])
}

/// Whether the point lies in the triangle, for points that are not on the line of all three
/// edges. A triangle without area holds none: the turns about its edges add up to zero.
fn holds_inside(triangle: &[DVec2; 3], p: DVec2) -> bool {
    let [a, b, c] = *triangle;
    let turns = [turn([a, b, p]), turn([b, c, p]), turn([c, a, p])];
    turns.contains(&Sign::Positive) != turns.contains(&Sign::Negative)
}

fn planar_segments_meet(s: &[DVec2; 2], t: &[DVec2; 2]) -> bool {
    let about_s = [turn([s[0], s[1], t[0]]), turn([s[0], s[1], t[1]])];
    let about_t = [turn([t[0], t[1], s[0]]), turn([t[0], t[1], s[1]])];
    let strictly_aside = |[p, q]: [Sign; 2]| p == q && !p.is_zero();
    if strictly_aside(about_s) || strictly_aside(about_t) {
        return false;
    }
    if about_s.iter().chain(&about_t).any(|sign| !sign.is_zero()) {
        return true; // the lines cross, and neither segment stays on one side of the other's line
    }
    let [s_ends, t_ends] = [s, t].map(|&[p, q]| if precedes(q, p) { [q, p] } else { [p, q] });
    !precedes(s_ends[1], t_ends[0]) && !precedes(t_ends[1], s_ends[0])
}

const AXES: [usize; 3] = [0, 1, 2];

/// The point without one of its coordinates.
fn without(p: DVec3, axis: usize) -> DVec2 {
    match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

fn turn([a, b, c]: [DVec2; 3]) -> Sign {
    orient2d(a, b, c)
}

fn before(p: DVec3, q: DVec3) -> bool {
    p.to_array() < q.to_array()
}

fn precedes(p: DVec2, q: DVec2) -> bool {
    p.to_array() < q.to_array()
}

fn least(p: DVec3, q: DVec3) -> DVec3 {
    if before(q, p) { q } else { p }
}

fn greatest(p: DVec3, q: DVec3) -> DVec3 {
    if before(p, q) { q } else { p }
}

#[cfg(test)]
mod tests {
    use super::*;

    const O: DVec3 = DVec3::ZERO;
    const X: DVec3 = DVec3::X;
    const Y: DVec3 = DVec3::Y;
    const Z: DVec3 = DVec3::Z;

    #[test]
    fn segments_meet_at_ends_across_and_along() {
        assert!(segments_meet(&[O, X], &[X, Y]));
        assert!(segments_meet(&[-X, X], &[-Y, Y]));
        assert!(!segments_meet(&[-X, X], &[Z - Y, Z + Y])); // one above the other
        assert!(!segments_meet(&[O, X], &[2.0 * X, 3.0 * X])); // in line, apart
        assert!(segments_meet(&[O, 2.0 * X], &[3.0 * X, X]));
        assert!(!segments_meet(&[O, X], &[Y, X + Y])); // parallel
        assert!(segments_meet(&[X, X], &[O, 2.0 * X])); // a point on a segment
        assert!(!segments_meet(&[X, X], &[O, Y]));
        assert!(segments_meet(&[X, X], &[X, X]));
        assert!(!segments_meet(&[X, X], &[Y, Y]));
    }

    #[test]
    fn a_triangle_holds_another_in_every_coordinate_plane() {
        for [u, v] in [[X, Y], [Y, Z], [Z, X], [X + Z, Y]] {
            let outer = [-8.0 * (u + v), 8.0 * u, 8.0 * v];
            let inner = [O, 0.5 * u, 0.5 * v];
            assert!(coplanar_triangles_meet(&outer, &inner));
            assert!(coplanar_triangles_meet(&inner, &outer));
            let aside = inner.map(|p| p + 16.0 * u);
            assert!(!coplanar_triangles_meet(&outer, &aside));
        }
    }

    #[test]
    fn collinear_points_span_their_extremes() {
        assert!(collinear(&[O, X, -3.0 * X]) && collinear(&[Y, Y, Y]));
        assert!(!collinear(&[O, X, Y]) && !collinear(&[O, Z, Y]) && !collinear(&[O, X, Z]));
        assert_eq!(span(&[O, X, -3.0 * X]), [-3.0 * X, X]);
        assert_eq!(span(&[Z, -Z, O]), [-Z, Z]);
    }
}
