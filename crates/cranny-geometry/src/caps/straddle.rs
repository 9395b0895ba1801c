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
//!
//! No source: this crate's own. What closes stays closed, for a piece and its opposite are dropped together. Cost:
//! O(n log n) in the chains; a piece that has an opposite also looks along the outline of its facet and along its
//! chain.

use super::chain::ChainEdge;
use crate::hull::{ConvexHull, FacetId};
use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::topology::DisjointSets;

/// Drops opposite pieces of the chains of two facets across an edge, which together cover nothing; `depth`
/// is that of the slabs.
pub(super) fn drop_straddled(
    mesh: &Mesh,
    hull: &ConvexHull,
    chains: &mut [(u32, Vec<ChainEdge>)],
    depth: f64,
) {
    let pieces = Pieces::of(chains);
    let covers_nothing = |piece: &[[u32; 2]], facets: [u32; 2]| {
        let [own, other] = facets.map(|f| covered(mesh, hull, f, piece));
        (own - other).abs() <= depth * length(mesh, piece)
    };
    for (piece, &(chain, _)) in pieces.pieces.iter().enumerate() {
        let piece = pieces.edges(piece);
        let (facet, chain) = &mut chains[chain];
        let partner = pieces.facet_of_opposite(piece).filter(|&f| are_neighbours(hull, *facet, f));
        if partner.is_some_and(|other| covers_nothing(piece, [*facet, other])) {
            chain.retain(|edge| piece.binary_search(&edge.ends).is_err());
        }
    }
}

/// The connected pieces of chains.
struct Pieces {
    /// Of each the chain, and where its edges end.
    pieces: Vec<(usize, usize)>,
    /// The edges of one piece behind those of the other, ascending in each.
    edges: Vec<[u32; 2]>,
    /// The least edge of each piece, the piece, and the facet of its chain; ascending.
    least: Vec<([u32; 2], u32, u32)>,
}

impl Pieces {
    fn of(chains: &[(u32, Vec<ChainEdge>)]) -> Self {
        let mut all = Self { pieces: Vec::new(), edges: Vec::new(), least: Vec::new() };
        let mut vertices: Vec<u32> = Vec::new();
        let mut edges: Vec<(usize, [u32; 2])> = Vec::new();
        for (index, (facet, chain)) in chains.iter().enumerate() {
            vertices.clear();
            vertices.extend(chain.iter().flat_map(|e| e.ends));
            vertices.sort_unstable();
            vertices.dedup();
            let place = |v: u32| vertices.partition_point(|&u| u < v);
            let mut joined = DisjointSets::new(vertices.len());
            for edge in chain {
                joined.union(place(edge.ends[0]), place(edge.ends[1]));
            }
            edges.clear();
            edges.extend(chain.iter().map(|e| (joined.find(place(e.ends[0])), e.ends)));
            edges.sort_unstable();
            for piece in edges.chunk_by(|e, f| e.0 == f.0) {
                all.least.push((piece[0].1, all.pieces.len() as u32, *facet));
                all.edges.extend(piece.iter().map(|e| e.1));
                all.pieces.push((index, all.edges.len()));
            }
        }
        all.least.sort_unstable();
        all
    }

    fn edges(&self, piece: usize) -> &[[u32; 2]] {
        let start = piece.checked_sub(1).map_or(0, |before| self.pieces[before].1);
        &self.edges[start..self.pieces[piece].1]
    }

    /// The facet whose chain has just the opposite edges as a piece; of several the highest.
    fn facet_of_opposite(&self, piece: &[[u32; 2]]) -> Option<u32> {
        let least = piece.iter().map(|&[a, b]| [b, a]).min()?;
        let first = self.least.partition_point(|l| l.0 < least);
        let alike = self.least[first..].iter().take_while(|l| l.0 == least);
        let mut opposite: Vec<[u32; 2]> = Vec::new();
        let mut found = None;
        for &(_, other, facet) in alike {
            let edges = self.edges(other as usize);
            if edges.len() != piece.len() {
                continue;
            }
            if opposite.is_empty() {
                opposite.extend(piece.iter().map(|&[a, b]| [b, a]));
                opposite.sort_unstable();
            }
            if edges == opposite {
                found = Some(facet);
            }
        }
        found
    }
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
