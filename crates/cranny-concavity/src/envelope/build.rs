//! Building envelopes: layer by layer, breadth-first.
//!
//! No source: this crate's own. A half-space holds its faces, for every corner is looked at and the
//! rounding of its height bounded. Cost: O(n) for each depth of layers, so O(n log n) as a rule,
//! given the trees.

use std::collections::VecDeque;

use cranny_exact::{Aabb, DVec3};

use super::cluster::{Scratch, clusters};
use super::face_groups::{FaceGroups, larger};
use super::moments::{Opening, unit};
use super::{EnvelopeFacet, EnvelopeOptions, Envelopes, HalfSpace, Head, Pocket};
use cranny_geometry::{FaceForest, FaceTree, Mesh, OptionalIndex};

impl HalfSpace {
    /// The smallest half-space with this normal (a unit vector, to rounding) that certainly holds
    /// the points.
    pub(super) fn holding(normal: DVec3, points: impl Iterator<Item = DVec3>) -> Self {
        let (mut most, mut bounds) = (f64::NEG_INFINITY, Aabb::EMPTY);
        for p in points {
            most = larger(most, normal.dot(p));
            bounds = Aabb { min: bounds.min.min(p), max: bounds.max.max(p) };
        }
        Self::above(normal, most, &bounds)
    }

    /// The same from the largest inner product of points with the normal, as computed, and their
    /// box.
    fn above(normal: DVec3, most: f64, bounds: &Aabb) -> Self {
        // Three products and two sums round by half an ulp of at most the sum of absolute products;
        // the last term stands for products that underflow.
        let size = bounds.min.abs().max(bounds.max.abs());
        let rounding = 2.0 * f64::EPSILON * normal.abs().dot(size) + f64::MIN_POSITIVE;
        Self { normal, offset: (most + rounding).next_up() }
    }
}

impl Envelopes {
    /// Of no concavity yet.
    pub(super) fn empty(options: EnvelopeOptions) -> Self {
        Self {
            heads: Vec::new(),
            layers: Vec::new(),
            facets: Vec::new(),
            faces: Vec::new(),
            lids: Vec::new(),
            options,
        }
    }

    /// Builds an envelope for each pocket.
    ///
    /// Cost: O(n log n) for n faces in all, most of it for trees over the faces of each.
    #[must_use]
    pub fn of<'p>(
        mesh: &Mesh,
        pockets: impl IntoIterator<Item = Pocket<'p>>,
        options: &EnvelopeOptions,
    ) -> Self {
        let pockets: Vec<Pocket> = pockets.into_iter().collect();
        let groups = pockets.iter().map(|pocket| pocket.faces);
        let leaf_size = FaceForest::DEFAULT_LEAF_SIZE.min(options.leaf_faces);
        Self::within(
            mesh,
            pockets.iter().copied(),
            &FaceForest::over(mesh, groups, leaf_size),
            options,
        )
    }

    /// The same, given trees over the faces of each pocket, in the same order.
    ///
    /// # Panics
    ///
    /// Where there are fewer trees than pockets.
    #[must_use]
    pub fn within<'p>(
        mesh: &Mesh,
        pockets: impl IntoIterator<Item = Pocket<'p>>,
        trees: &FaceForest,
        options: &EnvelopeOptions,
    ) -> Self {
        let options =
            EnvelopeOptions { width: options.width.max(2), leaf_faces: options.leaf_faces.max(1) };
        let mut all = Self::empty(options);
        let mut workshop = Workshop::default();
        for (i, pocket) in pockets.into_iter().enumerate() {
            all.add(mesh, &pocket, (trees.arena(), trees.root(i)), &mut workshop);
        }
        all
    }

    /// `root`: the node of the tree over the pocket's faces; none where there are none.
    pub(super) fn add(
        &mut self,
        mesh: &Mesh,
        pocket: &Pocket,
        (tree, root): (&FaceTree, Option<u32>),
        workshop: &mut Workshop,
    ) {
        let bounds = root.map_or(Aabb::EMPTY, |root| tree.node(root).bounds);
        let opening = Opening::of(pocket.openings, &bounds);
        let lids_start = self.lids.len() as u32;
        let Some(root) = root else {
            let lids = [lids_start; 2];
            self.heads.push(Head { axis: opening.axis, bounds, lids, layer: OptionalIndex::NONE });
            return;
        };
        workshop.groups.fill(mesh, tree, root, &opening, self.options.leaf_faces);
        let count = workshop.groups.items.len();
        workshop.order.clear();
        workshop.order.extend(0..count as u32);
        // Fewer than a third more facets are made than there are groups, as a rule.
        self.facets.reserve(count + count / 3);
        self.faces.reserve(pocket.faces.len());
        for direction in pocket.openings.iter().filter_map(|&o| unit(o)) {
            let corners = workshop.groups.all_corners().iter();
            let corners = corners.map(|&v| mesh.position(v));
            self.lids.push(HalfSpace::holding(direction, corners));
        }
        let lids = [lids_start, self.lids.len() as u32];
        let layer = OptionalIndex::some(self.layers.len() as u32);
        self.heads.push(Head { axis: opening.axis, bounds, lids, layer });

        self.add_layer(mesh, [0, count], self.faces.len() as u32, &opening, workshop);
        while let Some((facet, groups)) = workshop.waiting.pop_front() {
            self.facets[facet].layer = OptionalIndex::some(self.layers.len() as u32);
            let first_face = self.facets[facet].faces[0];
            self.add_layer(mesh, groups, first_face, &opening, workshop);
        }
        self.faces.extend(workshop.groups.ordered_faces(&workshop.order));
    }

    /// Divides a range of the order of groups, whose faces will stand from `face` on, and makes a
    /// facet of each part; those with many faces are left waiting for a layer.
    fn add_layer(
        &mut self,
        mesh: &Mesh,
        [start, end]: [usize; 2],
        mut face: u32,
        opening: &Opening,
        workshop: &mut Workshop,
    ) {
        let Workshop { groups, order, scratch, layer, in_order, waiting } = workshop;
        let range = &mut order[start..end];
        let mut parts = clusters(&groups.items, range, opening, &self.options, scratch);
        parts.sort_unstable_by_key(|part| part.start);
        layer.clear();
        for part in parts {
            let range = [start + part.start, start + part.end];
            let normal = part.moments.normal(opening);
            let (mut height, mut reach) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            let mut bounds = Aabb::EMPTY;
            for group in order[range[0]..range[1]].iter().map(|&item| groups.group(item)) {
                reach = larger(reach, group.reach);
                bounds = bounds.union(&group.bounds);
                for &v in groups.corners(group) {
                    height = larger(height, normal.dot(mesh.position(v)));
                }
            }
            let next = face + part.moments.count() as u32;
            let facet = EnvelopeFacet {
                beneath: HalfSpace::above(normal, height, &bounds),
                bounds,
                reach: HalfSpace::above(opening.axis, reach, &bounds).offset,
                faces: [face, next],
                layer: OptionalIndex::NONE,
            };
            layer.push((facet, range));
            face = next;
        }
        // Sorted by name: facets are large.
        in_order.clear();
        in_order.extend(layer.iter().zip(0..).map(|((facet, _), at)| (facet.reach, at)));
        in_order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let first = self.facets.len();
        for &(_, at) in &*in_order {
            let (facet, range) = layer[at as usize];
            if (facet.faces[1] - facet.faces[0]) as usize > self.options.leaf_faces {
                waiting.push_back((self.facets.len(), range));
            }
            self.facets.push(facet);
        }
        self.layers.push([first as u32, self.facets.len() as u32]);
    }
}

/// Memory that is used again from pocket to pocket.
#[derive(Default)]
pub(super) struct Workshop {
    groups: FaceGroups,
    /// The groups as they are divided.
    order: Vec<u32>,
    scratch: Scratch,
    /// Facets of a layer in the making, and their ranges of the order.
    layer: Vec<(EnvelopeFacet, [usize; 2])>,
    /// Their reaches and places there, from the cap inwards.
    in_order: Vec<(f64, u32)>,
    /// Facets whose groups are to be divided.
    waiting: VecDeque<(usize, [usize; 2])>,
}
