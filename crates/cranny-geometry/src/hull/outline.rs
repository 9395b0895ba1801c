//! Outlines of merged facets, with collinear corners dropped on both sides of an edge alike.
//!
//! A vertex where three or more facets meet is a corner. Between two corners an outline is a *chain*
//! along which the same two facets meet; each chain is simplified once (Douglas and Peucker 1973) by
//! the merging tolerance, so both facets see the same corners.
//!
//! Cost: O(n) for the loops; for a chain of k edges O(k log k) as a rule and O(k²) at worst, as for Douglas and
//! Peucker.

use cranny_exact::DVec3;

use super::HullVertexId;
use super::facets::FacetId;
use super::quickhull::{Surface, next};

/// Corners and neighbours of all facets, in compressed rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Outlines {
    pub(super) starts: Vec<u32>,
    pub(super) corners: Vec<HullVertexId>,
    pub(super) neighbours: Vec<FacetId>,
}

impl Outlines {
    pub(super) fn new(
        positions: &[DVec3],
        surface: &Surface,
        facet_of: &[u32],
        [triangle_starts, triangles]: [&[u32]; 2],
        tolerance: f64,
    ) -> Self {
        let facets = triangle_starts.len() - 1;
        let row =
            |f: usize| &triangles[triangle_starts[f] as usize..triangle_starts[f + 1] as usize];
        let loops = Loops::new(surface, facet_of, (0..facets).map(row));
        let mut is_corner = loops.meeting_points(positions.len());
        for facet in 0..facets {
            loops.simplify(facet, surface, positions, tolerance, &mut is_corner);
        }
        // A facet as thin as the tolerance may have lost its width: it keeps its whole outline.
        for facet in 0..facets {
            let (_, outline) = loops.of(facet);
            if outline.iter().filter(|&&v| is_corner[v as usize]).count() < 3 {
                for &v in outline {
                    is_corner[v as usize] = true;
                }
            }
        }
        let most = loops.vertices.len();
        let mut outlines = Self {
            starts: Vec::with_capacity(facets + 1),
            corners: Vec::with_capacity(most),
            neighbours: Vec::with_capacity(most),
        };
        outlines.starts.push(0);
        for facet in 0..facets {
            let (half_edges, vertices) = loops.of(facet);
            for (&h, &v) in half_edges.iter().zip(vertices) {
                if is_corner[v as usize] {
                    outlines.corners.push(HullVertexId(v));
                    outlines.neighbours.push(FacetId(across(surface, facet_of, h)));
                }
            }
            outlines.starts.push(outlines.corners.len() as u32);
        }
        outlines
    }

    pub(super) fn of(&self, facet: FacetId) -> (&[HullVertexId], &[FacetId]) {
        let row = self.starts[facet.index()] as usize..self.starts[facet.index() + 1] as usize;
        (&self.corners[row.clone()], &self.neighbours[row])
    }
}

/// The facet on the other side of a half-edge.
fn across(surface: &Surface, facet_of: &[u32], half_edge: u32) -> u32 {
    facet_of[surface.twins[half_edge as usize] as usize / 3]
}

/// The boundary half-edges of each facet, in order: one loop each, for facets are disks. Each begins with the
/// lowest.
struct Loops<'a> {
    facet_of: &'a [u32],
    starts: Vec<u32>,
    half_edges: Vec<u32>,
    /// Where each of them begins.
    vertices: Vec<u32>,
}

impl<'a> Loops<'a> {
    /// `facets`: the triangles of each, ascending.
    fn new<'t>(
        surface: &Surface,
        facet_of: &'a [u32],
        facets: impl ExactSizeIterator<Item = &'t [u32]>,
    ) -> Self {
        let is_boundary = |h: u32| facet_of[h as usize / 3] != across(surface, facet_of, h);
        let most = surface.twins.len();
        let mut loops = Self {
            facet_of,
            starts: Vec::with_capacity(facets.len() + 1),
            half_edges: Vec::with_capacity(most),
            vertices: Vec::with_capacity(most),
        };
        loops.starts.push(0);
        for triangles in facets {
            // Nearly all, on most bodies.
            if let &[t] = triangles {
                loops.half_edges.extend([3 * t, 3 * t + 1, 3 * t + 2]);
                loops.vertices.extend(surface.triangles[t as usize]);
                loops.starts.push(loops.half_edges.len() as u32);
                continue;
            }
            let own = triangles.iter().flat_map(|&t| 3 * t..3 * t + 3);
            let start = own.into_iter().find(|&h| is_boundary(h)).unwrap_or(u32::MAX);
            let mut h = start;
            while h != u32::MAX {
                loops.half_edges.push(h);
                loops.vertices.push(surface.origin(h));
                h = next(h);
                while !is_boundary(h) {
                    h = next(surface.twins[h as usize]);
                }
                if h == start {
                    break;
                }
            }
            loops.starts.push(loops.half_edges.len() as u32);
        }
        loops
    }

    /// The half-edges around a facet, and where each begins.
    fn of(&self, facet: usize) -> (&[u32], &[u32]) {
        let row = self.starts[facet] as usize..self.starts[facet + 1] as usize;
        (&self.half_edges[row.clone()], &self.vertices[row])
    }

    /// For each vertex, whether three or more facets meet there.
    fn meeting_points(&self, vertices: usize) -> Vec<bool> {
        let mut facets_at = vec![0u32; vertices];
        for &v in &self.vertices {
            facets_at[v as usize] += 1;
        }
        facets_at.into_iter().map(|n| n >= 3).collect()
    }

    /// Marks the corners that the chains of a facet need, those towards facets of higher number.
    fn simplify(
        &self,
        facet: usize,
        surface: &Surface,
        positions: &[DVec3],
        tolerance: f64,
        is_corner: &mut [bool],
    ) {
        let (outline, vertices) = self.of(facet);
        if vertices.iter().all(|&v| is_corner[v as usize]) {
            return;
        }
        let mut anchors: Vec<usize> =
            (0..vertices.len()).filter(|&i| is_corner[vertices[i] as usize]).collect();
        if anchors.is_empty() {
            // Two facets alone meet along a closed chain: it starts at its lowest vertex.
            let Some(lowest) = (0..vertices.len()).min_by_key(|&i| vertices[i]) else { return };
            is_corner[vertices[lowest] as usize] = true;
            anchors.push(lowest);
        }
        for (i, &from) in anchors.iter().enumerate() {
            if across(surface, self.facet_of, outline[from]) as usize > facet {
                let to = anchors.get(i + 1).copied().unwrap_or(anchors[0] + vertices.len());
                let chain: Vec<u32> = (from..=to).map(|k| vertices[k % vertices.len()]).collect();
                keep_bends(&chain, positions, tolerance, is_corner);
            }
        }
    }
}

/// Douglas and Peucker: marks vertices so that every other lies within the tolerance of the segment
/// between the marked ones beside it. The ends are taken as marked.
fn keep_bends(chain: &[u32], positions: &[DVec3], tolerance: f64, is_corner: &mut [bool]) {
    let at = |i: usize| positions[chain[i] as usize];
    let mut pieces = vec![(0, chain.len() - 1)];
    while let Some((from, to)) = pieces.pop() {
        let mut bend = (tolerance, None);
        for i in from + 1..to {
            let distance = distance_to_segment(at(i), at(from), at(to));
            if distance > bend.0 {
                bend = (distance, Some(i));
            }
        }
        if let (_, Some(i)) = bend {
            is_corner[chain[i] as usize] = true;
            pieces.extend([(from, i), (i, to)]);
        }
    }
}

fn distance_to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (along, to) = (b - a, p - a);
    let length_squared = along.length_squared();
    let t = if length_squared > 0.0 { to.dot(along) / length_squared } else { 0.0 };
    (to - t.clamp(0.0, 1.0) * along).length()
}
