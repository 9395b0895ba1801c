//! A hull whose surface was built anew, where it could not be repaired: what both surfaces have
//! stays what it was.
//!
//! Whatever follows a hull follows its new triangles. So triangles of the new surface that the one
//! before has too, with corners that have not moved, keep their numbers, and only the others are
//! exchanged.
//!
//! Source: none. Cost: O(n log n).

use super::super::quickhull::HullSurface;
use super::HullRepair;
use crate::ids::VertexId;

impl HullRepair<'_> {
    /// Exchanges the surface, to which nothing has been done yet, for another one, over the points;
    /// `moved`, ascending, are elsewhere than when it was made. `None` where the inner point is not
    /// within the new one.
    pub(in crate::hull) fn exchange(
        &mut self,
        surface: &HullSurface,
        moved: &[VertexId],
    ) -> Option<()> {
        let number = |repair: &mut Self, point: u32| {
            let stays = moved.binary_search(&VertexId(point)).is_err();
            let known = repair.known(VertexId(point)).filter(|_| stays);
            known.unwrap_or_else(|| repair.entered(point))
        };
        let mut new: Vec<[u32; 3]> =
            surface.triangles.iter().map(|t| t.map(|point| number(self, point))).collect();
        // Both are in the one form, so a triangle of both is written the same way.
        let mut old: Vec<([u32; 3], u32)> =
            (0..).zip(&self.surface.triangles).map(|(t, &corners)| (corners, t)).collect();
        old.sort_unstable();
        let mut is_kept = vec![false; old.len()];
        new.retain(|&corners| {
            let place = old.binary_search_by_key(&corners, |o| o.0);
            place.map(|i| is_kept[old[i].1 as usize] = true).is_err()
        });
        let is_gone = |t: u32| !is_kept[t as usize];
        let gone: Vec<u32> = (0..old.len() as u32).filter(|&t| is_gone(t)).collect();
        let rim = self.edges_around(gone.iter().copied(), is_gone);
        gone.into_iter().for_each(|t| self.kill(t));
        self.leaving = self.surface.leaving(self.sources.len());
        self.fill(&rim, &new)
    }
}
