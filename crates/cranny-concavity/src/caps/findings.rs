//! What is wrong with caps, as findings.
//!
//! Strips no wider than a slab is deep are rounding, as skin is, and not reported.

use std::collections::BTreeSet;

use cranny_exact::DVec3;

use super::CapSurface;
use crate::ids::CapId;
use cranny_geometry::hull::{ConvexHull, Facet, FacetId, HullKind};
use cranny_geometry::{Finding, FindingKind, Mesh, Model, VertexId, each_once};

impl CapSurface {
    /// A finding for each facet with negative caps wider than `depth`, that of the slabs, for each
    /// group of facets with such caps that is crossed, and for a closed body that is no thicker
    /// than slabs. O(n), and the square of the facets reported.
    pub(crate) fn findings(&self, model: &Model, depth: f64) -> Vec<Finding> {
        let (mesh, hull) = (model.mesh(), model.hull());
        let wide: Vec<CapId> =
            self.negative.iter().copied().filter(|&cap| self.width(mesh, cap) > depth).collect();
        let mut findings: Vec<Finding> =
            thin_body(mesh, hull, depth).filter(|_| model.is_closed()).into_iter().collect();
        let mut facets = BTreeSet::new();
        for caps in wide.chunk_by(|&a, &b| self.facet_of(a) == self.facet_of(b)) {
            let corners = caps.iter().flat_map(|cap| self.triangles[cap.index()]).collect();
            let area = caps.iter().map(|&cap| 0.5 * self.twice_area(mesh, cap)).sum();
            findings.push(finding(FindingKind::NegativeCap, corners, mesh, area));
            facets.insert(self.facet_of(caps[0]));
        }
        let is_reported =
            |f: &FacetId| facets.contains(f) || self.sharing(*f).any(|g| facets.contains(&g));
        for &facet in self.crossed.iter().filter(|f| is_reported(f)) {
            let facet = hull.facet(facet);
            let corners = facet.corners.iter().map(|&v| hull.source(v).0).collect();
            let thickness = facet.thickness.max(hull.flatness());
            findings.push(finding(FindingKind::CrossedCap, corners, mesh, thickness));
        }
        findings
    }

    fn twice_area(&self, mesh: &Mesh, cap: CapId) -> f64 {
        let [a, b, c] = self.corners(mesh, cap);
        (b - a).cross(c - a).length()
    }

    /// How wide a triangle is across its longest side.
    fn width(&self, mesh: &Mesh, cap: CapId) -> f64 {
        let [a, b, c] = self.corners(mesh, cap);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        self.twice_area(mesh, cap) / longest
    }

    fn corners(&self, mesh: &Mesh, cap: CapId) -> [DVec3; 3] {
        self.triangles[cap.index()].map(|v| mesh.position(VertexId(v)))
    }
}

/// The finding of a body whose hull has a volume, but is as thin as that. A flat one has two sides,
/// and faces that look up lie on the upper one.
fn thin_body(mesh: &Mesh, hull: &ConvexHull, depth: f64) -> Option<Finding> {
    let (volume, area) = (hull.volume(), hull.area());
    if hull.kind() != HullKind::Volume || volume > depth * area {
        return None;
    }
    let size = |f: &Facet<'_>| {
        let corners = f.triangles.iter().map(|&t| hull.corners(t as usize));
        corners.map(|[a, b, c]| (b - a).cross(c - a).length()).sum::<f64>()
    };
    let largest = hull.facets().max_by(|f, g| size(f).total_cmp(&size(g)))?;
    let corners = largest.corners.iter().map(|&v| hull.source(v).0).collect();
    Some(finding(FindingKind::ThinBody, corners, mesh, volume / area))
}

fn finding(kind: FindingKind, ids: Vec<u32>, mesh: &Mesh, measure: f64) -> Finding {
    let ids = each_once(ids);
    let sum: DVec3 = ids.iter().map(|&v| mesh.position(VertexId(v))).sum();
    let at = sum / ids.len().max(1) as f64;
    Finding::one(kind, ids, at, measure)
}
