//! Building envelopes: layer by layer, breadth-first.

use std::collections::VecDeque;

use cranny_exact::{Aabb, DVec3};

use super::cluster::{Cluster, Item, Opening, Scratch, clusters};
use super::{EnvelopeFacet, EnvelopeOptions, Envelopes, HalfSpace, Head, Pocket};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// A sum of unit vectors, weighted by areas, that is shorter than this part of the summed areas says
/// nothing about a direction. Smaller, and rounding picks the axis of a hole right through; larger, and
/// a nearly symmetrical one takes the axis of its largest lid though it has one of its own.
const MEANINGLESS: f64 = 1.0 / 1024.0;

impl HalfSpace {
    /// The smallest half-space with this normal (a unit vector, to rounding) that certainly holds the points.
    pub(super) fn holding(normal: DVec3, points: impl Iterator<Item = DVec3>) -> Self {
        let (mut most, mut bounds) = (f64::NEG_INFINITY, Aabb::EMPTY);
        for p in points {
            most = most.max(normal.dot(p));
            bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
        }
        Self::above(normal, most, &bounds)
    }

    /// The same from the largest inner product of points with the normal, as computed, and their box.
    fn above(normal: DVec3, most: f64, bounds: &Aabb) -> Self {
        // Three products and two sums round by half an ulp of at most the sum of absolute products; the
        // last term stands for products that underflow.
        let size = bounds.min.abs().max(bounds.max.abs());
        let rounding = 2.0 * f64::EPSILON * normal.abs().dot(size) + f64::MIN_POSITIVE;
        Self { normal, offset: (most + rounding).next_up() }
    }
}

impl Envelopes {
    /// Builds an envelope for each pocket.
    ///
    /// Cost: O(n log n) for n faces in all.
    #[must_use]
    pub fn of<'p>(
        mesh: &Mesh,
        pockets: impl IntoIterator<Item = Pocket<'p>>,
        options: &EnvelopeOptions,
    ) -> Self {
        let options =
            EnvelopeOptions { width: options.width.max(2), leaf_faces: options.leaf_faces.max(1) };
        let mut all = Self {
            heads: Vec::new(),
            layers: Vec::new(),
            facets: Vec::new(),
            faces: Vec::new(),
            lids: Vec::new(),
            options,
        };
        let mut items = Vec::new();
        for pocket in pockets {
            all.add(mesh, &pocket, &mut items);
        }
        all
    }

    pub(super) fn add(&mut self, mesh: &Mesh, pocket: &Pocket, items: &mut Vec<Item>) {
        items.clear();
        items.extend(pocket.faces.iter().map(|&f| Item::of(mesh, f)));
        let bounds = Aabb::of_points(items.iter().flat_map(|item| item.corners));
        let opening = Opening::of(pocket.openings, &bounds);
        let lids_start = self.lids.len() as u32;
        if !items.is_empty() {
            for direction in pocket.openings.iter().filter_map(|&o| unit(o)) {
                let corners = items.iter().flat_map(|item| item.corners);
                self.lids.push(HalfSpace::holding(direction, corners));
            }
        }
        let layer = if items.is_empty() { u32::MAX } else { self.layers.len() as u32 };
        let lids = [lids_start, self.lids.len() as u32];
        self.heads.push(Head { axis: opening.axis, bounds, lids, layer });

        let offset = self.faces.len();
        let (mut scratch, mut waiting) = (Scratch::default(), VecDeque::new());
        if !items.is_empty() {
            let whole = [0, items.len()];
            self.add_layer(items, whole, offset, &opening, &mut scratch, &mut waiting);
        }
        while let Some(facet) = waiting.pop_front() {
            let range = self.facets[facet].faces.map(|f| f as usize - offset);
            self.facets[facet].layer = self.layers.len() as u32;
            self.add_layer(items, range, offset, &opening, &mut scratch, &mut waiting);
        }
        self.faces.extend(items.iter().map(|item| item.face));
    }

    /// Divides a range of items, and makes a facet of each part; those with many faces are left waiting
    /// for a layer.
    fn add_layer(
        &mut self,
        items: &mut [Item],
        [start, end]: [usize; 2],
        offset: usize,
        opening: &Opening,
        scratch: &mut Scratch,
        waiting: &mut VecDeque<usize>,
    ) {
        let parts = clusters(&mut items[start..end], opening, &self.options, scratch);
        let first = self.facets.len();
        for Cluster { start: from, end: to, normal, .. } in parts {
            let (from, to) = (start + from, start + to);
            let (mut height, mut reach) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            let mut bounds = Aabb::EMPTY;
            for p in items[from..to].iter().flat_map(|item| item.corners) {
                (height, reach) = (height.max(normal.dot(p)), reach.max(opening.axis.dot(p)));
                bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
            }
            self.facets.push(EnvelopeFacet {
                beneath: HalfSpace::above(normal, height, &bounds),
                bounds,
                reach: HalfSpace::above(opening.axis, reach, &bounds).offset,
                faces: [(offset + from) as u32, (offset + to) as u32],
                layer: u32::MAX,
            });
        }
        let layer = &mut self.facets[first..];
        layer.sort_by(|a, b| b.reach.total_cmp(&a.reach).then(a.faces.cmp(&b.faces)));
        for (index, facet) in layer.iter().enumerate() {
            if (facet.faces[1] - facet.faces[0]) as usize > self.options.leaf_faces {
                waiting.push_back(first + index);
            }
        }
        self.layers.push([first as u32, self.facets.len() as u32]);
    }
}

fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    // Scaled first, so that squares neither overflow nor vanish.
    (largest > 0.0 && largest.is_finite()).then(|| (v / largest).normalize())
}

impl Opening {
    fn of(openings: &[DVec3], bounds: &Aabb) -> Self {
        let sum: DVec3 = openings.iter().sum();
        let total: f64 = openings.iter().map(|o| o.length()).sum();
        let largest = openings
            .iter()
            .copied()
            .reduce(|a, b| if b.length_squared() > a.length_squared() { b } else { a });
        let is_through = openings.len() > 1 && sum.length() <= MEANINGLESS * total;
        let direction = if is_through { largest.and_then(unit) } else { unit(sum) };
        let size = bounds.max - bounds.min;
        let axis = direction.unwrap_or_else(|| DVec3::AXES[size.min_position()]);
        let (across, around) = axis.any_orthonormal_pair();
        Self { axis, frame: [axis, across, around], is_through }
    }
}

impl Item {
    fn of(mesh: &Mesh, face: FaceId) -> Self {
        let area_vector = mesh.area_vector(face);
        let area = area_vector.length();
        let normal = if area > 0.0 { area_vector / area } else { DVec3::ZERO };
        Self { corners: mesh.triangle(face), normal, area, face }
    }
}
