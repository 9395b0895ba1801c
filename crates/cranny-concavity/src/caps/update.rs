//! Caps after some facets have other faces on them, or faces that have moved, or are new.
//!
//! The cap of a facet depends on its own chain, on where its edges are divided, which the facets
//! across these edges have a say in, and on which pieces of the chains of these are its own
//! opposites. So the caps of the facets named and of two rings of facets around them are made
//! again, from the chains of these and of two more rings.
//!
//! Which facets are covered together may depend on facets farther away, and so may which of several
//! opposites a piece is dropped with. Where there are such facets, or opposites just where the
//! second ring ends, or caps that count negative, all caps are made again.
//!
//! No source: this crate's own, for the reason above. Cost: with the function.

use std::collections::{BTreeMap, BTreeSet};

use super::straddle::drop_straddled;
use super::{CapSurface, divide_alike, open_chains, ridges_of};
use crate::features::{Assignment, RidgeOnFacet};
use cranny_geometry::hull::{ConvexHull, FacetId};
use cranny_geometry::rows::replaced;
use cranny_geometry::{FaceId, HalfEdgeId, Model};

impl CapSurface {
    /// The caps after the faces on the facets `stale`, or the ridges there, have changed or moved,
    /// or these facets are new; those facets whose caps were made again, and how many were looked
    /// at. The others are what they were.
    ///
    /// Cost: O(n log n) in the faces and triangles of these facets, a look at which facet each face
    /// is on, and copying. Where caps are shared or negative, or pieces have opposites two rings
    /// away, that of building.
    pub(crate) fn updated(
        &self,
        model: &Model,
        assignment: &Assignment,
        ridges: &[RidgeOnFacet],
        stale: &[u32],
    ) -> (Self, BTreeSet<u32>, usize) {
        let (mesh, hull) = (model.mesh(), model.hull());
        let count = hull.facet_count();
        let all_again = || {
            let all = Self::build(model, assignment, ridges);
            (all, (0..count as u32).collect(), count)
        };
        if !self.is_sound() {
            return all_again();
        }
        let stale = stale.iter().copied().collect();
        let stale = with_neighbours(hull, &with_neighbours(hull, &stale));
        let around = with_neighbours(hull, &with_neighbours(hull, &stale));
        let faces = faces_of_some(&assignment.facet_of_face, count, &around);
        let of_facet = |f: u32| faces.get(&f).map_or(&[][..], |faces| faces);
        let facets = around.iter().copied();
        let mut chains = open_chains(model, assignment, facets, of_facet);
        divide_alike(mesh, hull, &mut chains, ridges, assignment.depth());
        let opposites = drop_straddled(mesh, hull, &mut chains, assignment.depth());
        if opposites.iter().any(|[one, other]| stale.contains(one) && !stale.contains(other)) {
            return all_again();
        }

        // Each facet's by itself, and then all at their places.
        let mut made = Self::default();
        let mut changed: BTreeMap<u32, Vec<[u32; 3]>> =
            stale.iter().map(|&facet| (facet, Vec::new())).collect();
        for (facet, chain) in chains.iter().filter(|(_, chain)| !chain.is_empty()) {
            let Some(row) = changed.get_mut(facet) else { continue };
            let id = FacetId(*facet);
            made.close_facet(mesh, hull.facet(id), id, chain, ridges_of(ridges, *facet));
            row.append(&mut made.triangles);
        }
        if !made.is_sound() {
            return all_again();
        }
        let (facet_starts, triangles) =
            replaced(&self.facet_starts, &self.triangles, count, &changed, |t| t);
        (Self { triangles, facet_starts, ..Self::default() }, stale, around.len())
    }
}

/// The faces on some facets.
fn faces_of_some(
    facet_of_face: &[u32],
    count: usize,
    facets: &BTreeSet<u32>,
) -> BTreeMap<u32, Vec<FaceId>> {
    let mut is_wanted = vec![false; count];
    facets.iter().for_each(|&f| is_wanted[f as usize] = true);
    let mut faces: BTreeMap<u32, Vec<FaceId>> = BTreeMap::new();
    for (face, &facet) in (0..).map(FaceId).zip(facet_of_face) {
        if is_wanted.get(facet as usize) == Some(&true) {
            faces.entry(facet).or_default().push(face);
        }
    }
    faces
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
