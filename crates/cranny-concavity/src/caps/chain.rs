//! Chains of directed edges, in which opposite edges cancel.
//!
//! The boundary of a set of oriented triangles is such a chain, with integer multiplicities: an
//! edge that runs as often one way as the other is not in it. Boundaries are *closed*: as many
//! edges enter each vertex as leave it. (Munkres 1984, sections 5 and 6, for the algebra.)
//!
//! Cost: O(n log n) for n edges, which are sorted.

/// Where an edge of a chain comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Origin {
    /// A half-edge of the hull.
    Hull(u32),
    /// An edge of the mesh.
    Mesh,
}

/// An edge of a chain, run from the first end to the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ChainEdge {
    pub(crate) ends: [u32; 2],
    pub(crate) origin: Origin,
}

impl ChainEdge {
    pub(crate) fn new(ends: [u32; 2], origin: Origin) -> Self {
        Self { ends, origin }
    }

    fn undirected(&self) -> [u32; 2] {
        let [a, b] = self.ends;
        [a.min(b), a.max(b)]
    }

    fn is_forward(&self) -> bool {
        self.ends[0] < self.ends[1]
    }
}

/// Cancels opposite edges and drops edges from a vertex to itself; what is left is sorted. Of equal
/// edges those of the hull are kept last, so that what is left is rather of the mesh: which copies
/// cancel does not matter to the chain.
pub(crate) fn cancel(chain: &mut Vec<ChainEdge>) {
    chain.retain(|e| e.ends[0] != e.ends[1]);
    chain.sort_unstable_by_key(|e| (e.undirected(), !e.is_forward(), e.origin));
    let mut kept = 0;
    let mut first = 0;
    while first < chain.len() {
        let key = chain[first].undirected();
        let count = chain[first..].iter().take_while(|e| e.undirected() == key).count();
        let forward = chain[first..first + count].iter().take_while(|e| e.is_forward()).count();
        // The backward edges follow the forward ones.
        let left = if 2 * forward >= count {
            first..first + 2 * forward - count
        } else {
            first + 2 * forward..first + count
        };
        for i in left {
            chain[kept] = chain[i];
            kept += 1;
        }
        first += count;
    }
    chain.truncate(kept);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(mut chain: Vec<ChainEdge>) -> Vec<[u32; 2]> {
        cancel(&mut chain);
        chain.iter().map(|e| e.ends).collect()
    }

    fn mesh(edges: &[[u32; 2]]) -> Vec<ChainEdge> {
        edges.iter().map(|&e| ChainEdge::new(e, Origin::Mesh)).collect()
    }

    #[test]
    fn two_triangles_leave_the_rim_of_their_square() {
        let square = mesh(&[[0, 1], [1, 2], [2, 0], [0, 2], [2, 3], [3, 0]]);
        assert_eq!(ends(square), [[0, 1], [3, 0], [1, 2], [2, 3]]);
    }

    #[test]
    fn multiplicities_count() {
        assert_eq!(ends(mesh(&[[5, 4], [4, 5], [5, 4], [5, 4]])), [[5, 4], [5, 4]]);
        assert_eq!(ends(mesh(&[[4, 5], [4, 5], [5, 4]])), [[4, 5]]);
        assert_eq!(ends(mesh(&[[4, 5], [5, 4], [7, 7]])), [[0; 2]; 0]);
    }

    #[test]
    fn an_edge_of_hull_and_mesh_cancels_whatever_it_comes_from() {
        let mut chain = mesh(&[[2, 1]]);
        chain.push(ChainEdge::new([1, 2], Origin::Hull(7)));
        chain.push(ChainEdge::new([1, 3], Origin::Hull(8)));
        cancel(&mut chain);
        assert_eq!(chain, [ChainEdge::new([1, 3], Origin::Hull(8))]);
    }
}
