//! Triangle against triangle.

use glam::DVec3;

use super::Meeting;
use super::piercing::classify_segment_triangle;
use super::planar::{collinear, coplanar_triangles_meet, segments_meet, span};
use super::plane::Plane;
use crate::sign::{Arithmetic, Sign, orient3d_by};

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
    judge_triangles(a, b).0
}

/// [`classify_triangles`], and what arithmetic it took. (Whatever lies in one plane took more than
/// a filter.)
#[must_use]
pub fn judge_triangles(a: &[DVec3; 3], b: &[DVec3; 3]) -> (Meeting, Arithmetic) {
    let mut by = Arithmetic::Filter;
    let meeting = match CommonLine::of(a, b, &mut by) {
        Ok(line) => line.meeting(),
        Err(meeting) => meeting,
    };
    (meeting, by)
}

/// How two triangles meet, where they cross if they do so in general position, and what arithmetic
/// it took.
///
/// No crossing where they do not cross, or where a corner of one lies in the plane of the other or
/// an edge meets an edge: [`locate_piercing`](super::locate_piercing) says which features meet
/// there.
#[must_use]
pub fn cross_triangles(a: &[DVec3; 3], b: &[DVec3; 3]) -> (Meeting, Option<Crossing>, Arithmetic) {
    let mut by = Arithmetic::Filter;
    let (meeting, crossing) = match CommonLine::of(a, b, &mut by) {
        Ok(line) => match line.meeting() {
            Meeting::Cross => (Meeting::Cross, line.crossing(&mut by)),
            meeting => (meeting, None),
        },
        Err(meeting) => (meeting, None),
    };
    (meeting, crossing, by)
}

/// The segment in which two triangles cross in general position, by what makes its ends.
///
/// It runs along n × m, n being the first triangle's normal and m the second's, so that of the
/// first triangle the part behind the second lies on its left, seen against n.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crossing {
    /// Where it begins, where it ends.
    pub ends: [CrossingEnd; 2],
}

impl Crossing {
    /// The segment between two ends. `rises`: the edge of the first of them, run through as its
    /// triangle has it, goes from the back of the other triangle to the front.
    ///
    /// Where an edge of the first triangle goes to the back of the second, what is behind ends to
    /// its right: there the segment ends. Seen from the second triangle it runs the other way.
    #[must_use]
    pub fn of([one, other]: [CrossingEnd; 2], rises: bool) -> Self {
        let begins = rises == (one.owner == 0);
        Self { ends: if begins { [one, other] } else { [other, one] } }
    }
}

/// An end of a segment in which two triangles cross: an edge of one pierces the inside of the
/// other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CrossingEnd {
    /// Whose edge it is: 0 for the first triangle, 1 for the second.
    pub owner: u8,
    /// The edge, from corner `edge` to corner `(edge + 1) % 3`.
    pub edge: u8,
}

/// Two triangles whose planes cross, each reaching the other's plane: the intervals in which they
/// meet the common line.
struct CommonLine<'t> {
    triangles: [&'t [DVec3; 3]; 2],
    fans: [Fan; 2],
    /// For each triangle the corners whose edges from the apex lead to the interval's lower and
    /// upper end.
    low: [usize; 2],
    high: [usize; 2],
    /// On which side of the other's plane the corners of each are.
    sides: [[Sign; 3]; 2],
    a_high_to_b_low: Sign,
    a_low_to_b_high: Sign,
}

impl<'t> CommonLine<'t> {
    /// `Err` with the answer where there is no such line, or the intervals need not be looked at.
    fn of(a: &'t [DVec3; 3], b: &'t [DVec3; 3], by: &mut Arithmetic) -> Result<Self, Meeting> {
        let b_about_a = Plane::through(a).sides(b, by);
        if strictly_aside(b_about_a) {
            return Err(Meeting::None);
        }
        let a_about_b = Plane::through(b).sides(a, by);
        if strictly_aside(a_about_b) {
            return Err(Meeting::None);
        }
        let flat = |sides: [Sign; 3]| sides == [Sign::Zero; 3];
        if flat(b_about_a) || flat(a_about_b) {
            return Err(without_common_line(a, b));
        }
        let fans = [Fan::of(a_about_b), Fan::of(b_about_a)];
        // In order along the common line; the two triangles see it in opposite directions.
        let ([a_low, a_high], [b_high, b_low]) =
            (fans[0].ends_seen_from(&fans[1]), fans[1].ends_seen_from(&fans[0]));
        let mut line = Self {
            triangles: [a, b],
            fans,
            low: [a_low, b_low],
            high: [a_high, b_high],
            sides: [a_about_b, b_about_a],
            a_high_to_b_low: Sign::Zero,
            a_low_to_b_high: Sign::Zero,
        };
        line.a_high_to_b_low = line.direction(a_high, b_low, by);
        line.a_low_to_b_high = line.direction(a_low, b_high, by);
        Ok(line)
    }

    /// In which direction along the line the end made by corner `l` of the second triangle lies,
    /// seen from that made by corner `k` of the first.
    fn direction(&self, k: usize, l: usize, by: &mut Arithmetic) -> Sign {
        let [(a, p), (b, q)] = [0, 1].map(|i| (self.triangles[i], self.fans[i].apex));
        orient3d_by(a[p], a[k], b[q], b[l], by)
    }

    fn meeting(&self) -> Meeting {
        if self.a_high_to_b_low == Sign::Positive || self.a_low_to_b_high == Sign::Negative {
            return Meeting::None;
        }
        let open_intervals_overlap =
            self.a_high_to_b_low == Sign::Negative && self.a_low_to_b_high == Sign::Positive;
        if self.fans.iter().all(|fan| fan.straddles) && open_intervals_overlap {
            Meeting::Cross
        } else {
            Meeting::Touch
        }
    }

    /// The common interval of triangles that cross: from the greater of the lower ends to the
    /// lesser of the upper ends.
    fn crossing(&self, by: &mut Arithmetic) -> Option<Crossing> {
        let in_a_plane = |sides: &[Sign; 3]| sides.contains(&Sign::Zero);
        if self.sides.iter().any(in_a_plane) {
            return None;
        }
        let [lower, upper] = [self.low, self.high].map(|[k, l]| self.direction(k, l, by));
        let of_a_or_b = |is_of_a: bool, corners: [usize; 2]| {
            let owner = usize::from(!is_of_a);
            self.end(owner, corners[owner])
        };
        let low = match lower {
            Sign::Zero => return None,
            sign => of_a_or_b(sign == Sign::Negative, self.low),
        };
        let high = match upper {
            Sign::Zero => return None,
            sign => of_a_or_b(sign == Sign::Positive, self.high),
        };
        let rises = self.sides[usize::from(low.owner)][usize::from(low.edge)] == Sign::Negative;
        Some(Crossing::of([low, high], rises))
    }

    fn end(&self, owner: usize, corner: usize) -> CrossingEnd {
        let apex = self.fans[owner].apex;
        let edge = if corner == (apex + 1) % 3 { apex } else { corner };
        CrossingEnd { owner: owner as u8, edge: edge as u8 }
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
#[derive(Clone, Copy)]
struct Fan {
    /// No other corner lies on the apex's side of the other's plane (or, where the apex lies in
    /// that plane, the other two are strictly on one side). So both edges cross the plane
    /// transversally.
    apex: usize,
    /// On which side of the other's plane the apex is, relative to the other corners; never zero.
    side: Sign,
    /// Whether corners lie strictly on both sides of the other's plane.
    straddles: bool,
}

impl Fan {
    /// `sides` of the corners about the other's plane: neither all zero nor all strictly on one
    /// side.
    fn of(sides: [Sign; 3]) -> Self {
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
        let straddles = sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative);
        Self { apex, side, straddles }
    }

    /// The corners at the ends of the edges from the apex, in the order in which these edges meet
    /// the common line.
    ///
    /// Let `m` and `n` point from the line towards the apexes of the two triangles, each in its own
    /// plane, and direct the line along `w` with det(m, w, n) > 0. For points `i` on an edge
    /// `(p, q)` from the first apex and `k` on an edge `(r, s)` from the second,
    /// `orient3d(p, q, r, s)` then is the sign of `(k − i) · w`. `m × w` points to the side on
    /// which the second apex lies, so where that is the positive one the corners run against `w`;
    /// and as det(n, −w, m) > 0 too, the second triangle sees the same rule for `−w`.
    fn ends_seen_from(&self, other: &Self) -> [usize; 2] {
        let (next, last) = ((self.apex + 1) % 3, (self.apex + 2) % 3);
        if other.side == Sign::Positive { [last, next] } else { [next, last] }
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
    fn a_crossing_runs_along_the_product_of_the_normals() {
        // The floor looks up, the blade along −y, and z × −y = x.
        let blade = [[1.0, 1.0, -1.0], [2.0, 1.0, 1.0], [1.0, 1.0, 1.0]].map(DVec3::from_array);
        let normal = (blade[1] - blade[0]).cross(blade[2] - blade[0]);
        assert!(normal.y < 0.0);
        let end = |owner, edge| CrossingEnd { owner, edge };
        // It enters over the upright side x = 1 and leaves over the slanted one.
        let expected = Crossing { ends: [end(1, 2), end(1, 0)] };
        let clear = Arithmetic::Filter;
        assert_eq!(cross_triangles(&FLOOR, &blade), (Meeting::Cross, Some(expected), clear));
        // Wide, it is cut off by the floor's own sides: x = 0 and x + y = 4.
        let wide = [[-9.0, 1.0, -9.0], [9.0, 1.0, -9.0], [0.0, 1.0, 9.0]].map(DVec3::from_array);
        let expected = Crossing { ends: [end(0, 2), end(0, 1)] };
        assert_eq!(cross_triangles(&FLOOR, &wide).1, Some(expected));
        // Ends on a side of the floor: no general position.
        let flush = [[0.0, 1.0, -1.0], [2.0, 1.0, 1.0], [0.0, 1.0, 1.0]].map(DVec3::from_array);
        let close = Arithmetic::Adaptive;
        assert_eq!(cross_triangles(&FLOOR, &flush), (Meeting::Cross, None, close));
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
    fn only_close_calls_take_adaptive_arithmetic() {
        let blade = |tip: f64| [[1.0, 1.0, tip], [2.0, 1.0, 1.0], [1.0, 2.0, 1.0]];
        let by = |tip| judge_triangles(&FLOOR, &blade(tip).map(DVec3::from_array));
        assert_eq!(by(-0.5), (Meeting::Cross, Arithmetic::Filter));
        assert_eq!(by(0.5), (Meeting::None, Arithmetic::Filter));
        assert_eq!(by(0.0), (Meeting::Touch, Arithmetic::Adaptive));
        // In its plane, though far beside it.
        let beside = [[9.0, 9.0, 0.0], [8.0, 9.0, 0.0], [9.0, 8.0, 0.0]].map(DVec3::from_array);
        assert_eq!(judge_triangles(&FLOOR, &beside), (Meeting::None, Arithmetic::Adaptive));
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
