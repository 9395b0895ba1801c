//! The distinct places of a chain's vertices, in the order in which a sweep line meets them.
//!
//! No source: a sort, by lexicographic order as in `sweep`. Cost: O(m log m) for m vertices.

use std::cmp::Ordering;

use cranny_exact::{DVec2, check_point};

use crate::each_once::each_once;

/// Places sorted by x, then y, and which vertices lie at each.
pub(super) struct Sites {
    /// The vertices in use, ascending.
    vertices: Vec<u32>,
    /// The site of each of `vertices`.
    site_of: Vec<u32>,
    positions: Vec<DVec2>,
    /// The lowest vertex at each site.
    lowest: Vec<u32>,
}

impl Sites {
    /// Nothing if a vertex has no point, or one outside the domain.
    pub(super) fn new(points: &[DVec2], vertices: Vec<u32>) -> Option<Self> {
        let vertices = each_once(vertices);
        let mut order = Vec::with_capacity(vertices.len());
        for (rank, &v) in vertices.iter().enumerate() {
            let p = *points.get(v as usize)?;
            check_point(p.extend(0.0)).ok()?;
            order.push((p, rank as u32));
        }
        order.sort_unstable_by(|a, b| lexicographic(a.0, b.0).then(a.1.cmp(&b.1)));

        let mut site_of = vec![0; vertices.len()];
        let (mut positions, mut lowest) = (Vec::<DVec2>::new(), Vec::new());
        for (p, rank) in order {
            if positions.last() != Some(&p) {
                positions.push(p);
                lowest.push(vertices[rank as usize]);
            }
            site_of[rank as usize] = positions.len() as u32 - 1;
        }
        Some(Self { vertices, site_of, positions, lowest })
    }

    pub(super) fn positions(&self) -> &[DVec2] {
        &self.positions
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// The place of a vertex in use among those in use. `O(log m)`.
    pub(super) fn rank(&self, vertex: u32) -> usize {
        self.vertices.partition_point(|&v| v < vertex)
    }

    pub(super) fn site_of(&self, vertex: u32) -> u32 {
        self.site_of[self.rank(vertex)]
    }

    /// The vertex that stands for a site.
    pub(super) fn vertex(&self, site: u32) -> u32 {
        self.lowest[site as usize]
    }

    /// The vertex that stands for the place of a vertex.
    pub(super) fn vertex_at(&self, vertex: u32) -> u32 {
        self.vertex(self.site_of(vertex))
    }
}

fn lexicographic(p: DVec2, q: DVec2) -> Ordering {
    let compare = |a: f64, b: f64| a.partial_cmp(&b).unwrap_or(Ordering::Equal);
    compare(p.x, q.x).then(compare(p.y, q.y))
}
