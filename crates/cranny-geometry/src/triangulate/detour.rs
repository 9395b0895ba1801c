//! Ways around a segment that crosses others, along edges of a triangulation.
//!
//! The segment is replaced by a border of the corridor that it cuts through the triangles (the
//! corridor of Anglada 1997, there emptied to make room for the segment): left or right, whichever
//! lies closer. The strip between segment and border crosses itself nowhere, so a sweep of its own
//! fills it.
//!
//! Cost: O(t log t) to sort the sides of t triangles, then O(log t) for each triangle passed; for
//! all detours together these are at most [`STEPS_PER_SITE`] times the sites.

use std::cell::Cell;

use cranny_exact::{DVec2, Sign, orient2d};

use super::sweep::{Layer, Segment, Swept, sweep};
use crate::each_once::each_once;

/// How many triangles may be looked at per site, on average. Fewer, and chains with many crossings
/// get fans where local detours were possible; more, and an all-crossing chain takes time and
/// triangles of its size squared (`a_tangle_of_many_crossings_ends_as_a_fan`).
const STEPS_PER_SITE: usize = 64;

/// The edges of a triangulation, to walk along.
pub(super) struct Detours<'a> {
    sites: &'a [DVec2],
    /// From, to and the third corner of each triangle's sides, sorted.
    sides: Vec<[u32; 3]>,
    steps_left: Cell<usize>,
}

/// A segment, and sites from its left to its right end joined by edges.
pub(super) struct Path {
    segment: Segment,
    sites: Vec<u32>,
}

impl<'a> Detours<'a> {
    pub(super) fn new(sites: &'a [DVec2], swept: &Swept) -> Self {
        let mut sides: Vec<[u32; 3]> = swept
            .triangles
            .iter()
            .flat_map(|layer| {
                let [a, b, c] = layer.corners;
                [[a, b, c], [b, c, a], [c, a, b]]
            })
            .collect();
        sides.sort_unstable();
        Self { sites, sides, steps_left: Cell::new(STEPS_PER_SITE * sites.len()) }
    }

    /// The detour of a segment between two sites of the triangulation. Nothing if the steps for all
    /// detours together are used up.
    pub(super) fn along(&self, segment: Segment) -> Option<Path> {
        let mut sites = vec![segment.left];
        self.walk(segment, |border, _| sites.extend(border))?;
        Some(Path { segment, sites })
    }

    /// The sites on the inside of a segment, in order; those found if the steps are used up.
    pub(super) fn sites_on(&self, segment: Segment) -> Vec<u32> {
        let mut found = Vec::new();
        let _all_found = self.walk(segment, |_, site| found.push(site));
        found.retain(|&s| s != segment.right);
        found
    }

    /// Walks along a segment, from each site on it to the next, and returns the way there around
    /// the corridor (last the site itself), and the site.
    fn walk(&self, segment: Segment, mut visit: impl FnMut(&[u32], u32)) -> Option<()> {
        let mut at = segment.left;
        while at != segment.right {
            let [left, right] = self.to_next_site(at, segment.right)?;
            let border = if self.area(at, &right) < self.area(at, &left) { right } else { left };
            at = *border.last()?;
            visit(&border, at);
        }
        Some(())
    }

    /// Both ways around the corridor from a site towards another, up to the first site between.
    fn to_next_site(&self, from: u32, to: u32) -> Option<[Vec<u32>; 2]> {
        let side = |s: u32| self.orient(from, to, s);
        let first = self.sides.partition_point(|s| s[0] < from);
        for &[_, right, left] in self.sides[first..].iter().take_while(|s| s[0] == from) {
            self.step()?;
            for s in [right, left] {
                // Sites are sorted along every line.
                if side(s).is_zero() && s > from {
                    return Some([vec![s], vec![s]]);
                }
            }
            if side(right) == Sign::Negative && side(left) == Sign::Positive {
                return self.through_corridor([right, left], side);
            }
        }
        None
    }

    /// The borders of the corridor behind an edge that the segment crosses.
    fn through_corridor(
        &self,
        [mut right, mut left]: [u32; 2],
        side: impl Fn(u32) -> Sign,
    ) -> Option<[Vec<u32>; 2]> {
        let (mut lefts, mut rights) = (vec![left], vec![right]);
        loop {
            self.step()?;
            let behind = self.sides.partition_point(|s| [s[0], s[1]] < [left, right]);
            let apex = self.sides.get(behind).filter(|s| [s[0], s[1]] == [left, right])?[2];
            let sign = side(apex);
            if sign != Sign::Negative {
                lefts.push(apex);
                left = apex;
            }
            if sign != Sign::Positive {
                rights.push(apex);
                right = apex;
            }
            if sign.is_zero() {
                return Some([lefts, rights]);
            }
        }
    }

    /// Twice the area between a border and its chord, about; it only chooses between two ways.
    fn area(&self, from: u32, border: &[u32]) -> f64 {
        let place = |s: u32| self.sites[s as usize] - self.sites[from as usize];
        border.windows(2).map(|w| place(w[0]).perp_dot(place(w[1]))).sum::<f64>().abs()
    }

    fn step(&self) -> Option<()> {
        self.steps_left.set(self.steps_left.get().checked_sub(1)?);
        Some(())
    }

    fn orient(&self, a: u32, b: u32, c: u32) -> Sign {
        let [a, b, c] = [a, b, c].map(|s| self.sites[s as usize]);
        orient2d(a, b, c)
    }
}

impl Path {
    /// What takes the place of the segment.
    pub(super) fn segments(&self) -> impl Iterator<Item = Segment> {
        self.sites.windows(2).filter_map(|w| Segment::new([w[0], w[1]], self.segment.count, false))
    }

    /// Triangles whose boundary is the segment minus its detour. `O(p log p)` for `p` sites.
    pub(super) fn filling(&self, positions: &[DVec2]) -> Option<Vec<Layer>> {
        let sites = each_once(self.sites.iter().copied());
        let local = |s: u32| sites.partition_point(|&t| t < s) as u32;
        let inside = |s: Segment| Segment { left: local(s.left), right: local(s.right), ..s };
        let back = self.segments().map(|s| Segment { count: -s.count, ..s });
        let segments: Vec<Segment> = back.chain([self.segment]).map(inside).collect();
        let places: Vec<DVec2> = sites.iter().map(|&s| positions[s as usize]).collect();
        let swept = sweep(&places, &segments)?;
        if !swept.dropped.is_empty() {
            return None;
        }
        let layers = swept.triangles.into_iter().chain(swept.flat);
        Some(layers.map(|l| Layer { corners: l.corners.map(|s| sites[s as usize]), ..l }).collect())
    }
}
