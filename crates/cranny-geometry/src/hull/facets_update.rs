//! Facets of a hull that was repaired, within the same box: those around which nothing is new keep
//! their planes and their numbers, the others grow again, and come out as if the hull had been
//! built.
//!
//! Facets never grow over an edge that bends clearly. So triangles that hang together over other
//! edges share facets with no others, and which facets they make does not depend on these. They are
//! grown again together where one of them is new, has a corner of a new one, or has a facet that
//! lost a triangle, that is not certainly above every new vertex or that a lost vertex may have
//! held up. New facets take the numbers of those that are gone; where fewer are new, the last ones
//! take the numbers that are free.
//!
//! No source: this crate's own, and right because a plane that every new vertex is below supports
//! the new hull as it did the old one. Cost: what grows again and what borders on it, a comparison
//! for each plane, and copying. What hangs together is next to nothing but facets of one plane,
//! unless the body is flat nearly everywhere.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{Aabb, DVec3};

use super::facets::{FacetLayer, Growth, Plane, UNASSIGNED};
use super::outline::Region;
use super::repair::Repaired;
use super::shapes::{Shapes, bends_clearly};
use super::support::SupportGraph;
use super::update::FacetChange;
use crate::rows::{compaction_moves, overwritten, row};

impl FacetLayer {
    /// The facets of a repaired surface; `touched` are the corners of new triangles, ascending.
    /// Also which facets are others, and how many triangles were not kept.
    pub(super) fn followed(
        self,
        repaired: &Repaired,
        touched: &[u32],
        graph: &SupportGraph,
        bounds: &Aabb,
    ) -> (Self, FacetChange, usize) {
        let Repaired {
            positions, surface, leaving, numbering, new, lost, fresh, dead, moved, ..
        } = repaired;
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
        let places = new.iter().map(|&v| positions[v as usize]).collect();
        let new = Vertices::at(places, graph);
        let lost = Vertices::at(lost.clone(), graph);
        // One look at a plane decides nearly always.
        let both = Aabb::of_points(new.places.iter().chain(&lost.places).copied());
        let is_free = |p: &Plane| {
            is_below(&both, p, HELD_UP * graph.rounding(p.normal))
                || (new.are_below(p, 1.0) && lost.are_below(p, HELD_UP))
        };
        gone.extend((0..).zip(&planes).filter(|(_, p)| !is_free(p)).map(|(f, _)| f));
        let row = |f: u32| {
            let there = triangles[row(&triangle_starts, f as usize)]
                .iter()
                .filter(|t| dead.binary_search(t).is_err());
            there.map(|t| moved.get(t).copied().unwrap_or(*t))
        };
        let first = gone.iter().flat_map(|&f| row(f)).chain(fresh.iter().copied()).collect();
        let is_open = |h: u32| !bends_clearly(positions, surface, tolerance, h);
        let left: Vec<u32> = surface.hanging_together(first, is_open).into_iter().collect();
        gone.extend(left.iter().map(|&t| now[t as usize]).filter(|&f| f != UNASSIGNED));
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
        let moves = compaction_moves(before as u32, &free, &grown);
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

/// Of the rounding of heights, how far a vertex that holds a plane up may be below it: one is what
/// the plane was raised by, and one the rounding of that. Smaller, and a plane stays up when what
/// held it is gone; larger, and a few facets more grow again.
const HELD_UP: f64 = 3.0;

/// Vertices that are new, or lost.
struct Vertices<'a> {
    bounds: Aabb,
    places: Vec<DVec3>,
    graph: &'a SupportGraph,
}

impl<'a> Vertices<'a> {
    fn at(places: Vec<DVec3>, graph: &'a SupportGraph) -> Self {
        Self { bounds: Aabb::of_points(places.iter().copied()), places, graph }
    }

    /// Whether they are below a plane by so many roundings of their heights.
    fn are_below(&self, plane: &Plane, roundings: f64) -> bool {
        let depth = roundings * self.graph.rounding(plane.normal);
        let is_deep = |&p: &DVec3| plane.normal.dot(p) <= plane.offset - depth;
        self.places.is_empty()
            || is_below(&self.bounds, plane, depth)
            || self.places.iter().all(is_deep)
    }
}

/// Whether all points of a box are so deep below a plane.
fn is_below(bounds: &Aabb, plane: &Plane, depth: f64) -> bool {
    let highest = (plane.normal * bounds.min).max(plane.normal * bounds.max);
    // Sums and products round monotonically: no height is above that of the box.
    highest.x + highest.y + highest.z <= plane.offset - depth
}
