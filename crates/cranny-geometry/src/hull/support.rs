//! Support points by hill climbing on the vertex graph of a hull.
//!
//! # Why the answer is the maximum, rounding and all
//!
//! Let `e` bound the rounding of `direction · v` over all vertices `v`, and let the ascent end at
//! `w`, none of whose neighbours is computed to be higher. The vertices of a convex polytope that
//! lie above any plane hang together over its edges (the simplex method's argument). Take the plane
//! through the lower of `w` and the vertex `x` whose *computed* height is greatest: since `x` is
//! computed to be at least as high as `w`, its true height is at least that of `w` less `2 e`, so
//! there is a path from `w` to `x` whose vertices are truly at least that high, and computed at
//! most `4 e` below `w`. Searching all that hang together with `w` within `4 e` of it therefore
//! finds `x`, and with it every vertex that ties with it. In general position no neighbour is that
//! near and the search ends at once.
//!
//! # Source and cost
//!
//! Climbing over the edges from the last answer is how Cameron (1997, "Enhancing GJK: computing
//! minimum and penetration distances between convex polyhedra") finds support points; the argument
//! about rounding is this crate's own. O(n) to make the graph; for a query the vertices on the way
//! and the neighbours of each, from an answer near by a few.

use cranny_exact::{Aabb, DVec3};

use super::HullVertexId;
use super::numbering::Numbering;
use super::quickhull::{HullSurface, next};
use crate::rows::{Piece, joined, row, rows};

/// Vertices on a plateau up to which a list, searched from end to end, remembers the visited ones;
/// beyond, a bit per vertex. Only time depends on it: a larger number makes wide plateaus
/// quadratic, a smaller one allocates a bit set for quads seen face-on.
const SHORT_PLATEAU: usize = 16;

/// The vertex graph in compressed rows, and what starts and bounds an ascent.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SupportGraph {
    starts: Vec<u32>,
    neighbours: Vec<HullVertexId>,
    /// Extreme vertices along −x, x, −y, y, −z, z.
    seeds: [HullVertexId; 6],
    /// Largest magnitude of each coordinate.
    reach: DVec3,
}

impl SupportGraph {
    pub(super) fn new(positions: &[DVec3], surface: &HullSurface) -> Self {
        let (mut starts, half_edges) = rows(surface.triangles.as_flattened(), positions.len());
        let mut neighbours: Vec<HullVertexId> =
            half_edges.into_iter().map(|h| HullVertexId(surface.origin(next(h)))).collect();
        if positions.len() == 2 {
            (starts, neighbours) = (vec![0, 1, 2], vec![HullVertexId(1), HullVertexId(0)]);
        } else {
            sort_rows(&mut starts, &mut neighbours);
        }
        Self::with_seeds(positions, starts, neighbours)
    }

    fn with_seeds(positions: &[DVec3], starts: Vec<u32>, neighbours: Vec<HullVertexId>) -> Self {
        let reach = positions.iter().fold(DVec3::ZERO, |m, p| m.max(p.abs()));
        let seeds = extremes(positions).map(HullVertexId);
        Self { starts, neighbours, seeds, reach }
    }

    /// The graph of a surface that follows the one of this graph: rows of `touched`, ascending, are
    /// others. `bounds` is the box before. Cost: copying, and the triangles around these; a look at
    /// all vertices where these are numbered anew, the box is another or something is touched at
    /// its sides.
    pub(super) fn followed(
        &self,
        positions: &[DVec3],
        surface: &HullSurface,
        leaving: &[u32],
        numbering: &Numbering,
        touched: &[u32],
        bounds: &Aabb,
        same_box: bool,
    ) -> Self {
        let sorted = |&v: &u32| {
            let around = surface.spokes(leaving[v as usize]);
            let mut row: Vec<_> = around.map(|h| HullVertexId(surface.ends(h)[1])).collect();
            row.sort_unstable();
            row
        };
        let rows: Vec<Vec<HullVertexId>> = touched.iter().map(sorted).collect();
        let mut pieces = Vec::new();
        let mut new = touched.iter().zip(&rows).peekable();
        let mut first = 0;
        for run in numbering.runs() {
            let old = run.range();
            let end = first + old.len();
            let before = |v: usize| v - first + old.start;
            let mut next = first;
            while let Some((&v, row)) = new.next_if(|(v, _)| (**v as usize) < end) {
                if next < v as usize {
                    pieces.push(Piece::Kept(before(next)..before(v as usize)));
                }
                pieces.push(Piece::New(row));
                next = v as usize + 1;
            }
            if next < end {
                pieces.push(Piece::Kept(before(next)..before(end)));
            }
            first = end;
        }
        let pieces = pieces.into_iter();
        let (starts, neighbours) = if numbering.is_same() {
            joined(&self.starts, &self.neighbours, pieces, |v| v)
        } else {
            let map = |v: HullVertexId| HullVertexId(numbering.of_vertex(v.0));
            joined(&self.starts, &self.neighbours, pieces, map)
        };
        let at_side = |&v: &u32| {
            let p = positions[v as usize];
            (p.cmpeq(bounds.min) | p.cmpeq(bounds.max)).any()
        };
        let was_seed = |v: &u32| self.seeds.contains(&HullVertexId(*v));
        if same_box && numbering.is_same() && !touched.iter().any(|v| at_side(v) || was_seed(v)) {
            return Self { starts, neighbours, seeds: self.seeds, reach: self.reach };
        }
        Self::with_seeds(positions, starts, neighbours)
    }

    pub(super) fn neighbours(&self, vertex: HullVertexId) -> &[HullVertexId] {
        &self.neighbours[row(&self.starts, vertex.index())]
    }

    /// Bounds the rounding of `direction · v` over all vertices: three products and two sums, at
    /// most three roundings a term, so `γ₃ Σ |dᵢ| reachᵢ` (Higham 2002, lemma 3.1); 4 u covers
    /// computing the bound as well. The last term covers underflow.
    pub(super) fn rounding(&self, direction: DVec3) -> f64 {
        2.0 * f64::EPSILON * direction.abs().dot(self.reach) + 4.0 * f64::from_bits(1)
    }

    /// See [`ConvexHull::support`](super::ConvexHull::support).
    pub(super) fn support(
        &self,
        positions: &[DVec3],
        direction: DVec3,
        start: Option<HullVertexId>,
    ) -> Option<HullVertexId> {
        if positions.is_empty() {
            return None;
        }
        let height = |v: HullVertexId| direction.dot(positions[v.index()]);
        let near = 4.0 * self.rounding(direction);
        let mut top = start.unwrap_or_else(|| self.seed(direction));
        let mut top_height = height(top);
        loop {
            let here = top;
            let mut runner_up = f64::NEG_INFINITY;
            for &v in self.neighbours(here) {
                let h = height(v);
                if h > top_height {
                    (top, top_height) = (v, h);
                } else {
                    runner_up = runner_up.max(h);
                }
            }
            if top == here {
                if runner_up < top_height - near {
                    return Some(top);
                }
                let best = self.best_of_plateau(here, top_height - near, height);
                if height(best) > top_height {
                    (top, top_height) = (best, height(best));
                } else {
                    return Some(best);
                }
            }
        }
    }

    fn seed(&self, direction: DVec3) -> HullVertexId {
        let axis = direction.abs().max_position();
        self.seeds[2 * axis + usize::from(direction[axis] > 0.0)]
    }

    /// The highest vertex among those that hang together with `from` at or above `floor`, the
    /// lowest id of equals.
    fn best_of_plateau(
        &self,
        from: HullVertexId,
        floor: f64,
        height: impl Fn(HullVertexId) -> f64,
    ) -> HullVertexId {
        let mut best = (height(from), from);
        let mut visited = Visited::new();
        visited.insert(from, self.starts.len());
        let mut next = 0;
        while let Some(v) = visited.get(next) {
            next += 1;
            for &w in self.neighbours(v) {
                let h = height(w);
                let is_new = h >= floor && visited.insert(w, self.starts.len());
                if is_new && (h > best.0 || (h == best.0 && w < best.1)) {
                    best = (h, w);
                }
            }
        }
        best.1
    }
}

/// The first vertex farthest along −x, x, −y, y, −z, z.
fn extremes(positions: &[DVec3]) -> [u32; 6] {
    let mut seeds = [0; 6];
    let Some(&first) = positions.first() else { return seeds };
    let (mut low, mut high) = (first, first);
    for (v, p) in (0..).zip(positions) {
        for axis in 0..3 {
            if p[axis] < low[axis] {
                (low[axis], seeds[2 * axis]) = (p[axis], v);
            }
            if p[axis] > high[axis] {
                (high[axis], seeds[2 * axis + 1]) = (p[axis], v);
            }
        }
    }
    seeds
}

/// Sorts every row and closes the gaps that repeated entries leave (a plate has each diagonal
/// twice).
///
/// Neighbourhood is mutual: whoever goes through the rows in order, and enters each row's number in
/// the rows that it names, enters ascending numbers.
fn sort_rows(starts: &mut [u32], neighbours: &mut Vec<HullVertexId>) {
    let vertices = starts.len() - 1;
    let mut sorted = vec![HullVertexId(0); neighbours.len()];
    let mut fill = starts[..vertices].to_vec();
    let mut is_repeated = false;
    for from in 0..vertices {
        for to in &neighbours[row(starts, from)] {
            let place = fill[to.index()] as usize;
            fill[to.index()] += 1;
            sorted[place] = HullVertexId(from as u32);
            is_repeated |= place > starts[to.index()] as usize
                && sorted[place - 1] == HullVertexId(from as u32);
        }
    }
    *neighbours = sorted;
    if is_repeated {
        close_gaps(starts, neighbours);
    }
}

/// Leaves one of equal entries, which stand side by side.
fn close_gaps(starts: &mut [u32], neighbours: &mut Vec<HullVertexId>) {
    let (mut from, mut kept) = (0, 0);
    for end in &mut starts[1..] {
        let to = *end as usize;
        let row = kept;
        for i in from..to {
            if kept == row || neighbours[kept - 1] != neighbours[i] {
                neighbours[kept] = neighbours[i];
                kept += 1;
            }
        }
        from = to;
        *end = kept as u32;
    }
    neighbours.truncate(kept);
}

/// The vertices seen so far, in order.
struct Visited {
    short: [HullVertexId; SHORT_PLATEAU],
    count: usize,
    /// Continues `short`.
    long: Vec<HullVertexId>,
    bits: Vec<u64>,
}

impl Visited {
    fn new() -> Self {
        Self {
            short: [HullVertexId(0); SHORT_PLATEAU],
            count: 0,
            long: Vec::new(),
            bits: Vec::new(),
        }
    }

    fn get(&self, i: usize) -> Option<HullVertexId> {
        if i < SHORT_PLATEAU {
            self.short[..self.count].get(i).copied()
        } else {
            self.long.get(i - SHORT_PLATEAU).copied()
        }
    }

    /// Whether `vertex` was new. `vertices` is the number of vertices, at least.
    fn insert(&mut self, vertex: HullVertexId, vertices: usize) -> bool {
        if self.bits.is_empty() {
            if self.short[..self.count].contains(&vertex) {
                return false;
            }
            if self.count < SHORT_PLATEAU {
                self.short[self.count] = vertex;
                self.count += 1;
                return true;
            }
            self.bits = vec![0; vertices / 64 + 1];
            for v in self.short {
                self.bits[v.index() / 64] |= 1 << (v.index() % 64);
            }
        }
        let (word, bit) = (&mut self.bits[vertex.index() / 64], 1 << (vertex.index() % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        if is_new {
            self.long.push(vertex);
        }
        is_new
    }
}
