//! What of a convex hull lies foremost along a direction.

use cranny_exact::{Aabb, DVec3, RigidMap};
use cranny_geometry::hull::{ConvexHull, HullVertexId};

/// Vertices of a hull that are looked at in a layer, at most. Fewer: a facet with more corners is
/// left to the trees; more: time is lost over lids.
pub(super) const MOST_VERTICES: usize = 64;

/// What of a hull lies above a plane.
#[derive(Clone, Debug, Default)]
pub(super) struct Layer {
    /// The hull's greatest height.
    pub(super) top: f64,
    pub(super) floor: f64,
    /// The hull's vertices there.
    pub(super) vertices: Vec<HullVertexId>,
    /// These, and where the plane cuts edges that lead to them.
    pub(super) points: Vec<DVec3>,
}

impl Layer {
    /// Looks at the vertices around the top: what lies above a plane hangs together over the edges
    /// of a convex polytope. Whether these are few. `error` bounds how far heights are off.
    pub(super) fn fill(
        &mut self,
        hull: &ConvexHull,
        direction: DVec3,
        top: HullVertexId,
        floor: f64,
        error: f64,
    ) -> bool {
        (self.top, self.floor) = (direction.dot(hull.position(top)), floor);
        self.vertices.clear();
        self.points.clear();
        self.vertices.push(top);
        // Lower than needed: a vertex about as high as the floor is taken in, and the cuts
        // lie beyond those sought.
        let cut = floor - 2.0 * error;
        let mut next = 0;
        while let Some(&v) = self.vertices.get(next) {
            next += 1;
            let p = hull.position(v);
            let height = direction.dot(p);
            self.points.push(p);
            for &w in hull.neighbours(v) {
                let q = hull.position(w);
                let its = direction.dot(q);
                if its < cut {
                    self.points.push(p + (q - p) * ((height - cut) / (height - its)));
                } else if !self.vertices.contains(&w) {
                    if self.vertices.len() == MOST_VERTICES {
                        return false;
                    }
                    self.vertices.push(w);
                }
            }
        }
        true
    }

    /// The box around it, in another frame.
    pub(super) fn bounds(&self, map: &RigidMap) -> Aabb {
        Aabb::of_points(self.points.iter().map(|p| map.apply(*p)))
    }

    pub(super) fn bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<HullVertexId>()
            + self.points.capacity() * size_of::<DVec3>()
    }
}
