//! The classification as bytes. Convex sets are counted again.

use super::{ConvexSet, Feature, Features, NONE};
use crate::codec::{Flaw, Reader, Writer, check, check_below, coded, is_flatness};
use crate::hull::ConvexHull;
use crate::ids::{EdgeId, FaceId, VertexId};
use crate::mesh::Mesh;
use crate::topology::Topology;

coded!(Feature {
    Self::Convex => 0 => Self::Convex,
    Self::Boundary => 1 => Self::Boundary,
    Self::Concavity => 2 => Self::Concavity,
});

impl Features {
    pub(crate) fn encode(&self, out: &mut Writer) {
        let Self {
            facet_of_face,
            set_of_face,
            sets: _,
            vertices,
            edges,
            isolated,
            ridges,
            slab_depth,
        } = self;
        out.list(facet_of_face);
        out.list(set_of_face);
        out.codes(vertices);
        out.codes(edges);
        out.list(isolated);
        out.list(ridges);
        out.one(*slab_depth);
    }

    /// Reads the classification of a mesh by its hull.
    pub(crate) fn decode(
        input: &mut Reader,
        mesh: &Mesh,
        topology: &Topology,
        hull: &ConvexHull,
    ) -> Result<Self, Flaw> {
        let (facet_of_face, set_of_face): (Vec<u32>, Vec<u32>) = (input.list()?, input.list()?);
        let (vertices, edges): (Vec<Feature>, Vec<Feature>) = (input.codes()?, input.codes()?);
        let (isolated, ridges): (Vec<VertexId>, Vec<EdgeId>) = (input.list()?, input.list()?);
        let slab_depth: f64 = input.one()?;
        let faces = mesh.faces().len();
        check(facet_of_face.len() == faces, "a facet for each face is needed")?;
        check(set_of_face.len() == faces, "a convex set for each face is needed")?;
        let placed = facet_of_face.iter().copied().filter(|&facet| facet != NONE);
        check_below(placed, hull.facet_count(), "a face lies on a facet that is not there")?;
        check(vertices.len() == mesh.vertices().len(), "a class for each vertex is needed")?;
        check(edges.len() == topology.edges().len(), "a class for each edge is needed")?;
        check_below(isolated.iter().map(|v| v.0), vertices.len(), "a vertex is not there")?;
        check(isolated.is_sorted_by(|a, b| a < b), "isolated vertices are not ascending")?;
        check_below(ridges.iter().map(|e| e.0), edges.len(), "a ridge is not there")?;
        check(ridges.is_sorted_by(|a, b| a < b), "ridges are not ascending")?;
        check(is_flatness(slab_depth), "the depth of slabs is no number")?;
        let sets = sets_of(&facet_of_face, &set_of_face)?;
        Ok(Self { facet_of_face, set_of_face, sets, vertices, edges, isolated, ridges, slab_depth })
    }
}

/// Sets are numbered by their first faces.
fn sets_of(facet_of_face: &[u32], set_of_face: &[u32]) -> Result<Vec<ConvexSet>, Flaw> {
    let mut sets: Vec<ConvexSet> = Vec::new();
    let has_both = |(&facet, &set): (&u32, &u32)| (facet == NONE) == (set == NONE);
    let all_have = facet_of_face.iter().zip(set_of_face).fold(true, |all, own| all & has_both(own));
    check(all_have, "a face has a facet or a convex set, not both")?;
    let mut face = 0;
    for run in set_of_face.chunk_by(|a, b| a == b) {
        let (set, first_face) = (run[0], FaceId(face));
        face += run.len() as u32;
        if set == NONE {
            continue;
        }
        if set as usize == sets.len() {
            sets.push(ConvexSet { first_face, faces: 0 });
        }
        let set = sets.get_mut(set as usize).ok_or("convex sets are not in order")?;
        set.faces += run.len() as u32;
    }
    Ok(sets)
}
