//! What is wrong with caps, as findings.

use cranny_exact::DVec3;

use super::CapSurface;
use crate::hull::{ConvexHull, FacetId};
use crate::ids::VertexId;
use crate::mesh::Mesh;
use crate::report::{Finding, FindingKind};

impl CapSurface {
    /// A finding for each facet with negative caps, and for each that is crossed. O(n).
    pub(crate) fn findings(&self, mesh: &Mesh, hull: &ConvexHull) -> Vec<Finding> {
        let of_one_facet = self.negative.chunk_by(|&a, &b| self.facet_of(a) == self.facet_of(b));
        let negative = of_one_facet.map(|caps| {
            let corners = caps.iter().map(|cap| self.triangles[cap.index()]);
            let area = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|v| mesh.position(VertexId(v)));
                0.5 * (b - a).cross(c - a).length()
            };
            let measure = corners.clone().map(area).sum();
            finding(FindingKind::NegativeCap, corners.flatten().collect(), mesh, measure)
        });
        let crossed = self.crossed.iter().map(|&facet: &FacetId| {
            let facet = hull.facet(facet);
            let corners = facet.corners.iter().map(|&v| hull.source(v).0).collect();
            finding(FindingKind::CrossedCap, corners, mesh, facet.thickness.max(hull.flatness()))
        });
        negative.chain(crossed).collect()
    }
}

fn finding(kind: FindingKind, mut ids: Vec<u32>, mesh: &Mesh, measure: f64) -> Finding {
    ids.sort_unstable();
    ids.dedup();
    let sum: DVec3 = ids.iter().map(|&v| mesh.position(VertexId(v))).sum();
    Finding { kind, at: sum / ids.len().max(1) as f64, ids, measure, count: 1 }
}
