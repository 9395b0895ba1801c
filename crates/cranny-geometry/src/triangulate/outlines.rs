//! The polygonal outlines of a set of triangles.
//!
//! No source: this crate's own. Sides are paired by sorting, and each free side is followed by just
//! one other, so walks close. Cost: O(n log n) for n triangles.

use crate::hull::lowest_first;
use crate::ids::OptionalIndex;

/// The loops that bound a set of triangles, each running as the triangles' own sides do; together
/// they are the signed boundary. A loop visits no vertex twice and starts at its lowest; loops are
/// sorted.
///
/// Sides that two triangles run through in opposite directions are inner ones (of more than two,
/// they are paired as listed). A loop continues with the next free side around its vertex through
/// the triangles there, so parts that merely touch at a vertex have loops of their own. Triangles
/// with a repeated corner play no part. Cost: `O(t log t)` for `t` triangles.
pub fn outlines(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    if let &[[a, b, c]] = triangles
        && a != b
        && b != c
        && c != a
    {
        return vec![lowest_first([a, b, c]).to_vec()];
    }
    let triangles: Vec<[u32; 3]> =
        triangles.iter().copied().filter(|[a, b, c]| a != b && b != c && c != a).collect();
    let twins = Twins::new(&triangles);
    let mut seen = vec![false; 3 * triangles.len()];
    let mut loops = Vec::new();
    for start in 0..seen.len() {
        if twins.of(start).is_none() && !seen[start] {
            let mut walk = Vec::new();
            let mut side = start;
            while !seen[side] {
                seen[side] = true;
                walk.push(triangles[side / 3][side % 3]);
                side = twins.next_free(side);
            }
            split_at_repeated_vertices(walk, &mut loops);
        }
    }
    for outline in &mut loops {
        if let Some(lowest) = (0..outline.len()).min_by_key(|&i| outline[i]) {
            outline.rotate_left(lowest);
        }
    }
    loops.sort_unstable();
    loops
}

/// For each side `3 t + i` of triangle `t`, from its corner `i` to the next, the side opposite to
/// it.
struct Twins(Vec<OptionalIndex>);

impl Twins {
    fn new(triangles: &[[u32; 3]]) -> Self {
        // Lower vertex, higher vertex, whether it runs downwards, side.
        let mut sides: Vec<(u32, u32, bool, u32)> = (0u32..)
            .zip(triangles.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]))
            .map(|(side, (from, to))| (from.min(to), from.max(to), from > to, side))
            .collect();
        sides.sort_unstable();
        let mut twins = vec![OptionalIndex::NONE; sides.len()];
        for edge in sides.chunk_by(|s, t| (s.0, s.1) == (t.0, t.1)) {
            let (up, down) = edge.split_at(edge.partition_point(|s| !s.2));
            for (s, t) in up.iter().zip(down) {
                twins[s.3 as usize] = OptionalIndex::some(t.3);
                twins[t.3 as usize] = OptionalIndex::some(s.3);
            }
        }
        Self(twins)
    }

    fn of(&self, side: usize) -> Option<usize> {
        self.0[side].get().map(|twin| twin as usize)
    }

    /// The free side that follows a free one, around the vertex where this ends.
    fn next_free(&self, side: usize) -> usize {
        let next = |side: usize| side - side % 3 + (side + 1) % 3;
        let mut side = next(side);
        while let Some(twin) = self.of(side) {
            side = next(twin);
        }
        side
    }
}

/// Cuts a closed walk wherever it comes back to a vertex.
fn split_at_repeated_vertices(walk: Vec<u32>, loops: &mut Vec<Vec<u32>>) {
    let mut sorted = walk.clone();
    sorted.sort_unstable();
    if sorted.is_sorted_by(|a, b| a < b) {
        loops.push(walk);
        return;
    }
    let mut place = std::collections::BTreeMap::new();
    let mut open: Vec<u32> = Vec::with_capacity(walk.len());
    for v in walk {
        if let Some(&at) = place.get(&v) {
            let closed = open.split_off(at);
            closed.iter().for_each(|u| {
                place.remove(u);
            });
            loops.push(closed);
        }
        place.insert(v, open.len());
        open.push(v);
    }
    loops.push(open);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_sides_vanish() {
        assert_eq!(outlines(&[[0, 1, 2], [0, 2, 3]]), [[0, 1, 2, 3]]);
        assert_eq!(outlines(&[[0, 2, 1], [0, 3, 2]]), [[0, 3, 2, 1]]);
        assert!(outlines(&[[0, 1, 2], [2, 1, 0]]).is_empty());
        assert!(outlines(&[[0, 1, 1]]).is_empty());
        assert!(outlines(&[]).is_empty());
    }

    #[test]
    fn an_annulus_has_two_loops() {
        // Outer triangle 0 1 2, inner triangle 3 4 5.
        let ring = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5]];
        assert_eq!(outlines(&ring), [[0, 1, 2], [3, 5, 4]]);
    }

    #[test]
    fn triangles_that_touch_at_a_vertex_have_loops_of_their_own() {
        assert_eq!(outlines(&[[0, 1, 2], [2, 3, 4]]), [[0, 1, 2], [2, 3, 4]]);
        assert_eq!(outlines(&[[0, 1, 2], [0, 1, 2]]), [[0, 1, 2], [0, 1, 2]]);
    }

    #[test]
    fn a_hole_that_touches_the_outside_is_cut_off() {
        // A square 0 1 2 3 whose triangular hole 0 4 5 hangs on its corner 0: one walk, two loops.
        let triangles = [[0, 1, 4], [1, 2, 4], [4, 2, 5], [2, 3, 5], [3, 0, 5]];
        assert_eq!(outlines(&triangles), [vec![0, 1, 2, 3], vec![0, 5, 4]]);
    }
}
