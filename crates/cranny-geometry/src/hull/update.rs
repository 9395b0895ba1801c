//! A hull after some of its points have moved.
//!
//! The exact surface is [repaired](super::repair) where it can be, else exchanged, and facets keep
//! their planes where nothing around them is new: all their triangles are there, and all triangles
//! at their corners. The others grow again from what is left. That holds as long as the box of the
//! hull is the same, for the tolerance of merging, and what rounding may do, follow it; a new box
//! means new planes.
//!
//! Source: that of the repair; to keep planes is this crate's own. It is right because new vertices
//! are held against each plane that is kept, so it still has every vertex below it. Cost: with the
//! function.

use cranny_exact::{Aabb, DVec3};

use super::facets::FacetLayer;
use super::quickhull::hull_of_some;
use super::repair::{HullRepair, Repaired};
use super::support::SupportGraph;
use super::{ConvexHull, HullKind, Leaving};
use crate::each_once::each_once;
use crate::ids::VertexId;
use crate::on_demand::OnDemand;

/// A hull that follows another one.
pub(crate) struct Followed {
    pub(crate) hull: ConvexHull,
    pub(crate) facets: FacetChange,
    /// Triangles that are new or have another number; all, if it could be neither repaired nor
    /// exchanged.
    pub(crate) triangles: Vec<u32>,
    /// Number of triangles whose planes were measured.
    pub(crate) measured: usize,
    /// A point certainly in the interior, if one is known.
    pub(crate) inside: Option<DVec3>,
}

/// Which facets are others. All those that are named in neither list are the same triangles in the
/// same plane, and have their number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FacetChange {
    /// Facets before whose number means no facet, or another one; ascending.
    pub gone: Vec<u32>,
    /// Facets now that are new, or have another number; ascending.
    pub fresh: Vec<u32>,
}

impl FacetChange {
    fn of_all(before: usize, now: usize) -> Self {
        Self { gone: (0..before as u32).collect(), fresh: (0..now as u32).collect() }
    }
}

impl ConvexHull {
    /// The hull of `points`, of which those in `moved`, ascending, were elsewhere when this hull
    /// was built. `near` names the points that lie in a box, in any order; `inside` is certainly in
    /// the interior of this hull.
    ///
    /// Cost: O(m log m) for the m triangles and points around those that moved in or out; a look at
    /// the plane of each facet, and copying. Where vertices come or go, all corners are renamed.
    /// O(n log n) where the surface cannot be repaired; where the box is another, O(n) for facets.
    pub(crate) fn followed(
        mut self,
        points: &[DVec3],
        moved: &[VertexId],
        inside: Option<DVec3>,
        flatness: f64,
        near: impl Fn(&Aabb) -> Vec<VertexId>,
    ) -> Followed {
        let before = self.facet_count();
        let bounds = self.bounds();
        let kind = HullKind::Volume;
        let facets = std::mem::take(&mut self.facets);
        let graph = std::mem::take(&mut self.graph)
            .into_made(|| SupportGraph::new(&self.positions, &self.surface));
        let repaired = inside.filter(|_| self.kind == kind);
        let repaired = repaired.and_then(|inside| self.repaired(points, moved, inside, near));
        let Some(repaired) = repaired else {
            let hull = Self::with_flatness(points, flatness);
            let (measured, inside) = (hull.triangle_count(), hull.inner_point());
            let facets = FacetChange::of_all(before, hull.facet_count());
            let triangles = (0..measured as u32).collect();
            return Followed { hull, facets, triangles, measured, inside };
        };
        let Repaired { positions, surface, leaving, numbering, fresh, .. } = &repaired;
        let touched = each_once(fresh.iter().flat_map(|&t| surface.triangles[t as usize]));
        let new_bounds = Aabb::of_points(positions.iter().copied());
        let same_box = new_bounds == bounds;
        let graph =
            graph.followed(positions, surface, leaving, numbering, &touched, &bounds, same_box);
        let (facets, change, measured) = if same_box {
            facets.followed(&repaired, &touched, &graph, &bounds)
        } else {
            let facets = FacetLayer::new(kind, positions, surface, &graph, flatness);
            let change = FacetChange::of_all(before, facets.len());
            (facets, change, surface.triangles.len())
        };
        let Repaired { sources, positions, surface, leaving, fresh, moved, .. } = repaired;
        let triangles = fresh.into_iter().chain(moved.into_values()).collect();
        let hull = Self {
            kind,
            sources,
            positions,
            surface,
            graph: OnDemand::made(graph),
            leaving: Leaving(OnDemand::made(leaving)),
            facets,
            bounds: OnDemand::made(new_bounds),
            excluded: Vec::new(),
        };
        Followed { hull, facets: change, triangles, measured, inside }
    }

    fn repaired(
        self,
        points: &[DVec3],
        moved: &[VertexId],
        inside: DVec3,
        near: impl Fn(&Aabb) -> Vec<VertexId>,
    ) -> Option<Repaired> {
        let mut repair = HullRepair::new(points, self, inside);
        let mut is_repaired = repair.move_points(moved, near).is_some() && repair.is_sound();
        is_repaired = is_repaired && repair.make_canonical().is_some();
        if !is_repaired {
            repair.undo();
            repair.exchange(&hull_of_some(points)?, moved)?;
            if !repair.is_sound() {
                return None;
            }
        }
        Some(repair.finish())
    }
}

#[cfg(test)]
mod tests;
