//! Whether the rim of some faces, seen in a plane, is simple: nowhere crosses or touches itself,
//! and runs once around what it holds.
//!
//! Points come rounded; every sign that is read is larger than its error bound, so that 'simple' is
//! certain of the points before they were rounded. What cannot be certain is not called simple.
//!
//! No source: this crate's own. Loops no two sides of which meet are simple polygons, and the sign
//! of the area says which way one runs. Cost: O(r log r) for r sides, which are sorted along an
//! axis, and at most [`PAIRS_A_FACE`] pairs of sides for each face within.

use cranny_exact::DVec2;

use crate::ids::{OptionalIndex, VertexId};

/// Sides looked at together for each face within, at most: rims are short against what they hold,
/// and few of their sides lie beside each other. Larger, and a long winding rim takes longer than
/// judging the faces.
const PAIRS_A_FACE: usize = 16;

/// A side of the rim, from one point to another, and the box around it.
#[derive(Clone, Copy)]
struct RimSide {
    ends: [u32; 2],
    low: DVec2,
    high: DVec2,
}

/// Scratch memory of a search.
pub(super) struct Outline {
    /// Where the side that begins at a vertex ends; none between searches.
    next: Vec<OptionalIndex>,
    points: Vec<DVec2>,
    sides: Vec<RimSide>,
    loops: Vec<usize>,
}

/// Signs in the plane, of points that are wrong by no more than an error along either axis.
struct Signs {
    error: f64,
}

impl Signs {
    /// Bounds the error of a product of two differences of points, summed over both axes: with e
    /// the error of a difference (two of a point, a rounding), e times either difference, e² and
    /// the roundings of products, which are less than 2 errors of a point times either difference.
    fn margin(&self, u: DVec2, v: DVec2) -> f64 {
        let size = |w: DVec2| w.x.abs() + w.y.abs();
        4.0 * self.error * (size(u) + size(v) + 4.0 * self.error)
    }

    /// Which way three points turn, if that is certain: 1 or −1, else 0.
    fn turn(&self, a: DVec2, b: DVec2, c: DVec2) -> i8 {
        let (u, v) = (b - a, c - a);
        let (area, margin) = (u.perp_dot(v), self.margin(u, v));
        i8::from(area > margin) - i8::from(area < -margin)
    }

    /// Whether two points certainly lie on one side of the line through two others.
    fn aside(&self, [a, b]: [DVec2; 2], [p, q]: [DVec2; 2]) -> bool {
        let turn = self.turn(a, b, p);
        turn != 0 && turn == self.turn(a, b, q)
    }

    /// Whether two sides from one point certainly share no other.
    fn fork(&self, at: DVec2, p: DVec2, q: DVec2) -> bool {
        let (u, v) = (p - at, q - at);
        self.turn(at, p, q) != 0 || u.dot(v) < -self.margin(u, v)
    }
}

impl Outline {
    pub(super) fn new(vertices: usize) -> Self {
        let next = vec![OptionalIndex::NONE; vertices];
        Self { next, points: Vec::new(), sides: Vec::new(), loops: Vec::new() }
    }

    /// Whether a rim, given as sides of which as many end at each vertex as begin there, is
    /// certainly made of simple polygons apart from each other, one of them counter-clockwise and
    /// all others clockwise, as seen where `seen` puts the vertices: within `size` of 0 along
    /// either axis, from coordinates within `size / 2` of 0, sheared by factors no greater than 1.
    pub(super) fn is_simple(
        &mut self,
        rim: &[[VertexId; 2]],
        seen: impl Fn(VertexId) -> DVec2,
        size: f64,
        faces: usize,
    ) -> bool {
        // Three roundings of numbers up to `size`, and one of the coordinates, are less than 1.3
        // epsilons.
        let signs = Signs { error: 4.0 * f64::EPSILON * size };
        // A strip of faces has two sides more than faces; what is more ragged is not worth the
        // while.
        rim.len() <= faces + 2
            && self.link(rim)
            && {
                self.walk(rim, seen);
                self.sides_are_apart(&signs, PAIRS_A_FACE * faces)
            }
            && self.one_runs_around(&signs)
    }

    /// Notes where each side leads; whether at most one begins at each vertex.
    fn link(&mut self, rim: &[[VertexId; 2]]) -> bool {
        for (i, &[from, to]) in rim.iter().enumerate() {
            if self.next[from.index()].is_some() {
                rim[..i].iter().for_each(|[from, _]| self.next[from.index()] = OptionalIndex::NONE);
                return false;
            }
            self.next[from.index()] = OptionalIndex::some(to.0);
        }
        true
    }

    /// Follows the sides from loop to loop, and forgets where they lead.
    fn walk(&mut self, rim: &[[VertexId; 2]], seen: impl Fn(VertexId) -> DVec2) {
        self.points.clear();
        self.sides.clear();
        self.loops.clear();
        for &[start, _] in rim {
            let first = self.points.len();
            let mut vertex = start;
            while let Some(next) = self.next[vertex.index()].take() {
                self.points.push(seen(vertex));
                vertex = VertexId(next);
            }
            let end = self.points.len();
            if end == first {
                continue; // passed by an earlier loop
            }
            self.loops.push(first);
            for i in first..end {
                let ends = [i, if i + 1 == end { first } else { i + 1 }];
                let [p, q] = ends.map(|end| self.points[end]);
                let (low, high) = (p.min(q), p.max(q));
                self.sides.push(RimSide { ends: ends.map(|end| end as u32), low, high });
            }
        }
    }

    /// Whether no two sides share more than an end that both have. Sides are looked at in order
    /// along the longer axis; gives up after so many pairs.
    fn sides_are_apart(&mut self, signs: &Signs, mut pairs_left: usize) -> bool {
        let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let box_of_all =
            |(low, high): (DVec2, DVec2), s: &RimSide| (low.min(s.low), high.max(s.high));
        let (low, high) = self.sides.iter().fold(none, box_of_all);
        let along = (high - low).max_position();
        self.sides.sort_unstable_by(|s, t| {
            s.low[along].total_cmp(&t.low[along]).then(s.ends.cmp(&t.ends))
        });
        let (across, slack) = (1 - along, 4.0 * signs.error);
        for (i, s) in self.sides.iter().enumerate() {
            let reach = s.high[along] + slack;
            for t in self.sides[i + 1..].iter().take_while(|t| t.low[along] <= reach) {
                if pairs_left == 0 {
                    return false;
                }
                pairs_left -= 1;
                let beside = s.low[across] <= t.high[across] + slack
                    && t.low[across] <= s.high[across] + slack;
                if beside && !self.are_apart(signs, s, t) {
                    return false;
                }
            }
        }
        true
    }

    fn are_apart(&self, signs: &Signs, s: &RimSide, t: &RimSide) -> bool {
        let [a, b] = s.ends.map(|end| self.points[end as usize]);
        let [p, q] = t.ends.map(|end| self.points[end as usize]);
        match (s.ends[1] == t.ends[0], t.ends[1] == s.ends[0]) {
            (true, true) => false,
            (true, false) => signs.fork(b, a, q),
            (false, true) => signs.fork(a, b, p),
            (false, false) => signs.aside([a, b], [p, q]) || signs.aside([p, q], [a, b]),
        }
    }

    /// Whether, of several loops, one certainly runs counter-clockwise and the others clockwise;
    /// one alone around faces that are all counter-clockwise does.
    fn one_runs_around(&self, signs: &Signs) -> bool {
        let ends = self.loops.iter().skip(1).copied().chain([self.points.len()]);
        let turns = self.loops.iter().zip(ends).map(|(&start, end)| {
            let points = &self.points[start..end];
            let (mut area, mut margin, mut magnitude) = (0.0, 0.0, 0.0);
            for pair in points.windows(2) {
                let (u, v) = (pair[0] - points[0], pair[1] - points[0]);
                area += u.perp_dot(v);
                margin += signs.margin(u, v);
                magnitude += (u.x * v.y).abs() + (u.y * v.x).abs();
            }
            margin += points.len() as f64 * f64::EPSILON * magnitude;
            i8::from(area > margin) - i8::from(area < -margin)
        });
        match self.loops.len() {
            0 | 1 => self.loops.len() == 1,
            _ => {
                let turns: Vec<i8> = turns.collect();
                !turns.contains(&0) && turns.iter().filter(|&&turn| turn > 0).count() == 1
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Loops of points, as sides from each to the next.
    fn is_simple(loops: &[&[[f64; 2]]], grain: f64) -> bool {
        let points: Vec<[f64; 2]> = loops.concat();
        let mut rim = Vec::new();
        let mut first = 0;
        for points in loops {
            let count = points.len() as u32;
            let vertex = |i: u32| VertexId(first + i % count);
            rim.extend((0..count).map(|i| [vertex(i), vertex(i + 1)]));
            first += count;
        }
        let mut outline = Outline::new(points.len());
        let seen = |v: VertexId| DVec2::from_array(points[v.index()]);
        let simple = outline.is_simple(&rim, seen, grain, 100);
        assert!(outline.next.iter().all(|next| next.is_none()));
        // The same with the axes exchanged, which turns the loops.
        let backwards: Vec<_> = rim.iter().map(|&[a, b]| [b, a]).collect();
        let exchanged = |v: VertexId| DVec2::new(points[v.index()][1], points[v.index()][0]);
        assert_eq!(outline.is_simple(&backwards, exchanged, grain, 100), simple);
        simple
    }

    const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];

    #[test]
    fn polygons_that_meet_themselves_are_not_simple() {
        let square = SQUARE.as_slice();
        assert!(is_simple(&[square], 8.0));
        let corner = [[0.0, 0.0], [4.0, 0.0], [8.0, 0.0], [8.0, 2.0], [2.0, 2.0], [2.0, 8.0]];
        assert!(is_simple(&[&corner], 8.0));
        let bow_tie = [[0.0, 0.0], [8.0, 8.0], [8.0, 0.0], [0.0, 8.0]];
        assert!(!is_simple(&[&bow_tie], 8.0));
        // A corner on a side, a side that returns along another, corners in one place.
        let touching = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [4.0, 0.0], [0.0, 8.0]];
        assert!(!is_simple(&[&touching], 8.0));
        let folded = [[0.0, 0.0], [8.0, 0.0], [4.0, 0.0], [4.0, 4.0]];
        assert!(!is_simple(&[&folded], 8.0));
        let pinched = [[0.0, 0.0], [4.0, 4.0], [8.0, 0.0], [8.0, 8.0], [4.0, 4.0], [0.0, 8.0]];
        assert!(!is_simple(&[&pinched], 8.0));
        assert!(!is_simple(&[&[[0.0, 0.0], [1.0, 0.0]]], 8.0));
        assert!(!is_simple(&[], 8.0));
    }

    #[test]
    fn what_rounding_could_join_is_not_simple() {
        let slit = |width: f64| {
            let points = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [4.0, width], [0.0, 8.0]];
            is_simple(&[&points], 8.0)
        };
        assert!(slit(64.0 * f64::EPSILON * 8.0));
        assert!(!slit(2.0 * f64::EPSILON * 8.0));
    }

    #[test]
    fn one_loop_runs_around_all_others() {
        let turned = |points: &[[f64; 2]]| points.iter().rev().copied().collect::<Vec<_>>();
        let at = |x: f64, y: f64| SQUARE.map(|[u, v]| [x + u / 8.0, y + v / 8.0]);
        let [a, b, beside] = [at(1.0, 1.0), at(4.0, 5.0), at(20.0, 1.0)];
        let [hole, other] = [turned(&a), turned(&b)];
        assert!(is_simple(&[&SQUARE, &hole, &other], 8.0));
        assert!(!is_simple(&[&SQUARE, &a], 8.0)); // one above another
        assert!(!is_simple(&[&SQUARE, &hole, &b], 8.0));
        assert!(!is_simple(&[&SQUARE, &beside], 32.0)); // not nested, but not looked into
        let crossing = turned(&at(7.5, 1.0));
        assert!(!is_simple(&[&SQUARE, &crossing], 8.0));
    }
}
