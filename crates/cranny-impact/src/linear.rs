//! When do a vertex and a face, or two edges, that move linearly come together?
//!
//! Both questions are one: is there a root of `F(t, u, v) = base + u · along + v · across` in a box
//! of parameters, `base`, `along` and `across` being linear in `t`? Such an `F` takes the extremes
//! of any of its projections at the corners of a box of parameters, so eight corners bound it
//! sharply. A box whose image stays clear of zero along some direction holds no root; any other is
//! halved, the earliest first, until its image is smaller than a tolerance (inclusion functions:
//! Snyder 1992; sharp bounds from the corners, and a minimum separation: Wang, Ferguson, Schneider,
//! Jiang, Attene and Panozzo 2021).
//!
//! Departures:
//! - A box is also tested along the common normal and along the value in its middle. Slanted
//!   surfaces that slide past each other are separated at once instead of being paved with boxes
//!   as small as their gap.
//! - Along every direction that parts the two at the beginning of a box, the beginning is moved up
//!   to where the first of the four corners arrives. Whatever approaches flat, as parallel edges
//!   do, arrives everywhere at one time, and one place is as good as another.
//! - Boxes are ordered by time to within a *tick*, in which nothing moves by more than the
//!   tolerance, then by size; the time returned is a lower bound for all that are left.
//!
//! Cost: one test of a box takes some 100 nanoseconds; a miss most often takes one, a hit about
//! three per bit of `size / tolerance`.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use cranny_exact::DVec3;

/// What bounds the search of [`linear_vertex_face`] and [`linear_edge_edge`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearLimits {
    /// Features count as meeting when they are this near, >= 0. Features that stay farther apart
    /// than √3 · (separation + 2 · tolerance + rounding) are never reported.
    pub separation: f64,
    /// How finely a meeting is located, as a length > 0.
    pub tolerance: f64,
    /// Boxes that may be tested.
    pub subdivisions: u32,
}

/// What became of two features that move linearly from time 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinearImpact {
    /// Certified: at no time from 0 to 1 are they within the separation.
    Free,
    /// Certified not before `time`, and then within √3 · (separation + 2 · tolerance + rounding) of
    /// each other.
    Near {
        /// From 0 to 1.
        time: f64,
    },
    /// The budget was spent: certified not before `from`, unknown from then on.
    Open {
        /// From 0 to 1.
        from: f64,
    },
}

/// The first time at which a vertex comes within a separation of a triangle (edges included):
/// points are vertex, corner, corner, corner, at times 0 and 1. Triangles without area are allowed.
#[must_use]
pub fn linear_vertex_face(
    start: &[DVec3; 4],
    end: &[DVec3; 4],
    limits: &LinearLimits,
) -> (LinearImpact, u32) {
    let split = |[p, a, b, c]: &[DVec3; 4]| [*a - *p, *b - *a, *c - *a];
    Moving3::new(split(start), split(end), magnitude(start, end)).search(true, limits)
}

/// The first time at which two segments (ends included) come within a separation: points are the
/// first one's ends, then the second one's, at times 0 and 1. Segments without length are allowed.
#[must_use]
pub fn linear_edge_edge(
    start: &[DVec3; 4],
    end: &[DVec3; 4],
    limits: &LinearLimits,
) -> (LinearImpact, u32) {
    let split = |[a, b, c, d]: &[DVec3; 4]| [*a - *c, *b - *a, *c - *d];
    Moving3::new(split(start), split(end), magnitude(start, end)).search(false, limits)
}

fn magnitude(start: &[DVec3; 4], end: &[DVec3; 4]) -> f64 {
    start.iter().chain(end).fold(0.0, |m, p| f64::max(m, p.abs().max_element()))
}

/// Rounding of a projection of `F`, per unit of the largest coordinate M, in ulps. Differences of
/// points are off by M·u each (u: half an ulp of 1); interpolated, by 16 M·u; `F` sums three of
/// them, 62 M·u a coordinate; a projection onto a unit vector adds 32 M·u to √3 times that: 70
/// ulps.
const ROUNDING: f64 = 96.0;

/// `F` at the beginning and at the end: base, along, across.
struct Moving3 {
    start: [DVec3; 3],
    end: [DVec3; 3],
    /// Along which exclusion is tried first, not counting the axes: the common normal half-way, and
    /// what parts the two at the start. Zero where there is none.
    normals: [DVec3; 2],
    error: f64,
}

/// A box of parameters: time, u, v.
#[derive(Clone, Copy, Debug)]
struct Span {
    low: [f64; 3],
    high: [f64; 3],
    /// Ticks before `low[0]`, rounded down.
    tick: u64,
    depth: u32,
    /// Its beginning was moved up; that is done once, or spans would creep along slopes.
    moved: bool,
}

impl Span {
    /// The order in which spans are taken: earliest first, then the smallest, then by parameters,
    /// so that it is the same on every run.
    fn precedes(&self, other: &Self) -> Ordering {
        self.tick
            .cmp(&other.tick)
            .then(other.depth.cmp(&self.depth))
            .then(self.low[0].total_cmp(&other.low[0]))
            .then(self.low[1].total_cmp(&other.low[1]))
            .then(self.low[2].total_cmp(&other.low[2]))
    }
}

impl PartialEq for Span {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Span {}

impl PartialOrd for Span {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Span {
    /// The heap hands out its greatest member: the one that precedes all others.
    fn cmp(&self, other: &Self) -> Ordering {
        other.precedes(self)
    }
}

impl Moving3 {
    fn new(start: [DVec3; 3], end: [DVec3; 3], magnitude: f64) -> Self {
        let half = |i: usize| 0.5 * (start[i] + end[i]);
        let [base, along, _] = start;
        let across_gap = base * along.length_squared() - along * base.dot(along);
        let normals = [half(1).cross(half(2)), across_gap].map(DVec3::normalize_or_zero);
        Self { start, end, normals, error: ROUNDING * f64::EPSILON * magnitude }
    }

    fn search(&self, triangular: bool, limits: &LinearLimits) -> (LinearImpact, u32) {
        let separation = limits.separation + self.error;
        // Rounding hides anything finer.
        let tolerance = limits.tolerance.max(2.0 * self.error);
        let tick = (tolerance / self.fastest()).min(1.0);
        // Rounded down; and no span with as many ticks begins earlier.
        let begin = |span: &Span| span.tick as f64 * tick * (1.0 - 4.0 * f64::EPSILON);
        let mut heap = BinaryHeap::new();
        heap.push(Span { low: [0.0; 3], high: [1.0; 3], tick: 0, depth: 0, moved: false });
        let mut tested = 0;
        while let Some(mut span) = heap.pop() {
            if tested >= limits.subdivisions {
                return (LinearImpact::Open { from: begin(&span) }, tested);
            }
            tested += 1;
            if triangular && span.low[1] + span.low[2] > 1.0 {
                continue;
            }
            let mut ends = [span.low[0], span.high[0]].map(|t| self.at(t));
            let Some(arrival) = self.arrival(&ends, &span, separation) else { continue };
            if arrival > 0.0 && !span.moved {
                let later = span.low[0] + arrival * (span.high[0] - span.low[0]);
                span.low[0] = later.next_down().clamp(span.low[0], span.high[0]);
                span.moved = true;
                let before = std::mem::replace(&mut span.tick, (span.low[0] / tick) as u64);
                if span.tick > before {
                    heap.push(span);
                    continue;
                }
                ends[0] = self.at(span.low[0]);
            }
            let halves =
                if width(&ends, &span) <= tolerance { None } else { halved(&span, &ends, tick) };
            match halves {
                Some(halves) => heap.extend(halves),
                None => return (LinearImpact::Near { time: begin(&span) }, tested),
            }
        }
        (LinearImpact::Free, tested)
    }

    /// What part of a span's time passes, at least, before `F` comes within the separation; `None`
    /// if it does not.
    fn arrival(&self, ends: &[[DVec3; 3]; 2], span: &Span, separation: f64) -> Option<f64> {
        let [a, b] = self.normals;
        let mut latest = 0.0;
        for n in [DVec3::X, DVec3::Y, DVec3::Z, a, b, self.value(span).normalize_or_zero()] {
            latest = f64::max(latest, arrival_along(ends, span, n, separation)?);
        }
        Some(latest)
    }

    /// The most that a coordinate of `F` changes in all.
    fn fastest(&self) -> f64 {
        let change = [0, 1, 2].map(|i| self.end[i] - self.start[i]);
        let [base, along, across] = change;
        [base, base + along, base + across, base + along + across]
            .iter()
            .fold(0.0, |m, c| f64::max(m, c.abs().max_element()))
    }

    /// Base, along, across at a time.
    fn at(&self, t: f64) -> [DVec3; 3] {
        [0, 1, 2].map(|i| self.start[i] + t * (self.end[i] - self.start[i]))
    }

    /// `F` in the middle of a span.
    fn value(&self, span: &Span) -> DVec3 {
        let [t, u, v] = [0, 1, 2].map(|i| 0.5 * (span.low[i] + span.high[i]));
        let [base, along, across] = self.at(t);
        base + u * along + v * across
    }
}

/// As [`Moving3::arrival`], by the projection along `n`: at a corner of the span's `u` and `v` it
/// is linear in time, and in between it is between the corners' values.
fn arrival_along(ends: &[[DVec3; 3]; 2], span: &Span, n: DVec3, separation: f64) -> Option<f64> {
    let values = ends.map(|end| {
        let [base, along, across] = end.map(|x| x.dot(n));
        let (u0, u1) = (span.low[1] * along, span.high[1] * along);
        let (v0, v1) = (span.low[2] * across, span.high[2] * across);
        [base + (u0 + v0), base + (u0 + v1), base + (u1 + v0), base + (u1 + v1)]
    });
    let side = if values[0].iter().all(|&x| x > separation) {
        1.0
    } else if values[0].iter().all(|&x| x < -separation) {
        -1.0
    } else {
        return Some(0.0);
    };
    let mut earliest = f64::INFINITY;
    for (from, to) in values[0].into_iter().zip(values[1]) {
        let (from, to) = (side * from, side * to);
        if to <= separation {
            earliest = earliest.min((from - separation) / (from - to));
        }
    }
    (earliest < f64::INFINITY).then_some(earliest * (1.0 - 8.0 * f64::EPSILON))
}

/// The greatest width of the image of a span, along the axes.
fn width(ends: &[[DVec3; 3]; 2], span: &Span) -> f64 {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for [base, along, across] in ends {
        let [u0, u1] = [span.low[1] * *along, span.high[1] * *along];
        let [v0, v1] = [span.low[2] * *across, span.high[2] * *across];
        low = low.min(*base + u0.min(u1) + v0.min(v1));
        high = high.max(*base + u0.max(u1) + v0.max(v1));
    }
    (high - low).max_element()
}

/// Halves a span across the parameter that moves `F` most; `None` where numbers are too coarse.
fn halved(span: &Span, ends: &[[DVec3; 3]; 2], tick: f64) -> Option<[Span; 2]> {
    let width = [0, 1, 2].map(|i| span.high[i] - span.low[i]);
    let extent = |v: DVec3| v.abs().max_element();
    let corner = |end: &[DVec3; 3], u: f64, v: f64| end[0] + u * end[1] + v * end[2];
    let mut moved = [0.0, extent(ends[0][1]).max(extent(ends[1][1])) * width[1], 0.0];
    moved[2] = extent(ends[0][2]).max(extent(ends[1][2])) * width[2];
    for u in [span.low[1], span.high[1]] {
        for v in [span.low[2], span.high[2]] {
            moved[0] = f64::max(moved[0], extent(corner(&ends[1], u, v) - corner(&ends[0], u, v)));
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| moved[j].total_cmp(&moved[i]).then(i.cmp(&j)));
    order.into_iter().find_map(|axis| {
        let middle = 0.5 * (span.low[axis] + span.high[axis]);
        let half = Span { depth: span.depth + 1, moved: false, ..*span };
        let (mut lower, mut upper) = (half, half);
        lower.high[axis] = middle;
        upper.low[axis] = middle;
        upper.tick = (upper.low[0] / tick) as u64;
        (span.low[axis] < middle && middle < span.high[axis]).then_some([lower, upper])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOR: [DVec3; 3] =
        [DVec3::new(0.0, 0.0, 0.0), DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 0.0)];
    const FINE: LinearLimits =
        LinearLimits { separation: 0.0, tolerance: 1e-9, subdivisions: 10_000 };

    fn drop_on_floor(from: DVec3, to: DVec3, limits: &LinearLimits) -> LinearImpact {
        let [a, b, c] = FLOOR;
        linear_vertex_face(&[from, a, b, c], &[to, a, b, c], limits).0
    }

    #[test]
    fn a_vertex_falls_through_a_floor_at_a_quarter() {
        let hit = drop_on_floor(DVec3::new(1.0, 1.0, 1.0), DVec3::new(1.0, 1.0, -3.0), &FINE);
        let LinearImpact::Near { time } = hit else { panic!("{hit:?}") };
        assert!(time <= 0.25 && time > 0.25 - 1e-9, "{time}");
        // With a separation of 0.5: an eighth earlier.
        let wide = LinearLimits { separation: 0.5, ..FINE };
        let hit = drop_on_floor(DVec3::new(1.0, 1.0, 1.0), DVec3::new(1.0, 1.0, -3.0), &wide);
        let LinearImpact::Near { time } = hit else { panic!("{hit:?}") };
        assert!(time <= 0.125 && time > 0.125 - 1e-9, "{time}");
    }

    #[test]
    fn corners_and_rims_belong_to_the_face_and_nothing_beside_does() {
        for (x, y, hits) in [
            (0.0, 0.0, true),
            (4.0, 0.0, true),
            (2.0, 2.0, true),
            (2.0, 2.0 + 1e-7, false),
            (-1e-7, 1.0, false),
            (4.0, 4.0, false),
        ] {
            let (up, down) = (DVec3::new(x, y, 1.0), DVec3::new(x, y, -1.0));
            let impact = drop_on_floor(up, down, &FINE);
            assert_eq!(impact != LinearImpact::Free, hits, "{x} {y}: {impact:?}");
        }
    }

    #[test]
    fn crossed_edges_meet_and_parallel_ones_do_too() {
        let (x, z) = (DVec3::X, DVec3::Z);
        let lower = [-x, x];
        for upper in [[-DVec3::Y, DVec3::Y], [-0.5 * x, 2.0 * x], [x, 3.0 * x]] {
            let at = |h: f64| [lower[0], lower[1], upper[0] + h * z, upper[1] + h * z];
            let (impact, tested) = linear_edge_edge(&at(1.0), &at(-1.0), &FINE);
            let LinearImpact::Near { time } = impact else { panic!("{impact:?}") };
            assert!(time <= 0.5 && time > 0.5 - 1e-8, "{upper:?}: {time}");
            assert!(tested < 1000, "{tested}");
        }
        // Beside it.
        let at = |h: f64| [lower[0], lower[1], 1.001 * x + h * z, 2.0 * x + h * z];
        assert_eq!(linear_edge_edge(&at(1.0), &at(-1.0), &FINE).0, LinearImpact::Free);
    }

    #[test]
    fn sliding_past_a_slanted_face_takes_few_boxes() {
        let slanted = [DVec3::ZERO, DVec3::new(1.0, 0.3, 0.7), DVec3::new(-0.2, 1.0, 0.4)];
        let [u, v] = [slanted[1], slanted[2]];
        let normal = u.cross(v).normalize();
        let (from, to) = (0.8 * u - 0.3 * v + 1e-6 * normal, -0.2 * u + 0.9 * v + 1e-6 * normal);
        let [a, b, c] = slanted;
        let (impact, tested) = linear_vertex_face(&[from, a, b, c], &[to, a, b, c], &FINE);
        assert_eq!((impact, tested), (LinearImpact::Free, 1));
    }

    #[test]
    fn what_rests_within_the_separation_is_near_at_once() {
        let still = DVec3::new(1.0, 1.0, 0.25);
        let wide = LinearLimits { separation: 0.25, ..FINE };
        assert_eq!(drop_on_floor(still, still, &wide), LinearImpact::Near { time: 0.0 });
        assert_eq!(drop_on_floor(still, still, &FINE), LinearImpact::Free);
    }

    #[test]
    fn a_spent_budget_is_told_and_leaves_a_certified_beginning() {
        let few = LinearLimits { subdivisions: 8, ..FINE };
        let hit = drop_on_floor(DVec3::new(1.0, 1.0, 1.0), DVec3::new(1.0, 1.0, -3.0), &few);
        let LinearImpact::Open { from } = hit else { panic!("{hit:?}") };
        assert!(from <= 0.25, "{from}");
    }
}
