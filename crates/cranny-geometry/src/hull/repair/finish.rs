//! What a repair leaves: whether it is sound, the one form that its points decide, triangles that
//! fill the gaps, vertices numbered by their points.
//!
//! Source: none. Cost: that of what is new, and copying; where vertices come or go, all corners are
//! renamed.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{DVec3, Sign};

use super::super::canonical::halved;
use super::super::numbering::Numbering;
use super::super::quickhull::{HullSurface, previous};
use super::{HullRepair, NONE};
use crate::ids::VertexId;
use crate::projection::collinear;
use crate::rows::compaction_moves;

/// A surface that follows another one. Triangles that are there still have the numbers that they
/// had, but for those that fill gaps.
pub(in crate::hull) struct Repaired {
    pub(in crate::hull) sources: Vec<VertexId>,
    pub(in crate::hull) positions: Vec<DVec3>,
    pub(in crate::hull) surface: HullSurface,
    pub(in crate::hull) leaving: Vec<u32>,
    pub(in crate::hull) numbering: Numbering,
    /// Vertices that have moved or come.
    pub(in crate::hull) new: Vec<u32>,
    /// Where vertices were that have moved or gone.
    pub(in crate::hull) lost: Vec<DVec3>,
    /// Triangles that are new, by their numbers now, ascending.
    pub(in crate::hull) fresh: Vec<u32>,
    /// Triangles that are gone, by their numbers before, ascending.
    pub(in crate::hull) dead: Vec<u32>,
    /// Triangles that have another number, before and now.
    pub(in crate::hull) moved: BTreeMap<u32, u32>,
}

impl HullRepair<'_> {
    /// The triangles that are new, ascending.
    fn made(&self) -> Vec<u32> {
        (self.first_new..self.surface.triangles.len() as u32)
            .filter(|&t| self.is_alive(t))
            .collect()
    }

    /// The surface, which [is sound](Self::is_sound).
    pub(in crate::hull) fn finish(mut self) -> Repaired {
        let alive = self.made();
        let mut dead: Vec<u32> = self.dead.iter().map(|d| d.0).collect();
        dead.retain(|&t| t < self.first_new);
        dead.sort_unstable();
        let moves = compaction_moves(self.first_new, &dead, &alive);
        self.close_ranks(&moves, self.first_new as usize + alive.len() - dead.len());
        let (made, old): (Vec<_>, Vec<_>) =
            moves.into_iter().partition(|&(from, _)| from >= self.first_new);
        let mut fresh: Vec<u32> = made.into_iter().map(|(_, to)| to).collect();
        fresh.sort_unstable();
        let gone = self.gone();
        let lost = gone.iter().map(|&v| self.at(v)).collect();
        let (numbering, new) = self.number(&fresh, gone);
        Repaired {
            sources: self.sources,
            positions: self.positions,
            surface: self.surface,
            leaving: self.leaving,
            numbering,
            new,
            lost,
            fresh,
            dead,
            moved: old.into_iter().collect(),
        }
    }

    /// Whether new triangles have an area, and around their corners every edge is convex or flat
    /// and every vertex extreme: then the vertices are exactly the extreme points.
    pub(in crate::hull) fn is_sound(&self) -> bool {
        let new = self.made();
        let touched: BTreeSet<u32> =
            new.iter().flat_map(|&t| self.surface.triangles[t as usize]).collect();
        let is_extreme = |&v: &u32| {
            let mut convex = 0;
            for h in self.surface.spokes(self.leaving[v as usize]) {
                let apex = self.surface.origin(previous(self.surface.twins[h as usize]));
                match self.side_of(self.surface.triangles[h as usize / 3], self.at(apex)) {
                    Sign::Positive => return false,
                    Sign::Negative => convex += 1,
                    Sign::Zero => {}
                }
            }
            convex >= 3
        };
        let is_flat = |&t: &u32| {
            let [a, b, c] = self.surface.triangles[t as usize].map(|v| self.at(v));
            collinear(a, b, c)
        };
        touched.iter().all(is_extreme) && !new.iter().any(is_flat)
    }

    /// Brings the surface, which [is sound](Self::is_sound), into the [one
    /// form](super::super::canonical) that its points decide. `None` where that cannot be done.
    pub(in crate::hull) fn make_canonical(&mut self) -> Option<()> {
        let mut left: BTreeSet<u32> = self.made().into_iter().collect();
        while let Some(t) = left.pop_first() {
            let polygon = self.facets_of(vec![t]);
            if polygon.len() == 1 {
                continue;
            }
            let mut rim = self.rim_of(&polygon)?;
            let lowest = (0..rim.len()).min_by_key(|&i| self.sources[rim[i].0 as usize])?;
            rim.rotate_left(lowest);
            let corners = |[i, m, k]: [u32; 3]| [i, m, k].map(|c| rim[c as usize].0);
            let form: Vec<[u32; 3]> =
                halved(rim.len() as u32).map(|t| self.lowest_first(corners(t))).collect();
            let own: BTreeSet<[u32; 3]> =
                polygon.iter().map(|&t| self.surface.triangles[t as usize]).collect();
            let is_so = form.len() == own.len() && form.iter().all(|t| own.contains(t));
            polygon.iter().for_each(|t| {
                left.remove(t);
            });
            if !is_so {
                polygon.into_iter().for_each(|t| self.kill(t));
                self.fill(&rim, &form)?;
            }
        }
        Some(())
    }

    /// Moves triangles to the places of those that are gone; `count` are left.
    fn close_ranks(&mut self, moves: &[(u32, u32)], count: usize) {
        let places: BTreeMap<u32, u32> = moves.iter().copied().collect();
        let moved = |h: u32| places.get(&(h / 3)).map(|to| 3 * to + h % 3);
        let twins_of =
            |t: u32| [3 * t, 3 * t + 1, 3 * t + 2].map(|h| self.surface.twins[h as usize]);
        let contents: Vec<(u32, [u32; 3], [u32; 3])> = moves
            .iter()
            .map(|&(from, to)| (to, self.surface.triangles[from as usize], twins_of(from)))
            .collect();
        for (to, corners, twins) in contents {
            self.surface.triangles[to as usize] = corners;
            for (h, (corner, twin)) in (3 * to..).zip(corners.into_iter().zip(twins)) {
                let place = moved(twin);
                self.surface.twins[h as usize] = place.unwrap_or(twin);
                if place.is_none() {
                    self.surface.twins[twin as usize] = h;
                }
                self.leaving[corner as usize] = h;
            }
        }
        self.surface.triangles.truncate(count);
        self.surface.twins.truncate(3 * count);
    }

    /// Vertices of the hull before that are none where they were.
    fn gone(&self) -> BTreeSet<u32> {
        let corners = self.dead.iter().flat_map(|&(_, corners)| corners);
        let is_gone = |v: &u32| (*v as usize) < self.known && self.leaving[*v as usize] == NONE;
        corners.filter(is_gone).collect()
    }

    /// Numbers vertices by their points; `fresh` are the triangles that have new vertices, which
    /// are returned too, and `gone` the vertices that [are](Self::gone).
    fn number(&mut self, fresh: &[u32], mut gone: BTreeSet<u32>) -> (Numbering, Vec<u32>) {
        let mut come = Vec::new();
        let mut back = BTreeMap::new();
        for v in self.known as u32..self.sources.len() as u32 {
            if self.leaving[v as usize] == NONE {
                continue;
            }
            // A vertex that has moved and is one again.
            match self.known(self.sources[v as usize]).filter(|old| gone.remove(old)) {
                Some(old) => {
                    self.positions[old as usize] = self.positions[v as usize];
                    self.leaving[old as usize] = self.leaving[v as usize];
                    back.insert(v, old);
                }
                None => come.push(v),
            }
        }
        come.sort_unstable_by_key(|&v| self.sources[v as usize]);
        for corner in fresh.iter().flat_map(|&t| 3 * t..3 * t + 3) {
            let corner = &mut self.surface.triangles[corner as usize / 3][corner as usize % 3];
            *corner = back.get(corner).copied().unwrap_or(*corner);
        }
        let numbering = Numbering::of(&self.sources, self.known, &gone, &come);
        if !numbering.is_same() {
            numbering.apply(&mut self.surface.triangles);
        }
        self.sources = numbering.arranged(std::mem::take(&mut self.sources));
        self.positions = numbering.arranged(std::mem::take(&mut self.positions));
        self.leaving = numbering.arranged(std::mem::take(&mut self.leaving));
        let new = come.into_iter().chain(back.into_values());
        let new = new.map(|v| numbering.of_vertex(v)).collect();
        (numbering, new)
    }
}
