//! Supporting planes of facets, and how far facets reach below them, rounded outward.
//!
//! Source and cost: those of the merged layer.

use std::ops::Range;

use cranny_exact::DVec3;

use super::super::HullVertexId;
use super::super::shapes::longest_edge;
use super::super::side::Side;
use super::{Growth, Plane};

/// Neighbours of a triangle's corners, together, above which its plane is bounded instead of
/// measured. Smaller, and thicknesses are overestimated tenfold where they need not be; larger, and
/// fans take quadratic time (`wide_fans_take_no_quadratic_time`).
const CROWDED: usize = 256;

/// Lengths whose squares, and those of components that matter, neither vanish nor overflow: far
/// inside of what does.
const SQUARES: Range<f64> = 1e-100..1e100;

impl Growth<'_> {
    /// A unit normal of the triangle. One so thin that its area vanishes in `f64` leans as its
    /// neighbours do; if they vanish as well, it takes any direction across its longest edge.
    pub(super) fn normal_of(&self, t: u32) -> DVec3 {
        let around = || {
            (3 * t..3 * t + 3)
                .map(|h| self.triangles.area_vector(self.surface.twins[h as usize] / 3))
        };
        let at = |v: u32| self.positions[v as usize];
        unit_of_length(self.triangles.area_vector(t), self.triangles.area(t))
            .or_else(|| unit(around().sum()))
            .or_else(|| {
                let edge = longest_edge(self.surface.triangles[t as usize].map(at));
                [DVec3::X, DVec3::Y, DVec3::Z].into_iter().find_map(|axis| unit(edge.cross(axis)))
            })
            .unwrap_or(DVec3::Z)
    }

    /// The supporting plane of a facet of one triangle: the supporting plane of the hull along its
    /// normal, measured, or where a corner has very many neighbours, to look at all of which for
    /// every triangle of a fan takes quadratic time, a bound of it.
    ///
    /// The bound: every point `p` is exactly below the exact plane, and the rounded cross product
    /// `n` gives `n · (p − a) <= margin` in real arithmetic (see [`Side`]). Bringing `n` to length
    /// 1 scales that by `1 / |n|` and adds two roundings a component, less than an eighth of the
    /// margin.
    pub(super) fn plane_of_one(&self, t: u32, normal: DVec3) -> Plane {
        let mut corners = self.surface.triangles[t as usize];
        let degree: usize =
            corners.iter().map(|&v| self.graph.neighbours(HullVertexId(v)).len()).sum();
        if degree <= CROWDED {
            return self
                .plane_through_top(corners, normal)
                .unwrap_or_else(|| self.supporting_plane(normal, &[t]));
        }
        // The margin is least about the corner across from the longest edge.
        let at = |v: u32| self.positions[v as usize];
        let across = |k: usize| (at(corners[(k + 2) % 3]) - at(corners[(k + 1) % 3])).length();
        let anchor = (0..3).fold(0, |best, k| if across(k) > across(best) { k } else { best });
        corners.rotate_left(anchor);
        let side = Side::new(corners.map(at), self.extent);
        let margin = 1.25 * side.margin() / side.normal.length();
        let Some(normal) = unit(side.normal).filter(|_| margin.is_finite()) else {
            return self.supporting_plane(normal, &[t]);
        };
        let anchored = normal.dot(at(corners[0]));
        let offset = (anchored + 3.0 * self.graph.rounding(normal) + margin).next_up();
        Plane { normal, offset, thickness: self.thickness(normal, offset, &[t]) }
    }

    /// The supporting plane along `normal`, if the triangle's neighbourhood shows that the highest
    /// vertex of the hull is a corner of it: those corners that are as high as the top but for
    /// rounding have no other neighbour that is, so the search of [`SupportGraph::support`] would
    /// end with them.
    fn plane_through_top(&self, corners: [u32; 3], normal: DVec3) -> Option<Plane> {
        let height = |v: u32| normal.dot(self.positions[v as usize]);
        let heights = corners.map(height);
        let [a, b, c] = heights;
        let top = a.max(b).max(c);
        let rounding = self.graph.rounding(normal);
        let floor = top - 4.0 * rounding;
        let high_corners = heights.into_iter().filter(|&h| h >= floor).count();
        for (&corner, h) in corners.iter().zip(heights) {
            let ring = self.graph.neighbours(HullVertexId(corner));
            // The other corners are in the ring, once each.
            let high = |ring: &[HullVertexId]| ring.iter().filter(|v| height(v.0) >= floor).count();
            if h >= floor && high(ring) >= high_corners {
                return None;
            }
        }
        let lowest = a.min(b).min(c);
        let offset = (top + rounding).next_up();
        Some(Plane {
            normal,
            offset,
            thickness: (offset - (lowest - rounding).next_down()).next_up(),
        })
    }

    /// The supporting plane of the hull in a direction, and how far `region` reaches below it. All
    /// rounded outward by the proven rounding of the heights.
    pub(super) fn supporting_plane(&self, normal: DVec3, region: &[u32]) -> Plane {
        let height = |v: u32| normal.dot(self.positions[v as usize]);
        let start = region.first().map(|&t| HullVertexId(self.surface.triangles[t as usize][0]));
        let top = self.graph.support(self.positions, normal, start).map_or(0, |v| v.0);
        let rounding = self.graph.rounding(normal);
        let offset = (height(top) + rounding).next_up();
        Plane { normal, offset, thickness: self.thickness(normal, offset, region) }
    }

    /// How far `region` reaches below a plane, rounded up.
    fn thickness(&self, normal: DVec3, offset: f64, region: &[u32]) -> f64 {
        let lowest = region
            .iter()
            .flat_map(|&t| self.surface.triangles[t as usize])
            .fold(f64::INFINITY, |low, v| low.min(normal.dot(self.positions[v as usize])));
        (offset - (lowest - self.graph.rounding(normal)).next_down()).next_up()
    }
}

/// The vector at length 1; `None` where it has none to speak of.
pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    unit_of_length(v, v.length())
}

/// As [`unit`]; the length is known.
fn unit_of_length(v: DVec3, length: f64) -> Option<DVec3> {
    if SQUARES.contains(&length) {
        return Some(v / length);
    }
    let largest = v.abs().max_element();
    let scaled = v / largest;
    (largest > 0.0 && scaled.is_finite()).then(|| scaled / scaled.length())
}
