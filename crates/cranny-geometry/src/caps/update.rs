//! Caps after some facets have other faces on them, or faces that have moved, or are new.
//!
//! The cap of a facet depends on its own chain, on where its edges are divided, which the facets
//! across these edges have a say in, and on which pieces of the chains of these are its own opposites. So
//! the caps of the facets named and of two rings of facets around them are made again, from the
//! chains of these and of two more rings.
//!
//! Which facets are covered together may depend on facets farther away. Where there are such, or caps that count
//! negative, all caps are made again.
//!
//! No source: this crate's own, for the reason above. Cost: with the function.

use std::collections::BTreeSet;

use super::straddle::drop_straddled;
use super::{CapSurface, divide_alike, open_chains, ridges_of};
use crate::features::{Assignment, RidgeOnFacet};
use crate::hull::{ConvexHull, FacetId};
use crate::ids::HalfEdgeId;
use crate::mesh::Mesh;
use crate::topology::Topology;

impl CapSurface {
    /// The caps after the faces on the facets `stale`, or the ridges there, have changed or moved, or
    /// these facets are new; and how many facets were looked at. `before` names what each facet was, unless all
    /// have kept their numbers.
    ///
    /// Cost: O(n log n) in the faces and triangles of these facets, and a pass over the facets of all
    /// faces and over all cap triangles, which are copied. Where caps are shared or negative, that of
    /// building.
    pub(crate) fn updated(
        &self,
        mesh: &Mesh,
        topology: &Topology,
        hull: &ConvexHull,
        assignment: &Assignment,
        ridges: &[RidgeOnFacet],
        stale: &[u32],
        before: Option<&[u32]>,
    ) -> (Self, usize) {
        let all_again = || Self::build(mesh, topology, hull, assignment, ridges);
        if !self.shared.is_empty() || !self.is_sound() {
            return (all_again(), hull.facet_count());
        }
        let stale = stale.iter().copied().collect();
        let stale = with_neighbours(hull, &with_neighbours(hull, &stale));
        let around = with_neighbours(hull, &with_neighbours(hull, &stale));
        let mut chains = open_chains(mesh, topology, hull, assignment, around.iter().copied());
        divide_alike(mesh, hull, &mut chains, ridges, assignment.depth());
        drop_straddled(mesh, hull, &mut chains, assignment.depth());

        let mut updated = Self { facet_starts: vec![0], ..Self::default() };
        let mut chains = chains.into_iter().peekable();
        for facet in 0..hull.facet_count() as u32 {
            let chain = chains.next_if(|(id, _)| *id == facet).map(|(_, chain)| chain);
            if !stale.contains(&facet) {
                let was = before.map_or(facet, |before| before[facet as usize]);
                updated.copy(self, FacetId(was), FacetId(facet));
            } else if let Some(chain) = chain.filter(|chain| !chain.is_empty()) {
                let id = FacetId(facet);
                updated.cover(mesh, hull.facet(id), id, &chain, ridges_of(ridges, facet));
            }
            updated.facet_starts.push(updated.triangles.len() as u32);
        }
        if updated.is_sound() { (updated, around.len()) } else { (all_again(), hull.facet_count()) }
    }
}

/// Some facets and those across their edges.
fn with_neighbours(hull: &ConvexHull, facets: &BTreeSet<u32>) -> BTreeSet<u32> {
    let mut around = facets.clone();
    for &facet in facets {
        for &t in hull.facet(FacetId(facet)).triangles {
            around.extend(
                (3 * t..3 * t + 3)
                    .map(|h| hull.facet_of_triangle(hull.twin(HalfEdgeId(h)).index() / 3).0),
            );
        }
    }
    around
}
