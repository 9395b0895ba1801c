//! Which edges of a surface are flat, and which of its vertices are therefore not extreme.
//!
//! No source: signs alone. Cost: O(n), and an exact sign for each edge that the filter leaves
//! undecided.

use cranny_exact::{DVec3, Sign};

use super::quickhull::{HullSurface, previous};
use crate::each_once::each_once;

/// What is flat of a surface.
pub(super) struct Flat {
    /// Vertices that are not extreme, sorted. At an extreme point three or more edges are strictly
    /// convex; inside an edge of the hull two are, inside a facet none.
    pub(super) vertices: Vec<u32>,
    /// One half-edge of each flat edge, if all vertices are extreme; else of some.
    pub(super) edges: Vec<u32>,
}

impl Flat {
    /// Of a surface over `points` points. `edge_sign` is the exact [`edge_sign`] of a half-edge; it
    /// takes longest for zeros, so it is not tried for those that `is_surely_bent` names.
    pub(super) fn of(
        points: usize,
        surface: &HullSurface,
        is_surely_bent: impl Fn(u32) -> bool,
        edge_sign: impl Fn(u32) -> Sign,
    ) -> Self {
        let mut convex_edges = vec![0u32; points];
        let mut doubtful = Vec::new();
        for (half_edge, &twin) in (0u32..).zip(&surface.twins) {
            if half_edge > twin {
                continue;
            }
            if is_surely_bent(half_edge) {
                surface.ends(half_edge).into_iter().for_each(|v| convex_edges[v as usize] += 1);
            } else {
                doubtful.push(half_edge);
            }
        }
        let mut edges = Vec::new();
        // Between vertices that are known to be extreme it matters only if the others are as well.
        let mut put_off = Vec::new();
        for half_edge in doubtful {
            let ends = surface.ends(half_edge);
            if ends.iter().all(|&v| convex_edges[v as usize] >= 3) {
                put_off.push(half_edge);
            } else if edge_sign(half_edge).is_zero() {
                edges.push(half_edge);
            } else {
                ends.into_iter().for_each(|v| convex_edges[v as usize] += 1);
            }
        }
        let corners = surface.triangles.iter().flatten().copied();
        let vertices = each_once(corners.filter(|&v| convex_edges[v as usize] < 3));
        if vertices.is_empty() {
            edges.extend(put_off.into_iter().filter(|&h| edge_sign(h).is_zero()));
        }
        Self { vertices, edges }
    }
}

/// On which side of a triangle the apex of its neighbour lies: `Negative` where the edge is convex,
/// `Zero` where it is flat.
pub(super) fn edge_sign(points: &[DVec3], surface: &HullSurface, half_edge: u32) -> Sign {
    let [a, b, c] = surface.triangles[half_edge as usize / 3].map(|v| points[v as usize]);
    let apex = surface.origin(previous(surface.twins[half_edge as usize]));
    cranny_exact::orient3d(a, b, c, points[apex as usize])
}
