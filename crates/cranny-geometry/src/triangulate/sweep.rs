//! One pass of a sweep line triangulates the plane between given segments.
//!
//! After Hertel and Mehlhorn (1983), who triangulate inside and outside of a polygon in one sweep
//! without cutting it into monotone pieces first. The line meets sites in lexicographic order,
//! which is the order by x after a turn too small to matter, so vertical segments need no care.
//! Between neighbouring segments on the line a [`Front`] marks how far the plane is triangulated. A
//! new site closes the gaps between the segments that end in it, joins the sites that it sees in
//! the gaps beside, and opens a gap between each two segments that start in it. The whole convex
//! hull of the sites gets triangulated; the winding number of a gap is the sum of counts of the
//! segments below it.
//!
//! Segments become neighbours before the line reaches their crossing (Shamos and Hoey 1976): each
//! new pair is tested, and where they cross properly one of the two is given up. A segment through
//! a site is split when the line comes to it. So the order on the line is always right, and every
//! decision is the sign of an orientation. Cost: `O(m log m)` for `m` segments and splits.

use cranny_exact::{DVec2, Sign, orient2d};

use super::front::{Front, Fronts};
use super::status::{Place, Status};
use crate::ids::OptionalIndex;

/// A segment between two sites, `left` before `right`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Segment {
    pub(super) left: u32,
    pub(super) right: u32,
    /// How often the chain runs from left to right, net.
    pub(super) count: i64,
    /// Wanted as an edge of triangles whatever its count.
    pub(super) forced: bool,
}

impl Segment {
    /// From the first site to the second; nothing if they are the same.
    pub(super) fn new([from, to]: [u32; 2], count: i64, forced: bool) -> Option<Self> {
        let (left, right, count) = if from < to { (from, to, count) } else { (to, from, -count) };
        (left != right).then_some(Self { left, right, count, forced })
    }

    /// The parts before and behind a site, and a triangle of zero area: what the segment is more
    /// than its parts.
    pub(super) fn split(self, site: u32) -> (Self, Self, Layer) {
        let corners = [self.left, self.right, site];
        let layer = Layer { corners, winding: self.count };
        (Self { right: site, ..self }, Self { left: site, ..self }, layer)
    }
}

/// A triangle of sites, counter-clockwise, and how often it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layer {
    pub(super) corners: [u32; 3],
    pub(super) winding: i64,
}

/// What a sweep makes.
pub(super) struct Swept {
    /// The triangulated convex hull. Winding numbers are right if no segment of the chain was
    /// dropped.
    pub(super) triangles: Vec<Layer>,
    /// Triangles of zero area: what a split segment was, minus its pieces.
    pub(super) flat: Vec<Layer>,
    /// The segments, split at sites; each is an edge of triangles.
    pub(super) kept: Vec<Segment>,
    /// Segments that cross a kept one.
    pub(super) dropped: Vec<Segment>,
}

/// Triangulates between segments; the sites are distinct and sorted by x, then y.
///
/// Nothing if a segment is still open at the end, which exact signs rule out.
pub(super) fn sweep(sites: &[DVec2], segments: &[Segment]) -> Option<Swept> {
    let mut sweep = Sweep {
        sites,
        segments: Vec::with_capacity(segments.len()),
        following: Vec::with_capacity(segments.len()),
        above: Vec::with_capacity(segments.len()),
        first: vec![OptionalIndex::NONE; sites.len()],
        status: Status::default(),
        lowest: Front::EMPTY,
        fronts: Fronts::new(sites),
        flat: Vec::new(),
        kept: Vec::with_capacity(segments.len()),
        dropped: Vec::new(),
        ending: Vec::new(),
        starting: Vec::new(),
    };
    segments.iter().for_each(|&segment| sweep.announce(segment));
    (0..sites.len() as u32).for_each(|v| sweep.visit(v));
    sweep.status.is_empty().then(|| Swept {
        triangles: sweep.fronts.into_triangles(),
        flat: sweep.flat,
        kept: sweep.kept,
        dropped: sweep.dropped,
    })
}

struct Sweep<'a> {
    sites: &'a [DVec2],
    segments: Vec<Segment>,
    /// For each segment, another one that starts at the same site.
    following: Vec<OptionalIndex>,
    /// For each segment on the line, the front of the gap above it.
    above: Vec<Front>,
    /// For each site, one of the segments that start there.
    first: Vec<OptionalIndex>,
    status: Status,
    /// The front of the gap below all segments.
    lowest: Front,
    fronts: Fronts<'a>,
    flat: Vec<Layer>,
    kept: Vec<Segment>,
    dropped: Vec<Segment>,
    ending: Vec<u32>,
    starting: Vec<u32>,
}

impl Sweep<'_> {
    fn announce(&mut self, segment: Segment) {
        let id = self.segments.len() as u32;
        self.segments.push(segment);
        self.above.push(Front::EMPTY);
        let first = &mut self.first[segment.left as usize];
        self.following.push(std::mem::replace(first, OptionalIndex::some(id)));
    }

    fn visit(&mut self, v: u32) {
        let mut place = self.first_not_below(v);
        let below = self.status.before(place);
        let mut ending = std::mem::take(&mut self.ending);
        while let Some(e) = self.status.get(place).filter(|&e| self.side(e, v).is_zero()) {
            place = self.status.remove(place);
            ending.push(e);
        }

        let (lower, upper) = match ending.split_last() {
            Some((&last, others)) => {
                others.iter().for_each(|&e| self.fronts.close(self.above[e as usize], v));
                (*self.front_above(below), self.above[last as usize])
            }
            None => {
                let front = *self.front_above(below);
                self.fronts.cut(front)
            }
        };
        for e in ending.drain(..) {
            self.end(e, v);
        }
        self.ending = ending;

        self.collect_starting(v);
        let starting = std::mem::take(&mut self.starting);
        if starting.is_empty() {
            *self.front_above(below) = self.fronts.merge(lower, v, upper);
        } else {
            let mut winding = lower.winding;
            *self.front_above(below) = self.fronts.end_in(lower, v);
            for (i, &e) in starting.iter().enumerate() {
                winding += self.segments[e as usize].count;
                self.above[e as usize] = if i + 1 < starting.len() {
                    self.fronts.fresh(v, winding)
                } else {
                    self.fronts.start_in(upper, v, winding)
                };
                place = self.status.insert(place, e);
            }
        }
        let outermost = (starting.first().copied(), self.status.before(place));
        let behind = self.status.get(place);
        self.starting = starting;
        if self.cross(below, outermost.0.or(behind)) || self.cross(outermost.1, behind) {
            self.uncross(v);
        }
    }

    /// The first place on the line that does not lie below a site.
    fn first_not_below(&self, v: u32) -> Place {
        self.status.partition(|e| self.side(e, v) == Sign::Positive)
    }

    /// The front above a segment on the line, or below all.
    fn front_above(&mut self, segment: Option<u32>) -> &mut Front {
        match segment {
            Some(e) => &mut self.above[e as usize],
            None => &mut self.lowest,
        }
    }

    /// Takes note of a segment that ends in `v` or passes through it; in this case the rest starts
    /// there.
    fn end(&mut self, e: u32, v: u32) {
        let segment = self.segments[e as usize];
        if segment.right == v {
            self.kept.push(segment);
        } else {
            let piece = self.split(segment, v);
            self.kept.push(piece);
        }
    }

    /// Splits a segment at `v` and returns the first part; the second is yet to start.
    fn split(&mut self, segment: Segment, v: u32) -> Segment {
        let (piece, rest, layer) = segment.split(v);
        self.flat.push(layer);
        self.announce(rest);
        piece
    }

    /// The segments that start in `v`, from bottom to top, those of one direction made one.
    fn collect_starting(&mut self, v: u32) {
        let mut starting = std::mem::take(&mut self.starting);
        starting.clear();
        let mut next = self.first[v as usize].take();
        while let Some(e) = next {
            starting.push(e);
            next = self.following[e as usize].get();
        }
        let right = |e: u32| self.segments[e as usize].right;
        starting.sort_unstable_by(|&a, &b| {
            let turn = self.orient(v, right(a), right(b));
            0.cmp(&turn.as_i8()).then(right(a).cmp(&right(b))).then(a.cmp(&b))
        });
        let mut distinct = 0;
        let mut at = 0;
        while at < starting.len() {
            let nearest = starting[at];
            let along = |e: u32| {
                self.orient(
                    v,
                    self.segments[nearest as usize].right,
                    self.segments[e as usize].right,
                )
            };
            let same = starting[at..].iter().take_while(|&&e| along(e).is_zero()).count();
            self.fold(&starting[at..at + same]);
            let Segment { count, forced, .. } = self.segments[nearest as usize];
            if count != 0 || forced {
                starting[distinct] = nearest;
                distinct += 1;
            }
            at += same;
        }
        starting.truncate(distinct);
        self.starting = starting;
    }

    /// Makes one of segments of one direction, nearest end first: each farther one is split where
    /// the one before it ends, which takes over its first part.
    fn fold(&mut self, run: &[u32]) {
        for pair in run.windows(2).rev() {
            let [near, far] = [pair[0], pair[1]].map(|e| self.segments[e as usize]);
            if near.right != far.right {
                self.split(far, near.right);
            }
            let near = &mut self.segments[pair[0] as usize];
            near.count += far.count;
            near.forced |= far.forced;
        }
    }

    /// Gives up segments until none of those on the line at `v` crosses its neighbour.
    fn uncross(&mut self, v: u32) {
        let mut place = self.first_not_below(v);
        place = self.status.previous(place).unwrap_or(place);
        while let Some(lower) = self.status.get(place) {
            let next = self.status.next(place);
            if self.cross(Some(lower), self.status.get(next)) {
                let at = if self.gives_way(lower, next) { place } else { next };
                self.give_up(at);
                place = self.first_not_below(v);
                place = self.status.previous(place).unwrap_or(place);
            } else if self.side(lower, v) == Sign::Negative {
                return;
            } else {
                place = next;
            }
        }
    }

    /// Whether the lower of two crossing segments is to go: one that is only forced rather than one
    /// of the chain, then the longer (what goes makes a detour around the other's end), then the
    /// upper.
    fn gives_way(&self, lower: u32, upper: Place) -> bool {
        let Some(upper) = self.status.get(upper) else { return false };
        let weight = |e: u32| {
            let Segment { left, right, count, .. } = self.segments[e as usize];
            let along = self.sites[right as usize] - self.sites[left as usize];
            (count != 0, -along.length_squared())
        };
        weight(lower) < weight(upper)
    }

    fn give_up(&mut self, place: Place) {
        let Some(e) = self.status.get(place) else { return };
        let below = self.status.before(place);
        self.status.remove(place);
        self.dropped.push(self.segments[e as usize]);
        let (lower, upper) = (*self.front_above(below), self.above[e as usize]);
        *self.front_above(below) = self.fronts.unite(lower, upper);
    }

    /// Whether two neighbours on the line cross properly, to the right of it.
    fn cross(&self, lower: Option<u32>, upper: Option<u32>) -> bool {
        let (Some(lower), Some(upper)) = (lower, upper) else { return false };
        let [l, u] = [lower, upper].map(|e| self.segments[e as usize].right);
        match l.cmp(&u) {
            std::cmp::Ordering::Less => self.side(upper, l) == Sign::Positive,
            std::cmp::Ordering::Equal => false,
            std::cmp::Ordering::Greater => self.side(lower, u) == Sign::Negative,
        }
    }

    /// Positive where a site lies above a segment.
    fn side(&self, e: u32, v: u32) -> Sign {
        let Segment { left, right, .. } = self.segments[e as usize];
        self.orient(left, right, v)
    }

    fn orient(&self, a: u32, b: u32, c: u32) -> Sign {
        let [a, b, c] = [a, b, c].map(|s| self.sites[s as usize]);
        orient2d(a, b, c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn orient(lattice: &[[i64; 2]], corners: [u32; 3]) -> i64 {
        let [a, b, c] = corners.map(|s| lattice[s as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Twice the area of the convex hull of sorted sites, by gift wrapping.
    fn hull_area(lattice: &[[i64; 2]]) -> i64 {
        let (mut at, mut area) = (0, 0);
        loop {
            let next = (0..lattice.len() as u32).filter(|&s| s != at).reduce(|best, s| {
                let right = orient(lattice, [at, best, s]);
                let [p, b, q] = [at, best, s].map(|s| lattice[s as usize]);
                let reach = |r: [i64; 2]| (r[0] - p[0]).pow(2) + (r[1] - p[1]).pow(2);
                if right < 0 || (right == 0 && reach(q) > reach(b)) { s } else { best }
            });
            let Some(next) = next else { return 0 };
            area += orient(lattice, [0, at, next]);
            at = next;
            if at == 0 {
                return area;
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1500))]

        #[test]
        fn whatever_is_dropped_the_hull_is_triangulated(
            places in prop::collection::btree_set([-7i64..8, -7i64..8], 2..24),
            ends in prop::collection::vec(([0usize..24, 0usize..24], -1i64..2), 0..24),
        ) {
            let lattice: Vec<[i64; 2]> = places.into_iter().collect();
            let sites: Vec<DVec2> =
                lattice.iter().map(|p| DVec2::new(p[0] as f64, p[1] as f64)).collect();
            let segments: Vec<Segment> = ends
                .iter()
                .filter_map(|(e, count)| {
                    Segment::new(e.map(|i| (i % sites.len()) as u32), *count, true)
                })
                .collect();
            let swept = sweep(&sites, &segments).expect("all segments end");
            let mut area = 0;
            let mut sides = std::collections::BTreeSet::new();
            for Layer { corners: [a, b, c], .. } in swept.triangles {
                let twice = orient(&lattice, [a, b, c]);
                prop_assert!(twice > 0);
                area += twice;
                for side in [[a, b], [b, c], [c, a]] {
                    prop_assert!(sides.insert(side), "{side:?} twice");
                }
            }
            prop_assert_eq!(area, hull_area(&lattice));
            for segment in swept.kept {
                let ends = [segment.left, segment.right];
                let flat = area == 0;
                prop_assert!(flat || sides.contains(&ends) || sides.contains(&[ends[1], ends[0]]));
            }
            prop_assert!(swept.flat.iter().all(|l| orient(&lattice, l.corners) == 0));
        }
    }
}
