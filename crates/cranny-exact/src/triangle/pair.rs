//! Triangle against triangle.

use glam::DVec3;

use super::Meeting;
use super::piercing::classify_segment_triangle;
use super::planar::{collinear, coplanar_triangles_meet, segments_meet, span};
use super::plane::Plane;
use crate::sign::{Sign, orient3d};

/// How two closed triangles meet.
///
/// [`Meeting::Cross`]: some point lies strictly inside both, and their planes cross. Any other
/// shared point, overlap in one plane included, is [`Meeting::Touch`]. A triangle without area is a
/// segment or a point; it has no inside and can only touch.
///
/// Exact inside the [`domain`](crate::domain), symmetric in `a` and `b`, and independent of the
/// order of the corners.
///
/// Two triangles whose planes cross meet that common line in two intervals; their order on the line
/// follows from the signs of tetrahedra (Guigue and Devillers 2003). The *closed* intervals share a
/// point where the triangles meet, the *open* ones where they cross.
#[must_use]
pub fn classify_triangles(a: &[DVec3; 3], b: &[DVec3; 3]) -> Meeting {
    let b_about_a = Plane::through(a).sides(b);
    if strictly_aside(b_about_a) {
        return Meeting::None;
    }
    let a_about_b = Plane::through(b).sides(a);
    if strictly_aside(a_about_b) {
        return Meeting::None;
    }
    let flat = |sides: [Sign; 3]| sides == [Sign::Zero; 3];
    if flat(b_about_a) || flat(a_about_b) {
        return without_common_line(a, b);
    }
    let (a, b) = (Fan::of(a, a_about_b), Fan::of(b, b_about_a));
    // In order along the common line; the two triangles see it in opposite directions.
    let ([a_low, a_high], [b_high, b_low]) = (a.ends_seen_from(&b), b.ends_seen_from(&a));
    let a_high_to_b_low = orient3d(a.apex, a_high, b.apex, b_low);
    let a_low_to_b_high = orient3d(a.apex, a_low, b.apex, b_high);
    if a_high_to_b_low == Sign::Positive || a_low_to_b_high == Sign::Negative {
        return Meeting::None;
    }
    let open_intervals_overlap =
        a_high_to_b_low == Sign::Negative && a_low_to_b_high == Sign::Positive;
    if a.straddles && b.straddles && open_intervals_overlap {
        Meeting::Cross
    } else {
        Meeting::Touch
    }
}

fn strictly_aside(sides: [Sign; 3]) -> bool {
    sides[0] == sides[1] && sides[1] == sides[2] && !sides[0].is_zero()
}

/// The triangles share a plane, or at least one of them has none.
fn without_common_line(a: &[DVec3; 3], b: &[DVec3; 3]) -> Meeting {
    let meet = match (collinear(a), collinear(b)) {
        (false, false) => coplanar_triangles_meet(a, b),
        (true, false) => classify_segment_triangle(&span(a), b).meets(),
        (false, true) => classify_segment_triangle(&span(b), a).meets(),
        (true, true) => segments_meet(&span(a), &span(b)),
    };
    if meet { Meeting::Touch } else { Meeting::None }
}

/// A triangle that meets the plane of another in a point or an interval, seen from the corner whose
/// two edges lead to the ends of that interval.
struct Fan {
    /// No other corner lies on the apex's side of the other's plane (or, where the apex lies in that
    /// plane, the other two are strictly on one side). So both edges cross the plane transversally.
    apex: DVec3,
    /// The other corners, counter-clockwise after the apex.
    next: DVec3,
    last: DVec3,
    /// On which side of the other's plane the apex is, relative to the other corners; never zero.
    side: Sign,
    /// Whether corners lie strictly on both sides of the other's plane.
    straddles: bool,
}

impl Fan {
    /// `sides` of the corners about the other's plane: neither all zero nor all strictly on one side.
    fn of(corners: &[DVec3; 3], sides: [Sign; 3]) -> Self {
        let alone = |sign: Sign| {
            let mut holders = (0..3).filter(|&i| sides[i] == sign);
            holders.next().filter(|_| holders.next().is_none())
        };
        let (apex, side) = match (alone(Sign::Positive), alone(Sign::Negative)) {
            (Some(i), _) => (i, Sign::Positive),
            (None, Some(i)) => (i, Sign::Negative),
            // One corner in the plane, the other two strictly on one side of it.
            (None, None) => {
                let touching = match sides {
                    [Sign::Zero, _, _] => 0,
                    [_, Sign::Zero, _] => 1,
                    _ => 2,
                };
                (touching, sides[(touching + 1) % 3].flipped())
            }
        };
        Self {
            apex: corners[apex],
            next: corners[(apex + 1) % 3],
            last: corners[(apex + 2) % 3],
            side,
            straddles: sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative),
        }
    }

    /// The ends of the edges from the apex, in the order in which these edges meet the common line.
    ///
    /// Let `m` and `n` point from the line towards the apexes of the two triangles, each in its own
    /// plane, and direct the line along `w` with det(m, w, n) > 0. For points `i` on an edge
    /// `(p, q)` from the first apex and `k` on an edge `(r, s)` from the second,
    /// `orient3d(p, q, r, s)` then is the sign of `(k − i) · w`. `m × w` points to the side on which
    /// the second apex lies, so where that is the positive one the corners run against `w`; and as
    /// det(n, −w, m) > 0 too, the second triangle sees the same rule for `−w`.
    fn ends_seen_from(&self, other: &Self) -> [DVec3; 2] {
        if other.side == Sign::Positive { [self.last, self.next] } else { [self.next, self.last] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] =
        [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

    fn both_ways(a: &[DVec3; 3], b: &[DVec3; 3]) -> Meeting {
        let answer = classify_triangles(a, b);
        assert_eq!(answer, classify_triangles(b, a));
        assert_eq!(answer, classify_triangles(&[a[1], a[0], a[2]], &[b[1], b[2], b[0]]));
        answer
    }

    fn with_floor(b: [[f64; 3]; 3]) -> Meeting {
        both_ways(&FLOOR, &b.map(DVec3::from_array))
    }

    #[test]
    fn a_blade_through_the_floor_crosses_it() {
        assert_eq!(
            with_floor([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]),
            Meeting::Cross
        );
        // Larger than the floor: the floor's own interval is the shorter one.
        assert_eq!(
            with_floor([[-9.0, 1.0, -9.0], [9.0, 1.0, -9.0], [0.0, 1.0, 9.0]]),
            Meeting::Cross
        );
        // Beside it, though its plane cuts the floor's.
        assert_eq!(with_floor([[5.0, 1.0, -1.0], [5.0, 1.0, 1.0], [6.0, 1.0, 0.0]]), Meeting::None);
    }

    #[test]
    fn corners_and_edges_touch() {
        let standing_on_a_corner = [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]];
        assert_eq!(with_floor(standing_on_a_corner), Meeting::Touch);
        let standing_on_an_edge = [[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        assert_eq!(with_floor(standing_on_an_edge), Meeting::Touch);
        let through_the_rim = [[2.0, 0.0, -1.0], [2.0, 0.0, 1.0], [2.0, -1.0, 0.0]];
        assert_eq!(with_floor(through_the_rim), Meeting::Touch);
        // Straddles the floor's plane and meets the floor along its rim only.
        let along_the_rim = [[-9.0, 0.0, -9.0], [9.0, 0.0, -9.0], [0.0, 0.0, 9.0]];
        assert_eq!(with_floor(along_the_rim), Meeting::Touch);
        // End to end on the common line.
        let tip_to_rim = [[0.0, 1.0, 0.0], [-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]];
        assert_eq!(with_floor(tip_to_rim), Meeting::Touch);
        let tip_beside = [[(0.0f64).next_down(), 1.0, 0.0], [-1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]];
        assert_eq!(with_floor(tip_beside), Meeting::None);
    }

    #[test]
    fn overlap_in_one_plane_touches() {
        assert_eq!(both_ways(&FLOOR, &FLOOR), Meeting::Touch);
        assert_eq!(with_floor([[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]]), Meeting::Touch);
        assert_eq!(with_floor([[4.0, 0.0, 0.0], [5.0, 0.0, 0.0], [5.0, 1.0, 0.0]]), Meeting::Touch);
        assert_eq!(with_floor([[4.0, 1.0, 0.0], [5.0, 0.0, 0.0], [5.0, 1.0, 0.0]]), Meeting::None);
        assert_eq!(with_floor([[1.0, 1.0, 1.0], [1.5, 1.0, 1.0], [1.0, 1.5, 1.0]]), Meeting::None);
    }

    #[test]
    fn triangles_without_area_can_only_touch() {
        let needle_through = [[1.0, 1.0, -1.0], [1.0, 1.0, 3.0], [1.0, 1.0, 1.0]];
        assert_eq!(with_floor(needle_through), Meeting::Touch);
        let needle_beside = needle_through.map(|[x, y, z]| [x + 3.0, y, z]);
        assert_eq!(with_floor(needle_beside), Meeting::None);
        assert_eq!(with_floor([[1.0, 1.0, 0.0]; 3]), Meeting::Touch);
        assert_eq!(with_floor([[1.0, 1.0, 1.0]; 3]), Meeting::None);
        let needle = needle_through.map(DVec3::from_array);
        let crossing = [DVec3::new(0.0, 1.0, 0.0), DVec3::ONE, DVec3::new(2.0, 1.0, 2.0)];
        assert_eq!(both_ways(&needle, &crossing), Meeting::Touch);
        assert_eq!(both_ways(&needle, &crossing.map(|p| p + DVec3::Y)), Meeting::None);
        assert_eq!(both_ways(&needle, &needle), Meeting::Touch);
    }
}
