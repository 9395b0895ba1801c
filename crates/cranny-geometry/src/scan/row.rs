//! Vertices in a row along one direction: what is near each other is near each other there.
//!
//! Source: sorting by address calculation (Isaac and Singleton 1956). Cost: O(n) as a rule and O(n
//! log n) at worst to make a row; to look beside a vertex what is near in the row, and where that
//! is much a question to the tree.

use cranny_exact::{Aabb, DVec3};

use crate::each_once::each_once;
use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::near::corners_near;
use crate::tree::FaceTree;

/// A direction in which few places tie: on lattices, and along edges and sides of bodies, others
/// have thousands in one place. Shorter than 1, so that no two places are farther apart in the row
/// than they are.
const ALONG: DVec3 = DVec3::new(0.467_913, 0.703_511, 0.533_877);

/// Stretches of the row as long as this are not searched but replaced by a question to the tree:
/// side by side across the row, vertices must not take quadratic time.
const LONG: usize = 64;

/// Some vertices by their places in the row.
pub(super) struct Row {
    order: Vec<(f64, VertexId)>,
    /// By vertex; `usize::MAX` for others.
    rank: Vec<usize>,
    /// What is within the distance wanted is within this distance in the row.
    reach: f64,
}

impl Row {
    /// The row in which what lies within a distance is looked for.
    pub(super) fn of(mesh: &Mesh, distance: f64, among: impl Fn(VertexId) -> bool) -> Self {
        let vertices = mesh.vertex_ids().filter(|&v| among(v));
        let mut order: Vec<(f64, VertexId)> =
            vertices.map(|v| (ALONG.dot(mesh.position(v)), v)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut rank = vec![usize::MAX; mesh.vertices().len()];
        for (i, &(_, v)) in order.iter().enumerate() {
            rank[v.index()] = i;
        }
        let largest = mesh.vertices().iter().fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        // Five roundings of sums that are less than twice the largest coordinate, for either place.
        Self { order, rank, reach: distance + 16.0 * f64::EPSILON * largest }
    }

    /// Those that have a neighbour in the row within reach, ascending.
    pub(super) fn close(&self) -> Vec<VertexId> {
        let near = |pair: &&[(f64, VertexId)]| pair[1].0 - pair[0].0 <= self.reach;
        let pairs = self.order.windows(2).filter(near);
        each_once(pairs.flat_map(|pair| [pair[0].1, pair[1].1]))
    }

    pub(super) fn holds(&self, v: VertexId) -> bool {
        self.rank[v.index()] != usize::MAX
    }

    /// Finds the vertices that may be within the distance of another; that one may be among them.
    pub(super) fn beside(
        &self,
        mesh: &Mesh,
        tree: &FaceTree,
        v: VertexId,
        distance: f64,
        found: &mut Vec<VertexId>,
    ) {
        let at = self.rank[v.index()];
        let place = self.order[at].0;
        let near = |entry: &&(f64, VertexId)| (entry.0 - place).abs() <= self.reach;
        let before = self.order[..at].iter().rev().take_while(near);
        let behind = self.order[at + 1..].iter().take_while(near);
        found.clear();
        found.extend(before.chain(behind).map(|e| e.1).take(LONG));
        if found.len() == LONG {
            let p = mesh.position(v);
            *found = corners_near(mesh, tree, &Aabb { min: p, max: p }.grown(distance));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_row_finds_what_the_tree_finds() {
        // Two copies of a grid, a hair apart, and so many vertices in one place as no stretch
        // holds.
        let grid = |k: i32| DVec3::new(f64::from(k % 7), f64::from(k / 7 % 7), f64::from(k / 49));
        let shifted = |k| grid(k) + DVec3::new(0.0, 1e-9, -1e-9);
        let crowd = (0..100).map(|k| DVec3::new(9.0, 9.0, 1e-12 * f64::from(k)));
        let vertices: Vec<DVec3> =
            (0..343).map(grid).chain((0..343).map(shifted)).chain(crowd).collect();
        let faces = (0..vertices.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]);
        let mesh = Mesh::new(vertices.clone(), faces.collect()).unwrap();
        let tree = FaceTree::of(&mesh, 1);
        let row = Row::of(&mesh, 2e-9, |_| true);
        let count = 3 * (vertices.len() as u32 / 3);
        let close = row.close();
        let mut found = Vec::new();
        for v in (0..count).map(VertexId) {
            let p = mesh.position(v);
            row.beside(&mesh, &tree, v, 2e-9, &mut found);
            assert!(close.binary_search(&v).is_ok() || found.is_empty());
            for near in corners_near(&mesh, &tree, &Aabb { min: p, max: p }.grown(2e-9)) {
                assert!(near == v || found.contains(&near), "{near:?} beside {v:?}");
            }
        }
    }
}
