//! Facets of a hull that was repaired, within the same box: those around which nothing is new keep their planes and
//! their numbers, the others grow again from what is left.
//!
//! A facet stays if all its triangles are there, no corner of one is a corner of a new triangle, and every new vertex
//! is certainly below its plane. New facets take the numbers of those that are gone; where fewer are new, the last
//! ones take the numbers that are free.
//!
//! No source: this crate's own, and right because a plane that every new vertex is below supports the new hull as it did
//! the old one. Cost: what grows again and what borders on it, a comparison for each plane, and copying.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{Aabb, DVec3};

use super::facets::{FacetLayer, Growth, Plane, UNASSIGNED};
use super::outline::Region;
use super::repair::Repaired;
use super::shapes::Shapes;
use super::support::SupportGraph;
use super::update::FacetChange;
use crate::rows::{closing_ranks, overwritten};

impl FacetLayer {
    /// The facets of a repaired surface; `touched` are the corners of new triangles, ascending. Also which facets are
    /// others, and how many triangles were not kept.
    pub(super) fn followed(
        self,
        repaired: &Repaired,
        touched: &[u32],
        graph: &SupportGraph,
        bounds: &Aabb,
    ) -> (Self, FacetChange, usize) {
        let Repaired { positions, surface, leaving, numbering, new, fresh, dead, moved, .. } =
            repaired;
        let Self { tolerance, planes, facet_of, triangle_starts, triangles, outlines } = self;
        let before = planes.len();
        let mut gone: BTreeSet<u32> = dead.iter().map(|&t| facet_of[t as usize]).collect();
        let mut renamed = BTreeSet::new();
        let mut now = facet_of;
        let names: Vec<(u32, u32)> =
            moved.iter().map(|(&from, &to)| (to, now[from as usize])).collect();
        now.resize(surface.triangles.len(), UNASSIGNED);
        for (t, facet) in names {
            now[t as usize] = facet;
            renamed.insert(facet);
        }
        fresh.iter().for_each(|&t| now[t as usize] = UNASSIGNED);
        let around = touched.iter().flat_map(|&v| surface.spokes(leaving[v as usize]));
        let disturbed = around.map(|h| now[h as usize / 3]).filter(|&f| f != UNASSIGNED);
        gone.extend(disturbed);
        let places: Vec<DVec3> = new.iter().map(|&v| positions[v as usize]).collect();
        let fresh_vertices =
            Vertices { bounds: Aabb::of_points(places.iter().copied()), places, graph };
        gone.extend(
            (0..).zip(&planes).filter(|(_, p)| !fresh_vertices.are_beneath(p)).map(|(f, _)| f),
        );
        let row = |f: u32| {
            let row =
                triangle_starts[f as usize] as usize..triangle_starts[f as usize + 1] as usize;
            let there = triangles[row].iter().filter(|t| dead.binary_search(t).is_err());
            there.map(|t| moved.get(t).copied().unwrap_or(*t))
        };
        let mut left: Vec<u32> =
            gone.iter().flat_map(|&f| row(f)).chain(fresh.iter().copied()).collect();
        left.sort_unstable();
        left.iter().for_each(|&t| now[t as usize] = UNASSIGNED);
        let shapes = Shapes::of_some(positions, surface, tolerance, &left);
        let mut growth =
            Growth::new(positions, surface, graph, tolerance, shapes, now, planes, bounds);
        growth.run(left.iter().copied());
        let Growth { facet_of: mut now, mut planes, .. } = growth;

        let free: Vec<u32> = gone.iter().copied().collect();
        let grown: Vec<u32> = (before as u32..planes.len() as u32).collect();
        let count = before + grown.len() - free.len();
        let mut changed: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &t in &left {
            changed.entry(now[t as usize]).or_default().push(t);
        }
        for facet in renamed.into_iter().filter(|f| !gone.contains(f)) {
            changed.insert(facet, sorted(row(facet)));
        }
        let moves = closing_ranks(before as u32, &free, &grown);
        let mut change = FacetChange { gone: free, fresh: Vec::new() };
        let contents: Vec<(u32, u32, Plane)> =
            moves.iter().map(|&(from, to)| (from, to, planes[from as usize])).collect();
        for (from, to, plane) in contents {
            let own = changed.remove(&from).unwrap_or_else(|| sorted(row(from)));
            own.iter().for_each(|&t| now[t as usize] = to);
            planes[to as usize] = plane;
            changed.insert(to, own);
            change.fresh.push(to);
            if from < before as u32 {
                change.gone.push(from);
            }
        }
        planes.truncate(count);
        change.gone.sort_unstable();
        change.fresh.sort_unstable();
        let (triangle_starts, triangles) = overwritten(triangle_starts, triangles, count, &changed);
        let rows = [&*triangle_starts, &*triangles];
        let region = Region { positions, surface, leaving, facet_of: &now, rows, tolerance };
        let outlines = outlines.followed(&region, numbering, &change.fresh);
        let layer = Self { tolerance, planes, facet_of: now, triangle_starts, triangles, outlines };
        (layer, change, left.len())
    }
}

fn sorted(members: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut all: Vec<u32> = members.collect();
    all.sort_unstable();
    all
}

/// Vertices that are new.
struct Vertices<'a> {
    bounds: Aabb,
    places: Vec<DVec3>,
    graph: &'a SupportGraph,
}

impl Vertices<'_> {
    /// Whether they are certainly below a plane.
    fn are_beneath(&self, plane: &Plane) -> bool {
        let most = plane.offset - self.graph.rounding(plane.normal);
        let highest = (plane.normal * self.bounds.min).max(plane.normal * self.bounds.max);
        // Sums and products round monotonically: no height is above that of the box.
        highest.x + highest.y + highest.z <= most
            || self.places.iter().all(|&p| plane.normal.dot(p) <= most)
    }
}
