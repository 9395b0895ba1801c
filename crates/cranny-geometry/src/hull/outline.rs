//! Outlines of merged facets, with collinear corners dropped on both sides of an edge alike.
//!
//! A vertex where three or more facets meet is a corner. Between two corners an outline is a
//! *chain* along which the same two facets meet; each chain is simplified once (Douglas and
//! Peucker 1973) by the merging tolerance, so both facets see the same corners.
//!
//! Cost: O(n) for the loops; for a chain of k edges O(k log k) as a rule and O(k²) at worst, as for
//! Douglas and Peucker.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::DVec3;

use super::HullVertexId;
use super::facets::FacetId;
use super::numbering::Numbering;
use super::quickhull::{HullSurface, next};
use crate::rows::{overwritten, replaced, row};

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
        surface: &HullSurface,
        facet_of: &[u32],
        [triangle_starts, triangles]: [&[u32]; 2],
        tolerance: f64,
    ) -> Self {
        let facets = triangle_starts.len() - 1;
        if facets == surface.triangles.len() && facets > 2 {
            return Self::of_triangles(surface, facet_of, triangles);
        }
        let rows = (0..facets).map(|f| &triangles[row(triangle_starts, f)]);
        let loops = Loops::new(surface, facet_of, rows);
        let mut is_corner = loops.meeting_points(positions.len());
        for facet in 0..facets {
            loops.simplify(facet, surface, positions, tolerance, &mut is_corner);
        }
        // A facet as thin as the tolerance may have lost its width: it keeps its whole outline.
        let has_few = |facet: &usize| {
            loops.of(*facet).1.iter().filter(|&&v| is_corner[v as usize]).count() < 3
        };
        let thin: Vec<usize> = (0..facets).filter(has_few).collect();
        for &v in thin.into_iter().flat_map(|facet| loops.of(facet).1) {
            is_corner[v as usize] = true;
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

    /// The outlines of facets that are one triangle each, of a hull that is no plate: at each
    /// vertex three of them meet, or more.
    fn of_triangles(surface: &HullSurface, facet_of: &[u32], triangles: &[u32]) -> Self {
        let corners = |&t: &u32| surface.triangles[t as usize].map(HullVertexId);
        let neighbours = |&t: &u32| {
            let across = |i: u32| FacetId(across(surface, facet_of, 3 * t + i));
            [across(0), across(1), across(2)]
        };
        Self {
            starts: (0..=triangles.len() as u32).map(|f| 3 * f).collect(),
            corners: triangles.iter().flat_map(corners).collect(),
            neighbours: triangles.iter().flat_map(neighbours).collect(),
        }
    }

    /// The outlines of facets that follow those before, `fresh` of which are new or have another
    /// number.
    ///
    /// Whether a vertex is a corner depends on the facets that meet there, on the chain that it
    /// lies on, whose ends depend on the same, and on whether one of its facets is thin, which
    /// depends on the corners of that. So other outlines than before have the facets that share a
    /// vertex with one that shares a vertex with a new one, at most.
    pub(super) fn followed(
        self,
        region: &Region<'_>,
        numbering: &Numbering,
        fresh: &[u32],
    ) -> Self {
        let beside = region.around(&region.around(&fresh.iter().copied().collect()));
        let outlines: BTreeMap<u32, FacetOutline> =
            region.around(&beside).into_iter().map(|f| (f, region.outline(f))).collect();
        let thin = outlines.values().filter(|o| o.is_corner.iter().filter(|c| **c).count() < 3);
        let whole: BTreeSet<u32> = thin.flat_map(|o| o.vertices.iter().copied()).collect();
        let (mut corners, mut neighbours) = (BTreeMap::new(), BTreeMap::new());
        for (&facet, outline) in outlines.iter().filter(|(f, _)| beside.contains(f)) {
            let FacetOutline { half_edges, vertices, is_corner } = outline;
            let all = half_edges.iter().zip(vertices).zip(is_corner);
            let kept = all.filter(|((_, v), is_corner)| **is_corner || whole.contains(v));
            let (own, facets) = kept
                .map(|((&h, &v), _)| {
                    (HullVertexId(v), FacetId(across(region.surface, region.facet_of, h)))
                })
                .unzip();
            corners.insert(facet, own);
            neighbours.insert(facet, facets);
        }
        let count = region.rows[0].len() - 1;
        if numbering.is_same() {
            let (_, corners) = overwritten(self.starts.clone(), self.corners, count, &corners);
            let (starts, neighbours) =
                overwritten(self.starts, self.neighbours, count, &neighbours);
            return Self { starts, corners, neighbours };
        }
        let map = |v: HullVertexId| HullVertexId(numbering.of_vertex(v.0));
        let (_, corners) = replaced(&self.starts, &self.corners, count, &corners, map);
        let (starts, neighbours) = overwritten(self.starts, self.neighbours, count, &neighbours);
        Self { starts, corners, neighbours }
    }

    pub(super) fn of(&self, facet: FacetId) -> (&[HullVertexId], &[FacetId]) {
        let row = row(&self.starts, facet.index());
        (&self.corners[row.clone()], &self.neighbours[row])
    }
}

/// A surface with facets, of which some are looked at.
pub(super) struct Region<'a> {
    pub(super) positions: &'a [DVec3],
    pub(super) surface: &'a HullSurface,
    /// A half-edge that starts at each vertex.
    pub(super) leaving: &'a [u32],
    pub(super) facet_of: &'a [u32],
    /// The triangles of each facet, in compressed rows.
    pub(super) rows: [&'a [u32]; 2],
    pub(super) tolerance: f64,
}

/// The whole outline of a facet.
struct FacetOutline {
    half_edges: Vec<u32>,
    /// Where each of them begins.
    vertices: Vec<u32>,
    /// Whether that is a corner, be the facet thin or not.
    is_corner: Vec<bool>,
}

impl Region<'_> {
    fn triangles(&self, facet: u32) -> &[u32] {
        let [starts, triangles] = self.rows;
        &triangles[row(starts, facet as usize)]
    }

    /// Some facets and all that share a vertex with one of them.
    fn around(&self, facets: &BTreeSet<u32>) -> BTreeSet<u32> {
        let triangles = facets.iter().flat_map(|&f| self.triangles(f));
        let corners: BTreeSet<u32> =
            triangles.flat_map(|&t| self.surface.triangles[t as usize]).collect();
        let spokes = corners.iter().flat_map(|&v| self.surface.spokes(self.leaving[v as usize]));
        spokes.map(|h| self.facet_of[h as usize / 3]).collect()
    }

    fn outline(&self, facet: u32) -> FacetOutline {
        let (mut half_edges, mut vertices) = (Vec::new(), Vec::new());
        walk(self.surface, self.facet_of, self.triangles(facet), &mut half_edges, &mut vertices);
        let mut is_corner: Vec<bool> = vertices.iter().map(|&v| self.is_meeting_point(v)).collect();
        let mut corners = BTreeSet::new();
        let chains = chains(&vertices, |i| is_corner[i]);
        if !is_corner.contains(&true) {
            corners.extend(chains.first().map(|chain| chain.vertices[0]));
        }
        for chain in chains {
            keep_bends(&chain.vertices, self.positions, self.tolerance, |v| {
                corners.insert(v);
            });
        }
        for (v, is_corner) in vertices.iter().zip(&mut is_corner) {
            *is_corner |= corners.contains(v);
        }
        FacetOutline { half_edges, vertices, is_corner }
    }

    /// Whether three or more facets meet at a vertex.
    fn is_meeting_point(&self, v: u32) -> bool {
        let facet = |h: u32| self.facet_of[h as usize / 3];
        let between = |h: &u32| facet(*h) != across(self.surface, self.facet_of, *h);
        self.surface.spokes(self.leaving[v as usize]).filter(between).nth(2).is_some()
    }
}

/// The facet on the other side of a half-edge.
fn across(surface: &HullSurface, facet_of: &[u32], half_edge: u32) -> u32 {
    facet_of[surface.twins[half_edge as usize] as usize / 3]
}

/// The boundary half-edges of each facet, in order: one loop each, for facets are disks. Each
/// begins with the lowest.
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
        surface: &HullSurface,
        facet_of: &'a [u32],
        facets: impl ExactSizeIterator<Item = &'t [u32]>,
    ) -> Self {
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
            walk(surface, facet_of, triangles, &mut loops.half_edges, &mut loops.vertices);
            loops.starts.push(loops.half_edges.len() as u32);
        }
        loops
    }

    /// The half-edges around a facet, and where each begins.
    fn of(&self, facet: usize) -> (&[u32], &[u32]) {
        let row = row(&self.starts, facet);
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
        surface: &HullSurface,
        positions: &[DVec3],
        tolerance: f64,
        is_corner: &mut [bool],
    ) {
        let (outline, vertices) = self.of(facet);
        if vertices.iter().all(|&v| is_corner[v as usize]) {
            return;
        }
        let chains = chains(vertices, |i| is_corner[vertices[i] as usize]);
        if !vertices.iter().any(|&v| is_corner[v as usize]) {
            // A closed chain.
            chains.iter().for_each(|chain| is_corner[chain.vertices[0] as usize] = true);
        }
        for Chain { first, vertices } in chains {
            if across(surface, self.facet_of, outline[first]) as usize > facet {
                keep_bends(&vertices, positions, tolerance, |v| is_corner[v as usize] = true);
            }
        }
    }
}

/// A part of an outline between two corners.
struct Chain {
    /// Where in the outline its first edge stands.
    first: usize,
    /// From the end with the lower vertex, whichever way the outline runs: so both facets beside it
    /// see the same.
    vertices: Vec<u32>,
}

/// The chains of an outline that have vertices between their ends; one that is closed, if the
/// outline has no corner, starts at its lowest vertex.
fn chains(outline: &[u32], is_corner: impl Fn(usize) -> bool) -> Vec<Chain> {
    let count = outline.len();
    let mut anchors: Vec<usize> = (0..count).filter(|&i| is_corner(i)).collect();
    if anchors.is_empty() {
        anchors.extend((0..count).min_by_key(|&i| outline[i]));
    }
    let mut chains = Vec::new();
    for (i, &first) in anchors.iter().enumerate() {
        let to = anchors.get(i + 1).copied().unwrap_or(anchors[0] + count);
        if to == first + 1 {
            continue;
        }
        let mut vertices: Vec<u32> = (first..=to).map(|k| outline[k % count]).collect();
        let ends = [[vertices[0], vertices[1]], [outline[to % count], outline[(to - 1) % count]]];
        if ends[1] < ends[0] {
            vertices.reverse();
        }
        chains.push(Chain { first, vertices });
    }
    chains
}

/// Appends the half-edges around a facet of some triangles, and where each begins.
fn walk(
    surface: &HullSurface,
    facet_of: &[u32],
    triangles: &[u32],
    half_edges: &mut Vec<u32>,
    vertices: &mut Vec<u32>,
) {
    let is_boundary = |h: u32| facet_of[h as usize / 3] != across(surface, facet_of, h);
    let own = triangles.iter().flat_map(|&t| 3 * t..3 * t + 3);
    let Some(start) = own.into_iter().find(|&h| is_boundary(h)) else { return };
    let mut h = start;
    // Each half-edge of the facet is come by once. Were signs not exact, the triangles might not
    // make a surface.
    let mut left = 3 * triangles.len();
    let mut follow = |h: u32| {
        assert!(left > 0, "the outline of a facet of {} triangles does not end", triangles.len());
        left -= 1;
        next(h)
    };
    loop {
        half_edges.push(h);
        vertices.push(surface.origin(h));
        h = follow(h);
        while !is_boundary(h) {
            h = follow(surface.twins[h as usize]);
        }
        if h == start {
            break;
        }
    }
}

/// Douglas and Peucker: marks vertices so that every other lies within the tolerance of the segment
/// between the marked ones beside it. The ends are taken as marked.
fn keep_bends(chain: &[u32], positions: &[DVec3], tolerance: f64, mut mark: impl FnMut(u32)) {
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
            mark(chain[i]);
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
