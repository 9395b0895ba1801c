//! Least distance between two triangles, with the features that hold the witnesses.
//!
//! The least distance of two triangles that do not intersect is attained between a vertex and a
//! triangle or between two edges; all fifteen are measured (Ericson, 'Real-Time Collision
//! Detection', 2005, chapter 5, counts them so).
//!
//! Needles and edges that are nearly parallel make barycentric coordinates, and the parameters of
//! nearest points, lose all their digits. What is done about it: every candidate is a pair of
//! points that lie on the triangles to rounding, so none is too near; and a candidate is sought in
//! orthogonal steps, first along the longer direction, then across what is left, so that what is
//! lost moves it across by no more than `w` (a needle's width, or how far near-parallel edges
//! diverge) and by no more than about `h ε L / w` (`h` the distance, `L` the largest length).
//! Moving it by `δ` adds at most `δ² / 2h` to a distance of `h`, and
//! `min(w, h ε L / w)² / 2h <= ε L / 2`. Measured against exact rationals over needles and
//! near-parallel edges, the error stays below 2 ε times the largest coordinate
//! (`tests/suite/distances.rs`).

use cranny_exact::DVec3;
/// A part of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// Corner 0, 1 or 2.
    Corner(u8),
    /// Edge `i`, from corner `i` to corner `(i + 1) % 3`, its ends left out.
    Edge(u8),
    /// Inside, off the edges.
    Inside,
}

/// Two nearest points.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Their distance, squared.
    pub squared: f64,
    /// Where they are.
    pub points: [DVec3; 2],
    /// Which parts of the triangles they are on.
    pub parts: [Part; 2],
}

/// A triangle, ready to be measured from many points.
#[derive(Clone, Debug)]
pub struct Prepared {
    corners: [DVec3; 3],
    /// TriangleSide `i` runs from corner `i` to corner `(i + 1) % 3`.
    sides: [TriangleSide; 3],
    longest: usize,
    /// In the plane, at right angles to the sides, inward; as long as the side times the normal.
    inward: [DVec3; 3],
    /// One over the squared length of the normal, the outer product of two sides.
    over_normal_squared: f64,
}

impl Prepared {
    /// Prepares a triangle.
    #[must_use]
    pub fn of(corners: &[DVec3; 3]) -> Self {
        Self::with(*corners, sides(corners))
    }

    fn with(corners: [DVec3; 3], sides: [TriangleSide; 3]) -> Self {
        let longer = |i: usize, j: usize| if sides[j].squared > sides[i].squared { j } else { i };
        let longest = longer(longer(0, 1), 2);
        // The shorter sides lose least.
        let normal = sides[(longest + 1) % 3].along.cross(sides[(longest + 2) % 3].along);
        Self {
            corners,
            sides,
            longest,
            inward: sides.each_ref().map(|side| normal.cross(side.along)),
            over_normal_squared: 1.0 / normal.length_squared(),
        }
    }

    /// The point of the triangle's inside below a point, if it stands over the inside.
    ///
    /// Found along the longest side first, then across. Where rounding has it outside by either
    /// figure, the nearest point of the rim is as good.
    pub fn foot(&self, p: DVec3) -> Option<DVec3> {
        let depth = |i: usize| self.inward[i].dot(p - self.corners[i]);
        if !(depth(0) > 0.0 && depth(1) > 0.0 && depth(2) > 0.0) {
            return None;
        }
        let i = self.longest;
        let (base, arm) = (&self.sides[i], -self.sides[(i + 2) % 3].along);
        let start = self.corners[i];
        let across = depth(i) * self.over_normal_squared;
        let share = |v: DVec3| v.dot(base.along) * base.over_squared;
        let along = share(p - start) - across * share(arm);
        let inside = along >= 0.0 && along + across <= 1.0;
        inside.then(|| start + base.along * along + arm * across)
    }
}

/// A segment, ready to be measured against many.
#[derive(Clone, Copy, Debug)]
struct TriangleSide {
    start: DVec3,
    end: DVec3,
    along: DVec3,
    squared: f64,
    /// One over `squared`, or 0 for a segment without length.
    over_squared: f64,
}

impl TriangleSide {
    #[inline]
    fn of(start: DVec3, end: DVec3) -> Self {
        let along = end - start;
        let squared = along.length_squared();
        let over_squared = if squared > 0.0 { 1.0 / squared } else { 0.0 };
        Self { start, end, along, squared, over_squared }
    }

    /// The parameter of the point nearest to the one whose offset from the start has this inner
    /// product with the segment. Ends are recognized without dividing.
    #[inline]
    fn parameter(&self, product: f64) -> f64 {
        if product <= 0.0 {
            0.0
        } else if product >= self.squared {
            1.0
        } else {
            product * self.over_squared
        }
    }

    #[inline]
    fn at(&self, t: f64) -> DVec3 {
        if t <= 0.0 {
            self.start
        } else if t >= 1.0 {
            self.end
        } else {
            self.start + self.along * t
        }
    }

    /// Parameters of the nearest points of two segments.
    #[inline]
    fn nearest(&self, other: &Self) -> (f64, f64) {
        let apart = self.start - other.start;
        let (b, f) = (self.along.dot(other.along), other.along.dot(apart));
        // Along the other segment first, then along what this one has across it.
        let across = self.along - other.along * (b * other.over_squared);
        let beside = apart - other.along * (f * other.over_squared);
        let (moved, squared) = (-across.dot(beside), across.length_squared());
        let s = if moved <= 0.0 {
            0.0
        } else if moved >= squared {
            1.0
        } else {
            moved / squared
        };
        let product = b * s + f;
        if product < 0.0 {
            (self.parameter(-self.along.dot(apart)), 0.0)
        } else if product > other.squared {
            (self.parameter(b - self.along.dot(apart)), 1.0)
        } else {
            (s, other.parameter(product))
        }
    }
}

fn sides(&[a, b, c]: &[DVec3; 3]) -> [TriangleSide; 3] {
    [TriangleSide::of(a, b), TriangleSide::of(b, c), TriangleSide::of(c, a)]
}

/// The part of a triangle that holds the point of its side `i` at a parameter.
fn part_of_side(i: usize, t: f64) -> Part {
    if t <= 0.0 {
        Part::Corner(i as u8)
    } else if t >= 1.0 {
        Part::Corner((i as u8 + 1) % 3)
    } else {
        Part::Edge(i as u8)
    }
}

/// The point of a triangle nearest to `p`, and the part that holds it.
///
/// The distance to it exceeds the least one by a few units of rounding of the largest length in
/// play, needles and triangles without area included; in a needle, the part may be a neighbour of
/// the true one.
#[must_use]
pub fn closest_on_triangle(p: DVec3, triangle: &[DVec3; 3]) -> (DVec3, Part) {
    let sides = sides(triangle);
    let products = [0, 1, 2].map(|i| sides[i].along.dot(p - triangle[i]));
    for i in 0..3 {
        let before = (i + 2) % 3;
        if products[i] <= 0.0 && products[before] >= sides[before].squared {
            return (triangle[i], Part::Corner(i as u8));
        }
    }
    if let Some(foot) = Prepared::with(*triangle, sides).foot(p) {
        return (foot, Part::Inside);
    }
    // All three sides, not just those that face the point: in a needle, which do may be noise.
    let mut best = (triangle[0], Part::Corner(0));
    let mut least = f64::INFINITY;
    for i in 0..3 {
        let t = sides[i].parameter(products[i]);
        let point = sides[i].at(t);
        let squared = (p - point).length_squared();
        if squared < least {
            (best, least) = ((point, part_of_side(i, t)), squared);
        }
    }
    best
}

/// The point of a segment nearest to another point.
#[inline]
pub fn closest_on_segment(p: DVec3, ends: &[DVec3; 2]) -> DVec3 {
    let side = TriangleSide::of(ends[0], ends[1]);
    side.at(side.parameter(side.along.dot(p - ends[0])))
}

/// Parameters in \[0, 1\] of the nearest points of two segments, each from its first end.
///
/// The distance of those points exceeds the least one by a few units of rounding of the largest
/// length in play, however small the angle; where the segments are parallel, one of many pairs.
#[must_use]
#[inline]
pub fn closest_on_segments(p: &[DVec3; 2], q: &[DVec3; 2]) -> (f64, f64) {
    TriangleSide::of(p[0], p[1]).nearest(&TriangleSide::of(q[0], q[1]))
}

/// The nearest points of two triangles. They must not intersect, or the answer is too large.
pub fn triangle_distance(a: &[DVec3; 3], b: &[DVec3; 3]) -> Nearest {
    Prepared::of(a).nearest(ALL_CORNERS, &Prepared::of(b), ALL_CORNERS)
}

/// For [`Prepared::nearest`]: nothing is left out.
const ALL_CORNERS: u8 = 0b111;

impl Prepared {
    /// The nearest points of two triangles that do not intersect, if these lie at some of their
    /// corners, a bit each, or on sides that end there, or inside.
    pub fn nearest(&self, own: u8, other: &Self, its: u8) -> Nearest {
        let mut best = Nearest {
            squared: f64::INFINITY,
            points: [self.corners[0], other.corners[0]],
            parts: [Part::Corner(0); 2],
        };
        let mut offer = |points: [DVec3; 2], parts: [Part; 2]| {
            let squared = (points[1] - points[0]).length_squared();
            if squared < best.squared || (squared <= best.squared && parts < best.parts) {
                best = Nearest { squared, points, parts };
            }
        };
        let is_corner = |bits: u8, i: usize| bits >> i & 1 != 0;
        let is_side = |bits: u8, i: usize| is_corner(bits, i) || is_corner(bits, (i + 1) % 3);
        // Sides with their ends: what is nearest to a corner and not inside a face.
        for (i, p) in self.sides.iter().enumerate().filter(|(i, _)| is_side(own, *i)) {
            for (j, q) in other.sides.iter().enumerate().filter(|(j, _)| is_side(its, *j)) {
                let (s, t) = p.nearest(q);
                offer([p.at(s), q.at(t)], [part_of_side(i, s), part_of_side(j, t)]);
            }
        }
        for i in 0..3 {
            let corner = Part::Corner(i as u8);
            let (p, q) = (self.corners[i], other.corners[i]);
            if let Some(foot) = is_corner(own, i).then(|| other.foot(p)).flatten() {
                offer([p, foot], [corner, Part::Inside]);
            }
            if let Some(foot) = is_corner(its, i).then(|| self.foot(q)).flatten() {
                offer([foot, q], [Part::Inside, corner]);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] =
        [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];

    #[test]
    fn each_part_of_a_triangle_can_be_nearest() {
        let part = |x, y| closest_on_triangle(DVec3::new(x, y, 1.0), &FLOOR).1;
        assert_eq!(part(1.0, 1.0), Part::Inside);
        assert_eq!(part(-1.0, -1.0), Part::Corner(0));
        assert_eq!(part(9.0, -1.0), Part::Corner(1));
        assert_eq!(part(-1.0, 9.0), Part::Corner(2));
        assert_eq!(part(1.0, -1.0), Part::Edge(0));
        assert_eq!(part(3.0, 3.0), Part::Edge(1));
        assert_eq!(part(-1.0, 1.0), Part::Edge(2));
    }

    #[test]
    fn crossed_edges_are_nearest_between_their_insides() {
        let roof =
            [DVec3::new(1.0, -1.0, 2.0), DVec3::new(1.0, 1.0, 2.0), DVec3::new(1.0, 0.0, 9.0)];
        let wall =
            [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(2.0, 0.0, -5.0)];
        let nearest = triangle_distance(&roof, &wall);
        assert_eq!(nearest.squared, 4.0);
        assert_eq!(nearest.parts, [Part::Edge(0), Part::Edge(0)]);
        assert_eq!(nearest.points[0], DVec3::new(1.0, 0.0, 2.0));
    }

    #[test]
    fn triangles_without_area_are_segments_and_points() {
        let segment =
            [DVec3::new(0.0, 0.0, 3.0), DVec3::new(2.0, 0.0, 3.0), DVec3::new(1.0, 0.0, 3.0)];
        assert_eq!(triangle_distance(&segment, &FLOOR).squared, 9.0);
        let point = [DVec3::new(5.0, 0.0, 0.0); 3];
        assert_eq!(triangle_distance(&point, &FLOOR).squared, 1.0);
        assert_eq!(triangle_distance(&point, &segment).squared, 18.0);
    }
}
