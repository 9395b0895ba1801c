//! Which caps without faces beneath are skin, and which an opening.
//!
//! No source: this crate's own; volumes are sums of cones, as in Mirtich (1996). Cost: O(m log m)
//! in these caps.

use cranny_exact::DVec3;

use super::input::{Input, twice_area_vector};
use crate::caps::CapSurface;
use crate::ids::CapId;

/// A volume beneath a triangle is a sixth of a product of three lengths, at the most, and is
/// rounded nine times by half an epsilon. Smaller, and layers that enclose nothing may seem to hold
/// something; larger, and layers that hold more than rounding are skin.
const VOLUME_ROUNDING: f64 = f64::EPSILON;

/// Caps without faces that hang together.
#[derive(Clone, Copy, Default)]
struct Layer {
    /// Area, negative where too much is covered.
    covered: f64,
    area: f64,
    /// Their lengths.
    edges: f64,
    /// Between the caps and a corner of the first. Measured from far away, what rounding leaves of
    /// layers as slim as slabs are deep is more than they hold
    /// (`two_caps_back_to_back_are_no_opening`).
    volume: f64,
    corner: Option<DVec3>,
    /// Lengths along edges, multiplied as they are in volumes: these are off by roundings of such
    /// products.
    products: f64,
    /// It has a boundary.
    is_open: bool,
}

impl Layer {
    fn is_skin(&self, slab_depth: f64) -> bool {
        let rounding = VOLUME_ROUNDING * self.products;
        let is_flat = !self.is_open && self.volume.abs() <= slab_depth * self.area + rounding;
        is_flat || self.covered.abs() <= slab_depth * self.edges
    }
}

impl Input<'_> {
    /// For each component of caps without faces, whether it is skin; `caps` are these and which
    /// component each belongs to. It is, where it covers no more than a strip along its edges as
    /// wide as slabs are deep: needles, and what faces that straddle facets cover too often here
    /// and too little there. And where it is closed in itself and no deeper than slabs: the two
    /// sides of a flange about as thin as these, whose faces lie on either side's facets.
    pub(super) fn skin(
        &self,
        caps: &CapSurface,
        members: Vec<(usize, usize)>,
        is_skin: &mut [bool],
    ) {
        let mut layers = vec![Layer::default(); is_skin.len()];
        let mut borders = Vec::new();
        for (cap, root) in members {
            let ids = caps.triangles[cap];
            let corners @ [a, b, c] = self.cap_triangle(caps, cap);
            let is_negative = caps.negative.binary_search(&CapId(cap as u32)).is_ok();
            let sign = if is_negative { -1.0 } else { 1.0 };
            let layer = &mut layers[root];
            let area = 0.5 * twice_area_vector(corners).length();
            layer.covered += sign * area;
            layer.area += area;
            layer.edges += (b - a).length() + (c - b).length() + (a - c).length();
            let from = *layer.corner.get_or_insert(corners[0]);
            let [a, b, c] = corners.map(|p| p - from);
            layer.volume += a.dot(b.cross(c)) / 6.0;
            layer.products += a.length() * b.length() * c.length();
            borders.extend((0..3).map(|k| {
                let (from, to) = (ids[k], ids[(k + 1) % 3]);
                ((root, from.min(to), from.max(to)), if from < to { 1 } else { -1 })
            }));
        }
        borders.sort_unstable();
        for edge in borders.chunk_by(|a, b| a.0 == b.0) {
            let times: i32 = edge.iter().map(|b| b.1).sum();
            layers[edge[0].0.0].is_open |= times != 0;
        }
        let depth = self.features.slab_depth();
        for (is_skin, layer) in is_skin.iter_mut().zip(layers) {
            *is_skin = layer.is_skin(depth);
        }
    }
}
