//! Closed chains of directed edges, split into simple loops.
//!
//! A chain that is a boundary enters each vertex as often as it leaves it, so it is a sum of loops
//! (Euler 1736). Where it touches itself, at a vertex that it leaves more than once, several sums
//! are possible; the one taken here follows the edge to the lowest vertex, and cuts a loop off
//! whenever it comes back to a vertex that it has passed. Every loop is simple: it passes each
//! vertex once.
//!
//! Cost: O(n log n) for n edges, which are sorted by where they begin.

use cranny_geometry::VertexId;

/// The simple loops of a chain, in compressed rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Loops {
    pub(crate) starts: Vec<u32>,
    pub(crate) vertices: Vec<VertexId>,
    /// Per vertex of a loop whether the chain passes it more than once.
    pub(crate) touches: Vec<bool>,
}

impl Loops {
    pub(crate) fn new() -> Self {
        Self { starts: vec![0], ..Self::default() }
    }

    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    /// Appends some loops of others; returns where their vertices stand there.
    pub(crate) fn append(
        &mut self,
        other: &Self,
        loops: std::ops::Range<u32>,
    ) -> std::ops::Range<usize> {
        let starts = &other.starts[loops.start as usize..=loops.end as usize];
        let row = starts[0] as usize..starts[starts.len() - 1] as usize;
        let end = self.vertices.len() as u32;
        self.starts.extend(starts[1..].iter().map(|s| s - starts[0] + end));
        self.vertices.extend_from_slice(&other.vertices[row.clone()]);
        self.touches.extend_from_slice(&other.touches[row.clone()]);
        row
    }

    /// Appends a loop.
    pub(crate) fn push(&mut self, vertices: &[u32]) {
        self.vertices.extend(vertices.iter().map(|&v| VertexId(v)));
        self.touches.resize(self.vertices.len(), false);
        self.starts.push(self.vertices.len() as u32);
    }

    /// Splits a closed chain and appends its loops, each from its lowest vertex, in the order of
    /// these. O(n log n). Edges that are on no loop, which a closed chain has not, are left out.
    pub(crate) fn split(&mut self, edges: &mut [[u32; 2]]) {
        edges.sort_unstable();
        let mut vertices: Vec<u32> = edges.iter().map(|e| e[0]).collect();
        vertices.dedup();
        let place = |v: u32| vertices.binary_search(&v).ok();
        let first: Vec<usize> =
            vertices.iter().map(|&v| edges.partition_point(|e| e[0] < v)).collect();
        let end = |i: usize| first.get(i + 1).copied().unwrap_or(edges.len());
        let mut cursor = first.clone();
        let mut on_path = vec![usize::MAX; vertices.len()];
        let mut found: Vec<Vec<usize>> = Vec::new();
        for start in 0..vertices.len() {
            let mut path = vec![start];
            on_path[start] = 0;
            while let Some(&at) = path.last() {
                if cursor[at] == end(at) {
                    on_path[at] = usize::MAX;
                    path.pop();
                    continue;
                }
                let to = edges[cursor[at]][1];
                cursor[at] += 1;
                let Some(to) = place(to) else { continue };
                if on_path[to] == usize::MAX {
                    on_path[to] = path.len();
                    path.push(to);
                } else {
                    let cut = path.split_off(on_path[to] + 1);
                    for &v in &cut {
                        on_path[v] = usize::MAX;
                    }
                    found.push([&[to], cut.as_slice()].concat());
                }
            }
        }
        for row in &mut found {
            let lowest = (0..row.len()).min_by_key(|&i| row[i]).unwrap_or(0);
            row.rotate_left(lowest);
        }
        found.sort_unstable();
        for row in found {
            self.vertices.extend(row.iter().map(|&i| VertexId(vertices[i])));
            self.touches.extend(row.iter().map(|&i| end(i) - first[i] > 1));
            self.starts.push(self.vertices.len() as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(edges: &[[u32; 2]]) -> Vec<(Vec<u32>, Vec<u32>)> {
        let mut loops = Loops::new();
        loops.split(&mut edges.to_vec());
        (0..loops.len())
            .map(|i| {
                let row = &loops.vertices[loops.row(i)];
                let touches = row.iter().zip(&loops.touches[loops.row(i)]).filter(|(_, t)| **t);
                (row.iter().map(|v| v.0).collect(), touches.map(|(v, _)| v.0).collect())
            })
            .collect()
    }

    #[test]
    fn separate_loops_start_at_their_lowest_vertices() {
        let found = split(&[[9, 4], [4, 7], [7, 9], [2, 8], [8, 1], [1, 2]]);
        assert_eq!(found, [(vec![1, 2, 8], vec![]), (vec![4, 7, 9], vec![])]);
    }

    #[test]
    fn a_figure_of_eight_is_two_loops_that_name_their_touching_vertex() {
        let eight = [[1, 5], [5, 2], [2, 3], [3, 5], [5, 4], [4, 1]];
        let found = split(&eight);
        assert_eq!(found, [(vec![1, 5, 4], vec![5]), (vec![2, 3, 5], vec![5])]);
    }

    #[test]
    fn a_chain_of_three_loops_through_two_vertices() {
        let found = split(&[[0, 1], [1, 0], [1, 2], [2, 1], [2, 3], [3, 2]]);
        assert_eq!(found, [(vec![0, 1], vec![1]), (vec![1, 2], vec![1, 2]), (vec![2, 3], vec![2])]);
    }

    #[test]
    fn an_edge_that_closes_nothing_is_left_out() {
        assert_eq!(split(&[[0, 1], [1, 2], [2, 0], [2, 9]]), [(vec![0, 1, 2], vec![2])]);
    }
}
