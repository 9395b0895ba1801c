//! Faces that straddle facets: what one facet is covered too much by, its neighbour is too little.
//!
//! Where the surface bends by about as little as the merging of facets ignores, mesh and hull may divide
//! it differently: a quadrilateral whose two triangles on the hull went to different facets, while the
//! mesh has the other diagonal. Each of its faces lies on one of the two facets, to within its slab, and
//! reaches into the other. The pieces of cap chains that are left on both sides are then each other's
//! opposites: together they bound nothing, and both are dropped.
//!
//! Both sides of a plate have opposite pieces too where it has a hole. There both are uncovered; here one
//! is covered too often. What tells them apart is the areas, each measured along the normal of its own
//! facet: only pieces whose areas add up to nothing are dropped.

use std::collections::BTreeMap;

use super::chain::ChainEdge;
use crate::hull::{ConvexHull, FacetId};
use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::topology::DisjointSets;

/// Drops opposite pieces of the chains of two facets across an edge, which together cover nothing; `depth`
/// is that of the slabs. O(n log n).
pub(super) fn drop_straddled(
    mesh: &Mesh,
    hull: &ConvexHull,
    chains: &mut [(u32, Vec<ChainEdge>)],
    depth: f64,
) {
    let mut pieces: BTreeMap<Vec<[u32; 2]>, u32> = BTreeMap::new();
    for (facet, chain) in chains.iter() {
        pieces.extend(pieces_of(chain).into_iter().map(|piece| (piece, *facet)));
    }
    let covers_nothing = |piece: &[[u32; 2]], facets: [u32; 2]| {
        let [own, other] = facets.map(|f| covered(mesh, hull, f, piece));
        (own - other).abs() <= depth * length(mesh, piece)
    };
    for (facet, chain) in chains.iter_mut().filter(|(_, chain)| !chain.is_empty()) {
        for piece in pieces_of(chain) {
            let mut opposite: Vec<[u32; 2]> = piece.iter().map(|&[a, b]| [b, a]).collect();
            opposite.sort_unstable();
            let partner =
                pieces.get(&opposite).filter(|&other| are_neighbours(hull, *facet, *other));
            if partner.is_some_and(|&other| covers_nothing(&piece, [*facet, other])) {
                chain.retain(|edge| piece.binary_search(&edge.ends).is_err());
            }
        }
    }
}

/// The connected pieces of a chain; of each the edges, ascending.
fn pieces_of(chain: &[ChainEdge]) -> Vec<Vec<[u32; 2]>> {
    let mut vertices: Vec<u32> = chain.iter().flat_map(|e| e.ends).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let place = |v: u32| vertices.partition_point(|&u| u < v);
    let mut joined = DisjointSets::new(vertices.len());
    for edge in chain {
        joined.union(place(edge.ends[0]), place(edge.ends[1]));
    }
    let mut edges: Vec<(usize, [u32; 2])> =
        chain.iter().map(|e| (joined.find(place(e.ends[0])), e.ends)).collect();
    edges.sort_unstable();
    edges.chunk_by(|e, f| e.0 == f.0).map(|piece| piece.iter().map(|e| e.1).collect()).collect()
}

fn are_neighbours(hull: &ConvexHull, facet: u32, other: u32) -> bool {
    hull.facet(FacetId(facet)).neighbours.contains(&FacetId(other))
}

/// The signed area that a piece bounds, along the normal of a facet.
fn covered(mesh: &Mesh, hull: &ConvexHull, facet: u32, piece: &[[u32; 2]]) -> f64 {
    let normal = hull.facet(FacetId(facet)).normal;
    let origin = mesh.position(VertexId(piece[0][0]));
    let twice = |ends: &[u32; 2]| {
        let [from, to] = ends.map(|v| mesh.position(VertexId(v)) - origin);
        normal.dot(from.cross(to))
    };
    0.5 * piece.iter().map(twice).sum::<f64>()
}

fn length(mesh: &Mesh, piece: &[[u32; 2]]) -> f64 {
    let length =
        |[a, b]: &[u32; 2]| mesh.position(VertexId(*a)).distance(mesh.position(VertexId(*b)));
    piece.iter().map(length).sum()
}
