//! Edges of the hull, divided where the mesh divides them.
//!
//! The edge of a planar side may carry vertices of the mesh that are not extreme, or are so by
//! rounding alone. The facets on both sides of an edge of the hull must divide it alike: then
//! whatever one facet's cap gains by it the other's loses, and caps still close. An edge is divided
//! only where it is left over on both sides, that is, where no edge of the mesh equals it.
//!
//! No source: this crate's own, and right whatever is near or not, because both facets are given
//! the same division. Cost: O(n log n) as a rule; an edge is compared with all vertices beside it
//! along the sweep.

use std::collections::BTreeMap;

use cranny_exact::DVec3;

use super::chain::{ChainEdge, Origin};
use cranny_geometry::hull::ConvexHull;
use cranny_geometry::{HalfEdgeId, Mesh, VertexId, each_once};

/// The vertices that divide edges of the hull, by the lesser of the two half-edges; from the lesser
/// of the edge's ends on.
#[derive(Debug, Default)]
pub(crate) struct Divisions(BTreeMap<u32, Vec<(f64, u32)>>);

impl Divisions {
    /// Finds for each edge of the hull that is left in a facet's chain the vertices of the mesh
    /// left there, and `others`, that lie within `reach` of it.
    ///
    /// A sweep along the facet's widest axis: O(n log n) unless very many vertices lie side by
    /// side.
    pub(crate) fn find(
        &mut self,
        mesh: &Mesh,
        hull: &ConvexHull,
        left: &[ChainEdge],
        others: impl Iterator<Item = u32>,
        reach: f64,
    ) {
        let of_mesh = left.iter().filter(|e| e.origin == Origin::Mesh).flat_map(|e| e.ends);
        let mut candidates = each_once(of_mesh.chain(others));
        let at = |v: u32| mesh.position(VertexId(v));
        let axis = widest_axis(candidates.iter().map(|&v| at(v)));
        candidates.sort_by(|&u, &v| at(u)[axis].total_cmp(&at(v)[axis]).then(u.cmp(&v)));
        for edge in left {
            let Origin::Hull(h) = edge.origin else { continue };
            let twin = hull.twin(HalfEdgeId(h)).0;
            // From the lesser vertex on: numbers of half-edges mean nothing, and rounding may
            // differ between the two ways.
            let [from, to] = [edge.ends[0].min(edge.ends[1]), edge.ends[0].max(edge.ends[1])];
            let (p, q) = (at(from), at(to));
            let (low, high) = (p[axis].min(q[axis]) - reach, p[axis].max(q[axis]) + reach);
            let first = candidates.partition_point(|&v| at(v)[axis] < low);
            for &v in candidates[first..].iter().take_while(|&&v| at(v)[axis] <= high) {
                if v == from || v == to {
                    continue;
                }
                if let Some(share) = share_along(at(v), p, q, reach) {
                    self.0.entry(h.min(twin)).or_default().push((share, v));
                }
            }
        }
    }

    /// Drops the divisions of an edge that one of its facets has no use for.
    pub(crate) fn keep(&mut self, is_left: impl Fn(u32) -> bool) {
        self.0.retain(|&h, _| is_left(h));
        for row in self.0.values_mut() {
            row.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            row.dedup_by_key(|entry| entry.1);
        }
    }

    /// Replaces divided edges of the hull by the paths along their divisions.
    pub(crate) fn divide(&self, hull: &ConvexHull, chain: &mut Vec<ChainEdge>) {
        if self.0.is_empty() {
            return;
        }
        let whole = std::mem::take(chain);
        for edge in whole {
            let row = match edge.origin {
                Origin::Hull(h) => self.0.get(&h.min(hull.twin(HalfEdgeId(h)).0)),
                Origin::Mesh => None,
            };
            let Some(row) = row else {
                chain.push(edge);
                continue;
            };
            let mut path: Vec<u32> = row.iter().map(|&(_, v)| v).collect();
            if edge.ends[0] > edge.ends[1] {
                path.reverse();
            }
            path.push(edge.ends[1]);
            let mut from = edge.ends[0];
            for to in path {
                chain.push(ChainEdge::new([from, to], edge.origin));
                from = to;
            }
        }
    }

    /// Whether an edge of the hull is divided.
    pub(crate) fn touches(&self, hull: &ConvexHull, half_edge: u32) -> bool {
        self.0.contains_key(&half_edge.min(hull.twin(HalfEdgeId(half_edge)).0))
    }
}

fn widest_axis(points: impl Iterator<Item = DVec3>) -> usize {
    let bounds = cranny_exact::Aabb::of_points(points);
    (bounds.max - bounds.min).max_position()
}

/// How far along the segment a point lies, between 0 and 1, if it lies within reach of its inside.
fn share_along(point: DVec3, from: DVec3, to: DVec3, reach: f64) -> Option<f64> {
    let (along, out) = (to - from, point - from);
    let share = out.dot(along) / along.length_squared();
    let near = (out - share * along).length_squared() <= reach * reach;
    (share > 0.0 && share < 1.0 && near).then_some(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_divides_a_segment_within_reach_of_its_inside_only() {
        let (p, q) = (DVec3::ZERO, 4.0 * DVec3::X);
        assert_eq!(share_along(DVec3::X, p, q, 0.0), Some(0.25));
        assert_eq!(share_along(DVec3::new(3.0, 0.0, 0.5), p, q, 0.5), Some(0.75));
        assert_eq!(share_along(DVec3::new(3.0, 0.0, 0.5), p, q, 0.25), None);
        assert_eq!(share_along(p, p, q, 1.0), None);
        assert_eq!(share_along(5.0 * DVec3::X, p, q, 2.0), None);
        assert_eq!(share_along(p, p, p, 1.0), None);
    }
}
