//! What fills the hole that a vertex leaves.
//!
//! Source and cost: those of the repair.

use std::collections::BTreeSet;

use super::super::quickhull::HullSurface;

/// The triangles of the hull of some points that lie within a rim; `None` where an edge of that is
/// none of the hull.
pub(super) fn within(
    surface: &HullSurface,
    some: &[u32],
    rim: &[(u32, u32, u32)],
) -> Option<Vec<[u32; 3]>> {
    let ends = |h: u32| surface.ends(h).map(|v| some[v as usize]);
    let edges: BTreeSet<[u32; 2]> = rim.iter().map(|&(from, to, _)| [from, to]).collect();
    let half_edges = 0..surface.twins.len() as u32;
    let on_rim = half_edges.filter(|&h| edges.contains(&ends(h)));
    let front: Vec<u32> = on_rim.map(|h| h / 3).collect();
    if front.len() < edges.len() {
        return None;
    }
    let inside = surface.hanging_together(front, |h| !edges.contains(&ends(h)));
    let corners = |t: u32| surface.triangles[t as usize].map(|v| some[v as usize]);
    Some(inside.into_iter().map(corners).collect())
}

/// Triangles over a convex outline in a plane, turned so that they fit into a link; `None` where
/// the link has other vertices.
pub(super) fn fan_along(link: &[(u32, u32, u32)], outline: Vec<u32>) -> Option<Vec<[u32; 3]>> {
    let rim: Vec<u32> = link.iter().map(|l| l.0).collect();
    if outline.len() != rim.len() || !outline.iter().all(|v| rim.contains(v)) {
        return None;
    }
    Some((2..rim.len()).map(|i| [rim[0], rim[i - 1], rim[i]]).collect())
}
