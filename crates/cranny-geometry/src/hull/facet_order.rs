//! An order of facets that says the same of a hull that was built and of one that followed moved
//! points.
//!
//! Facets are numbered in no order that means anything, and planes of the same facet may differ by
//! rounding. What is the same however a hull came about is which vertices of the mesh a facet has.
//! So where nothing else distinguishes two facets, the one whose vertices, ascending, come first in
//! the order of dictionaries is taken.
//!
//! No source: this crate's own. Cost: O(k log k) for a facet of k triangles when it is first needed
//! for.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::{ConvexHull, FacetId};
use crate::each_once::each_once;
use crate::ids::VertexId;

/// Facets of a hull by their vertices.
pub struct FacetOrder<'a> {
    hull: &'a ConvexHull,
    vertices: BTreeMap<u32, Vec<VertexId>>,
}

impl<'a> FacetOrder<'a> {
    /// The order of the facets of a hull.
    pub fn of(hull: &'a ConvexHull) -> Self {
        Self { hull, vertices: BTreeMap::new() }
    }

    /// Which of two facets comes first. Those with the same vertices, the two sides of a plate, go
    /// by number.
    pub fn compare(&mut self, one: u32, other: u32) -> Ordering {
        self.prepare(one);
        self.prepare(other);
        let of = |facet: u32| self.vertices.get(&facet);
        of(one).cmp(&of(other)).then(one.cmp(&other))
    }

    fn prepare(&mut self, facet: u32) {
        let hull = self.hull;
        self.vertices.entry(facet).or_insert_with(|| {
            let triangles = hull.facet(FacetId(facet)).triangles.iter();
            let corners = triangles.flat_map(|&t| hull.triangle(t as usize));
            each_once(corners.map(|v| hull.source(v)))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;

    #[test]
    fn facets_are_ordered_by_their_vertices_whatever_their_numbers() {
        // A point inside comes first, so vertices of the hull have other numbers than its sources.
        let bit = |i: u32, k: u32| f64::from(i >> k & 1);
        let corners = (0..8).map(|i| DVec3::new(bit(i, 0), bit(i, 1), bit(i, 2)));
        let points: Vec<DVec3> = std::iter::once(DVec3::splat(0.5)).chain(corners).collect();
        let hull = ConvexHull::of_points(&points);
        let mut order = FacetOrder::of(&hull);
        let mut facets: Vec<u32> = (0..hull.facet_count() as u32).collect();
        facets.sort_by(|&a, &b| order.compare(a, b));
        let vertices = |f: &u32| {
            let mut all: Vec<u32> =
                hull.facet(FacetId(*f)).corners.iter().map(|&v| hull.source(v).0).collect();
            all.sort_unstable();
            all
        };
        let sides: Vec<Vec<u32>> = facets.iter().map(vertices).collect();
        let ascending =
            [[1, 2, 3, 4], [1, 2, 5, 6], [1, 3, 5, 7], [2, 4, 6, 8], [3, 4, 7, 8], [5, 6, 7, 8]];
        assert_eq!(sides, ascending);
        assert_eq!(order.compare(facets[0], facets[0]), Ordering::Equal);
    }
}
