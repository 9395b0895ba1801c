//! Faces that straddle facets: what one facet is covered too much by, its neighbour is too little.
//!
//! Where the surface bends by about as little as the merging of facets ignores, mesh and hull may
//! divide it differently: a quadrilateral whose two triangles on the hull went to different facets,
//! while the mesh has the other diagonal. Each of its faces lies on one of the two facets, to
//! within its slab, and reaches into the other. The pieces of cap chains that are left on both
//! sides are then each other's opposites: together they bound nothing, and both are dropped.
//!
//! Both sides of a plate have opposite pieces too where it has a hole. There both are uncovered;
//! here one is covered too often. What distinguishes them is the areas, each measured along the
//! normal of its own facet: only pieces whose areas add up to nothing are dropped.
//!
//! Where sides are rough by as much as slabs are deep, a piece may have the opposites of several
//! facets. Then two are dropped that choose each other, each [the first](FacetOrder) of those it
//! may choose from; the others stay. So pieces go in pairs, always.
//!
//! No source: this crate's own. What closes stays closed, for a piece and its opposite are dropped
//! together. Cost: O(n log n) in the chains; a piece that has an opposite also looks along the
//! outline of its facet and along its chain.

use std::cmp::Ordering;

use super::chain::ChainEdge;
use cranny_geometry::hull::{ConvexHull, FacetId, FacetOrder};
use cranny_geometry::{DisjointSets, Mesh, VertexId};

/// Drops opposite pieces of the chains of two facets across an edge, which together cover nothing;
/// `depth` is that of the slabs. Which facets have such pieces, dropped or not: each with every
/// other.
pub(super) fn drop_straddled(
    mesh: &Mesh,
    hull: &ConvexHull,
    chains: &mut [(u32, Vec<ChainEdge>)],
    depth: f64,
) -> Vec<[u32; 2]> {
    let pieces = Pieces::of(chains);
    let facet_of = |piece: usize| chains[pieces.pieces[piece].0].0;
    let covers_nothing = |piece: usize, other: usize| {
        // Either is measured along the same one of the two, so that both say the same.
        let facets = [facet_of(piece), facet_of(other)];
        let edges = pieces.edges(piece).min(pieces.edges(other));
        let [one, other] = facets.map(|f| covered(mesh, hull, f, edges));
        (one - other).abs() <= depth * length(mesh, edges)
    };
    let mut order = FacetOrder::of(hull);
    let mut opposites = Vec::new();
    // Of each piece that has opposites the one that it chooses; by piece.
    let mut chosen: Vec<(usize, usize)> = Vec::new();
    for piece in 0..pieces.pieces.len() {
        let facet = facet_of(piece);
        let mut first: Option<usize> = None;
        for other in pieces.opposites(piece) {
            if !are_neighbours(hull, facet, facet_of(other)) || !covers_nothing(piece, other) {
                continue;
            }
            opposites.push([facet, facet_of(other)]);
            let comes_first =
                |first: usize| order.compare(facet_of(other), facet_of(first)) == Ordering::Less;
            if first.is_none_or(comes_first) {
                first = Some(other);
            }
        }
        chosen.extend(first.map(|other| (piece, other)));
    }
    let choice = |piece: usize| {
        let found = chosen.binary_search_by_key(&piece, |&(piece, _)| piece);
        found.ok().map(|at| chosen[at].1)
    };
    let dropped: Vec<usize> = chosen
        .iter()
        .filter(|&&(piece, other)| choice(other) == Some(piece))
        .map(|c| c.0)
        .collect();
    for piece in dropped {
        let edges = pieces.edges(piece);
        let (_, chain) = &mut chains[pieces.pieces[piece].0];
        chain.retain(|edge| edges.binary_search(&edge.ends).is_err());
    }
    opposites
}

/// The connected pieces of chains.
struct Pieces {
    /// Of each the chain, and where its edges end.
    pieces: Vec<(usize, usize)>,
    /// The edges of one piece behind those of the other, ascending in each.
    edges: Vec<[u32; 2]>,
    /// The least edge of each piece, and the piece; ascending.
    least: Vec<([u32; 2], u32)>,
}

impl Pieces {
    fn of(chains: &[(u32, Vec<ChainEdge>)]) -> Self {
        let mut all = Self { pieces: Vec::new(), edges: Vec::new(), least: Vec::new() };
        let mut vertices: Vec<u32> = Vec::new();
        let mut edges: Vec<(usize, [u32; 2])> = Vec::new();
        for (index, (_, chain)) in chains.iter().enumerate() {
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
                all.least.push((piece[0].1, all.pieces.len() as u32));
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

    /// The pieces, of any chain, that have just the opposite edges.
    fn opposites(&self, piece: usize) -> Vec<usize> {
        let piece = self.edges(piece);
        let Some(least) = piece.iter().map(|&[a, b]| [b, a]).min() else { return Vec::new() };
        let first = self.least.partition_point(|l| l.0 < least);
        let alike = self.least[first..].iter().take_while(|l| l.0 == least);
        let mut opposite: Vec<[u32; 2]> = Vec::new();
        let mut found = Vec::new();
        for &(_, other) in alike {
            let edges = self.edges(other as usize);
            if edges.len() != piece.len() {
                continue;
            }
            if opposite.is_empty() {
                opposite.extend(piece.iter().map(|&[a, b]| [b, a]));
                opposite.sort_unstable();
            }
            if edges == opposite {
                found.push(other as usize);
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
